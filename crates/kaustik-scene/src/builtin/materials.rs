use crate::description::{MaterialDescription, SpectralInput, Specular, Transmission, Volume};

/// A Lambertian surface of this linear Rec.709 albedo.
pub(super) fn diffuse(name: &str, albedo: [f32; 3]) -> MaterialDescription {
    let [r, g, b] = albedo;
    MaterialDescription {
        name: name.to_owned(),
        base_color: [r, g, b, 1.0],
        metallic: 0.0,
        roughness: 1.0,
        specular: Specular {
            factor: 0.0,
            texture: None,
            color: [1.0; 3],
            color_texture: None,
        },
        double_sided: true,
        ..MaterialDescription::default()
    }
}

/// A Lambertian surface with a measured reflectance; `albedo` is its colour under D65, for
/// viewers that know no spectra.
fn measured(name: &str, table: &str, albedo: [f32; 3]) -> MaterialDescription {
    MaterialDescription {
        reflectance: Some(SpectralInput::Named(table.to_owned())),
        ..diffuse(name, albedo)
    }
}

/// The white paint of the Cornell box.
pub(super) fn white() -> MaterialDescription {
    measured("white", "cornell-white", [0.738, 0.736, 0.739])
}

/// The red paint of the Cornell box.
pub(super) fn red() -> MaterialDescription {
    measured("red", "cornell-red", [0.494, 0.049, 0.051])
}

/// The green paint of the Cornell box.
pub(super) fn green() -> MaterialDescription {
    measured("green", "cornell-green", [0.068, 0.398, 0.087])
}

/// A black surface that radiates D65 on its front side.
pub(super) fn lamp(radiance: f32) -> MaterialDescription {
    MaterialDescription {
        emissive: [radiance; 3],
        double_sided: false,
        ..diffuse("lamp", [0.0; 3])
    }
}

/// A perfect mirror.
pub(super) fn mirror() -> MaterialDescription {
    MaterialDescription {
        name: "mirror".to_owned(),
        metallic: 1.0,
        roughness: 0.0,
        double_sided: true,
        ..MaterialDescription::default()
    }
}

/// A clear solid of this index of refraction; roughness 0 is smooth.
pub(super) fn solid(name: &str, ior: f32, roughness: f32) -> MaterialDescription {
    MaterialDescription {
        name: name.to_owned(),
        metallic: 0.0,
        roughness,
        ior,
        transmission: Some(Transmission {
            factor: 1.0,
            texture: None,
        }),
        volume: Some(Volume {
            thickness: 1.0,
            attenuation_distance: f32::INFINITY,
            attenuation_color: [1.0; 3],
        }),
        ..MaterialDescription::default()
    }
}
