//! Meshes that nodes morph and bend: one for each shape.

use std::collections::HashMap;
use std::sync::Arc;

use kaustik_geometry::Mesh;

use super::LoadError;
use super::budget::VISIT;
use super::json::Cursor;
use super::mesh::{self, Meshes, Part};
use super::node::Placed;
use super::reader::Reader;
use super::shape::Shape;
use super::skin::Skin;

type Result<T> = std::result::Result<T, LoadError>;

/// Meshes in the shapes that nodes give them, beside those of the file.
#[derive(Debug, Default)]
pub(super) struct Shaped {
    pub(super) list: Vec<Arc<Mesh>>,
    /// Where the geometries of a mesh in some shape begin, behind those of the file; `None`: it is as the file has it.
    known: HashMap<ShapeKey, Option<usize>>,
}

/// What makes two nodes give their mesh the same shape.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
struct ShapeKey {
    mesh: usize,
    skin: Option<usize>,
    /// Weights of morph targets by their bits; `None`: those of the mesh.
    weights: Option<Vec<u32>>,
}

impl Shaped {
    /// The geometries and materials of a node's mesh, in the shape that the node gives it.
    pub(super) fn geometry<'a>(
        &mut self,
        reader: &mut Reader<'a>,
        placed: &Placed<'a>,
        index: usize,
        skin: Option<(usize, &Skin)>,
        meshes: &Meshes,
    ) -> Result<Vec<Part>> {
        let mesh = placed.node.need("mesh")?.target(&reader.root, "meshes")?;
        let own = match placed.node.get("weights")? {
            Some(weights) => Some(numbers(&weights)?),
            None => None,
        };
        let key = ShapeKey {
            mesh: index,
            skin: skin.map(|(index, _)| index),
            weights: (own.as_ref()).map(|own| own.iter().map(|w| w.to_bits()).collect()),
        };
        let first = match self.known.get(&key) {
            Some(first) => *first,
            None => {
                let mut weights = match (own, mesh.get("weights")?) {
                    (Some(own), _) => own,
                    (None, Some(weights)) => {
                        let count = mesh.count("weights")?;
                        reader.budget.work(&weights, count * VISIT)?;
                        numbers(&weights)?
                    }
                    (None, None) => Vec::new(),
                };
                weights.truncate(most_targets(reader, &mesh)?);
                let bends = skin.and_then(|(_, skin)| skin.bends.clone());
                let shape = Shape { weights, bends };
                let first = self.shape(reader, &mesh, &shape, meshes)?;
                *self.known.entry(key).or_insert(first)
            }
        };
        let parts = &meshes.parts[index];
        let Some(first) = first else {
            return Ok(parts.clone());
        };
        let moved = parts.iter().enumerate().map(|(at, part)| Part {
            mesh: first + at,
            ..*part
        });
        Ok(moved.collect())
    }

    fn shape<'a>(
        &mut self,
        reader: &mut Reader<'a>,
        mesh: &Cursor<'a>,
        shape: &Shape,
        meshes: &Meshes,
    ) -> Result<Option<usize>> {
        if shape.is_plain() {
            return Ok(None);
        }
        let first = meshes.list.len() + self.list.len();
        self.list.extend(mesh::shaped(reader, mesh, shape)?);
        Ok(Some(first))
    }
}

/// The most morph targets of any primitive.
fn most_targets<'a>(reader: &mut Reader<'a>, mesh: &Cursor<'a>) -> Result<usize> {
    let mut most = 0;
    for primitive in mesh.need("primitives")?.items()? {
        reader.budget.work(&primitive, VISIT)?;
        most = most.max(primitive.count("targets")?);
    }
    Ok(most)
}

fn numbers(list: &Cursor<'_>) -> Result<Vec<f32>> {
    list.items()?.map(|number| number.f32()).collect()
}
