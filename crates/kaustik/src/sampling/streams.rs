//! Generators beside those of the ladders.
//!
//! A render's random numbers come from generators that follow from its seed and a number; ladder i has number
//! i. What is drawn besides, before the ladders or beside them, has a number that no ladder has. Two things
//! of one method must not share a number where one of them weighs the other: a picture would be biased by
//! numbers that agree by construction.

/// First samples: a pilot's, a pool's.
pub(crate) const PILOT: u64 = u64::MAX;
/// The choice of first states from these.
pub(crate) const CHOICE: u64 = u64::MAX - 1;
/// `pssmlt`: samples that fix the constant in the weights, which must not depend on the pool.
pub(crate) const CONSTANT: u64 = u64::MAX - 2;
/// Photon chains: the choice of those that go on when an iteration has left others in the dark.
pub(crate) const REVIVAL: u64 = u64::MAX - 2;
/// `mmlt`: samples that fix how often each strategy is tried.
pub(crate) const TECHNIQUES: u64 = u64::MAX - 3;
/// Light seen directly, beside chains.
pub(crate) const LAMPS: u64 = u64::MAX - 1024;
/// How bright a picture is as a whole, beside chains.
pub(crate) const METER: u64 = u64::MAX - 1025;
/// Where such samples look first.
pub(crate) const METER_LOOK: u64 = u64::MAX - 1026;
/// A look at how easy direct light is to find.
pub(crate) const DIRECT_LOOK: u64 = u64::MAX - 1027;
/// A look at what a sample of the start takes.
pub(crate) const START_LOOK: u64 = u64::MAX - 1028;
/// Photon methods: what the camera sees.
pub(crate) const CAMERA: u64 = u64::MAX - 2048;
/// `photon-density`: light paths of the pilot.
pub(crate) const DENSITY: u64 = u64::MAX - 4096;
/// `erpt`, `erpt-pss`: by how much the shares of all cells are turned.
pub(crate) const CARRIED: u64 = u64::MAX - 4096;
/// `relt`: where even samples begin.
pub(crate) const EVEN_BEGINNING: u64 = (1 << 40) - 1;

/// Levels and scouts of an attempt at an annealing have numbers of their own, fewer than this.
const ANNEALING: u64 = 16;

/// `relt`, `annealing`: what is drawn at a level of an attempt, counted from 0.
pub(crate) fn annealing(attempt: u32, level: usize) -> u64 {
    debug_assert!((level as u64) < ANNEALING);
    u64::MAX - u64::from(attempt) * ANNEALING - level as u64
}

/// `annealing`: what is drawn at a level of a ladder's round, of fewer than 2^36.
pub(crate) fn round(ladder: u32, round: u64, level: usize) -> u64 {
    (u64::from(ladder) + 1) << 40 | round << 4 | level as u64
}

/// `mlt`: samples between the mutations of a ladder.
pub(crate) fn fresh(ladder: u32) -> u64 {
    u64::MAX - 65_536 + u64::from(ladder)
}

/// `erpt`, `erpt-pss`: decisions of a ladder's chains, beside its samples.
pub(crate) fn chains(ladder: u32) -> u64 {
    (1 << 32) + u64::from(ladder)
}

/// `relt`: even samples of a ladder.
pub(crate) fn even(ladder: u32) -> u64 {
    (1 << 40) + u64::from(ladder)
}

#[cfg(test)]
mod tests {
    use std::ops::RangeInclusive;

    use super::*;
    use crate::Method;

    /// The most ladders that a render may have.
    const LADDERS: u32 = 4096;

    /// All numbers that a method's generators have.
    fn numbers(method: Method) -> Vec<RangeInclusive<u64>> {
        let one = |number: u64| number..=number;
        let by_ladder = |of: fn(u32) -> u64| of(0)..=of(LADDERS - 1);
        let started = [one(PILOT), one(CHOICE), one(LAMPS)];
        let metered = [one(METER), one(METER_LOOK)];
        let own = match method {
            Method::Path | Method::Light | Method::Bdpt => vec![one(PILOT)],
            Method::Pssmlt => [&started[..], &metered, &[one(CONSTANT)]].concat(),
            Method::PssmltMultistage => [&started[..], &[one(CONSTANT)]].concat(),
            Method::Mmlt => [&started[..], &metered, &[one(CONSTANT), one(TECHNIQUES)]].concat(),
            Method::Mlt => [&started[..], &metered, &[by_ladder(fresh)]].concat(),
            Method::MltMultistage => [&started[..], &[by_ladder(fresh)]].concat(),
            Method::Relt => {
                let own = [
                    annealing(3, 15)..=annealing(0, 0),
                    one(LAMPS),
                    one(EVEN_BEGINNING),
                    by_ladder(even),
                ];
                [&own[..], &metered].concat()
            }
            Method::Annealing => vec![
                annealing(3, 15)..=annealing(0, 0),
                one(LAMPS),
                round(0, 0, 0)..=round(LADDERS - 1, (1 << 36) - 1, 15),
            ],
            Method::Erpt | Method::ErptPss => {
                vec![one(PILOT), one(CARRIED), by_ladder(chains), one(LAMPS)]
            }
            Method::Sppm => vec![one(PILOT), one(CAMERA)],
            Method::PhotonVisibility | Method::PhotonSpatial | Method::PhotonImage => {
                vec![one(PILOT), one(CHOICE), one(REVIVAL), one(CAMERA)]
            }
            Method::PhotonDensity => {
                vec![
                    one(PILOT),
                    one(CHOICE),
                    one(REVIVAL),
                    one(CAMERA),
                    one(DENSITY),
                ]
            }
        };
        [vec![0..=u64::from(LADDERS - 1)], own].concat()
    }

    #[test]
    fn nothing_of_a_method_shares_its_numbers() {
        for method in Method::ALL {
            let mut numbers = numbers(method);
            numbers.sort_by_key(|range| *range.start());
            for pair in numbers.windows(2) {
                assert!(pair[0].end() < pair[1].start(), "{method}: {pair:?}");
            }
        }
    }
}
