use crate::{Acceptance, Scalable};

/// Drives the acceptance of small steps to a target (Robbins and Monro 1951).
///
/// After round n, log size += gain / n^decay * (acceptance - target), where the acceptance
/// is the round's mean acceptance *probability*. The default target is 0.234, the optimum of
/// many independent dimensions (Roberts, Gelman and Gilks 1997); up to 0.44 is right for one
/// or two. The default gain is 2, its decay 0.6: the size may still travel far, and settles
/// in the end (the gains sum to infinity, their squares do not). Where rounds are few and long, sizes that are far
/// too large come down slowly, by a tenth in the tenth round: see [`in_logarithms`](Self::in_logarithms).
///
/// ```
/// use kaustik_mcmc::{
///     AcceptanceAdaptation, Exponential, Ignore, Metropolis, PointKernel, generator, target,
/// };
/// use kaustik_pss::{Coordinates, Stream};
///
/// let target = target(|u: &mut dyn Coordinates| u.get(Stream::Camera, 0) - 0.5);
/// let family = |x: &f64| [(-5e4 * x * x).exp()]; // a narrow peak
/// let mut adaptation = AcceptanceAdaptation::new(Exponential::default());
/// let mut rng = generator(1, 0);
/// let mutation = adaptation.mutation();
/// let mut chain = Metropolis::start(&target, &family, 0, mutation, &mut rng);
/// let kernel = PointKernel::new(&target, 0.1);
/// for _round in 0..20 {
///     for _ in 0..1000 {
///         chain.step(&kernel, &family, &mut rng, &mut Ignore);
///     }
///     let mutation = adaptation.end_round(chain.statistics().small());
///     chain.set_mutation(mutation, &mut rng);
/// }
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct AcceptanceAdaptation<M> {
    base: M,
    #[cfg_attr(feature = "serde", serde(deserialize_with = "crate::serial::finite"))]
    target: f64,
    #[cfg_attr(feature = "serde", serde(deserialize_with = "crate::serial::finite"))]
    gain: f64,
    #[cfg_attr(feature = "serde", serde(deserialize_with = "crate::serial::finite"))]
    decay: f64,
    #[cfg_attr(feature = "serde", serde(deserialize_with = "crate::serial::finite"))]
    log_scale: f64,
    #[cfg_attr(feature = "serde", serde(deserialize_with = "crate::serial::count"))]
    rounds: u64,
    seen: Acceptance,
    logarithmic: bool,
}

/// Acceptances are taken to be this much larger before their logarithms are taken: that of none is finite.
const LEAST: f64 = 0.02;

/// A size is never moved by more than this factor's logarithm.
const FARTHEST: f64 = 20.0;

impl<M: Scalable> AcceptanceAdaptation<M> {
    /// Begins with the given mutation.
    pub fn new(mutation: M) -> Self {
        Self {
            base: mutation,
            target: 0.234,
            gain: 2.0,
            decay: 0.6,
            log_scale: 0.0,
            rounds: 0,
            seen: Acceptance::default(),
            logarithmic: false,
        }
    }

    /// Another target, in (0, 1).
    ///
    /// # Panics
    ///
    /// If it is not.
    #[must_use]
    pub fn with_target(self, target: f64) -> Self {
        assert!(target > 0.0 && target < 1.0, "an acceptance of {target}");
        Self { target, ..self }
    }

    /// Other gains: gain / n^decay after round n. To converge, 1/2 < decay <= 1.
    ///
    /// # Panics
    ///
    /// If the gain is not above 0 or the decay below, or either is not finite.
    #[must_use]
    pub fn with_gain(self, gain: f64, decay: f64) -> Self {
        let sound = gain > 0.0 && decay >= 0.0 && gain.is_finite() && decay.is_finite();
        assert!(sound, "gains of {gain} / n^{decay}");
        Self {
            gain,
            decay,
            ..self
        }
    }

    /// Compares the logarithms of the acceptances: log size += gain / n^decay * log(acceptance / target). For rounds of
    /// many steps, whose acceptance is well known; the right gain is then about 1, as halving a size that is too large
    /// doubles its acceptance, about.
    #[must_use]
    pub fn in_logarithms(self) -> Self {
        Self {
            logarithmic: true,
            ..self
        }
    }

    /// Ends a round and gives the mutation of the next.
    ///
    /// `total` is the chain's counter of the small steps *since it began* (or the merged
    /// counters of several chains that share the size), of which the adaptation takes what
    /// is new. A round without proposals changes nothing and does not count.
    #[must_use = "the new mutation is to be set"]
    pub fn end_round(&mut self, total: &Acceptance) -> M {
        let round = total.since(&self.seen);
        self.seen = *total;
        if round.proposed > 0 {
            self.rounds += 1;
            let gain = self.gain / libm::pow(self.rounds as f64, self.decay);
            let off = if self.logarithmic {
                libm::log((round.rate() + LEAST) / (self.target + LEAST))
            } else {
                round.rate() - self.target
            };
            let log_scale = self.log_scale + gain * off;
            self.log_scale = log_scale.clamp(-FARTHEST, FARTHEST);
        }
        self.mutation()
    }

    /// From now on learns as fast as at first, from where it is: for targets that have changed.
    pub fn begin_anew(&mut self) {
        self.rounds = 0;
    }

    /// The mutation of the current round.
    pub fn mutation(&self) -> M {
        self.base.scaled(self.scale())
    }

    /// How many times as large as at the beginning steps would be, if there were no largest and no smallest.
    pub fn scale(&self) -> f64 {
        libm::exp(self.log_scale)
    }

    /// How many rounds have been learnt from, since it last began.
    pub fn rounds(&self) -> u64 {
        self.rounds
    }
}
