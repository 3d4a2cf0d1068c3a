use kaustik_mcmc::{Independent, generator};
use kaustik_path::{
    Beginning, Bidirectional, BuilderSettings, Class, Contributions, Form, Heuristic, PathBuilder,
    ScalarTarget, Sighting, sight,
};
use kaustik_pss::Recording;
use kaustik_scene::{Scene, builtin};

use crate::scenes::SCENES;
use crate::stage::compile;

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

/// Light is sighted where the full form has something in class 0, and nowhere else.
#[test]
fn what_is_sighted_is_what_the_full_form_finds() {
    let mut out = Contributions::default();
    let mut found = [0; 2];
    for (name, scene) in scenes() {
        for min_edges in [1, 2, 4] {
            let settings = BuilderSettings {
                min_edges,
                max_edges: 12,
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
                let light = out.by_class(ScalarTarget::Xyz)[Class::L0 as usize];
                let mut sees = |beginning| {
                    let seen = sight(&settings, &scene, beginning, &mut recorded);
                    seen == Sighting::Light
                };
                let place = format!("{name}, {min_edges} edges at least, point {point}");
                assert_eq!(light > 0.0, sees(Beginning::Any), "{place}: {light}");
                // each sees its own part
                let parts = [Beginning::Dirac, Beginning::Other].map(&mut sees);
                let seen = parts.into_iter().filter(|seen| *seen).count();
                assert_eq!(seen, usize::from(light > 0.0), "{place}: {parts:?}");
                for (found, seen) in found.iter_mut().zip(parts) {
                    *found += u32::from(seen);
                }
                // looks read nothing that the evaluation has not read
                assert_eq!(recorded.missing(), None, "{place}");
            }
        }
    }
    assert!(found.iter().all(|&found| found > 300), "only {found:?}");
}

#[test]
fn a_scene_without_dirac_surfaces_is_plain() {
    let scene = compile(&builtin::load("cornell").expect("a built-in scene"));
    let mut source = Independent::new(generator(18, 0));
    for _ in 0..POINTS {
        let settings = BuilderSettings::default();
        let sighting = sight(&settings, &scene, Beginning::Any, &mut source);
        assert_eq!(sighting, Sighting::Plain);
    }
}
