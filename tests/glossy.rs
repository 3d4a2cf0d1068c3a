//! Long paths between glossy surfaces: the product of their scattering goes beyond single precision.

use glam::Vec3;
use kaustik::geometry::Mesh;
use kaustik::scene::Scene;
use kaustik::scene::description::MaterialDescription;
use kaustik::{Control, Method, RenderSettings, Starts, render};

use crate::scale::scaled;
use crate::support::{compile, describe, means, settings};

const SIDE: u32 = 8;

/// The faces of a box around the origin, seen from within, `half` wide each way; the last faces down.
fn faces(half: f32) -> [Mesh; 6] {
    let (x, y, z) = (Vec3::X, Vec3::Y, Vec3::Z);
    [
        (x, y, z),
        (-x, z, y),
        (z, x, y),
        (-z, y, x),
        (-y, x, z),
        (y, z, x),
    ]
    .map(|(out, a, b)| Mesh {
        positions: vec![out - a - b, out - a + b, out + a + b, out + a - b]
            .into_iter()
            .map(|at| at * half)
            .collect(),
        indices: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    })
}

/// A closed room of bright metal with narrow lobes, a lamp under its ceiling, as many units wide.
fn room(unit: f32) -> Scene {
    let metal = MaterialDescription {
        metallic: 1.0,
        roughness: 0.1,
        base_color: [0.97, 0.97, 0.97, 1.0],
        ..MaterialDescription::default()
    };
    let lamp = MaterialDescription {
        emissive: [5.0; 3],
        base_color: [0.0, 0.0, 0.0, 1.0],
        double_sided: true,
        ..MaterialDescription::default()
    };
    let [.., mut ceiling] = faces(0.4);
    for at in &mut ceiling.positions {
        at.y += 0.5;
    }
    let walls = faces(1.0).into_iter().map(|mesh| (metal.clone(), mesh));
    let things = walls.chain([(lamp, ceiling)]);
    let description = describe(Vec3::new(0.1, -0.2, 0.9), 1.2, things);
    compile(&scaled(&description, unit), SIDE)
}

/// Green of the whole picture over seeds: mean and standard error. Nothing may have been left out.
fn brightness(scene: &Scene, settings: &RenderSettings) -> (f64, f64) {
    let found: Vec<f64> = (0..8)
        .map(|seed| {
            let settings = RenderSettings {
                seed,
                max_depth: 48,
                ..settings.clone()
            };
            let rendered = render(scene, &settings, &mut Control::default()).expect("a render");
            let left_out = rendered.statistics.nonfinite;
            assert_eq!(left_out, 0, "{}, seed {seed}", settings.method);
            means(&rendered.image)[1]
        })
        .collect();
    let n = found.len() as f64;
    let mean = found.iter().sum::<f64>() / n;
    let squares: f64 = found.iter().map(|x| (x - mean).powi(2)).sum();
    (mean, (squares / (n - 1.0) / n).sqrt())
}

/// Methods on paths multiply BSDF values, not throughputs: these have no bound, and light that overflowed was lost. They
/// divide by squares of lengths as well, which are small here.
#[test]
fn long_glossy_paths_do_not_overflow() {
    as_bright_as_by_path(1e-4);
}

#[test]
#[ignore = "long"]
fn long_glossy_paths_do_not_overflow_in_any_unit() {
    for unit in [1.0, 1e-4, 1e4] {
        as_bright_as_by_path(unit);
    }
}

fn as_bright_as_by_path(unit: f32) {
    let scene = room(unit);
    let (expected, noise) = brightness(&scene, &settings(Method::Path, SIDE, 256));
    assert!(noise < 0.02 * expected, "{noise} of {expected}");
    let mut both = settings(Method::Erpt, SIDE, 8);
    both.options.seeds = Starts::Bidirectional;
    for (name, settings) in [
        ("mlt", settings(Method::Mlt, SIDE, 128)),
        ("erpt", settings(Method::Erpt, SIDE, 32)),
        ("erpt from both sides", both),
    ] {
        let (found, error) = brightness(&scene, &settings);
        let error = error.hypot(noise);
        assert!(error < 0.06 * expected, "{name}: {error} of {expected}");
        assert!(
            (found - expected).abs() < 4.0 * error,
            "{name}, {unit}: {found} +- {error}, not {expected}"
        );
    }
}
