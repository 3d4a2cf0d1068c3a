//! The settings that `--set key=value` reaches.

use kaustik_estimate::{Contribution, Mis, ReplicaSet, ScalarTarget};
use kaustik_mcmc::Schedule;
use kaustik_path::Heuristic;
use kaustik_spectrum::WavelengthSampling;

pub(crate) mod setting;
mod table;

use crate::settings::choices::{
    Builder, Caustics, Colours, Direct, Energy, EvenSamples, Jitter, Normaliser, SmallStep, Starts,
    Steps, Strategies,
};
use crate::settings::key::KEYS;
use crate::settings::method::Method;
use crate::{Mutations, PhotonOptions, RenderError, StageOptions};

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
    pub meter: bool,
    pub direct: Direct,
    /// `None`: the standard set with `delta`.
    pub replicas: Option<ReplicaSet>,
    pub delta: f64,
    pub beta: f64,
    pub exchange: Schedule,
    pub even: EvenSamples,
    pub steps: Steps,
    pub particles: u64,
    pub length: u32,
    pub chains: f64,
    /// `None`: no filter.
    pub consecutive: Option<u64>,
    /// `None`: no filter.
    pub proposed: Option<f64>,
    pub seeds: Starts,
    pub energy: Energy,
    pub perturbations: Mutations,
    pub deposit: Colours,
    pub caustic: Caustics,
    pub mutations: Mutations,
    pub jitter: Jitter,
    /// Radians, least and most.
    pub angles: [f64; 2],
    pub photon: PhotonOptions,
    pub stages: StageOptions,
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
            small_step: SmallStep::KELEMEN,
            mis: Mis::default(),
            normaliser: Normaliser::default(),
            meter: true,
            direct: Direct::default(),
            replicas: None,
            delta: ReplicaSet::DELTA,
            beta: 2.0,
            exchange: Schedule::Full,
            even: EvenSamples::default(),
            steps: Steps::default(),
            particles: 10_000,
            length: 300,
            chains: 0.01,
            consecutive: None,
            proposed: None,
            seeds: Starts::default(),
            energy: Energy::default(),
            perturbations: Mutations::PERTURBATIONS,
            deposit: Colours::default(),
            caustic: Caustics::default(),
            mutations: Mutations::STANDARD,
            jitter: Jitter::default(),
            angles: [1e-4, 0.1],
            photon: PhotonOptions::default(),
            stages: StageOptions::default(),
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
    #[error(
        "method {method} has no setting '{key}'; it has: {known}{}",
        elsewhere(others)
    )]
    Key {
        /// The method.
        method: Method,
        /// The key.
        key: String,
        /// The keys that it has.
        known: String,
        /// The methods that have the key.
        others: Vec<Method>,
    },
    /// A value out of its range.
    #[error("setting {key}: found '{value}', expected {range}{}", said(reason))]
    Value {
        /// The key.
        key: &'static str,
        /// The value.
        value: String,
        /// What was expected.
        range: &'static str,
        /// What is wrong with the value, if there is more to say.
        reason: Option<String>,
    },
}

/// A reason at the end of a sentence, if there is one.
fn said(reason: &Option<String>) -> String {
    (reason.as_ref()).map_or_else(String::new, |reason| format!(": {reason}"))
}

/// Whose setting it is, if it is another method's.
fn elsewhere(others: &[Method]) -> String {
    let names: Vec<_> = others.iter().map(|method| method.name()).collect();
    match names.is_empty() {
        true => String::new(),
        false => format!("; that is a setting of {}", names.join(", ")),
    }
}

impl Options {
    /// Refuses settings of a method that contradict each other.
    ///
    /// # Errors
    /// [`RenderError::Setting`], with the reason.
    pub fn check(&self, method: Method) -> Result<(), RenderError> {
        let has = method.keys().any(|key| key.name == "nextevent");
        match self.next_event_that_is_not_there(method) {
            Some(reason) if has => Err(RenderError::Setting {
                what: "nextevent",
                found: "off".to_owned(),
                expected: format!("on with {reason}"),
            }),
            _ => Ok(()),
        }
    }

    /// What has no next event that could be switched off, with the reason.
    fn next_event_that_is_not_there(&self, method: Method) -> Option<&'static str> {
        if self.next_event {
            return None;
        }
        match self.builder {
            Builder::Endpoint => Some("builder=endpoint: an endpoint is joined or it is nothing"),
            Builder::Simple | Builder::Bidirectional => Some(
                "builder=simple or bidirectional: it is one of their ways of joining two walks",
            ),
            Builder::Unidirectional
                if method == Method::Erpt && self.seeds == Starts::Bidirectional =>
            {
                Some("seeds=bidirectional: it is one of the ways of joining two walks")
            }
            Builder::Unidirectional => None,
        }
    }

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
                others: (Method::ALL.into_iter())
                    .filter(|other| other.keys().any(|known| known.name == key))
                    .collect(),
            })?;
        // Words that only other methods know.
        let shared = matches!(key.name, "normaliser" | "direct");
        let known = !shared || key.range.split('|').any(|word| word == value);
        let read = match self.setting(key.name) {
            Some(mut setting) if known => setting.read(value),
            _ => Err(None),
        };
        read.map_err(|reason| OptionError::Value {
            key: key.name,
            value: value.to_owned(),
            range: key.range,
            reason,
        })
    }

    /// The settings of a method as one would write them, defaults included: what a picture needs to be
    /// made again.
    pub fn entries(&self, method: Method) -> Vec<(&'static str, String)> {
        // the same places read and write
        let mut all = *self;
        let mut written = |name| (all.setting(name)).map_or_else(String::new, |it| it.written());
        method
            .keys()
            .map(|key| (key.name, written(key.name)))
            .collect()
    }

    /// The replicas of `relt`.
    pub fn replica_set(&self) -> ReplicaSet {
        (self.replicas).unwrap_or_else(|| ReplicaSet::standard(self.delta))
    }
}

#[cfg(test)]
mod tests;
