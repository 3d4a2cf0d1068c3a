//! How far the light of all films together is known.

use std::array::from_fn;

use kaustik_mcmc::Mean;

use super::ReplicaShares;

/// With this [trust](ReplicaShares::trust), 800 effective samples, the spread of samples is known from themselves.
const KNOWN: f64 = 0.9975;

/// What a ladder adds to the pool, and its sweeps.
type Ladder<const K: usize> = (ReplicaShares<K>, u64);

impl<const K: usize> ReplicaShares<K> {
    /// Standard error of the [light](Self::light) that the samples of a pool and these ladders tell together, with
    /// the [scales](Self::scales) of their sum; each ladder comes with its number of sweeps. Samples of the pool
    /// bring their error to the first `shared` replicas alike.
    ///
    /// The squares of these are added:
    /// - by how much the light changes without one ladder after the other, and the error of the pool, which is the
    ///   same for all ladders;
    /// - of light that few samples have met, what chains foresee above that: samples that have not
    ///   met the rare and bright see no spread;
    /// - of such light, by how much samples and [bridges](Self::bridged) disagree beyond chance, as far as the
    ///   picture stands on bridges: the starts of all ladders come from one population, so that no spread among
    ///   ladders tells how far it was off, or that chains have not yet found what samples have met.
    pub fn error_of_light(pool: &Self, ladders: &[(Self, u64)], shared: usize) -> f64 {
        let (all, sweeps) = sum(pool, ladders);
        let spread = Spread::of(pool, ladders);
        let mut variance = match ladders {
            [] | [_] => all.error_within(&all, shared).powi(2),
            _ => spread.whole + pool.error_within(&all, shared).powi(2),
        };
        let lights = all.lights(sweeps, &all.scales(sweeps));
        let gaps = all.gaps(sweeps);
        for k in 0..K {
            if all.held[k] <= 0.0 {
                // samples have met it and no film shows it
                variance += gaps[k] * gaps[k];
                continue;
            }
            if all.trust(k) >= KNOWN {
                continue;
            }
            variance += (all.foreseen(k, lights[k]) - spread.lights[k]).max(0.0);
            let by_chance = all.part(k).standard_error.powi(2).max(spread.gaps[k]);
            let bridged = 1.0 - all.trust(k);
            variance += bridged * bridged * (gaps[k] * gaps[k] - by_chance).max(0.0);
        }
        variance.sqrt()
    }

    /// By how much the light of each replica by samples is above that by bridges.
    fn gaps(&self, sweeps: u64) -> [f64; K] {
        let bridged = self.lights(sweeps, &self.bridged());
        from_fn(|k| self.parts[k].mean() - bridged[k])
    }

    /// Variance of a replica's light by samples as its chain knows it: the second moment of the light is what the
    /// film holds of it, each times all light of its path.
    fn foreseen(&self, level: usize, light: f64) -> f64 {
        let scale = light / self.held[level];
        let samples = self.parts[level].count().max(1) as f64;
        (scale * self.squares[level] - light * light).max(0.0) / samples
    }
}

/// Variances by leaving out one ladder after the other (the jackknife); 0 for a single one.
struct Spread<const K: usize> {
    whole: f64,
    lights: [f64; K],
    gaps: [f64; K],
}

impl<const K: usize> Spread<K> {
    fn of(pool: &ReplicaShares<K>, ladders: &[Ladder<K>]) -> Self {
        let (mut whole, mut lights, mut gaps) = (Mean::new(), [Mean::new(); K], [Mean::new(); K]);
        let after = sums_after(ladders);
        let (mut before, mut sweeps_before) = (*pool, 0);
        for ((shares, sweeps), (after, sweeps_after)) in ladders.iter().zip(&after) {
            let mut without = before;
            without.merge(after);
            let left = sweeps_before + sweeps_after;
            let parts = without.lights(left, &without.scales(left));
            whole.push(parts.iter().sum());
            for (k, gap) in without.gaps(left).into_iter().enumerate() {
                lights[k].push(parts[k]);
                gaps[k].push(gap);
            }
            before.merge(shares);
            sweeps_before += sweeps;
        }
        // Two values that leave out one of n ladders each differ by 1 / (n - 1) of what the ladders differ by.
        let n = ladders.len() as f64;
        let variance = |mean: &Mean| match ladders {
            [] | [_] => 0.0,
            _ => mean.variance() / n * (n - 1.0).powi(2),
        };
        Self {
            whole: variance(&whole),
            lights: from_fn(|k| variance(&lights[k])),
            gaps: from_fn(|k| variance(&gaps[k])),
        }
    }
}

/// The pool and all ladders.
fn sum<const K: usize>(pool: &ReplicaShares<K>, ladders: &[Ladder<K>]) -> Ladder<K> {
    ladders
        .iter()
        .fold((*pool, 0), |(mut all, n), (one, sweeps)| {
            all.merge(one);
            (all, n + sweeps)
        })
}

/// For each ladder all that come after it.
fn sums_after<const K: usize>(ladders: &[Ladder<K>]) -> Vec<Ladder<K>> {
    let mut sums = Vec::with_capacity(ladders.len());
    let mut after = (ReplicaShares::on(from_fn(|_| 0)), 0);
    for (shares, sweeps) in ladders.iter().rev() {
        sums.push(after);
        after.0.merge(shares);
        after.1 += sweeps;
    }
    sums.reverse();
    sums
}

#[cfg(test)]
mod tests {
    use kaustik_mcmc::{Draws, Estimate, Pcg64Dxsm, generator};

    use super::*;

    const LADDERS: usize = 32;
    const SAMPLES: u64 = 500;
    const RUNS: u64 = 200;
    /// Light of the second replica.
    const RARE: f64 = 0.2;

    /// A run whose second replica has been met `finds` times on average, by ladders and a pool of a sixteenth, and
    /// whose bridges say `bridge` times the truth.
    fn run(
        rng: &mut Pcg64Dxsm,
        finds: f64,
        bridge: f64,
    ) -> (ReplicaShares<2>, Vec<(ReplicaShares<2>, u64)>) {
        let chance = finds / (LADDERS as f64 * SAMPLES as f64 * 17.0 / 16.0);
        let mut one = |samples: u64| {
            let mut shares = ReplicaShares::default();
            for _ in 0..samples {
                let found = rng.uniform() < chance;
                shares.sample([0.5 + rng.uniform(), if found { RARE / chance } else { 0.0 }]);
            }
            shares
        };
        let pool = one(LADDERS as u64 * SAMPLES / 16);
        let ladder = |_| {
            let mut shares = one(SAMPLES);
            shares.hold(0, SAMPLES as f64, 1.0);
            shares.hold(1, SAMPLES as f64, bridge * RARE / chance);
            // up over down is RARE times bridge
            shares.visit(0, 1.0 + RARE * bridge, &[1.0, RARE * bridge]);
            shares.visit(1, 1.0 + RARE * bridge, &[1.0, RARE * bridge]);
            (shares, SAMPLES)
        };
        (pool, (0..LADDERS).map(ladder).collect())
    }

    /// Share of runs that are further from the truth than twice their error.
    fn beyond(finds: f64, bridge: fn(&mut Pcg64Dxsm) -> f64, error: Error) -> f64 {
        let mut rng = generator(41, finds as u64);
        let is_beyond = |_| {
            let bridge = bridge(&mut rng);
            let (pool, ladders) = run(&mut rng, finds, bridge);
            let (all, sweeps) = sum(&pool, &ladders);
            let light = all.light(sweeps, &all.scales(sweeps));
            (light - 1.0 - RARE).abs() > 2.0 * error(&pool, &ladders)
        };
        (0..RUNS).map(is_beyond).filter(|&is| is).count() as f64 / RUNS as f64
    }

    type Error = fn(&ReplicaShares<2>, &[(ReplicaShares<2>, u64)]) -> f64;

    fn stated(pool: &ReplicaShares<2>, ladders: &[(ReplicaShares<2>, u64)]) -> f64 {
        ReplicaShares::error_of_light(pool, ladders, 2)
    }

    /// Without what bridges hide.
    fn jackknife(pool: &ReplicaShares<2>, ladders: &[(ReplicaShares<2>, u64)]) -> f64 {
        let all = sum(pool, ladders).0;
        (Spread::of(pool, ladders).whole.sqrt()).hypot(pool.error_within(&all, 2))
    }

    /// Bridges that are off alike in all ladders.
    fn common(rng: &mut Pcg64Dxsm) -> f64 {
        3.0 * rng.uniform() * rng.uniform()
    }

    #[test]
    fn few_runs_are_far_from_the_truth() {
        for finds in [6.0, 14.0, 100.0, 2_000.0] {
            let stated = beyond(finds, common, stated);
            assert!(stated < 0.1, "{finds}: {stated}");
            assert!(finds < 100.0 || stated > 0.02, "{finds}: {stated}");
        }
        // bridges that are right make the error too large at most
        assert!(beyond(6.0, |_| 1.0, stated) < 0.05);
        // chains that found none say nothing about what they missed
        assert!(beyond(14.0, |_| 0.01, stated) < 0.1);
    }

    #[test]
    fn a_jackknife_alone_is_found_too_small() {
        assert!(beyond(6.0, common, jackknife) > 0.13);
        assert!(beyond(3.0, |_| 0.01, jackknife) > 0.3);
    }

    #[test]
    fn one_ladder_knows_its_error() {
        let mut rng = generator(42, 0);
        let (pool, ladders) = run(&mut rng, 14.0, 1.0);
        let all = stated(&pool, &ladders);
        let one = stated(&pool, &ladders[..1]);
        // the pool is as large as two ladders
        assert!(one > 2.0 * all && one < 8.0 * all, "{one} {all}");
    }

    #[test]
    fn what_no_film_shows_is_in_the_error() {
        let mut shares = ReplicaShares::<1>::default();
        for light in [0.0, 8.0, 8.0, 0.0] {
            shares.sample([light]);
        }
        assert!(stated_of_one(&shares) >= 4.0);
    }

    /// However well it is known.
    #[test]
    fn what_no_film_shows_is_in_the_error_of_the_sure() {
        let mut shares = ReplicaShares::<1>::default();
        let sure = Estimate {
            value: 4.0,
            standard_error: 0.01,
        };
        shares.sampled(0, &Mean::of(1_000_000, sure));
        assert!(shares.trust(0) > KNOWN);
        assert!(stated_of_one(&shares) >= 4.0);
    }

    fn stated_of_one(shares: &ReplicaShares<1>) -> f64 {
        ReplicaShares::error_of_light(&ReplicaShares::default(), &[(*shares, 4)], 1)
    }
}
