//! Settings as one would write them.

use kaustik_estimate::{Contribution, Mis, ScalarTarget};
use kaustik_path::Heuristic;
use kaustik_spectrum::WavelengthSampling;

use super::Options;
use super::assign::EXCHANGES;
use crate::StageLadder;
use crate::choices::{
    Builder, Caustics, Colours, Direct, Energy, EvenSamples, Jitter, SmallStep, Starts, Steps,
    Strategies,
};

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
            "meter" => switch(self.meter).to_owned(),
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
            "even" => match self.even {
                EvenSamples::Auto => "auto".to_owned(),
                EvenSamples::Count(count) => count.to_string(),
            },
            "exchange" => EXCHANGES
                .iter()
                .find(|(_, schedule)| *schedule == self.exchange)
                .map_or(String::new(), |(word, _)| (*word).to_owned()),
            "steps" => match self.steps {
                Steps::Fine => "fine",
                Steps::Kelemen => "kelemen",
                Steps::Paper => "paper",
                Steps::Adapted => "adapted",
            }
            .to_owned(),
            "particles" => self.particles.to_string(),
            "length" => self.length.to_string(),
            "chains" => self.chains.to_string(),
            "consecutive" => (self.consecutive).map_or("off".to_owned(), |n| n.to_string()),
            "proposed" => (self.proposed).map_or("off".to_owned(), |kappa| kappa.to_string()),
            "seeds" => match self.seeds {
                Starts::Path => "path",
                Starts::Bidirectional => "bidirectional",
            }
            .to_owned(),
            "energy" => match self.energy {
                Energy::Pilot => "pilot",
                Energy::Passes => "passes",
            }
            .to_owned(),
            "perturbations" => self.perturbations.to_string(),
            "deposit" => match self.deposit {
                Colours::Current => "current",
                Colours::Printed => "printed",
            }
            .to_owned(),
            "caustic" => match self.caustic {
                Caustics::Exact => "exact",
                Caustics::Printed => "printed",
            }
            .to_owned(),
            "mutations" => self.mutations.to_string(),
            "jitter" => match self.jitter {
                Jitter::Standard => "standard".to_owned(),
                Jitter::Veach => "veach".to_owned(),
                Jitter::Local => "local".to_owned(),
                Jitter::Between([a, b]) => format!("{a}:{b}"),
            },
            "angles" => format!("{}:{}", self.angles[0], self.angles[1]),
            "budget" => self.stages.budget.to_string(),
            "stages" => match self.stages.ladder {
                StageLadder::Widths => "widths",
                StageLadder::Two => "two",
            }
            .to_owned(),
            "floor" => self.stages.floor.to_string(),
            other => self.photon.value(other).unwrap_or_default(),
        }
    }
}
