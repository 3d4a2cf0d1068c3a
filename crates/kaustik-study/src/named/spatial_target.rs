//! Gruson et al. 2016, with Hachisuka and Jensen 2009 and 2011.

mod chains;
mod function;

use kaustik::Method;

use super::evenness::evener;
use super::lacks::{has_again, lacks_more};
use super::over_time::everywhere;
use super::rivals::{lower, lower_nsd};
use super::{FigureScale, PaperFigure, blank, minutes, seconds, settings};
use crate::{Claim, Figure, MethodEntry, ReferenceEntry, SceneEntry, Study};

pub(super) fn figures(scale: FigureScale) -> Vec<PaperFigure> {
    vec![
        one(scale),
        function::three(scale),
        four(scale),
        chains::five(scale),
        chains::six(scale),
        seven(scale),
        function::eight(scale),
        nine(scale),
        ten(scale),
        eleven(scale),
    ]
}

const HALL: &str = "dinner-hall";
const VILLA: &str = "villa";
const UNDERWATER: &str = "underwater";
const CANYON: &str = "canyon";
const BALLS: &str = "mirror-balls";
const TEA: &str = "tea-time";
/// Of the paper's Figures 7 to 9.
const FOUR: [&str; 4] = [HALL, VILLA, UNDERWATER, CANYON];

fn entry(scale: FigureScale, name: &str, method: Method, more: &[&str]) -> MethodEntry {
    let mut settings = settings(scale, "pilot=2000", more);
    settings.push(match scale {
        FigureScale::Quick => "photons=2000".to_owned(),
        FigureScale::Usual => "photons=250000".to_owned(),
        FigureScale::AsPublished => "photons=10000000".to_owned(),
    });
    // The paper's discs stay.
    settings.push("reduction=off".to_owned());
    if method == Method::Sppm {
        // nothing but light paths
        settings.retain(|setting| !setting.starts_with("pilot"));
    }
    MethodEntry {
        name: name.to_owned(),
        method,
        settings,
        amounts: None,
    }
}

fn sppm(scale: FigureScale) -> MethodEntry {
    entry(scale, "sppm", Method::Sppm, &[])
}

fn visibility(scale: FigureScale) -> MethodEntry {
    entry(scale, "visibility", Method::PhotonVisibility, &[])
}

fn image(scale: FigureScale) -> MethodEntry {
    entry(scale, "image", Method::PhotonImage, &[])
}

fn spatial(scale: FigureScale, name: &str, more: &[&str]) -> MethodEntry {
    entry(scale, name, Method::PhotonSpatial, more)
}

/// A scene with a reference of its own where bidirectional paths do not do: under water nearly all light is the sun's, by way of
/// the surface, which they meet too seldom; independent photons, with discs as large as those of the methods, do.
fn place(scale: FigureScale, name: &str) -> SceneEntry {
    let mut entry = SceneEntry::builtin(name);
    if name == UNDERWATER && scale != FigureScale::Quick {
        entry.reference = Some(ReferenceEntry {
            method: Method::Sppm,
            settings: sppm(scale).settings,
            per_pixel: 64,
            error: 0.02,
            most: 32,
        });
    }
    entry
}

/// A study of some scenes at equal times; as published for so many minutes.
fn study(scale: FigureScale, title: &str, about: &str, scenes: &[&str], published: f64) -> Study {
    let mut study = blank(title, about, scale);
    study.scenes = scenes.iter().map(|scene| place(scale, scene)).collect();
    (study.width, study.height) = match scale {
        FigureScale::Quick => (32, 18),
        FigureScale::Usual => (128, 72),
        FigureScale::AsPublished => (960, 540),
    };
    study.max_depth = study.max_depth.min(16);
    if scale == FigureScale::Quick {
        // many textures and triangles: a few paths a pixel show that it works
        study.reference.per_pixel = 4;
    }
    study.budgets = match scale {
        FigureScale::Quick => seconds(&[0.1, 0.2]),
        FigureScale::Usual => seconds(&[5.0, 10.0, 20.0]),
        FigureScale::AsPublished => minutes(published),
    };
    study
}

fn one(scale: FigureScale) -> PaperFigure {
    let mut study = study(
        scale,
        "Figure 1: regions of space and regions of the image",
        "A bright garden and a dim room with a mirror in it, which shows both side by side.",
        &[VILLA],
        30.0,
    );
    study.methods = vec![
        visibility(scale),
        image(scale),
        spatial(scale, "spatial", &[]),
    ];
    PaperFigure {
        number: 1,
        study,
        claims: &[
            Claim {
                text: "Fig. 1: less noise than with the visibility target",
                check: |r| lower_nsd(r, VILLA, "spatial", &[("visibility", 1.0)]),
            },
            Claim {
                text: "Sec. 5: at worst little more noise than by regions of the image (our goal: at most 1.1 times)",
                check: |r| lower_nsd(r, VILLA, "spatial", &[("image", 1.1)]),
            },
            Claim {
                text: "Fig. 1: less than by regions of the image, which mix what is seen in the mirror with what is beside it",
                check: |r| lower_nsd(r, VILLA, "spatial", &[("image", 1.0)]),
            },
        ],
    }
}

fn four(scale: FigureScale) -> PaperFigure {
    let mut study = study(
        scale,
        "Figure 4: relative error, evenly",
        "Layers show the target with its factors and regions, and how often points are touched.",
        &[HALL, CANYON],
        10.0,
    );
    study.layers = true;
    study.methods = vec![
        entry(scale, "visibility", Method::PhotonVisibility, &["maps=on"]),
        spatial(scale, "spatial", &["maps=on"]),
    ];
    PaperFigure {
        number: 4,
        study,
        claims: &[
            Claim {
                text: "Fig. 4: the relative error is even; our goal: the 95th over the 5th percentile over tiles is at most \
                       1/3 of the visibility target's (dinner-hall)",
                check: |r| evener(r, HALL, "spatial", "visibility", 1.0 / 3.0),
            },
            Claim {
                text: "The same on the canyon",
                check: |r| evener(r, CANYON, "spatial", "visibility", 1.0 / 3.0),
            },
        ],
    }
}

fn seven(scale: FigureScale) -> PaperFigure {
    let mut study = study(
        scale,
        "Figure 7: four scenes",
        "Equal times. As published: an hour each at 960x540 and 10 million light paths an iteration.",
        &FOUR,
        60.0,
    );
    study.methods = vec![
        sppm(scale),
        visibility(scale),
        entry(scale, "density", Method::PhotonDensity, &[]),
        image(scale),
        spatial(scale, "spatial", &[]),
    ];
    PaperFigure {
        number: 7,
        study,
        claims: &[
            Claim {
                text: "Sec. 5: less noise than with the visibility target; our goal: half of it (dinner-hall)",
                check: |r| lower_nsd(r, HALL, "spatial", &[("visibility", 0.5)]),
            },
            Claim {
                text: "Our goal: half of it (villa)",
                check: |r| lower_nsd(r, VILLA, "spatial", &[("visibility", 0.5)]),
            },
            Claim {
                text: "Less of it under water",
                check: |r| lower_nsd(r, UNDERWATER, "spatial", &[("visibility", 1.0)]),
            },
            Claim {
                text: "Our goal under water: at most 1.1 times that by regions of the image",
                check: |r| lower_nsd(r, UNDERWATER, "spatial", &[("image", 1.1)]),
            },
            Claim {
                text: "Less of it in the canyon",
                check: |r| lower_nsd(r, CANYON, "spatial", &[("visibility", 1.0)]),
            },
            Claim {
                text: "Sec. 5: a lower RMSE in all four scenes",
                check: |r| {
                    everywhere(&FOUR, |place| {
                        let rivals = [("visibility", 1.0)];
                        lower(r, place, Figure::RmseXyz, "spatial", &rivals)
                    })
                },
            },
        ],
    }
}

/// Methods that follow light to the camera.
fn transport(scale: FigureScale) -> Vec<MethodEntry> {
    let both = ["builder=bidirectional"];
    let methods: [(Method, &[&str]); 7] = [
        (Method::Pssmlt, &both),
        (Method::PssmltMultistage, &both),
        (Method::Mlt, &[]),
        (Method::MltMultistage, &[]),
        (Method::Path, &[]),
        (Method::Bdpt, &[]),
        (Method::Erpt, &[]),
    ];
    let entry = |(method, more): (Method, &[&str])| MethodEntry {
        name: method.to_string(),
        method,
        settings: settings(scale, "pilot=2000", more),
        amounts: None,
    };
    methods.into_iter().map(entry).collect()
}

/// The paper rescales them: their chains do not know how bright the picture is as a whole.
const MATCHED: [&str; 4] = ["pssmlt", "pssmlt-multistage", "mlt", "mlt-multistage"];

/// What is claimed of Figure 9.
const NINE: &[Claim] = &[
    Claim {
        text: "Fig. 9: less noise than primary-sample light transport, also in stages (dinner-hall)",
        check: |r| {
            let rivals = [("pssmlt", 1.0), ("pssmlt-multistage", 1.0)];
            lower_nsd(r, HALL, "spatial", &rivals)
        },
    },
    Claim {
        text: "Less noise than light transport on paths, also in stages (dinner-hall)",
        check: |r| {
            let rivals = [("mlt", 1.0), ("mlt-multistage", 1.0)];
            lower_nsd(r, HALL, "spatial", &rivals)
        },
    },
    Claim {
        text: "The same (villa)",
        check: |r| {
            let rivals = [("mlt", 1.0), ("mlt-multistage", 1.0)];
            lower_nsd(r, VILLA, "spatial", &rivals)
        },
    },
    Claim {
        text: "Light transport on paths is ahead on the diffuse canyon",
        check: |r| lower_nsd(r, CANYON, "mlt", &[("spatial", 1.0)]),
    },
    Claim {
        text: "Hoberock and Hart 2010: stages even out the relative error (dinner-hall)",
        check: |r| evener(r, HALL, "mlt-multistage", "mlt", 1.0),
    },
    Claim {
        text: "The same on primary samples (dinner-hall)",
        check: |r| evener(r, HALL, "pssmlt-multistage", "pssmlt", 1.0),
    },
    Claim {
        text: "Stages make less noise (dinner-hall)",
        check: |r| lower_nsd(r, HALL, "mlt-multistage", &[("mlt", 1.0)]),
    },
];

fn nine(scale: FigureScale) -> PaperFigure {
    let scenes = match scale {
        FigureScale::Quick => &[HALL][..],
        FigureScale::Usual | FigureScale::AsPublished => &FOUR,
    };
    let mut study = study(
        scale,
        "Figure 9: against Metropolis light transport",
        "Equal times, with light that photons cannot carry; the multi-stage methods of Hoberock and Hart even out the relative error, as \
         the spatial target function does. Path tracing, bidirectional path tracing and energy redistribution are in the paper's \
         supplement. Pictures, errors and differences of Metropolis light transport are shown at the reference's brightness, as in \
         the paper. As published: an hour each.",
        scenes,
        60.0,
    );
    study.methods = transport(scale);
    study.matched = MATCHED.map(str::to_owned).to_vec();
    study.methods.push(spatial(scale, "spatial", &[]));
    PaperFigure {
        number: 9,
        study,
        claims: NINE,
    }
}

fn ten(scale: FigureScale) -> PaperFigure {
    let mut study = study(
        scale,
        "Figure 10: a simple scene",
        "Most uniform light paths are seen: chains have nothing to win. As published: five minutes.",
        &[BALLS],
        5.0,
    );
    study.methods = vec![sppm(scale), spatial(scale, "spatial", &[])];
    PaperFigure {
        number: 10,
        study,
        claims: &[Claim {
            text: "Sec. 5: not significantly worse than independent photons; our goal: at most 1.2 times their noise",
            check: |r| lower_nsd(r, BALLS, "spatial", &[("sppm", 1.2)]),
        }],
    }
}

fn eleven(scale: FigureScale) -> PaperFigure {
    let mut study = study(
        scale,
        "Figure 11: glossy surfaces",
        "Roughness thresholds 0.05 and 0.39, the remainder by path tracing: it is the part of a picture of that name. Without it \
         what photons cannot carry is missing; where, the red of the signed differences shows.",
        &[TEA],
        60.0,
    );
    study.methods = vec![
        entry(
            scale,
            "visibility, 0.05",
            Method::PhotonVisibility,
            &["roughness=0.05"],
        ),
        spatial(scale, "spatial, 0.05", &["roughness=0.05"]),
        entry(scale, "visibility, 0.39", Method::PhotonVisibility, &[]),
        spatial(scale, "spatial, 0.39", &[]),
        spatial(
            scale,
            "no remainder, 0.05",
            &["roughness=0.05", "remainder=off"],
        ),
        spatial(scale, "no remainder, 0.39", &["remainder=off"]),
    ];
    study.layers = true;
    PaperFigure {
        number: 11,
        study,
        claims: &[
            Claim {
                text: "Sec. 5: better than the visibility target at either threshold (0.05)",
                check: |r| lower_nsd(r, TEA, "spatial, 0.05", &[("visibility, 0.05", 1.0)]),
            },
            Claim {
                text: "The same (0.39)",
                check: |r| lower_nsd(r, TEA, "spatial, 0.39", &[("visibility, 0.39", 1.0)]),
            },
            Claim {
                text: "The high threshold has less noise",
                check: |r| lower_nsd(r, TEA, "spatial, 0.39", &[("spatial, 0.05", 1.0)]),
            },
            Claim {
                text: "Sec. 5: by photons alone light is missing at the threshold 0.39; path tracing brings it back",
                check: |r| has_again(r, TEA, "spatial, 0.39", "no remainder, 0.39"),
            },
            Claim {
                text: "At 0.05 less of it is missing",
                check: |r| lacks_more(r, TEA, "no remainder, 0.39", "no remainder, 0.05"),
            },
        ],
    }
}
