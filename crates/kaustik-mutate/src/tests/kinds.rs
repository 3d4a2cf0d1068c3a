//! The kernels under test, from starts that are independent paths.

use glam::DVec3;
use kaustik_mcmc::testing::{Changes, PairedTest};
use kaustik_mcmc::{Draws, Kernel, Mixture, Pcg64Dxsm, acceptance, decide};
use kaustik_scene::Scene;

use super::space;
use crate::factor::Factor;
use crate::factor::planted::without;
use crate::{
    BidirectionalMutation, CausticPerturbation, EveryPerturbation, LensMutation, LensPerturbation,
    Path, PathSpace, Radii, Run, Seeds, TimeMutation, WavelengthMutation,
};

/// How many test functions there are.
pub(super) const H: usize = 26;
/// Longest path.
pub(super) const EDGES: u32 = 5;

/// Where most of the stages' cameras stand.
const EYE: DVec3 = DVec3::new(0.3, 3.0, 2.0);

/// What each part of a path shows.
pub(super) fn functions(path: &Path) -> [f64; H] {
    let n = path.edges();
    // What a kernel keeps is worked out again: rounding is no change.
    let rounded = |u: f64| (u * 1e9).round() * 1e-9;
    let [x, y] = path.raster().to_array().map(rounded);
    let lens = DVec3::from(path.position(n).map(rounded)) - EYE;
    let (first, last) = (path.position(1.min(n)), path.position(n - 1));
    let specular = (1..n).filter(|&i| path.is_specular(i)).count() as f64;
    let is = |yes: bool| f64::from(u8::from(yes));
    let [red, green, blue] = path.colour().0.map(f64::from);
    [
        x,
        y,
        x * x,
        y * y,
        x * y,
        is(x < 0.3),
        is(y < 0.3),
        is(n == 2),
        is(n == 3),
        is(n == 4),
        specular,
        first[0],
        first[1].min(5.0),
        first[2],
        last[0],
        last[2],
        path.wavelength_u(),
        red + 0.5 * green,
        blue,
        first[0] * last[0],
        path.time(),
        is(path.time() < 0.3),
        path.time() * first[0],
        lens.x,
        lens.x * lens.x,
        lens.length_squared(),
    ]
}

/// A kernel on paths in a space, and which paths it is started from.
pub(super) type Kind = (&'static str, fn(&PathSpace<'_>, &Path) -> bool, Propose);
pub(super) type Propose = fn(&PathSpace<'_>, &Path, &mut Path, &mut Pcg64Dxsm) -> f64;
fn lens<'a>(space: &'a PathSpace<'a>, run: Run) -> LensPerturbation<'a> {
    LensPerturbation {
        space,
        radii: Radii {
            least: 0.2,
            most: 8.0,
        },
        angles: Radii {
            least: 0.05,
            most: 1.0,
        },
        run,
    }
}

fn caustic<'a>(space: &'a PathSpace<'a>) -> CausticPerturbation<'a> {
    CausticPerturbation {
        space,
        radii: Radii {
            least: 0.2,
            most: 6.0,
        },
    }
}

fn every<'a>(space: &'a PathSpace<'a>) -> EveryPerturbation<'a> {
    EveryPerturbation {
        space,
        fraction: 0.3,
    }
}

pub(super) const LENS: Kind = (
    "lens",
    |space, x| lens(space, Run::Single).suits(x),
    |space, x, y, rng| lens(space, Run::Single).propose(&mut (), x, y, rng).ratio,
);
pub(super) const MULTICHAIN: Kind = (
    "multichain",
    |space, x| lens(space, Run::Multiple).suits(x),
    |space, x, y, rng| lens(space, Run::Multiple).propose(&mut (), x, y, rng).ratio,
);
pub(super) const CAUSTIC: Kind = (
    "caustic",
    |space, x| caustic(space).suits(x),
    |space, x, y, rng| caustic(space).propose(&mut (), x, y, rng).ratio,
);
pub(super) const BIDIRECTIONAL: Kind = (
    "bidirectional",
    |_, _| true,
    |space, x, y, rng| {
        BidirectionalMutation { space }
            .propose(&mut (), x, y, rng)
            .ratio
    },
);
pub(super) const SUBPATH: Kind = (
    "lens mutation",
    |space, x| LensMutation { space }.suits(x),
    |space, x, y, rng| LensMutation { space }.propose(&mut (), x, y, rng).ratio,
);
pub(super) const WAVELENGTHS: Kind = (
    "wavelengths",
    |space, x| WavelengthMutation { space }.suits(x),
    |space, x, y, rng| {
        WavelengthMutation { space }
            .propose(&mut (), x, y, rng)
            .ratio
    },
);

pub(super) const TIME: Kind = (
    "time",
    |space, x| TimeMutation { space }.suits(x),
    |space, x, y, rng| TimeMutation { space }.propose(&mut (), x, y, rng).ratio,
);

pub(super) const EVERY: Kind = (
    "every",
    |space, x| every(space).suits(x),
    |space, x, y, rng| every(space).propose(&mut (), x, y, rng).ratio,
);

/// Which of four kernels suit a path, whole paths anew always: what a mixture chooses by.
fn suitable(space: &PathSpace<'_>, path: &Path) -> [f64; 4] {
    [BIDIRECTIONAL, LENS, MULTICHAIN, CAUSTIC].map(|kind| f64::from(u8::from(kind.1(space, path))))
}

/// One of the four that suit, as `mlt` makes them.
pub(super) const MIXTURE: Kind = (
    "mixture",
    |_, _| true,
    |space, x, y, rng| {
        let kernels = (
            BidirectionalMutation { space },
            lens(space, Run::Single),
            lens(space, Run::Multiple),
            caustic(space),
        );
        let mixture = Mixture::<_, _, 4>::new(kernels, |path: &Path| suitable(space, path));
        mixture.propose(&mut (), x, y, rng).ratio
    },
);

/// The same with a choice that the ratio does not know of.
pub(super) const UNWEIGHED: Kind = (
    "mixture, unweighed",
    |_, _| true,
    |space, x, y, rng| {
        let made = [BIDIRECTIONAL, LENS, MULTICHAIN, CAUSTIC][rng.index(&suitable(space, x))];
        made.2(space, x, y, rng)
    },
);

/// Kernels that look at the scene where the space stands, as it is when the shutter opens, whatever the time
/// of the path.
pub(super) const BLIND: [Kind; 3] = [
    ("lens, blind", LENS.1, |space, x, y, rng| {
        let made = lens(space, Run::Single).perturb(x, y, rng);
        made.unwrap_or(0.0)
    }),
    ("caustic, blind", CAUSTIC.1, |space, x, y, rng| {
        caustic(space).perturb(x, y, rng).unwrap_or(0.0)
    }),
    (
        "bidirectional, blind",
        BIDIRECTIONAL.1,
        |space, x, y, rng| {
            let made = BidirectionalMutation { space }.mutate(x, y, rng);
            made.unwrap_or(0.0)
        },
    ),
];

/// Starts from independent paths, steps, and hands `judge` the pieces.
pub(super) fn with_pieces<R>(
    scene: &Scene,
    kind: Kind,
    left_out: Option<Factor>,
    judge: impl FnOnce(
        &mut dyn FnMut(&mut Pcg64Dxsm) -> (Path, f64),
        &mut dyn FnMut(&mut Path, &mut Pcg64Dxsm),
    ) -> R,
) -> R {
    with_pieces_in(&space(scene, EDGES), kind, left_out, judge)
}

/// As [`with_pieces`], in a space of one's own.
pub(super) fn with_pieces_in<R>(
    space: &PathSpace<'_>,
    kind: Kind,
    left_out: Option<Factor>,
    judge: impl FnOnce(
        &mut dyn FnMut(&mut Pcg64Dxsm) -> (Path, f64),
        &mut dyn FnMut(&mut Path, &mut Pcg64Dxsm),
    ) -> R,
) -> R {
    let (_, suits, propose) = kind;
    let mut seeds = Seeds::new(space);
    let mut start = |rng: &mut Pcg64Dxsm| {
        let mut path = Path::default();
        let weight = seeds.sample(&mut path, rng);
        let suited = weight > 0.0 && suits(space, &path);
        (path, if suited { weight } else { 0.0 })
    };
    let mut next = Path::default();
    let mut step = |path: &mut Path, rng: &mut Pcg64Dxsm| {
        let ratio = without(left_out, || propose(space, path, &mut next, rng));
        let accepted = acceptance(path.density(), next.density(), ratio);
        if ratio > 0.0 && decide(accepted, rng) {
            std::mem::swap(path, &mut next);
        }
    };
    judge(&mut start, &mut step)
}

/// How the means change, with a factor left out of the kernel's densities or none.
pub(super) fn changes(
    scene: &Scene,
    kind: Kind,
    left_out: Option<Factor>,
    test: &PairedTest,
) -> Changes<H> {
    with_pieces(scene, kind, left_out, |start, step| {
        test.run(|rng| start(rng), |path, rng| step(path, rng), functions)
    })
}
