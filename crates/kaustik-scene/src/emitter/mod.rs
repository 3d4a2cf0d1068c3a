//! Everything that sends out light.
//!
//! Light walks choose an emitter by power. Emissive triangles are emitters of their own; an environment takes half of the
//! choice when there is anything else, and directional lights half of what is left at most, because their flux through the scene's sphere says
//! little about what it does for the picture. Next event chooses among those that stand somewhere by what each may bring to the point
//! that asks ([`next_event`]), and otherwise alike; how much more often than light walks is what weights have to know
//! ([`Emitters::odds`]). Photons, which no other technique has to know the density of,
//! have a distribution of their own that goes by that flux: they should all carry as much.

mod alias;
mod density;
mod emission;
mod next_event;
mod point;
mod punctual;
mod sample;
mod shares;
mod surroundings;
mod tree;
mod triangle;

use std::f64::consts::PI;

use glam::DVec3;
use kaustik_bsdf::warp;
use kaustik_spectrum::Wavelengths;

use crate::environment::Environment;
use crate::matter::Matter;
use crate::scene::SceneError;
use crate::{Interior, Vertex};
use alias::AliasTable;
use density::lambertian_pdf;
use next_event::{Chosen, NextEvent};
pub(crate) use punctual::{Arrival, Punctual};
use shares::{Choices, Shares};
use surroundings::Surroundings;
use triangle::{TriangleEmitter, typical_area};

pub use density::EmissionPdf;
pub use point::{EmitterPoint, PunctualView};
pub use sample::{AreaSample, DirectSample, EmissionSample, Reach};

/// Marks an instance that emits nothing.
const DARK: u32 = u32::MAX;

/// Emissive triangles that a scene may have, each instance's counted: a list of them takes some 3 GB, and
/// files of a kilobyte can ask for any number.
const MOST_TRIANGLES: u64 = 1 << 24;

#[derive(Clone, Copy, Debug)]
enum Emitter {
    Triangle(TriangleEmitter),
    Punctual(u32),
    Environment,
}

/// All emitters of a scene.
#[derive(Debug, Default)]
pub(crate) struct Emitters {
    list: Vec<Emitter>,
    /// Among all: for light walks, and for next event where this does not depend on the point.
    choice: AliasTable,
    /// Among all for next event, where this depends on the point that asks.
    next_event: Option<NextEvent>,
    /// Among emitters of photons, where these are not chosen as all else is.
    photon_choice: Option<AliasTable>,
    punctual: Vec<Punctual>,
    environment: Option<Environment>,
    /// For each instance the index of its first triangle's emitter, or [`DARK`].
    first_of_instance: Vec<u32>,
    surroundings: Surroundings,
    /// Sphere around all geometry.
    center: DVec3,
    radius: f64,
}

/// Emitters that are not surfaces, and the sphere around all geometry.
pub(crate) struct Sources {
    pub(crate) punctual: Vec<Punctual>,
    pub(crate) environment: Option<Environment>,
    pub(crate) center: DVec3,
    pub(crate) radius: f64,
}

impl Emitters {
    /// Collects what emits, unless there is too much of it.
    pub(crate) fn new(matter: &Matter, sources: Sources) -> Result<Self, SceneError> {
        let instances = 0..matter.material_of.len() as u32;
        let triangles = instances.map(|instance| emissive_triangles(matter, instance));
        let found = triangles.fold(0, u64::saturating_add);
        if found > MOST_TRIANGLES {
            let most = MOST_TRIANGLES;
            return Err(SceneError::Emitters { found, most });
        }
        let mut emitters = Self {
            center: sources.center,
            radius: sources.radius,
            ..Self::default()
        };
        let mut shares = Shares::default();
        for instance in 0..matter.material_of.len() as u32 {
            emitters.add_instance(matter, instance, &mut shares);
        }
        let disc = PI * sources.radius * sources.radius;
        for (index, light) in sources.punctual.iter().enumerate() {
            emitters.list.push(Emitter::Punctual(index as u32));
            shares.punctual(light, disc);
        }
        let triangles = emitters.list.len() - sources.punctual.len();
        emitters.surroundings = Surroundings::new(matter, triangles, sources.punctual.len());
        emitters.punctual = sources.punctual;
        if let Some(environment) = sources.environment.filter(|e| e.mean_radiance() > 0.0) {
            emitters.list.push(Emitter::Environment);
            shares.environment(&environment, disc);
            emitters.environment = Some(environment);
        }
        let Choices {
            all,
            photons,
            standing,
        } = shares.choices();
        (emitters.choice, emitters.photon_choice) = (all, photons);
        emitters.look_around(matter, &standing);
        Ok(emitters)
    }

    fn add_instance(&mut self, matter: &Matter, instance: u32, shares: &mut Shares) {
        let world = &matter.world;
        let material_index = matter.material_of[instance as usize];
        let material = matter.material(material_index);
        if emissive_triangles(matter, instance) == 0 {
            self.first_of_instance.push(DARK);
            return;
        }
        self.first_of_instance.push(self.list.len() as u32);
        shares.instance();
        let sides = if material.emits_on_both_sides() {
            2.0
        } else {
            1.0
        };
        for primitive in 0..world.mesh_of(instance).indices.len() as u32 {
            let area = typical_area(world, instance, primitive);
            let mean = material.mean_emission(&matter.textures, world, instance, primitive);
            shares.triangle(area * sides * PI * mean);
            let triangle = TriangleEmitter::new(matter, [instance, primitive], material_index);
            self.list.push(Emitter::Triangle(triangle));
        }
    }

    /// Nothing emits?
    pub(crate) fn is_empty(&self) -> bool {
        self.choice.is_empty()
    }

    /// Is any of them neither a surface nor the environment?
    pub(crate) fn any_punctual(&self) -> bool {
        !self.punctual.is_empty()
    }

    /// Is any of them a surface or the environment?
    pub(crate) fn any_extended(&self) -> bool {
        self.list.len() > self.punctual.len()
    }

    pub(crate) fn environment(&self) -> Option<&Environment> {
        self.environment.as_ref()
    }

    /// The emitter for a coordinate that is asked for only if there is a choice to make.
    #[inline]
    fn choose(&self, u: impl FnOnce() -> f64) -> Option<(&Emitter, f64)> {
        self.choose_by(&self.choice, u)
    }

    #[inline]
    fn choose_by(&self, choice: &AliasTable, u: impl FnOnce() -> f64) -> Option<(&Emitter, f64)> {
        let index = match choice.len() {
            0 => return None,
            1 => 0,
            _ => choice.choose(u()),
        };
        Some((&self.list[index], choice.probability(index)))
    }

    /// Next event: a point or direction of an emitter as seen from `position`. `u(i)` gives
    /// coordinate `i` of three: choice, then the point or direction. `false` where nothing arrives.
    ///
    /// The sample goes into the caller's slot, because this is the innermost loop: returned, it would be copied twice.
    #[inline]
    pub(crate) fn write_direct(
        &self,
        matter: &Matter,
        position: DVec3,
        wavelengths: &Wavelengths,
        mut u: impl FnMut(u32) -> f64,
        sample: &mut DirectSample,
    ) -> bool {
        let Some(chosen) = self.choose_from(position, || u(0)) else {
            return false;
        };
        let Chosen {
            emitter,
            probability,
            odds,
        } = chosen;
        let other = match emitter {
            Emitter::Triangle(triangle) => {
                let weights = warp::uniform_triangle([u(1), u(2)]);
                let (point, normal, surface) = triangle.point(matter, weights);
                let to = point.as_dvec3() - position;
                let squared = to.length_squared();
                let wi = to / squared.sqrt();
                let cos = -wi.dot(normal.as_dvec3());
                let material = matter.material(triangle.material);
                let pdf = probability * triangle.inverse_area(matter) * squared / cos.abs();
                if !(material.emits_toward(cos) && pdf.is_finite() && pdf > 0.0) {
                    return false;
                }
                sample.wi = wi;
                sample.pdf = pdf;
                sample.odds = odds;
                sample.emission_pdf = lambertian_pdf(cos, material.emits_on_both_sides());
                sample.radiance = triangle.radiance(matter, surface.as_ref(), wavelengths);
                sample.delta = false;
                sample.reach = Reach::Surface(point, normal);
                return true;
            }
            Emitter::Punctual(index) => {
                let light = self.punctual[*index as usize].at(matter.world.time());
                self.punctual_direct(&light, &chosen, position, wavelengths)
            }
            Emitter::Environment => {
                let u = [u(1), u(2)];
                self.environment_direct(probability, wavelengths, u)
            }
        };
        match other {
            Some(other) => {
                *sample = other;
                true
            }
            None => false,
        }
    }

    fn environment_direct(
        &self,
        probability: f64,
        wavelengths: &Wavelengths,
        u: [f64; 2],
    ) -> Option<DirectSample> {
        let environment = self.environment.as_ref()?;
        let (wi, pdf) = environment.sample(u);
        (pdf > 0.0).then(|| DirectSample {
            wi,
            pdf: pdf * probability,
            odds: 1.0,
            emission_pdf: self.disc_pdf(),
            radiance: environment.radiance(wi, wavelengths),
            delta: false,
            reach: Reach::Infinity,
        })
    }

    fn punctual_direct(
        &self,
        light: &Punctual,
        chosen: &Chosen<'_>,
        position: DVec3,
        wavelengths: &Wavelengths,
    ) -> Option<DirectSample> {
        let Arrival {
            toward,
            squared,
            intensity,
        } = light.arrival(position, wavelengths);
        (squared > 0.0 && !intensity.is_zero()).then(|| DirectSample {
            wi: toward,
            pdf: chosen.probability,
            odds: chosen.odds,
            emission_pdf: self.punctual_pdf(light, toward),
            radiance: intensity * (1.0 / squared) as f32,
            delta: true,
            reach: match light.is_directional() {
                true => Reach::Infinity,
                false => Reach::Point(light.position),
            },
        })
    }

    /// Density with which light walks leave a punctual light away from `toward`: per solid angle, of one that is infinitely far away per
    /// area of the disc that they start on.
    fn punctual_pdf(&self, light: &Punctual, toward: DVec3) -> f64 {
        match light.is_directional() {
            true => self.disc_pdf(),
            false => light.direction_pdf(-toward),
        }
    }

    /// Density per solid angle with which [`Self::write_direct`] from a point at a distance whose square is
    /// `squared` finds this point of a triangle, met at `cos`.
    #[inline]
    pub(crate) fn direct_pdf(
        &self,
        matter: &Matter,
        from: DVec3,
        vertex: &Vertex,
        [squared, cos]: [f64; 2],
    ) -> f64 {
        let Some(index) = self.triangle_index(vertex) else {
            return 0.0;
        };
        match self.list[index] {
            Emitter::Triangle(triangle) if cos != 0.0 => {
                let area = triangle.inverse_area(matter);
                let probability = self.choice.probability(index) * self.odds(index as u32, from);
                probability * area * squared / cos.abs()
            }
            _ => 0.0,
        }
    }

    /// Density per solid angle with which [`Self::write_direct`] finds the environment in `direction`.
    #[inline]
    pub(crate) fn environment_pdf(&self, direction: DVec3) -> f64 {
        self.environment.as_ref().map_or(0.0, |environment| {
            environment.pdf(direction) * self.choice.probability(self.list.len() - 1)
        })
    }

    /// The solids around a point on an emitter, on the side of `direction`.
    pub(crate) fn area_interior(
        &self,
        matter: &Matter,
        area: &AreaSample,
        direction: DVec3,
    ) -> Interior {
        match &self.list[area.emitter as usize] {
            Emitter::Triangle(triangle) => {
                self.interior_beside(matter, triangle, &area.surface, direction)
            }
            _ => Interior::VACUUM,
        }
    }

    /// What is left of a fading light's radiance after `distance`.
    pub(crate) fn fading(&self, emission: &EmissionSample, distance: f64) -> f32 {
        emission.fading.map_or(1.0, |index| {
            self.punctual[index as usize].window(distance) as f32
        })
    }
}

/// The triangles of an instance that are emitters.
fn emissive_triangles(matter: &Matter, instance: u32) -> u64 {
    let material = matter.material(matter.material_of[instance as usize]);
    match material.is_emissive() {
        true => matter.world.mesh_of(instance).indices.len() as u64,
        false => 0,
    }
}

#[cfg(test)]
mod tests;
