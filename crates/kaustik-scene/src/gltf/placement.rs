//! What stands where: nodes become instances, cameras and lights.

use std::sync::Arc;

use glam::{Affine3A, DAffine3, DVec3};

use super::accessor::Accessor;
use super::animation::{Carrier, Rig};
use super::camera::CameraKind;
use super::json::Cursor;
use super::light::Punctual;
use super::mesh::{Meshes, Part};
use super::node::Placed;
use super::reader::Reader;
use super::shaped::Shaped;
use super::skin::Skin;
use super::{ErrorKind, LoadError, transform, vertices};
use crate::description::{
    CameraDescription, Carried, Description, InstanceDescription, LightDescription, Load,
};

type Result<T> = std::result::Result<T, LoadError>;

/// The parts of a file that nodes refer to.
#[derive(Debug)]
pub(super) struct Parts {
    pub(super) meshes: Meshes,
    pub(super) cameras: Vec<CameraKind>,
    pub(super) lights: Vec<Punctual>,
    pub(super) skins: Vec<Option<Skin>>,
}

/// Adds all that the nodes place to the description. Cameras come in the order of the file's
/// cameras, as the first one is the default; all else in the order of the nodes.
pub(super) fn place<'a>(
    reader: &mut Reader<'a>,
    nodes: &[Placed<'a>],
    parts: Parts,
    rig: &Rig,
    description: &mut Description,
) -> Result<()> {
    let (mut cameras, mut shaped) = (Vec::new(), Shaped::default());
    for (position, placed) in nodes.iter().enumerate() {
        let name = placed.node.text("name")?;
        let carrier = rig.carrier(position);
        if !placed.hidden && placed.node.get("mesh")?.is_some() {
            let skin = skin(placed, &parts)?;
            if skin.is_some_and(|(_, skin)| skin.moves) {
                let message =
                    "the skin is bent as its joints rest; it moves as the first of them does";
                reader.warn(&placed.node, message);
            }
            let held = match skin {
                Some((_, skin)) => Held {
                    copies: vec![(skin.world, skin.local)],
                    carrier: skin.carrier,
                },
                None => Held {
                    copies: copies(reader, placed)?,
                    carrier,
                },
            };
            let place = placed.node.need("mesh")?;
            let mesh = place.index("/meshes", parts.meshes.parts.len())?;
            let count = parts.meshes.parts[mesh].len();
            charge(reader, &placed.node, &held, name, count, description)?;
            if !held.copies.is_empty() && count > 0 {
                let geometry = shaped.geometry(reader, placed, mesh, skin, &parts.meshes)?;
                instances(reader, placed, &held, name, &geometry, description)?;
            }
        }
        if let Some((index, camera)) = camera(reader, placed, name, &parts.cameras)? {
            cameras.push((index, camera, carrier));
        }
        let light = light(reader, placed, name, &parts.lights)?;
        if let Some(light) = light.filter(|_| !placed.hidden) {
            carry(description, Load::Light(description.lights.len()), carrier);
            description.lights.push(light);
        }
    }
    cameras.sort_by_key(|&(index, ..)| index);
    for (_, camera, carrier) in cameras {
        carry(
            description,
            Load::Camera(description.cameras.len()),
            carrier,
        );
        description.cameras.push(camera);
    }
    let shapes = !shaped.list.is_empty();
    description.meshes = parts.meshes.list;
    description.meshes.extend(shaped.list);
    if shapes {
        leave_out_idle(reader, description);
    }
    Ok(())
}

/// Leaves out meshes that stand nowhere, as they mostly do where a shape of theirs stands.
fn leave_out_idle(reader: &mut Reader<'_>, description: &mut Description) {
    let meshes = std::mem::take(&mut description.meshes);
    let mut places = vec![None; meshes.len()];
    for instance in &mut description.instances {
        let next = description.meshes.len();
        let place = *places[instance.mesh].get_or_insert(next);
        if place == next {
            description.meshes.push(Arc::clone(&meshes[instance.mesh]));
        }
        instance.mesh = place;
    }
    let idle = places
        .iter()
        .zip(&meshes)
        .filter(|(place, _)| place.is_none());
    let bytes: usize = idle.map(|(_, mesh)| mesh.memory()).sum();
    reader.budget.give(bytes as u64);
}

/// Notes that something moves, if it does.
fn carry(description: &mut Description, load: Load, carrier: Carrier) {
    let carried = carrier.map(|(joint, offset)| Carried {
        load,
        joint,
        offset,
    });
    description.animation.carried.extend(carried);
}

/// The node's name, or else that of what it holds.
fn named(reader: &mut Reader<'_>, place: &Cursor<'_>, node: &str, own: &str) -> Result<String> {
    let name = if node.is_empty() { own } else { node };
    reader.budget.take(&place.pointer(), name.len() as u64)?;
    Ok(name.to_owned())
}

fn camera(
    reader: &mut Reader<'_>,
    placed: &Placed<'_>,
    name: &str,
    cameras: &[CameraKind],
) -> Result<Option<(usize, CameraDescription)>> {
    let Some(place) = placed.node.get("camera")? else {
        return Ok(None);
    };
    let index = place.index("/cameras", cameras.len())?;
    let kind = &cameras[index];
    let camera = CameraDescription {
        name: named(reader, &placed.node, name, &kind.name)?,
        transform: transform::narrow(&placed.world, &placed.node)?,
        projection: kind.projection,
        lens: kind.lens,
        shutter: kind.shutter,
    };
    Ok(Some((index, camera)))
}

fn light(
    reader: &mut Reader<'_>,
    placed: &Placed<'_>,
    name: &str,
    lights: &[Punctual],
) -> Result<Option<LightDescription>> {
    let Some(extension) = placed.node.extension("KHR_lights_punctual")? else {
        return Ok(None);
    };
    let index = extension.need("light")?;
    let punctual = &lights[index.index("/extensions/KHR_lights_punctual/lights", lights.len())?];
    Ok(Some(LightDescription {
        name: named(reader, &placed.node, name, &punctual.name)?,
        kind: punctual.kind,
        color: punctual.color,
        intensity: punctual.intensity,
        range: punctual.range,
        transform: transform::narrow(&placed.world, &placed.node)?,
    }))
}

/// Where the mesh of a node stands, in each copy: to the world and to what carries it.
struct Held {
    copies: Vec<(DAffine3, DAffine3)>,
    carrier: Carrier,
}

/// The skin of a node with a mesh and its index, if it has one that holds it.
fn skin<'p>(placed: &Placed<'_>, parts: &'p Parts) -> Result<Option<(usize, &'p Skin)>> {
    let Some(place) = placed.node.get("skin")? else {
        return Ok(None);
    };
    let index = place.index("/skins", parts.skins.len())?;
    Ok(parts.skins[index].as_ref().map(|skin| (index, skin)))
}

/// One instance for each primitive of the node's mesh, and for each copy of the node.
fn instances<'a>(
    reader: &mut Reader<'a>,
    placed: &Placed<'a>,
    held: &Held,
    name: &str,
    parts: &[Part],
    description: &mut Description,
) -> Result<()> {
    let node = &placed.node;
    let Held { copies, carrier } = held;
    for (world, local) in copies {
        let Some(transform) = standing(reader, node, world, carrier.is_some())? else {
            continue;
        };
        let first = description.instances.len();
        for index in first..first + parts.len() {
            let carrier = carrier.map(|(joint, offset)| (joint, offset * *local));
            carry(description, Load::Instance(index), carrier);
        }
        description
            .instances
            .extend(parts.iter().map(|part| InstanceDescription {
                name: name.to_owned(),
                mesh: part.mesh,
                material: part.material,
                transform,
            }));
    }
    Ok(())
}

/// Counts the instances of a node's mesh, of so many primitives, before they are made.
fn charge<'a>(
    reader: &mut Reader<'a>,
    node: &Cursor<'a>,
    held: &Held,
    name: &str,
    parts: usize,
    description: &Description,
) -> Result<()> {
    let added = held.copies.len().saturating_mul(parts);
    let most = reader.options.max_instances;
    if description.instances.len().saturating_add(added) > most {
        let found = format!("a node with which there are more than {most} instances");
        let expected = format!("at most {most}");
        return Err(node.error(ErrorKind::Budget, found, expected));
    }
    let moving = if held.carrier.is_some() {
        size_of::<Carried>()
    } else {
        0
    };
    let each = size_of::<InstanceDescription>() + name.len() + moving;
    reader.budget.take_many(&node.pointer(), added, each)
}

/// The transform of an instance; `None` if nothing of it is seen. What moves may grow from nothing.
fn standing<'a>(
    reader: &mut Reader<'a>,
    node: &Cursor<'a>,
    world: &DAffine3,
    moves: bool,
) -> Result<Option<Affine3A>> {
    let transform = transform::narrow(world, node)?;
    if moves || transform.matrix3.as_dmat3().determinant() != 0.0 {
        return Ok(Some(transform));
    }
    let flat = transform::flattened(&transform);
    reader.warn(
        node,
        match flat {
            Some(_) => "it is flat: its scale along one axis is 0",
            None => "its scale is 0, so that nothing of it is seen; it is left out",
        },
    );
    Ok(flat)
}

/// The transforms of a node's copies (`EXT_mesh_gpu_instancing`), to the world and to the node: its own one if it has
/// none.
fn copies<'a>(reader: &mut Reader<'a>, placed: &Placed<'a>) -> Result<Vec<(DAffine3, DAffine3)>> {
    let Some(extension) = placed.node.extension("EXT_mesh_gpu_instancing")? else {
        return Ok(vec![(placed.world, DAffine3::IDENTITY)]);
    };
    let place = extension.need("attributes")?;
    let mut count = None;
    let translations = vectors(reader, &place, "TRANSLATION", &vertices::VECTOR, &mut count)?;
    let rotations = vectors(reader, &place, "ROTATION", &vertices::ROTATION, &mut count)?;
    let scales = vectors(reader, &place, "SCALE", &vertices::VECTOR, &mut count)?;
    let count = count.unwrap_or(1);
    reader
        .budget
        .take_many(&place.pointer(), count, size_of::<[DAffine3; 2]>())?;
    let wide = |v: &[f32; 3]| DVec3::from_array(v.map(f64::from));
    let local = |i: usize| {
        let rotation = rotations.get(i).and_then(|&r| transform::rotation(r));
        DAffine3::from_scale_rotation_translation(
            scales.get(i).map_or(DVec3::ONE, wide),
            rotation.unwrap_or_default(),
            translations.get(i).map_or(DVec3::ZERO, wide),
        )
    };
    let both = |local| (placed.world * local, local);
    Ok((0..count).map(|i| both(local(i))).collect())
}

/// The values of an attribute of the copies, as many as of the others.
fn vectors<'a, const N: usize>(
    reader: &mut Reader<'a>,
    attributes: &Cursor<'a>,
    name: &'static str,
    allowed: &super::accessor::Allowed,
    count: &mut Option<usize>,
) -> Result<Vec<[f32; N]>> {
    let Some(place) = attributes.get(name)? else {
        return Ok(Vec::new());
    };
    let accessor = Accessor::find(&reader.root, &place)?;
    let others = *count.get_or_insert(accessor.count());
    if accessor.count() != others {
        let found = format!("{} values", accessor.count());
        let expected = format!("{others}, as the other attributes have");
        return Err(place.error(ErrorKind::Value, found, expected));
    }
    accessor.floats(allowed, &reader.buffers, &mut reader.budget)
}
