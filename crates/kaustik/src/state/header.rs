//! What a state is the state of.

use kaustik_film::Window;
use kaustik_scene::Scene;
use serde::{Deserialize, Serialize};

use super::StateError;
use super::packed::Packed;
use crate::{Budget, Options, RenderSettings};

/// Where the scene of a render came from, in the words that found it: `merge` loads it again.
/// Not compared: the scene's content is.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Source {
    /// A file, or the name of a built-in scene.
    pub scene: String,
    /// Name of the camera, if not the first.
    pub camera: Option<String>,
    /// Material variant of a glTF file, if not its default.
    pub variant: Option<String>,
    /// Light from all around, if not the scene's own.
    pub environment: Option<String>,
}

/// All that decides what is in a state, and where it came from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Header {
    software: String,
    method: String,
    seed: u64,
    size: [u32; 2],
    crop: Window,
    filter: String,
    max_depth: u32,
    /// The method's settings, as [`Options::set`] takes them.
    options: Vec<(String, String)>,
    /// First of the ladders that are in it, and the one after the last.
    ladders: [u32; 2],
    /// See [`Scene::content`].
    scene: [u8; 32],
    pub(super) source: Source,
    /// Time that sampling has taken so far.
    seconds: f64,
}

impl Header {
    pub(crate) fn new(scene: &Scene, settings: &RenderSettings, seconds: f64) -> Self {
        let ladders = settings.ladder_range();
        let entries = settings.options.entries(settings.method);
        Self {
            software: format!("kaustik {}", env!("CARGO_PKG_VERSION")),
            method: settings.method.to_string(),
            seed: settings.seed,
            size: [settings.width, settings.height],
            crop: settings.layout().crop,
            filter: settings.filter.to_string(),
            max_depth: settings.max_depth,
            options: entries
                .into_iter()
                .map(|(k, v)| (k.to_owned(), v))
                .collect(),
            ladders: [ladders.start, ladders.end],
            scene: scene.content(),
            source: Source::default(),
            seconds,
        }
    }

    /// The same, of a scene that came from there.
    pub(super) fn with(&self, source: &Source) -> Self {
        Self {
            source: source.clone(),
            ..self.clone()
        }
    }

    pub(crate) fn seconds(&self) -> f64 {
        self.seconds
    }

    pub(crate) fn seed(&self) -> u64 {
        self.seed
    }

    pub(crate) fn ladders(&self) -> std::ops::Range<u32> {
        self.ladders[0]..self.ladders[1]
    }

    /// Everything that must be equal for two states, or a state and a render, to be of one picture: names and
    /// values. Without the ladders.
    fn law(&self) -> Vec<(&str, String)> {
        let hex = |byte: &u8| format!("{byte:02x}");
        let mut law = vec![
            ("program", self.software.clone()),
            ("method", self.method.clone()),
            ("seed", self.seed.to_string()),
            ("width", self.size[0].to_string()),
            ("height", self.size[1].to_string()),
            ("crop", self.crop.to_string()),
            ("filter", self.filter.clone()),
            ("max-depth", self.max_depth.to_string()),
        ];
        law.extend(self.options.iter().map(|(k, v)| (k.as_str(), v.clone())));
        // Two hashes that differ do so early.
        law.push(("scene's content", self.scene[..8].iter().map(hex).collect()));
        law
    }

    /// Refuses another picture, with both values of whatever differs.
    pub(crate) fn same_picture(&self, asked: &Self) -> Result<(), StateError> {
        let (state, asked_law) = (self.law(), asked.law());
        let differences: Vec<String> = if self.method == asked.method {
            let pairs = state.iter().zip(&asked_law);
            pairs
                .filter(|(a, b)| a != b)
                .map(|((name, a), (_, b))| format!("{name} is {a} in the state, {b} here"))
                .collect()
        } else {
            // Their settings have nothing to do with each other.
            let (a, b) = (&self.method, &asked.method);
            vec![format!("method is {a} in the state, {b} here")]
        };
        let alike = state.len() == asked_law.len() && self.scene == asked.scene;
        if differences.is_empty() && alike {
            return Ok(());
        }
        let differences = match differences.is_empty() {
            true => "they do not have the same settings".to_owned(),
            false => differences.join("; "),
        };
        Err(StateError::Other(differences))
    }

    /// As [`same_picture`](Self::same_picture), of whatever seeds; of different ones with as much of the start as each had time for.
    pub(crate) fn same_but_seed(&self, other: &Self) -> Result<(), StateError> {
        let mut alike = Self {
            seed: self.seed,
            ..other.clone()
        };
        if self.seed != other.seed {
            let start = |header: &Self| header.options.iter().position(|(key, _)| key == "start");
            if let (Some(own), Some(its)) = (start(self), start(other)) {
                alike.options[its] = self.options[own].clone();
            }
        }
        self.same_picture(&alike)
    }

    /// As [`same_picture`](Self::same_picture), and the same share of it.
    pub(crate) fn same_share(&self, asked: &Self) -> Result<(), StateError> {
        self.same_picture(asked)?;
        let [a, b] = [self.ladders(), asked.ladders()];
        if a == b {
            return Ok(());
        }
        Err(StateError::Other(format!(
            "ladders are {}..{} in the state, {}..{} here",
            a.start, a.end, b.start, b.end
        )))
    }

    /// The settings that it was made with; the budget is not among them.
    pub(super) fn settings(&self) -> Result<RenderSettings, StateError> {
        let wrong = |what: &str| StateError::damaged(format!("its {what} makes no sense"));
        let method = self.method.parse().map_err(|_| wrong("method"))?;
        let mut options = Options::default();
        for (key, value) in &self.options {
            options
                .set(method, &format!("{key}={value}"))
                .map_err(|error| StateError::damaged(error.to_string()))?;
        }
        let [width, height] = self.size;
        if !Window::full(width, height).contains(&self.crop) || self.crop.area() == 0 {
            return Err(wrong("crop window"));
        }
        let ladders = self.ladders();
        if ladders.is_empty() || ladders.end > options.ladders {
            return Err(wrong("range of ladders"));
        }
        Ok(RenderSettings {
            method,
            options,
            width,
            height,
            crop: Some(self.crop),
            filter: self.filter.parse().map_err(|_| wrong("filter"))?,
            budget: Budget::Total(0),
            seed: self.seed,
            max_depth: self.max_depth,
            ladders: Some(ladders),
            ..RenderSettings::default()
        })
    }

    /// Refuses a file that is too short for its picture, before anything is made of it.
    pub(super) fn fits(&self, bytes: usize) -> Result<(), StateError> {
        let ladders = u64::from(self.ladders[1].saturating_sub(self.ladders[0]));
        let sums = self.crop.area().saturating_mul(3);
        let least = Packed::least(usize::try_from(sums).unwrap_or(usize::MAX)) as u64;
        if !self.seconds.is_finite() || self.seconds < 0.0 || self.seconds > 1e12 {
            return Err(StateError::damaged("its time makes no sense"));
        }
        if least.max(ladders) > bytes as u64 {
            return Err(StateError::damaged(
                "it is shorter than a picture of its size",
            ));
        }
        Ok(())
    }
}
