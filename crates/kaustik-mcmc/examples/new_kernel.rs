//! Writing a kernel of one's own, and proving it right.
//!
//! `cargo run --release -p kaustik-mcmc --features testing --example new_kernel`
//!
//! The kernel walks on a ring of places and knows roughly where the modes are: from time to
//! time it jumps to a place drawn from its guess. How often depends on where it is, and that
//! is the trap: the chance to *choose* the jump there and back is part of the ratio.

#![expect(clippy::print_stdout, reason = "an example shows what it found")]

use kaustik_mcmc::testing::{
    TransitionMatrix, assert_detailed_balance, assert_stationary, strategies,
};
use kaustik_mcmc::{Draws, Ignore, Kernel, Metropolis, Move, generator};
use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};

/// Jumps to a place of a guess, or steps to a neighbour.
#[derive(Clone, Debug)]
struct Jumps {
    /// Relative chance of each place to be jumped to.
    guess: Vec<f64>,
    /// Chance to jump rather than step, by place.
    leave: Vec<f64>,
    /// Whether the ratio knows of `leave`. The fault that we plant is to forget it.
    knows: bool,
}

// 1. The kernel. It proposes and says with which ratio; it never decides. The state is the
// value itself, so there is nothing else to remember, `()`, and nothing to take back.
impl Kernel<()> for Jumps {
    type Value = usize;

    fn propose<D: Draws + ?Sized>(
        &self,
        (): &mut (),
        &x: &usize,
        proposed: &mut usize,
        draws: &mut D,
    ) -> Move {
        let places = self.guess.len();
        // Every decision is a call of `draws`: that is what makes it enumerable.
        let jump = draws.bernoulli(self.leave[x]);
        let y = if jump {
            draws.index(&self.guess)
        } else {
            (x + [1, places - 1][draws.index(&[1.0, 1.0])]) % places
        };
        *proposed = y;
        // T(y -> x) / T(x -> y), for the route that was taken
        let routes = if !self.knows {
            1.0
        } else if jump {
            self.leave[y] / self.leave[x]
        } else {
            (1.0 - self.leave[y]) / (1.0 - self.leave[x])
        };
        if jump {
            // counted as a kind of its own in the statistics
            Move::new(Move::OWN, routes * self.guess[x] / self.guess[y])
        } else {
            Move::new(Move::SMALL, routes)
        }
    }
}

// 2. One step of the library's own chain with it, from everywhere, along all branches: the
// exact transition matrix.
fn matrix(kernel: &Jumps, pi: &[f64]) -> TransitionMatrix {
    let family = |place: &usize| [pi[*place]];
    TransitionMatrix::of(pi.len(), 1, |from, draws| {
        let mut chain = Metropolis::at((), from, &family, 0);
        chain.step(kernel, &family, draws, &mut Ignore);
        *chain.value()
    })
}

// 3. What it is tried on: targets of all shapes, and kernels of all shapes with them.
fn cases(knows: bool) -> impl Strategy<Value = (Vec<f64>, Jumps)> {
    strategies::targets(2..8).prop_flat_map(move |pi| {
        let chance = prop_oneof![1 => Just(0.0), 4 => 0.05..0.95f64];
        let jumps = (
            strategies::targets(pi.len()),
            prop::collection::vec(chance, pi.len()),
        );
        let kernel = jumps.prop_map(move |(guess, leave)| Jumps {
            guess,
            leave,
            knows,
        });
        (Just(pi), kernel)
    })
}

// 4. The proof: balance of each pair of states, to rounding error, on a thousand cases.
fn prove() {
    let mut runner = TestRunner::new(Config::with_cases(1000));
    let proof = runner.run(&cases(true), |(pi, kernel)| {
        let p = matrix(&kernel, &pi);
        assert_detailed_balance(&p, &pi);
        // several kernels one after the other keep the law, but are not reversible
        let steps = Jumps {
            leave: vec![0.0; pi.len()],
            ..kernel
        };
        assert_stationary(&p.then(&matrix(&steps, &pi)), &pi);
        Ok(())
    });
    proof.expect("the kernel is reversible");
}

// 5. The proof of the proof: with the fault, it must fail. The strategy finds a case and
// shrinks it to the smallest.
fn refute() -> (Vec<f64>, Jumps) {
    let mut runner = TestRunner::new(Config {
        failure_persistence: None,
        ..Config::default()
    });
    let refutation = runner.run(&cases(false), |(pi, kernel)| {
        prop_assert!(matrix(&kernel, &pi).balance_defect(&pi) <= 1e-14);
        Ok(())
    });
    match refutation {
        Err(proptest::test_runner::TestError::Fail(_, case)) => case,
        other => panic!("the planted fault was not found: {other:?}"),
    }
}

/// The share of steps right of the middle, where 3/4 of the mass is.
fn right_of_the_middle(jump: f64) -> f64 {
    let places = 400;
    let peak = |x: f64, at: f64| (-(x - at) * (x - at) / 50.0).exp();
    let family = |place: &usize| {
        let x = *place as f64;
        [peak(x, 100.0) + 3.0 * peak(x, 300.0)]
    };
    let kernel = Jumps {
        guess: (0..places)
            .map(|i| if i % 200 / 20 == 5 { 1.0 } else { 0.01 })
            .collect(),
        leave: vec![jump; places],
        knows: true,
    };
    let mut chain = Metropolis::at((), 100, &family, 0);
    let mut rng = generator(1, 0);
    let steps = 200_000;
    let right = (0..steps).filter(|_| {
        chain.step(&kernel, &family, &mut rng, &mut Ignore);
        *chain.value() > 200
    });
    right.count() as f64 / f64::from(steps)
}

fn main() {
    prove();
    println!("detailed balance holds on 1000 targets");

    let (pi, kernel) = refute();
    println!("\nwithout the chance to jump in its ratio it does not; the smallest case found:");
    println!(
        "  pi {pi:?}\n  guess {:?}, leave {:?}",
        kernel.guess, kernel.leave
    );
    println!("  {}", matrix(&kernel, &pi).worst_pair(&pi));

    println!("\ntwo modes, 3/4 of the mass in the right one; share of time spent there:");
    for jump in [0.0, 0.1] {
        let share = right_of_the_middle(jump);
        println!("  jumps with probability {jump}: {share:.3}");
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_kernel_is_reversible() {
        super::prove();
    }

    #[test]
    fn the_planted_fault_is_found() {
        let (pi, kernel) = super::refute();
        assert!(super::matrix(&kernel, &pi).worst_pair(&pi).defect() > 1e-14);
    }
}
