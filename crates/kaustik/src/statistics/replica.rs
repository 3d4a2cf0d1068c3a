use serde::Serialize;

/// What replicas tell about themselves; goes into the image file and into `--stats`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ReplicaStatistics {
    /// The replicas that ran, the uniform one first.
    pub levels: Vec<ReplicaLevel>,
    /// Sweeps of all ladders.
    pub sweeps: u64,
    /// Mean acceptance of exchanges, for each pair that exchanges
    /// ([`ReplicaSet::pairs`](crate::estimate::ReplicaSet::pairs)); `None` where it was never tried by itself, as with
    /// `exchange=gibbs` and `exchange=none`.
    pub exchange_acceptance: Vec<Option<f64>>,
    /// With `exchange=gibbs`: how probable it was in the mean that any states change their places.
    pub permutation_acceptance: Option<f64>,
    /// The pairs, counted from 1.
    pub pairs: Vec<[usize; 2]>,
    /// Independent samples of all ladders that were spread evenly over the image.
    pub even: u64,
    /// Scouts sent by all ladders.
    pub scouts: u64,
    /// How many of all found implicit specular light.
    pub scouts_found: u64,
    /// How often the specific replica went there.
    pub scouts_followed: u64,
    /// Times that the specific replica was to go on a tour.
    pub tours: u64,
    /// How often it went to where one had ended.
    pub tours_followed: u64,
    /// Steps of all tours; there is none where it has no light that nothing else finds.
    pub tour_steps: u64,
    /// Share of these that were accepted.
    pub tour_acceptance: f64,
    /// How often a state's lineage went from the first replica to the last and back.
    pub round_trips: u64,
    /// Particles of the annealing.
    pub particles: u64,
    /// Why replicas that were asked for did not run; `None` if all did.
    pub dropped: Option<String>,
    /// What scales the films: `running`, `exchange` or `initial`.
    pub normaliser: &'static str,
}

/// One replica.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ReplicaLevel {
    /// Weights of the six classes of paths in its density; zeros for the uniform replica.
    pub weights: [f64; 6],
    /// Rough integral of its density, from the annealing: the constant in the weights.
    pub rough: f64,
    /// Its standard error.
    pub rough_error: Option<f64>,
    /// Running estimate from replica to replica (RELT eq. 10): blind to what no chain has found.
    pub normalisation: f64,
    /// Its standard error; `None` while nothing is known of it.
    pub normalisation_error: Option<f64>,
    /// The mean over the uniform replica's own samples: independent of the chains' course, noisier.
    pub independent: f64,
    /// Its standard error.
    pub independent_error: Option<f64>,
    /// How many standard errors lie between `normalisation` and `independent`.
    pub discrepancy: Option<f64>,
    /// Light (X + Y + Z) that its film stands for, by independent samples.
    pub share: f64,
    /// Its standard error.
    pub share_error: Option<f64>,
    /// What its film is multiplied by.
    pub scale: f64,
    /// Mean acceptance of its steps.
    pub acceptance: f64,
    /// Effective number of the annealing's first particles, if they were resampled for this replica at once.
    pub effective_at_once: f64,
    /// That of the annealed population at this replica, before it was resampled.
    pub effective_annealed: f64,
    /// Largest small step, mean over the ladders.
    pub step: f64,
}

impl ReplicaStatistics {
    /// Beyond so many standard errors two estimates of one number call for a word.
    const SUSPECT: f64 = 5.0;

    /// What whoever renders should be told.
    pub fn notices(&self) -> Vec<String> {
        let mut lines = Vec::new();
        if let Some(why) = &self.dropped {
            lines.push(format!("note: {why}"));
        }
        for (index, level) in self.levels.iter().enumerate() {
            if level.discrepancy.is_some_and(|z| z.abs() > Self::SUSPECT) {
                lines.push(format!(
                    "warning: the normalisation of replica {} is {:.6} by exchange and {:.6} by \
                     independent samples, more than {} standard errors apart: render longer, or \
                     with another seed",
                    index + 1,
                    level.normalisation,
                    level.independent,
                    Self::SUSPECT
                ));
            }
        }
        lines
    }
}
