//! Sheen, clearcoat, anisotropy and iridescence.

use super::LoadError;
use super::json::Cursor;
use super::material::{POSITIVE, UNIT, slot};
use super::reader::Reader;
use super::texture::Textures;
use crate::description::{Anisotropy, Clearcoat, Iridescence, MaterialDescription, Sheen};

type Result<T> = std::result::Result<T, LoadError>;

/// Reads those that a material has.
pub(super) fn load(
    reader: &mut Reader<'_>,
    textures: &Textures,
    place: &Cursor<'_>,
    material: &mut MaterialDescription,
) -> Result<()> {
    if let Some(e) = place.extension("KHR_materials_clearcoat")? {
        material.clearcoat = Some(clearcoat(reader, textures, &e)?);
    }
    if let Some(e) = place.extension("KHR_materials_sheen")? {
        material.sheen = Some(Sheen {
            color: reader.numbers(&e, "sheenColorFactor", [0.0; 3], UNIT)?,
            color_texture: slot(reader, textures, &e, "sheenColorTexture")?,
            roughness: reader.number(&e, "sheenRoughnessFactor", 0.0, UNIT)?,
            roughness_texture: slot(reader, textures, &e, "sheenRoughnessTexture")?,
        });
    }
    if let Some(e) = place.extension("KHR_materials_anisotropy")? {
        let any = (f32::NEG_INFINITY, f32::INFINITY);
        material.anisotropy = Some(Anisotropy {
            strength: reader.number(&e, "anisotropyStrength", 0.0, UNIT)?,
            rotation: reader.number(&e, "anisotropyRotation", 0.0, any)?,
            texture: slot(reader, textures, &e, "anisotropyTexture")?,
        });
    }
    if let Some(e) = place.extension("KHR_materials_iridescence")? {
        material.iridescence = Some(Iridescence {
            factor: reader.number(&e, "iridescenceFactor", 0.0, UNIT)?,
            texture: slot(reader, textures, &e, "iridescenceTexture")?,
            ior: reader.number(&e, "iridescenceIor", 1.3, (1.0, f32::INFINITY))?,
            thickness: [
                reader.number(&e, "iridescenceThicknessMinimum", 100.0, POSITIVE)?,
                reader.number(&e, "iridescenceThicknessMaximum", 400.0, POSITIVE)?,
            ],
            thickness_texture: slot(reader, textures, &e, "iridescenceThicknessTexture")?,
        });
    }
    Ok(())
}

fn clearcoat(
    reader: &mut Reader<'_>,
    textures: &Textures,
    place: &Cursor<'_>,
) -> Result<Clearcoat> {
    let (normal_texture, normal_scale) = match place.get("clearcoatNormalTexture")? {
        None => (None, 1.0),
        Some(normal) => (
            textures.slot(reader, &normal)?,
            normal.f32_or("scale", 1.0)?,
        ),
    };
    Ok(Clearcoat {
        factor: reader.number(place, "clearcoatFactor", 0.0, UNIT)?,
        texture: slot(reader, textures, place, "clearcoatTexture")?,
        roughness: reader.number(place, "clearcoatRoughnessFactor", 0.0, UNIT)?,
        roughness_texture: slot(reader, textures, place, "clearcoatRoughnessTexture")?,
        normal_texture,
        normal_scale,
    })
}
