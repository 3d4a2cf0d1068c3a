use crate::lobe::lobe_of_variants;
use crate::{
    Coated, Conductor, Delta, Dielectric, Finish, Interface, Lambertian, LayerParameters, Layered,
    Lobe, Mirror, Mode, OrenNayar, Passing, Phong, Principled, PrincipledParameters, Reflectance,
    RoughConductor, RoughDielectric, RoughThinDielectric, Sample, ThinDielectric,
};
use glam::DVec3;
use kaustik_spectrum::Spectrum;

/// GGX roughness `alpha` below which a surface is taken as perfectly smooth: its lobe would be
/// narrower than single-precision hit points can tell apart.
pub const SMOOTH_ALPHA: f64 = 1e-3;

/// Any scattering function. Closed and `Copy`: half the cost of boxed trait objects.
///
/// The constructors put a roughness below [`SMOOTH_ALPHA`] to the smooth variant. One more
/// kind of surface is one more file and one more arm.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(
    clippy::large_enum_variant,
    reason = "a box would be an allocation a vertex"
)]
#[expect(missing_docs, reason = "each variant is the type of its name")]
pub enum Bsdf {
    Lambertian(Lambertian),
    Mirror(Mirror),
    Conductor(Conductor),
    RoughConductor(RoughConductor),
    Dielectric(Dielectric),
    RoughDielectric(RoughDielectric),
    ThinDielectric(ThinDielectric),
    RoughThinDielectric(RoughThinDielectric),
    Coated(Coated),
    Phong(Phong),
    Principled(Principled),
    Layered(Layered),
    OrenNayar(OrenNayar),
}

impl Bsdf {
    /// Scatters nothing: what a slot holds before it is written. Not a constant, of which all bytes would be copied.
    #[inline]
    pub fn black() -> Self {
        Self::lambertian(Spectrum::ZERO)
    }

    /// Ideal diffuse reflection; lanes of `reflectance` in `[0, 1]`.
    #[inline]
    pub fn lambertian(reflectance: Spectrum) -> Self {
        Self::Lambertian(Lambertian { reflectance })
    }

    /// Perfect mirror of one colour at all angles.
    #[inline]
    pub fn mirror(reflectance: Spectrum) -> Self {
        Self::Mirror(Mirror { reflectance })
    }

    /// Metal of measured index `eta - i k` (relative to the outside) and GGX roughness `alpha`
    /// in `[0, 1]`; `compensation` gives back what scatters between facets.
    #[inline]
    pub fn conductor(eta: Spectrum, k: Spectrum, alpha: f64, compensation: bool) -> Self {
        Self::reflector(Reflectance::Conductor { eta, k }, alpha, compensation)
    }

    /// Metal by its colours at normal incidence and at grazing (Schlick), see
    /// [`conductor`](Self::conductor).
    #[inline]
    pub fn metal(f0: Spectrum, f90: Spectrum, alpha: f64, compensation: bool) -> Self {
        Self::reflector(Reflectance::Schlick { f0, f90 }, alpha, compensation)
    }

    /// Opaque microfacets of any [`Reflectance`], smooth if `alpha` is small.
    #[inline]
    pub fn reflector(reflectance: Reflectance, alpha: f64, compensation: bool) -> Self {
        if alpha >= SMOOTH_ALPHA {
            Self::RoughConductor(RoughConductor::new(reflectance, alpha, compensation))
        } else {
            Self::Conductor(Conductor { reflectance })
        }
    }

    /// Boundary of a transparent solid; z > 0 is outside. GGX roughness `alpha` in `[0, 1]`.
    #[inline]
    pub fn dielectric(interface: Interface, alpha: f64, compensation: bool) -> Self {
        if alpha >= SMOOTH_ALPHA && interface.bends() {
            Self::RoughDielectric(RoughDielectric::new(interface, alpha, compensation))
        } else {
            Self::Dielectric(Dielectric { interface })
        }
    }

    /// Pane without thickness, blurred if `alpha` is not small.
    #[inline]
    pub fn thin_dielectric(interface: Interface, alpha: f64, compensation: bool) -> Self {
        if alpha >= SMOOTH_ALPHA && interface.bends() {
            Self::RoughThinDielectric(RoughThinDielectric::new(interface, alpha, compensation))
        } else {
            Self::ThinDielectric(ThinDielectric {
                interface,
                passable: false,
            })
        }
    }

    /// The same without what goes straight through a smooth pane: where rays pass by themselves, as they pass the holes of
    /// a leaf, that is not scattering but [`passing`](Self::passing). Panes under layers stay as they are.
    #[must_use]
    pub fn passable(self) -> Self {
        match self {
            Self::ThinDielectric(pane) => Self::ThinDielectric(ThinDielectric {
                passable: true,
                ..pane
            }),
            Self::Principled(lobe) => Self::Principled(lobe.passable()),
            other => other,
        }
    }

    /// What of light from `wo` (local, unit) passes a [`passable`](Self::passable) pane unscattered; nothing passes any
    /// other. It and what is scattered sum to 1 at most.
    #[inline]
    pub fn passing(&self, wo: DVec3) -> Passing {
        match self {
            Self::ThinDielectric(pane) => pane.passing(wo),
            Self::Principled(lobe) => lobe.passing(wo),
            _ => Passing::NOTHING,
        }
    }

    /// Smooth coat of index `ior` (usually 1.5) over a diffuse base.
    #[inline]
    pub fn coated(reflectance: Spectrum, ior: f64) -> Self {
        Self::Coated(Coated::new(reflectance, ior))
    }

    /// Diffuse plus normalised Phong lobe, see [`Phong::new`].
    #[inline]
    pub fn phong(diffuse: Spectrum, specular: Spectrum, exponent: f64) -> Self {
        Self::Phong(Phong::new(diffuse, specular, exponent))
    }

    /// Rough diffuse reflection, see [`OrenNayar::new`]; roughness 0 is [`lambertian`](Self::lambertian).
    #[inline]
    pub fn oren_nayar(reflectance: Spectrum, roughness: f64) -> Self {
        if roughness > 0.0 {
            Self::OrenNayar(OrenNayar::new(reflectance, roughness))
        } else {
            Self::lambertian(reflectance)
        }
    }

    /// glTF's material under sheen and clearcoat, or without them if there are none.
    pub fn layered(base: &PrincipledParameters, layers: &LayerParameters) -> Self {
        if layers.is_bare() {
            Self::principled(base)
        } else {
            Self::Layered(Layered::new(base, layers))
        }
    }

    /// Does [`sample`](Lobe::sample) read its `uc`? Where it does not, a walk need not ask for the
    /// number.
    #[inline]
    pub fn has_choice(&self) -> bool {
        !matches!(
            self,
            Self::Lambertian(_) | Self::Mirror(_) | Self::Conductor(_) | Self::OrenNayar(_)
        )
    }

    /// glTF's metallic-roughness material, or the simpler variant that it amounts to: metallic 1
    /// is [`metal`](Self::metal) (at roughness 0 a [`mirror`](Self::mirror) of the base colour),
    /// transmission 1 is glass, and specular 0 is exactly [`lambertian`](Self::lambertian).
    pub fn principled(parameters: &PrincipledParameters) -> Self {
        Principled::simplest(parameters, None)
    }

    /// The same where the finish of that roughness and anisotropy has been made before.
    #[inline]
    pub fn principled_of(parameters: &PrincipledParameters, finish: &Finish) -> Self {
        Principled::simplest(parameters, Some(finish))
    }
}

lobe_of_variants!(
    Bsdf: Lambertian, Mirror, Conductor, RoughConductor, Dielectric, RoughDielectric, ThinDielectric,
    RoughThinDielectric, Coated, Phong, Principled, Layered, OrenNayar
);

#[cfg(test)]
mod tests {
    use super::*;

    /// Each vertex of a path holds one: a variant that is larger than all others makes every one larger.
    #[test]
    fn it_is_as_large_as_its_largest_variant_may_be() {
        assert!(size_of::<Bsdf>() <= 1040, "{}", size_of::<Bsdf>());
    }
}
