//! Paths that were written and read again move on as if nothing had happened.

use kaustik_mcmc::{Draws, acceptance, decide, generator};

use super::kinds::{
    BIDIRECTIONAL, CAUSTIC, EDGES, EVERY, Kind, LENS, MULTICHAIN, SUBPATH, TIME, WAVELENGTHS,
};
use super::space;
use super::stage::scene;
use crate::{Path, PathSpace, Seeds, WrittenPath};

const SCENES: [&str; 18] = [
    "diffuse",
    "glossy",
    "mirror",
    "varnish",
    "glass",
    "inlay",
    "frosted",
    "rainbow",
    "point",
    "sun",
    "sky",
    "lens",
    "orthographic",
    "veil",
    "pane",
    "moving",
    "moving-mirror",
    "moving-glass",
];
const KINDS: [Kind; 8] = [
    BIDIRECTIONAL,
    LENS,
    MULTICHAIN,
    CAUSTIC,
    SUBPATH,
    WAVELENGTHS,
    TIME,
    EVERY,
];

fn start(space: &PathSpace<'_>) -> Path {
    let mut seeds = Seeds::new(space);
    let (mut path, mut rng) = (Path::default(), generator(3, 1));
    while seeds.sample(&mut path, &mut rng) <= 0.0 {}
    path
}

/// After every step the path is written down and read again, and whatever is around it is as new: proposals, their
/// ratios and the numbers that they take are those of a chain that was left in peace.
#[test]
fn a_path_that_was_read_moves_like_the_one_that_was_written() {
    for name in SCENES {
        let scene = scene(name);
        let space = space(&scene, EDGES);
        let mut rng = generator(11, 5);
        let (mut path, mut next) = (start(&space), Path::default());
        let (mut moved, mut proposed) = (0, 0);
        for step in 0..4_600 {
            let (_, suits, propose) = KINDS[step % KINDS.len()];
            let written = path.written();
            let again = space.read(&written).expect("what was written");
            assert_eq!(again.written(), written, "{name} {step}");
            assert_eq!(suits(&space, &path), suits(&space, &again), "{name} {step}");
            if !suits(&space, &path) {
                continue;
            }
            let (mut other, mut fresh) = (rng.clone(), Path::default());
            let ratios = [
                propose(&space, &path, &mut next, &mut rng),
                propose(&space, &again, &mut fresh, &mut other),
            ];
            let [one, two] = ratios.map(f64::to_bits);
            assert_eq!(one, two, "{name} {step}: {ratios:?}");
            // the numbers that were drawn
            assert_eq!(rng.clone().uniform().to_bits(), other.uniform().to_bits());
            proposed += 1;
            if ratios[0] <= 0.0 {
                continue;
            }
            assert_eq!(next.written(), fresh.written(), "{name} {step}");
            let accepted = acceptance(path.density(), next.density(), ratios[0]);
            if decide(accepted, &mut rng) {
                std::mem::swap(&mut path, &mut next);
                moved += 1;
            }
        }
        assert!(
            moved > 50 && proposed > 2_000,
            "{name}: {moved} of {proposed}"
        );
    }
}

#[test]
fn what_is_no_path_of_the_scene_is_refused() {
    let (here, elsewhere) = (scene("glass"), scene("point"));
    let space = space(&here, EDGES);
    let path = start(&space);
    let bytes = postcard::to_allocvec(&path.written()).expect("bytes");
    let written: WrittenPath = postcard::from_bytes(&bytes).expect("what was written");
    assert_eq!(written, path.written());
    assert!(space.read(&written).is_some());
    assert!(super::space(&elsewhere, EDGES).read(&written).is_none());
    assert!(super::space(&here, 1).read(&written).is_none());
    assert!(space.read(&WrittenPath::default()).is_none());
    // Any bit of it, wherever it is: nothing panics, and what is taken can be proposed from.
    let (mut refused, mut rng) = (0, generator(5, 5));
    for at in 0..bytes.len() * 8 {
        let mut bytes = bytes.clone();
        bytes[at / 8] ^= 1 << (at % 8);
        let broken = postcard::from_bytes::<WrittenPath>(&bytes).ok();
        let Some(taken) = broken.and_then(|broken| space.read(&broken)) else {
            refused += 1;
            continue;
        };
        for (_, suits, propose) in KINDS {
            if suits(&space, &taken) {
                propose(&space, &taken, &mut Path::default(), &mut rng);
            }
        }
    }
    // places and directions are not in the density again: they are anybody's
    assert!(
        refused > bytes.len(),
        "{refused} of {} bits",
        bytes.len() * 8
    );
}
