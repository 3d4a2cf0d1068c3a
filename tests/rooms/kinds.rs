//! The sorts of material that files may ask for.

use kaustik::scene::description::{
    AlphaMode, Anisotropy, Clearcoat, DiffuseTransmission, Iridescence, MaterialDescription, Model,
    Sheen, SpecularGlossiness, TextureSlot, Transmission, UvTransform, Volume,
};
use kaustik::spectrum::{Glass, Metal};

use super::Builder;
use crate::support::paint;

/// What materials of a kind differ by.
#[derive(Clone, Copy)]
pub(super) struct Swatch {
    pub(super) albedo: [f32; 3],
    pub(super) roughness: f32,
}

impl Swatch {
    fn paint(self) -> MaterialDescription {
        diffuse(self.albedo)
    }

    fn plastic(self) -> MaterialDescription {
        MaterialDescription {
            roughness: self.roughness,
            ..plastic(self.albedo)
        }
    }

    fn metal(self) -> MaterialDescription {
        metal(self.albedo, self.roughness)
    }
}

/// One of the sorts of material that files may ask for.
pub(super) struct Kind {
    pub(super) name: &'static str,
    pub(super) is_dirac: bool,
    pub(super) make: fn(&mut Builder, Swatch) -> MaterialDescription,
}

const fn kind(name: &'static str, make: fn(&mut Builder, Swatch) -> MaterialDescription) -> Kind {
    Kind {
        name,
        is_dirac: false,
        make,
    }
}

/// Of which a part scatters into single directions.
const fn dirac(name: &'static str, make: fn(&mut Builder, Swatch) -> MaterialDescription) -> Kind {
    Kind {
        is_dirac: true,
        ..kind(name, make)
    }
}

pub(super) const KINDS: [Kind; 22] = [
    kind("paint", |_, swatch| swatch.paint()),
    kind("rough paint", |_, swatch| {
        model(swatch, Model::OrenNayar { sigma: 0.8 })
    }),
    kind("phong", |_, swatch| {
        model(swatch, Model::Phong { exponent: 20.0 })
    }),
    dirac("coated paint", |_, swatch| model(swatch, Model::Coated)),
    kind("metal", |_, swatch| swatch.metal()),
    kind("measured metal", |_, swatch| MaterialDescription {
        metal: Some([Metal::Au, Metal::Al][usize::from(swatch.roughness > 0.5)]),
        ..swatch.metal()
    }),
    dirac("mirror", |_, _| metal([0.9; 3], 0.0)),
    kind("plastic", |_, swatch| swatch.plastic()),
    kind("varnished metal", |_, swatch| {
        varnished(metal(swatch.albedo, 0.5), swatch.roughness)
    }),
    dirac("smoothly varnished plastic", |_, swatch| {
        varnished(swatch.plastic(), 0.0)
    }),
    kind("cloth", cloth),
    kind("brushed metal", brushed),
    kind("iridescent metal", iridescent),
    dirac("smooth pane", |_, swatch| glass(swatch.albedo, 0.0)),
    dirac("glass", |_, swatch| {
        solid(glass([1.0; 3], 0.0), swatch.albedo)
    }),
    kind("rough glass", |_, swatch| {
        solid(glass([1.0; 3], swatch.roughness), swatch.albedo)
    }),
    dirac("dispersive glass", |_, _| MaterialDescription {
        glass: Glass::named("sf11"),
        ..solid(glass([1.0; 3], 0.0), [1.0; 3])
    }),
    kind("something half there", |_, swatch| {
        let [r, g, b] = swatch.albedo;
        MaterialDescription {
            alpha_mode: AlphaMode::Blend,
            base_color: [r, g, b, 0.6],
            ..swatch.plastic()
        }
    }),
    kind("texture with holes", |room, swatch| MaterialDescription {
        alpha_mode: if room.one_in(2) {
            AlphaMode::Mask(0.5)
        } else {
            AlphaMode::Blend
        },
        base_color_texture: Some(SLOT),
        ..swatch.plastic()
    }),
    kind("what glows", |room, swatch| MaterialDescription {
        emissive: room.color(0.1, 0.8),
        double_sided: true,
        ..swatch.plastic()
    }),
    kind("texture of bumps and gloss", |_, swatch| {
        MaterialDescription {
            base_color_texture: Some(SLOT),
            metallic_roughness_texture: Some(SLOT),
            normal_texture: Some(SLOT),
            normal_scale: 0.3,
            metallic: 0.6,
            roughness: 0.9,
            ..plastic(swatch.albedo)
        }
    }),
    dirac("half glass or gloss", half_glass_or_gloss),
];

/// Those that came later.
pub(super) const LEAVES: [Kind; 3] = [
    kind("leaf", |room, swatch| leaf(room, swatch.plastic())),
    dirac("smoothly varnished leaf", |room, swatch| {
        varnished(leaf(room, swatch.plastic()), 0.0)
    }),
    dirac("leaf with clear spots", |room, swatch| {
        let clear = Transmission {
            factor: 0.3,
            texture: Some(SLOT),
        };
        MaterialDescription {
            transmission: Some(clear),
            roughness: 0.0,
            ..leaf(room, swatch.paint())
        }
    }),
];

fn leaf(room: &mut Builder, material: MaterialDescription) -> MaterialDescription {
    let through = DiffuseTransmission {
        factor: room.between(0.2, 0.8),
        texture: None,
        color: room.color(0.2, 0.9),
        color_texture: None,
    };
    MaterialDescription {
        diffuse_transmission: Some(through),
        ..material
    }
}

fn cloth(room: &mut Builder, swatch: Swatch) -> MaterialDescription {
    let sheen = Sheen {
        color: room.color(0.2, 1.0),
        color_texture: None,
        roughness: swatch.roughness,
        roughness_texture: None,
    };
    MaterialDescription {
        sheen: Some(sheen),
        ..swatch.plastic()
    }
}

fn brushed(room: &mut Builder, swatch: Swatch) -> MaterialDescription {
    let anisotropy = Anisotropy {
        strength: room.between(0.2, 0.8),
        rotation: room.between(0.0, 3.0),
        texture: None,
    };
    MaterialDescription {
        anisotropy: Some(anisotropy),
        ..swatch.metal()
    }
}

fn iridescent(room: &mut Builder, swatch: Swatch) -> MaterialDescription {
    let film = Iridescence {
        factor: room.between(0.3, 1.0),
        texture: None,
        ior: 1.3,
        thickness: [0.0, room.between(200.0, 600.0)],
        thickness_texture: None,
    };
    MaterialDescription {
        iridescence: Some(film),
        ..swatch.metal()
    }
}

/// Half transparent and smooth, or of the older model.
fn half_glass_or_gloss(room: &mut Builder, swatch: Swatch) -> MaterialDescription {
    let gloss = SpecularGlossiness {
        specular: [0.3; 3],
        glossiness: 0.6,
        texture: None,
    };
    if room.one_in(2) {
        MaterialDescription {
            specular_glossiness: Some(gloss),
            ..swatch.plastic()
        }
    } else {
        let half = Transmission {
            factor: 0.5,
            texture: None,
        };
        MaterialDescription {
            transmission: Some(half),
            roughness: 0.0,
            ..swatch.plastic()
        }
    }
}

const SLOT: TextureSlot = TextureSlot {
    texture: 0,
    uv_set: 0,
    transform: UvTransform::IDENTITY,
};

pub(super) fn diffuse(albedo: [f32; 3]) -> MaterialDescription {
    MaterialDescription {
        name: "paint".to_owned(),
        ..paint(albedo)
    }
}

fn model(swatch: Swatch, model: Model) -> MaterialDescription {
    MaterialDescription {
        model: Some(model),
        ..swatch.paint()
    }
}

pub(super) fn metal([r, g, b]: [f32; 3], roughness: f32) -> MaterialDescription {
    MaterialDescription {
        base_color: [r, g, b, 1.0],
        roughness,
        ..MaterialDescription::default()
    }
}

fn plastic([r, g, b]: [f32; 3]) -> MaterialDescription {
    MaterialDescription {
        base_color: [r, g, b, 1.0],
        metallic: 0.0,
        ..MaterialDescription::default()
    }
}

fn varnished(material: MaterialDescription, roughness: f32) -> MaterialDescription {
    let varnish = Clearcoat {
        factor: 0.8,
        texture: None,
        roughness,
        roughness_texture: None,
        normal_texture: None,
        normal_scale: 1.0,
    };
    MaterialDescription {
        clearcoat: Some(varnish),
        ..material
    }
}

/// A pane; with [`solid`] a body.
fn glass(albedo: [f32; 3], roughness: f32) -> MaterialDescription {
    let all = Transmission {
        factor: 1.0,
        texture: None,
    };
    MaterialDescription {
        roughness,
        transmission: Some(all),
        ..plastic(albedo)
    }
}

fn solid(glass: MaterialDescription, attenuation_color: [f32; 3]) -> MaterialDescription {
    MaterialDescription {
        volume: Some(Volume {
            thickness: 1.0,
            attenuation_distance: 1.0,
            attenuation_color,
        }),
        ..glass
    }
}
