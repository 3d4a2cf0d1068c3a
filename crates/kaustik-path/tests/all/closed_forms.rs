use glam::Vec3;
use kaustik_path::{
    Bidirectional, BuilderSettings, Endpoint, Form, Heuristic, LightTracing, PathBuilder,
    Unidirectional,
};
use kaustik_scene::Scene;
use kaustik_scene::description::MaterialDescription;
use kaustik_scene::testing::{Stage, blended, cuboid, dielectric, floor, grey, lamp, rectangle};

use crate::estimate::{Estimate, image_means};
use crate::lengths::white;

const SAMPLES: u32 = 60_000;

fn builders() -> [(&'static str, Box<dyn PathBuilder>); 5] {
    let settings = BuilderSettings::default();
    let path = Unidirectional {
        settings,
        next_event: true,
    };
    let joined = |form| {
        Box::new(Bidirectional {
            settings,
            form,
            heuristic: Heuristic::Power,
        })
    };
    [
        ("path", Box::new(path)),
        ("endpoint", Box::new(Endpoint { settings })),
        ("full", joined(Form::Full)),
        ("simple", joined(Form::Simple)),
        ("light", Box::new(LightTracing { settings })),
    ]
}

fn mean(scene: &Scene, builder: &dyn PathBuilder) -> Estimate {
    image_means(scene, builder, SAMPLES, 9)[0]
}

/// Radiance within a medium is that outside times the square of the index.
#[test]
fn under_water_the_sky_is_brighter() {
    let water = dielectric(1.33, 0.0, [1.0; 3]);
    // narrow enough that no ray is trapped by total reflection
    let scene = Stage::new()
        .look_at(Vec3::new(0.1, 0.2, -0.1), Vec3::new(0.0, 0.1, -1.0), 0.5)
        .add(water, cuboid(Vec3::splat(-1.0), Vec3::splat(1.0)))
        .sky(1.0)
        .build();
    let expected = 1.33_f64.powi(2) * white();
    for (name, builder) in &builders()[..4] {
        let seen = mean(&scene, &**builder);
        assert!(seen.holds(expected), "{name}: {seen:?}, {expected}");
        assert!(seen.error() < 0.01 * expected, "{name}");
    }
}

fn view() -> Stage {
    Stage::new().look_at(Vec3::new(0.0, 3.0, 0.01), Vec3::ZERO, 0.8)
}

fn veil(opacity: f32, albedo: f32) -> MaterialDescription {
    blended(grey(albedo), opacity)
}

/// Before a lamp that fills the view, black veils leave the product of what each lets pass.
#[test]
fn veils_dim_what_is_behind_them() {
    let scene = view()
        .add(lamp(2.0), floor(0.0, 4.0))
        .add(veil(0.5, 0.0), floor(1.0, 3.0))
        .add(veil(0.2, 0.0), floor(1.0, 3.0))
        .add(veil(0.25, 0.0), floor(2.0, 3.0))
        .build();
    let expected = 2.0 * 0.5 * 0.8 * 0.75 * white();
    for (name, builder) in builders() {
        let seen = mean(&scene, &*builder);
        assert!(seen.holds(expected), "{name}: {seen:?}, {expected}");
        assert!(seen.error() < 0.02 * expected, "{name}: {seen:?}");
    }
}

/// A plate of opacity a, above black ground, is the mixture of a plate and of none; above a
/// grey floor, on which it also casts half a shadow, path and light still agree.
#[test]
fn a_half_transparent_plate_is_a_mixture() {
    // two edges: the sky's light on what is seen first, through the plate or not
    let settings = BuilderSettings {
        max_edges: 2,
        ..BuilderSettings::default()
    };
    let path = Unidirectional {
        settings,
        next_event: true,
    };
    let light = LightTracing { settings };
    let over = |ground: f32, opacity: f32| {
        view()
            .add(grey(ground), floor(0.0, 4.0))
            .add(veil(opacity, 0.9), rectangle(Vec3::Y, Vec3::Z, Vec3::X))
            .sky(1.0)
            .build()
    };
    let full = mean(&over(0.0, 1.0), &path).mean;
    for opacity in [0.3, 0.75] {
        for builder in [&path as &dyn PathBuilder, &light] {
            let seen = mean(&over(0.0, opacity), builder);
            let expected = f64::from(opacity) * full;
            let off = (seen.mean - expected).abs();
            assert!(
                off < 4.5 * seen.error() + 0.01 * expected,
                "{seen:?} {expected}"
            );
        }
        let scene = over(0.2, opacity);
        let (a, b) = (mean(&scene, &path), mean(&scene, &light));
        assert!(a.p_value(&b) > 1e-3, "{a:?} {b:?}");
    }
}
