//! Instances as hits ask for them.

use std::sync::Arc;

use glam::{Affine3A, DMat3, DVec3, Vec3};

use crate::Mesh;
use crate::surface::Corners;

/// An instance, where it stands and what is asked of it often.
pub(crate) struct Standing {
    pub(crate) mesh: Arc<Mesh>,
    /// The mesh has positions alone.
    pub(crate) bare: bool,
    /// Index of its motion, or [`STILL`](crate::bvh::STILL).
    pub(crate) motion: u32,
    /// The largest coordinate of the mesh, absolute.
    size: f32,
    /// Of what moves: at time 0.
    pub(crate) pose: Pose,
}

/// A transform with what it does to directions: worked out once for what stands still, because every hit asks.
pub(crate) struct Pose {
    transform: Affine3A,
    placement: Placement,
    /// The transform changes nothing at all.
    pub(crate) identity: bool,
    /// -1 if the transform mirrors, else 1.
    pub(crate) handedness: f64,
    /// Of directions, object to world.
    pub(crate) linear: DMat3,
    /// Of normals, up to length: the cofactors, whose sign must not turn the normal.
    pub(crate) normals: DMat3,
    /// At least as large as [`Corners::reach`] of any of its triangles.
    pub(crate) reach: f64,
}

/// How its corners come to stand where rays meet them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Placement {
    /// As the mesh has them.
    Still,
    /// Moved once, in single precision.
    Moved,
    /// Rays undergo the transform.
    OwnTree,
}

impl Standing {
    /// `size` is the largest coordinate of the mesh, absolute; `motion` the index of its motion.
    pub(crate) fn new(
        transform: Affine3A,
        mesh: &Arc<Mesh>,
        flattened: bool,
        size: f32,
        motion: u32,
    ) -> Self {
        Self {
            bare: mesh.is_bare(),
            mesh: Arc::clone(mesh),
            motion,
            size,
            pose: Pose::new(transform, flattened, size),
        }
    }

    /// Of what moves: where it stands when its transform is this.
    pub(crate) fn moved(&self, transform: Affine3A) -> Pose {
        Pose::new(transform, false, self.size)
    }

    /// A triangle's corners exactly as the walk sees them.
    #[inline(always)]
    pub(crate) fn corners<'a>(&'a self, pose: &'a Pose, primitive: u32) -> Corners<'a> {
        let positions = match pose.placement {
            // Corner by corner: an array of the mesh's own would be copied before it is widened.
            Placement::Still => {
                let [a, b, c] = self.mesh.indices[primitive as usize];
                let wide = |i: u32| self.mesh.positions[i as usize].as_dvec3();
                [wide(a), wide(b), wide(c)]
            }
            Placement::Moved => {
                let moved = |p| pose.transform.transform_point3(p).as_dvec3();
                self.mesh.corners(primitive).map(moved)
            }
            Placement::OwnTree => {
                let shift = pose.transform.translation.as_dvec3();
                let placed = |p: Vec3| pose.linear * p.as_dvec3() + shift;
                self.mesh.corners(primitive).map(placed)
            }
        };
        Corners {
            mesh: &self.mesh,
            bare: self.bare,
            pose,
            primitive,
            positions,
        }
    }
}

impl Pose {
    fn new(transform: Affine3A, flattened: bool, size: f32) -> Self {
        let linear = transform.matrix3.as_dmat3();
        let handedness = linear.determinant().signum();
        let [x, y, z] = linear.to_cols_array_2d().map(DVec3::from);
        let identity = transform == Affine3A::IDENTITY;
        let size = f64::from(size);
        let reach = if identity && flattened {
            size
        } else {
            let turned = (x.abs() + y.abs() + z.abs()).max_element() * size;
            let shift = transform.translation.as_dvec3().abs().max_element();
            // Twice, because an instance's own tree counts the parts of the sum and the sum; and rounding.
            2.0001 * (turned + shift)
        };
        Self {
            placement: match (flattened, identity) {
                (true, true) => Placement::Still,
                (true, false) => Placement::Moved,
                (false, _) => Placement::OwnTree,
            },
            transform,
            identity,
            handedness,
            linear,
            normals: DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y)) * handedness,
            reach,
        }
    }

    /// That of the transform, where rays undergo it; None where the corners did.
    pub(crate) fn translation(&self) -> Option<DVec3> {
        (self.placement == Placement::OwnTree).then(|| self.transform.translation.as_dvec3())
    }
}
