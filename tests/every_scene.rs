//! Methods agree on every built-in scene, to some percent a tile: those that [`agreement`](crate::agreement) and
//! [`by_tile`](crate::by_tile) know to half a percent are few, and have no textures, sky or dispersion.

use kaustik::{Builder, Method, RenderSettings, Starts};

use crate::by_tile::{Contender, Look, TILES, assert_equal, compare};

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

/// `bdpt` first: the others are held against it.
const METHODS: [Contender; 8] = [
    WHOLE,
    short(Method::Path, 64, |_| {}),
    short(Method::Pssmlt, 64, |settings| {
        pilot(settings);
        settings.options.builder = Builder::Bidirectional;
        settings.options.p_large = 0.6;
    }),
    short(Method::Mmlt, 256, pilot),
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
];

const LOOK: Look = Look {
    seeds: 16,
    first: 0,
    share: 0.05,
    rounds: 3,
};

/// Nothing differs from `bdpt`; and most tiles are known well enough that it would be seen.
fn assert_agreement_on(words: &str) {
    let verdicts = compare(words, &METHODS, LOOK);
    let held = verdicts
        .iter()
        .filter(|(pair, _)| pair[0].method == Method::Bdpt);
    for (pair, verdict) in held {
        assert_equal(words, *pair, verdict, LOOK);
        let known = TILES * TILES - verdict.uncertain.len();
        assert!(known >= TILES * TILES / 2, "{words}: {verdict:?}");
    }
}

macro_rules! agree_on {
    ($($name:ident: $words:literal;)*) => {$(
        #[test]
        #[ignore = "long"]
        fn $name() {
            assert_agreement_on($words);
        }
    )*};
}

agree_on! {
    methods_agree_on_glossy_cornell: "glossy-cornell";
    methods_agree_on_disco: "disco";
    methods_agree_on_mirror_statue: "mirror-statue";
    methods_agree_on_dinner_hall: "dinner-hall";
    methods_agree_on_villa: "villa";
    methods_agree_on_underwater: "underwater";
    methods_agree_on_canyon: "canyon";
    methods_agree_on_mirror_balls: "mirror-balls";
    methods_agree_on_tea_time: "tea-time";
    methods_agree_on_prism: "prism";
    methods_agree_on_material_ball: "material-ball";
    methods_agree_on_glass_ball: "material-ball?material=glass";
}
