//! Energy redistribution on paths (Cline, Talbot and Egbert 2005).
//!
//! Every pixel is sampled by a path tracer. Each path that a sample finds brings light, its
//! multiple-importance weight included; chains of perturbations carry equal parts of it to neighbouring paths,
//! as many chains as it has parts, and every part falls in the colour of the path that it
//! falls on. The mean is the path tracer's whatever the chains do.

mod films;
mod perturbations;
mod starts;
mod stream;

use std::io;
use std::sync::atomic::AtomicBool;

use glam::DVec2;
use kaustik_film::{Counters, Image, Layer};
use kaustik_mcmc::{Mean, RedistributionStatistics};
use kaustik_mutate::PathSpace;
use kaustik_path::Event;
use kaustik_scene::Scene;
use rayon::prelude::*;

use crate::beside::Besides;
use crate::beside::lamps::Lamps;
use crate::beside::lost::Lost;
use crate::control::is_stopped;
use crate::engine::{Engine, Nonfinite, add_counters, add_nonfinite};
use crate::mark::FilmMark;
use crate::methods::erpt_pss::{chains_a_sample, redistribution};
use crate::methods::path_space::path_space;
use crate::sampling::cells::Cells;
use crate::state::{Keep, Reader, StateError, Writer};
use crate::{
    ChainStatistics, EnergyStatistics, MutationStatistics, Options, RenderError, RenderSettings,
    StepId,
};
use films::Films;
use perturbations::{NAMES, Perturbations};
use stream::{Job, Light, Stream};

/// What a sample takes beside its chains, in mutations: samples beside them go by these.
const SAMPLE: u64 = 8;

/// Ladders, each with a band of the image to sample, on one film.
pub(crate) struct ErptEngine<'a> {
    space: PathSpace<'a>,
    options: Options,
    size: DVec2,
    seed: u64,
    cells: Cells,
    films: Films,
    besides: Besides<'a>,
    streams: Vec<Stream>,
    /// Light to be spread of the pilot's samples.
    pilot: Mean,
    /// What the filters took away, as of the last picture.
    lost: Vec<Lost>,
    /// Where the last whole pass ended.
    mark: (Vec<FilmMark>, Vec<stream::Kept>),
}

impl<'a> ErptEngine<'a> {
    /// Draws the pilot that fixes the light of a deposit (Batty's Algorithm 1): samples of its own, so that the
    /// light is a constant.
    pub(crate) fn new(scene: &'a Scene, settings: &RenderSettings) -> Result<Self, RenderError> {
        let mut options = settings.options;
        let size = DVec2::new(f64::from(settings.width), f64::from(settings.height));
        let space = path_space(scene, settings)?;
        let (mut pilot, mut all) = (Mean::new(), Mean::new());
        for light in starts::pilot(
            &space,
            &Perturbations::new(&space, &options, size),
            settings,
        ) {
            pilot.push(light[0]);
            all.push(light[1]);
        }
        options.chains = Some(chains_a_sample(&options, &pilot));
        let plan = redistribution(&options, pilot.mean());
        let stream = |ladder| Stream::new(settings, ladder, plan);
        Ok(Self {
            films: Films::new(settings, all.mean())?,
            besides: Besides::of_lamps(Lamps::new(scene, settings)?),
            cells: Cells::new(settings),
            streams: settings.ladder_range().map(stream).collect(),
            seed: settings.seed,
            space,
            options,
            size,
            pilot,
            lost: Vec::new(),
            mark: Default::default(),
        })
    }

    /// All ladders' chains and light, in their order.
    fn all(&self) -> (RedistributionStatistics, Light) {
        let (mut chains, mut light) = (RedistributionStatistics::default(), Light::default());
        for stream in &self.streams {
            chains.merge(stream.redistributor.statistics());
            light.merge(&stream.light);
        }
        (chains, light)
    }

    fn steps(&self) -> u64 {
        self.streams.iter().map(|stream| stream.step).sum()
    }

    /// What so many samples and their chains amount to, in mutations.
    fn mutations(&self, samples: u64) -> u64 {
        let chains = chains_a_sample(&self.options, &self.pilot) * f64::from(self.options.length);
        samples.saturating_mul(SAMPLE.saturating_add(chains as u64))
    }

    /// Takes the samples beside those so far.
    fn keep_up(&mut self) {
        let mutations = self.mutations(self.steps());
        self.besides.keep_up(mutations);
    }

    /// Samples of the whole image that the passes so far amount to, in whatever part of it this process works.
    fn samples(&self) -> Result<f64, StateError> {
        let passes = self.streams.iter().filter_map(|stream| {
            let [first, end] = self.cells.of_ladder(stream.ladder);
            stream.step.checked_div(end - first)
        });
        let (least, most) = (passes.clone().min(), passes.max());
        if least != most {
            return Err(StateError::passes());
        }
        Ok((most.unwrap_or(0).max(1) * self.cells.count()) as f64)
    }

    /// Writes down where films and streams are.
    fn mark(&mut self) {
        let (films, streams) = &mut self.mark;
        self.films.mark(films);
        streams.clear();
        streams.extend(self.streams.iter().map(Stream::kept));
    }

    /// Goes back to there.
    fn take_back(&mut self) {
        let (films, streams) = &mut self.mark;
        self.films.take_back(films);
        for (stream, kept) in self.streams.iter_mut().zip(streams.drain(..)) {
            stream.go_to(kept);
        }
    }

    /// What streams share, and the streams.
    fn parts<'s>(&'s mut self, stop: Option<&'s AtomicBool>) -> (Job<'s>, &'s mut [Stream]) {
        let job = Job {
            space: &self.space,
            options: &self.options,
            perturbations: Perturbations::new(&self.space, &self.options, self.size),
            films: &self.films,
            cells: self.cells,
            seed: self.seed,
            pilot: self.pilot.mean(),
            stop,
        };
        (job, &mut self.streams)
    }

    fn lost(&self, on: bool, place: usize) -> Option<f64> {
        on.then(|| self.lost.get(place).map_or(0.0, |lost| lost.share))
    }
}

impl Engine for ErptEngine<'_> {
    fn advance(&mut self, plan: &[u64], stop: Option<&AtomicBool>) -> u64 {
        let before = self.steps();
        if stop.is_some() {
            self.mark();
        }
        let (job, streams) = self.parts(stop);
        streams
            .par_iter_mut()
            .zip(plan)
            .with_max_len(1)
            .for_each(|(stream, &steps)| stream.run(&job, steps));
        // Chains leave their pixel: a pass that is broken off could not be made even again.
        if is_stopped(stop) && self.steps() < before + plan.iter().sum::<u64>() {
            self.take_back();
        }
        self.keep_up();
        self.steps() - before
    }

    fn planned(&self, ladder: u32, settings: &RenderSettings) -> u64 {
        self.cells.whole_passes(ladder, settings.budget)
    }

    fn pass(&self) -> Option<u64> {
        Some(self.cells.count())
    }

    fn grain(&self, ladder: u32) -> u64 {
        let [first, end] = self.cells.of_ladder(ladder);
        end - first
    }

    fn develop(&mut self) -> Result<Image, RenderError> {
        let per_sample = self.size.element_product() / self.samples()?;
        let besides: Vec<_> = self.besides.parts().collect();
        let (image, lost) = self.films.develop(per_sample, &besides)?;
        self.lost = lost;
        Ok(image)
    }

    fn holds_back(&self) -> bool {
        false
    }

    fn chain_statistics(&self) -> Option<ChainStatistics> {
        let (chains, light) = self.all();
        let moves = &chains.chain.moves;
        let proposed: u64 = moves.iter().map(|kind| kind.proposed).sum();
        let expected: f64 = moves.iter().map(|kind| kind.expected).sum();
        let b = [light.all.mean(), light.all.standard_error()];
        Some(ChainStatistics {
            small_acceptance: expected / proposed.max(1) as f64,
            large_acceptance: 0.0,
            ..ChainStatistics::new(&chains.chain, b, self.pilot.mean())
        })
    }

    fn mutation_statistics(&self) -> Vec<MutationStatistics> {
        let (chains, _) = self.all();
        let kinds = NAMES.iter().zip(&chains.chain.moves);
        kinds
            .filter(|(_, moves)| moves.proposed > 0)
            .map(|(name, moves)| MutationStatistics {
                name,
                proposed: moves.proposed,
                acceptance: moves.rate(),
            })
            .collect()
    }

    fn energy_statistics(&self) -> Option<EnergyStatistics> {
        let (chains, light) = self.all();
        let (consecutive, proposed) = (
            self.options.consecutive.is_some(),
            self.options.proposed.is_some(),
        );
        Some(EnergyStatistics {
            consecutive_loss: self.lost(consecutive, 0),
            proposed_loss: self.lost(proposed, usize::from(consecutive)),
            ..EnergyStatistics::new(self.steps(), &chains, &light.sums)
        })
    }

    fn layers(&self) -> Result<Vec<Layer>, RenderError> {
        Ok(self.lost.iter().map(Lost::layer).collect())
    }

    fn nonfinite(&self) -> (u64, Vec<StepId>) {
        let ladders = self.streams.iter();
        let own = Nonfinite::all(ladders.map(|stream| (stream.ladder, stream.nonfinite)));
        add_nonfinite(own, Some(self.besides.nonfinite()))
    }

    /// The sample with its chains; none of a ladder without pixels.
    fn replay(&mut self, StepId { ladder, step }: StepId) -> Result<Vec<Event>, RenderError> {
        if self.grain(ladder) == 0 {
            return Ok(Vec::new());
        }
        let (job, streams) = self.parts(None);
        let stream = streams.first_mut();
        Ok(stream.map_or(Vec::new(), |stream| stream.replay(&job, step)))
    }

    fn film_counters(&self) -> Counters {
        add_counters(self.films.picture.counters(), self.besides.film_counters())
    }

    fn is_lit(&self) -> bool {
        self.space.scene.has_light()
    }
}

/// Films, and where each stream is; the pilot is drawn again, and compared.
impl Keep for ErptEngine<'_> {
    fn taken(&self) -> Vec<u64> {
        self.streams.iter().map(|stream| stream.step).collect()
    }

    fn write(&self, out: &mut Writer<'_>) -> io::Result<()> {
        out.value(&self.pilot)?;
        self.films.write(out)?;
        self.besides.write(out)?;
        (self.streams.iter()).try_for_each(|stream| out.value(&stream.kept()))
    }

    fn take_up(&mut self, from: &mut Reader<'_>) -> Result<(), StateError> {
        let pilot: Mean = from.value()?;
        if pilot != self.pilot {
            return Err(StateError::pilot(pilot.mean(), self.pilot.mean()));
        }
        self.films.take_up(from)?;
        let passes = self.besides.take_up(from)?;
        let ladders = from.ladders();
        let mut taken = 0;
        for stream in (self.streams.iter_mut()).filter(|s| ladders.contains(&s.ladder)) {
            stream.take_up(from.value()?, &self.cells)?;
            taken += stream.step;
        }
        self.besides.check(passes, self.mutations(taken))?;
        self.keep_up();
        Ok(())
    }
}
