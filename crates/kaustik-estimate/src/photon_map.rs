//! Where photons and measurement points meet.

use kaustik_film::Film;
use kaustik_path::{Event, Lookup, MeasurementPoints, Photon, PhotonPath, note};
use kaustik_spectrum::Wavelengths;

use crate::Scale;

/// The measurement points of one iteration, and how to find them.
#[derive(Clone, Copy, Debug)]
pub struct PhotonMap<'a> {
    /// The points.
    pub points: &'a MeasurementPoints,
    /// Their discs, numbered alike.
    pub lookup: &'a Lookup,
    /// The wavelengths of the iteration.
    pub wavelengths: &'a Wavelengths,
    /// Longest whole path in edges.
    pub max_edges: u32,
}

impl PhotonMap<'_> {
    /// Calls `meet` with every point that a photon counts at: within the radius, nothing between them, on a surface that looks the
    /// same way, at the end of a path that is not too long.
    #[inline]
    pub fn meetings(&self, photon: &Photon, mut meet: impl FnMut(usize)) {
        (self.lookup).holding(self.points.discs(), photon.position, |index| {
            if (self.points).accepts(index as usize, photon, self.max_edges) {
                meet(index as usize);
            }
        });
    }

    /// Adds what one photon brings to one point, times `weight`, to a film. `false`: the value is not finite or
    /// negative, and was left out.
    #[inline]
    pub fn splat(
        &self,
        film: &Film,
        scale: Scale,
        photon: &Photon,
        point: usize,
        weight: f64,
    ) -> bool {
        let xyz = self.points.contribution(point, photon, self.wavelengths);
        let sum = xyz.sum();
        note(|| Event::Deposit {
            raster: self.points.points()[point].raster,
            xyz: xyz * weight as f32,
            kept: sum.is_finite() && xyz.0.iter().all(|&v| v >= 0.0),
        });
        if !(sum.is_finite() && xyz.0.iter().all(|&v| v >= 0.0)) {
            return false;
        }
        if sum > 0.0 {
            let raster = self.points.points()[point].raster;
            film.splat_weighted(raster.x * scale.width, raster.y * scale.height, xyz, weight);
        }
        true
    }

    /// Adds all that a path brings (G Eq. 2), times `weight`, to a film. Returns how many values were not finite or
    /// negative.
    #[inline]
    pub fn deposit(&self, film: &Film, scale: Scale, path: &PhotonPath, weight: f64) -> u64 {
        let mut faults = u64::from(path.nonfinite());
        for photon in path.photons() {
            note(|| self.told(photon));
            self.meetings(photon, |point| {
                faults += u64::from(!self.splat(film, scale, photon, point, weight));
            });
        }
        faults
    }

    /// For whoever looks at the photon.
    #[cold]
    pub(crate) fn told(&self, photon: &Photon) -> Event {
        let mut met = 0;
        self.meetings(photon, |_| met += 1);
        Event::Photon {
            position: photon.position.as_dvec3(),
            direction: photon.wi,
            power: photon.power,
            edges: photon.edges,
            met,
        }
    }
}
