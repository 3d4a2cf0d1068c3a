use kaustik_spectrum::Glass;

use super::json::Cursor;
use super::reader::Reader;
use super::texture::Textures;
use super::{LoadError, extras, layers};
use crate::description::{
    AlphaMode, DiffuseTransmission, MaterialDescription, Specular, SpecularGlossiness, TextureSlot,
    Transmission, Volume,
};

type Result<T> = std::result::Result<T, LoadError>;

pub(super) const UNIT: (f32, f32) = (0.0, 1.0);
pub(super) const POSITIVE: (f32, f32) = (0.0, f32::INFINITY);

/// Reads all materials of the file.
pub(super) fn load(
    reader: &mut Reader<'_>,
    textures: &Textures,
) -> Result<Vec<MaterialDescription>> {
    let count = reader.root.count("materials")?;
    let each = size_of::<MaterialDescription>();
    reader.budget.take_many("/materials", count, each)?;
    let mut materials = Vec::with_capacity(count);
    for place in reader.root.list("materials")? {
        let mut material = core(reader, textures, &place)?;
        if let Some(place) = place.extension("KHR_materials_pbrSpecularGlossiness")? {
            specular_glossiness(reader, textures, &place, &mut material)?;
        }
        extensions(reader, textures, &place, &mut material)?;
        layers::load(reader, textures, &place, &mut material)?;
        if let Some(ours) = place.extras()? {
            extras::material(reader, &ours, &mut material)?;
        }
        materials.push(material);
    }
    Ok(materials)
}

/// The texture `key`, if there is one that can be read.
pub(super) fn slot<'a>(
    reader: &mut Reader<'_>,
    textures: &Textures,
    place: &Cursor<'a>,
    key: &'a str,
) -> Result<Option<TextureSlot>> {
    match place.get(key)? {
        Some(info) => textures.slot(reader, &info),
        None => Ok(None),
    }
}

/// What needs no extension, and the strength of the emission.
fn core(
    reader: &mut Reader<'_>,
    textures: &Textures,
    place: &Cursor<'_>,
) -> Result<MaterialDescription> {
    let mut material = MaterialDescription {
        name: place.text("name")?.to_owned(),
        alpha_mode: alpha_mode(reader, place)?,
        double_sided: place.flag("doubleSided")?,
        emissive: emissive(reader, place)?,
        emissive_texture: slot(reader, textures, place, "emissiveTexture")?,
        ..MaterialDescription::default()
    };
    if let Some(pbr) = place.get("pbrMetallicRoughness")? {
        material.base_color = reader.numbers(&pbr, "baseColorFactor", [1.0; 4], UNIT)?;
        material.base_color_texture = slot(reader, textures, &pbr, "baseColorTexture")?;
        material.metallic = reader.number(&pbr, "metallicFactor", 1.0, UNIT)?;
        material.roughness = reader.number(&pbr, "roughnessFactor", 1.0, UNIT)?;
        material.metallic_roughness_texture =
            slot(reader, textures, &pbr, "metallicRoughnessTexture")?;
    }
    if let Some(normal) = place.get("normalTexture")? {
        material.normal_texture = textures.slot(reader, &normal)?;
        material.normal_scale = normal.f32_or("scale", 1.0)?;
    }
    Ok(material)
}

fn alpha_mode(reader: &mut Reader<'_>, place: &Cursor<'_>) -> Result<AlphaMode> {
    let cutoff = reader.number(place, "alphaCutoff", 0.5, POSITIVE)?;
    let Some(mode) = place.get("alphaMode")? else {
        return Ok(AlphaMode::Opaque);
    };
    match mode.string()? {
        "OPAQUE" => Ok(AlphaMode::Opaque),
        "MASK" => Ok(AlphaMode::Mask(cutoff)),
        "BLEND" => Ok(AlphaMode::Blend),
        _ => Err(mode.mismatch("OPAQUE, MASK or BLEND")),
    }
}

/// Factor times strength. The product is taken in double precision, so that what the exporter
/// splits into a factor and a power of two comes back with the same bits.
fn emissive(reader: &mut Reader<'_>, place: &Cursor<'_>) -> Result<[f32; 3]> {
    let strength = match place.extension("KHR_materials_emissive_strength")? {
        Some(e) => reader.number(&e, "emissiveStrength", 1.0, POSITIVE)?,
        None => 1.0,
    };
    let mut emissive = [0.0; 3];
    let Some(factor) = place.get("emissiveFactor")? else {
        return Ok(emissive);
    };
    let numbers = reader.numbers(place, "emissiveFactor", emissive, POSITIVE)?;
    if numbers.iter().any(|&n| n > 1.0) {
        let message =
            "above 1, which glTF leaves to KHR_materials_emissive_strength; taken as it is";
        reader.warn(&factor, message);
    }
    for (radiance, number) in emissive.iter_mut().zip(factor.items()?) {
        let product = number.f64()?.max(0.0) * f64::from(strength);
        *radiance = product as f32;
        if !radiance.is_finite() {
            return Err(number.mismatch("a radiance below 3.4e38"));
        }
    }
    Ok(emissive)
}

fn extensions(
    reader: &mut Reader<'_>,
    textures: &Textures,
    place: &Cursor<'_>,
    material: &mut MaterialDescription,
) -> Result<()> {
    material.unlit = place.extension("KHR_materials_unlit")?.is_some();
    if let Some(e) = place.extension("KHR_materials_ior")? {
        material.ior = ior(reader, &e)?;
    }
    if let Some(e) = place.extension("KHR_materials_dispersion")? {
        material.dispersion = dispersion(reader, &e, material.ior)?;
    }
    if let Some(e) = place.extension("KHR_materials_specular")? {
        material.specular = Specular {
            factor: reader.number(&e, "specularFactor", 1.0, UNIT)?,
            texture: slot(reader, textures, &e, "specularTexture")?,
            color: reader.numbers(&e, "specularColorFactor", [1.0; 3], POSITIVE)?,
            color_texture: slot(reader, textures, &e, "specularColorTexture")?,
        };
    }
    if let Some(e) = place.extension("KHR_materials_transmission")? {
        material.transmission = Some(Transmission {
            factor: reader.number(&e, "transmissionFactor", 0.0, UNIT)?,
            texture: slot(reader, textures, &e, "transmissionTexture")?,
        });
    }
    if let Some(e) = place.extension("KHR_materials_volume")? {
        material.volume = Some(volume(reader, &e)?);
    }
    if let Some(e) = place.extension("KHR_materials_diffuse_transmission")? {
        diffuse_transmission(reader, textures, &e, material)?;
    }
    Ok(())
}

/// Of what has an inside one of the two is left out.
fn diffuse_transmission(
    reader: &mut Reader<'_>,
    textures: &Textures,
    place: &Cursor<'_>,
    material: &mut MaterialDescription,
) -> Result<()> {
    let diffuse = DiffuseTransmission {
        factor: reader.number(place, "diffuseTransmissionFactor", 0.0, UNIT)?,
        texture: slot(reader, textures, place, "diffuseTransmissionTexture")?,
        color: reader.numbers(place, "diffuseTransmissionColorFactor", [1.0; 3], UNIT)?,
        color_texture: slot(reader, textures, place, "diffuseTransmissionColorTexture")?,
    };
    let is_there = diffuse.factor > 0.0;
    if is_there && material.bounds_solid() {
        reader.warn(place, "left out of a solid: what enters that is refracted");
        return Ok(());
    }
    if is_there && material.volume.is_some_and(|volume| volume.thickness > 0.0) {
        let message = "what diffuse light goes through is thin here: the volume, and what it absorbs, is left out";
        reader.warn(place, message);
        material.volume = None;
    }
    material.diffuse_transmission = Some(diffuse);
    Ok(())
}

/// 1 or more, or the 0 by which the extension spells a reflection of 1 everywhere.
fn ior(reader: &mut Reader<'_>, place: &Cursor<'_>) -> Result<f32> {
    match place.get("ior")? {
        Some(ior) if ior.f32()? == 0.0 => Ok(0.0),
        _ => reader.number(place, "ior", 1.5, (1.0, f32::INFINITY)),
    }
}

/// 20 divided by the Abbe number, where an index that is possible at all wavelengths follows from it.
fn dispersion(reader: &mut Reader<'_>, place: &Cursor<'_>, ior: f32) -> Result<f32> {
    let dispersion = reader.number(place, "dispersion", 0.0, POSITIVE)?;
    if dispersion > 0.0 && ior > 0.0 && Glass::abbe(ior, 20.0 / dispersion).is_err() {
        let message = format!(
            "{dispersion} is so much that no index of refraction is possible at all wavelengths; taken as none"
        );
        reader.warn(place, message);
        return Ok(0.0);
    }
    Ok(dispersion)
}

/// The thickness texture is not read: rays find how thick a solid is, and need to know only
/// that it is one.
fn volume(reader: &mut Reader<'_>, place: &Cursor<'_>) -> Result<Volume> {
    let mut attenuation_distance = f32::INFINITY;
    if let Some(distance) = place.get("attenuationDistance")? {
        attenuation_distance = distance.f32()?;
        if attenuation_distance <= 0.0 {
            reader.warn(&distance, "not above 0; the volume does not absorb");
            attenuation_distance = f32::INFINITY;
        }
    }
    Ok(Volume {
        thickness: reader.number(place, "thicknessFactor", 0.0, POSITIVE)?,
        attenuation_distance,
        attenuation_color: reader.numbers(place, "attenuationColor", [1.0; 3], UNIT)?,
    })
}

/// The older model. Its diffuse colour takes the place of the base colour; what the newer model says
/// beside it is a fallback for other readers.
fn specular_glossiness(
    reader: &mut Reader<'_>,
    textures: &Textures,
    place: &Cursor<'_>,
    material: &mut MaterialDescription,
) -> Result<()> {
    material.base_color = reader.numbers(place, "diffuseFactor", [1.0; 4], UNIT)?;
    material.base_color_texture = slot(reader, textures, place, "diffuseTexture")?;
    material.specular_glossiness = Some(SpecularGlossiness {
        specular: reader.numbers(place, "specularFactor", [1.0; 3], UNIT)?,
        glossiness: reader.number(place, "glossinessFactor", 1.0, UNIT)?,
        texture: slot(reader, textures, place, "specularGlossinessTexture")?,
    });
    Ok(())
}
