use std::array::from_fn;

use crate::{
    Draws, Estimate, Extinct, Family, Kernel, Ladder, Population, Recorder, RoughNormalisers, Stage,
};

/// Takes a population up all levels of its family: population annealing on one generator
/// (RELT sec. 4.3, Algorithm 2; see [`Population`] for what is exact, and for doing the same
/// in stages).
///
/// At every level particles are weighed, resampled, brought under the level's kernel and (except at level 0,
/// where they are still independent samples) moved `moves` steps by it; then one of them, chosen uniformly,
/// becomes the start of that level's replica, and all are shown to `recorder` with weight 1
/// ([`Ignore`](crate::Ignore) if only the rest is wanted). Moves change variances, not expectations; without
/// any, copies stay identical: take 2 or more.
///
/// Give lazy points their step sizes level by level with [`LevelKernel`](crate::LevelKernel).
///
/// # When to use it
///
/// As the initial phase of a [`Ladder`]: rough normalisers for its weights and good starts for
/// all replicas. Scaled by the very Z_k of the annealing, what a chain from such a start
/// gathers is unbiased as long as it exchanges with no other; with exchanges the remaining
/// start-up bias is small, and vanishes with the length of the run. Alone, as
/// an estimator through `recorder`, it needs no burn-in and is unbiased, but forgets what it
/// found once the levels are climbed.
///
/// ```
/// use kaustik_mcmc::{
///     Exponential, Ignore, LevelKernel, Population, Resampling, anneal, generator, target,
/// };
/// use kaustik_pss::{Coordinates, Stream};
///
/// let place = target(|u: &mut dyn Coordinates| u.get(Stream::Camera, 0));
/// let bump = |x: &f64| {
///     let bump = (-((x - 0.4) / 0.002).powi(2)).exp();
///     [1.0, bump.powf(0.02), bump]
/// };
/// let sizes = [0.25, 0.05, 0.005].map(|s| Exponential::new(s / 16.0, s));
/// let large = [1.0, 0.0, 0.0];
/// let kernels = std::array::from_fn(|k| LevelKernel::new(&place, large[k], sizes[k]));
/// let mut rng = generator(1, 0);
/// let mut population =
///     Population::start(5000, &place, &bump, &sizes[0], Resampling::Systematic, &mut rng);
/// let annealed = anneal(&mut population, 2, &kernels, &bump, &mut rng, &mut Ignore);
///
/// let b = annealed.normalisers.estimates()[2];
/// let exact = 0.002 * std::f64::consts::PI.sqrt();
/// assert!((b.value - exact).abs() < 5.0 * b.standard_error && b.relative_error() < 0.2);
/// let mut ladder = annealed.into_ladder(&bump)?; // or why not
/// ladder.sweep(&kernels, &bump, &mut rng, &mut Ignore);
/// # Ok::<(), kaustik_mcmc::Extinct>(())
/// ```
///
/// # Panics
///
/// If the population has been taken to a level before: its weights would be multiplied once more.
pub fn anneal<S, V, N, F, D, R, const K: usize>(
    population: &mut Population<S, V, K>,
    moves: usize,
    kernels: &[N; K],
    family: &F,
    draws: &mut D,
    recorder: &mut R,
) -> Annealed<S, V, K>
where
    S: Clone,
    V: Clone,
    N: Kernel<S, Value = V>,
    F: Family<V, K> + ?Sized,
    D: Draws + ?Sized,
    R: Recorder<V, K> + ?Sized,
{
    assert!(
        population.level().is_none(),
        "the population is at level {:?} already",
        population.level()
    );
    let mut stages = [None; K];
    let mut starts = from_fn(|_| None);
    let mut extinct = None;
    for (level, kernel) in kernels.iter().enumerate() {
        let stage = match population.advance(level, kernel, draws) {
            Ok(stage) => stage,
            Err(reason) => {
                extinct = Some(reason);
                break;
            }
        };
        stages[level] = Some(stage);
        // by the level alone: a number of moves that depended on weights would be a bias
        let moves = if level == 0 { 0 } else { moves };
        for _ in 0..moves {
            population.step(kernel, family, draws, &mut crate::Ignore);
        }
        population.visit(recorder);
        starts[level] = population
            .choose(draws)
            .map(|particle| (particle.state().clone(), particle.value().clone()));
    }
    let estimates = stages
        .map(|stage: Option<Stage>| stage.map_or(Estimate::exact(0.0), |stage| stage.normaliser));
    Annealed {
        normalisers: RoughNormalisers::annealed(estimates, population.particles().len()),
        stages,
        starts,
        extinct,
    }
}

/// What an annealing has found.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(bound(
        serialize = "S: serde::Serialize, V: serde::Serialize",
        deserialize = "S: serde::Deserialize<'de>, V: serde::Deserialize<'de>"
    ))
)]
pub struct Annealed<S, V, const K: usize> {
    /// The product of mean weights at each level, fit for the weights of a run; 0 from the
    /// level on where the population died, with the error 0, which says nothing then.
    pub normalisers: RoughNormalisers<K>,
    /// The stages; `None` from the level on where the population died.
    #[cfg_attr(feature = "serde", serde(with = "crate::serial::array"))]
    pub stages: [Option<Stage>; K],
    /// A state with its value for the replica of each level; `None` likewise.
    #[cfg_attr(feature = "serde", serde(with = "crate::serial::array"))]
    pub starts: [Option<(S, V)>; K],
    /// Where the population died, if it did.
    ///
    /// One may try again with more particles (the normalisers are then heuristic constants,
    /// which is all that weights need), or do without the levels that nobody reaches.
    pub extinct: Option<Extinct>,
}

impl<S, V: Default, const K: usize> Annealed<S, V, K> {
    /// The ladder that starts where the annealing ended.
    ///
    /// # Errors
    ///
    /// If some level has no start.
    pub fn into_ladder(
        self,
        family: &(impl Family<V, K> + ?Sized),
    ) -> Result<Ladder<S, V, K>, Extinct> {
        if let Some(extinct) = self.extinct {
            return Err(extinct);
        }
        let missing = self.starts.iter().position(Option::is_none);
        if let Some(level) = missing {
            return Err(Extinct { level });
        }
        let starts: Vec<(S, V)> = self.starts.into_iter().flatten().collect();
        match starts.try_into() {
            Ok(starts) => Ok(Ladder::new(starts, family)),
            Err(_) => Err(Extinct { level: 0 }),
        }
    }
}
