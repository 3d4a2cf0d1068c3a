use std::collections::BTreeSet;

use glam::DVec2;
use kaustik_mcmc::{Independent, Visit, sample_generator};
use kaustik_path::{BuilderSettings, Lookup, MeasurementPoints, MeasurementWalk, Photon};
use kaustik_scene::{SceneOptions, builtin};
use kaustik_spectrum::{WavelengthSampling, Wavelengths};

use super::*;
use crate::first_meetings::FirstMeetings;
use crate::{Combine, RegionSums, Sharing, Witnesses};

const SIDE: u32 = 160;
const PATHS: u64 = 400;
const TRACING: PhotonTracing = PhotonTracing { max_edges: 8 };

/// A room with discs so large that a photon meets thousands.
struct Crowded {
    scene: Scene,
    wavelengths: Wavelengths,
    points: MeasurementPoints,
    lookup: Lookup,
}

impl Crowded {
    fn new() -> Self {
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
        Self {
            scene,
            wavelengths,
            points,
            lookup,
        }
    }

    fn map(&self) -> PhotonMap<'_> {
        PhotonMap {
            points: &self.points,
            lookup: &self.lookup,
            wavelengths: &self.wavelengths,
            max_edges: TRACING.max_edges,
        }
    }

    /// Calls with light paths: as a target keeps them, and as they are.
    fn each_path(&self, mut tell: impl FnMut(&PhotonValue, &PhotonPath)) {
        let target = PhotonTarget {
            scene: &self.scene,
            tracing: TRACING,
            map: self.map(),
            targets: &[],
        };
        let (mut value, mut whole) = (PhotonValue::default(), PhotonPath::default());
        for index in 0..PATHS {
            let u = || Independent::new(sample_generator(1, 1, index));
            target.evaluate(&mut u(), &mut value);
            TRACING.build(&self.scene, &self.wavelengths, &mut u(), &mut whole);
            tell(&value, &whole);
        }
    }

    fn brought(&self, photon: &Photon, point: usize) -> f64 {
        f64::from((self.points.contribution(point, photon, &self.wavelengths)).sum())
    }
}

/// Pairs that are kept bring what all would.
#[test]
fn what_is_kept_of_many_meetings_brings_as_much() {
    let crowded = Crowded::new();
    let (mut thinned, mut all, mut kept) = (0, 0.0, 0.0);
    crowded.each_path(|value, whole| {
        for (at, photon) in whole.photons().iter().enumerate() {
            let mut count = 0;
            crowded.map().meetings(photon, |point| {
                count += 1;
                all += crowded.brought(photon, point);
            });
            let of = |meeting: &&Meeting| meeting.photon as usize == at;
            let own = value.meetings.iter().filter(of).count();
            assert!(own <= MOST_MEETINGS * 5 / 4 && (own == count || count > MOST_MEETINGS));
            thinned += usize::from(own < count);
        }
        for meeting in &value.meetings {
            let photon = &value.path.photons()[meeting.photon as usize];
            let stands_for = value.stands_for(meeting.photon);
            kept += crowded.brought(photon, meeting.point as usize) * stands_for;
        }
    });
    assert!(thinned > 100, "{thinned}");
    assert!((kept / all - 1.0).abs() < 2e-3, "{kept}, not {all}");
}

/// They tell regions of as many points, though several photons of a path meet the same.
#[test]
fn what_is_kept_of_many_meetings_counts_as_many_points() {
    let crowded = Crowded::new();
    let levels = PhotonLevels([PhotonTargetKind::Uniform]);
    let mut sums = RegionSums::new(1, &levels, Witnesses::All);
    sums.begin(vec![0; crowded.points.points().len()]);
    let sharing = Sharing {
        combine: Combine::Balance,
        rough: [1.0],
        samples: [1.0],
    };
    let (mut touched, mut firsts) = (0, FirstMeetings::default());
    crowded.each_path(|value, whole| {
        let visit = Visit {
            level: 0,
            value,
            densities: &[1.0],
            weight: 1.0,
            independent: 0.0,
        };
        sums.take(&visit, 1.0, &crowded.map(), &sharing, 0, &mut firsts);
        let mut met = BTreeSet::new();
        for photon in whole.photons() {
            crowded.map().meetings(photon, |point| {
                met.insert(point);
            });
        }
        touched += met.len();
    });
    let [tally] = sums.tallies(&[1.0])[..] else {
        panic!("one leaf");
    };
    let told = tally.psi[0] / touched as f64;
    assert!((told - 1.0).abs() < 2e-3, "{tally:?}, not {touched}");
}
