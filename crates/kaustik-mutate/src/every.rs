//! A perturbation of every variable of a path at once (Kelemen et al. 2002, sec. 7: what mutations in
//! the primary sample space are compared with).

use kaustik_mcmc::{Draws, Mutation, Uniform};
use kaustik_spectrum::Wavelengths;

use crate::retrace::{self, Retrace};
use crate::{Path, PathSpace};

/// Perturbs every variable of a path by a fraction of its domain, and traces the whole path again with the same
/// string of scatterings.
///
/// | variable | domain | measure |
/// |---|---|---|
/// | wavelengths | [0, 1) | that of the uniform number they are sampled by |
/// | time, where something moves | [0, 1) | itself |
/// | point of the lens | square around it | area; beyond the rim the proposal is impossible |
/// | raster point | the window | area |
/// | direction at a vertex that does not scatter into Dirac directions | the hemisphere that it lies in | solid angle: its cosine and its azimuth |
/// | point of a surface that emits | its triangle | area |
///
/// Steps are uniform over the fraction ([`Uniform`]) and go round at the ends of a domain. Nothing is sampled
/// by importance: each variable moves symmetrically in the measure above, and what is left of the ratio is the
/// geometry of what is traced, as of [`LensPerturbation`](crate::LensPerturbation). An emitter infinitely far
/// away, and one behind a Dirac scattering, is found by the last direction; a punctual light stays where it is. What
/// moves takes lens and emitter along: a point of them is the same point at the other time.
#[derive(Clone, Copy, Debug)]
pub struct EveryPerturbation<'a> {
    /// Where the paths run.
    pub space: &'a PathSpace<'a>,
    /// The share of its domain that a variable can reach, in (0, 1].
    pub fraction: f64,
}

impl EveryPerturbation<'_> {
    /// Is the path of the kind that this perturbation moves?
    pub fn suits(&self, path: &Path) -> bool {
        retrace::suits(path)
    }

    pub(crate) fn perturb<D: Draws + ?Sized>(
        &self,
        x: &Path,
        y: &mut Path,
        draws: &mut D,
    ) -> Option<f64> {
        if !self.suits(x) {
            return None;
        }
        let step = Uniform::new(self.fraction);
        y.wavelength_u = step.mutate(x.wavelength_u, draws);
        y.wavelengths = Wavelengths::sample(y.wavelength_u, self.space.settings.wavelengths);
        y.time = x.time;
        if self.space.scene.moves() {
            y.time = step.mutate(x.time, draws);
        }
        let step = Some(step);
        self.space.at(y.time, |to| {
            let from = self.space;
            Retrace { from, to, step }.trace(x, y, draws)
        })
    }
}
