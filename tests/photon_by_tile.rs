//! Photon methods tile by tile: with discs of a pixel all have the same error of the kernel, and with discs that shrink none.

use kaustik::{Method, PhotonOptions, RenderSettings};

use crate::support::{Difference, Verdict};
use crate::windows::{
    Contender, Look, SEEDS, SPARED, TILES, assert_known_equal, compare, with_the_first,
};

/// The whole image, in iterations of as many light paths as by default: chains are long only there.
const SPPM: Contender = Contender {
    method: Method::Sppm,
    variant: "",
    block: TILES,
    first: 8,
    error: 0.0065,
    change: by_default,
};

/// As users have it, but for discs that stay: what they blur is the same for all methods, however many iterations each takes.
fn by_default(settings: &mut RenderSettings) {
    settings.options.pilot = 100_000;
    settings.options.photon = PhotonOptions {
        reduction: None,
        ..PhotonOptions::default()
    };
}

const fn chains(method: Method) -> Contender {
    Contender { method, ..SPPM }
}

const METHODS: [Contender; 5] = [
    SPPM,
    chains(Method::PhotonVisibility),
    chains(Method::PhotonDensity),
    chains(Method::PhotonSpatial),
    chains(Method::PhotonImage),
];

const LONG: Look = Look {
    seeds: SEEDS,
    first: 0,
    share: 0.01,
    rounds: usize::MAX,
};

/// In scenes where light is rare, for a few rounds.
const ROUGH: Look = Look {
    seeds: 16,
    first: 0,
    share: 0.05,
    rounds: 3,
};

/// Seconds of work: what is far off is found.
const SHORT: Look = Look {
    seeds: 8,
    share: 0.2,
    ..LONG
};

const fn short(contender: Contender, change: fn(&mut RenderSettings)) -> Contender {
    Contender {
        first: 2,
        error: 0.1,
        change,
        ..contender
    }
}

/// So few light paths that eight seeds take seconds.
fn few(settings: &mut RenderSettings) {
    settings.options.photon.photons = Some(40_000);
    settings.options.pilot = 10_000;
}

#[test]
fn photons_agree_roughly_and_a_missing_bounce_is_found() {
    let methods = METHODS.map(|contender| short(contender, few));
    let told = compare("cornell", &methods, SHORT);
    for ([_, rival], verdict) in with_the_first(told, &methods) {
        assert!(verdict.rejected.is_empty(), "{rival}: {verdict:?}");
    }
    let cut = short(chains(Method::PhotonSpatial), |settings| {
        few(settings);
        settings.max_depth = 2;
    });
    for (_, verdict) in compare("cornell", &[methods[0], cut], SHORT) {
        assert!(!verdict.rejected.is_empty(), "{verdict:?}");
    }
}

/// Discs of a pixel.
macro_rules! photons_agree {
    ($($name:ident: $words:literal, $look:expr, $least_known:expr;)*) => {$(
        #[test]
        #[ignore = "long; KAUSTIK_KEEP keeps what is done"]
        fn $name() {
            assert_known_equal($words, &METHODS, $look, $least_known);
        }
    )*};
}

photons_agree! {
    photons_agree_on_cornell: "cornell", LONG, TILES * TILES - SPARED;
    photons_agree_on_ring_and_sphere: "ring-and-sphere?light=0.8", LONG, TILES * TILES - SPARED;
    photons_agree_on_glass_cube: "glass-cube?light=0.8", LONG, TILES * TILES - SPARED;
    photons_agree_on_dinner_hall: "dinner-hall", ROUGH, TILES;
    photons_agree_on_villa: "villa", ROUGH, TILES;
    photons_agree_on_canyon: "canyon", ROUGH, TILES * TILES / 2;
    photons_agree_on_underwater: "underwater", ROUGH, TILES * TILES / 2;
}

/// A fifth of a pixel's radius: the error of the kernel goes with its area, and is one part in twenty-five of that of a pixel's disc.
fn small_discs(settings: &mut RenderSettings) {
    by_default(settings);
    settings.options.photon.radius = 0.2;
}

/// Tiles that differ by more than a percent.
fn beyond_a_percent(verdict: &Verdict) -> Vec<usize> {
    let beyond = |told: &&Difference| told.share.abs() > 0.01;
    let told = verdict.differences.iter().filter(beyond);
    told.map(|told| told.tile).collect()
}

/// Every photon method, against bidirectional paths.
macro_rules! small_discs_agree_with_bdpt {
    ($($name:ident: $words:literal, $method:ident;)*) => {$(
        #[test]
        #[ignore = "long; KAUSTIK_KEEP keeps what is done"]
        fn $name() {
            assert_small_discs($words, Method::$method);
        }
    )*};
}

small_discs_agree_with_bdpt! {
    small_discs_of_sppm_are_right_on_cornell: "cornell", Sppm;
    small_discs_of_photon_visibility_are_right_on_cornell: "cornell", PhotonVisibility;
    small_discs_of_photon_density_are_right_on_cornell: "cornell", PhotonDensity;
    small_discs_of_photon_spatial_are_right_on_cornell: "cornell", PhotonSpatial;
    small_discs_of_photon_image_are_right_on_cornell: "cornell", PhotonImage;
    small_discs_of_sppm_are_right_on_ring_and_sphere: "ring-and-sphere?light=0.8", Sppm;
    small_discs_of_photon_visibility_are_right_on_ring_and_sphere: "ring-and-sphere?light=0.8", PhotonVisibility;
    small_discs_of_photon_density_are_right_on_ring_and_sphere: "ring-and-sphere?light=0.8", PhotonDensity;
    small_discs_of_photon_spatial_are_right_on_ring_and_sphere: "ring-and-sphere?light=0.8", PhotonSpatial;
    small_discs_of_photon_image_are_right_on_ring_and_sphere: "ring-and-sphere?light=0.8", PhotonImage;
}

const BDPT: Contender = Contender {
    method: Method::Bdpt,
    block: 1,
    first: 200,
    error: 0.0025,
    ..SPPM
};

/// A percent is two and a half standard errors at least, which the few tiles that are spared may be off by chance.
const SMALL: Look = Look {
    share: 0.004,
    ..LONG
};

fn small(method: Method) -> Contender {
    Contender {
        variant: " small discs",
        first: 64,
        error: 0.003,
        change: small_discs,
        ..chains(method)
    }
}

fn assert_small_discs(words: &str, method: Method) {
    let [(_, verdict)] = &compare(words, &[BDPT, small(method)], SMALL)[..] else {
        panic!("one verdict on two");
    };
    let beyond = beyond_a_percent(verdict);
    assert!(
        beyond.len() <= SPARED,
        "{words}, {method}: {beyond:?} of {verdict:?}"
    );
    assert!(
        verdict.uncertain.len() <= SPARED,
        "{words}, {method}: {verdict:?}"
    );
}

/// Discs of four pixels are found to be off, beyond all noise.
#[test]
#[ignore = "long; KAUSTIK_KEEP keeps what is done"]
fn large_discs_are_found() {
    let large = Contender {
        variant: " large discs",
        first: 4,
        error: 0.007,
        change: |settings| {
            by_default(settings);
            settings.options.photon.radius = 4.0;
        },
        ..small(Method::Sppm)
    };
    let look = Look {
        share: 0.01,
        ..SMALL
    };
    let bdpt = Contender {
        error: 0.006,
        ..BDPT
    };
    for (_, verdict) in compare("cornell", &[bdpt, large], look) {
        let surely = |told: &&Difference| told.share.abs() > 0.01 + 4.0 * told.error;
        let found = verdict.differences.iter().filter(surely).count();
        assert!(found > 2 * SPARED, "{found} of {verdict:?}");
    }
}
