/// What happens outside [0, 1).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wrap {
    /// Repeats.
    #[default]
    Repeat,
    /// Repeats, every other copy mirrored.
    Mirror,
    /// The edge goes on.
    Clamp,
}

/// How texels are read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Filtering {
    /// Bilinear.
    #[default]
    Linear,
    /// The nearest texel.
    Nearest,
}

/// An image with its sampling.
#[derive(Clone, Debug, PartialEq)]
pub struct TextureDescription {
    /// Index into [`Description::images`](super::Description::images).
    pub image: usize,
    /// Wrapping along u.
    pub wrap_s: Wrap,
    /// Wrapping along v.
    pub wrap_t: Wrap,
    /// Magnification filter.
    pub filtering: Filtering,
}

/// An affine map of texture coordinates (`KHR_texture_transform`): scale, rotate, offset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UvTransform {
    /// Added last.
    pub offset: [f32; 2],
    /// Counter-clockwise in uv as the extension defines it, in radians.
    pub rotation: f32,
    /// Applied first.
    pub scale: [f32; 2],
}

impl UvTransform {
    /// Leaves coordinates as they are.
    pub const IDENTITY: Self = Self {
        offset: [0.0; 2],
        rotation: 0.0,
        scale: [1.0; 2],
    };
}

/// A texture as a material uses it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TextureSlot {
    /// Index into [`Description::textures`](super::Description::textures).
    pub texture: usize,
    /// Which uv set of the mesh, 0 or 1.
    pub uv_set: u8,
    /// Map of the coordinates before the look-up.
    pub transform: UvTransform,
}
