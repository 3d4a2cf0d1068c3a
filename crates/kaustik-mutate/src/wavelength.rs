use kaustik_bsdf::{Lobe, Mode};
use kaustik_mcmc::Draws;
use kaustik_spectrum::Wavelengths;

use crate::{Path, PathSpace};

/// Draws the wavelengths anew and keeps the vertices: no ray is traced but through panes. Symmetric.
///
/// A path that refracts smoothly where the index depends on the wavelength would run elsewhere: such a
/// proposal is impossible.
#[derive(Clone, Copy, Debug)]
pub struct WavelengthMutation<'a> {
    /// Where the paths run.
    pub space: &'a PathSpace<'a>,
}

/// Directions that differ by less are the same.
const SAME: f64 = 1e-6;

impl WavelengthMutation<'_> {
    /// Is the path of the kind that this mutation can change?
    pub fn suits(&self, path: &Path) -> bool {
        path.edges() > 0
            && (1..path.edges()).all(|i| !(path.is_specular(i) && path.at(i).dispersive))
    }

    pub(crate) fn redraw<D: Draws + ?Sized>(
        &self,
        x: &Path,
        y: &mut Path,
        draws: &mut D,
    ) -> Option<f64> {
        let space = self.space;
        let n = x.len();
        if !self.suits(x) {
            return None;
        }
        y.resize(n);
        y.copy(0, x, 0..n);
        y.raster = x.raster;
        y.importance = x.importance;
        y.time = x.time;
        y.wavelength_u = draws.uniform();
        y.wavelengths = Wavelengths::sample(y.wavelength_u, space.settings.wavelengths);
        let wavelengths = y.wavelengths;
        for i in 1..n - 1 {
            let vertex = y.at_mut(i);
            (space.scene).write_bsdf(
                &vertex.vertex,
                &wavelengths,
                &vertex.interior,
                &mut vertex.bsdf,
            );
            if vertex.specular && vertex.transmitted {
                let delta = vertex.bsdf.delta(vertex.wo, true, Mode::Radiance);
                if !delta.is_some_and(|delta| (delta.wi - vertex.wi).length() < SAME) {
                    return None;
                }
            }
        }
        for i in 0..n - 1 {
            self.tint(y, i);
            if !space.refresh(y, i) {
                return None;
            }
        }
        space.evaluate(y).then_some(1.0)
    }

    /// What is left of light along the edge of vertex `i`.
    fn tint(&self, y: &mut Path, i: usize) {
        let wavelengths = y.wavelengths;
        let (light, eye) = y.pair(i);
        light.edge.transmittance = (self.space).transmittance_between(light, eye, &wavelengths);
        if self.space.scene.has_panes() {
            light.edge.dim(self.space.passed(light, eye, &wavelengths));
        }
    }
}
