//! Samples of the light of a cell of the image, of two kinds.

use kaustik_estimate::{ScalarTarget, SpecularSplit};
use kaustik_mcmc::{Exponential, Independent, Point, SampleGenerators, Step};
use kaustik_path::{
    Bidirectional, Contributions, Find, Form, PathBuilder, Sighting, sight_branches,
};
use kaustik_scene::Scene;

use super::grid::Grid;
use crate::RenderSettings;
use crate::methods::builders::builder_settings;
use crate::sampling::stratified::{Stratified, mix};

/// Branches that a scout takes from where it meets the first surface that scatters otherwise than into a Dirac
/// direction. Error squared times time in `ring-and-sphere`, `glass-cube` and `water-cornell`: with a single
/// branch about twice as much; with 4 branches, or with 8 for every second scout alone, about the same.
const BRANCHES: u32 = 8;
/// What so many branches know of the light is what so many scouts with a single one know: in the same scenes 5, 6 and 8.
pub(super) const WORTH: f64 = 5.0;

/// Where a sample is made.
#[derive(Clone, Copy)]
pub(super) struct At {
    /// Its number among all.
    pub(super) step: u64,
    pub(super) pass: u64,
    pub(super) cell: usize,
    /// Its number among those of its kind in the cell and pass.
    pub(super) index: u64,
}

/// What a scout saw.
pub(super) struct Seen {
    /// How far.
    pub(super) sighting: Sighting,
    /// Implicit specular light that nothing else finds.
    pub(super) light: f64,
    /// The same of squares: without products of what a walk finds at several places.
    pub(super) square: f64,
    /// Branches that brought some.
    pub(super) finds: u32,
}

/// What makes samples, each from a generator of its own, stratified over those of the cell and pass.
pub(super) struct Samples<'a> {
    scene: &'a Scene,
    builder: Bidirectional,
    target: ScalarTarget,
    /// Scrambles what is stratified.
    seed: u64,
    generators: SampleGenerators,
    pub(super) grid: Grid,
}

/// What a thread needs to make them.
pub(super) struct Scratch {
    pub(super) point: Point<Exponential>,
    value: Contributions,
    /// Contributions of the last sample that were not finite.
    pub(super) nonfinite: u32,
}

impl Default for Scratch {
    fn default() -> Self {
        Self {
            point: Point::new(Exponential::default()),
            value: Contributions::default(),
            nonfinite: 0,
        }
    }
}

impl<'a> Samples<'a> {
    /// From generators of this number, of light as this scalar.
    pub(super) fn new(
        scene: &'a Scene,
        settings: &RenderSettings,
        target: ScalarTarget,
        stream: u64,
    ) -> Self {
        Self {
            scene,
            builder: Bidirectional {
                settings: builder_settings(settings),
                form: Form::Full,
                heuristic: settings.options.heuristic,
            },
            target,
            seed: mix(settings.seed ^ mix(stream)),
            generators: SampleGenerators::new(settings.seed, stream),
            grid: Grid::new(settings),
        }
    }

    /// All light but what scouts look for.
    pub(super) fn join(&self, at: At, scratch: &mut Scratch) -> f64 {
        let (corner, size) = self.grid.place(at.cell);
        let inner = Independent::new(self.generators.at(at.step));
        let scramble = self.scramble(at.pass, at.cell);
        let mut u = Stratified::new(inner, corner, size, at.index, scramble);
        let value = &mut scratch.value;
        self.builder.build(self.scene, &mut u, value);
        scratch.nonfinite = value.nonfinite();
        SpecularSplit::of(value, self.target).other
    }

    /// Looks for implicit specular light that nothing else finds.
    pub(super) fn scout(&self, at: At, scratch: &mut Scratch) -> Seen {
        let mut seen = Seen {
            sighting: Sighting::Plain,
            light: 0.0,
            square: 0.0,
            finds: 0,
        };
        let Scratch {
            point,
            value,
            nonfinite,
        } = scratch;
        *nonfinite = 0;
        seen.sighting = self.search(at, point, &mut |mut find| {
            let light = self.light(&mut find, value);
            *nonfinite += value.nonfinite();
            seen.light += find.weight * light;
            seen.square += find.weight * light * light;
            seen.finds += 1;
        });
        seen
    }

    /// Goes where a scout goes, and tells what it finds, in its order.
    pub(super) fn search(
        &self,
        at: At,
        point: &mut Point<Exponential>,
        found: &mut dyn FnMut(Find<'_>),
    ) -> Sighting {
        let (corner, size) = self.grid.place(at.cell);
        let mut draws = self.generators.at(at.step);
        // It remembers its coordinates, which branches and evaluations ask for again.
        let mut proposal = point.propose(Step::Large, &mut draws);
        let scramble = self.scramble(!at.pass, at.cell);
        let mut u = Stratified::new(&mut proposal, corner, size, at.index, scramble);
        let settings = &self.builder.settings;
        let sighting = sight_branches(settings, self.scene, BRANCHES, &mut u, found);
        proposal.reject();
        sighting
    }

    /// The light that a find stands for.
    pub(super) fn light(&self, find: &mut Find<'_>, value: &mut Contributions) -> f64 {
        let builder = Bidirectional {
            settings: find.settings,
            ..self.builder
        };
        builder.build(self.scene, find.u, value);
        SpecularSplit::of(value, self.target).specular
    }

    /// Passes are independent of each other: their spread tells their error.
    fn scramble(&self, pass: u64, cell: usize) -> u64 {
        mix(self.seed ^ mix(pass)) ^ cell as u64
    }
}
