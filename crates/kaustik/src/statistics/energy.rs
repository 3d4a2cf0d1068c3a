use kaustik_mcmc::RedistributionStatistics;
use kaustik_spectrum::Xyz;
use serde::{Deserialize, Serialize};

/// What energy redistribution did: light as X, Y, Z of the mean sample, in the units of the
/// normalisation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct EnergyStatistics {
    /// Samples from which paths came.
    pub samples: u64,
    /// Paths (`erpt-pss`: samples) whose light was to be spread.
    pub starts: u64,
    /// Chains that spread it.
    pub chains: u64,
    /// Chains a sample in the mean.
    pub chains_per_sample: f64,
    /// Paths that would have had more chains than a thousand: their deposits grew instead.
    pub capped: u64,
    /// Light of the paths that were to be spread.
    pub seeded: [f64; 3],
    /// What their chains deposited before any filter. Its mean is that of `seeded`.
    pub deposited: [f64; 3],
    /// Light that was left where it was sampled.
    pub unperturbed: [f64; 3],
    /// Share of all light that the filter by consecutive samples took away; `None` without it.
    pub consecutive_loss: Option<f64>,
    /// Share of the picture's light that the filter by proposals took away; `None` without it.
    pub proposed_loss: Option<f64>,
}

/// Sums of light over samples, as X, Y, Z.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(crate) struct EnergySums {
    /// Of what was to be spread.
    pub(crate) seeded: [f64; 3],
    /// Of what chains deposited before any filter.
    pub(crate) deposited: [f64; 3],
    /// Of what stayed where it was sampled.
    pub(crate) unperturbed: [f64; 3],
}

impl EnergySums {
    pub(crate) fn merge(&mut self, other: &Self) {
        for c in 0..3 {
            self.seeded[c] += other.seeded[c];
            self.deposited[c] += other.deposited[c];
            self.unperturbed[c] += other.unperturbed[c];
        }
    }
}

/// Adds weighted light to one of the sums.
#[inline]
pub(crate) fn add(sum: &mut [f64; 3], colour: Xyz, weight: f64) {
    for (sum, part) in sum.iter_mut().zip(colour.0) {
        *sum += f64::from(part) * weight;
    }
}

impl EnergyStatistics {
    /// Of so many samples; no filter.
    pub(crate) fn new(samples: u64, chains: &RedistributionStatistics, sums: &EnergySums) -> Self {
        let mean = |sum: [f64; 3]| sum.map(|sum| sum / samples.max(1) as f64);
        Self {
            samples,
            starts: chains.starts,
            chains: chains.chains,
            chains_per_sample: chains.chains as f64 / samples.max(1) as f64,
            capped: chains.capped,
            seeded: mean(sums.seeded),
            deposited: mean(sums.deposited),
            unperturbed: mean(sums.unperturbed),
            consecutive_loss: None,
            proposed_loss: None,
        }
    }

    /// What whoever looks at the picture should know: how many chains there were, and what filters took away.
    #[must_use]
    pub fn notices(&self) -> Vec<String> {
        let chains = format!("{:.3} chains a sample", self.chains_per_sample);
        let filters = [
            ("consecutive samples", self.consecutive_loss),
            ("proposals", self.proposed_loss),
        ];
        let lost = filters.into_iter().filter_map(|(name, loss)| {
            let percent = 100.0 * loss?;
            Some(format!(
                "the filter by {name} has taken away {percent:.3} % of the light: the picture is biased"
            ))
        });
        std::iter::once(chains).chain(lost).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_filter_says_that_it_is_biased() {
        let mut energy = EnergyStatistics {
            samples: 10,
            starts: 8,
            chains: 12,
            chains_per_sample: 1.2,
            capped: 0,
            seeded: [1.0; 3],
            deposited: [1.0; 3],
            unperturbed: [0.5; 3],
            consecutive_loss: None,
            proposed_loss: None,
        };
        assert_eq!(energy.notices().len(), 1);
        energy.consecutive_loss = Some(0.0123);
        let notices = energy.notices();
        assert!(notices.len() == 2 && notices[1].contains("consecutive samples"));
        assert!(notices[1].contains("1.230 %") && notices[1].contains("biased"));
    }
}
