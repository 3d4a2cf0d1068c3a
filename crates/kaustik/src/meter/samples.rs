//! Samples of the light of a cell of the image, of two kinds.

use kaustik_estimate::ScalarTarget;
use kaustik_mcmc::{Exponential, Independent, Point, SampleGenerators, Step};
use kaustik_path::{
    Beginning, Bidirectional, Class, Contributions, Form, PathBuilder, Sighting, sight,
};
use kaustik_scene::Scene;

use super::grid::Grid;
use crate::RenderSettings;
use crate::render::builder_settings;
use crate::stratified::{Stratified, mix};

/// Where a sample is made.
#[derive(Clone, Copy)]
pub(super) struct At {
    /// Its number among all.
    pub(super) step: u64,
    pub(super) pass: u64,
    pub(super) cell: usize,
    /// Its number among those of the cell and pass.
    pub(super) index: u64,
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
    point: Point<Exponential>,
    pub(super) value: Contributions,
}

impl Default for Scratch {
    fn default() -> Self {
        Self {
            point: Point::new(Exponential::default()),
            value: Contributions::default(),
        }
    }
}

impl<'a> Samples<'a> {
    /// From generators of this number.
    pub(super) fn new(scene: &'a Scene, settings: &RenderSettings, stream: u64) -> Self {
        Self {
            scene,
            builder: Bidirectional {
                settings: builder_settings(settings),
                form: Form::Full,
                heuristic: settings.options.heuristic,
            },
            target: settings.options.target,
            seed: mix(settings.seed ^ mix(stream)),
            generators: SampleGenerators::new(settings.seed, stream),
            grid: Grid::new(settings),
        }
    }

    /// All light but the implicit specular that two walks joined in every way bring.
    pub(super) fn join(&self, at: At, Scratch { value, .. }: &mut Scratch) -> f64 {
        let (corner, size) = self.grid.place(at.cell);
        let inner = Independent::new(self.generators.at(at.step));
        let mut u = Stratified::new(
            inner,
            corner,
            size,
            at.index,
            self.scramble(at.pass, at.cell),
        );
        self.builder.build(self.scene, &mut u, value);
        self.light(value)[1]
    }

    /// How far a walk from the camera sees that begins so, and the implicit specular light there.
    pub(super) fn scout(
        &self,
        at: At,
        beginning: Beginning,
        Scratch { point, value }: &mut Scratch,
    ) -> (Sighting, f64) {
        let (corner, size) = self.grid.place(at.cell);
        let mut draws = self.generators.at(at.step);
        let mut proposal = point.propose(Step::Large, &mut draws);
        let scramble = self.scramble(!at.pass, at.cell);
        let mut u = Stratified::new(&mut proposal, corner, size, at.index, scramble);
        let settings = &self.builder.settings;
        let sighting = sight(settings, self.scene, beginning, &mut u);
        value.clear();
        if sighting == Sighting::Light {
            self.builder.build(self.scene, &mut u, value);
        }
        proposal.reject();
        (sighting, self.light(value)[0])
    }

    /// Passes are independent of each other: their spread tells their error.
    fn scramble(&self, pass: u64, cell: usize) -> u64 {
        mix(self.seed ^ mix(pass)) ^ cell as u64
    }

    /// The scalar contribution of implicit specular light, and of all other.
    fn light(&self, value: &Contributions) -> [f64; 2] {
        let classes = value.by_class(self.target);
        let specular = classes[Class::L0 as usize];
        let others = Class::ALL.into_iter().filter(|class| *class != Class::L0);
        [specular, others.map(|class| classes[class as usize]).sum()]
    }
}
