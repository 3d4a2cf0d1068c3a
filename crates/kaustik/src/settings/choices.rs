//! What settings can be chosen from.

use glam::DVec2;
use kaustik_mutate::Radii;

use crate::settings::options::setting::{finite, range};

/// How small steps are made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SmallStep {
    /// Kelemen's: size between the two, its logarithm uniform.
    Kelemen(f64, f64),
    /// Uniform within this fraction of the domain.
    Uniform(f64),
}

impl SmallStep {
    /// Kelemen's own sizes (sec. 7).
    pub(crate) const KELEMEN: Self = Self::Kelemen(1.0 / 1024.0, 1.0 / 64.0);

    /// `kelemen`, `kelemen:S1:S2` or `uniform:FRACTION`.
    pub(crate) fn parse(text: &str) -> Option<Self> {
        let mut words = text.split(':');
        let kind = words.next()?;
        let numbers = words.map(finite).collect::<Option<Vec<f64>>>()?;
        match (kind, numbers.as_slice()) {
            ("kelemen", []) => Some(Self::KELEMEN),
            ("kelemen", &[s1, s2]) if s1 > 0.0 && s1 < s2 && s2 <= 0.5 => {
                Some(Self::Kelemen(s1, s2))
            }
            ("uniform", &[fraction]) if fraction > 0.0 && fraction <= 1.0 => {
                Some(Self::Uniform(fraction))
            }
            _ => None,
        }
    }

    /// What [`parse`](Self::parse) takes for it.
    pub(crate) fn text(&self) -> String {
        match self {
            Self::Kelemen(s1, s2) => format!("kelemen:{s1}:{s2}"),
            Self::Uniform(fraction) => format!("uniform:{fraction}"),
        }
    }
}

/// How much of its start a chain method makes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum StartShare {
    /// All of it, but with a time to keep no more than fits ([`Budget::Time`](crate::Budget::Time)).
    #[default]
    Auto,
    /// Halved so often, at most [`MOST_HALVINGS`](Self::MOST_HALVINGS) times.
    Halved(u32),
}

impl StartShare {
    /// All of it.
    pub const WHOLE: Self = Self::Halved(0);
    /// The least that is made is a share of one in two to this power.
    pub const MOST_HALVINGS: u32 = 10;
    /// A halved start keeps at least so many samples, or all if it had fewer.
    const LEAST: u64 = 64;

    /// Of so many samples those that are made.
    pub(crate) fn of(self, samples: u64) -> u64 {
        let Self::Halved(halvings) = self else {
            return samples;
        };
        let left = samples.checked_shr(halvings).unwrap_or(0);
        left.max(samples.min(Self::LEAST))
    }

    /// As a number, in (0, 1].
    pub(crate) fn share(self) -> f64 {
        match self {
            Self::Auto => 1.0,
            Self::Halved(halvings) => 0.5_f64.powi(halvings as i32),
        }
    }

    /// `auto`, `whole`, or `1/2` to `1/1024`, powers of two alone.
    pub(crate) fn parse(text: &str) -> Option<Self> {
        let whole: u32 = match text {
            "auto" => return Some(Self::Auto),
            "whole" => return Some(Self::WHOLE),
            share => share.strip_prefix("1/")?.parse().ok()?,
        };
        let halvings = whole.checked_ilog2()?;
        let is_share = whole.is_power_of_two() && (1..=Self::MOST_HALVINGS).contains(&halvings);
        is_share.then_some(Self::Halved(halvings))
    }

    /// What [`parse`](Self::parse) takes for it.
    pub(crate) fn text(&self) -> String {
        match self {
            Self::Auto => "auto".to_owned(),
            Self::Halved(0) => "whole".to_owned(),
            // what has no such word is not taken
            Self::Halved(halvings) => format!("1/{}", 1_u64.checked_shl(*halvings).unwrap_or(0)),
        }
    }
}

/// How paths are made under a chain.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Builder {
    /// A walk from the camera, joined to emitters at every vertex.
    #[default]
    Unidirectional,
    /// A walk from the camera, joined at its end only.
    Endpoint,
    /// Walks from a light and from the camera, joined at their ends.
    Simple,
    /// Walks from a light and from the camera, joined everywhere.
    Bidirectional,
}

/// Which estimate of `b` scales the image, or of its parts the replicas' films.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Normaliser {
    /// All independent samples, those before the chains and among their steps: consistent, and better all
    /// the time.
    #[default]
    Running,
    /// Those before the chains alone: exactly unbiased (`relt`: but for exchanges, and but for an annealing that
    /// died out and began again).
    Initial,
    /// What chains tell about the next: RELT eq. 10, `relt` alone.
    Exchange,
}

impl Normaliser {
    /// All, with the words for them.
    pub(crate) const WORDS: &[(&str, Self)] = &[
        ("running", Self::Running),
        ("initial", Self::Initial),
        ("exchange", Self::Exchange),
    ];

    /// The word for it.
    pub(crate) fn name(self) -> &'static str {
        let mut words = Self::WORDS.iter();
        (words.find(|(_, it)| *it == self)).map_or("", |(word, _)| *word)
    }
}

/// How often `mmlt` tries the strategies of a length.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Strategies {
    /// By the spread of what each brings to a pilot.
    #[default]
    Learned,
    /// All alike.
    Even,
}

/// Which paths independent samples beside the chains see to; chains leave these out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Direct {
    /// `Apart` for `pssmlt`, `mmlt`, `mlt`, `erpt` and `erpt-pss` where a look at the scene finds direct light easy to find for
    /// independent samples; else, and for other methods, `Lamps`.
    #[default]
    Auto,
    /// Paths of one edge: emitters and surroundings seen directly. Of `mlt`, `mlt-multistage` and `erpt` all purely specular
    /// paths: those seen by way of mirrors and smooth glass alone. (`erpt-pss`, whose chains start in every pixel,
    /// has nothing of this.)
    Lamps,
    /// None.
    Together,
    /// Paths of at most two edges: light that was scattered once as well.
    Apart,
}

/// Sizes of small steps of `relt`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Steps {
    /// From Kelemen's smallest to the largest that RELT 5.1.3 prints; of the specific replica Kelemen's.
    #[default]
    Fine,
    /// Kelemen's for all.
    Kelemen,
    /// Those that RELT 5.1.3 prints.
    Paper,
    /// Adapted by each ladder.
    Adapted,
}

/// How many samples of `relt` are spread evenly over the image, for each sweep of a ladder.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum EvenSamples {
    /// The more, the easier light is to find.
    #[default]
    Auto,
    /// So many.
    Count(u32),
}

impl EvenSamples {
    /// The most a sweep.
    pub(crate) const MOST: u32 = 256;

    /// `auto`, or a number up to [`MOST`](Self::MOST).
    pub(crate) fn parse(text: &str) -> Option<Self> {
        let count = || {
            text.parse()
                .ok()
                .filter(|n| *n <= Self::MOST)
                .map(Self::Count)
        };
        if text == "auto" {
            Some(Self::Auto)
        } else {
            count()
        }
    }

    /// What [`parse`](Self::parse) takes for it.
    pub(crate) fn text(&self) -> String {
        match self {
            Self::Auto => "auto".to_owned(),
            Self::Count(count) => count.to_string(),
        }
    }
}

/// Where the chains of `erpt` start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Starts {
    /// At the paths of a path tracer, from every pixel.
    #[default]
    Path,
    /// At paths of walks from both sides, joined in every way, one of each sample.
    Bidirectional,
}

/// What fixes the light of a deposit of `erpt`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Energy {
    /// Samples of a pilot (Batty's Algorithm 1).
    #[default]
    Pilot,
    /// The pilot first, and for each pass over the image all the passes of the same ladder before it.
    Passes,
}

/// In which colour chains of `erpt` deposit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Colours {
    /// That of the path deposited on.
    #[default]
    Current,
    /// That of the chain's start, as Batty's Algorithm 2 prints: wrong.
    Printed,
}

/// By which density change `erpt` judges caustic perturbations.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Caustics {
    /// Cline's rules 2 and 5.
    #[default]
    Exact,
    /// Rule 5 alone, as Batty's section 4.2 prints: wrong.
    Printed,
}

/// How far perturbations move what is seen.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Jitter {
    /// `mlt`: as Veach; `erpt`: local.
    #[default]
    Standard,
    /// A tenth of a pixel up to the radius of a twentieth of the image.
    Veach,
    /// A tenth of a pixel up to a twentieth of the shorter side.
    Local,
    /// Pixels, least and most.
    Between([f64; 2]),
}

impl Jitter {
    /// A word, or two numbers of pixels that grow, with a colon between them.
    pub(crate) fn parse(text: &str) -> Option<Self> {
        match text {
            "standard" => Some(Self::Standard),
            "veach" => Some(Self::Veach),
            "local" => Some(Self::Local),
            _ => range(text, 1e6).map(Self::Between),
        }
    }

    /// What [`parse`](Self::parse) takes for it.
    pub(crate) fn text(&self) -> String {
        match self {
            Self::Standard => "standard".to_owned(),
            Self::Veach => "veach".to_owned(),
            Self::Local => "local".to_owned(),
            Self::Between([least, most]) => format!("{least}:{most}"),
        }
    }

    /// In pixels, in an image of this size; `standard` is what the word of this name stands for.
    pub(crate) fn radii(self, size: DVec2, standard: Self) -> Radii {
        match self {
            Self::Standard if standard == Self::Local => Self::Local.radii(size, Self::Veach),
            Self::Standard | Self::Veach => Radii::raster(size),
            Self::Local => Radii {
                least: 0.1,
                most: (0.05 * size.min_element()).max(1.0),
            },
            Self::Between([least, most]) => Radii { least, most },
        }
    }
}
