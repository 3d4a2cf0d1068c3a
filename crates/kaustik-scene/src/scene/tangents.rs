//! Tangents for meshes that have none, where a material asks for them.
//!
//! They are MikkTSpace's, as glTF has it (2.0, 3.7.2.1) and as normal textures are baked for: means over the triangles
//! around a vertex, apart for each side of a mirrored texture. What they cannot be made for
//! keeps the tangents of single triangles.

use std::collections::{HashMap, HashSet};
use std::sync::Arc;

use bevy_mikktspace::{Geometry, Ops, TangentSpace, generate_tangents};
use glam::{DVec2, Vec4};
use kaustik_geometry::{Instance, Mesh, Unwrapping};

use crate::fence::fenced;

/// Triangles of a mesh that tangents are made for. Those of finer meshes hardly differ from triangle to triangle.
const MOST_TRIANGLES: usize = 1 << 18;

/// Corners that may meet in a vertex: what the algorithm does there grows with their square, and its stack with
/// their number.
const MOST_CORNERS: u32 = 256;

/// The meshes, and with them those that get tangents for instances: `along(i)` tells how the texture lies that instance `i`
/// needs tangents for, if it does. Instances are turned to what they need, and meshes that nobody needs as they are, are
/// replaced.
///
/// A mesh gets tangents once, for the first that needs some: a file of few bytes can lay its textures in any number of ways, and
/// each would be a mesh of its own. Where they lie otherwise, triangles keep their own tangents.
pub(super) fn complete(
    meshes: &[Arc<Mesh>],
    instances: &mut [Instance],
    along: impl Fn(usize) -> Option<Unwrapping>,
) -> Vec<Arc<Mesh>> {
    let mut made: HashMap<u32, (Unwrapping, Option<Arc<Mesh>>)> = HashMap::new();
    let turned: Vec<bool> = (instances.iter().enumerate())
        .map(|(i, instance)| {
            let mesh = meshes.get(instance.mesh as usize);
            along(i).zip(mesh).is_some_and(|(along, mesh)| {
                let make = || (along, with_tangents(mesh, &along));
                let (lies, made) = made.entry(instance.mesh).or_insert_with(make);
                *lies == along && made.is_some()
            })
        })
        .collect();
    let kept = instances
        .iter()
        .zip(&turned)
        .filter(|(_, turned)| !**turned);
    let kept: HashSet<u32> = kept.map(|(instance, _)| instance.mesh).collect();
    let mut list = meshes.to_vec();
    let mut place_of: HashMap<u32, u32> = HashMap::new();
    for (instance, _) in instances
        .iter_mut()
        .zip(turned)
        .filter(|(_, turned)| *turned)
    {
        let old = instance.mesh;
        let Some((_, Some(mesh))) = made.get(&old) else {
            continue;
        };
        instance.mesh = *place_of.entry(old).or_insert_with(|| {
            if kept.contains(&old) {
                list.push(Arc::clone(mesh));
                return list.len() as u32 - 1;
            }
            list[old as usize] = Arc::clone(mesh);
            old
        });
    }
    list
}

/// The mesh with tangents; `None` if it has some, or none can be made.
fn with_tangents(mesh: &Mesh, along: &Unwrapping) -> Option<Arc<Mesh>> {
    let vertices = mesh.positions.len();
    let uv = mesh.uv.get(along.set)?;
    let whole = mesh.normals.len() == vertices && uv.len() == vertices;
    let fits = mesh.indices.len() <= MOST_TRIANGLES && mesh.tangents.is_empty();
    let sound = mesh
        .indices
        .iter()
        .flatten()
        .all(|&i| (i as usize) < vertices);
    if !(whole && fits && sound) {
        return None;
    }
    let mut work = Work::new(mesh, uv.iter().map(|uv| along.turned * uv.as_dvec2()));
    if work.is_crowded() {
        return None;
    }
    fenced(|| generate_tangents(&mut work))?.ok()?;
    split(mesh, &work.tangents).map(Arc::new)
}

/// A mesh as the algorithm sees it: without triangles that are none, for which it would look at all others.
struct Work<'a> {
    mesh: &'a Mesh,
    normals: Vec<[f32; 3]>,
    /// With `v` up, as the bitangent of a normal texture goes.
    uv: Vec<[f32; 2]>,
    /// Which triangles its faces are.
    faces: Vec<usize>,
    /// Of each corner of each triangle.
    tangents: Vec<[Vec4; 3]>,
}

impl<'a> Work<'a> {
    fn new(mesh: &'a Mesh, uv: impl Iterator<Item = DVec2>) -> Self {
        let is_face = |&triangle: &usize| {
            let [a, b, c] = mesh.indices[triangle].map(|i| mesh.positions[i as usize]);
            a != b && b != c && c != a
        };
        let normals = mesh.normals.iter();
        Self {
            mesh,
            normals: normals
                .map(|n| n.as_dvec3().normalize_or_zero().as_vec3().to_array())
                .collect(),
            uv: uv.map(|uv| [uv.x as f32, -uv.y as f32]).collect(),
            faces: (0..mesh.indices.len()).filter(is_face).collect(),
            tangents: vec![[Vec4::W; 3]; mesh.indices.len()],
        }
    }

    fn vertex(&self, face: usize, corner: usize) -> usize {
        self.mesh.indices[self.faces[face]][corner] as usize
    }

    /// Do too many corners meet anywhere?
    fn is_crowded(&self) -> bool {
        let mut corners: HashMap<[u32; 8], u32> = HashMap::new();
        (0..3 * self.faces.len()).any(|at| {
            let vertex = self.vertex(at / 3, at % 3);
            let [x, y, z] = self.mesh.positions[vertex].to_array();
            let ([i, j, k], [u, v]) = (self.normals[vertex], self.uv[vertex]);
            let count = corners.entry([x, y, z, i, j, k, u, v].map(f32::to_bits));
            let count = count.or_insert(0);
            *count += 1;
            *count > MOST_CORNERS
        })
    }
}

/// The same on all machines.
enum Portable {}

impl Ops for Portable {
    fn sqrt(x: f32) -> f32 {
        libm::sqrtf(x)
    }

    fn acos(x: f32) -> f32 {
        libm::acos(f64::from(x)) as f32
    }
}

impl Geometry<Portable> for Work<'_> {
    fn num_faces(&self) -> usize {
        self.faces.len()
    }

    fn num_vertices_of_face(&self, _face: usize) -> usize {
        3
    }

    fn position(&self, face: usize, corner: usize) -> [f32; 3] {
        self.mesh.positions[self.vertex(face, corner)].to_array()
    }

    fn normal(&self, face: usize, corner: usize) -> [f32; 3] {
        self.normals[self.vertex(face, corner)]
    }

    fn tex_coord(&self, face: usize, corner: usize) -> [f32; 2] {
        self.uv[self.vertex(face, corner)]
    }

    fn set_tangent(&mut self, space: Option<TangentSpace>, face: usize, corner: usize) {
        let tangent = space.map(|space| Vec4::from_array(space.tangent_encoded()));
        // Zero where there is none: the triangle's own takes its place.
        let tangent = tangent.filter(|tangent| tangent.is_finite());
        self.tangents[self.faces[face]][corner] = tangent.unwrap_or(Vec4::W);
    }
}

/// The mesh with a vertex of its own for each tangent that corners have in one place; `None` if it would have more than twice the
/// vertices, as no texture asks for that and memory has been counted without.
fn split(mesh: &Mesh, tangents: &[[Vec4; 3]]) -> Option<Mesh> {
    let mut with = mesh.clone();
    with.tangents = vec![Vec4::W; mesh.positions.len()];
    let mut first = vec![true; mesh.positions.len()];
    let mut copies: HashMap<(u32, [u32; 4]), u32> = HashMap::new();
    for (triangle, tangents) in with.indices.iter_mut().zip(tangents) {
        if with.positions.len() > 2 * mesh.positions.len() {
            return None;
        }
        for (index, &tangent) in triangle.iter_mut().zip(tangents) {
            let vertex = *index as usize;
            let bits = tangent.to_array().map(f32::to_bits);
            *index = *copies.entry((*index, bits)).or_insert_with(|| {
                if std::mem::replace(&mut first[vertex], false) {
                    with.tangents[vertex] = tangent;
                    return vertex as u32;
                }
                with.tangents.push(tangent);
                repeat(&mut with.positions, vertex);
                repeat(&mut with.normals, vertex);
                with.uv.iter_mut().for_each(|uv| repeat(uv, vertex));
                repeat(&mut with.colors, vertex);
                with.positions.len() as u32 - 1
            });
        }
    }
    Some(with)
}

fn repeat<T: Copy>(values: &mut Vec<T>, vertex: usize) {
    let value = values.get(vertex).copied();
    values.extend(value);
}
