//! Methods agree on every built-in scene, to some percent a tile: those that [`agreement`](crate::agreement) and
//! [`by_tile`](crate::by_tile) know to half a percent are few, and have no textures, sky or dispersion.

use kaustik::{Builder, Method, Normaliser, RenderSettings, Starts};

use crate::support::Verdict;
use crate::windows::{Contender, Look, TILES, assert_equal, compare, wanted};

/// The whole image at once, for a few rounds.
const WHOLE: Contender = Contender {
    method: Method::Bdpt,
    variant: " short",
    block: TILES,
    first: 32,
    error: 0.03,
    change: |_| {},
};

const fn short(method: Method, first: u64, change: fn(&mut RenderSettings)) -> Contender {
    Contender {
        method,
        first,
        change,
        ..WHOLE
    }
}

fn pilot(settings: &mut RenderSettings) {
    settings.options.pilot = 20_000;
}

/// Whose walks start at the camera, and end at lamps at best.
const FROM_THE_CAMERA: usize = 3;

/// `bdpt` first: the others are held against it. Those from the camera last.
const METHODS: [Contender; 12] = [
    WHOLE,
    short(Method::Pssmlt, 64, |settings| {
        pilot(settings);
        settings.options.builder = Builder::Bidirectional;
        settings.options.p_large = 0.6;
    }),
    // A sample shows one strategy: it takes more of them until starts know of all light. What scales the picture by the same
    // samples is unbiased for any number of them.
    short(Method::Mmlt, 256, |settings| {
        settings.options.pilot = 1_000_000;
        settings.options.normaliser = Normaliser::Initial;
    }),
    short(Method::Relt, 64, |_| {}),
    short(Method::Mlt, 256, pilot),
    short(Method::Erpt, 16, |settings| {
        pilot(settings);
        settings.options.seeds = Starts::Bidirectional;
    }),
    short(Method::ErptPss, 16, |settings| {
        pilot(settings);
        settings.options.builder = Builder::Bidirectional;
    }),
    short(Method::Annealing, 64, |_| {}),
    short(Method::Light, 64, |_| {}),
    short(Method::Path, 64, |_| {}),
    Contender {
        variant: " simple",
        ..short(Method::Pssmlt, 128, |settings| {
            pilot(settings);
            settings.options.builder = Builder::Simple;
        })
    },
    Contender {
        variant: " endpoint",
        ..short(Method::Pssmlt, 128, |settings| {
            pilot(settings);
            settings.options.builder = Builder::Endpoint;
        })
    },
];

/// Where light comes through glass or water from a narrow lamp or the sun: walks from the camera may not meet it in any seed, and know
/// nothing of it.
const WITH_LIGHT_PATHS: &[Contender] = METHODS.split_at(METHODS.len() - FROM_THE_CAMERA).0;

const LOOK: Look = Look {
    seeds: 16,
    first: 0,
    share: 0.05,
    rounds: 3,
};

/// Tiles that are known to the share, and differ. Of the others Welch's test knows nothing: where one seed in ten meets
/// what is bright, means are not normal.
fn differs(verdict: &Verdict) -> Vec<usize> {
    let known = |tile: &usize| !verdict.uncertain.contains(tile);
    verdict.rejected.iter().copied().filter(known).collect()
}

/// Tiles that are to be known at least, or a comparison says nothing.
const QUARTER: usize = TILES * TILES / 4;

/// A doorway is bright, the room before it is lit by what comes through: that takes hours to know so well.
const DOORWAY: usize = 4;

/// Nothing that is known differs from `bdpt`.
fn assert_agreement_on(words: &str, methods: &[Contender], least_known: usize) {
    let told = compare(words, &wanted(methods), LOOK);
    for told in told
        .iter()
        .filter(|(pair, _)| pair[0].method == Method::Bdpt)
    {
        let ([_, rival], verdict) = told;
        let known = TILES * TILES - verdict.uncertain.len();
        assert!(known >= least_known, "{words}, {rival}: {verdict:?}");
        assert_equal(words, told, LOOK, differs);
    }
}

macro_rules! agree_on {
    ($($name:ident: $words:literal, $methods:expr, $least_known:expr;)*) => {$(
        #[test]
        #[ignore = "long"]
        fn $name() {
            assert_agreement_on($words, $methods, $least_known);
        }
    )*};
}

agree_on! {
    every_method_agrees_on_glossy_cornell: "glossy-cornell", &METHODS, QUARTER;
    every_method_agrees_on_disco: "disco", &METHODS, QUARTER;
    every_method_agrees_on_mirror_statue: "mirror-statue", &METHODS, QUARTER;
    every_method_agrees_on_dinner_hall: "dinner-hall", &METHODS, DOORWAY;
    every_method_agrees_on_villa: "villa", &METHODS, QUARTER;
    every_method_agrees_on_underwater: "underwater", WITH_LIGHT_PATHS, QUARTER;
    every_method_agrees_on_canyon: "canyon", &METHODS, QUARTER;
    every_method_agrees_on_mirror_balls: "mirror-balls", &METHODS, QUARTER;
    every_method_agrees_on_tea_time: "tea-time", &METHODS, QUARTER;
    every_method_agrees_on_prism: "prism", WITH_LIGHT_PATHS, QUARTER;
    every_method_agrees_on_material_ball: "material-ball", &METHODS, QUARTER;
    every_method_agrees_on_glass_ball: "material-ball?material=glass", &METHODS, QUARTER;
}
