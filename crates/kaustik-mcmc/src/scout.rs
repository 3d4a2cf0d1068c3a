//! Independent proposals within a region that a cheap look recognises.

use kaustik_pss::Coordinates;

use crate::decide::{acceptance, decide};
use crate::family::checked_densities;
use crate::metropolis::Pending;
use crate::{Draws, Family, Metropolis, Mutation, Point, Recorder, Step, Target};

/// A part of the unit cube that is hard to find and cheap to recognise: where both the look and the measure say so.
pub trait Region<V> {
    /// A look at a point. It says the same of the same coordinates, and reads none that the evaluation does not read.
    fn may_hold(&self, u: &mut dyn Coordinates) -> bool;

    /// How much a value brings of what is looked for, at least 0. Where the look is `false` it may be anything.
    fn measure(&self, value: &V) -> f64;
}

/// What scouts look for, and what is evaluated where they find it.
#[doc(alias = "independence sampler")]
#[derive(Debug)]
pub struct Scouting<'a, T, G> {
    /// The target of the chain.
    pub target: &'a T,
    /// What is looked for.
    pub region: &'a G,
}

/// What a scout came back with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Scouted {
    /// A point out of the region: measure 0.
    Nothing,
    /// A point within.
    Found {
        /// Its measure. Over all scouts, this (and 0 for nothing) is an independent sample of the measure's integral.
        measure: f64,
        /// Has the chain gone there?
        accepted: bool,
    },
}

impl<M: Mutation, V, const K: usize> Metropolis<Point<M>, V, K> {
    /// A uniform proposal that is evaluated only if it lies in a region.
    ///
    /// From a state within the region, a point v of the region is accepted with probability min(1, q(v) / q(u));
    /// what lies outside is turned down, as if its density were zero, for the price of a look. From a state outside
    /// the chain never moves by this. So moves go between points of the region alone, both ways
    /// with the same density: any target is left as it is. What it adds to small steps is jumps between
    /// islands of the region; the way into it and out of it are other moves' affair.
    ///
    /// As an exchange, this records nothing by itself: what the current state has gathered is reported before it
    /// is left. `spare` is any point; its state is overwritten.
    pub fn scout<T, G, F, D, R>(
        &mut self,
        scouting: &Scouting<'_, T, G>,
        spare: &mut Point<M>,
        family: &F,
        draws: &mut D,
        recorder: &mut R,
    ) -> Scouted
    where
        T: Target<Value = V>,
        G: Region<V>,
        F: Family<V, K> + ?Sized,
        D: Draws + ?Sized,
        R: Recorder<V, K> + ?Sized,
    {
        let mut proposal = spare.propose(Step::Large, draws);
        if !scouting.region.may_hold(&mut proposal) {
            return Scouted::Nothing; // dropped, and so undone
        }
        scouting.target.evaluate(&mut proposal, &mut self.proposed);
        proposal.leave_open();
        let measure = scouting.region.measure(&self.proposed);
        let densities = checked_densities(family, &self.proposed);
        if densities.is_none() {
            self.statistics.count_defect();
        }
        let (Some(densities), true) = (densities, measure > 0.0) else {
            spare.roll_back();
            return Scouted::Nothing;
        };
        let inside = self.is_inside(scouting.region, draws);
        let wanted = densities[self.level];
        let accepted = inside && decide(acceptance(self.density(), wanted, 1.0), draws);
        if accepted {
            self.flush(recorder);
            spare.commit();
            self.state.exchange(spare, draws);
            std::mem::swap(&mut self.value, &mut self.proposed);
            self.densities = densities;
            self.pending = Pending::default();
            self.stay = 0;
        } else {
            spare.roll_back();
        }
        Scouted::Found { measure, accepted }
    }

    /// Is the chain in the region?
    fn is_inside<D: Draws + ?Sized>(&mut self, region: &impl Region<V>, draws: &mut D) -> bool {
        region.measure(&self.value) > 0.0 && region.may_hold(&mut self.state.current(draws))
    }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use kaustik_pss::Stream;

    use super::*;
    use crate::{Exponential, Ignore, Ladder, LevelKernel, Visit, generator, target};

    const BINS: usize = 20;

    /// Two islands of the region, of unlike densities, in a sea that is lower.
    fn density(x: f64) -> f64 {
        match x {
            _ if (0.1..0.15).contains(&x) => 6.0,
            _ if (0.75..0.85).contains(&x) => 2.0 + 10.0 * (x - 0.75),
            _ => 0.5,
        }
    }

    /// What is looked at up to here.
    struct Islands {
        end: f64,
    }

    const ALL: Islands = Islands { end: 1.0 };

    impl Region<f64> for Islands {
        fn may_hold(&self, u: &mut dyn Coordinates) -> bool {
            // a little of the sea as well: evaluation tells
            let x = u.get(Stream::Camera, 0);
            ((0.05..0.2).contains(&x) || (0.7..0.9).contains(&x)) && x < self.end
        }

        fn measure(&self, x: &f64) -> f64 {
            let high = (0.1..0.15).contains(x) || (0.75..0.85).contains(x);
            f64::from(u8::from(high))
        }
    }

    /// Time in each bin over steps and its expectation, squared difference over the batch variance; and the mean of
    /// scouts' measures.
    fn run(steps: usize, region: &Islands) -> (f64, f64) {
        let place = target(|u: &mut dyn Coordinates| u.get(Stream::Camera, 0));
        let family = |x: &f64| [density(*x)];
        let steps_at = Exponential::new(1.0 / 256.0, 1.0 / 16.0);
        let kernel = LevelKernel::new(&place, 0.0, steps_at);
        let scouting = Scouting {
            target: &&place,
            region,
        };
        let mut rng = generator(91, 0);
        let mut chain = Metropolis::start(&place, &family, 0, steps_at, &mut rng);
        let mut spare = Point::new(steps_at);
        const BATCHES: usize = 50;
        let mut batches = vec![[0.0; BINS]; BATCHES];
        let (mut found, mut sent) = (0.0, 0.0);
        for bins in &mut batches {
            let mut record = |visit: Visit<'_, f64, 1>| {
                bins[(visit.value * BINS as f64) as usize] += visit.weight / steps as f64;
            };
            for _ in 0..steps {
                chain.step(&kernel, &family, &mut rng, &mut record);
                let scouted = chain.scout(&scouting, &mut spare, &family, &mut rng, &mut record);
                sent += 1.0;
                if let Scouted::Found { measure, .. } = scouted {
                    found += measure;
                }
            }
            chain.flush(&mut record);
        }
        let cells = 100;
        let total = 0.5 * 0.85 + 6.0 * 0.05 + 2.5 * 0.1;
        let mut chi2 = 0.0;
        for bin in 0..BINS {
            let middle = |i: usize| (bin as f64 + (i as f64 + 0.5) / cells as f64) / BINS as f64;
            let mass: f64 = (0..cells).map(|i| density(middle(i))).sum();
            let wanted = mass / cells as f64 / BINS as f64 / total;
            let mean: crate::Mean = batches.iter().map(|bins| bins[bin]).collect();
            chi2 += ((mean.mean() - wanted) / mean.standard_error()).powi(2);
        }
        (chi2 / BINS as f64, found / sent)
    }

    /// A step evaluates once, an exchange nothing, a scout what it has found.
    #[test]
    fn nothing_is_evaluated_twice() {
        let count = Cell::new(0_u64);
        let place = target(|u: &mut dyn Coordinates| -> f64 {
            count.set(count.get() + 1);
            u.get(Stream::Camera, 0)
        });
        let family = |x: &f64| [1.0, density(*x), density(*x) * density(*x)];
        let sizes = Exponential::new(1.0 / 256.0, 1.0 / 16.0);
        let kernels = [1.0, 0.0, 0.0].map(|large| LevelKernel::new(&place, large, sizes));
        let mut rng = generator(92, 0);
        let mut ladder = Ladder::start(&place, &family, [sizes; 3], &mut rng);
        let mut spare = Point::new(sizes);
        let scouting = Scouting {
            target: &&place,
            region: &ALL,
        };
        let looks = Cell::new(0);
        let mut wanted = 3;
        for _ in 0..500 {
            ladder.sweep(&kernels, &family, &mut rng, &mut Ignore);
            ladder.step_at(2, &kernels[2], &family, &mut rng, &mut Ignore);
            wanted += 4;
            assert_eq!(count.get(), wanted);
            let scouted = ladder.scout(2, &scouting, &mut spare, &family, &mut rng, &mut Ignore);
            looks.set(looks.get() + u32::from(scouted == Scouted::Nothing));
            let evaluated = count.get() - wanted;
            assert!(evaluated <= 1 && (evaluated == 1 || scouted == Scouted::Nothing));
            wanted = count.get();
        }
        assert!(looks.get() > 300 && ladder.statistics().swap(1, 2).accepted > 50);
    }

    #[test]
    fn scouts_leave_the_target_as_it_is() {
        let (chi2, measure) = run(4_000, &ALL);
        assert!(chi2 < 2.5, "chi2 / {BINS} is {chi2}");
        assert!((measure / 0.15 - 1.0).abs() < 0.02, "{measure}");
    }

    #[test]
    fn defects_are_counted() {
        let place = target(|u: &mut dyn Coordinates| u.get(Stream::Camera, 0));
        let family = |x: &f64| {
            [if (0.1..0.15).contains(x) {
                f64::NAN
            } else {
                1.0
            }]
        };
        let sizes = Exponential::new(1e-6, 1e-5);
        let mut rng = generator(92, 0);
        let mut chain = Metropolis::start(&place, &family, 0, sizes, &mut rng);
        let mut spare = Point::new(sizes);
        let scouting = Scouting {
            target: &&place,
            region: &ALL,
        };
        for _ in 0..400 {
            chain.scout(&scouting, &mut spare, &family, &mut rng, &mut Ignore);
        }
        // one in twenty
        assert!((8..40).contains(&chain.statistics().defects));
    }

    /// The look leaves out what the measure would take: from there no scout is followed, as none comes there.
    #[test]
    fn a_look_at_a_part_leaves_the_target_as_it_is() {
        let (chi2, measure) = run(4_000, &Islands { end: 0.8 });
        assert!(chi2 < 2.5, "chi2 / {BINS} is {chi2}");
        assert!((measure / 0.1 - 1.0).abs() < 0.02, "{measure}");
    }
}
