//! Scenes in code: small, procedural, each with one difficulty that a published figure shows.
//!
//! A built-in makes a plain [`Description`] and so can be exported, changed and loaded again
//! like any file. Nothing in it is random, all numbers are f32, and functions of the C library are
//! avoided: the same name gives the same bits everywhere. Boxes are about 5.5 units wide,
//! one unit standing for 10 cm of the physical Cornell box.
//!
//! Scenes with a small lamp take `light`, the edge of the square lamp. Its radiance grows as
//! its area shrinks, so a picture keeps its brightness while it gets harder to
//! find the lamp by chance.

mod canyon;
mod cornell;
mod cornell_direct;
mod cornell_indirect;
mod dinner_hall;
mod disco;
mod furnace;
mod glass_cube;
mod glossy_cornell;
mod material_ball;
mod materials;
mod mirror_balls;
mod mirror_statue;
mod patterns;
mod prism;
mod query;
mod ring_and_sphere;
mod room;
mod shapes;
mod spheres;
mod stage;
mod statue;
mod tea_time;
mod underwater;
mod villa;
mod water_cornell;

use crate::Description;
use query::Query;

/// A parameter of a built-in scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BuiltinParameter {
    /// The key in `name?key=value`.
    pub key: &'static str,
    /// What values are permitted, in words.
    pub values: &'static str,
    /// The value if the key is absent.
    pub default: &'static str,
    /// What it changes.
    pub meaning: &'static str,
}

/// A built-in scene.
#[derive(Clone, Copy, Debug)]
pub struct BuiltinScene {
    /// Its name.
    pub name: &'static str,
    /// What it shows, in a line.
    pub summary: &'static str,
    /// What can be chosen.
    pub parameters: &'static [BuiltinParameter],
    build: fn(&Query<'_>) -> Result<Description, BuiltinError>,
}

/// A built-in scene that cannot be made from the words given.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum BuiltinError {
    /// No such scene.
    #[error("there is no built-in scene '{name}'; there are {known}")]
    UnknownScene {
        /// The name given.
        name: String,
        /// All names.
        known: String,
    },
    /// The scene has no such parameter.
    #[error("built-in scene '{scene}' has no parameter '{key}'; {known}")]
    UnknownParameter {
        /// The scene.
        scene: &'static str,
        /// The key given.
        key: String,
        /// The keys that there are, in words.
        known: String,
    },
    /// A parameter twice.
    #[error("built-in scene '{scene}': parameter '{key}' is given twice")]
    Repeated {
        /// The scene.
        scene: &'static str,
        /// The key.
        key: String,
    },
    /// A value that is not permitted.
    #[error("built-in scene '{scene}': {key}={value} is not possible, expected {expected}")]
    Value {
        /// The scene.
        scene: &'static str,
        /// The key.
        key: &'static str,
        /// The value given.
        value: String,
        /// What is permitted, in words.
        expected: &'static str,
    },
    /// Not `key=value`.
    #[error("built-in scene '{scene}': '{part}' is not of the form key=value")]
    Malformed {
        /// The scene.
        scene: &'static str,
        /// The words.
        part: String,
    },
}

const SCENES: &[BuiltinScene] = &[
    cornell::SCENE,
    cornell_direct::SCENE,
    cornell_indirect::SCENE,
    glass_cube::SCENE,
    water_cornell::SCENE,
    ring_and_sphere::SCENE,
    glossy_cornell::SCENE,
    disco::SCENE,
    mirror_statue::SCENE,
    dinner_hall::SCENE,
    villa::SCENE,
    underwater::SCENE,
    canyon::SCENE,
    mirror_balls::SCENE,
    tea_time::SCENE,
    prism::SCENE,
    material_ball::SCENE,
    furnace::SCENE,
];

/// All built-in scenes.
#[must_use]
pub fn list() -> &'static [BuiltinScene] {
    SCENES
}

/// Makes the scene that `words` name: `name` or `name?key=value&key=value`.
///
/// # Errors
/// A scene, a key or a value that does not exist; the message lists what does.
pub fn load(words: &str) -> Result<Description, BuiltinError> {
    let (name, query) = words.split_once('?').unwrap_or((words, ""));
    let scene = SCENES
        .iter()
        .find(|scene| scene.name == name)
        .ok_or_else(|| {
            let names: Vec<&str> = SCENES.iter().map(|scene| scene.name).collect();
            BuiltinError::UnknownScene {
                name: name.to_owned(),
                known: names.join(", "),
            }
        })?;
    let query = Query::parse(scene, query)?;
    let mut description = (scene.build)(&query)?;
    words.clone_into(&mut description.name);
    Ok(description)
}

#[cfg(test)]
mod tests;
