//! Normalising constants from the chains themselves.
//!
//! The ratio of the constants of two levels is an average under the first (RELT eq. 10):
//!
//! ```text
//! b_k = b_j * E under p_j of [ q_k / q_j ]
//! ```
//!
//! so a chain at level j that wanders over the places of level k tells b_k / b_j, and a ladder
//! tells all of them, step by step from a level whose constant is known: the stepping stones.

use std::array::from_fn;

use crate::{Estimate, Recorder, RunningNormalisers, Visit};

/// How many closed batches are kept apart at most.
const BATCHES: usize = 64;

/// Sums for the running normalisers of a family (RELT eq. 10).
///
/// A [`Recorder`]: each visit at the level j below a level k adds its expected-value weight,
/// and the weight times q_k / q_j. A [`Ladder`](crate::Ladder) keeps one and feeds it.
///
/// # What is assumed
///
/// The levels' supports are nested: q_k is zero wherever q_j is ([`defects`](Self::defects) counts visits
/// that say otherwise; [`discrepancies`](RunningNormalisers::discrepancies) show what no chain has come to).
/// The constant of level 0 is known; 1 if it is the uniform law on the cube. Then the estimate is consistent.
/// It is not unbiased in short runs, since the factors of the product are correlated by exchanges and ratios
/// may be heavy-tailed (+9 % after 50 sweeps on a toy with four replicas, nothing to be seen after 5000). The
/// unbiased alternative, noisier for narrow levels, is the mean of q_k over the independent proposals of
/// level 0: [`Statistics::independent`](crate::Statistics::independent).
///
/// # Errors
///
/// By batch means: sweeps are gathered into up to 64 batches, which double in length as the
/// run goes on. To first order, log b_k is a sum of ratio estimates over the stones on the way
/// to k; the spread of that sum over batches is its standard error, correlations between
/// levels included. It is right once a batch is much longer than the chains' memory; two
/// batches are the least, a dozen a minimum of sense.
///
/// # Merging
///
/// Ladders of one family are merged *before* the product is formed, in the order of their
/// indices. Batches of different ladders may differ in length: each is a residual of its own.
#[doc(alias = "bridge sampling")]
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SteppingStone<const K: usize> {
    /// The level below each; 0 is below itself.
    #[cfg_attr(
        feature = "serde",
        serde(
            serialize_with = "crate::serial::array::serialize",
            deserialize_with = "tree"
        )
    )]
    below: [usize; K],
    open: Batch<K>,
    /// Sweeps in the open batch.
    #[cfg_attr(feature = "serde", serde(deserialize_with = "crate::serial::count"))]
    sweeps: u64,
    /// Sweeps in a closed batch.
    #[cfg_attr(feature = "serde", serde(deserialize_with = "crate::serial::count"))]
    length: u64,
    #[cfg_attr(feature = "serde", serde(deserialize_with = "batches"))]
    closed: Vec<Batch<K>>,
    merged: Moments<K>,
    #[cfg_attr(feature = "serde", serde(deserialize_with = "crate::serial::count"))]
    defects: u64,
}

/// Sums over successive sweeps, by the upper level of each stone.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Batch<const K: usize> {
    /// Of weight times q_k / q_j.
    #[cfg_attr(feature = "serde", serde(with = "crate::serial::array"))]
    ratio: [f64; K],
    /// Of weights at level j.
    #[cfg_attr(feature = "serde", serde(with = "crate::serial::array"))]
    weight: [f64; K],
}

impl<const K: usize> Batch<K> {
    const EMPTY: Self = Self {
        ratio: [0.0; K],
        weight: [0.0; K],
    };

    fn add(&mut self, other: &Self) {
        for k in 0..K {
            self.ratio[k] += other.ratio[k];
            self.weight[k] += other.weight[k];
        }
    }
}

/// First and second moments of batches.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Moments<const K: usize> {
    #[cfg_attr(feature = "serde", serde(deserialize_with = "crate::serial::count"))]
    batches: u64,
    sum: Batch<K>,
    #[cfg_attr(feature = "serde", serde(with = "crate::serial::table"))]
    ratio_ratio: [[f64; K]; K],
    #[cfg_attr(feature = "serde", serde(with = "crate::serial::table"))]
    ratio_weight: [[f64; K]; K],
    #[cfg_attr(feature = "serde", serde(with = "crate::serial::table"))]
    weight_weight: [[f64; K]; K],
}

impl<const K: usize> Moments<K> {
    const EMPTY: Self = Self {
        batches: 0,
        sum: Batch::EMPTY,
        ratio_ratio: [[0.0; K]; K],
        ratio_weight: [[0.0; K]; K],
        weight_weight: [[0.0; K]; K],
    };

    fn push(&mut self, batch: &Batch<K>) {
        self.batches += 1;
        self.sum.add(batch);
        for k in 0..K {
            for l in 0..K {
                self.ratio_ratio[k][l] += batch.ratio[k] * batch.ratio[l];
                self.ratio_weight[k][l] += batch.ratio[k] * batch.weight[l];
                self.weight_weight[k][l] += batch.weight[k] * batch.weight[l];
            }
        }
    }

    fn add(&mut self, other: &Self) {
        self.batches += other.batches;
        self.sum.add(&other.sum);
        let matrices = [
            (&mut self.ratio_ratio, &other.ratio_ratio),
            (&mut self.ratio_weight, &other.ratio_weight),
            (&mut self.weight_weight, &other.weight_weight),
        ];
        for (mine, theirs) in matrices {
            let theirs = theirs.iter().flatten();
            mine.iter_mut()
                .flatten()
                .zip(theirs)
                .for_each(|(m, t)| *m += t);
        }
    }

    /// The ratio of the sums: b_k over that of the level below.
    fn ratio(&self, k: usize) -> f64 {
        if self.sum.weight[k] > 0.0 {
            self.sum.ratio[k] / self.sum.weight[k]
        } else {
            0.0
        }
    }

    /// The covariance of log ratio(k) and log ratio(l): to first order that of the mean
    /// relative residuals u_k = (ratio sum - ratio(k) * weight sum) / total, over batches.
    fn covariance(&self, k: usize, l: usize) -> f64 {
        let (r, s) = (self.ratio(k), self.ratio(l));
        let residuals =
            self.ratio_ratio[k][l] - s * self.ratio_weight[k][l] - r * self.ratio_weight[l][k]
                + r * s * self.weight_weight[k][l];
        let freedom = self.batches as f64 / (self.batches as f64 - 1.0);
        freedom * residuals / (self.sum.ratio[k] * self.sum.ratio[l])
    }
}

impl<const K: usize> SteppingStone<K> {
    /// Each level stands on the one before.
    pub fn line() -> Self {
        Self::on(from_fn(|k| k.saturating_sub(1)))
    }

    /// Level k stands on `below[k]`: a tree, for levels that are only partially ordered.
    /// What stands at 0 is not used.
    ///
    /// # Panics
    ///
    /// If a level stands on one that is not before it.
    pub fn on(below: [usize; K]) -> Self {
        for (k, &j) in below.iter().enumerate().skip(1) {
            assert!(j < k, "level {k} stands on level {j}");
        }
        Self {
            below,
            open: Batch::EMPTY,
            sweeps: 0,
            length: 1,
            closed: Vec::with_capacity(BATCHES),
            merged: Moments::EMPTY,
            defects: 0,
        }
    }

    /// The level that each stands on.
    pub fn below(&self) -> [usize; K] {
        self.below
    }

    /// A sweep is over: errors come from batches of sweeps.
    pub fn end_sweep(&mut self) {
        self.sweeps += 1;
        if self.sweeps < self.length {
            return;
        }
        self.closed.push(self.open);
        self.open = Batch::EMPTY;
        self.sweeps = 0;
        if self.closed.len() == BATCHES {
            for i in 0..BATCHES / 2 {
                let second = self.closed[2 * i + 1];
                self.closed[i] = self.closed[2 * i];
                self.closed[i].add(&second);
            }
            self.closed.truncate(BATCHES / 2);
            self.length *= 2;
        }
    }

    /// Takes what another ladder of the same family and the same order of levels has
    /// gathered. (The order, `below`, stays that of this one.)
    pub fn merge(&mut self, other: &Self) {
        self.merged.add(&other.moments());
        self.defects += other.defects;
    }

    /// As [`merge`](Self::merge), but all that the other ladder has gathered is one batch. A dozen ladders
    /// or more should be merged so, into an empty one: ladders are independent, the batches of one are
    /// not while it has still to find what others have found.
    pub fn merge_as_one(&mut self, other: &Self) {
        self.merged.push(&other.moments().sum);
        self.defects += other.defects;
    }

    /// The constants so far, if that of level 0 is `base`.
    ///
    /// A level that none of the visits below has touched has the value 0 and an infinite
    /// error: nothing is known of it.
    pub fn normalisers(&self, base: f64) -> RunningNormalisers<K> {
        let moments = self.moments();
        let mut values = [base; K];
        for k in 1..K {
            values[k] = values[self.below[k]] * moments.ratio(k);
        }
        RunningNormalisers {
            estimates: from_fn(|k| Estimate {
                value: values[k],
                standard_error: self.standard_error(k, values[k], &moments),
            }),
        }
    }

    /// The constant of each level over that of the level below it; 1 for the first, 0 where nothing is known.
    pub fn ratios(&self) -> [f64; K] {
        let moments = self.moments();
        from_fn(|k| if k == 0 { 1.0 } else { moments.ratio(k) })
    }

    /// How many ratios were not finite (a density too small to divide by) and left out, and how many
    /// visits fell where the density of the level below is zero. One of the latter is proof that
    /// the supports are not nested: then all constants from there up are too small.
    pub fn defects(&self) -> u64 {
        self.defects
    }

    /// The sums of weighted ratios and of weights, by upper level.
    #[cfg(test)]
    pub(crate) fn sums(&self) -> [(f64, f64); K] {
        let sum = self.moments().sum;
        from_fn(|k| (sum.ratio[k], sum.weight[k]))
    }

    fn standard_error(&self, level: usize, value: f64, moments: &Moments<K>) -> f64 {
        if level == 0 {
            return 0.0;
        }
        if moments.batches < 2 || value <= 0.0 {
            return f64::INFINITY;
        }
        let way = |level: usize| {
            std::iter::successors(Some(level), |&k| Some(self.below[k])).take_while(|&k| k > 0)
        };
        let variance: f64 = way(level)
            .flat_map(|k| way(level).map(move |l| (k, l)))
            .map(|(k, l)| moments.covariance(k, l))
            .sum();
        // squares of very large or very small densities may be no numbers
        if variance.is_finite() {
            value * variance.max(0.0).sqrt()
        } else {
            f64::INFINITY
        }
    }

    fn moments(&self) -> Moments<K> {
        let mut moments = self.merged;
        self.closed.iter().for_each(|batch| moments.push(batch));
        if self.open != Batch::EMPTY {
            moments.push(&self.open);
        }
        moments
    }
}

/// Each level stands on one before it.
#[cfg(feature = "serde")]
fn tree<'de, D: serde::Deserializer<'de>, const K: usize>(
    deserializer: D,
) -> Result<[usize; K], D::Error> {
    let below: [usize; K] = crate::serial::array::deserialize(deserializer)?;
    let sound = below.iter().enumerate().skip(1).all(|(k, j)| *j < k);
    crate::serial::check(sound, "a level stands on one that is not before it")?;
    Ok(below)
}

/// There is room for one more, and for all that ever will be.
#[cfg(feature = "serde")]
fn batches<'de, D: serde::Deserializer<'de>, const K: usize>(
    deserializer: D,
) -> Result<Vec<Batch<K>>, D::Error> {
    let mut closed: Vec<Batch<K>> = serde::Deserialize::deserialize(deserializer)?;
    crate::serial::check(closed.len() < BATCHES, "too many batches")?;
    closed.reserve_exact(BATCHES - closed.len());
    Ok(closed)
}

impl<V, const K: usize> Recorder<V, K> for SteppingStone<K> {
    #[inline]
    fn record(&mut self, visit: Visit<'_, V, K>) {
        if visit.weight <= 0.0 {
            return;
        }
        if visit.level > 0 && visit.densities[self.below[visit.level]] <= 0.0 {
            self.defects += 1;
        }
        let inverse = visit.weight / visit.density();
        for k in 1..K {
            if self.below[k] == visit.level {
                let ratio = visit.densities[k] * inverse;
                if ratio.is_finite() {
                    self.open.ratio[k] += ratio;
                    self.open.weight[k] += visit.weight;
                } else {
                    self.defects += 1;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests;
