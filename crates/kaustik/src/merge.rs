//! Shares of a render, added up.

use kaustik_scene::Scene;

use crate::render::{Work, check, engine, threads};
use crate::{Outcome, RenderError, RenderSettings, Rendered, State, StateError, Watch};

/// The settings of the render whose shares these states are, with all of their ladders: what a scene for
/// [`merge`] is built for.
///
/// # Errors
/// No states, states of different pictures, ladders that overlap or leave a gap.
pub fn whole(states: &[State]) -> Result<RenderSettings, StateError> {
    let Some((first, others)) = states.split_first() else {
        return Err(StateError::Shares("there are none".to_owned()));
    };
    for other in others {
        first
            .header()
            .same_picture(other.header())
            .map_err(|error| match error {
                StateError::Other(differences) => {
                    StateError::Shares(format!("{differences} ('here' is another of the states)"))
                }
                error => error,
            })?;
    }
    let mut ladders: Vec<_> = states.iter().map(State::ladders).collect();
    ladders.sort_by_key(|range| (range.start, range.end));
    for pair in ladders.windows(2) {
        let [a, b] = [&pair[0], &pair[1]];
        if a.end != b.start {
            let fault = if a.end > b.start {
                "overlap"
            } else {
                "leave a gap"
            };
            return Err(StateError::Shares(format!(
                "the ladders {}..{} and {}..{} {fault}",
                a.start, a.end, b.start, b.end
            )));
        }
    }
    let end = ladders.last().map_or(0, |range| range.end);
    Ok(RenderSettings {
        ladders: Some(ladders[0].start..end),
        ..first.settings()?
    })
}

/// The picture of several states, as one process would have made it of all their ladders, to the bit. `settings` are
/// those of [`whole`]; threads and features are free. `watch` is asked for the state of the whole alone.
///
/// # Errors
/// As [`crate::resume`]; ladders that have gone different ways, where their samples cannot be weighed against each
/// other.
pub fn merge(
    scene: &Scene,
    settings: &RenderSettings,
    states: &[State],
    watch: &mut dyn Watch,
) -> Result<Rendered, RenderError> {
    check(scene, settings)?;
    for state in states {
        let share = RenderSettings {
            ladders: Some(state.ladders()),
            ..settings.clone()
        };
        state.check(scene, &share)?;
    }
    let pool = threads(settings)?;
    let mut work = Work::new(scene, settings);
    let mut engine = pool.install(|| engine(scene, settings))?;
    for (index, state) in states.iter().enumerate() {
        pool.install(|| work.take_up(engine.as_mut(), state, index == 0))?;
    }
    work.begin();
    if watch.wants_state(&work.progress(engine.as_ref()), true) {
        work.show_state(engine.as_ref(), watch);
    }
    let outcome = if engine.is_lit() {
        Outcome::Complete
    } else {
        Outcome::Black
    };
    work.finish(engine, &pool, outcome)
}
