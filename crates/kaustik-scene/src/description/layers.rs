use super::TextureSlot;

/// `KHR_materials_clearcoat`: a varnish over all else.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clearcoat {
    /// Share of the surface that has it, in [0, 1].
    pub factor: f32,
    /// Share in the red channel.
    pub texture: Option<TextureSlot>,
    /// Perceptual roughness in [0, 1].
    pub roughness: f32,
    /// Roughness in the green channel.
    pub roughness_texture: Option<TextureSlot>,
    /// Normals of its own, in the tangent frame of what it covers.
    pub normal_texture: Option<TextureSlot>,
    /// Factor of their x and y.
    pub normal_scale: f32,
}

/// `KHR_materials_sheen`: fibres that shine at grazing angles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sheen {
    /// Linear Rec.709 in [0, 1].
    pub color: [f32; 3],
    /// Colour texture (sRGB).
    pub color_texture: Option<TextureSlot>,
    /// Perceptual roughness in [0, 1].
    pub roughness: f32,
    /// Roughness in the alpha channel.
    pub roughness_texture: Option<TextureSlot>,
}

/// `KHR_materials_anisotropy`: facets rougher along one direction of the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Anisotropy {
    /// In [0, 1].
    pub strength: f32,
    /// Radians from the tangent, counter-clockwise.
    pub rotation: f32,
    /// Direction in red and green, strength in blue.
    pub texture: Option<TextureSlot>,
}

/// `KHR_materials_iridescence`: a thin film.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Iridescence {
    /// Share of the surface that has it, in [0, 1].
    pub factor: f32,
    /// Share in the red channel.
    pub texture: Option<TextureSlot>,
    /// Index of refraction of the film, >= 1.
    pub ior: f32,
    /// Thickness in nanometres where the texture is 0, and where it is 1 or absent.
    pub thickness: [f32; 2],
    /// Where in that range, in the green channel.
    pub thickness_texture: Option<TextureSlot>,
}
