//! How far a surface goes on around a point.
//!
//! A disc is to count what lands on the surface that its point lies on. Where a wall stands on a floor, half of a disc at
//! its foot lies behind it: photons there belong to another room, and those that would be in that half are missing in
//! this one. And a disc at the edge of a table lies half in the air. Short rays tell where something stands on the surface
//! and, from inside what it bounds, where that ends; the disc ends there too. Where a sheet ends that bounds nothing, its
//! triangles tell.

use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_4, PI};

use glam::{Vec2, Vec3};
use kaustik_geometry::{Hit, Ray, Surface, World};

use super::nearby::Nearby;
use super::point::agree;

/// Normals whose cosine is less (within about 6 degrees of opposite ones) belong to two faces of a plate.
const OPPOSITE: f32 = -0.995;

/// Rays around a point, at equal angles.
const SIDES: usize = 8;
/// Their directions, the first once more at the end.
const DIRECTIONS: [Vec2; SIDES + 1] = {
    const D: f32 = FRAC_1_SQRT_2 as f32;
    [
        Vec2::new(1.0, 0.0),
        Vec2::new(D, D),
        Vec2::new(0.0, 1.0),
        Vec2::new(-D, D),
        Vec2::new(-1.0, 0.0),
        Vec2::new(-D, -D),
        Vec2::new(0.0, -1.0),
        Vec2::new(D, -D),
        Vec2::new(1.0, 0.0),
    ]
};
/// Rays rise from the surface by so much of their length.
const RISE: f32 = 1.0 / 64.0;
/// Of a disc in a crack less than this part is free. That few photons are not all its light, its sides are made as long as
/// [`LEAST_SIDE`] of the radius at least.
const LEAST_FREE: f64 = 1.0 / 32.0;
const LEAST_SIDE: u8 = FREE / 8;
/// The length of a side that nothing ends; lengths are in parts of that.
const FREE: u8 = u8::MAX;

/// A polygon around a point, in its tangent plane, by the distances of its corners. Those that are not within a disc's
/// radius leave the disc round.
///
/// Many pixels may have one: lengths are rounded down to what a byte tells. The area is that of the polygon
/// as it is then.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Outline {
    /// Of the disc that it was made for, in scene units. The disc may have shrunk since.
    radius: f32,
    /// Lengths in parts of that.
    sides: [u8; SIDES],
}

impl Outline {
    /// Looks around as far as `radius`, in scene units. On the seen side of a surface, that of its `normal` if it is seen
    /// from `above`, whatever stands there ends it. On the other side it ends where a ray comes out of the solid that it
    /// bounds; what a ray goes into there stands behind a sheet, and is none of its affair unless light comes `through` that. What faces as the surface does is more
    /// of the same, and what faces the opposite way, as the back of a thin plate, ends nothing. It ends where the last of its triangles does as
    /// well. `None` where nothing is in the way, or for a radius that no disc can have.
    pub(super) fn look(
        world: &World,
        surface: &Surface,
        normal: Vec3,
        above: bool,
        through: bool,
        radius: f32,
    ) -> Option<Self> {
        if !radius.is_normal() {
            return None;
        }
        let [x, y] = plane(normal);
        let nearby = Nearby::look(world, surface.position, [x, y, normal], radius);
        if nearby.goes_on() {
            return None;
        }
        let seen = if above { normal } else { -normal };
        let sides = std::array::from_fn(|side| {
            let [along, across] = DIRECTIONS[side].to_array();
            let free = |up: Vec3, behind: bool| {
                let direction = x * along + y * across + up * RISE;
                let ray = Ray {
                    t_max: radius,
                    ..Ray::spawn(surface, direction)
                };
                let facing = |hit: &Hit| world.surface(&ray, hit).geometric_normal;
                let other = world.intersect_filtered(&ray, |hit| ends(normal, facing(hit)));
                match other {
                    Some(hit) if !behind || direction.dot(facing(&hit)) > 0.0 => {
                        (hit.t / radius * f32::from(FREE)) as u8
                    }
                    _ => FREE,
                }
            };
            let covered = nearby.covered(DIRECTIONS[side], radius);
            let end = (covered / radius * f32::from(FREE)) as u8;
            if nearby.is_broken() {
                end.min(free(seen, false)).min(free(-seen, !through))
            } else {
                end
            }
        });
        let outline = Self { radius, sides };
        (sides != [FREE; SIDES]).then(|| outline.widened())
    }

    /// Not as narrow as a crack may be.
    fn widened(self) -> Self {
        let disc = PI * f64::from(self.radius) * f64::from(self.radius);
        if self.area(self.radius) >= LEAST_FREE * disc {
            return self;
        }
        Self {
            sides: self.sides.map(|side| side.max(LEAST_SIDE)),
            ..self
        }
    }

    /// What it leaves of a disc, in square scene units.
    pub(super) fn area(&self, radius: f32) -> f64 {
        let sectors = (0..SIDES).map(|side| {
            let [a, b] = self.ends(side, radius).map(f64::from);
            if self.is_round(side, radius) {
                FRAC_PI_4 * a * b
            } else {
                FRAC_1_SQRT_2 * a * b
            }
        });
        0.5 * sectors.sum::<f64>()
    }

    /// Is a point of the disc, `offset` from its centre, on this side of what stands there?
    #[inline]
    pub(super) fn holds(&self, normal: Vec3, radius: f32, offset: Vec3) -> bool {
        let at = Vec2::from_array(plane(normal).map(|axis| axis.dot(offset)));
        let side = sector(at);
        if self.is_round(side, radius) {
            return true;
        }
        let [a, b] = self.ends(side, radius);
        let [a, b] = [DIRECTIONS[side] * a, DIRECTIONS[side + 1] * b];
        (b - a).perp_dot(at - a) > 0.0
    }

    /// Both ends of a sector, within the disc.
    #[inline]
    fn ends(&self, side: usize, radius: f32) -> [f32; 2] {
        let scale = self.radius / f32::from(FREE);
        [side, (side + 1) % SIDES].map(|end| match self.sides[end] {
            FREE => radius,
            part => (f32::from(part) * scale).min(radius),
        })
    }

    /// Is a sector the whole disc's?
    #[inline]
    fn is_round(&self, side: usize, radius: f32) -> bool {
        self.ends(side, radius).iter().all(|&end| end >= radius)
    }
}

/// Does a face that faces so end a surface of this normal: neither more of it nor the back of a plate?
#[inline]
pub(super) fn ends(normal: Vec3, facing: Vec3) -> bool {
    !agree(normal, facing) && normal.dot(facing) > OPPOSITE
}

/// Two axes in the plane across a unit normal. They jump where a normal turns: one and the same serves both who makes
/// an outline and who asks it.
#[inline]
fn plane(normal: Vec3) -> [Vec3; 2] {
    let (x, y) = normal.any_orthonormal_pair();
    [x, y]
}

/// The eighth of the plane that holds a point, counted from the first axis.
#[inline]
fn sector(at: Vec2) -> usize {
    let (steep, left, below) = (at.y.abs() > at.x.abs(), at.x < 0.0, at.y < 0.0);
    match (left, below) {
        (false, false) => usize::from(steep),
        (true, false) => 3 - usize::from(steep),
        (true, true) => 4 + usize::from(steep),
        (false, true) => 7 - usize::from(steep),
    }
}

#[cfg(test)]
impl Outline {
    /// A quarter and half an eighth on either side of it are free, from the fourth to the seventh ray.
    pub(super) fn mostly_blocked() -> Self {
        Self {
            radius: 1.0,
            sides: [0, 0, 0, 0, FREE, FREE, FREE, FREE],
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::{Affine3A, Quat};
    use kaustik_geometry::{Instance, Mesh};
    use kaustik_mcmc::{Draws, generator};

    use super::*;

    const COUNT: u32 = 20_000;

    /// Places in the plane, some of which count: the same part of it as the area says, up to noise. Returns which count.
    fn held(outline: &Outline, normal: Vec3, radius: f32, turn: Quat) -> Vec<(Vec2, bool)> {
        let mut draws = generator(5, 0);
        let mut places = Vec::new();
        while places.len() < COUNT as usize {
            let at = Vec2::from([0; 2].map(|_| 2.0 * draws.uniform() as f32 - 1.0)) * radius;
            if at.length() < radius {
                let offset = turn * at.extend(0.0);
                places.push((at, outline.holds(normal, radius, offset)));
            }
        }
        let free = places.iter().filter(|(_, holds)| *holds).count() as f64 / f64::from(COUNT);
        let area = outline.area(radius) / (PI * f64::from(radius * radius));
        assert!((free - area).abs() < 0.015, "{free} {area}");
        places
    }

    fn rotations() -> impl Iterator<Item = Quat> {
        let mut draws = generator(6, 0);
        let any = std::iter::repeat_with(move || {
            let [a, b, c] = [0; 3].map(|_| 7.0 * draws.uniform() as f32);
            Quat::from_euler(glam::EulerRot::ZXZ, a, b, c)
        });
        std::iter::once(Quat::IDENTITY).chain(any)
    }

    /// A box of these corners, its sides facing out, as seen from a place that is turned; mirrored and not.
    fn solid(low: Vec3, high: Vec3, turn: Quat, mirrored: bool) -> World {
        let corner = |bits: usize| {
            let at = |axis: usize| [low, high][bits >> axis & 1][axis];
            Vec3::new(at(0), at(1), at(2))
        };
        let positions: Vec<Vec3> = (0..8).map(corner).collect();
        let quads = [
            [0, 4, 6, 2],
            [1, 3, 7, 5],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 2, 3, 1],
            [4, 5, 7, 6],
        ];
        let halves = |[a, b, c, d]: [u32; 4]| [[a, b, c], [a, c, d]];
        let indices = quads.into_iter().flat_map(halves).collect();
        let mut transform = Affine3A::from_quat(turn);
        let mut mesh = Mesh::new(positions, indices).expect("a box");
        if mirrored {
            // twice: the same solid
            transform *= Affine3A::from_scale(Vec3::new(-1.0, 1.0, 1.0));
            mesh.positions.iter_mut().for_each(|p| p.x = -p.x);
            mesh.indices.iter_mut().for_each(|t| t.swap(1, 2));
        }
        let instance = Instance { mesh: 0, transform };
        World::build(vec![Arc::new(mesh)], vec![instance]).expect("a world")
    }

    fn look(world: &World, turn: Quat, center: Vec3, radius: f32) -> Option<Outline> {
        let surface = Surface::bare(turn * center, turn * Vec3::Z);
        Outline::look(world, &surface, turn * Vec3::Z, true, false, radius)
    }

    /// Points of a floor at many distances from a wall, on both sides of it: nothing behind the wall counts, and on this side
    /// all but what chords cut off.
    #[test]
    fn a_disc_ends_at_a_wall() {
        for turn in rotations().take(20) {
            // the floor is where the points are
            let (low, high) = (Vec3::new(0.0, -9.0, -1.0), Vec3::new(0.1, 9.0, 3.0));
            let world = solid(low, high, turn, false);
            for from in [0.9_f32, 0.5, 0.2, 0.02, -0.12, -0.5] {
                let center = Vec3::new(-from, 0.3, 0.0);
                let outline = look(&world, turn, center, 1.0).expect("a wall");
                // discs shrink, and keep their outline
                for radius in [0.7, 0.3] {
                    held(&outline, turn * Vec3::Z, radius, turn);
                }
                let mut lost = 0;
                for (at, holds) in held(&outline, turn * Vec3::Z, 1.0, turn) {
                    let x = center.x + at.x;
                    let free = if from > 0.0 { x < 0.0 } else { x > 0.1 };
                    assert!(free || !holds || x.abs() < 1e-4, "{from} {at}");
                    lost += u32::from(free && !holds);
                }
                assert!(lost < COUNT / 5, "{from} {lost}");
            }
            assert_eq!(look(&world, turn, Vec3::new(-1.5, 0.0, 0.0), 1.0), None);
        }
    }

    /// A sheet of squares with a corner at the origin, each of two triangles, as seen from a place that is turned.
    fn sheet(squares: [[f32; 4]; 2], turn: Quat) -> World {
        let corners = squares.map(|[x0, y0, x1, y1]| {
            [[x0, y0], [x1, y0], [x1, y1], [x0, y1]].map(|[x, y]| Vec3::new(x, y, 0.0))
        });
        let mesh = |corners: [Vec3; 4]| {
            Arc::new(Mesh::new(corners.to_vec(), vec![[0, 1, 2], [0, 2, 3]]).expect("a square"))
        };
        let instance = |mesh| Instance {
            mesh,
            transform: Affine3A::from_quat(turn),
        };
        World::build(corners.map(mesh).to_vec(), vec![instance(0), instance(1)]).expect("a world")
    }

    /// Points of a sheet of two squares side by side: nothing beyond its border counts, on this side of it all but what chords cut
    /// off, and there is no border between the two.
    #[test]
    fn a_disc_ends_at_the_border_of_a_sheet() {
        for turn in rotations().take(20) {
            let world = sheet([[-9.0, -9.0, 0.0, 0.5], [-9.0, 0.5, 0.0, 9.0]], turn);
            for from in [0.9_f32, 0.5, 0.1, 0.01] {
                let center = Vec3::new(-from, 0.3, 0.0);
                let outline = look(&world, turn, center, 1.0).expect("a border");
                let mut lost = 0;
                for (at, holds) in held(&outline, turn * Vec3::Z, 1.0, turn) {
                    let free = at.x < from;
                    assert!(free || !holds || at.x < from + 2e-3, "{from} {at}");
                    lost += u32::from(free && !holds);
                }
                assert!(lost < COUNT / 5, "{from} {lost}");
            }
            assert_eq!(look(&world, turn, Vec3::new(-2.0, 0.3, 0.0), 1.0), None);
        }
    }

    /// Points of a table's top: nothing beyond its edge counts. The other way round, its sides are no edges of the floor below it.
    #[test]
    fn a_disc_ends_at_the_edge_of_a_table() {
        for (number, turn) in rotations().take(20).enumerate() {
            let (low, high) = (Vec3::new(-9.0, -9.0, -0.5), Vec3::new(0.0, 9.0, 0.0));
            let world = solid(low, high, turn, number % 2 == 1);
            for from in [0.9_f32, 0.5, 0.1] {
                let center = Vec3::new(-from, 0.3, 0.0);
                let outline = look(&world, turn, center, 1.0).expect("an edge");
                for (at, holds) in held(&outline, turn * Vec3::Z, 1.0, turn) {
                    assert!(
                        at.x < from + 1e-4 || !holds,
                        "{number} {from} {at} {outline:?}"
                    );
                }
            }
            assert_eq!(look(&world, turn, Vec3::new(-2.0, 0.0, 0.0), 1.0), None);
        }
    }

    /// Neither the back of a thin plate ends the disc of its front, nor does what stands under a sheet; where the
    /// sheet is seen from there, that does.
    #[test]
    fn a_disc_ends_on_its_own_side() {
        for turn in rotations().take(20) {
            for thickness in [1e-4_f32, 1e-3, 1e-2] {
                let (low, high) = (Vec3::new(-9.0, -9.0, -thickness), Vec3::new(9.0, 9.0, 0.0));
                let plate = solid(low, high, turn, false);
                assert_eq!(look(&plate, turn, Vec3::ZERO, 1.0), None, "{thickness}");
            }
            // under a sheet at the height of the points
            let (low, high) = (Vec3::new(0.3, -9.0, -3.0), Vec3::new(0.4, 9.0, -1e-3));
            let wall = solid(low, high, turn, false);
            assert_eq!(look(&wall, turn, Vec3::ZERO, 1.0), None);
            let surface = Surface::bare(Vec3::ZERO, turn * Vec3::Z);
            // but where it is seen from there, or light comes through
            for (above, through) in [(false, false), (true, true)] {
                let outline = Outline::look(&wall, &surface, turn * Vec3::Z, above, through, 1.0);
                for (at, holds) in held(&outline.expect("a wall"), turn * Vec3::Z, 1.0, turn) {
                    assert!(at.x < 0.3 + 1e-4 || !holds, "{at}");
                }
            }
        }
    }

    /// A disc that cannot be, or that is as large as numbers go, is no reason to fail.
    #[test]
    fn a_disc_of_any_radius_is_looked_at() {
        let (low, high) = (Vec3::new(0.3, -9.0, -1.0), Vec3::new(0.4, 9.0, 3.0));
        let world = solid(low, high, Quat::IDENTITY, false);
        for radius in [f32::INFINITY, f32::NAN, 0.0, -1.0, 1e-42] {
            assert_eq!(look(&world, Quat::IDENTITY, Vec3::ZERO, radius), None);
        }
        let outline = look(&world, Quat::IDENTITY, Vec3::ZERO, 2e38);
        assert!(outline.is_some_and(|outline| outline.area(2e38).is_finite()));
    }

    /// What bends, faces otherwise little by little: neither a bowl nor a ball has an outline.
    #[test]
    fn a_bent_surface_goes_on() {
        let (rings, parts) = (40_u32, 80_u32);
        let at = |ring: u32, part: u32| {
            let polar = std::f32::consts::PI * ring as f32 / rings as f32;
            let turn = std::f32::consts::TAU * part as f32 / parts as f32;
            let (across, along) = polar.sin_cos();
            Vec3::new(across * turn.cos(), across * turn.sin(), along)
        };
        let places = (0..=rings).flat_map(|ring| (0..parts).map(move |part| (ring, part)));
        let positions: Vec<Vec3> = places.map(|(ring, part)| at(ring, part)).collect();
        let number = |ring: u32, part: u32| ring * parts + part % parts;
        let quads = (1..rings - 1).flat_map(|ring| (0..parts).map(move |part| (ring, part)));
        let halves = quads.flat_map(|(ring, part)| {
            let [a, b] = [number(ring, part), number(ring, part + 1)];
            let [c, d] = [number(ring + 1, part), number(ring + 1, part + 1)];
            [[a, c, d], [a, d, b]]
        });
        let mesh = Mesh::new(positions, halves.collect()).expect("a ball");
        let instance = Instance {
            mesh: 0,
            transform: Affine3A::IDENTITY,
        };
        let world = World::build(vec![Arc::new(mesh)], vec![instance]).expect("a world");
        let surface = world.surface_at(0, 30 * parts, 0.3, 0.3);
        let normal = surface.geometric_normal;
        for above in [true, false] {
            let outline = Outline::look(&world, &surface, normal, above, !above, 0.5);
            assert_eq!(outline, None, "{above}");
        }
    }

    /// Between two walls that nearly touch, a disc is small but not nothing.
    #[test]
    fn a_disc_in_a_crack_has_an_area() {
        let [crack, disc] =
            [[0, 1, 1, 1, 0, 1, 1, 1], [FREE; SIDES]].map(|sides| Outline { radius: 1.0, sides });
        let wide = crack.widened();
        assert!((0.01..0.1).contains(&wide.area(1.0)), "{}", wide.area(1.0));
        assert!((disc.area(2.0) - 4.0 * PI).abs() < 1e-12);
        let part = Outline::mostly_blocked();
        assert_eq!(part.widened(), part);
    }
}
