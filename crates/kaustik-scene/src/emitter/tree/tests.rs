//! In trees of any size, anywhere, nothing that shines at a point rounds to nothing.

use glam::Vec3;
use proptest::prelude::*;

use super::*;

/// A lamp: the exponent of its power, its place, where it shines to within how many radians, and how many lengths far.
type Lamp = (i32, Vec3, DVec3, f64, Option<f64>);

/// Of length 1.
pub(super) fn unit() -> impl Strategy<Value = DVec3> {
    (-1.0..1.0f64, 0.0..std::f64::consts::TAU).prop_map(|(z, phi)| {
        let radius = (1.0 - z * z).sqrt();
        DVec3::new(radius * libm::cos(phi), radius * libm::sin(phi), z)
    })
}

fn place() -> impl Strategy<Value = Vec3> {
    let any = [-1.0..1.0f32, -1.0..1.0f32, -1.0..1.0f32].prop_map(Vec3::from_array);
    prop_oneof![any, Just(Vec3::ZERO)]
}

fn lamps() -> impl Strategy<Value = Vec<Lamp>> {
    let range = prop_oneof![Just(None), (0.01..3.0f64).prop_map(Some)];
    let lamp = (-30..30i32, place(), unit(), 0.01..3.0f64, range);
    prop::collection::vec(lamp, 1..40)
}

fn tree(lamps: &[Lamp], scale: f32, away: Vec3) -> LightTree {
    let light = |(i, &(power, place, axis, angle, range)): (usize, &Lamp)| {
        let place = (place * scale + away).as_dvec3();
        let range = range.map_or(f64::INFINITY, |range| range * f64::from(scale));
        Light::lamp(i as u32, 10.0_f64.powi(power), place, (axis, angle), range)
    };
    LightTree::new(lamps.iter().enumerate().map(light).collect(), lamps.len())
}

fn normal_of([a, b, c]: [Vec3; 3]) -> DVec3 {
    let [u, v] = [b - a, c - a].map(Vec3::as_dvec3);
    u.cross(v).normalize_or_zero()
}

/// Where there is no number nothing is chosen.
#[test]
fn places_that_are_no_numbers_have_no_share() {
    let lamp = |i, place| Light::lamp(i, 1.0, place, (DVec3::Z, 3.0), f64::INFINITY);
    let apart = vec![lamp(0, DVec3::ZERO), lamp(1, DVec3::X), lamp(2, DVec3::Y)];
    let together = (0..5).map(|i| lamp(i, DVec3::ONE)).collect();
    for tree in [LightTree::new(apart, 3), LightTree::new(together, 5)] {
        for point in [
            DVec3::NAN,
            DVec3::INFINITY,
            DVec3::new(0.0, f64::NEG_INFINITY, 1.0),
        ] {
            assert_eq!(tree.choose(point, 0.5), None);
            assert_eq!(tree.probability(point, 1), Some(0.0));
        }
        let share = tree.probability(DVec3::new(0.2, 0.1, 3.0), 1);
        assert!(share.is_some_and(|share| share > 0.1), "{share:?}");
    }
}

proptest! {
    /// Looked at from within each lamp's cone, at any distance.
    #[test]
    fn what_shines_has_a_share(
        lamps in lamps(),
        size in -15..15i32,
        away in (place(), 0..4i32),
        distance in -5.0..9.0f64,
        turn in unit(),
    ) {
        let scale = 10.0_f32.powi(size);
        let away = away.0 * scale * 10.0_f32.powi(away.1);
        let tree = tree(&lamps, scale, away);
        let distance = libm::pow(10.0, distance);
        for (i, &(_, place, axis, angle, range)) in lamps.iter().enumerate() {
            let inside = axis + turn * libm::sin(0.999 * angle.min(std::f64::consts::FRAC_PI_2));
            let direction = inside.normalize_or(axis);
            let shines = cone::angle(direction, axis) < angle;
            if !shines || range.is_some_and(|range| distance > range) {
                continue;
            }
            let from = (place * scale + away).as_dvec3();
            let share = tree.probability(from + direction * (distance * f64::from(scale)), i);
            prop_assert!(share.is_some_and(|share| share > 0.0 && share <= 1.0), "{i}: {share:?}");
        }
    }

    /// So has a triangle seen from its front, be it at a grazing angle.
    #[test]
    fn faces_have_a_share(
        faces in prop::collection::vec((place(), place(), place()), 1..40),
        size in -12..12i32,
        cos in prop_oneof![0.0..1.0f64, (-5.0..0.0f64).prop_map(|x| libm::pow(10.0, x))],
        distance in -3.0..7.0f64,
        turn in unit(),
    ) {
        let scale = 10.0_f32.powi(size);
        let faces: Vec<_> = (faces.into_iter())
            .map(|(a, b, c)| [a, a + b * 0.1, a + c * 0.1].map(|corner| corner * scale))
            .map(|corners| (corners, normal_of(corners)))
            .filter(|(_, normal)| normal.is_normalized())
            .collect();
        let light = |(i, &(corners, normal))| Light::triangle(i as u32, 1.0, corners, normal);
        let tree = LightTree::new(faces.iter().enumerate().map(light).collect(), faces.len());
        let distance = libm::pow(10.0, distance) * f64::from(scale);
        for (i, (corners, normal)) in faces.iter().enumerate() {
            let aside = (turn - *normal * turn.dot(*normal)).normalize();
            let direction = *normal * cos + aside * (1.0 - cos * cos).sqrt();
            let from = corners[0].as_dvec3() + direction * distance;
            // A face that lies so low as seen from there that rounding decides is none.
            if !aside.is_finite() || (from - corners[0].as_dvec3()).normalize().dot(*normal) < 1e-5 {
                continue;
            }
            let share = tree.probability(from, i);
            prop_assert!(share.is_some_and(|share| share > 0.0 && share <= 1.0), "{i}: {share:?}");
        }
    }

    /// The numbers that lead to an emitter are as many as its probability.
    #[test]
    fn numbers_lead_where_probabilities_say(lamps in lamps(), point in place(), size in -15..15i32) {
        const COUNT: u32 = 1 << 14;
        let scale = 10.0_f32.powi(size);
        let tree = tree(&lamps, scale, Vec3::ZERO);
        let point = (point * scale * 2.0).as_dvec3();
        let mut met = vec![0; lamps.len()];
        for i in 0..COUNT {
            if let Some((emitter, stated)) = tree.choose(point, (f64::from(i) + 0.5) / f64::from(COUNT)) {
                met[emitter] += 1;
                let other = tree.probability(point, emitter).unwrap_or(0.0);
                prop_assert!((stated / other - 1.0).abs() < 1e-12, "{stated} {other}");
            }
        }
        // Where a group that has a share turns out to send nothing, its numbers lead nowhere.
        for (i, met) in met.into_iter().enumerate() {
            let (share, stated) = (f64::from(met) / f64::from(COUNT), tree.probability(point, i));
            let off = share - stated.unwrap_or(0.0);
            prop_assert!(off.abs() <= 1.0 / f64::from(COUNT), "{i}: {share} {stated:?}");
        }
    }
}
