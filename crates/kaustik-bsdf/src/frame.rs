use glam::DVec3;

/// Right-handed orthonormal frame at a surface point; `z` is the shading normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Tangent.
    pub x: DVec3,
    /// Bitangent, `z cross x`.
    pub y: DVec3,
    /// Shading normal.
    pub z: DVec3,
}

impl Frame {
    /// A frame about the unit vector `z`, with a tangent of its own choice that is continuous
    /// in `z` apart from the plane z = 0.
    #[inline]
    pub fn from_z(z: DVec3) -> Self {
        // Of the plane across z take the vector whose third component is -x times the sign, in
        // the manner of Frisvad, with the pole put at z = -1 times the sign so that no division
        // comes near zero (Duff et al. 2017).
        let sign = if z.z < 0.0 { -1.0 } else { 1.0 };
        let a = -1.0 / (sign + z.z);
        let b = z.x * z.y * a;
        Self {
            x: DVec3::new(1.0 + sign * z.x * z.x * a, sign * b, -sign * z.x),
            y: DVec3::new(b, sign + z.y * z.y * a, -z.y),
            z,
        }
    }

    /// A frame about the unit vector `z` whose tangent is `x` made perpendicular to it; `x`
    /// need not be unit. Falls back to [`from_z`](Self::from_z) where `x` is parallel to `z`
    /// or not finite.
    #[inline]
    pub fn from_z_x(z: DVec3, x: DVec3) -> Self {
        let across = x - z * z.dot(x);
        let squared = across.length_squared();
        if squared > 1e-16 * x.length_squared() && squared.is_finite() {
            let x = across / squared.sqrt();
            Self {
                x,
                y: z.cross(x),
                z,
            }
        } else {
            Self::from_z(z)
        }
    }

    /// World to local.
    #[inline]
    pub fn to_local(&self, w: DVec3) -> DVec3 {
        DVec3::new(self.x.dot(w), self.y.dot(w), self.z.dot(w))
    }

    /// Local to world.
    #[inline]
    pub fn to_world(&self, w: DVec3) -> DVec3 {
        self.x * w.x + self.y * w.y + self.z * w.z
    }
}
