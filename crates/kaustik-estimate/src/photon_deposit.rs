//! What the visits of photon chains are worth.

use kaustik_film::Film;
use kaustik_mcmc::{Recorder, Visit};
use kaustik_path::{Event, note};

use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use crate::{PhotonMap, PhotonValue, RegionSums, Scale};

/// How the samples of several chains make one picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Combine {
    /// The balance heuristic over all chains (G sec. 4.4): what a path weighs does not depend on the chain
    /// that found it.
    #[default]
    Balance,
    /// The plain mean of what each chain estimates by itself.
    Average,
}

/// A visit of weight 1 in [`PhotonDeposit::touches`].
pub const TOUCH: u64 = 1 << 16;

/// Splats what chains visit: on a film for each level, with weights from rough normalisers `b0`.
///
/// Level `l` of `N` weighted visits becomes its share of the picture by the factor `(b_l / b0_l) / N`, once `b_l` is known
/// (as RELT eq. 23, every chain with the same number of samples): right for any `b0`, as weights made of it sum to 1.
#[derive(Debug)]
pub struct PhotonDeposit<'a, const K: usize> {
    /// Where paths meet points.
    pub map: PhotonMap<'a>,
    /// From the unit square to pixels.
    pub scale: Scale,
    /// A film for each level.
    pub films: [&'a Film; K],
    /// Rough normalisers, > 0.
    pub rough: [f64; K],
    /// How chains share.
    pub combine: Combine,
    /// Where statistics of regions are gathered, and into which half of them.
    pub regions: Option<(&'a RegionSums<K>, usize)>,
    /// How often each point was touched, in steps of [`TOUCH`], if anybody asks.
    pub touches: Option<&'a [AtomicU64]>,
    /// Sum of the visits' weights at each level.
    pub counts: [f64; K],
    /// Values of the visits at each level that were not finite.
    pub faults: [u64; K],
}

/// The weight of level l, `(T_l / b0_l) / sum(T_m / b0_m)` or `1 / K`, over `T_l / b0_l`.
#[inline]
fn share<const K: usize>(
    combine: Combine,
    rough: &[f64; K],
    densities: &[f64; K],
    level: usize,
) -> f64 {
    match combine {
        Combine::Balance => {
            let sum: f64 = densities.iter().zip(rough).map(|(t, b)| t / b).sum();
            1.0 / sum
        }
        Combine::Average => rough[level] / (densities[level] * K as f64),
    }
}

impl<const K: usize> Recorder<PhotonValue, K> for PhotonDeposit<'_, K> {
    fn record(&mut self, visit: Visit<'_, PhotonValue, K>) {
        let level = visit.level;
        if visit.weight <= 0.0 {
            return;
        }
        note(|| Event::Visit {
            level: level as u32,
            weight: visit.weight,
        });
        self.counts[level] += visit.weight;
        self.faults[level] += u64::from(visit.value.path.nonfinite());
        if visit.value.meetings.is_empty() {
            return;
        }
        let weight = visit.weight * share(self.combine, &self.rough, visit.densities, level);
        let photons = visit.value.path.photons();
        for meeting in &visit.value.meetings {
            let photon = &photons[meeting.photon as usize];
            let sound = (self.map).splat(
                self.films[level],
                self.scale,
                photon,
                meeting.point as usize,
                weight,
            );
            self.faults[level] += u64::from(!sound);
            if let Some(touches) = self.touches {
                let steps = (visit.weight * TOUCH as f64).round_ties_even() as u64;
                touches[meeting.point as usize].fetch_add(steps, Relaxed);
            }
        }
        if let Some((sums, half)) = self.regions {
            sums.take(&visit, &self.map, &self.rough, half);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whatever the rough normalisers are, what all chains together give to a path is one: each level visits it with
    /// density `T_l / b_l` and scales by `b_l / b0_l`, so that `b_l` falls out.
    #[test]
    fn shares_sum_to_one() {
        for rough in [[1.0, 0.3, 0.01, 1e-5], [1.0, 0.9, 0.9, 0.2]] {
            for densities in [[1.0, 1.0, 0.5, 1e-7], [1.0, 1.0, 1.0, 1.0]] {
                for combine in [Combine::Balance, Combine::Average] {
                    let of = |l: usize| densities[l] / rough[l];
                    let sum: f64 = (0..4)
                        .map(|l| of(l) * share(combine, &rough, &densities, l))
                        .sum();
                    assert!((sum - 1.0).abs() < 1e-12, "{combine:?}: {sum}");
                }
            }
        }
    }
}
