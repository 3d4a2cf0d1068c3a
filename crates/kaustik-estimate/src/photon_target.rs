//! Light paths as states of chains: what they touch, and what the targets say of it.

use kaustik_mcmc::{Draws, Family, SampleGenerators, Target};
use kaustik_path::{PhotonPath, PhotonTracing, note};
use kaustik_pss::Coordinates;
use kaustik_scene::Scene;

use crate::{PhotonMap, PhotonTargetKind};

/// A photon of a path that counts at a measurement point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Meeting {
    /// Number of the photon in its path.
    pub photon: u32,
    /// Number of the point.
    pub point: u32,
}

/// A path remembers about so many points of each photon at most.
///
/// A photon has a few, or some thousands where discs are large; but points of a whole picture may lie in one place. Of more than
/// this many every so-many-th is kept, and stands for so many: the same in the mean, and memory is bounded.
const MOST_MEETINGS: usize = 4096;

/// A light path with all that targets ask of it. Buffers are reused.
#[derive(Clone, Debug, Default)]
pub struct PhotonValue {
    /// The photons.
    pub path: PhotonPath,
    /// The pairs that meet, by photon: all, or those that stand for all.
    pub meetings: Vec<Meeting>,
    /// For how many pairs one of each photon stands; 1 for the photons behind the last.
    pub(crate) strides: Vec<u32>,
    /// The targets, by [`PhotonTargetKind`]: all but the uniform one are positive where the path is
    /// visible, and 0 elsewhere.
    pub targets: [f64; PhotonTargetKind::COUNT],
}

impl PhotonValue {
    /// For how many pairs one of this photon stands.
    #[inline]
    pub fn stands_for(&self, photon: u32) -> f64 {
        self.strides
            .get(photon as usize)
            .copied()
            .map_or(1.0, f64::from)
    }

    /// Does every pair that meets stand for itself?
    #[inline]
    pub(crate) fn is_whole(&self) -> bool {
        self.strides.is_empty()
    }
}

/// Evaluates light paths against the measurement points of one iteration.
#[derive(Clone, Copy, Debug)]
pub struct PhotonTarget<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// How light paths are made.
    pub tracing: PhotonTracing,
    /// The points.
    pub map: PhotonMap<'a>,
    /// `T_3` and `T_4` of each point; empty: 1.
    pub targets: &'a [[f32; 2]],
}

impl Target for PhotonTarget<'_> {
    type Value = PhotonValue;

    fn evaluate(&self, u: &mut dyn Coordinates, value: &mut PhotonValue) {
        let PhotonValue {
            path,
            meetings,
            strides,
            targets,
        } = value;
        (self.tracing).build(self.scene, self.map.wavelengths, u, path);
        meetings.clear();
        strides.clear();
        // G Eq. 12: the largest of the points touched
        let mut most = [0.0_f32; 2];
        for at in 0..path.photons().len() {
            let photon = &path.photons()[at];
            note(|| self.map.told(photon));
            let (first, mut count) = (meetings.len(), 0);
            self.map.meetings(photon, |point| {
                count += 1;
                if count <= MOST_MEETINGS {
                    meetings.push(Meeting {
                        photon: at as u32,
                        point: point as u32,
                    });
                }
                let [kernel, full] = self.targets.get(point).copied().unwrap_or([1.0; 2]);
                most = [most[0].max(kernel), most[1].max(full)];
            });
            if count > MOST_MEETINGS {
                meetings.truncate(first);
                let stride = count.div_ceil(MOST_MEETINGS) as u32;
                strides.resize(at, 1);
                strides.push(stride);
                self.thin_out(path, at, stride, meetings);
            }
        }
        let visible = f64::from(u8::from(!meetings.is_empty()));
        *targets = [1.0, visible, f64::from(most[0]), f64::from(most[1])];
    }
}

impl PhotonTarget<'_> {
    /// About every so-many-th of the points that a photon meets.
    ///
    /// Which ones goes by the path, the same for all its photons: where one keeps a point, one that keeps more of them keeps
    /// it too. So a point is kept with the chance of the photon that keeps most.
    #[cold]
    fn thin_out(&self, path: &PhotonPath, at: usize, stride: u32, meetings: &mut Vec<Meeting>) {
        let photons = path.photons();
        let [x, y, z] = photons[0]
            .position
            .to_array()
            .map(|at| u64::from(at.to_bits()));
        let of_points = SampleGenerators::new(x ^ (y << 32), z);
        self.map.meetings(&photons[at], |point| {
            if of_points.at(point as u64).uniform() * f64::from(stride) < 1.0 {
                meetings.push(Meeting {
                    photon: at as u32,
                    point: point as u32,
                });
            }
        });
    }
}

/// Which targets the chains of a ladder follow, the uniform one first (G sec. 4.4, Fig. 5).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PhotonLevels<const K: usize>(pub [PhotonTargetKind; K]);

impl<const K: usize> PhotonLevels<K> {
    /// Does a chain follow this target?
    pub fn has(&self, kind: PhotonTargetKind) -> bool {
        self.0.contains(&kind)
    }

    /// Does a chain follow a target that asks for more of a point than whether it is touched?
    pub fn ask_of_points(&self) -> bool {
        self.0.iter().any(|kind| kind.asks_of_points())
    }
}

impl<const K: usize> Family<PhotonValue, K> for PhotonLevels<K> {
    #[inline]
    fn densities(&self, value: &PhotonValue) -> [f64; K] {
        self.0.map(|kind| value.targets[kind as usize])
    }
}

#[cfg(test)]
mod tests;
