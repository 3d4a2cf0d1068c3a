//! Every variant over a grid of its parameters.

use crate::layers::layers;
use kaustik_bsdf::{
    Bsdf, FilmParameters, Interface, Principled, PrincipledParameters, Reflectance, ThinFilm, Wall,
};
use kaustik_spectrum::Spectrum;

/// A scattering function and what is known of it.
#[derive(Clone)]
pub(crate) struct Case {
    pub(crate) name: String,
    pub(crate) bsdf: Bsdf,
    /// Loses no light.
    pub(crate) lossless: bool,
    /// Hero's index inside over outside, for eta squared; 1 if nothing refracts.
    pub(crate) eta: f64,
    /// Width of its narrowest lobe, about.
    pub(crate) width: f64,
}

impl Case {
    /// Does light change its medium here?
    pub(crate) fn refracts(&self) -> bool {
        (self.eta - 1.0).abs() > 1e-9
    }
}

fn case(name: impl Into<String>, bsdf: Bsdf, lossless: bool, eta: f64, width: f64) -> Case {
    Case {
        name: name.into(),
        bsdf,
        lossless,
        eta,
        width,
    }
}

pub(crate) fn grey(x: f32) -> Spectrum {
    Spectrum::splat(x)
}

const RED: Spectrum = Spectrum::new([0.9, 0.5, 0.3, 0.1]);
const GOLD_ETA: Spectrum = Spectrum::new([0.18, 0.35, 1.3, 1.45]);
const GOLD_K: Spectrum = Spectrum::new([3.4, 2.5, 1.9, 1.8]);
const FLINT: Spectrum = Spectrum::new([1.62, 1.60, 1.65, 1.68]);

/// All but the microfacet grids.
fn plain() -> Vec<Case> {
    vec![
        case(
            "lambertian white",
            Bsdf::lambertian(Spectrum::ONE),
            true,
            1.0,
            1.0,
        ),
        case("lambertian red", Bsdf::lambertian(RED), false, 1.0, 1.0),
        case("mirror", Bsdf::mirror(Spectrum::ONE), true, 1.0, 1.0),
        case("mirror red", Bsdf::mirror(RED), false, 1.0, 1.0),
        case(
            "conductor",
            Bsdf::conductor(GOLD_ETA, GOLD_K, 0.0, true),
            false,
            1.0,
            1.0,
        ),
        case(
            "metal",
            Bsdf::metal(RED, Spectrum::ONE, 0.0, true),
            false,
            1.0,
            1.0,
        ),
        case(
            "coated white",
            Bsdf::coated(Spectrum::ONE, 1.5),
            true,
            1.0,
            1.0,
        ),
        case("coated red", Bsdf::coated(RED, 1.8), false, 1.0, 1.0),
        case(
            "coated thinly",
            Bsdf::coated(Spectrum::ONE, 1.01),
            true,
            1.0,
            1.0,
        ),
        case(
            "phong 20",
            Bsdf::phong(grey(0.4), grey(0.5), 20.0),
            false,
            1.0,
            0.2,
        ),
        case(
            "phong 1000",
            Bsdf::phong(grey(0.0), RED, 1000.0),
            false,
            1.0,
            0.03,
        ),
        case("phong 0", Bsdf::phong(RED, grey(0.5), 0.0), false, 1.0, 1.0),
    ]
}

fn glass(eta: f32) -> Interface {
    Interface::clear(grey(eta))
}

/// Glass that reflects less than its index says, nothing, in colours, by a film.
pub(crate) fn finishes() -> [(&'static str, Reflectance); 4] {
    let schlick = |f0, f90| Reflectance::Schlick { f0, f90 };
    let wavelengths = Spectrum::new([550.0, 430.0, 490.0, 640.0]);
    let film = ThinFilm::new(0.8, 1.4, 420.0, wavelengths, (grey(0.04), 1.0));
    [
        ("dull", schlick(grey(0.012), grey(0.3))),
        ("dark", schlick(grey(0.0), grey(0.0))),
        ("coloured", schlick(RED, grey(0.9))),
        ("filmed", Reflectance::Filmed(film)),
    ]
}

/// Reflectors, solids and panes of the given roughness.
pub(crate) fn facets(alpha: f64, compensation: bool) -> Vec<Case> {
    let lossless = compensation || alpha == 0.0;
    let width = if alpha > 0.0 { alpha } else { 1.0 };
    let tag = if compensation { "" } else { " single" };
    let mut all = vec![
        case(
            format!("gold {alpha}{tag}"),
            Bsdf::conductor(GOLD_ETA, GOLD_K, alpha, compensation),
            false,
            1.0,
            width,
        ),
        case(
            format!("red metal {alpha}{tag}"),
            Bsdf::metal(RED, Spectrum::ONE, alpha, compensation),
            false,
            1.0,
            width,
        ),
        case(
            format!("white metal {alpha}{tag}"),
            Bsdf::metal(Spectrum::ONE, Spectrum::ONE, alpha, compensation),
            lossless,
            1.0,
            width,
        ),
        case(
            format!("pane {alpha}{tag}"),
            Bsdf::thin_dielectric(glass(1.5), alpha, compensation),
            lossless,
            1.0,
            width,
        ),
        case(
            format!("tinted pane {alpha}{tag}"),
            Bsdf::thin_dielectric(Interface::new(FLINT, grey(0.8), RED), alpha, compensation),
            false,
            1.0,
            width,
        ),
        case(
            format!("flint {alpha}{tag}"),
            Bsdf::dielectric(Interface::clear(FLINT), alpha, compensation),
            false, // only where the lanes agree
            1.62,
            width,
        ),
        case(
            format!("red solid {alpha}{tag}"),
            Bsdf::dielectric(
                Interface::new(grey(1.33), grey(0.7), RED),
                alpha,
                compensation,
            ),
            false,
            f64::from(1.33f32),
            width,
        ),
    ];
    for (name, finish) in finishes() {
        let finished = |eta| glass(eta).with_finish(finish);
        all.push(case(
            format!("{name} pane {alpha}{tag}"),
            Bsdf::thin_dielectric(finished(1.5), alpha, compensation),
            lossless,
            1.0,
            width,
        ));
        for eta in [0.75f32, 1.5] {
            all.push(case(
                format!("{name} solid {eta} {alpha}{tag}"),
                Bsdf::dielectric(finished(eta), alpha, compensation),
                alpha == 0.0,
                f64::from(eta),
                width,
            ));
        }
    }
    for eta in [0.75f32, 1.1, 1.5, 2.4] {
        all.push(case(
            format!("glass {eta} {alpha}{tag}"),
            Bsdf::dielectric(glass(eta), alpha, compensation),
            lossless,
            f64::from(eta),
            width,
        ));
    }
    all
}

/// The glTF material of the given roughness, without its shortcuts.
pub(crate) fn principled(roughness: f64) -> Vec<Case> {
    let alpha = roughness * roughness;
    let width = if alpha > 0.0 { alpha } else { 1.0 };
    let white = PrincipledParameters {
        roughness,
        metallic: 0.0,
        ..Default::default()
    };
    let kinds = [
        ("white plastic", white, true),
        (
            "red plastic",
            PrincipledParameters {
                base_color: RED,
                specular: 0.6,
                ..white
            },
            false,
        ),
        (
            "matt",
            PrincipledParameters {
                specular: 0.0,
                ..white
            },
            true,
        ),
        (
            "half metal",
            PrincipledParameters {
                metallic: 0.5,
                ..white
            },
            false,
        ),
        (
            "white half metal",
            PrincipledParameters {
                metallic: 0.5,
                base_color: Spectrum::ONE,
                ..white
            },
            true,
        ),
        (
            "half pane",
            PrincipledParameters {
                transmission: 0.5,
                ..white
            },
            true,
        ),
        (
            "half solid",
            PrincipledParameters {
                transmission: 0.6,
                wall: Wall::Solid,
                ..white
            },
            true,
        ),
        (
            "white leaf",
            PrincipledParameters {
                diffuse_transmission: 0.4,
                ..white
            },
            true,
        ),
        (
            "red leaf",
            PrincipledParameters {
                diffuse_transmission: 0.7,
                diffuse_transmission_color: RED,
                base_color: Spectrum::new([0.1, 0.5, 0.2, 0.9]),
                metallic: 0.2,
                transmission: 0.3,
                ..white
            },
            false,
        ),
        (
            "all of it",
            PrincipledParameters {
                metallic: 0.3,
                transmission: 0.6,
                base_color: RED,
                specular: 0.7,
                specular_color: Spectrum::new([2.0, 1.0, 0.5, 0.2]),
                wall: Wall::Solid,
                ior: FLINT,
                ..white
            },
            false,
        ),
        (
            "filmed glass",
            PrincipledParameters {
                transmission: 0.9,
                specular: 0.8,
                film: Some(FilmParameters {
                    strength: 1.0,
                    ior: 1.3,
                    thickness: 300.0,
                    wavelengths: Spectrum::new([550.0, 430.0, 490.0, 640.0]),
                }),
                ..white
            },
            false,
        ),
        (
            "single",
            PrincipledParameters {
                compensation: false,
                metallic: 0.2,
                transmission: 0.3,
                ..white
            },
            false,
        ),
    ];
    kinds
        .into_iter()
        .map(|(name, p, lossless)| {
            let lossless = lossless && p.compensation;
            let solid = p.wall == Wall::Solid;
            let eta = if solid { f64::from(p.ior.hero()) } else { 1.0 };
            let bsdf = Bsdf::Principled(Principled::new(&p));
            let width = if name == "matt" { 1.0 } else { width };
            case(
                format!("principled {name} {roughness}"),
                bsdf,
                lossless,
                eta,
                width,
            )
        })
        .collect()
}

/// A bit of everything, for the fast half of the tests.
pub(crate) fn some() -> Vec<Case> {
    let mut all = plain();
    for alpha in [0.0, 0.01, 0.1, 0.5, 1.0] {
        all.extend(facets(alpha, true));
    }
    all.extend(facets(0.3, false));
    for roughness in [0.0, 0.2, 0.5, 1.0] {
        all.extend(principled(roughness));
        all.extend(layers(roughness));
    }
    all.extend(passable());
    all
}

/// What is left of smooth panes where light that passes is not scattered.
fn passable() -> Vec<Case> {
    let mut all = facets(0.0, true);
    all.extend(principled(0.0));
    let passes = |case: &Case| case.bsdf.passable() != case.bsdf;
    let panes = all.into_iter().filter(passes).map(|case| Case {
        name: format!("passable {}", case.name),
        bsdf: case.bsdf.passable(),
        lossless: false,
        ..case
    });
    panes.collect()
}
