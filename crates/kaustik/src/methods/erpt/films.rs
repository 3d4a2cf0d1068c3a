//! The picture, and what Cline's filters need beside it (Batty sec. 4.2 and 6).

use std::io;
use std::iter::once;

use glam::DVec2;
use kaustik_film::{Film, Image, Quantum, develop};
use kaustik_mcmc::Deposit;
use kaustik_mutate::Path;
use kaustik_path::{Event, ScalarTarget, note};
use kaustik_spectrum::Xyz;

use crate::beside::lost::{Lost, scalars, sum};
use crate::mark::FilmMark;
use crate::state::{Reader, StateError, Writer};
use crate::{RenderError, RenderSettings};

/// One film; another for each filter that is asked for.
pub(crate) struct Films {
    pub(crate) picture: Film,
    /// What the filter by consecutive samples kept back.
    held: Option<Film>,
    /// What the filter by proposals lets a pixel hold, in X: light of as many deposits as were proposed into it,
    /// times kappa, and what was never to be spread.
    allowed: Option<(Film, f64)>,
    size: DVec2,
    target: ScalarTarget,
}

impl Films {
    /// `mean`: light of a sample.
    pub(crate) fn new(settings: &RenderSettings, mean: f64) -> Result<Self, RenderError> {
        let options = &settings.options;
        let film = || Film::with_layout(&settings.layout(), Quantum::from_sum_of_xyz(mean));
        let allowed = |kappa| film().map(|film| (film, kappa));
        Ok(Self {
            picture: film()?,
            held: options.consecutive.map(|_| film()).transpose()?,
            allowed: options.proposed.map(allowed).transpose()?,
            size: DVec2::new(f64::from(settings.width), f64::from(settings.height)),
            target: options.target,
        })
    }

    /// Light that is left where it was sampled.
    pub(crate) fn leave(&self, path: &Path, weight: f64) {
        let at = path.raster() * self.size;
        tell(path, path.colour(), weight);
        (self.picture).splat_weighted(at.x, at.y, path.colour(), weight);
        if let Some((allowed, _)) = &self.allowed {
            allowed.splat_weighted(at.x, at.y, UNIT, weight);
        }
    }

    /// A chain's deposit in a colour whose scalar is 1.
    pub(crate) fn deposit(&self, deposit: &Deposit<'_, Path>, colour: Xyz) {
        let at = deposit.value.raster() * self.size;
        tell(deposit.value, colour, deposit.weight());
        (self.picture).splat_weighted(at.x, at.y, colour, deposit.weight());
        if let Some(held) = self.held.as_ref().filter(|_| deposit.held > 0.0) {
            held.splat_weighted(at.x, at.y, colour, deposit.held);
        }
        if let Some((allowed, kappa)) = self.allowed.as_ref().filter(|_| deposit.is_proposal) {
            allowed.splat_weighted(at.x, at.y, UNIT, kappa * deposit.unit);
        }
    }

    fn all(&self) -> impl Iterator<Item = &Film> {
        let allowed = self.allowed.iter().map(|(film, _)| film);
        once(&self.picture).chain(&self.held).chain(allowed)
    }

    fn all_mut(&mut self) -> impl Iterator<Item = &mut Film> {
        let allowed = self.allowed.iter_mut().map(|(film, _)| film);
        once(&mut self.picture).chain(&mut self.held).chain(allowed)
    }

    /// Writes down what they hold.
    pub(crate) fn mark(&self, marks: &mut Vec<FilmMark>) {
        marks.resize_with(self.all().count(), FilmMark::default);
        for (mark, film) in marks.iter_mut().zip(self.all()) {
            mark.set(film);
        }
    }

    /// Takes them back to it.
    pub(crate) fn take_back(&mut self, marks: &[FilmMark]) {
        for (mark, film) in marks.iter().zip(self.all_mut()) {
            mark.take_back(film);
        }
    }

    /// Writes all of them.
    pub(crate) fn write(&self, out: &mut Writer<'_>) -> io::Result<()> {
        self.all().try_for_each(|film| out.film(film))
    }

    /// Fills all of them.
    pub(crate) fn take_up(&mut self, from: &mut Reader<'_>) -> Result<(), StateError> {
        self.all_mut().try_for_each(|film| from.film(film))
    }

    /// The picture through the filters, with what is beside it, and what each filter took away. `per_sample` turns sums into
    /// means.
    pub(crate) fn develop(
        &self,
        per_sample: f64,
        besides: &[(&Film, f64)],
    ) -> Result<(Image, Vec<Lost>), RenderError> {
        let mut image = develop(&[(&self.picture, per_sample)])?;
        let mut lost = Vec::new();
        let mut all = vec![(&self.picture, per_sample)];
        all.extend(besides);
        if let Some(held) = &self.held {
            lost.push(Lost::held((held, per_sample), &all, self.target)?);
        }
        if let Some((allowed, _)) = &self.allowed {
            let kept = scalars(&all[..1], |xyz| self.target.of(xyz))?;
            let most = scalars(&[(allowed, per_sample)], |xyz| f64::from(xyz.0[0]))?;
            let shares: Vec<f64> = (kept.iter().zip(&most))
                .map(|(&kept, &most)| allowed_share(kept, most))
                .collect();
            let unfiltered = image.rgb().map(<[f32]>::to_vec);
            image.scale_pixels(|pixel| shares[pixel] as f32);
            let mut difference = unfiltered;
            for (plane, filtered) in difference.iter_mut().zip(image.rgb()) {
                for (value, filtered) in plane.iter_mut().zip(filtered) {
                    *value -= filtered;
                }
            }
            let away: f64 = kept.iter().zip(&shares).map(|(k, s)| k * (1.0 - s)).sum();
            let all = sum(&all, self.target)?;
            lost.push(Lost::new("proposed", difference, [away, all]));
        }
        if !besides.is_empty() {
            image.add(&develop(besides)?)?;
        }
        Ok((image, lost))
    }
}

/// What is left of a pixel that may hold at most so much. Beside bright pixels a filter with negative lobes may leave
/// less than nothing of either: what is negative is kept, and what is not allowed to be more than that goes.
fn allowed_share(kept: f64, most: f64) -> f64 {
    if kept > most.max(0.0) {
        most.max(0.0) / kept
    } else {
        1.0
    }
}

/// Tells whoever listens what falls on the picture.
#[inline]
fn tell(path: &Path, colour: Xyz, weight: f64) {
    note(|| Event::Deposit {
        raster: path.raster(),
        xyz: colour * weight as f32,
        kept: true,
    });
}

/// A scalar on a film of colours.
const UNIT: Xyz = Xyz([1.0, 0.0, 0.0]);
