//! How often each emitter is chosen: by its power, where that says something.

use std::f64::consts::PI;
use std::ops::Range;

use super::alias::AliasTable;
use super::punctual::Punctual;
use crate::environment::Environment;

/// Share of the mean power that the dimmest emissive triangle is chosen with at least: a texture
/// may be bright where the power estimate did not look.
const TRIANGLE_FLOOR: f64 = 1e-3;

/// Share of the mean power of an emissive object or lamp that the dimmest of them is chosen with at least: a dome
/// around all has a thousand times the power of the lamp on the table, which is all that lights the table.
const OBJECT_FLOOR: f64 = 0.1;

/// What directional lights are chosen with at least, as a share of all other lamps' choice. They have as much as
/// these at most: the flux through the scene's disc grows with the ground that a house stands on.
const DIRECTIONAL_FLOOR: f64 = 0.05;

/// Share of the photons that lamps and surfaces have at least beside what is infinitely far away: what is near in a room may have
/// little power beside the sky, and yet be all that is seen.
const PHOTON_FLOOR: f64 = 0.05;

/// The same of what is infinitely far away beside them. It counts with all that goes through the whole scene, and so rather
/// with too many photons than with too few; many that carry little hide the few that carry much.
const DISTANT_FLOOR: f64 = 0.01;

/// Powers of a scene's emitters: triangles, then punctual lights, then the environment.
#[derive(Debug, Default)]
pub(super) struct Shares {
    triangles: Vec<f64>,
    /// Those of each emissive instance.
    instances: Vec<Range<usize>>,
    lamps: Vec<Lamp>,
    environment: Option<f64>,
}

#[derive(Clone, Copy, Debug)]
struct Lamp {
    power: f64,
    directional: bool,
}

/// By what emitters are chosen.
#[derive(Debug)]
pub(super) struct Choices {
    /// For light walks, and for next event where few emitters stand anywhere.
    pub(super) all: AliasTable,
    /// For photons, if another.
    pub(super) photons: Option<AliasTable>,
    /// The power of each triangle and lamp that stands somewhere; 0 of directional lights.
    pub(super) standing: Vec<f64>,
}

impl Shares {
    /// Triangles from here on are of another instance.
    pub(super) fn instance(&mut self) {
        let begin = self.triangles.len();
        self.instances.push(begin..begin);
    }

    /// An emissive triangle of the last instance.
    pub(super) fn triangle(&mut self, power: f64) {
        self.triangles.push(power);
        if let Some(instance) = self.instances.last_mut() {
            instance.end += 1;
        }
    }

    /// A light, in a scene whose bounding sphere has a disc of this area.
    pub(super) fn punctual(&mut self, light: &Punctual, disc: f64) {
        self.lamps.push(Lamp {
            power: light.power(disc),
            directional: light.is_directional(),
        });
    }

    /// The environment of such a scene.
    pub(super) fn environment(&mut self, environment: &Environment, disc: f64) {
        self.environment = Some(4.0 * PI * environment.mean_radiance() * disc);
    }

    /// By what emitters are chosen.
    pub(super) fn choices(mut self) -> Choices {
        self.raise_triangles();
        // Next event sees for itself which objects are near, so that it needs no floor for them.
        let standing = self.powers(0.0);
        self.raise_objects();
        let near = self.triangles.iter().sum::<f64>() + self.of_lamps(false);
        let directional = self.of_lamps(true);
        Choices {
            all: self.choice(near, directional),
            photons: self.photons(near, directional),
            standing,
        }
    }

    fn of_lamps(&self, directional: bool) -> f64 {
        let lamps = self.lamps.iter();
        let lamps = lamps.filter(|lamp| lamp.directional == directional);
        lamps.map(|lamp| lamp.power).sum()
    }

    fn raise_triangles(&mut self) {
        let triangles = self.triangles.len().max(1) as f64;
        let floor = self.triangles.iter().sum::<f64>() / triangles * TRIANGLE_FLOOR;
        for power in self.triangles.iter_mut().filter(|power| **power > 0.0) {
            *power = power.max(floor);
        }
    }

    /// Objects are emissive instances, and lamps that stand somewhere.
    fn raise_objects(&mut self) {
        let instances = self.instances.iter().cloned();
        let instance = |range: Range<usize>| self.triangles[range].iter().sum();
        let of_instances: Vec<f64> = instances.map(instance).collect();
        let standing = self.lamps.iter().filter(|lamp| !lamp.directional);
        let powers = of_instances.iter().copied();
        let powers = powers.chain(standing.map(|lamp| lamp.power));
        let shining = powers.filter(|&power| power > 0.0);
        let (sum, count) =
            shining.fold((0.0, 0_u32), |(sum, count), power| (sum + power, count + 1));
        let floor = sum / f64::from(count.max(1)) * OBJECT_FLOOR;
        for (range, power) in self.instances.iter().zip(of_instances) {
            if power > 0.0 && power < floor {
                for triangle in &mut self.triangles[range.clone()] {
                    *triangle *= floor / power;
                }
            }
        }
        for lamp in &mut self.lamps {
            if !lamp.directional && lamp.power > 0.0 {
                lamp.power = lamp.power.max(floor);
            }
        }
    }

    /// Half is the environment's if there is anything else; directional lights have half of the rest at most.
    fn choice(&self, near: f64, directional: f64) -> AliasTable {
        let scale = match near > 0.0 && directional > 0.0 {
            true => directional.clamp(DIRECTIONAL_FLOOR * near, near) / directional,
            false => 1.0,
        };
        let mut powers = self.powers(scale);
        if self.environment.is_some() {
            let rest: f64 = powers.iter().sum();
            powers.push(if rest > 0.0 { rest } else { 1.0 });
        }
        AliasTable::new(&powers)
    }

    /// By the flux that everything brings into the scene's sphere, as far as the floors let it.
    fn photons(&self, near: f64, directional: f64) -> Option<AliasTable> {
        let environment = self.environment.unwrap_or(0.0);
        let distant = directional + environment;
        if near > 0.0 && distant > 0.0 {
            let to = near * distant_odds(distant, near);
            let sky = sky_share(environment, directional);
            let mut powers = self.powers(match directional > 0.0 {
                true => to * (1.0 - sky) / directional,
                false => 1.0,
            });
            powers.extend(self.environment.map(|_| to * sky));
            return Some(AliasTable::new(&powers));
        }
        if environment > 0.0 && directional > 0.0 {
            let mut powers = self.powers(1.0);
            powers.push(directional * distant_odds(environment, directional));
            return Some(AliasTable::new(&powers));
        }
        None
    }

    /// Of all but the environment, with those of directional lights scaled.
    fn powers(&self, directional: f64) -> Vec<f64> {
        let lamps = self.lamps.iter().map(|lamp| match lamp.directional {
            true => lamp.power * directional,
            false => lamp.power,
        });
        self.triangles.iter().copied().chain(lamps).collect()
    }
}

/// The environment's part of what comes from infinitely far away.
fn sky_share(environment: f64, directional: f64) -> f64 {
    match directional > 0.0 && environment > 0.0 {
        true => share(environment, directional),
        false if environment > 0.0 => 1.0,
        false => 0.0,
    }
}

/// How many photons of what is far away, or of more of it, there are for one of all others.
fn distant_odds(distant: f64, rest: f64) -> f64 {
    let share = share(distant, rest);
    share / (1.0 - share)
}

fn share(distant: f64, rest: f64) -> f64 {
    let most = 1.0 - PHOTON_FLOOR;
    DISTANT_FLOOR + (most - DISTANT_FLOOR) * distant / (distant + rest)
}
