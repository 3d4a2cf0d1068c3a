//! Energy: emission carries each emitter's power, next event gives irradiances of closed form.

use std::f64::consts::PI;

use glam::{DVec3, Vec3};
use kaustik_spectrum::uplift_emission;

use super::under_sky;
use crate::Scene;
use crate::description::{LightDescription, LightKind, MaterialDescription, Pixels};
use crate::testing::{
    Rng, Stage, blended, double_sided, grey, image, lamp, mean, punctual, rectangle,
    rectangle_with_uv, wavelengths,
};

const SAMPLES: usize = 100_000;

/// Value of a white emission of strength 1 at the tests' first wavelength.
fn unit() -> f64 {
    f64::from(uplift_emission([1.0; 3]).eval(&wavelengths()).hero())
}

/// Checks a mean within `4.5` standard errors and rounding.
fn assert_mean(what: &str, (mean, error): (f64, f64), expected: f64) {
    let tolerance = 4.5 * error + 2e-5 * expected.abs();
    assert!(
        (mean - expected).abs() <= tolerance,
        "{what}: {mean} +- {error}, expected {expected}"
    );
    assert!(error < 0.01 * expected.abs(), "{what}: too uncertain");
}

/// Mean of the emission's weights: the power.
fn power(scene: &Scene) -> (f64, f64) {
    let mut rng = Rng::new(23);
    mean((0..SAMPLES).map(|_| {
        scene
            .sample_emission(&wavelengths(), |_| rng.uniform())
            .map_or(0.0, |sample| f64::from(sample.weight.hero()) / unit())
    }))
}

fn panel() -> kaustik_geometry::Mesh {
    rectangle_with_uv(Vec3::Y, Vec3::X * 0.5, Vec3::Z)
}

const PANEL_AREA: f64 = 2.0;

#[test]
fn surfaces_radiate_pi_times_area_times_radiance() {
    let power_of =
        |material: MaterialDescription| power(&Stage::new().add(material, panel()).build());
    let one = PI * PANEL_AREA * 3.0;
    assert_mean("front", power_of(lamp(3.0)), one);
    assert_mean("both sides", power_of(double_sided(lamp(3.0))), 2.0 * one);
    let veil = blended(lamp(3.0), 0.25);
    assert_mean("partly transparent", power_of(veil), 0.25 * one);
}

#[test]
fn a_picture_radiates_its_mean() {
    let texels = [0.0, 1.0, 0.5, 0.1].map(|grey| [grey; 3]);
    let (stage, slot) = Stage::new().texture(image(2, 2, Pixels::RgbF32(texels.concat())));
    let material = MaterialDescription {
        emissive_texture: Some(slot),
        ..lamp(2.0)
    };
    let scene = stage.add(material, panel()).build();
    let expected = PI * PANEL_AREA * 2.0 * 0.4;
    assert_mean("picture", power(&scene), expected);
}

fn plain() -> Stage {
    Stage::new().add(grey(0.5), panel())
}

fn lights(kind: LightKind) -> Stage {
    let position = Vec3::new(0.0, 3.0, 1.0);
    plain().light(punctual(kind, 2.0, position, Vec3::NEG_Y))
}

fn sun(irradiance: f32, axis: Vec3) -> LightDescription {
    punctual(LightKind::Directional, irradiance, Vec3::ZERO, axis)
}

#[test]
fn punctual_lights_radiate_their_closed_forms() {
    assert_mean(
        "point",
        power(&lights(LightKind::Point).build()),
        4.0 * PI * 2.0,
    );
    // the second is half a degree wide: its cosines lie together, and its middle is as bright
    for (inner, outer) in [(0.3_f32, 0.9_f32), (0.0, 0.008)] {
        let spot = power(&lights(LightKind::Spot { inner, outer }).build());
        let cos = [inner, outer].map(|angle| libm::cos(f64::from(angle)));
        // the falloff is the square of what is linear in the cosine
        let solid_angle = 2.0 * PI * ((1.0 - cos[0]) + (cos[0] - cos[1]) / 3.0);
        assert_mean("spot", spot, 2.0 * solid_angle);
    }
    let directional = lights(LightKind::Directional).build();
    let (_, radius) = directional.bounding_sphere();
    let disc = PI * radius * radius;
    assert_mean("directional", power(&directional), 2.0 * disc);
}

#[test]
fn the_sky_radiates_through_the_sphere() {
    let scene = plain().sky(1.5).build();
    let sphere = 4.0 * PI * PI * scene.bounding_sphere().1.powi(2);
    assert_mean("constant", power(&scene), 1.5 * sphere);
    // upper half bright, the other dim: interpolation keeps the mean by symmetry
    let rows = [3.0, 3.0, 1.0, 1.0];
    let texels: Vec<f32> = rows.iter().flat_map(|&row| [row; 8]).collect();
    let scene = under_sky(plain(), 8, &texels).build();
    assert_mean("picture", power(&scene), 2.0 * sphere);
}

/// Choosing among several emitters loses nothing and counts nothing twice.
#[test]
fn powers_add_up() {
    let scene = lights(LightKind::Point)
        .add(double_sided(lamp(3.0)), panel())
        .light(sun(1.0, Vec3::X))
        .sky(0.2)
        .build();
    let disc = PI * scene.bounding_sphere().1.powi(2);
    let lamps = 2.0 * PI * PANEL_AREA * 3.0;
    let expected = 8.0 * PI + lamps + disc + 0.2 * 4.0 * PI * disc;
    assert_mean("all", power(&scene), expected);
}

/// Photons of a sun and of a dim sky carry nearly the same flux, where half of all other light walks are the sky's.
#[test]
fn photons_of_sun_and_sky_carry_alike() {
    let scene = plain().light(sun(30.0, Vec3::X)).sky(0.02).build();
    let disc = PI * scene.bounding_sphere().1.powi(2);
    let mut rng = Rng::new(31);
    let photons = mean((0..SAMPLES).map(|_| {
        scene
            .sample_photon(&wavelengths(), |_| rng.uniform())
            .map_or(0.0, |sample| f64::from(sample.weight.hero()) / unit())
    }));
    assert_mean("photons", photons, (30.0 + 0.02 * 4.0 * PI) * disc);
    // Mean square over squared mean.
    let spread = |(mean, error): (f64, f64)| 1.0 + SAMPLES as f64 * (error / mean).powi(2);
    let (photons, walks) = (spread(photons), spread(power(&scene)));
    assert!(photons < 1.1 && walks > 1.8, "{photons} {walks}");
}

/// Beside a sun on much ground, and under a sky as well, a twentieth of the photons is a lamp's; the power is that of all.
#[test]
fn a_lamp_has_photons_beside_the_sun() {
    let ground = || {
        let ground = rectangle(Vec3::ZERO, Vec3::Z * 80.0, Vec3::X * 80.0);
        let lamp = punctual(LightKind::Point, 2.0, Vec3::Y, Vec3::NEG_Y);
        Stage::new()
            .add(grey(0.5), ground)
            .light(lamp)
            .light(sun(30.0, Vec3::NEG_Y))
    };
    for (sky, stage) in [(0.0, ground()), (0.1, ground().sky(0.1))] {
        let scene = stage.build();
        let disc = PI * scene.bounding_sphere().1.powi(2);
        let mut rng = Rng::new(37);
        let mut of_lamp = 0;
        let photons = mean((0..SAMPLES).map(|_| {
            let sample = scene.sample_photon(&wavelengths(), |_| rng.uniform());
            sample.map_or(0.0, |sample| {
                of_lamp += usize::from(sample.ray.origin.distance(Vec3::Y) < 1e-3);
                f64::from(sample.weight.hero()) / unit()
            })
        }));
        let power = (30.0 + sky * 4.0 * PI) * disc + 2.0 * 4.0 * PI;
        assert_mean("photons", photons, power);
        let share = of_lamp as f64 / SAMPLES as f64;
        assert!((share - 0.05).abs() < 0.004, "{share}");
    }
}

/// Irradiance at the origin of a surface that faces up.
fn irradiance(scene: &Scene) -> (f64, f64) {
    let mut rng = Rng::new(29);
    mean((0..SAMPLES).map(|_| {
        scene
            .sample_direct(DVec3::ZERO, &wavelengths(), |_| rng.uniform())
            .map_or(0.0, |sample| {
                let cos = sample.wi.y.max(0.0);
                f64::from(sample.radiance.hero()) * cos / sample.pdf / unit()
            })
    }))
}

/// Form factor of a rectangle from a point on the normal of one of its corners, over
/// it: sides `a` and `b` in units of the distance.
fn corner_form_factor(a: f64, b: f64) -> f64 {
    let side = |a: f64, b: f64| {
        let root = (1.0 + a * a).sqrt();
        a / root * libm::atan(b / root)
    };
    (side(a, b) + side(b, a)) / (2.0 * PI)
}

#[test]
fn a_square_above_a_point() {
    let of = |material, mesh| irradiance(&Stage::new().add(material, mesh).build());
    let square = rectangle(Vec3::Y * 1.5, Vec3::X, Vec3::Z);
    let expected = 3.0 * PI * 4.0 * corner_form_factor(1.0 / 1.5, 1.0 / 1.5);
    assert_mean("square", of(lamp(3.0), square.clone()), expected);
    let mut turned = square;
    turned.indices.iter_mut().for_each(|t| t.swap(0, 1));
    let (dark, _) = of(lamp(3.0), turned.clone());
    assert_eq!(dark.to_bits(), 0.0_f64.to_bits(), "its back is dark");
    let both = double_sided(lamp(3.0));
    assert_mean("both sides", of(both, turned), expected);
}

#[test]
fn punctual_lights_and_the_sky_on_a_point() {
    let of = |light| irradiance(&Stage::new().light(light).build());
    let light = punctual(LightKind::Point, 3.0, Vec3::new(0.0, 2.0, 1.0), Vec3::X);
    let cos = 2.0 / 5.0_f64.sqrt();
    let point = 3.0 * cos / 5.0;
    assert_mean("point", of(light.clone()), point);
    let ranged = LightDescription {
        range: Some(4.0),
        ..light
    };
    let window = 1.0 - 25.0 / 256.0;
    assert_mean("range", of(ranged), point * window);
    let along = Vec3::new(1.0, -2.0, 0.0);
    assert_mean("directional", of(sun(3.0, along)), 3.0 * cos);
    let sky = Stage::new().sky(2.0).build();
    assert_mean("sky", irradiance(&sky), 2.0 * PI);
}
