//! Meshes, rays and the slow oracle.

use std::sync::Arc;

use glam::{Affine3A, DVec3, Quat, Vec3};
use kaustik_geometry::{Hit, Instance, Mesh, Ray, World};

/// A small generator (PCG), so that every test is the same each time.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn unit(&mut self) -> f32 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        let word = (((self.0 >> 18) ^ self.0) >> 27) as u32;
        (word.rotate_right((self.0 >> 59) as u32) >> 8) as f32 / (1 << 24) as f32
    }

    pub(crate) fn cube(&mut self) -> Vec3 {
        Vec3::new(self.unit(), self.unit(), self.unit()) * 2.0 - 1.0
    }

    pub(crate) fn direction(&mut self) -> Vec3 {
        loop {
            let v = self.cube();
            if v.length_squared() > 1e-2 && v.length_squared() <= 1.0 {
                return v.normalize();
            }
        }
    }

    /// A rotation, a scale in each axis (some negative) and a shift.
    pub(crate) fn transform(&mut self) -> Affine3A {
        let turn = Quat::from_axis_angle(self.direction(), self.unit() * 6.0);
        let size = Vec3::new(self.scale(), self.scale(), self.scale());
        Affine3A::from_scale_rotation_translation(size, turn, self.cube() * 3.0)
    }

    fn scale(&mut self) -> f32 {
        let size = 0.3 + self.unit();
        if self.unit() < 0.3 { -size } else { size }
    }

    /// Triangles of many sizes anywhere in a cube.
    pub(crate) fn soup(&mut self, triangles: u32) -> Mesh {
        let mut positions = Vec::new();
        for _ in 0..triangles {
            let (center, size) = (self.cube(), 0.01 + 0.5 * self.unit() * self.unit());
            positions.extend(
                (0..3)
                    .map(|_| center + self.cube() * size)
                    .collect::<Vec<_>>(),
            );
        }
        let indices = (0..triangles)
            .map(|t| [3 * t, 3 * t + 1, 3 * t + 2])
            .collect();
        Mesh::new(positions, indices).unwrap()
    }
}

pub(crate) fn placed(mesh: Mesh, transform: Affine3A) -> World {
    World::build(vec![Arc::new(mesh)], vec![Instance { mesh: 0, transform }]).unwrap()
}

pub(crate) fn single(mesh: Mesh) -> World {
    placed(mesh, Affine3A::IDENTITY)
}

/// As `single`, but with a tree of its own, reached through an instance.
pub(crate) fn instanced(mesh: Mesh, transform: Affine3A) -> World {
    // The second is far away, and there are too many triangles to copy, though all but the mesh's own are points.
    let mut mesh = mesh;
    let corner = mesh.indices[0][0];
    mesh.indices
        .extend(std::iter::repeat_n([corner; 3], 10_000));
    let far = Affine3A::from_translation(Vec3::splat(1e3) * transform.matrix3.x_axis.length())
        * transform;
    let instances = [transform, far].map(|transform| Instance { mesh: 0, transform });
    World::build(vec![Arc::new(mesh)], instances.to_vec()).unwrap()
}

/// Every hit of a ray, found in double precision, as (t, instance, primitive, certainty); certainty is how far, as a
/// fraction of the triangle, the hit is from being missed.
pub(crate) fn all_hits(world: &World, ray: &Ray) -> Vec<(f64, u32, u32, f64)> {
    let mut hits = Vec::new();
    for (index, instance) in world.instances().iter().enumerate() {
        let to_world = instance.transform.as_daffine3();
        let mesh = world.mesh(instance.mesh);
        for primitive in 0..mesh.triangle_count() as u32 {
            let corners = mesh
                .corners(primitive)
                .map(|p| to_world.transform_point3(p.as_dvec3()));
            if let Some((t, certainty)) = meets(ray, corners) {
                hits.push((t, index as u32, primitive, certainty));
            }
        }
    }
    hits.sort_by(|a, b| a.0.total_cmp(&b.0));
    hits
}

/// Moeller and Trumbore in double precision.
fn meets(ray: &Ray, [a, b, c]: [DVec3; 3]) -> Option<(f64, f64)> {
    let (o, d) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
    let (e, f) = (b - a, c - a);
    let p = d.cross(f);
    let det = e.dot(p);
    if det == 0.0 {
        return None;
    }
    let q = (o - a).cross(e);
    let (u, v) = ((o - a).dot(p) / det, d.dot(q) / det);
    let t = f.dot(q) / det;
    let certainty = u.min(v).min(1.0 - u - v);
    (certainty > -1e-3 && t > 0.0 && t <= f64::from(ray.t_max)).then_some((t, certainty))
}

/// Whether a hit is one that the oracle allows: no certain hit lies clearly before it, and it is one itself.
pub(crate) fn agrees(world: &World, ray: &Ray, hit: Option<Hit>) -> Result<(), String> {
    let all = all_hits(world, ray);
    let tolerance = |t: f64| 1e-4 * t + 1e-5;
    let first = all.iter().find(|h| h.3 > 1e-4);
    match (hit, first) {
        (None, None) => Ok(()),
        (None, Some(first)) => Err(format!("missed {first:?}")),
        (Some(hit), first) => {
            let t = f64::from(hit.t);
            let same = |h: &&(f64, u32, u32, f64)| (h.1, h.2) == (hit.instance, hit.primitive);
            let found = all
                .iter()
                .find(same)
                .ok_or_else(|| format!("{hit:?} is no hit"))?;
            if (found.0 - t).abs() > tolerance(t) {
                return Err(format!("{hit:?} lies at {}", found.0));
            }
            match first {
                Some(first) if first.0 + tolerance(t) < t => {
                    Err(format!("{hit:?} lies behind {first:?}"))
                }
                _ => Ok(()),
            }
        }
    }
}

/// A subdivided icosahedron of radius one.
pub(crate) fn icosphere(levels: u32) -> Mesh {
    let g = (1.0 + 5f32.sqrt()) / 2.0;
    let mut positions: Vec<Vec3> = [
        [-1.0, g, 0.0],
        [1.0, g, 0.0],
        [-1.0, -g, 0.0],
        [1.0, -g, 0.0],
        [0.0, -1.0, g],
        [0.0, 1.0, g],
        [0.0, -1.0, -g],
        [0.0, 1.0, -g],
        [g, 0.0, -1.0],
        [g, 0.0, 1.0],
        [-g, 0.0, -1.0],
        [-g, 0.0, 1.0],
    ]
    .map(|p| Vec3::from_array(p).normalize())
    .to_vec();
    let mut indices = vec![
        [0, 11, 5],
        [0, 5, 1],
        [0, 1, 7],
        [0, 7, 10],
        [0, 10, 11],
        [1, 5, 9],
        [5, 11, 4],
        [11, 10, 2],
        [10, 7, 6],
        [7, 1, 8],
        [3, 9, 4],
        [3, 4, 2],
        [3, 2, 6],
        [3, 6, 8],
        [3, 8, 9],
        [4, 9, 5],
        [2, 4, 11],
        [6, 2, 10],
        [8, 6, 7],
        [9, 8, 1],
    ];
    for _ in 0..levels {
        let mut middles = std::collections::HashMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                positions.push(((positions[a as usize] + positions[b as usize]) / 2.0).normalize());
                positions.len() as u32 - 1
            })
        };
        indices = indices
            .iter()
            .flat_map(|&[a, b, c]| {
                let (x, y, z) = (middle(a, b), middle(b, c), middle(c, a));
                [[a, x, z], [b, y, x], [c, z, y], [x, y, z]]
            })
            .collect();
    }
    Mesh::new(positions, indices).unwrap()
}

/// A closed torus around z, of radii 1 and `tube`.
pub(crate) fn torus(n: u32, m: u32, tube: f32) -> Mesh {
    let angle = |i: u32, n: u32| i as f32 / n as f32 * std::f32::consts::TAU;
    let positions = (0..n * m).map(|k| {
        let (a, b) = (angle(k / m, n), angle(k % m, m));
        let r = 1.0 + tube * b.cos();
        Vec3::new(r * a.cos(), r * a.sin(), tube * b.sin())
    });
    let at = |i: u32, j: u32| i % n * m + j % m;
    let indices = (0..n * m).flat_map(|k| {
        let (i, j) = (k / m, k % m);
        [
            [at(i, j), at(i + 1, j), at(i + 1, j + 1)],
            [at(i, j), at(i + 1, j + 1), at(i, j + 1)],
        ]
    });
    Mesh::new(positions.collect(), indices.collect()).unwrap()
}

/// A cube from -1 to 1, each side of `n * n * 2` triangles.
pub(crate) fn cube(n: u32) -> Mesh {
    let (mut positions, mut indices) = (Vec::new(), Vec::new());
    for side in 0..6 {
        let base = positions.len() as u32;
        for k in 0..(n + 1) * (n + 1) {
            let (s, t) = (
                (k % (n + 1)) as f32 / n as f32 * 2.0 - 1.0,
                (k / (n + 1)) as f32 / n as f32 * 2.0 - 1.0,
            );
            let end = if side % 2 == 0 { 1.0 } else { -1.0 };
            positions.push(match side / 2 {
                0 => Vec3::new(end, s * end, t),
                1 => Vec3::new(t, end, s * end),
                _ => Vec3::new(s * end, t, end),
            });
        }
        for k in 0..n * n {
            let a = base + k / n * (n + 1) + k % n;
            indices.extend([[a, a + 1, a + n + 2], [a, a + n + 2, a + n + 1]]);
        }
    }
    Mesh::new(positions, indices).unwrap()
}

/// The mesh with all positions scaled.
pub(crate) fn scaled(mut mesh: Mesh, scale: f32) -> Mesh {
    for p in &mut mesh.positions {
        *p *= scale;
    }
    mesh
}
