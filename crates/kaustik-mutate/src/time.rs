use kaustik_mcmc::Draws;

use crate::retrace::{self, Retrace};
use crate::{Path, PathSpace};

/// Draws the time of a path anew and traces the path again: the same wavelengths, points of the image, of the
/// lens and of the emitter, the same string of scatterings and the same directions, each as its surface sees
/// it. Symmetric in these; what is left of the ratio is geometry, as of
/// [`EveryPerturbation`](crate::EveryPerturbation).
///
/// A path that nothing moves stays what it is at any time. Without this kernel, the time of a
/// path would change only where the whole path is made anew, or every variable of it perturbed.
#[derive(Clone, Copy, Debug)]
pub struct TimeMutation<'a> {
    /// Where the paths run.
    pub space: &'a PathSpace<'a>,
}

impl TimeMutation<'_> {
    /// Is the path of the kind that this mutation changes? None is where nothing moves.
    pub fn suits(&self, path: &Path) -> bool {
        self.space.scene.moves() && retrace::suits(path)
    }

    pub(crate) fn redraw<D: Draws + ?Sized>(
        &self,
        x: &Path,
        y: &mut Path,
        draws: &mut D,
    ) -> Option<f64> {
        if !self.suits(x) {
            return None;
        }
        y.tune(x);
        y.time = draws.uniform();
        self.space.at(y.time, |to| {
            let from = self.space;
            let step = None;
            Retrace { from, to, step }.trace(x, y, draws)
        })
    }
}
