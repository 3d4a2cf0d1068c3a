use kaustik_path::{
    Bidirectional, BuilderSettings, Endpoint, Form, Heuristic, LightTracing, Multiplexed,
    PathBuilder, Techniques, Unidirectional,
};
use kaustik_scene::testing::{Stage, compile, floor, grey};
use kaustik_scene::{Scene, builtin};
use kaustik_spectrum::Illuminant;

use crate::estimate::{Estimate, image_means};

/// X + Y + Z of a white emission of strength 1.
pub(crate) fn white() -> f64 {
    kaustik_spectrum::integrate_xyz(|nm| f64::from(Illuminant::D65.at(nm as f32)))
        .iter()
        .sum()
}

/// The mean image of each builder that keeps to paths of at most so many edges.
fn means(scene: &Scene, max_edges: u32, samples: u32) -> Vec<(&'static str, Estimate)> {
    let settings = BuilderSettings {
        max_edges,
        ..BuilderSettings::default()
    };
    let walk = |next_event| Unidirectional {
        settings,
        next_event,
    };
    let joined = |form, heuristic| {
        Box::new(Bidirectional {
            settings,
            form,
            heuristic,
        })
    };
    let multiplexed = Multiplexed::new(
        *joined(Form::Full, Heuristic::Power),
        Techniques::even(1, max_edges, false),
    );
    let builders: [(&str, Box<dyn PathBuilder>); 9] = [
        ("next event", Box::new(walk(true))),
        ("implicit hits", Box::new(walk(false))),
        ("endpoint", Box::new(Endpoint { settings })),
        ("full, power", joined(Form::Full, Heuristic::Power)),
        ("full, balance", joined(Form::Full, Heuristic::Balance)),
        ("full, maximum", joined(Form::Full, Heuristic::Maximum)),
        ("simple", joined(Form::Simple, Heuristic::Power)),
        ("multiplexed", Box::new(multiplexed)),
        ("light", Box::new(LightTracing { settings })),
    ];
    builders
        .into_iter()
        .map(|(name, builder)| (name, image_means(scene, &*builder, samples, 5)[0]))
        .collect()
}

/// In a closed room that emits 1/2 and reflects 1/2, the paths of up to k edges bring 1 - 2^-k.
#[test]
fn each_edge_of_a_furnace_brings_its_share() {
    let scene = compile(&builtin::load("furnace?kind=diffuse").expect("a built-in scene"));
    let mut share = 1.0;
    for max_edges in 1..=5 {
        share *= 0.5;
        let expected = (1.0 - share) * white();
        for (name, estimate) in means(&scene, max_edges, 16_000) {
            assert!(
                estimate.holds(expected),
                "{name}, {max_edges}: {estimate:?}, expected {expected}"
            );
            assert!(estimate.error() < 0.02 * expected, "{name}: {estimate:?}");
        }
    }
}

/// The sky behind everything is one edge away, its light on a surface two.
#[test]
fn the_sky_counts_as_an_emitter() {
    let wall = grey(0.5);
    let stage = Stage::new().look_at(glam::Vec3::new(0.0, 2.0, 0.01), glam::Vec3::ZERO, 1.0);
    let scene = stage.add(wall, floor(0.0, 0.5)).sky(1.0).build();
    // the plate's share of the window on the plane at its distance
    let half_window = 2.0 * 0.5_f64.tan();
    let covered = 1.0 / (4.0 * half_window * half_window);
    for (max_edges, plate) in [(1, 0.0), (2, 0.5), (3, 0.5)] {
        let expected = (1.0 - covered + covered * plate) * white();
        for (name, estimate) in means(&scene, max_edges, 16_000) {
            // a light walk never shows the sky itself
            let expected = match name {
                "light" => covered * plate * white(),
                _ => expected,
            };
            let tolerance = 4.5 * estimate.error() + 1e-3 * expected;
            assert!(
                (estimate.mean - expected).abs() <= tolerance,
                "{name}, {max_edges}: {estimate:?}, expected {expected}"
            );
        }
    }
}
