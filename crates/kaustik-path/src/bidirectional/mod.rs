//! Bidirectional path tracing (Lafortune and Willems 1993, Veach 1997 ch. 10).

mod eye;
mod form;
mod heuristic;
mod join;
mod joined;
mod light;
mod multiplexed;
mod running;
mod subpath_walk;
mod technique_spread;
mod techniques;
mod vertex;
mod weights;
mod witness;
mod workspace;

#[cfg(test)]
mod tests;

use kaustik_pss::{Coordinates, Stream};
use kaustik_scene::Scene;
use kaustik_spectrum::Wavelengths;

pub use form::Form;
pub(crate) use form::ONWARD;
pub use heuristic::Heuristic;
pub use multiplexed::Multiplexed;
pub use technique_spread::TechniqueSpread;
pub use techniques::{Technique, Techniques};

use crate::contributions::Gathered;
use crate::instant::at_its_time;
use crate::{BuilderSettings, Contributions, PathBuilder, layout};
use eye::OtherEnd;
use weights::Weights;
use witness::Witness;
use workspace::Workspace;

/// Walks from an emitter and from the camera, joined in every way that makes a path of at most
/// [`BuilderSettings::max_edges`] edges.
///
/// A strategy `(s, t)` takes `s` vertices from the light and `t` from the eye. All are used:
/// `s = 0` runs into an emitter, `s = 1` draws a fresh point of an emitter for
/// each vertex of the eye, `t = 1` joins a vertex of the light to the lens, `t = 0` with
/// `s >= 3` runs into a lens that has area (the lens blocks nothing), all others join two vertices.
/// Left out are (1, 1) and (2, 0), so that (0, 2), an emitter seen directly, has weight 1.
///
/// Weights take the densities of all strategies of the path into account ([`Heuristic`]); roulette
/// is not part of them. A shadow ray is traced only where the weighted contribution without
/// it is not zero. A camera with parallel rays has a lens at infinity: `t = 1` projects onto it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bidirectional {
    /// What all builders are told.
    pub settings: BuilderSettings,
    /// Which vertices are joined.
    pub form: Form,
    /// How strategies share a path.
    pub heuristic: Heuristic,
}

impl PathBuilder for Bidirectional {
    fn build(&self, scene: &Scene, u: &mut dyn Coordinates, out: &mut Contributions) {
        at_its_time(scene, u, |scene, u| {
            Workspace::with(|workspace| self.evaluate(scene, u, out, workspace, &mut ()));
        });
    }
}

/// What stays the same through one evaluation.
#[derive(Clone, Copy, Debug)]
struct Job<'a> {
    builder: &'a Bidirectional,
    scene: &'a Scene,
    wavelengths: &'a Wavelengths,
    /// Density of a raster point: one over the window's area.
    raster_pdf: f64,
    /// Walks of no length given beforehand end by it.
    roulette: bool,
}

impl Bidirectional {
    fn evaluate(
        &self,
        scene: &Scene,
        u: &mut dyn Coordinates,
        out: &mut Contributions,
        workspace: &mut Workspace,
        witness: &mut impl Witness,
    ) {
        out.clear();
        let sampling = self.settings.wavelengths;
        let wavelengths = Wavelengths::sample(u.get(Stream::Wavelength, 0), sampling);
        let job = Job {
            builder: self,
            scene,
            wavelengths: &wavelengths,
            raster_pdf: self.settings.raster_pdf(),
            roulette: true,
        };
        match self.form {
            Form::Full => job.full(u, out, workspace, witness),
            Form::Simple => job.simple(u, out, workspace, witness),
        }
    }
}

impl Job<'_> {
    #[inline]
    fn weights(&self) -> Weights {
        Weights {
            form: self.builder.form,
            heuristic: self.builder.heuristic,
        }
    }

    fn full(
        &self,
        u: &mut dyn Coordinates,
        out: &mut Contributions,
        workspace: &mut Workspace,
        witness: &mut impl Witness,
    ) {
        light::trace(self, u, &mut workspace.light, true, out, witness);
        let mut gathered = Gathered::new(self.wavelengths, self.builder.settings.track_largest);
        let other = OtherEnd::Any;
        let raster = eye::trace(self, u, workspace, other, &mut gathered, witness);
        out.merge(raster, &gathered);
    }

    fn simple(
        &self,
        u: &mut dyn Coordinates,
        out: &mut Contributions,
        workspace: &mut Workspace,
        witness: &mut impl Witness,
    ) {
        let form = self.builder.form;
        let mut stops = |index, onward: f64| u.get(Stream::Technique, index) >= onward;
        let at_lens = stops(layout::STOP_AT_LENS, form.at_lens().onward);
        let at_emitter = stops(layout::STOP_AT_EMITTER, form.at_emitter().onward);
        let other = if at_emitter {
            OtherEnd::Emitter
        } else if light::trace(self, u, &mut workspace.light, at_lens, out, witness) {
            OtherEnd::Last
        } else {
            OtherEnd::None
        };
        if at_lens {
            return;
        }
        let mut gathered = Gathered::new(self.wavelengths, self.builder.settings.track_largest);
        let raster = eye::trace(self, u, workspace, other, &mut gathered, witness);
        out.merge(raster, &gathered);
    }
}
