use kaustik_spectrum::{Glass, Metal};

use super::{Anisotropy, Clearcoat, Iridescence, Sheen, TextureSlot};

/// What alpha means.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum AlphaMode {
    /// Nothing: the surface is opaque.
    #[default]
    Opaque,
    /// Opaque where alpha is at least the cutoff, absent elsewhere.
    Mask(f32),
    /// Met with probability alpha, else passed.
    Blend,
}

/// A spectrum as a file gives it (`extras.kaustik`).
#[derive(Clone, Debug, PartialEq)]
pub enum SpectralInput {
    /// A table by name, for instance `cornell-white` or `D65`.
    Named(String),
    /// Knots (wavelength in nm, value), wavelengths ascending.
    Knots(Vec<(f32, f32)>),
}

/// `KHR_materials_specular`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Specular {
    /// Strength of the dielectric reflection in [0, 1].
    pub factor: f32,
    /// Strength in the alpha channel.
    pub texture: Option<TextureSlot>,
    /// Colour of the reflection at normal incidence, linear Rec.709, >= 0.
    pub color: [f32; 3],
    /// Colour texture (sRGB).
    pub color_texture: Option<TextureSlot>,
}

/// `KHR_materials_pbrSpecularGlossiness`: the older model. The base colour is its diffuse colour;
/// metallic, roughness, specular and ior are not used.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpecularGlossiness {
    /// Reflectance at normal incidence, linear Rec.709 in [0, 1].
    pub specular: [f32; 3],
    /// 1 - perceptual roughness, in [0, 1].
    pub glossiness: f32,
    /// Specular colour (sRGB), glossiness in the alpha channel.
    pub texture: Option<TextureSlot>,
}

/// `KHR_materials_transmission`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transmission {
    /// Share of light that is not reflected and goes through, in [0, 1].
    pub factor: f32,
    /// Share in the red channel.
    pub texture: Option<TextureSlot>,
}

/// `KHR_materials_diffuse_transmission`: light that leaves on the other side in all directions, as of a leaf or a lampshade.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DiffuseTransmission {
    /// Share of the diffuse light that goes through, in [0, 1]; of a solid none does.
    pub factor: f32,
    /// Share in the alpha channel.
    pub texture: Option<TextureSlot>,
    /// Colour of that light, linear Rec.709 in [0, 1], in place of the base colour.
    pub color: [f32; 3],
    /// Colour texture (sRGB).
    pub color_texture: Option<TextureSlot>,
}

/// `KHR_materials_volume`: the mesh bounds a solid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Volume {
    /// > 0 for a solid; 0 is a thin wall.
    pub thickness: f32,
    /// Distance after which light is `attenuation_color`; infinite: no absorption.
    pub attenuation_distance: f32,
    /// Linear Rec.709 in [0, 1].
    pub attenuation_color: [f32; 3],
}

/// A scattering model other than glTF's (`extras.kaustik.model`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Model {
    /// A smooth varnish over a diffuse base (RELT's mirror-varnished surfaces).
    Coated,
    /// Diffuse base plus a normalised Phong lobe of this exponent.
    Phong {
        /// Exponent, >= 0.
        exponent: f32,
    },
    /// A rough diffuse surface that loses no energy (Oren and Nayar's in a newer form).
    OrenNayar {
        /// Roughness in [0, 1]; 0 is Lambertian.
        sigma: f32,
    },
}

/// A material as a file gives it: glTF's core model with its extensions, and kaustik's own keys.
#[derive(Clone, Debug, PartialEq)]
pub struct MaterialDescription {
    /// Name, for messages.
    pub name: String,
    /// Linear Rec.709 and alpha, each in [0, 1].
    pub base_color: [f32; 4],
    /// sRGB colour and linear alpha.
    pub base_color_texture: Option<TextureSlot>,
    /// In [0, 1].
    pub metallic: f32,
    /// Perceptual roughness in [0, 1]; GGX alpha is its square.
    pub roughness: f32,
    /// Roughness in green, metallic in blue.
    pub metallic_roughness_texture: Option<TextureSlot>,
    /// Tangent-space normals.
    pub normal_texture: Option<TextureSlot>,
    /// Scales the x and y of the normal texture.
    pub normal_scale: f32,
    /// Emitted radiance, linear Rec.709, strength included.
    pub emissive: [f32; 3],
    /// sRGB factor of the emission.
    pub emissive_texture: Option<TextureSlot>,
    /// What alpha means.
    pub alpha_mode: AlphaMode,
    /// Do both sides emit?
    pub double_sided: bool,
    /// Shows its base colour and scatters nothing (`KHR_materials_unlit`).
    pub unlit: bool,
    /// Index of refraction (`KHR_materials_ior`), >= 1, or 0 for a mirror-like F0 of 1.
    pub ior: f32,
    /// `KHR_materials_dispersion`: 20 / Abbe number; 0 is none.
    pub dispersion: f32,
    /// Dielectric reflection.
    pub specular: Specular,
    /// The older model in place of the newer, if so.
    pub specular_glossiness: Option<SpecularGlossiness>,
    /// Transmission, if any.
    pub transmission: Option<Transmission>,
    /// Diffuse light that goes through, if any.
    pub diffuse_transmission: Option<DiffuseTransmission>,
    /// The interior, if any.
    pub volume: Option<Volume>,
    /// Varnish, if any.
    pub clearcoat: Option<Clearcoat>,
    /// Fibres, if any.
    pub sheen: Option<Sheen>,
    /// Brushed facets, if any.
    pub anisotropy: Option<Anisotropy>,
    /// A thin film, if any.
    pub iridescence: Option<Iridescence>,
    /// Replaces the base colour's uplift: a measured reflectance.
    pub reflectance: Option<SpectralInput>,
    /// Replaces the emission's uplift: radiance.
    pub emission: Option<SpectralInput>,
    /// A measured metal: replaces base colour and metallic.
    pub metal: Option<Metal>,
    /// A measured glass: replaces ior and dispersion.
    pub glass: Option<Glass>,
    /// Another scattering model.
    pub model: Option<Model>,
    /// Which of two overlapping solids wins: the higher.
    pub priority: i32,
}

impl MaterialDescription {
    /// Is what it covers filled with a clear medium: transmission, and a volume with a thickness?
    pub fn bounds_solid(&self) -> bool {
        self.volume.is_some_and(|volume| volume.thickness > 0.0)
            && self.transmission.is_some_and(|t| t.factor > 0.0)
    }
}

impl Default for MaterialDescription {
    /// glTF's default material: white, fully metallic, fully rough.
    fn default() -> Self {
        Self {
            name: String::new(),
            base_color: [1.0; 4],
            base_color_texture: None,
            metallic: 1.0,
            roughness: 1.0,
            metallic_roughness_texture: None,
            normal_texture: None,
            normal_scale: 1.0,
            emissive: [0.0; 3],
            emissive_texture: None,
            alpha_mode: AlphaMode::Opaque,
            double_sided: false,
            unlit: false,
            ior: 1.5,
            dispersion: 0.0,
            specular: Specular {
                factor: 1.0,
                texture: None,
                color: [1.0; 3],
                color_texture: None,
            },
            specular_glossiness: None,
            transmission: None,
            diffuse_transmission: None,
            volume: None,
            clearcoat: None,
            sheen: None,
            anisotropy: None,
            iridescence: None,
            reflectance: None,
            emission: None,
            metal: None,
            glass: None,
            model: None,
            priority: 0,
        }
    }
}
