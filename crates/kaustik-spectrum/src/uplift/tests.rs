//! Every cell of the table, its likeness to a fresh solution, and random colours.

use super::build::{build, colour, pack};
use super::solver::lab_error;
use super::table::{NX, NZ, Table};
use super::*;

fn error(sigmoid: Sigmoid, rgb: [f64; 3]) -> f64 {
    lab_error(sigmoid.coefficients().map(f64::from), rgb)
}

/// A small generator, so that colours are the same everywhere.
struct Colours(u64);

impl Colours {
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    fn take(&mut self, n: usize, f: impl Fn(f64) -> f64) -> Vec<[f64; 3]> {
        (0..n)
            .map(|_| [f(self.next()), f(self.next()), f(self.next())])
            .collect()
    }
}

/// Mean, 95th percentile and maximum of the error of the look-up.
fn statistics(colours: &[[f64; 3]]) -> [f64; 3] {
    let rounded = |rgb: &[f64; 3]| rgb.map(|c| c as f32);
    let mut errors: Vec<f64> = colours
        .iter()
        .map(|rgb| {
            error(
                uplift_reflectance(rounded(rgb)),
                rounded(rgb).map(f64::from),
            )
        })
        .collect();
    errors.sort_by(f64::total_cmp);
    let n = errors.len();
    [
        errors.iter().sum::<f64>() / n as f64,
        errors[n * 95 / 100],
        errors[n - 1],
    ]
}

fn encoded(v: f64) -> f64 {
    f64::from(crate::srgb_to_linear(v as f32))
}

#[test]
fn every_cell_has_its_colour() {
    let mut worst: (f64, [f64; 3]) = (0.0, [0.0; 3]);
    let mut sum = 0.0;
    for m in 0..3 {
        for j in 0..NX {
            for i in 0..NX {
                for k in 0..NZ {
                    let rgb = colour(m, i, j, k);
                    let e = error(uplift_reflectance(rgb.map(|c| c as f32)), rgb);
                    sum += e;
                    if e > worst.0 {
                        worst = (e, rgb);
                    }
                }
            }
        }
    }
    println!(
        "cells: mean {:.5}, worst {worst:?}",
        sum / (3 * NX * NX * NZ) as f64
    );
    assert!(worst.0 < 0.1, "{worst:?}");
}

#[test]
fn random_colours_come_back() {
    let mut colours = Colours(12345);
    let linear = statistics(&colours.take(4000, |v| v));
    let display = statistics(&colours.take(4000, encoded));
    let pale = statistics(&colours.take(2000, |v| 1.0 - 0.1 * v * v));
    let dark = statistics(&colours.take(2000, |v| 0.03 * v * v));
    println!(
        "mean, p95, max: linear {linear:.4?} sRGB {display:.4?} pale {pale:.4?} dark {dark:.4?}"
    );
    for [mean, p95, most] in [linear, display, pale, dark] {
        assert!(
            mean < 0.04 && p95 < 0.15 && most < 2.5,
            "{mean} {p95} {most}"
        );
    }
}

/// The corner at white, where the surfaces of a scene gather and smooth reflectances bend most: all
/// 8-bit sRGB colours with components of 240 and more.
#[test]
fn near_white_8_bit_colours_come_back() {
    let level = |code: u32| encoded(f64::from(code) / 255.0);
    let colours: Vec<_> = (0..4096_u32)
        .map(|i| [i % 16, i / 16 % 16, i / 256].map(|code| level(240 + code)))
        .collect();
    let [mean, p95, most] = statistics(&colours);
    println!("near white, 8 bits: mean {mean:.4}, p95 {p95:.4}, max {most:.4}");
    assert!(
        mean < 0.04 && p95 < 0.15 && most < 1.0,
        "{mean} {p95} {most}"
    );
}

#[test]
fn solving_is_better_than_looking_up() {
    for rgb in Colours(777).take(200, encoded) {
        let rgb = rgb.map(|c| c as f32);
        let e = error(solve_reflectance(rgb), rgb.map(f64::from));
        assert!(e < 0.01, "{rgb:?}: {e}");
    }
}

#[test]
fn limits_are_exact() {
    assert_eq!(uplift_reflectance([0.0; 3]), Sigmoid::BLACK);
    assert_eq!(uplift_reflectance([1.0; 3]), Sigmoid::WHITE);
    assert_eq!(
        uplift_reflectance([2.0, f32::INFINITY, 1.0]),
        Sigmoid::WHITE
    );
    assert_eq!(
        uplift_reflectance([f32::NAN, -1.0, f32::NEG_INFINITY]),
        Sigmoid::BLACK
    );
    for nm in [360.0, 555.5, 830.0] {
        assert_eq!(Sigmoid::WHITE.at(nm), 1.0);
        assert_eq!(Sigmoid::BLACK.at(nm), 0.0);
    }
}

#[test]
fn next_to_grey_is_next_to_the_closed_form() {
    for g in [1e-6_f32, 0.003, 0.18, 0.5, 0.93, 0.999] {
        let near = uplift_reflectance([g, g, g * (1.0 - 1e-6)]);
        for nm in [420.0, 555.0, 700.0] {
            let s = near.at(nm);
            assert!((s - g).abs() < 2e-4 * g, "{g} {nm} {s}");
        }
    }
}

/// Solves the whole table (half a minute) and compares it with the committed one. With
/// `KAUSTIK_WRITE_UPLIFT` set to a file's name it writes the table there.
#[test]
#[ignore = "long"]
fn the_committed_table_is_what_the_solver_gives() {
    let (codes, worst) = build();
    println!("solver's worst error {worst:.6}");
    assert!(worst < 0.01, "{worst}");
    let packed = pack(&codes);
    if let Some(file) = std::env::var_os("KAUSTIK_WRITE_UPLIFT") {
        std::fs::write(file, &packed).expect("the file can be written");
    }
    let (fresh, committed) = (Table::decode(&packed), Table::get());
    let apart = fresh.largest_difference(committed);
    println!(
        "{} bytes; committed table differs by at most {apart:e}",
        packed.len()
    );
    assert!(apart < 1e-3);
}
