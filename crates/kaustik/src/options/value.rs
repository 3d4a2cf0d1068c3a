//! Settings as one would write them.

use kaustik_estimate::{Contribution, Mis, ScalarTarget};
use kaustik_path::Heuristic;
use kaustik_spectrum::WavelengthSampling;

use super::Options;
use super::assign::EXCHANGES;
use crate::choices::{Builder, Direct, SmallStep, Steps, Strategies};

impl Options {
    /// The value of a key, in the words that [`set`](Self::set) takes.
    pub(super) fn value(&self, key: &str) -> String {
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
            _ => String::new(),
        }
    }
}
