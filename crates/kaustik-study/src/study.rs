//! What a study is: plain data, checked before anything is rendered.

use std::path::PathBuf;

use kaustik::film::Window;
use kaustik::{Method, Options};

use crate::StudyError;
use crate::chart::number;

/// Methods x scenes x seeds x budgets, and the reference that they are measured against.
#[derive(Clone, Debug, PartialEq)]
pub struct Study {
    /// Shown above its part of the page.
    pub title: String,
    /// What it is to show, in a few sentences; may be empty.
    pub about: String,
    /// Columns of every picture, 1 to [`Study::LARGEST`].
    pub width: u32,
    /// Rows of every picture.
    pub height: u32,
    /// Longest path in edges, > 0.
    pub max_depth: u32,
    /// Worker threads; 0 is one a processor. Changes pictures only where the budget is a time.
    pub threads: usize,
    /// Keep and show what a method knows beside its picture: `relt` its replicas, photon methods their
    /// remainder, and with `maps=on` target, factors, regions and contributions.
    pub layers: bool,
    /// Names of methods whose pictures the page shows at the reference's mean luminance, as it does their
    /// errors and differences: what they are off by as a whole is left out. Tables have both.
    pub matched: Vec<String>,
    /// What each render may cost.
    pub budgets: Budgets,
    /// Independent repetitions, all different.
    pub seeds: Vec<u64>,
    /// Where.
    pub scenes: Vec<SceneEntry>,
    /// Who.
    pub methods: Vec<MethodEntry>,
    /// Against what.
    pub reference: ReferenceEntry,
}

/// What a budget counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// Wall-clock seconds, the pilot included: all budgets of a seed are looks at one render.
    Wall,
    /// Seconds of processor time of the whole process, the pilot included; likewise.
    Cpu,
    /// Samples or mutations a pixel: one render each.
    PerPixel,
    /// Samples or mutations in all: one render each.
    Total,
}

impl Unit {
    /// Is it a time?
    #[must_use]
    pub fn is_time(self) -> bool {
        matches!(self, Self::Wall | Self::Cpu)
    }

    /// In words, for axes and tables.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Wall => "seconds",
            Self::Cpu => "CPU seconds",
            Self::PerPixel => "samples a pixel",
            Self::Total => "samples",
        }
    }
}

/// Ascending amounts of one unit.
#[derive(Clone, Debug, PartialEq)]
pub struct Budgets {
    /// What they count.
    pub unit: Unit,
    /// Ascending, > 0; whole numbers if they count samples.
    pub amounts: Vec<f64>,
}

/// A scene of a study.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneEntry {
    /// Unique in the study.
    pub name: String,
    /// Which.
    pub source: SceneSource,
    /// Parts of the picture to be shown enlarged, within it.
    pub close_ups: Vec<Window>,
    /// A reference of its own.
    pub reference: Option<ReferenceEntry>,
}

/// Where a scene comes from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SceneSource {
    /// A built-in one: `name` or `name?key=value`.
    Builtin(String),
    /// A glTF file.
    File(PathBuf),
}

/// A method of a study with its settings.
#[derive(Clone, Debug, PartialEq)]
pub struct MethodEntry {
    /// Unique in the study; what charts and tables call it.
    pub name: String,
    /// The method.
    pub method: Method,
    /// Its settings as `key=value`, as after `--set`.
    pub settings: Vec<String>,
    /// What it may cost in place of the study's amounts: as many, of the same unit.
    pub amounts: Option<Vec<f64>>,
}

/// How the reference is rendered: independent renders are averaged until the standard error of their mean,
/// as their own spread tells it, is small enough.
#[derive(Clone, Debug, PartialEq)]
pub struct ReferenceEntry {
    /// The method.
    pub method: Method,
    /// Its settings as `key=value`.
    pub settings: Vec<String>,
    /// Samples or mutations a pixel of each render, > 0.
    pub per_pixel: u64,
    /// The standard error wanted, as a share (see `film::metrics::Spread::relative_error`), > 0.
    pub error: f64,
    /// Most renders, >= 2.
    pub most: u32,
}

impl MethodEntry {
    /// A method with settings.
    #[must_use]
    pub fn new(name: &str, method: Method, settings: &[&str]) -> Self {
        Self {
            name: name.to_owned(),
            method,
            settings: settings.iter().map(|&s| s.to_owned()).collect(),
            amounts: None,
        }
    }

    /// With amounts of its own in place of the study's.
    #[must_use]
    pub fn with_amounts(self, amounts: &[f64]) -> Self {
        let amounts = Some(amounts.to_vec());
        Self { amounts, ..self }
    }
}

impl SceneEntry {
    /// A built-in scene under its own name.
    #[must_use]
    pub fn builtin(words: &str) -> Self {
        Self {
            name: words.to_owned(),
            source: SceneSource::Builtin(words.to_owned()),
            close_ups: Vec::new(),
            reference: None,
        }
    }
}

/// The settings as options, if they fit together.
pub(crate) fn options(method: Method, settings: &[String]) -> Result<Options, String> {
    let mut options = Options::default();
    for setting in settings {
        options.set(method, setting).map_err(|e| e.to_string())?;
    }
    options.check(method).map_err(|e| e.to_string())?;
    Ok(options)
}

impl Study {
    /// Most columns or rows of a study's pictures.
    pub const LARGEST: u32 = 4096;

    /// Most renders in a study: scenes x methods x seeds x budgets.
    pub const MOST: usize = 100_000;

    /// The reference of a scene.
    #[must_use]
    pub fn reference_of(&self, scene: &SceneEntry) -> ReferenceEntry {
        scene.reference.as_ref().unwrap_or(&self.reference).clone()
    }

    /// What a method may cost at a budget.
    #[must_use]
    pub fn amount(&self, method: &MethodEntry, budget: usize) -> f64 {
        let own = method.amounts.as_ref();
        own.unwrap_or(&self.budgets.amounts)[budget]
    }

    /// The largest amount in words, and those of methods that have their own.
    pub(crate) fn last_budget(&self) -> String {
        let last = self.budgets.amounts.len() - 1;
        let words = number(self.budgets.amounts[last]) + " " + self.budgets.unit.name();
        let own = (self.methods.iter())
            .filter(|method| method.amounts.is_some())
            .map(|method| format!("{} {}", method.name, number(self.amount(method, last))));
        let own: Vec<String> = own.collect();
        match own.is_empty() {
            true => words,
            false => format!("{words} ({})", own.join(", ")),
        }
    }

    /// Is everything within its range?
    ///
    /// # Errors
    /// The first part that is not, and what was expected.
    pub fn check(&self) -> Result<(), StudyError> {
        let sides = 1..=Self::LARGEST;
        expect(
            sides.contains(&self.width) && sides.contains(&self.height),
            "width, height",
            "expected 1 to 4096",
        )?;
        expect(self.max_depth > 0, "max_depth", "expected at least 1")?;
        expect(self.threads <= 4096, "threads", "expected at most 4096")?;
        let seeds = &self.seeds;
        let different = (1..seeds.len()).all(|i| !seeds[..i].contains(&seeds[i]));
        expect(
            !seeds.is_empty() && seeds.len() <= 1000 && different,
            "seeds",
            "expected 1 to 1000 different numbers",
        )?;
        self.budgets.check("budget")?;
        expect(!self.scenes.is_empty(), "scene", "expected at least one")?;
        expect(!self.methods.is_empty(), "method", "expected at least one")?;
        names("scene", self.scenes.iter().map(|s| &s.name))?;
        names("method", self.methods.iter().map(|m| &m.name))?;
        let cells = [self.scenes.len(), self.methods.len(), seeds.len()];
        let cells = cells
            .iter()
            .fold(self.budgets.amounts.len(), |n, m| n.saturating_mul(*m));
        expect(
            cells <= Self::MOST,
            "study",
            "expected at most 100,000 renders in all",
        )?;
        for method in &self.methods {
            let place = format!("method '{}'", method.name);
            options(method.method, &method.settings)
                .map_err(|m| StudyError::words(place.clone(), m))?;
            self.own(method, &place)?;
        }
        for name in &self.matched {
            let is_known = self.methods.iter().any(|method| method.name == *name);
            let place = format!("matched '{name}'");
            expect(is_known, &place, "expected the name of a method")?;
        }
        self.reference.check("reference")?;
        for scene in &self.scenes {
            scene.check(self)?;
        }
        Ok(())
    }
}

impl Study {
    /// Are a method's own amounts what the study's could be?
    fn own(&self, method: &MethodEntry, place: &str) -> Result<(), StudyError> {
        let Some(amounts) = &method.amounts else {
            return Ok(());
        };
        expect(
            amounts.len() == self.budgets.amounts.len(),
            place,
            "expected as many amounts as the budget has",
        )?;
        let own = Budgets {
            amounts: amounts.clone(),
            ..self.budgets.clone()
        };
        own.check(place)
    }
}

fn expect(sound: bool, place: &str, message: &str) -> Result<(), StudyError> {
    match sound {
        true => Ok(()),
        false => Err(StudyError::words(place, message)),
    }
}

impl SceneEntry {
    /// Within the picture of `study`.
    fn check(&self, study: &Study) -> Result<(), StudyError> {
        let place = format!("scene '{}'", self.name);
        if let Some(reference) = &self.reference {
            reference.check(&place)?;
        }
        let inside = |w: &Window| w.area() > 0 && w.x1 <= study.width && w.y1 <= study.height;
        expect(
            self.close_ups.iter().all(inside) && self.close_ups.len() <= 16,
            &place,
            "expected at most 16 close-ups [x0, y0, x1, y1] within the picture",
        )
    }
}

impl Budgets {
    fn check(&self, place: &str) -> Result<(), StudyError> {
        let a = &self.amounts;
        let rising = a.windows(2).all(|pair| pair[0] < pair[1]);
        let whole = self.unit.is_time() || a.iter().all(|x| x.fract() == 0.0 && *x <= 1e15);
        let positive = a.iter().all(|x| *x > 0.0 && *x <= 1e15);
        expect(
            !a.is_empty() && a.len() <= 100 && rising && whole && positive,
            place,
            "expected 1 to 100 rising amounts above 0, whole numbers of samples",
        )
    }
}

impl ReferenceEntry {
    fn check(&self, place: &str) -> Result<(), StudyError> {
        options(self.method, &self.settings).map_err(|m| StudyError::words(place, m))?;
        expect(
            self.per_pixel > 0 && self.error > 0.0 && (2..=10_000).contains(&self.most),
            place,
            "expected per_pixel > 0, error > 0, most from 2 to 10,000",
        )
    }
}

/// Names that stand in tables, charts and messages.
fn names<'a>(what: &str, names: impl Iterator<Item = &'a String>) -> Result<(), StudyError> {
    let mut seen: Vec<&String> = Vec::new();
    for name in names {
        let plain = !name.trim().is_empty() && name.chars().count() <= 80;
        if !plain || name.chars().any(char::is_control) || seen.contains(&name) {
            let message = "expected different names of 1 to 80 characters, no control characters";
            return Err(StudyError::words(format!("{what} {name:?}"), message));
        }
        seen.push(name);
    }
    Ok(())
}
