//! What a study measured.

use kaustik::film::metrics::{
    Measured, Nsd, Reference, brightness_factor, difference, matched, measure, nsd_beside, nsd_map,
};
use kaustik::film::{Image, Keep};
use serde_json::Value;

use crate::figure::mean_and_error;
use crate::parts::{Parts, luminances};
use crate::store::Record;
use crate::{SceneEntry, Study, StudyError};

/// A study with all that came of it.
#[derive(Clone, Debug)]
pub struct Results {
    /// What was asked.
    pub study: Study,
    /// One a scene, in the study's order.
    pub scenes: Vec<SceneResults>,
}

/// One scene's.
#[derive(Clone, Debug)]
pub struct SceneResults {
    /// What pictures were measured against.
    pub reference: ReferenceResult,
    /// Every method at every budget: by method, then by budget.
    pub groups: Vec<Group>,
    /// One picture a method: the first seed's at the last budget.
    pub shown: Vec<Shown>,
}

/// A reference and how well it is known.
#[derive(Clone, Debug)]
pub struct ReferenceResult {
    /// The mean of all renders.
    pub image: Image,
    /// The means of every other one: two independent halves, whose noise cancels in squared errors.
    pub halves: [Image; 2],
    /// Standard error of the mean as a share (`film::metrics::Spread::relative_error`).
    pub error: f64,
    /// The error that was wanted.
    pub wanted: f64,
    /// Renders.
    pub renders: u32,
    /// What they cost by the study's clock.
    pub seconds: f64,
}

/// The seeds of one method at one budget.
#[derive(Clone, Debug)]
pub struct Group {
    /// Index of the method in the study.
    pub method: usize,
    /// Index of the budget.
    pub budget: usize,
    /// One a seed.
    pub cells: Vec<Cell>,
    /// Spread over the seeds; `None` for one seed or black pictures.
    pub nsd: Option<Nsd>,
    /// Standard error of its mean as a share, by leaving out one seed at a time (the jackknife); NaN for fewer than three.
    pub nsd_error: f64,
}

/// One finished render.
#[derive(Clone, Debug)]
pub struct Cell {
    /// Its seed.
    pub seed: u64,
    /// What it cost by the study's clock, the pilot included.
    pub seconds: f64,
    /// Samples or mutations a pixel.
    pub per_pixel: f64,
    /// Against the halves of the reference.
    pub measured: Measured,
    /// The same with the brightness set right.
    pub matched: Measured,
    /// Root mean square relative difference over the darkest and over the brightest quarter of the lit pixels.
    pub quarters: [f64; 2],
    /// Mean linear red, green, blue of each close-up of the scene, or of the whole picture if there is none.
    pub colours: Vec<[f64; 3]>,
    /// What the render said of itself (`kaustik::RenderStatistics`).
    pub statistics: Value,
}

/// A picture for the page.
#[derive(Clone, Debug)]
pub struct Shown {
    /// Index of the method.
    pub method: usize,
    /// Its seed.
    pub seed: u64,
    /// The picture, with a method's parts as layers if the study keeps them.
    pub image: Image,
    /// What the page multiplies the picture by: 1, or what gives it the reference's mean luminance if the
    /// study asks for it.
    pub factor: f32,
    /// Signed relative difference a pixel (`film::metrics::difference`), of the picture as the page shows it.
    pub difference: Vec<f32>,
    /// NSD of each pixel over the seeds at the last budget (`film::metrics::nsd_map`); `None` for one seed.
    pub nsd: Option<Vec<f32>>,
    /// Size of the relative difference of each pixel, the mean over the seeds at the last budget, each with its brightness set right
    /// where that of the picture is.
    pub error: Vec<f32>,
}

impl ReferenceResult {
    /// For metrics. Halves always fit each other.
    #[must_use]
    pub fn reference(&self) -> Reference<'_> {
        let [a, b] = &self.halves;
        Reference::halves(a, b).unwrap_or_else(|| Reference::exact(&self.image))
    }
}

impl Shown {
    /// The picture at the brightness of the page; its layers stay.
    #[must_use]
    pub fn on_page(&self) -> Image {
        let mut image = self.image.clone();
        image.scale_pixels(|_| self.factor);
        image
    }
}

impl SceneResults {
    /// A method at a budget.
    #[must_use]
    pub fn group(&self, method: usize, budget: usize) -> Option<&Group> {
        self.groups
            .iter()
            .find(|g| g.method == method && g.budget == budget)
    }
}

type Read<'a> = dyn Fn(usize, u64, usize, Keep) -> Result<(Record, Image), StudyError> + 'a;

/// Measures all pictures of a scene; no more than one group of them is in memory at a time.
pub(crate) fn evaluate(
    study: &Study,
    scene: &SceneEntry,
    reference: ReferenceResult,
    read: &Read<'_>,
) -> Result<SceneResults, StudyError> {
    let (mut groups, mut shown) = (Vec::new(), Vec::new());
    let parts = Parts::of(&reference.image, &scene.close_ups);
    for method in 0..study.methods.len() {
        let mut last = Vec::new();
        for budget in 0..study.budgets.amounts.len() {
            last.clear();
            let mut cells = Vec::new();
            for &seed in &study.seeds {
                let (record, image) = read(method, seed, budget, Keep::Main)?;
                cells.push(cell(seed, record, &image, &reference, &parts)?);
                last.push(image);
            }
            let all: Vec<&Image> = last.iter().collect();
            groups.push(Group {
                method,
                budget,
                cells,
                nsd: nsd_beside(&all, &reference.image),
                nsd_error: nsd_error(&all, &reference.image),
            });
        }
        let seed = study.seeds[0];
        let (_, image) = read(method, seed, study.budgets.amounts.len() - 1, Keep::All)?;
        let is_matched = study.matched.contains(&study.methods[method].name);
        shown.push(show(method, seed, image, is_matched, &reference, &last)?);
    }
    Ok(SceneResults {
        reference,
        groups,
        shown,
    })
}

/// Standard error of the NSD of pictures as a share: what leaving out one at a time changes.
fn nsd_error(images: &[&Image], reference: &Image) -> f64 {
    let without = |index: usize| {
        let mut others = images.to_vec();
        others.remove(index);
        nsd_beside(&others, reference).map_or(f64::NAN, |nsd| nsd.mean)
    };
    let values: Vec<f64> = (0..images.len()).map(without).collect();
    let [mean, error] = mean_and_error(&values);
    // Each of n is that of n - 1, which have n - 2 in common: they spread less than means of their own would.
    error * (values.len() as f64 - 1.0) / mean
}

/// Size of the relative difference of each pixel, the mean over pictures; 0 where the reference is black.
fn mean_error(images: &[Image], reference: &Image) -> Vec<f32> {
    let wanted = luminances(reference.rgb());
    let mut sums = vec![0.0; wanted.len()];
    for image in images {
        for ((sum, found), wanted) in sums.iter_mut().zip(luminances(image.rgb())).zip(&wanted) {
            *sum += (found - wanted).abs() / wanted;
        }
    }
    let mean = |(sum, wanted): (f64, &f64)| match *wanted > 0.0 {
        true => (sum / images.len() as f64) as f32,
        false => 0.0,
    };
    sums.into_iter().zip(&wanted).map(mean).collect()
}

/// As the page shows it; `last` are the pictures of all seeds.
fn show(
    method: usize,
    seed: u64,
    image: Image,
    is_matched: bool,
    reference: &ReferenceResult,
    last: &[Image],
) -> Result<Shown, StudyError> {
    let factor = match is_matched {
        true => brightness_factor(&image, &reference.reference()).ok_or_else(size)?,
        false => 1.0,
    };
    let mut shown = Shown {
        method,
        seed,
        image,
        factor: factor as f32,
        difference: Vec::new(),
        nsd: nsd_map(&last.iter().collect::<Vec<_>>(), &reference.image),
        error: match is_matched {
            true => mean_error(&brightened(last, reference)?, &reference.image),
            false => mean_error(last, &reference.image),
        },
    };
    shown.difference = difference(&shown.on_page(), &reference.reference()).ok_or_else(size)?;
    Ok(shown)
}

/// Pictures, each with the reference's mean luminance.
fn brightened(images: &[Image], reference: &ReferenceResult) -> Result<Vec<Image>, StudyError> {
    let brightened = |image: &Image| {
        let factor = brightness_factor(image, &reference.reference()).ok_or_else(size)?;
        let mut image = image.clone();
        image.scale_pixels(|_| factor as f32);
        Ok(image)
    };
    images.iter().map(brightened).collect()
}

fn size() -> StudyError {
    StudyError::page("picture", "its size is not the reference's")
}

fn cell(
    seed: u64,
    record: Record,
    image: &Image,
    reference: &ReferenceResult,
    parts: &Parts,
) -> Result<Cell, StudyError> {
    let reference = reference.reference();
    let difference = difference(image, &reference).ok_or_else(size)?;
    Ok(Cell {
        seed,
        seconds: record.seconds,
        per_pixel: record.per_pixel,
        measured: measure(image, &reference).ok_or_else(size)?,
        matched: matched(image, &reference).ok_or_else(size)?,
        quarters: parts.root_mean_squares(&difference),
        colours: parts.colours(image),
        statistics: record.statistics,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grey(values: &[f32]) -> Image {
        let plane = || values.to_vec();
        Image::from_rgb(values.len() as u32, 1, [plane(), plane(), plane()]).expect("an image")
    }

    #[test]
    fn errors_are_means_over_pictures() {
        let reference = grey(&[1.0, 2.0, 0.0]);
        let images = [grey(&[1.5, 2.0, 1.0]), grey(&[0.9, 1.0, 0.0])];
        let found = mean_error(&images, &reference);
        for (found, wanted) in found.iter().zip([0.3, 0.25, 0.0]) {
            assert!((found - wanted).abs() < 1e-6, "{found} is not {wanted}");
        }
    }

    /// The error of a standard deviation of n equal normal values is one part in the root of 2 (n - 1): of many pixels of
    /// their own it is that over the root of the pixels.
    #[test]
    fn the_error_of_noise_is_what_pixels_and_pictures_tell() {
        let mut draw = crate::key::fingerprint(*b"noise");
        let mut uniform = || {
            draw = draw
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (draw >> 40) as f32 / (1_u64 << 24) as f32
        };
        let mut picture = || {
            let values: Vec<f32> = (0..100)
                .map(|_| 1.0 + 0.01 * (0..12).map(|_| uniform()).sum::<f32>())
                .collect();
            grey(&values)
        };
        let images: Vec<Image> = (0..8).map(|_| picture()).collect();
        let all: Vec<&Image> = images.iter().collect();
        let error = nsd_error(&all, &images[0]);
        let wanted = 1.0 / f64::from(2 * 7 * 100).sqrt();
        assert!((0.4..2.0).contains(&(error / wanted)), "{error}, {wanted}");
        assert!(nsd_error(&all[..2], &images[0]).is_nan());
    }
}
