//! The laws of emitters: what is drawn has the density that is stated, and carries the energy that
//! there is.

mod densities;
mod direct;
mod emission;
mod energy;
mod tree;

use std::f64::consts::{PI, TAU};

use glam::{DVec3, Quat};
use kaustik_bsdf::Frame;

use crate::description::Pixels;
use crate::testing::{Stage, chi_square, image, level};

/// Samples of a test in the fast half, and in the long one.
const FAST: u32 = 100_000;
const LONG: u32 = 1_000_000;

/// All chi-square tests of emitters together reject the truth once in a hundred times.
fn accepts(observed: &[f64], expected: &[f64]) -> bool {
    chi_square(observed, expected) > level(24)
}

/// A stage with grey radiance around it, `width` texels a row.
fn under_sky(stage: Stage, width: u32, texels: &[f32]) -> Stage {
    let pixels = Pixels::RgbF32(texels.iter().flat_map(|&v| [v; 3]).collect());
    let picture = image(width, texels.len() as u32 / width, pixels);
    stage.environment_map(picture, Quat::from_rotation_x(0.7))
}

/// A grid over the sphere of equal solid angles, about `frame.z`.
#[derive(Clone, Copy)]
struct Sphere {
    frame: Frame,
    rows: usize,
    columns: usize,
}

impl Sphere {
    fn new(axis: DVec3, rows: usize, columns: usize) -> Self {
        let frame = Frame::from_z(axis);
        Self {
            frame,
            rows,
            columns,
        }
    }

    fn len(&self) -> usize {
        self.rows * self.columns
    }

    fn cell(&self, direction: DVec3) -> usize {
        let local = self.frame.to_local(direction);
        let row = cell(0.5 * (1.0 + local.z), self.rows);
        row * self.columns + cell(turns(local.x, local.y), self.columns)
    }

    /// Integral of a density over each cell, by `fine` x `fine` points.
    fn integrate(&self, fine: usize, density: impl Fn(DVec3) -> f64) -> Vec<f64> {
        let mut cells = vec![0.0; self.len()];
        let (rows, columns) = (self.rows * fine, self.columns * fine);
        let share = 4.0 * PI / (rows * columns) as f64;
        for row in 0..rows {
            let z = 2.0 * (row as f64 + 0.5) / rows as f64 - 1.0;
            let radius = (1.0 - z * z).sqrt();
            for column in 0..columns {
                let phi = TAU * (column as f64 + 0.5) / columns as f64;
                let local = DVec3::new(radius * libm::cos(phi), radius * libm::sin(phi), z);
                let index = row / fine * self.columns + column / fine;
                cells[index] += density(self.frame.to_world(local)) * share;
            }
        }
        cells
    }
}

/// The cell of a number in [0, 1] among `count`.
fn cell(x: f64, count: usize) -> usize {
    ((x * count as f64) as usize).min(count - 1)
}

/// The angle of a point in the plane, in [0, 1].
fn turns(x: f64, y: f64) -> f64 {
    let turns = libm::atan2(y, x) / TAU;
    if turns < 0.0 { turns + 1.0 } else { turns }
}
