//! Ladders of replicas written down and taken up again.

use std::io;

use kaustik_estimate::{ReplicaFamily, ReplicaSet, ReplicaShares};
use kaustik_mcmc::{
    AcceptanceAdaptation, Estimate, Ladder, Metropolis, Pcg64Dxsm, Point, checked_densities,
};
use kaustik_path::Contributions;
use serde::{Deserialize, Serialize};

use super::ReltEngine;
use super::kernels::Mutation;
use super::run::{Run, below, nowhere};
use crate::Steps;
use crate::engine::Nonfinite;
use crate::state::{Keep, Reader, StateError, Writer};

/// All of a [`Run`] that does not follow from its number of sweeps, and this number. `L`, `P`, `A` stand for what is
/// borrowed where it is written and owned where it is read.
#[derive(Serialize, Deserialize)]
struct Kept<L, P, A, S> {
    index: u32,
    sweeps: u64,
    draws: Pcg64Dxsm,
    ladder: L,
    spare: P,
    adaptations: A,
    shares: S,
    scouted: [u64; 2],
    toured: [u64; 2],
    tours_followed: u64,
    nonfinite: Nonfinite,
}

type Read<const K: usize> = Kept<
    Ladder<Point<Mutation>, Contributions, K>,
    Point<Mutation>,
    Vec<AcceptanceAdaptation<Mutation>>,
    ReplicaShares<K>,
>;

/// Films, ladders, and what stands beside them; what annealing and scouts found is found again, and compared.
impl<const K: usize> Keep for ReltEngine<'_, K> {
    fn taken(&self) -> Vec<u64> {
        let runs = self.runs.iter();
        runs.map(|run| run.sweeps * self.cost()).collect()
    }

    fn write(&self, out: &mut Writer<'_>) -> io::Result<()> {
        out.value(&(self.rough.to_vec(), self.pool, self.even))?;
        for film in &self.films {
            out.film(film)?;
        }
        self.besides.write(out)?;
        (self.runs.iter()).try_for_each(|run| {
            out.value(&Kept {
                index: run.index,
                sweeps: run.sweeps,
                draws: run.draws.clone(),
                ladder: &run.ladder,
                spare: &run.spare,
                adaptations: run.adaptations.as_slice(),
                shares: run.shares,
                scouted: [run.found, run.followed],
                toured: run.tour_steps(),
                tours_followed: run.tours_followed,
                nonfinite: run.nonfinite,
            })
        })
    }

    fn take_up(&mut self, from: &mut Reader<'_>) -> Result<(), StateError> {
        let (rough, pool, even): (Vec<Estimate>, ReplicaShares<K>, u32) = from.value()?;
        if rough != self.rough || pool != self.pool || even != self.even {
            let (b, here) = (pool.whole().value, self.pool.whole().value);
            return Err(StateError::Other(format!(
                "annealing found {} replicas and light of {b:e} for the state, {K} and {here:e} here: this program computes other numbers",
                rough.len()
            )));
        }
        for film in &mut self.films {
            from.film(film)?;
        }
        let passes = self.besides.take_up(from)?;
        let (ladders, cost) = (from.ladders(), self.cost());
        let mut steps = 0;
        for run in self
            .runs
            .iter_mut()
            .filter(|run| ladders.contains(&run.index))
        {
            let kept: Read<K> = from.value()?;
            Reader::count(kept.sweeps.saturating_mul(cost))?;
            run.take_up(kept, &self.family, &self.set, self.options.steps)?;
            run.even.go_to(run.sweeps * u64::from(self.even), run.index);
            steps += run.sweeps * cost;
        }
        let all = self.sweeps() * cost;
        self.besides.check(passes, steps)?;
        self.besides.keep_up(all);
        Ok(())
    }
}

impl<const K: usize> Run<K> {
    /// Refuses what no run of this ladder can have written.
    fn take_up(
        &mut self,
        kept: Read<K>,
        family: &ReplicaFamily<K>,
        set: &ReplicaSet,
        steps: Steps,
    ) -> Result<(), StateError> {
        let wrong = |what: &str| Err(StateError::damaged(what));
        let Ok(adaptations) = <[_; K]>::try_from(kept.adaptations) else {
            return wrong("steps of some replicas are missing");
        };
        let ladder = &kept.ladder;
        let same = kept.index == self.index
            && ladder.turn() == kept.sweeps
            && ladder.graph().pairs() == self.ladder.graph().pairs()
            && ladder.schedule() == self.ladder.schedule()
            && ladder.stepping_stone().below() == below(set);
        if !same {
            return wrong("a ladder does not agree with itself");
        }
        if steps != Steps::Adapted && adaptations != self.adaptations {
            return wrong("steps have changed that never do");
        }
        for (level, replica) in ladder.replicas().iter().enumerate() {
            let taken = kept.sweeps * u64::from(set.repeats()[level]);
            check_replica(replica, taken, &adaptations[level], family)?;
        }
        let [proposed, accepted] = kept.toured;
        let [found, followed] = kept.scouted;
        for count in [found, followed, proposed, accepted, kept.tours_followed] {
            Reader::count(count)?;
        }
        self.nonfinite = kept.nonfinite.checked()?;
        [self.found, self.followed] = kept.scouted;
        (self.toured, self.tour) = (kept.toured, nowhere(set, steps));
        self.tours_followed = kept.tours_followed;
        self.sweeps = kept.sweeps;
        self.draws = kept.draws;
        self.ladder = kept.ladder;
        self.spare = kept.spare;
        self.adaptations = adaptations;
        self.shares = kept.shares;
        Ok(())
    }
}

/// Refuses a replica that cannot have come here in so many steps, with what it has learnt of their sizes.
fn check_replica<const K: usize>(
    replica: &Metropolis<Point<Mutation>, Contributions, K>,
    steps: u64,
    adaptation: &AcceptanceAdaptation<Mutation>,
    family: &ReplicaFamily<K>,
) -> Result<(), StateError> {
    let wrong = |what: &str| Err(StateError::damaged(what));
    let statistics = replica.statistics();
    let moves = statistics.moves.iter().map(|kind| kind.proposed);
    let most = moves.chain([statistics.defects]).max();
    if statistics.steps != steps || most > Some(steps) {
        return wrong("a replica has other steps than its ladder");
    }
    let densities = checked_densities(family, replica.value()).unwrap_or([0.0; K]);
    if densities.map(f64::to_bits) != replica.densities().map(f64::to_bits) {
        return wrong("a replica's density is not that of its path");
    }
    if *replica.state().mutation() != adaptation.mutation() {
        return wrong("a replica has other steps than it has learnt");
    }
    Ok(())
}
