use glam::DVec2;
use kaustik_path::{
    Bidirectional, BuilderSettings, Endpoint, Form, Heuristic, LightTracing, Multiplexed,
    PathBuilder, Techniques, Unidirectional,
};
use kaustik_scene::Scene;
use kaustik_scene::testing::{Stage, ceiling, floor, grey, lamp};

use crate::estimate::{Estimate, REGIONS, image_means};
use crate::scenes::SCENES;

/// Enough edges for what matters, few enough for a quick test.
fn settings() -> BuilderSettings {
    BuilderSettings {
        max_edges: 12,
        ..BuilderSettings::default()
    }
}

fn path(settings: BuilderSettings) -> Unidirectional {
    Unidirectional {
        settings,
        next_event: true,
    }
}

/// Builders that are compared with the path tracer.
const OTHERS: usize = 7;

/// Level of one comparison, so that all of a run together reject the truth once in a hundred
/// times (Sidak).
fn level() -> f64 {
    let comparisons = (SCENES.len() + 2) * OTHERS * REGIONS;
    1.0 - 0.99_f64.powf(1.0 / comparisons as f64)
}

/// Regions in which two estimates of an image differ, and the error of what is compared.
fn compare(a: &[Estimate; REGIONS], b: &[Estimate; REGIONS]) -> (Vec<usize>, f64) {
    let differs = |region: &usize| a[*region].p_value(&b[*region]) < level();
    let error = (a[0].error().powi(2) + b[0].error().powi(2)).sqrt() / a[0].mean;
    ((0..REGIONS).filter(differs).collect(), error)
}

/// What a comparison takes.
#[derive(Clone, Copy)]
struct Effort {
    /// Samples of an image.
    samples: u32,
    /// So many multiplexed ones for each: they cost a fraction of the others, and show as much less.
    multiplexed: u32,
    /// The largest relative standard error with which a comparison means something.
    uncertainty: f64,
}

/// What speaks against agreement of the builders with the path tracer.
fn complaints(name: &str, scene: &Scene, settings: BuilderSettings, effort: Effort) -> Vec<String> {
    let samples = effort.samples;
    let path = image_means(scene, &path(settings), samples, 1);
    let joined = |form, heuristic| Bidirectional {
        settings,
        form,
        heuristic,
    };
    let lens = scene.camera().has_aperture();
    let multiplexed = Multiplexed::new(
        joined(Form::Full, Heuristic::Power),
        Techniques::even(1, settings.max_edges, lens),
    );
    let others: [(&str, &dyn PathBuilder); OTHERS] = [
        ("light", &LightTracing { settings }),
        ("endpoint", &Endpoint { settings }),
        ("full, power", &joined(Form::Full, Heuristic::Power)),
        ("full, balance", &joined(Form::Full, Heuristic::Balance)),
        ("full, maximum", &joined(Form::Full, Heuristic::Maximum)),
        ("simple", &joined(Form::Simple, Heuristic::Power)),
        ("multiplexed", &multiplexed),
    ];
    let mut complaints = Vec::new();
    for (method, builder) in others {
        let each = match method {
            "multiplexed" => effort.multiplexed,
            _ => 1,
        };
        let other = image_means(scene, builder, samples * each, 2);
        let (differing, error) = compare(&path, &other);
        if !differing.is_empty() {
            complaints.push(format!(
                "{name}: path and {method} differ in {differing:?}: {path:?} {other:?}"
            ));
        }
        if error > effort.uncertainty {
            complaints.push(format!("{name}, {method}: uncertain by {error}"));
        }
    }
    complaints
}

/// Every third scene, so that three tests share the processors.
fn assert_scenes(part: usize, effort: Effort) {
    let scenes = SCENES.iter().skip(part).step_by(3);
    let complaints: Vec<String> = scenes
        .flat_map(|(name, stage)| complaints(name, &stage().build(), settings(), effort))
        .collect();
    assert!(complaints.is_empty(), "{complaints:#?}");
}

const FAST: Effort = Effort {
    samples: 50_000,
    multiplexed: 8,
    uncertainty: 0.05,
};

#[test]
fn builders_agree_on_a_third_of_the_scenes() {
    assert_scenes(0, FAST);
}

#[test]
fn builders_agree_on_another_third() {
    assert_scenes(1, FAST);
}

#[test]
fn builders_agree_on_the_last_third() {
    assert_scenes(2, FAST);
}

const LONG: Effort = Effort {
    samples: 1_000_000,
    // in `overlapping solids` 8 leave 1.5 %
    multiplexed: 16,
    uncertainty: 0.012,
};

#[test]
#[ignore = "long"]
fn builders_agree_to_a_percent_on_a_third() {
    assert_scenes(0, LONG);
}

#[test]
#[ignore = "long"]
fn builders_agree_to_a_percent_on_another_third() {
    assert_scenes(1, LONG);
}

#[test]
#[ignore = "long"]
fn builders_agree_to_a_percent_on_the_last_third() {
    assert_scenes(2, LONG);
}

/// A filter that reaches over the edge draws from a larger window: all builders divide by it.
#[test]
fn builders_agree_on_a_larger_window() {
    let wide = BuilderSettings {
        window_min: DVec2::splat(-0.2),
        window_max: DVec2::new(1.1, 1.3),
        ..settings()
    };
    let (name, stage) = SCENES[6];
    let complaints = complaints(name, &stage().build(), wide, FAST);
    assert!(complaints.is_empty(), "{complaints:#?}");
}

fn plate(albedo: f32) -> Scene {
    Stage::new()
        .look_at(glam::Vec3::new(0.3, 3.0, 2.0), glam::Vec3::ZERO, 0.8)
        .add(grey(albedo), floor(0.0, 6.0))
        .add(lamp(4.0), ceiling(glam::Vec3::new(0.5, 2.5, -1.0), 0.7))
        .build()
}

/// The test of the test: an image four percent too bright is not the same.
#[test]
fn a_planted_error_is_rejected() {
    let light = LightTracing {
        settings: settings(),
    };
    let path = image_means(&plate(0.5), &path(settings()), 200_000, 1);
    let right = image_means(&plate(0.5), &light, 200_000, 2);
    let wrong = image_means(&plate(0.52), &light, 200_000, 2);
    assert!(compare(&path, &right).0.is_empty());
    assert!(!compare(&path, &wrong).0.is_empty());
}
