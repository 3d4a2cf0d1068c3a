//! Methods of independent samples: path tracing, light tracing, bidirectional path tracing; and of such
//! samples redistributed by short chains.

mod keep;
mod mark;
mod stream;

use std::sync::atomic::AtomicBool;

use kaustik_estimate::Scale;
use kaustik_film::{Counters, Film, Image, Layer, Quantum, develop};
use kaustik_mcmc::{Independent, Mean, SampleGenerators};
use kaustik_path::{
    Bidirectional, Contributions, Event, Form, LightTracing, PathBuilder, RayCounts, Remainder,
    Unidirectional, trace,
};
use kaustik_scene::Scene;
use rayon::prelude::*;

use crate::control::is_stopped;
use crate::engine::{Engine, Nonfinite, add_rays};
use crate::mark::FilmMark;
use crate::methods::builders::builder;
use crate::methods::builders::builder_settings;
use crate::methods::erpt_pss::{Chains, PssRedistribution};
use crate::sampling::cells::Cells;
use crate::sampling::streams;
use crate::{
    Budget, ChainStatistics, EnergyStatistics, RenderError, RenderSettings, StateError, StepId,
};
use mark::Mark;
use stream::{Job, SampleStream};

/// The pilot needs only the order of magnitude.
const PILOT_SHARE: u64 = 100;

/// Streams of independent samples on one film.
pub(crate) struct IndependentEngine<'a> {
    scene: &'a Scene,
    builder: Box<dyn PathBuilder + 'a>,
    film: Film,
    streams: Vec<SampleStream>,
    seed: u64,
    scale: Scale,
    /// Raster area of the window in pixels.
    area: f64,
    /// Methods with a walk from the camera visit the cells of a grid over the window in turn; light
    /// tracing has none.
    cells: Option<Cells>,
    /// A sample touches one pixel only.
    single_pixel: bool,
    lit: bool,
    redistribution: Option<PssRedistribution>,
    /// Where the last whole pass ended, where only whole ones count.
    mark: Mark,
    /// What the film holds while it is lent.
    aside: FilmMark,
}

impl<'a> IndependentEngine<'a> {
    pub(crate) fn path(scene: &'a Scene, settings: &RenderSettings) -> Result<Self, RenderError> {
        let builder = Unidirectional {
            settings: builder_settings(settings),
            next_event: settings.options.next_event,
        };
        let cells = Cells::new(settings);
        Self::new(scene, settings, Box::new(builder), Some(cells))
    }

    pub(crate) fn bdpt(scene: &'a Scene, settings: &RenderSettings) -> Result<Self, RenderError> {
        let builder = Bidirectional {
            settings: builder_settings(settings),
            form: Form::Full,
            heuristic: settings.options.heuristic,
        };
        let cells = Cells::new(settings);
        let engine = Self::new(scene, settings, Box::new(builder), Some(cells))?;
        Ok(engine.in_whole_passes())
    }

    /// Light that is joined to the lens falls on any pixel: only whole passes leave the picture even.
    pub(crate) fn in_whole_passes(self) -> Self {
        Self {
            single_pixel: false,
            ..self
        }
    }

    pub(crate) fn light(scene: &'a Scene, settings: &RenderSettings) -> Result<Self, RenderError> {
        let builder = LightTracing {
            settings: builder_settings(settings),
        };
        Self::new(scene, settings, Box::new(builder), None)
    }

    /// What the photon methods leave out.
    pub(crate) fn remainder(
        scene: &'a Scene,
        settings: &RenderSettings,
    ) -> Result<Self, RenderError> {
        let builder = Remainder {
            settings: builder_settings(settings),
            threshold: settings.options.photon.roughness,
        };
        let cells = Cells::new(settings);
        let engine = Self::new(scene, settings, Box::new(builder), Some(cells))?;
        // An iteration that is broken off takes its passes back.
        Ok(engine.in_whole_passes())
    }

    /// Samples of any builder, each redistributed over the image by short chains.
    pub(crate) fn erpt_pss(
        scene: &'a Scene,
        settings: &RenderSettings,
    ) -> Result<Self, RenderError> {
        let cells = Cells::new(settings);
        let engine = Self::new(scene, settings, builder(scene, settings)?, Some(cells))?;
        let film = |_| Film::with_layout(&settings.layout(), engine.film.quantum());
        let held = settings.options.consecutive.map(film).transpose()?;
        let builder = engine.builder.as_ref();
        let redistribution = PssRedistribution::new(scene, builder, settings, held);
        let mut streams = engine.streams;
        for stream in &mut streams {
            stream.chains = Some(Box::new(Chains::new(settings, stream.ladder)));
        }
        // Chains leave their pixel: only whole passes leave the picture even.
        Ok(Self {
            streams,
            single_pixel: false,
            redistribution: Some(redistribution),
            ..engine
        })
    }

    /// Samples of any builder; `cells` if its walks begin at the camera.
    pub(crate) fn new(
        scene: &'a Scene,
        settings: &RenderSettings,
        builder: Box<dyn PathBuilder + 'a>,
        cells: Option<Cells>,
    ) -> Result<Self, RenderError> {
        let layout = settings.layout();
        let mean = pilot(scene, builder.as_ref(), settings);
        let stream = |ladder| SampleStream {
            ladder,
            step: 0,
            generators: SampleGenerators::new(settings.seed, u64::from(ladder)),
            value: Contributions::default(),
            nonfinite: Nonfinite::default(),
            rays: RayCounts::default(),
            chains: None,
        };
        Ok(Self {
            scene,
            builder,
            film: Film::with_layout(&layout, Quantum::from_sum_of_xyz(mean))?,
            streams: settings.ladder_range().map(stream).collect(),
            seed: settings.seed,
            scale: settings.scale(),
            area: layout.extended_bounds().area(),
            cells,
            single_pixel: layout.filter.is_single_pixel(),
            lit: scene.has_light(),
            redistribution: None,
            mark: Mark::default(),
            aside: FilmMark::default(),
        })
    }

    /// What all streams have in common, and the streams.
    fn parts<'s>(&'s mut self, stop: Option<&'s AtomicBool>) -> (Job<'s>, &'s mut [SampleStream]) {
        let job = Job {
            seed: self.seed,
            scene: self.scene,
            builder: self.builder.as_ref(),
            film: &self.film,
            scale: self.scale,
            cells: self.cells,
            stop,
            redistribution: self.redistribution.as_ref(),
        };
        (job, &mut self.streams)
    }

    /// Samples of all streams.
    pub(crate) fn steps(&self) -> u64 {
        self.streams.iter().map(|stream| stream.step).sum()
    }

    /// Whole passes of all streams; `None` if they differ, or in the middle of one.
    fn passes(&self) -> Option<u64> {
        let cells = self.cells?;
        let all: Vec<_> = (self.streams.iter())
            .map(|stream| stream.passes(&cells))
            .collect();
        all_equal(&all)
    }

    /// The chains of all streams, where the method has any.
    fn chains(&self) -> impl Iterator<Item = &Chains> {
        self.streams.iter().filter_map(|s| s.chains.as_deref())
    }

    /// The picture of all steps taken.
    pub(crate) fn picture(&self) -> Result<Image, RenderError> {
        let Some(cells) = self.cells else {
            let factor = self.area / self.steps().max(1) as f64;
            return Ok(develop(&[(&self.film, factor)])?);
        };
        let cell_area = self.area / cells.count() as f64;
        if let Some(passes) = self.passes() {
            return Ok(develop(&[(&self.film, cell_area / passes.max(1) as f64)])?);
        }
        if !self.single_pixel {
            return Err(StateError::passes().into());
        }
        // Every pixel has its own number of samples (one pixel a cell).
        let mut image = develop(&[(&self.film, 1.0)])?;
        let mut factors = vec![0.0_f32; cells.count() as usize];
        for stream in &self.streams {
            let [first, end] = cells.of_ladder(stream.ladder);
            for cell in first..end {
                let visits = stream.visits(&cells, cell - first);
                factors[cell as usize] = if visits > 0 { 1.0 / visits as f32 } else { 0.0 };
            }
        }
        image.scale_pixels(|index| factors[index]);
        Ok(image)
    }
}

/// Rough mean of X + Y + Z over the window, for the film's quantum.
fn pilot(scene: &Scene, builder: &dyn PathBuilder, settings: &RenderSettings) -> f64 {
    let share = settings.options.pilot / PILOT_SHARE;
    let samples = share.min(settings.pilot()).max(1);
    let generators = SampleGenerators::new(settings.seed, streams::PILOT);
    let mut value = Contributions::default();
    let mut mean = Mean::new();
    for index in 0..samples {
        let draws = generators.at(index);
        builder.build(scene, &mut Independent::new(draws), &mut value);
        mean.push(
            value
                .splats()
                .iter()
                .map(|splat| f64::from(splat.xyz.sum()))
                .sum(),
        );
    }
    mean.mean()
}

impl Engine for IndependentEngine<'_> {
    fn advance(&mut self, plan: &[u64], stop: Option<&AtomicBool>) -> u64 {
        let before = self.steps();
        // A pass that is broken off leaves the picture uneven; where samples touch more than their own pixel
        // nothing could make it even again, so that it is taken back.
        let evenly = self.cells.is_some() && !self.single_pixel;
        if evenly && stop.is_some() {
            self.mark();
        }
        let (job, streams) = self.parts(stop);
        streams
            .par_iter_mut()
            .zip(plan)
            .with_max_len(1)
            .for_each(|(stream, &steps)| stream.run(&job, steps));
        if evenly && is_stopped(stop) && self.steps() < before + plan.iter().sum::<u64>() {
            self.take_back();
        }
        self.steps() - before
    }

    fn pass(&self) -> Option<u64> {
        self.cells.map(|cells| cells.count())
    }

    fn planned(&self, ladder: u32, settings: &RenderSettings) -> u64 {
        let Some(cells) = &self.cells else {
            return settings.planned(ladder);
        };
        match settings.budget {
            // Samples of a last, broken pass go to the first cells of each ladder; where they touch
            // more than their own pixel, passes are whole, at least one.
            Budget::Total(n) if self.single_pixel => {
                let [first, end] = cells.of_ladder(ladder);
                n / cells.count() * (end - first) + cells.share(n % cells.count(), [first, end])
            }
            budget => cells.whole_passes(ladder, budget),
        }
    }

    fn grain(&self, ladder: u32) -> u64 {
        self.cells.map_or(1, |cells| {
            let [first, end] = cells.of_ladder(ladder);
            end - first
        })
    }

    fn develop(&mut self) -> Result<Image, RenderError> {
        let image = self.picture()?;
        // Chains go by whole passes.
        let passes = self.passes();
        if let (Some(redistribution), Some(cells), Some(passes)) =
            (&mut self.redistribution, &self.cells, passes)
        {
            let per_sample = self.area / cells.count() as f64 / passes.max(1) as f64;
            redistribution.see(&self.film, per_sample)?;
        }
        Ok(image)
    }

    fn holds_back(&self) -> bool {
        self.redistribution.is_some()
    }

    fn chain_statistics(&self) -> Option<ChainStatistics> {
        Some(self.redistribution.as_ref()?.statistics(self.chains()))
    }

    fn energy_statistics(&self) -> Option<EnergyStatistics> {
        let redistribution = self.redistribution.as_ref()?;
        Some(redistribution.energy(self.steps(), self.chains()))
    }

    fn layers(&self) -> Result<Vec<Layer>, RenderError> {
        let lost = self.redistribution.iter();
        Ok(lost.filter_map(PssRedistribution::layer).collect())
    }

    fn nonfinite(&self) -> (u64, Vec<StepId>) {
        Nonfinite::all(
            self.streams
                .iter()
                .map(|stream| (stream.ladder, stream.nonfinite)),
        )
    }

    /// Samples follow from their number alone; how many chains one has, from those of its cell before it.
    fn replay(&mut self, StepId { ladder, step }: StepId) -> Result<Vec<Event>, RenderError> {
        let pass = self.grain(ladder);
        if pass == 0 {
            // a ladder without cells has no samples
            return Ok(Vec::new());
        }
        let (job, streams) = self.parts(None);
        let Some(stream) = streams.iter_mut().find(|s| s.ladder == ladder) else {
            return Ok(Vec::new());
        };
        if stream.chains.is_some() {
            for earlier in (step % pass..step).step_by(pass as usize) {
                stream.step = earlier;
                stream.run(&job, 1);
            }
        }
        stream.step = step;
        Ok(trace(|| stream.run(&job, 1)).1)
    }

    /// Not of what is redistributed: its chains do not count them.
    fn rays(&self) -> Option<RayCounts> {
        let none = self.redistribution.is_none();
        none.then(|| add_rays(self.streams.iter().map(|stream| stream.rays)))
    }

    fn film_counters(&self) -> Counters {
        self.film.counters()
    }

    fn is_lit(&self) -> bool {
        self.lit
    }
}

/// The common number of passes; ladders without cells (`u64::MAX`) go with any.
fn all_equal(passes: &[Option<u64>]) -> Option<u64> {
    let mut common = None;
    for passes in passes.iter().filter(|passes| **passes != Some(u64::MAX)) {
        let passes = (*passes)?;
        if *common.get_or_insert(passes) != passes {
            return None;
        }
    }
    // Without any cells there is nothing to weigh.
    Some(common.unwrap_or(0))
}
