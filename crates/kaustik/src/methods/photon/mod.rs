//! Photon methods (Hachisuka and Jensen 2009, 2011; Gruson et al. 2016, "G"): iterations of new measurement points
//! and light paths that look for them, and path tracing of what photons cannot carry.
//!
//! An iteration is whole or it is not: `--time` ends a render between two, and one that is stopped within an iteration
//! gives it up, as if it had not begun it. All ladders share the points of an iteration, so that a process runs all of
//! them; independent renders may be averaged instead.

mod chains;
mod density;
mod maps;
mod sppm;
mod stage;
mod targets;

use std::io;
use std::sync::atomic::AtomicBool;

use kaustik_estimate::{PhotonLevels, PhotonTargetKind};
use kaustik_film::{Counters, Film, Image, Layer};
use kaustik_path::Event;
use kaustik_scene::Scene;

use crate::control::is_stopped;
use crate::engine::{Engine, add_counters, add_nonfinite};
use crate::methods::independent::IndependentEngine;
use crate::state::{Keep, Reader, StateError, Writer};
use crate::{
    Budget, ChainStatistics, LadderSize, Method, PhotonStatistics, RenderError, RenderSettings,
    StepId,
};
use chains::PhotonChains;
use sppm::IndependentPhotons;
use stage::{Place, Stage};
use targets::Space;

/// Passes of the remainder for each iteration.
const PASSES: u64 = 2;
/// Turns the seed of the photons into another one.
const SEED: u64 = 0x5E3D_0F1B_9C27_A684;

/// How the light paths of an iteration are drawn, and where what they bring is kept.
trait Tracer: Send + Sync {
    /// Traces the light paths of the iteration that the stage has begun, with a film beside its own that
    /// nobody needs meanwhile; it is black, and may be left as it comes. `false`: it was stopped before it
    /// had traced them all, and is as it was before.
    fn trace(&mut self, stage: &Stage<'_>, spare: &mut Film, stop: Option<&AtomicBool>) -> bool;

    /// The iteration of this place, where light paths follow from those of the iterations before; `None`
    /// where they follow from their number.
    fn iteration(&self, _: &Stage<'_>, _: StepId) -> Option<u64> {
        None
    }

    /// Tells what happens in the light path of this place, of a tracer and a stage that have just been made,
    /// or have come to its [iteration](Self::iteration), which the stage has begun. With a film as
    /// [`trace`](Self::trace) has it.
    fn replay(&mut self, stage: &mut Stage<'_>, spare: &mut Film, place: StepId) -> Vec<Event>;

    /// Writes what there is between two iterations, beyond what is made anew.
    fn write(&self, out: &mut Writer<'_>) -> io::Result<()>;

    /// Takes it up, after so many iterations.
    fn take_up(&mut self, from: &mut Reader<'_>, iterations: u64) -> Result<(), StateError>;

    /// Adds the light of all iterations to a picture.
    fn add_to(&mut self, stage: &Stage<'_>, image: &mut Image) -> Result<(), RenderError>;

    /// Pictures of what chains follow, if they were asked for.
    fn layers(&self, _: &Stage<'_>) -> Vec<Layer> {
        Vec::new()
    }

    fn chain_statistics(&self) -> Option<ChainStatistics> {
        None
    }

    fn photon_statistics(&self) -> Option<PhotonStatistics> {
        None
    }

    fn nonfinite(&self) -> (u64, Vec<StepId>);

    fn film_counters(&self) -> Counters;
}

/// A photon method at work. A step is a light path.
pub(crate) struct PhotonEngine<'a> {
    stage: Stage<'a>,
    tracer: Box<dyn Tracer>,
    remainder: IndependentEngine<'a>,
    /// Steps of each ladder for one round of the remainder.
    passes: Vec<u64>,
    /// The stage has begun an iteration that was not traced yet.
    ready: bool,
    /// The picture has layers of the last iteration's points.
    maps: bool,
}

/// What traces the light paths of a method.
fn tracer(
    scene: &Scene,
    stage: &Stage<'_>,
    settings: &RenderSettings,
) -> Result<Box<dyn Tracer>, RenderError> {
    let space = match settings.method {
        Method::PhotonImage => {
            let [low, sides] = window(settings);
            Space::Image(low, sides)
        }
        _ => Space::World,
    };
    use PhotonTargetKind::{Full, InverseKernel, Uniform, Visibility};
    match (settings.method, settings.options.photon.levels) {
        (Method::PhotonDensity, _) => {
            let space = Space::Densities(density::pilot(scene, settings));
            chains(stage, settings, [Uniform, InverseKernel], space)
        }
        (Method::PhotonVisibility, _) => chains(stage, settings, [Uniform, Visibility], space),
        (Method::PhotonSpatial | Method::PhotonImage, LadderSize::Two) => {
            chains(stage, settings, [Uniform, Full], space)
        }
        (Method::PhotonSpatial | Method::PhotonImage, LadderSize::Three) => {
            chains(stage, settings, [Uniform, InverseKernel, Full], space)
        }
        (Method::PhotonSpatial | Method::PhotonImage, LadderSize::Four) => {
            chains(stage, settings, PhotonTargetKind::ALL, space)
        }
        _ => Ok(Box::new(IndependentPhotons::new(stage, settings)?)),
    }
}

/// First corner and sides of the window that is rendered, in the unit square over the whole image.
fn window(settings: &RenderSettings) -> [[f64; 2]; 2] {
    let window = settings.layout().crop;
    let whole = [settings.width, settings.height].map(f64::from);
    let of_whole = |[x, y]: [u32; 2]| [f64::from(x) / whole[0], f64::from(y) / whole[1]];
    [[window.x0, window.y0], [window.width(), window.height()]].map(of_whole)
}

fn chains<const K: usize>(
    stage: &Stage<'_>,
    settings: &RenderSettings,
    levels: [PhotonTargetKind; K],
    space: Space,
) -> Result<Box<dyn Tracer>, RenderError> {
    let chains = PhotonChains::new(stage, settings, PhotonLevels(levels), space)?;
    Ok(Box::new(chains))
}

impl<'a> PhotonEngine<'a> {
    pub(crate) fn new(scene: &'a Scene, settings: &RenderSettings) -> Result<Self, RenderError> {
        let mut stage = Stage::new(scene, settings);
        stage.begin(None);
        let tracer = tracer(scene, &stage, settings)?;
        let mut of_remainder = RenderSettings {
            seed: settings.seed ^ SEED,
            ..settings.clone()
        };
        if !settings.options.photon.remainder {
            of_remainder.max_depth = 1;
        }
        let remainder = IndependentEngine::remainder(scene, &of_remainder)?;
        let ladders = 0..settings.options.ladders;
        Ok(Self {
            passes: ladders.map(|l| PASSES * remainder.grain(l)).collect(),
            stage,
            tracer,
            remainder,
            ready: true,
            maps: settings.options.photon.maps,
        })
    }

    /// Iterations that were traced.
    fn done(&self) -> u64 {
        self.stage.iterations - u64::from(self.ready)
    }

    /// Sees to it that the stage has begun an iteration that was not traced yet.
    fn begin(&mut self) {
        self.ready = self.ready || self.stage.begin(None);
    }

    /// One iteration. `false`: it was stopped, and all is as it was before.
    fn iterate(&mut self, stop: Option<&AtomicBool>) -> bool {
        let (ready, before) = (std::mem::take(&mut self.ready), self.stage.place());
        let whole = (ready || self.stage.begin(stop)) && self.trace(stop);
        if !whole {
            self.ready = ready;
            if !ready {
                self.stage.stand_at(before, self.maps);
            }
        }
        whole
    }

    /// What is left of an iteration once it has points. What photons cannot carry comes first: to take it back is all
    /// that is to be done where the photons are stopped.
    fn trace(&mut self, stop: Option<&AtomicBool>) -> bool {
        let steps = self.passes.iter().sum::<u64>();
        if self.remainder.advance(&self.passes, stop) < steps {
            return false;
        }
        let whole = self.photons(stop);
        if !whole {
            self.remainder.take_back();
        }
        whole
    }

    /// The light paths of an iteration. What is to be rendered beside them rests, and lends them its film.
    fn photons(&mut self, stop: Option<&AtomicBool>) -> bool {
        let Self { stage, tracer, .. } = self;
        (self.remainder).lend(|spare| tracer.trace(stage, spare, stop))
    }
}

impl Engine for PhotonEngine<'_> {
    fn advance(&mut self, plan: &[u64], stop: Option<&AtomicBool>) -> u64 {
        let steps = plan.iter().sum::<u64>();
        let mut taken = 0;
        while taken < steps && !is_stopped(stop) && self.iterate(stop) {
            taken += self.stage.photons;
        }
        taken
    }

    /// Whole iterations, on the account of the first ladder.
    fn planned(&self, ladder: u32, settings: &RenderSettings) -> u64 {
        let photons = self.stage.photons;
        let iterations = match settings.budget {
            _ if ladder > 0 => 0,
            Budget::PerPixel(n) => n,
            Budget::Total(n) => (n / photons).max(u64::from(n > 0)),
            Budget::Time(_) => u64::MAX / photons,
        };
        iterations.saturating_mul(photons)
    }

    fn grain(&self, ladder: u32) -> u64 {
        if ladder > 0 { 1 } else { self.stage.photons }
    }

    fn develop(&mut self) -> Result<Image, RenderError> {
        self.remainder.forget_marks();
        let mut image = self.remainder.picture()?;
        self.tracer.add_to(&self.stage, &mut image)?;
        Ok(image)
    }

    fn holds_back(&self) -> bool {
        false
    }

    fn chain_statistics(&self) -> Option<ChainStatistics> {
        self.tracer.chain_statistics()
    }

    fn photon_statistics(&self) -> Option<PhotonStatistics> {
        self.tracer.photon_statistics()
    }

    fn layers(&self) -> Result<Vec<Layer>, RenderError> {
        let planes = self.remainder.picture()?.into_rgb();
        let channels = ["R", "G", "B"].into_iter().zip(planes);
        let mut layers = vec![Layer::new("remainder", channels.collect())];
        layers.extend(self.tracer.layers(&self.stage));
        Ok(layers)
    }

    fn nonfinite(&self) -> (u64, Vec<StepId>) {
        let (count, places) =
            add_nonfinite(self.tracer.nonfinite(), Some(self.remainder.nonfinite()));
        // Camera walks are no steps, and have no place.
        (count + self.stage.nonfinite(), places)
    }

    /// The light path at this place, with the sample there of what photons cannot carry.
    fn replay(&mut self, place: StepId) -> Result<Vec<Event>, RenderError> {
        if let Some(iteration) = self.tracer.iteration(&self.stage, place) {
            while self.done() < iteration {
                self.begin();
                self.ready = false;
                self.photons(None);
            }
            self.begin();
        }
        let Self { stage, tracer, .. } = self;
        let mut events = (self.remainder).lend(|spare| tracer.replay(stage, spare, place));
        events.extend(self.remainder.replay(place)?);
        Ok(events)
    }

    fn ahead(&self, place: StepId) -> Option<u64> {
        let iteration = self.tracer.iteration(&self.stage, place);
        iteration.map_or(Some(0), |iteration| iteration.checked_sub(self.done()))
    }

    fn film_counters(&self) -> Counters {
        add_counters(self.tracer.film_counters(), self.remainder.film_counters())
    }

    fn is_lit(&self) -> bool {
        self.remainder.is_lit()
    }
}

/// What photons have brought and chains have learnt; the points of the last iteration are made anew.
impl Keep for PhotonEngine<'_> {
    /// On the account of the first ladder.
    fn taken(&self) -> Vec<u64> {
        let mut taken = vec![0; self.passes.len()];
        if let Some(first) = taken.first_mut() {
            *first = self.done() * self.stage.photons;
        }
        taken
    }

    fn write(&self, out: &mut Writer<'_>) -> io::Result<()> {
        let place = Place {
            iterations: self.done(),
            ..self.stage.place()
        };
        out.value(&place)?;
        self.tracer.write(out)?;
        self.remainder.write(out)
    }

    fn take_up(&mut self, from: &mut Reader<'_>) -> Result<(), StateError> {
        let place: Place = from.value()?;
        self.stage.go_to(place)?;
        let iterations = place.iterations;
        self.ready = iterations == 0;
        self.tracer.take_up(from, iterations)?;
        self.remainder.take_up(from)?;
        let due = self
            .passes
            .iter()
            .map(|steps| steps.saturating_mul(iterations));
        if !due.eq(self.remainder.taken()) {
            return Err(StateError::damaged(
                "what photons cannot carry does not keep up with them",
            ));
        }
        Ok(())
    }
}
