//! A rejected proposal never was.

use kaustik_mcmc::{
    Exponential, Ignore, Metropolis, Point, PointKernel, Step, Target, Uniform, generator, target,
};
use kaustik_pss::{Coordinates, Stream};
use proptest::prelude::*;

type Address = (Stream, u32);
type Reads = Vec<(Address, u64)>;

/// A path whose length and streams depend on what it reads; its value is all it has read.
struct Walk;

impl Target for Walk {
    type Value = Reads;

    fn evaluate(&self, u: &mut dyn Coordinates, value: &mut Self::Value) {
        value.clear();
        let mut read = |stream, index| {
            let x = u.get(stream, index);
            value.push(((stream, index), x.to_bits()));
            x
        };
        let mut i = 0;
        while read(Stream::Camera, 3 * i) < 0.75 && i < 20 {
            let side = Stream::ALL[(read(Stream::Camera, 3 * i + 1) * 7.0) as usize];
            read(side, 100 + i);
            i += 1;
        }
    }
}

/// Longer walks are denser, and some have density zero.
fn density(value: &Reads) -> [f64; 1] {
    [if value.len() % 5 == 4 {
        0.0
    } else {
        value.len() as f64
    }]
}

proptest! {
    #[test]
    fn a_rebuilt_state_has_its_old_value(seed in 0u64..1 << 40, large in 0.0..0.6f64, settle in any::<bool>()) {
        let mut rng = generator(seed, 0);
        let kernel = PointKernel::new(&Walk, large);
        let mut chain = Metropolis::start(&Walk, &density, 0, Exponential::new(0.01, 0.2), &mut rng);
        let mut again = Vec::new();
        for step in 0..200 {
            let before = chain.value().clone();
            let accepted = chain.step(&kernel, &density, &mut rng, &mut Ignore);
            if !accepted {
                prop_assert_eq!(chain.value(), &before);
            }
            if settle && step % 7 == 0 {
                chain.set_mutation(Exponential::new(0.01, 0.3), &mut rng);
            }
            chain.evaluate_again(&Walk, &mut again, &mut rng);
            prop_assert_eq!(&again, chain.value());
        }
    }

    /// Any reads, any decisions, dropped or decided or forgotten: what was seen is restored.
    #[test]
    fn every_way_to_reject_restores(
        steps in prop::collection::vec(
            (any::<bool>(), 0u8..4, prop::collection::vec((0usize..7, 0u32..6), 0..12)), 1..40),
        seed in any::<u64>(),
    ) {
        let mut rng = generator(seed, 1);
        let mut point = Point::new(Uniform::new(0.3));
        let mut state: Reads = Vec::new();
        for (large, outcome, reads) in steps {
            let step = if large { Step::Large } else { Step::Small };
            let mut proposal = point.propose(step, &mut rng);
            let mut seen = Vec::new();
            for (stream, index) in reads {
                let address = (Stream::ALL[stream], index);
                seen.push((address, proposal.get(address.0, address.1).to_bits()));
            }
            // asked twice, answered alike
            for ((stream, index), bits) in &seen {
                prop_assert_eq!(proposal.get(*stream, *index).to_bits(), *bits);
            }
            match outcome {
                0 => { if proposal.decide(1.0) { state = seen; } }
                1 => prop_assert!(!proposal.decide(f64::NAN)),
                2 => drop(proposal),
                _ => std::mem::forget(proposal),
            }
            let mut current = point.current(&mut rng);
            for ((stream, index), bits) in &state {
                prop_assert_eq!(current.get(*stream, *index).to_bits(), *bits);
            }
        }
    }
}

/// Refresh forgets exactly what the state does not use.
#[test]
fn refresh_keeps_what_was_seen() {
    let mut rng = generator(5, 0);
    let mut point = Point::new(Exponential::default());
    let mut first = point.propose(Step::Large, &mut rng);
    let (a, b) = (first.get(Stream::Camera, 0), first.get(Stream::Camera, 1));
    assert!(first.decide(1.0));
    // a rejected proposal looks at coordinate 2; an accepted one at 0 alone
    let mut rejected = point.propose(Step::Small, &mut rng);
    rejected.get(Stream::Camera, 2);
    rejected.reject();
    point.refresh();
    let mut current = point.current(&mut rng);
    assert_eq!(current.get(Stream::Camera, 0).to_bits(), a.to_bits());
    assert_eq!(current.get(Stream::Camera, 1).to_bits(), b.to_bits());
    let mut small = point.propose(Step::Small, &mut rng);
    let a = small.get(Stream::Camera, 0);
    assert!(small.decide(1.0));
    point.refresh();
    let mut current = point.current(&mut rng);
    assert_eq!(current.get(Stream::Camera, 0).to_bits(), a.to_bits());
    let far = (current.get(Stream::Camera, 1) - b).abs();
    assert!(far > 1.0 / 64.0, "drawn anew, not perturbed: {far}");
}

/// An evaluation that has no coordinates at all is a state as well.
#[test]
fn a_target_may_read_nothing() {
    let constant = target(|_: &mut dyn Coordinates| 1.0);
    let family = |v: &f64| [*v];
    let mut rng = generator(6, 0);
    let mut chain = Metropolis::start(&constant, &family, 0, Exponential::default(), &mut rng);
    let kernel = PointKernel::new(&constant, 0.5);
    assert!((0..10).all(|_| chain.step(&kernel, &family, &mut rng, &mut Ignore)));
}
