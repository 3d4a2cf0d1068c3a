use crate::local::within;
use crate::{fresnel, warp};
use kaustik_spectrum::Spectrum;

/// The thickest film, in nanometres: thicker ones show no colours.
const MOST_NM: f64 = 1e5;

/// Interference in a thin transparent film over a surface (`KHR_materials_iridescence`): soap, oil, anodised
/// metal.
///
/// At each wavelength the exact sum over all reflections within the film (Airy), for unpolarised light. What lies
/// beneath is taken as a dielectric that reflects the given colour at normal incidence, as the extension has it; no
/// phase is added by its extinction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThinFilm {
    /// Share of the surface that has the film, in `[0, 1]`.
    strength: f32,
    /// Index of the film relative to the outside.
    index: f32,
    /// Twice the film's optical thickness in wavelengths at normal incidence, each lane.
    turns: Spectrum,
    /// What is beneath: of a mixture both parts, as they do not reflect as one.
    beneath: [Beneath; 2],
}

/// A part of the surface without its film, weighted by its share.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Beneath {
    /// Reflected at normal incidence.
    f0: Spectrum,
    /// The same at grazing, in all lanes; 0 where there is none.
    f90: f32,
}

impl ThinFilm {
    /// From `strength` in `[0, 1]`, the film's `index` relative to the outside, its `thickness` in nanometres (100,000 at most), the
    /// path's `wavelengths` outside in nanometres, and what the surface without it reflects at normal incidence and at
    /// grazing, `f0` at most `f90`.
    pub fn new(
        strength: f64,
        index: f64,
        thickness: f64,
        wavelengths: Spectrum,
        (f0, f90): (Spectrum, f32),
    ) -> Self {
        let index = if index > 0.0 && index.is_finite() {
            index
        } else {
            1.0
        };
        let path = 2.0 * index * within(thickness, 0.0, MOST_NM);
        Self {
            strength: within(strength, 0.0, 1.0) as f32,
            index: index as f32,
            turns: wavelengths.map(|nm| {
                if nm > 0.0 {
                    (path / f64::from(nm)) as f32
                } else {
                    0.0
                }
            }),
            beneath: [Beneath { f0, f90 }, Beneath::default()],
        }
    }

    /// The same over a mixture, of which this is the second part's share at normal incidence and at grazing.
    pub(crate) fn and(mut self, (f0, f90): (Spectrum, f32)) -> Self {
        self.beneath[1] = Beneath { f0, f90 };
        self
    }

    /// Share reflected at an angle of incidence of the given cosine in `[0, 1]`.
    pub fn at(&self, cosine: f64) -> Spectrum {
        self.at_rise(
            cosine,
            Spectrum::splat(fresnel::schlick_weight(cosine) as f32),
        )
    }

    /// The same where what has no film rises by `rise` from normal incidence, 0, to grazing, 1.
    pub(crate) fn at_rise(&self, cosine: f64, rise: Spectrum) -> Spectrum {
        let parts = self.beneath.iter().filter(|part| part.f90 > 0.0);
        let of_part = |part: &Beneath| {
            let plain = (part.f0).zip(rise, |f0, rise| f0 + (part.f90 - f0) * rise);
            let films =
                (self.turns).zip(part.f0, |turns, f0| self.airy(cosine, turns, f0 / part.f90));
            plain.lerp(films * part.f90, self.strength)
        };
        parts.map(of_part).sum()
    }

    /// Reflectance of the whole stack at one wavelength, over a base that reflects `f0` at normal incidence
    /// and everything at grazing incidence.
    fn airy(&self, cosine: f64, turns: f32, f0: f32) -> f32 {
        let film = f64::from(self.index);
        let root = f64::from(f0).sqrt().clamp(0.0, 0.9999);
        let beneath = (1.0 + root) / (1.0 - root); // its index relative to the outside
        let sine2 = (1.0 - cosine * cosine).max(0.0);
        let inside = |index: f64| 1.0 - sine2 / (index * index);
        let (within, below) = (inside(film), inside(beneath));
        if within <= 0.0 {
            return 1.0; // total reflection, as nothing is left to tunnel to
        }
        let (within, below) = (within.sqrt(), below.max(0.0).sqrt());
        let (_, cos) = warp::sin_cos_turns(f64::from(turns) * within);
        let amplitude = |a: f64, b: f64| if a + b > 0.0 { (a - b) / (a + b) } else { 1.0 };
        let stack = |upper: f64, lower: f64| {
            let (u2, l2, both) = (upper * upper, lower * lower, 2.0 * upper * lower * cos);
            (u2 + l2 + both) / (1.0 + u2 * l2 + both)
        };
        let s = stack(
            amplitude(cosine, film * within),
            amplitude(film * within, beneath * below),
        );
        let p = stack(
            amplitude(film * cosine, within),
            amplitude(beneath * within, film * below),
        );
        let mean = 0.5 * (s + p);
        if mean.is_finite() {
            mean.clamp(0.0, 1.0) as f32
        } else {
            1.0
        }
    }
}
