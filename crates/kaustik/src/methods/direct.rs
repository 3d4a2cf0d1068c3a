//! Direct light beside chains that leave it out.

mod ease;

use std::io;
use std::ops::{Range, RangeInclusive};
use std::sync::atomic::AtomicBool;

use kaustik_film::{Counters, Image, Layer};
use kaustik_path::{BuilderSettings, Event, PureSpecular, RayCounts, Unidirectional};
use kaustik_scene::Scene;

use crate::engine::{Engine, add_counters, add_nonfinite, add_rays};
use crate::methods::builders::builder_settings;
use crate::methods::independent::IndependentEngine;
use crate::sampling::cells::Cells;
use crate::state::{Keep, Reader, StateError, Writer};
use crate::{
    Budget, ChainStatistics, Direct, DirectStatistics, EnergyStatistics, Method,
    MutationStatistics, RenderError, RenderSettings, ReplicaStatistics, StepId,
};

pub(crate) use ease::choice;

/// The longest paths that are rendered apart, in edges: emitters seen directly, and light that was scattered
/// once, at whatever surface.
pub(crate) const MOST_EDGES: u32 = 2;
/// Of so many passes' worth of steps, direct light takes the first.
const CYCLE: u64 = 4;
/// The same where a step is a sample with all its chains.
const CYCLE_OF_SAMPLES: u64 = 2;
/// So many passes' worth of steps leave both parts with something where a step of the chains is less than a pass.
const LEAST: u64 = 2;
/// Turns the seed of the chains into another one.
const SEED: u64 = 0xD1EC_7A9A_2750_CE11;

/// Is direct light rendered apart?
pub(crate) fn is_apart(settings: &RenderSettings) -> bool {
    can_be_apart(settings.method) && settings.options.direct == Direct::Apart
}

/// Can the method leave direct light to other samples?
fn can_be_apart(method: Method) -> bool {
    matches!(
        method,
        Method::Pssmlt | Method::Mmlt | Method::Relt | Method::ErptPss | Method::Erpt | Method::Mlt
    )
}

/// What becomes of purely specular paths in the method's own samples.
///
/// Chains on paths seldom propose one that is new from end to end, so that they may never come to a lamp behind glass;
/// those of redistribution do not leave the scatterings that they began with, and the few samples that they begin with
/// show such a lamp as a dot. The other methods do so with every large step, which serves as well as samples beside them.
pub(crate) fn pure_specular(settings: &RenderSettings) -> PureSpecular {
    let paths = [Method::Mlt, Method::MltMultistage, Method::Erpt];
    if paths.contains(&settings.method) && settings.options.direct != Direct::Together {
        PureSpecular::LeftOut
    } else {
        PureSpecular::Kept
    }
}

/// How many edges the paths have that [`Lamps`](crate::beside::lamps::Lamps) see to; `None` if there are none of them.
///
/// They look where such light is, which the even samples of direct light do not: a lamp seen in a mirror or through one surface of glass is theirs as well
/// where direct light is rendered apart.
pub(crate) fn edges_of_lamps(settings: &RenderSettings) -> Option<RangeInclusive<u32>> {
    let most = match pure_specular(settings) {
        PureSpecular::LeftOut => settings.max_depth,
        _ if is_apart(settings) && keeps_lamps(settings.method) => {
            settings.max_depth.min(MOST_EDGES)
        }
        _ if are_lamps(settings) => 1,
        _ => 0,
    };
    (most > 0).then_some(1..=most)
}

/// Of so many passes' worth of steps, direct light takes the first.
fn cycle(settings: &RenderSettings) -> u64 {
    match settings.method {
        Method::Erpt | Method::ErptPss => CYCLE_OF_SAMPLES,
        _ => CYCLE,
    }
}

/// Does the method keep its samples of what is seen directly where direct light is apart? `erpt-pss` never has any, and `relt` has films
/// enough.
fn keeps_lamps(method: Method) -> bool {
    !matches!(method, Method::ErptPss | Method::Relt)
}

/// What builds the paths of direct light where it is rendered apart: those that [`edges_of_lamps`] leaves.
pub(crate) fn direct_paths(settings: &RenderSettings) -> Unidirectional {
    let (min_edges, pure_specular) = if keeps_lamps(settings.method) {
        (MOST_EDGES, PureSpecular::LeftOut)
    } else {
        (1, PureSpecular::Kept)
    };
    Unidirectional {
        settings: BuilderSettings {
            min_edges,
            max_edges: settings.max_depth.min(MOST_EDGES),
            pure_specular,
            ..builder_settings(settings)
        },
        next_event: true,
    }
}

/// Are emitters and surroundings seen directly rendered beside the chains (of some methods also those seen
/// by way of mirrors and glass alone: [`pure_specular`]), and nothing else?
pub(crate) fn are_lamps(settings: &RenderSettings) -> bool {
    match settings.method {
        Method::Pssmlt | Method::Mmlt | Method::Relt | Method::Mlt | Method::Erpt => {
            !matches!(settings.options.direct, Direct::Together | Direct::Apart)
        }
        // These have no light of two edges apart.
        Method::MltMultistage | Method::PssmltMultistage => {
            settings.options.direct != Direct::Together
        }
        method => method == Method::Annealing,
    }
}

/// The shortest paths that a method's builder makes, in edges.
pub(crate) fn min_edges(settings: &RenderSettings) -> u32 {
    match (is_apart(settings), are_lamps(settings)) {
        (true, _) => MOST_EDGES + 1,
        (false, true) => 2,
        (false, false) => 1,
    }
}

/// A method whose paths have more edges than [`MOST_EDGES`], and stratified independent samples of the others ([`direct_paths`]) on a
/// film of their own. The picture is the sum: both parts are right by themselves, whatever share
/// of the steps each takes.
pub(crate) struct DirectApart<'a> {
    chains: Box<dyn Engine + 'a>,
    direct: IndependentEngine<'a>,
    /// The ladders of this process.
    ladders: Range<u32>,
    /// Steps that each of them was given so far, for both parts.
    given: Vec<u64>,
    /// Of these, steps of direct light and of the chains.
    done: Vec<[u64; 2]>,
    /// Steps of one pass over the image, of all ladders.
    pass: u64,
    /// Of so many passes, direct light takes the first.
    cycle: u64,
    /// Passes that leave both parts of each ladder with something.
    least: u64,
}

impl<'a> DirectApart<'a> {
    /// Beside an engine that was made for the same settings.
    pub(crate) fn new(
        scene: &'a Scene,
        settings: &RenderSettings,
        chains: Box<dyn Engine + 'a>,
    ) -> Result<Self, RenderError> {
        let of_direct = RenderSettings {
            method: Method::Path,
            seed: settings.seed ^ SEED,
            ..settings.clone()
        };
        let paths = Box::new(direct_paths(settings));
        let cells = Cells::new(settings);
        let direct = IndependentEngine::new(scene, &of_direct, paths, Some(cells))?;
        let ladders = settings.ladder_range();
        let all = settings.options.ladders;
        let mut both = Self {
            pass: (0..all).map(|l| direct.grain(l)).sum(),
            cycle: cycle(settings),
            least: LEAST,
            given: vec![0; ladders.len()],
            done: vec![[0; 2]; ladders.len()],
            chains,
            direct,
            ladders,
        };
        both.least = both.least_of_all(all);
        Ok(both)
    }

    /// Of so many steps of a ladder those for direct light, whole passes, and those for the chains, as many
    /// as they can take. Neither ever shrinks when the steps grow by a pass.
    fn split(&self, ladder: u32, steps: u64) -> [u64; 2] {
        let pass = self.direct.grain(ladder).max(1);
        let direct = (steps / pass).div_ceil(self.cycle) * pass;
        // A ladder without cells has none of either.
        let whole = |grain| (steps - direct) / grain * grain;
        match self.chains.grain(ladder) {
            0 => [direct, 0],
            grain => [direct, whole(grain)],
        }
    }

    /// As few passes as leave the chains of each ladder a step: one part alone is no picture. A small ladder's passes may be less than a
    /// sweep of replicas; but all ladders take as many, as some filters want whole passes of all.
    fn least_of_all(&self, ladders: u32) -> u64 {
        let least = |ladder| {
            let pass = self.direct.grain(ladder);
            let suffices = |passes: &u64| self.split(ladder, passes * pass)[1] > 0;
            if pass == 0 || self.chains.grain(ladder) == 0 {
                return LEAST;
            }
            (LEAST..).find(suffices).unwrap_or(LEAST)
        };
        (0..ladders).map(least).max().unwrap_or(LEAST)
    }
}

impl Engine for DirectApart<'_> {
    fn advance(&mut self, plan: &[u64], stop: Option<&AtomicBool>) -> u64 {
        let mut plans = [Vec::new(), Vec::new()];
        for (index, (ladder, steps)) in self.ladders.clone().zip(plan).enumerate() {
            self.given[index] += steps;
            let due = self.split(ladder, self.given[index]);
            let done = &mut self.done[index];
            for (plan, (due, done)) in plans.iter_mut().zip(due.into_iter().zip(done)) {
                // A render that was stopped in a round may have more of one part than is due yet.
                plan.push(due.saturating_sub(*done));
                *done = due.max(*done);
            }
        }
        let before = self.steps();
        self.direct.advance(&plans[0], stop);
        self.chains.advance(&plans[1], stop);
        self.steps() - before
    }

    fn pass(&self) -> Option<u64> {
        Some(self.pass)
    }

    /// Whole passes.
    fn planned(&self, ladder: u32, settings: &RenderSettings) -> u64 {
        let passes = match settings.budget {
            Budget::PerPixel(n) => n,
            Budget::Total(n) => n / self.pass,
            Budget::Time(_) => u64::MAX,
        };
        passes
            .max(self.least)
            .saturating_mul(self.direct.grain(ladder))
    }

    /// A first round has something of both.
    fn grain(&self, ladder: u32) -> u64 {
        self.least * self.direct.grain(ladder)
    }

    fn develop(&mut self) -> Result<Image, RenderError> {
        let mut image = self.chains.develop()?;
        image.add(&self.direct.picture()?)?;
        Ok(image)
    }

    fn chain_statistics(&self) -> Option<ChainStatistics> {
        self.chains.chain_statistics()
    }

    fn replica_statistics(&self) -> Option<ReplicaStatistics> {
        self.chains.replica_statistics()
    }

    fn mutation_statistics(&self) -> Vec<MutationStatistics> {
        self.chains.mutation_statistics()
    }

    fn energy_statistics(&self) -> Option<EnergyStatistics> {
        self.chains.energy_statistics()
    }

    fn direct_statistics(&self) -> Option<DirectStatistics> {
        Some(DirectStatistics {
            max_edges: MOST_EDGES,
            samples: self.direct.steps(),
        })
    }

    fn layers(&self) -> Result<Vec<Layer>, RenderError> {
        let mut layers = self.chains.layers()?;
        let image = self.direct.picture()?;
        let channels = ["R", "G", "B"].into_iter().zip(image.rgb());
        let channels = channels.map(|(name, plane)| (name, plane.to_vec()));
        layers.push(Layer::new("direct", channels.collect()));
        Ok(layers)
    }

    fn nonfinite(&self) -> (u64, Vec<StepId>) {
        add_nonfinite(self.chains.nonfinite(), Some(self.direct.nonfinite()))
    }

    /// A step of this number of both parts: they count their own.
    fn replay(&mut self, place: StepId) -> Result<Vec<Event>, RenderError> {
        let mut events = self.chains.replay(place)?;
        events.extend(self.direct.replay(place)?);
        Ok(events)
    }

    fn rays(&self) -> Option<RayCounts> {
        let (chains, direct) = (self.chains.rays()?, self.direct.rays()?);
        Some(add_rays([chains, direct].into_iter()))
    }

    fn film_counters(&self) -> Counters {
        add_counters(self.chains.film_counters(), self.direct.film_counters())
    }

    fn is_lit(&self) -> bool {
        self.chains.is_lit() || self.direct.is_lit()
    }
}

/// Both parts, and what ladders were given: of that, something too small for a step may be left over.
impl Keep for DirectApart<'_> {
    fn taken(&self) -> Vec<u64> {
        self.given.clone()
    }

    /// None before either part has some: one alone is no picture.
    fn steps(&self) -> u64 {
        match [self.direct.steps(), self.chains.steps()] {
            [0, _] | [_, 0] => 0,
            [direct, chains] => direct + chains,
        }
    }

    fn write(&self, out: &mut Writer<'_>) -> io::Result<()> {
        out.value(&self.given)?;
        self.direct.write(out)?;
        self.chains.write(out)
    }

    fn take_up(&mut self, from: &mut Reader<'_>) -> Result<(), StateError> {
        let given: Vec<u64> = from.value()?;
        let kept = from.ladders();
        if given.len() != kept.len() {
            return Err(StateError::damaged("a ladder's steps are missing"));
        }
        self.direct.take_up(from)?;
        self.chains.take_up(from)?;
        let both = self.direct.taken().into_iter().zip(self.chains.taken());
        self.done = both.map(|(direct, chains)| [direct, chains]).collect();
        for (ladder, given) in kept.zip(given) {
            let at = ladder.wrapping_sub(self.ladders.start) as usize;
            let (Some(steps), Some(done)) = (self.given.get_mut(at), self.done.get(at)) else {
                continue;
            };
            *steps = Reader::count(given)?;
            if done[0].saturating_add(done[1]) > *steps {
                return Err(StateError::damaged("a ladder took more steps than it had"));
            }
        }
        Ok(())
    }
}
