use std::collections::HashMap;

use kaustik_geometry::Hit;

use crate::Interior;

/// Solids on the way of a ray in all but senseless scenes.
const NEAR: usize = 16;

/// Where a ray goes into solids and out of them, told in any order.
#[derive(Default)]
pub(super) struct Crossings {
    /// On the stack as a rule, since where something moves every path may ask.
    near: [Crossed; NEAR],
    count: usize,
    /// Those beyond that many.
    far: HashMap<u32, Crossed>,
}

/// One solid on the way.
#[derive(Clone, Copy)]
struct Crossed {
    medium: u32,
    /// How many more times it is left than entered.
    exits: i32,
    /// Its first crossing.
    first: Hit,
}

impl Default for Crossed {
    fn default() -> Self {
        Self {
            medium: 0,
            exits: 0,
            first: Hit {
                t: f32::INFINITY,
                u: 0.0,
                v: 0.0,
                instance: u32::MAX,
                primitive: u32::MAX,
            },
        }
    }
}

impl Crossings {
    /// One more.
    pub(super) fn add(&mut self, medium: u32, leaves: bool, hit: &Hit) {
        let near = &mut self.near[..self.count];
        let known = near.iter().position(|crossed| crossed.medium == medium);
        let crossed = match known {
            Some(index) => &mut self.near[index],
            None if self.count < NEAR => {
                self.count += 1;
                &mut self.near[self.count - 1]
            }
            None => self.far.entry(medium).or_default(),
        };
        crossed.medium = medium;
        crossed.exits += if leaves { 1 } else { -1 };
        if hit.precedes(&crossed.first) {
            crossed.first = *hit;
        }
    }

    /// The solids that are left more often than they are entered; the one that is crossed first was entered last.
    pub(super) fn interior(mut self) -> Interior {
        let left = |crossed: &Crossed| crossed.exits > 0;
        let mut interior = Interior::VACUUM;
        let mut enter = |crossed: &Crossed| {
            for _ in 0..crossed.exits {
                interior.enter(crossed.medium);
            }
        };
        let last_first = |a: &Crossed, b: &Crossed| match a.first.precedes(&b.first) {
            true => std::cmp::Ordering::Greater,
            false => std::cmp::Ordering::Less,
        };
        let near = &mut self.near[..self.count];
        if self.far.is_empty() {
            near.sort_unstable_by(last_first);
            near.iter().filter(|crossed| left(crossed)).for_each(enter);
        } else {
            let all = near.iter().chain(self.far.values()).copied();
            let mut all: Vec<Crossed> = all.filter(left).collect();
            all.sort_unstable_by(last_first);
            all.iter().for_each(&mut enter);
        }
        interior
    }
}
