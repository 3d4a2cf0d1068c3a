//! A step of a render once more, for whoever wants to see what happened in it.

use kaustik_path::Event;
use kaustik_scene::Scene;

use crate::render::{check, engine};
use crate::threads::pool;
use crate::{Method, Place, RenderError, RenderSettings};

/// What happened in one step of a render: of a sample or mutation all that its path builder did, of `relt` in the sweep
/// of that step, of `erpt-pss` and `erpt` in the sample and its chains, of `sppm` in the light path (all of them count as
/// ladder 0) and in the sample of what photons cannot carry; with `direct=apart` in the steps of that number
/// of both parts.
///
/// The step is that of the render with these settings, to the bit, whatever its budget and share of the ladders. Independent
/// samples are made at once; a chain goes there from its start.
///
/// # Errors
/// As [`render`](fn@crate::render); a method that is not [replayable](Method::is_replayable), a ladder that
/// the render does not have.
pub fn replay(
    scene: &Scene,
    settings: &RenderSettings,
    place: Place,
) -> Result<Vec<Event>, RenderError> {
    if !settings.method.is_replayable() {
        return Err(unreplayable(settings.method));
    }
    let ladders = settings.options.ladders;
    if place.ladder >= ladders {
        return Err(RenderError::Setting {
            what: "the ladder",
            found: place.ladder.to_string(),
            expected: format!("one of 0 to {}", ladders.saturating_sub(1)),
        });
    }
    let shares = settings.method.has_shares();
    let settings = RenderSettings {
        ladders: shares.then(|| place.ladder..place.ladder + 1),
        ..settings.clone()
    };
    check(scene, &settings)?;
    let pool = pool(settings.threads)?;
    let mut engine = pool.install(|| engine(scene, &settings))?;
    // On this thread: events are told on the one where they happen.
    let events = engine.replay(place);
    events.ok_or_else(|| unreplayable(settings.method))
}

fn unreplayable(method: Method) -> RenderError {
    let known = Method::ALL.into_iter().filter(|m| m.is_replayable());
    let names: Vec<_> = known.map(Method::name).collect();
    let why = match method {
        Method::Annealing => {
            "a round of annealing moves all its particles together; relt, which starts by the same annealing, shows its sweeps"
        }
        _ => {
            "chains of photons learn from each other in every iteration; sppm shows light paths among the same points"
        }
    };
    RenderError::Setting {
        what: "the method",
        found: method.to_string(),
        expected: format!(
            "one whose steps can be replayed: {} ({why})",
            names.join(", ")
        ),
    }
}
