//! How each replica moves.

use std::array::from_fn;

use kaustik_estimate::{PathTarget, ReplicaSet};
use kaustik_mcmc::{Exponential, LevelKernel};

use crate::Steps;

/// Small steps of a replica.
pub(crate) type Mutation = Exponential;

/// Small steps of a replica: RELT 5.1.3's sizes, s2 = 16 s1, or finer ones. Light through glass is a peak a thousandth
/// wide, and so is other light that comes through a slit; what is spread wide still wants the largest of the paper's.
pub(crate) fn mutation(set: &ReplicaSet, steps: Steps, level: usize) -> Mutation {
    const KELEMEN: [f64; 2] = [1.0 / 1024.0, 1.0 / 64.0];
    const PAPER: [f64; 2] = [1.0 / 61.0, 16.0 / 61.0];
    let specific = set.is_specific() && level + 1 == set.count();
    let [s1, s2] = match (steps, specific) {
        (Steps::Kelemen, _) | (Steps::Fine, true) => KELEMEN,
        (Steps::Fine, false) => [KELEMEN[0], PAPER[1]],
        (Steps::Paper | Steps::Adapted, true) => [1.0 / 96.0, 16.0 / 96.0],
        (Steps::Paper | Steps::Adapted, false) => PAPER,
    };
    Exponential::new(s1, s2)
}

/// Kernels of all replicas: the uniform one draws anew, the others perturb.
pub(crate) fn kernels<'a, const K: usize>(
    target: PathTarget<'a>,
    set: &ReplicaSet,
    steps: Steps,
) -> [LevelKernel<PathTarget<'a>, Mutation>; K] {
    from_fn(|level| kernel(target, set, steps, level))
}

/// The kernel of one replica.
#[inline]
pub(crate) fn kernel<'a>(
    target: PathTarget<'a>,
    set: &ReplicaSet,
    steps: Steps,
    level: usize,
) -> LevelKernel<PathTarget<'a>, Mutation> {
    let large = if level == 0 { 1.0 } else { 0.0 };
    LevelKernel::new(target, large, mutation(set, steps, level))
}
