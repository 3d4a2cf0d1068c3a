use crate::ggx::Ggx;
use crate::local::within;
use crate::{Reflectance, SMOOTH_ALPHA, ThinFilm};
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
    /// `diffuseTransmissionFactor`, `[0, 1]`: share of the diffuse light that leaves on the other side, of what is no solid.
    pub diffuse_transmission: f64,
    /// `diffuseTransmissionColorFactor`: colour of that light, in place of the base colour. Lanes in `[0, 1]`.
    pub diffuse_transmission_color: Spectrum,
    /// `anisotropyStrength`, `[0, 1]`: how much rougher the reflecting facets are along the frame's x than along y.
    pub anisotropy: f64,
    /// A thin film on what reflects.
    pub film: Option<FilmParameters>,
    /// Give back what scatters between facets.
    pub compensation: bool,
}

/// `KHR_materials_iridescence`, at one point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilmParameters {
    /// `iridescenceFactor`, `[0, 1]`.
    pub strength: f64,
    /// `iridescenceIor` relative to the outside.
    pub ior: f64,
    /// Thickness in nanometres.
    pub thickness: f64,
    /// The path's wavelengths in the medium outside, in nanometres: those in vacuum over its index.
    pub wavelengths: Spectrum,
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
            diffuse_transmission: 0.0,
            diffuse_transmission_color: Spectrum::ONE,
            anisotropy: 0.0,
            film: None,
            compensation: true,
        }
    }
}

impl PrincipledParameters {
    /// The same with every number in its range; what is not a number becomes the range's lower
    /// end, an index that is not positive and finite becomes 1.
    #[inline]
    pub(crate) fn in_range(&self) -> Self {
        let unit = |x: f64| within(x, 0.0, 1.0);
        let lane = |x: f32, high: f64| within(f64::from(x), 0.0, high) as f32;
        let share = |s: Spectrum| s.map(|x| lane(x, 1.0));
        Self {
            base_color: share(self.base_color),
            metallic: unit(self.metallic),
            roughness: unit(self.roughness),
            specular: unit(self.specular),
            specular_color: self.specular_color.map(|x| lane(x, 1e6)),
            ior: self
                .ior
                .map(|n| if n > 0.0 && n.is_finite() { n } else { 1.0 }),
            transmission: unit(self.transmission),
            wall: self.wall,
            diffuse_transmission: match self.wall {
                Wall::Thin => unit(self.diffuse_transmission),
                Wall::Solid => 0.0,
            },
            diffuse_transmission_color: share(self.diffuse_transmission_color),
            anisotropy: unit(self.anisotropy),
            film: self.film.filter(|film| film.strength > 0.0),
            compensation: self.compensation,
        }
    }

    /// GGX alpha, 0 where it counts as smooth.
    #[inline]
    pub(super) fn alpha(&self) -> f64 {
        let alpha = self.roughness * self.roughness;
        if alpha < crate::SMOOTH_ALPHA {
            0.0
        } else {
            alpha
        }
    }

    /// The facets that reflect; `None` where the surface counts as smooth.
    ///
    /// Along x the roughness goes from alpha to 1 with the square of the anisotropy, as the extension has it.
    #[inline]
    pub(crate) fn facets(&self) -> Option<Ggx> {
        let alpha = self.alpha();
        let strength = self.anisotropy * self.anisotropy;
        let along = alpha + (1.0 - alpha) * strength;
        match self.anisotropy > 0.0 {
            true if along >= SMOOTH_ALPHA => Some(Ggx::brushed([along, alpha.max(SMOOTH_ALPHA)])),
            _ => (alpha > 0.0).then(|| Ggx::new(alpha)),
        }
    }

    /// Reflection between two colours, under the film if there is one.
    #[inline]
    pub(super) fn reflectance(&self, f0: Spectrum, f90: Spectrum) -> Reflectance {
        match self.film {
            None => Reflectance::Schlick { f0, f90 },
            Some(film) => Reflectance::Filmed(ThinFilm::new(
                film.strength,
                film.ior,
                film.thickness,
                film.wavelengths,
                (f0, f90.max()),
            )),
        }
    }

    /// Reflection of two parts of the surface, each between two colours that are weighted by its share; under
    /// the film, if there is one, each has its own.
    #[inline]
    pub(super) fn mixed(
        &self,
        (f0, f90): (Spectrum, Spectrum),
        other: (Spectrum, Spectrum),
    ) -> Reflectance {
        match self.reflectance(f0, f90) {
            Reflectance::Filmed(film) => Reflectance::Filmed(film.and((other.0, other.1.max()))),
            _ => Reflectance::Schlick {
                f0: f0 + other.0,
                f90: f90 + other.1,
            },
        }
    }

    /// Reflectance of the dielectric at normal incidence and at grazing (`KHR_materials_specular`).
    #[inline]
    pub(super) fn dielectric_ends(&self) -> (Spectrum, Spectrum) {
        let strength = self.specular as f32;
        let f0 = self.ior.zip(self.specular_color, |n, colour| {
            (crate::fresnel::normal_incidence(f64::from(n)) as f32 * colour).min(1.0) * strength
        });
        (f0, Spectrum::splat(strength))
    }
}
