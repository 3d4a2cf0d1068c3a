//! What must hold of a population that is read (feature `serde`).

use serde::Deserialize;

use super::{Memory, Population};
use crate::{Extinct, Metropolis, Resampling};

#[derive(Deserialize)]
#[serde(bound(deserialize = "S: Deserialize<'de>, V: Deserialize<'de> + Default"))]
pub(super) struct Written<S, V, const K: usize> {
    particles: Vec<Metropolis<S, V, K>>,
    founders: Vec<u32>,
    resampling: Resampling,
    level: Option<usize>,
    extinct: Option<Extinct>,
    #[serde(deserialize_with = "crate::serial::sound")]
    normaliser: f64,
    #[serde(with = "crate::serial::known")]
    correction: f64,
    #[serde(deserialize_with = "crate::serial::count")]
    defects: u64,
}

impl<S, V, const K: usize> TryFrom<Written<S, V, K>> for Population<S, V, K> {
    type Error = &'static str;

    fn try_from(written: Written<S, V, K>) -> Result<Self, Self::Error> {
        let count = written.particles.len();
        let exists = |founder: &u32| (*founder as usize) < count;
        if written.founders.len() != count || !written.founders.iter().all(exists) {
            return Err("a particle's founder does not exist");
        }
        let level = written.level.unwrap_or(0);
        let mut levels = written.particles.iter().map(Metropolis::level);
        if level >= K || levels.any(|other| other != level) {
            return Err("a particle is not at its population's level");
        }
        Ok(Self {
            particles: written.particles,
            founders: written.founders,
            resampling: written.resampling,
            level: written.level,
            extinct: written.extinct,
            normaliser: written.normaliser,
            correction: written.correction,
            defects: written.defects,
            memory: Memory::default(),
        })
    }
}
