//! Emission sampling: the law of positions and directions of the first ray of a light walk.

use std::f64::consts::{FRAC_PI_3, PI};

use glam::{DVec3, Vec3};
use kaustik_bsdf::Frame;

use super::super::Punctual;
use super::{FAST, LONG, Sphere, accepts, cell, turns, under_sky};
use crate::description::{LightKind, MaterialDescription};
use crate::testing::{Rng, Stage, grey, lamp, punctual, rectangle, wavelengths};
use crate::{EmissionSample, Scene};

/// Counts the cells of samples.
fn count(
    scene: &Scene,
    samples: u32,
    cells: usize,
    cell: impl Fn(&EmissionSample) -> usize,
) -> Vec<f64> {
    let mut observed = vec![0.0; cells];
    let mut rng = Rng::new(17);
    for _ in 0..samples {
        let sample = scene
            .sample_emission(&wavelengths(), |_| rng.uniform())
            .expect("an emission");
        observed[cell(&sample)] += 1.0;
    }
    observed
}

fn direction(sample: &EmissionSample) -> DVec3 {
    sample.ray.direction.as_dvec3()
}

const U: Vec3 = Vec3::new(0.8, 0.1, 0.3);
const V: Vec3 = Vec3::new(-0.2, 0.5, 0.4);
const CENTRE: Vec3 = Vec3::new(0.5, -1.0, 2.0);

/// Four by four places, four by four directions (cosine squared, angle) on each side.
fn area_cell(sample: &EmissionSample) -> usize {
    let (u, v) = (U.as_dvec3(), V.as_dvec3());
    let normal = u.cross(v).normalize();
    let offset = (sample.ray.origin - CENTRE).as_dvec3();
    let s = normal.dot(offset.cross(v)) / normal.dot(u.cross(v));
    let t = normal.dot(u.cross(offset)) / normal.dot(u.cross(v));
    let local = Frame::from_z(normal).to_local(direction(sample));
    let place = cell(0.5 * (1.0 + s), 4) * 4 + cell(0.5 * (1.0 + t), 4);
    let toward = cell(local.z * local.z, 4) * 4 + cell(turns(local.x, local.y), 4);
    let side = usize::from(local.z < 0.0);
    (side * 16 + place) * 16 + toward
}

fn area_agrees(samples: u32, fault: f64) -> bool {
    [false, true].into_iter().all(|both_sides| {
        let lamp = MaterialDescription {
            double_sided: both_sides,
            ..lamp(2.0)
        };
        let stage = Stage::new().add(lamp, rectangle(CENTRE, U, V));
        let cells = if both_sides { 512 } else { 256 };
        let mut expected = vec![f64::from(samples) / cells as f64; cells];
        for pair in expected.chunks_exact_mut(2) {
            pair[0] *= 1.0 + fault;
            pair[1] *= 1.0 - fault;
        }
        let observed = count(&stage.build(), samples, cells, area_cell);
        accepts(&observed, &expected)
    })
}

#[test]
fn surfaces_emit_by_area_and_cosine() {
    assert!(area_agrees(FAST, 0.0));
}

#[test]
#[ignore = "long"]
fn surfaces_emit_by_area_and_cosine_to_a_tenth_of_a_percent() {
    assert!(area_agrees(LONG, 0.0));
}

/// The test of the test: a density wrong by a twentieth, up and down, is found.
#[test]
fn a_wrong_density_is_rejected() {
    assert!(!area_agrees(FAST, 0.05));
}

/// A point or spot light over the sphere, against its own density.
fn punctual_agrees(kind: LightKind, samples: u32, fault: f64) -> bool {
    let axis = Vec3::new(0.6, -0.8, 0.1);
    let stage = Stage::new().light(punctual(kind, 1.0, CENTRE, axis));
    let light = Punctual::new(&stage.description.lights[0]);
    // the rim of a cone of 60 degrees lies in the middle of a row, between points of the integral
    let sphere = Sphere::new(light.axis(), 30, 16);
    let bent = |d: DVec3| light.direction_pdf(d) * (1.0 + fault * light.axis().dot(d));
    let density = sphere.integrate(4, bent);
    let sum: f64 = density.iter().sum();
    let expected: Vec<f64> = density
        .iter()
        .map(|p| p / sum * f64::from(samples))
        .collect();
    let observed = count(&stage.build(), samples, sphere.len(), |sample| {
        assert_eq!(sample.ray.origin, CENTRE);
        sphere.cell(direction(sample))
    });
    (sum - 1.0).abs() < 1e-3 + fault && accepts(&observed, &expected)
}

const SPOT: LightKind = LightKind::Spot {
    inner: 0.4,
    outer: FRAC_PI_3 as f32,
};

#[test]
fn points_and_spots_have_the_stated_density() {
    for kind in [LightKind::Point, SPOT] {
        assert!(punctual_agrees(kind, FAST, 0.0), "{kind:?}");
        assert!(!punctual_agrees(kind, FAST, 0.4), "{kind:?}");
    }
}

#[test]
#[ignore = "long"]
fn points_and_spots_have_the_stated_density_to_a_tenth_of_a_percent() {
    for kind in [LightKind::Point, SPOT] {
        assert!(punctual_agrees(kind, LONG, 0.0), "{kind:?}");
    }
}

/// Radius squared and angle on the disc that a ray from infinitely far away starts on, in
/// units of the scene's sphere.
fn on_disc(scene: &Scene, sample: &EmissionSample) -> [f64; 2] {
    let (centre, radius) = scene.bounding_sphere();
    let frame = Frame::from_z(direction(sample));
    let local = frame.to_local(sample.ray.origin.as_dvec3() - centre) / radius;
    assert!((local.z + 1.0).abs() < 1e-5, "behind the scene: {local}");
    let squared = local.x * local.x + local.y * local.y;
    assert!(squared < 1.0 + 1e-5);
    [squared, turns(local.x, local.y)]
}

fn plate() -> Stage {
    Stage::new().add(grey(0.5), rectangle(CENTRE, U * 3.0, V * 2.0))
}

#[test]
fn directional_light_fills_the_disc() {
    let axis = Vec3::new(0.3, -0.9, 0.2);
    let light = punctual(LightKind::Directional, 2.0, Vec3::ZERO, axis);
    let scene = plate().light(light).build();
    let observed = count(&scene, FAST, 256, |sample| {
        assert!((sample.ray.direction - axis.normalize()).length() < 1e-6);
        let [squared, turns] = on_disc(&scene, sample);
        cell(squared, 16) * 16 + cell(turns, 16)
    });
    assert!(accepts(&observed, &[f64::from(FAST) / 256.0; 256]));
}

fn sky_agrees(samples: u32) -> bool {
    let sky: Vec<f32> = (0..72).map(|i| (i * i % 11) as f32).collect();
    let scene = under_sky(plate(), 12, &sky).build();
    let sphere = Sphere::new(DVec3::new(0.2, 0.9, 0.1).normalize(), 12, 24);
    let density = sphere.integrate(16, |d| scene.environment_pdf(d));
    assert!((density.iter().sum::<f64>() - 1.0).abs() < 2e-3);
    let parts = density
        .iter()
        .flat_map(|p| [p * f64::from(samples) / 4.0; 4]);
    let expected: Vec<f64> = parts.collect();
    let observed = count(&scene, samples, expected.len(), |sample| {
        let [squared, turns] = on_disc(&scene, sample);
        sphere.cell(-direction(sample)) * 4 + cell(squared, 2) * 2 + cell(turns, 2)
    });
    accepts(&observed, &expected)
}

#[test]
fn the_sky_emits_from_its_disc() {
    assert!(sky_agrees(FAST));
}

#[test]
#[ignore = "long"]
fn the_sky_emits_from_its_disc_to_a_tenth_of_a_percent() {
    assert!(sky_agrees(LONG));
}

/// One over the weight is the density: their product with the radiance is constant for lamps.
#[test]
fn weights_are_radiance_over_density() {
    let scene = Stage::new().add(lamp(1.0), rectangle(CENTRE, U, V)).build();
    let radiance = kaustik_spectrum::uplift_emission([1.0; 3]).eval(&wavelengths());
    let area = 4.0 * U.cross(V).length();
    let mut rng = Rng::new(1);
    for _ in 0..1000 {
        let sample = scene
            .sample_emission(&wavelengths(), |_| rng.uniform())
            .expect("a lamp");
        let ratio = sample.weight.hero() / (radiance.hero() * area * PI as f32);
        assert!((ratio - 1.0).abs() < 1e-5);
        let place = sample.area.expect("a surface").weight;
        assert!((place / f64::from(area) - 1.0).abs() < 1e-5);
    }
}
