use crate::{Delta, Mode, Sample};
use glam::DVec3;
use kaustik_spectrum::Spectrum;

/// What every scattering function does. All laws are tested once, over this trait.
///
/// Directions are unit vectors of the local frame (z = shading normal), away from the surface.
/// `wo` points to where the walk came from, `wi` to where it goes. Input that means nothing
/// (horizontal, not finite) gives zero or `None`, never a panic.
///
/// Laws, for all `wo`, `wi` (a varnish with normals of its own keeps the first and the last alone):
/// * `eval(wo, wi, Importance) == eval(wi, wo, Radiance)`;
/// * with `n(w)` the index on the side of `w`: `eval(wo, wi, Radiance) / n(wo)^2` is symmetric;
/// * the integral of `eval(wo, wi, Importance) |cos wi|` over `wi` plus the delta shares is at
///   most 1 (scattering makes no energy);
/// * `sample` draws from `pdf`, and `weight * pdf == eval * |cos wi|`.
pub trait Lobe {
    /// The scattering function without the cosine; zero for delta parts. Per steradian.
    fn eval(&self, wo: DVec3, wi: DVec3, mode: Mode) -> Spectrum;

    /// Density per solid angle with which `sample` draws `wi` from its continuous parts, lobe
    /// choice included. It does not integrate to 1 where delta parts or absorption take a share.
    fn pdf(&self, wo: DVec3, wi: DVec3, mode: Mode) -> f64;

    /// [`eval`](Self::eval) and [`pdf`](Self::pdf) at once: what a connection to an emitter asks for.
    #[inline]
    fn eval_pdf(&self, wo: DVec3, wi: DVec3, mode: Mode) -> (Spectrum, f64) {
        (self.eval(wo, wi, mode), self.pdf(wo, wi, mode))
    }

    /// The same with the density of `wo` from `wi` beside that of `wi` from `wo`: what a join asks for. Where the value is zero nothing is
    /// joined, and the densities mean nothing.
    #[inline]
    fn eval_pdfs(&self, wo: DVec3, wi: DVec3, mode: Mode) -> (Spectrum, [f64; 2]) {
        let (f, pdf) = self.eval_pdf(wo, wi, mode);
        let back = match f.is_zero() {
            true => 0.0,
            false => self.pdf(wi, wo, mode.reversed()),
        };
        (f, [pdf, back])
    }

    /// Draws `wi`. `uc` chooses the lobe, `u` the direction; all in `[0, 1)`. `None`: absorbed.
    fn sample(&self, wo: DVec3, uc: f64, u: [f64; 2], mode: Mode) -> Option<Sample>;

    /// All that scatters from `wo` into one Dirac direction: by reflection, or through the surface if
    /// `transmitted`. `None` where there is no such part.
    ///
    /// What a walk draws with [`sample`](Self::sample) at its chance, asked for by name: a path that
    /// is traced again must pass each smooth surface as it did before.
    fn delta(&self, _wo: DVec3, _transmitted: bool, _mode: Mode) -> Option<Delta> {
        None
    }

    /// Directional albedo: the share of light that leaves again when it arrives from `wo`. Exact
    /// for lossless lobes, an estimate within a few per cent for the others; for the albedo
    /// layer and for guessing importance, not for transport.
    fn albedo(&self, wo: DVec3) -> Spectrum;

    /// Does this scatter into delta directions only? Then `eval` is always zero, and a
    /// connection to this vertex is in vain.
    fn is_delta(&self) -> bool {
        false
    }

    /// May light be scattered to the other side? (What passes a [`passable`](crate::Bsdf::passable) pane is not scattered.) If not, `eval` is zero for directions on different sides, and
    /// `sample` stays on its own.
    fn transmits(&self) -> bool {
        true
    }

    /// Can a connection or a light be joined here (has a continuous part)?
    fn is_connectable(&self) -> bool {
        !self.is_delta()
    }

    /// Does going from `wo` to `wi` refract where the index depends on the wavelength? Then
    /// only the hero lane of `eval` means anything.
    fn dispersive_between(&self, _wo: DVec3, _wi: DVec3) -> bool {
        false
    }
}

/// Makes an enum whose every variant holds one [`Lobe`] a lobe itself: whatever is asked of it, the variant answers.
macro_rules! lobe_of_variants {
    ($name:ident: $($variant:ident),+ $(,)?) => {
        impl Lobe for $name {
            #[inline]
            fn eval(&self, wo: DVec3, wi: DVec3, mode: Mode) -> Spectrum {
                match self {
                    $(Self::$variant(lobe) => lobe.eval(wo, wi, mode),)+
                }
            }

            #[inline]
            fn pdf(&self, wo: DVec3, wi: DVec3, mode: Mode) -> f64 {
                match self {
                    $(Self::$variant(lobe) => lobe.pdf(wo, wi, mode),)+
                }
            }

            #[inline]
            fn eval_pdf(&self, wo: DVec3, wi: DVec3, mode: Mode) -> (Spectrum, f64) {
                match self {
                    $(Self::$variant(lobe) => lobe.eval_pdf(wo, wi, mode),)+
                }
            }

            #[inline]
            fn eval_pdfs(&self, wo: DVec3, wi: DVec3, mode: Mode) -> (Spectrum, [f64; 2]) {
                match self {
                    $(Self::$variant(lobe) => lobe.eval_pdfs(wo, wi, mode),)+
                }
            }

            #[inline]
            fn sample(&self, wo: DVec3, uc: f64, u: [f64; 2], mode: Mode) -> Option<Sample> {
                match self {
                    $(Self::$variant(lobe) => lobe.sample(wo, uc, u, mode),)+
                }
            }

            #[inline]
            fn delta(&self, wo: DVec3, transmitted: bool, mode: Mode) -> Option<Delta> {
                match self {
                    $(Self::$variant(lobe) => lobe.delta(wo, transmitted, mode),)+
                }
            }

            #[inline]
            fn albedo(&self, wo: DVec3) -> Spectrum {
                match self {
                    $(Self::$variant(lobe) => lobe.albedo(wo),)+
                }
            }

            #[inline]
            fn is_delta(&self) -> bool {
                match self {
                    $(Self::$variant(lobe) => lobe.is_delta(),)+
                }
            }

            #[inline]
            fn transmits(&self) -> bool {
                match self {
                    $(Self::$variant(lobe) => lobe.transmits(),)+
                }
            }

            #[inline]
            fn is_connectable(&self) -> bool {
                match self {
                    $(Self::$variant(lobe) => lobe.is_connectable(),)+
                }
            }

            #[inline]
            fn dispersive_between(&self, wo: DVec3, wi: DVec3) -> bool {
                match self {
                    $(Self::$variant(lobe) => lobe.dispersive_between(wo, wi),)+
                }
            }
        }
    };
}

pub(crate) use lobe_of_variants;
