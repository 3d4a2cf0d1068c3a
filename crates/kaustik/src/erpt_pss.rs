//! Energy redistribution on primary samples (Cline, Talbot and Egbert 2005, with Kelemen's small steps).
//!
//! Each sample of a path builder has light; chains of small steps carry equal parts of it to
//! neighbouring points, as many chains as it has parts. Whatever the chains do, the mean of what
//! they leave is the light of the sample, spread as the target is: unbiased, without a start-up phase
//! and without a normaliser.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use kaustik_estimate::{PathTarget, ScalarContribution, Scale};
use kaustik_film::Film;
use kaustik_mcmc::{
    Deposit, Depositor, Mean, Point, PointKernel, Redistribution, RedistributionStatistics,
    Redistributor, SampleGenerators, Target,
};
use kaustik_path::{Contributions, PathBuilder};
use kaustik_pss::Coordinates;
use kaustik_scene::Scene;

use crate::carried::Carried;
use crate::control::is_stopped;
use crate::pssmlt::{Small, pilot};
use crate::state::{Reader, StateError};
use crate::streams;
use crate::{ChainStatistics, Options, RenderSettings};

/// What all chains have in common.
pub(crate) struct PssRedistribution {
    /// `None` if the pilot saw no light: samples then fall where they are, which is as unbiased.
    plan: Option<Redistribution>,
    family: ScalarContribution,
    /// Mean scalar contribution of the pilot.
    pilot: f64,
}

/// Where paths run, and where their light goes.
pub(crate) struct Paths<'a> {
    pub(crate) scene: &'a Scene,
    pub(crate) builder: &'a dyn PathBuilder,
    pub(crate) film: &'a Film,
    pub(crate) scale: Scale,
    /// Breaks chains off.
    pub(crate) stop: Option<&'a AtomicBool>,
}

/// How samples of this mean light are spread; `None` where there is none to spread.
pub(crate) fn redistribution(options: &Options, mean: f64) -> Option<Redistribution> {
    let unit = mean / f64::from(options.length) / options.chains;
    let plan = Redistribution::new(options.length, unit).ok()?;
    Some(match options.consecutive {
        Some(patience) => plan.patience(patience),
        None => plan,
    })
}

/// Takes deposits until it is told to stop. Chains that are broken off leave their sample's light unspread: it must be
/// taken back.
pub(crate) struct UntilStopped<'a, F> {
    pub(crate) deposit: F,
    pub(crate) stop: Option<&'a AtomicBool>,
}

impl<V, F: FnMut(Deposit<'_, V>)> Depositor<V> for UntilStopped<'_, F> {
    #[inline]
    fn deposit(&mut self, deposit: Deposit<'_, V>) {
        (self.deposit)(deposit);
    }

    #[inline]
    fn goes_on(&mut self) -> bool {
        !is_stopped(self.stop)
    }
}

/// The chains of one ladder.
pub(crate) struct Chains {
    generators: SampleGenerators,
    seed: Point<Small>,
    value: Contributions,
    redistributor: Redistributor<Point<Small>, Contributions>,
    carried: Carried,
    weights: Mean,
}

impl PssRedistribution {
    /// Draws the pilot that fixes the light of a deposit: samples of its own, so that the light is a constant.
    pub(crate) fn new(scene: &Scene, builder: &dyn PathBuilder, settings: &RenderSettings) -> Self {
        let options = &settings.options;
        let family = ScalarContribution {
            target: options.target,
            contribution: options.contribution,
        };
        let nonfinite = AtomicU64::new(0);
        let target = PathTarget {
            scene,
            builder,
            nonfinite: &nonfinite,
        };
        let mut weights = Mean::new();
        pilot(target, &family, settings, streams::PILOT, 0..options.pilot)
            .into_iter()
            .filter(|density| density.is_finite())
            .for_each(|density| weights.push(density));
        Self {
            plan: redistribution(options, weights.mean()),
            family,
            pilot: weights.mean(),
        }
    }

    /// Mean scalar contribution of the pilot's samples: what all else follows from.
    pub(crate) fn pilot(&self) -> f64 {
        self.pilot
    }

    /// All ladders' chains, in their order.
    pub(crate) fn statistics<'a>(
        &self,
        chains: impl Iterator<Item = &'a Chains>,
    ) -> ChainStatistics {
        let (mut all, mut weights) = (RedistributionStatistics::default(), Mean::new());
        for chains in chains {
            all.merge(chains.redistributor.statistics());
            weights.merge(&chains.weights);
        }
        ChainStatistics::new(
            &all.chain,
            [weights.mean(), weights.standard_error()],
            self.pilot,
        )
    }
}

/// What chains of a ladder leave behind.
pub(crate) type Kept = (RedistributionStatistics, Mean, Carried);

impl Chains {
    /// Between two samples nothing else counts.
    pub(crate) fn kept(&self) -> Kept {
        let statistics = self.redistributor.statistics().clone();
        (statistics, self.weights, self.carried.clone())
    }

    /// Refuses what chains from so many samples cannot have left.
    pub(crate) fn take_up(&mut self, kept: Kept, samples: u64) -> Result<(), StateError> {
        let (statistics, weights, carried) = kept;
        check_redistribution(&statistics)?;
        if weights.count() != samples || statistics.starts + statistics.bad_starts > samples {
            return Err(StateError::damaged(
                "chains do not agree with their samples",
            ));
        }
        self.go_to((statistics, weights, self.carried.checked(carried)?));
        Ok(())
    }

    /// As those are that left this behind.
    pub(crate) fn go_to(&mut self, (statistics, weights, carried): Kept) {
        self.redistributor = Redistributor::new().with_statistics(statistics);
        self.weights = weights;
        self.carried = carried;
    }

    pub(crate) fn new(settings: &RenderSettings, ladder: u32) -> Self {
        Self {
            generators: SampleGenerators::new(settings.seed, streams::chains(ladder)),
            seed: Point::new(Small::new(settings.options.small_step)),
            value: Contributions::default(),
            redistributor: Redistributor::new(),
            carried: Carried::new(settings, ladder),
            weights: Mean::new(),
        }
    }

    /// One sample and its chains; how many contributions were not finite.
    pub(crate) fn run<C: Coordinates>(
        &mut self,
        common: &PssRedistribution,
        paths: &Paths<'_>,
        coordinates: &mut C,
        step: u64,
    ) -> u64 {
        let nonfinite = AtomicU64::new(0);
        let target = PathTarget {
            scene: paths.scene,
            builder: paths.builder,
            nonfinite: &nonfinite,
        };
        target.evaluate(&mut self.seed.seed(coordinates), &mut self.value);
        let weight = common.family.of(&self.value);
        self.weights.push(weight);
        match &common.plan {
            None => paths.scale.splat(paths.film, &self.value, 1.0),
            Some(_) if weight <= 0.0 => {} // nothing to spread
            Some(plan) => {
                let deposit = |deposit: Deposit<'_, Contributions>| {
                    let share = deposit.weight() / deposit.density;
                    paths.scale.splat(paths.film, deposit.value, share);
                };
                let stop = paths.stop;
                let mut deposit = UntilStopped { deposit, stop };
                let share = self.carried.at(step);
                self.redistributor.carry(share.as_deref().copied());
                self.redistributor.run(
                    plan,
                    (&self.seed, &self.value, weight),
                    &PointKernel::new(target, 0.0),
                    &common.family,
                    &mut self.generators.at(step),
                    &mut deposit,
                );
                if let (Some(share), Some(left)) = (share, self.redistributor.carried()) {
                    *share = left;
                }
            }
        }
        nonfinite.load(Ordering::Relaxed)
    }
}

/// Refuses counts that no redistribution has.
pub(crate) fn check_redistribution(kept: &RedistributionStatistics) -> Result<(), StateError> {
    let moves = kept.chain.moves.iter().map(|kind| kind.proposed);
    let counts = [kept.starts, kept.bad_starts, kept.chains, kept.chain.steps];
    for count in counts.into_iter().chain(moves) {
        Reader::count(count)?;
    }
    if kept.capped > kept.starts || kept.chain.defects > kept.chain.steps {
        return Err(StateError::damaged("chains do not agree with themselves"));
    }
    Ok(())
}
