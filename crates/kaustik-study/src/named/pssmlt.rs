//! Kelemen and Szirmay-Kalos 2002.

use kaustik::Method;

use super::checks::{acceptance, fewer_shadow_rays, last};
use super::rivals::{best, lower, lower_in_the_dark, lower_in_time};
use super::{FigureScale, PaperFigure, blank, per_pixel, seconds, settings};
use crate::{Claim, Figure, Finding, MethodEntry, SceneEntry, Study};

/// The paper names no size of its pictures: 512 x 512 stands for it.
pub(super) fn figures(scale: FigureScale) -> Vec<PaperFigure> {
    vec![
        five(scale),
        six(scale),
        seven(scale),
        eight(scale),
        nine(scale),
    ]
}

const GLOSSY: &str = "glossy-cornell";
const STATUE: &str = "mirror-statue";

/// A variant of `pssmlt` as the paper has it: the contribution that its chains follow is the largest
/// path's luminance, and all light is theirs, the lamps' seen directly too.
fn pssmlt(scale: FigureScale, name: &str, builder: &str, more: &[&str]) -> MethodEntry {
    let builder = format!("builder={builder}");
    let heuristic = if builder.ends_with("unidirectional") {
        &[][..]
    } else {
        &["heuristic=maximum"]
    };
    let mut all = vec![
        builder.as_str(),
        "target=luminance",
        "contribution=maximum",
        "direct=together",
    ];
    all.extend(heuristic);
    all.extend(more);
    MethodEntry {
        name: name.to_owned(),
        method: Method::Pssmlt,
        settings: settings(scale, "pilot=2000", &all),
        amounts: None,
    }
}

/// The paper's rival: variables of paths move, not the numbers that they are made of.
fn in_path_space(scale: FigureScale, name: &str, fraction: &str) -> MethodEntry {
    let mutations = format!("mutations=bidirectional,every:{fraction}");
    let more = [mutations.as_str(), "target=luminance", "direct=together"];
    MethodEntry {
        name: name.to_owned(),
        method: Method::Mlt,
        settings: settings(scale, "pilot=2000", &more),
        amounts: None,
    }
}

fn bdpt(scale: FigureScale, name: &str, more: &[&str]) -> MethodEntry {
    MethodEntry {
        name: name.to_owned(),
        method: Method::Bdpt,
        settings: settings(scale, "pilot=2000", more),
        amounts: None,
    }
}

fn statue(study: &mut Study, scale: FigureScale) {
    study.scenes = vec![SceneEntry::builtin(STATUE)];
    if scale != FigureScale::Quick {
        // The mirrored back, where uniform samples are noisiest: a chain knows it sooner.
        study.reference.method = Method::Pssmlt;
        study.reference.settings =
            vec!["builder=bidirectional".to_owned(), "plarge=0.5".to_owned()];
        study.reference.per_pixel = 1024;
        study.reference.error = 0.1; // its noise cancels between its halves
    }
}

/// What is claimed of Figure 5.
const FIVE: &[Claim] = &[
    Claim {
        text: "Sec. 7: with mutations over 20 % of the domain 76 % are accepted, with \
                       1 % 84 %; here: within ten points",
        check: |r| acceptance(r, GLOSSY, &[("20 %", 0.76), ("1 %", 0.84)]),
    },
    Claim {
        text: "Sec. 7: in path space 43 % and 62 % are accepted; here: within ten points",
        check: |r| {
            let rates = [("path space, 20 %", 0.43), ("path space, 1 %", 0.62)];
            acceptance(r, GLOSSY, &rates)
        },
    },
    Claim {
        text: "Fig. 5 left: mutations in the primary sample space converge faster than in path space",
        check: |r| {
            let rivals = [("path space, 5 %", 1.0)];
            lower(r, GLOSSY, Figure::RmseXyz, "5 %, no MIS", &rivals)
        },
    },
    Claim {
        text: "Fig. 5 right: by the share of pixels whose relative error exceeds a threshold, multiple \
                       importance sampling is better",
        check: |r| {
            lower(
                r,
                GLOSSY,
                Figure::Over10,
                "5 %, MIS",
                &[("5 %, no MIS", 1.0)],
            )
        },
    },
    Claim {
        text: "Sec. 7: its benefit is not obvious in the root mean square error; here: a ratio from 0.8 to 1.25",
        check: |r| {
            let figure = Figure::RmseXyz;
            let median = |name| Some(last(r, GLOSSY, name)?.quartiles(figure).median);
            match (median("5 %, MIS"), median("5 %, no MIS")) {
                (Some(a), Some(b)) => Finding::new(
                    format!("{}: ratio {:.2}", figure.name(), a / b),
                    (0.8..1.25).contains(&(a / b)),
                ),
                _ => Finding::open("not rendered"),
            }
        },
    },
];

fn five(scale: FigureScale) -> PaperFigure {
    let mut study = blank(
        "Figure 5: error curves",
        "A Cornell box with a glossy mirror for a back wall. Simple bidirectional paths (walks from both sides, \
         joined at their ends) under uniform mutations of 5 % of the domain, large steps with probability 0.5 (the \
         paper does not say), with and without large steps as independent samples; full bidirectional paths besides; \
         and mutations of 20 % and 1 % for their acceptance. Beside them mutations in path space: every variable of a \
         path by as much of its domain, and as often all of a path or a part of it anew (mlt).",
        scale,
    );
    let simple = |name, more: &[&str]| pssmlt(scale, name, "simple", more);
    study.scenes = vec![SceneEntry::builtin(GLOSSY)];
    study.methods = vec![
        simple(
            "5 %, no MIS",
            &["plarge=0.5", "mutation=uniform:0.05", "mis=off"],
        ),
        simple(
            "5 %, MIS",
            &["plarge=0.5", "mutation=uniform:0.05", "mis=printed"],
        ),
        simple(
            "5 %, unbiased MIS",
            &["plarge=0.5", "mutation=uniform:0.05", "mis=split"],
        ),
        simple("20 %", &["plarge=0.5", "mutation=uniform:0.2"]),
        simple("1 %", &["plarge=0.5", "mutation=uniform:0.01"]),
        in_path_space(scale, "path space, 5 %", "0.05"),
        in_path_space(scale, "path space, 20 %", "0.2"),
        in_path_space(scale, "path space, 1 %", "0.01"),
        pssmlt(
            scale,
            "full bidirectional",
            "bidirectional",
            &["plarge=0.5", "mutation=uniform:0.05"],
        ),
    ];
    study.budgets = match scale {
        FigureScale::Quick => seconds(&[0.1, 0.25]),
        FigureScale::Usual => seconds(&[1.0, 2.0, 4.0, 8.0, 16.0]),
        FigureScale::AsPublished => super::minutes(5.0),
    };
    PaperFigure {
        number: 5,
        study,
        claims: FIVE,
    }
}

fn six(scale: FigureScale) -> PaperFigure {
    let mut study = blank(
        "Figure 6: without and with multiple importance sampling",
        "The statue before the mirror, 25 mutations a pixel, large steps with probability 0.5.",
        scale,
    );
    statue(&mut study, scale);
    let full = |name, mis| pssmlt(scale, name, "bidirectional", &["plarge=0.5", mis]);
    study.methods = vec![
        full("no MIS", "mis=off"),
        full("MIS", "mis=printed"),
        full("unbiased MIS", "mis=split"),
    ];
    study.budgets = per_pixel(&[if scale == FigureScale::Quick {
        4.0
    } else {
        25.0
    }]);
    PaperFigure {
        number: 6,
        study,
        claims: &[Claim {
            text: "Sec. 7.1: the difference in bright parts is negligible, darker pixels benefit greatly",
            check: |r| lower_in_the_dark(r, STATUE, "MIS", "no MIS"),
        }],
    }
}

fn seven(scale: FigureScale) -> PaperFigure {
    let mut study = blank(
        "Figure 7: disco lights",
        "A ball of 80 clear facets under eight coloured lamps, 256 mutations a pixel.",
        scale,
    );
    study.scenes = vec![SceneEntry::builtin("disco")];
    study.methods = vec![
        pssmlt(scale, "pssmlt", "bidirectional", &["plarge=0.5"]),
        bdpt(scale, "bdpt", &[]),
    ];
    study.budgets = per_pixel(&[if scale == FigureScale::Quick {
        4.0
    } else {
        256.0
    }]);
    PaperFigure {
        number: 7,
        study,
        claims: &[Claim {
            text: "Fig. 7: 256 mutations a pixel are enough to render the scene quite accurately; here: fewer than a \
                   quarter of the pixels off by more than 20 %",
            check: |r| match last(r, "disco", "pssmlt") {
                Some(group) => {
                    let off = group.quartiles(Figure::Over20).median;
                    Finding::new(
                        format!(
                            "{:.1} % of the pixels are off by more than 20 %",
                            100.0 * off
                        ),
                        off < 0.25,
                    )
                }
                None => Finding::open("not rendered"),
            },
        }],
    }
}

const SHARES: [&str; 5] = ["0.02", "0.1", "0.3", "0.5", "0.9"];

fn eight(scale: FigureScale) -> PaperFigure {
    let mut study = blank(
        "Figure 8: probabilities of large steps",
        "The statue before the mirror, 25 mutations a pixel, with multiple importance sampling.",
        scale,
    );
    statue(&mut study, scale);
    let shares = SHARES.map(|share| {
        let plarge = format!("plarge={share}");
        pssmlt(scale, share, "bidirectional", &[&plarge, "mis=printed"])
    });
    study.methods = shares.to_vec();
    study.budgets = per_pixel(&[if scale == FigureScale::Quick {
        4.0
    } else {
        25.0
    }]);
    PaperFigure {
        number: 8,
        study,
        claims: &[Claim {
            text: "Sec. 7.1: the optimal probability of a large step is about 0.5; here: 0.3 or 0.5 has the least \
                   relative MSE, worst 0.1 % dropped",
            check: |r| {
                best(
                    r,
                    STATUE,
                    Figure::RelativeMseTrimmed,
                    &SHARES,
                    &["0.3", "0.5"],
                )
            },
        }],
    }
}

/// What is claimed of Figure 9.
const NINE: &[Claim] = &[
    Claim {
        text: "Fig. 9: better than bidirectional path tracing in the same time",
        check: |r| {
            lower_in_time(
                r,
                STATUE,
                Figure::RelativeMseTrimmed,
                "pssmlt",
                &[("bdpt", 1.0)],
            )
        },
    },
    Claim {
        text: "Sec. 2: the maximum heuristic traces fewer shadow rays",
        check: |r| fewer_shadow_rays(r, STATUE, "bdpt, maximum", "bdpt"),
    },
];

fn nine(scale: FigureScale) -> PaperFigure {
    let mut study = blank(
        "Figure 9: against bidirectional path tracing",
        "The statue before the mirror at equal time (as published: 100 samples a pixel each). Once more \
         bidirectional path tracing with the maximum heuristic, which need not trace every shadow ray.",
        scale,
    );
    statue(&mut study, scale);
    study.methods = vec![
        bdpt(scale, "bdpt", &[]),
        bdpt(scale, "bdpt, maximum", &["heuristic=maximum"]),
        pssmlt(
            scale,
            "pssmlt",
            "bidirectional",
            &["plarge=0.5", "mis=printed"],
        ),
    ];
    study.budgets = match scale {
        FigureScale::Quick => seconds(&[0.1, 0.25]),
        FigureScale::Usual => seconds(&[2.0, 4.0, 8.0, 16.0]),
        FigureScale::AsPublished => per_pixel(&[100.0]),
    };
    PaperFigure {
        number: 9,
        study,
        claims: NINE,
    }
}
