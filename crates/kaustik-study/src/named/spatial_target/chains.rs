//! The figures about the chains of a ladder.

use super::super::checks::steadier;
use super::super::rivals::{lower, lower_nsd};
use super::super::{FigureScale, PaperFigure};
use super::{HALL, spatial, study};
use crate::{Claim, Figure};

/// Four chains with statistics of all but the last.
const AUTHORS: &str = "authors' statistics";
/// The paper's own settings. It has one ladder; so have ours at the usual size, nearly (two on one thread). As published it would leave
/// all threads but one idle, which is no matter of the target.
const AS_PRINTED: [&str; 4] = [
    "psi=visibility",
    "refinement=adaptive",
    "burnin=10000",
    "pace=1:2:2:1",
];

pub(super) fn five(scale: FigureScale) -> PaperFigure {
    let mut study = study(
        scale,
        "Figure 5: chains of a ladder",
        "Four chains, three without visibility, two without inverse kernel size as well (all with statistics of all chains but the last, as in \
         the authors' code, so that they differ in nothing else), the plain mean of four. The paper's own settings \
         all together, and its choices one by one: regions by what their halves tell, by iterations, none; visible light paths for \
         statistics; no target but the inverse kernel size. And what is ours: the statistics of all chains; one share of visible \
         paths for all iterations, which is biased.",
        &[HALL],
        10.0,
    );
    study.methods = vec![
        spatial(scale, "four", &[]),
        spatial(scale, "three", &["levels=3", "psi=authors"]),
        spatial(scale, "two", &["levels=2", "psi=authors"]),
        spatial(scale, "average", &["combine=average"]),
        spatial(scale, AUTHORS, &["psi=authors"]),
        spatial(scale, "one normaliser", &["normalisation=progressive"]),
        spatial(scale, "second moment", &["tf=second-moment"]),
        spatial(scale, "orientation", &["orientation=on"]),
        spatial(scale, "as printed", &AS_PRINTED),
        spatial(scale, "adaptive", &["refinement=adaptive"]),
        spatial(scale, "by iterations", &["refinement=iterations"]),
        spatial(scale, "not refined", &["refinement=off"]),
        spatial(scale, "statistics of visibility", &["psi=visibility"]),
        spatial(scale, "inverse kernel", &["tf=inverse-kernel"]),
    ];
    PaperFigure {
        number: 5,
        study,
        claims: &[
            Claim {
                text: "Sec. 4.4: four chains are better than three",
                check: |r| lower_nsd(r, HALL, AUTHORS, &[("three", 1.0)]),
            },
            Claim {
                text: "Three are better than two",
                check: |r| lower_nsd(r, HALL, "three", &[("two", 1.0)]),
            },
            Claim {
                text: "Sec. 4.4: the normaliser of four chains varies less than that of three (by the brightness of pictures)",
                check: |r| steadier(r, HALL, AUTHORS, "three"),
            },
            Claim {
                text: "That of three less than that of two",
                check: |r| steadier(r, HALL, "three", "two"),
            },
            Claim {
                text: "Sec. 4.2: regions that are refined by what their halves tell are better than by iterations",
                check: |r| lower_nsd(r, HALL, "adaptive", &[("by iterations", 1.0)]),
            },
            Claim {
                text: "Sec. 4.1: the full target is better than inverse kernel size alone",
                check: |r| lower_nsd(r, HALL, "four", &[("inverse kernel", 1.0)]),
            },
            Claim {
                text: "Ours: our settings are better than the paper's",
                check: |r| lower_nsd(r, HALL, "four", &[("as printed", 1.0)]),
            },
            Claim {
                text: "Multiple importance sampling is better than the mean",
                check: |r| lower_nsd(r, HALL, "four", &[("average", 1.0)]),
            },
            Claim {
                text: "Ours: statistics of all chains are better than those of all but the last",
                check: |r| lower_nsd(r, HALL, "four", &[(AUTHORS, 1.0)]),
            },
        ],
    }
}

pub(super) fn six(scale: FigureScale) -> PaperFigure {
    let mut study = study(
        scale,
        "Figure 6: with and without multiple importance sampling",
        "What the four chains find, combined by the balance heuristic; by the mean over the chains weighted by the samples \
         that each took, as in the paper; by their plain mean.",
        &[HALL],
        10.0,
    );
    study.methods = vec![
        spatial(scale, "balance", &[]),
        spatial(scale, "by samples", &["combine=samples"]),
        spatial(scale, "plain mean", &["combine=average"]),
    ];
    PaperFigure {
        number: 6,
        study,
        claims: &[
            Claim {
                text: "Fig. 6: multiple importance sampling has less noise than the mean by samples",
                check: |r| lower_nsd(r, HALL, "balance", &[("by samples", 1.0)]),
            },
            Claim {
                text: "Fig. 6: fewer bright spots, which make most of a relative MSE",
                check: |r| {
                    let rivals = [("by samples", 1.0)];
                    lower(r, HALL, Figure::RelativeMse, "balance", &rivals)
                },
            },
            Claim {
                text: "The same against the plain mean: less noise",
                check: |r| lower_nsd(r, HALL, "balance", &[("plain mean", 1.0)]),
            },
        ],
    }
}
