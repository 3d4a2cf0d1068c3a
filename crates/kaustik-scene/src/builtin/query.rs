use super::{BuiltinError, BuiltinScene};

/// The parameters given for a scene, all of them known to it.
#[derive(Debug)]
pub(super) struct Query<'a> {
    scene: &'static BuiltinScene,
    pairs: Vec<(&'a str, &'a str)>,
}

impl<'a> Query<'a> {
    /// Parses `key=value&key=value`; empty for none.
    pub(super) fn parse(
        scene: &'static BuiltinScene,
        words: &'a str,
    ) -> Result<Self, BuiltinError> {
        let mut pairs: Vec<(&str, &str)> = Vec::new();
        for part in words.split('&').filter(|part| !part.is_empty()) {
            let (key, value) = part
                .split_once('=')
                .ok_or_else(|| BuiltinError::Malformed {
                    scene: scene.name,
                    part: part.to_owned(),
                })?;
            if !scene.parameters.iter().any(|known| known.key == key) {
                return Err(unknown(scene, key));
            }
            if pairs.iter().any(|&(other, _)| other == key) {
                let key = key.to_owned();
                let scene = scene.name;
                return Err(BuiltinError::Repeated { scene, key });
            }
            pairs.push((key, value));
        }
        Ok(Self { scene, pairs })
    }

    /// The value of a key that the scene declares, its default if absent.
    pub(super) fn text(&self, key: &'static str) -> &'a str {
        let given = self.pairs.iter().find(|pair| pair.0 == key);
        let default = || self.scene.parameters.iter().find(|known| known.key == key);
        match given {
            Some(pair) => pair.1,
            None => default().map_or("", |parameter| parameter.default),
        }
    }

    /// The value as a number from `low` to `high`.
    pub(super) fn number(
        &self,
        key: &'static str,
        low: f32,
        high: f32,
    ) -> Result<f32, BuiltinError> {
        let number = self.text(key).parse::<f32>().ok();
        number
            .filter(|number| (low..=high).contains(number))
            .ok_or_else(|| self.refuse(key))
    }

    /// The error of a value that is not permitted.
    pub(super) fn refuse(&self, key: &'static str) -> BuiltinError {
        let declared = self.scene.parameters.iter().find(|known| known.key == key);
        BuiltinError::Value {
            scene: self.scene.name,
            key,
            value: self.text(key).to_owned(),
            expected: declared.map_or("another value", |parameter| parameter.values),
        }
    }
}

fn unknown(scene: &'static BuiltinScene, key: &str) -> BuiltinError {
    let keys: Vec<&str> = scene.parameters.iter().map(|known| known.key).collect();
    BuiltinError::UnknownParameter {
        scene: scene.name,
        key: key.to_owned(),
        known: if keys.is_empty() {
            "it has none".to_owned()
        } else {
            format!("there are {}", keys.join(", "))
        },
    }
}
