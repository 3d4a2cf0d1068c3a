//! Rendering a scene: in one call, watched, or from a state.

use kaustik_film::Image;
use kaustik_scene::Scene;

use crate::check::check;
use crate::methods::engine;
use crate::methods::settled::settled;
use crate::threads::pool;
use crate::work::Work;
use crate::{Control, Progress, RenderError, RenderSettings, RenderStatistics, Snapshot, State};

/// What became of a render.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// The budget is spent.
    Complete,
    /// Stopped from outside; the picture is right for what was done.
    Stopped,
    /// Nothing that was tried brings light to the camera: the picture is black.
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

/// Renders a scene.
///
/// The picture depends on the scene and the settings alone (but for `threads`); with
/// [`Budget::Time`](crate::Budget::Time) also on how many rounds fit.
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

    /// Receives the image, without albedo, normal and depth, but with the method's own layers if features
    /// are enabled.
    fn see_image(&mut self, _rendered: Rendered) {}

    /// The image that was wanted could not be made; the render goes on.
    fn image_failed(&mut self, _error: RenderError) {}

    /// The pilot is over: from now on there is a state to be kept.
    fn pilot_done(&mut self) {}

    /// Asked after every round, and once more after the `last`: is the state wanted as it is now?
    fn wants_state(&mut self, _progress: &Progress, _last: bool) -> bool {
        false
    }

    /// Receives the state.
    fn see_state(&mut self, _snapshot: &Snapshot<'_>) {}
}

impl Watch for () {}

/// As [`render`], showing pictures and states on the way: an error curve takes one render, not one a point.
///
/// Watching does not affect the result.
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
    let pool = pool(settings.threads)?;
    let settings = &*pool.install(|| settled(scene, settings, state.as_ref()));
    if let Some(state) = &state {
        state.check(scene, settings)?;
    }
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
