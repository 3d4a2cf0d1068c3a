//! What decides what a render computes: its method, the method's settings, size and budget.

mod choices;
mod key;
mod method;
mod mutation_kind;
mod mutations;
pub(crate) mod options;
pub(crate) mod photon_options;

pub use choices::{
    Builder, Caustics, Colours, Direct, Energy, EvenSamples, Jitter, Normaliser, SmallStep,
    StartShare, Starts, Steps, Strategies,
};
pub use key::{KEYS, Key};
pub use method::{Method, UnknownMethod};
pub use mutation_kind::MutationKind;
pub use mutations::Mutations;
pub use options::{OptionError, Options};
pub use photon_options::{LadderSize, Normalisation, Pace, PhotonOptions, TargetFunction};

use std::ops::Range;
use std::time::Duration;

use kaustik_estimate::Scale;
use kaustik_film::{Filter, Layout, Window};
use kaustik_scene::SceneOptions;

/// When a render is done.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Budget {
    /// Samples (or mutations) a pixel; of photon methods iterations.
    PerPixel(u64),
    /// Samples or mutations in all; of photon methods light paths.
    Total(u64),
    /// Wall-clock time: the first unit of work (a round, a pass, an iteration), and each that ends nearer to it than where the
    /// one before has ended.
    Time(Duration),
}

/// All that decides what a render computes, but for the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderSettings {
    /// The method.
    pub method: Method,
    /// Its settings.
    pub options: Options,
    /// Columns of the image, > 0: those that the scene was compiled for.
    pub width: u32,
    /// Rows of the image, > 0: those that the scene was compiled for.
    pub height: u32,
    /// Pixels to render; `None` is all.
    pub crop: Option<Window>,
    /// Reconstruction filter.
    pub filter: Filter,
    /// When it is done.
    pub budget: Budget,
    /// Every random number follows from it.
    pub seed: u64,
    /// Worker threads; 0 is one for each processor. Not part of the result.
    pub threads: usize,
    /// Longest path in edges, > 0; at most 4096 for `mmlt`, `mlt`, `mlt-multistage` and `erpt`.
    pub max_depth: u32,
    /// The ladders that this process runs; `None` is all.
    pub ladders: Option<Range<u32>>,
    /// Render albedo, normal and depth of what is seen first as layers, and keep the parts of the picture
    /// that a method knows (`relt`: its replicas) as layers.
    pub features: bool,
}

impl Default for RenderSettings {
    fn default() -> Self {
        Self {
            method: Method::default(),
            options: Options::default(),
            width: 1024,
            height: 1024,
            crop: None,
            filter: Filter::default(),
            budget: Budget::Time(Duration::from_secs(60)),
            seed: 0,
            threads: 0,
            max_depth: 64,
            ladders: None,
            features: true,
        }
    }
}

impl RenderSettings {
    /// What a scene must be compiled with to be rendered by these settings; its first camera, its own environment.
    pub fn scene_options(&self) -> SceneOptions {
        SceneOptions {
            width: self.width,
            height: self.height,
            compensation: self.options.compensation,
            ..SceneOptions::default()
        }
    }

    /// Size, crop and filter for a film.
    pub fn layout(&self) -> Layout {
        let layout = Layout::new(self.width, self.height).with_filter(self.filter);
        match self.crop {
            Some(crop) => layout.with_crop(crop),
            None => layout,
        }
    }

    /// From raster to pixels.
    pub(crate) fn scale(&self) -> Scale {
        Scale {
            width: f64::from(self.width),
            height: f64::from(self.height),
        }
    }

    /// The ladders that this process runs.
    pub fn ladder_range(&self) -> Range<u32> {
        self.ladders.clone().unwrap_or(0..self.options.ladders)
    }

    /// Pixels of the crop window.
    pub(crate) fn pixels(&self) -> u64 {
        self.layout().crop.area()
    }

    /// Independent samples at the start.
    pub(crate) fn pilot(&self) -> u64 {
        self.options.start.of(self.options.pilot)
    }

    /// Particles of an annealing at the start.
    pub(crate) fn particles(&self) -> u64 {
        self.options.start.of(self.options.particles)
    }

    /// Light paths of an iteration of a photon method. Points and what photons cannot carry take a pixel's time each iteration: in large
    /// pictures few light paths would be a small part of the work.
    pub(crate) fn photons(&self) -> u64 {
        let suited = || self.pixels().saturating_mul(2).clamp(250_000, 100_000_000);
        self.options.photon.photons.unwrap_or_else(suited)
    }

    /// Steps of a ladder whose steps all count alike.
    pub(crate) fn planned(&self, ladder: u32) -> u64 {
        match self.budget {
            Budget::PerPixel(n) => self.share(n.saturating_mul(self.pixels()), ladder),
            Budget::Total(n) => self.share(n, ladder),
            Budget::Time(_) => u64::MAX,
        }
    }

    /// Steps of a ladder that takes them in sweeps of so many: whole sweeps within the budget, at
    /// least one in all.
    pub(crate) fn planned_sweeps(&self, ladder: u32, each: u64) -> u64 {
        let total = match self.budget {
            Budget::PerPixel(n) => n.saturating_mul(self.pixels()),
            Budget::Total(n) => n,
            Budget::Time(_) => return u64::MAX / each * each,
        };
        let sweeps = (total / each).max(u64::from(total > 0));
        self.share(sweeps, ladder) * each
    }

    /// How many of `total` steps fall to a ladder: as even as can be, the first ladders take one more.
    fn share(&self, total: u64, ladder: u32) -> u64 {
        let ladders = u64::from(self.options.ladders);
        total / ladders + u64::from(u64::from(ladder) < total % ladders)
    }
}
