//! The settings that `--set key=value` reaches.

use kaustik_estimate::{Contribution, Mis, ReplicaSet, ScalarTarget};
use kaustik_mcmc::Schedule;
use kaustik_path::Heuristic;
use kaustik_spectrum::WavelengthSampling;

pub(crate) mod setting;
mod table;

use crate::settings::choices::{
    Builder, Caustics, Colours, Direct, Energy, EvenSamples, Jitter, Normaliser, SmallStep,
    StartShare, Starts, Steps, Strategies,
};
use crate::settings::key::KEYS;
use crate::settings::method::Method;
use crate::{Mutations, PhotonOptions, RenderError, StageOptions};

/// All settings; a method reads those that [`Method::keys`] lists.
///
/// Each is named as its key, or as said; [`KEYS`] tells ranges and what the papers have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Independent chains or streams of samples, 1 to 4096: part of the result.
    pub ladders: u32,
    /// How many wavelengths a path has, and their law.
    pub wavelengths: WavelengthSampling,
    /// Gives back the light that scatters between the facets of rough surfaces.
    pub compensation: bool,
    /// Independent samples at the start, 1 to 10,000,000.
    pub pilot: u64,
    /// How much of the start is made: of `pilot` or `particles`.
    pub start: StartShare,
    /// `nextevent`: joins every vertex of a walk from the camera to an emitter.
    pub next_event: bool,
    /// How a point of the unit cube becomes paths.
    pub builder: Builder,
    /// How the strategies of bidirectional paths share one path.
    pub heuristic: Heuristic,
    /// How often `mmlt` tries the strategies of a length.
    pub strategies: Strategies,
    /// The scalar of a colour that chains follow.
    pub target: ScalarTarget,
    /// How what one point contributes makes one scalar.
    pub contribution: Contribution,
    /// `plarge`: probability of a large step, in (0, 1].
    pub p_large: f64,
    /// `mutation`: the law of small steps, in shares of the domain.
    pub small_step: SmallStep,
    /// Large steps as independent samples.
    pub mis: Mis,
    /// What scales the image, or the replicas' films.
    pub normaliser: Normaliser,
    /// Measures the scale by samples beside the chains as well, where light comes by glass, mirrors or water.
    pub meter: bool,
    /// What independent samples beside the chains see to.
    pub direct: Direct,
    /// What the chains of a ladder follow; `None`: the standard set with `delta`.
    pub replicas: Option<ReplicaSet>,
    /// Share of joined paths in the last of the standard replicas, in (0, 1].
    pub delta: f64,
    /// Exponent of the heuristic that combines replicas, in [1, 8].
    pub beta: f64,
    /// Which replicas exchange after a sweep.
    pub exchange: Schedule,
    /// Independent samples a sweep, spread evenly over the image.
    pub even: EvenSamples,
    /// The law of the replicas' small steps.
    pub steps: Steps,
    /// Particles of an annealing, 10 to 1,000,000.
    pub particles: u64,
    /// Steps of each chain that spreads the light of a sample, 1 to 100,000.
    pub length: u32,
    /// Mean number of such chains a sample, in [0.01, 100]; `None`: by how evenly light is spread over the pilot's samples.
    pub chains: Option<f64>,
    /// Proposals that a chain may stay in one place before its staying leaves nothing; `None`: no filter.
    pub consecutive: Option<u64>,
    /// Most light of a pixel, in deposits a proposal into it; `None`: no filter.
    pub proposed: Option<f64>,
    /// Where the chains of `erpt` start.
    pub seeds: Starts,
    /// What fixes the light of a deposit.
    pub energy: Energy,
    /// What moves a path along its chain (`erpt`).
    pub perturbations: Mutations,
    /// The colour of a deposit.
    pub deposit: Colours,
    /// Density change of caustic perturbations.
    pub caustic: Caustics,
    /// What may change a path (`mlt`).
    pub mutations: Mutations,
    /// Pixels by which perturbations move what is seen.
    pub jitter: Jitter,
    /// Radians, least and most, by which multi-chain perturbations turn directions within a path.
    pub angles: [f64; 2],
    /// Those of photon methods.
    pub photon: PhotonOptions,
    /// Those of multi-stage methods.
    pub stages: StageOptions,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            ladders: 64,
            wavelengths: WavelengthSampling::Hero,
            compensation: true,
            pilot: 100_000,
            start: StartShare::default(),
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
            chains: None,
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
    /// Refuses settings out of their [ranges](KEYS), and settings of a method that contradict each other.
    ///
    /// # Errors
    /// [`RenderError::Setting`], with the reason.
    pub fn check(&self, method: Method) -> Result<(), RenderError> {
        self.check_ranges(method)?;
        let has = method.keys().any(|key| key.name == "nextevent");
        if let Some(reason) = self.next_event_that_is_not_there(method).filter(|_| has) {
            return Err(RenderError::Setting {
                what: "nextevent",
                found: "off".to_owned(),
                expected: format!("on with {reason}"),
            });
        }
        match method {
            Method::Relt => self.check_permutations().and_then(|()| self.check_delta()),
            Method::Annealing => self.check_line().and_then(|()| self.check_delta()),
            _ => Ok(()),
        }
    }

    /// Fields are public: is each what its key could have been told? Also those that this method does not have.
    fn check_ranges(&self, method: Method) -> Result<(), RenderError> {
        for key in KEYS {
            let mut again = *self;
            let Some(mut setting) = again.setting(key.name) else {
                continue;
            };
            let found = setting.written();
            let is_known = !key.methods.contains(&method) || key.knows(&found);
            if !is_known || setting.read(&found).is_err() {
                return Err(RenderError::Setting {
                    what: key.name,
                    found: match found.is_empty() {
                        true => "what no word stands for".to_owned(),
                        false => found,
                    },
                    expected: key.range.to_owned(),
                });
            }
        }
        Ok(())
    }

    /// Is `delta` asked of replicas that it says something about?
    fn check_delta(&self) -> Result<(), RenderError> {
        let is_default = self.delta.to_bits() == ReplicaSet::DELTA.to_bits();
        match self.replicas {
            Some(set) if !is_default => Err(RenderError::Setting {
                what: "delta",
                found: format!("{} with replicas={set}", self.delta),
                expected: "delta with the standard replicas alone; others state the weights of their last themselves"
                    .to_owned(),
            }),
            _ => Ok(()),
        }
    }

    /// Are there few enough replicas for all of their orders?
    fn check_permutations(&self) -> Result<(), RenderError> {
        let (count, most) = (self.replica_set().count(), Schedule::MOST_PERMUTED);
        if self.exchange != Schedule::Permutation || count <= most {
            return Ok(());
        }
        Err(RenderError::Setting {
            what: "exchange",
            found: format!("gibbs with {count} replicas"),
            expected: format!("at most {most} replicas"),
        })
    }

    /// Does each replica stand on the one before?
    fn check_line(&self) -> Result<(), RenderError> {
        let set = self.replica_set();
        if set.is_line() {
            return Ok(());
        }
        Err(RenderError::Setting {
            what: "replicas",
            found: set.to_string(),
            expected: "replicas that each stand on the one before: populations climb a line"
                .to_owned(),
        })
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
        let read = match self.setting(key.name) {
            Some(mut setting) if key.knows(value) => setting.read(value),
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
