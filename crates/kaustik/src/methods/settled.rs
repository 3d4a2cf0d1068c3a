//! Settings that leave something to the scene, settled.

use std::borrow::Cow;

use kaustik_scene::Scene;

use super::{direct, start_share};
use crate::{Direct, RenderSettings, StartShare, State};

/// Settings that say which light is rendered beside the chains and how much of the start is made, where they left it open. What a
/// look at the scene tells is the same every time; what a look at the clock told is in the state that a render goes on from.
pub(crate) fn settled<'s>(
    scene: &Scene,
    settings: &'s RenderSettings,
    state: Option<&State>,
) -> Cow<'s, RenderSettings> {
    let options = &settings.options;
    if options.direct != Direct::Auto && options.start != StartShare::Auto {
        return Cow::Borrowed(settings);
    }
    let mut settled = settings.clone();
    if options.direct == Direct::Auto {
        settled.options.direct = direct::choice(scene, settings);
    }
    if options.start == StartShare::Auto {
        settled.options.start = match state {
            Some(state) => start_share::of_state(state),
            None => start_share::choice(scene, &settled),
        };
    }
    Cow::Owned(settled)
}
