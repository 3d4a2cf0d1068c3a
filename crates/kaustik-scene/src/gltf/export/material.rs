use kaustik_spectrum::Glass;
use serde_json::{Value, json};

use super::layers;
use super::writer::{Object, Writer, extras, number, numbers};
use crate::description::{
    AlphaMode, MaterialDescription, Model, SpectralInput, TextureSlot, UvTransform,
};

/// A material with all its extensions; what is as glTF's defaults have it is left out.
#[expect(clippy::float_cmp, reason = "only the very default may be left out")]
pub(super) fn material(writer: &mut Writer, m: &MaterialDescription) -> Value {
    let default = MaterialDescription::default();
    let mut pbr = Object::default();
    if m.base_color != default.base_color {
        pbr = pbr.with("baseColorFactor", numbers(&m.base_color));
    }
    let pbr = pbr
        .maybe("baseColorTexture", slot(writer, m.base_color_texture))
        .with("metallicFactor", number(m.metallic))
        .with("roughnessFactor", number(m.roughness))
        .maybe(
            "metallicRoughnessTexture",
            slot(writer, m.metallic_roughness_texture),
        );
    let (factor, strength) = emissive(m.emissive);
    let (alpha_mode, cutoff) = match m.alpha_mode {
        AlphaMode::Opaque => (None, None),
        AlphaMode::Mask(cutoff) => (Some("MASK"), Some(number(cutoff))),
        AlphaMode::Blend => (Some("BLEND"), None),
    };
    Object::default()
        .named(&m.name)
        .with("pbrMetallicRoughness", pbr)
        .maybe(
            "normalTexture",
            normal(writer, m.normal_texture, m.normal_scale),
        )
        .maybe("emissiveFactor", factor)
        .maybe("emissiveTexture", slot(writer, m.emissive_texture))
        .maybe("alphaMode", alpha_mode)
        .maybe("alphaCutoff", cutoff)
        .maybe("doubleSided", m.double_sided.then_some(true))
        .maybe("extensions", extensions(writer, m, strength).some())
        .maybe("extras", extras(ours(m)))
        .into()
}

/// A factor up to 1 and, where that is not enough, a power of two as the strength: their
/// product is exact.
#[expect(clippy::float_cmp, reason = "only the very default may be left out")]
fn emissive(radiance: [f32; 3]) -> (Option<Value>, Option<Value>) {
    let most = radiance.into_iter().fold(0.0, f32::max);
    let mut strength = 1.0_f64;
    while strength < f64::from(most) && most.is_finite() {
        strength *= 2.0;
    }
    let factor = radiance.map(|r| match strength {
        1.0 => number(r),
        _ => (f64::from(r) / strength).into(),
    });
    let factor = (radiance != [0.0; 3]).then(|| factor.into());
    (factor, (strength > 1.0).then(|| strength.into()))
}

/// A texture info of normals, with the factor of their x and y.
pub(super) fn normal(
    writer: &mut Writer,
    normals: Option<TextureSlot>,
    scale: f32,
) -> Option<Value> {
    let mut info = slot(writer, normals)?;
    if scale.to_bits() != 1.0_f32.to_bits() {
        info["scale"] = number(scale);
    }
    Some(info)
}

/// A texture info.
pub(super) fn slot(writer: &mut Writer, slot: Option<TextureSlot>) -> Option<Value> {
    let slot = slot?;
    let transform = (slot.transform != UvTransform::IDENTITY).then(|| {
        writer.uses("KHR_texture_transform");
        json!({ "KHR_texture_transform": {
            "offset": numbers(&slot.transform.offset),
            "rotation": number(slot.transform.rotation),
            "scale": numbers(&slot.transform.scale),
        }})
    });
    let info = Object::default()
        .with("index", slot.texture)
        .maybe("texCoord", (slot.uv_set != 0).then_some(slot.uv_set))
        .maybe("extensions", transform);
    Some(info.into())
}

fn extensions(writer: &mut Writer, m: &MaterialDescription, strength: Option<Value>) -> Object {
    let mut all = plain(m, strength);
    all.extend(surface(writer, m));
    all.extend(layers::layers(writer, m));
    all.into_iter()
        .fold(Object::default(), |all, (name, members)| {
            writer.uses(name);
            all.with(name, members)
        })
}

/// The extensions that are a number at most, with their names.
#[expect(clippy::float_cmp, reason = "only the very default may be left out")]
fn plain(m: &MaterialDescription, strength: Option<Value>) -> Vec<(&'static str, Object)> {
    let mut all = Vec::new();
    if let Some(strength) = strength {
        let members = Object::default().with("emissiveStrength", strength);
        all.push(("KHR_materials_emissive_strength", members));
    }
    if m.unlit {
        all.push(("KHR_materials_unlit", Object::default()));
    }
    if m.ior != MaterialDescription::default().ior {
        let members = Object::default().with("ior", number(m.ior));
        all.push(("KHR_materials_ior", members));
    }
    if m.dispersion != 0.0 {
        let members = Object::default().with("dispersion", number(m.dispersion));
        all.push(("KHR_materials_dispersion", members));
    }
    all
}

/// The extensions of the surface itself and of what it bounds, with their names.
fn surface(writer: &mut Writer, m: &MaterialDescription) -> Vec<(&'static str, Object)> {
    let mut all = Vec::new();
    if m.specular != MaterialDescription::default().specular {
        let members = Object::default()
            .with("specularFactor", number(m.specular.factor))
            .maybe("specularTexture", slot(writer, m.specular.texture))
            .with("specularColorFactor", numbers(&m.specular.color))
            .maybe(
                "specularColorTexture",
                slot(writer, m.specular.color_texture),
            );
        all.push(("KHR_materials_specular", members));
    }
    if let Some(older) = m.specular_glossiness {
        let members = Object::default()
            .with("diffuseFactor", numbers(&m.base_color))
            .maybe("diffuseTexture", slot(writer, m.base_color_texture))
            .with("specularFactor", numbers(&older.specular))
            .with("glossinessFactor", number(older.glossiness))
            .maybe("specularGlossinessTexture", slot(writer, older.texture));
        all.push(("KHR_materials_pbrSpecularGlossiness", members));
    }
    if let Some(transmission) = m.transmission {
        let members = Object::default()
            .with("transmissionFactor", number(transmission.factor))
            .maybe("transmissionTexture", slot(writer, transmission.texture));
        all.push(("KHR_materials_transmission", members));
    }
    if let Some(diffuse) = m.diffuse_transmission {
        let members = Object::default()
            .with("diffuseTransmissionFactor", number(diffuse.factor))
            .maybe("diffuseTransmissionTexture", slot(writer, diffuse.texture))
            .with("diffuseTransmissionColorFactor", numbers(&diffuse.color))
            .maybe(
                "diffuseTransmissionColorTexture",
                slot(writer, diffuse.color_texture),
            );
        all.push(("KHR_materials_diffuse_transmission", members));
    }
    if let Some(volume) = m.volume {
        let distance = volume.attenuation_distance;
        let members = Object::default()
            .with("thicknessFactor", number(volume.thickness))
            .maybe(
                "attenuationDistance",
                (distance < f32::INFINITY).then(|| number(distance)),
            )
            .with("attenuationColor", numbers(&volume.attenuation_color));
        all.push(("KHR_materials_volume", members));
    }
    all
}

/// What stands in `extras.kaustik`.
fn ours(m: &MaterialDescription) -> Object {
    let (model, exponent, sigma) = match m.model {
        None => (None, None, None),
        Some(Model::Coated) => (Some("coated"), None, None),
        Some(Model::Phong { exponent }) => (Some("phong"), Some(number(exponent)), None),
        Some(Model::OrenNayar { sigma }) => (Some("oren-nayar"), None, Some(number(sigma))),
    };
    Object::default()
        .maybe("reflectance", m.reflectance.as_ref().map(spectrum))
        .maybe("emission", m.emission.as_ref().map(spectrum))
        .maybe("metal", m.metal.map(|metal| metal.name()))
        .maybe("glass", m.glass.map(|g| glass(&g)))
        .maybe("model", model)
        .maybe("exponent", exponent)
        .maybe("sigma", sigma)
        .maybe("priority", (m.priority != 0).then_some(m.priority))
}

fn spectrum(input: &SpectralInput) -> Value {
    match input {
        SpectralInput::Named(name) => name.as_str().into(),
        SpectralInput::Knots(knots) => {
            let pair = |&(nm, value): &(f32, f32)| numbers(&[nm, value]);
            knots.iter().map(pair).collect()
        }
    }
}

/// By name if there is one for this very formula.
fn glass(glass: &Glass) -> Value {
    let same = |name: &&str| Glass::named(name).as_ref() == Some(glass);
    if let Some(name) = Glass::names().find(same) {
        return name.into();
    }
    match glass {
        Glass::Constant(ior) => json!({ "constant": number(*ior) }),
        Glass::Sellmeier { b, c } => json!({ "B": numbers(b), "C": numbers(c) }),
        Glass::Cauchy { a, b } => json!({ "cauchy": numbers(&[*a, *b]) }),
        Glass::Polynomial { a } => json!({ "polynomial": numbers(a) }),
    }
}
