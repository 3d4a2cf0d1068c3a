//! What a render refuses before it begins.

use kaustik_path::MeasurementPoints;
use kaustik_scene::Scene;

use crate::sampling::cells::Cells;
use crate::{RenderError, RenderSettings};

/// Bytes that a photon method has for each camera path at the least: points, their index and a film (`docs/performance.md`).
const OF_PHOTONS: u64 = 170;
/// A film's three sums of 8 bytes.
const OF_A_FILM: u64 = 24;
/// Albedo, normal and depth.
const OF_FEATURES: u64 = 28;

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

/// Refuses images that no system would find the memory for, where an allocation that fails would end the process. What it
/// asks for is less than what a render takes: one that is just possible is not refused.
fn check_size(settings: &RenderSettings) -> Result<(), RenderError> {
    let method = settings.method;
    let pixels = settings.pixels();
    let mut of_each = OF_A_FILM;
    if method.traces_photons() {
        // one camera path a cell, and at most one point each
        let paths = Cells::new(settings).count();
        if paths > MeasurementPoints::MOST {
            return Err(RenderError::Setting {
                what: "the number of camera paths of an iteration",
                found: paths.to_string(),
                expected: format!(
                    "at most {} for {method}: render one crop window at a time",
                    MeasurementPoints::MOST
                ),
            });
        }
        of_each = OF_PHOTONS;
    }
    if settings.features {
        of_each += OF_FEATURES;
    }
    let bytes = pixels.saturating_mul(of_each);
    let granted = usize::try_from(bytes).is_ok_and(|bytes| {
        let mut room = Vec::<u8>::new();
        std::hint::black_box(&mut room)
            .try_reserve_exact(bytes)
            .is_ok()
    });
    if granted {
        return Ok(());
    }
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
            (settings.width, settings.height) = (512, 512);
            assert!(check_size(&settings).is_ok(), "{method}");
            // 2^52 pixels: more bytes than there are addresses, but no more than one may ask for
            (settings.width, settings.height) = (1 << 31, 1 << 21);
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
