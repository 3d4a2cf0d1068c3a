//! A point of a surface as a walk sees it.

use glam::{DVec3, Vec2, Vec3};
use kaustik_bsdf::Frame;
use kaustik_geometry::Surface;

/// Where a walk met a surface: the geometry in f64, the shading frame, the material.
#[derive(Clone, Copy, Debug)]
pub struct Vertex {
    /// The geometry as the ray tracer keeps it (f32, with its error bound).
    pub surface: Surface,
    /// World position.
    pub position: DVec3,
    /// Unit geometric normal of the front side.
    pub normal: DVec3,
    /// Shading frame; its z lies on the same side as [`Self::normal`].
    pub frame: Frame,
    /// Which instance.
    pub instance: u32,
    /// Which triangle of it.
    pub primitive: u32,
    /// Index of the material.
    pub material: u32,
}

impl Default for Vertex {
    /// A slot for [`Scene::advance`](crate::Scene::advance) to write into.
    fn default() -> Self {
        Self {
            surface: Surface {
                position: Vec3::ZERO,
                position_error: Vec3::ZERO,
                geometric_normal: Vec3::Z,
                shading_normal: Vec3::Z,
                uv: [Vec2::ZERO; 2],
                color: [1.0; 4],
                front: true,
            },
            position: DVec3::ZERO,
            normal: DVec3::Z,
            frame: Frame {
                x: DVec3::X,
                y: DVec3::Y,
                z: DVec3::Z,
            },
            instance: 0,
            primitive: 0,
            material: 0,
        }
    }
}

impl Vertex {
    /// The geometric normal in the local frame, for the adjoint of shading normals.
    #[inline]
    pub fn local_normal(&self) -> DVec3 {
        self.frame.to_local(self.normal)
    }

    /// Does `direction` (world) leave on the front side of the geometry?
    #[inline]
    pub fn in_front(&self, direction: DVec3) -> bool {
        self.normal.dot(direction) > 0.0
    }
}
