//! Directions are drawn with the density that `pdf` states.
//!
//! Cells are polar about the direction where the lobe should peak, finer where it is narrow; one
//! set for each side of the surface. What falls into a cell is compared with the integral of
//! `pdf` over it; delta directions and absorption are cells too.

use crate::catalogue::{Case, facets, principled, some};
use crate::layers::layers;
use crate::support::{Random, at};
use glam::DVec3;
use kaustik_bsdf::{Frame, Lobe, Mode};
use statrs::distribution::{ChiSquared, ContinuousCDF};
use std::f64::consts::TAU;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

const RINGS: usize = 12;
const SECTORS: usize = 8;

/// Polar cells about an axis, over the directions of one side.
struct Cells {
    frame: Frame,
    /// +1 or -1: the side whose directions count.
    side: f64,
    /// How far the lobe reaches, in units of 1 - cos.
    lobe: f64,
}

impl Cells {
    fn new(axis: DVec3, width: f64) -> Self {
        Self {
            frame: Frame::from_z(axis),
            side: axis.z.signum(),
            lobe: (50.0 * width * width).min(1.0),
        }
    }

    /// `1 - cos` of the angle to the axis, from the ring coordinate in `[0, 1]`: half of the rings
    /// share the lobe, the others the rest of the sphere.
    fn drop(&self, t: f64) -> f64 {
        if t < 0.5 {
            self.lobe * 4.0 * t * t
        } else {
            self.lobe + (2.0 - self.lobe) * (2.0 * t - 1.0)
        }
    }

    /// Derivative of `drop`.
    fn slope(&self, t: f64) -> f64 {
        if t < 0.5 {
            self.lobe * 8.0 * t
        } else {
            2.0 * (2.0 - self.lobe)
        }
    }

    fn ring(&self, drop: f64) -> f64 {
        if drop < self.lobe {
            0.5 * (drop / self.lobe).sqrt()
        } else {
            0.5 + 0.5 * (drop - self.lobe) / (2.0 - self.lobe)
        }
    }

    fn cell(&self, w: DVec3) -> usize {
        let local = self.frame.to_local(w);
        let ring = (self.ring(1.0 - local.z) * RINGS as f64) as usize;
        let turns = (local.y.atan2(local.x) / TAU).rem_euclid(1.0);
        let sector = (turns * SECTORS as f64) as usize;
        ring.min(RINGS - 1) * SECTORS + sector.min(SECTORS - 1)
    }

    fn direction(&self, t: f64, turns: f64) -> DVec3 {
        self.frame.to_world(at(1.0 - self.drop(t), turns))
    }

    /// Integral of `pdf` over a rectangle of the coordinates, by halving until it settles.
    fn integral(
        &self,
        pdf: &dyn Fn(DVec3) -> f64,
        low: [f64; 2],
        high: [f64; 2],
        depth: u32,
    ) -> f64 {
        let whole = self.gauss(pdf, low, high);
        let middle = [(low[0] + high[0]) / 2.0, (low[1] + high[1]) / 2.0];
        let parts = [
            (low, middle),
            ([middle[0], low[1]], [high[0], middle[1]]),
            ([low[0], middle[1]], [middle[0], high[1]]),
            (middle, high),
        ];
        let (mut fine, mut least, mut most) = (0.0, whole.1, whole.2);
        for (a, b) in &parts {
            let part = self.gauss(pdf, *a, *b);
            fine += part.0;
            least = least.min(part.1);
            most = most.max(part.2);
        }
        for w in self
            .corners(low, high)
            .into_iter()
            .filter(|w| w.z * self.side > 0.0)
        {
            let value = pdf(w);
            least = least.min(value);
            most = most.max(value);
        }
        let settled = (fine - whole.0).abs() < 1e-7 + 3e-5 * fine;
        // Two rules that agree by chance across a jump are not rare, and at the horizon a sliver
        // or a narrow band may hide between the points.
        let rough = depth > 3 && (most > 4.0 * least || self.straddles(low, high));
        if depth == 0 || (settled && !rough) {
            return fine;
        }
        parts
            .iter()
            .map(|(a, b)| self.integral(pdf, *a, *b, depth - 1))
            .sum()
    }

    fn corners(&self, low: [f64; 2], high: [f64; 2]) -> [DVec3; 4] {
        [low, [low[0], high[1]], [high[0], low[1]], high].map(|c| self.direction(c[0], c[1]))
    }

    /// Are some but not all corners of the rectangle on the side that counts?
    fn straddles(&self, low: [f64; 2], high: [f64; 2]) -> bool {
        let inside = self.corners(low, high).map(|w| w.z * self.side > 1e-6);
        inside.contains(&true) && inside.contains(&false)
    }

    /// Integral by nine points, and the least and the largest value met.
    fn gauss(&self, pdf: &dyn Fn(DVec3) -> f64, low: [f64; 2], high: [f64; 2]) -> (f64, f64, f64) {
        const RULE: [(f64, f64); 3] = [
            (0.112_701_665_379_258_3, 0.277_777_777_777_777_8),
            (0.5, 0.444_444_444_444_444_4),
            (0.887_298_334_620_741_7, 0.277_777_777_777_777_8),
        ];
        let (mut sum, mut least, mut most) = (0.0, f64::INFINITY, 0.0f64);
        for (x, wx) in RULE {
            let t = low[0] + (high[0] - low[0]) * x;
            let slope = self.slope(t);
            for (y, wy) in RULE {
                let w = self.direction(t, low[1] + (high[1] - low[1]) * y);
                let value = if w.z * self.side > 0.0 { pdf(w) } else { 0.0 };
                sum += wx * wy * slope * value;
                least = least.min(value);
                most = most.max(value);
            }
        }
        (
            sum * (high[0] - low[0]) * (high[1] - low[1]) * TAU,
            least,
            most,
        )
    }

    /// `pdf` over each cell, which may be halved `depth` times.
    fn expected(&self, pdf: &dyn Fn(DVec3) -> f64, depth: u32) -> Vec<f64> {
        let size = [0.5 / RINGS as f64, 0.5 / SECTORS as f64];
        let quarter = |i: usize, j: usize| {
            let low = [i as f64 * size[0], j as f64 * size[1]];
            self.integral(pdf, low, [low[0] + size[0], low[1] + size[1]], depth)
        };
        (0..RINGS * SECTORS)
            .map(|cell| (2 * (cell / SECTORS), 2 * (cell % SECTORS)))
            .map(|(i, j)| {
                quarter(i, j) + quarter(i + 1, j) + quarter(i, j + 1) + quarter(i + 1, j + 1)
            })
            .collect()
    }
}

/// Where light from `wo` should mostly go on its own side and on the other, and how narrowly.
fn peaks(case: &Case, wo: DVec3) -> [(DVec3, f64); 2] {
    let ahead = if wo.z > 0.0 { case.eta } else { 1.0 / case.eta };
    let across = -DVec3::new(wo.x, wo.y, 0.0) / ahead;
    let z2 = 1.0 - across.length_squared();
    let refracted = if z2 > 0.0 {
        (
            DVec3::new(across.x, across.y, -wo.z.signum() * z2.sqrt()),
            case.width,
        )
    } else {
        (DVec3::new(0.0, 0.0, -wo.z.signum()), 1.0)
    };
    [(DVec3::new(-wo.x, -wo.y, wo.z), case.width), refracted]
}

/// The probability of a worse chi-square than that of `samples` draws against `pdf`.
pub(crate) fn p_value(
    case: &Case,
    lobe: &impl Lobe,
    wo: DVec3,
    mode: Mode,
    samples: usize,
    seed: u64,
) -> f64 {
    let cells = peaks(case, wo).map(|(axis, width)| Cells::new(axis, width));
    let depth = if samples > 100_000 { 10 } else { 6 };
    let pdf = |wi: DVec3| lobe.pdf(wo, wi, mode);
    let mut expected: Vec<f64> = cells
        .iter()
        .flat_map(|cells| cells.expected(&pdf, depth))
        .collect();
    let mut counts = vec![0.0; expected.len()];
    let mut deltas: Vec<(DVec3, f64, f64)> = Vec::new();
    let mut absorbed = 0.0;
    let mut random = Random::new(seed);
    for _ in 0..samples {
        let (uc, u) = (random.uniform(), [random.uniform(), random.uniform()]);
        match lobe.sample(wo, uc, u, mode) {
            None => absorbed += 1.0,
            Some(s) if s.delta => {
                // two lobes may share a direction, but not a density
                let known = deltas
                    .iter_mut()
                    .find(|(wi, pdf, _)| wi.distance(s.wi) < 1e-9 && (pdf - s.pdf).abs() < 1e-12);
                match known {
                    Some((_, _, count)) => *count += 1.0,
                    None => deltas.push((s.wi, s.pdf, 1.0)),
                }
            }
            Some(s) => {
                let side = usize::from(s.wi.z * wo.z < 0.0);
                counts[side * RINGS * SECTORS + cells[side].cell(s.wi)] += 1.0;
            }
        }
    }
    for (_, pdf, count) in deltas {
        expected.push(pdf);
        counts.push(count);
    }
    let total: f64 = expected.iter().sum();
    if total > 1.0 + 1e-3 {
        return 0.0;
    }
    expected.push((1.0 - total).max(0.0));
    counts.push(absorbed);
    compare(&expected, &counts, samples as f64)
}

/// Chi-square over cells, pooled until five are expected in each.
fn compare(expected: &[f64], counts: &[f64], samples: f64) -> f64 {
    let mut order: Vec<usize> = (0..expected.len()).collect();
    order.sort_by(|a, b| expected[*b].total_cmp(&expected[*a]));
    let (mut chi2, mut cells) = (0.0, 0);
    let (mut e, mut c) = (0.0, 0.0);
    for i in order {
        e += expected[i] * samples;
        c += counts[i];
        if e >= 5.0 {
            chi2 += (c - e) * (c - e) / e;
            cells += 1;
            (e, c) = (0.0, 0.0);
        }
    }
    // what is left expects less than five
    if e < 1e-3 * 5.0 && c > 2.0 {
        return 0.0;
    }
    if e > 0.0 {
        chi2 += (c - e) * (c - e) / e.max(1.0);
    }
    let freedom = (cells as f64 - 1.0).max(1.0);
    ChiSquared::new(freedom).map_or(0.0, |law| law.sf(chi2))
}

pub(crate) fn directions(case: &Case) -> Vec<DVec3> {
    let below = if !case.refracts() { 0.3 } else { 0.95 };
    [
        (0.98, 0.2),
        (0.6, 0.7),
        (0.12, 0.45),
        (-below, 0.1),
        (-0.5, 0.9),
    ]
    .map(|(z, turns): (f64, f64)| at(z, turns))
    .to_vec()
}

/// The Sidak bound for `tests` tests at 1 % together.
pub(crate) fn bound(tests: usize) -> f64 {
    1.0 - 0.99f64.powf(1.0 / tests as f64)
}

fn check(cases: &[Case], samples: usize) {
    let from = |case| directions(case).into_iter().map(move |wo| (case, wo));
    let tests: Vec<(&Case, DVec3)> = cases.iter().flat_map(from).collect();
    let bound = bound(tests.len());
    let next = AtomicUsize::new(0);
    let worker = || {
        let mut failed = Vec::new();
        loop {
            let at = next.fetch_add(1, Ordering::Relaxed);
            let Some(&(case, wo)) = tests.get(at) else {
                return failed;
            };
            let mode = [Mode::Importance, Mode::Radiance][at % 2];
            let p = p_value(case, &case.bsdf, wo, mode, samples, at as u64 + 1);
            if p.is_nan() || p <= bound {
                failed.push(format!("{} from {wo}, {mode:?}: p = {p}", case.name));
            }
        }
    };
    let threads = thread::available_parallelism().map_or(1, usize::from);
    let failed: Vec<String> = thread::scope(|scope| {
        let workers: Vec<_> = (0..threads).map(|_| scope.spawn(worker)).collect();
        let join = |worker: thread::ScopedJoinHandle<'_, _>| worker.join().expect("a worker");
        workers.into_iter().flat_map(join).collect()
    });
    assert!(failed.is_empty(), "of {}: {failed:#?}", tests.len());
}

#[test]
fn samples_follow_the_density() {
    // one in five, a number that has no divisor in common with those of kinds: all come by, at one roughness or another
    let cases: Vec<Case> = some().into_iter().step_by(5).collect();
    check(&cases, 20_000);
}

#[test]
#[ignore = "long"]
fn many_samples_follow_the_density() {
    let mut cases = some();
    for alpha in [0.005, 0.03, 0.2, 0.7] {
        cases.extend(facets(alpha, true));
    }
    cases.extend(facets(1.0, false));
    cases.extend(principled(0.35));
    cases.extend(layers(0.35));
    check(&cases, 1_000_000);
}
