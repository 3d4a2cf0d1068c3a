//! Stops in the middle of passes, iterations and rounds: flags that rise at a look of a given number.

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

use kaustik_film::Filter;
use kaustik_scene::Scene;

use crate::engine::Engine;
use crate::methods::engine;
use crate::state::{Header, Source};
use crate::threads::pool;
use crate::{
    Budget, Control, Direct, Energy, Method, Outcome, Progress, RenderSettings, Snapshot, State,
    Watch, render, render_watched, resume, small,
};

/// Addresses of flags, and looks after which they rise.
static LOOKS: Mutex<Vec<(usize, u64)>> = Mutex::new(Vec::new());

fn address(flag: &AtomicBool) -> usize {
    std::ptr::from_ref(flag).addr()
}

/// Somebody looks at a flag.
pub(crate) fn look(stop: Option<&AtomicBool>) {
    let Some(flag) = stop else { return };
    let mut looks = LOOKS.lock().expect("no look fails");
    let own = looks.iter_mut().find(|(of, _)| *of == address(flag));
    if let Some((_, left)) = own {
        match left.checked_sub(1) {
            Some(fewer) => *left = fewer,
            None => flag.store(true, Ordering::Relaxed),
        }
    }
}

/// A flag that rises after so many looks; how many are left when `work` is done with it.
fn after<T>(count: u64, work: impl FnOnce(&AtomicBool) -> T) -> (T, u64) {
    // on the heap: no other test's flag has its address as long as it lives
    let flag = Box::new(AtomicBool::new(false));
    LOOKS.lock().expect("sound").push((address(&flag), count));
    let done = work(&flag);
    let mut looks = LOOKS.lock().expect("sound");
    let at = looks.iter().position(|(of, _)| *of == address(&flag));
    (done, looks.remove(at.expect("its own")).1)
}

const SIDE: u32 = 12;

fn scene() -> Scene {
    small::scene("glass-cube?light=0.8", [SIDE; 2])
}

fn settings(method: Method, change: impl FnOnce(&mut RenderSettings)) -> RenderSettings {
    let mut settings = RenderSettings {
        max_depth: 6,
        budget: Budget::PerPixel(8),
        threads: 1,
        ..small::settings(method, [SIDE; 2])
    };
    let options = &mut settings.options;
    options.ladders = 3;
    options.pilot = 2000;
    options.photon.photons = Some(1000);
    options.particles = 256;
    // Every sample with light has chains.
    (options.chains, options.length) = (Some(3.0), 20);
    change(&mut settings);
    settings
}

/// Methods that take back what was broken off.
fn cases() -> Vec<(String, RenderSettings)> {
    let mut cases = Vec::new();
    let mut case = |what: &str, method: Method, change: &dyn Fn(&mut RenderSettings)| {
        let name = format!("{method} {what}");
        cases.push((name, settings(method, change)));
    };
    let plain: &dyn Fn(&mut RenderSettings) = &|_| {};
    case("wide filter", Method::Path, &|s| {
        s.filter = Filter::GAUSSIAN;
    });
    case("", Method::Bdpt, plain);
    case("", Method::Erpt, plain);
    case("filters", Method::Erpt, &|s| {
        s.options.consecutive = Some(2);
        s.options.proposed = Some(1.5);
    });
    case("passes", Method::Erpt, &|s| {
        s.options.energy = Energy::Passes;
    });
    case("", Method::ErptPss, plain);
    case("filter", Method::ErptPss, &|s| {
        s.options.consecutive = Some(2);
    });
    for method in (Method::ALL.into_iter()).filter(|method| method.traces_photons()) {
        case("", method, plain);
        case("shrinking discs, maps", method, &|s| {
            s.options.photon.reduction = Some(0.7);
            s.options.photon.maps = true;
            s.features = true;
        });
    }
    case("", Method::Annealing, plain);
    case("one ladder", Method::Annealing, &|s| s.options.ladders = 1);
    cases
}

/// An engine's state, and the bits of its picture with its layers.
type Seen = (Vec<u8>, Vec<u32>);

fn seen(scene: &Scene, settings: &RenderSettings, engine: &mut (dyn Engine + '_)) -> Seen {
    let snapshot = Snapshot::new(Header::new(scene, settings, 0.0), engine);
    let bytes = snapshot.bytes(&Source::default()).expect("a state");
    let image = engine.develop().expect("a picture");
    let layers = engine.layers().expect("layers");
    let parts = layers.iter().flat_map(|layer| &layer.channels);
    let planes = image.rgb().into_iter();
    let planes = planes.chain(parts.map(|part| part.samples.as_slice()));
    let bits = planes.flatten().map(|value| value.to_bits()).collect();
    (bytes, bits)
}

/// Broken off after any number of looks, in the first round of work and in the second, an engine is where it
/// was before, and goes on to where it would have come to.
#[test]
fn what_is_broken_off_is_taken_back() {
    let scene = scene();
    for (what, settings) in cases() {
        let pool = pool(settings.threads).expect("threads");
        pool.install(|| {
            let new = || engine(&scene, &settings).expect("an engine");
            let see = |engine: &mut dyn Engine| seen(&scene, &settings, engine);
            let grain = |e: &dyn Engine| -> Vec<u64> {
                let ladders = settings.ladder_range();
                ladders
                    .map(|l| e.grain(l).min(e.planned(l, &settings)))
                    .collect()
            };
            let mut through = new();
            let (plan, begin) = (grain(through.as_ref()), see(through.as_mut()));
            through.advance(&plan, None);
            let once = see(through.as_mut());
            through.advance(&plan, None);
            let twice = see(through.as_mut());
            assert!(begin.0 != once.0 && once.0 != twice.0, "{what}");
            let mut given_up = [0; 2];
            for (round, (before, whole)) in [(&begin, &once), (&once, &twice)].iter().enumerate() {
                let there = || {
                    let mut there = new();
                    for _ in 0..round {
                        there.advance(&plan, None);
                    }
                    there
                };
                // How many looks there are in the round.
                let most = 1 << 40;
                let (_, left) = after(most, |stop| there().advance(&plan, Some(stop)));
                let looks = most - left;
                let parts = [0, 1, 3, 5, 7, 9].map(|tenths| looks * tenths / 10);
                for count in parts.into_iter().chain(looks.saturating_sub(8)..looks) {
                    let mut broken = there();
                    let (taken, _) = after(count, |stop| broken.advance(&plan, Some(stop)));
                    // The last looks may find all done.
                    if taken == 0 {
                        given_up[round] += 1;
                        let now = see(broken.as_mut());
                        assert!(now == **before, "{what}: {count} of {looks}");
                        broken.advance(&plan, None);
                    }
                    let now = see(broken.as_mut());
                    assert!(now == **whole, "{what}: {count} of {looks}");
                }
            }
            assert!(
                given_up.iter().all(|&times| times >= 8),
                "{what}: {given_up:?}"
            );
        });
    }
}

/// Keeps the last state.
#[derive(Default)]
struct Keeper(Option<State>);

impl Watch for Keeper {
    fn wants_state(&mut self, _: &Progress, last: bool) -> bool {
        last
    }

    fn see_state(&mut self, snapshot: &Snapshot<'_>) {
        self.0 = snapshot.state().ok();
    }
}

/// A whole render that is broken off and resumed, once and again, has the bits of one that went through.
/// Before either part has whole passes it has no samples.
#[test]
fn broken_renders_go_on() {
    let scene = scene();
    let mut cases = cases();
    for method in [Method::Erpt, Method::ErptPss] {
        let apart = settings(method, |s| s.options.direct = Direct::Apart);
        cases.push((format!("{method} apart"), apart));
    }
    for (what, settings) in cases {
        let bits = |image: &kaustik_film::Image| -> Vec<u32> {
            let planes = image.rgb().into_iter().flatten();
            planes.map(|value| value.to_bits()).collect()
        };
        let through = render(&scene, &settings, &mut Control::default()).expect("a render");
        let mut broken = 0;
        for count in [1, 9, 40, 700] {
            let mut keeper = Keeper::default();
            let mut first = true;
            for _ in 0..2 {
                let state = keeper.0.take();
                let (rendered, _) = after(count, |stop| {
                    let mut control = Control {
                        stop: Some(stop),
                        progress: None,
                    };
                    match state {
                        None => render_watched(&scene, &settings, &mut control, &mut keeper),
                        Some(state) => resume(&scene, &settings, state, &mut control, &mut keeper),
                    }
                });
                let rendered = rendered.expect("a render");
                broken += u32::from(rendered.outcome == Outcome::Stopped);
                if count == 1 && first {
                    assert_eq!(rendered.statistics.steps, 0, "{what}");
                }
                first = false;
            }
            let state = keeper.0.take().expect("a state");
            let mut control = Control::default();
            let done = resume(&scene, &settings, state, &mut control, &mut keeper);
            let done = done.expect("a render");
            assert!(bits(&done.image) == bits(&through.image), "{what}: {count}");
            assert_eq!(done.statistics.steps, through.statistics.steps, "{what}");
        }
        assert!(broken > 1, "{what}: {broken}");
    }
}
