//! Where whole passes ended: a pass that is broken off is taken back to there.

use kaustik_film::Film;
use kaustik_path::RayCounts;

use super::IndependentEngine;
use crate::engine::Nonfinite;
use crate::mark::FilmMark;
use crate::methods::erpt_pss::{Chains, Kept};

/// The films and streams of an engine as they were. Its memory is used again.
#[derive(Default)]
pub(super) struct Mark {
    film: FilmMark,
    held: FilmMark,
    streams: Vec<(u64, Nonfinite, RayCounts, Option<Kept>)>,
}

impl IndependentEngine<'_> {
    /// Writes down where the engine is.
    pub(super) fn mark(&mut self) {
        let Self {
            mark,
            film,
            streams,
            redistribution,
            ..
        } = self;
        mark.film.set(film);
        if let Some(held) = redistribution.as_ref().and_then(|r| r.held.as_ref()) {
            mark.held.set(held);
        }
        mark.streams.clear();
        mark.streams.extend(streams.iter().map(|s| {
            let chains = s.chains.as_deref().map(Chains::kept);
            (s.step, s.nonfinite, s.rays, chains)
        }));
    }

    /// Lends the film, black, to work that has another use for its memory. It holds what it held afterwards.
    pub(crate) fn lend<T>(&mut self, work: impl FnOnce(&mut Film) -> T) -> T {
        let quantum = self.film.quantum();
        self.aside.set(&self.film);
        self.film.renew(quantum);
        let result = work(&mut self.film);
        self.film.renew(quantum);
        self.aside.take_back(&mut self.film);
        result
    }

    /// Lets go the memory of what a stop would need: until the engine advances again, nobody does.
    pub(crate) fn forget_marks(&mut self) {
        (self.mark, self.aside) = (Mark::default(), FilmMark::default());
    }

    /// Goes back to where it was when it was told to advance last, if it could be stopped then.
    pub(crate) fn take_back(&mut self) {
        let Self {
            mark,
            film,
            streams,
            redistribution,
            ..
        } = self;
        mark.film.take_back(film);
        if let Some(held) = redistribution.as_mut().and_then(|r| r.held.as_mut()) {
            mark.held.take_back(held);
        }
        for (stream, (step, nonfinite, rays, kept)) in streams.iter_mut().zip(&mark.streams) {
            (stream.step, stream.nonfinite, stream.rays) = (*step, *nonfinite, *rays);
            if let (Some(chains), Some(kept)) = (&mut stream.chains, kept) {
                chains.go_to(kept.clone());
            }
        }
    }
}
