//! The triangles around a point of a surface.

use glam::{Vec2, Vec3};
use kaustik_geometry::World;

use super::outline::ends;
use super::point::agree;

/// Where more triangles than these are near, not all of them are asked.
const MOST_NEAR: usize = 64;
/// Where more than these are of the point's own surface, it is taken to go on, so that looking around takes little time.
const MOST_OWN: usize = 16;
/// Triangles reach over their edges by so much of the radius: neighbours leave no gap.
const JOINT: f32 = 1e-3;

/// What is within a radius of a point: does something face otherwise, and how far do the triangles of its own surface go on?
pub(super) struct Nearby {
    /// Does something face otherwise? Also where that is not known.
    broken: bool,
    /// Does its surface go on all around, as far as is known?
    whole: bool,
    count: usize,
    /// Corners of triangles of its surface in the tangent plane, from the point.
    own: [[Vec2; 3]; MOST_OWN],
    /// How far these reach over their edges, in scene units.
    joint: f32,
}

impl Nearby {
    /// Looks around in a plane with these axes and this normal.
    pub(super) fn look(
        world: &World,
        center: Vec3,
        [x, y, normal]: [Vec3; 3],
        radius: f32,
    ) -> Self {
        let mut nearby = Self {
            broken: false,
            whole: false,
            count: 0,
            own: [[Vec2::ZERO; 3]; MOST_OWN],
            joint: JOINT * radius,
        };
        let mut offered = 0;
        let (at, reach) = (center.as_dvec3(), f64::from(radius));
        let too_many = world.any_near(center, radius, |corners| {
            offered += 1;
            if offered > MOST_NEAR {
                return true;
            }
            let [a, b, c] = corners.map(|corner| corner.as_dvec3());
            let across = (b - a).cross(c - a);
            let size = across.length();
            // one without an area reaches nowhere
            if across.dot(at - a).abs() < reach * size {
                let facing = (across / size).as_vec3();
                nearby.broken |= ends(normal, facing);
                if agree(normal, facing) || agree(-normal, facing) {
                    nearby.add(
                        corners.map(|corner| {
                            let from = corner - center;
                            Vec2::new(x.dot(from), y.dot(from))
                        }),
                        radius,
                    );
                }
            }
            nearby.broken && nearby.whole
        });
        // or nothing is left to be asked
        nearby.broken |= too_many;
        nearby.whole |= too_many;
        nearby
    }

    fn add(&mut self, triangle: [Vec2; 3], radius: f32) {
        self.whole |= self.count == MOST_OWN || holds_disc(triangle, radius);
        if !self.whole {
            self.own[self.count] = triangle;
            self.count += 1;
        }
    }

    /// Does something face otherwise?
    pub(super) fn is_broken(&self) -> bool {
        self.broken
    }

    /// Is there nothing but more of the surface, all around? Where one triangle holds the disc this takes no second look.
    pub(super) fn goes_on(&self) -> bool {
        !self.broken && self.whole
    }

    /// How far its triangles go on in a direction of the plane, at most `radius`. That far where none of them is known to hold the point.
    pub(super) fn covered(&self, direction: Vec2, radius: f32) -> f32 {
        if self.whole {
            return radius;
        }
        let mut reach = 0.0_f32;
        loop {
            let before = reach;
            for &triangle in &self.own[..self.count] {
                if let Some([enter, leave]) = crossing(triangle, direction, self.joint)
                    && enter <= reach
                {
                    reach = reach.max(leave);
                }
            }
            if reach >= radius || reach <= 0.0 {
                return radius;
            }
            if reach <= before {
                return reach;
            }
        }
    }
}

/// Its edges in the sense in which its inside is on their left.
fn edges([a, b, c]: [Vec2; 3]) -> [[Vec2; 2]; 3] {
    if (b - a).perp_dot(c - a) > 0.0 {
        [[a, b], [b, c], [c, a]]
    } else {
        [[b, a], [c, b], [a, c]]
    }
}

/// Does it hold all of a disc around the origin?
fn holds_disc(triangle: [Vec2; 3], radius: f32) -> bool {
    let inside = |[p, q]: [Vec2; 2]| p.perp_dot(q) >= radius * p.distance(q);
    edges(triangle).into_iter().all(inside)
}

/// From where to where a ray from the origin is in a triangle that reaches over its edges by `joint`; direction of unit length.
fn crossing(triangle: [Vec2; 3], direction: Vec2, joint: f32) -> Option<[f32; 2]> {
    let (mut enter, mut leave) = (0.0_f32, f32::INFINITY);
    for [p, q] in edges(triangle) {
        let edge = q - p;
        let inside = p.perp_dot(q) + joint * edge.length();
        let rise = edge.perp_dot(direction);
        if rise > 0.0 {
            enter = enter.max(-inside / rise);
        } else if rise < 0.0 {
            leave = leave.min(-inside / rise);
        } else if inside < 0.0 {
            return None;
        }
    }
    (enter <= leave).then_some([enter, leave])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_cross_triangles_of_either_sense() {
        let [a, b, c] = [
            Vec2::new(1.0, -1.0),
            Vec2::new(3.0, -1.0),
            Vec2::new(1.0, 1.0),
        ];
        for triangle in [[a, b, c], [c, b, a]] {
            let [enter, leave] = crossing(triangle, Vec2::X, 0.0).expect("it is ahead");
            assert!(
                (enter - 1.0).abs() < 1e-6 && (leave - 2.0).abs() < 1e-6,
                "{enter} {leave}"
            );
            assert_eq!(crossing(triangle, Vec2::Y, 0.0), None);
            assert_eq!(crossing(triangle, -Vec2::X, 0.0), None);
        }
    }

    #[test]
    fn a_disc_is_within_a_triangle_or_is_not() {
        let around = [
            Vec2::new(-4.0, -1.0),
            Vec2::new(4.0, -1.0),
            Vec2::new(0.0, 8.0),
        ];
        assert!(holds_disc(around, 0.99) && !holds_disc(around, 1.01));
        assert!(!holds_disc(around.map(|at| at + 5.0), 0.1));
    }
}
