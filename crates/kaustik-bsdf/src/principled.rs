use crate::{Lambertian, Lobe, Mode, Sample};
use glam::DVec3;
use kaustik_spectrum::Spectrum;

/// What stands behind a transmitting glTF surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Wall {
    /// No volume: a pane that light passes straight, blurred by the roughness.
    #[default]
    Thin,
    /// `KHR_materials_volume` with a thickness: the boundary of a solid, which refracts.
    Solid,
}

/// What glTF says of a material, at one point and at the path's wavelengths.
///
/// The default is glTF's for what the extensions add, with white base colour, metallic 1 and
/// roughness 1 as the core has it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrincipledParameters {
    /// Base colour: of the metal, of the diffuse body, of transmitted light. Lanes in `[0, 1]`.
    pub base_color: Spectrum,
    /// Metal share, `[0, 1]`.
    pub metallic: f64,
    /// Perceptual roughness, `[0, 1]`; GGX alpha is its square.
    pub roughness: f64,
    /// `specularFactor`, `[0, 1]`: strength of the dielectric's reflection.
    pub specular: f64,
    /// `specularColorFactor`, lanes at least 0: tint of the dielectric's reflection at normal incidence.
    pub specular_color: Spectrum,
    /// Index of the dielectric relative to the outside, each lane (1.5 unless `KHR_materials_ior`).
    pub ior: Spectrum,
    /// `transmissionFactor`, `[0, 1]`: share of the dielectric that is clear instead of diffuse.
    pub transmission: f64,
    /// Pane or solid, for the clear share.
    pub wall: Wall,
    /// Give back what scatters between facets.
    pub compensation: bool,
}

impl Default for PrincipledParameters {
    fn default() -> Self {
        Self {
            base_color: Spectrum::ONE,
            metallic: 1.0,
            roughness: 1.0,
            specular: 1.0,
            specular_color: Spectrum::ONE,
            ior: Spectrum::splat(1.5),
            transmission: 0.0,
            wall: Wall::Thin,
            compensation: true,
        }
    }
}

/// glTF's metallic-roughness material with specular, ior, transmission and volume.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Principled {
    diffuse: Lambertian,
}

impl Principled {
    /// From glTF's numbers.
    #[inline]
    pub fn new(parameters: &PrincipledParameters) -> Self {
        Self { diffuse: Lambertian { reflectance: parameters.base_color } }
    }
}

impl Lobe for Principled {
    fn eval(&self, wo: DVec3, wi: DVec3, mode: Mode) -> Spectrum {
        self.diffuse.eval(wo, wi, mode)
    }

    fn pdf(&self, wo: DVec3, wi: DVec3, mode: Mode) -> f64 {
        self.diffuse.pdf(wo, wi, mode)
    }

    fn sample(&self, wo: DVec3, uc: f64, u: [f64; 2], mode: Mode) -> Option<Sample> {
        self.diffuse.sample(wo, uc, u, mode)
    }

    fn albedo(&self, wo: DVec3) -> Spectrum {
        self.diffuse.albedo(wo)
    }
}
