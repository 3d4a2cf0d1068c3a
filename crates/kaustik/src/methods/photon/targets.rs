//! What chains follow: the targets of measurement points, and the regions that they go by.

use kaustik_estimate::{
    DensityTarget, Learnt, PhotonLevels, PhotonTargetKind, Refinement, RegionPoint, RegionSums,
    Regions, inverse,
};
use kaustik_path::{Disc, MeasurementPoint};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::stage::Stage;
use crate::settings::photon_options::{PhotonOptions, TargetFunction};
use crate::state::StateError;

/// Camera walks a pixel before the first iteration, which the tree is made from (G sec. 4.2).
const PILOT_PASSES: u64 = 4;
/// Regions smaller than this share of all that is seen part surfaces by where they face.
const ORIENTED: f32 = 0.05;

/// Where regions lie, or what stands for them.
#[derive(Debug)]
pub(super) enum Space {
    /// In the scene.
    World,
    /// On the image: on the window that is rendered, by its first corner and its sides (the unit square over the whole).
    Image([f64; 2], [f64; 2]),
    /// No regions: a pilot's map of the image.
    Densities(DensityTarget),
}

/// What targets have learnt.
#[derive(Serialize, Deserialize)]
pub(super) struct Kept {
    means: [f64; 2],
    learnt: Option<Vec<Learnt>>,
    of_points: Vec<[f32; 2]>,
}

/// Means and targets of points before an iteration.
pub(super) type Mark = ([f64; 2], Option<Vec<[f32; 2]>>);

/// `T_3` and `T_4` of all points, and the regions behind them.
pub(super) struct Targets<const K: usize> {
    space: Space,
    /// What normals are multiplied by in places; 0 where regions do not ask for them.
    normals: f32,
    /// Visibility asks nothing of points.
    plain: bool,
    regions: Option<Regions>,
    refinement: Refinement,
    sums: Option<RegionSums<K>>,
    of_points: Vec<[f32; 2]>,
    /// Mean of either target over the points.
    means: [f64; 2],
}

impl<const K: usize> Targets<K> {
    /// For a ladder of these levels.
    pub(super) fn new(
        stage: &Stage<'_>,
        options: PhotonOptions,
        levels: &PhotonLevels<K>,
        space: Space,
    ) -> Self {
        let wanted = levels.has(PhotonTargetKind::Full)
            && options.target_function != TargetFunction::InverseKernel;
        let normals = if options.orientation {
            0.5 * ORIENTED * stage.reach()
        } else {
            0.0
        };
        let place = |disc: &Disc, point: &MeasurementPoint| place(disc, point, normals);
        let regions = wanted.then(|| match &space {
            Space::World | Space::Densities(_) => {
                Regions::spatial(&mut stage.pilot(PILOT_PASSES, place))
            }
            Space::Image(..) => Regions::image(),
        });
        let sums = (regions.as_ref()).map(|regions| {
            let sums = RegionSums::new(regions.leaves(), levels, options.psi);
            match options.target_function {
                TargetFunction::SecondMoment => {
                    let power = stage.power().mean().max(f64::MIN_POSITIVE);
                    sums.with_fluxes(power / std::f64::consts::PI)
                }
                _ => sums,
            }
        });
        Self {
            space,
            normals,
            plain: !levels.ask_of_points(),
            regions,
            refinement: options.refinement,
            sums,
            of_points: Vec::new(),
            means: [1.0; 2],
        }
    }

    /// For the iteration that the stage has begun (G Eq. 11). Returns by how much each of the four targets has grown in
    /// the mean over the points.
    pub(super) fn assign(&mut self, stage: &Stage<'_>) -> [f64; PhotonTargetKind::COUNT] {
        self.of_points.clear();
        if self.plain {
            return [1.0; PhotonTargetKind::COUNT];
        }
        let all = stage.map().points;
        let points = all.points();
        let areas = || (0..points.len()).map(|index| all.area(index));
        let largest = areas().fold(0.0, f64::max);
        let kernel = |area: f64| inverse(area / largest);
        let leaves = self.leaves(stage);
        // No more than that: there is one a pixel.
        self.of_points.reserve_exact(points.len());
        match &mut self.regions {
            None => {
                let space = &self.space;
                let of = |(area, point): (f64, &MeasurementPoint)| match space {
                    Space::Densities(map) => map.at(point.raster.x, point.raster.y),
                    _ => kernel(area) as f32,
                };
                let of = areas().zip(points).map(|both| [of(both); 2]);
                self.of_points.extend(of);
            }
            Some(regions) => {
                let mut of_leaves = vec![0.0; regions.leaves()];
                for (area, &leaf) in areas().zip(&leaves) {
                    of_leaves[leaf as usize] += area;
                }
                regions.set_areas(&of_leaves);
                let densities = match self.refinement {
                    Refinement::Shrunk { paths } => regions.shrunk_densities(paths),
                    _ => regions.densities(),
                };
                self.of_points
                    .extend(areas().zip(&leaves).map(|(area, &leaf)| {
                        let kernel = kernel(area);
                        let full = kernel * inverse(densities[leaf as usize]);
                        [kernel as f32, full as f32]
                    }));
            }
        }
        if let Some(sums) = &mut self.sums {
            sums.begin(leaves);
        }
        let before = self.means;
        self.means = self.means_of_points();
        let [kernel, full] = [0, 1].map(|which| self.means[which] / before[which]);
        [1.0, 1.0, kernel, full]
    }

    fn means_of_points(&self) -> [f64; 2] {
        let count = self.of_points.len().max(1) as f64;
        [0, 1].map(|which| {
            let sum: f64 = self.of_points.iter().map(|of| f64::from(of[which])).sum();
            (sum / count).max(f64::MIN_POSITIVE)
        })
    }

    /// What [`assign`](Self::assign) changes and does not make anew; with the targets of points, if these are shown.
    pub(super) fn mark(&self, shown: bool) -> Mark {
        let of_points = shown.then(|| self.of_points.clone());
        (self.means, of_points)
    }

    /// As it was then.
    pub(super) fn take_back(&mut self, (means, of_points): Mark) {
        self.means = means;
        if let Some(of_points) = of_points {
            self.of_points = of_points;
        }
    }

    /// What is to be kept between two iterations; with the targets of the last one's points, if these are shown.
    pub(super) fn kept(&self, shown: bool) -> Kept {
        Kept {
            means: self.means,
            learnt: self.regions.as_ref().map(Regions::learnt),
            of_points: if shown {
                self.of_points.clone()
            } else {
                Vec::new()
            },
        }
    }

    /// Refuses what other targets have left.
    pub(super) fn take_up(&mut self, kept: Kept, shown: bool) -> Result<(), StateError> {
        let wrong = || StateError::damaged("regions are none of these targets");
        if !kept
            .means
            .iter()
            .all(|mean| mean.is_finite() && *mean > 0.0)
        {
            return Err(wrong());
        }
        self.regions = match (self.regions.take(), kept.learnt) {
            (None, None) => None,
            (Some(regions), Some(learnt)) => Some(regions.with_learnt(&learnt).ok_or_else(wrong)?),
            _ => return Err(wrong()),
        };
        self.means = kept.means;
        if shown {
            self.of_points = kept.of_points;
        }
        Ok(())
    }

    /// Where a point lies in the tree.
    fn place(&self, disc: &Disc, point: &MeasurementPoint) -> RegionPoint {
        match &self.space {
            Space::Image(low, sides) => {
                let within = |axis: usize| {
                    let from_corner = point.raster[axis] - low[axis];
                    (from_corner / sides[axis]) as f32
                };
                [within(0), within(1), 0.0, 0.0, 0.0, 0.0]
            }
            _ => place(disc, point, self.normals),
        }
    }

    /// The leaf of each point.
    fn leaves(&mut self, stage: &Stage<'_>) -> Vec<u32> {
        let sums = self.sums.as_mut();
        let mut leaves = sums.map_or(Vec::new(), RegionSums::take_leaves);
        leaves.clear();
        let Some(regions) = &self.regions else {
            return leaves;
        };
        let points = stage.map().points;
        let both = (points.discs().par_iter()).zip(points.points());
        both.with_min_len(4096)
            .map(|(disc, point)| regions.leaf(self.place(disc, point)))
            .collect_into_vec(&mut leaves);
        leaves
    }

    /// `T_3` and `T_4` of each point; empty where nobody asks.
    pub(super) fn of_points(&self) -> &[[f32; 2]] {
        &self.of_points
    }

    /// The region of each point, if there are any.
    pub(super) fn region(&self, disc: &Disc, point: &MeasurementPoint) -> Option<u32> {
        let regions = self.regions.as_ref()?;
        Some(regions.regions()[regions.leaf(self.place(disc, point)) as usize])
    }

    /// Where visits tell about regions.
    pub(super) fn sums(&self) -> Option<&RegionSums<K>> {
        self.sums.as_ref()
    }

    /// What visits of the iteration will be about worth, by the rough normalisers of these levels.
    pub(super) fn expect(&mut self, levels: &PhotonLevels<K>, rough: &[f64; K]) {
        // A visit is worth `b / T`: of the chain that looks most widely, with the mean over points for `T`.
        let worth = rough[1] / self.mean(levels.0[1]);
        if let Some(sums) = &mut self.sums {
            sums.expect(worth.max(f64::MIN_POSITIVE));
        }
    }

    /// A target's mean over the points.
    fn mean(&self, kind: PhotonTargetKind) -> f64 {
        match kind {
            PhotonTargetKind::Uniform | PhotonTargetKind::Visibility => 1.0,
            PhotonTargetKind::InverseKernel => self.means[0],
            PhotonTargetKind::Full => self.means[1],
        }
    }

    /// Ends an iteration: regions take what visits have told.
    pub(super) fn learn(&mut self, factors: &[f64; K]) {
        if let (Some(regions), Some(sums)) = (&mut self.regions, &self.sums) {
            regions.learn(&sums.tallies(factors), self.refinement);
        }
    }

    /// The name of a target.
    pub(super) fn name(&self, kind: PhotonTargetKind) -> &'static str {
        match (kind, &self.space) {
            (PhotonTargetKind::InverseKernel, Space::Densities(_)) => "density",
            _ => kind.name(),
        }
    }

    /// Regions in the cut; 0 without a tree.
    pub(super) fn cut(&self) -> usize {
        self.regions.as_ref().map_or(0, Regions::cut)
    }
}

/// Position and normal.
fn place(disc: &Disc, point: &MeasurementPoint, normals: f32) -> RegionPoint {
    let ([x, y, z], [u, v, w]) = (disc.center.to_array(), (point.normal * normals).to_array());
    [x, y, z, u, v, w]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Method, small};

    #[test]
    fn targets_go_by_the_part_of_a_disc_in_which_photons_count() {
        let size = [24; 2];
        let settings = small::settings(Method::PhotonSpatial, size);
        let scene = small::scene("cornell", size);
        let mut stage = Stage::new(&scene, &settings);
        stage.begin(None);
        let levels = PhotonLevels([
            PhotonTargetKind::Uniform,
            PhotonTargetKind::Visibility,
            PhotonTargetKind::InverseKernel,
            PhotonTargetKind::Full,
        ]);
        let photon = settings.options.photon;
        let mut targets = Targets::new(&stage, photon, &levels, Space::World);
        targets.assign(&stage);
        let points = stage.map().points;
        let count = points.points().len();
        let largest = (0..count)
            .map(|index| points.area(index))
            .fold(0.0, f64::max);
        let mut cut = 0;
        for (index, &[kernel, _]) in targets.of_points().iter().enumerate() {
            let (area, whole) = (points.area(index), points.discs()[index].whole_area());
            cut += usize::from(area < 0.7 * whole);
            let expected = inverse(area / largest) as f32;
            assert_eq!(kernel.to_bits(), expected.to_bits(), "{area} of {whole}");
        }
        // the feet of walls and boxes
        assert!(cut > count / 50, "{cut} of {count}");
        // and the areas of regions, from which densities are made
        let whole: f64 = points.discs().iter().map(Disc::whole_area).sum();
        let free: f64 = (0..count).map(|index| points.area(index)).sum();
        let regions = targets.regions.as_ref().expect("a full target");
        assert!(free < 0.98 * whole, "{free} of {whole}");
        assert!(
            (regions.area() / free - 1.0).abs() < 1e-9,
            "{}",
            regions.area()
        );
    }
}
