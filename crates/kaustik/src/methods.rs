//! The methods: an engine each, or one for several.

pub(crate) mod annealing;
pub(crate) mod builders;
pub(crate) mod direct;
pub(crate) mod erpt;
pub(crate) mod erpt_pss;
pub(crate) mod independent;
pub(crate) mod mlt;
pub(crate) mod mmlt;
pub(crate) mod path_space;
pub(crate) mod photon;
pub(crate) mod pssmlt;
pub(crate) mod relt;
pub(crate) mod settled;
pub(crate) mod stages;
pub(crate) mod start_share;

use kaustik_scene::Scene;

use self::direct::DirectApart;
use self::erpt::ErptEngine;
use self::independent::IndependentEngine;
use self::mlt::MltEngine;
use self::photon::PhotonEngine;
use self::pssmlt::PssmltEngine;
use self::stages::StagedEngine;
use crate::engine::Engine;
use crate::{Method, RenderError, RenderSettings};

pub use stages::{StageLadder, StageOptions};

/// The engine of the method that the settings name, with direct light apart if they say so.
pub(crate) fn engine<'a>(
    scene: &'a Scene,
    settings: &'a RenderSettings,
) -> Result<Box<dyn Engine + 'a>, RenderError> {
    let engine: Box<dyn Engine> = match settings.method {
        Method::Path => Box::new(IndependentEngine::path(scene, settings)?),
        Method::Light => Box::new(IndependentEngine::light(scene, settings)?),
        Method::Bdpt => Box::new(IndependentEngine::bdpt(scene, settings)?),
        Method::Pssmlt | Method::Mmlt => Box::new(PssmltEngine::new(scene, settings)?),
        Method::Relt => relt::engine(scene, settings)?,
        Method::Mlt => Box::new(MltEngine::new(scene, settings)?),
        Method::Erpt => Box::new(ErptEngine::new(scene, settings)?),
        Method::Sppm
        | Method::PhotonVisibility
        | Method::PhotonDensity
        | Method::PhotonSpatial
        | Method::PhotonImage => Box::new(PhotonEngine::new(scene, settings)?),
        Method::MltMultistage | Method::PssmltMultistage => {
            Box::new(StagedEngine::new(scene, settings)?)
        }
        Method::Annealing => annealing::engine(scene, settings)?,
        Method::ErptPss => Box::new(IndependentEngine::erpt_pss(scene, settings)?),
    };
    if !direct::is_apart(settings) {
        return Ok(engine);
    }
    Ok(Box::new(DirectApart::new(scene, settings, engine)?))
}
