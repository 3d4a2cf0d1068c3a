//! Instances as hits ask for them.

use std::sync::Arc;

use glam::{Affine3A, DMat3, DVec3, Vec3};

use crate::surface::Corners;
use crate::{Instance, Mesh};

/// An instance with what its transform does to directions: worked out once, because every hit asks.
pub(crate) struct Standing {
    pub(crate) mesh: Arc<Mesh>,
    transform: Affine3A,
    way: Way,
    /// The transform changes nothing at all.
    pub(crate) identity: bool,
    /// The mesh has positions alone.
    pub(crate) bare: bool,
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
enum Way {
    /// As the mesh has them.
    Still,
    /// Moved once, in single precision.
    Moved,
    /// Rays undergo the transform.
    OwnTree,
}

impl Standing {
    /// `size` is the largest coordinate of the mesh, absolute.
    pub(crate) fn new(instance: &Instance, mesh: &Arc<Mesh>, flattened: bool, size: f32) -> Self {
        let transform = instance.transform;
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
            way: match (flattened, identity) {
                (true, true) => Way::Still,
                (true, false) => Way::Moved,
                (false, _) => Way::OwnTree,
            },
            transform,
            identity,
            bare: mesh.is_bare(),
            handedness,
            linear,
            normals: DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y)) * handedness,
            reach,
            mesh: Arc::clone(mesh),
        }
    }

    /// A triangle's corners exactly as the walk sees them.
    #[inline(always)]
    pub(crate) fn corners(&self, primitive: u32) -> Corners<'_> {
        let positions = match self.way {
            // Corner by corner: an array of the mesh's own would be copied before it is widened.
            Way::Still => {
                let [a, b, c] = self.mesh.indices[primitive as usize];
                let wide = |i: u32| self.mesh.positions[i as usize].as_dvec3();
                [wide(a), wide(b), wide(c)]
            }
            Way::Moved => {
                let moved = |p| self.transform.transform_point3(p).as_dvec3();
                self.mesh.corners(primitive).map(moved)
            }
            Way::OwnTree => {
                let shift = self.transform.translation.as_dvec3();
                let placed = |p: Vec3| self.linear * p.as_dvec3() + shift;
                self.mesh.corners(primitive).map(placed)
            }
        };
        Corners {
            standing: self,
            primitive,
            positions,
        }
    }

    /// That of the transform, where rays undergo it; None where the corners did.
    pub(crate) fn translation(&self) -> Option<DVec3> {
        (self.way == Way::OwnTree).then(|| self.transform.translation.as_dvec3())
    }
}
