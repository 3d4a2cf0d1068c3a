//! Independent photons (Hachisuka and Jensen 2009).

use std::io;
use std::sync::atomic::AtomicBool;

use kaustik_film::{Counters, Film, Image, develop};
use kaustik_mcmc::{Independent, SampleGenerators};
use kaustik_path::{Event, PhotonPath, trace};
use rayon::prelude::*;

use super::Tracer;
use super::stage::Stage;
use crate::control::is_stopped;
use crate::engine::Nonfinite;
use crate::state::{Reader, StateError, Writer};
use crate::{RenderError, RenderSettings, StepId};

/// Light paths that one thread traces at a time.
const CHUNK: u64 = 1024;

/// Every light path is a sample of its own: that of its number alone.
pub(super) struct IndependentPhotons {
    generators: Vec<SampleGenerators>,
    film: Film,
    nonfinite: Nonfinite,
}

impl IndependentPhotons {
    /// For a stage whose first iteration has begun.
    pub(super) fn new(stage: &Stage<'_>, settings: &RenderSettings) -> Result<Self, RenderError> {
        let ladders = 0..u64::from(settings.options.ladders);
        Ok(Self {
            generators: ladders
                .map(|ladder| SampleGenerators::new(settings.seed, ladder))
                .collect(),
            film: stage.film(settings)?,
            nonfinite: Nonfinite::default(),
        })
    }

    /// The light path of this number, and what it brings to the points of its iteration. Returns how much was left out.
    #[inline]
    fn light_path(&self, stage: &Stage<'_>, step: u64, film: &Film, path: &mut PhotonPath) -> u64 {
        let ladders = self.generators.len() as u64;
        let generators = &self.generators[(step % ladders) as usize];
        let mut u = Independent::new(generators.at(step / ladders));
        (stage.tracing).build(stage.scene(), stage.wavelengths(), &mut u, path);
        (stage.map()).deposit(film, stage.scale, path, 1.0)
    }
}

impl Tracer for IndependentPhotons {
    fn trace(&mut self, stage: &Stage<'_>, spare: &mut Film, stop: Option<&AtomicBool>) -> bool {
        // Apart, until it is whole.
        spare.renew(self.film.quantum());
        let film = &*spare;
        let before = (stage.iterations - 1) * stage.photons;
        let chunk = |path: &mut PhotonPath, chunk: u64| {
            let mut faults = Nonfinite::default();
            if is_stopped(stop) {
                return faults;
            }
            for number in chunk * CHUNK..((chunk + 1) * CHUNK).min(stage.photons) {
                let step = before + number;
                faults.count(self.light_path(stage, step, film, path), step);
            }
            faults
        };
        let chunks = 0..stage.photons.div_ceil(CHUNK);
        let found = chunks
            .into_par_iter()
            .map_init(PhotonPath::default, chunk)
            .reduce(Nonfinite::default, Nonfinite::and);
        // The flag stays up: without it no chunk was left out.
        let whole = !is_stopped(stop);
        if whole {
            self.nonfinite = self.nonfinite.and(found);
            // It was made for the same picture, and has the same unit.
            let merged = self.film.merge(spare);
            debug_assert!(merged.is_ok());
        }
        whole
    }

    /// Iteration and light path follow from the number. All are counted on the account of the first ladder.
    fn replay(
        &mut self,
        stage: &mut Stage<'_>,
        spare: &mut Film,
        StepId { ladder, step }: StepId,
    ) -> Vec<Event> {
        if ladder > 0 {
            return Vec::new();
        }
        stage.begin_at(step / stage.photons);
        let mut path = PhotonPath::default();
        spare.renew(self.film.quantum());
        trace(|| self.light_path(stage, step, spare, &mut path)).1
    }

    fn write(&self, out: &mut Writer<'_>) -> io::Result<()> {
        out.film(&self.film)?;
        out.value(&self.nonfinite)
    }

    fn take_up(&mut self, from: &mut Reader<'_>, _: u64) -> Result<(), StateError> {
        from.film(&mut self.film)?;
        self.nonfinite = from.value::<Nonfinite>()?.checked()?;
        Ok(())
    }

    fn add_to(&mut self, stage: &Stage<'_>, image: &mut Image) -> Result<(), RenderError> {
        Ok(image.add(&develop(&[(&self.film, stage.factor())])?)?)
    }

    fn nonfinite(&self) -> (u64, Vec<StepId>) {
        Nonfinite::all(std::iter::once((0, self.nonfinite)))
    }

    fn film_counters(&self) -> Counters {
        self.film.counters()
    }
}
