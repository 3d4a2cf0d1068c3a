//! What is seen directly, for some methods also by way of mirrors and smooth glass alone: purely specular paths, by
//! samples of their own.
//!
//! A lamp that fills few pixels is bright there and nothing elsewhere. A chain meets it by chance, and
//! the constant that scales its picture is an integral over all pixels, to which such a lamp brings nearly
//! all of the noise: in `ring-and-sphere` 70 times that of all other light of `relt`. A few camera rays know it
//! better than a million paths. Behind glass it is worse: what a ball shows of the lamp fills four of 65,000 pixels
//! there, which in two minutes no chain of `mlt` has met once. A lamp that fills a small part of a pixel is found
//! [from its own side](by_light).

mod by_light;
#[cfg(test)]
mod tests;

use std::io;

use kaustik_estimate::Scale;
use kaustik_film::{Counters, Film, Quantum};
use kaustik_mcmc::{Independent, SampleGenerators};
use kaustik_path::{
    BuilderSettings, Class, Contributions, Event, PathBuilder, PureSpecular, RayCounts,
    Unidirectional, trace,
};
use kaustik_scene::Scene;
use rayon::prelude::*;

use self::by_light::ByLight;
use crate::beside::Beside;
use crate::engine::Nonfinite;
use crate::methods::builders::builder_settings;
use crate::methods::direct;
use crate::sampling::cells::Cells;
use crate::sampling::stratified::mix;
use crate::sampling::streams;
use crate::state::{Reader, StateError, Writer};
use crate::{Builder, Method, RenderError, RenderSettings, StepId};

/// Samples a cell that tell where there is something to see. They are used for nothing else, so that
/// where one looks more closely does not depend on what is found there.
const LOOK: u64 = 4;
/// Numbers of the samples of that look: from here on, far from those that passes will have.
const FIRST_LOOK: u64 = u64::MAX / 2;
/// The same of samples from the emitters' own side, and of the look from there.
const FROM_LIGHT: u64 = u64::MAX / 4;
const FROM_LIGHT_LOOK: u64 = u64::MAX / 8;
/// The most samples in a cell that is looked at more closely, for each in another.
const CLOSELY: f64 = 1024.0;
/// Mutations a pixel for each pass but the first, where each mutation is a path of one strategy.
const EACH: u64 = 8;
/// The same where it is a path by all strategies, which takes as long as a dozen of these samples, or where something is seen by way of mirrors or glass,
/// which has more noise.
const EACH_OFTEN: u64 = 4;

/// Stratified samples of purely specular paths, in passes over a grid, one cell a pixel.
pub(crate) struct Lamps<'a> {
    scene: &'a Scene,
    builder: Box<dyn PathBuilder + 'a>,
    /// The same without emitters seen directly.
    others: Unidirectional,
    by_light: ByLight,
    film: Film,
    scale: Scale,
    seed: u64,
    generators: SampleGenerators,
    cells: Cells,
    /// Samples a pass in each cell.
    often: Vec<u64>,
    /// Mutations a pixel for each pass.
    each: u64,
    passes: u64,
    pixels: u64,
    /// Raster area of a cell in pixels.
    cell_area: f64,
    lit: bool,
    rays: RayCounts,
    nonfinite: Nonfinite,
}

/// Mutations a pixel for each pass, where nothing is seen by way of mirrors.
fn each(settings: &RenderSettings) -> u64 {
    let bidirectional = settings.options.builder == Builder::Bidirectional;
    match settings.method {
        Method::Relt | Method::Annealing => EACH_OFTEN,
        Method::Pssmlt | Method::PssmltMultistage if bidirectional => EACH_OFTEN,
        // whose samples count as several mutations
        Method::Erpt => 2 * EACH,
        _ => EACH,
    }
}

/// How the samples of a cell and its neighbours differ.
#[derive(Clone, Copy, Debug)]
struct Spread {
    /// Standard deviation of X + Y + Z.
    deviation: f32,
    /// The same over the mean; 0 where nothing was seen.
    relative: f32,
}

/// What a few samples of a cell saw. Less than a film has of a pixel.
#[derive(Clone, Copy, Debug)]
struct Look {
    /// X + Y + Z of all samples together.
    light: f64,
    /// Root of the sum of its squares.
    root: f32,
    /// Was some of it seen by way of a mirror or glass?
    specular: bool,
    /// Did a walk go on from a mirror or through glass, whatever it saw?
    onward: bool,
}

impl<'a> Lamps<'a> {
    /// Takes the first pass. `None` if the chains see to all light themselves.
    pub(crate) fn new(
        scene: &'a Scene,
        settings: &RenderSettings,
    ) -> Result<Option<Self>, RenderError> {
        let Some(edges) = direct::edges_of_lamps(settings) else {
            return Ok(None);
        };
        let paths = Unidirectional {
            settings: BuilderSettings {
                min_edges: *edges.start(),
                max_edges: *edges.end(),
                pure_specular: PureSpecular::Alone,
                ..builder_settings(settings)
            },
            next_event: false,
        };
        Self::with_builder(scene, settings, paths, Box::new(paths)).map(Some)
    }

    /// The same with any builder in place of one of these paths.
    pub(crate) fn with_builder(
        scene: &'a Scene,
        settings: &RenderSettings,
        paths: Unidirectional,
        builder: Box<dyn PathBuilder + 'a>,
    ) -> Result<Self, RenderError> {
        let layout = settings.layout();
        let cells = Cells::new(settings);
        let generators = SampleGenerators::new(settings.seed, streams::LAMPS);
        let mut others = paths;
        others.settings.emitters_seen = false;
        let mut lamps = Self {
            scene,
            builder,
            others,
            by_light: ByLight::new(paths.settings, cells, generators),
            // until a first look tells the quantum: two large films would be one too many
            film: Film::new(1, 1, Quantum::FALLBACK)?,
            scale: settings.scale(),
            seed: settings.seed,
            generators,
            cells,
            often: Vec::new(),
            each: each(settings),
            passes: 0,
            pixels: settings.pixels(),
            cell_area: layout.extended_bounds().area() / cells.count() as f64,
            lit: false,
            rays: RayCounts::default(),
            nonfinite: Nonfinite::default(),
        };
        let seen = lamps.look();
        let found = lamps.by_light.look(scene, FROM_LIGHT_LOOK);
        let seen_mean =
            seen.iter().map(|look| look.light).sum::<f64>() / (cells.count() * LOOK) as f64;
        // of a lamp that is small one of the two is far too low
        let mean = seen_mean.max(found.mean);
        if seen.iter().any(|look| look.specular) {
            lamps.each = EACH_OFTEN;
        }
        lamps.film = Film::with_layout(&layout, Quantum::from_sum_of_xyz(mean))?;
        lamps.often = lamps.closely(&seen);
        lamps.by_light.take(lamps.cells_by_light(&found.often));
        lamps.keep_up(0);
        lamps.lit = lamps.film.sums().any(|sum| sum != 0);
        Ok(lamps)
    }

    /// A few samples in each cell.
    fn look(&self) -> Vec<Look> {
        let cells = 0..self.cells.count() as usize;
        let look = |value: &mut Contributions, cell| {
            let (mut sum, mut squares, mut specular, mut onward) = (0.0, 0.0, false, false);
            for index in self.first_look() {
                self.build(cell as u64, index, value);
                let splats = value.splats();
                let light: f64 = splats.iter().map(|s| f64::from(s.xyz.sum())).sum();
                sum += light;
                squares += light * light;
                specular |= splats.iter().any(|splat| splat.class == Class::L0);
                // other walks end at what they meet first
                onward |= value.rays().closest > 1;
            }
            Look {
                light: sum,
                root: squares.sqrt() as f32,
                specular,
                onward,
            }
        };
        (cells.into_par_iter().with_min_len(256))
            .map_init(Contributions::default, look)
            .collect()
    }

    /// How often each cell is sampled in a pass: once, and as many samples again as there are cells fall to those
    /// where samples differ: half of them by the standard deviation, which is what gives the least squared error, half
    /// by its ratio to the mean, for the least relative one. The inside of a lamp and an even sky ask for nothing more; what costs is
    /// the outline of whatever stands before them. Where mirrors or glass are seen, a third each, and a third to all cells that see some: behind
    /// several reflections a lamp may be too small for a few samples to have met it.
    fn closely(&self, seen: &[Look]) -> Vec<u64> {
        let spread = self.spread(seen);
        let sum = |of: fn(&Spread) -> f32| {
            let all = spread.iter().map(|spread| f64::from(of(spread)));
            all.sum::<f64>().max(f64::MIN_POSITIVE)
        };
        let deviations = sum(|spread| spread.deviation);
        let relatives = sum(|spread| spread.relative);
        let onward = seen.iter().filter(|look| look.onward).count();
        let parts = if onward > 0 { 3.0 } else { 2.0 };
        let share = self.cells.count() as f64 / parts;
        let often = |(spread, look): (&Spread, &Look)| {
            let by_spread =
                f64::from(spread.deviation) / deviations + f64::from(spread.relative) / relatives;
            let by_mirrors = if look.onward {
                1.0 / onward as f64
            } else {
                0.0
            };
            let wanted = 1.0 + share * (by_spread + by_mirrors);
            // what is not a number becomes 0, then 1
            (wanted.round().clamp(1.0, CLOSELY) as u64).max(1)
        };
        spread.iter().zip(seen).map(often).collect()
    }

    /// How the samples of each cell and of its neighbours differ: a few of its own alone would often tell nothing of an
    /// outline that crosses it.
    fn spread(&self, seen: &[Look]) -> Vec<Spread> {
        let (columns, rows) = (self.cells.columns() as usize, self.cells.rows() as usize);
        let around = |at: usize, side: usize| at.saturating_sub(1)..(at + 2).min(side);
        let of = |cell: usize| {
            let (x, y) = (cell % columns, cell / columns);
            let near = around(y, rows).flat_map(|y| around(x, columns).map(move |x| (x, y)));
            let near = near.map(|(x, y)| &seen[y * columns + x]);
            let (mut count, mut sum, mut squares) = (0, 0.0, 0.0);
            for look in near {
                count += LOOK;
                sum += look.light;
                squares += f64::from(look.root) * f64::from(look.root);
            }
            let mean = sum / count as f64;
            let variance = squares / count as f64 - mean * mean;
            let deviation = variance.max(0.0).sqrt();
            let relative = if mean > 0.0 { deviation / mean } else { 0.0 };
            Spread {
                deviation: deviation as f32,
                relative: relative as f32,
            }
        };
        (0..columns * rows).map(of).collect()
    }

    /// Which cells show emitters by samples from their own side: those of which more are seen there than would give
    /// camera rays the same error. `found` is how many a pass has in each.
    fn cells_by_light(&self, found: &[u32]) -> Vec<bool> {
        let mut value = Contributions::default();
        let by_light = |(cell, (&found, &often)): (u64, (&u32, &u64))| {
            if found == 0 {
                return false;
            }
            // of n rays that meet a lamp with probability p, the squared error is that of n p / (1 - p) samples of it
            let met = self.met(cell, &mut value) as f64;
            let missed = LOOK as f64 - met;
            f64::from(found) * missed > often as f64 * (met + 0.5)
        };
        (0..)
            .zip(found.iter().zip(&self.often))
            .map(by_light)
            .collect()
    }

    /// How many samples of a first look have met an emitter directly in a cell.
    fn met(&self, cell: u64, value: &mut Contributions) -> usize {
        let mut light = |paths: &dyn PathBuilder, index| {
            self.build_with(paths, cell, index, value);
            value.splats().iter().map(|s| s.xyz.sum()).sum::<f32>()
        };
        self.first_look()
            .filter(|&index| light(&*self.builder, index) > light(&self.others, index))
            .count()
    }

    /// Indices of a first look in a cell.
    fn first_look(&self) -> std::ops::Range<u64> {
        let first = FIRST_LOOK / self.cells.count();
        first..first + LOOK
    }

    /// The sample of this index in a cell.
    fn build(&self, cell: u64, index: u64, value: &mut Contributions) {
        let by_light = self.by_light.has(cell);
        let paths: &dyn PathBuilder = if by_light {
            &self.others
        } else {
            &*self.builder
        };
        self.build_with(paths, cell, index, value);
    }

    /// The same by a builder.
    fn build_with(
        &self,
        paths: &dyn PathBuilder,
        cell: u64,
        index: u64,
        value: &mut Contributions,
    ) {
        let inner = Independent::new(self.generators.at(self.step(cell, index)));
        let mut coordinates = (self.cells).confine((cell, index), mix(self.seed), inner);
        paths.build(self.scene, &mut coordinates, value);
    }

    /// The number of a sample among all: that of its generator.
    fn step(&self, cell: u64, index: u64) -> u64 {
        index * self.cells.count() + cell
    }

    /// Tells what happens in the sample of this number.
    pub(crate) fn replay(&self, step: u64) -> Vec<Event> {
        let (index, cell) = (step / self.cells.count(), step % self.cells.count());
        let mut value = Contributions::default();
        let from_light = FROM_LIGHT..FIRST_LOOK;
        trace(|| {
            if from_light.contains(&step) {
                self.by_light.build(self.scene, step, &mut value);
            } else {
                self.build(cell, index, &mut value);
            }
        })
        .1
    }

    /// Writes the passes so far.
    pub(crate) fn write(&self, out: &mut Writer<'_>) -> io::Result<()> {
        out.value(&(self.passes, self.rays, self.nonfinite))?;
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
    pub(crate) fn nonfinite(&self) -> (u64, Vec<StepId>) {
        Nonfinite::all(std::iter::once((StepId::LAMPS, self.nonfinite)))
    }

    /// The rays of the passes.
    pub(crate) fn rays(&self) -> RayCounts {
        self.rays
    }

    /// What the film left out.
    pub(crate) fn film_counters(&self) -> Counters {
        self.film.counters()
    }
}

impl Beside for Lamps<'_> {
    const NAME: &'static str = "light seen directly";

    fn due(&self, mutations: u64) -> u64 {
        1 + mutations / (self.each * self.pixels)
    }

    fn keep_up(&mut self, mutations: u64) {
        let due = self.due(mutations);
        let passes = self.passes..due.max(self.passes);
        self.passes = passes.end;
        let this = &*self;
        let sample = |value: &mut Contributions, (cell, &often): (usize, &u64)| {
            let (mut faults, mut rays) = (Nonfinite::default(), RayCounts::default());
            for index in passes.start * often..passes.end * often {
                this.build(cell as u64, index, value);
                rays += value.rays();
                faults.count(u64::from(value.nonfinite()), this.step(cell as u64, index));
                this.scale.splat(&this.film, value, 1.0 / often as f64);
            }
            (faults, rays)
        };
        let from_light = |value: &mut Contributions, number: u64| {
            let number = FROM_LIGHT + number;
            this.by_light.build(this.scene, number, value);
            let mut faults = Nonfinite::default();
            faults.count(u64::from(value.nonfinite()), number);
            if this.by_light.counts(value) {
                this.scale.splat(&this.film, value, 1.0);
            }
            (faults, value.rays())
        };
        let both = |(faults, mut rays): (Nonfinite, RayCounts),
                    (others, more): (Nonfinite, RayCounts)| {
            rays += more;
            (faults.and(others), rays)
        };
        let of_cells = (this.often.par_iter().enumerate().with_min_len(256))
            .map_init(Contributions::default, sample)
            .reduce(Default::default, both);
        let each = this.by_light.each();
        let of_light = passes.map(|pass| {
            (0..each as usize)
                .into_par_iter()
                .with_min_len(256)
                .map_init(Contributions::default, |value, i| {
                    from_light(value, pass * each + i as u64)
                })
                .reduce(Default::default, both)
        });
        let (found, rays) = of_light.fold(of_cells, both);
        self.nonfinite = self.nonfinite.and(found);
        self.rays += rays;
    }

    fn take_up(&mut self, from: &mut Reader<'_>) -> Result<u64, StateError> {
        let (passes, rays, nonfinite): (u64, RayCounts, Nonfinite) = from.value()?;
        let (passes, nonfinite) = (Reader::count(passes)?.max(1), nonfinite.checked()?);
        for count in [rays.closest, rays.any] {
            Reader::count(count)?;
        }
        let wanted = from.is_first() || passes > self.passes;
        from.film_instead(&mut self.film, wanted)?;
        if wanted {
            self.passes = passes;
            self.rays = rays;
            self.nonfinite = nonfinite;
        }
        Ok(passes)
    }
}
