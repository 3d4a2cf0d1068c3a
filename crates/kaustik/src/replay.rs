//! A step of a render once more, for whoever wants to see what happened in it.

use kaustik_path::Event;
use kaustik_scene::Scene;

use crate::beside::lamps::Lamps;
use crate::beside::meter::Meter;
use crate::check::check;
use crate::methods::engine;
use crate::methods::settled::settled;
use crate::state::take_up;
use crate::threads::pool;
use crate::{RenderError, RenderSettings, State, StepId};

/// What happened in one step of a render: of a sample or mutation all that its path builder did, of `relt` in
/// the sweep of that step, of `erpt-pss` and `erpt` in the sample and its chains, of `sppm` in the light path
/// (all of them count as ladder 0); of chains of photons in the step of one chain and the exchanges after it,
/// of `annealing` in the step of one particle. Photon methods show the sample of the same place of what
/// photons cannot carry as well, `direct=apart` the steps of that number of both parts. [`StepId::LAMPS`]
/// stands for the samples of emitters seen directly beside chains, [`StepId::METER`] for those that measure
/// the brightness.
///
/// The step is that of the render with these settings, to the bit, whatever its budget (but for a time, which may shorten the start), threads and share of
/// the ladders. Independent samples are made at once, and so is a round of `annealing`; a chain goes there
/// from its start; chains of photons and stages, which learn from each other, run all iterations or stages
/// before: see [`replay_from`].
///
/// # Errors
/// As [`render`](fn@crate::render); a ladder that the render does not have, a level that a round of
/// `annealing` did not come to.
pub fn replay(
    scene: &Scene,
    settings: &RenderSettings,
    place: StepId,
) -> Result<Vec<Event>, RenderError> {
    replay_from(scene, settings, None, place, &mut |_| {})
}

/// As [`replay`], but starting from a saved state if that state does not lie beyond the requested step,
/// so that earlier iterations need not be rerun. `ahead` is called with the number of iterations still
/// to run, if there are any.
///
/// # Errors
/// As [`replay`]; a state of another scene, method, setting or share, or a damaged one.
pub fn replay_from(
    scene: &Scene,
    settings: &RenderSettings,
    state: Option<&State>,
    place: StepId,
    ahead: &mut (dyn FnMut(u64) + Send),
) -> Result<Vec<Event>, RenderError> {
    check(scene, settings)?;
    let settings = &*pool(settings.threads)?.install(|| settled(scene, settings, state));
    if let Some(state) = state {
        state.check(scene, settings)?;
    }
    if place.ladder == StepId::LAMPS {
        let lamps = pool(settings.threads)?.install(|| Lamps::new(scene, settings))?;
        let lamps = lamps.ok_or_else(|| no_ladder(settings, place))?;
        return Ok(lamps.replay(place.step));
    }
    if place.ladder == StepId::METER {
        let replay = || Meter::replay(scene, settings, place.step);
        let events = pool(settings.threads)?.install(replay);
        return events.ok_or_else(|| no_ladder(settings, place));
    }
    if place.ladder >= settings.options.ladders {
        return Err(no_ladder(settings, place));
    }
    let shares = settings.method.has_shares();
    let settings = &RenderSettings {
        ladders: shares.then(|| place.ladder..place.ladder + 1),
        ..settings.clone()
    };
    check(scene, settings)?;
    // Events are told on the thread where they happen: one of these.
    pool(settings.threads)?.install(|| {
        let new = || engine(scene, settings);
        let mut engine = new()?;
        if let (Some(state), Some(1..)) = (state, engine.ahead(place)) {
            take_up(engine.as_mut(), state, true)?;
            if engine.ahead(place).is_none() {
                engine = new()?;
            }
        }
        if let Some(iterations @ 1..) = engine.ahead(place) {
            ahead(iterations);
        }
        engine.replay(place)
    })
}

fn no_ladder(settings: &RenderSettings, place: StepId) -> RenderError {
    let last = settings.options.ladders.saturating_sub(1);
    let (found, why) = match place.ladder {
        StepId::LAMPS => (
            "lamps".to_owned(),
            ": this render has no samples of emitters seen directly beside its chains",
        ),
        StepId::METER => (
            "meter".to_owned(),
            ": this render does not measure its brightness beside its chains",
        ),
        ladder => (ladder.to_string(), ""),
    };
    RenderError::Setting {
        what: "the ladder",
        found,
        expected: format!("one of 0 to {last}{why}"),
    }
}
