//! Energy redistribution on primary samples (Cline, Talbot and Egbert 2005, with Kelemen's small steps).
//!
//! Each sample of a path builder has light; chains of small steps carry equal parts of it to
//! neighbouring points, as many chains as it has parts. Whatever the chains do, the mean of what
//! they leave is the light of the sample, spread as the target is: unbiased, without a start-up phase
//! and without a normaliser.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use kaustik_estimate::{PathTarget, ScalarContribution, Scale};
use kaustik_film::{Film, Layer};
use kaustik_mcmc::{
    Deposit, Depositor, Mean, Point, PointKernel, Redistribution, RedistributionStatistics,
    Redistributor, SampleGenerators, Target,
};
use kaustik_path::{Contributions, PathBuilder};
use kaustik_pss::Coordinates;
use kaustik_scene::Scene;
use kaustik_spectrum::Xyz;

use crate::beside::lost::Lost;
use crate::carried::Carried;
use crate::control::is_stopped;
use crate::methods::pssmlt::{Small, pilot};
use crate::sampling::streams;
use crate::state::{Reader, StateError};
use crate::statistics::energy::{EnergySums, add};
use crate::{ChainStatistics, EnergyStatistics, Options, RenderError, RenderSettings};

/// What all chains have in common.
pub(crate) struct PssRedistribution {
    /// `None` if the pilot saw no light: samples then fall where they are, which is as unbiased.
    plan: Option<Redistribution>,
    family: ScalarContribution,
    /// Mean scalar contribution of the pilot.
    pilot: f64,
    /// What the filter by consecutive samples kept back, where it is asked for.
    pub(crate) held: Option<Film>,
    /// That, as of the last picture.
    lost: Option<Lost>,
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

/// Chains a sample where rare samples carry much of the light: more samples find more of these.
const FEW_CHAINS: f64 = 0.01;
/// Chains a sample where light is spread evenly over samples.
const MORE_CHAINS: f64 = 0.03;
/// Up to this relative variance of a pilot's samples light is spread evenly. (Measured: 5 to 80 on built-in scenes that gain by more chains, 200 to
/// 9000 on those that lose, or gain by chance.)
const EVEN_LIGHT: f64 = 128.0;
/// Fewer samples do not tell: their relative variance is at most their number.
const TELLING: u64 = 4096;

/// Mean number of chains a sample: as asked for, or as suits the light of the pilot's samples.
pub(crate) fn chains_a_sample(options: &Options, pilot: &Mean) -> f64 {
    let suited = || {
        let noise = pilot.variance() / pilot.mean().powi(2);
        if noise <= EVEN_LIGHT && pilot.count() >= TELLING {
            MORE_CHAINS
        } else {
            FEW_CHAINS
        }
    };
    options.chains.unwrap_or_else(suited)
}

/// How samples of this mean light are spread; `None` where there is none to spread.
pub(crate) fn redistribution(options: &Options, mean: f64) -> Option<Redistribution> {
    // Left open, it is known by now.
    let chains = options.chains.unwrap_or(FEW_CHAINS);
    let unit = mean / f64::from(options.length) / chains;
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
    sums: EnergySums,
}

impl PssRedistribution {
    /// Draws the pilot that fixes the light of a deposit: samples of its own, so that the light is a constant.
    /// `held` is a film for what a filter keeps back.
    pub(crate) fn new(
        scene: &Scene,
        builder: &dyn PathBuilder,
        settings: &RenderSettings,
        held: Option<Film>,
    ) -> Self {
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
        pilot(
            target,
            &family,
            settings,
            streams::PILOT,
            0..settings.pilot(),
        )
        .into_iter()
        .filter(|density| density.is_finite())
        .for_each(|density| weights.push(density));
        let options = Options {
            chains: Some(chains_a_sample(options, &weights)),
            ..*options
        };
        Self {
            plan: redistribution(&options, weights.mean()),
            family,
            pilot: weights.mean(),
            held,
            lost: None,
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

    /// Their light, from so many samples.
    pub(crate) fn energy<'a>(
        &self,
        samples: u64,
        chains: impl Iterator<Item = &'a Chains>,
    ) -> EnergyStatistics {
        let (mut all, mut sums) = (RedistributionStatistics::default(), EnergySums::default());
        for chains in chains {
            all.merge(chains.redistributor.statistics());
            sums.merge(&chains.sums);
        }
        let share = || self.lost.as_ref().map_or(0.0, |lost| lost.share);
        EnergyStatistics {
            consecutive_loss: self.held.as_ref().map(|_| share()),
            ..EnergyStatistics::new(samples, &all, &sums)
        }
    }

    /// Looks at what the filter kept off this picture. `per_sample` turns sums into means.
    pub(crate) fn see(&mut self, picture: &Film, per_sample: f64) -> Result<(), RenderError> {
        if let Some(held) = &self.held {
            let target = self.family.target;
            self.lost = Some(Lost::held(
                (held, per_sample),
                &[(picture, per_sample)],
                target,
            )?);
        }
        Ok(())
    }

    /// What was seen.
    pub(crate) fn layer(&self) -> Option<Layer> {
        self.lost.as_ref().map(Lost::layer)
    }
}

/// What chains of a ladder leave behind.
pub(crate) type Kept = (RedistributionStatistics, Mean, Carried, EnergySums);

impl Chains {
    /// Between two samples nothing else counts.
    pub(crate) fn kept(&self) -> Kept {
        let statistics = self.redistributor.statistics().clone();
        (statistics, self.weights, self.carried.clone(), self.sums)
    }

    /// Refuses what chains from so many samples cannot have left.
    pub(crate) fn take_up(&mut self, kept: Kept, samples: u64) -> Result<(), StateError> {
        let (statistics, weights, carried, sums) = kept;
        check_redistribution(&statistics)?;
        if weights.count() != samples || statistics.starts + statistics.bad_starts > samples {
            return Err(StateError::damaged(
                "chains do not agree with their samples",
            ));
        }
        self.go_to((statistics, weights, self.carried.checked(carried)?, sums));
        Ok(())
    }

    /// As those are that left this behind.
    pub(crate) fn go_to(&mut self, (statistics, weights, carried, sums): Kept) {
        self.redistributor = Redistributor::new().with_statistics(statistics);
        self.weights = weights;
        self.carried = carried;
        self.sums = sums;
    }

    pub(crate) fn new(settings: &RenderSettings, ladder: u32) -> Self {
        Self {
            generators: SampleGenerators::new(settings.seed, streams::chains(ladder)),
            seed: Point::new(Small::new(settings.options.small_step)),
            value: Contributions::default(),
            redistributor: Redistributor::new(),
            carried: Carried::new(settings, ladder),
            weights: Mean::new(),
            sums: EnergySums::default(),
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
        let sums = &mut self.sums;
        match &common.plan {
            None => {
                add(&mut sums.unperturbed, colour(&self.value), 1.0);
                paths.scale.splat(paths.film, &self.value, 1.0);
            }
            Some(_) if weight <= 0.0 => {} // nothing to spread
            Some(plan) => {
                add(&mut sums.seeded, colour(&self.value), 1.0);
                let deposit = |deposit: Deposit<'_, Contributions>| {
                    let share = |weight: f64| weight / deposit.density;
                    let all = share(deposit.weight() + deposit.held);
                    add(&mut sums.deposited, colour(deposit.value), all);
                    (paths.scale).splat(paths.film, deposit.value, share(deposit.weight()));
                    if let Some(held) = common.held.as_ref().filter(|_| deposit.held > 0.0) {
                        (paths.scale).splat(held, deposit.value, share(deposit.held));
                    }
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

/// Light of all splats of a value.
#[inline]
fn colour(value: &Contributions) -> Xyz {
    value.splats().iter().map(|splat| splat.xyz).sum()
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chains_go_by_how_evenly_light_is_spread() {
        let first = |count: u64, bright: f64| -> Mean {
            let light = |index| if index % 1000 == 0 { bright } else { 1.0 };
            (0..count).map(light).collect()
        };
        let pilot = |bright| first(10_000, bright);
        let auto = Options::default();
        let asked = Options {
            chains: Some(2.5),
            ..auto
        };
        for (light, chains) in [
            (pilot(1.0), MORE_CHAINS),
            (pilot(100.0), MORE_CHAINS),
            (pilot(1000.0), FEW_CHAINS),
            (pilot(f64::INFINITY), FEW_CHAINS),
            (first(100, 1000.0), FEW_CHAINS),
            (Mean::new(), FEW_CHAINS),
            (std::iter::repeat_n(0.0, 9).collect(), FEW_CHAINS),
        ] {
            for (options, expected) in [(&auto, chains), (&asked, 2.5)] {
                let found = chains_a_sample(options, &light);
                assert_eq!(found.to_bits(), expected.to_bits(), "{light:?}: {found}");
            }
        }
    }
}
