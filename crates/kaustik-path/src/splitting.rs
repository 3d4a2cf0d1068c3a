//! Looking for implicit specular paths along several branches that have their beginning in common.

use std::fmt;

use kaustik_bsdf::{Bsdf, Lobe};
use kaustik_pss::{Coordinates, Stream};
use kaustik_scene::{Scene, Vertex};
use kaustik_spectrum::Wavelengths;

use crate::instant::at_its_time;
use crate::sighting::{sees_environment, sees_light};
use crate::walk::Walk;
use crate::{BuilderSettings, Sighting, camera_walk, layout};

/// Light found by a search along several branches, for estimating how much there is.
pub struct Find<'f> {
    /// Coordinates of the branch.
    pub u: &'f mut dyn Coordinates,
    /// The settings of the search, restricted to the path lengths that this find stands for.
    pub settings: BuilderSettings,
    /// Weight of the light found, > 0.
    pub weight: f64,
}

impl fmt::Debug for Find<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Find")
            .field("settings", &self.settings)
            .field("weight", &self.weight)
            .finish_non_exhaustive()
    }
}

/// Looks for light of [`Class::L0`](crate::Class::L0) by a walk from the camera, as [`sight`](crate::sight) does. The
/// walk splits at surfaces that do not scatter into a Dirac direction: into so many `branches` at the first, half as many at the
/// next, and so on, one at least.
///
/// From such a surface, which the walk has reached through glass or by mirrors, only few directions lead
/// through glass or mirrors again to the lamp. So several are followed from there, each at the cost of its
/// own new edges alone; only the first goes on past the next surface that scatters otherwise. Each branch is
/// responsible for its own range of path lengths, which `found` is given with every hit ([`Find::settings`]). At the
/// coordinates of a find, [`Bidirectional`](crate::Bidirectional) paths in their full form, with the find's
/// settings, have some light of that class. The sum of this light times the weight, over all finds, has its mean.
///
/// The first branch has the coordinates of `u` itself, the others have them turned: each is as uniform as `u`
/// is, though not independent of the others. `u` must remember what it has said.
pub fn sight_branches(
    settings: &BuilderSettings,
    scene: &Scene,
    branches: u32,
    u: &mut dyn Coordinates,
    found: &mut dyn FnMut(Find<'_>),
) -> Sighting {
    at_its_time(scene, u, |scene, u| {
        let wavelengths = Wavelengths::sample(u.get(Stream::Wavelength, 0), settings.wavelengths);
        let (walk, _) = camera_walk::start(settings, scene, &wavelengths, u);
        let look = Look {
            settings,
            scene,
            branches,
        };
        look.along(walk, u, found)
    })
}

/// Where a stretch of Dirac surfaces led to.
struct Leg {
    /// It met light.
    lit: bool,
    /// It ended at a surface that scatters otherwise, where the walk stands before it is scattered, and which could
    /// not be joined to the one before.
    stands: bool,
}

/// Who is told of light that was met.
struct Told<'f> {
    /// Of any so far.
    lit: bool,
    found: &'f mut dyn FnMut(Find<'_>),
}

impl Told<'_> {
    fn tell(&mut self, u: &mut dyn Coordinates, settings: BuilderSettings, weight: f64) {
        self.lit = true;
        (self.found)(Find {
            u,
            settings,
            weight,
        });
    }
}

struct Look<'a> {
    settings: &'a BuilderSettings,
    scene: &'a Scene,
    branches: u32,
}

impl Look<'_> {
    fn along(
        &self,
        mut walk: Walk<'_>,
        u: &mut dyn Coordinates,
        found: &mut dyn FnMut(Find<'_>),
    ) -> Sighting {
        let mut told = Told { lit: false, found };
        let mut vertex = Vertex::default();
        let mut leg = self.leg(&mut walk, &mut vertex, u);
        if leg.lit {
            told.tell(u, self.within([1, walk.edges]), 1.0);
        }
        let mut branches = self.branches.max(1);
        while leg.stands {
            let parting = walk.edges;
            if branches == 1 {
                if self.meets_light(&mut walk, &mut vertex, u) {
                    let edges = [parting + 1, self.settings.max_edges];
                    told.tell(u, self.within(edges), 1.0);
                }
                break;
            }
            self.others(&walk, &vertex, branches, u, &mut told);
            // the first is the walk itself
            if !self.scatter(&mut walk, &vertex, u) {
                break;
            }
            leg = self.leg(&mut walk, &mut vertex, u);
            if leg.lit {
                let edges = [parting + 1, walk.edges];
                told.tell(u, self.within(edges), 1.0 / f64::from(branches));
            }
            branches /= 2;
        }
        match (told.lit, walk.specular) {
            (true, _) => Sighting::Light,
            (false, true) => Sighting::Specular,
            (false, false) => Sighting::Plain,
        }
    }

    /// All of so many branches but the first, from the parting where the walk stands to the next surface that scatters
    /// otherwise.
    fn others(
        &self,
        walk: &Walk<'_>,
        vertex: &Vertex,
        branches: u32,
        u: &mut dyn Coordinates,
        told: &mut Told<'_>,
    ) {
        let mut next = Vertex::default();
        let parting = walk.edges;
        for number in 1..branches {
            let mut branch = Branch::new(u, parting, [number, branches]);
            let mut walk = walk.clone();
            if self.scatter(&mut walk, vertex, &mut branch)
                && self.leg(&mut walk, &mut next, &mut branch).lit
            {
                let settings = self.within([parting + 1, walk.edges]);
                told.tell(&mut branch, settings, 1.0 / f64::from(branches));
            }
        }
    }

    /// The settings of the look, for paths of so many edges.
    fn within(&self, [least, most]: [u32; 2]) -> BuilderSettings {
        BuilderSettings {
            min_edges: least.max(self.settings.min_edges),
            max_edges: most,
            ..*self.settings
        }
    }

    /// Goes on as long as surfaces scatter into Dirac directions, light or not.
    fn leg(&self, walk: &mut Walk<'_>, vertex: &mut Vertex, u: &mut dyn Coordinates) -> Leg {
        let Self {
            settings, scene, ..
        } = self;
        let mut bsdf = Bsdf::black();
        let mut leg = Leg {
            lit: false,
            stands: false,
        };
        loop {
            if walk.advance(scene, u, vertex).is_none() {
                leg.lit |= sees_environment(settings, scene, walk);
                return leg;
            }
            leg.lit |= sees_light(settings, scene, walk, vertex);
            if walk.edges == settings.max_edges {
                return leg;
            }
            let scatter = walk.scatter(scene, vertex, &mut bsdf);
            if !scatter.bsdf.has_choice() && !scatter.bsdf.is_delta() {
                leg.stands = !walk.open;
                return leg;
            }
            let before = walk.clone();
            // Where nothing comes of it, other directions may fare better; of a Dirac direction there is but one.
            let sample = walk.bounce(scene, &scatter, u);
            if !sample.is_some_and(|sample| sample.delta) {
                *walk = before;
                leg.stands = !walk.open;
                return leg;
            }
            if !walk.survives(u) {
                return leg;
            }
        }
    }

    /// Goes on from a surface to the first light.
    fn meets_light(
        &self,
        walk: &mut Walk<'_>,
        vertex: &mut Vertex,
        u: &mut dyn Coordinates,
    ) -> bool {
        while self.scatter(walk, vertex, u) {
            let leg = self.leg(walk, vertex, u);
            if leg.lit || !leg.stands {
                return leg.lit;
            }
        }
        false
    }

    /// Leaves a surface; `false` when the walk ends there.
    fn scatter(&self, walk: &mut Walk<'_>, vertex: &Vertex, u: &mut dyn Coordinates) -> bool {
        let mut bsdf = Bsdf::black();
        let scatter = walk.scatter(self.scene, vertex, &mut bsdf);
        walk.bounce(self.scene, &scatter, u).is_some() && walk.survives(u)
    }
}

/// Coordinates of a branch: those of the look, but those of the camera walk past the parting are turned by
/// amounts that follow from the branch's number.
struct Branch<'a> {
    u: &'a mut dyn Coordinates,
    /// Edge that leads to the parting.
    parting: u32,
    number: u32,
    /// Of all branches that part there.
    count: u32,
}

/// What turns directions from branch to branch, in the second coordinate: the golden section.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

impl<'a> Branch<'a> {
    fn new(u: &'a mut dyn Coordinates, parting: u32, [number, count]: [u32; 2]) -> Self {
        Self {
            u,
            parting,
            number,
            count,
        }
    }

    /// By how much a coordinate is turned, as a share of the whole.
    fn turn(&self, stream: Stream, index: u32) -> f64 {
        let bounce = layout::bounce(layout::CAMERA_HEAD, self.parting);
        let number = f64::from(self.number);
        let turned = match stream {
            // the part of the surface that scatters is chosen before branches part
            Stream::Camera => index > bounce,
            // of two walks that take turns
            Stream::Transparency => index >= 2 * self.parting,
            Stream::Technique => index > layout::part(self.parting),
            _ => false,
        };
        if self.number == 0 || !turned {
            return 0.0;
        }
        match stream {
            // directions at the parting: a lattice
            Stream::Camera if index == bounce + 1 => number / f64::from(self.count),
            Stream::Camera if index == bounce + 2 => (number * GOLDEN).fract(),
            // any constants that differ
            _ => {
                let address = f64::from(index) * Stream::COUNT as f64 + f64::from(stream as u8);
                (number * (GOLDEN + address * std::f64::consts::SQRT_2)).fract()
            }
        }
    }
}

impl Coordinates for Branch<'_> {
    fn get(&mut self, stream: Stream, index: u32) -> f64 {
        let turned = self.u.get(stream, index) + self.turn(stream, index);
        // A sum may round up to 2.
        if turned < 1.0 {
            turned
        } else {
            (turned - 1.0).min(1.0 - f64::EPSILON)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Just below 1 everywhere.
    struct Last;

    impl Coordinates for Last {
        fn get(&mut self, _: Stream, _: u32) -> f64 {
            1.0 - f64::EPSILON / 2.0
        }
    }

    const PARTING: u32 = 3;

    fn turns(number: u32, stream: Stream) -> Vec<f64> {
        let mut last = Last;
        let branch = Branch::new(&mut last, PARTING, [number, 8]);
        (0..64).map(|index| branch.turn(stream, index)).collect()
    }

    #[test]
    fn branches_have_their_beginning_in_common_and_not_their_directions() {
        for stream in Stream::ALL {
            assert!(turns(0, stream).iter().all(|turn| turn.to_bits() == 0));
            let [one, other] = [1, 5].map(|number| turns(number, stream));
            let first = match stream {
                Stream::Camera => 4 + 4 * 2 + 1,
                Stream::Transparency => 2 * PARTING as usize,
                Stream::Technique => 8 + PARTING as usize + 1,
                _ => usize::MAX,
            };
            for (index, (one, other)) in one.into_iter().zip(other).enumerate() {
                let turned = one > 0.0 && other > 0.0 && (one - other).abs() > 1e-9;
                assert_eq!(turned, index >= first, "{stream:?} {index}");
            }
        }
    }

    #[test]
    fn turned_coordinates_are_below_one() {
        for number in 0..1_000 {
            let mut last = Last;
            let mut branch = Branch::new(&mut last, PARTING, [number, 1_000]);
            for index in 0..64 {
                assert!((0.0..1.0).contains(&branch.get(Stream::Camera, index)));
            }
        }
    }
}
