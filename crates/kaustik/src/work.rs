//! The render loop: rounds of work until the budget is spent.

use std::time::{Duration, Instant};

use kaustik_scene::Scene;

use crate::engine::Engine;
use crate::state::{Header, take_up};
use crate::{
    Budget, Control, Outcome, Progress, RenderError, RenderSettings, RenderStatistics, Rendered,
    Snapshot, State, StateError, Watch, features,
};

/// Rounds aim at this length: short enough for a lively display, long enough that
/// waiting for the last ladder costs little.
const ROUND: Duration = Duration::from_millis(250);

/// How long a render that was stopped works on albedo, normal and depth.
const PATIENCE: Duration = Duration::from_millis(300);

/// A render at work.
pub(crate) struct Work<'a> {
    scene: &'a Scene,
    settings: &'a RenderSettings,
    start: Instant,
    pilot: Duration,
    /// Sampling of the states that were taken up.
    before: Duration,
    steps: u64,
}

impl<'a> Work<'a> {
    pub(crate) fn new(scene: &'a Scene, settings: &'a RenderSettings) -> Self {
        Self {
            scene,
            settings,
            start: Instant::now(),
            pilot: Duration::ZERO,
            before: Duration::ZERO,
            steps: 0,
        }
    }

    /// Takes up a state; see [`take_up`].
    pub(crate) fn take_up(
        &mut self,
        engine: &mut (dyn Engine + '_),
        state: &State,
        first: bool,
    ) -> Result<(), StateError> {
        take_up(engine, state, first)?;
        self.before += Duration::from_secs_f64(state.seconds());
        self.steps = engine.steps();
        Ok(())
    }

    /// Sampling begins now.
    pub(crate) fn begin(&mut self) {
        self.pilot = self.start.elapsed();
    }

    fn elapsed(&self) -> Duration {
        self.start.elapsed() + self.before
    }

    fn seconds(&self) -> f64 {
        (self.elapsed() - self.pilot).as_secs_f64()
    }

    /// Works until the budget is spent, or it is told to stop.
    pub(crate) fn run(
        &mut self,
        engine: &mut (dyn Engine + '_),
        pool: &rayon::ThreadPool,
        control: &mut Control<'_>,
        watch: &mut dyn Watch,
    ) -> Result<Outcome, RenderError> {
        let outcome = if engine.is_lit() {
            self.rounds(engine, pool, control, watch)?
        } else {
            Outcome::Black
        };
        // Before the end makes chains deposit what they hold back.
        if watch.wants_state(&self.progress(engine), true) {
            self.show_state(engine, watch);
        }
        Ok(outcome)
    }

    fn rounds(
        &mut self,
        engine: &mut (dyn Engine + '_),
        pool: &rayon::ThreadPool,
        control: &mut Control<'_>,
        watch: &mut dyn Watch,
    ) -> Result<Outcome, RenderError> {
        let ladders = self.settings.ladder_range();
        let mut done = engine.taken();
        if self.is_past(engine, &done) {
            return Ok(Outcome::Complete);
        }
        let mut allowed = self.begun(engine, &done);
        let mut chunk = 1;
        loop {
            // Every ladder may have taken `allowed` grains, but no more than planned.
            allowed = u64::saturating_add(allowed, chunk);
            let steps = |(ladder, done): (u32, &u64)| {
                let planned = engine.planned(ladder, self.settings);
                let due = engine.grain(ladder).saturating_mul(allowed);
                planned.min(due).saturating_sub(*done)
            };
            let round_start = Instant::now();
            let plan: Vec<u64> = ladders.clone().zip(&done).map(steps).collect();
            let taken = pool.install(|| engine.advance(&plan, control.stop));
            let round = round_start.elapsed().as_secs_f64().max(1e-6);
            self.steps += taken;
            done.iter_mut().zip(&plan).for_each(|(done, n)| *done += n);
            let progress = self.progress(engine);
            control.tell(&progress);
            if watch.wants_state(&progress, false) {
                self.show_state(engine, watch);
            }
            if watch.wants_image(&progress) {
                self.show(engine, pool, watch)?;
            }
            if control.stopped() {
                return Ok(Outcome::Stopped);
            }
            // Grow gently toward rounds of the wanted length, never past twice the last.
            let ratio = ROUND.as_secs_f64() / round;
            let wanted = ((chunk as f64 * ratio.clamp(0.5, 2.0)) as u64).max(1);
            let fits = self.grains_left(round / chunk as f64);
            if plan.iter().all(|&steps| steps == 0) || fits == 0 {
                return Ok(Outcome::Complete);
            }
            chunk = wanted.min(fits);
        }
    }

    /// Was a state taken up that has more than the budget allows? Its picture is then shown as it was, even if a signal had
    /// ended it within a round that an engine of several parts would complete first.
    fn is_past(&self, engine: &dyn Engine, done: &[u64]) -> bool {
        let ladders = self.settings.ladder_range();
        let (mut past, mut due) = (false, false);
        for (ladder, done) in ladders.zip(done) {
            let planned = engine.planned(ladder, self.settings);
            past |= planned < *done;
            due |= planned > *done;
        }
        past && !due
    }

    /// Grains that all ladders have taken which have steps left to take. In a merged state some may be far ahead: they wait,
    /// and the others catch up round by round.
    fn begun(&self, engine: &dyn Engine, done: &[u64]) -> u64 {
        let unfinished = (self.settings.ladder_range().zip(done))
            .filter(|(ladder, done)| engine.planned(*ladder, self.settings) > **done);
        let grains = |(ladder, done): (u32, &u64)| done / engine.grain(ladder).max(1);
        unfinished.map(grains).min().unwrap_or(0)
    }

    /// The state as it is now.
    pub(crate) fn snapshot<'s>(&self, engine: &'s (dyn Engine + '_)) -> Snapshot<'s> {
        let header = Header::new(self.scene, self.settings, self.seconds());
        Snapshot::new(header, engine)
    }

    pub(crate) fn show_state(&self, engine: &(dyn Engine + '_), watch: &mut dyn Watch) {
        watch.see_state(&self.snapshot(engine));
    }

    /// Shows the picture, and puts back what its chains had to deposit for it.
    fn show(
        &self,
        engine: &mut (dyn Engine + '_),
        pool: &rayon::ThreadPool,
        watch: &mut dyn Watch,
    ) -> Result<(), RenderError> {
        let kept = match engine.holds_back() {
            true => Some(self.snapshot(engine).state()?),
            false => None,
        };
        match pool.install(|| self.rendered(engine, Outcome::Stopped)) {
            Ok(rendered) => watch.see_image(rendered),
            // As of a merged state whose ladders have not come as far as each other yet.
            Err(error) => watch.image_failed(error),
        }
        if let Some(kept) = kept {
            pool.install(|| take_up(engine, &kept, true))?;
        }
        Ok(())
    }

    /// The picture at the end, with what does not come from the engine.
    pub(crate) fn finish(
        &self,
        mut engine: Box<dyn Engine + '_>,
        pool: &rayon::ThreadPool,
        outcome: Outcome,
    ) -> Result<Rendered, RenderError> {
        let mut rendered = self.rendered(engine.as_mut(), outcome)?;
        // The films are not needed any more, the feature planes are.
        drop(engine);
        if self.settings.features {
            // Whoever stops a render waits for the picture: what is not part of it is left out if it takes long.
            let patience = match outcome {
                Outcome::Stopped => PATIENCE,
                Outcome::Complete | Outcome::Black => Duration::MAX,
            };
            let layers = pool.install(|| features::layers(self.scene, self.settings, patience));
            for layer in layers.into_iter().flatten() {
                rendered.image.push_layer(layer)?;
            }
        }
        Ok(rendered)
    }

    /// The picture so far and what is to be said about it.
    fn rendered(
        &self,
        engine: &mut (dyn Engine + '_),
        outcome: Outcome,
    ) -> Result<Rendered, RenderError> {
        let seconds = self.seconds();
        let mut image = engine.develop()?;
        let (nonfinite, mut nonfinite_places) = engine.nonfinite();
        nonfinite_places.truncate(RenderStatistics::MOST_PLACES);
        let settings = self.settings;
        let statistics = RenderStatistics {
            method: settings.method.to_string(),
            seed: settings.seed,
            ladders: settings.options.ladders,
            steps: self.steps,
            planned: self.planned(engine),
            per_pixel: self.steps as f64 / engine.pass().unwrap_or(settings.pixels()) as f64,
            seconds,
            pilot_seconds: self.pilot.as_secs_f64(),
            start_share: settings.options.start.share(),
            nonfinite,
            nonfinite_places,
            rays: engine.rays(),
            film: engine.film_counters(),
            chain: engine.chain_statistics(),
            direct: engine.direct_statistics(),
            replicas: engine.replica_statistics(),
            mutations: engine.mutation_statistics(),
            energy: engine.energy_statistics(),
            photons: engine.photon_statistics(),
            stages: engine.stage_statistics(),
            merged: None,
        };
        if settings.features {
            for layer in engine.layers()? {
                image.push_layer(layer)?;
            }
        }
        let is_black = || {
            image
                .rgb()
                .iter()
                .all(|plane| plane.iter().all(|&v| v == 0.0))
        };
        let outcome = match outcome {
            Outcome::Complete if is_black() => Outcome::Black,
            other => other,
        };
        Ok(Rendered {
            image,
            statistics,
            outcome,
        })
    }

    /// How many grains of so many seconds the time has room for. A grain may be an iteration of seconds: it is begun if it ends
    /// nearer to the limit than the render is now.
    fn grains_left(&self, seconds: f64) -> u64 {
        let Budget::Time(limit) = self.settings.budget else {
            return u64::MAX;
        };
        let left = limit.saturating_sub(self.elapsed()).as_secs_f64();
        (left / seconds).round() as u64
    }

    /// Steps of all ladders of this process, where the budget tells.
    fn planned(&self, engine: &dyn Engine) -> Option<u64> {
        match self.settings.budget {
            // of a merge, which takes what there is
            Budget::Time(_) | Budget::Total(0) => None,
            Budget::PerPixel(_) | Budget::Total(_) => {
                let ladders = self.settings.ladder_range();
                let planned = ladders.map(|ladder| engine.planned(ladder, self.settings));
                Some(planned.fold(0, u64::saturating_add))
            }
        }
    }

    pub(crate) fn progress(&self, engine: &dyn Engine) -> Progress {
        let elapsed = self.elapsed();
        let fraction = match self.settings.budget {
            Budget::Time(limit) => elapsed.as_secs_f64() / limit.as_secs_f64().max(1e-9),
            Budget::PerPixel(_) | Budget::Total(_) => {
                let planned = self.planned(engine).unwrap_or_default();
                self.steps as f64 / planned.max(1) as f64
            }
        };
        let fraction = fraction.clamp(0.0, 1.0);
        let sampling = self.seconds();
        let chain = engine.chain_statistics();
        Progress {
            fraction,
            elapsed,
            remaining: match self.settings.budget {
                Budget::Time(limit) => limit.saturating_sub(elapsed),
                Budget::PerPixel(_) | Budget::Total(_) => Duration::from_secs_f64(
                    (sampling * (1.0 - fraction) / fraction.max(1e-9)).min(1e9),
                ),
            },
            steps: self.steps,
            rate: self.steps as f64 / sampling.max(1e-9),
            acceptance: chain.map(|c| [c.small_acceptance, c.large_acceptance]),
            normalisation: chain.map(|c| [c.normalisation, c.normalisation_error]),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Method, small};

    #[test]
    fn what_ends_nearer_to_the_limit_is_begun() {
        const SIDE: u32 = 8;
        let scene = small::scene("cornell", [SIDE; 2]);
        let left = |budget, seconds| {
            let settings = RenderSettings {
                budget,
                ..small::settings(Method::Sppm, [SIDE; 2])
            };
            Work::new(&scene, &settings).grains_left(seconds)
        };
        let hour = Budget::Time(Duration::from_secs(3600));
        assert_eq!(left(hour, 359.0), 10);
        assert_eq!(left(hour, 7000.0), 1);
        assert_eq!(left(hour, 7400.0), 0);
        assert_eq!(left(Budget::Time(Duration::ZERO), 1e-6), 0);
        assert_eq!(left(Budget::PerPixel(1), 7400.0), u64::MAX);
    }
}
