mod body;
mod clear;
mod parameters;
mod parts;
mod store;

pub use parameters::{FilmParameters, PrincipledParameters, Wall};
pub(crate) use store::{PrincipledPieces, PrincipledStore};

use crate::facets::{Facets, Facing, rebound_colour};
use crate::ggx::FacetLoss;
use crate::{Bsdf, Delta, Finish, Lobe, Mode, Passing, Reflectance, Sample, local, warp};
use body::Body;
use clear::Clear;
use glam::DVec3;
use kaustik_spectrum::Spectrum;

/// glTF's metallic-roughness material with specular, ior, transmission and volume.
///
/// Linear in `metallic` and `transmission`:
/// * the metal share reflects by Schlick from the base colour to white;
/// * the dielectric's diffuse share is a glossy cover over a diffuse body. With `A` the cover's
///   directional albedo the body is `base (1 - A(wo)) (1 - A(wi)) / (pi (1 - A_mean))`
///   (Kelemen and Szirmay-Kalos 2001): reciprocal, and a white body loses nothing. A share of it may leave on the
///   other side in a colour of its own (`KHR_materials_diffuse_transmission`), by the same formula;
/// * the dielectric's clear share is a pane or the boundary of a solid, with the exact Fresnel of
///   its index, stretched between the ends that specular factor and colour give, or under the film. Base colour
///   multiplies what is transmitted, once an interface.
///
/// Lobes are chosen in proportion to their estimated albedos from `wo`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Principled {
    /// Metal and cover together: reflection is linear in F0 and F90; a film has both apart.
    glossy: Glossy,
    /// The cover alone, and the diffuse body beneath it.
    body: Body,
    clear: Option<Clear>,
}

/// Reflection off the outer surface.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Glossy {
    None,
    Smooth(Reflectance),
    Rough(Facets),
}

impl Principled {
    /// From glTF's numbers, brought into range.
    pub fn new(parameters: &PrincipledParameters) -> Self {
        let p = parameters.in_range();
        Self::within(&p, &Finish::of(&p))
    }

    /// The function of these numbers, or the one simpler function that they amount to. `finish` is that of their roughness and anisotropy,
    /// if it is there already.
    pub(crate) fn simplest(parameters: &PrincipledParameters, finish: Option<&Finish>) -> Bsdf {
        let p = parameters.in_range();
        Self::simplified(&p).unwrap_or_else(|| {
            Bsdf::Principled(match finish {
                Some(finish) => Self::within(&p, finish),
                None => Self::within(&p, &Finish::of(&p)),
            })
        })
    }

    /// From numbers that are in range.
    fn within(p: &PrincipledParameters, finish: &Finish) -> Self {
        let metal = p.metallic as f32;
        let opaque = ((1.0 - p.metallic) * (1.0 - p.transmission)) as f32;
        let body = Body::new(p, finish, opaque);
        let (f0, f90) = p.dielectric_ends();
        let reflectance = p.mixed(
            (p.base_color * metal, Spectrum::splat(metal)),
            (f0 * opaque, f90 * opaque),
        );
        let glossy = if reflectance.mean().is_zero() {
            Glossy::None
        } else if let Some(grain) = &finish.grain {
            let rebound = metal_rebound(p, grain.mean_loss) * metal + body.rebound() * opaque;
            Glossy::Rough(Facets::new(reflectance, grain, rebound))
        } else {
            Glossy::Smooth(reflectance)
        };
        let clear = (1.0 - p.metallic) * p.transmission;
        let clear = (clear > 0.0).then(|| Clear::new(p, clear as f32));
        Self {
            glossy,
            body,
            clear,
        }
    }

    /// The one simpler function that numbers in range stand for, if it is one: pure metal, pure glass, pure diffuse.
    fn simplified(p: &PrincipledParameters) -> Option<Bsdf> {
        if p.film.is_some() || p.facets().is_some() && p.anisotropy > 0.0 {
            return None;
        }
        if p.metallic >= 1.0 {
            let base = p.base_color;
            return Some(match p.alpha() > 0.0 {
                true => Bsdf::metal(base, Spectrum::ONE, p.alpha(), p.compensation),
                false => Bsdf::mirror(base),
            });
        }
        if p.metallic > 0.0 {
            return None;
        }
        if p.transmission >= 1.0 {
            return Some(Clear::new(p, 1.0).bsdf());
        }
        let plain = p.transmission.max(p.specular).max(p.diffuse_transmission) <= 0.0;
        plain.then(|| Bsdf::lambertian(p.base_color))
    }

    /// The same with a [passable](crate::ThinDielectric::passable) pane, if it has a smooth one.
    pub(crate) fn passable(self) -> Self {
        Self {
            clear: self.clear.map(Clear::passable),
            ..self
        }
    }

    /// What [passes](crate::ThinDielectric::passing).
    #[inline]
    pub(crate) fn passing(&self, wo: DVec3) -> Passing {
        self.clear
            .map_or(Passing::NOTHING, |clear| clear.passing(wo))
    }

    /// What the surface does to light from `w`.
    #[inline]
    fn view(&self, w: DVec3) -> View {
        let above = DVec3 {
            z: w.z.abs().min(1.0),
            ..w
        };
        // What reflects and what covers the body are the same facets.
        let at = (self.body.ggx()).map_or(FacetLoss::NONE, |ggx| ggx.loss(above));
        let admitted = match self.body.is_black() {
            true => Spectrum::ZERO,
            false => self.body.admitted(above, at),
        };
        View {
            facing: Facing { w: above, at },
            admitted,
        }
    }

    /// Probabilities of glossy, diffuse and clear from `wo`; they sum to 1 unless all is black.
    #[inline]
    fn choice(&self, wo: DVec3, o: &View) -> [f64; 3] {
        let albedos = [
            f64::from(self.glossy_albedo(o).mean()),
            f64::from((self.body.scattered() * o.admitted).mean()),
            self.clear
                .map_or(0.0, |clear| f64::from(clear.albedo(wo).mean())),
        ];
        let sum: f64 = albedos.iter().sum();
        if sum > 0.0 {
            albedos.map(|a| a / sum)
        } else {
            [0.0, 1.0, 0.0]
        }
    }

    /// Share of what it sends back that goes about where a mirror would send it, in `[0, 1]`.
    pub(crate) fn mirrored(&self, wo: DVec3) -> f64 {
        let sharp = match &self.glossy {
            Glossy::None => 0.0,
            Glossy::Smooth(_) => 1.0,
            Glossy::Rough(facets) => 1.0 - facets.alpha(),
        };
        self.outlook(wo).choice[GLOSSY] * sharp
    }

    #[inline]
    fn glossy_albedo(&self, o: &View) -> Spectrum {
        match &self.glossy {
            Glossy::None => Spectrum::ZERO,
            Glossy::Smooth(reflectance) => reflectance.at(o.facing.w.z),
            Glossy::Rough(facets) => facets.albedo_facing(&o.facing),
        }
    }

    /// All that is asked of the direction that a walk comes from.
    #[inline]
    fn outlook(&self, w: DVec3) -> Outlook {
        let view = self.view(w);
        Outlook {
            w,
            choice: self.choice(w, &view),
            view,
        }
    }

    /// Value and density of all continuous lobes together.
    #[inline]
    fn both(&self, o: &Outlook, wi: DVec3, mode: Mode) -> (Spectrum, f64) {
        let [glossy, diffuse, clear] = o.choice;
        let (mut f, mut pdf) = (self.clear).map_or((Spectrum::ZERO, 0.0), |lobe| {
            let (f, pdf) = lobe.eval_pdf(o.w, wi, mode);
            (f, clear * pdf)
        });
        let across = across(o.w, wi);
        if !across || self.body.lets_through() {
            let i = self.view(wi);
            if let (false, Glossy::Rough(facets)) = (across, &self.glossy) {
                let (once, density) = facets.both(&o.view.facing, &i.facing);
                f += once;
                pdf += glossy * density;
            }
            f += self.body.eval((o.view.admitted, i.admitted), across);
            pdf += diffuse * self.body.pdf(wi.z, across);
        }
        (f, pdf)
    }

    /// The same with the density of the way back.
    #[inline]
    fn both_ways(&self, o: &Outlook, i: &Outlook, mode: Mode) -> (Spectrum, [f64; 2]) {
        let (mut f, mut pdf, mut back) = (Spectrum::ZERO, 0.0, 0.0);
        if let Some(lobe) = self.clear {
            (f, pdf) = lobe.eval_pdf(o.w, i.w, mode);
            pdf *= o.choice[CLEAR];
            back = i.choice[CLEAR] * lobe.pdf(i.w, o.w, mode.reversed());
        }
        let across = across(o.w, i.w);
        if let (false, Glossy::Rough(facets)) = (across, &self.glossy) {
            let (once, [there, here]) = facets.both_ways(&o.view.facing, &i.view.facing);
            f += once;
            pdf += o.choice[GLOSSY] * there;
            back += i.choice[GLOSSY] * here;
        }
        f += self.body.eval((o.view.admitted, i.view.admitted), across);
        pdf += o.choice[DIFFUSE] * self.body.pdf(i.w.z, across);
        back += i.choice[DIFFUSE] * self.body.pdf(o.w.z, across);
        (f, [pdf, back])
    }

    /// A sample of all continuous lobes together, drawn by one of them.
    #[inline]
    fn finish(&self, o: &Outlook, wi: DVec3, mode: Mode) -> Option<Sample> {
        if !local::usable(wi) {
            return None;
        }
        let (f, pdf) = self.both(o, wi, mode);
        let dispersive = self.dispersive_between(o.w, wi);
        Some(Sample {
            dispersive,
            ..Sample::continuous(o.w, wi, f, pdf)?
        })
    }

    /// The glossy lobe, if it is the one that is drawn.
    #[inline]
    fn sample_glossy(&self, o: &Outlook, uc: f64, u: [f64; 2], mode: Mode) -> Option<Sample> {
        let facing = &o.view.facing;
        match &self.glossy {
            Glossy::None => None,
            Glossy::Smooth(reflectance) => {
                let share = reflectance.at(facing.w.z);
                Sample::delta(o.w, local::mirror(o.w), share, o.choice[GLOSSY])
            }
            Glossy::Rough(facets) => {
                let wi = facets.sample(facing, uc, u);
                if wi.z > 0.0 {
                    self.finish(o, local::to_side_of(o.w, wi), mode)
                } else {
                    None
                }
            }
        }
    }
}

/// What the surface does to light from one direction: looked up once, for all lobes.
#[derive(Clone, Copy, Debug)]
struct View {
    /// The direction, above the surface.
    facing: Facing,
    /// What the cover lets in to the body.
    admitted: Spectrum,
}

/// A direction that a walk comes from, with the [probabilities](Principled::choice) of the lobes from there.
#[derive(Clone, Copy, Debug)]
struct Outlook {
    w: DVec3,
    view: View,
    choice: [f64; 3],
}

/// Of the lobes in [`Principled::choice`].
const GLOSSY: usize = 0;
const DIFFUSE: usize = 1;
const CLEAR: usize = 2;

/// Does the surface lie between two directions?
#[inline]
fn across(wo: DVec3, wi: DVec3) -> bool {
    wo.z * wi.z < 0.0
}

/// Colour of light rebounding between the metal's facets.
fn metal_rebound(p: &PrincipledParameters, mean_loss: FacetLoss) -> Spectrum {
    if !p.compensation {
        return Spectrum::ZERO;
    }
    let metal = p.reflectance(p.base_color, Spectrum::ONE);
    rebound_colour(metal.mean(), mean_loss.loss)
}

impl Lobe for Principled {
    #[inline]
    fn eval(&self, wo: DVec3, wi: DVec3, mode: Mode) -> Spectrum {
        if !local::usable(wo) || !local::usable(wi) {
            return Spectrum::ZERO;
        }
        let mut f = self
            .clear
            .map_or(Spectrum::ZERO, |clear| clear.eval(wo, wi, mode));
        let across = across(wo, wi);
        if !across || self.body.lets_through() {
            let (o, i) = (self.view(wo), self.view(wi));
            if let (false, Glossy::Rough(facets)) = (across, &self.glossy) {
                f += facets.eval(&o.facing, &i.facing);
            }
            f += self.body.eval((o.admitted, i.admitted), across);
        }
        f
    }

    #[inline]
    fn pdf(&self, wo: DVec3, wi: DVec3, mode: Mode) -> f64 {
        if !local::usable(wo) || !local::usable(wi) {
            return 0.0;
        }
        let o = self.outlook(wo);
        let [glossy, diffuse, clear] = o.choice;
        let mut pdf = self
            .clear
            .map_or(0.0, |lobe| clear * lobe.pdf(wo, wi, mode));
        let across = across(wo, wi);
        if let (false, Glossy::Rough(facets)) = (across, &self.glossy) {
            pdf += glossy * facets.pdf(&o.view.facing, local::lift(wi));
        }
        pdf + diffuse * self.body.pdf(wi.z, across)
    }

    #[inline]
    fn eval_pdf(&self, wo: DVec3, wi: DVec3, mode: Mode) -> (Spectrum, f64) {
        if !local::usable(wo) || !local::usable(wi) {
            return (Spectrum::ZERO, 0.0);
        }
        self.both(&self.outlook(wo), wi, mode)
    }

    #[inline]
    fn eval_pdfs(&self, wo: DVec3, wi: DVec3, mode: Mode) -> (Spectrum, [f64; 2]) {
        if !local::usable(wo) || !local::usable(wi) {
            return (Spectrum::ZERO, [0.0; 2]);
        }
        self.both_ways(&self.outlook(wo), &self.outlook(wi), mode)
    }

    fn sample(&self, wo: DVec3, uc: f64, u: [f64; 2], mode: Mode) -> Option<Sample> {
        if !local::usable(wo) {
            return None;
        }
        let o = self.outlook(wo);
        let [glossy, diffuse, clear] = o.choice;
        let (take, uc) = local::choose(uc, glossy);
        if take {
            return self.sample_glossy(&o, uc, u, mode);
        }
        let rest = diffuse + clear;
        let (take, uc) = local::choose(uc, if rest > 0.0 { diffuse / rest } else { 1.0 });
        if take {
            let (through, _) = local::choose(uc, self.body.chance_through());
            let from = if through { -wo } else { wo };
            let wi = local::to_side_of(from, warp::cosine_hemisphere(u));
            return self.finish(&o, wi, mode);
        }
        let sample = self.clear?.sample(wo, uc, u, mode)?;
        if !sample.delta {
            return self.finish(&o, sample.wi, mode);
        }
        let weight = sample.weight / (clear as f32);
        Some(Sample {
            weight,
            pdf: sample.pdf * clear,
            ..sample
        })
    }

    fn delta(&self, wo: DVec3, transmitted: bool, mode: Mode) -> Option<Delta> {
        if !local::usable(wo) {
            return None;
        }
        let o = self.outlook(wo);
        let through = self
            .clear
            .and_then(|lobe| lobe.delta(wo, transmitted, mode));
        let through = through.map(|delta| Delta {
            probability: delta.probability * o.choice[CLEAR],
            ..delta
        });
        let coat = match &self.glossy {
            Glossy::Smooth(_) if !transmitted => self.sample_glossy(&o, 0.0, [0.0; 2], mode),
            _ => None,
        };
        match coat {
            Some(sample) => Some(Delta::of(&sample).and(through)),
            None => through,
        }
    }

    #[inline]
    fn albedo(&self, wo: DVec3) -> Spectrum {
        let clear = self.clear.map_or(Spectrum::ZERO, |clear| clear.albedo(wo));
        let o = self.view(wo);
        self.glossy_albedo(&o) + self.body.scattered() * o.admitted + clear
    }

    #[inline]
    fn is_delta(&self) -> bool {
        let glossy = !matches!(self.glossy, Glossy::Rough(_));
        glossy && self.body.is_black() && self.clear.is_none_or(|clear| clear.is_delta())
    }

    #[inline]
    fn dispersive_between(&self, wo: DVec3, wi: DVec3) -> bool {
        self.clear
            .is_some_and(|clear| clear.dispersive_between(wo, wi))
    }

    #[inline]
    fn transmits(&self) -> bool {
        self.body.lets_through() || self.clear.is_some_and(|clear| clear.transmits())
    }
}
