//! Kitaoka, Kitamura and Kishino 2009.

use kaustik::Method;
use kaustik::film::Window;

use super::checks::{carries_the_dark, more_effective, starts_within};
use super::rivals::{lower, lower_always};
use super::{FigureScale, PaperFigure, blank, minutes, seconds, settings};
use crate::{Budgets, Claim, Figure, Finding, MethodEntry, Results, SceneEntry, Study};

pub(super) fn figures(scale: FigureScale) -> Vec<PaperFigure> {
    vec![
        four(scale),
        five(scale),
        six(scale),
        seven(scale),
        eight(scale),
    ]
}

const GLASS: &str = "glass-cube";
const WATER: &str = "water-cornell";

/// The paper's spectra where its figures are made as it made them: one wavelength from 400 to 700 nm.
fn spectra(scale: FigureScale) -> &'static [&'static str] {
    match scale {
        FigureScale::AsPublished => &["wavelengths=uniform"],
        FigureScale::Quick | FigureScale::Usual => &[],
    }
}

fn entry(
    scale: FigureScale,
    name: &str,
    method: Method,
    start: &str,
    more: &[&str],
) -> MethodEntry {
    let all: Vec<&str> = spectra(scale).iter().chain(more).copied().collect();
    MethodEntry {
        name: name.to_owned(),
        method,
        settings: settings(scale, start, &all),
        amounts: None,
    }
}

/// The methods of every figure.
fn rivals(scale: FigureScale) -> Vec<MethodEntry> {
    let builder = ["builder=bidirectional"];
    vec![
        entry(scale, "bdpt", Method::Bdpt, "pilot=2000", &[]),
        entry(scale, "pssmlt", Method::Pssmlt, "pilot=2000", &builder),
        entry(scale, SMLT, Method::Pssmlt, "pilot=2000", &SMLT_AS_PRINTED),
        fmlt(scale),
        relt(scale, "relt", &[]),
        relt(scale, PRINTED, &AS_PRINTED),
    ]
}

const PRINTED: &str = "relt as printed";
/// The paper's own, as far as settings go; what they leave is told with the setting `replicas`.
const AS_PRINTED: [&str; 7] = [
    "replicas=paper",
    "exchange=pair",
    "steps=paper",
    "normaliser=exchange",
    "even=0",
    "direct=together",
    "meter=off",
];

const SMLT: &str = "smlt as printed";
/// The paper's second rival, Kelemen's: "only computes the normalization term for MIS in the initialization phase".
const SMLT_AS_PRINTED: [&str; 3] = ["builder=bidirectional", "mis=printed", "direct=together"];

/// FMLT, the paper's third rival: path-space mutations, direct light left out of what the chains follow.
fn fmlt(scale: FigureScale) -> MethodEntry {
    let more = ["mutations=bidirectional,lens,caustic", "direct=apart"];
    entry(scale, "fmlt", Method::Mlt, "pilot=2000", &more)
}

fn relt(scale: FigureScale, name: &str, more: &[&str]) -> MethodEntry {
    entry(scale, name, Method::Relt, "particles=1000", more)
}

/// What replica exchange begins with, and nothing after it.
fn annealing(scale: FigureScale) -> MethodEntry {
    entry(scale, "annealing", Method::Annealing, "particles=1000", &[])
}

fn budgets(scale: FigureScale, published: f64) -> Budgets {
    match scale {
        FigureScale::Quick => seconds(&[0.1, 0.25]),
        FigureScale::Usual => seconds(&[1.0, 2.0, 4.0, 8.0, 16.0]),
        FigureScale::AsPublished => minutes(published),
    }
}

/// A study of one figure, with the paper's size where it is wanted.
fn study(scale: FigureScale, title: &str, about: &str, published: (u32, f64)) -> Study {
    let mut study = blank(title, about, scale);
    study.budgets = budgets(scale, published.1);
    if scale == FigureScale::AsPublished {
        (study.width, study.height) = (published.0, published.0);
    }
    study.reference.settings = spectra(scale).iter().map(|&s| s.to_owned()).collect();
    study.methods = rivals(scale);
    study
}

/// Light that is specular, diffuse, specular: what uniform samples find too seldom for a reference.
fn caustics(study: &mut Study, scale: FigureScale) {
    if scale != FigureScale::Quick {
        study.reference.method = Method::Pssmlt;
        study
            .reference
            .settings
            .push("builder=bidirectional".to_owned());
        // its noise cancels between its halves; renders long enough for chains to have been everywhere
        study.reference.per_pixel = 1024;
        study.reference.error = 0.1;
        study.reference.most = 16;
    }
}

/// A part of the picture by shares of its sides.
fn part(study: &Study, [x0, y0, x1, y1]: [f64; 4]) -> Window {
    let at = |share: f64, side: u32| (share * f64::from(side)).round() as u32;
    Window {
        x0: at(x0, study.width),
        y0: at(y0, study.height),
        x1: at(x1, study.width).max(at(x0, study.width) + 1),
        y1: at(y1, study.height).max(at(y0, study.height) + 1),
    }
}

fn four(scale: FigureScale) -> PaperFigure {
    const SCENE: &str = "cornell-direct";
    let mut study = study(
        scale,
        "Figure 4: direct light",
        "A diffuse box under a large lamp. As published: 400 x 400 pixels, 10 minutes. SMLT is pssmlt over bidirectional \
         paths, by our defaults and as Kelemen has it; FMLT is mlt with three mutations; plain path tracing is added.",
        (400, 10.0),
    );
    study.scenes = vec![SceneEntry::builtin(SCENE)];
    study
        .methods
        .push(entry(scale, "path", Method::Path, "pilot=2000", &[]));
    PaperFigure {
        number: 4,
        study,
        claims: &[
            Claim {
                text: "5.2.1: at any time a lower error than BPT and SMLT",
                check: |r| lower_always(r, SCENE, Figure::RmseXyz, "relt", &["bdpt", "pssmlt"]),
            },
            Claim {
                text: PAPERS_OWN,
                check: |r| {
                    let rivals = ["bdpt", SMLT];
                    lower_always(r, SCENE, Figure::RmseXyz, PRINTED, &rivals)
                },
            },
            Claim {
                text: "5.2.1: an error level equivalent to FMLT; here: at most 1.25 times its error",
                check: |r| lower(r, SCENE, Figure::RmseXyz, "relt", &[("fmlt", 1.25)]),
            },
            Claim {
                text: OURS_IN_THE_OPEN,
                check: |r| not_above(r, SCENE),
            },
            Claim {
                text: "Our expectation: plain path tracing wins where light is diffuse and mainly direct",
                check: |r| {
                    let rivals = [("bdpt", 1.0), ("pssmlt", 1.0), ("relt", 1.0)];
                    lower(r, SCENE, Figure::RmseXyz, "path", &rivals)
                },
            },
        ],
    }
}

const APART: &str = "relt, direct light apart";

fn five(scale: FigureScale) -> PaperFigure {
    const SCENE: &str = "cornell-indirect";
    let mut study = study(
        scale,
        "Figure 5: indirect light",
        "The same box lit by way of the ceiling. As published: 400 x 400 pixels, 10 minutes. Population annealing alone \
         is added, and relt with direct light apart, as FMLT has it.",
        (400, 10.0),
    );
    study.scenes = vec![SceneEntry::builtin(SCENE)];
    study.methods.push(annealing(scale));
    study.methods.push(relt(scale, APART, &["direct=apart"]));
    PaperFigure {
        number: 5,
        study,
        claims: &[
            Claim {
                text: "5.2.1: at any time a lower error than BPT, SMLT and FMLT",
                check: |r| {
                    let rivals = ["bdpt", "pssmlt", "fmlt"];
                    lower_always(r, SCENE, Figure::RmseXyz, "relt", &rivals)
                },
            },
            Claim {
                text: PAPERS_OWN,
                check: |r| {
                    let rivals = ["bdpt", SMLT, "fmlt"];
                    lower_always(r, SCENE, Figure::RmseXyz, PRINTED, &rivals)
                },
            },
            Claim {
                text: "The same against FMLT, direct light apart in both",
                check: |r| lower_always(r, SCENE, Figure::RmseXyz, APART, &["fmlt"]),
            },
            Claim {
                text: ANNEALING,
                check: |r| lower(r, SCENE, Figure::RmseXyz, "relt", &[("annealing", 1.0)]),
            },
            Claim {
                text: OURS_IN_THE_OPEN,
                check: |r| not_above(r, SCENE),
            },
        ],
    }
}

/// The paper leaves open how good annealing alone is as a renderer (sec. 6).
const ANNEALING: &str = "Our expectation (sec. 6 leaves it open): relt is below annealing alone";

const PAPERS_OWN: &str = "The same as the paper has it, against SMLT as Kelemen has it";
const RIVALS: [(&str, f64); 3] = [("bdpt", 1.0), ("pssmlt", 1.0), ("fmlt", 1.0)];
const PAPERS_RIVALS: [(&str, f64); 3] = [("bdpt", 1.0), (SMLT, 1.0), ("fmlt", 1.0)];

/// What we want where samples find all light.
const OURS_IN_THE_OPEN: &str = "Our goal: a relative MSE not above bdpt's and pssmlt's";

fn not_above(results: &Results, place: &str) -> Finding {
    let rivals = [("bdpt", 1.0), ("pssmlt", 1.0)];
    lower(results, place, Figure::RelativeMse, "relt", &rivals)
}

/// What we want of `relt` on a scene of caustics, besides what the paper says.
const GOAL: [(&str, f64); 2] = [("bdpt", 0.25), ("pssmlt", 2.0 / 3.0)];

fn six(scale: FigureScale) -> PaperFigure {
    let mut study = study(
        scale,
        "Figure 6: caustics seen through glass",
        "A yellow cube cast in glass under a small lamp. As published: 800 x 800 pixels, 20 minutes. The parts of relt's \
         picture are its replicas: uniform, full, indirect, specific. Population annealing alone is added.",
        (800, 20.0),
    );
    caustics(&mut study, scale);
    study.methods.push(annealing(scale));
    study.layers = true;
    study.scenes = vec![SceneEntry::builtin(GLASS)];
    study.scenes[0].close_ups = vec![part(&study, [0.55, 0.55, 0.85, 0.85])];
    PaperFigure {
        number: 6,
        study,
        claims: &[
            Claim {
                text: "5.2.2: in equal time better than BPT, SMLT and FMLT",
                check: |r| lower(r, GLASS, Figure::RelativeMse, "relt", &RIVALS),
            },
            Claim {
                text: PAPERS_OWN,
                check: |r| lower(r, GLASS, Figure::RelativeMse, PRINTED, &PAPERS_RIVALS),
            },
            Claim {
                text: "Our goal: a quarter of bdpt's relative MSE, two thirds of pssmlt's",
                check: |r| lower(r, GLASS, Figure::RelativeMse, "relt", &GOAL),
            },
            Claim {
                text: ANNEALING,
                check: |r| lower(r, GLASS, Figure::RelativeMse, "relt", &[("annealing", 1.0)]),
            },
            Claim {
                text: "5.2.2: the uniform replica renders the darker areas (as printed; ours sends it samples spread evenly as well)",
                check: |r| carries_the_dark(r, GLASS, PRINTED, "replica-1"),
            },
            Claim {
                text: "4.3: annealing leaves the specific replica more effective particles than resampling at once",
                check: |r| more_effective(r, GLASS, PRINTED, 3),
            },
            Claim {
                text: "5.1.2: a start of 10,000 samples takes less than a second",
                check: |r| starts_within(r, "relt", 1.0),
            },
        ],
    }
}

fn seven(scale: FigureScale) -> PaperFigure {
    let mut study = study(
        scale,
        "Figure 7: a box filled with water",
        "Caustics on the floor, seen through the surface. As published: 800 x 800 pixels, 60 minutes, with close-ups.",
        (800, 60.0),
    );
    caustics(&mut study, scale);
    study.scenes = vec![SceneEntry::builtin(WATER)];
    study.scenes[0].close_ups = vec![
        part(&study, [0.1, 0.6, 0.45, 0.95]),
        part(&study, [0.55, 0.6, 0.9, 0.95]),
    ];
    PaperFigure {
        number: 7,
        study,
        claims: &[
            Claim {
                text: "5.2.2: smoother than BPT, SMLT and FMLT in equal time",
                check: |r| lower(r, WATER, Figure::RelativeMse, "relt", &RIVALS),
            },
            Claim {
                text: PAPERS_OWN,
                check: |r| lower(r, WATER, Figure::RelativeMse, PRINTED, &PAPERS_RIVALS),
            },
            Claim {
                text: "Our goal: a quarter of bdpt's relative MSE, two thirds of pssmlt's",
                check: |r| lower(r, WATER, Figure::RelativeMse, "relt", &GOAL),
            },
            Claim {
                text: "5.1.2: a start of 10,000 samples takes less than a second",
                check: |r| starts_within(r, "relt", 1.0),
            },
        ],
    }
}

/// The default replicas have scouts and three steps for the specific one; the paper's have neither.
const OURS: &str = "relt";
const OURS_APART: &str = "relt without exchange";
const PRINTED_APART: &str = "relt as printed, without exchange";
const PAPERS: &str = "paper's replicas";
const PAPERS_APART: &str = "paper's replicas without exchange";

fn eight(scale: FigureScale) -> PaperFigure {
    let mut study = study(
        scale,
        "Figure 8: without exchange",
        "The scenes of Figures 6 and 7 without exchanges between replicas (as published in the same times; here \
         both in 20 minutes): all as the paper has it; its four replicas with what else is ours by default; and the default \
         ones, whose specific replica has scouts as well, by which it comes to new places without any exchange.",
        (800, 20.0),
    );
    caustics(&mut study, scale);
    study.scenes = vec![SceneEntry::builtin(GLASS), SceneEntry::builtin(WATER)];
    // Of a setting that stands twice the last counts.
    let printed_apart = [&AS_PRINTED[..], &["exchange=none"]].concat();
    study.methods = vec![
        relt(scale, PRINTED, &AS_PRINTED),
        relt(scale, PRINTED_APART, &printed_apart),
        relt(scale, PAPERS, &["replicas=paper"]),
        relt(scale, PAPERS_APART, &["replicas=paper", "exchange=none"]),
        relt(scale, OURS, &[]),
        relt(scale, OURS_APART, &["exchange=none"]),
    ];
    PaperFigure {
        number: 8,
        study,
        claims: &[
            Claim {
                text: "5.2.2: without exchange the pictures are obviously imperfect; here: all as in the paper, at least \
                       twice the relative MSE (glass)",
                check: |r| twice_without(r, GLASS, [PRINTED, PRINTED_APART]),
            },
            Claim {
                text: "The same (water)",
                check: |r| twice_without(r, WATER, [PRINTED, PRINTED_APART]),
            },
            Claim {
                text: "With the paper's replicas, and what else is ours, at least twice the relative MSE (glass)",
                check: |r| twice_without(r, GLASS, [PAPERS, PAPERS_APART]),
            },
            Claim {
                text: "The same (water)",
                check: |r| twice_without(r, WATER, [PAPERS, PAPERS_APART]),
            },
            Claim {
                text: "Our goal: at least twice the relative MSE with the default replicas as well (glass)",
                check: |r| twice_without(r, GLASS, [OURS, OURS_APART]),
            },
            Claim {
                text: "The same (water)",
                check: |r| twice_without(r, WATER, [OURS, OURS_APART]),
            },
        ],
    }
}

/// The first has at most half of the second's error.
fn twice_without(results: &Results, place: &str, [with, without]: [&str; 2]) -> Finding {
    lower(results, place, Figure::RelativeMse, with, &[(without, 0.5)])
}
