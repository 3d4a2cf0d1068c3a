use glam::DVec2;
use kaustik_mutate::PathSpace;
use kaustik_scene::Scene;

use crate::methods::builders::builder_settings;
use crate::{RenderError, RenderSettings};

/// The light paths of a scene, for the methods that move in them.
pub(crate) fn path_space<'a>(
    scene: &'a Scene,
    settings: &RenderSettings,
) -> Result<PathSpace<'a>, RenderError> {
    if settings.max_depth > PathSpace::MOST_EDGES {
        return Err(RenderError::Setting {
            what: "max-depth",
            found: settings.max_depth.to_string(),
            expected: format!("at most {} for {}", PathSpace::MOST_EDGES, settings.method),
        });
    }
    Ok(PathSpace {
        scene,
        settings: builder_settings(settings),
        target: settings.options.target,
        pixels: DVec2::new(f64::from(settings.width), f64::from(settings.height)),
    })
}
