//! The papers' own studies: their figures on our scenes, and what they claim.
//!
//! Scenes of the papers are not to be had; ours have the same difficulty
//! ([`builtin`](kaustik::scene::builtin)). Where a paper leaves a setting open, the figure's text says what
//! stands in for it.

mod checks;
mod erpt;
mod evenness;
#[cfg(test)]
mod fixture;
mod lacks;
mod over_time;
mod pssmlt;
mod relt;
mod rivals;
mod spatial_target;

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use crate::{
    Budgets, Claim, CpuClock, Judged, Listener, ReferenceEntry, Results, Runner, Section, Study,
    StudyError, StudyProgress, Unit, Verdict, judge, write,
};

/// How large a study is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FigureScale {
    /// Less than a minute in all: shows that everything works, and nothing else.
    Quick,
    /// Small pictures, up to 20 CPU seconds a render: a quarter of an hour to more than two hours in all, references on top.
    #[default]
    Usual,
    /// The paper's own sizes and times: hours to days.
    AsPublished,
}

impl FigureScale {
    /// As a command line asks for it, of whose two words only one may stand.
    pub fn of_words(quick: bool, as_published: bool) -> Self {
        match (quick, as_published) {
            (true, _) => Self::Quick,
            (_, true) => Self::AsPublished,
            _ => Self::Usual,
        }
    }

    /// The folder for a study of this name where none is given: what is quick does not take the place of what took hours.
    #[must_use]
    pub fn folder(self, name: &str) -> PathBuf {
        let scale = match self {
            Self::Quick => "-quick",
            Self::Usual => "",
            Self::AsPublished => "-as-published",
        };
        PathBuf::from(format!("study-{name}{scale}"))
    }
}

/// A figure of a paper as a study.
#[derive(Clone, Debug)]
pub struct PaperFigure {
    /// Its number in the paper.
    pub number: u32,
    /// What is rendered.
    pub study: Study,
    /// What the paper says of it, and what we want of it.
    pub claims: &'static [Claim],
}

/// A paper's study.
#[derive(Clone, Copy, Debug)]
pub struct Named {
    /// What the command calls it.
    pub name: &'static str,
    /// The page's title.
    pub title: &'static str,
    figures: fn(FigureScale) -> Vec<PaperFigure>,
}

/// All of them.
pub const ALL: [Named; 4] = [
    Named {
        name: "pssmlt",
        title: "Kelemen, Szirmay-Kalos 2002: a simple and robust mutation strategy for the Metropolis \
                light transport algorithm",
        figures: pssmlt::figures,
    },
    Named {
        name: "relt",
        title: "Kitaoka, Kitamura, Kishino 2009: replica exchange light transport",
        figures: relt::figures,
    },
    Named {
        name: "erpt",
        title: "Batty: implementing energy redistribution path tracing (Cline, Talbot, Egbert 2005)",
        figures: erpt::figures,
    },
    Named {
        name: "spatial-target",
        title: "Gruson, Ribardière, Šik, Vorba, Cozot, Bouatouch, Křivánek 2016: a spatial target function for Metropolis \
                photon tracing",
        figures: spatial_target::figures,
    },
];

/// What became of a paper's study.
#[derive(Debug)]
pub struct Done {
    /// The page.
    pub page: PathBuf,
    /// Each figure's claims.
    pub judged: Vec<(u32, Vec<Judged>)>,
}

/// The study of this name.
#[must_use]
pub fn find(name: &str) -> Option<&'static Named> {
    ALL.iter().find(|named| named.name == name)
}

impl Named {
    /// Its figures at a scale.
    #[must_use]
    pub fn figures(&self, scale: FigureScale) -> Vec<PaperFigure> {
        (self.figures)(scale)
    }

    /// Renders all figures, or the one of this number, and writes tables, curves and page into a
    /// folder, which is made if it is not there.
    ///
    /// # Errors
    /// A number that no figure has, or what [`Runner::run`] and [`write`](crate::write()) say.
    pub fn run(
        &self,
        scale: FigureScale,
        number: Option<u32>,
        folder: &Path,
        listener: &mut Listener<'_>,
    ) -> Result<Done, StudyError> {
        let mut figures = self.figures(scale);
        if let Some(number) = number {
            let known: Vec<String> = figures.iter().map(|f| f.number.to_string()).collect();
            figures.retain(|figure| figure.number == number);
            if figures.is_empty() {
                let message = format!("study {} has the figures {}", self.name, known.join(", "));
                return Err(StudyError::words(format!("figure {number}"), message));
            }
        }
        let mut done: Vec<(u32, Results, Vec<Judged>)> = Vec::new();
        let count = figures.len() as f64;
        for (index, figure) in figures.iter().enumerate() {
            let mut inner = |progress: &StudyProgress<'_>| -> ControlFlow<()> {
                listener(&StudyProgress {
                    fraction: (index as f64 + progress.fraction) / count,
                    what: &format!("figure {}, {}", figure.number, progress.what),
                    ..*progress
                })
            };
            let results = Runner::new(&figure.study, folder).run(&mut inner)?;
            let mut judged = judge(figure.claims, &results);
            if scale == FigureScale::Quick {
                // a few samples on a few pixels decide nothing
                for judged in &mut judged {
                    judged.finding.verdict = Verdict::Open;
                }
            }
            done.push((figure.number, results, judged));
        }
        let words: Vec<String> = done.iter().map(|d| format!("figure-{}", d.0)).collect();
        let sections: Vec<(&str, Section<'_>)> = (done.iter().zip(&words))
            .map(|((_, results, judged), word)| (word.as_str(), Section { results, judged }))
            .collect();
        let page = write(folder, self.title, &sections)?;
        let judged = done.into_iter().map(|(number, _, judged)| (number, judged));
        Ok(Done {
            page,
            judged: judged.collect(),
        })
    }
}

/// Seconds of processor time where the system tells it, of the wall elsewhere.
fn seconds(amounts: &[f64]) -> Budgets {
    let unit = if CpuClock::is_told() {
        Unit::Cpu
    } else {
        Unit::Wall
    };
    Budgets {
        unit,
        amounts: amounts.to_vec(),
    }
}

/// Minutes on the wall with all threads, and the halvings before them: the papers' own times.
fn minutes(last: f64) -> Budgets {
    Budgets {
        unit: Unit::Wall,
        amounts: [32.0, 16.0, 8.0, 4.0, 2.0, 1.0]
            .map(|part| 60.0 * last / part)
            .to_vec(),
    }
}

fn per_pixel(amounts: &[f64]) -> Budgets {
    Budgets {
        unit: Unit::PerPixel,
        amounts: amounts.to_vec(),
    }
}

/// A study of this scale without scenes and methods.
fn blank(title: &str, about: &str, scale: FigureScale) -> Study {
    let (side, seeds, threads, error, most) = match scale {
        FigureScale::Quick => (24, 2, 1, 0.5, 2),
        FigureScale::Usual => (128, 5, 1, 0.03, 32),
        FigureScale::AsPublished => (512, 5, 0, 0.02, 64),
    };
    Study {
        title: title.to_owned(),
        about: about.to_owned(),
        width: side,
        height: side,
        max_depth: if scale == FigureScale::Quick { 8 } else { 64 },
        threads,
        layers: false,
        matched: Vec::new(),
        budgets: per_pixel(&[1.0]),
        seeds: (0..seeds).collect(),
        scenes: Vec::new(),
        methods: Vec::new(),
        reference: ReferenceEntry {
            method: kaustik::Method::Bdpt,
            settings: Vec::new(),
            per_pixel: if scale == FigureScale::Quick { 16 } else { 256 },
            error,
            most,
        },
    }
}

/// Settings, with a small start where the study is to be quick. `start` is the setting that makes it small.
fn settings(scale: FigureScale, start: &str, more: &[&str]) -> Vec<String> {
    let quick = [start, "ladders=8"];
    let quick = if scale == FigureScale::Quick {
        &quick[..]
    } else {
        &[]
    };
    quick.iter().chain(more).map(|&s| s.to_owned()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_figure_is_sound_at_every_scale() {
        for named in &ALL {
            assert_eq!(find(named.name).map(|n| n.title), Some(named.title));
            for scale in [
                FigureScale::Quick,
                FigureScale::Usual,
                FigureScale::AsPublished,
            ] {
                let figures = named.figures(scale);
                assert!(figures.len() >= 5);
                for figure in &figures {
                    let place = format!("{} {} {scale:?}", named.name, figure.number);
                    figure
                        .study
                        .check()
                        .unwrap_or_else(|e| panic!("{place}: {e}"));
                    assert!(!figure.claims.is_empty(), "{place}");
                    assert!(
                        figure.study.title.contains(&figure.number.to_string()),
                        "{place}"
                    );
                }
            }
        }
        assert!(find("mlt").is_none());
    }

    #[test]
    fn published_figures_have_the_published_cost() {
        let of = |name: &str, number: u32| {
            let figures = find(name).unwrap().figures(FigureScale::AsPublished);
            figures
                .into_iter()
                .find(|f| f.number == number)
                .unwrap()
                .study
        };
        for (number, mutations) in [(6, 25.0), (7, 256.0), (8, 25.0), (9, 100.0)] {
            assert_eq!(of("pssmlt", number).budgets, per_pixel(&[mutations]));
        }
        for (number, samples) in [(2, 1400.0), (3, 24.0), (4, 5625.0), (5, 24.0), (6, 24.0)] {
            assert_eq!(of("erpt", number).budgets, per_pixel(&[samples]));
        }
        for (number, samples) in [(2, 1400.0), (4, 5625.0)] {
            let study = of("erpt", number);
            let named = |name: &str| study.methods.iter().find(|m| m.name == name).unwrap();
            let cost = |name| study.amount(named(name), 0);
            let all = vec![cost("path"), cost("erpt"), cost("few chains")];
            assert_eq!(all, [samples, 24.0, 240.0]);
        }
        for (number, minutes) in [
            (1, 30.0),
            (4, 10.0),
            (7, 60.0),
            (8, 60.0),
            (9, 60.0),
            (10, 5.0),
            (11, 60.0),
        ] {
            let study = of("spatial-target", number);
            assert_eq!((study.width, study.height), (960, 540));
            assert_eq!(study.budgets.amounts.last(), Some(&(60.0 * minutes)));
        }
        for (number, side, minutes) in [
            (4, 400, 10.0),
            (5, 400, 10.0),
            (6, 800, 20.0),
            (7, 800, 60.0),
        ] {
            let study = of("relt", number);
            assert_eq!((study.width, study.height), (side, side));
            assert_eq!(study.budgets.amounts.last(), Some(&(60.0 * minutes)));
            assert_eq!(study.budgets.unit, Unit::Wall);
        }
    }

    /// Renders that two figures share are done once: what a figure adds is what has no equal before it.
    #[test]
    fn figures_of_the_spatial_target_share_renders() {
        let figures = find("spatial-target").unwrap().figures(FigureScale::Usual);
        let numbers: Vec<u32> = figures.iter().map(|figure| figure.number).collect();
        assert_eq!(numbers, [1, 3, 4, 5, 6, 7, 8, 9, 10, 11]);
        let of = |number: u32| figures.iter().find(|f| f.number == number).unwrap();
        let renders = |figure: &PaperFigure| {
            let study = &figure.study;
            let scenes = study.scenes.iter().map(|scene| scene.name.clone());
            let methods = || {
                let all = study.methods.iter();
                all.map(|m| format!("{} {:?} {}", m.method, m.settings, study.layers))
            };
            let all = scenes.flat_map(|scene| methods().map(move |m| format!("{scene} {m}")));
            all.collect::<std::collections::BTreeSet<String>>()
        };
        let new = |number: u32, before: &[u32]| {
            let before = before.iter().flat_map(|n| renders(of(*n))).collect();
            renders(of(number)).difference(&before).count()
        };
        assert_eq!(new(3, &[4]), 0, "the hall's target is that of figure 4");
        assert_eq!(new(6, &[5]), 1, "the mean by samples");
        assert_eq!(new(8, &[4]), 8, "independent photons, villa and water");
        let all: std::collections::BTreeSet<String> = figures.iter().flat_map(renders).collect();
        // five seeds of 20 seconds each
        assert_eq!((all.len() * 100) / 60, 136);
    }

    #[test]
    fn a_figure_that_is_not_there_is_refused() {
        let folder = std::env::temp_dir();
        let go = |_: &StudyProgress<'_>| ControlFlow::Break(());
        let error = ALL[1]
            .run(FigureScale::Quick, Some(99), &folder, &mut { go })
            .unwrap_err();
        assert!(error.to_string().contains("4, 5, 6, 7, 8"), "{error}");
    }
}
