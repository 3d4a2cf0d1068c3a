use super::material::{normal, slot};
use super::writer::{Object, Writer, number, numbers};
use crate::description::MaterialDescription;

/// The extensions of what lies on a material, with their names.
pub(super) fn layers(writer: &mut Writer, m: &MaterialDescription) -> Vec<(&'static str, Object)> {
    let mut all = Vec::new();
    if let Some(coat) = m.clearcoat {
        let members = Object::default()
            .with("clearcoatFactor", number(coat.factor))
            .maybe("clearcoatTexture", slot(writer, coat.texture))
            .with("clearcoatRoughnessFactor", number(coat.roughness))
            .maybe(
                "clearcoatRoughnessTexture",
                slot(writer, coat.roughness_texture),
            )
            .maybe(
                "clearcoatNormalTexture",
                normal(writer, coat.normal_texture, coat.normal_scale),
            );
        all.push(("KHR_materials_clearcoat", members));
    }
    if let Some(sheen) = m.sheen {
        let members = Object::default()
            .with("sheenColorFactor", numbers(&sheen.color))
            .maybe("sheenColorTexture", slot(writer, sheen.color_texture))
            .with("sheenRoughnessFactor", number(sheen.roughness))
            .maybe(
                "sheenRoughnessTexture",
                slot(writer, sheen.roughness_texture),
            );
        all.push(("KHR_materials_sheen", members));
    }
    if let Some(anisotropy) = m.anisotropy {
        let members = Object::default()
            .with("anisotropyStrength", number(anisotropy.strength))
            .with("anisotropyRotation", number(anisotropy.rotation))
            .maybe("anisotropyTexture", slot(writer, anisotropy.texture));
        all.push(("KHR_materials_anisotropy", members));
    }
    if let Some(film) = m.iridescence {
        let [least, most] = film.thickness.map(number);
        let members = Object::default()
            .with("iridescenceFactor", number(film.factor))
            .maybe("iridescenceTexture", slot(writer, film.texture))
            .with("iridescenceIor", number(film.ior))
            .with("iridescenceThicknessMinimum", least)
            .with("iridescenceThicknessMaximum", most)
            .maybe(
                "iridescenceThicknessTexture",
                slot(writer, film.thickness_texture),
            );
        all.push(("KHR_materials_iridescence", members));
    }
    all
}
