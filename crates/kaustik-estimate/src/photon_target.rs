//! Light paths as states of chains: what they touch, and what the targets say of it.

use kaustik_mcmc::{Family, Target};
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

/// A light path with all that targets ask of it. Buffers are reused.
#[derive(Clone, Debug, Default)]
pub struct PhotonValue {
    /// The photons.
    pub path: PhotonPath,
    /// All pairs that meet, by photon.
    pub meetings: Vec<Meeting>,
    /// The targets, by [`PhotonTargetKind`]: all but the uniform one are positive where the path is
    /// visible, and 0 elsewhere.
    pub targets: [f64; PhotonTargetKind::COUNT],
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
            targets,
        } = value;
        (self.tracing).build(self.scene, self.map.wavelengths, u, path);
        meetings.clear();
        // G Eq. 12: the largest of the points touched
        let mut most = [0.0_f32; 2];
        for (photon, at) in path.photons().iter().zip(0..) {
            note(|| self.map.told(photon));
            self.map.meetings(photon, |point| {
                meetings.push(Meeting {
                    photon: at,
                    point: point as u32,
                });
                let [kernel, full] = self.targets.get(point).copied().unwrap_or([1.0; 2]);
                most = [most[0].max(kernel), most[1].max(full)];
            });
        }
        let visible = f64::from(u8::from(!meetings.is_empty()));
        *targets = [1.0, visible, f64::from(most[0]), f64::from(most[1])];
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
}

impl<const K: usize> Family<PhotonValue, K> for PhotonLevels<K> {
    #[inline]
    fn densities(&self, value: &PhotonValue) -> [f64; K] {
        self.0.map(|kind| value.targets[kind as usize])
    }
}
