//! The methods: an engine each, or one for several.

pub(crate) mod annealing;
pub(crate) mod builders;
pub(crate) mod direct;
pub(crate) mod erpt;
pub(crate) mod erpt_pss;
pub(crate) mod independent;
pub(crate) mod mlt;
pub(crate) mod mmlt;
pub(crate) mod path_space;
pub(crate) mod photon;
pub(crate) mod pssmlt;
pub(crate) mod relt;
pub(crate) mod stages;

pub use stages::{StageLadder, StageOptions};
