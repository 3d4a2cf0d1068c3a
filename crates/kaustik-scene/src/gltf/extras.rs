//! Kaustik's own keys, `extras.kaustik` of materials, cameras and scenes. What can be
//! misspelled is an error that lists what is known; unknown keys are a warning.

use std::fmt::Display;

use kaustik_spectrum::{Glass, Illuminant, Metal, NM_MAX, NM_MIN, Tabulated};

use super::json::Cursor;
use super::reader::Reader;
use super::{ErrorKind, LoadError};
use crate::description::{Blades, Lens, MaterialDescription, Model, Shutter, SpectralInput};
use crate::material::reflecting;

type Result<T> = std::result::Result<T, LoadError>;

/// Keys of materials that are read.
const MATERIAL: [&str; 8] = [
    "reflectance",
    "emission",
    "metal",
    "glass",
    "model",
    "exponent",
    "priority",
    "sigma",
];
/// Keys of cameras that are read.
const CAMERA: [&str; 5] = ["aperture", "focus", "blades", "rotation", "shutter"];

/// Warns about keys that are not `known`; those of a `later` version are told as such.
pub(super) fn warn_of_unknown(
    reader: &mut Reader<'_>,
    place: &Cursor<'_>,
    known: &[&str],
) -> Result<()> {
    for (key, _) in place.object()? {
        let Some(member) = place.get(key)? else {
            continue;
        };
        if !known.contains(&key.as_str()) {
            let message = format!(
                "an unknown key; it is ignored (known: {})",
                known.join(", ")
            );
            reader.warn(&member, message);
        }
    }
    Ok(())
}

/// Reads `extras.kaustik` of a material.
pub(super) fn material(
    reader: &mut Reader<'_>,
    place: &Cursor<'_>,
    material: &mut MaterialDescription,
) -> Result<()> {
    warn_of_unknown(reader, place, &MATERIAL)?;
    if let Some(input) = place.get("reflectance")? {
        material.reflectance = Some(reflectance(&input)?);
    }
    if let Some(input) = place.get("emission")? {
        material.emission = Some(spectrum(&input)?);
    }
    if let Some(metal) = place.get("metal")? {
        let known = || metal.mismatch(format!("one of {}", Metal::ALL.map(Metal::name).join(", ")));
        material.metal = Some(Metal::named(metal.string()?).ok_or_else(known)?);
    }
    if let Some(input) = place.get("glass")? {
        material.glass = Some(glass(&input)?);
    }
    if let Some(priority) = place.get("priority")? {
        material.priority = priority.i32()?;
    }
    material.model = model(reader, place)?;
    drop_lost_layers(reader, place, material);
    Ok(())
}

/// A measured metal and a model of its own have no place for what lies on a surface.
fn drop_lost_layers(
    reader: &mut Reader<'_>,
    place: &Cursor<'_>,
    material: &mut MaterialDescription,
) {
    let what = match (material.metal, material.model) {
        (None, None) => return,
        (Some(_), _) => "\"metal\"",
        (None, Some(_)) => "\"model\"",
    };
    let lost = [
        ("clearcoat", material.clearcoat.take().is_some()),
        ("sheen", material.sheen.take().is_some()),
        ("anisotropy", material.anisotropy.take().is_some()),
        ("iridescence", material.iridescence.take().is_some()),
        (
            "diffuse transmission",
            material.diffuse_transmission.take().is_some(),
        ),
    ];
    for (layer, _) in lost.iter().filter(|(_, there)| *there) {
        let message = format!("{layer} is left out: it does not go with {what}");
        reader.warn(place, message);
    }
}

fn model(reader: &mut Reader<'_>, place: &Cursor<'_>) -> Result<Option<Model>> {
    let Some(model) = place.get("model")? else {
        for key in ["exponent", "sigma"] {
            if let Some(number) = place.get(key)? {
                reader.warn(&number, "ignored: there is no \"model\"");
            }
        }
        return Ok(None);
    };
    match model.string()? {
        "coated" => Ok(Some(Model::Coated)),
        "phong" => {
            let exponent = place.need("exponent")?;
            let value = exponent.f32()?;
            if value < 0.0 {
                return Err(exponent.mismatch("an exponent of 0 or more"));
            }
            Ok(Some(Model::Phong { exponent: value }))
        }
        "oren-nayar" => {
            let sigma = place.need("sigma")?;
            let value = sigma.f32()?;
            if !(0.0..=1.0).contains(&value) {
                return Err(sigma.mismatch("a roughness from 0 to 1"));
            }
            Ok(Some(Model::OrenNayar { sigma: value }))
        }
        _ => Err(model.mismatch("coated, phong or oren-nayar")),
    }
}

/// A name, or `[[nm, value], ...]`.
fn spectrum(place: &Cursor<'_>) -> Result<SpectralInput> {
    if !place.is_array() {
        let expected = "the name of a table or [[nm, value], ...]";
        let name = place.string().map_err(|_| place.mismatch(expected))?;
        if Tabulated::named(name).is_none() && Illuminant::named(name).is_none() {
            let names = Tabulated::NAMES.join(", ");
            let expected = format!("one of {names}, A, D50, D65, E, FL2, FL11");
            return Err(place.mismatch(expected));
        }
        return Ok(SpectralInput::Named(name.to_owned()));
    }
    let mut knots = Vec::new();
    for knot in place.items()? {
        let [nm, value] = knot.floats()?;
        knots.push((nm, value));
    }
    let expected = "knots of ascending wavelength and values of 0 or more";
    Tabulated::new(knots.clone()).map_err(|e| invalid(place, &e, expected))?;
    Ok(SpectralInput::Knots(knots))
}

fn reflectance(place: &Cursor<'_>) -> Result<SpectralInput> {
    let input = spectrum(place)?;
    // Names of lamps are tables as well.
    if reflecting(&input, "").is_err() {
        let found = "a value above 1";
        return Err(place.error(ErrorKind::Value, found, "reflectances from 0 to 1"));
    }
    Ok(input)
}

fn invalid(place: &Cursor<'_>, why: &impl Display, expected: &str) -> LoadError {
    place.error(ErrorKind::Value, why.to_string(), expected)
}

/// A name, or an object with one of the formulas: `{B, C}` (Sellmeier), `{nd, abbe}`,
/// `{cauchy: [A, B]}`, `{polynomial: [7 numbers]}`, `{constant}`.
fn glass(place: &Cursor<'_>) -> Result<Glass> {
    if !place.is_object() {
        let named = place.string().ok().and_then(Glass::named);
        return named.ok_or_else(|| {
            let names: Vec<&str> = Glass::names().collect();
            let names = names.join(", ");
            place.mismatch(format!("one of {names}, or an object with \"B\" and \"C\", \"nd\" and \"abbe\", \"cauchy\", \"polynomial\" or \"constant\""))
        });
    }
    let physical = "an index of refraction that is finite and above 0.1 in the visible range";
    let glass = formula(place)?;
    // the open variants are checked here, the others by their constructors as well
    let mut nm = NM_MIN;
    while nm <= NM_MAX {
        let ior = glass.at(nm);
        if !ior.is_finite() || ior < 0.1 {
            return Err(invalid(
                place,
                &format!("an index of {ior} at {nm} nm"),
                physical,
            ));
        }
        nm += 1.0;
    }
    Ok(glass)
}

fn formula(place: &Cursor<'_>) -> Result<Glass> {
    let terms =
        |key| -> Result<Vec<f32>> { place.need(key)?.items()?.map(|term| term.f32()).collect() };
    let checked = |glass: std::result::Result<Glass, _>| {
        glass.map_err(|e| invalid(place, &e, "a physical formula"))
    };
    if let Some(cauchy) = place.get("cauchy")? {
        let [a, b] = cauchy.floats()?;
        return Ok(Glass::Cauchy { a, b });
    }
    if let Some(polynomial) = place.get("polynomial")? {
        let a = polynomial.floats()?;
        return Ok(Glass::Polynomial { a });
    }
    if let Some(constant) = place.get("constant")? {
        return checked(Glass::constant(constant.f32()?));
    }
    if let Some(nd) = place.get("nd")? {
        return checked(Glass::abbe(nd.f32()?, place.need("abbe")?.f32()?));
    }
    checked(Glass::sellmeier(&terms("B")?, &terms("C")?))
}

/// Reads `extras.kaustik` of a camera.
pub(super) fn camera(
    reader: &mut Reader<'_>,
    place: &Cursor<'_>,
) -> Result<(Option<Lens>, Option<Shutter>)> {
    if let Some(prescription) = place.get("lens")? {
        let expected = "a thin lens: \"aperture\" and \"focus\", with \"blades\" if it has them";
        return Err(prescription
            .error(ErrorKind::Unsupported, "a lens of several elements", expected)
            .help(
                "light is not traced through lens elements, whose flares, vignetting and distortion a thin lens \
                 would leave out",
            ));
    }
    warn_of_unknown(reader, place, &CAMERA)?;
    Ok((lens(reader, place)?, shutter(place)?))
}

fn lens(reader: &mut Reader<'_>, place: &Cursor<'_>) -> Result<Option<Lens>> {
    let positive = |place: &Cursor<'_>| match place.f32()? {
        value if value > 0.0 => Ok(value),
        _ => Err(place.mismatch("a number above 0")),
    };
    let Some(aperture) = place.get("aperture")? else {
        for key in ["focus", "blades", "rotation"] {
            if let Some(member) = place.get(key)? {
                reader.warn(&member, "ignored: there is no \"aperture\"");
            }
        }
        return Ok(None);
    };
    if aperture.f32()? == 0.0 {
        return Ok(None); // a pinhole
    }
    Ok(Some(Lens {
        aperture: positive(&aperture)?,
        focus: match place.get("focus")? {
            Some(focus) => positive(&focus)?,
            None => {
                let expected = "a \"focus\" beside the \"aperture\"";
                return Err(place.error(ErrorKind::Value, "no \"focus\"", expected));
            }
        },
        blades: blades(reader, place)?,
    }))
}

fn blades(reader: &mut Reader<'_>, place: &Cursor<'_>) -> Result<Option<Blades>> {
    let Some(count) = place.get("blades")? else {
        if let Some(rotation) = place.get("rotation")? {
            reader.warn(&rotation, "ignored: there are no \"blades\"");
        }
        return Ok(None);
    };
    match count.usize()? {
        number @ 3..=64 => Ok(Some(Blades {
            count: number as u32,
            rotation: place.f32_or("rotation", 0.0)?,
        })),
        _ => Err(count.mismatch("3 to 64 blades")),
    }
}

fn shutter(place: &Cursor<'_>) -> Result<Option<Shutter>> {
    let Some(shutter) = place.get("shutter")? else {
        return Ok(None);
    };
    let [open, close] = shutter.floats()?;
    if close < open {
        let found = format!("[{open}, {close}]");
        return Err(shutter.error(ErrorKind::Value, found, "[open, close] with open <= close"));
    }
    Ok(Some(Shutter { open, close }))
}
