//! The path builders of methods on primary samples.

use glam::DVec2;
use kaustik_estimate::Contribution;
use kaustik_path::{Bidirectional, BuilderSettings, Endpoint, Form, PathBuilder, Unidirectional};
use kaustik_scene::Scene;

use super::{direct, mmlt};
use crate::{Builder, Method, RenderError, RenderSettings};

/// What path builders are told by these settings.
pub(crate) fn builder_settings(settings: &RenderSettings) -> BuilderSettings {
    let bounds = settings.layout().extended_bounds();
    let size = DVec2::new(f64::from(settings.width), f64::from(settings.height));
    BuilderSettings {
        min_edges: direct::min_edges(settings),
        max_edges: settings.max_depth,
        pure_specular: direct::pure_specular(settings),
        emitters_seen: true,
        track_largest: settings.options.contribution == Contribution::Maximum,
        wavelengths: settings.options.wavelengths,
        window_min: DVec2::from(bounds.min) / size,
        window_max: DVec2::from(bounds.max) / size,
    }
}

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
