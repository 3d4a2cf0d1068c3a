//! The extensions' materials over a grid: sheen, clearcoat, anisotropy, films, rough diffuse surfaces.

use crate::catalogue::{Case, grey};
use kaustik_bsdf::{Bsdf, FilmParameters, LayerParameters, Principled, PrincipledParameters, Wall};
use kaustik_spectrum::Spectrum;

const RED: Spectrum = Spectrum::new([0.9, 0.5, 0.3, 0.1]);

fn case(name: String, bsdf: Bsdf, lossless: bool, eta: f64, width: f64) -> Case {
    Case {
        name,
        bsdf,
        lossless,
        eta,
        width,
    }
}

/// A film of 1.3 over whatever it is, at four wavelengths.
pub(crate) fn film(thickness: f64) -> FilmParameters {
    FilmParameters {
        strength: 1.0,
        ior: 1.3,
        thickness,
        wavelengths: Spectrum::new([550.0, 430.0, 610.0, 700.0]),
    }
}

/// All of them at about this perceptual roughness.
pub(crate) fn layers(roughness: f64) -> Vec<Case> {
    let alpha = roughness * roughness;
    let width = if alpha > 0.0 { alpha } else { 1.0 };
    let plastic = PrincipledParameters {
        roughness,
        metallic: 0.0,
        ..Default::default()
    };
    let metal = PrincipledParameters {
        metallic: 1.0,
        ..plastic
    };
    let red = PrincipledParameters {
        base_color: RED,
        ..plastic
    };
    let solid = PrincipledParameters {
        transmission: 0.8,
        wall: Wall::Solid,
        ..plastic
    };
    let leaf = PrincipledParameters {
        diffuse_transmission: 0.6,
        diffuse_transmission_color: RED,
        ..plastic
    };
    let coat = |clearcoat, clearcoat_roughness| LayerParameters {
        clearcoat,
        clearcoat_roughness,
        ..Default::default()
    };
    let sheen = |sheen_color, sheen_roughness| LayerParameters {
        sheen_color,
        sheen_roughness,
        ..Default::default()
    };
    let both = LayerParameters {
        sheen_color: RED,
        sheen_roughness: 0.4,
        ..coat(0.7, 0.2)
    };
    let brushed = |anisotropy, p: PrincipledParameters| {
        Bsdf::Principled(Principled::new(&PrincipledParameters { anisotropy, ..p }))
    };
    let filmed = |thickness, p: PrincipledParameters| {
        let film = Some(film(thickness));
        Bsdf::Principled(Principled::new(&PrincipledParameters { film, ..p }))
    };
    let name = |what: &str| format!("{what} {roughness}");
    let along = alpha.max(0.05);
    vec![
        case(
            name("clear on plastic"),
            Bsdf::layered(&red, &coat(1.0, 0.0)),
            false,
            1.0,
            width,
        ),
        case(
            name("frost on plastic"),
            Bsdf::layered(&plastic, &coat(0.8, 0.5)),
            false,
            1.0,
            width,
        ),
        case(
            name("clear on metal"),
            Bsdf::layered(&metal, &coat(1.0, 0.0)),
            false,
            1.0,
            width,
        ),
        case(
            name("rough on metal"),
            Bsdf::layered(&metal, &coat(1.0, 1.0)),
            false,
            1.0,
            width,
        ),
        case(
            name("clear on leaf"),
            Bsdf::layered(&leaf, &both),
            false,
            1.0,
            width,
        ),
        case(name("brushed leaf"), brushed(0.7, leaf), false, 1.0, width),
        case(
            name("clear on solid"),
            Bsdf::layered(&solid, &coat(1.0, 0.1)),
            false,
            f64::from(1.5f32),
            width,
        ),
        case(
            name("cloth"),
            Bsdf::layered(&red, &sheen(grey(0.9), 0.3)),
            false,
            1.0,
            width,
        ),
        case(
            name("velvet"),
            Bsdf::layered(
                &plastic,
                &LayerParameters {
                    sheen_shade: 0.95,
                    ..sheen(RED, 0.8)
                },
            ),
            false,
            1.0,
            width,
        ),
        case(
            name("silk on metal"),
            Bsdf::layered(&metal, &sheen(Spectrum::ONE, 0.1)),
            false,
            1.0,
            width,
        ),
        case(
            name("varnished cloth"),
            Bsdf::layered(&plastic, &both),
            false,
            1.0,
            width,
        ),
        case(
            name("brushed metal"),
            brushed(0.6, metal),
            false,
            1.0,
            along,
        ),
        case(
            name("brushed plastic"),
            brushed(1.0, red),
            false,
            1.0,
            along,
        ),
        case(
            name("soap on plastic"),
            filmed(300.0, plastic),
            roughness == 0.0,
            1.0,
            width,
        ),
        case(
            name("oil on metal"),
            filmed(
                700.0,
                PrincipledParameters {
                    base_color: RED,
                    ..metal
                },
            ),
            false,
            1.0,
            width,
        ),
        case(
            name("film on half metal"),
            Bsdf::Principled(Principled::new(&PrincipledParameters {
                base_color: Spectrum::ONE,
                metallic: 0.5,
                film: Some(FilmParameters {
                    ior: 1.1,
                    ..film(200.0)
                }),
                ..plastic
            })),
            false,
            1.0,
            width,
        ),
        case(
            name("plaster"),
            Bsdf::oren_nayar(Spectrum::ONE, roughness.max(0.01)),
            true,
            1.0,
            1.0,
        ),
        case(
            name("clay"),
            Bsdf::oren_nayar(RED, roughness.max(0.01)),
            false,
            1.0,
            1.0,
        ),
    ]
}
