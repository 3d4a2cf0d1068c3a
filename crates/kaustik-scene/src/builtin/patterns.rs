//! Painted pictures for surfaces, and the uneven ground that they lie on: value noise from integers, so that
//! bits are the same everywhere.

use std::sync::Arc;

use glam::{Vec2, Vec3};
use kaustik_geometry::Mesh;

use crate::description::{ImageData, Pixels};

/// Texels a side.
const SIDE: u32 = 128;

/// In [0, 1), by the corner of the lattice.
fn corner(x: i32, y: i32) -> f32 {
    let mut hash = (x as u32).wrapping_mul(0x9e37_79b9) ^ (y as u32).wrapping_mul(0x85eb_ca6b);
    hash = (hash ^ (hash >> 15)).wrapping_mul(0x2c1b_3c6d);
    hash = (hash ^ (hash >> 12)).wrapping_mul(0x297a_2d39);
    ((hash ^ (hash >> 15)) >> 8) as f32 / (1u32 << 24) as f32
}

/// Smooth noise in [0, 1), a feature a unit; repeats every `period` units (a power of two).
fn noise(at: Vec2, period: i32) -> f32 {
    let cell = at.floor();
    let t = at - cell;
    let s = t * t * (Vec2::splat(3.0) - 2.0 * t);
    let [x, y] = cell.as_ivec2().to_array();
    let of = |dx: i32, dy: i32| corner((x + dx) & (period - 1), (y + dy) & (period - 1));
    let low = of(0, 0) + s.x * (of(1, 0) - of(0, 0));
    let high = of(0, 1) + s.x * (of(1, 1) - of(0, 1));
    low + s.y * (high - low)
}

/// Noise of several sizes, each half of the one before; in [0, 1), repeats every 64 units.
pub(super) fn rough(at: Vec2, octaves: u32) -> f32 {
    let (mut sum, mut weight, mut all) = (0.0, 1.0, 0.0);
    for octave in 0..octaves {
        let scale = (1 << octave) as f32;
        sum += weight * noise(at * scale, 64 << octave);
        all += weight;
        weight *= 0.5;
    }
    sum / all
}

/// A picture of sRGB bytes, by a share in [0, 1) of both sides (from the top left).
fn picture(name: &str, colour: impl Fn(Vec2) -> [f32; 3]) -> Arc<ImageData> {
    let mut bytes = Vec::with_capacity((4 * SIDE * SIDE) as usize);
    for texel in 0..SIDE * SIDE {
        let at = Vec2::new((texel % SIDE) as f32, (texel / SIDE) as f32) / SIDE as f32;
        bytes.extend(colour(at).map(|c| c.clamp(0.0, 255.0) as u8));
        bytes.push(255);
    }
    Arc::new(ImageData {
        name: name.to_owned(),
        width: SIDE,
        height: SIDE,
        pixels: Pixels::Rgba8(bytes),
        encoded: Vec::new(),
    })
}

fn mixed(a: [f32; 3], b: [f32; 3], share: f32) -> [f32; 3] {
    [0, 1, 2].map(|c| a[c] + share * (b[c] - a[c]))
}

/// Eight planks of wood along v.
pub(super) fn boards() -> Arc<ImageData> {
    picture("boards", |at| {
        let plank = (8.0 * at.x).floor();
        let gap = 8.0 * at.x - plank < 0.06;
        let grain = noise(Vec2::new(64.0 * at.x, 8.0 * at.y + 3.0 * plank), 64);
        let shade = 0.5 * corner(plank as i32, 7) + 0.5 * grain;
        let wood = mixed([112.0, 72.0, 42.0], [178.0, 126.0, 80.0], shade);
        if gap { [70.0, 44.0, 28.0] } else { wood }
    })
}

/// Square tiles, four a side, in two tones.
pub(super) fn tiles() -> Arc<ImageData> {
    picture("tiles", |at| {
        let cell = (4.0 * at).floor();
        let inner = 4.0 * at - cell;
        let joint = inner.min_element() < 0.04;
        let veins = rough(at * 8.0, 3);
        let dark = (cell.x + cell.y) as i32 % 2 == 0;
        let base = if dark { 120.0 } else { 205.0 };
        let tone = base + 45.0 * (veins - 0.5);
        if joint {
            [90.0, 88.0, 84.0]
        } else {
            [tone, 0.97 * tone, 0.92 * tone]
        }
    })
}

/// Layers of rock, one above the other along v.
pub(super) fn strata() -> Arc<ImageData> {
    picture("strata", |at| {
        let wave = 0.08 * noise(Vec2::new(8.0 * at.x, 4.0), 8);
        let layer = ((at.y + wave) * 16.0).floor();
        let tone = corner(layer as i32, 3);
        let speckle = 30.0 * (noise(at * 64.0, 64) - 0.5);
        let rock = mixed([150.0, 88.0, 58.0], [224.0, 172.0, 124.0], tone);
        rock.map(|c| c + speckle)
    })
}

/// Grass or sand: two colours by noise.
pub(super) fn ground(name: &str, low: [f32; 3], high: [f32; 3]) -> Arc<ImageData> {
    picture(name, |at| mixed(low, high, rough(at * 16.0, 3)))
}

/// Gives a mesh texture coordinates, `scale` pictures a unit: along the two axes that each vertex's first
/// triangle faces least. Vertices that several triangles share should lie in one plane, or nearly so.
pub(super) fn draped(mut mesh: Mesh, scale: f32) -> Mesh {
    let mut uv = vec![None; mesh.positions.len()];
    for triangle in &mesh.indices {
        let [a, b, c] = triangle.map(|i| mesh.positions[i as usize]);
        let normal = (b - a).cross(c - a).abs();
        for &i in triangle {
            let p = mesh.positions[i as usize];
            let flat = if normal.y >= normal.x && normal.y >= normal.z {
                Vec2::new(p.x, p.z)
            } else if normal.x >= normal.z {
                Vec2::new(p.z, p.y)
            } else {
                Vec2::new(p.x, p.y)
            };
            uv[i as usize].get_or_insert(flat * scale);
        }
    }
    mesh.uv[0] = uv.into_iter().map(Option::unwrap_or_default).collect();
    mesh
}

/// A sheet over the rectangle from `min` to `max` (x, z) with flat facets, front up; u runs along x and z
/// together, v upward, `scale` pictures a unit.
pub(super) fn terrain(
    [min, max]: [Vec2; 2],
    [columns, rows]: [u32; 2],
    scale: f32,
    height: impl Fn(Vec2) -> f32,
) -> Mesh {
    let mut mesh = Mesh::default();
    let across = columns + 1;
    for k in 0..across * (rows + 1) {
        let (i, j) = (k % across, k / across);
        let share = Vec2::new(i as f32 / columns as f32, j as f32 / rows as f32);
        let at = min + (max - min) * share;
        let y = height(at);
        mesh.positions.push(Vec3::new(at.x, y, at.y));
        mesh.uv[0].push(Vec2::new(at.x + at.y, at.x - at.y + 2.0 * y) * scale);
        if i < columns && j < rows {
            let (a, b) = (k, k + across);
            mesh.indices.extend([[a, b, b + 1], [a, b + 1, a + 1]]);
        }
    }
    mesh
}
