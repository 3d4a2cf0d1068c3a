//! Batty's report on Cline, Talbot and Egbert 2005.

use kaustik::Method;
use kaustik::film::Window;

use super::checks::{cost_of_a_step, few_spikes, last, same_tint, statistic_above, tint_differs};
use super::rivals::{best_in_time, lower, lower_in_time};
use super::{FigureScale, PaperFigure, blank, per_pixel, seconds, settings};
use crate::{Claim, Figure, Finding, MethodEntry, SceneEntry, Study};

pub(super) fn figures(scale: FigureScale) -> Vec<PaperFigure> {
    vec![
        two(scale),
        three(scale),
        four(scale),
        five(scale),
        six(scale),
    ]
}

const INDIRECT: &str = "cornell-indirect";
const RING: &str = "ring-and-sphere";

/// The report's own: a chain a sample in the mean, of 100 steps, of all that is scattered.
const REPORT: [&str; 3] = ["chains=1", "length=100", "direct=lamps"];

fn entry(scale: FigureScale, name: &str, method: Method, more: &[&str]) -> MethodEntry {
    MethodEntry {
        name: name.to_owned(),
        method,
        settings: settings(scale, "pilot=2000", more),
        amounts: None,
    }
}

fn path(scale: FigureScale) -> MethodEntry {
    entry(scale, "path", Method::Path, &[])
}

fn erpt(scale: FigureScale, name: &str, more: &[&str]) -> MethodEntry {
    let all: Vec<&str> = REPORT.iter().chain(more).copied().collect();
    entry(scale, name, Method::Erpt, &all)
}

/// The light of many samples in few and long chains that go far: what we found best for the same time.
fn few_chains(scale: FigureScale) -> MethodEntry {
    let more = ["length=1000", "chains=0.01", "jitter=veach"];
    erpt(scale, "few chains", &more)
}

/// Samples a pixel from which the report's chains start in all its figures.
const SAMPLES: f64 = 24.0;

/// Path tracing against both kinds of chains. As published path tracing has its own number of samples a
/// pixel, chains have the report's 24, and few chains so many that there are as many mutations: ten a sample
/// in place of a hundred.
fn path_and_chains(scale: FigureScale) -> Vec<MethodEntry> {
    let chains = [
        (erpt(scale, "erpt", &[]), SAMPLES),
        (few_chains(scale), 10.0 * SAMPLES),
    ];
    let chains = chains.map(|(method, samples)| match scale {
        FigureScale::AsPublished => method.with_amounts(&[samples]),
        FigureScale::Quick | FigureScale::Usual => method,
    });
    [path(scale)].into_iter().chain(chains).collect()
}

/// A study of one scene at equal times; as published at so many samples a pixel.
fn study(scale: FigureScale, title: &str, about: &str, scene: &str, published: f64) -> Study {
    let mut study = blank(title, about, scale);
    study.scenes = vec![SceneEntry::builtin(scene)];
    study.budgets = match scale {
        FigureScale::Quick => seconds(&[0.1, 0.25]),
        FigureScale::Usual => seconds(&[2.0, 4.0, 8.0, 16.0]),
        FigureScale::AsPublished => per_pixel(&[published]),
    };
    study
}

fn two(scale: FigureScale) -> PaperFigure {
    let mut study = study(
        scale,
        "Figure 2: indirect light by path tracing",
        "A box lit by way of the ceiling. As published: 1400 samples a pixel, about two hours on a laptop of its time, \
         against the chains of Figure 3.",
        INDIRECT,
        1400.0,
    );
    study.methods = path_and_chains(scale);
    PaperFigure {
        number: 2,
        study,
        claims: &[
            Claim {
                text: "Sec. 5: at equal time path tracing is much noisier (chains of 100, about one a sample)",
                check: |r| {
                    let rivals = [("path", 1.0)];
                    lower_in_time(r, INDIRECT, Figure::RelativeMse, "erpt", &rivals)
                },
            },
            Claim {
                text: "Our goal: at most half of path's relative MSE (chains of 1000, one to a hundred samples)",
                check: |r| {
                    let rivals = [("path", 0.5)];
                    lower_in_time(r, INDIRECT, Figure::RelativeMse, "few chains", &rivals)
                },
            },
        ],
    }
}

const LENGTHS: [&str; 3] = ["100", "300", "1000"];

const COLOURED: &str = "cornell";
/// Of its white wall, which spans 0.22 to 0.79 of the width, what is beside the red and beside the green one: left, top, right, bottom as shares of the picture.
const BESIDE_COLOUR: [[f64; 4]; 2] = [[0.23, 0.3, 0.28, 0.7], [0.73, 0.3, 0.78, 0.7]];

fn three(scale: FigureScale) -> PaperFigure {
    let mut study = study(
        scale,
        "Figure 3: indirect light by redistribution",
        "The same box by chains of 100, 300 and 1000 steps, a chain a sample in the mean. As published: chains of 100, \
         24 samples a pixel. And with deposits in the colour of the chain's start, as Algorithm 2 prints: in a box of \
         coloured walls, whose light it carries to the white ones.",
        INDIRECT,
        SAMPLES,
    );
    let mut coloured = SceneEntry::builtin(COLOURED);
    coloured.close_ups = BESIDE_COLOUR.map(|part| close_up(&study, part)).to_vec();
    study.scenes.push(coloured);
    study.methods = LENGTHS
        .map(|length| erpt(scale, length, &[&format!("length={length}")]))
        .to_vec();
    study
        .methods
        .push(erpt(scale, "printed colours", &["deposit=printed"]));
    PaperFigure {
        number: 3,
        study,
        claims: &[
            Claim {
                text: "Sec. 5: longer chains would smooth out the unevenness; here at equal time: chains of 300 or 1000 \
                       have the least relative MSE, worst 0.1 % dropped",
                check: |r| {
                    let figure = Figure::RelativeMseTrimmed;
                    best_in_time(r, INDIRECT, figure, &LENGTHS, &["300", "1000"])
                },
            },
            Claim {
                text: "Algorithm 2 deposits in the colour of the start; here: that tints the picture (mean colour of the white \
                       wall beside the red or the green one off by more than 0.5 %, or the error above 1.1 times the right one's). The \
                       mean of the whole picture it leaves as it is",
                check: |r| tint_differs(r, COLOURED, "printed colours", "100"),
            },
        ],
    }
}

fn four(scale: FigureScale) -> PaperFigure {
    let mut study = study(
        scale,
        "Figure 4: caustics by path tracing",
        "A mirror ring and a glass sphere in a box. As published: 5625 samples a pixel, 7.5 hours, against the chains of \
         Figure 5.",
        RING,
        5625.0,
    );
    caustics(&mut study, scale);
    study.methods = path_and_chains(scale);
    PaperFigure {
        number: 4,
        study,
        claims: &[
            Claim {
                text: "Sec. 5: path tracing is noisy inside the ring, erpt shows more detail with less noise (chains of \
                       100, about one a sample; worst 0.1 % dropped)",
                check: |r| {
                    let rivals = [("path", 1.0)];
                    lower_in_time(r, RING, Figure::RelativeMseTrimmed, "erpt", &rivals)
                },
            },
            Claim {
                text: "Our goal: at most a fifth of path's relative MSE (chains of 1000, one to a hundred samples)",
                check: |r| {
                    lower_in_time(r, RING, Figure::RelativeMse, "few chains", &[("path", 0.2)])
                },
            },
            Claim {
                text: "The same without the worst 0.1 % of the pixels",
                check: |r| {
                    let rivals = [("path", 0.2)];
                    lower_in_time(r, RING, Figure::RelativeMseTrimmed, "few chains", &rivals)
                },
            },
        ],
    }
}

/// The reference must have met what uniform samples meet seldom.
fn caustics(study: &mut Study, scale: FigureScale) {
    study.scenes[0].close_ups = CLOSE_UPS.map(|part| close_up(study, part)).to_vec();
    if scale != FigureScale::Quick {
        study.reference.per_pixel = 1024;
        study.reference.error = 0.05;
    }
}

/// Left, top, right, bottom as shares of the picture: the sphere with all around it, the caustic on the floor below it, the wall beside it.
const CLOSE_UPS: [[f64; 4]; 3] = [
    [0.5, 0.5, 1.0, 1.0],
    [0.64, 0.88, 0.82, 0.95],
    [0.84, 0.4, 1.0, 0.85],
];

fn close_up(study: &Study, [x0, y0, x1, y1]: [f64; 4]) -> Window {
    let at = |share: f64, side: u32| (share * f64::from(side)).round() as u32;
    Window {
        x0: at(x0, study.width),
        y0: at(y0, study.height),
        x1: at(x1, study.width),
        y1: at(y1, study.height),
    }
}

/// The report's mutations and nothing beside them: what a mutation costs.
const PERTURBATIONS: &str = "perturbations alone";
const PERTURBED: [&str; 2] = ["perturbations=lens,multichain,caustic", "direct=together"];

fn five(scale: FigureScale) -> PaperFigure {
    let mut study = study(
        scale,
        "Figure 5: caustics by redistribution",
        "The same scene by chains of 100, and by the chains of our default. As published: 24 samples a pixel. The reference, by bdpt, \
         decides whether the coloured caustics by the sphere and on the walls are there. And the density change of section 4.2 \
         as printed. The box of Figure 3 once more, for what a mutation costs.",
        RING,
        SAMPLES,
    );
    caustics(&mut study, scale);
    study.scenes.push(SceneEntry::builtin(INDIRECT));
    study.methods = vec![
        erpt(scale, "erpt", &[]),
        erpt(scale, "caustic as printed", &["caustic=printed"]),
        entry(scale, "default", Method::Erpt, &[]),
        erpt(scale, PERTURBATIONS, &PERTURBED),
        entry(scale, "bdpt", Method::Bdpt, &[]),
    ];
    PaperFigure {
        number: 5,
        study,
        claims: &[
            Claim {
                text: "Sec. 5: are the coloured caustics near the sphere and on the walls correct? Here: where they fall \
                       (around the sphere, on the floor below it, on the wall beside it) erpt has the mean colour of the reference, by bdpt, \
                       within 5 %",
                check: |r| same_tint(r, RING, "default", 0.05),
            },
            Claim {
                text: "The same by chains of 100",
                check: |r| same_tint(r, RING, "erpt", 0.05),
            },
            Claim {
                text: "Sec. 4.2: for caustic perturbations rule 5 alone is right, as the results indicate; here: its \
                       picture is no worse than that of rules 2 and 5 (error at most 1.1 times)",
                check: |r| {
                    let rivals = [("erpt", 1.1)];
                    lower(
                        r,
                        RING,
                        Figure::RmseXyzTrimmed,
                        "caustic as printed",
                        &rivals,
                    )
                },
            },
            Claim {
                text: "Sec. 5: 7.5 hours instead of 2 for the same number of mutations, 3.75 times a mutation's cost; \
                       here: from 1.2 to 5 times",
                check: |r| cost_of_a_step(r, PERTURBATIONS, (RING, INDIRECT), [1.2, 5.0]),
            },
            Claim {
                text: "Our goal: few spikes (a relative MSE of at most 3 times that without the worst 0.1 % of the \
                       pixels)",
                check: |r| few_spikes(r, RING, "default", 3.0),
            },
            Claim {
                text: "The same by chains of 100",
                check: |r| few_spikes(r, RING, "erpt", 3.0),
            },
        ],
    }
}

fn six(scale: FigureScale) -> PaperFigure {
    let mut study = study(
        scale,
        "Figure 6: the filter by consecutive samples",
        "The scene of Figure 5 without and with the filter at a cutoff of 10, and with the filter by proposals, which the \
         report lacks (kappa 1 and 4). What each takes away is a layer of its picture.",
        RING,
        SAMPLES,
    );
    caustics(&mut study, scale);
    study.layers = true;
    study.methods = vec![
        erpt(scale, "unfiltered", &[]),
        erpt(scale, "cutoff 10", &["consecutive=10"]),
        erpt(scale, "proposed, 1", &["proposed=1"]),
        erpt(scale, "proposed, 4", &["proposed=4"]),
    ];
    PaperFigure {
        number: 6,
        study,
        claims: &[
            Claim {
                text: "Sec. 5: bright pixels from chains that are stuck are eliminated; here: a lower relative MSE than \
                       unfiltered",
                check: |r| {
                    let rivals = [("unfiltered", 1.0)];
                    lower(r, RING, Figure::RelativeMse, "cutoff 10", &rivals)
                },
            },
            Claim {
                text: "Ours: the filter is biased: it takes away at least 0.01 % of the light",
                check: |r| statistic_above(r, RING, "cutoff 10", "/energy/consecutive_loss", 1e-4),
            },
            Claim {
                text: "Ours: so is the filter by proposals (kappa 1)",
                check: |r| statistic_above(r, RING, "proposed, 1", "/energy/proposed_loss", 0.001),
            },
            Claim {
                text: "Sec. 6 wishes for filters without bias; ours has none, and none is known here. What stands in: no \
                       filter at all, and longer chains from more starts",
                check: |r| match last(r, RING, "unfiltered") {
                    Some(_) => Finding::open("no such filter is built"),
                    None => Finding::open("not rendered"),
                },
            },
        ],
    }
}
