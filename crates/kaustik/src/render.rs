//! The render loop: rounds of work until the budget is spent.

use std::time::{Duration, Instant};

use glam::DVec2;
use kaustik_estimate::Contribution;
use kaustik_film::Image;
use kaustik_path::BuilderSettings;
use kaustik_scene::Scene;

use crate::check::check;
use crate::engine::Engine;
use crate::methods::direct::{self, DirectApart};
use crate::methods::erpt::ErptEngine;
use crate::methods::independent::IndependentEngine;
use crate::methods::mlt::MltEngine;
use crate::methods::photon::PhotonEngine;
use crate::methods::pssmlt::PssmltEngine;
use crate::methods::stages::StagedEngine;
use crate::methods::{annealing, relt};
use crate::state::{Header, take_up};
use crate::threads::pool;
use crate::{
    Budget, Control, Method, Progress, RayStatistics, RenderError, RenderSettings,
    RenderStatistics, Snapshot, State, StateError, features,
};

/// What became of a render.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// The budget is spent.
    Complete,
    /// Stopped from outside; the picture is right for what was done.
    Stopped,
    /// Nothing in the scene brings light to the camera: the picture is black.
    Black,
}

/// A picture and what is to be said about it.
#[derive(Clone, Debug)]
pub struct Rendered {
    /// Linear Rec.709, with feature layers if asked for.
    pub image: Image,
    /// What happened.
    pub statistics: RenderStatistics,
    /// How it ended.
    pub outcome: Outcome,
}

/// Rounds aim at this length: short enough for a lively display, long enough that
/// waiting for the last ladder costs little.
const ROUND: Duration = Duration::from_millis(250);

/// How long a render that was stopped works on albedo, normal and depth.
const PATIENCE: Duration = Duration::from_millis(300);

/// Renders a scene.
///
/// The picture depends on the scene and the settings alone (but for `threads`); with
/// [`Budget::Time`] also on how many rounds fit.
///
/// # Errors
/// Settings out of range or not those that the scene was built for, no memory for the film, no threads,
/// a path builder that does not repeat itself.
pub fn render(
    scene: &Scene,
    settings: &RenderSettings,
    control: &mut Control<'_>,
) -> Result<Rendered, RenderError> {
    render_watched(scene, settings, control, &mut ())
}

/// Observes a render: asked after every round whether it wants the image or the state. `()` wants neither.
pub trait Watch {
    /// Asked after every round: is the image wanted as it is now?
    fn wants_image(&mut self, _progress: &Progress) -> bool {
        false
    }

    /// Gets it: without albedo, normal and depth, with a method's parts if the settings ask for features.
    fn see_image(&mut self, _rendered: Rendered) {}

    /// The pilot is over: from now on there is a state to be kept.
    fn pilot_done(&mut self) {}

    /// Asked after every round, and once more after the `last`: is the state wanted as it is now?
    fn wants_state(&mut self, _progress: &Progress, _last: bool) -> bool {
        false
    }

    /// Gets it.
    fn see_state(&mut self, _snapshot: &Snapshot<'_>) {}
}

impl Watch for () {}

/// As [`render`], showing pictures and states on the way: an error curve takes one render, not one a point.
///
/// Whoever looks changes nothing.
///
/// # Errors
/// As [`render`].
pub fn render_watched(
    scene: &Scene,
    settings: &RenderSettings,
    control: &mut Control<'_>,
    watch: &mut dyn Watch,
) -> Result<Rendered, RenderError> {
    render_from(scene, settings, None, control, watch)
}

/// As [`render_watched`], from where another render was: the picture has the bits of a render that nothing
/// interrupted, for any number of threads. The budget is that of both together and may be larger than the
/// first was. The state, which may be as large as the films, is let go once it is taken up.
///
/// ```
/// use kaustik::scene::{Scene, builtin};
/// use kaustik::{Budget, Control, Method, Progress, RenderSettings, Snapshot, Source, State, Watch};
///
/// /// Keeps the last state.
/// #[derive(Default)]
/// struct Keeper(Vec<u8>);
///
/// impl Watch for Keeper {
///     fn wants_state(&mut self, _: &Progress, last: bool) -> bool {
///         last
///     }
///     fn see_state(&mut self, snapshot: &Snapshot<'_>) {
///         self.0 = snapshot.bytes(&Source::default()).unwrap_or_default();
///     }
/// }
///
/// let settings = RenderSettings {
///     method: Method::Path,
///     width: 8,
///     height: 8,
///     budget: Budget::PerPixel(4),
///     ..RenderSettings::default()
/// };
/// let scene = Scene::new(&builtin::load("cornell")?, &settings.scene_options())?;
/// let mut keeper = Keeper::default();
/// kaustik::render_watched(&scene, &settings, &mut Control::default(), &mut keeper)?;
///
/// // Later, perhaps elsewhere: four samples a pixel more.
/// let state = State::from_bytes(keeper.0)?;
/// let more = RenderSettings {
///     budget: Budget::PerPixel(8),
///     ..state.settings()?
/// };
/// let done = kaustik::resume(&scene, &more, state, &mut Control::default(), &mut ())?;
/// assert_eq!(done.statistics.steps, 8 * 64);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// As [`render_watched`]; a state of another scene, method, setting or share, or a damaged one.
pub fn resume(
    scene: &Scene,
    settings: &RenderSettings,
    state: State,
    control: &mut Control<'_>,
    watch: &mut dyn Watch,
) -> Result<Rendered, RenderError> {
    render_from(scene, settings, Some(state), control, watch)
}

fn render_from(
    scene: &Scene,
    settings: &RenderSettings,
    state: Option<State>,
    control: &mut Control<'_>,
    watch: &mut dyn Watch,
) -> Result<Rendered, RenderError> {
    check(scene, settings)?;
    if let Some(state) = &state {
        state.check(scene, settings)?;
    }
    let pool = pool(settings.threads)?;
    let mut work = Work::new(scene, settings);
    let mut engine = pool.install(|| engine(scene, settings))?;
    if let Some(state) = state {
        pool.install(|| work.take_up(engine.as_mut(), &state, true))?;
    }
    work.begin();
    watch.pilot_done();
    let outcome = work.run(engine.as_mut(), &pool, control, watch)?;
    work.finish(engine, &pool, outcome)
}

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

/// What path builders are told by these settings.
pub(crate) fn builder_settings(settings: &RenderSettings) -> BuilderSettings {
    let bounds = settings.layout().extended_bounds();
    let size = DVec2::new(f64::from(settings.width), f64::from(settings.height));
    BuilderSettings {
        min_edges: direct::min_edges(settings),
        max_edges: settings.max_depth,
        pure_specular: direct::pure_specular(settings),
        emitters_seen: true,
        track_largest: settings.options.contribution == Contribution::Maximum,
        wavelengths: settings.options.wavelengths,
        window_min: DVec2::from(bounds.min) / size,
        window_max: DVec2::from(bounds.max) / size,
    }
}

/// A render at work.
pub(crate) struct Work<'a> {
    scene: &'a Scene,
    settings: &'a RenderSettings,
    start: Instant,
    pilot: Duration,
    /// Sampling of the states that were taken up.
    before: Duration,
    steps: u64,
}

impl<'a> Work<'a> {
    pub(crate) fn new(scene: &'a Scene, settings: &'a RenderSettings) -> Self {
        Self {
            scene,
            settings,
            start: Instant::now(),
            pilot: Duration::ZERO,
            before: Duration::ZERO,
            steps: 0,
        }
    }

    /// Takes up a state; see [`take_up`].
    pub(crate) fn take_up(
        &mut self,
        engine: &mut (dyn Engine + '_),
        state: &State,
        first: bool,
    ) -> Result<(), StateError> {
        take_up(engine, state, first)?;
        self.before += Duration::from_secs_f64(state.seconds());
        self.steps = engine.steps();
        Ok(())
    }

    /// Sampling begins now.
    pub(crate) fn begin(&mut self) {
        self.pilot = self.start.elapsed();
    }

    fn elapsed(&self) -> Duration {
        self.start.elapsed() + self.before
    }

    fn seconds(&self) -> f64 {
        (self.elapsed() - self.pilot).as_secs_f64()
    }

    fn run(
        &mut self,
        engine: &mut (dyn Engine + '_),
        pool: &rayon::ThreadPool,
        control: &mut Control<'_>,
        watch: &mut dyn Watch,
    ) -> Result<Outcome, RenderError> {
        let outcome = if engine.is_lit() {
            self.rounds(engine, pool, control, watch)?
        } else {
            Outcome::Black
        };
        // Before the end makes chains deposit what they hold back.
        if watch.wants_state(&self.progress(engine), true) {
            self.show_state(engine, watch);
        }
        Ok(outcome)
    }

    fn rounds(
        &mut self,
        engine: &mut (dyn Engine + '_),
        pool: &rayon::ThreadPool,
        control: &mut Control<'_>,
        watch: &mut dyn Watch,
    ) -> Result<Outcome, RenderError> {
        let ladders = self.settings.ladder_range();
        let mut done = engine.taken();
        let mut allowed = self.begun(engine, &done);
        let mut chunk = 1;
        loop {
            // Every ladder may have taken `allowed` grains, but no more than planned.
            allowed = u64::saturating_add(allowed, chunk);
            let steps = |(ladder, done): (u32, &u64)| {
                let planned = engine.planned(ladder, self.settings);
                let due = engine.grain(ladder).saturating_mul(allowed);
                planned.min(due).saturating_sub(*done)
            };
            let round_start = Instant::now();
            let plan: Vec<u64> = ladders.clone().zip(&done).map(steps).collect();
            let taken = pool.install(|| engine.advance(&plan, control.stop));
            self.steps += taken;
            done.iter_mut().zip(&plan).for_each(|(done, n)| *done += n);
            let progress = self.progress(engine);
            control.tell(&progress);
            if watch.wants_state(&progress, false) {
                self.show_state(engine, watch);
            }
            if watch.wants_image(&progress) {
                self.show(engine, pool, watch)?;
            }
            if control.stopped() {
                return Ok(Outcome::Stopped);
            }
            if plan.iter().all(|&steps| steps == 0) || self.out_of_time() {
                return Ok(Outcome::Complete);
            }
            // Grow gently toward rounds of the wanted length, never past twice the last.
            let ratio = ROUND.as_secs_f64() / round_start.elapsed().as_secs_f64().max(1e-6);
            chunk = ((chunk as f64 * ratio.clamp(0.5, 2.0)) as u64).max(1);
        }
    }

    /// Grains that all ladders have taken which have steps left to take. In a merged state some may be far ahead: they wait,
    /// and the others catch up round by round.
    fn begun(&self, engine: &dyn Engine, done: &[u64]) -> u64 {
        let unfinished = (self.settings.ladder_range().zip(done))
            .filter(|(ladder, done)| engine.planned(*ladder, self.settings) > **done);
        let grains = |(ladder, done): (u32, &u64)| done / engine.grain(ladder).max(1);
        unfinished.map(grains).min().unwrap_or(0)
    }

    /// The state as it is now.
    pub(crate) fn snapshot<'s>(&self, engine: &'s (dyn Engine + '_)) -> Snapshot<'s> {
        let header = Header::new(self.scene, self.settings, self.seconds());
        Snapshot::new(header, engine)
    }

    pub(crate) fn show_state(&self, engine: &(dyn Engine + '_), watch: &mut dyn Watch) {
        watch.see_state(&self.snapshot(engine));
    }

    /// Shows the picture, and puts back what its chains had to deposit for it.
    fn show(
        &self,
        engine: &mut (dyn Engine + '_),
        pool: &rayon::ThreadPool,
        watch: &mut dyn Watch,
    ) -> Result<(), RenderError> {
        if !engine.holds_back() {
            watch.see_image(pool.install(|| self.rendered(engine, Outcome::Stopped))?);
            return Ok(());
        }
        let kept = self.snapshot(engine).state()?;
        watch.see_image(pool.install(|| self.rendered(engine, Outcome::Stopped))?);
        Ok(pool.install(|| take_up(engine, &kept, true))?)
    }

    /// The picture at the end, with what does not come from the engine.
    pub(crate) fn finish(
        &self,
        mut engine: Box<dyn Engine + '_>,
        pool: &rayon::ThreadPool,
        outcome: Outcome,
    ) -> Result<Rendered, RenderError> {
        let mut rendered = self.rendered(engine.as_mut(), outcome)?;
        // The films are not needed any more, the feature planes are.
        drop(engine);
        if self.settings.features {
            // Whoever stops a render waits for the picture: what is not part of it is left out if it takes long.
            let patience = match outcome {
                Outcome::Stopped => PATIENCE,
                Outcome::Complete | Outcome::Black => Duration::MAX,
            };
            let layers = pool.install(|| features::layers(self.scene, self.settings, patience));
            for layer in layers.into_iter().flatten() {
                rendered.image.push_layer(layer)?;
            }
        }
        Ok(rendered)
    }

    /// The picture so far and what is to be said about it.
    fn rendered(
        &self,
        engine: &mut (dyn Engine + '_),
        outcome: Outcome,
    ) -> Result<Rendered, RenderError> {
        let seconds = self.seconds();
        let mut image = engine.develop()?;
        let (nonfinite, mut nonfinite_places) = engine.nonfinite();
        nonfinite_places.truncate(RenderStatistics::MOST_PLACES);
        let settings = self.settings;
        let statistics = RenderStatistics {
            method: settings.method.to_string(),
            seed: settings.seed,
            ladders: settings.options.ladders,
            steps: self.steps,
            per_pixel: self.steps as f64 / settings.pixels() as f64,
            seconds,
            pilot_seconds: self.pilot.as_secs_f64(),
            nonfinite,
            nonfinite_places,
            rays: engine.rays().map(|rays| RayStatistics {
                closest: rays.closest,
                any: rays.any,
            }),
            film: engine.film_counters(),
            chain: engine.chain_statistics(),
            direct: engine.direct_statistics(),
            replicas: engine.replica_statistics(),
            mutations: engine.mutation_statistics(),
            energy: engine.energy_statistics(),
            photons: engine.photon_statistics(),
            stages: engine.stage_statistics(),
            merged: None,
        };
        if settings.features {
            for layer in engine.layers()? {
                image.push_layer(layer)?;
            }
        }
        Ok(Rendered {
            image,
            statistics,
            outcome,
        })
    }

    fn out_of_time(&self) -> bool {
        matches!(self.settings.budget, Budget::Time(limit) if self.elapsed() >= limit)
    }

    pub(crate) fn progress(&self, engine: &dyn Engine) -> Progress {
        let elapsed = self.elapsed();
        let fraction = match self.settings.budget {
            Budget::Time(limit) => elapsed.as_secs_f64() / limit.as_secs_f64().max(1e-9),
            Budget::PerPixel(_) | Budget::Total(_) => {
                let ladders = self.settings.ladder_range();
                let planned = ladders.map(|ladder| engine.planned(ladder, self.settings));
                let planned = planned.fold(0, u64::saturating_add);
                self.steps as f64 / planned.max(1) as f64
            }
        };
        let fraction = fraction.clamp(0.0, 1.0);
        let sampling = self.seconds();
        let chain = engine.chain_statistics();
        Progress {
            fraction,
            elapsed,
            remaining: match self.settings.budget {
                Budget::Time(limit) => limit.saturating_sub(elapsed),
                Budget::PerPixel(_) | Budget::Total(_) => Duration::from_secs_f64(
                    (sampling * (1.0 - fraction) / fraction.max(1e-9)).min(1e9),
                ),
            },
            steps: self.steps,
            rate: self.steps as f64 / sampling.max(1e-9),
            acceptance: chain.map(|c| [c.small_acceptance, c.large_acceptance]),
            normalisation: chain.map(|c| [c.normalisation, c.normalisation_error]),
        }
    }
}
