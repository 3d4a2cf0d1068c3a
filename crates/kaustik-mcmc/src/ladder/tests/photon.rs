//! The ladder of photon methods (spec stf-photon.md 3.1 and 7): a uniform chain that begins anew in every step, then targets
//! of one common support, each within the one before.

use super::*;

/// Fresh states, or a step round the ring.
#[derive(Clone, Copy)]
struct Scan {
    fresh: bool,
}

impl Kernel<()> for Scan {
    type Value = usize;

    fn propose<D: Draws + ?Sized>(
        &self,
        (): &mut (),
        current: &usize,
        proposed: &mut usize,
        draws: &mut D,
    ) -> Move {
        if self.fresh {
            *proposed = draws.index(&[1.0; STATES]);
            Move::large()
        } else {
            let up = draws.index(&[0.5, 0.5]) == 1;
            *proposed = (current + if up { 1 } else { STATES - 1 }) % STATES;
            Move::small()
        }
    }
}

/// Two of three states are visible.
const TARGETS: Table<4> = [
    [1.0, 0.0, 0.0, 0.0],
    [1.0, 1.0, 0.3, 0.05],
    [1.0, 1.0, 1.0, 0.6],
];

fn sweeps(exchange: impl Fn(&mut Ladder<(), usize, 4>, &mut Enumerator)) -> TransitionMatrix {
    let family = |s: &usize| TARGETS[*s];
    let kernels = [true, false, false, false].map(|fresh| Scan { fresh });
    TransitionMatrix::of(STATES.pow(4), 1, |from, draws| {
        let mut ladder = ladder(&TARGETS, digits(from));
        ladder.step(&kernels, &family, draws, &mut Ignore);
        exchange(&mut ladder, draws);
        place(&ladder)
    })
}

/// All four laws stay what they are, jointly.
#[test]
fn the_scan_keeps_the_product() {
    let kernels = [Scan { fresh: false }; 4];
    let matrix = sweeps(|ladder, draws| ladder.exchange(&kernels, draws, &mut Ignore));
    assert!(matrix.stationarity_defect(&joint(&TARGETS)) < TOLERANCE);
}

/// Taking over a visible fresh state without a look at the targets is right for visibility alone: at a higher level it is
/// a fault, and found.
#[test]
fn a_scan_that_exchanges_too_gladly_is_caught() {
    let kernel = Scan { fresh: false };
    let matrix = sweeps(|ladder, draws| {
        if ladder.replicas[0].densities[2] > 0.0 {
            ladder.swap(0, 2, &[kernel; 4], draws, &mut Ignore);
        }
    });
    let defect = matrix.stationarity_defect(&joint(&TARGETS));
    assert!(defect > 1e-3, "{defect}");
}
