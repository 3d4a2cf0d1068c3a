//! Next-event estimation: the density of the directions it draws, and its choice of emitters.

use std::f64::consts::PI;

use glam::{DVec3, Vec3};
use kaustik_geometry::Ray;

use super::super::alias::AliasTable;
use super::{FAST, LONG, Sphere, accepts, under_sky};
use crate::description::{LightKind, MaterialDescription};
use crate::testing::{Rng, Stage, double_sided, grey, lamp, punctual, rectangle, wavelengths};
use crate::{Interior, Reach, Scene, Vertex};

const FROM: DVec3 = DVec3::new(0.1, -0.2, 0.05);

/// Lamps around a point that hide nothing of each other: one above, one aside that shows its
/// back edgewise and its front, a brighter one that emits to both sides and shows its back.
fn lamps(bright: f32) -> Stage {
    let above = rectangle(Vec3::new(0.2, 1.5, 0.0), Vec3::X, Vec3::Z);
    let tilted = Vec3::new(0.9, 0.4, 0.0);
    let aside = rectangle(Vec3::new(-1.6, -0.3, 0.2), Vec3::Z, tilted);
    let behind = rectangle(Vec3::new(0.2, -0.4, -1.2), Vec3::X * 0.8, Vec3::Y * 0.6);
    // shows its dark side: what is drawn there is lost
    let dark = rectangle(Vec3::new(1.8, -0.4, 0.3), Vec3::Y, Vec3::Z);
    Stage::new()
        .add(lamp(1.0), above)
        .add(double_sided(lamp(2.0)), aside)
        .add(double_sided(lamp(bright)), behind)
        .add(lamp(1.5), dark)
}

/// The stated density of a direction: of the emitter that a ray meets, and of the sky.
fn density(scene: &Scene, direction: DVec3) -> f64 {
    let ray = Ray::new(FROM.as_vec3(), direction.as_vec3());
    let mut vertex = Vertex::default();
    let mut interior = Interior::VACUUM;
    let sky = scene.environment_pdf(direction);
    let met = scene.advance(&ray, &mut interior, &wavelengths(), || 0.0, &mut vertex);
    if met.escapes() || scene.emitted(&vertex, -direction, &wavelengths()).is_zero() {
        return sky;
    }
    sky + scene.direct_pdf(FROM, &vertex)
}

/// Draws from one scene, densities from another, the last cell for what is lost.
fn agrees(drawn: &Scene, stated: &Scene, samples: u32, fine: usize) -> bool {
    let sphere = Sphere::new(DVec3::new(0.3, 1.0, 0.2).normalize(), 16, 32);
    let mut expected = sphere.integrate(fine, |direction| density(stated, direction));
    expected.push((1.0 - expected.iter().sum::<f64>()).max(0.0));
    let mut expected: Vec<f64> = expected.iter().map(|p| p * f64::from(samples)).collect();
    let mut observed = vec![0.0; expected.len()];
    let mut rng = Rng::new(7);
    for _ in 0..samples {
        let sample = drawn.sample_direct(FROM, &wavelengths(), |_| rng.uniform());
        let cell = sample.map_or(sphere.len(), |sample| sphere.cell(sample.wi));
        observed[cell] += 1.0;
    }
    // Cells at the corner of a lamp, of which the integral may know nothing, count together.
    for cell in 0..sphere.len() {
        if expected[cell] >= 20.0 {
            continue;
        }
        observed[sphere.len()] += std::mem::take(&mut observed[cell]);
        expected[sphere.len()] += std::mem::take(&mut expected[cell]);
    }
    accepts(&observed, &expected)
}

fn lit_by_the_sky() -> Scene {
    let sky: Vec<f32> = (0..32).map(|i| (i % 7 + i / 8) as f32).collect();
    under_sky(lamps(3.0), 8, &sky).build()
}

#[test]
fn directions_have_the_stated_density() {
    let scene = lamps(3.0).build();
    assert!(agrees(&scene, &scene, FAST, 24));
    let scene = lit_by_the_sky();
    assert!(agrees(&scene, &scene, FAST, 24));
}

#[test]
#[ignore = "long"]
fn directions_have_the_stated_density_to_a_tenth_of_a_percent() {
    for scene in [lamps(3.0).build(), lit_by_the_sky()] {
        assert!(agrees(&scene, &scene, LONG, 96));
    }
}

/// The test of the test: with another choice probability, by a tenth, it fails.
#[test]
fn a_wrong_choice_probability_is_rejected() {
    let (drawn, stated) = (lamps(3.0).build(), lamps(3.3).build());
    assert!(!agrees(&drawn, &stated, FAST, 24));
}

/// A ray that finds an emitter by chance reports the density that next event states.
#[test]
fn samples_carry_the_density_of_what_they_reach() {
    let scene = lit_by_the_sky();
    let mut rng = Rng::new(3);
    for _ in 0..10_000 {
        let Some(sample) = scene.sample_direct(FROM, &wavelengths(), |_| rng.uniform()) else {
            continue;
        };
        let expected = match sample.reach {
            Reach::Infinity => scene.environment_pdf(sample.wi),
            _ => density(&scene, sample.wi) - scene.environment_pdf(sample.wi),
        };
        // the ray is rounded to single precision and may miss an edge
        let near = (sample.pdf / expected - 1.0).abs() < 1e-3;
        assert!(near || expected == 0.0, "{} {expected}", sample.pdf);
    }
}

/// How often each emitter is chosen, by what its samples look like: point, spot, directional, sky,
/// surface; and the probabilities that they state.
fn choices(scene: &Scene, samples: u32) -> ([f64; 5], [f64; 5]) {
    let (mut observed, mut stated) = ([0.0; 5], [0.0; 5]);
    let mut rng = Rng::new(11);
    for _ in 0..samples {
        let sample = scene
            .sample_direct(DVec3::ZERO, &wavelengths(), |_| rng.uniform())
            .expect("every emitter shines on the origin");
        let kind = match (sample.delta, &sample.reach) {
            (true, Reach::Point(at)) if at.x > 0.0 => 0,
            (true, Reach::Point(_)) => 1,
            (true, _) => 2,
            (false, Reach::Infinity) => 3,
            (false, _) => 4,
        };
        observed[kind] += 1.0;
        stated[kind] = match kind {
            0..=2 => sample.pdf,
            3 => sample.pdf * 4.0 * PI,
            _ => 0.0,
        };
    }
    stated[4] = 1.0 - stated.iter().sum::<f64>();
    (observed, stated)
}

fn all_kinds(intensity: f32) -> Stage {
    let spot = LightKind::Spot {
        inner: 0.3,
        outer: std::f32::consts::FRAC_PI_3,
    };
    let sun = punctual(LightKind::Directional, 0.7, Vec3::ZERO, Vec3::NEG_Y);
    Stage::new()
        .add(lamp(1.0), rectangle(Vec3::Y * 2.0, Vec3::X, Vec3::Z))
        .light(punctual(LightKind::Point, intensity, Vec3::X, Vec3::Z))
        .light(punctual(spot, 3.0, Vec3::NEG_X, Vec3::X))
        .light(sun)
        .sky(0.5)
}

#[test]
fn emitters_are_chosen_with_the_stated_probability() {
    let (observed, stated) = choices(&all_kinds(1.0).build(), FAST);
    let expected = stated.map(|p| p * f64::from(FAST));
    assert!(accepts(&observed, &expected), "{observed:?} {expected:?}");
    let (_, wrong) = choices(&all_kinds(1.2).build(), FAST);
    assert!(!accepts(&observed, &wrong.map(|p| p * f64::from(FAST))));
    assert!((stated[3] - 0.5).abs() < 1e-12, "the sky takes half");
}

/// The probability with which next event chooses a lamp that stands above the origin, beside others.
fn chance_of_the_point(stage: Stage) -> f64 {
    let point = punctual(LightKind::Point, 1.0, Vec3::Y, Vec3::Z);
    let scene = stage.light(point).build();
    let mut rng = Rng::new(3);
    (0..FAST)
        .filter_map(|_| scene.sample_direct(DVec3::ZERO, &wavelengths(), |_| rng.uniform()))
        .find(|sample| matches!(sample.reach, Reach::Point(_)))
        .map_or(0.0, |sample| sample.pdf)
}

/// The share of light walks that begin at such a lamp.
fn walks_from_the_point(stage: Stage) -> f64 {
    let point = punctual(LightKind::Point, 1.0, Vec3::Y, Vec3::Z);
    let scene = stage.light(point).build();
    let mut rng = Rng::new(3);
    let begins = (0..FAST)
        .filter_map(|_| scene.sample_emission(&wavelengths(), |_| rng.uniform()))
        .filter(|emission| !emission.pdf.hittable);
    begins.count() as f64 / f64::from(FAST)
}

/// A ground of a square kilometre under the sun, and a dome of a thousand times the lamp's power, say little about what is
/// seen by the lamp.
#[test]
fn small_lamps_are_chosen_beside_large_ones() {
    let sun = punctual(LightKind::Directional, 3.0, Vec3::ZERO, Vec3::NEG_Y);
    let ground = Stage::new().add(
        grey(0.5),
        rectangle(Vec3::NEG_Y, Vec3::X * 500.0, Vec3::Z * 500.0),
    );
    let beside_the_sun = chance_of_the_point(ground.light(sun));
    assert!((beside_the_sun - 0.5).abs() < 1e-12, "{beside_the_sun}");
    let dome = rectangle(Vec3::Y * 90.0, Vec3::X * 80.0, Vec3::Z * 80.0);
    let under_a_dome = Stage::new().add(lamp(1.0), dome);
    let near_the_lamp = chance_of_the_point(under_a_dome.clone());
    assert!(near_the_lamp > 0.5, "{near_the_lamp}");
    // Light walks: a tenth of half of both.
    let by_walks = walks_from_the_point(under_a_dome);
    assert!((0.046..0.052).contains(&by_walks), "{by_walks}");
    let far = punctual(LightKind::Directional, 1e-6, Vec3::ZERO, Vec3::NEG_Y);
    let starlight = chance_of_the_point(
        Stage::new()
            .add(grey(0.5), rectangle(Vec3::NEG_Y, Vec3::X, Vec3::Z))
            .light(far),
    );
    assert!((1.0 / starlight - 1.05).abs() < 1e-9, "{starlight}");
}

#[test]
fn one_number_chooses_by_weight() {
    let weights: Vec<f64> = (0..50)
        .map(|i| f64::from(i % 7) / f64::from(i + 1))
        .collect();
    let table = AliasTable::new(&weights);
    let mut rng = Rng::new(5);
    let mut observed = vec![0.0; weights.len()];
    for _ in 0..FAST {
        observed[table.choose(rng.uniform())] += 1.0;
    }
    let expect = |factor: f64| -> Vec<f64> {
        let probability = |i: usize| table.probability(i) * if i == 1 { factor } else { 1.0 };
        let sum: f64 = (0..weights.len()).map(probability).sum();
        let share = f64::from(FAST) / sum;
        (0..weights.len()).map(|i| probability(i) * share).collect()
    };
    assert!(accepts(&observed, &expect(1.0)));
    assert!(!accepts(&observed, &expect(1.2)));
}

/// An emission so dim that its power rounds to nothing leaves nothing to choose; a ray that
/// meets it all the same gets an answer.
#[test]
fn a_power_of_zero_is_no_choice() {
    let mesh = rectangle(Vec3::NEG_Z, Vec3::X, Vec3::Y);
    let dim = MaterialDescription {
        emissive: [1e-45, 0.0, 0.0],
        ..lamp(0.0)
    };
    let scene = Stage::new().add(dim, mesh).build();
    assert!(!scene.has_light());
    assert_eq!(
        scene.direct_pdf(FROM, &Vertex::default()).to_bits(),
        0.0_f64.to_bits()
    );
    let drawn = scene.sample_direct(FROM, &wavelengths(), |_| 0.5);
    assert!(drawn.is_none());
}
