//! Settings from what was written.

use kaustik_estimate::{Contribution, Mis, ScalarTarget};
use kaustik_mcmc::Schedule;
use kaustik_path::Heuristic;
use kaustik_spectrum::WavelengthSampling;

use super::Options;
use crate::choices::{
    Builder, Caustics, Colours, Direct, Energy, EvenSamples, Jitter, Normaliser, SmallStep, Starts,
    Steps, Strategies,
};
use crate::{Mutations, StageLadder};

impl Options {
    /// `None` if the value is out of range.
    pub(super) fn assign(&mut self, key: &str, value: &str) -> Option<()> {
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
            "meter" => self.meter = switch(value)?,
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
            "even" if value == "auto" => self.even = EvenSamples::Auto,
            "even" => self.even = EvenSamples::Count(integer(value, 0, 64)? as u32),
            "steps" => {
                let words = [
                    ("fine", Steps::Fine),
                    ("kelemen", Steps::Kelemen),
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
            "proposed" if value == "off" => self.proposed = None,
            "proposed" => {
                self.proposed = Some(number(value).filter(|k| (1.0..=1e6).contains(k))?);
            }
            "seeds" => {
                let (path, both) = (Starts::Path, Starts::Bidirectional);
                self.seeds = word(value, &[("path", path), ("bidirectional", both)])?;
            }
            "energy" => {
                let (pilot, passes) = (Energy::Pilot, Energy::Passes);
                self.energy = word(value, &[("pilot", pilot), ("passes", passes)])?;
            }
            "perturbations" => {
                let made = Mutations::parse(value)?;
                self.perturbations = Some(made).filter(|m| m.within(Mutations::PERTURBATIONS))?;
            }
            "deposit" => {
                let (current, printed) = (Colours::Current, Colours::Printed);
                self.deposit = word(value, &[("current", current), ("printed", printed)])?;
            }
            "caustic" => {
                let (exact, printed) = (Caustics::Exact, Caustics::Printed);
                self.caustic = word(value, &[("exact", exact), ("printed", printed)])?;
            }
            "mutations" => self.mutations = Mutations::parse(value)?,
            "jitter" => {
                let words = [
                    ("standard", Jitter::Standard),
                    ("veach", Jitter::Veach),
                    ("local", Jitter::Local),
                ];
                let between = || range(value, 1e6).map(Jitter::Between);
                self.jitter = word(value, &words).or_else(between)?;
            }
            "angles" => self.angles = range(value, 3.0)?,
            "budget" => self.stages.budget = integer(value, 1, 1_000_000)?,
            "stages" => {
                let (widths, two) = (StageLadder::Widths, StageLadder::Two);
                self.stages.ladder = word(value, &[("widths", widths), ("two", two)])?;
            }
            "floor" => {
                self.stages.floor = number(value).filter(|f| *f > 0.0 && *f <= 1.0)?;
            }
            other => self.photon.assign(other, value)?,
        }
        Some(())
    }
}

/// Words for exchanges.
pub(super) const EXCHANGES: &[(&str, Schedule)] = &[
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
