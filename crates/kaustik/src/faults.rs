//! Renders some of whose contributions are not finite: planted by a builder around the method's own, which no
//! setting and no scene reaches.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use kaustik_path::{
    Bidirectional, Contributions, Event, Form, LightTracing, PathBuilder, Unidirectional,
};
use kaustik_pss::{Coordinates, Stream};
use kaustik_scene::Scene;
use kaustik_spectrum::Xyz;

use crate::beside::Beside;
use crate::beside::lamps::Lamps;
use crate::engine::Engine;
use crate::methods::annealing;
use crate::methods::builders::builder;
use crate::methods::builders::builder_settings;
use crate::methods::independent::IndependentEngine;
use crate::methods::pssmlt::PssmltEngine;
use crate::methods::relt::start::replica_builder;
use crate::sampling::cells::Cells;
use crate::sampling::stratified::mix;
use crate::{Budget, Method, RenderSettings, StepId, small};

/// What becomes of the contributions that chance picks.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Fault {
    /// They are not finite, or negative: one after the other.
    Spoilt,
    /// They are not there.
    Absent,
}

/// One contribution of so many is picked.
const RATE: u64 = 10_000;

/// A builder of whose contributions some are spoilt. Which ones follows from the coordinates, so that an
/// evaluation is a function of its point as ever.
struct Faulty<'a> {
    inner: Box<dyn PathBuilder + 'a>,
    fault: Fault,
    picked: Arc<AtomicU64>,
}

/// Mixes all coordinates that are read into one number.
struct Mixing<'a> {
    inner: &'a mut dyn Coordinates,
    hash: u64,
}

impl Mixing<'_> {
    fn see(&mut self, value: f64) {
        self.hash = mix(self.hash ^ value.to_bits());
    }
}

impl Coordinates for Mixing<'_> {
    fn get(&mut self, stream: Stream, index: u32) -> f64 {
        let value = self.inner.get(stream, index);
        self.see(value);
        value
    }

    fn get2(&mut self, stream: Stream, index: u32) -> [f64; 2] {
        let pair = self.inner.get2(stream, index);
        pair.into_iter().for_each(|value| self.see(value));
        pair
    }
}

impl PathBuilder for Faulty<'_> {
    fn build(&self, scene: &Scene, u: &mut dyn Coordinates, out: &mut Contributions) {
        let mut u = Mixing { inner: u, hash: 1 };
        self.inner.build(scene, &mut u, out);
        assert_eq!(out.nonfinite(), 0, "the scene is sound");
        let splats = out.splats().to_vec();
        let pick = |index: usize| mix(u.hash ^ index as u64);
        if !(0..splats.len()).any(|index| pick(index).is_multiple_of(RATE)) {
            return;
        }
        out.clear();
        for (index, splat) in splats.into_iter().enumerate() {
            let chance = pick(index);
            let mut xyz = splat.xyz;
            if chance.is_multiple_of(RATE) {
                self.picked.fetch_add(1, Ordering::Relaxed);
                if self.fault == Fault::Absent {
                    continue;
                }
                let [x, y, z] = xyz.0;
                xyz = Xyz(match chance / RATE % 4 {
                    0 => [x, f32::NAN, z],
                    1 => [x, y, f32::INFINITY],
                    2 => [f32::NEG_INFINITY, y, z],
                    _ => [x, -1.0, z],
                });
            }
            out.push(splat.raster, xyz, splat.class);
        }
    }
}

const SIDE: u32 = 32;
const METHODS: [Method; 6] = [
    Method::Path,
    Method::Light,
    Method::Bdpt,
    Method::Pssmlt,
    Method::Mmlt,
    Method::Annealing,
];

fn a_scene() -> Scene {
    small::scene("cornell", [SIDE; 2])
}

fn settings(method: Method) -> RenderSettings {
    let mut settings = RenderSettings {
        budget: Budget::PerPixel(100),
        max_depth: 8,
        ..small::settings(method, [SIDE; 2])
    };
    settings.options.pilot = 5_000;
    settings.options.ladders = 8;
    settings.options.particles = 1_000;
    settings
}

/// The method's engine around the faulty builder, and the count of what was picked.
fn engine<'a>(
    scene: &'a Scene,
    settings: &RenderSettings,
    fault: Fault,
) -> (Box<dyn Engine + 'a>, Arc<AtomicU64>) {
    let common = builder_settings(settings);
    let cells = Some(Cells::new(settings));
    let (inner, cells): (Box<dyn PathBuilder>, _) = match settings.method {
        Method::Path => {
            let next_event = true;
            (
                Box::new(Unidirectional {
                    settings: common,
                    next_event,
                }),
                cells,
            )
        }
        Method::Light => (Box::new(LightTracing { settings: common }), None),
        Method::Bdpt => {
            let paths = Bidirectional {
                settings: common,
                form: Form::Full,
                heuristic: settings.options.heuristic,
            };
            (Box::new(paths), cells)
        }
        Method::Annealing => (Box::new(replica_builder(settings)), None),
        _ => (builder(scene, settings).expect("a builder"), None),
    };
    let picked = Arc::new(AtomicU64::new(0));
    let faulty = Box::new(Faulty {
        inner,
        fault,
        picked: Arc::clone(&picked),
    });
    let engine: Box<dyn Engine> = match settings.method {
        Method::Pssmlt | Method::Mmlt => {
            Box::new(PssmltEngine::with_builder(scene, settings, faulty).expect("an engine"))
        }
        Method::Annealing => annealing::with_builder(scene, settings, faulty).expect("an engine"),
        method => {
            let engine = IndependentEngine::new(scene, settings, faulty, cells);
            let engine = engine.expect("an engine");
            Box::new(match method {
                Method::Bdpt => engine.in_whole_passes(),
                _ => engine,
            })
        }
    };
    // Pilots count for nothing.
    picked.store(0, Ordering::Relaxed);
    (engine, picked)
}

/// What came of a render: its bits, its count of faults and what was picked, its places.
struct Came {
    bits: Vec<u32>,
    counted: u64,
    picked: u64,
    places: Vec<StepId>,
}

fn rendered(scene: &Scene, settings: &RenderSettings, fault: Fault, threads: usize) -> Came {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    pool.expect("threads").install(|| {
        let (mut engine, picked) = engine(scene, settings, fault);
        let plan: Vec<u64> = (settings.ladder_range())
            .map(|ladder| engine.planned(ladder, settings))
            .collect();
        engine.advance(&plan, None);
        let image = engine.develop().expect("a picture");
        let (counted, places) = engine.nonfinite();
        assert_eq!(
            engine.film_counters().non_finite,
            0,
            "none comes as far as a film"
        );
        Came {
            bits: image
                .rgb()
                .iter()
                .flat_map(|plane| plane.iter().map(|v| v.to_bits()))
                .collect(),
            counted,
            picked: picked.load(Ordering::Relaxed),
            places,
        }
    })
}

/// The picture is the one without these contributions, bit for bit, their count is exact, and neither depends
/// on threads. A chain does not go where nothing else brings light: its target is what is left.
#[test]
fn what_is_not_finite_is_as_if_it_were_not_there() {
    let scene = a_scene();
    for method in METHODS {
        let settings = settings(method);
        let spoilt = rendered(&scene, &settings, Fault::Spoilt, 1);
        let absent = rendered(&scene, &settings, Fault::Absent, 1);
        let three = rendered(&scene, &settings, Fault::Spoilt, 3);
        assert!(spoilt.counted > 3, "{method}: {}", spoilt.counted);
        assert_eq!(spoilt.counted, spoilt.picked, "{method}");
        assert_eq!(spoilt.picked, absent.picked, "{method}");
        assert_eq!(absent.counted, 0, "{method}");
        assert!(spoilt.bits == absent.bits, "{method}");
        assert!(
            spoilt
                .bits
                .iter()
                .all(|bits| f32::from_bits(*bits).is_finite()),
            "{method}"
        );
        assert!(spoilt.bits == three.bits, "{method}");
        assert_eq!(
            (spoilt.counted, &spoilt.places),
            (three.counted, &three.places),
            "{method}"
        );
    }
}

/// Contributions that were told to be left out.
fn left_out(events: &[Event]) -> usize {
    let left_out = |event: &&Event| matches!(event, Event::Splat { kept: false, .. });
    events.iter().filter(left_out).count()
}

/// The places that a render reports are those where a replay finds the fault, and steps beside them are sound.
#[test]
fn a_replay_finds_the_fault_where_it_was_reported() {
    let scene = a_scene();
    for method in METHODS {
        let settings = settings(method);
        let came = rendered(&scene, &settings, Fault::Spoilt, 1);
        assert!(came.places.len() > 1, "{method}");
        for place in came.places.iter().take(3) {
            let one = RenderSettings {
                ladders: Some(place.ladder..place.ladder + 1),
                ..settings.clone()
            };
            let faults = |step: u64| {
                let events = engine(&scene, &one, Fault::Spoilt)
                    .0
                    .replay(StepId { step, ..*place });
                left_out(&events.expect("events"))
            };
            assert!(faults(place.step) > 0, "{method} {place:?}");
            let beside = place.step + 1;
            if !came.places.contains(&StepId {
                step: beside,
                ..*place
            }) {
                assert_eq!(faults(beside), 0, "{method} {place:?}");
            }
        }
    }
}

/// The same of lamps beside chains: whatever the threads and however passes are cut, the same faults are
/// counted, and the first of them are found where they were reported, and only there.
#[test]
fn faults_of_lamps_are_found() {
    const MUTATIONS: u64 = 16 * 400 * (SIDE * SIDE) as u64;
    let scene = a_scene();
    let settings = settings(Method::Pssmlt);
    let lamps = |threads: usize, cuts: &[u64]| {
        let picked = Arc::new(AtomicU64::new(0));
        let paths = Unidirectional {
            settings: kaustik_path::BuilderSettings {
                min_edges: 1,
                pure_specular: kaustik_path::PureSpecular::Alone,
                ..builder_settings(&settings)
            },
            next_event: false,
        };
        let faulty = Box::new(Faulty {
            inner: Box::new(paths),
            fault: Fault::Spoilt,
            picked: Arc::clone(&picked),
        });
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("threads").install(|| {
            let mut lamps = Lamps::with_builder(&scene, &settings, paths, faulty).expect("lamps");
            for &mutations in cuts {
                lamps.keep_up(mutations);
            }
            (lamps, picked.load(Ordering::Relaxed))
        })
    };
    let (one, picked) = lamps(1, &[MUTATIONS]);
    let (count, places) = one.nonfinite();
    assert_eq!(places.len(), 4);
    assert!(places.is_sorted_by_key(|place| place.step), "{places:?}");
    // The look before the passes finds some that count for nothing.
    assert!(
        count > 4 && count <= picked && picked < count + 3,
        "{count} {picked}"
    );
    let (three, _) = lamps(3, &[MUTATIONS / 3, MUTATIONS / 2, MUTATIONS]);
    assert_eq!(
        (count, &places),
        (three.nonfinite().0, &three.nonfinite().1)
    );
    for place in &places {
        assert_eq!(place.ladder, StepId::LAMPS);
        assert_eq!(left_out(&one.replay(place.step)), 1, "{place}");
        assert_eq!(left_out(&three.replay(place.step)), 1, "{place}");
        let beside = place.step + 1;
        assert!(
            places.iter().any(|other| other.step == beside) || left_out(&one.replay(beside)) == 0
        );
    }
}
