use std::f64::consts::{PI, TAU};

use glam::{DVec2, DVec3};
use kaustik_bsdf::warp;

use crate::description::{Blades, Lens};

/// The opening of a thin lens in its plane: a disk, or a regular polygon.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Aperture {
    radius: f64,
    polygon: Option<Polygon>,
}

#[derive(Clone, Debug, PartialEq)]
struct Polygon {
    corners: f64,
    rotation: f64,
}

impl Aperture {
    /// The opening of `lens`, whose numbers are in range.
    pub(super) fn new(lens: &Lens) -> Self {
        let polygon = |blades: Blades| Polygon {
            corners: f64::from(blades.count),
            rotation: f64::from(blades.rotation),
        };
        Self {
            radius: f64::from(lens.aperture),
            polygon: lens.blades.map(polygon),
        }
    }

    /// Of the disk, or of the circle through the polygon's corners.
    pub(super) fn radius(&self) -> f64 {
        self.radius
    }

    /// In square scene units.
    pub(super) fn area(&self) -> f64 {
        let square = self.radius * self.radius;
        match &self.polygon {
            None => PI * square,
            Some(polygon) => 0.5 * polygon.corners * square * libm::sin(TAU / polygon.corners),
        }
    }

    /// A point of the opening, uniform by area; continuous in `u` in [0,1)^2. On a polygon the disk's
    /// rings become similar polygons, and its sectors the triangles over the edges.
    pub(super) fn point(&self, u: [f64; 2]) -> DVec3 {
        let [x, y] = warp::concentric_disk(u);
        let Some(polygon) = &self.polygon else {
            return DVec3::new(x, y, 0.0) * self.radius;
        };
        let turns = libm::atan2(y, x) / TAU;
        let along = (turns - turns.floor()) * polygon.corners;
        // rounding may come to the last corner's successor, which is the first
        let edge = along.floor();
        let ring = self.radius * (x * x + y * y).sqrt().min(1.0);
        let point = polygon
            .corner(edge)
            .lerp(polygon.corner(edge + 1.0), along - edge);
        (point * ring).extend(0.0)
    }

    /// Is a point of the plane within the opening?
    pub(super) fn holds(&self, point: DVec3) -> bool {
        let distance = (point.x * point.x + point.y * point.y).sqrt();
        let Some(polygon) = &self.polygon else {
            return distance <= self.radius;
        };
        let sector = TAU / polygon.corners;
        let angle = libm::atan2(point.y, point.x) - polygon.rotation;
        // from the middle of the edge
        let angle = angle - sector * (angle / sector).floor() - 0.5 * sector;
        distance * libm::cos(angle) <= self.radius * libm::cos(0.5 * sector)
    }
}

impl Polygon {
    fn corner(&self, index: f64) -> DVec2 {
        let angle = self.rotation + TAU * index / self.corners;
        DVec2::new(libm::cos(angle), libm::sin(angle))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{Rng, chi_square};

    fn polygon(count: u32) -> Aperture {
        Aperture::new(&Lens {
            aperture: 0.7,
            focus: 3.0,
            blades: Some(Blades {
                count,
                rotation: 0.4,
            }),
        })
    }

    /// p-value of points being uniform over the cells of a grid, whose shares of the opening are
    /// found by [`Aperture::holds`].
    fn p_value(aperture: &Aperture, point: impl Fn([f64; 2]) -> DVec3) -> f64 {
        const CELLS: usize = 12;
        const SUB: usize = 60;
        let edge = 1.42;
        let mut rng = Rng::new(17);
        let mut observed = vec![0.0; CELLS * CELLS];
        let samples = 200_000;
        for _ in 0..samples {
            let at = point(rng.pair());
            let cell = |x: f64| (((x / edge + 0.5) * CELLS as f64) as usize).min(CELLS - 1);
            observed[cell(at.y) * CELLS + cell(at.x)] += 1.0;
        }
        let mut expected = vec![0.0; CELLS * CELLS];
        let n = CELLS * SUB;
        for i in 0..n * n {
            let [x, y] = [i % n, i / n].map(|k| edge * ((k as f64 + 0.5) / n as f64 - 0.5));
            if aperture.holds(DVec3::new(x, y, 0.0)) {
                expected[(i / n / SUB) * CELLS + (i % n) / SUB] += 1.0;
            }
        }
        let total: f64 = expected.iter().sum();
        let area = total * (edge / n as f64) * (edge / n as f64);
        assert!((area / aperture.area() - 1.0).abs() < 2e-3, "{area}");
        for e in &mut expected {
            *e *= f64::from(samples) / total;
        }
        // a cell of which the opening has a sliver is known only as well as the quadrature
        let (mut o, mut e) = (Vec::new(), Vec::new());
        let (mut rest_o, mut rest_e) = (0.0, 0.0);
        for (a, b) in observed.iter().zip(&expected) {
            if *b > 100.0 {
                o.push(*a);
                e.push(*b);
            } else {
                rest_o += a;
                rest_e += b;
            }
        }
        o.push(rest_o);
        e.push(rest_e.max(1e-9));
        if rest_e < 1e-9 {
            o.pop();
            e.pop();
        }
        chi_square(&o, &e)
    }

    #[test]
    fn points_are_uniform_over_the_polygon() {
        for count in [3, 5, 6, 64] {
            let aperture = polygon(count);
            let p = p_value(&aperture, |u| aperture.point(u));
            assert!(p > 1e-4, "{count} blades: p = {p}");
        }
    }

    #[test]
    fn points_that_are_not_uniform_are_caught() {
        let aperture = polygon(5);
        let disk = |u| {
            let [x, y] = warp::concentric_disk(u);
            DVec3::new(x, y, 0.0) * 0.7
        };
        assert!(p_value(&aperture, disk) < 1e-6);
        let crowded = |u| aperture.point(u) * 0.98;
        assert!(p_value(&aperture, crowded) < 1e-6);
    }

    #[test]
    fn points_lie_within_and_steps_are_small() {
        let mut rng = Rng::new(3);
        for aperture in [polygon(3), polygon(7)] {
            for _ in 0..20_000 {
                let [x, y] = rng.pair().map(|u| 0.999 * u);
                let a = aperture.point([x, y]);
                assert!(aperture.holds(a * (1.0 - 1e-9)), "{a}");
                let b = aperture.point([x + 1e-6, y + 1e-6]);
                assert!(a.distance(b) < 1e-5, "a jump from {a} to {b}");
            }
            assert!(!aperture.holds(DVec3::X * 0.701));
        }
        // corners on the circle, the first one at the rotation
        let triangle = polygon(3);
        let at = |angle: f64| DVec3::new(angle.cos(), angle.sin(), 0.0) * 0.699;
        let rotation = f64::from(0.4_f32);
        assert!(triangle.holds(at(rotation)));
        assert!(!triangle.holds(at(rotation + TAU / 6.0) * 0.51));
        assert!(triangle.holds(at(rotation + TAU / 6.0) * 0.49));
    }
}
