//! What a render refuses before it begins.

use kaustik_scene::Scene;

use crate::{RenderError, RenderSettings};

/// Refuses settings that do not fit the scene, the method or each other.
pub(crate) fn check(scene: &Scene, settings: &RenderSettings) -> Result<(), RenderError> {
    let setting = |what, found: String, expected: String| {
        Err(RenderError::Setting {
            what,
            found,
            expected,
        })
    };
    let size = [settings.width, settings.height];
    if scene.image_size() != size {
        let found = format!("{} x {}", size[0], size[1]);
        let [w, h] = scene.image_size();
        return setting(
            "image size",
            found,
            format!("that of the scene's camera, {w} x {h}"),
        );
    }
    if scene.compensates() != settings.options.compensation {
        let word = |on: bool| if on { "on" } else { "off" }.to_owned();
        let expected = format!("that of the scene, {}", word(scene.compensates()));
        return setting(
            "compensation",
            word(settings.options.compensation),
            expected,
        );
    }
    // Before anything is made for each of its pixels.
    settings.layout().check()?;
    settings.options.check(settings.method)?;
    if settings.max_depth == 0 {
        return setting("max-depth", "0".into(), "at least 1".into());
    }
    let range = settings.ladder_range();
    if range.is_empty() || range.end > settings.options.ladders {
        let expected = format!("a part of 0..{}", settings.options.ladders);
        return setting(
            "ladders",
            format!("{}..{}", range.start, range.end),
            expected,
        );
    }
    if !settings.method.has_shares() && range != (0..settings.options.ladders) {
        let expected = "all of them: the iterations or stages of this method are shared by all ladders; renders of other seeds can be merged instead";
        let found = format!("{}..{}", range.start, range.end);
        return setting("ladders", found, expected.into());
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use kaustik_scene::{SceneOptions, builtin};

    use super::*;

    #[test]
    fn a_scene_of_another_compensation_is_refused() {
        let description = builtin::load("furnace").expect("a scene");
        let settings = RenderSettings {
            width: 8,
            height: 8,
            ..RenderSettings::default()
        };
        for compensation in [true, false] {
            let options = SceneOptions {
                width: 8,
                height: 8,
                compensation,
                ..SceneOptions::default()
            };
            let scene = Scene::new(&description, &options).expect("a sound scene");
            let mut settings = settings.clone();
            settings.options.compensation = compensation;
            assert!(check(&scene, &settings).is_ok());
            settings.options.compensation = !compensation;
            let error = check(&scene, &settings).expect_err("another");
            assert!(error.to_string().contains("compensation"), "{error}");
        }
    }
}
