//! A surface in two parts: what scatters widely, and what mirrors or nearly does.

use kaustik_spectrum::Spectrum;

use crate::{Bsdf, Phong};

/// A scattering function as the sum of two, split by a threshold of roughness.
///
/// Photon maps estimate the light that a *wide* part scatters; light that a *narrow* part sends to the eye must
/// be followed further, because hardly any photon arrives from where it looks. Diffuse parts are always wide
/// and Dirac parts always narrow. The two parts' continuous values sum to the whole's; so do their Dirac shares, but
/// only [`narrow`](Self::narrow) is to be asked for those.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parts {
    /// Lobes whose roughness reaches the threshold: to be evaluated, never to be sampled from (a varnished surface
    /// is here with its varnish, whose value is zero).
    pub wide: Option<Bsdf>,
    /// All others.
    pub narrow: Option<Bsdf>,
}

impl Parts {
    const fn all_wide(bsdf: Bsdf) -> Self {
        Self {
            wide: Some(bsdf),
            narrow: None,
        }
    }

    const fn all_narrow(bsdf: Bsdf) -> Self {
        Self {
            wide: None,
            narrow: Some(bsdf),
        }
    }

    const fn one(bsdf: Bsdf, wide: bool) -> Self {
        if wide {
            Self::all_wide(bsdf)
        } else {
            Self::all_narrow(bsdf)
        }
    }
}

impl Bsdf {
    /// The two parts. `threshold` is a GGX roughness `alpha` in `[0, 1]`; a Phong lobe of exponent `n` has that of
    /// the same width, `sqrt(2 / (n + 2))`. With 0 everything is wide that is not Dirac.
    pub fn parts(&self, threshold: f64) -> Parts {
        match self {
            Self::Lambertian(_) | Self::OrenNayar(_) => Parts::all_wide(*self),
            Self::Mirror(_)
            | Self::Conductor(_)
            | Self::Dielectric(_)
            | Self::ThinDielectric(_) => Parts::all_narrow(*self),
            Self::RoughConductor(lobe) => Parts::one(*self, lobe.alpha() >= threshold),
            Self::RoughDielectric(lobe) => Parts::one(*self, lobe.alpha() >= threshold),
            Self::RoughThinDielectric(lobe) => Parts::one(*self, lobe.alpha() >= threshold),
            Self::Coated(lobe) => Parts {
                wide: Some(*self),
                narrow: Some(Self::Conductor(lobe.varnish())),
            },
            Self::Phong(lobe) => phong(lobe, threshold),
            Self::Layered(lobe) => {
                let [wide, narrow] = lobe.parts(threshold);
                Parts {
                    wide: wide.map(Self::Layered),
                    narrow: narrow.map(Self::Layered),
                }
            }
            Self::Principled(lobe) => {
                let [wide, narrow] = lobe.parts(threshold);
                Parts {
                    wide: wide.map(Self::Principled),
                    narrow: narrow.map(Self::Principled),
                }
            }
        }
    }
}

fn phong(lobe: &Phong, threshold: f64) -> Parts {
    if lobe.alpha() >= threshold {
        return Parts::all_wide(Bsdf::Phong(*lobe));
    }
    let lit = |colour: Spectrum, part: Phong| (!colour.is_zero()).then_some(Bsdf::Phong(part));
    let (diffuse, specular) = lobe.colours();
    Parts {
        wide: lit(diffuse, lobe.with_colours(diffuse, Spectrum::ZERO)),
        narrow: lit(specular, lobe.with_colours(Spectrum::ZERO, specular)),
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::{Interface, LayerParameters, Lobe, Mode, PrincipledParameters, Reflectance, Wall};

    fn grey(value: f32) -> Spectrum {
        Spectrum::new([value, value * 0.8, value * 0.6, value * 0.9])
    }

    fn glass() -> Interface {
        Interface::new(Spectrum::splat(1.5), Spectrum::ONE, Spectrum::ONE)
    }

    /// One of each kind, smooth and rough.
    fn kinds() -> Vec<Bsdf> {
        let mut kinds = vec![
            Bsdf::lambertian(grey(0.7)),
            Bsdf::mirror(grey(0.9)),
            Bsdf::coated(grey(0.6), 1.5),
        ];
        for alpha in [0.0, 0.1, 0.6] {
            let metal = Reflectance::Schlick {
                f0: grey(0.8),
                f90: Spectrum::ONE,
            };
            kinds.push(Bsdf::reflector(metal, alpha, true));
            kinds.push(Bsdf::dielectric(glass(), alpha, true));
            kinds.push(Bsdf::thin_dielectric(glass(), alpha, true));
            for (metallic, transmission) in [(0.0, 0.0), (0.5, 0.0), (0.0, 0.5), (0.3, 0.3)] {
                for wall in [Wall::Thin, Wall::Solid] {
                    kinds.push(Bsdf::principled(&PrincipledParameters {
                        base_color: grey(0.6),
                        metallic,
                        roughness: f64::sqrt(alpha),
                        transmission,
                        wall,
                        ..PrincipledParameters::default()
                    }));
                }
            }
        }
        kinds.push(Bsdf::oren_nayar(grey(0.7), 0.5));
        for (roughness, clearcoat_roughness) in [(0.0, 0.0), (0.3, 0.0), (0.8, 0.3), (0.3, 0.8)] {
            for metallic in [0.0, 1.0] {
                let base = PrincipledParameters {
                    base_color: grey(0.6),
                    metallic,
                    roughness,
                    ..PrincipledParameters::default()
                };
                let coat = LayerParameters {
                    clearcoat: 0.8,
                    clearcoat_roughness,
                    ..LayerParameters::default()
                };
                let sheen = LayerParameters {
                    sheen_color: grey(0.7),
                    sheen_roughness: 0.4,
                    ..coat
                };
                kinds.push(Bsdf::layered(&base, &coat));
                kinds.push(Bsdf::layered(&base, &sheen));
            }
        }
        for exponent in [5.0, 200.0] {
            kinds.push(Bsdf::phong(grey(0.4), grey(0.5), exponent));
            kinds.push(Bsdf::phong(Spectrum::ZERO, grey(0.5), exponent));
        }
        kinds
    }

    fn directions() -> Vec<DVec3> {
        let mut all = Vec::new();
        for z in [-0.9, -0.3, 0.2, 0.7, 0.95] {
            for angle in [0.3, 2.0, 4.4] {
                let r = f64::sqrt(1.0 - z * z);
                all.push(DVec3::new(r * f64::cos(angle), r * f64::sin(angle), z));
            }
        }
        all
    }

    /// The parts' sum is the whole, in continuous values and in Dirac shares.
    #[test]
    fn parts_sum_to_the_whole() {
        let near = |a: Spectrum, b: Spectrum| {
            let scale = a.max().abs().max(1e-3);
            (a - b).map(f32::abs).max() <= 2e-5 * scale
        };
        for bsdf in kinds() {
            for threshold in [0.0, 0.39, 1.0] {
                let Parts { wide, narrow } = bsdf.parts(threshold);
                assert!(wide.is_some() || narrow.is_some(), "{bsdf:?}");
                for wo in directions() {
                    for mode in [Mode::Radiance, Mode::Importance] {
                        for wi in directions() {
                            let value = |part: Option<Bsdf>| part.map(|p| p.eval(wo, wi, mode));
                            let sum = value(wide).unwrap_or(Spectrum::ZERO)
                                + value(narrow).unwrap_or(Spectrum::ZERO);
                            let whole = bsdf.eval(wo, wi, mode);
                            assert!(near(whole, sum), "{bsdf:?} {wo} {wi}: {whole:?} {sum:?}");
                        }
                        for transmitted in [false, true] {
                            let share = |b: &Bsdf| b.delta(wo, transmitted, mode).map(|d| d.share);
                            let whole = share(&bsdf).unwrap_or(Spectrum::ZERO);
                            let part = narrow.as_ref().and_then(share);
                            let part = part.unwrap_or(Spectrum::ZERO);
                            assert!(near(whole, part), "{bsdf:?} {wo}: {whole:?} {part:?}");
                        }
                    }
                }
            }
        }
    }

    /// The threshold decides; Dirac parts are narrow under any.
    #[test]
    fn roughness_decides() {
        let rough = Bsdf::conductor(grey(0.2), grey(3.0), 0.3, true);
        assert!(rough.parts(0.3).narrow.is_none() && rough.parts(0.31).wide.is_none());
        let phong = Bsdf::phong(grey(0.4), grey(0.5), 30.0); // as wide as alpha 1/4
        assert!(phong.parts(0.25).narrow.is_none());
        let Parts { wide, narrow } = phong.parts(0.26);
        assert!(wide.is_some() && narrow.is_some());
        assert!(Bsdf::mirror(grey(0.5)).parts(0.0).wide.is_none());
    }
}
