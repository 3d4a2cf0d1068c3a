//! No method holds more than five films, whatever the number of threads, and photon methods little beside. (A binary of its
//! own: it owns the allocator.)

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use kaustik::scene::{Scene, SceneOptions, builtin};
use kaustik::{Budget, Control, Direct, Method, RenderSettings, render};

const WIDTH: u32 = 61;
const HEIGHT: u32 = 47;
/// Three integers of 64 bits a pixel: a size that nothing else has.
const FILM: usize = WIDTH as usize * HEIGHT as usize * 3 * 8;

static LIVE: AtomicUsize = AtomicUsize::new(0);
static MOST: AtomicUsize = AtomicUsize::new(0);
static BYTES: AtomicUsize = AtomicUsize::new(0);
static MOST_BYTES: AtomicUsize = AtomicUsize::new(0);

/// The system's allocator, counting bytes, and pieces as large as a film.
struct Counting;

impl Counting {
    fn take(size: usize) {
        let bytes = BYTES.fetch_add(size, Ordering::Relaxed) + size;
        MOST_BYTES.fetch_max(bytes, Ordering::Relaxed);
        if size == FILM {
            let live = LIVE.fetch_add(1, Ordering::Relaxed) + 1;
            MOST.fetch_max(live, Ordering::Relaxed);
        }
    }

    fn give_back(size: usize) {
        BYTES.fetch_sub(size, Ordering::Relaxed);
        if size == FILM {
            LIVE.fetch_sub(1, Ordering::Relaxed);
        }
    }
}

#[expect(
    unsafe_code,
    reason = "an allocator can only be written so; it forwards to System"
)]
// SAFETY: every call is passed on to `System` unchanged; the counters neither allocate nor unwind.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        Self::take(layout.size());
        // SAFETY: the caller's promise is passed on
        unsafe { System.alloc(layout) }
    }

    unsafe fn realloc(&self, memory: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        Self::give_back(layout.size());
        Self::take(size);
        // SAFETY: the caller's promise is passed on
        unsafe { System.realloc(memory, layout, size) }
    }

    unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
        Self::give_back(layout.size());
        // SAFETY: the caller's promise is passed on
        unsafe { System.dealloc(memory, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn scene(words: &str, [width, height]: [u32; 2]) -> Scene {
    let options = SceneOptions {
        width,
        height,
        ..SceneOptions::default()
    };
    Scene::new(&builtin::load(words).expect("a built-in scene"), &options).expect("a sound scene")
}

/// The most films at a time.
fn films(method: Method, direct: Direct, threads: usize) -> usize {
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
    settings.options.direct = direct;
    // glass: all replicas run
    let scene = scene("glass-cube?light=0.8", [WIDTH, HEIGHT]);
    let before = LIVE.load(Ordering::Relaxed);
    MOST.store(before, Ordering::Relaxed);
    render(&scene, &settings, &mut Control::default()).expect("a render");
    MOST.load(Ordering::Relaxed) - before
}

/// The most bytes a pixel of a photon method that may be stopped, over those of the scene.
fn bytes_a_pixel(method: Method) -> f64 {
    let size = [480, 270];
    let mut settings = RenderSettings {
        method,
        width: size[0],
        height: size[1],
        budget: Budget::PerPixel(3),
        threads: 2,
        features: false,
        ..RenderSettings::default()
    };
    settings.options.pilot = 2_000;
    settings.options.photon.photons = 50_000;
    let (scene, stop) = (scene("ring-and-sphere", size), AtomicBool::new(false));
    let mut control = Control {
        stop: Some(&stop),
        ..Control::default()
    };
    let before = BYTES.load(Ordering::Relaxed);
    MOST_BYTES.store(before, Ordering::Relaxed);
    render(&scene, &settings, &mut control).expect("a render");
    (MOST_BYTES.load(Ordering::Relaxed) - before) as f64 / f64::from(size[0] * size[1])
}

/// One test, so that nothing else counts at the same time.
#[test]
fn few_films_are_held() {
    for method in Method::ALL {
        for direct in [Direct::Lamps, Direct::Apart] {
            let found = [1, 4].map(|threads| films(method, direct, threads));
            assert!(found[0] >= 1, "{method}: films are counted");
            assert_eq!(found[0], found[1], "{method}, {direct:?}: by threads");
            // of photons: a film a level, of which one is that of what they cannot carry, that one, and the picture
            assert!(found[0] <= 5, "{method}, {direct:?}: {found:?}");
        }
    }
    let relt = films(Method::Relt, Direct::Lamps, 1);
    assert_eq!(relt, 5, "a film each for four replicas and for lamps");
    // 600 MB are 289 bytes a pixel of 1920 x 1080; here what does not grow with the picture, as trees, has its part as well.
    let limits = [
        (Method::Sppm, 210.0),
        (Method::PhotonVisibility, 230.0),
        (Method::PhotonDensity, 320.0),
        (Method::PhotonSpatial, 330.0),
        (Method::PhotonImage, 330.0),
    ];
    let found = limits.map(|(method, _)| bytes_a_pixel(method));
    for ((method, most), bytes) in limits.into_iter().zip(found) {
        assert!(
            bytes <= most,
            "{method}: more than {most} of {found:.0?} bytes a pixel"
        );
    }
}
