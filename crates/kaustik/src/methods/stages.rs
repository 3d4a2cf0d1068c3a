//! Multi-stage Metropolis light transport (Hoberock and Hart 2010).
//!
//! A chain that follows the light of the image is mostly where the image is bright, and leaves its dark parts
//! noisy. Here a render is made in stages. Each follows the light times a weight on the image, inverse to the
//! picture of the stages before it, so that every part is visited alike. Within a stage nothing learns: it is
//! ordinary Metropolis light transport, with a pool and a normaliser of its own, whatever the weights are. The
//! picture is the mean of the stages' pictures, each weighted by its number of mutations. Stages whose pools saw no
//! light are passed over: where that happens, those that remain are too bright in the mean.

mod keep;
mod options;
mod past;
mod plan;
mod sums;
#[cfg(test)]
mod tests;

use std::sync::atomic::AtomicBool;

use kaustik_estimate::{Contribution, MappedContribution, Mis};
use kaustik_film::{Counters, Image, develop};
use kaustik_path::{Event, RayCounts};
use kaustik_scene::Scene;

use crate::beside::Besides;
use crate::beside::lamps::Lamps;
use crate::control::is_stopped;
use crate::engine::{Engine, add_counters, add_nonfinite, add_rays};
use crate::methods::builders::builder;
use crate::methods::mlt::MltEngine;
use crate::methods::pssmlt::PssmltEngine;
use crate::sampling::stratified::mix;
use crate::state::Keep;
use crate::{
    ChainStatistics, Method, MutationStatistics, RenderError, RenderSettings, StageStatistics,
    StepId,
};
use past::{Counted, Past};
use plan::Plan;
use sums::Sums;

pub use options::{StageLadder, StageOptions};

/// Turns the seed of a render into those of its stages.
const SEEDS: u64 = 0x57A6_E5ED_0F40_BE20;
/// The relative error with which the samples of a stage's pool are to know the light of the image. Where light
/// is so rare that few samples see any, about 25 of a pool then do (1 / 0.2^2): hardly any pool sees none.
const CERTAIN: f64 = 0.2;

/// The stage at work, and the pictures of those before it.
pub(crate) struct StagedEngine<'a> {
    scene: &'a Scene,
    settings: RenderSettings,
    plan: Plan,
    /// Of the stages before the one that the engine began in.
    sums: Sums,
    past: Past,
    engine: Box<dyn Engine + 'a>,
    /// The stage that the engine began in: its map is that of this one.
    began: usize,
    /// The stage that ladders are in, or at the end of: later than `began` if stages were skipped because
    /// their pools were dark.
    stage: usize,
    /// What is seen directly is not for the stages.
    besides: Besides<'a>,
    /// Samples that a pool is to have for what it tells of the light to be certain enough.
    many: u64,
    /// Why a stage could not begin.
    failure: Option<RenderError>,
}

impl<'a> StagedEngine<'a> {
    /// Begins the first stage.
    pub(crate) fn new(scene: &'a Scene, settings: &RenderSettings) -> Result<Self, RenderError> {
        let plan = Plan::new(settings);
        let sums = Sums::black(&settings.layout());
        let engine = begin(scene, settings, (&plan, 0, 0), &sums)?;
        Ok(Self {
            many: many(engine.as_ref(), plan.pool(0, 0)),
            engine,
            besides: Besides::of_lamps(Lamps::new(scene, settings)?),
            scene,
            settings: settings.clone(),
            plan,
            sums,
            past: Past::default(),
            began: 0,
            stage: 0,
            failure: None,
        })
    }

    /// Steps that a ladder had behind it where the engine began.
    fn start(&self) -> u64 {
        self.plan.start(self.began)
    }

    fn counted(&self) -> Counted<'_> {
        Counted {
            engine: self.engine.as_ref(),
            start: self.start(),
            width: self.plan.stage(self.began).width,
        }
    }

    /// Goes on to the next stage. Where its pool sees no light, or it cannot begin, the stage before goes on
    /// in its place.
    fn turn(&mut self) {
        self.stage += 1;
        match self.next() {
            Ok(Some((engine, sums))) => {
                let mut past = std::mem::take(&mut self.past);
                past.push(&self.counted());
                self.past = past;
                self.engine = engine;
                self.sums = sums;
                self.began = self.stage;
            }
            Ok(None) => {}
            Err(error) => self.failure = Some(error),
        }
    }

    /// The stage that ladders have come to, if its pool sees light, and the pictures of those before it.
    fn next(&mut self) -> Result<Option<Begun<'a>>, RenderError> {
        let image = self.engine.develop()?;
        let sums = self.sums.with(&image, self.engine.steps());
        let engine = begin(
            self.scene,
            &self.settings,
            (&self.plan, self.stage, self.many),
            &sums,
        )?;
        Ok(sees(engine.as_ref()).then_some((engine, sums)))
    }
}

/// An engine with the map that these pictures make for a stage, and streams of its own.
fn begin<'a>(
    scene: &'a Scene,
    settings: &RenderSettings,
    (plan, number, many): (&Plan, usize, u64),
    sums: &Sums,
) -> Result<Box<dyn Engine + 'a>, RenderError> {
    let options = settings.options;
    let map = sums.map(
        &settings.layout(),
        plan.stage(number),
        options.target,
        options.stages.floor,
    );
    let mut own = RenderSettings {
        seed: seed(settings.seed, number),
        ..settings.clone()
    };
    own.options.pilot = plan.pool(number, many);
    // What large steps are worth as independent samples goes by the picture, not by these weights.
    own.options.mis = Mis::Off;
    own.options.contribution = Contribution::Sum;
    if settings.method == Method::MltMultistage {
        return Ok(Box::new(MltEngine::with_map(
            scene,
            &own,
            map,
            Besides::default(),
        )?));
    }
    let family = MappedContribution {
        target: options.target,
        map,
    };
    let builder = builder(scene, &own)?;
    let engine = PssmltEngine::of_family(scene, &own, builder, family, Besides::default())?;
    Ok(Box::new(engine))
}

/// The seed of a stage: that of no other, and not the render's.
fn seed(render: u64, number: usize) -> u64 {
    mix(mix(render ^ SEEDS) ^ number as u64)
}

/// A stage that has begun, and the pictures of those before it.
type Begun<'a> = (Box<dyn Engine + 'a>, Sums);

/// How many samples know the normaliser with a relative error of [`CERTAIN`], judged by the first pool, of
/// `samples`. No later samples have a say, or stages that happen to see more than usual would be preferred.
fn many(first: &dyn Engine, samples: u64) -> u64 {
    let chain = first.chain_statistics();
    let error = chain.map_or(0.0, |chain| {
        chain.normalisation_error / chain.normalisation.max(f64::MIN_POSITIVE)
    });
    (samples as f64 * (error / CERTAIN).powi(2)).ceil() as u64
}

/// Has the pool of a stage that has not taken a step seen light?
fn sees(engine: &dyn Engine) -> bool {
    engine
        .chain_statistics()
        .is_some_and(|chain| chain.normalisation > 0.0)
}

impl Engine for StagedEngine<'_> {
    /// Cuts the plan where stages end. None of a plan's steps is left over: see [`Plan`].
    fn advance(&mut self, plan: &[u64], stop: Option<&AtomicBool>) -> u64 {
        let before = self.steps();
        let mut taken = self.taken();
        let targets: Vec<u64> = taken.iter().zip(plan).map(|(taken, n)| taken + n).collect();
        loop {
            let end = self.plan.stage(self.stage).end;
            let due = targets.iter().zip(&taken);
            let due: Vec<u64> = due
                .map(|(&target, &taken)| target.min(end).saturating_sub(taken))
                .collect();
            self.engine.advance(&due, stop);
            taken = self.taken();
            let left = taken
                .iter()
                .zip(&targets)
                .any(|(taken, target)| taken < target);
            let ended = taken.iter().all(|&taken| taken >= end);
            // Short of the end: it was stopped, or there is no light.
            if !left || !ended || is_stopped(stop) {
                break;
            }
            self.turn();
        }
        let steps = self.steps();
        self.besides.keep_up(steps);
        steps - before
    }

    fn develop(&mut self) -> Result<Image, RenderError> {
        // It stays: what a watcher was shown in place of a picture, the render's end says as well.
        if let Some(failure) = &self.failure {
            return Err(failure.clone());
        }
        let image = self.engine.develop()?;
        let sums = self.sums.with(&image, self.engine.steps());
        let mut image = sums.image(&self.settings.layout())?;
        for part in self.besides.parts() {
            image.add(&develop(&[part])?)?;
        }
        Ok(image)
    }

    /// Of the stage at work.
    fn chain_statistics(&self) -> Option<ChainStatistics> {
        self.past.chain(&self.counted())
    }

    fn mutation_statistics(&self) -> Vec<MutationStatistics> {
        self.past.mutations(&self.counted())
    }

    fn stage_statistics(&self) -> Vec<StageStatistics> {
        let mut stages = self.past.stages().to_vec();
        stages.push(self.counted().statistics());
        stages
    }

    fn nonfinite(&self) -> (u64, Vec<StepId>) {
        let own = self.past.nonfinite(&self.counted());
        add_nonfinite(own, Some(self.besides.nonfinite()))
    }

    /// The stages before it run first.
    fn replay(&mut self, StepId { ladder, step }: StepId) -> Result<Vec<Event>, RenderError> {
        let wanted = self.plan.of_step(step);
        let before = self.plan.start(wanted);
        let due = self.taken().into_iter();
        let due: Vec<u64> = due.map(|taken| before.saturating_sub(taken)).collect();
        self.advance(&due, None);
        if self.stage < wanted && self.taken().iter().all(|&taken| taken >= before) {
            self.turn();
        }
        if let Some(failure) = self.failure.take() {
            return Err(failure);
        }
        let step = step - self.start();
        self.engine.replay(StepId { ladder, step })
    }

    /// Stages.
    fn ahead(&self, StepId { ladder, step }: StepId) -> Option<u64> {
        let taken = self.taken();
        if taken
            .get(ladder as usize)
            .is_some_and(|&taken| taken > step)
        {
            return None;
        }
        let wanted = self.plan.of_step(step);
        wanted.checked_sub(self.stage).map(|stages| stages as u64)
    }

    fn rays(&self) -> Option<RayCounts> {
        let stages = self.past.rays(&self.counted())?;
        Some(add_rays([stages, self.besides.rays()].into_iter()))
    }

    fn film_counters(&self) -> Counters {
        let stages = self.past.counters(&self.counted());
        add_counters(stages, self.besides.film_counters())
    }

    fn is_lit(&self) -> bool {
        self.began > 0 || self.engine.is_lit() || self.besides.is_lit()
    }
}
