//! How far a run can be trusted: four chains, what they say of each other, step sizes that learn and then stay.
//!
//! Two humps far apart, one three times as heavy as the other: what is the mean? Chains of small steps look healthy,
//! each by itself: as many steps are accepted as should be, and the error is tiny. What gives them away is that chains
//! which began elsewhere say something else: R-hat is far from 1. With large steps in between all agree, and the effective
//! number of samples tells how many digits of the answer are known.
//!
//! `cargo run --release -p kaustik-mcmc --features serde --example trust`

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

/// Two humps, the second three times as heavy: their mean is 0.25 x 0.2 + 0.75 x 0.8 = 0.65.
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
    /// Where a chain is, along the first coordinate: of one chain, and of all.
    one: Autocorrelation,
    places: Autocorrelation,
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
        one: Autocorrelation::new(),
        places: Autocorrelation::new(),
        accepted: 0.0,
    };
    for number in 0..CHAINS {
        let mut rng = generator(3, number);
        let mut sizes = AcceptanceAdaptation::new(WrappedNormal::new(0.02));
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
        let (mut halves, mut places) = (Halves::new(), Autocorrelation::new());
        for _ in 0..STEPS {
            chain.step(&kernel, &density, &mut rng, &mut Ignore);
            halves.push(chain.value()[0]);
            places.push(chain.value()[0]);
        }
        found.halves.push(halves);
        found.places.merge(&places);
        found.one = places;
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
    println!("the mean is 0.65");
    println!("large steps   accepted   one chain says     R-hat    effective samples   all say");
    for p_large in [0.0, 0.2] {
        let found = run(p_large)?;
        println!(
            "{p_large:11}   {:6.1} %   {}   {:6.3}   {:17}   {}",
            100.0 * found.accepted,
            mean(&found.one),
            split_r_hat(&found.halves).unwrap_or(f64::NAN),
            (found.places.effective_samples()).map_or("unknown".to_owned(), |n| format!("{n:.0}")),
            mean(&found.places),
        );
    }
    println!(
        "Above about 1.01 the chains do not tell of the same law, and no error is to be believed."
    );
    Ok(())
}

fn mean(of: &Autocorrelation) -> String {
    let mean = of.numbers().mean();
    match of.standard_error() {
        Some(error) => format!("{mean:.4} ± {error:.4}"),
        None => format!("{mean:.4} ± unknown"),
    }
}
