use serde::Serialize;

/// What energy redistribution on paths did: light as X, Y, Z of the mean sample, in the units of the
/// normalisation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct EnergyStatistics {
    /// Samples from which paths came.
    pub samples: u64,
    /// Paths whose light was to be spread.
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
