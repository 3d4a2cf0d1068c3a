//! How far a run can be trusted: four chains, what they say of each other, step sizes that learn and then stay.
//!
//! Two humps far apart, one three times as heavy as the other: how much of the whole is the heavy one? Chains of small
//! steps look healthy, each by itself: as many steps are accepted as should be, hump after hump of nothing unusual. Only
//! that chains which began elsewhere say something else gives them away (R-hat far from 1). With large steps in between all
//! agree, and the effective number of samples tells how many digits of the answer are known.
//!
//! `cargo run --release -p kaustik-mcmc --example trust`

#![expect(clippy::print_stdout, reason = "an example shows what it found")]

use kaustik_mcmc::{
    AcceptanceAdaptation, Autocorrelation, Coordinates, Halves, Ignore, Metropolis, Pcg64Dxsm,
    Point, PointKernel, Stream, WrappedNormal, generator, split_r_hat, target,
};

const CHAINS: u64 = 4;
/// In which step sizes learn, from so many steps each.
const ROUNDS: u32 = 40;
const STEPS_OF_A_ROUND: u32 = 500;
/// Taken afterwards, by each chain.
const STEPS: u32 = 200_000;

type Place = [f64; 2];
type Chain = Metropolis<Point<WrappedNormal>, Place, 1>;

/// Two humps, the second three times as heavy: 0.75 of the whole.
fn density(&[x, y]: &Place) -> [f64; 1] {
    const WIDTH: f64 = 0.02;
    let hump = |at: f64| {
        let squared = (x - at).powi(2) + (y - at).powi(2);
        (-0.5 * squared / (WIDTH * WIDTH)).exp()
    };
    [hump(0.2) + 3.0 * hump(0.8)]
}

/// What four chains have found.
struct Found {
    halves: Vec<Halves>,
    /// Of all: is the chain on the heavy hump?
    on_heavy: Autocorrelation,
    /// Share of small steps that were accepted.
    accepted: f64,
}

fn run(p_large: f64) -> serde_json::Result<Found> {
    let place = target(|u: &mut dyn Coordinates| -> Place {
        [u.get(Stream::Camera, 0), u.get(Stream::Camera, 1)]
    });
    let kernel = PointKernel::new(&place, p_large);
    let mut found = Found {
        halves: Vec::new(),
        on_heavy: Autocorrelation::new(),
        accepted: 0.0,
    };
    for number in 0..CHAINS {
        let mut rng = generator(1, number);
        let mut sizes = AcceptanceAdaptation::new(WrappedNormal::new(0.1));
        let mut chain = Metropolis::start(&&place, &density, 0, sizes.mutation(), &mut rng);
        for _ in 0..ROUNDS {
            for _ in 0..STEPS_OF_A_ROUND {
                chain.step(&kernel, &density, &mut rng, &mut Ignore);
            }
            // Between steps, and never again once numbers count: a chain that learns for ever keeps no law.
            let mutation = sizes.end_round(chain.statistics().small());
            chain.set_mutation(mutation, &mut rng);
        }
        chain.flush(&mut Ignore);
        let _burnt_in = chain.take_statistics();
        (chain, rng) = written_and_read_again(&chain, &rng)?;
        let (mut halves, mut on_heavy) = (Halves::new(), Autocorrelation::new());
        for _ in 0..STEPS {
            chain.step(&kernel, &density, &mut rng, &mut Ignore);
            let is_heavy = f64::from(u8::from(chain.value()[0] > 0.5));
            halves.push(is_heavy);
            on_heavy.push(is_heavy);
        }
        found.halves.push(halves);
        found.on_heavy.merge(&on_heavy);
        found.accepted += chain.statistics().small().rate() / CHAINS as f64;
    }
    Ok(found)
}

/// As of a run that is stopped here and goes on tomorrow, with the same bits.
fn written_and_read_again(
    chain: &Chain,
    rng: &Pcg64Dxsm,
) -> serde_json::Result<(Chain, Pcg64Dxsm)> {
    let file = serde_json::to_string(&(chain, rng))?;
    serde_json::from_str(&file)
}

fn main() -> serde_json::Result<()> {
    println!("the heavy hump is 0.75 of the whole");
    println!("large steps   accepted   R-hat    effective samples   found");
    for p_large in [0.0, 0.2] {
        let found = run(p_large)?;
        let number = |of: Option<f64>| of.unwrap_or(f64::NAN);
        println!(
            "{p_large:11}   {:6.1} %   {:6.3}   {:17.0}   {:.4} ± {:.4}",
            100.0 * found.accepted,
            number(split_r_hat(&found.halves)),
            number(found.on_heavy.effective_samples()),
            found.on_heavy.numbers().mean(),
            number(found.on_heavy.standard_error()),
        );
    }
    println!(
        "Above about 1.01 the chains do not tell of the same law, and no error is to be believed."
    );
    Ok(())
}
