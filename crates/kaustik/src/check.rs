//! What a render refuses before it begins.

use kaustik_path::MeasurementPoints;
use kaustik_scene::Scene;

use crate::{RenderError, RenderSettings};

/// Bytes a pixel that measurement points, their index and the chains' sums take, measured at 1920x1080
/// (`docs/performance.md`, Memory).
const OF_PHOTONS: u64 = 252;
/// A film's three sums of 8 bytes, and as much again for what other methods know of a pixel: the share of samples
/// that it gets, the map of a stage.
const OF_A_FILM: u64 = 48;

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
    check_size(settings)?;
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

/// Refuses images of more pixels than there is memory for, where an allocation that fails would end the process.
fn check_size(settings: &RenderSettings) -> Result<(), RenderError> {
    let pixels = settings.pixels();
    let photons = settings.method.traces_photons();
    if photons && pixels > MeasurementPoints::MOST {
        return Err(RenderError::Setting {
            what: "the number of pixels",
            found: pixels.to_string(),
            expected: format!(
                "at most {} for {}: render one crop window at a time",
                MeasurementPoints::MOST,
                settings.method
            ),
        });
    }
    let bytes = pixels.saturating_mul(if photons { OF_PHOTONS } else { OF_A_FILM });
    let had =
        usize::try_from(bytes).is_ok_and(|bytes| Vec::<u8>::new().try_reserve_exact(bytes).is_ok());
    if had {
        return Ok(());
    }
    let method = settings.method;
    Err(RenderError::Memory {
        method,
        pixels,
        bytes,
    })
}

#[cfg(test)]
mod tests {
    use kaustik_scene::{SceneOptions, builtin};

    use super::*;
    use crate::Method;

    #[test]
    fn an_image_too_large_for_memory_is_refused() {
        for method in Method::ALL {
            let mut settings = RenderSettings {
                method,
                ..RenderSettings::default()
            };
            (settings.width, settings.height) = (8192, 8192);
            assert!(check_size(&settings).is_ok(), "{method}");
            // 2^64 pixels less some, of which no machine has room
            (settings.width, settings.height) = (u32::MAX, u32::MAX);
            let error = check_size(&settings).expect_err("too large");
            let told = if method.traces_photons() {
                matches!(error, RenderError::Setting { .. })
            } else {
                matches!(error, RenderError::Memory { pixels, .. } if pixels == settings.pixels())
            };
            assert!(told, "{method}: {error}");
        }
    }

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
