//! Independent samples beside the chains, spread evenly over the image.
//!
//! The uniform replica is free to go anywhere, as an exchange must be able to begin anywhere; its samples,
//! and the visits of all chains, fall on pixels by chance. Where light is easy to find, this chance is most
//! of the noise: a pixel that is visited 48 times in place of 60 is dark by a fifth, however well each visit
//! knows its light. So a ladder also walks over the cells of a grid, a sample in each, as `bdpt` does. These
//! samples count in the heuristic as more of the uniform replica's, and take part in no exchange. The
//! normaliser counts them as if they fell by chance: they know the light of the picture at least as well as
//! such samples do, so that its stated error is rather too large for them.

use kaustik_estimate::{PathTarget, ReplicaDeposit, ReplicaFamily};
use kaustik_mcmc::{
    Draws, Independent, Recorder, SampleGenerators, Target, Visit, checked_densities, generator,
};
use kaustik_path::Contributions;

use super::full_replica;
use super::noise;
use super::start::Started;
use crate::sampling::cells::Cells;
use crate::sampling::shuffle::Shuffle;
use crate::sampling::stratified::mix;
use crate::sampling::streams;
use crate::{EvenSamples, RenderSettings};

/// The most samples a sweep, if it is not said how many, and the fewest.
const MOST: f64 = EvenSamples::MOST as f64;
const FEWEST: f64 = 8.0;
/// More than so many only where each cell of the image still has one sample at most while all ladders take a sweep: in
/// small pictures there would be hardly any sweeps.
const MOST_OF_SMALL: f64 = 64.0;
/// As many where light is hard to find, but none of it is left to a specific replica.
const FEW: f64 = 64.0;
/// As many where light is hard to find, and a specific replica has little of it.
const FEW_BESIDE: f64 = 32.0;
/// That is: of the full replica's density, in the mean, its own is at most this share.
const LITTLE: f64 = 0.02;

/// How many even samples a sweep are worth their cost.
///
/// With `r` the effective share of independent samples for a replica (their mean squared over
/// the mean of squares; of those where the image is lit), an even sample estimates its pixel with a relative variance of about
/// `1/r - 1`. A visit of a chain has 1 or more, because visits meet a pixel by chance. So from
/// `r` = 1/2 on even samples are the better ones, and chains go on only for what they may yet
/// find. The replica that is hardest to sample decides, since its light is what chains are for.
/// Where light is hard to find there are [some](FEW) all the same.
pub(super) fn samples_a_sweep<const K: usize>(
    settings: &RenderSettings,
    started: &Started,
    specific: bool,
) -> u32 {
    let particles = started.particles.max(1) as f64;
    // What is dark, or a lamp, makes no light harder to find elsewhere.
    let lit = noise::lit(&started.pool);
    let shares = started
        .effective
        .iter()
        .take(K)
        .map(|[at_once, _]| at_once / particles);
    let ease = 2.0 * shares.fold(0.5, |least, share| f64::min(least, share / lit));
    let rough = |k: usize| started.rough[k].value;
    let few = if specific {
        few_beside(rough(K - 1) / rough(full_replica::<K>()))
    } else {
        FEW
    };
    let cells = Cells::new(settings).count();
    let a_ladder = cells as f64 / f64::from(settings.options.ladders);
    let most = MOST.min(a_ladder.max(MOST_OF_SMALL));
    // 16 where an effective sample in four is one; 256 where it is one in two
    (MOST * ease.powi(4)).max(few).min(most).round() as u32
}

/// Even samples where light is hard to find: they show what is easy all the same. The more light the specific
/// replica has, of its share of the full replica's density, the fewer: that light is seen in sweeps alone. Measured:
/// `docs/experiments/relt.md`.
fn few_beside(specific: f64) -> f64 {
    (FEW_BESIDE * (LITTLE / specific).min(1.0)).max(FEWEST)
}

/// The way of one ladder over the cells.
///
/// All cells stand in a circle, in an order without a pattern: where a render has not come to all of them
/// yet, what is missing looks like noise and not like hatching. The ladders begin at even distances and go
/// round. Where the first begins is a uniform random cell, so that each sample is uniform over the image by
/// itself, and the picture right in the mean after any number of them.
pub(super) struct Even {
    cells: Cells,
    /// How many ladders share the circle, and on whose part of it this one is.
    ladders: u64,
    part: u64,
    /// Place on the circle.
    place: u64,
    /// By how much the order is moved on.
    first: u64,
    order: Shuffle,
    /// Complete passes over the cells of its part.
    pass: u64,
    seed: u64,
    generators: SampleGenerators,
    step: u64,
    value: Contributions,
}

impl Even {
    pub(super) fn new(settings: &RenderSettings, ladder: u32) -> Self {
        let cells = Cells::new(settings);
        let count = cells.count();
        let ladders = u64::from(settings.options.ladders);
        let begin = generator(settings.seed, streams::EVEN_BEGINNING).uniform();
        let mut even = Self {
            cells,
            ladders,
            part: u64::from(ladder),
            place: count * u64::from(ladder) / ladders,
            first: ((begin * count as f64) as u64).min(count - 1),
            order: Shuffle::new(count, mix(settings.seed)),
            pass: 0,
            seed: mix(settings.seed),
            generators: SampleGenerators::new(settings.seed, streams::even(ladder)),
            step: 0,
            value: Contributions::default(),
        };
        even.enter();
        even
    }

    /// To the part that the place is in.
    fn enter(&mut self) {
        let count = self.cells.count();
        while self.place >= count * (self.part + 1) / self.ladders {
            self.part += 1;
            self.pass += 1;
            if self.part == self.ladders {
                (self.part, self.place) = (0, 0);
            }
        }
    }

    /// To where it is after so many samples: all follows from their number.
    pub(super) fn go_to(&mut self, step: u64, ladder: u32) {
        let (count, ladder) = (u128::from(self.cells.count()), u128::from(ladder));
        let ladders = u128::from(self.ladders);
        let along = count * ladder / ladders + u128::from(step);
        let (round, place) = (along / count, along % count);
        // the first part that ends behind the place
        let part = ((place + 1) * ladders).div_ceil(count) - 1;
        self.place = place as u64;
        self.part = part as u64;
        self.pass = (round * ladders + part - ladder) as u64;
        self.step = step;
    }

    fn cell(&self) -> u64 {
        (self.first + self.order.at(self.place)) % self.cells.count()
    }

    /// One sample in each of the next `count` cells.
    pub(super) fn samples<const K: usize>(
        &mut self,
        count: u32,
        target: &PathTarget<'_>,
        family: &ReplicaFamily<K>,
        deposit: &mut ReplicaDeposit<'_, K>,
    ) {
        for _ in 0..count {
            let cell = self.cell();
            let inner = Independent::new(self.generators.at(self.step));
            let mut u = (self.cells).confine((cell, self.pass), self.seed, inner);
            target.evaluate(&mut u, &mut self.value);
            if let Some(densities) = checked_densities(family, &self.value) {
                deposit.record(Visit {
                    level: 0,
                    value: &self.value,
                    densities: &densities,
                    weight: 1.0,
                    independent: 1.0,
                });
            }
            self.step += 1;
            self.place += 1;
            self.enter();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Method;

    #[test]
    fn the_more_only_sweeps_show_the_fewer_are_even() {
        let found = [0.0, 0.02, 0.04, 0.08, 0.16, 0.32, 1.0].map(few_beside);
        let wanted = [32.0, 32.0, 16.0, 8.0, 8.0, 8.0, 8.0];
        for (found, wanted) in found.into_iter().zip(wanted) {
            assert!((found - wanted).abs() < 1e-12, "{found} {wanted}");
        }
    }

    fn walks(columns: u32, rows: u32, ladders: u32, seed: u64) -> Vec<Even> {
        let mut settings = RenderSettings {
            method: Method::Relt,
            width: columns,
            height: rows,
            seed,
            ..RenderSettings::default()
        };
        settings.options.ladders = ladders;
        (0..ladders).map(|l| Even::new(&settings, l)).collect()
    }

    fn step(walk: &mut Even) -> (u64, u64) {
        let at = (walk.cell(), walk.pass);
        walk.place += 1;
        walk.enter();
        at
    }

    /// Ladders that go side by side visit every cell equally often, each time with another sample of the cell's
    /// sequence; also where there are fewer cells than ladders.
    #[test]
    fn all_ladders_together_visit_all_cells_alike() {
        for (columns, rows, ladders) in [(16, 12, 64), (7, 5, 3), (1, 1, 4), (5, 1, 64)] {
            let mut walks = walks(columns, rows, ladders, 7);
            let cells = (columns * rows) as usize;
            let mut visits = vec![Vec::new(); cells];
            // as many steps of every ladder as there are cells: each goes once round
            for _ in 0..cells {
                for walk in &mut walks {
                    let (cell, pass) = step(walk);
                    visits[cell as usize].push(pass);
                }
            }
            for passes in &mut visits {
                passes.sort_unstable();
                let count = passes.len();
                passes.dedup();
                assert_eq!((count, passes.len()), (ladders as usize, count));
            }
        }
    }

    /// Whoever goes on from a number of samples stands where one stands that has walked so far.
    #[test]
    fn a_walk_goes_on_anywhere() {
        for (columns, rows, ladders) in [(16, 12, 64), (7, 5, 3), (1, 1, 4), (5, 1, 64), (3, 2, 1)]
        {
            for (ladder, mut walked) in (0..).zip(walks(columns, rows, ladders, 7)) {
                for steps in 0..3 * u64::from(columns * rows) {
                    let mut gone = walks(columns, rows, ladders, 7).swap_remove(ladder as usize);
                    gone.go_to(steps, ladder);
                    let at = |walk: &Even| (walk.cell(), walk.part, walk.place, walk.pass);
                    assert_eq!(at(&gone), at(&walked), "{columns}x{rows} {ladder} {steps}");
                    step(&mut walked);
                }
            }
        }
    }

    /// Where ladders have gone a quarter of the way together, no column and no row has been left out: it would show as
    /// a stripe.
    #[test]
    fn no_line_of_the_image_waits_for_the_others() {
        let mut walks = walks(64, 64, 64, 5);
        let mut visits = [[0_u32; 64]; 2];
        for _ in 0..16 {
            for walk in &mut walks {
                let (cell, _) = step(walk);
                visits[0][cell as usize % 64] += 1;
                visits[1][cell as usize / 64] += 1;
            }
        }
        // 16 each in the mean, by chance 16 +- 3.5
        let few = visits.iter().flatten().min();
        let many = visits.iter().flatten().max();
        assert!(few >= Some(&4) && many <= Some(&32), "{visits:?}");
    }

    /// A few steps of every ladder leave hardly a difference.
    #[test]
    fn a_broken_round_differs_by_one() {
        let mut walks = walks(16, 12, 64, 3);
        let mut visits = [0_i32; 192];
        for _ in 0..7 {
            for walk in &mut walks {
                visits[step(walk).0 as usize] += 1;
            }
        }
        let (least, most) = (visits.iter().min(), visits.iter().max());
        assert_eq!((least, most), (Some(&2), Some(&3)));
    }

    /// Where a ladder begins is uniform over all cells.
    #[test]
    fn every_cell_is_a_beginning() {
        let mut seen = [0_u32; 12];
        for seed in 0..1_200 {
            seen[walks(4, 3, 5, seed)[3].cell() as usize] += 1;
        }
        let chi2: f64 = (seen.iter())
            .map(|&n| (f64::from(n) - 100.0).powi(2) / 100.0)
            .sum();
        // 11 degrees of freedom: 31.3 is one in a thousand
        assert!(chi2 < 31.3, "{seen:?}");
    }
}
