//! States of one picture, added up: shares of a render, renders of other seeds.

use kaustik_film::Average;
use kaustik_scene::Scene;

use crate::check::check;
use crate::engine::Engine;
use crate::methods::settled::settled;
use crate::methods::{direct, engine, start_share};
use crate::state::take_up;
use crate::statistics::{MergeStatistics, MergedPart, Parts};
use crate::threads::pool;
use crate::work::Work;
use crate::{Method, Outcome, RenderError, RenderSettings, Rendered, State, StateError, Watch};

/// Parts count as comparable if the largest has at most so many times the samples of the smallest.
const COMPARABLE: f64 = 4.0;
/// Name of the layer with the standard error of each pixel.
const ERROR: &str = "error";

/// The settings of the render that these states are shares of, with all of their ladders: what a scene for
/// [`merge`] is built for. States of other seeds are renders of their own; the settings are those of the lowest.
///
/// # Errors
/// No states, states of different pictures, ladders that overlap or leave a gap, renders of different ladders.
pub fn merged_settings(states: &[State]) -> Result<RenderSettings, StateError> {
    let renders = renders(states)?;
    match renders.first() {
        Some(render) => render.settings(),
        None => Err(StateError::Shares("there are none".to_owned())),
    }
}

/// The shares of one seed, by ladders.
struct SeedShares<'a> {
    states: Vec<&'a State>,
    ladders: std::ops::Range<u32>,
}

impl SeedShares<'_> {
    fn settings(&self) -> Result<RenderSettings, StateError> {
        Ok(RenderSettings {
            ladders: Some(self.ladders.clone()),
            ..self.states[0].settings()?
        })
    }

    fn seed(&self) -> u64 {
        self.states[0].header().seed()
    }
}

/// The states by seed, which all rise; the order in which they are given does not count.
fn renders(states: &[State]) -> Result<Vec<SeedShares<'_>>, StateError> {
    let mut sorted: Vec<&State> = states.iter().collect();
    let place = |state: &&State| {
        let ladders = state.ladders();
        (state.header().seed(), ladders.start, ladders.end)
    };
    sorted.sort_by_key(place);
    for other in &sorted {
        // Shares of one seed must have the same start, too.
        let of_its_seed = sorted.iter().find(|state| state.seed() == other.seed());
        let same = sorted[0].header().same_but_seed(other.header());
        let same = same.and_then(|()| match of_its_seed {
            Some(first) => first.header().same_picture(other.header()),
            None => Ok(()),
        });
        same.map_err(|error| match error {
            StateError::Other(differences) => {
                StateError::Shares(format!("{differences} ('here' is another of the states)"))
            }
            error => error,
        })?;
    }
    let seeds = sorted.chunk_by(|a, b| a.header().seed() == b.header().seed());
    let renders: Vec<SeedShares<'_>> = seeds.map(shares).collect::<Result<_, _>>()?;
    for pair in renders.windows(2) {
        let [a, b] = [&pair[0], &pair[1]];
        if a.ladders != b.ladders {
            return Err(StateError::Shares(format!(
                "seed {} has the ladders {}..{}, seed {} has {}..{}",
                a.seed(),
                a.ladders.start,
                a.ladders.end,
                b.seed(),
                b.ladders.start,
                b.ladders.end
            )));
        }
    }
    Ok(renders)
}

/// The shares of one seed, if they follow on each other.
fn shares<'a>(states: &[&'a State]) -> Result<SeedShares<'a>, StateError> {
    for pair in states.windows(2) {
        let [a, b] = [pair[0].ladders(), pair[1].ladders()];
        if a.end != b.start {
            let fault = if a.end > b.start {
                "overlap"
            } else {
                "leave a gap"
            };
            return Err(StateError::Shares(format!(
                "the ladders {}..{} and {}..{} {fault}",
                a.start, a.end, b.start, b.end
            )));
        }
    }
    let end = states.last().map_or(0, |state| state.ladders().end);
    Ok(SeedShares {
        states: states.to_vec(),
        ladders: states[0].ladders().start..end,
    })
}

/// The picture of several states. Shares of one render give the picture that one process would have made of all their
/// ladders, to the bit. Renders of other seeds are averaged, each with the weight of its samples.
///
/// Where two parts or more tell of the same pixels by themselves (renders, or shares of a method whose ladders all serve
/// the whole image) and have comparably many samples, the layer `error` holds the standard error of each pixel; if
/// settings ask for features.
///
/// `settings` must be those of [`merged_settings`], except for threads and features. `watch` is only
/// offered the merged state; renders of several seeds have none.
///
/// ```
/// use kaustik::scene::{Scene, builtin};
/// use kaustik::{Budget, Control, Method, RenderSettings, Snapshot, Source, State, Watch};
///
/// /// Keeps the last state.
/// #[derive(Default)]
/// struct Keeper(Vec<u8>);
///
/// impl Watch for Keeper {
///     fn wants_state(&mut self, _: &kaustik::Progress, last: bool) -> bool {
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
/// // Two processes, perhaps on two machines, half of the 64 ladders each.
/// let mut states = Vec::new();
/// for ladders in [0..32, 32..64] {
///     let share = RenderSettings { ladders: Some(ladders), ..settings.clone() };
///     let mut keeper = Keeper::default();
///     kaustik::render_watched(&scene, &share, &mut Control::default(), &mut keeper)?;
///     states.push(State::from_bytes(keeper.0)?);
/// }
/// let both = kaustik::merge(&scene, &kaustik::merged_settings(&states)?, &states, &mut ())?;
/// let one = kaustik::render(&scene, &settings, &mut Control::default())?;
/// assert_eq!(both.image.rgb(), one.image.rgb());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// As [`crate::resume`]; ladders that have gone different ways, where their samples cannot be weighed against each
/// other.
pub fn merge(
    scene: &Scene,
    settings: &RenderSettings,
    states: &[State],
    watch: &mut dyn Watch,
) -> Result<Rendered, RenderError> {
    check(scene, settings)?;
    let settings = &*pool(settings.threads)?.install(|| settled(scene, settings, states.first()));
    let renders = renders(states)?;
    match renders.as_slice() {
        [] => Err(StateError::Shares("there are none".to_owned()).into()),
        [render] => merge_shares(scene, settings, render, settings.features, watch),
        renders => average(scene, settings, renders),
    }
}

/// One render of all of its shares.
struct Merged<'a> {
    work: Work<'a>,
    engine: Box<dyn Engine + 'a>,
    pool: rayon::ThreadPool,
}

impl<'a> Merged<'a> {
    /// Makes the engine of the whole; tells of what it is before anything is taken up.
    fn new(scene: &'a Scene, settings: &'a RenderSettings) -> Result<Self, RenderError> {
        let pool = pool(settings.threads)?;
        let work = Work::new(scene, settings);
        let engine = pool.install(|| engine(scene, settings))?;
        Ok(Self { work, engine, pool })
    }

    fn take_up(&mut self, state: &State, first: bool) -> Result<(), StateError> {
        let (work, engine) = (&mut self.work, self.engine.as_mut());
        (self.pool).install(|| work.take_up(engine, state, first))
    }

    fn outcome(&self) -> Outcome {
        match (self.engine.is_lit(), self.engine.steps()) {
            (false, _) => Outcome::Black,
            // Renders that were stopped before anything was whole.
            (true, 0) => Outcome::Stopped,
            (true, _) => Outcome::Complete,
        }
    }

    fn finish(self) -> Result<Rendered, RenderError> {
        let outcome = self.outcome();
        self.work.finish(self.engine, &self.pool, outcome)
    }
}

/// One picture of the shares of a seed; `tells_spread`: and how far these lie apart, which takes an engine's worth of work.
fn merge_shares(
    scene: &Scene,
    settings: &RenderSettings,
    render: &SeedShares<'_>,
    tells_spread: bool,
    watch: &mut dyn Watch,
) -> Result<Rendered, RenderError> {
    for state in &render.states {
        let share = RenderSettings {
            ladders: Some(state.ladders()),
            ..settings.clone()
        };
        state.check(scene, &share)?;
    }
    let mut merged = Merged::new(scene, settings)?;
    let several = render.states.len() > 1 && tells_spread;
    let apart = match several && tell_alike(settings) {
        true => Some(each_share(&mut merged, render)?),
        false => None,
    };
    for (index, state) in render.states.iter().enumerate() {
        merged.take_up(state, index == 0)?;
    }
    merged.work.begin();
    if watch.wants_state(&merged.work.progress(merged.engine.as_ref()), true) {
        merged.work.show_state(merged.engine.as_ref(), watch);
    }
    let mut rendered = merged.finish()?;
    match apart {
        Some((average, parts)) => tell(
            &mut rendered,
            Parts::Ladders,
            parts,
            average.as_ref(),
            settings,
        )?,
        None if several => {
            let why = "shares of this method are bands of the image";
            rendered.statistics.merged = Some(MergeStatistics::without(Parts::Ladders, why));
        }
        None => {}
    }
    Ok(rendered)
}

/// Does each ladder tell of the whole picture by itself?
fn tell_alike(settings: &RenderSettings) -> bool {
    let alike = matches!(
        settings.method,
        Method::Light
            | Method::Pssmlt
            | Method::Mmlt
            | Method::Relt
            | Method::Mlt
            | Method::Annealing
    );
    // light rendered apart is made in bands
    alike && !direct::is_apart(settings)
}

/// The picture of each share by itself: the engine of the whole with nothing but that share.
fn each_share(
    merged: &mut Merged<'_>,
    render: &SeedShares<'_>,
) -> Result<(Option<Average>, Vec<MergedPart>), RenderError> {
    let nothing = merged.work.snapshot(merged.engine.as_ref()).state()?;
    let mut parts = Vec::new();
    let mut average: Option<Average> = None;
    for state in &render.states {
        merged.alone(&nothing)?;
        merged.alone(state)?;
        let steps = merged.engine.steps();
        let (pool, engine) = (&merged.pool, merged.engine.as_mut());
        let image = pool.install(|| engine.develop())?;
        parts.push(MergedPart::new(
            render.seed(),
            &state.ladders(),
            steps,
            &image,
        ));
        let weight = steps.max(1) as f64;
        match &mut average {
            None => average = Some(Average::of(&image, weight)),
            Some(average) => average.push(&image, weight)?,
        }
    }
    merged.alone(&nothing)?;
    Ok((average, parts))
}

impl Merged<'_> {
    /// Nothing else is in the films, and the clock hears nothing of it.
    fn alone(&mut self, state: &State) -> Result<(), StateError> {
        let engine = self.engine.as_mut();
        (self.pool).install(|| take_up(engine, state, true))
    }
}

/// Renders of several seeds.
fn average(
    scene: &Scene,
    settings: &RenderSettings,
    renders: &[SeedShares<'_>],
) -> Result<Rendered, RenderError> {
    let mut parts = Vec::new();
    let mut all: Option<(Average, Rendered)> = None;
    for render in renders {
        let mut settings = RenderSettings {
            seed: render.seed(),
            ..settings.clone()
        };
        // Each had as much of its start as its own time allowed.
        settings.options.start = start_share::of_state(render.states[0]);
        // The spread of the seeds is told, which holds that of a seed's shares.
        let rendered = merge_shares(scene, &settings, render, false, &mut ())?;
        let steps = rendered.statistics.steps;
        let part = MergedPart::new(render.seed(), &render.ladders, steps, &rendered.image);
        parts.push(part);
        let weight = steps.max(1) as f64;
        match &mut all {
            None => all = Some((Average::of(&rendered.image, weight), rendered)),
            Some((average, whole)) => {
                average.push(&rendered.image, weight)?;
                whole.statistics.add(&rendered.statistics);
                if rendered.outcome == Outcome::Complete {
                    whole.outcome = Outcome::Complete;
                }
            }
        }
    }
    let Some((average, mut rendered)) = all else {
        return Err(StateError::Shares("there are none".to_owned()).into());
    };
    rendered.image = average.image()?;
    tell(&mut rendered, Parts::Seeds, parts, Some(&average), settings)?;
    Ok(rendered)
}

/// Says how far parts lie apart, and shows where.
fn tell(
    rendered: &mut Rendered,
    of: Parts,
    parts: Vec<MergedPart>,
    average: Option<&Average>,
    settings: &RenderSettings,
) -> Result<(), RenderError> {
    let mut statistics = MergeStatistics::new(of, parts, COMPARABLE);
    let error = average.and_then(|average| average.error(ERROR));
    if let Some(layer) = error.filter(|_| statistics.is_told()) {
        statistics.see(&layer);
        if settings.features {
            rendered.image.push_layer(layer)?;
        }
    }
    rendered.statistics.merged = Some(statistics);
    Ok(())
}
