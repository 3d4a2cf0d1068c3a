//! A small path tracer that knows nothing of this workspace, run once as it is and once with our
//! chains. It implements no trait of ours: it uses the proposal guard (`Proposal`) alone.
//!
//! The scene is a room with a glass ball and a small lamp. Paths hit the lamp only by chance,
//! and no next-event estimation is possible for the light that reaches the floor through the ball.
//!
//! `cargo run --release -p kaustik-mcmc --example foreign_renderer [picture.png]`
//!
//! The picture shows plain path tracing, chains with as many paths, and the reference.

#![expect(clippy::print_stdout, reason = "an example shows what it found")]

mod picture;
mod renderer;

use kaustik_mcmc::{
    Coordinates, Cursor, Draws, Exponential, Point, Pool, Step, Stream, acceptance, generator,
    sample_generator,
};
use picture::{Image, SIDE, mean, rmse, write_png};
use renderer::{V, trace};

/// A path: where it shows, and what it brings.
fn path(next: &mut dyn FnMut() -> f64) -> (usize, V) {
    let (x, y) = (next(), next());
    let pixel = |u: f64| (u * SIDE as f64) as usize;
    (pixel(x) + SIDE * pixel(y), trace(x, y, next))
}

/// Independent paths.
fn plain(samples: usize, seed: u64) -> Image {
    let mut rng = generator(seed, 0);
    let mut image = vec![V::default(); SIDE * SIDE];
    for _ in 0..samples {
        let (pixel, light) = path(&mut || rng.uniform());
        image[pixel] = image[pixel] + light * ((SIDE * SIDE) as f64 / samples as f64);
    }
    image
}

/// The same paths from the coordinates of a proposal.
fn read(u: &mut dyn Coordinates) -> (usize, V) {
    let mut cursor = Cursor::new(u, Stream::Camera);
    path(&mut || cursor.next())
}

/// A chain. A tenth of the paths go into the pool of its starts; visits have the weights of
/// the crate page's split form, which is unbiased for every constant `B0`.
fn chain(samples: usize, seed: u64) -> Image {
    const LARGE: f64 = 0.3;
    const B0: f64 = 1.0;
    let pool = Pool::new((0..samples as u64 / 10).map(|i| {
        let mut rng = sample_generator(seed, 0, i);
        path(&mut || rng.uniform()).1.sum()
    }));
    let b = pool.normaliser().mean(); // belongs to the start that is chosen
    let mut rng = generator(seed, 1);
    let start = pool.choose(&mut rng).expect("some path meets the lamp");
    let mut point = Point::new(Exponential::default());
    let mut again = sample_generator(seed, 0, start.index);
    let mut first = point.propose(Step::Large, &mut again);
    let mut current = read(&mut first);
    first.accept();

    let mut image = vec![V::default(); SIDE * SIDE];
    let steps = samples - samples / 10;
    let scale = (SIDE * SIDE) as f64 / steps as f64;
    for _ in 0..steps {
        let large = rng.bernoulli(LARGE);
        let mut proposal = point.propose(if large { Step::Large } else { Step::Small }, &mut rng);
        let proposed = read(&mut proposal);
        let a = acceptance(current.1.sum(), proposed.1.sum(), 1.0);
        let bonus = f64::from(u8::from(large));
        for ((pixel, light), weight) in [
            (current, (1.0 - a) * b / B0),
            (proposed, a * b / B0 + bonus),
        ] {
            // 0 times what is no number is none either: one such path would blacken its pixel for ever
            if weight > 0.0 && light.sum().is_finite() {
                image[pixel] = image[pixel] + light * (scale * weight / (light.sum() / B0 + LARGE));
            }
        }
        if proposal.decide(a) {
            current = proposed;
        }
    }
    image
}

fn main() -> std::io::Result<()> {
    let file = std::env::args_os().nth(1).map_or_else(
        || std::env::temp_dir().join("kaustik-foreign-renderer.png"),
        Into::into,
    );
    let samples = 128 * SIDE * SIDE;
    let reference = plain(16 * samples, 9);
    let plain = plain(samples, 1);
    let chain = chain(samples, 1);
    let error = rmse(&plain, &reference);
    println!("{SIDE} x {SIDE} pixels, 128 paths a pixel");
    println!("plain: RMSE {error:.4}, mean {:.4}", mean(&plain));
    let chained = rmse(&chain, &reference);
    println!("chain: RMSE {chained:.4}, mean {:.4}", mean(&chain));
    let noise = error / 16f64.sqrt();
    println!(
        "reference, 2048 paths a pixel: own error about {noise:.4}, mean {:.4}",
        mean(&reference)
    );
    write_png(&file, &[&plain, &chain, &reference])?;
    println!("{}", file.display());
    Ok(())
}
