//! Light paths as states of chains: what they touch, and what the targets say of it.

use kaustik_mcmc::{Draws, Family, Target, sample_generator};
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

/// A path remembers so many points of each photon at most.
///
/// A photon has a few, or some thousands where discs are large; but points of a whole picture may lie in one place. Of more than
/// this many every so-many-th is kept, and is brought so many times the power: the same in the mean, and memory is bounded.
const MOST_MEETINGS: usize = 4096;

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
                self.thin_out(path, at, count, meetings);
            }
        }
        let visible = f64::from(u8::from(!meetings.is_empty()));
        *targets = [1.0, visible, f64::from(most[0]), f64::from(most[1])];
    }
}

impl PhotonTarget<'_> {
    /// Every so-many-th of this many points that a photon meets. Which one is first goes by where the photon lies: the
    /// same for the same path.
    #[cold]
    fn thin_out(
        &self,
        path: &mut PhotonPath,
        at: usize,
        count: usize,
        meetings: &mut Vec<Meeting>,
    ) {
        let stride = count.div_ceil(MOST_MEETINGS);
        let photon = path.photons()[at];
        let [x, y, z] = photon.position.to_array().map(|at| u64::from(at.to_bits()));
        let mut turn = (sample_generator(x, y, z).uniform() * stride as f64) as usize;
        self.map.meetings(&photon, |point| {
            if turn == 0 {
                turn = stride;
                meetings.push(Meeting {
                    photon: at as u32,
                    point: point as u32,
                });
            }
            turn -= 1;
        });
        path.multiply(at, stride as f32);
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

#[cfg(test)]
mod tests {
    use glam::DVec2;
    use kaustik_mcmc::Independent;
    use kaustik_path::{BuilderSettings, Lookup, MeasurementPoints, MeasurementWalk, Photon};
    use kaustik_scene::{SceneOptions, builtin};
    use kaustik_spectrum::{WavelengthSampling, Wavelengths};

    use super::*;

    const SIDE: u32 = 160;

    /// Discs so large that a photon meets thousands: those that are kept bring what all would.
    #[test]
    fn what_is_kept_of_many_meetings_brings_as_much() {
        let options = SceneOptions {
            width: SIDE,
            height: SIDE,
            ..SceneOptions::default()
        };
        let description = builtin::load("cornell").expect("a built-in scene");
        let scene = Scene::new(&description, &options).expect("a sound scene");
        let wavelengths = Wavelengths::sample(0.3, WavelengthSampling::Hero);
        let walk = MeasurementWalk {
            settings: BuilderSettings::default(),
            threshold: 0.39,
            pixels: DVec2::splat(f64::from(SIDE)),
            radius: 100.0,
        };
        let (mut points, mut lookup) = (MeasurementPoints::default(), Lookup::default());
        for pixel in 0..u64::from(SIDE * SIDE) {
            let mut u = Independent::new(sample_generator(1, 0, pixel));
            walk.trace(&scene, &wavelengths, &mut u, &mut points);
        }
        points.sort_into(&mut lookup);
        let map = PhotonMap {
            points: &points,
            lookup: &lookup,
            wavelengths: &wavelengths,
            max_edges: 8,
        };
        let tracing = PhotonTracing { max_edges: 8 };
        let target = PhotonTarget {
            scene: &scene,
            tracing,
            map,
            targets: &[],
        };
        let brought = |photon: &Photon, point: usize| {
            f64::from(points.contribution(point, photon, &wavelengths).sum())
        };
        let (mut value, mut whole) = (PhotonValue::default(), PhotonPath::default());
        let (mut thinned, mut all, mut kept) = (0, 0.0, 0.0);
        for index in 0..400 {
            let u = || Independent::new(sample_generator(1, 1, index));
            target.evaluate(&mut u(), &mut value);
            tracing.build(&scene, &wavelengths, &mut u(), &mut whole);
            for (at, photon) in whole.photons().iter().enumerate() {
                let mut count = 0;
                map.meetings(photon, |point| {
                    count += 1;
                    all += brought(photon, point);
                });
                let of = |meeting: &&Meeting| meeting.photon as usize == at;
                let own = value.meetings.iter().filter(of).count();
                assert!(own <= MOST_MEETINGS && (own == count || count > MOST_MEETINGS));
                thinned += usize::from(own < count);
            }
            for meeting in &value.meetings {
                let photon = &value.path.photons()[meeting.photon as usize];
                kept += brought(photon, meeting.point as usize);
            }
        }
        assert!(thinned > 100, "{thinned}");
        assert!((kept / all - 1.0).abs() < 2e-3, "{kept}, not {all}");
    }
}
