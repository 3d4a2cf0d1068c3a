//! Which setting a key stands for, in which words.

use kaustik_estimate::{Contribution, Mis, ReplicaSetError, ScalarTarget};
use kaustik_mcmc::Schedule;
use kaustik_path::Heuristic;
use kaustik_spectrum::WavelengthSampling;

use super::Options;
use super::setting::{
    AnySetting, by, finite, integer, number, optional, optional_integer, range, reasoned, switch,
    word,
};
use crate::settings::choices::{
    Builder, Caustics, Colours, Direct, Energy, EvenSamples, Jitter, Normaliser, SmallStep,
    StartShare, Starts, Steps, Strategies,
};
use crate::{Mutations, StageLadder};

impl Options {
    /// The setting of a key; `None` if no method has such a key.
    pub(super) fn setting(&mut self, key: &str) -> Option<AnySetting<'_>> {
        let stages = &mut self.stages;
        Some(match key {
            "ladders" => integer(&mut self.ladders, 1..=4096),
            "pilot" => integer(&mut self.pilot, 1..=10_000_000),
            "start" => by(&mut self.start, StartShare::parse, StartShare::text),
            "wavelengths" => word(&mut self.wavelengths, WAVELENGTHS),
            "compensation" => switch(&mut self.compensation),
            "nextevent" => switch(&mut self.next_event),
            "builder" => word(&mut self.builder, BUILDERS),
            "heuristic" => word(&mut self.heuristic, HEURISTICS),
            "strategies" => word(&mut self.strategies, STRATEGIES),
            "target" => word(&mut self.target, TARGETS),
            "contribution" => word(&mut self.contribution, CONTRIBUTIONS),
            "plarge" => number(&mut self.p_large, |p| p > 0.0 && p <= 1.0),
            "mutation" => by(&mut self.small_step, SmallStep::parse, SmallStep::text),
            "mis" => word(&mut self.mis, MIS),
            "normaliser" => word(&mut self.normaliser, Normaliser::WORDS),
            "meter" => switch(&mut self.meter),
            "direct" => word(&mut self.direct, DIRECT),
            "replicas" => reasoned(&mut self.replicas, "standard", |set| {
                set.parse()
                    .map_err(|error: ReplicaSetError| Some(error.to_string()))
            }),
            "delta" => number(&mut self.delta, |delta| delta > 0.0 && delta <= 1.0),
            "beta" => number(&mut self.beta, |beta| (1.0..=8.0).contains(&beta)),
            "exchange" => word(&mut self.exchange, EXCHANGES),
            "even" => by(&mut self.even, EvenSamples::parse, EvenSamples::text),
            "steps" => word(&mut self.steps, STEPS),
            "particles" => integer(&mut self.particles, 10..=1_000_000),
            "length" => integer(&mut self.length, 1..=100_000),
            "chains" => optional(&mut self.chains, "auto", |text| {
                finite(text).filter(|n| (0.01..=100.0).contains(n))
            }),
            "consecutive" => optional_integer(&mut self.consecutive, "off", 1..=100_000),
            "proposed" => optional(&mut self.proposed, "off", |text| {
                finite(text).filter(|kappa| (1.0..=1e6).contains(kappa))
            }),
            "seeds" => word(&mut self.seeds, SEEDS),
            "energy" => word(&mut self.energy, ENERGIES),
            "perturbations" => by(
                &mut self.perturbations,
                |text| Mutations::parse(text).filter(|m| m.within(Mutations::PERTURBATIONS)),
                Mutations::to_string,
            ),
            "deposit" => word(&mut self.deposit, DEPOSITS),
            "caustic" => word(&mut self.caustic, CAUSTICS),
            "mutations" => by(&mut self.mutations, Mutations::parse, Mutations::to_string),
            "jitter" => by(&mut self.jitter, Jitter::parse, Jitter::text),
            "angles" => by(
                &mut self.angles,
                |text| range(text, 3.0),
                |[least, most]| format!("{least}:{most}"),
            ),
            "budget" => integer(&mut stages.budget, 1..=1_000_000),
            "stages" => word(&mut stages.ladder, STAGES),
            "floor" => number(&mut stages.floor, |f| f > 0.0 && f <= 1.0),
            other => self.photon.setting(other)?,
        })
    }
}

const WAVELENGTHS: &[(&str, WavelengthSampling)] = &[
    ("hero", WavelengthSampling::Hero),
    ("uniform", WavelengthSampling::Single),
];
const BUILDERS: &[(&str, Builder)] = &[
    ("unidirectional", Builder::Unidirectional),
    ("endpoint", Builder::Endpoint),
    ("simple", Builder::Simple),
    ("bidirectional", Builder::Bidirectional),
];
const HEURISTICS: &[(&str, Heuristic)] = &[
    ("power", Heuristic::Power),
    ("balance", Heuristic::Balance),
    ("maximum", Heuristic::Maximum),
];
const STRATEGIES: &[(&str, Strategies)] =
    &[("learned", Strategies::Learned), ("even", Strategies::Even)];
const TARGETS: &[(&str, ScalarTarget)] = &[
    ("xyz", ScalarTarget::Xyz),
    ("luminance", ScalarTarget::Luminance),
];
const CONTRIBUTIONS: &[(&str, Contribution)] = &[
    ("sum", Contribution::Sum),
    ("maximum", Contribution::Maximum),
];
const MIS: &[(&str, Mis)] = &[
    ("split", Mis::Split),
    ("printed", Mis::Printed),
    ("off", Mis::Off),
];
const DIRECT: &[(&str, Direct)] = &[
    ("auto", Direct::Auto),
    ("lamps", Direct::Lamps),
    ("together", Direct::Together),
    ("apart", Direct::Apart),
];
const EXCHANGES: &[(&str, Schedule)] = &[
    ("full", Schedule::Full),
    ("pair", Schedule::RandomPair),
    ("alternating", Schedule::Alternating),
    ("matching", Schedule::RandomMatching),
    ("gibbs", Schedule::Permutation),
    ("none", Schedule::Off),
];
const STEPS: &[(&str, Steps)] = &[
    ("fine", Steps::Fine),
    ("kelemen", Steps::Kelemen),
    ("paper", Steps::Paper),
    ("adapted", Steps::Adapted),
];
const SEEDS: &[(&str, Starts)] = &[
    ("path", Starts::Path),
    ("bidirectional", Starts::Bidirectional),
];
const ENERGIES: &[(&str, Energy)] = &[("pilot", Energy::Pilot), ("passes", Energy::Passes)];
const DEPOSITS: &[(&str, Colours)] =
    &[("current", Colours::Current), ("printed", Colours::Printed)];
const CAUSTICS: &[(&str, Caustics)] = &[("exact", Caustics::Exact), ("printed", Caustics::Printed)];
const STAGES: &[(&str, StageLadder)] =
    &[("widths", StageLadder::Widths), ("two", StageLadder::Two)];
