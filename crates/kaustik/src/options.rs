//! The settings that `--set key=value` reaches.

use kaustik_estimate::{Contribution, Mis, ReplicaSet, ScalarTarget};
use kaustik_mcmc::Schedule;
use kaustik_path::Heuristic;
use kaustik_spectrum::WavelengthSampling;

use crate::choices::{Builder, Direct, Normaliser, SmallStep, Steps, Strategies};
use crate::method::{KEYS, Method};
use crate::{Mutations, PhotonOptions};

/// All settings; a method reads those that [`Method::keys`] lists.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(missing_docs, reason = "the table of keys says what each does")]
pub struct Options {
    pub ladders: u32,
    pub wavelengths: WavelengthSampling,
    pub compensation: bool,
    pub pilot: u64,
    pub next_event: bool,
    pub builder: Builder,
    pub heuristic: Heuristic,
    pub strategies: Strategies,
    pub target: ScalarTarget,
    pub contribution: Contribution,
    pub p_large: f64,
    pub small_step: SmallStep,
    pub mis: Mis,
    pub normaliser: Normaliser,
    pub direct: Direct,
    /// `None`: the standard set with `delta`.
    pub replicas: Option<ReplicaSet>,
    pub delta: f64,
    pub beta: f64,
    pub exchange: Schedule,
    pub steps: Steps,
    pub particles: u64,
    pub length: u32,
    pub chains: f64,
    /// `None`: no filter.
    pub consecutive: Option<u64>,
    pub mutations: Mutations,
    /// Pixels, least and most; `None`: Veach's.
    pub jitter: Option<[f64; 2]>,
    /// Radians, least and most.
    pub angles: [f64; 2],
    pub photon: PhotonOptions,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            ladders: 64,
            wavelengths: WavelengthSampling::Hero,
            compensation: true,
            pilot: 100_000,
            next_event: true,
            builder: Builder::default(),
            heuristic: Heuristic::default(),
            strategies: Strategies::default(),
            target: ScalarTarget::default(),
            contribution: Contribution::default(),
            p_large: 0.3,
            small_step: SmallStep::Kelemen(1.0 / 1024.0, 1.0 / 64.0),
            mis: Mis::default(),
            normaliser: Normaliser::default(),
            direct: Direct::default(),
            replicas: None,
            delta: ReplicaSet::DELTA,
            beta: 2.0,
            exchange: Schedule::Full,
            steps: Steps::default(),
            particles: 10_000,
            length: 100,
            chains: 1.0,
            consecutive: None,
            mutations: Mutations::ALL,
            jitter: None,
            angles: [1e-4, 0.1],
            photon: PhotonOptions::default(),
        }
    }
}

/// A `--set` that means nothing.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum OptionError {
    /// Not of the form `key=value`.
    #[error("'{0}' is not of the form key=value")]
    Form(String),
    /// A key that the method does not have.
    #[error("method {method} has no setting '{key}'; it has: {known}")]
    Key {
        /// The method.
        method: Method,
        /// The key.
        key: String,
        /// The keys that it has.
        known: String,
    },
    /// A value out of its range.
    #[error("setting {key}: '{value}' is not one of {range}")]
    Value {
        /// The key.
        key: &'static str,
        /// The value.
        value: String,
        /// What was expected.
        range: &'static str,
    },
}

impl Options {
    /// Applies `key=value` for a method.
    ///
    /// # Errors
    /// A text of another form, a key that the method does not have, a value out of range; each
    /// names what was expected.
    pub fn set(&mut self, method: Method, text: &str) -> Result<(), OptionError> {
        let (key, value) = text
            .split_once('=')
            .ok_or_else(|| OptionError::Form(text.to_owned()))?;
        let key = KEYS
            .iter()
            .find(|known| known.name == key && known.methods.contains(&method))
            .ok_or_else(|| OptionError::Key {
                method,
                key: key.to_owned(),
                known: method
                    .keys()
                    .map(|key| key.name)
                    .collect::<Vec<_>>()
                    .join(", "),
            })?;
        let known = key.name != "normaliser" || key.range.split('|').any(|word| word == value);
        known
            .then(|| self.assign(key.name, value))
            .flatten()
            .ok_or_else(|| OptionError::Value {
                key: key.name,
                value: value.to_owned(),
                range: key.range,
            })
    }

    /// The settings of a method as one would write them, defaults included: what a picture needs to be
    /// made again.
    pub fn entries(&self, method: Method) -> Vec<(&'static str, String)> {
        method
            .keys()
            .map(|key| (key.name, self.value(key.name)))
            .collect()
    }

    fn value(&self, key: &str) -> String {
        let switch = |on: bool| if on { "on" } else { "off" };
        match key {
            "ladders" => self.ladders.to_string(),
            "pilot" => self.pilot.to_string(),
            "plarge" => self.p_large.to_string(),
            "mutation" => match self.small_step {
                SmallStep::Kelemen(s1, s2) => format!("kelemen:{s1}:{s2}"),
                SmallStep::Uniform(fraction) => format!("uniform:{fraction}"),
            },
            "wavelengths" => match self.wavelengths {
                WavelengthSampling::Hero => "hero",
                WavelengthSampling::Single => "uniform",
            }
            .to_owned(),
            "compensation" => switch(self.compensation).to_owned(),
            "nextevent" => switch(self.next_event).to_owned(),
            "builder" => match self.builder {
                Builder::Unidirectional => "unidirectional",
                Builder::Endpoint => "endpoint",
                Builder::Simple => "simple",
                Builder::Bidirectional => "bidirectional",
            }
            .to_owned(),
            "heuristic" => match self.heuristic {
                Heuristic::Power => "power",
                Heuristic::Balance => "balance",
                Heuristic::Maximum => "maximum",
            }
            .to_owned(),
            "strategies" => match self.strategies {
                Strategies::Learned => "learned",
                Strategies::Even => "even",
            }
            .to_owned(),
            "target" => match self.target {
                ScalarTarget::Xyz => "xyz",
                ScalarTarget::Luminance => "luminance",
            }
            .to_owned(),
            "contribution" => match self.contribution {
                Contribution::Sum => "sum",
                Contribution::Maximum => "maximum",
            }
            .to_owned(),
            "mis" => match self.mis {
                Mis::Split => "split",
                Mis::Printed => "printed",
                Mis::Off => "off",
            }
            .to_owned(),
            "normaliser" => self.normaliser.name().to_owned(),
            "direct" => match self.direct {
                Direct::Lamps => "lamps",
                Direct::Together => "together",
                Direct::Apart => "apart",
            }
            .to_owned(),
            "replicas" => (self.replicas).map_or("standard".to_owned(), |set| set.to_string()),
            "delta" => self.delta.to_string(),
            "beta" => self.beta.to_string(),
            "exchange" => EXCHANGES
                .iter()
                .find(|(_, schedule)| *schedule == self.exchange)
                .map_or(String::new(), |(word, _)| (*word).to_owned()),
            "steps" => match self.steps {
                Steps::Fine => "fine",
                Steps::Paper => "paper",
                Steps::Adapted => "adapted",
            }
            .to_owned(),
            "particles" => self.particles.to_string(),
            "length" => self.length.to_string(),
            "chains" => self.chains.to_string(),
            "consecutive" => (self.consecutive).map_or("off".to_owned(), |n| n.to_string()),
            "mutations" => self.mutations.to_string(),
            "jitter" => (self.jitter).map_or("veach".to_owned(), |[a, b]| format!("{a}:{b}")),
            "angles" => format!("{}:{}", self.angles[0], self.angles[1]),
            other => self.photon.value(other).unwrap_or_default(),
        }
    }

    /// `None` if the value is out of range.
    fn assign(&mut self, key: &str, value: &str) -> Option<()> {
        match key {
            "ladders" => self.ladders = integer(value, 1, 4096)? as u32,
            "pilot" => self.pilot = integer(value, 1, 10_000_000)?,
            "wavelengths" => {
                let (hero, single) = (WavelengthSampling::Hero, WavelengthSampling::Single);
                self.wavelengths = word(value, &[("hero", hero), ("uniform", single)])?;
            }
            "compensation" => self.compensation = switch(value)?,
            "nextevent" => self.next_event = switch(value)?,
            "builder" => {
                let words = [
                    ("unidirectional", Builder::Unidirectional),
                    ("endpoint", Builder::Endpoint),
                    ("simple", Builder::Simple),
                    ("bidirectional", Builder::Bidirectional),
                ];
                self.builder = word(value, &words)?;
            }
            "heuristic" => {
                let words = [
                    ("power", Heuristic::Power),
                    ("balance", Heuristic::Balance),
                    ("maximum", Heuristic::Maximum),
                ];
                self.heuristic = word(value, &words)?;
            }
            "strategies" => {
                let (learned, even) = (Strategies::Learned, Strategies::Even);
                self.strategies = word(value, &[("learned", learned), ("even", even)])?;
            }
            "target" => {
                let (xyz, y) = (ScalarTarget::Xyz, ScalarTarget::Luminance);
                self.target = word(value, &[("xyz", xyz), ("luminance", y)])?;
            }
            "contribution" => {
                let (sum, max) = (Contribution::Sum, Contribution::Maximum);
                self.contribution = word(value, &[("sum", sum), ("maximum", max)])?;
            }
            "plarge" => self.p_large = number(value).filter(|p| *p > 0.0 && *p <= 1.0)?,
            "mutation" => self.small_step = small_step(value)?,
            "mis" => {
                let words = [
                    ("split", Mis::Split),
                    ("printed", Mis::Printed),
                    ("off", Mis::Off),
                ];
                self.mis = word(value, &words)?;
            }
            "normaliser" => {
                let words = [
                    Normaliser::Running,
                    Normaliser::Initial,
                    Normaliser::Exchange,
                ];
                self.normaliser = word(value, &words.map(|n| (n.name(), n)))?;
            }
            "direct" => {
                let words = [
                    ("lamps", Direct::Lamps),
                    ("together", Direct::Together),
                    ("apart", Direct::Apart),
                ];
                self.direct = word(value, &words)?;
            }
            "replicas" if value == "standard" => self.replicas = None,
            "replicas" => self.replicas = Some(value.parse().ok()?),
            "delta" => self.delta = number(value).filter(|d| *d > 0.0 && *d <= 1.0)?,
            "beta" => self.beta = number(value).filter(|b| (1.0..=8.0).contains(b))?,
            "exchange" => self.exchange = word(value, EXCHANGES)?,
            "steps" => {
                let words = [
                    ("fine", Steps::Fine),
                    ("paper", Steps::Paper),
                    ("adapted", Steps::Adapted),
                ];
                self.steps = word(value, &words)?;
            }
            "particles" => self.particles = integer(value, 1_000, 1_000_000)?,
            "length" => self.length = integer(value, 1, 100_000)? as u32,
            "chains" => self.chains = number(value).filter(|n| (0.01..=100.0).contains(n))?,
            "consecutive" if value == "off" => self.consecutive = None,
            "consecutive" => self.consecutive = Some(integer(value, 1, 100_000)?),
            "mutations" => self.mutations = Mutations::parse(value)?,
            "jitter" if value == "veach" => self.jitter = None,
            "jitter" => self.jitter = Some(range(value, 1e6)?),
            "angles" => self.angles = range(value, 3.0)?,
            other => self.photon.assign(other, value)?,
        }
        Some(())
    }

    /// The replicas of `relt`.
    pub fn replica_set(&self) -> ReplicaSet {
        (self.replicas).unwrap_or_else(|| ReplicaSet::standard(self.delta))
    }
}

/// Words for exchanges.
const EXCHANGES: &[(&str, Schedule)] = &[
    ("full", Schedule::Full),
    ("pair", Schedule::RandomPair),
    ("alternating", Schedule::Alternating),
    ("gibbs", Schedule::Permutation),
    ("none", Schedule::Off),
];

fn word<T: Copy>(value: &str, words: &[(&str, T)]) -> Option<T> {
    words
        .iter()
        .find(|(word, _)| *word == value)
        .map(|(_, meaning)| *meaning)
}

fn switch(value: &str) -> Option<bool> {
    word(value, &[("on", true), ("off", false)])
}

fn integer(value: &str, least: u64, most: u64) -> Option<u64> {
    value.parse().ok().filter(|n| (least..=most).contains(n))
}

fn number(value: &str) -> Option<f64> {
    value.parse().ok().filter(|x: &f64| x.is_finite())
}

/// Two numbers that grow, both above 0, with a colon between them.
fn range(value: &str, most: f64) -> Option<[f64; 2]> {
    let (a, b) = value.split_once(':')?;
    Some([number(a)?, number(b)?]).filter(|[a, b]| 0.0 < *a && a < b && *b <= most)
}

fn small_step(value: &str) -> Option<SmallStep> {
    let mut words = value.split(':');
    let kind = words.next()?;
    let numbers = words.map(number).collect::<Option<Vec<f64>>>()?;
    match (kind, numbers.as_slice()) {
        ("kelemen", []) => Some(Options::default().small_step),
        ("kelemen", &[s1, s2]) if s1 > 0.0 && s1 < s2 && s2 <= 0.5 => {
            Some(SmallStep::Kelemen(s1, s2))
        }
        ("uniform", &[fraction]) if fraction > 0.0 && fraction <= 1.0 => {
            Some(SmallStep::Uniform(fraction))
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_default_of_the_table_is_the_default() {
        for method in Method::ALL {
            for key in method.keys() {
                let mut options = Options::default();
                options
                    .set(method, &format!("{}={}", key.name, key.default))
                    .unwrap();
                assert_eq!(options, Options::default(), "{}", key.name);
            }
        }
    }

    #[test]
    fn what_is_written_is_what_was_set() {
        let mut options = Options::default();
        for text in [
            "mutation=uniform:0.05",
            "mis=off",
            "target=luminance",
            "plarge=0.5",
            "builder=simple",
            "heuristic=maximum",
        ] {
            options.set(Method::Pssmlt, text).unwrap();
        }
        let mut again = Options::default();
        for (key, value) in options.entries(Method::Pssmlt) {
            again
                .set(Method::Pssmlt, &format!("{key}={value}"))
                .unwrap();
        }
        assert_eq!(again, options);
    }

    #[test]
    fn what_is_written_of_replicas_is_what_was_set() {
        let mut options = Options::default();
        for text in [
            "replicas=uniform;1,0,1,1,1,1;0.5,0,0,1,1,1",
            "beta=1.5",
            "exchange=pair",
            "steps=adapted",
            "particles=2000",
            "delta=0.1",
            "normaliser=exchange",
        ] {
            options.set(Method::Relt, text).unwrap();
        }
        assert_eq!(options.replica_set().count(), 3);
        let mut again = Options::default();
        for (key, value) in options.entries(Method::Relt) {
            again.set(Method::Relt, &format!("{key}={value}")).unwrap();
        }
        assert_eq!(again, options);
        for wrong in [
            "replicas=uniform;1,0,0,0,0,0;0,1,0,0,0,0",
            "beta=0.5",
            "delta=0",
            "exchange=some",
            "particles=10",
        ] {
            assert!(again.set(Method::Relt, wrong).is_err(), "{wrong}");
        }
        assert_eq!(again, options);
    }

    #[test]
    fn what_is_written_of_mutations_is_what_was_set() {
        let mut options = Options::default();
        for text in [
            "mutations=lens,bidirectional",
            "jitter=0.5:20",
            "angles=0.001:0.5",
        ] {
            options.set(Method::Mlt, text).unwrap();
        }
        let mut again = Options::default();
        for (key, value) in options.entries(Method::Mlt) {
            again.set(Method::Mlt, &format!("{key}={value}")).unwrap();
        }
        assert_eq!(again, options);
        for wrong in [
            "mutations=",
            "mutations=lens,small",
            "jitter=3:1",
            "angles=0.1:4",
            "angles=1",
        ] {
            assert!(again.set(Method::Mlt, wrong).is_err(), "{wrong}");
        }
        assert_eq!(again, options);
    }

    #[test]
    fn wrong_words_are_refused_with_what_was_expected() {
        let mut options = Options::default();
        let message = |text: &str, options: &mut Options| {
            options.set(Method::Pssmlt, text).unwrap_err().to_string()
        };
        assert!(message("plarge=0", &mut options).contains("0 < p <= 1"));
        assert!(message("plarge=nan", &mut options).contains("plarge"));
        assert!(message("mutation=uniform", &mut options).contains("uniform:FRACTION"));
        assert!(message("colour=red", &mut options).contains("ladders"));
        assert!(message("plarge", &mut options).contains("key=value"));
        assert_eq!(options, Options::default());
        let error = options.set(Method::Path, "plarge=0.5").unwrap_err();
        assert!(matches!(error, OptionError::Key { .. }));
    }
}
