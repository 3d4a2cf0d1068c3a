//! What is seen directly: paths of one edge, by samples of their own.
//!
//! A lamp that fills few pixels is bright there and nothing elsewhere. A chain meets it by chance, and
//! the constant that scales its picture is an integral over all pixels, to which such a lamp brings most
//! of the noise (9 tenths of the light's error in `ring-and-sphere`). A camera ray a pixel knows it better than a
//! million paths.

use kaustik_film::{Counters, Film};
use kaustik_scene::Scene;

use crate::engine::Engine;
use crate::independent::IndependentEngine;
use crate::{Budget, Lamps, Method, Place, RenderError, RenderSettings};

/// Passes over the image before the chains start.
const FIRST: u64 = 1;
/// Mutations a pixel for each further one.
const EACH: u64 = 8;
/// Samples from which the film's quantum is taken, times a hundred: lamps are small.
const PILOT: u64 = 2_000_000;

/// Stratified samples of what is seen directly.
pub(crate) struct DirectLight<'a> {
    engine: IndependentEngine<'a>,
    passes: u64,
    pixels: u64,
}

impl<'a> DirectLight<'a> {
    /// `None` if the chains do it themselves.
    pub(crate) fn new(
        scene: &'a Scene,
        settings: &RenderSettings,
    ) -> Result<Option<Self>, RenderError> {
        if settings.options.lamps == Lamps::Chain {
            return Ok(None);
        }
        let mut own = RenderSettings {
            method: Method::Path,
            max_depth: 1,
            // a part of the ladders still makes a whole picture
            ladders: None,
            budget: Budget::Total(0),
            ..settings.clone()
        };
        own.options.pilot = PILOT;
        let mut direct = Self {
            engine: IndependentEngine::path(scene, &own)?,
            passes: 0,
            pixels: settings.pixels(),
        };
        direct.keep_up(0);
        Ok(Some(direct))
    }

    /// Takes the passes that so many mutations are due.
    pub(crate) fn keep_up(&mut self, mutations: u64) {
        let due = FIRST + mutations / (EACH * self.pixels);
        if due > self.passes {
            self.engine.pass(due - self.passes);
            self.passes = due;
        }
    }

    /// The film, with what turns it into a part of the picture.
    pub(crate) fn part(&self) -> (&Film, f64) {
        self.engine.part(self.passes)
    }

    /// Is anything seen?
    pub(crate) fn is_lit(&self) -> bool {
        self.engine.has_seen_light()
    }

    /// Contributions left out because they were not finite, and where the first arose.
    pub(crate) fn nonfinite(&self) -> (u64, Option<Place>) {
        self.engine.nonfinite()
    }

    /// What the film left out.
    pub(crate) fn film_counters(&self) -> Counters {
        self.engine.film_counters()
    }
}
