use std::collections::HashSet;

use kaustik_mcmc::{Independent, generator};
use kaustik_path::{
    Bidirectional, BuilderSettings, Contributions, Endpoint, Form, Heuristic, LightTracing,
    Multiplexed, PathBuilder, Techniques, Unidirectional,
};
use kaustik_pss::{Coordinates, Recorded, Recording, Stream};
use kaustik_scene::testing::compile;
use kaustik_scene::{Scene, builtin};
use kaustik_spectrum::WavelengthSampling;

use crate::scenes::SCENES;

/// Passes numbers on and refuses to give one twice.
struct Once<'a> {
    source: &'a mut dyn Coordinates,
    asked: HashSet<(Stream, u32)>,
    twice: Option<(Stream, u32)>,
}

impl<'a> Once<'a> {
    fn new(source: &'a mut dyn Coordinates) -> Self {
        Self {
            source,
            asked: HashSet::new(),
            twice: None,
        }
    }
}

impl Coordinates for Once<'_> {
    fn get(&mut self, stream: Stream, index: u32) -> f64 {
        if !self.asked.insert((stream, index)) {
            self.twice.get_or_insert((stream, index));
        }
        self.source.get(stream, index)
    }
}

fn builders() -> Vec<Box<dyn PathBuilder>> {
    let mut builders: Vec<Box<dyn PathBuilder>> = Vec::new();
    for wavelengths in [WavelengthSampling::Hero, WavelengthSampling::Single] {
        let settings = BuilderSettings {
            wavelengths,
            ..BuilderSettings::default()
        };
        builders.push(Box::new(LightTracing { settings }));
        builders.push(Box::new(Endpoint { settings }));
        for form in [Form::Full, Form::Simple] {
            builders.push(Box::new(Bidirectional {
                settings,
                form,
                heuristic: Heuristic::Power,
            }));
        }
        let full = Bidirectional {
            settings,
            form: Form::Full,
            heuristic: Heuristic::Power,
        };
        builders.push(Box::new(Multiplexed::new(
            full,
            Techniques::even(1, 8, true),
        )));
        for next_event in [false, true] {
            builders.push(Box::new(Unidirectional {
                settings,
                next_event,
            }));
        }
    }
    builders
}

/// All built-in scenes, with all values of what can be chosen in words, and those by code.
fn scenes() -> impl Iterator<Item = (String, Scene)> {
    let kinds = ["glass", "rough", "plate"].map(|kind| format!("furnace?kind={kind}"));
    let names = builtin::list().iter().map(|scene| scene.name.to_owned());
    let built_in = names.chain(kinds).map(|words| {
        let scene = compile(&builtin::load(&words).expect("a built-in scene"));
        (words, scene)
    });
    let by_code = SCENES.map(|(name, stage)| (name.to_owned(), stage().build()));
    built_in.chain(by_code)
}

const POINTS: u64 = 60;

#[test]
fn no_coordinate_is_read_twice() {
    let mut out = Contributions::default();
    for (name, scene) in scenes() {
        for (index, builder) in builders().iter().enumerate() {
            let mut source = Independent::new(generator(6, index as u64));
            for _ in 0..POINTS {
                let mut once = Once::new(&mut source);
                builder.build(&scene, &mut once, &mut out);
                assert_eq!(once.twice, None, "{name}, builder {index}");
            }
        }
    }
}

/// The test of the test.
#[test]
fn reading_twice_is_noticed() {
    let mut source = Recorded::new();
    let mut once = Once::new(&mut source);
    once.get2(Stream::Light, 3);
    assert_eq!(once.twice, None);
    once.get(Stream::Light, 4);
    assert_eq!(once.twice, Some((Stream::Light, 4)));
}

/// All numbers of a result, as bits.
fn bits(out: &Contributions) -> Vec<u64> {
    out.splats()
        .iter()
        .flat_map(|splat| {
            let raster = splat.raster.to_array().map(f64::to_bits);
            let colour = splat.xyz.0.map(|v| u64::from(v.to_bits()));
            raster.into_iter().chain(colour)
        })
        .collect()
}

#[test]
fn a_recorded_point_gives_the_same_bits() {
    let mut out = Contributions::default();
    let mut lit = 0;
    for (name, scene) in scenes() {
        for (index, builder) in builders().iter().enumerate() {
            let mut source = Independent::new(generator(8, index as u64));
            for _ in 0..POINTS {
                let mut recording = Recording::new(&mut source);
                builder.build(&scene, &mut recording, &mut out);
                let first = bits(&out);
                let mut point = recording.finish();
                for _ in 0..2 {
                    builder.build(&scene, &mut point, &mut out);
                    assert_eq!(bits(&out), first, "{name}, builder {index}");
                }
                assert_eq!(point.missing(), None, "{name}, builder {index}");
                lit += usize::from(!first.is_empty());
            }
        }
    }
    assert!(lit > 1000, "most of it must not be black: {lit}");
}
