//! How replicas start: by population annealing (RELT 4.3, Algorithm 2).

use std::sync::atomic::{AtomicBool, AtomicU64};

use kaustik_estimate::{PathTarget, ReplicaFamily, ReplicaSet, SpecularSplit};
use kaustik_mcmc::{Estimate, Extinct, Metropolis, Point, SampleGenerators};
use kaustik_path::{Bidirectional, Contributions, Form, PathBuilder, Sighting};
use kaustik_scene::Scene;
use rayon::prelude::*;

use super::climb::Climb;
use super::kernels::Mutation;
use crate::RenderSettings;
use crate::control::is_stopped;
use crate::methods::builders::builder_settings;

/// A replica's place and what it brings.
pub(crate) type State = (Point<Mutation>, Contributions);

/// How paths under replicas are made.
pub(crate) fn replica_builder(settings: &RenderSettings) -> Bidirectional {
    Bidirectional {
        settings: builder_settings(settings),
        form: Form::Full,
        heuristic: settings.options.heuristic,
    }
}

/// The engine of a type `Engine<K>` for as many replicas as have started.
macro_rules! for_so_many_replicas {
    ($engine:ident, $scene:expr, $builder:expr, $settings:expr, $started:expr) => {
        match $started.starts.len() {
            0 | 1 => Box::new($engine::<1>::new($scene, $builder, $settings, $started)?),
            2 => Box::new($engine::<2>::new($scene, $builder, $settings, $started)?),
            3 => Box::new($engine::<3>::new($scene, $builder, $settings, $started)?),
            4 => Box::new($engine::<4>::new($scene, $builder, $settings, $started)?),
            5 => Box::new($engine::<5>::new($scene, $builder, $settings, $started)?),
            6 => Box::new($engine::<6>::new($scene, $builder, $settings, $started)?),
            7 => Box::new($engine::<7>::new($scene, $builder, $settings, $started)?),
            _ => Box::new($engine::<8>::new($scene, $builder, $settings, $started)?),
        }
    };
}
pub(crate) use for_so_many_replicas;

/// Anneals with the replicas that are asked for.
pub(crate) fn start(
    scene: &Scene,
    builder: &dyn PathBuilder,
    settings: &RenderSettings,
) -> Started {
    let set = &settings.options.replica_set();
    let nonfinite = AtomicU64::new(0);
    let target = PathTarget {
        scene,
        builder,
        nonfinite: &nonfinite,
    };
    match set.count() {
        2 => anneal::<2>(target, set, settings),
        3 => anneal::<3>(target, set, settings),
        4 => anneal::<4>(target, set, settings),
        5 => anneal::<5>(target, set, settings),
        6 => anneal::<6>(target, set, settings),
        7 => anneal::<7>(target, set, settings),
        _ => anneal::<8>(target, set, settings),
    }
}

/// An annealing that dies is tried again so often, each time with twice the particles.
const AGAIN: u32 = 3;
/// Below this share of the replica before, the specific one is not worth its steps. Its whole
/// density counts, not only what particles have seen of its light: in water under a small lamp that is nothing, and
/// a third of the picture.
const NEGLIGIBLE: f64 = 1e-3;

/// What is kept of an independent sample.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PoolSample {
    /// By replica; 0 for those that there are not.
    pub(crate) densities: [f64; ReplicaSet::MOST],
    /// X + Y + Z.
    pub(crate) light: SpecularSplit,
    /// Where the walk from the camera begins, in the unit square over the window.
    pub(crate) raster: [f64; 2],
}

/// What an annealing leaves.
pub(crate) struct Started {
    /// For each replica that is to run, a state for each ladder of this process.
    pub(crate) starts: Vec<Vec<State>>,
    /// Integrals of the replicas' densities: constants of the weights.
    pub(crate) rough: Vec<Estimate>,
    /// The first attempt's independent samples.
    pub(crate) pool: Vec<PoolSample>,
    /// Implicit specular light of what the first attempt's scouts found, and how many were sent.
    pub(crate) scouted: (Vec<f64>, u64),
    /// Effective numbers of particles by replica: of the first population weighed at once, and of the
    /// annealed one before it is resampled at that level.
    pub(crate) effective: Vec<[f64; 2]>,
    /// Mean of X + Y + Z over the last attempt's samples, or over its scouts or the meter's where these alone met
    /// light; 0 if nobody did.
    pub(crate) mean: f64,
    /// Particles of the last attempt.
    pub(crate) particles: u64,
    /// The replicas, those that do not run among them.
    pub(crate) set: ReplicaSet,
    /// Why replicas do not run.
    pub(crate) dropped: Option<String>,
}

/// Why there is no light for the specific replica, if there cannot be any.
fn lightless(
    target: PathTarget<'_>,
    set: &ReplicaSet,
    started: &Started,
    sighted: Sighting,
) -> Option<String> {
    if !set.is_specific() {
        return None;
    }
    if !target.scene.has_extended_lights() {
        return Some("there is no emitter that a walk can run into".to_owned());
    }
    let walks = started.scouted.1;
    (sighted == Sighting::Plain).then(|| {
        format!("none of {walks} walks from the camera began at a mirror or at smooth glass")
    })
}

/// Why it is not worth its steps though it has lived, if so.
fn negligible<const K: usize>(set: &ReplicaSet, started: &Started) -> Option<String> {
    let little = started.rough[K - 1].value < NEGLIGIBLE * started.rough[K - 2].value;
    (set.is_specific() && little)
        .then(|| format!("its normalisation is below {NEGLIGIBLE} of that of the replica before"))
}

/// Anneals until the population lives or has been tried often enough, and drops what nobody reaches
/// and what is negligible.
fn anneal<const K: usize>(
    target: PathTarget<'_>,
    set: &ReplicaSet,
    settings: &RenderSettings,
) -> Started {
    let mut attempt = 0;
    let mut first = None;
    loop {
        let easy = first.as_ref().map(|(_, easy)| *easy);
        let mut climb = Climb::<K>::new(target, set, settings, attempt, easy);
        let (mut started, extinct, sighted) = climb.run();
        let lightless = lightless(target, set, &started, sighted);
        let hopeless = lightless.is_some() && extinct == Some(Extinct { level: K - 1 });
        if extinct.is_some() && !hopeless && attempt < AGAIN {
            attempt += 1;
            first.get_or_insert(((started.pool, started.scouted), climb.easy));
            continue;
        }
        let specific = |why: String| format!("the specific replica does not run: {why}");
        if hopeless {
            started.dropped = lightless.map(specific);
        } else if let Some(Extinct { level }) = extinct {
            started.dropped = Some(format!(
                "replicas from the {}. on do not run: none of {} particles reached it",
                level + 1,
                started.particles
            ));
        } else if let Some(easy) = climb.easy {
            started.dropped = Some(specific(easy.to_string()));
        } else if let Some(why) = lightless.or_else(|| negligible::<K>(set, &started)) {
            started.drop_last(specific(why));
        }
        // What counts as independent is the first attempt's: a later one was made because that had met too little,
        // and is the last because it met enough.
        if let Some((first, _)) = first {
            (started.pool, started.scouted) = first;
        }
        return started;
    }
}

impl Started {
    fn drop_last(&mut self, why: String) {
        self.starts.pop();
        self.rough.pop();
        self.dropped = Some(why);
    }
}

/// Independent samples, each from a generator of its own, in the order of their indices. `None`: stopped.
pub(crate) fn samples<const K: usize>(
    target: PathTarget<'_>,
    family: &ReplicaFamily<K>,
    mutation: &Mutation,
    seed: u64,
    ladder: u64,
    (count, stop): (u64, Option<&AtomicBool>),
) -> Option<Vec<State>> {
    let generators = SampleGenerators::new(seed, ladder);
    (0..count as usize)
        .into_par_iter()
        .with_min_len(64)
        .map(|index| {
            let mut draws = generators.at(index as u64);
            (!is_stopped(stop)).then(|| {
                let chain = Metropolis::start(&target, family, 0, *mutation, &mut draws);
                (chain.state().clone(), chain.value().clone())
            })
        })
        .collect()
}
