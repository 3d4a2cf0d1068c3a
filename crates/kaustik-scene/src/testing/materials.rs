use crate::description::{AlphaMode, MaterialDescription, Specular, Transmission, Volume};

/// A Lambertian surface of this linear Rec.709 albedo.
pub fn diffuse(albedo: [f32; 3]) -> MaterialDescription {
    let [r, g, b] = albedo;
    MaterialDescription {
        base_color: [r, g, b, 1.0],
        metallic: 0.0,
        specular: Specular {
            factor: 0.0,
            texture: None,
            color: [1.0; 3],
            color_texture: None,
        },
        ..MaterialDescription::default()
    }
}

/// A Lambertian surface of the same albedo everywhere in the spectrum.
pub fn grey(albedo: f32) -> MaterialDescription {
    diffuse([albedo; 3])
}

/// A black surface whose front has this white radiance.
pub fn lamp(radiance: f32) -> MaterialDescription {
    MaterialDescription {
        emissive: [radiance; 3],
        ..grey(0.0)
    }
}

/// The same on both sides: a lamp that shines to the back as well.
pub fn double_sided(material: MaterialDescription) -> MaterialDescription {
    MaterialDescription {
        double_sided: true,
        ..material
    }
}

/// The same, partly transparent: `1 - opacity` of all light goes straight through.
pub fn blended(material: MaterialDescription, opacity: f32) -> MaterialDescription {
    let [r, g, b, _] = material.base_color;
    MaterialDescription {
        base_color: [r, g, b, opacity],
        alpha_mode: AlphaMode::Blend,
        ..material
    }
}

/// A mirror of this colour at normal incidence, or blurred metal.
pub fn metal(color: [f32; 3], roughness: f32) -> MaterialDescription {
    let [r, g, b] = color;
    MaterialDescription {
        base_color: [r, g, b, 1.0],
        metallic: 1.0,
        roughness,
        ..MaterialDescription::default()
    }
}

/// A transparent solid, of which `color` is left of white light after the distance 1.
pub fn dielectric(ior: f32, roughness: f32, color: [f32; 3]) -> MaterialDescription {
    MaterialDescription {
        metallic: 0.0,
        roughness,
        ior,
        transmission: Some(Transmission {
            factor: 1.0,
            texture: None,
        }),
        volume: Some(Volume {
            thickness: 1.0,
            attenuation_distance: 1.0,
            attenuation_color: color,
        }),
        ..MaterialDescription::default()
    }
}
