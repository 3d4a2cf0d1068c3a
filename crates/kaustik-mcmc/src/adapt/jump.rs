use crate::Scalable;

/// Looks for the step size of the largest expected squared jump (Pasarica and Gelman 2010).
///
/// The mean squared distance between successive states is, for a functional, its variance
/// times 2 (1 - first autocorrelation): the larger, the faster the chain forgets. It needs no
/// acceptance that somebody knows to be right.
///
/// Rounds come in threes: at the present size, at a smaller and at a larger one, apart by a
/// factor that begins at 4. Then the best of them becomes the present size; the factor's
/// logarithm shrinks by 0.9 when the size moves and by 0.5 when it stays. So the search
/// reaches about a factor of 10^6 either way, and freezes geometrically. Where nothing moves at any of the three the
/// steps are taken to be too large, and all become smaller, down to a millionth of the first.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct JumpAdaptation<M> {
    base: M,
    /// log2 of the present scale.
    #[cfg_attr(feature = "serde", serde(deserialize_with = "crate::serial::finite"))]
    centre: f64,
    /// log2 of the factor between trials.
    #[cfg_attr(feature = "serde", serde(deserialize_with = "crate::serial::finite"))]
    spread: f64,
    /// Mean squared jumps of the trials so far, in the order of [`TRIALS`].
    jumps: [f64; 3],
    #[cfg_attr(feature = "serde", serde(deserialize_with = "trial"))]
    trial: usize,
}

/// So far down the search goes by itself where nothing moves: log2 of the scale.
const LOWEST: f64 = -20.0;

/// Where the trials stand, in spreads from the centre.
const TRIALS: [f64; 3] = [0.0, -1.0, 1.0];

impl<M: Scalable> JumpAdaptation<M> {
    /// Begins with the given mutation.
    pub fn new(mutation: M) -> Self {
        Self {
            base: mutation,
            centre: 0.0,
            spread: 2.0,
            jumps: [0.0; 3],
            trial: 0,
        }
    }

    /// Ends a round in which the mean squared jump was `jump` and gives the mutation of the
    /// next. What is jumped is up to the caller: see [`Jumps`](crate::Jumps). All rounds
    /// should be equally long, a multiple of the autocorrelation time. NaN counts as 0.
    #[must_use = "the new mutation is to be set"]
    pub fn end_round(&mut self, jump: f64) -> M {
        self.jumps[self.trial] = jump.max(0.0);
        self.trial += 1;
        if self.trial == TRIALS.len() {
            self.trial = 0;
            self.conclude();
        }
        self.mutation()
    }

    fn conclude(&mut self) {
        let [here, below, above] = self.jumps;
        if here.max(below).max(above) <= 0.0 {
            // Nothing is learnt of how far apart trials should be. A chain that moves at no size is not helped by smaller ones.
            self.centre = (self.centre - self.spread).max(LOWEST.min(self.centre));
            return;
        }
        let towards = if below.max(above) <= here {
            0.0
        } else if below > above {
            -1.0
        } else {
            1.0
        };
        self.centre += towards * self.spread;
        self.spread *= if towards == 0.0 { 0.5 } else { 0.9 };
    }

    /// The mutation of the current round: a trial.
    pub fn mutation(&self) -> M {
        self.scaled(self.centre + TRIALS[self.trial] * self.spread)
    }

    /// The best mutation so far: what to freeze at the end.
    pub fn best(&self) -> M {
        self.scaled(self.centre)
    }

    /// How many times as large as at the beginning the best steps are.
    pub fn scale(&self) -> f64 {
        libm::exp2(self.centre)
    }

    fn scaled(&self, octaves: f64) -> M {
        self.base.scaled(libm::exp2(octaves))
    }
}

#[cfg(feature = "serde")]
fn trial<'de, D: serde::Deserializer<'de>>(deserializer: D) -> Result<usize, D::Error> {
    let trial = serde::Deserialize::deserialize(deserializer)?;
    crate::serial::check(trial < TRIALS.len(), "a trial that does not exist")?;
    Ok(trial)
}
