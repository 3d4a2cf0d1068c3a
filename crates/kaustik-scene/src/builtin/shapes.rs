//! Flat and swept meshes: quads, blocks, rings, pools. Counter-clockwise seen from outside.

use glam::{Vec2, Vec3};
use kaustik_geometry::Mesh;

/// A parallelogram or trapezoid by its corners in order around; flat. Its front faces `toward`.
pub(super) fn quad(corners: [Vec3; 4], toward: Vec3) -> Mesh {
    let [a, b, c, d] = corners;
    let normal = (b - a).cross(c - a) + (c - a).cross(d - a);
    let centre = (a + b + c + d) * 0.25;
    let corners = if normal.dot(toward - centre) < 0.0 {
        [a, d, c, b]
    } else {
        corners
    };
    Mesh {
        positions: corners.to_vec(),
        indices: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    }
}

/// A horizontal square at height `y`, its front facing down.
pub(super) fn square_facing_down(centre: Vec2, y: f32, edge: f32) -> Mesh {
    let half = 0.5 * edge;
    let corner = |x, z| Vec3::new(centre.x + half * x, y, centre.y + half * z);
    let corners = [
        corner(-1.0, -1.0),
        corner(1.0, -1.0),
        corner(1.0, 1.0),
        corner(-1.0, 1.0),
    ];
    quad(corners, Vec3::new(centre.x, y - 1.0, centre.y))
}

/// A solid between two quads with corresponding corners, flat. `base` runs clockwise seen from
/// `top`'s side: for a `top` above, the order x, z.
pub(super) fn block(base: [Vec3; 4], top: [Vec3; 4]) -> Mesh {
    let centre = (base.iter().sum::<Vec3>() + top.iter().sum::<Vec3>()) * 0.125;
    let mut faces = vec![base, top];
    for i in 0..4 {
        let j = (i + 1) % 4;
        faces.push([base[i], base[j], top[j], top[i]]);
    }
    let outward = |face: [Vec3; 4]| {
        let middle = face.iter().sum::<Vec3>() * 0.25;
        quad(face, middle + (middle - centre))
    };
    join(faces.into_iter().map(outward))
}

/// A box around `centre` with the given half edges, turned about the vertical by `turn`
/// radians.
pub(super) fn cuboid(centre: Vec3, half: Vec3, turn: f32) -> Mesh {
    let (sin, cos) = (libm::sinf(turn), libm::cosf(turn));
    let corner = |x: f32, y: f32, z: f32| {
        let (x, z) = (x * half.x, z * half.z);
        centre + Vec3::new(cos * x + sin * z, y * half.y, cos * z - sin * x)
    };
    let level = |y| {
        [
            corner(-1.0, y, -1.0),
            corner(1.0, y, -1.0),
            corner(1.0, y, 1.0),
            corner(-1.0, y, 1.0),
        ]
    };
    block(level(-1.0), level(1.0))
}

/// An upright column over a convex polygon of corners (x, z), flat and closed.
pub(super) fn column(corners: &[Vec2], bottom: f32, top: f32) -> Mesh {
    let at = |corner: Vec2, y: f32| Vec3::new(corner.x, y, corner.y);
    let centre = corners.iter().sum::<Vec2>() / corners.len() as f32;
    let middle = at(centre, 0.5 * (bottom + top));
    let mut parts = Vec::new();
    for (i, &a) in corners.iter().enumerate() {
        let b = corners[(i + 1) % corners.len()];
        let side = [at(a, bottom), at(b, bottom), at(b, top), at(a, top)];
        let outside = side.iter().sum::<Vec3>() * 0.5 - middle;
        parts.push(quad(side, outside));
    }
    for (y, outside) in [(bottom, bottom - 1.0), (top, top + 1.0)] {
        let mut face: Vec<Vec3> = corners.iter().map(|&corner| at(corner, y)).collect();
        let normal = (face[1] - face[0]).cross(face[2] - face[0]);
        if normal.y * (outside - y) < 0.0 {
            face.reverse();
        }
        parts.push(Mesh {
            indices: (2..face.len() as u32).map(|i| [0, i - 1, i]).collect(),
            positions: face,
            ..Mesh::default()
        });
    }
    join(parts)
}

/// A band around an axis along z through `centre`, rectangular in section, between the two
/// radii and `depth` long towards +z; smooth around, sharp at the edges.
pub(super) fn ring(centre: Vec3, radii: [f32; 2], depth: f32, segments: u32) -> Mesh {
    let [inner, outer] = radii;
    let spoke = |i: u32| {
        let angle = std::f64::consts::TAU * f64::from(i) / f64::from(segments);
        Vec3::new(libm::cos(angle) as f32, libm::sin(angle) as f32, 0.0)
    };
    // each side: the rim it starts from, the rim it ends at, and its normal on a spoke
    type Side = ([f32; 2], [f32; 2], fn(Vec3) -> Vec3);
    let sides: [Side; 4] = [
        ([inner, depth], [inner, 0.0], |spoke| -spoke),
        ([outer, 0.0], [outer, depth], |spoke| spoke),
        ([inner, 0.0], [outer, 0.0], |_| Vec3::NEG_Z),
        ([outer, depth], [inner, depth], |_| Vec3::Z),
    ];
    join(sides.into_iter().map(|(from, to, normal)| {
        let mut mesh = Mesh::default();
        for i in 0..segments {
            let spoke = spoke(i);
            for [radius, z] in [from, to] {
                mesh.positions.push(centre + spoke * radius + Vec3::Z * z);
                mesh.normals.push(normal(spoke));
            }
            let (a, b) = (2 * i, 2 * ((i + 1) % segments));
            mesh.indices.extend([[a, b, b + 1], [a, b + 1, a + 1]]);
        }
        mesh
    }))
}

/// A body of liquid over the rectangle from `min` to `max` (x, z), from `bottom` up to a
/// surface of which `height` gives the height and the two slopes at a point. Closed; the surface is a grid
/// of `cells` by `cells` squares with smooth normals, the rest is flat.
pub(super) fn pool(
    min: Vec2,
    max: Vec2,
    bottom: f32,
    cells: u32,
    height: impl Fn(Vec2) -> (f32, Vec2),
) -> Mesh {
    let side = cells + 1;
    let mut surface = Mesh::default();
    for k in 0..side * side {
        let share = Vec2::new((k % side) as f32, (k / side) as f32) / cells as f32;
        // the ends exactly: rounding must not leave a gap
        let at = Vec2::select(share.cmpge(Vec2::ONE), max, min + (max - min) * share);
        let (y, slope) = height(at);
        surface.positions.push(Vec3::new(at.x, y, at.y));
        surface
            .normals
            .push(Vec3::new(-slope.x, 1.0, -slope.y).normalize());
        let (i, j) = (k % side, k / side);
        if i < cells && j < cells {
            let (a, b) = (k, k + side);
            surface.indices.extend([[a, b, b + 1], [a, b + 1, a + 1]]);
        }
    }
    let rim = rim(side);
    let mut parts = Vec::new();
    let sunk = |p: Vec3| Vec3::new(p.x, bottom, p.z);
    let middle = (min + max) * 0.5;
    let middle = Vec3::new(middle.x, bottom, middle.y);
    for (i, &a) in rim.iter().enumerate() {
        let b = rim[(i + 1) % rim.len()];
        let (p, q) = (surface.positions[a as usize], surface.positions[b as usize]);
        parts.push(flat(&[p, q, sunk(q), sunk(p)]));
        parts.push(flat(&[sunk(p), sunk(q), middle]));
    }
    parts.push(surface);
    join(parts)
}

/// The border vertices of a grid, in order around, so that the outside lies to the front of
/// (this, next, below next).
fn rim(side: u32) -> Vec<u32> {
    let last = side - 1;
    let mut rim = Vec::new();
    rim.extend(0..last); // z = min, along +x
    rim.extend((0..last).map(|j| j * side + last));
    rim.extend((1..side).rev().map(|i| last * side + i));
    rim.extend((1..side).rev().map(|j| j * side));
    rim
}

/// A flat convex polygon with its normal at the corners.
fn flat(corners: &[Vec3]) -> Mesh {
    let normal = (corners[1] - corners[0])
        .cross(corners[2] - corners[0])
        .normalize();
    Mesh {
        positions: corners.to_vec(),
        indices: (2..corners.len() as u32).map(|i| [0, i - 1, i]).collect(),
        normals: vec![normal; corners.len()],
        ..Mesh::default()
    }
}

/// A block with its edges along the axes, by two opposite corners; flat.
pub(super) fn slab(low: [f32; 3], high: [f32; 3]) -> Mesh {
    let (low, high) = (Vec3::from(low), Vec3::from(high));
    cuboid(0.5 * (low + high), 0.5 * (high - low), 0.0)
}

/// A wall of so much thickness along x (from, to) around `z` with an opening (from, to along x; from, to in height).
pub(super) fn pierced(x: [f32; 2], y: [f32; 2], z: [f32; 2], opening: [[f32; 2]; 2]) -> [Mesh; 4] {
    let [[left, right], [sill, lintel]] = opening;
    // A wall without a sill has a sliver there, which lies in the floor.
    [
        slab([x[0], y[0], z[0]], [left, y[1], z[1]]),
        slab([right, y[0], z[0]], [x[1], y[1], z[1]]),
        slab([left, lintel, z[0]], [right, y[1], z[1]]),
        slab([left, y[0], z[0]], [right, sill, z[1]]),
    ]
}

/// What an outline (radius, height; from below) sweeps around the vertical through `centre`: smooth, its
/// front to the right of the way that the outline takes; ends of radius 0 are closed.
pub(super) fn revolved(centre: Vec3, outline: &[Vec2], segments: u32) -> Mesh {
    let mut mesh = Mesh::default();
    let last = outline.len() - 1;
    for (k, p) in outline.iter().enumerate() {
        let along = outline[(k + 1).min(last)] - outline[k.saturating_sub(1)];
        let normal = Vec2::new(along.y, -along.x).normalize();
        for i in 0..segments {
            let angle = std::f64::consts::TAU * f64::from(i) / f64::from(segments);
            let (sin, cos) = (libm::sin(angle) as f32, libm::cos(angle) as f32);
            let swept = |v: Vec2| Vec3::new(v.x * cos, v.y, v.x * sin);
            mesh.positions.push(centre + swept(*p));
            mesh.normals.push(swept(normal).normalize());
        }
    }
    for k in 0..last as u32 {
        for i in 0..segments {
            let j = (i + 1) % segments;
            let (a, b) = (k * segments + i, k * segments + j);
            let (c, d) = (a + segments, b + segments);
            if outline[k as usize].x > 0.0 {
                mesh.indices.push([a, c, b]);
            }
            if outline[k as usize + 1].x > 0.0 {
                mesh.indices.push([b, c, d]);
            }
        }
    }
    mesh
}

/// One mesh of several; either all have normals or none has, and so with the first texture coordinates.
pub(super) fn join(parts: impl IntoIterator<Item = Mesh>) -> Mesh {
    let mut all = Mesh::default();
    for part in parts {
        let first = all.positions.len() as u32;
        all.positions.extend(part.positions);
        all.normals.extend(part.normals);
        let [uv, _] = part.uv;
        all.uv[0].extend(uv);
        let shifted = part
            .indices
            .iter()
            .map(|triangle| triangle.map(|i| i + first));
        all.indices.extend(shifted);
    }
    all
}
