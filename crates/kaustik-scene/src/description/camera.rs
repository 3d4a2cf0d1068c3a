use glam::Affine3A;

/// How directions are mapped to the image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// Pinhole or thin lens.
    Perspective {
        /// Vertical field of view in radians, in (0, pi).
        yfov: f32,
        /// Width over height if the file gives it: the default of the image's shape, which decides.
        aspect_ratio: Option<f32>,
    },
    /// Parallel rays; half extents in scene units.
    Orthographic {
        /// Half the width that the file asks for: the default of the image's shape, which decides.
        xmag: f32,
        /// Half the height.
        ymag: f32,
    },
}

/// A thin lens (`extras.kaustik` of a camera).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lens {
    /// Radius of the aperture in scene units, > 0.
    pub aperture: f32,
    /// Distance of the plane of focus along the axis in scene units, > 0.
    pub focus: f32,
    /// A polygon in place of the round aperture.
    pub blades: Option<Blades>,
}

/// An aperture of straight blades: a regular polygon with its corners on the circle of the
/// aperture's radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blades {
    /// Corners, 3 to 64.
    pub count: u32,
    /// Angle of the first corner from the camera's +x in radians, counter-clockwise toward +y.
    pub rotation: f32,
}

/// When the shutter is open, in seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shutter {
    /// Opens.
    pub open: f32,
    /// Closes, not before it opens.
    pub close: f32,
}

/// A camera: it looks along its local -z, +y is up (glTF's convention).
#[derive(Clone, Debug, PartialEq)]
pub struct CameraDescription {
    /// Name, for `--camera`.
    pub name: String,
    /// Camera to world; scale is ignored.
    pub transform: Affine3A,
    /// Projection.
    pub projection: Projection,
    /// Thin lens; `None` is a pinhole.
    pub lens: Option<Lens>,
    /// Shutter interval; `None` is an instant.
    pub shutter: Option<Shutter>,
}
