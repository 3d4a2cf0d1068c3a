//! From a description to a scene.

use std::sync::Arc;

use glam::{Affine3A, DVec2, DVec3, Vec3A};
use kaustik_geometry::{Aabb, Instance, World};

use super::content::content;
use super::{Scene, SceneError};
use crate::camera::Camera;
use crate::description::{
    CameraDescription, Description, EnvironmentDescription, MaterialDescription, Projection,
};
use crate::emitter::{Emitters, Punctual, Sources};
use crate::environment::Environment;
use crate::material::Material;
use crate::matter::Matter;
use crate::texture::Texture;

/// Choices that are not the scene's own.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneOptions {
    /// Columns of the image, > 0.
    pub width: u32,
    /// Rows of the image, > 0.
    pub height: u32,
    /// Name or index of the camera; `None` takes the first.
    pub camera: Option<String>,
    /// Replaces the scene's environment.
    pub environment: Option<EnvironmentDescription>,
    /// Give back the energy that scatters between facets of rough surfaces.
    pub compensation: bool,
}

impl Default for SceneOptions {
    fn default() -> Self {
        Self {
            width: 1024,
            height: 1024,
            camera: None,
            environment: None,
            compensation: true,
        }
    }
}

impl Scene {
    /// Compiles a description: builds the ray-tracing structure, prepares materials, collects emitters.
    ///
    /// # Errors
    /// An index out of range, geometry or an image that is not what it says, a camera that does
    /// not exist or cannot be, a spectrum without sense.
    pub fn new(description: &Description, options: &SceneOptions) -> Result<Self, SceneError> {
        let mut notices = Vec::new();
        let matter = matter(description, options)?;
        let (center, radius) = bounding_sphere(&matter.world);
        let camera = camera_description(
            description,
            options,
            &matter.world.bounds(),
            (center, radius),
            &mut notices,
        )?;
        if camera.lens.is_some() && matches!(camera.projection, Projection::Orthographic { .. }) {
            notices.push(
                "an orthographic camera has no lens: its aperture and focus are ignored".to_owned(),
            );
        }
        // Builders know which part of the raster they serve; the camera accepts all of it.
        let camera = Camera::new(&camera, options.width, options.height)?
            .with_window(DVec2::NEG_INFINITY, DVec2::INFINITY);
        let environment = options
            .environment
            .as_ref()
            .or(description.environment.as_ref());
        let build_environment = |description: &EnvironmentDescription| {
            Environment::new(description).map_err(|e| SceneError::Environment(e.to_string()))
        };
        let emits = !description.lights.is_empty()
            || matter
                .material_of
                .iter()
                .any(|&m| matter.material(m).is_emissive());
        let environment = match environment {
            Some(environment) => Some(build_environment(environment)?),
            None if emits => None,
            None => {
                notices.push(
                    "the scene has no light: a constant environment of radiance 1 is used \
                     (choose another with --environment)"
                        .to_owned(),
                );
                Some(build_environment(&EnvironmentDescription::Constant(
                    [1.0; 3],
                ))?)
            }
        };
        let sources = Sources {
            punctual: description.lights.iter().map(Punctual::new).collect(),
            environment,
            center,
            radius,
        };
        let emitters = Emitters::new(&matter, sources);
        let camera_interior = matter.interior_at(camera.position());
        Ok(Self {
            matter,
            emitters,
            camera,
            camera_interior,
            notices,
            center,
            radius,
            image_size: [options.width, options.height],
            content: content(description, options),
        })
    }
}

fn matter(description: &Description, options: &SceneOptions) -> Result<Matter, SceneError> {
    let textures = description
        .textures
        .iter()
        .enumerate()
        .map(|(index, texture)| {
            let image =
                description
                    .images
                    .get(texture.image)
                    .ok_or_else(|| SceneError::Reference {
                        what: format!("texture {index}"),
                        kind: "image",
                        index: texture.image,
                        count: description.images.len(),
                    })?;
            Ok(Texture::new(texture, Arc::clone(image))?)
        })
        .collect::<Result<Vec<_>, SceneError>>()?;
    let mut materials = description
        .materials
        .iter()
        .map(|material| Material::new(material, &textures, options.compensation))
        .collect::<Result<Vec<_>, _>>()?;
    let fallback = materials.len() as u32;
    materials.push(Material::new(
        &MaterialDescription::default(),
        &textures,
        options.compensation,
    )?);
    let material_of = description
        .instances
        .iter()
        .map(|instance| match instance.material {
            None => Ok(fallback),
            Some(index) if index < description.materials.len() => Ok(index as u32),
            Some(index) => Err(SceneError::Reference {
                what: format!("instance '{}'", instance.name),
                kind: "material",
                index,
                count: description.materials.len(),
            }),
        })
        .collect::<Result<Vec<u32>, _>>()?;
    let instances = description
        .instances
        .iter()
        .map(|instance| Instance {
            mesh: instance.mesh as u32,
            transform: instance.transform,
        })
        .collect();
    let used = |test: fn(&Material) -> bool| {
        material_of
            .iter()
            .any(|&index| test(&materials[index as usize]))
    };
    let has_alpha = used(Material::has_alpha);
    let has_solids = used(|material| material.solid().is_some());
    let world = World::build(description.meshes.clone(), instances)?;
    Ok(Matter {
        world,
        materials,
        textures,
        material_of,
        has_alpha,
        has_solids,
    })
}

/// A little larger than the sphere around the bounding box; never empty.
fn bounding_sphere(world: &World) -> (DVec3, f64) {
    let bounds = world.bounds();
    let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
    let diagonal = (max - min).length();
    if diagonal.is_finite() && min.cmple(max).all() {
        (
            (min + max) * 0.5,
            (diagonal * 0.5 * (1.0 + 1e-5)).max(1e-30),
        )
    } else {
        (DVec3::ZERO, 1.0)
    }
}

fn camera_description(
    description: &Description,
    options: &SceneOptions,
    bounds: &Aabb,
    sphere: (DVec3, f64),
    notices: &mut Vec<String>,
) -> Result<CameraDescription, SceneError> {
    let cameras = &description.cameras;
    match (&options.camera, cameras.first()) {
        (Some(wanted), _) => {
            let camera = description.camera(Some(wanted)).cloned();
            camera.ok_or_else(|| {
                let named = cameras.iter().enumerate();
                let names: Vec<String> = named
                    .take(50)
                    .map(|(i, camera)| format!("{i} ({})", camera.name))
                    .collect();
                SceneError::NoSuchCamera {
                    wanted: wanted.clone(),
                    known: if names.is_empty() {
                        "none".to_owned()
                    } else {
                        names.join(", ")
                    },
                }
            })
        }
        (None, Some(first)) => Ok(first.clone()),
        (None, None) => {
            notices.push("the scene has no camera: one that frames everything is used".to_owned());
            let aspect = f64::from(options.width) / f64::from(options.height);
            Ok(framing_camera(bounds, sphere, aspect))
        }
    }
}

/// Looks at everything from the front, a little from above and the right, as near as the corners of the
/// bounding box allow.
fn framing_camera(bounds: &Aabb, (center, radius): (DVec3, f64), aspect: f64) -> CameraDescription {
    const YFOV: f64 = 0.7;
    const MARGIN: f64 = 1.05;
    let direction = DVec3::new(0.45, 0.35, 1.0).normalize();
    // A camera looks along its -z.
    let x = DVec3::Y.cross(direction).normalize();
    let y = direction.cross(x);
    let slope = libm::tan(YFOV * 0.5);
    let (low, high) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
    let mut distance = radius * 1e-3;
    for corner in 0..8u32 {
        let pick =
            |axis: u32, low: f64, high: f64| if corner >> axis & 1 == 0 { low } else { high };
        let at = DVec3::new(
            pick(0, low.x, high.x),
            pick(1, low.y, high.y),
            pick(2, low.z, high.z),
        );
        let from = if at.is_finite() {
            at - center
        } else {
            DVec3::ZERO
        };
        let aside = (x.dot(from).abs() / aspect).max(y.dot(from).abs()) * MARGIN / slope;
        distance = distance.max(aside + direction.dot(from));
    }
    let eye = center + direction * distance;
    let column = |v: DVec3| Vec3A::from(v.as_vec3());
    let transform = Affine3A::from_cols(column(x), column(y), column(direction), column(eye));
    CameraDescription {
        name: "framing".to_owned(),
        transform,
        projection: Projection::Perspective {
            yfov: YFOV as f32,
            aspect_ratio: None,
        },
        lens: None,
        shutter: None,
    }
}
