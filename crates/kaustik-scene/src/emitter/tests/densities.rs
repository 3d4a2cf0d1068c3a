//! The densities that emission sampling, next event and running into an emitter state are the same.

use glam::{DVec3, Vec3};
use kaustik_geometry::Ray;

use super::under_sky;
use crate::description::LightKind;
use crate::testing::{Rng, Stage, double_sided, grey, lamp, punctual, rectangle, wavelengths};
use crate::{EmissionPdf, Interior, Reach, Scene, Vertex};

fn near(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-4 * a.abs().max(b.abs())
}

/// Two lamps, one of which shines to both sides, a sky, a point, a spot and parallel light, around a
/// grey plate.
fn stage() -> Stage {
    let mut stage = Stage::new()
        .add(
            lamp(1.0),
            rectangle(Vec3::new(0.2, 1.5, 0.0), Vec3::X, Vec3::Z),
        )
        .add(
            double_sided(lamp(3.0)),
            rectangle(Vec3::new(-1.6, -0.3, 0.2), Vec3::Z, Vec3::Y),
        )
        .add(
            grey(0.5),
            rectangle(Vec3::new(0.0, -1.0, 0.0), Vec3::Z, Vec3::X),
        );
    let spot = LightKind::Spot {
        inner: 0.4,
        outer: 0.9,
    };
    for kind in [LightKind::Point, spot, LightKind::Directional] {
        let (position, axis) = (Vec3::new(0.5, 1.0, 0.3), Vec3::new(-0.3, -1.0, 0.1));
        stage = stage.light(punctual(kind, 2.0, position, axis));
    }
    let sky: Vec<f32> = (0..72).map(|i| (1 + i * i % 11) as f32 * 0.1).collect();
    under_sky(stage, 12, &sky)
}

/// What running into the start of an emission states, for hittable emitters.
fn met(scene: &Scene, ray: &Ray, distance: f32) -> Option<EmissionPdf> {
    let back = Ray::new(ray.origin + ray.direction * distance, -ray.direction);
    let mut vertex = Vertex::default();
    let mut interior = Interior::VACUUM;
    let met = scene.advance(&back, &mut interior, &wavelengths(), || 0.0, &mut vertex);
    if met.escapes() {
        return None;
    }
    Some(scene.emission_pdf(&vertex, ray.direction.as_dvec3()))
}

#[test]
fn emission_and_hits_state_the_same() {
    let scene = stage().build();
    let mut rng = Rng::new(3);
    let (mut surfaces, mut skies, mut others) = (0, 0, 0);
    for _ in 0..4_000 {
        let sample = scene
            .sample_emission(&wavelengths(), |_| rng.uniform())
            .expect("an emission");
        let own = sample.pdf;
        if let Some(area) = &sample.area {
            assert!(near(own.position, 1.0 / area.weight));
            // The lamp met just before its start.
            let found = met(&scene, &sample.ray, 1e-3).expect("the lamp");
            assert!(near(found.position, own.position), "{found:?} {own:?}");
            assert!(near(found.direction, own.direction), "{found:?} {own:?}");
            assert!(near(found.cos, own.cos));
            surfaces += 1;
        } else if own.hittable {
            let toward = -sample.ray.direction.as_dvec3();
            let found = scene.environment_emission_pdf(toward);
            assert!(near(found.position, own.position) && near(found.direction, own.direction));
            assert!(found.infinite && own.infinite);
            skies += 1;
        } else {
            others += 1;
        }
    }
    assert!(surfaces > 300 && skies > 300 && others > 100);
}

/// Next event's densities are those of emission at the same point, brought to the receiver, times the odds of the choice.
#[test]
fn next_event_states_the_same() {
    let scene = stage().build();
    let mut rng = Rng::new(5);
    let from = DVec3::new(0.1, -0.2, 0.05);
    let mut kinds = [0; 3];
    for _ in 0..4_000 {
        let sample = scene.sample_direct(from, &wavelengths(), |_| rng.uniform());
        let Some(sample) = sample else { continue };
        match &sample.reach {
            Reach::Surface(point, _) => {
                let to = point.as_dvec3() - from;
                let ray = Ray::new(*point, -sample.wi.as_vec3());
                let own = met(&scene, &ray, 1e-3).expect("the lamp");
                let odds = scene.next_event_odds(&own, from);
                assert!(near(odds, sample.odds) && !near(odds, 1.0));
                let pdf = odds * own.position * to.length_squared() / own.cos;
                assert!(near(pdf, sample.pdf), "{pdf} {sample:?}");
                assert!(near(own.direction, sample.emission_pdf));
                kinds[0] += 1;
            }
            Reach::Point(_) => {
                assert!(sample.delta && sample.emission_pdf > 0.0);
                kinds[1] += 1;
            }
            Reach::Infinity => {
                let (_, radius) = scene.bounding_sphere();
                let disc = 1.0 / (std::f64::consts::PI * radius * radius);
                assert!(near(sample.emission_pdf, disc));
                if !sample.delta {
                    let own = scene.environment_emission_pdf(sample.wi);
                    assert!(near(own.position, sample.pdf));
                }
                kinds[2] += 1;
            }
        }
    }
    assert!(kinds.iter().all(|&count| count > 100), "{kinds:?}");
}

#[test]
fn what_does_not_shine_has_no_density() {
    let scene = stage().build();
    let mut vertex = Vertex::default();
    let mut see = |origin: Vec3, direction: Vec3| {
        let ray = Ray::new(origin, direction);
        let mut interior = Interior::VACUUM;
        let seen = scene.advance(&ray, &mut interior, &wavelengths(), || 0.0, &mut vertex);
        assert!(!seen.escapes());
        scene.emission_pdf(&vertex, -direction.as_dvec3())
    };
    let plate = see(Vec3::new(0.3, 0.0, 0.2), Vec3::NEG_Y);
    // the first lamp faces down or up; one of its sides is dark
    let below = see(Vec3::new(0.2, 0.5, 0.1), Vec3::Y);
    let above = see(Vec3::new(0.2, 2.5, 0.1), Vec3::NEG_Y);
    assert!(plate.position == 0.0 && plate.direction == 0.0);
    assert!((below.position > 0.0) != (above.position > 0.0));
}
