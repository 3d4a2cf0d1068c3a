//! Replica exchange: K chains, one at each level of a family, that exchange their states.

use crate::decide::{decide, exchange_acceptance};
use crate::permutation::Permutations;
use crate::{
    Both, Draws, Family, IndexProcess, Kernel, LadderStatistics, Metropolis, Recorder, Schedule,
    SteppingStone, SwapGraph,
};

/// K chains, one a level, that exchange their states (Swendsen and Wang 1986; Geyer 1991; for
/// light Kitaoka et al. 2009, RELT Algorithm 1).
///
/// Where one chain would stay in one mode for ever, a ladder has levels of growing
/// difficulty: at the bottom one that moves everywhere, at the top the targets that matter.
/// States found below climb by exchanges. Since every density is read off a value that is
/// known already, an exchange costs no evaluation.
///
/// One [`sweep`](Self::sweep) is a step in every replica, then exchanges by the ladder's
/// [`Schedule`] along its [`SwapGraph`]. An exchange of levels k and l is accepted with
/// probability [min(1, r)](crate::exchange_acceptance), which leaves the product of all
/// normalised targets invariant (RELT eqs. 8 and 9). So visits at level k, which come with
/// `visit.level == k`, estimate means under p_k exactly as those of a single chain do, from a
/// stationary start without bias; exchanges themselves record nothing.
///
/// Replicas keep what belongs to their level: a lazy [`Point`](crate::Point) its mutation (the debt that a
/// state owes to it is paid when it leaves), the kernel its large steps, the chain its
/// statistics. Level 0 usually has the uniform density 1 and large steps only
/// (`PointKernel { p_large: 1.0, .. }`), the others small steps only.
///
/// ```
/// use kaustik_mcmc::{
///     Exponential, Ladder, PointKernel, Visit, generator, target,
/// };
/// use kaustik_pss::{Coordinates, Stream};
///
/// // two narrow modes, at 0.2 (one third of the mass) and 0.7
/// let place = target(|u: &mut dyn Coordinates| u.get(Stream::Camera, 0));
/// let modes = |x: &f64| {
///     let bump = |at: f64| (-((x - at) / 0.01).powi(2)).exp();
///     let both = bump(0.2) + 2.0 * bump(0.7);
///     [1.0, both.powf(0.2), both]
/// };
/// let kernels = [1.0, 0.0, 0.0].map(|large| PointKernel::new(&place, large));
/// let mut rng = generator(1, 0);
/// let mut ladder = Ladder::start(&place, &modes, [Exponential::default(); 3], &mut rng);
/// let mut left = 0.0;
/// let sweeps = 40_000;
/// for _ in 0..sweeps {
///     ladder.sweep(&kernels, &modes, &mut rng, &mut |visit: Visit<'_, f64, 3>| {
///         if visit.level == 2 && *visit.value < 0.45 {
///             left += visit.weight;
///         }
///     });
/// }
/// assert!((left / f64::from(sweeps) - 1.0 / 3.0).abs() < 0.05);
/// assert!(ladder.statistics().round_trips > 100);
/// let b = ladder.stepping_stone().normalisers(1.0); // level 0 is uniform: its b is 1
/// let exact = 3.0 * 0.01 * std::f64::consts::PI.sqrt();
/// assert!((b.values()[2] / exact - 1.0).abs() < 0.1);
/// ```
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(bound(
        serialize = "S: serde::Serialize, V: serde::Serialize",
        deserialize = "S: serde::Deserialize<'de>, V: serde::Deserialize<'de> + Default"
    ))
)]
#[doc(alias = "parallel tempering")]
#[doc(alias = "replica exchange")]
pub struct Ladder<S, V, const K: usize> {
    #[cfg_attr(
        feature = "serde",
        serde(
            serialize_with = "crate::serial::array::serialize",
            deserialize_with = "serial::replicas"
        )
    )]
    replicas: [Metropolis<S, V, K>; K],
    graph: SwapGraph<K>,
    #[cfg_attr(
        feature = "serde",
        serde(deserialize_with = "serial::schedule::<_, K>")
    )]
    schedule: Schedule,
    /// Rounds of exchanges so far: whose turn it is.
    #[cfg_attr(feature = "serde", serde(deserialize_with = "crate::serial::count"))]
    turn: u64,
    indices: IndexProcess<K>,
    statistics: LadderStatistics<K>,
    stepping_stone: SteppingStone<K>,
}

impl<S, V: Default, const K: usize> Ladder<S, V, K> {
    /// A ladder whose replica k starts at the k-th state and its value, on a line, with the
    /// default schedule.
    ///
    /// A start of density zero at its level is left at the first opportunity, by a step or
    /// an exchange of two ([`Schedule::Permutation`] waits until every level has a state that is not dark there).
    pub fn new(starts: [(S, V); K], family: &(impl Family<V, K> + ?Sized)) -> Self {
        let mut level = 0..;
        let replicas = starts.map(|(state, value)| {
            Metropolis::at(state, value, family, level.next().unwrap_or_default())
        });
        Self::of(replicas)
    }
}

impl<S, V, const K: usize> Ladder<S, V, K> {
    fn of(replicas: [Metropolis<S, V, K>; K]) -> Self {
        const { assert!(K > 0, "a ladder has a level") };
        Self {
            replicas,
            graph: SwapGraph::line(),
            schedule: Schedule::default(),
            turn: 0,
            indices: IndexProcess::new(),
            statistics: LadderStatistics::new(),
            stepping_stone: SteppingStone::line(),
        }
    }

    /// Exchanges by another schedule.
    ///
    /// # Panics
    ///
    /// If permutations are asked of more than [`Schedule::MOST_PERMUTED`] levels.
    #[must_use]
    pub fn with_schedule(mut self, schedule: Schedule) -> Self {
        assert!(
            schedule != Schedule::Permutation || K <= Schedule::MOST_PERMUTED,
            "permutations of {K} levels"
        );
        self.schedule = schedule;
        self
    }

    /// Exchanges along other pairs.
    #[must_use]
    pub fn with_graph(mut self, graph: SwapGraph<K>) -> Self {
        self.graph = graph;
        self
    }

    /// Normalisers by other stepping stones than a line's.
    #[must_use]
    pub fn with_stepping_stone(mut self, stone: SteppingStone<K>) -> Self {
        self.stepping_stone = stone;
        self
    }

    /// One step in every replica, then exchanges.
    ///
    /// `kernels` has one a level; K references to one kernel will do if they are the same.
    pub fn sweep<N, F, D, R>(
        &mut self,
        kernels: &[N; K],
        family: &F,
        draws: &mut D,
        recorder: &mut R,
    ) where
        N: Kernel<S, Value = V>,
        F: Family<V, K> + ?Sized,
        D: Draws + ?Sized,
        R: Recorder<V, K> + ?Sized,
    {
        self.step(kernels, family, draws, recorder);
        self.exchange(kernels, draws, recorder);
    }

    /// One step in every replica, in the order of the levels: half a [`sweep`](Self::sweep),
    /// for who wants several steps between exchanges.
    pub fn step<N, F, D, R>(
        &mut self,
        kernels: &[N; K],
        family: &F,
        draws: &mut D,
        recorder: &mut R,
    ) where
        N: Kernel<S, Value = V>,
        F: Family<V, K> + ?Sized,
        D: Draws + ?Sized,
        R: Recorder<V, K> + ?Sized,
    {
        for (level, kernel) in kernels.iter().enumerate() {
            self.step_at(level, kernel, family, draws, recorder);
        }
    }

    /// One step of one replica, for more steps at some levels than at others. The weights of visits count
    /// steps: divide by the steps of a sweep if you add them up by sweep.
    ///
    /// # Panics
    ///
    /// If `level` is K or more.
    #[inline]
    pub fn step_at<N, F, D, R>(
        &mut self,
        level: usize,
        kernel: &N,
        family: &F,
        draws: &mut D,
        recorder: &mut R,
    ) where
        N: Kernel<S, Value = V>,
        F: Family<V, K> + ?Sized,
        D: Draws + ?Sized,
        R: Recorder<V, K> + ?Sized,
    {
        let mut both = Both(&mut self.stepping_stone, recorder);
        self.replicas[level].step(kernel, family, draws, &mut both);
    }

    /// Exchanges by the schedule: the other half of a [`sweep`](Self::sweep).
    pub fn exchange<N, D, R>(&mut self, kernels: &[N; K], draws: &mut D, recorder: &mut R)
    where
        N: Kernel<S, Value = V>,
        D: Draws + ?Sized,
        R: Recorder<V, K> + ?Sized,
    {
        let (pairs, matchings) = (self.graph.pairs().len(), self.graph.matchings());
        let tried = match self.schedule {
            Schedule::Off => 0..0,
            Schedule::Permutation => {
                self.permute(kernels, draws, recorder);
                0..0
            }
            _ if pairs == 0 => 0..0,
            Schedule::RandomPair => {
                let pair = self.graph.any_pair(draws);
                pair..pair + 1
            }
            Schedule::RandomMatching => self.graph.matching(self.graph.any_matching(draws)),
            Schedule::Alternating => {
                let turn = self.turn % matchings as u64;
                self.graph.matching(turn as usize)
            }
            Schedule::Full => 0..pairs,
        };
        for pair in tried {
            self.try_swap(self.graph.pairs()[pair], kernels, draws, recorder);
        }
        self.end_round();
    }

    /// Metropolis' exchange of one pair: RELT eq. 9.
    fn try_swap<N, D, R>(
        &mut self,
        [a, b]: [usize; 2],
        kernels: &[N; K],
        draws: &mut D,
        recorder: &mut R,
    ) where
        N: Kernel<S, Value = V>,
        D: Draws + ?Sized,
        R: Recorder<V, K> + ?Sized,
    {
        let density = |level: usize, at: usize| self.replicas[at].densities[level];
        let acceptance = exchange_acceptance(
            [density(a, a), density(b, b)],
            [density(a, b), density(b, a)],
        );
        let accepted = decide(acceptance, draws);
        self.statistics.swaps[a][b].push(acceptance, accepted);
        if accepted {
            self.swap(a, b, kernels, draws, recorder);
        }
    }

    /// Gibbs' exchange of all at once.
    fn permute<N, D, R>(&mut self, kernels: &[N; K], draws: &mut D, recorder: &mut R)
    where
        N: Kernel<S, Value = V>,
        D: Draws + ?Sized,
        R: Recorder<V, K> + ?Sized,
    {
        let law = Permutations::new(K, |level, at| self.replicas[at].densities[level]);
        let index = draws.index(law.weights());
        let change = law.change();
        self.statistics.permutations.push(change, index > 0);
        let wanted = Permutations::get(K, index);
        let mut at: [usize; K] = std::array::from_fn(|level| level);
        for (level, wanted) in wanted.iter().enumerate().take(K) {
            let found = at.iter().position(|state| state == wanted);
            if let Some(other) = found.filter(|&other| other != level) {
                self.swap(level, other, kernels, draws, recorder);
                at.swap(level, other);
            }
        }
    }

    /// Exchanges two states, a < b.
    fn swap<N, D, R>(
        &mut self,
        a: usize,
        b: usize,
        kernels: &[N; K],
        draws: &mut D,
        recorder: &mut R,
    ) where
        N: Kernel<S, Value = V>,
        D: Draws + ?Sized,
        R: Recorder<V, K> + ?Sized,
    {
        let (before, after) = self.replicas.split_at_mut(b);
        let mut both = Both(&mut self.stepping_stone, recorder);
        before[a].exchange(&mut after[0], &kernels[a], draws, &mut both);
        self.indices.swap(a, b);
    }

    fn end_round(&mut self) {
        self.turn += 1;
        let arrivals = self.indices.arrive();
        self.statistics.rounds += 1;
        self.statistics.restarts += u64::from(arrivals.restart);
        self.statistics.round_trips += u64::from(arrivals.round_trip);
        self.stepping_stone.end_sweep();
    }

    /// Reports what the current states have gathered, each at its level: at the end, and
    /// before anything changes densities from outside.
    pub fn flush<R: Recorder<V, K> + ?Sized>(&mut self, recorder: &mut R) {
        let mut both = Both(&mut self.stepping_stone, recorder);
        for replica in &mut self.replicas {
            replica.flush(&mut both);
        }
    }

    /// Reads all densities off a changed family. Flush before. Normalisers gathered so far
    /// belong to the old one: [`reset_statistics`](Self::reset_statistics) forgets them.
    pub fn read_densities<F: Family<V, K> + ?Sized>(&mut self, family: &F) {
        for replica in &mut self.replicas {
            replica.read_densities(family);
        }
    }

    /// Forgets the statistics of exchanges and the sums of normalisers (after burn-in, say).
    /// Where lineages stand is kept; so are the replicas' own statistics. [Flush](Self::flush) first (into
    /// [`Ignore`](crate::Ignore) after burn-in): what is pending would be counted afterwards.
    pub fn reset_statistics(&mut self) {
        self.statistics = LadderStatistics::new();
        self.stepping_stone = SteppingStone::on(self.stepping_stone.below());
    }

    /// The chains, by level.
    pub fn replicas(&self) -> &[Metropolis<S, V, K>; K] {
        &self.replicas
    }

    /// Which pairs may exchange.
    pub fn graph(&self) -> &SwapGraph<K> {
        &self.graph
    }

    /// Which exchanges are tried.
    pub fn schedule(&self) -> Schedule {
        self.schedule
    }

    /// Rounds of exchanges since the ladder was made: decides whose turn it is to be tried
    /// by [`Schedule::Alternating`].
    pub fn turn(&self) -> u64 {
        self.turn
    }

    /// Where lineages stand.
    pub fn indices(&self) -> &IndexProcess<K> {
        &self.indices
    }

    /// How exchanges went so far.
    pub fn statistics(&self) -> &LadderStatistics<K> {
        &self.statistics
    }

    /// The sums for running normalisers. What current states have gathered is in them after
    /// a [`flush`](Self::flush).
    pub fn stepping_stone(&self) -> &SteppingStone<K> {
        &self.stepping_stone
    }
}

#[cfg(test)]
mod lazy_tests;
mod points;
#[cfg(feature = "serde")]
mod serial;
#[cfg(test)]
mod tests;
