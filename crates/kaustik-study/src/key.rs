//! What a finished render is known by.

use std::path::Path;

use kaustik::{Budget, Method};
use serde_json::{Value, json};

use crate::study::options;
use crate::{SceneEntry, SceneSource, Study, StudyError};

/// All that a picture depends on, in words: two renders with equal words are the same render.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Key(Value);

/// A render as a key names it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Render<'a> {
    pub(crate) method: Method,
    pub(crate) settings: &'a [String],
    pub(crate) seed: u64,
    pub(crate) amount: Amount,
    pub(crate) layers: bool,
    /// Worker threads, 0 for one a processor: decide how much fits into a time, and how long samples took.
    pub(crate) threads: usize,
}

/// When a render is looked at or done.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Amount {
    /// Seconds by the study's clock.
    Seconds(f64),
    /// Samples.
    Samples(Budget),
}

impl Key {
    /// `scene` is from [`scene_words`].
    pub(crate) fn new(
        study: &Study,
        scene: &Value,
        render: &Render<'_>,
    ) -> Result<Self, StudyError> {
        let options = options(render.method, render.settings)
            .map_err(|message| StudyError::words("settings", message))?;
        let set: Vec<String> = (options.entries(render.method).into_iter())
            .map(|(key, value)| format!("{key}={value}"))
            .collect();
        // Threads change no bit of what is counted in samples, but the seconds that are told of it.
        let amount = match render.amount {
            Amount::Seconds(s) => json!([study.budgets.unit.name(), s, study.threads]),
            Amount::Samples(Budget::PerPixel(n)) => json!(["a pixel", n, render.threads]),
            Amount::Samples(Budget::Total(n)) => json!(["in all", n, render.threads]),
            Amount::Samples(Budget::Time(t)) => json!(["seconds", t.as_secs_f64()]),
        };
        Ok(Self(json!({
            "version": env!("CARGO_PKG_VERSION"),
            "scene": scene,
            "size": [study.width, study.height],
            "max_depth": study.max_depth,
            "method": render.method.name(),
            "set": set,
            "seed": render.seed,
            "amount": amount,
            "layers": render.layers,
        })))
    }

    /// As it stands in a cell's file.
    pub(crate) fn value(&self) -> &Value {
        &self.0
    }

    /// A name for files: 32 hexadecimal digits.
    pub(crate) fn name(&self) -> String {
        let words = self.0.to_string();
        let other = fingerprint(words.bytes().rev());
        format!("{:016x}{other:016x}", fingerprint(words.bytes()))
    }
}

/// The scene for keys: its words, or its file's contents. What a `.gltf` file names beside itself is
/// known by name alone.
pub(crate) fn scene_words(scene: &SceneEntry) -> Result<Value, StudyError> {
    match &scene.source {
        SceneSource::Builtin(words) => Ok(json!(words)),
        SceneSource::File(path) => {
            let bytes = read(path)?;
            Ok(json!([
                path.file_name().map(|n| n.to_string_lossy()),
                fingerprint(bytes)
            ]))
        }
    }
}

fn read(path: &Path) -> Result<Vec<u8>, StudyError> {
    std::fs::read(path).map_err(|source| StudyError::io(path, source))
}

/// FNV-1a, 64 bits: tells files apart that nobody forged.
pub(crate) fn fingerprint(bytes: impl IntoIterator<Item = u8>) -> u64 {
    bytes.into_iter().fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fingerprint_is_the_published_one() {
        assert_eq!(fingerprint([]), 0xcbf2_9ce4_8422_2325);
        assert_eq!(fingerprint(*b"a"), 0xaf63_dc4c_8601_ec8c);
        assert_eq!(fingerprint(*b"foobar"), 0x8594_4171_f739_67e8);
    }
}
