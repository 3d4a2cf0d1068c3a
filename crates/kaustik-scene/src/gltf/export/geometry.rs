use std::collections::{HashMap, HashSet};

use glam::Affine3A;
use kaustik_geometry::Mesh;
use serde_json::{Value, json};

use super::writer::{Object, Writer, numbers};
use crate::Description;

/// The glTF mesh of each mesh of the description under each of its materials.
pub(super) type MeshIndex = HashMap<(usize, Option<usize>), usize>;

/// Writes every mesh once, used or not, and one glTF mesh for each material that it has.
/// Those share the accessors, by which they are known as one when they are read.
pub(super) fn meshes(writer: &mut Writer, description: &Description) -> MeshIndex {
    let mut materials = vec![Vec::new(); description.meshes.len()];
    let mut seen = HashSet::new();
    for instance in &description.instances {
        if let Some(materials) = materials.get_mut(instance.mesh)
            && seen.insert((instance.mesh, instance.material))
        {
            materials.push(instance.material);
        }
    }
    let (mut index, mut list) = (MeshIndex::new(), Vec::new());
    for (i, (mesh, mut materials)) in description.meshes.iter().zip(materials).enumerate() {
        let primitive = primitive(writer, mesh);
        if materials.is_empty() {
            materials.push(None);
        }
        for material in materials {
            let mut primitive = primitive.clone();
            if let Some(material) = material {
                primitive["material"] = material.into();
            }
            index.insert((i, material), list.len());
            list.push(json!({ "primitives": [primitive] }));
        }
    }
    writer.set("meshes", list);
    index
}

fn primitive(writer: &mut Writer, mesh: &Mesh) -> Value {
    let mut attributes = Object::default();
    let positions = writer.floats(mesh.positions.iter().map(|p| p.to_array()));
    let corner = |start: f32, pick: fn(f32, f32) -> f32| {
        let fold = |a: [f32; 3], p: &glam::Vec3| [0, 1, 2].map(|i| pick(a[i], p[i]));
        mesh.positions.iter().fold([start; 3], fold)
    };
    if !mesh.positions.is_empty() {
        let least = corner(f32::INFINITY, f32::min);
        writer.bound(positions, &least, &corner(f32::NEG_INFINITY, f32::max));
    }
    attributes = attributes.with("POSITION", positions);
    if !mesh.normals.is_empty() {
        let normals = writer.floats(mesh.normals.iter().map(|n| n.to_array()));
        attributes = attributes.with("NORMAL", normals);
    }
    if !mesh.tangents.is_empty() {
        let tangents = writer.floats(mesh.tangents.iter().map(|t| t.to_array()));
        attributes = attributes.with("TANGENT", tangents);
    }
    for (uv, name) in mesh.uv.iter().zip(["TEXCOORD_0", "TEXCOORD_1"]) {
        if !uv.is_empty() {
            let uv = writer.floats(uv.iter().map(|uv| uv.to_array()));
            attributes = attributes.with(name, uv);
        }
    }
    if !mesh.colors.is_empty() {
        let colors = writer.floats(mesh.colors.iter().copied());
        attributes = attributes.with("COLOR_0", colors);
    }
    let corners = mesh.indices.iter().flatten().map(|i| i.to_le_bytes());
    let indices = writer.accessor("SCALAR", 5125, 3 * mesh.indices.len(), corners);
    json!({ "attributes": Value::from(attributes), "indices": indices })
}

/// A transform as a column-major matrix; none for the identity.
pub(super) fn matrix(transform: &Affine3A) -> Option<Value> {
    let bits = |t: &Affine3A| t.to_cols_array().map(f32::to_bits);
    if bits(transform) == bits(&Affine3A::IDENTITY) {
        return None;
    }
    let m = transform.to_cols_array();
    let column = |i: usize, last: f32| [m[3 * i], m[3 * i + 1], m[3 * i + 2], last];
    let columns = [
        column(0, 0.0),
        column(1, 0.0),
        column(2, 0.0),
        column(3, 1.0),
    ];
    Some(numbers(columns.as_flattened()))
}
