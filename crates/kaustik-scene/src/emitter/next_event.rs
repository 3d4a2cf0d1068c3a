//! Which emitter next event looks at, as seen from the point that asks.

use glam::{DVec3, Vec3};

use super::alias::AliasTable;
use super::tree::{Light, LightTree};
use super::{Emitter, Emitters, TriangleEmitter};
use crate::matter::Matter;

/// Fewer that stand anywhere are chosen by power: two triangles of a square lamp need no tree.
const FEWEST: usize = 3;

/// More are chosen by power as well: a tree of a million took 145 MB and half a second, and so many are a mesh that
/// shines, not lamps.
const MOST: usize = 1 << 20;

/// Share of next events that choose as light walks do, so that none is ever chosen less than so many times as often: a tree knows nothing of
/// walls, and a bright lamp behind one would have nearly all of them.
pub(super) const BY_POWER: f64 = 0.2;

/// The choice of an emitter that depends on the point: mostly, among those that stand somewhere, by a tree, as often as light walks begin
/// at any of them; among the others as light walks choose, and a share of all as these do.
#[derive(Clone, Debug)]
pub(super) struct NextEvent {
    tree: LightTree,
    /// Probability of the tree.
    standing: f64,
    /// Directional lights and the environment, by their number in the list.
    distant: Vec<u32>,
    distant_choice: AliasTable,
}

/// An emitter that was chosen.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chosen<'a> {
    pub(super) emitter: &'a Emitter,
    pub(super) probability: f64,
    /// How much more often next event chooses it from there than light walks do.
    pub(super) odds: f64,
}

impl NextEvent {
    /// `powers` are those of the emitters that stand somewhere, by their number in the list; `None` where light walks' choice serves.
    fn new(matter: &Matter, emitters: &Emitters, powers: &[f64]) -> Option<Self> {
        let choice = &emitters.choice;
        let stands = |i: usize| powers.get(i).is_some_and(|&power| power > 0.0);
        let standing = (0..emitters.list.len()).filter(|&i| stands(i));
        if choice.is_empty() || !(FEWEST..=MOST).contains(&standing.clone().count()) {
            return None;
        }
        let light = |i: usize| light(matter, emitters, i, powers[i]);
        let lights: Vec<Light> = standing.filter_map(light).collect();
        if !lights.iter().all(Light::is_finite) {
            return None;
        }
        let distant = |&i: &usize| !stands(i) && choice.probability(i) > 0.0;
        let distant: Vec<usize> = (0..emitters.list.len()).filter(distant).collect();
        let of_distant: Vec<f64> = distant.iter().map(|&i| choice.probability(i)).collect();
        Some(Self {
            tree: LightTree::new(lights, emitters.list.len()),
            standing: 1.0 - of_distant.iter().sum::<f64>(),
            distant: distant.iter().map(|&i| i as u32).collect(),
            distant_choice: AliasTable::new(&of_distant),
        })
    }

    /// The emitter for `u` in [0, 1), with how much more often it is chosen than by `walks`; `None` where none shines at the point.
    #[inline]
    fn choose(&self, walks: &AliasTable, point: DVec3, u: f64) -> Option<(usize, f64)> {
        const BY_PLACE: f64 = 1.0 - BY_POWER;
        if u >= BY_PLACE {
            let index = walks.choose((u - BY_PLACE) / BY_POWER);
            return Some((index, self.odds(walks, point, index)));
        }
        let (u, standing) = (u / BY_PLACE, self.standing);
        if u < standing || self.distant_choice.is_empty() {
            let (index, share) = self.tree.choose(point, u / standing)?;
            return Some((index, self.mixed(walks, index, share)));
        }
        let index = (self.distant_choice).choose((u - standing) / (1.0 - standing));
        Some((self.distant[index] as usize, 1.0))
    }

    /// How much more often an emitter is chosen at a point than by `walks`.
    #[inline]
    fn odds(&self, walks: &AliasTable, point: DVec3, index: usize) -> f64 {
        match self.tree.probability(point, index) {
            Some(share) => self.mixed(walks, index, share),
            None => 1.0,
        }
    }

    /// The same of one that has this share of what the tree chooses.
    #[inline]
    fn mixed(&self, walks: &AliasTable, index: usize, share: f64) -> f64 {
        BY_POWER + (1.0 - BY_POWER) * self.standing * share / walks.probability(index)
    }
}

/// An emitter that stands somewhere, as the tree sees it.
fn light(matter: &Matter, emitters: &Emitters, index: usize, power: f64) -> Option<Light> {
    let number = index as u32;
    match &emitters.list[index] {
        Emitter::Triangle(triangle) => Some(of_triangle(matter, triangle, number, power)),
        Emitter::Punctual(punctual) => {
            let punctual = &emitters.punctual[*punctual as usize];
            let now = punctual.at(HALFWAY);
            let light = Light::lamp(number, power, now.position, now.cone(), now.range());
            Some(match punctual.moves() {
                true => light.moving(),
                false => light,
            })
        }
        Emitter::Environment => None,
    }
}

/// What moves is taken to stand where it is at this time, and to shine everywhere.
const HALFWAY: f32 = 0.5;

fn of_triangle(matter: &Matter, triangle: &TriangleEmitter, number: u32, power: f64) -> Light {
    let (instance, primitive) = (triangle.instance, triangle.primitive);
    let moving = matter.world.is_moving(instance);
    let both_sides = matter.material(triangle.material).emits_on_both_sides();
    let corners: [Vec3; 3] = match moving {
        true => matter.world.at(HALFWAY).triangle(instance, primitive),
        false => matter.world.triangle(instance, primitive),
    };
    let middle = (matter.world).surface_at(instance, primitive, 0.3, 0.3);
    let light = Light::triangle(number, power, corners, middle.geometric_normal.as_dvec3());
    match (moving, both_sides) {
        (true, _) => light.moving(),
        (false, true) => light.both_sides(),
        (false, false) => light,
    }
}

impl Emitters {
    /// Makes next event choose by place, where there are enough emitters for that.
    pub(super) fn look_around(&mut self, matter: &Matter, powers: &[f64]) {
        self.next_event = NextEvent::new(matter, self, powers);
    }

    /// Does next event choose by the point that asks?
    #[inline]
    pub(crate) fn choose_by_place(&self) -> bool {
        self.next_event.is_some()
    }

    /// The emitter for a coordinate that is asked for only if there is a choice to make.
    #[inline]
    pub(super) fn choose_from(&self, point: DVec3, u: impl FnOnce() -> f64) -> Option<Chosen<'_>> {
        let Some(next_event) = &self.next_event else {
            let (emitter, probability) = self.choose(u)?;
            return Some(Chosen {
                emitter,
                probability,
                odds: 1.0,
            });
        };
        let (index, odds) = next_event.choose(&self.choice, point, u())?;
        Some(Chosen {
            emitter: &self.list[index],
            probability: odds * self.choice.probability(index),
            odds,
        })
    }

    /// How much more often next event from `point` chooses an emitter than light walks do.
    #[inline]
    pub(crate) fn odds(&self, emitter: u32, point: DVec3) -> f64 {
        let Some(next_event) = &self.next_event else {
            return 1.0;
        };
        next_event.odds(&self.choice, point, emitter as usize)
    }
}
