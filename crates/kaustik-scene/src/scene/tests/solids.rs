//! Solids within solids: what fills the space, which interfaces are seen, what absorbs.

use std::f64::consts::PI;

use glam::{DVec3, Vec3};
use kaustik_bsdf::{Lobe, Mode};
use kaustik_geometry::{Mesh, Ray};
use kaustik_spectrum::{Spectrum, uplift_reflectance};

use super::{meet, passed_share};
use crate::description::MaterialDescription;
use crate::testing::{Stage, blended, cuboid, dielectric, grey, rectangle, wavelengths};
use crate::{Interior, Scene};

pub(super) const GREEN: [f32; 3] = [0.3, 0.9, 0.4];
pub(super) const BLUE: [f32; 3] = [0.2, 0.5, 0.8];

/// A smooth solid.
pub(super) fn solid(ior: f32, priority: i32, color: [f32; 3]) -> MaterialDescription {
    MaterialDescription {
        priority,
        ..dielectric(ior, 0.0, color)
    }
}

/// What is left of light after a distance in a solid of that colour at distance 1.
fn beer(color: [f32; 3], distance: f32) -> Spectrum {
    uplift_reflectance(color)
        .eval(&wavelengths())
        .map(|c| libm::powf(c, distance))
}

fn assert_near(a: Spectrum, b: Spectrum) {
    let worst = (a - b).map(f32::abs).max();
    assert!(worst < 2e-5, "{a:?} {b:?}");
}

/// A straight walk through all interfaces: material, length and transmittance of each segment, and
/// the solids at the end.
fn straight(
    scene: &Scene,
    origin: Vec3,
    direction: Vec3,
    mut interior: Interior,
) -> (Vec<(u32, f64, Spectrum)>, Interior) {
    let mut ray = Ray::new(origin, direction);
    let mut seen = Vec::new();
    while let Some((vertex, segment)) = meet(scene, &ray, &mut interior, 0.5) {
        seen.push((vertex.material, segment.distance, segment.transmittance));
        scene.cross(&vertex, direction.as_dvec3(), &mut interior);
        ray = Ray::spawn(&vertex.surface, direction);
    }
    (seen, interior)
}

fn assert_seen(seen: &[(u32, f64, Spectrum)], expected: &[(u32, f64, Spectrum)]) {
    assert_eq!(seen.len(), expected.len(), "{seen:?}");
    for (a, b) in seen.iter().zip(expected) {
        assert_eq!(a.0, b.0, "{seen:?}");
        assert!((a.1 - b.1).abs() < 1e-5 * b.1, "{seen:?}");
        assert_near(a.2, b.2);
    }
}

pub(super) fn slab(from: f32, to: f32) -> Mesh {
    cuboid(Vec3::new(from, -1.0, -1.0), Vec3::new(to, 1.0, 1.0))
}

pub(super) const AXIS: Vec3 = Vec3::new(0.0, 0.1, 0.23);

/// Glass from 0 to 2, water from 1 to 4; the glass fills the overlap.
fn overlapping() -> Scene {
    Stage::new()
        .add(solid(1.33, 1, BLUE), slab(1.0, 4.0))
        .add(solid(1.5, 2, GREEN), slab(0.0, 2.0))
        .build()
}
pub(super) const WATER: u32 = 0;
pub(super) const GLASS: u32 = 1;

#[test]
fn overlapping_solids_are_seen_by_priority() {
    let scene = overlapping();
    let start = AXIS - Vec3::X;
    let (seen, end) = straight(&scene, start, Vec3::X, Interior::VACUUM);
    let expected = [
        (GLASS, 1.0, Spectrum::ONE),
        (GLASS, 2.0, beer(GREEN, 2.0)),
        (WATER, 2.0, beer(BLUE, 2.0)),
    ];
    assert_seen(&seen, &expected);
    assert!(end.is_vacuum());
    let (seen, end) = straight(&scene, AXIS + Vec3::X * 5.0, Vec3::NEG_X, Interior::VACUUM);
    let expected = [
        (WATER, 1.0, Spectrum::ONE),
        (GLASS, 2.0, beer(BLUE, 2.0)),
        (GLASS, 2.0, beer(GREEN, 2.0)),
    ];
    assert_seen(&seen, &expected);
    assert!(end.is_vacuum());
}

/// A block that is clear on one side and frosted on the other: materials of one medium bound one solid, those of another do not.
#[test]
fn a_solid_may_have_several_finishes() {
    let side = |x: f32, out: f32| rectangle(Vec3::X * x, Vec3::Y * out, Vec3::Z);
    let frosted = MaterialDescription {
        base_color: [0.9, 0.8, 0.7, 1.0],
        ..dielectric(1.5, 0.3, GREEN)
    };
    let around = |y: f32, z: f32| {
        let (out, along) = (Vec3::new(0.0, y, z), Vec3::new(0.0, -z, y));
        rectangle(Vec3::X + out, along, Vec3::X)
    };
    let block = |back: MaterialDescription| {
        let stage = Stage::new().add(dielectric(1.5, 0.0, GREEN), side(0.0, -1.0));
        let stage = stage.add(back.clone(), side(2.0, 1.0));
        let sides = [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)];
        let add = |stage: Stage, (y, z)| stage.add(back.clone(), around(y, z));
        sides.into_iter().fold(stage, add).build()
    };
    let start = AXIS - Vec3::X;
    let scene = block(frosted.clone());
    let (seen, end) = straight(&scene, start, Vec3::X, Interior::VACUUM);
    let expected = [(0, 1.0, Spectrum::ONE), (1, 2.0, beer(GREEN, 2.0))];
    assert_seen(&seen, &expected);
    assert!(end.is_vacuum());
    let (back, end) = straight(&scene, AXIS + Vec3::X * 3.0, Vec3::NEG_X, Interior::VACUUM);
    assert_seen(
        &back,
        &[(1, 1.0, Spectrum::ONE), (0, 2.0, beer(GREEN, 2.0))],
    );
    assert!(end.is_vacuum());
    // Who starts within finds the one solid by what it leaves.
    let (within, end) = straight(
        &scene,
        AXIS + Vec3::X,
        Vec3::X,
        scene.matter.interior_at(AXIS.as_dvec3() + DVec3::X),
    );
    assert_seen(&within, &[(1, 1.0, beer(GREEN, 1.0))]);
    assert!(end.is_vacuum());
    let others = [
        MaterialDescription {
            ior: 1.4,
            ..frosted.clone()
        },
        MaterialDescription {
            priority: 1,
            ..frosted.clone()
        },
        dielectric(1.5, 0.3, BLUE),
    ];
    for other in others {
        let (_, end) = straight(&block(other), start, Vec3::X, Interior::VACUUM);
        assert_eq!(end.solids(), [0]);
    }
}

/// A sphere by rings, facing outward.
fn sphere(centre: Vec3, radius: f64) -> Mesh {
    const RINGS: u32 = 48;
    let mut mesh = Mesh::default();
    let point = |ring: u32, spoke: u32| {
        let theta = PI * f64::from(ring) / f64::from(RINGS);
        let phi = PI * f64::from(spoke % (2 * RINGS)) / f64::from(RINGS);
        let across = radius * libm::sin(theta);
        let (x, z) = (across * libm::cos(phi), across * libm::sin(phi));
        centre + DVec3::new(x, radius * libm::cos(theta), z).as_vec3()
    };
    for ring in 0..RINGS {
        for spoke in 0..2 * RINGS {
            let first = mesh.positions.len() as u32;
            let corners = [(0, 0), (0, 1), (1, 1), (1, 0)];
            let corners = corners.map(|(r, s)| point(ring + r, spoke + s));
            mesh.positions.extend(corners);
            mesh.indices.push([first, first + 1, first + 2]);
            mesh.indices.push([first, first + 2, first + 3]);
        }
    }
    mesh
}

#[test]
fn overlapping_spheres_are_seen_by_priority() {
    let scene = Stage::new()
        .add(solid(1.33, 0, BLUE), sphere(Vec3::X, 1.0))
        .add(solid(1.5, 3, GREEN), sphere(Vec3::ZERO, 1.0))
        .build();
    // off the axis by (0.1, 0.15): half the chord of either sphere
    let half = (1.0 - 0.1_f64.powi(2) - 0.15_f64.powi(2)).sqrt();
    let start = Vec3::new(-3.0, 0.1, 0.15);
    let (seen, end) = straight(&scene, start, Vec3::X, Interior::VACUUM);
    assert!(end.is_vacuum());
    let materials: Vec<u32> = seen.iter().map(|s| s.0).collect();
    assert_eq!(materials, [GLASS, GLASS, WATER]);
    for ((_, distance, transmittance), (length, color)) in
        seen[1..].iter().zip([(2.0 * half, GREEN), (1.0, BLUE)])
    {
        assert!((distance - length).abs() < 0.005, "{distance}");
        assert_near(*transmittance, beer(color, *distance as f32));
    }
}

#[test]
fn what_lies_within_a_higher_solid_is_hidden() {
    let stage = Stage::new()
        .add(solid(1.33, 0, BLUE), slab(1.0, 2.0))
        .add(solid(1.5, 1, GREEN), slab(0.0, 4.0))
        // met within both: a wall that is no solid is seen
        .add(grey(0.5), rectangle(Vec3::X * 1.5, Vec3::Y, Vec3::Z));
    let (seen, end) = straight(&stage.build(), AXIS - Vec3::X, Vec3::X, Interior::VACUUM);
    let expected = [
        (1, 1.0, Spectrum::ONE),
        (2, 1.5, beer(GREEN, 1.5)),
        (1, 2.5, beer(GREEN, 2.5)),
    ];
    assert_seen(&seen, &expected);
    assert!(end.is_vacuum());
}

/// Where interfaces coincide, passing the hidden one does not skip the other.
#[test]
fn coinciding_interfaces_are_all_crossed() {
    for swapped in [false, true] {
        let add = |stage: Stage, low: bool| {
            let (priority, color) = if low { (0, BLUE) } else { (1, GREEN) };
            stage.add(
                solid(1.4, priority, color),
                slab(if low { 1.0 } else { 0.0 }, 3.0),
            )
        };
        let scene = add(add(Stage::new(), swapped), !swapped).build();
        for direction in [Vec3::X, Vec3::NEG_X] {
            let start = AXIS + Vec3::X * 1.5 - direction * 5.0;
            let (_, end) = straight(&scene, start, direction, Interior::VACUUM);
            assert!(end.solids().len() <= 1, "{swapped} {direction}: {end:?}");
        }
    }
}

/// Snell's law at the interface of glass and water, from both sides.
#[test]
fn an_interface_bends_by_both_solids() {
    let scene = overlapping();
    for (from, along, ratio) in [(0.5, 1.0_f32, 1.5 / 1.33), (3.0, -1.0, 1.33 / 1.5)] {
        let direction = DVec3::new(f64::from(along), 0.3, 0.0).normalize();
        let origin = Vec3::X * from;
        let mut interior = scene.matter.interior_at(origin.as_dvec3());
        let ray = Ray::new(origin, direction.as_vec3());
        let (vertex, _) = meet(&scene, &ray, &mut interior, 0.5).expect("the interface");
        assert!((vertex.position.x - 2.0).abs() < 1e-6);
        let bsdf = scene.bsdf(&vertex, &wavelengths(), &interior);
        let wo = vertex.frame.to_local(-direction);
        let passes = (0..100).find_map(|i| {
            let uc = (f64::from(i) + 0.5) / 100.0;
            let sample = bsdf.sample(wo, uc, [0.5; 2], Mode::Radiance)?;
            sample.transmitted.then_some(sample)
        });
        let sample = passes.expect("most of it passes");
        let bent = vertex.frame.to_world(sample.wi);
        assert!(
            (bent.y - direction.y * ratio).abs() < 1e-6,
            "{bent} {ratio}"
        );
        assert!(bent.x * f64::from(along) > 0.0);
        let beyond = scene.interior_toward(&vertex, &interior, -direction, bent);
        assert_eq!(beyond.solids().len(), if along > 0.0 { 1 } else { 2 });
    }
}

#[test]
fn a_slab_attenuates_by_its_colour_to_the_distance() {
    for (attenuation_distance, thickness) in [(1.0_f32, 0.25_f32), (2.5, 3.0), (0.1, 0.05)] {
        let mut glass = solid(1.5, 0, GREEN);
        if let Some(volume) = &mut glass.volume {
            volume.attenuation_distance = attenuation_distance;
        }
        let stage = Stage::new().add(glass, slab(0.0, thickness));
        let (seen, _) = straight(&stage.build(), AXIS - Vec3::X, Vec3::X, Interior::VACUUM);
        assert_eq!(seen.len(), 2);
        assert_near(seen[1].2, beer(GREEN, thickness / attenuation_distance));
    }
}

/// Within a solid, past an interface that another hides, partly transparent surfaces still
/// let through what they let through outside.
#[test]
fn alpha_counts_behind_hidden_interfaces() {
    let veil = blended(grey(0.5), 0.3);
    let scene = Stage::new()
        .add(solid(1.33, 0, BLUE), slab(1.0, 2.0))
        .add(solid(1.5, 1, GREEN), slab(0.0, 4.0))
        .add(veil, rectangle(Vec3::X * 3.0, Vec3::Y, Vec3::Z))
        .build();
    let ray = Ray::new(AXIS + Vec3::X * 0.5, Vec3::X);
    let inside = Interior::VACUUM.with(1);
    let stopped = (0..1000).filter(|i| {
        let u = (f64::from(*i) + 0.5) / 1000.0;
        let (vertex, _) = meet(&scene, &ray, &mut { inside }, u).expect("a surface");
        vertex.material == 2
    });
    assert_eq!(stopped.count(), 300);
    let short = Ray { t_max: 3.0, ..ray };
    assert!((passed_share(&scene, &short, &inside) - 0.7).abs() < 1e-6);
}

/// Glass from 0 to 2 and glass from 1 to 4, of one material.
fn of_one_material() -> Scene {
    Stage::new()
        .add(solid(1.5, 0, GREEN), slab(0.0, 2.0))
        .and(slab(1.0, 4.0))
        .build()
}

/// Objects of one material that overlap are one solid, from whichever side and wherever a walk begins.
#[test]
fn overlapping_objects_of_one_material_are_one() {
    let scene = of_one_material();
    for (start, direction) in [(-1.0, Vec3::X), (5.0, Vec3::NEG_X)] {
        let (seen, end) = straight(&scene, AXIS + Vec3::X * start, direction, Interior::VACUUM);
        let expected = [(0, 1.0, Spectrum::ONE), (0, 4.0, beer(GREEN, 4.0))];
        assert_seen(&seen, &expected);
        assert!(end.is_vacuum());
    }
    let within = |x: f32| scene.matter.interior_at((AXIS + Vec3::X * x).as_dvec3());
    assert_eq!([0.5, 1.5, 3.0].map(|x| within(x).times(0)), [1, 2, 1]);
    for (x, direction, left) in [
        (1.5, Vec3::X, 2.5),
        (1.5, Vec3::NEG_X, 1.5),
        (0.5, Vec3::X, 3.5),
    ] {
        let (seen, end) = straight(&scene, AXIS + Vec3::X * x, direction, within(x));
        assert_seen(&seen, &[(0, left, beer(GREEN, left as f32))]);
        assert!(end.is_vacuum());
    }
    // What is joined within is joined, what is beyond the last interface is not.
    let passed = |from: f32, to: f32| {
        let ray = Ray {
            t_max: (to - from).abs(),
            ..Ray::new(AXIS + Vec3::X * from, Vec3::X * (to - from).signum())
        };
        passed_share(&scene, &ray, &within(from))
    };
    for (from, to, share) in [
        (0.5, 3.5, 1.0_f32),
        (3.5, 0.5, 1.0),
        (1.5, 1.6, 1.0),
        (0.5, 4.5, 0.0),
        (1.5, -0.5, 0.0),
        (-0.5, 0.5, 0.0),
    ] {
        assert_eq!(passed(from, to).to_bits(), share.to_bits(), "{from} {to}");
    }
}
