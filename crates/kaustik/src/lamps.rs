//! What is seen directly: paths of one edge, by samples of their own.
//!
//! A lamp that fills few pixels is bright there and nothing elsewhere. A chain meets it by chance, and
//! the constant that scales its picture is an integral over all pixels, to which such a lamp brings nearly
//! all of the noise: in `ring-and-sphere` 70 times that of all other light of `relt`. A few camera rays know it
//! better than a million paths.

use std::io;

use kaustik_estimate::Scale;
use kaustik_film::{Counters, Film, Quantum};
use kaustik_mcmc::{Independent, SampleGenerators};
use kaustik_path::{
    BuilderSettings, Contributions, Event, PathBuilder, Rays, Unidirectional, trace,
};
use kaustik_scene::Scene;
use rayon::prelude::*;

use crate::beside::Beside;
use crate::cells::Cells;
use crate::engine::Nonfinite;
use crate::render::builder_settings;
use crate::state::{Reader, StateError, Writer};
use crate::stratified::{Stratified, mix};
use crate::streams;
use crate::{Place, RenderError, RenderSettings, direct};

/// Samples a cell that tell where there is something to see. They are used for nothing else, so that
/// where one looks more closely does not depend on what is found there.
const LOOK: u64 = 4;
/// The most samples in a cell that is looked at more closely, for each in another.
const CLOSELY: u64 = 1024;
/// Mutations a pixel for each pass but the first.
const EACH: u64 = 16;

/// Stratified samples of what is seen directly, in passes over a grid, one cell a pixel.
pub(crate) struct Lamps<'a> {
    scene: &'a Scene,
    builder: Box<dyn PathBuilder + 'a>,
    film: Film,
    scale: Scale,
    seed: u64,
    generators: SampleGenerators,
    cells: Cells,
    /// Samples a pass in each cell.
    often: Vec<u64>,
    passes: u64,
    pixels: u64,
    /// Raster area of a cell in pixels.
    cell_area: f64,
    lit: bool,
    nonfinite: Nonfinite,
}

impl<'a> Lamps<'a> {
    /// Takes the first pass. `None` if the chains see to all light themselves.
    pub(crate) fn new(
        scene: &'a Scene,
        settings: &RenderSettings,
    ) -> Result<Option<Self>, RenderError> {
        if !direct::are_lamps(settings) {
            return Ok(None);
        }
        let paths = Unidirectional {
            settings: BuilderSettings {
                min_edges: 1,
                max_edges: 1,
                ..builder_settings(settings)
            },
            next_event: false,
        };
        Self::with_builder(scene, settings, Box::new(paths)).map(Some)
    }

    /// The same with any builder.
    pub(crate) fn with_builder(
        scene: &'a Scene,
        settings: &RenderSettings,
        builder: Box<dyn PathBuilder + 'a>,
    ) -> Result<Self, RenderError> {
        let layout = settings.layout();
        let cells = Cells::new(settings);
        let mut direct = Self {
            scene,
            builder,
            // until a first look tells the quantum: two large films would be one too many
            film: Film::new(1, 1, Quantum::FALLBACK)?,
            scale: settings.scale(),
            seed: settings.seed,
            generators: SampleGenerators::new(settings.seed, streams::LAMPS),
            cells,
            often: Vec::new(),
            passes: 0,
            pixels: settings.pixels(),
            cell_area: layout.extended_bounds().area() / cells.count() as f64,
            lit: false,
            nonfinite: Nonfinite::default(),
        };
        let seen = direct.look();
        let mean = seen.iter().sum::<f64>() / (cells.count() * LOOK) as f64;
        direct.film = Film::with_layout(&layout, Quantum::from_sum_of_xyz(mean))?;
        direct.often = direct.closely(&seen);
        direct.keep_up(0);
        direct.lit = direct.film.sums().any(|sum| sum != 0);
        Ok(direct)
    }

    /// X + Y + Z of a few samples in each cell.
    fn look(&self) -> Vec<f64> {
        let cells = 0..self.cells.count() as usize;
        let look = |value: &mut Contributions, cell| {
            let samples = (0..LOOK).map(|index| {
                // far from the indices that passes will have
                self.build(
                    cell as u64,
                    u64::MAX / self.cells.count() / 2 + index,
                    value,
                );
                (value.splats().iter())
                    .map(|s| f64::from(s.xyz.sum()))
                    .sum::<f64>()
            });
            samples.sum()
        };
        (cells.into_par_iter().with_min_len(256))
            .map_init(Contributions::default, look)
            .collect()
    }

    /// Cells where something was seen, and their neighbours, are looked at more often: as many samples as
    /// all cells have together are spent there.
    fn closely(&self, seen: &[f64]) -> Vec<u64> {
        let (columns, rows) = (self.cells.columns() as i64, self.cells.rows() as i64);
        let lit = |x: i64, y: i64| {
            let inside = (0..columns).contains(&x) && (0..rows).contains(&y);
            inside && seen[(y * columns + x) as usize] > 0.0
        };
        let near = |cell: i64| {
            let (x, y) = (cell % columns, cell / columns);
            (-1..=1).any(|dy| (-1..=1).any(|dx| lit(x + dx, y + dy)))
        };
        let close: Vec<bool> = (0..columns * rows).map(near).collect();
        let count = close.iter().filter(|close| **close).count() as u64;
        let often = (self.cells.count() / count.max(1)).clamp(1, CLOSELY);
        let of = |close| if close { often } else { 1 };
        close.into_iter().map(of).collect()
    }

    /// The sample of this index in a cell.
    fn build(&self, cell: u64, index: u64, value: &mut Contributions) {
        let columns = self.cells.columns();
        let corner = [cell % columns, cell / columns].map(|at| at as f64);
        let size = [columns, self.cells.rows()].map(|side| 1.0 / side as f64);
        let inner = Independent::new(self.generators.at(self.step(cell, index)));
        let seed = mix(self.seed) ^ cell;
        let mut coordinates = Stratified::new(inner, corner, size, index, seed);
        self.builder.build(self.scene, &mut coordinates, value);
    }

    /// The number of a sample among all: that of its generator.
    fn step(&self, cell: u64, index: u64) -> u64 {
        index * self.cells.count() + cell
    }

    /// Tells what happens in the sample of this number.
    pub(crate) fn replay(&self, step: u64) -> Vec<Event> {
        let (index, cell) = (step / self.cells.count(), step % self.cells.count());
        let mut value = Contributions::default();
        trace(|| self.build(cell, index, &mut value)).1
    }

    /// Writes the passes so far.
    pub(crate) fn write(&self, out: &mut Writer<'_>) -> io::Result<()> {
        out.value(&(self.passes, self.nonfinite))?;
        out.film(&self.film)
    }

    /// The film, with what turns it into a part of the picture.
    pub(crate) fn part(&self) -> (&Film, f64) {
        (&self.film, self.cell_area / self.passes as f64)
    }

    /// Has anything been seen?
    pub(crate) fn is_lit(&self) -> bool {
        self.lit
    }

    /// Contributions left out because they were not finite, and the first samples where that was so.
    pub(crate) fn nonfinite(&self) -> (u64, Vec<Place>) {
        Nonfinite::all(std::iter::once((Place::LAMPS, self.nonfinite)))
    }

    /// One ray a sample of the passes, to the first surface.
    pub(crate) fn rays(&self) -> Rays {
        Rays {
            closest: self.passes * self.often.iter().sum::<u64>(),
            any: 0,
        }
    }

    /// What the film left out.
    pub(crate) fn film_counters(&self) -> Counters {
        self.film.counters()
    }
}

impl Beside for Lamps<'_> {
    const NAME: &'static str = "light seen directly";

    fn due(&self, mutations: u64) -> u64 {
        1 + mutations / (EACH * self.pixels)
    }

    fn keep_up(&mut self, mutations: u64) {
        let due = self.due(mutations);
        let passes = self.passes..due.max(self.passes);
        self.passes = passes.end;
        let this = &*self;
        let sample = |value: &mut Contributions, (cell, &often): (usize, &u64)| {
            let mut faults = Nonfinite::default();
            for index in passes.start * often..passes.end * often {
                this.build(cell as u64, index, value);
                faults.count(u64::from(value.nonfinite()), this.step(cell as u64, index));
                this.scale.splat(&this.film, value, 1.0 / often as f64);
            }
            faults
        };
        let found = (this.often.par_iter().enumerate().with_min_len(256))
            .map_init(Contributions::default, sample)
            .reduce(Nonfinite::default, Nonfinite::and);
        self.nonfinite = self.nonfinite.and(found);
    }

    fn take_up(&mut self, from: &mut Reader<'_>) -> Result<u64, StateError> {
        let (passes, nonfinite): (u64, Nonfinite) = from.value()?;
        let (passes, nonfinite) = (Reader::count(passes)?.max(1), nonfinite.checked()?);
        let wanted = from.is_first() || passes > self.passes;
        from.film_instead(&mut self.film, wanted)?;
        if wanted {
            self.passes = passes;
            self.nonfinite = nonfinite;
        }
        Ok(passes)
    }
}
