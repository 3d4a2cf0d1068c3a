use glam::Vec3;
use kaustik_mcmc::{Exponential, Independent, Mean, Point, Step, generator};
use kaustik_path::{
    Bidirectional, BuilderSettings, Class, Contributions, Form, Heuristic, PathBuilder,
    PureSpecular, ScalarTarget, Sighting, Unidirectional, Unjoined, sight, sight_branches,
};
use kaustik_pss::{Coordinates, Recording, Stream};
use kaustik_scene::testing::{Stage, ceiling, compile, cuboid, dielectric, diffuse, floor, lamp};
use kaustik_scene::{Scene, builtin};

use crate::scenes::SCENES;

const POINTS: u64 = 1_500;

fn scenes() -> impl Iterator<Item = (String, Scene)> {
    let words = [
        "glass-cube",
        "water-cornell?light=0.8",
        "ring-and-sphere",
        "furnace?kind=glass",
        "furnace?kind=rough",
        "disco",
        "cornell",
    ];
    let built_in = words.map(|words| {
        let scene = compile(&builtin::load(words).expect("a built-in scene"));
        (words.to_owned(), scene)
    });
    let by_code = SCENES.map(|(name, stage)| (name.to_owned(), stage().build()));
    built_in.into_iter().chain(by_code)
}

/// Light is sighted where the full form has something in class 0, and nowhere else; much of such light is of paths that
/// other strategies make as well, which have a class of their own.
#[test]
fn what_is_sighted_is_what_the_full_form_finds() {
    let mut out = Contributions::default();
    let (mut found, mut joined) = (0, 0);
    for (name, scene) in scenes() {
        let all = [1, 2, 4].map(|min_edges| (min_edges, PureSpecular::Kept));
        for (min_edges, pure_specular) in all.into_iter().chain([(2, PureSpecular::LeftOut)]) {
            let settings = BuilderSettings {
                min_edges,
                max_edges: 12,
                pure_specular,
                ..BuilderSettings::default()
            };
            let full = Bidirectional {
                settings,
                form: Form::Full,
                heuristic: Heuristic::Power,
            };
            let mut source = Independent::new(generator(17, u64::from(min_edges)));
            for point in 0..POINTS {
                let mut recording = Recording::new(&mut source);
                full.build(&scene, &mut recording, &mut out);
                let mut recorded = recording.finish();
                let classes = out.by_class(ScalarTarget::Xyz);
                let light = classes[Class::L0 as usize];
                let sighting = sight(&settings, &scene, &mut recorded);
                let place = format!("{name}, {settings:?}, point {point}");
                let sees = sighting == Sighting::Light;
                assert_eq!(light > 0.0, sees, "{place}: {light}");
                found += u32::from(sees);
                joined += u32::from(classes[Class::L0Joined as usize] > 0.0);
                // a look reads nothing that the evaluation has not read
                assert_eq!(recorded.missing(), None, "{place}");
            }
        }
    }
    assert!(found > 300 && joined > 300, "only {found}, {joined}");
}

/// Heuristics leave all of what nothing else finds to the walk that runs into it: a path tracer without next event
/// brings the same. Of the rest they give some away.
#[test]
fn what_cannot_be_joined_has_the_weight_one() {
    let (mut full_form, mut plain) = (Contributions::default(), Contributions::default());
    let [mut alone, mut less, mut more] = [0; 3];
    for (name, scene) in scenes() {
        // what falls on the lens by chance is of all paths
        if scene.camera().has_aperture() {
            continue;
        }
        let settings = BuilderSettings {
            max_edges: 12,
            ..BuilderSettings::default()
        };
        let full = Bidirectional {
            settings,
            form: Form::Full,
            heuristic: Heuristic::Power,
        };
        let path = Unidirectional {
            settings,
            next_event: false,
        };
        let mut source = Independent::new(generator(21, 0));
        for point in 0..POINTS {
            let mut recording = Recording::new(&mut source);
            full.build(&scene, &mut recording, &mut full_form);
            let mut recorded = recording.finish();
            path.build(&scene, &mut recorded, &mut plain);
            let both = [&full_form, &plain].map(|out| out.by_class(ScalarTarget::Xyz));
            let [one, other] = both.map(|classes| classes[Class::L0 as usize]);
            let place = format!("{name}, point {point}");
            assert!(
                (one - other).abs() <= 1e-5 * other,
                "{place}: {one} {other}"
            );
            alone += u32::from(one > 0.0);
            let [one, other] = both.map(|classes| classes[Class::L0Joined as usize]);
            assert!(one <= 1.000_01 * other, "{place}: {one} {other}");
            less += u32::from(one < 0.99 * other);
            more += u32::from(other > 0.0);
        }
    }
    assert!(alone > 300 && less > 100, "{alone} alone; {less} of {more}");
}

/// The walk from the camera alone brings what the full form has in class 0, and nothing else. It reads no coordinate that the
/// full form does not read, and none of a light's walk or of a connection.
#[test]
fn the_walk_alone_brings_what_cannot_be_joined() {
    let (mut whole, mut alone) = (Contributions::default(), Contributions::default());
    let mut found = 0;
    for (name, scene) in scenes() {
        for (min_edges, pure_specular) in [
            (1, PureSpecular::Kept),
            (4, PureSpecular::Kept),
            (2, PureSpecular::LeftOut),
        ] {
            let settings = BuilderSettings {
                min_edges,
                max_edges: 12,
                pure_specular,
                ..BuilderSettings::default()
            };
            let full = Bidirectional {
                settings,
                form: Form::Full,
                heuristic: Heuristic::Power,
            };
            let walk = Unjoined { settings };
            let mut source = Independent::new(generator(23, u64::from(min_edges)));
            for point in 0..POINTS {
                let mut recording = Recording::new(&mut source);
                full.build(&scene, &mut recording, &mut whole);
                let mut recorded = recording.finish();
                let mut reading = Recording::new(&mut recorded);
                walk.build(&scene, &mut reading, &mut alone);
                let read = reading.finish();
                let place = format!("{name}, {settings:?}, point {point}");
                let wanted: Vec<_> = (whole.splats().iter())
                    .filter(|splat| splat.class == Class::L0)
                    .collect();
                assert_eq!(wanted.len(), alone.splats().len(), "{place}");
                for (one, other) in wanted.into_iter().zip(alone.splats()) {
                    assert_eq!(
                        (one.raster, other.class),
                        (other.raster, Class::L0),
                        "{place}"
                    );
                    let near = |(a, b): (&f32, &f32)| (a - b).abs() <= 1e-5 * one.xyz.sum();
                    let alike = one.xyz.0.iter().zip(&other.xyz.0).all(near);
                    assert!(alike, "{place}: {:?} {:?}", one.xyz, other.xyz);
                    found += 1;
                }
                assert_eq!(recorded.missing(), None, "{place}");
                let still = [Stream::Light, Stream::Connection, Stream::Technique];
                let other = read.iter().find(|(stream, ..)| still.contains(stream));
                assert_eq!(other, None, "{place}");
            }
        }
    }
    assert!(found > 300, "only {found}");
}

/// Walks from the light fall on a lens with area: the full form gives them their part of what the walk alone brings whole.
#[test]
fn a_lens_with_area_takes_a_part() {
    let slab = cuboid(Vec3::new(-1.5, 0.4, -1.5), Vec3::new(1.5, 0.8, 1.5));
    let scene = Stage::new()
        .look_at(Vec3::new(0.3, 3.0, 2.0), Vec3::ZERO, 0.8)
        .lens(0.4, 3.0)
        .add(diffuse([0.6; 3]), floor(0.0, 6.0))
        .add(dielectric(1.5, 0.0, [1.0; 3]), slab)
        .add(lamp(9.0), ceiling(Vec3::new(0.5, 2.5, -1.0), 0.2))
        .build();
    let settings = BuilderSettings::default();
    let full = Bidirectional {
        settings,
        form: Form::Full,
        heuristic: Heuristic::Power,
    };
    let (mut whole, mut alone) = (Contributions::default(), Contributions::default());
    let mut source = Independent::new(generator(27, 0));
    let [mut found, mut less] = [0; 2];
    for _ in 0..40 * POINTS {
        let mut recording = Recording::new(&mut source);
        full.build(&scene, &mut recording, &mut whole);
        Unjoined { settings }.build(&scene, &mut recording.finish(), &mut alone);
        let both = [&whole, &alone].map(|out| out.by_class(ScalarTarget::Xyz));
        let [shared, light] = both.map(|classes| classes[Class::L0 as usize]);
        if light > 0.0 {
            assert!(shared <= 1.000_01 * light, "{shared} {light}");
            found += 1;
            less += u32::from(shared < 0.9 * light);
        }
    }
    assert!(found > 20 && less > found / 2, "{less} of {found}");
}

#[test]
fn a_scene_without_dirac_surfaces_is_plain() {
    let scene = compile(&builtin::load("cornell").expect("a built-in scene"));
    let mut source = Independent::new(generator(18, 0));
    for _ in 0..POINTS {
        let settings = BuilderSettings::default();
        let sighting = sight(&settings, &scene, &mut source);
        assert_eq!(sighting, Sighting::Plain);
    }
}

/// What a look along so many branches has found of each stretch: up to the first parting, and past it.
fn found(scene: &Scene, full: &Bidirectional, branches: u32, u: &mut dyn Coordinates) -> [f64; 2] {
    let (mut out, mut found) = (Contributions::default(), [0.0; 2]);
    sight_branches(&full.settings, scene, branches, u, &mut |find| {
        let part = Bidirectional {
            settings: find.settings,
            ..*full
        };
        part.build(scene, find.u, &mut out);
        let light = out.by_class(ScalarTarget::Xyz)[Class::L0 as usize];
        assert!(light > 0.0, "{:?}", find.settings);
        let parted = find.settings.min_edges > full.settings.min_edges;
        found[usize::from(parted)] += find.weight * light;
    });
    found
}

/// With purely specular paths where the shortest have one edge: with those that are one edge long, all are.
fn full(min_edges: u32) -> Bidirectional {
    let pure_specular = match min_edges {
        1 => PureSpecular::Kept,
        _ => PureSpecular::LeftOut,
    };
    Bidirectional {
        settings: BuilderSettings {
            min_edges,
            max_edges: 12,
            pure_specular,
            ..BuilderSettings::default()
        },
        form: Form::Full,
        heuristic: Heuristic::Power,
    }
}

/// A single way finds what the full form has at the same point, stretch by stretch.
#[test]
fn a_single_way_is_the_walk_itself() {
    let mut out = Contributions::default();
    let mut met = [0; 2];
    let lamp = ["water-cornell?light=1.9", "glass-cube?light=1.9"];
    let large = lamp.map(|words| {
        let scene = compile(&builtin::load(words).expect("a built-in scene"));
        (words.to_owned(), scene)
    });
    let few = scenes().map(|named| (named, POINTS));
    for ((name, scene), points) in few.chain(large.map(|named| (named, 8 * POINTS))) {
        for min_edges in [1, 3, 6] {
            let full = full(min_edges);
            let mut source = Independent::new(generator(19, u64::from(min_edges)));
            for point in 0..points {
                let mut recording = Recording::new(&mut source);
                full.build(&scene, &mut recording, &mut out);
                let mut recorded = recording.finish();
                let wanted = out.by_class(ScalarTarget::Xyz)[Class::L0 as usize];
                let parts = found(&scene, &full, 1, &mut recorded);
                let place = format!("{name}, {min_edges} edges at least, point {point}");
                let off = (parts[0] + parts[1] - wanted).abs();
                assert!(off <= 1e-5 * wanted, "{place}: {parts:?} {wanted}");
                for (met, part) in met.iter_mut().zip(parts) {
                    *met += u32::from(part > 0.0);
                }
                assert_eq!(recorded.missing(), None, "{place}");
            }
        }
    }
    assert!(met.iter().all(|&met| met > 30), "{met:?}");
}

/// Ways have the mean of the walk, and a smaller spread.
#[test]
fn ways_have_the_mean_of_the_walk() {
    const LOOKS: usize = 150_000;
    let scene = compile(&builtin::load("water-cornell?light=1.9").expect("a built-in scene"));
    let full = full(1);
    let mean = |branches: u32, counts: f64| -> Mean {
        let mut draws = generator(20, u64::from(branches));
        let mut point = Point::new(Exponential::default());
        let one = |_| {
            let mut u = point.propose(Step::Large, &mut draws);
            let [beginning, parted] = found(&scene, &full, branches, &mut u);
            u.reject();
            beginning + counts * parted
        };
        (0..LOOKS).map(one).collect()
    };
    let (one, eight) = (mean(1, 1.0), mean(8, 1.0));
    let off = |branches: &Mean| {
        let error = one.standard_error().hypot(branches.standard_error());
        (branches.mean() - one.mean()).abs() / error
    };
    assert!(off(&eight) < 4.0, "{one:?} {eight:?}");
    assert!(eight.variance() < 0.3 * one.variance(), "{one:?} {eight:?}");
    // The test of the test.
    let wrong = mean(8, 1.3);
    assert!(off(&wrong) > 4.0, "{one:?} {wrong:?}");
}
