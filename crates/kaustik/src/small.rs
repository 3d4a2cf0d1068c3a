//! Small scenes and settings for tests of engines.

use kaustik_scene::{Scene, SceneOptions, builtin};

use crate::{Method, RenderSettings};

/// A built-in scene for pictures of this size.
pub(crate) fn scene(name: &str, [width, height]: [u32; 2]) -> Scene {
    let description = builtin::load(name).expect("a built-in scene");
    let options = SceneOptions {
        width,
        height,
        ..SceneOptions::default()
    };
    Scene::new(&description, &options).expect("a sound scene")
}

/// Settings of pictures of this size: what tests do not name is as users have it.
pub(crate) fn settings(method: Method, [width, height]: [u32; 2]) -> RenderSettings {
    RenderSettings {
        method,
        width,
        height,
        ..RenderSettings::default()
    }
}
