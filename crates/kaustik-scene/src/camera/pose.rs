use glam::{Affine3A, DVec3};

/// Where a camera stands: orthonormal, right-handed, local -z is forward.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Pose {
    position: DVec3,
    x: DVec3,
    y: DVec3,
    z: DVec3,
}

impl Pose {
    /// The rotation nearest in view direction, then in up direction; `None` without axes. A
    /// mirrored transform does not mirror the image: scale is ignored.
    pub(super) fn new(transform: &Affine3A) -> Option<Self> {
        let columns = transform.matrix3.as_dmat3();
        let z = columns.z_axis.try_normalize()?;
        let x = columns.y_axis.try_normalize()?.cross(z).try_normalize()?;
        let position = glam::Vec3::from(transform.translation).as_dvec3();
        let pose = Self {
            position,
            x,
            y: z.cross(x).normalize(),
            z,
        };
        let finite = pose.position.is_finite() && pose.x.is_finite() && pose.z.is_finite();
        finite.then_some(pose)
    }

    pub(super) fn position(&self) -> DVec3 {
        self.position
    }

    pub(super) fn forward(&self) -> DVec3 {
        -self.z
    }

    pub(super) fn vector_to_world(&self, v: DVec3) -> DVec3 {
        self.x * v.x + self.y * v.y + self.z * v.z
    }

    pub(super) fn vector_to_local(&self, v: DVec3) -> DVec3 {
        DVec3::new(v.dot(self.x), v.dot(self.y), v.dot(self.z))
    }

    pub(super) fn point_to_world(&self, p: DVec3) -> DVec3 {
        self.position + self.vector_to_world(p)
    }

    pub(super) fn point_to_local(&self, p: DVec3) -> DVec3 {
        self.vector_to_local(p - self.position)
    }
}
