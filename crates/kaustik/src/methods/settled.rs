//! Settings that leave something to the scene, settled.

use std::borrow::Cow;

use kaustik_scene::Scene;

use super::{direct, start_share};
use crate::{Direct, RenderSettings, StartShare, State};

/// Settings that say which light is rendered beside the chains and how much of the start is made, where they left it open. Looks at the
/// scene decide, the same every time. How much of the start goes by the time as well, which may be longer when a render goes on: a
/// state tells what it was.
pub(crate) fn settled<'s>(
    scene: &Scene,
    settings: &'s RenderSettings,
    state: Option<&State>,
) -> Cow<'s, RenderSettings> {
    let mut settled = Cow::Borrowed(settings);
    if settings.options.direct == Direct::Auto {
        settled.to_mut().options.direct = direct::choice(scene, settings);
    }
    let start = match (settings.options.start, state) {
        _ if !start_share::has_start(settings.method) => StartShare::WHOLE,
        (StartShare::Auto, Some(state)) => start_share::of_state(state),
        (StartShare::Auto, None) => start_share::choice(scene, &settled),
        (share, _) => share,
    };
    if start != settings.options.start {
        settled.to_mut().options.start = start;
    }
    settled
}
