//! The ladder of photon methods (Gruson et al. 2016): a uniform chain that begins anew in every step, then targets
//! of one common support, each within the one before.

use kaustik_pss::{Coordinates, Stream};

use super::*;
use crate::{Metropolis, Point, Power};

/// Fresh states, or a step round the ring.
#[derive(Clone, Copy)]
enum Scan {
    Fresh,
    Around(Ring),
}

const AROUND: Scan = Scan::Around(Ring { up: 0.5 });

impl Kernel<()> for Scan {
    type Value = usize;

    fn propose<D: Draws + ?Sized>(
        &self,
        (): &mut (),
        current: &usize,
        proposed: &mut usize,
        draws: &mut D,
    ) -> Move {
        match self {
            Self::Fresh => {
                *proposed = draws.index(&[1.0; STATES]);
                Move::large()
            }
            Self::Around(ring) => ring.propose(&mut (), current, proposed, draws),
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
    let kernels = [Scan::Fresh, AROUND, AROUND, AROUND];
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
    let kernels = [AROUND; 4];
    let matrix = sweeps(|ladder, draws| ladder.exchange(&kernels, draws, &mut Ignore));
    assert!(matrix.stationarity_defect(&joint(&TARGETS)) < TOLERANCE);
}

/// Taking over a visible fresh state without a look at the targets is right for visibility alone: at a higher
/// level it is a fault, and found.
#[test]
fn a_scan_that_exchanges_too_gladly_is_caught() {
    let kernel = AROUND;
    let matrix = sweeps(|ladder, draws| {
        if ladder.replicas[0].densities[2] > 0.0 {
            ladder.swap(0, 2, &[kernel; 4], draws, &mut Ignore);
        }
    });
    let defect = matrix.stationarity_defect(&joint(&TARGETS));
    assert!(defect > 1e-3, "{defect}");
}

/// A chain that goes on from where another one is has that one's state and densities, its own step size, and
/// pays what is owed to the other's.
#[test]
fn a_chain_goes_on_from_another() {
    let target = crate::target(|u: &mut dyn Coordinates| u.get(Stream::Light, 0));
    let family = |x: &f64| [1.0, f64::from(u8::from(*x > 0.5))];
    let mut draws = generator(4, 0);
    let mut start = |size: f64, lit: bool| loop {
        let mut levels = 0..;
        let starts = [(); 2].map(|()| {
            let level = levels.next().unwrap();
            let sized = Power::new(size);
            let chain = Metropolis::start(&target, &family, level, sized, &mut draws);
            (chain.state().clone(), *chain.value())
        });
        if (starts[1].1 > 0.5) == lit {
            break Ladder::<Point<Power>, f64, 2>::new(starts, &family);
        }
    };
    let (mut dark, source) = (start(0.1, false), start(0.7, true));
    assert!(dark.replicas()[1].density() <= 0.0);
    dark.restart_from(1, &source.replicas()[1], &mut generator(5, 0));
    let chain = &dark.replicas()[1];
    let value = source.replicas()[1].value().to_bits();
    assert_eq!(chain.value().to_bits(), value);
    assert_eq!(
        chain.densities().map(f64::to_bits),
        source.replicas()[1].densities().map(f64::to_bits)
    );
    assert!((chain.state().mutation().size() - 0.1).abs() < 1e-12);
    let again = |chain: &Metropolis<Point<Power>, f64, 2>| {
        let mut chain = chain.clone();
        chain.evaluate_anew(&target, &family, &mut generator(6, 0));
        chain.value().to_bits()
    };
    assert_eq!(again(chain), value);
}
