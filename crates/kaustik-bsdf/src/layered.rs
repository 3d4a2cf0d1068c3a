use crate::coat::Coat;
use crate::sheen::Sheen;
use crate::{Delta, Lobe, Mode, Principled, PrincipledParameters, Sample, local};
use glam::DVec3;
use kaustik_spectrum::Spectrum;

/// What lies on a glTF material: `KHR_materials_sheen` and, above it, `KHR_materials_clearcoat`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LayerParameters {
    /// `clearcoatFactor`, `[0, 1]`; 0 is none.
    pub clearcoat: f64,
    /// `clearcoatRoughnessFactor`, perceptual, `[0, 1]`.
    pub clearcoat_roughness: f64,
    /// Index of the varnish relative to the outside: 1.5 in air.
    pub clearcoat_ior: f64,
    /// The varnish's own normal (`clearcoatNormalTexture`) in the local frame, unit with z > 0; `None` is that of what
    /// it covers. Such a varnish is at least as rough as 0.05.
    pub clearcoat_normal: Option<DVec3>,
    /// `sheenColorFactor`, lanes in `[0, 1]`; black is none.
    pub sheen_color: Spectrum,
    /// Its largest channel, `[0, 1]`: at every wavelength the fibres take at least as much from what lies below as if
    /// this were their colour.
    pub sheen_shade: f32,
    /// `sheenRoughnessFactor`, perceptual, `[0, 1]`.
    pub sheen_roughness: f64,
}

impl Default for LayerParameters {
    fn default() -> Self {
        Self {
            clearcoat: 0.0,
            clearcoat_roughness: 0.0,
            clearcoat_ior: 1.5,
            clearcoat_normal: None,
            sheen_color: Spectrum::ZERO,
            sheen_shade: 0.0,
            sheen_roughness: 0.0,
        }
    }
}

impl LayerParameters {
    /// Is there nothing on top?
    #[inline]
    pub fn is_bare(&self) -> bool {
        let some = self.clearcoat > 0.0 || self.sheen_color.max() > 0.0;
        !some
    }
}

/// A glTF material under fibres and varnish.
///
/// Each layer takes from what is below it the light that it sends back itself, on the way in and on the way
/// out: reciprocal, and no energy is made, but where the varnish has normals of its own. Light that goes back and forth between layers is estimated from
/// below, so that a white material under varnish is a few per cent grey.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layered {
    /// `None`: it is left out.
    base: Option<Principled>,
    sheen: Option<Sheen>,
    coat: Option<Coat>,
    /// Are sheen and coat there, or are they only in the way of what is below?
    shown: Shown,
}

/// What lies over a glTF material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Layers {
    sheen: Option<Sheen>,
    coat: Option<Coat>,
    shown: Shown,
}

impl Layers {
    /// Over this, or by themselves.
    #[inline]
    pub(crate) fn over(self, base: Option<Principled>) -> Layered {
        let Self { sheen, coat, shown } = self;
        Layered {
            base,
            sheen,
            coat,
            shown,
        }
    }
}

/// Layers that scatter.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Shown {
    sheen: bool,
    coat: bool,
}

impl Layered {
    /// `base` with layers; numbers are brought into their ranges.
    pub fn new(base: &PrincipledParameters, layers: &LayerParameters) -> Self {
        let lane = |x: f32| local::within(f64::from(x), 0.0, 1.0) as f32;
        let colour = layers.sheen_color.map(lane);
        Self {
            base: Some(Principled::new(base)),
            sheen: (colour.max() > 0.0)
                .then(|| Sheen::new(colour, lane(layers.sheen_shade), layers.sheen_roughness)),
            coat: (layers.clearcoat > 0.0).then(|| {
                Coat::new(
                    layers.clearcoat,
                    layers.clearcoat_roughness,
                    layers.clearcoat_ior,
                    layers.clearcoat_normal.filter(|n| n.z > 0.0),
                    base.compensation,
                )
            }),
            shown: Shown {
                sheen: true,
                coat: true,
            },
        }
    }

    /// The layers, and what is below them.
    pub(crate) fn apart(&self) -> (Layers, Option<Principled>) {
        let Self {
            base,
            sheen,
            coat,
            shown,
        } = *self;
        (Layers { sheen, coat, shown }, base)
    }

    /// What is as rough as `threshold` (GGX alpha) or diffuse, and the rest; each `None` if there is nothing.
    pub(crate) fn parts(&self, threshold: f64) -> [Option<Self>; 2] {
        let [wide, narrow] = self.base.map_or([None; 2], |base| base.parts(threshold));
        let wide_coat =
            (self.coat).is_some_and(|coat| !coat.is_smooth() && coat.alpha() >= threshold);
        let part = |base: Option<Principled>, shown: Shown| {
            let part = Self {
                base,
                shown,
                ..*self
            };
            let some =
                base.is_some() || part.shown_sheen().is_some() || part.shown_coat().is_some();
            some.then_some(part)
        };
        let Shown { sheen, coat } = self.shown;
        [
            part(
                wide,
                Shown {
                    sheen,
                    coat: coat && wide_coat,
                },
            ),
            part(
                narrow,
                Shown {
                    sheen: false,
                    coat: coat && !wide_coat,
                },
            ),
        ]
    }

    /// The sheen if it scatters.
    #[inline]
    fn shown_sheen(&self) -> Option<Sheen> {
        self.sheen.filter(|_| self.shown.sheen)
    }

    /// The coat if it scatters.
    #[inline]
    fn shown_coat(&self) -> Option<Coat> {
        self.coat.filter(|_| self.shown.coat)
    }

    /// Probabilities of coat, sheen and base from `wo`, about by albedo; they sum to 1.
    #[inline]
    fn choice(&self, wo: DVec3) -> [f64; 3] {
        let up = local::lift(wo);
        let below = 1.0 - self.coat.map_or(0.0, |coat| f64::from(coat.albedo(up)));
        let coat = if self.shown.coat { 1.0 - below } else { 0.0 };
        let sheen = (self.shown_sheen()).map_or(0.0, |sheen| f64::from(sheen.albedo(up).mean()));
        let passed = self
            .sheen
            .map_or(1.0, |sheen| f64::from(sheen.passed(up).mean()));
        let base = (self.base).map_or(0.0, |base| f64::from(base.albedo(wo).mean())) * passed;
        let albedos = [coat, sheen * below, base * below];
        let sum: f64 = albedos.iter().sum();
        if sum > 0.0 {
            albedos.map(|a| a / sum)
        } else {
            [0.0, 0.0, 1.0]
        }
    }

    /// What the coat leaves for what is below it.
    #[inline]
    fn under_coat(&self, wo: DVec3, wi: DVec3) -> f32 {
        self.coat
            .map_or(1.0, |coat| coat.passed(local::lift(wo), local::lift(wi)))
    }

    /// What coat and sheen leave for the base.
    #[inline]
    fn under_all(&self, wo: DVec3, wi: DVec3) -> Spectrum {
        let sheen = (self.sheen).map_or(Spectrum::ONE, |sheen| {
            sheen.passed(wo).zip(sheen.passed(wi), f32::min)
        });
        sheen * self.under_coat(wo, wi)
    }

    #[inline]
    fn finish(&self, wo: DVec3, wi: DVec3, mode: Mode) -> Option<Sample> {
        if !local::usable(wi) {
            return None;
        }
        let (f, pdf) = self.eval_pdf(wo, wi, mode);
        Some(Sample {
            dispersive: self.dispersive_between(wo, wi),
            ..Sample::continuous(wo, wi, f, pdf)?
        })
    }

    fn sample_coat(&self, wo: DVec3, p: f64, uc: f64, u: [f64; 2], mode: Mode) -> Option<Sample> {
        let coat = self.shown_coat()?;
        let Some(wi) = coat.sample(local::lift(wo), uc, u) else {
            let share = Spectrum::splat(coat.albedo(local::lift(wo)));
            return Sample::delta(wo, local::mirror(wo), share, p);
        };
        if wi.z > 0.0 {
            self.finish(wo, local::to_side_of(wo, wi), mode)
        } else {
            None // met a second facet, which single scattering leaves out
        }
    }
}

impl Lobe for Layered {
    fn eval(&self, wo: DVec3, wi: DVec3, mode: Mode) -> Spectrum {
        if !local::usable(wo) || !local::usable(wi) {
            return Spectrum::ZERO;
        }
        let mut f = match self.base {
            Some(base) => base.eval(wo, wi, mode) * self.under_all(wo, wi),
            None => Spectrum::ZERO,
        };
        if wo.z * wi.z > 0.0 {
            let (up_o, up_i) = (local::lift(wo), local::lift(wi));
            if let Some(sheen) = self.shown_sheen() {
                f += sheen.eval(up_o, up_i) * self.under_coat(wo, wi);
            }
            if let Some(coat) = self.shown_coat() {
                f += coat.eval(up_o, up_i, mode);
            }
        }
        f
    }

    fn pdf(&self, wo: DVec3, wi: DVec3, mode: Mode) -> f64 {
        if !local::usable(wo) || !local::usable(wi) {
            return 0.0;
        }
        let [coat, sheen, base] = self.choice(wo);
        let mut pdf = self.base.map_or(0.0, |lobe| base * lobe.pdf(wo, wi, mode));
        if wo.z * wi.z > 0.0 {
            if self.shown_sheen().is_some() {
                pdf += sheen * Sheen::PDF;
            }
            if let Some(lobe) = self.shown_coat() {
                pdf += coat * lobe.pdf(local::lift(wo), local::lift(wi));
            }
        }
        pdf
    }

    fn sample(&self, wo: DVec3, uc: f64, u: [f64; 2], mode: Mode) -> Option<Sample> {
        if !local::usable(wo) {
            return None;
        }
        let [coat, sheen, base] = self.choice(wo);
        let (take, uc) = local::choose(uc, coat);
        if take {
            return self.sample_coat(wo, coat, uc, u, mode);
        }
        let rest = sheen + base;
        let (take, uc) = local::choose(uc, if rest > 0.0 { sheen / rest } else { 0.0 });
        if take {
            return self.finish(wo, local::to_side_of(wo, Sheen::sample(u)), mode);
        }
        let sample = self.base?.sample(wo, uc, u, mode)?;
        if !sample.delta {
            return self.finish(wo, sample.wi, mode);
        }
        let passed = self.under_all(wo, sample.wi);
        Some(Sample {
            weight: sample.weight * passed / base as f32,
            pdf: sample.pdf * base,
            ..sample
        })
    }

    fn delta(&self, wo: DVec3, transmitted: bool, mode: Mode) -> Option<Delta> {
        if !local::usable(wo) {
            return None;
        }
        let [coat, _, base] = self.choice(wo);
        let below = (self.base).and_then(|lobe| lobe.delta(wo, transmitted, mode));
        let below = below.map(|delta| Delta {
            share: delta.share * self.under_all(wo, delta.wi),
            probability: delta.probability * base,
            ..delta
        });
        let smooth = self.shown_coat().is_some_and(|coat| coat.is_smooth());
        if transmitted || !smooth {
            return below;
        }
        match self.sample_coat(wo, coat, 0.0, [0.0; 2], mode) {
            Some(sample) => Some(Delta::of(&sample).and(below)),
            None => below,
        }
    }

    fn albedo(&self, wo: DVec3) -> Spectrum {
        let up = local::lift(wo);
        let coat = self.shown_coat().map_or(0.0, |coat| coat.albedo(up));
        let (sheen, passed) = self.sheen.map_or((Spectrum::ZERO, Spectrum::ONE), |sheen| {
            // the rest passes on the way out too, at any angle
            let out = sheen.passed(DVec3::new(0.8, 0.0, 0.6));
            (sheen.albedo(up), sheen.passed(up).zip(out, f32::min))
        });
        let sheen = if self.shown.sheen {
            sheen
        } else {
            Spectrum::ZERO
        };
        let (base, mirrored) = self.base.map_or((Spectrum::ZERO, 0.0), |base| {
            (base.albedo(wo) * passed, base.mirrored(wo) as f32)
        });
        let below = sheen + base;
        // what leaves by a coat passes it once more: a mirror's light at the same angle, other light at any
        let out = |wi: DVec3| self.under_coat(wo, wi);
        let again = match self.coat {
            None => 1.0,
            Some(_) => mirrored * out(up) + (1.0 - mirrored) * out(DVec3::new(0.8, 0.0, 0.6)),
        };
        Spectrum::splat(coat) + below * again
    }

    fn is_delta(&self) -> bool {
        let smooth = self.shown_coat().is_none_or(|coat| coat.is_smooth());
        let base = self.base.is_none_or(|base| base.is_delta());
        smooth && self.shown_sheen().is_none() && base
    }

    fn dispersive_between(&self, wo: DVec3, wi: DVec3) -> bool {
        self.base
            .is_some_and(|base| base.dispersive_between(wo, wi))
    }

    #[inline]
    fn transmits(&self) -> bool {
        self.base.is_some_and(|base| base.transmits())
    }
}
