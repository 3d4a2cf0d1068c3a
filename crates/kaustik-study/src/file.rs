//! A study from a TOML file.

use std::io::Read as _;
use std::path::{Path, PathBuf};

use kaustik::film::Window;
use kaustik::scene::builtin;
use serde::Deserialize;
use toml::Spanned;

use crate::study::options;
use crate::{
    Budgets, MethodEntry, ReferenceEntry, SceneEntry, SceneSource, Study, StudyError, Unit,
};

/// Larger files are no studies.
const LARGEST: u64 = 1 << 20;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Words {
    #[serde(default)]
    title: Option<String>,
    #[serde(default)]
    about: String,
    width: u32,
    height: u32,
    #[serde(default = "depth")]
    max_depth: u32,
    #[serde(default)]
    threads: u32,
    #[serde(default)]
    layers: bool,
    #[serde(default)]
    matched: Vec<String>,
    seeds: Vec<u32>,
    budget: Spanned<BudgetWords>,
    reference: ReferenceWords,
    scene: Vec<SceneWords>,
    method: Vec<MethodWords>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct BudgetWords {
    wall: Option<Vec<f64>>,
    cpu: Option<Vec<f64>>,
    per_pixel: Option<Vec<f64>>,
    total: Option<Vec<f64>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ReferenceWords {
    method: Spanned<String>,
    #[serde(default)]
    set: Vec<Spanned<String>>,
    per_pixel: u64,
    error: f64,
    #[serde(default = "most")]
    most: u32,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SceneWords {
    name: Option<String>,
    scene: Spanned<String>,
    #[serde(default)]
    close_ups: Vec<[u32; 4]>,
    reference: Option<ReferenceWords>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct MethodWords {
    name: Option<String>,
    method: Spanned<String>,
    #[serde(default)]
    set: Vec<Spanned<String>>,
    amounts: Option<Vec<f64>>,
}

fn depth() -> u32 {
    64
}

fn most() -> u32 {
    64
}

/// The text with its name, for messages that say where.
struct Source<'a> {
    name: &'a str,
    text: &'a str,
    folder: &'a Path,
}

impl Source<'_> {
    fn wrong<T>(&self, at: &Spanned<T>, message: impl std::fmt::Display) -> StudyError {
        let before = &self.text[..at.span().start.min(self.text.len())];
        let line = before.matches('\n').count() + 1;
        let column = before.rsplit('\n').next().map_or(0, |l| l.chars().count()) + 1;
        StudyError::words(format!("{}:{line}:{column}", self.name), message)
    }

    /// The settings, each of which the method must know.
    fn settings(
        &self,
        method: kaustik::Method,
        set: &[Spanned<String>],
    ) -> Result<Vec<String>, StudyError> {
        for setting in set {
            options(method, &[setting.as_ref().clone()]).map_err(|m| self.wrong(setting, m))?;
        }
        Ok(set.iter().map(|s| s.as_ref().clone()).collect())
    }

    fn method(&self, words: &Spanned<String>) -> Result<kaustik::Method, StudyError> {
        words.as_ref().parse().map_err(|e| self.wrong(words, e))
    }

    fn reference(&self, words: &ReferenceWords) -> Result<ReferenceEntry, StudyError> {
        let method = self.method(&words.method)?;
        Ok(ReferenceEntry {
            method,
            settings: self.settings(method, &words.set)?,
            per_pixel: words.per_pixel,
            error: words.error,
            most: words.most,
        })
    }

    fn scene(&self, words: &SceneWords) -> Result<SceneEntry, StudyError> {
        let source = match words.scene.as_ref().strip_prefix("builtin:") {
            Some(name) => {
                builtin::load(name).map_err(|e| self.wrong(&words.scene, e))?;
                SceneSource::Builtin(name.to_owned())
            }
            None => {
                let path = self.folder.join(words.scene.as_ref());
                if !path.is_file() {
                    let message = format!(
                        "{} is no file: expected builtin:NAME, or a .gltf or .glb file",
                        path.display()
                    );
                    return Err(self.wrong(&words.scene, message));
                }
                SceneSource::File(path)
            }
        };
        let close_ups = words.close_ups.iter().map(|&[x0, y0, x1, y1]| {
            if x0 < x1 && y0 < y1 {
                Ok(Window { x0, y0, x1, y1 })
            } else {
                Err(self.wrong(&words.scene, "expected close_ups = [[x0, y0, x1, y1], ...]"))
            }
        });
        let reference = words.reference.as_ref().map(|r| self.reference(r));
        Ok(SceneEntry {
            name: (words.name.clone()).unwrap_or_else(|| words.scene.as_ref().clone()),
            source,
            close_ups: close_ups.collect::<Result<_, _>>()?,
            reference: reference.transpose()?,
        })
    }

    fn budgets(&self, words: &Spanned<BudgetWords>) -> Result<Budgets, StudyError> {
        let budget = words.as_ref();
        let given = [
            (Unit::Wall, &budget.wall),
            (Unit::Cpu, &budget.cpu),
            (Unit::PerPixel, &budget.per_pixel),
            (Unit::Total, &budget.total),
        ];
        let mut given = given.into_iter().filter_map(|(u, a)| Some((u, a.clone()?)));
        match (given.next(), given.next()) {
            (Some((unit, amounts)), None) => Ok(Budgets { unit, amounts }),
            _ => Err(self.wrong(words, "expected one of wall, cpu, per_pixel, total")),
        }
    }
}

impl Study {
    /// Reads a study from a TOML file. Scene files are looked for beside it.
    ///
    /// # Errors
    /// If the file cannot be read, or what is in it is no study; with line and column where it is
    /// wrong.
    pub fn load(path: &Path) -> Result<Self, StudyError> {
        let failed = |source| StudyError::io(path, source);
        let metadata = std::fs::metadata(path).map_err(failed)?;
        if !metadata.is_file() || metadata.len() > LARGEST {
            let message = "expected a file of at most 1 MiB";
            return Err(StudyError::words(path.display().to_string(), message));
        }
        let mut text = String::new();
        let file = std::fs::File::open(path).map_err(failed)?;
        file.take(LARGEST)
            .read_to_string(&mut text)
            .map_err(failed)?;
        let folder = path.parent().map_or(PathBuf::new(), Path::to_path_buf);
        Self::parse(&text, &path.display().to_string(), &folder)
    }

    /// As [`load`](Self::load), from text. `name` stands for the file in messages.
    ///
    /// # Errors
    /// As [`load`](Self::load).
    pub fn parse(text: &str, name: &str, folder: &Path) -> Result<Self, StudyError> {
        let source = Source { name, text, folder };
        let words: Words = toml::from_str(text).map_err(|error| {
            let start = error.span().map_or(0, |span| span.start);
            source.wrong(&Spanned::new(start..start, ()), error.message())
        })?;
        let methods = words.method.iter().map(|words| {
            let method = source.method(&words.method)?;
            Ok(MethodEntry {
                name: words.name.clone().unwrap_or_else(|| method.to_string()),
                method,
                settings: source.settings(method, &words.set)?,
                amounts: words.amounts.clone(),
            })
        });
        let scenes = words.scene.iter().map(|words| source.scene(words));
        let study = Self {
            title: words.title.clone().unwrap_or_else(|| name.to_owned()),
            about: words.about.clone(),
            width: words.width,
            height: words.height,
            max_depth: words.max_depth,
            threads: words.threads as usize,
            layers: words.layers,
            matched: words.matched.clone(),
            budgets: source.budgets(&words.budget)?,
            seeds: words.seeds.iter().map(|&seed| u64::from(seed)).collect(),
            scenes: scenes.collect::<Result<_, _>>()?,
            methods: methods.collect::<Result<_, StudyError>>()?,
            reference: source.reference(&words.reference)?,
        };
        match study.check() {
            Err(StudyError::Words { place, message }) => {
                Err(StudyError::words(format!("{name}: {place}"), message))
            }
            other => other.map(|()| study),
        }
    }
}

#[cfg(test)]
mod tests;
