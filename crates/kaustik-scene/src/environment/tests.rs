use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use kaustik_spectrum::{Rgb, WavelengthSampling, Xyz};

use super::*;
use crate::description::{ImageData, Pixels};
use crate::testing::{Rng, chi_square};

fn environment(
    width: u32,
    height: u32,
    rotation: Quat,
    mut value: impl FnMut(u32, u32) -> [f32; 3],
) -> Environment {
    let values = (0..height)
        .flat_map(|y| (0..width).map(move |x| (x, y)))
        .flat_map(|(x, y)| value(x, y))
        .collect();
    let image = ImageData {
        name: "test".to_owned(),
        width,
        height,
        pixels: Pixels::RgbF32(values),
        encoded: Vec::new(),
    };
    let description = EnvironmentDescription::Image {
        image: Arc::new(image),
        strength: 2.0,
        rotation,
    };
    Environment::new(&description).unwrap()
}

fn turned() -> Quat {
    Quat::from_xyzw(0.3, -0.5, 0.7, 0.4).normalize()
}

/// One bright texel over a dim ground.
fn lamp(rotation: Quat) -> Environment {
    environment(16, 8, rotation, |x, y| match (x, y) {
        (11, 2) => [1000.0, 800.0, 500.0],
        _ => [0.1; 3],
    })
}

/// Random texels, a third of them black.
fn noise(rotation: Quat) -> Environment {
    let mut rng = Rng::new(5);
    environment(16, 8, rotation, |_, _| {
        let black = rng.uniform() < 0.33;
        [0; 3].map(|_| if black { 0.0 } else { rng.uniform() as f32 })
    })
}

/// One lit texel in the dark, one column, the poles.
fn odd() -> [Environment; 4] {
    [
        environment(9, 5, turned(), |x, y| {
            [f32::from(x == 0 && y == 3), 0.0, 0.0]
        }),
        environment(1, 6, turned(), |_, y| [y as f32; 3]),
        environment(7, 1, turned(), |x, _| [x as f32, 0.0, 0.0]),
        environment(8, 4, turned(), |x, y| {
            [f32::from(y == 0 && x == 7) + 1e-4; 3]
        }),
    ]
}

fn all() -> Vec<Environment> {
    let mut all = vec![
        lamp(Quat::IDENTITY),
        lamp(turned()),
        noise(Quat::IDENTITY),
        noise(turned()),
        Environment::new(&EnvironmentDescription::Constant([1.0, 0.5, 0.2])).unwrap(),
    ];
    all.extend(odd());
    all
}

const BINS: [usize; 2] = [48, 24];

/// The direction at a share of the turn and of the height.
fn direction([x, y]: [f64; 2]) -> DVec3 {
    let z = 1.0 - 2.0 * y;
    let sin = (1.0 - z * z).max(0.0).sqrt();
    DVec3::new(sin * (TAU * x).cos(), sin * (TAU * x).sin(), z)
}

fn bin(d: DVec3) -> usize {
    let x = (d.y.atan2(d.x) / TAU).rem_euclid(1.0) * BINS[0] as f64;
    let y = 0.5 * (1.0 - d.z) * BINS[1] as f64;
    (y as usize).min(BINS[1] - 1) * BINS[0] + (x as usize).min(BINS[0] - 1)
}

/// Integral of `pdf` over each bin of equal solid angle, by midpoints.
fn integrals(sub: usize, pdf: impl Fn(DVec3) -> f64) -> Vec<f64> {
    let [nx, ny] = BINS.map(|n| n * sub);
    let mut sums = vec![0.0; BINS[0] * BINS[1]];
    for y in 0..ny {
        for x in 0..nx {
            let at = [(x as f64 + 0.5) / nx as f64, (y as f64 + 0.5) / ny as f64];
            let value = pdf(direction(at)) * 4.0 * PI / (nx * ny) as f64;
            sums[y / sub * BINS[0] + x / sub] += value;
        }
    }
    sums
}

fn p_value(
    samples: u32,
    sub: usize,
    sample: impl Fn([f64; 2]) -> DVec3,
    pdf: impl Fn(DVec3) -> f64,
) -> f64 {
    let mut rng = Rng::new(11);
    let mut observed = vec![0.0; BINS[0] * BINS[1]];
    for _ in 0..samples {
        observed[bin(sample(rng.pair()))] += 1.0;
    }
    let mut expected = integrals(sub, pdf);
    let total: f64 = expected.iter().sum();
    assert!(
        (total - 1.0).abs() < 0.005,
        "the density integrates to {total}"
    );
    for e in &mut expected {
        *e *= f64::from(samples) / total;
    }
    chi_square(&observed, &expected)
}

#[test]
fn samples_follow_their_density() {
    for (i, environment) in all().iter().enumerate() {
        let p = p_value(
            100_000,
            8,
            |u| environment.sample(u).0,
            |d| environment.pdf(d),
        );
        assert!(p > 1e-4, "environment {i}: p = {p}");
    }
}

#[test]
#[ignore = "long"]
fn samples_follow_their_density_long() {
    for (i, environment) in all().iter().enumerate() {
        let p = p_value(
            1_000_000,
            40,
            |u| environment.sample(u).0,
            |d| environment.pdf(d),
        );
        assert!(p > 1e-4, "environment {i}: p = {p}");
    }
}

#[test]
fn a_wrong_density_is_caught() {
    let environment = noise(turned());
    let sample = |u| environment.sample(u).0;
    let tilted = |d: DVec3| environment.pdf(d) * (1.0 + 0.2 * d.z);
    let skewed = |d: DVec3| environment.pdf(d) * if d.x > 0.0 { 1.08 } else { 0.92 };
    for wrong in [&tilted as &dyn Fn(DVec3) -> f64, &skewed] {
        // a factor that keeps the integral at one, which is checked by itself
        let total: f64 = integrals(8, wrong).iter().sum();
        assert!(p_value(100_000, 8, sample, |d| wrong(d) / total) < 1e-6);
    }
    // a sampler that forgets the rotation
    let unturned = noise(Quat::IDENTITY);
    let forgot = |u| unturned.sample(u).0;
    assert!(p_value(100_000, 8, forgot, |d| environment.pdf(d)) < 1e-6);
}

#[test]
fn sample_reports_the_density_of_its_direction() {
    let mut rng = Rng::new(3);
    for (i, environment) in all().iter().enumerate() {
        for _ in 0..2000 {
            let (d, pdf) = environment.sample(rng.pair());
            assert!((d.length() - 1.0).abs() < 1e-12);
            assert!(pdf > 0.0 && pdf.is_finite());
            let again = environment.pdf(d);
            assert!(
                (again / pdf - 1.0).abs() < 1e-5,
                "{i}: {again} for {pdf} at {d}"
            );
        }
        for u in [[0.0; 2], [1.0 - 1e-16; 2], [0.0, 1.0 - 1e-16], [0.5, 0.0]] {
            let (d, pdf) = environment.sample(u);
            assert!(d.is_finite() && pdf.is_finite() && pdf >= 0.0, "{i}");
        }
    }
}

#[test]
fn density_is_positive_wherever_there_is_light() {
    let mut rng = Rng::new(4);
    // eighteen orders of magnitude between texels
    let steep = environment(13, 7, turned(), |x, y| match (x, y) {
        (4, 4) => [1e9; 3],
        (1, _) => [0.0; 3],
        _ => [0.0, 0.0, 1e-9],
    });
    for environment in all().iter().chain([&steep]) {
        for _ in 0..20_000 {
            let d = warp::uniform_sphere(rng.pair());
            let light = environment.rgb(d).iter().any(|&c| c > 0.0);
            assert!(!light || environment.pdf(d) > 0.0);
        }
        for d in [DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z, DVec3::X] {
            assert!(environment.pdf(d).is_finite());
        }
    }
}

#[test]
fn weights_hardly_vary() {
    // radiance over density: constant but for the sine across a strip (and the colour)
    let mut rng = Rng::new(6);
    for environment in [lamp(turned()), noise(turned())] {
        let mean = 3.0 * environment.mean_radiance() * 4.0 * PI;
        for _ in 0..10_000 {
            let (d, pdf) = environment.sample(rng.pair());
            let value: f32 = environment.rgb(d).iter().sum();
            let weight = f64::from(value) / pdf / mean;
            assert!((0.4..2.0).contains(&weight), "{weight}");
        }
    }
}

#[test]
fn small_steps_of_the_square_are_small_steps_of_the_sphere() {
    let environment = environment(64, 32, turned(), |x, y| {
        [1.0 + 0.5 * ((x * y) % 3) as f32; 3]
    });
    let mut rng = Rng::new(8);
    for _ in 0..10_000 {
        let [x, y] = rng.pair().map(|u| 0.001 + 0.998 * u);
        let (a, pdf) = environment.sample([x, y]);
        let (b, _) = environment.sample([x + 1e-6, y + 1e-6]);
        assert!(
            a.distance(b) < 1e-4 + 1e-5 / pdf,
            "a jump of {}",
            a.distance(b)
        );
    }
}

#[test]
fn the_picture_stands_as_described() {
    // 4 columns: centres at +-45 and +-135 degrees from -z; the middle lies between 1 and 2
    let at = |rotation: Quat, d: DVec3| {
        environment(4, 2, rotation, |x, y| [x as f32, y as f32, 1.0]).rgb(d)
    };
    let eighth = 0.5_f64.sqrt();
    // 45 degrees to the right of -z, 45 degrees up: the upper right of the middle
    let d = DVec3::new(0.5, eighth, -0.5);
    let [column, row, _] = at(Quat::IDENTITY, d);
    assert!(
        (column - 4.0).abs() < 1e-5 && row.abs() < 1e-5,
        "{column} {row}"
    );
    let d = DVec3::new(-0.5, -eighth, -0.5);
    let [column, row, _] = at(Quat::IDENTITY, d);
    assert!((column - 2.0).abs() < 1e-5 && (row - 2.0).abs() < 1e-5);
    assert!(at(Quat::IDENTITY, DVec3::Y)[1].abs() < 1e-5);
    // turned by 90 degrees about +y, -z goes to -x
    let turn = Quat::from_rotation_y(std::f32::consts::FRAC_PI_2);
    let [column, _, _] = at(turn, DVec3::new(-eighth, 0.0, -eighth));
    assert!((column - 4.0).abs() < 1e-5, "{column}");
}

#[test]
fn colours_are_uplifted_against_d65() {
    let rgb = [0.8_f32, 0.4, 0.1];
    let constant = Environment::new(&EnvironmentDescription::Constant(rgb)).unwrap();
    let picture = environment(4, 2, turned(), |_, _| rgb.map(|c| 0.5 * c)); // strength 2
    for environment in [constant, picture] {
        let mut sum = Xyz::default();
        for i in 0..512 {
            let u = (f64::from(i) + 0.5) / 512.0;
            let wavelengths = Wavelengths::sample(u, WavelengthSampling::Hero);
            sum += wavelengths.to_xyz(environment.radiance(DVec3::Z, &wavelengths)) * (1.0 / 512.0);
        }
        let Rgb(found) = sum.into();
        for (found, wanted) in found.iter().zip(rgb) {
            assert!((found - wanted).abs() < 0.005, "{found} for {wanted}");
        }
        assert!((environment.mean_radiance() - 1.3 / 3.0).abs() < 1e-6);
    }
}

#[test]
fn a_black_environment_is_sampled_uniformly() {
    let black = environment(4, 4, turned(), |_, _| [0.0; 3]);
    let (d, pdf) = black.sample([0.3, 0.6]);
    assert!((pdf * 4.0 * PI - 1.0).abs() < 1e-12 && d.is_finite());
    assert!((black.pdf(d) * 4.0 * PI - 1.0).abs() < 1e-12);
    assert!(black.mean_radiance().abs() < 1e-12);
}

#[test]
fn bad_values_are_refused() {
    let constant = |rgb| Environment::new(&EnvironmentDescription::Constant(rgb));
    assert!(constant([1.0, f32::NAN, 0.0]).is_err());
    assert!(constant([-1.0, 0.0, 0.0]).is_err());
    assert!(constant([f32::INFINITY; 3]).is_err());
    let image = |pixels, strength, rotation| {
        let image = ImageData {
            name: "bad".to_owned(),
            width: 1,
            height: 1,
            pixels,
            encoded: Vec::new(),
        };
        Environment::new(&EnvironmentDescription::Image {
            image: Arc::new(image),
            strength,
            rotation,
        })
        .map(|_| ())
        .unwrap_err()
        .to_string()
    };
    let white = || Pixels::RgbF32(vec![1.0; 3]);
    assert!(image(Pixels::Rgba8(vec![0; 4]), 1.0, Quat::IDENTITY).contains("8-bit"));
    assert!(image(Pixels::RgbF32(vec![1.0]), 1.0, Quat::IDENTITY).contains("holds 1"));
    assert!(image(white(), f32::NAN, Quat::IDENTITY).contains("NaN"));
    assert!(image(white(), 1.0, Quat::from_xyzw(0.0, 0.0, 0.0, 0.0)).contains("unit"));
    assert!(image(Pixels::RgbF32(vec![1e30; 3]), 10.0, Quat::IDENTITY).contains("range"));
}
