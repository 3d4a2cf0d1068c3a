use glam::Vec3;
use kaustik_geometry::Mesh;
use kaustik_mcmc::{Independent, generator};
use kaustik_path::{
    Bidirectional, BuilderSettings, Class, Contributions, Form, Heuristic, PathBuilder,
    PureSpecular, Unidirectional,
};
use kaustik_pss::{Recording, Stream};
use kaustik_scene::testing::{Stage, ceiling, compile, cuboid, dielectric, lamp};
use kaustik_scene::{Scene, builtin};
use kaustik_spectrum::{Illuminant, Rgb, Spectrum, WavelengthSampling, Wavelengths, Xyz};

const PATH: Unidirectional = Unidirectional {
    settings: BuilderSettings {
        track_largest: false,
        min_edges: 1,
        pure_specular: PureSpecular::Kept,
        emitters_seen: true,
        max_edges: 64,
        wavelengths: WavelengthSampling::Hero,
        window_min: glam::DVec2::ZERO,
        window_max: glam::DVec2::ONE,
    },
    next_event: true,
};

/// A glass ball in uniform light; 20 / Abbe number of it.
fn sphere(dispersion: f32) -> Scene {
    let mut description = builtin::load("furnace?kind=glass").expect("a built-in scene");
    for material in &mut description.materials {
        material.dispersion = dispersion;
    }
    compile(&description)
}

/// A triangular prism lying across the view, in uniform light.
fn prism(dispersion: f32) -> Scene {
    let corner = |x: f32, y: f32, z: f32| Vec3::new(x, y, z);
    let mut positions = Vec::new();
    for x in [-1.0, 1.0] {
        positions.extend([
            corner(x, 0.0, -0.5),
            corner(x, 0.0, 0.5),
            corner(x, 0.9, 0.0),
        ]);
    }
    let indices = vec![
        [0, 1, 2],
        [3, 5, 4],
        [0, 3, 4],
        [0, 4, 1],
        [1, 4, 5],
        [1, 5, 2],
        [2, 5, 3],
        [2, 3, 0],
    ];
    let mesh = Mesh::new(positions, indices).expect("a prism");
    let mut glass = dielectric(1.6, 0.0, [1.0; 3]);
    glass.dispersion = dispersion;
    Stage::new()
        .look_at(Vec3::new(0.0, 0.5, 3.0), Vec3::new(0.0, 0.4, 0.0), 0.5)
        .add(glass, mesh)
        .sky(1.0)
        .build()
}

/// Mean colour of a scene with the standard error of each channel.
fn colour(scene: &Scene, samples: u32) -> [(f64, f64); 3] {
    let mut u = Independent::new(generator(3, 0));
    let mut out = Contributions::default();
    let (mut sum, mut squares) = ([0.0; 3], [0.0; 3]);
    for _ in 0..samples {
        PATH.build(scene, &mut u, &mut out);
        assert_eq!(out.nonfinite(), 0);
        let xyz = out.splats().iter().fold([0.0; 3], |sum: [f32; 3], splat| {
            [0, 1, 2].map(|i| sum[i] + splat.xyz.0[i])
        });
        let Rgb(rgb) = Xyz(xyz).into();
        for (i, value) in rgb.into_iter().map(f64::from).enumerate() {
            sum[i] += value;
            squares[i] += value * value;
        }
    }
    let count = f64::from(samples);
    [0, 1, 2].map(|i| {
        let mean: f64 = sum[i] / count;
        (mean, ((squares[i] / count - mean * mean) / count).sqrt())
    })
}

#[test]
fn uniform_light_stays_white_through_dispersive_glass() {
    for (name, scene) in [("sphere", sphere(0.7)), ("prism", prism(0.7))] {
        for (mean, error) in colour(&scene, 100_000) {
            assert!(error < 0.01, "{name}: {error}");
            assert!(
                (mean - 1.0).abs() < 4.5 * error + 2e-3,
                "{name}: {mean} +- {error}"
            );
        }
    }
}

/// The largest difference of two colours, each scaled to the sum 1.
fn distance(a: Xyz, b: Xyz) -> f32 {
    let (s, t) = (a.sum(), b.sum());
    (0..3)
        .map(|i| (a.0[i] / s - b.0[i] / t).abs())
        .fold(0.0, f32::max)
}

/// How many paths have the colour of their hero, and how many that of all their wavelengths.
fn heroes(scene: &Scene, samples: u32) -> (u32, u32) {
    let mut source = Independent::new(generator(4, 0));
    let mut out = Contributions::default();
    let (mut alone, mut together) = (0, 0);
    for _ in 0..samples {
        let mut recording = Recording::new(&mut source);
        PATH.build(scene, &mut recording, &mut out);
        let point = recording.finish();
        let u = point.value(Stream::Wavelength, 0).expect("wavelengths");
        let wavelengths = Wavelengths::sample(u, WavelengthSampling::Hero);
        let light = Illuminant::D65.eval(&wavelengths);
        let Some(splat) = out.splats().first() else {
            continue;
        };
        if distance(splat.xyz, wavelengths.hero_to_xyz(Spectrum::ONE)) < 1e-4 {
            alone += 1;
        } else {
            // reflection differs a little between wavelengths, too
            assert!(distance(splat.xyz, wavelengths.to_xyz(light)) < 0.05);
            together += 1;
        }
    }
    (alone, together)
}

#[test]
fn refracted_paths_count_with_their_hero_alone() {
    const SAMPLES: u32 = 5_000;
    let (alone, together) = heroes(&sphere(0.7), SAMPLES);
    assert!(alone > SAMPLES / 4, "{alone} {together}");
    assert!(together > SAMPLES / 8, "{alone} {together}");
    // without dispersion every path keeps its four
    let (alone, together) = heroes(&sphere(0.0), SAMPLES);
    assert!(
        alone == 0 && together > SAMPLES * 9 / 10,
        "{alone} {together}"
    );
}

/// Of splats of this class, how many have the colour of their hero, and how many another.
fn heroes_joined(scene: &Scene, class: Class, samples: u32) -> (u32, u32) {
    let builder = Bidirectional {
        settings: PATH.settings,
        form: Form::Full,
        heuristic: Heuristic::Balance,
    };
    let mut source = Independent::new(generator(6, 0));
    let mut out = Contributions::default();
    let (mut alone, mut together) = (0, 0);
    for _ in 0..samples {
        let mut recording = Recording::new(&mut source);
        builder.build(scene, &mut recording, &mut out);
        let point = recording.finish();
        let u = point.value(Stream::Wavelength, 0).expect("wavelengths");
        let wavelengths = Wavelengths::sample(u, WavelengthSampling::Hero);
        let hero = wavelengths.hero_to_xyz(Spectrum::ONE);
        for splat in out.splats().iter().filter(|splat| splat.class == class) {
            if distance(splat.xyz, hero) < 1e-4 {
                alone += 1;
            } else {
                together += 1;
            }
        }
    }
    (alone, together)
}

/// A rough dispersive plate hangs between lamp and lens: light that passes it by the very joint of two
/// walks counts with its hero alone, as all light does that comes through.
#[test]
fn a_dispersive_joint_leaves_the_hero_alone() {
    let plate = |dispersion| {
        let mut glass = dielectric(1.6, 0.5, [1.0; 3]);
        glass.dispersion = dispersion;
        let half = Vec3::new(2.0, 0.1, 2.0);
        Stage::new()
            .look_at(Vec3::new(0.3, -2.0, 0.1), Vec3::ZERO, 0.7)
            .add(glass, cuboid(-half, half))
            .add(lamp(5.0), ceiling(Vec3::new(0.2, 1.5, 0.1), 0.8))
            .build()
    };
    for class in [Class::L2, Class::L4, Class::L5] {
        let (alone, together) = heroes_joined(&plate(2.0), class, 3_000);
        assert!(alone > 300, "{class:?}: {alone} {together}");
        assert!(together == 0, "{class:?}: {alone} {together}");
        let (alone, together) = heroes_joined(&plate(0.0), class, 500);
        assert!(alone == 0 && together > 50, "{class:?}: {alone} {together}");
    }
}
