use kaustik_mcmc::{Independent, generator};
use kaustik_path::{
    Bidirectional, BuilderSettings, Contributions, Endpoint, Form, Heuristic, LightTracing,
    Multiplexed, PathBuilder, PureSpecular, Techniques, Unidirectional,
};
use kaustik_pss::Recording;
use kaustik_scene::Scene;

use crate::scenes::SCENES;

/// Paths up to so many edges are the short ones.
const SHORT: u32 = 2;
const EDGES: u32 = 7;
const POINTS: u32 = 400;

type Make = fn(BuilderSettings) -> Box<dyn PathBuilder>;

fn joined(settings: BuilderSettings, form: Form) -> Bidirectional {
    Bidirectional {
        settings,
        form,
        heuristic: Heuristic::Power,
    }
}

const BUILDERS: [(&str, Make); 7] = [
    ("next event", |settings| {
        Box::new(Unidirectional {
            settings,
            next_event: true,
        })
    }),
    ("implicit hits", |settings| {
        Box::new(Unidirectional {
            settings,
            next_event: false,
        })
    }),
    ("endpoint", |settings| Box::new(Endpoint { settings })),
    ("simple", |settings| {
        Box::new(joined(settings, Form::Simple))
    }),
    ("full", |settings| Box::new(joined(settings, Form::Full))),
    ("light", |settings| Box::new(LightTracing { settings })),
    ("multiplexed", |settings| {
        // The same choices whatever is left out.
        let techniques = Techniques::even(1, EDGES, true);
        Box::new(Multiplexed::new(joined(settings, Form::Full), techniques))
    }),
];

/// Light of a point, and light times a function of the place that it falls on.
fn light(out: &Contributions) -> [f64; 2] {
    out.splats().iter().fold([0.0; 2], |[sum, placed], splat| {
        let value = f64::from(splat.xyz.sum());
        let place = 1.0 + splat.raster.x + 3.0 * splat.raster.y;
        [sum + value, placed + value * place]
    })
}

/// Of all points: the largest difference between all paths and the sum of two parts, as a share of all, and how
/// many points have light in each part.
fn worst_of(scene: &Scene, all: &dyn PathBuilder, parts: [&dyn PathBuilder; 2]) -> (f64, [u32; 2]) {
    let mut source = Independent::new(generator(12, 0));
    let mut out = Contributions::default();
    let (mut worst, mut lit) = (0.0_f64, [0; 2]);
    for _ in 0..POINTS {
        let mut recording = Recording::new(&mut source);
        all.build(scene, &mut recording, &mut out);
        let mut point = recording.finish();
        let whole = light(&out);
        let parts = parts.map(|part| {
            part.build(scene, &mut point, &mut out);
            light(&out)
        });
        assert_eq!(point.missing(), None);
        for (i, whole) in whole.into_iter().enumerate() {
            let off: f64 = whole - parts[0][i] - parts[1][i];
            worst = worst.max(off.abs() / whole.max(1e-30));
        }
        for (lit, part) in lit.iter_mut().zip(parts) {
            *lit += u32::from(part[0] > 0.0);
        }
    }
    (worst, lit)
}

/// The same of the short and the long paths of a builder.
fn worst(scene: &Scene, make: Make, first_long: u32) -> (f64, [u32; 2]) {
    let of = |min_edges, max_edges| {
        make(BuilderSettings {
            min_edges,
            max_edges,
            ..BuilderSettings::default()
        })
    };
    let parts = [of(1, SHORT), of(first_long, EDGES)];
    worst_of(scene, &*of(1, EDGES), [&*parts[0], &*parts[1]])
}

/// Point by point: what is left out is what the short paths bring, no more and no less.
#[test]
fn short_and_long_paths_are_together_all() {
    let mut lit = [0; 2];
    for (name, stage) in SCENES {
        let scene = stage().build();
        for (builder, make) in BUILDERS {
            let (worst, found) = worst(&scene, make, SHORT + 1);
            assert!(worst < 1e-4, "{name}, {builder}: {worst}");
            lit = [lit[0] + found[0], lit[1] + found[1]];
        }
    }
    assert!(lit[0] > 3_000 && lit[1] > 3_000, "{lit:?}");
}

/// The test of the test: a length in both parts, or in neither.
#[test]
fn a_length_too_many_or_too_few_is_noticed() {
    let (_, stage) = SCENES[0];
    let scene = stage().build();
    let (_, other) = SCENES[1];
    let room = other().build();
    for (builder, make) in BUILDERS {
        for first_long in [SHORT, SHORT + 2] {
            let off = worst(&scene, make, first_long)
                .0
                .max(worst(&room, make, first_long).0);
            assert!(off > 1e-2, "{builder}, {first_long}: {off}");
        }
    }
}

/// The same of the paths that are not purely specular, and of what a walk finds that makes no others.
fn worst_of_pure(scene: &Scene, make: Make, first_edges: u32) -> (f64, [u32; 2]) {
    let settings = |min_edges, pure_specular| BuilderSettings {
        min_edges,
        max_edges: EDGES,
        pure_specular,
        ..BuilderSettings::default()
    };
    let all = make(settings(1, PureSpecular::Kept));
    let rest = make(settings(1, PureSpecular::LeftOut));
    let pure = Unidirectional {
        settings: settings(first_edges, PureSpecular::Alone),
        next_event: false,
    };
    worst_of(scene, &*all, [&*rest, &pure])
}

/// Builders whose walk from the eye goes as far as any, and which make purely specular paths by it alone.
const WALKERS: [usize; 3] = [0, 1, 4];

/// Point by point: what is left out is what a walk finds that goes on by mirrors and smooth glass alone, no more
/// and no less. (Where the lens has area, walks from a light find some of it as well.)
#[test]
fn purely_specular_and_other_paths_are_together_all() {
    let mut lit = [0; 2];
    for (name, stage) in SCENES {
        let scene = stage().build();
        if scene.camera().has_aperture() {
            continue;
        }
        for (builder, make) in WALKERS.map(|i| BUILDERS[i]) {
            let (worst, found) = worst_of_pure(&scene, make, 1);
            assert!(worst < 1e-4, "{name}, {builder}: {worst}");
            lit = [lit[0] + found[0], lit[1] + found[1]];
        }
    }
    assert!(lit[0] > 3_000 && lit[1] > 300, "{lit:?}");
}

/// The test of the test: what is seen directly in neither part.
#[test]
fn a_purely_specular_path_that_is_lost_is_noticed() {
    let off = SCENES.map(|(_, stage)| worst_of_pure(&stage().build(), BUILDERS[1].1, 2).0);
    assert!(off.into_iter().fold(0.0, f64::max) > 1e-2, "{off:?}");
}
