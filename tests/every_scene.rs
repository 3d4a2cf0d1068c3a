//! Methods agree on every built-in scene, to some percent a tile: those that [`agreement`](crate::agreement) and
//! [`by_tile`](crate::by_tile) know to half a percent are few, and have no textures, sky or dispersion.

use kaustik::{Builder, Method, RenderSettings};

use crate::support::from_both_sides;
use crate::windows::{Contender, Look, TILES, assert_known_equal};

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

fn both_sides(settings: &mut RenderSettings) {
    pilot(settings);
    from_both_sides(settings);
}

/// Whose walks start at the camera, and end at lamps at best.
const FROM_THE_CAMERA: usize = 2;

/// `bdpt` first: the others are held against it. Those from the camera last.
const METHODS: [Contender; 12] = [
    WHOLE,
    short(Method::Pssmlt, 64, both_sides),
    short(Method::Mmlt, 256, both_sides),
    short(Method::Relt, 64, |_| {}),
    short(Method::Mlt, 256, pilot),
    short(Method::Erpt, 16, both_sides),
    short(Method::ErptPss, 16, both_sides),
    short(Method::Annealing, 64, |_| {}),
    short(Method::Light, 64, |_| {}),
    Contender {
        variant: " simple",
        ..short(Method::Pssmlt, 128, |settings| {
            pilot(settings);
            settings.options.builder = Builder::Simple;
        })
    },
    short(Method::Path, 64, |_| {}),
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

/// Tiles that are to be known at least, or a comparison says nothing.
const QUARTER: usize = TILES * TILES / 4;

/// A doorway is bright, the room before it is lit by what comes through: that takes hours to know so well.
const DOORWAY: usize = 4;

macro_rules! agree_on {
    ($($name:ident: $words:literal, $methods:expr, $least_known:expr;)*) => {$(
        #[test]
        #[ignore = "long"]
        fn $name() {
            assert_known_equal($words, $methods, LOOK, $least_known);
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
