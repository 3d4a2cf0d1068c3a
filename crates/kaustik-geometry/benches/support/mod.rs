//! Meshes and rays for the benches: made by arithmetic, the same on every machine.
#![allow(dead_code, unreachable_pub, reason = "each bench uses a part")]

use glam::{Affine3A, Vec3};
use kaustik_geometry::{Instance, Mesh, Ray, Surface, World};
use std::sync::Arc;

/// A small generator of 32-bit words (PCG), enough to choose rays.
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> f32 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        let x = (((self.0 >> 18) ^ self.0) >> 27) as u32;
        let word = x.rotate_right((self.0 >> 59) as u32);
        (word >> 8) as f32 / (1 << 24) as f32
    }

    pub fn direction(&mut self) -> Vec3 {
        loop {
            let v = Vec3::new(self.next(), self.next(), self.next()) * 2.0 - 1.0;
            let l = v.length_squared();
            if l > 1e-4 && l <= 1.0 {
                return v / l.sqrt();
            }
        }
    }
}

/// A square of `n * n * 2` triangles, placed by `place` of parameters in [0, 1].
pub fn grid(mesh: &mut Mesh, n: u32, place: impl Fn(f32, f32) -> Vec3) {
    let base = mesh.positions.len() as u32;
    for j in 0..=n {
        for i in 0..=n {
            mesh.positions
                .push(place(i as f32 / n as f32, j as f32 / n as f32));
        }
    }
    for j in 0..n {
        for i in 0..n {
            let a = base + j * (n + 1) + i;
            mesh.indices.push([a, a + 1, a + n + 2]);
            mesh.indices.push([a, a + n + 2, a + n + 1]);
        }
    }
}

/// Smooth bumps of several sizes.
pub fn bumps(p: Vec3) -> f32 {
    let (mut sum, mut size, mut p) = (0.0, 0.5, p * 3.0);
    for _ in 0..6 {
        sum += size * (p.x.sin() * p.y.cos() + p.y.sin() * p.z.cos() + p.z.sin() * p.x.cos());
        size *= 0.45;
        p = Vec3::new(p.y, p.z, p.x) * 2.1 + Vec3::splat(1.7);
    }
    sum
}

/// A bumpy sphere of `12 n^2` triangles.
pub fn blob(mesh: &mut Mesh, n: u32, center: Vec3, radius: f32, depth: f32) {
    for face in 0..6 {
        grid(mesh, n, |s, t| {
            let (s, t) = (s * 2.0 - 1.0, t * 2.0 - 1.0);
            let side = if face % 2 == 0 { 1.0 } else { -1.0 };
            let d = match face / 2 {
                0 => Vec3::new(side, s, t),
                1 => Vec3::new(s, side, t),
                _ => Vec3::new(s, t, side),
            }
            .normalize();
            center + d * radius * (1.0 + depth * bumps(d + center))
        });
    }
}

/// A closed bumpy cave with eight bumpy stones in it; about `triangles`.
pub fn cave(triangles: u32) -> Mesh {
    let mut mesh = Mesh::default();
    let n = ((triangles as f32 / 12.0) / 3.0).sqrt() as u32;
    blob(&mut mesh, n, Vec3::ZERO, 4.0, 0.15);
    for k in 0..8 {
        let side = |bit: u32| if k >> bit & 1 == 0 { -1.2 } else { 1.2 };
        blob(
            &mut mesh,
            n / 2,
            Vec3::new(side(0), side(1), side(2)),
            0.8,
            0.3,
        );
    }
    mesh
}

/// A fractal height field; about `triangles`.
pub fn terrain(triangles: u32) -> Mesh {
    let mut mesh = Mesh::default();
    let n = (triangles as f32 / 2.0).sqrt() as u32;
    grid(&mut mesh, n, |s, t| {
        let p = Vec3::new(s * 8.0 - 4.0, 0.0, t * 8.0 - 4.0);
        p + Vec3::Y * bumps(p * 0.7) * 0.8
    });
    mesh
}

/// A box with a lamp and two boxes in it: 32 triangles.
pub fn cornell() -> Mesh {
    let mut mesh = Mesh::default();
    quad(
        &mut mesh,
        Vec3::new(-1.0, -1.0, -1.0),
        Vec3::X * 2.0,
        Vec3::Z * 2.0,
    );
    quad(
        &mut mesh,
        Vec3::new(-1.0, 1.0, -1.0),
        Vec3::Z * 2.0,
        Vec3::X * 2.0,
    );
    quad(
        &mut mesh,
        Vec3::new(-1.0, -1.0, -1.0),
        Vec3::Y * 2.0,
        Vec3::X * 2.0,
    );
    quad(
        &mut mesh,
        Vec3::new(-1.0, -1.0, -1.0),
        Vec3::Z * 2.0,
        Vec3::Y * 2.0,
    );
    quad(
        &mut mesh,
        Vec3::new(1.0, -1.0, -1.0),
        Vec3::Y * 2.0,
        Vec3::Z * 2.0,
    );
    quad(
        &mut mesh,
        Vec3::new(-0.25, 0.998, -0.2),
        Vec3::Z * 0.4,
        Vec3::X * 0.5,
    );
    for (at, size, turn) in [
        (
            Vec3::new(-0.7, -1.0, -0.4),
            Vec3::new(0.6, 1.2, 0.6),
            0.3f32,
        ),
        (Vec3::new(0.1, -1.0, 0.0), Vec3::new(0.6, 0.6, 0.6), -0.3),
    ] {
        let (x, z) = (
            Vec3::new(turn.cos(), 0.0, turn.sin()),
            Vec3::new(-turn.sin(), 0.0, turn.cos()),
        );
        let (x, y, z) = (x * size.x, Vec3::Y * size.y, z * size.z);
        quad(&mut mesh, at + y, x, z);
        quad(&mut mesh, at, x, y);
        quad(&mut mesh, at + z, x, y);
        quad(&mut mesh, at, z, y);
        quad(&mut mesh, at + x, z, y);
    }
    mesh
}

fn quad(mesh: &mut Mesh, at: Vec3, s: Vec3, t: Vec3) {
    grid(mesh, 1, |a, b| at + s * a + t * b);
}

pub fn single(mesh: Mesh) -> World {
    let placed = Instance {
        mesh: 0,
        transform: Affine3A::IDENTITY,
    };
    World::build(vec![Arc::new(mesh)], vec![placed]).expect("a valid world")
}

/// Rays through the pixels of a square picture, row by row.
pub fn primary(eye: Vec3, at: Vec3, size: usize) -> Vec<Ray> {
    let z = (at - eye).normalize();
    let x = z.cross(Vec3::Y).normalize();
    let y = x.cross(z);
    let coordinate = |i: usize| (i as f32 + 0.5) / size as f32 * 1.6 - 0.8;
    (0..size * size)
        .map(|i| Ray::new(eye, z + x * coordinate(i % size) - y * coordinate(i / size)))
        .collect()
}

/// From where each ray ends, into a random direction of the half space it came from.
pub fn bounces(world: &World, rays: &[Ray], random: &mut Random) -> Vec<Ray> {
    surfaces(world, rays)
        .map(|(surface, ray)| {
            let n = surface.geometric_normal;
            let n = if n.dot(ray.direction) > 0.0 { -n } else { n };
            let mut d = (n + random.direction() * 0.999).normalize();
            if d.dot(n) <= 0.0 {
                d = n;
            }
            Ray::spawn(&surface, d)
        })
        .collect()
}

/// From where each ray ends to where another one does.
pub fn shadows(world: &World, rays: &[Ray], random: &mut Random) -> Vec<Ray> {
    let all: Vec<Surface> = surfaces(world, rays).map(|(s, _)| s).collect();
    (0..all.len())
        .map(|i| {
            Ray::between(
                &all[i],
                &all[(random.next() * all.len() as f32) as usize % all.len()],
            )
        })
        .collect()
}

fn surfaces<'a>(world: &'a World, rays: &'a [Ray]) -> impl Iterator<Item = (Surface, Ray)> + 'a {
    rays.iter().filter_map(|ray| {
        let hit = world.intersect(ray)?;
        Some((world.surface(ray, &hit), *ray))
    })
}
