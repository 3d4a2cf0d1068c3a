//! Which chain ran when, and on which thread, leaves no trace in the bits.

use kaustik_mcmc::{
    Draws, Exponential, Ladder, Pcg64Dxsm, Point, PointKernel, Schedule, Statistics, SteppingStone,
    Visit, generator,
};

use super::resume::{Walk, family};

const LADDERS: u64 = 6;
const SWEEPS: usize = 300;

/// A ladder with its own generator and what it has added up: all that its steps touch.
struct Seat {
    ladder: Ladder<Point<Exponential>, Vec<f64>, 4>,
    rng: Pcg64Dxsm,
    sums: [f64; 4],
    swept: usize,
}

impl Seat {
    fn new(index: u64) -> Self {
        let mut rng = generator(61, index);
        let sizes = [0.5, 0.2, 0.05, 0.01].map(|s| Exponential::new(s / 16.0, s));
        let schedule = [Schedule::Full, Schedule::Alternating, Schedule::Permutation];
        let ladder = Ladder::start(&Walk, &family, sizes, &mut rng)
            .with_schedule(schedule[index as usize % 3]);
        Self {
            ladder,
            rng,
            sums: [0.0; 4],
            swept: 0,
        }
    }

    fn sweep(&mut self, times: usize) {
        let kernels = [1.0, 0.1, 0.0, 0.0].map(|large| PointKernel::new(Walk, large));
        let times = times.min(SWEEPS - self.swept);
        self.swept += times;
        let sums = &mut self.sums;
        let mut record = |visit: Visit<'_, Vec<f64>, 4>| {
            sums[visit.level] += visit.weight * visit.value[0];
        };
        for _ in 0..times {
            self.ladder
                .sweep(&kernels, &family, &mut self.rng, &mut record);
        }
        if self.swept == SWEEPS {
            self.ladder.flush(&mut record);
        }
    }
}

/// All there is to know at the end, merged in the order of the indices.
fn merged(seats: &[Seat]) -> String {
    let mut statistics = Statistics::<4>::new();
    let mut stone = SteppingStone::<4>::line();
    let mut sums = [0.0; 4];
    for seat in seats {
        assert_eq!(seat.swept, SWEEPS);
        for replica in seat.ladder.replicas() {
            statistics.merge(replica.statistics());
        }
        stone.merge(seat.ladder.stepping_stone());
        for (sum, more) in sums.iter_mut().zip(seat.sums) {
            *sum += more;
        }
    }
    let ladders: Vec<_> = seats.iter().map(|seat| &seat.ladder).collect();
    format!(
        "{statistics:?} {:?} {sums:?} {ladders:?}",
        stone.normalisers(1.0)
    )
}

fn seats() -> Vec<Seat> {
    (0..LADDERS).map(Seat::new).collect()
}

#[test]
fn any_order_gives_the_same_bits() {
    let mut in_order = seats();
    in_order.iter_mut().for_each(|seat| seat.sweep(SWEEPS));
    let wanted = merged(&in_order);

    let mut order = generator(62, 0);
    for _ in 0..4 {
        let mut seats = seats();
        while seats.iter().any(|seat| seat.swept < SWEEPS) {
            let next = order.index(&[1.0; LADDERS as usize]);
            seats[next].sweep(1 + order.index(&[1.0; 9]));
        }
        assert_eq!(merged(&seats), wanted);
    }
}

#[test]
fn any_threads_give_the_same_bits() {
    let mut in_order = seats();
    in_order.iter_mut().for_each(|seat| seat.sweep(SWEEPS));
    let wanted = merged(&in_order);

    for (threads, round) in [(1, 7), (2, 1), (3, 50), (6, 300)] {
        let mut seats = seats();
        for i in 0..SWEEPS.div_ceil(round) {
            seats.rotate_left(i % 2); // other ladders on a thread in each round
            std::thread::scope(|scope| {
                for share in seats.chunks_mut((LADDERS as usize).div_ceil(threads)) {
                    scope.spawn(|| share.iter_mut().rev().for_each(|seat| seat.sweep(round)));
                }
            });
        }
        let turned = SWEEPS.div_ceil(round) / 2 % LADDERS as usize;
        seats.rotate_right(turned);
        assert_eq!(merged(&seats), wanted, "{threads} threads");
    }
}
