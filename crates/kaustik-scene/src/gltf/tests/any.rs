//! Scenes with a bit of everything, from a seed.

use std::sync::Arc;

use glam::{Affine3A, Quat, Vec2, Vec3, Vec4};
use kaustik_geometry::Mesh;
use kaustik_spectrum::{Glass, Metal};

use super::file::{jpeg, png, png_of_16_bits, webp};
use crate::Description;
use crate::description::*;
use crate::testing::Rng;

/// An uncompressed Radiance file of 3 x 2 pixels.
pub(super) fn small_hdr() -> Vec<u8> {
    let mut bytes = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 3\n".to_vec();
    for i in 0..6 {
        bytes.extend([128 + i, 64, 3 * i, 126 + i]);
    }
    bytes
}

fn number(rng: &mut Rng) -> f32 {
    let magnitude = libm::exp2f(40.0 * rng.uniform() as f32 - 20.0);
    if rng.uniform() < 0.5 {
        -magnitude
    } else {
        magnitude
    }
}

fn unit(rng: &mut Rng) -> f32 {
    rng.uniform() as f32
}

fn below(rng: &mut Rng, most: usize) -> usize {
    (rng.uniform() * most as f64) as usize
}

fn numbers<const N: usize>(rng: &mut Rng, each: impl Fn(&mut Rng) -> f32) -> [f32; N] {
    std::array::from_fn(|_| each(rng))
}

fn maybe<T>(rng: &mut Rng, make: impl FnOnce(&mut Rng) -> T) -> Option<T> {
    (rng.uniform() < 0.5).then(|| make(rng))
}

fn transform(rng: &mut Rng) -> Affine3A {
    if rng.uniform() < 0.2 {
        return Affine3A::IDENTITY;
    }
    Affine3A::from_cols_array(&numbers(rng, number))
}

fn mesh(rng: &mut Rng) -> Mesh {
    let count = 3 + below(rng, 10);
    let vectors = |rng: &mut Rng| {
        (0..count)
            .map(|_| Vec3::from(numbers(rng, number)))
            .collect()
    };
    let uv = |rng: &mut Rng| {
        (0..count)
            .map(|_| Vec2::from(numbers(rng, number)))
            .collect()
    };
    let tangent = |rng: &mut Rng| {
        let [x, y, z] = numbers(rng, unit);
        Vec4::new(x, y, z, if rng.uniform() < 0.5 { 1.0 } else { -1.0 })
    };
    let tangents = |rng: &mut Rng| (0..count).map(|_| tangent(rng)).collect();
    let colors = |rng: &mut Rng| (0..count).map(|_| numbers(rng, unit)).collect();
    let triangles = 1 + below(rng, 8);
    let index = |rng: &mut Rng| below(rng, count) as u32;
    Mesh {
        positions: vectors(rng),
        indices: (0..triangles)
            .map(|_| [index(rng), index(rng), index(rng)])
            .collect(),
        normals: maybe(rng, vectors).unwrap_or_default(),
        tangents: maybe(rng, tangents).unwrap_or_default(),
        uv: [
            maybe(rng, uv).unwrap_or_default(),
            maybe(rng, uv).unwrap_or_default(),
        ],
        colors: maybe(rng, colors).unwrap_or_default(),
    }
}

fn slot(rng: &mut Rng, textures: usize) -> TextureSlot {
    let transform = maybe(rng, |rng| UvTransform {
        offset: numbers(rng, number),
        rotation: number(rng),
        scale: numbers(rng, number),
    });
    TextureSlot {
        texture: below(rng, textures),
        uv_set: below(rng, 2) as u8,
        transform: transform.unwrap_or(UvTransform::IDENTITY),
    }
}

fn spectrum(rng: &mut Rng, most: f32) -> SpectralInput {
    if rng.uniform() < 0.3 {
        return SpectralInput::Named("cornell-white".into());
    }
    let knots = 1 + below(rng, 5);
    let mut nm = 300.0;
    let mut knot = |rng: &mut Rng| {
        nm += 1.0 + 100.0 * unit(rng);
        (nm, most * unit(rng))
    };
    SpectralInput::Knots((0..knots).map(|_| knot(rng)).collect())
}

fn glass(rng: &mut Rng) -> Glass {
    let all = [
        Glass::named("sf11").unwrap(),
        Glass::constant(1.0 + unit(rng)).unwrap(),
        Glass::abbe(1.3 + unit(rng), 20.0 + 40.0 * unit(rng)).unwrap(),
        Glass::sellmeier(&[unit(rng), 0.1], &[0.01, 0.02]).unwrap(),
        Glass::Polynomial {
            a: [0.0, 0.001, 2.0 + unit(rng), 0.01, 0.0, 0.0, 0.0],
        },
    ];
    all[below(rng, all.len())]
}

fn material(rng: &mut Rng, textures: usize) -> MaterialDescription {
    let texture = |rng: &mut Rng| maybe(rng, |rng| slot(rng, textures));
    let normal_texture = texture(rng);
    let coat_normals = texture(rng);
    let alpha_modes = [
        AlphaMode::Opaque,
        AlphaMode::Mask(unit(rng)),
        AlphaMode::Blend,
    ];
    let models = [
        None,
        Some(Model::Coated),
        Some(Model::Phong {
            exponent: 99.0 * unit(rng),
        }),
        Some(Model::OrenNayar { sigma: unit(rng) }),
    ];
    let bright = |rng: &mut Rng| number(rng).abs();
    let metal = maybe(rng, |rng| Metal::ALL[below(rng, 4)]);
    let model = models[below(rng, 4)];
    // A measured metal and a model of its own have no layers.
    let bare = metal.is_some() || model.is_some();
    let transmission = maybe(rng, |rng| Transmission {
        factor: unit(rng),
        texture: texture(rng),
    });
    let diffuse_transmission = maybe(rng, |rng| DiffuseTransmission {
        factor: unit(rng),
        texture: texture(rng),
        color: numbers(rng, unit),
        color_texture: texture(rng),
    });
    let volume = maybe(rng, |rng| Volume {
        thickness: bright(rng),
        attenuation_distance: maybe(rng, bright).unwrap_or(f32::INFINITY),
        attenuation_color: numbers(rng, unit),
    });
    MaterialDescription {
        name: format!("material \"{}\"", below(rng, 100)),
        base_color: numbers(rng, unit),
        base_color_texture: texture(rng),
        metallic: unit(rng),
        roughness: unit(rng),
        metallic_roughness_texture: texture(rng),
        normal_texture,
        normal_scale: normal_texture.map_or(1.0, |_| number(rng)),
        emissive: maybe(rng, |rng| numbers(rng, bright)).unwrap_or_default(),
        emissive_texture: texture(rng),
        alpha_mode: alpha_modes[below(rng, 3)],
        double_sided: rng.uniform() < 0.5,
        unlit: rng.uniform() < 0.5,
        ior: maybe(rng, |rng| 1.0 + unit(rng)).unwrap_or(0.0),
        dispersion: unit(rng),
        specular: Specular {
            factor: unit(rng),
            texture: texture(rng),
            color: numbers(rng, bright),
            color_texture: texture(rng),
        },
        specular_glossiness: maybe(rng, |rng| SpecularGlossiness {
            specular: numbers(rng, unit),
            glossiness: unit(rng),
            texture: texture(rng),
        }),
        transmission,
        // There is none of what has an inside.
        diffuse_transmission: diffuse_transmission.filter(|_| !bare && volume.is_none()),
        volume,
        clearcoat: maybe(rng, |rng| Clearcoat {
            factor: unit(rng),
            texture: texture(rng),
            roughness: unit(rng),
            roughness_texture: texture(rng),
            normal_texture: coat_normals,
            normal_scale: coat_normals.map_or(1.0, |_| number(rng)),
        })
        .filter(|_| !bare),
        sheen: maybe(rng, |rng| Sheen {
            color: numbers(rng, unit),
            color_texture: texture(rng),
            roughness: unit(rng),
            roughness_texture: texture(rng),
        })
        .filter(|_| !bare),
        anisotropy: maybe(rng, |rng| Anisotropy {
            strength: unit(rng),
            rotation: number(rng),
            texture: texture(rng),
        })
        .filter(|_| !bare),
        iridescence: maybe(rng, |rng| Iridescence {
            factor: unit(rng),
            texture: texture(rng),
            ior: 1.0 + unit(rng),
            thickness: numbers(rng, bright),
            thickness_texture: texture(rng),
        })
        .filter(|_| !bare),
        reflectance: maybe(rng, |rng| spectrum(rng, 1.0)),
        emission: maybe(rng, |rng| spectrum(rng, 50.0)),
        metal,
        glass: maybe(rng, glass),
        model,
        priority: below(rng, 5) as i32 - 2,
    }
}

fn images() -> Vec<Arc<ImageData>> {
    let image = |name: &str, width, height, rgb: bool| {
        let encoded = if rgb {
            jpeg(width, height)
        } else {
            png(width, height)
        };
        let pixels = image::load_from_memory(&encoded)
            .unwrap()
            .into_rgba8()
            .into_raw();
        let name = name.to_owned();
        Arc::new(ImageData {
            name,
            width,
            height,
            pixels: Pixels::Rgba8(pixels),
            encoded,
        })
    };
    let made = ImageData {
        encoded: Vec::new(),
        ..ImageData::clone(&image("made", 5, 3, false))
    };
    let encoded = webp(5, 4);
    let pixels = image::load_from_memory(&encoded).unwrap().into_rgba8();
    let lossless = ImageData {
        name: "lossless".to_owned(),
        width: 5,
        height: 4,
        pixels: Pixels::Rgba8(pixels.into_raw()),
        encoded,
    };
    let encoded = png_of_16_bits(2, 3);
    let pixels = image::load_from_memory(&encoded).unwrap().into_rgba16();
    let deep = ImageData {
        name: "deep".to_owned(),
        width: 2,
        height: 3,
        pixels: Pixels::Rgba16(pixels.into_raw()),
        encoded,
    };
    vec![
        image("a", 4, 4, false),
        image("", 9, 2, true),
        Arc::new(deep),
        Arc::new(made),
        Arc::new(lossless),
    ]
}

fn camera(rng: &mut Rng, i: usize) -> CameraDescription {
    let perspective = Projection::Perspective {
        yfov: 0.1 + 3.0 * unit(rng),
        aspect_ratio: maybe(rng, |rng| 0.1 + unit(rng)),
    };
    let orthographic = Projection::Orthographic {
        xmag: number(rng).abs(),
        ymag: number(rng).abs(),
    };
    let positive = |rng: &mut Rng| number(rng).abs();
    CameraDescription {
        name: if i == 0 {
            String::new()
        } else {
            format!("camera {i}")
        },
        transform: transform(rng),
        projection: if rng.uniform() < 0.5 {
            perspective
        } else {
            orthographic
        },
        lens: maybe(rng, |rng| Lens {
            aperture: positive(rng),
            focus: positive(rng),
            blades: maybe(rng, |rng| Blades {
                count: 3 + below(rng, 62) as u32,
                rotation: number(rng),
            }),
        }),
        shutter: maybe(rng, |rng| Shutter {
            open: unit(rng) - 1.0,
            close: unit(rng),
        }),
    }
}

fn light(rng: &mut Rng, i: usize) -> LightDescription {
    let inner = unit(rng);
    let spot = LightKind::Spot {
        inner,
        outer: inner + 0.5 * unit(rng),
    };
    LightDescription {
        name: format!("light {i}"),
        kind: [LightKind::Point, LightKind::Directional, spot][below(rng, 3)],
        color: numbers(rng, unit),
        intensity: number(rng).abs(),
        range: maybe(rng, |rng| number(rng).abs()),
        transform: transform(rng),
    }
}

fn environment(rng: &mut Rng) -> EnvironmentDescription {
    let mut sky = crate::environment::decode_hdr("sky.hdr", &small_hdr())
        .unwrap()
        .image;
    match below(rng, 4) {
        0 => return EnvironmentDescription::Constant(numbers(rng, unit)),
        1 => sky.encoded = small_hdr(),
        2 => sky.encoded = Vec::new(),
        _ => {
            sky = ImageData::clone(&images()[below(rng, 3)]);
            sky.pixels = crate::gltf::environment::radiances(&sky.pixels);
        }
    }
    EnvironmentDescription::Image {
        image: Arc::new(sky),
        strength: number(rng).abs(),
        rotation: Quat::from_rotation_y(6.0 * unit(rng)),
    }
}

/// A scene with a bit of everything.
pub(super) fn description(seed: u64) -> Description {
    let rng = &mut Rng::new(seed);
    let images = images();
    let kinds = [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp];
    let textures = (0..1 + below(rng, 4)).map(|_| TextureDescription {
        image: below(rng, images.len()),
        wrap_s: kinds[below(rng, 3)],
        wrap_t: kinds[below(rng, 3)],
        filtering: [Filtering::Linear, Filtering::Nearest][below(rng, 2)],
    });
    let textures: Vec<_> = textures.collect();
    let materials: Vec<_> = (0..1 + below(rng, 3))
        .map(|_| material(rng, textures.len()))
        .collect();
    let meshes: Vec<_> = (0..1 + below(rng, 3))
        .map(|_| Arc::new(mesh(rng)))
        .collect();
    let instance = |rng: &mut Rng, i: usize| InstanceDescription {
        name: format!("instance {i}"),
        mesh: below(rng, meshes.len()),
        material: maybe(rng, |rng| below(rng, materials.len())),
        transform: transform(rng),
    };
    Description {
        name: format!("scene {seed}"),
        instances: (0..below(rng, 6)).map(|i| instance(rng, i)).collect(),
        lights: (0..below(rng, 3)).map(|i| light(rng, i)).collect(),
        cameras: (0..below(rng, 3)).map(|i| camera(rng, i)).collect(),
        environment: maybe(rng, environment),
        meshes,
        materials,
        textures,
        images,
        animation: crate::description::AnimationDescription::default(),
    }
}
