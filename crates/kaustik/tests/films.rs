//! No method holds more than five films, whatever the number of threads. (A binary of its own: it owns the allocator.)

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering};

use kaustik::scene::{Scene, SceneOptions, builtin};
use kaustik::{Budget, Control, Direct, Method, Options, RenderSettings, render};

const WIDTH: u32 = 61;
const HEIGHT: u32 = 47;
/// Three integers of 64 bits a pixel: a size that nothing else has.
const FILM: usize = WIDTH as usize * HEIGHT as usize * 3 * 8;

static LIVE: AtomicUsize = AtomicUsize::new(0);
static MOST: AtomicUsize = AtomicUsize::new(0);

/// The system's allocator, counting pieces as large as a film.
struct Counting;

#[expect(
    unsafe_code,
    reason = "an allocator can only be written so; it forwards to System"
)]
// SAFETY: every call is passed on to `System` unchanged; the counters neither allocate nor unwind.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        if layout.size() == FILM {
            let live = LIVE.fetch_add(1, Ordering::Relaxed) + 1;
            MOST.fetch_max(live, Ordering::Relaxed);
        }
        // SAFETY: the caller's promise is passed on
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
        if layout.size() == FILM {
            LIVE.fetch_sub(1, Ordering::Relaxed);
        }
        // SAFETY: the caller's promise is passed on
        unsafe { System.dealloc(memory, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn scene(words: &str) -> Scene {
    let options = SceneOptions {
        width: WIDTH,
        height: HEIGHT,
        ..SceneOptions::default()
    };
    Scene::new(&builtin::load(words).expect("a built-in scene"), &options).expect("a sound scene")
}

/// The most films at a time.
fn films(method: Method, threads: usize, change: impl Fn(&mut Options)) -> usize {
    let mut settings = RenderSettings {
        method,
        width: WIDTH,
        height: HEIGHT,
        budget: Budget::PerPixel(2),
        threads,
        features: false,
        ..RenderSettings::default()
    };
    settings.options.pilot = 2_000;
    settings.options.particles = 1_000;
    settings.options.photon.photons = Some(4_000);
    change(&mut settings.options);
    // glass: all replicas run
    let scene = scene("glass-cube?light=0.8");
    let before = LIVE.load(Ordering::Relaxed);
    MOST.store(before, Ordering::Relaxed);
    render(&scene, &settings, &mut Control::default()).expect("a render");
    MOST.load(Ordering::Relaxed) - before
}

/// One test, so that nothing else counts at the same time.
#[test]
fn few_films_are_held() {
    for method in Method::ALL {
        for direct in [Direct::Lamps, Direct::Apart] {
            let options = Options {
                direct,
                ..Options::default()
            };
            let staged = [Method::MltMultistage, Method::PssmltMultistage].contains(&method);
            let is_refused = staged && direct == Direct::Apart;
            assert_eq!(options.check(method).is_err(), is_refused, "{method}");
            if is_refused {
                continue;
            }
            let found = [1, 4].map(|threads| films(method, threads, |o| o.direct = direct));
            assert!(found[0] >= 1, "{method}: films are counted");
            assert_eq!(found[0], found[1], "{method}, {direct:?}: by threads");
            // of photons: a film a level, of which one is that of what they cannot carry, and the picture
            assert!(found[0] <= 5, "{method}, {direct:?}: {found:?}");
        }
    }
    let relt = films(Method::Relt, 1, |_| ());
    assert_eq!(relt, 5, "a film each for four replicas and for lamps");
    for method in [Method::Mlt, Method::Erpt] {
        let of = |direct| films(method, 1, |o| o.direct = direct);
        assert_eq!(of(Direct::Lamps), 2, "{method}: another for lamps");
        assert_eq!(of(Direct::Apart), 3, "{method}: one more for direct light");
    }
    for method in [Method::Erpt, Method::ErptPss] {
        let alone = |filter| {
            films(method, 1, |o| {
                (o.direct, o.consecutive) = (Direct::Together, filter);
            })
        };
        let found = [alone(None), alone(Some(1))];
        assert_eq!(
            found,
            [1, 2],
            "{method}: another only where a filter needs it"
        );
    }
}
