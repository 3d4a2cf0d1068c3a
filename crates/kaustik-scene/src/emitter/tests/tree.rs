//! The tree of lights: its choice has the stated probabilities, leaves out nothing that shines at a point, and is near what
//! lamps bring.

use glam::{DAffine3, DVec3, Vec3};
use kaustik_geometry::{Mesh, Ray};
use proptest::prelude::*;

use super::super::next_event::BY_POWER;
use super::{FAST, accepts};
use crate::description::{
    Carried, Interpolation, Joint, LightDescription, LightKind, Load, Shutter,
};
use crate::testing::{
    Rng, Stage, ceiling, channel, cuboid, double_sided, grey, joint, lamp, mean, punctual,
    rectangle, sphere, wavelengths,
};
use crate::{EmissionPdf, Reach, Scene};

/// A point of a cube whose edge is 8.
fn place() -> impl Strategy<Value = Vec3> {
    [-4.0..4.0f32, -4.0..4.0f32, -4.0..4.0f32].prop_map(Vec3::from)
}

fn surfaces() -> impl Strategy<Value = (Mesh, bool, f32)> {
    let mesh = prop_oneof![
        (place(), place(), place()).prop_map(|(p, u, v)| rectangle(p, u * 0.1, v * 0.1)),
        (place(), 0.05..0.5f32).prop_map(|(p, r)| sphere(p, r)),
        (place(), place()).prop_map(|(p, e)| cuboid(p, p + e.abs() * 0.2 + 0.01)),
    ];
    (mesh, any::<bool>(), 0.1..10.0f32)
}

fn light() -> impl Strategy<Value = LightDescription> {
    let spot = (0.0..0.7f32, 0.01..0.8f32).prop_map(|(inner, more)| LightKind::Spot {
        inner,
        outer: (inner + more).min(std::f32::consts::FRAC_PI_2),
    });
    let kind = prop_oneof![
        2 => Just(LightKind::Point),
        2 => spot,
        1 => Just(LightKind::Directional)
    ];
    let range = prop_oneof![Just(None), (0.5..9.0f32).prop_map(Some)];
    (kind, 0.1..10.0f32, place(), place(), range).prop_map(|(kind, power, at, axis, range)| {
        let axis = (axis + Vec3::X * 1e-3).normalize();
        LightDescription {
            range,
            ..punctual(kind, power, at, axis)
        }
    })
}

/// Many lamps of all kinds.
fn scene() -> impl Strategy<Value = Scene> {
    let surfaces = prop::collection::vec(surfaces(), 1..6);
    let lights = prop::collection::vec(light(), 3..12);
    (surfaces, lights, any::<bool>()).prop_map(|(surfaces, lights, sky)| {
        let mut stage = Stage::new();
        for (mesh, both_sides, strength) in surfaces {
            let material = match both_sides {
                true => double_sided(lamp(strength)),
                false => lamp(strength),
            };
            stage = stage.add(material, mesh);
        }
        let stage = lights.into_iter().fold(stage, Stage::light);
        match sky {
            true => stage.sky(0.3).build(),
            false => stage.build(),
        }
    })
}

/// How often each emitter is chosen at a point for numbers that are spread evenly.
fn shares(scene: &Scene, point: DVec3, count: u32) -> Vec<f64> {
    let emitters = scene.emitters();
    let mut shares = vec![0.0; emitters.list.len()];
    for i in 0..count {
        let u = (f64::from(i) + 0.5) / f64::from(count);
        if let Some(chosen) = emitters.choose_from(point, || u) {
            let found = std::ptr::from_ref(chosen.emitter);
            let index = emitters.list.iter().position(|e| std::ptr::eq(e, found));
            shares[index.expect("one of the list")] += 1.0 / f64::from(count);
        }
    }
    shares
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// The measure of the numbers that lead to each emitter is its probability.
    #[test]
    fn the_measure_of_numbers_is_the_probability(scene in scene(), point in place()) {
        const COUNT: u32 = 100_000;
        let point = point.as_dvec3();
        let emitters = scene.emitters();
        prop_assert!(emitters.next_event.is_some());
        for (i, share) in shares(&scene, point, COUNT).into_iter().enumerate() {
            let stated = emitters.choice.probability(i) * emitters.odds(i as u32, point);
            let off = (share - stated).abs();
            prop_assert!(off < 1e-3, "{i}: {share} {stated}");
        }
    }

    /// Where an emitter shines the tree may choose it: light walks reach nothing that next event is blind to.
    #[test]
    fn what_shines_at_a_point_may_be_chosen(scene in scene(), seed in any::<u64>()) {
        prop_assert_eq!(first_blind(&scene, seed, 200), None);
    }

    /// Points anywhere, and those of lamps themselves, have probabilities.
    #[test]
    fn extremes_have_numbers(scene in scene(), scale in -30..30i32) {
        let far = DVec3::new(1.0, -2.0, 0.5) * 10.0_f64.powi(scale);
        let at_lamps = scene.emitters().punctual.iter().map(|light| light.position);
        for point in at_lamps.chain([far]) {
            for i in 0..scene.emitters().list.len() {
                let odds = scene.emitters().odds(i as u32, point);
                prop_assert!(odds > 0.0 && odds.is_finite(), "{i} at {point}: {odds}");
            }
        }
    }
}

/// The first of many light walks that leaves an emitter for a point from which the tree never chooses that; `None` if there is none.
fn first_blind(scene: &Scene, seed: u64, walks: u32) -> Option<EmissionPdf> {
    let mut rng = Rng::new(seed);
    (0..walks).find_map(|_| {
        let emission = scene.sample_emission(&wavelengths(), |_| rng.uniform())?;
        let distance = 12.0 * rng.uniform();
        let along = emission.ray.direction.as_dvec3() * distance;
        let point = emission.ray.origin.as_dvec3() + along;
        // At a grazing angle and at its own surface rounding decides.
        let shines = scene.fading(&emission, distance) > 0.0 && emission.weight.max() > 0.0;
        if !shines || emission.pdf.cos < 1e-3 || distance < 1e-2 {
            return None;
        }
        let odds = scene.next_event_odds(&emission.pdf, point);
        // More often than the share that goes by power anyway.
        let seen = odds > BY_POWER * (1.0 + 1e-12) && odds.is_finite();
        (!seen).then_some(emission.pdf)
    })
}

/// Spots back to back, and faces, on tilted poles; and a lamp that fades.
fn back_to_back() -> Stage {
    let spot = LightKind::Spot {
        inner: 0.01,
        outer: 0.02,
    };
    let mut stage = Stage::new();
    for i in 0..8_u8 {
        let (axis, at) = (
            Vec3::new(0.3, 1.0 + f32::from(i), -0.7).normalize(),
            Vec3::X * f32::from(i),
        );
        for side in [axis, -axis] {
            stage = stage.light(punctual(spot, 1.0, at + Vec3::Y, side));
            let (u, v) = (side.any_orthonormal_vector() * 0.2, side);
            stage = stage.add(lamp(1.0), rectangle(at, u, u.cross(v)));
        }
    }
    stage.light(LightDescription {
        range: Some(1.5),
        ..punctual(LightKind::Point, 30.0, Vec3::NEG_Z, Vec3::NEG_Y)
    })
}

#[test]
fn lamps_back_to_back_are_not_blind() {
    assert_eq!(first_blind(&back_to_back().build(), 5, 40_000), None);
}

/// The lamp that fades goes far beyond its own reach; a face turns over.
#[test]
fn lamps_that_move_are_not_blind() {
    let mut stage = back_to_back();
    let loads = [
        Load::Light(stage.description.lights.len() - 1),
        Load::Instance(3),
    ];
    stage.description.cameras[0].shutter = Some(Shutter {
        open: 0.0,
        close: 1.0,
    });
    let animation = &mut stage.description.animation;
    for (number, load) in loads.into_iter().enumerate() {
        animation.carried.push(Carried {
            load,
            joint: number,
            offset: DAffine3::IDENTITY,
        });
        let goes = [[0.0, 0.0, -4.0], [0.0, 0.0, 4.0]];
        let turns = [[0.0, 0.0, 0.0, 1.0], [1.0, 0.0, 0.0, 0.0]];
        animation.joints.push(Joint {
            translation: Some(channel(Interpolation::Linear, &[0.0, 1.0], &goes)),
            rotation: Some(channel(Interpolation::Linear, &[0.0, 1.0], &turns)),
            ..joint()
        });
    }
    let scene = stage.build();
    assert!(scene.moves());
    for time in [0.0, 0.2, 0.5, 0.9, 1.0] {
        assert_eq!(first_blind(&scene.at(time), 7, 20_000), None);
    }
}

/// A weak lamp before a wall, a strong one right behind it: next event knows nothing of the wall, and looks at the weak one still.
#[test]
fn what_shines_behind_a_wall_does_not_have_all() {
    let lamp = |power: f32, at: Vec3| punctual(LightKind::Point, power, at, Vec3::NEG_Y);
    let scene = (Stage::new())
        .add(grey(0.5), rectangle(Vec3::X, Vec3::Y, Vec3::Z))
        .light(lamp(1.0, Vec3::NEG_X * 3.0))
        .light(lamp(1e4, Vec3::X * 1.01))
        .light(lamp(1e4, Vec3::X * 1.02))
        .build();
    let mut rng = Rng::new(53);
    let point = DVec3::X * 0.99;
    let weak = (0..FAST).filter(|_| {
        let sample = scene.sample_direct(point, &wavelengths(), |_| rng.uniform());
        sample.is_some_and(|sample| sample.wi.x < 0.0)
    });
    let share = weak.count() as f64 / f64::from(FAST);
    // By light walks a tenth of the mean of the three.
    assert!(share > 0.9 * BY_POWER / 31.0, "{share}");
}

/// A light that stands nowhere leaves the choice by power.
#[test]
fn a_place_that_is_no_number_has_no_tree() {
    let nowhere = punctual(LightKind::Point, 1.0, Vec3::splat(f32::NAN), Vec3::NEG_Y);
    let scene = back_to_back().light(nowhere).build();
    assert!(!scene.chooses_emitters_by_place());
}

/// A long hall with a lamp every four units.
fn hall(lamps: u32) -> Scene {
    let mut stage = Stage::new();
    for i in 0..lamps {
        let place = Vec3::new(0.0, 3.0, 4.0 * i as f32);
        stage = stage.add(lamp(1.0), ceiling(place, 0.2));
    }
    stage.build()
}

/// Irradiance of a level surface that faces up, by `samples` next events; with the standard error.
fn irradiance(scene: &Scene, point: DVec3, samples: u32) -> (f64, f64) {
    let mut rng = Rng::new(9);
    mean((0..samples).map(|_| {
        scene
            .sample_direct(point, &wavelengths(), |_| rng.uniform())
            .map_or(0.0, |sample| {
                let cos = sample.wi.y.max(0.0);
                f64::from(sample.radiance.hero()) * cos / sample.pdf
            })
    }))
}

/// Of a hundred lamps those overhead are looked at: the irradiance is right, and by far surer than where each is looked at as often.
#[test]
fn lamps_that_are_near_are_chosen() {
    let scene = hall(100);
    let point = DVec3::new(0.3, 0.0, 40.5);
    let (mean, error) = irradiance(&scene, point, FAST);
    let unit = f64::from(
        kaustik_spectrum::uplift_emission([1.0; 3])
            .eval(&wavelengths())
            .hero(),
    );
    let expected: f64 = (0..100).map(|i| square(point, 4.0 * f64::from(i))).sum();
    let off = (mean / unit / expected - 1.0).abs();
    assert!(off < 4.5 * error / mean + 1e-4, "{mean} {error} {expected}");
    let evenly = 4.0 * 100.0 / 7.0;
    let relative = error * error / (mean * mean) * f64::from(FAST);
    assert!(
        relative < evenly / 40.0,
        "variance {relative}, evenly some {evenly}"
    );
}

/// Irradiance by a square of the hall, by the midpoint rule.
fn square(point: DVec3, z: f64) -> f64 {
    const CELLS: u32 = 20;
    let at = |i: u32| 0.2 * (2.0 * (f64::from(i) + 0.5) / f64::from(CELLS) - 1.0);
    let area = 0.16 / f64::from(CELLS * CELLS);
    let cells = (0..CELLS).flat_map(|i| (0..CELLS).map(move |j| (i, j)));
    cells
        .map(|(i, j)| {
            let to = DVec3::new(at(i), 3.0, z + at(j)) - point;
            to.y * to.y / (to.length_squared() * to.length_squared()) * area
        })
        .sum()
}

/// Sums of samples weighted with the balance heuristic: next event and light walks together bring what next event brings alone, if
/// the odds are right.
fn by_light_walks(scene: &Scene, target: &Target, factor: f64, samples: u32) -> (f64, f64) {
    let mut rng = Rng::new(31);
    mean((0..samples).map(|_| {
        let emission = scene.sample_emission(&wavelengths(), |_| rng.uniform());
        let Some(emission) = emission else { return 0.0 };
        let Some((point, cos)) = target.hit(&emission.ray) else {
            return 0.0;
        };
        let odds = scene.next_event_odds(&emission.pdf, point) * factor;
        let walk = per_area(&emission.pdf, point, cos, emission.ray.origin.as_dvec3());
        // Next event from a point of the target that is drawn evenly.
        let next_event = odds / target.area();
        f64::from(emission.weight.hero()) * walk / (walk + next_event)
    }))
}

/// Density with which a walk reaches the target there.
fn per_area(pdf: &EmissionPdf, point: DVec3, cos: f64, origin: DVec3) -> f64 {
    match pdf.infinite {
        true => pdf.direction * cos,
        false => pdf.direction * cos / (point - origin).length_squared(),
    }
}

fn by_next_event(scene: &Scene, target: &Target, samples: u32) -> (f64, f64) {
    let mut rng = Rng::new(37);
    mean((0..samples).map(|_| {
        let point = target.point([rng.uniform(), rng.uniform()]);
        let sample = scene.sample_direct(point, &wavelengths(), |_| rng.uniform());
        let Some(sample) = sample else { return 0.0 };
        let cos = sample.wi.y;
        if cos <= 0.0 {
            return 0.0;
        }
        let squared = match sample.reach {
            Reach::Surface(at, _) => (at.as_dvec3() - point).length_squared(),
            Reach::Point(at) => (at - point).length_squared(),
            Reach::Infinity => 1.0,
        };
        let walk = sample.emission_pdf * cos / squared;
        let next_event = sample.odds / target.area();
        let flux = f64::from(sample.radiance.hero()) * cos * target.area() / sample.pdf;
        flux * next_event / (walk + next_event)
    }))
}

/// A level square at the height 0 that faces up.
struct Target {
    half: f64,
}

impl Target {
    fn area(&self) -> f64 {
        4.0 * self.half * self.half
    }

    fn point(&self, u: [f64; 2]) -> DVec3 {
        let [x, z] = u.map(|u| self.half * (2.0 * u - 1.0));
        DVec3::new(x, 0.0, z)
    }

    fn hit(&self, ray: &Ray) -> Option<(DVec3, f64)> {
        let (origin, direction) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
        let distance = -origin.y / direction.y;
        let point = origin + direction * distance;
        let inside = point.x.abs() <= self.half && point.z.abs() <= self.half;
        (distance > 0.0 && direction.y < 0.0 && inside).then_some((point, -direction.y))
    }
}

/// Lamps of which none hides another from the target.
fn above_a_target() -> Scene {
    let mut stage = Stage::new();
    for i in 0..7_u8 {
        let (x, z) = (f32::from(i) - 3.0, f32::from(i * 3 % 7) - 3.0);
        let place = Vec3::new(x, 1.0 + 0.2 * f32::from(i), z);
        stage = match i % 3 {
            0 => stage.add(lamp(3.0), ceiling(place, 0.1)),
            1 => stage.light(punctual(LightKind::Point, 0.2, place, Vec3::NEG_Y)),
            _ => {
                let spot = LightKind::Spot {
                    inner: 0.3,
                    outer: 1.0,
                };
                stage.light(punctual(spot, 0.5, place, Vec3::NEG_Y))
            }
        };
    }
    stage.build()
}

/// Two techniques, each weighted by what it knows of the other, bring all the light together. The odds at half are noticed.
#[test]
fn weights_by_the_odds_sum_to_one() {
    let (scene, target) = (above_a_target(), Target { half: 2.0 });
    let mut rng = Rng::new(41);
    let whole = mean((0..FAST).map(|_| {
        let point = target.point([rng.uniform(), rng.uniform()]);
        let sample = scene.sample_direct(point, &wavelengths(), |_| rng.uniform());
        sample.map_or(0.0, |s| {
            f64::from(s.radiance.hero()) * s.wi.y.max(0.0) / s.pdf
        })
    }));
    let whole = (whole.0 * target.area(), whole.1 * target.area());
    let next_event = by_next_event(&scene, &target, FAST);
    let off = |factor: f64| {
        let walks = by_light_walks(&scene, &target, factor, 4 * FAST);
        let error = (whole.1.powi(2) + walks.1.powi(2) + next_event.1.powi(2)).sqrt();
        (walks.0 + next_event.0 - whole.0) / error
    };
    assert!(off(1.0).abs() < 4.5, "{}", off(1.0));
    assert!(off(0.5) > 10.0, "{}", off(0.5));
    assert!(whole.1 < 0.01 * whole.0 && next_event.0 < 0.9 * whole.0);
}

/// Numbers drawn at random lead to each lamp as often as stated.
#[test]
fn lamps_are_drawn_as_often_as_stated() {
    let scene = above_a_target();
    let point = DVec3::new(0.4, 0.0, -0.8);
    let emitters = scene.emitters();
    let mut rng = Rng::new(43);
    let mut observed = vec![0.0; emitters.list.len()];
    for _ in 0..FAST {
        let chosen = emitters
            .choose_from(point, || rng.uniform())
            .expect("a lamp");
        let found = std::ptr::from_ref(chosen.emitter);
        let index = emitters.list.iter().position(|e| std::ptr::eq(e, found));
        observed[index.expect("one of the list")] += 1.0;
    }
    let expected = |at: DVec3| -> Vec<f64> {
        let probability = |i: usize| emitters.choice.probability(i) * emitters.odds(i as u32, at);
        (0..observed.len())
            .map(|i| probability(i) * f64::from(FAST))
            .collect()
    };
    assert!(accepts(&observed, &expected(point)));
    assert!(!accepts(&observed, &expected(point + DVec3::X * 0.1)));
}

/// A sphere that shines is looked at where it faces the point.
#[test]
fn what_faces_away_is_not_looked_at() {
    let scene = Stage::new().add(lamp(1.0), sphere(Vec3::ZERO, 1.0)).build();
    let mut rng = Rng::new(47);
    let point = DVec3::new(0.0, 3.0, 0.0);
    let found = (0..FAST)
        .filter(|_| {
            let sample = scene.sample_direct(point, &wavelengths(), |_| rng.uniform());
            sample.is_some()
        })
        .count();
    let share = found as f64 / f64::from(FAST);
    // By area a third: a cap whose height is 1 - 1/3.
    assert!(share > 0.4, "{share}");
}
