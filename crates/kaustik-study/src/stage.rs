//! Scenes as they are needed: a study that only reads what is finished loads none.

use std::sync::OnceLock;

use kaustik::scene::{Description, Scene, SceneOptions, builtin, gltf};

use crate::{SceneEntry, SceneSource, Study, StudyError};

/// A scene of a study, compiled with and without compensation when first asked for.
pub(crate) struct Stage<'a> {
    study: &'a Study,
    entry: &'a SceneEntry,
    description: OnceLock<Description>,
    plain: OnceLock<Scene>,
    compensated: OnceLock<Scene>,
}

impl<'a> Stage<'a> {
    pub(crate) fn new(study: &'a Study, entry: &'a SceneEntry) -> Self {
        Self {
            study,
            entry,
            description: OnceLock::new(),
            plain: OnceLock::new(),
            compensated: OnceLock::new(),
        }
    }

    pub(crate) fn scene(&self, compensation: bool) -> Result<&Scene, StudyError> {
        let slot = if compensation {
            &self.compensated
        } else {
            &self.plain
        };
        if let Some(scene) = slot.get() {
            return Ok(scene);
        }
        let options = SceneOptions {
            width: self.study.width,
            height: self.study.height,
            compensation,
            ..SceneOptions::default()
        };
        let scene = Scene::new(self.description()?, &options).map_err(|e| self.wrong(e))?;
        Ok(slot.get_or_init(|| scene))
    }

    fn description(&self) -> Result<&Description, StudyError> {
        if let Some(description) = self.description.get() {
            return Ok(description);
        }
        let description = match &self.entry.source {
            SceneSource::Builtin(words) => builtin::load(words).map_err(|e| self.wrong(e))?,
            SceneSource::File(path) => {
                let options = gltf::LoadOptions::default();
                gltf::load(path, &options)
                    .map_err(|e| self.wrong(e))?
                    .description
            }
        };
        Ok(self.description.get_or_init(|| description))
    }

    fn wrong(&self, error: impl std::fmt::Display) -> StudyError {
        StudyError::Scene {
            name: self.entry.name.clone(),
            message: error.to_string(),
        }
    }
}
