//! What the visits of photon chains are worth.

use kaustik_film::Film;
use kaustik_mcmc::{Recorder, Visit};
use kaustik_path::{Event, note};

use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use crate::{PhotonMap, PhotonValue, RegionWitnesses, Scale};

/// How the samples of several chains make one picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Combine {
    /// The balance heuristic over all chains (G sec. 4.4): what a path weighs does not depend on the chain
    /// that found it.
    #[default]
    Balance,
    /// The plain mean of what each chain estimates by itself.
    Average,
    /// The mean of what each chain estimates by itself, weighted by the samples it took (G figure 6).
    Samples,
}

/// What of a path each chain of a ladder stands for.
#[derive(Clone, Copy, Debug)]
pub struct Sharing<const K: usize> {
    /// How.
    pub combine: Combine,
    /// Rough normalisers, > 0.
    pub rough: [f64; K],
    /// How many samples each level delivers, relative to the others, > 0. By the balance heuristic those of a chain, which
    /// resemble each other, may count for fewer.
    pub samples: [f64; K],
}

impl<const K: usize> Sharing<K> {
    /// About how many samples of a level there are at a path, relative to the others: `n_l T_l / b0_l`.
    #[inline]
    pub(crate) fn expected(&self, densities: &[f64; K], level: usize) -> f64 {
        self.samples[level] * densities[level] / self.rough[level]
    }

    /// The weight of a level by the balance heuristic (or `1 / K`, or its part of the samples), divided by
    /// its density `T_l / b0_l`.
    #[inline]
    fn share(&self, densities: &[f64; K], level: usize) -> f64 {
        match self.combine {
            Combine::Balance => {
                let all = (0..K).map(|level| self.expected(densities, level));
                self.samples[level] / all.sum::<f64>()
            }
            Combine::Average => self.rough[level] / (densities[level] * K as f64),
            Combine::Samples => {
                let part = self.samples[level] / self.samples.iter().sum::<f64>();
                part * self.rough[level] / densities[level]
            }
        }
    }
}

/// A visit of weight 1 in [`PhotonDeposit::touches`].
pub const TOUCH: u64 = 1 << 16;

/// Splats what chains visit: on a film for each level, with weights from rough normalisers `b0`.
///
/// Level `l` of `N` weighted visits becomes its share of the picture by the factor `(b_l / b0_l) / N`, once
/// `b_l` is known (as RELT eq. 23): right for any `b0` and any `samples`, as weights made of them sum to 1.
#[derive(Debug)]
pub struct PhotonDeposit<'a, const K: usize> {
    /// Where paths meet points.
    pub map: PhotonMap<'a>,
    /// From the unit square to pixels.
    pub scale: Scale,
    /// A film for each level.
    pub films: [&'a Film; K],
    /// How chains share.
    pub sharing: Sharing<K>,
    /// Where statistics of regions are gathered.
    pub regions: Option<RegionWitnesses<'a, K>>,
    /// How often each point was touched, in steps of [`TOUCH`], if anybody asks.
    pub touches: Option<&'a [AtomicU64]>,
    /// Sum of the visits' weights at each level.
    pub counts: [f64; K],
    /// Values of the visits at each level that were not finite.
    pub faults: [u64; K],
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
        let weight = visit.weight * self.sharing.share(visit.densities, level);
        let photons = visit.value.path.photons();
        for meeting in &visit.value.meetings {
            let photon = &photons[meeting.photon as usize];
            let stands_for = visit.value.stands_for(meeting.photon);
            let sound = (self.map).splat(
                self.films[level],
                self.scale,
                photon,
                meeting.point as usize,
                weight * stands_for,
            );
            self.faults[level] += u64::from(!sound);
            if let Some(touches) = self.touches {
                let steps = (visit.weight * stands_for * TOUCH as f64).round_ties_even() as u64;
                touches[meeting.point as usize].fetch_add(steps, Relaxed);
            }
        }
        if let Some(regions) = &mut self.regions {
            regions.take(&visit, &self.map, &self.sharing);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By how much all chains' parts of a path differ from one at most, for the shares that `share` makes of a sharing,
    /// densities and a level. Each level visits the path with density `T_l / b_l` and scales by `b_l / b0_l`, so that `b_l`
    /// falls out.
    fn off_one(share: impl Fn(&Sharing<4>, &[f64; 4], usize) -> f64) -> f64 {
        let mut off = 0.0f64;
        for rough in [[1.0, 0.3, 0.01, 1e-5], [1.0, 0.9, 0.9, 0.2]] {
            for samples in [[1.0; 4], [1.0, 1.0, 2.0, 8.0]] {
                for combine in [Combine::Balance, Combine::Average, Combine::Samples] {
                    let sharing = Sharing {
                        combine,
                        rough,
                        samples,
                    };
                    for densities in [[1.0, 1.0, 0.5, 1e-7], [1.0, 1.0, 1.0, 1.0]] {
                        let of =
                            |l: usize| densities[l] / rough[l] * share(&sharing, &densities, l);
                        off = off.max(((0..4).map(of).sum::<f64>() - 1.0).abs());
                    }
                }
            }
        }
        off
    }

    /// Whatever the rough normalisers are. Shares that know nothing of them are found.
    #[test]
    fn shares_sum_to_one() {
        let off = off_one(Sharing::share);
        assert!(off < 1e-12, "{off}");
        let without = off_one(|sharing, densities, level| {
            let rough = [1.0; 4];
            Sharing { rough, ..*sharing }.share(densities, level)
        });
        assert!(without > 0.1, "{without}");
    }

    /// The part that each of two chains of 1 and 2 samples has of a path.
    fn parts(combine: Combine, densities: [f64; 2]) -> [f64; 2] {
        let sharing = Sharing {
            combine,
            rough: [1.0, 0.5],
            samples: [1.0, 2.0],
        };
        [0, 1].map(|l| densities[l] / sharing.rough[l] * sharing.share(&densities, l))
    }

    /// A chain of twice the samples has twice the part of what both find.
    #[test]
    fn more_samples_have_a_larger_share() {
        let [first, second] = parts(Combine::Balance, [1.0, 0.5]);
        assert!((second / first - 2.0).abs() < 1e-12, "{first}, {second}");
    }

    /// By samples a chain's part is the same whatever the path; the balance heuristic goes by the densities.
    #[test]
    fn a_mean_by_samples_looks_at_no_path() {
        for densities in [[1.0, 0.5], [1.0, 1e-3]] {
            let [first, second] = parts(Combine::Samples, densities);
            assert!((first - 1.0 / 3.0).abs() < 1e-12 && (second - 2.0 / 3.0).abs() < 1e-12);
        }
        let [first, second] = parts(Combine::Balance, [1.0, 1e-3]);
        assert!(second < 0.01 * first);
    }
}
