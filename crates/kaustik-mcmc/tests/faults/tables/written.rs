//! States written down and read again.

use super::fault;
use crate::Fault;

/// What is forgotten, and what should have been refused.
pub(crate) const WRITTEN: &[Fault] = &[
    fault(
        "written: pending weights are forgotten",
        "metropolis.rs",
        "pub(crate) pending: Pending,\n    /// The value",
        "#[cfg_attr(feature = \"serde\", serde(skip))]\n    pub(crate) pending: Pending,\n    /// The value",
        "resume::a_chain_resumes_at_every_step resume::a_ladder_resumes_at_every_sweep_under_every_schedule",
    ),
    fault(
        "written: the statistics of a chain are forgotten",
        "metropolis.rs",
        "pub(crate) statistics: Statistics<K>,\n    /// Steps",
        "#[cfg_attr(feature = \"serde\", serde(skip))]\n    pub(crate) statistics: Statistics<K>,\n    /// Steps",
        "resume::a_chain_resumes_at_every_step",
    ),
    fault(
        "written: exchanges so far are forgotten",
        "ladder.rs",
        "statistics: LadderStatistics<K>,\n    stepping_stone",
        "#[cfg_attr(feature = \"serde\", serde(skip))]\n    statistics: LadderStatistics<K>,\n    stepping_stone",
        "resume::a_ladder_resumes_at_every_sweep_under_every_schedule",
    ),
    fault(
        "written: half a batch is forgotten",
        "diagnostics/autocorrelation.rs",
        "half: Option<f64>,\n}",
        "#[cfg_attr(feature = \"serde\", serde(skip))]\n    half: Option<f64>,\n}",
        "resume::adaptations_and_diagnostics_resume_at_every_step",
    ),
    fault(
        "written: what an adaptation has seen is forgotten",
        "adapt/acceptance.rs",
        "seen: Acceptance,\n    logarithmic",
        "#[cfg_attr(feature = \"serde\", serde(skip))]\n    seen: Acceptance,\n    logarithmic",
        "resume::adaptations_and_diagnostics_resume_at_every_step",
    ),
    fault(
        "written: that an adaptation is in logarithms is forgotten",
        "adapt/acceptance.rs",
        "logarithmic: bool,\n}",
        "#[cfg_attr(feature = \"serde\", serde(skip))]\n    logarithmic: bool,\n}",
        "resume::adaptations_and_diagnostics_resume_at_every_step",
    ),
    fault(
        "written: the last large step is forgotten",
        "point/serial.rs",
        "                large_time,\n",
        "                large_time: 0 * large_time,\n",
        "resume::a_chain_resumes_at_every_step",
    ),
    fault(
        "written: when a coordinate was read is forgotten",
        "point/serial.rs",
        "(coordinate.value, coordinate.modify, coordinate.seen)",
        "(coordinate.value, coordinate.modify, -1)",
        "resume::a_chain_resumes_at_every_step",
    ),
    fault(
        "written: an open proposal goes along",
        "point/serial.rs",
        "if !self.undo.is_empty() {",
        "if false {",
        "resume::a_forgotten_proposal_is_not_written",
    ),
    fault(
        "written: founders are all one",
        "population/serial.rs",
        "founders: written.founders,",
        "founders: vec![0; written.founders.len()],",
        "resume::a_population_resumes_between_all_stages",
    ),
    fault(
        "read: any level",
        "serial.rs",
        "check(level < K, \"a level that does not exist\")?;",
        "",
        "hostile::what_cannot_be_is_refused",
    ),
    fault(
        "read: any count",
        "serial.rs",
        "check(count <= MOST, \"a count beyond 2^48\")?;",
        "",
        "hostile::what_cannot_be_is_refused hostile::broken_ladders_are_refused_or_run",
    ),
    fault(
        "read: founders that nobody knows",
        "population/serial.rs",
        "|| !written.founders.iter().all(exists)",
        "|| (false && !written.founders.iter().all(exists))",
        "hostile::what_cannot_be_is_refused hostile::broken_populations_are_refused_or_run",
    ),
    fault(
        "read: coordinates off the circle",
        "point/serial.rs",
        "(0.0..1.0).contains(&value)",
        "!value.is_nan()",
        "hostile::what_cannot_be_is_refused",
    ),
];
