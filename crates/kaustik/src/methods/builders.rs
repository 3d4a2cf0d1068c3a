//! The path builders of methods on primary samples.

use kaustik_path::{Bidirectional, Endpoint, Form, PathBuilder, Unidirectional};
use kaustik_scene::Scene;

use super::mmlt;
use crate::render::builder_settings;
use crate::{Builder, Method, RenderError, RenderSettings};

/// What makes paths of a point.
pub(crate) fn builder(
    scene: &Scene,
    settings: &RenderSettings,
) -> Result<Box<dyn PathBuilder>, RenderError> {
    let options = &settings.options;
    if settings.method == Method::Mmlt {
        return Ok(Box::new(mmlt::builder(scene, settings)?));
    }
    Ok(match options.builder {
        Builder::Unidirectional => Box::new(Unidirectional {
            settings: builder_settings(settings),
            next_event: options.next_event,
        }),
        Builder::Endpoint => Box::new(Endpoint {
            settings: builder_settings(settings),
        }),
        Builder::Simple => Box::new(bidirectional(settings, Form::Simple)),
        Builder::Bidirectional => Box::new(bidirectional(settings, Form::Full)),
    })
}

fn bidirectional(settings: &RenderSettings, form: Form) -> Bidirectional {
    Bidirectional {
        settings: builder_settings(settings),
        form,
        heuristic: settings.options.heuristic,
    }
}
