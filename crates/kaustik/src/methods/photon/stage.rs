//! What an iteration of a photon method stands on: its wavelengths, measurement points, and their lookup.

use std::ops::Range;
use std::sync::atomic::AtomicBool;

use glam::{DVec2, Vec3};
use kaustik_estimate::{PhotonMap, Scale};
use kaustik_film::{Film, Quantum};
use kaustik_mcmc::{Draws, Independent, Mean, SampleGenerators};
use kaustik_path::{
    Disc, Lookup, MeasurementPoint, MeasurementPoints, MeasurementWalk, PhotonPath, PhotonTracing,
};
use kaustik_scene::Scene;
use kaustik_spectrum::{WavelengthSampling, Wavelengths};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::control::is_stopped;
use crate::methods::builders::builder_settings;
use crate::sampling::cells::Cells;
use crate::sampling::stratified::mix;
use crate::sampling::streams;
use crate::state::{Reader, StateError};
use crate::{RenderError, RenderSettings};

/// Cells whose points one thread makes at a time.
const CHUNK: u64 = 512;
/// Chunks that are made before they are put together: what this takes beside the points themselves is bounded.
const BATCH: u64 = 64;
/// The golden ratio less one: its multiples fill the unit interval evenly.
const GOLDEN: f64 = 0.618_033_988_749_894_9;
/// Quarters of the unit interval in an order of which any two in a row are far apart.
const QUARTERS: [f64; 4] = [0.0, 2.0, 1.0, 3.0];
/// The root of two less one: with the golden ratio's, its multiples fill the unit square evenly.
const SILVER: f64 = std::f64::consts::SQRT_2 - 1.0;
/// A look at what moves sees so many instants, spread evenly.
const INSTANTS: u64 = 16;
/// A look at where things are takes about so many walks at most: 32 for each leaf that a tree can have.
const MOST_LOOKS: u64 = 1 << 20;
/// Light paths that tell how bright photons are.
const PILOT: u64 = 1024;
/// So many more at a time, where none of them lands anywhere,
const MORE_PILOT: u64 = 1 << 15;
/// and about so many at most.
const MOST_PILOT: u64 = 1 << 20;

/// How far a stage has come.
#[derive(Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct Place {
    /// Begun so far.
    pub(super) iterations: u64,
    /// Of the last one's discs.
    pub(super) radius: f64,
    /// Camera walks that left no point because they carried no finite number.
    pub(super) nonfinite: u64,
}

/// One iteration after the other.
pub(super) struct Stage<'a> {
    scene: &'a Scene,
    /// The same at the time of the iteration, where something moves.
    instant: Option<Scene>,
    pub(super) tracing: PhotonTracing,
    pub(super) scale: Scale,
    pub(super) seed: u64,
    /// Light paths an iteration.
    pub(super) photons: u64,
    /// Iterations begun so far.
    pub(super) iterations: u64,
    /// Camera walks in them that carried no finite number: they left no point.
    nonfinite: u64,
    walk: MeasurementWalk,
    cells: Cells,
    generators: SampleGenerators,
    sampling: WavelengthSampling,
    /// Of the first iteration, in [0, 1).
    first_wavelength: f64,
    wavelengths: Wavelengths,
    /// Of the first iteration, in [0, 1).
    first_time: f64,
    points: MeasurementPoints,
    lookup: Lookup,
    parts: Vec<MeasurementPoints>,
    reduction: Option<f64>,
    /// Raster area of a cell in pixels.
    cell_area: f64,
}

impl<'a> Stage<'a> {
    pub(super) fn new(scene: &'a Scene, settings: &RenderSettings) -> Self {
        let options = settings.options;
        let builder = builder_settings(settings);
        let cells = Cells::new(settings);
        let generators = SampleGenerators::new(settings.seed, streams::CAMERA);
        let mut first = generators.at(u64::MAX);
        let [first_wavelength, first_time] = [first.uniform(), first.uniform()];
        let size = DVec2::new(f64::from(settings.width), f64::from(settings.height));
        Self {
            scene,
            instant: scene.moves().then(|| scene.at(first_time)),
            tracing: PhotonTracing {
                max_edges: settings.max_depth,
            },
            scale: settings.scale(),
            seed: settings.seed,
            photons: settings.photons(),
            iterations: 0,
            nonfinite: 0,
            walk: MeasurementWalk {
                settings: builder,
                threshold: options.photon.roughness,
                pixels: size,
                radius: options.photon.radius,
            },
            cells,
            generators,
            sampling: options.wavelengths,
            first_wavelength,
            wavelengths: Wavelengths::sample(first_wavelength, options.wavelengths),
            first_time,
            points: MeasurementPoints::default(),
            lookup: Lookup::default(),
            parts: vec![MeasurementPoints::default(); BATCH as usize],
            reduction: options.photon.reduction,
            cell_area: settings.layout().extended_bounds().area() / cells.count() as f64,
        }
    }

    /// The scene at the time of the iteration: points and photons meet there.
    #[inline]
    pub(super) fn scene(&self) -> &Scene {
        self.instant.as_ref().unwrap_or(self.scene)
    }

    /// Does anything move from one iteration to another?
    pub(super) fn moves(&self) -> bool {
        self.scene.moves()
    }

    /// Sees the scene anew: other wavelengths, another time, other points of every pixel, and smaller discs
    /// if these shrink. `false`: it was stopped, and has no points; it must [go back](Self::stand_at).
    pub(super) fn begin(&mut self, stop: Option<&AtomicBool>) -> bool {
        let index = self.iterations;
        self.shrink(index);
        let seen = self.see(index, stop);
        if seen {
            self.nonfinite += self.points.nonfinite();
        }
        seen
    }

    /// Sees it as in the iteration of this number, which is not before the last that was begun.
    pub(super) fn begin_at(&mut self, iteration: u64) {
        if iteration < self.iterations {
            return;
        }
        (self.iterations..=iteration).for_each(|index| self.shrink(index));
        self.see(iteration, None);
    }

    /// Discs of the iteration of this number, from those before it.
    fn shrink(&mut self, index: u64) {
        if let (Some(alpha), true) = (self.reduction, index > 0) {
            // r_{i+1}^2 = r_i^2 (i + alpha) / (i + 1), i >= 1
            let i = index as f64;
            self.walk.radius *= ((i + alpha) / (i + 1.0)).sqrt();
        }
    }

    /// As it was at a place after whole iterations. Refuses what cannot be.
    pub(super) fn go_to(&mut self, place: Place) -> Result<(), StateError> {
        let steps = self.photons.max(self.cells.count());
        Reader::count(place.iterations.saturating_mul(steps))?;
        Reader::count(place.nonfinite)?;
        // discs never grow, and shrink by chains of roots
        if !(place.radius > 0.0 && place.radius <= self.walk.radius) {
            return Err(StateError::damaged("discs have an impossible radius"));
        }
        if place.iterations > 0 && place != self.place() {
            self.stand_at(place, true);
        }
        Ok(())
    }

    pub(super) fn place(&self) -> Place {
        Place {
            iterations: self.iterations,
            radius: self.walk.radius,
            nonfinite: self.nonfinite,
        }
    }

    /// Stands at a place, as when it takes back an iteration. The next one has new points: those of the last
    /// are made again only if somebody wants to see them.
    pub(super) fn stand_at(&mut self, place: Place, points: bool) {
        self.walk.radius = place.radius;
        (self.iterations, self.nonfinite) = (place.iterations, place.nonfinite);
        if points && place.iterations > 0 {
            self.see(place.iterations - 1, None);
        }
    }

    /// Camera walks of all iterations that carried no finite number.
    pub(super) fn nonfinite(&self) -> u64 {
        self.nonfinite
    }

    /// The iteration of this number; `false` if it was stopped before it was seen.
    fn see(&mut self, index: u64, stop: Option<&AtomicBool>) -> bool {
        self.iterations = index + 1;
        let turned = turn(self.first_wavelength, index, self.sampling);
        self.wavelengths = Wavelengths::sample(turned, self.sampling);
        if self.scene.moves() {
            let turned = self.first_time + SILVER * index as f64;
            self.instant = Some(self.scene.at(turned - turned.floor()));
        }
        if !self.look(index, stop) {
            return false;
        }
        self.points.sort_into(&mut self.lookup);
        true
    }

    /// One walk a cell, put together in the order of the cells; `false` if it was stopped.
    fn look(&mut self, index: u64, stop: Option<&AtomicBool>) -> bool {
        let count = self.cells.count();
        self.points.clear();
        self.points.reserve(count as usize);
        let mut parts = std::mem::take(&mut self.parts);
        for batch in (0..count).step_by((CHUNK * BATCH) as usize) {
            let (this, first) = (&*self, batch / CHUNK);
            parts.par_iter_mut().enumerate().for_each(|(at, part)| {
                part.clear();
                if is_stopped(stop) {
                    return;
                }
                let start = (first + at as u64) * CHUNK;
                for cell in start..(start + CHUNK).min(count) {
                    this.measure(cell, index, part);
                }
            });
            for part in &parts {
                self.points.append(part);
            }
            if is_stopped(stop) {
                break;
            }
        }
        self.parts = parts;
        !is_stopped(stop)
    }

    fn measure(&self, cell: u64, index: u64, out: &mut MeasurementPoints) {
        self.measure_in(self.scene(), cell, index, out);
    }

    /// In the scene at some instant.
    fn measure_in(&self, scene: &Scene, cell: u64, index: u64, out: &mut MeasurementPoints) {
        let inner = Independent::new(self.generators.at(index * self.cells.count() + cell));
        let mut coordinates = (self.cells).confine((cell, index), mix(self.seed), inner);
        (self.walk).trace(scene, &self.wavelengths, &mut coordinates, out);
    }

    /// Points from so many walks a cell, by what `of` takes of them, for nothing but a look at where things
    /// are. Of a large image some cells are left out, evenly. What moves is seen all along its way: walks are
    /// at instants in turn.
    pub(super) fn pilot<T: Send + Clone>(
        &self,
        passes: u64,
        of: impl Fn(&Disc, &MeasurementPoint) -> T + Sync,
    ) -> Vec<T> {
        let instants = self.instants();
        let stride = (self.cells.count() * passes).div_ceil(MOST_LOOKS).max(1);
        let walks = self.cells.count().div_ceil(stride);
        let chunks = (0..walks.div_ceil(CHUNK)).into_par_iter();
        let positions = |points: &mut MeasurementPoints, chunk: u64| {
            points.clear();
            for walk in chunk * CHUNK..((chunk + 1) * CHUNK).min(walks) {
                for pass in 0..passes {
                    // far from the indices that iterations will have
                    let scene = self.in_turn(&instants, walk * passes + pass);
                    self.measure_in(
                        scene,
                        walk * stride,
                        u64::MAX / self.cells.count() / 2 + pass,
                        points,
                    );
                }
            }
            let discs = points.discs().iter().zip(points.points());
            discs
                .map(|(disc, point)| of(disc, point))
                .collect::<Vec<T>>()
        };
        let found: Vec<Vec<T>> = chunks
            .map_init(MeasurementPoints::default, positions)
            .collect();
        found.concat()
    }

    /// The scene at times that are spread evenly over all; none where nothing moves.
    fn instants(&self) -> Vec<Scene> {
        let count = if self.scene.moves() { INSTANTS } else { 0 };
        let time = |index: u64| (index as f64 + 0.5) / INSTANTS as f64;
        (0..count).map(|index| self.scene.at(time(index))).collect()
    }

    /// One of the instants, each as often as the others, by a hash of `number`.
    fn in_turn<'s>(&'s self, instants: &'s [Scene], number: u64) -> &'s Scene {
        // The number's own bits would go with columns of the picture.
        let turn = mix(number) % INSTANTS;
        instants.get(turn as usize).unwrap_or(self.scene)
    }

    pub(super) fn map(&self) -> PhotonMap<'_> {
        PhotonMap {
            points: &self.points,
            lookup: &self.lookup,
            wavelengths: &self.wavelengths,
            max_edges: self.tracing.max_edges,
        }
    }

    pub(super) fn wavelengths(&self) -> &Wavelengths {
        &self.wavelengths
    }

    /// Raster area of a cell in pixels.
    pub(super) fn cell_area(&self) -> f64 {
        self.cell_area
    }

    /// What turns sums over whole iterations, of light paths that each weigh one, into a picture.
    pub(super) fn factor(&self) -> f64 {
        let paths = self.photons as f64 * self.iterations.max(1) as f64;
        self.cell_area / paths
    }

    /// The power of photons of uniform light paths, in the mean over the wavelengths; of what moves at many instants. Where none of the
    /// first lands anywhere and something could be lit, more are looked at until one does.
    pub(super) fn power(&self) -> Mean {
        let mut looked = PILOT;
        let mut power: Mean = self.powers(0..PILOT).into_iter().collect();
        let could_be_lit = !self.points.discs().is_empty();
        while power.count() == 0 && could_be_lit && looked < MOST_PILOT {
            power = self
                .powers(looked..looked + MORE_PILOT)
                .into_iter()
                .collect();
            looked += MORE_PILOT;
        }
        power
    }

    /// The powers of the photons of these light paths, in their order.
    fn powers(&self, paths: Range<u64>) -> Vec<f64> {
        let generators = SampleGenerators::new(self.seed, streams::PILOT);
        let instants = self.instants();
        let of = |path: &mut PhotonPath, index: u64| {
            let scene = self.in_turn(&instants, index);
            let mut u = Independent::new(generators.at(index));
            (self.tracing).build(scene, &self.wavelengths, &mut u, path);
            let photons = path.photons().iter();
            photons
                .map(|photon| f64::from(photon.power.mean()))
                .collect::<Vec<f64>>()
        };
        let found: Vec<Vec<f64>> = paths
            .into_par_iter()
            .map_init(PhotonPath::default, of)
            .collect();
        found.concat()
    }

    /// Diagonal of the box around the points.
    pub(super) fn reach(&self) -> f32 {
        let at = self.points.discs().iter().map(|disc| disc.center);
        let low = at.clone().reduce(Vec3::min).unwrap_or_default();
        let high = at.reduce(Vec3::max).unwrap_or_default();
        low.distance(high)
    }

    /// A film for contributions of single photons.
    pub(super) fn film(&self, settings: &RenderSettings) -> Result<Film, RenderError> {
        Ok(Film::with_layout(
            &settings.layout(),
            self.quantum(&self.power()),
        )?)
    }

    /// The unit of contributions of single photons of this power. Their size comes from the mean power of photons and the mean area
    /// of discs, which are known even where the two never meet. The geometric mean: one disc before the lens, as small as
    /// a grain, is to make no other's light too little to count.
    pub(super) fn quantum(&self, power: &Mean) -> Quantum {
        let of = |disc: &Disc| disc.whole_area().ln();
        let areas: Mean = if self.scene.moves() {
            self.pilot(1, |disc, _| of(disc)).into_iter().collect()
        } else {
            self.points.discs().iter().map(of).collect()
        };
        let typical = power.mean() / (areas.mean().exp() * std::f64::consts::PI);
        Quantum::from_mean(typical)
    }
}

/// A random number for the wavelengths of an iteration, in [0, 1), from that of the first.
///
/// Which four a hero brings with it depends on where in its quarter of the interval it lies: that is what turns by
/// the golden ratio. The quarter itself matters to light that disperses, which has the hero alone: it goes round.
fn turn(first: f64, index: u64, sampling: WavelengthSampling) -> f64 {
    let turned = |from: f64| (from + GOLDEN * index as f64).fract();
    match sampling {
        WavelengthSampling::Single => turned(first),
        WavelengthSampling::Hero => {
            let start = 4.0 * first;
            let quarter = QUARTERS[((start as u64 + index) % 4) as usize];
            0.25 * (quarter + turned(start.fract()))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The widest gap between points of the circle.
    fn gap(points: impl Iterator<Item = f64>) -> f64 {
        let mut points: Vec<f64> = points.map(|point| point.fract()).collect();
        points.sort_by(f64::total_cmp);
        let last = points[points.len() - 1];
        let inner = points.windows(2).map(|pair| pair[1] - pair[0]);
        inner.fold(1.0 - last + points[0], f64::max)
    }

    #[test]
    fn wavelengths_of_few_iterations_are_spread_evenly() {
        for first in [0.0, 0.13, 0.77, 0.999] {
            let hero = |index| turn(first, index, WavelengthSampling::Hero);
            let single = |index| turn(first, index, WavelengthSampling::Single);
            for count in [4, 8, 16, 64] {
                let even = 1.0 / count as f64;
                assert!(gap((0..count).map(|i| 4.0 * hero(i))) < 2.7 * even);
                assert!(gap((0..count).map(single)) < 2.7 * even);
            }
            // dispersive light: a hero in each quarter
            let mut quarters: Vec<u64> = (5..9).map(|i| (4.0 * hero(i)) as u64).collect();
            quarters.sort_unstable();
            assert_eq!(quarters, [0, 1, 2, 3]);
            assert!((0..1000).all(|i| (0.0..1.0).contains(&hero(i))));
        }
    }
}
