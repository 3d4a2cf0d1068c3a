//! Where whole passes ended: a pass that is broken off is taken back to there.

use kaustik_film::Counters;
use kaustik_path::Rays;

use super::IndependentEngine;
use crate::engine::Nonfinite;

/// The films and streams of an engine as they were. Its memory is used again.
#[derive(Default)]
pub(super) struct Mark {
    sums: Vec<i64>,
    counters: Counters,
    streams: Vec<(u64, Nonfinite, Rays)>,
}

impl IndependentEngine<'_> {
    /// Writes down where the engine is.
    pub(super) fn mark(&mut self) {
        let mut mark = std::mem::take(&mut self.mark);
        mark.sums.clear();
        mark.sums.extend(self.film.sums());
        mark.counters = self.film.counters();
        mark.streams.clear();
        let streams = self.streams.iter();
        mark.streams
            .extend(streams.map(|s| (s.step, s.nonfinite, s.rays)));
        self.mark = mark;
    }

    /// Goes back to where it was then.
    pub(super) fn take_back(&mut self) {
        let Self {
            mark,
            film,
            streams,
            ..
        } = self;
        film.clear();
        // They came from this very film: there are as many, and no sum is past its limit.
        let restored = film.add_sums(mark.sums.iter().copied(), &mark.counters);
        debug_assert!(restored.is_ok());
        for (stream, (step, nonfinite, rays)) in streams.iter_mut().zip(&mark.streams) {
            (stream.step, stream.nonfinite, stream.rays) = (*step, *nonfinite, *rays);
        }
    }
}
