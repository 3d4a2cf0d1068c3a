//! One ladder of replicas at work.

use kaustik_estimate::{
    PathTarget, ReplicaDeposit, ReplicaFamily, ReplicaSet, ReplicaShares, ReplicaWeights,
};
use kaustik_mcmc::{
    AcceptanceAdaptation, Family, Ladder, Metropolis, Pcg64Dxsm, Point, Scouted, Scouting,
    SteppingStone, SwapGraph, Touring, generator,
};
use kaustik_path::Contributions;

use super::even::Even;
use super::kernels::{Mutation, mutation};
use super::scouts::SpecularLight;
use super::start::{Started, State};
use crate::engine::Nonfinite;
use crate::{RenderSettings, Steps};

/// One ladder.
pub(super) struct Run<const K: usize> {
    pub(super) index: u32,
    pub(super) draws: Pcg64Dxsm,
    pub(super) ladder: Ladder<Point<Mutation>, Contributions, K>,
    pub(super) even: Even,
    /// Where scouts go.
    pub(super) spare: Point<Mutation>,
    /// Goes on tours of the specific replica.
    pub(super) tour: Metropolis<Point<Mutation>, Contributions, 1>,
    /// Steps of tours before the run was taken up, and of these the accepted.
    pub(super) toured: [u64; 2],
    /// Tours whose end the replica has gone to.
    pub(super) tours_followed: u64,
    pub(super) found: u64,
    pub(super) followed: u64,
    pub(super) adaptations: [AcceptanceAdaptation<Mutation>; K],
    pub(super) sweeps: u64,
    pub(super) shares: ReplicaShares<K>,
    pub(super) nonfinite: Nonfinite,
}

/// Tours of the specific replica in a sweep.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tours {
    pub(super) count: u32,
    /// Steps of each.
    pub(super) each: u32,
}

impl Tours {
    /// Of a set whose specific replica runs, or does not.
    pub(super) fn of(set: &ReplicaSet, specific: bool) -> Self {
        let goes = specific && set.tour() > 0;
        let repeats = set.repeats()[set.count() - 1];
        Self {
            count: if goes { repeats - 1 } else { 0 },
            each: set.tour(),
        }
    }

    /// Of all in a sweep.
    pub(super) fn steps(self) -> f64 {
        f64::from(self.count) * f64::from(self.each)
    }
}

/// What independent samples and scouts say before any chain has moved.
pub(super) fn pool<const K: usize>(
    weights: &ReplicaWeights<K>,
    set: &ReplicaSet,
    started: &Started,
) -> ReplicaShares<K> {
    let mut pool = ReplicaShares::on(below(set));
    for sample in &started.pool {
        let densities = std::array::from_fn(|k| sample.densities[k]);
        pool.sample(weights.share(&densities, sample.light));
    }
    if weights.shared() < K {
        let (found, sent) = &started.scouted;
        pool.scouts(K - 1, found, *sent);
    }
    pool
}

/// The replica that each of the first K stands on.
pub(super) fn below<const K: usize>(set: &ReplicaSet) -> [usize; K] {
    std::array::from_fn(|k| set.below()[k])
}

impl<const K: usize> Run<K> {
    /// Sends scouts for the specific replica.
    pub(super) fn scout(
        &mut self,
        count: u32,
        (target, region): (&PathTarget<'_>, &SpecularLight<'_>),
        family: &ReplicaFamily<K>,
        deposit: &mut ReplicaDeposit<'_, K>,
    ) {
        let scouting = Scouting { target, region };
        let Self {
            ladder,
            spare,
            draws,
            ..
        } = self;
        for _ in 0..count {
            let light = match ladder.scout(K - 1, &scouting, spare, family, draws, deposit) {
                Scouted::Nothing => 0.0,
                Scouted::Found { measure, accepted } => {
                    self.found += 1;
                    self.followed += u64::from(accepted);
                    measure
                }
            };
            deposit.shares.scout(K - 1, light);
        }
    }

    /// Sends the specific replica on tours.
    pub(super) fn tour<Q: Family<Contributions, 1>>(
        &mut self,
        count: u32,
        touring: &Touring<'_, PathTarget<'_>, PathTarget<'_>, Q>,
        family: &ReplicaFamily<K>,
        deposit: &mut ReplicaDeposit<'_, K>,
    ) {
        let (ladder, tour, draws) = (&mut self.ladder, &mut self.tour, &mut self.draws);
        for _ in 0..count {
            let followed = ladder.step_by_tour(K - 1, touring, tour, family, draws, deposit);
            self.tours_followed += u64::from(followed);
        }
    }

    /// Steps of all its tours, and of these the accepted.
    pub(super) fn tour_steps(&self) -> [u64; 2] {
        let since = self.tour.statistics().small();
        let [proposed, accepted] = self.toured;
        [proposed + since.proposed, accepted + since.accepted]
    }

    /// Ends a round: new step sizes for all replicas but the uniform one.
    pub(super) fn adapt(&mut self) {
        for (level, adaptation) in self.adaptations.iter_mut().enumerate().skip(1) {
            let small = *self.ladder.replicas()[level].statistics().small();
            let mutation = adaptation.end_round(&small);
            // pays what sleeping coordinates owe to the old sizes
            self.ladder.set_mutation(level, mutation, &mut self.draws);
        }
    }
}

/// A chain for tours of the last replica, which has not been anywhere.
pub(super) fn nowhere(
    set: &ReplicaSet,
    steps: Steps,
) -> Metropolis<Point<Mutation>, Contributions, 1> {
    let point = Point::new(mutation(set, steps, set.count() - 1));
    Metropolis::at(
        point,
        Contributions::default(),
        &|_: &Contributions| [0.0],
        0,
    )
}

/// The ladders of this process.
pub(super) fn runs<const K: usize>(
    family: &ReplicaFamily<K>,
    set: &ReplicaSet,
    settings: &RenderSettings,
    started: Started,
) -> Vec<Run<K>> {
    let graph = SwapGraph::new(&set.pairs(K)).expect("pairs of different replicas, each once");
    let mut levels: Vec<_> = started.starts.into_iter().map(Vec::into_iter).collect();
    let run = |index: u32| {
        let starts: Vec<State> = levels.iter_mut().filter_map(Iterator::next).collect();
        let starts: [State; K] = starts.try_into().ok()?;
        Some(Run {
            index,
            draws: generator(settings.seed, u64::from(index)),
            ladder: Ladder::new(starts, family)
                .with_schedule(settings.options.exchange)
                .with_graph(graph.clone())
                .with_stepping_stone(SteppingStone::on(below(set))),
            even: Even::new(settings, index),
            spare: Point::new(mutation(set, settings.options.steps, K - 1)),
            tour: nowhere(set, settings.options.steps),
            toured: [0; 2],
            tours_followed: 0,
            found: 0,
            followed: 0,
            adaptations: std::array::from_fn(|k| {
                AcceptanceAdaptation::new(mutation(set, settings.options.steps, k))
            }),
            sweeps: 0,
            shares: ReplicaShares::on(below(set)),
            nonfinite: Nonfinite::default(),
        })
    };
    settings.ladder_range().map_while(run).collect()
}
