//! From a description to a scene.

use std::collections::HashSet;
use std::sync::Arc;

use glam::{Affine3A, DVec2, DVec3, Vec3A};
use kaustik_geometry::{Aabb, Instance, Motion, World};

use super::content::content;
use super::motion::Motions;
use super::{Scene, SceneError, tangents};
use crate::camera::Camera;
use crate::description::{
    CameraDescription, Description, EnvironmentDescription, InstanceDescription, Load,
    MaterialDescription, Projection,
};
use crate::emitter::{Emitters, Punctual, Sources};
use crate::environment::Environment;
use crate::material::{Material, Media, has_smooth_bumps};
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
        let mut motions = motions(description, options, &mut notices)?;
        let matter = matter(description, options, &mut motions)?;
        if description.materials.iter().any(has_smooth_bumps) {
            notices.push(
                "a varnish (clearcoat) whose normals are not those of what it covers is rendered with a roughness of at least 0.05"
                    .to_owned(),
            );
        }
        let (center, radius) = bounding_sphere(&matter.world);
        let sphere = (center, radius);
        let bounds = matter.world.bounds();
        let camera = camera_description(description, options, &bounds, sphere, &mut notices)?;
        let motion = camera_motion(description, options, &mut motions);
        let camera = ready_camera(camera, motion.as_deref(), options, &mut notices)?;
        let camera_motion = motion.filter(|motion| !motion.is_still());
        let environment = environment(description, options, &matter, &mut notices)?;
        let lights = description.lights.iter().map(Punctual::new);
        let mut punctual: Vec<Punctual> = lights.collect();
        for (index, motion) in motions.lights {
            punctual[index].carry(motion);
        }
        let moves =
            matter.world.moves() || camera_motion.is_some() || punctual.iter().any(Punctual::moves);
        let sources = Sources {
            punctual,
            environment,
            center,
            radius,
        };
        let emitters = Emitters::new(&matter, sources)?;
        let camera_interior = matter.interior_at(camera.position());
        let typical_length = distance_seen(&matter.world, &camera).unwrap_or(radius);
        Ok(Self {
            matter,
            emitters: Arc::new(emitters),
            camera,
            camera_interior,
            camera_motion,
            moves,
            notices: notices.into(),
            material_names: (description.materials.iter())
                .map(|material| material.name.clone())
                .collect(),
            center,
            radius,
            typical_length,
            image_size: [options.width, options.height],
            compensates: options.compensation,
            content: content(description, options),
        })
    }
}

/// The camera, where its motion has it at first. Builders know which part of the raster they serve; the camera accepts
/// all of it.
fn ready_camera(
    mut camera: CameraDescription,
    motion: Option<&Motion>,
    options: &SceneOptions,
    notices: &mut Vec<String>,
) -> Result<Camera, SceneError> {
    if camera.lens.is_some() && matches!(camera.projection, Projection::Orthographic { .. }) {
        notices.push(
            "an orthographic camera has no lens: its aperture and focus are ignored".to_owned(),
        );
    }
    if let Some(motion) = motion {
        camera.transform = motion.at(0.0);
    }
    let camera = Camera::new(&camera, options.width, options.height)?;
    Ok(camera.with_window(DVec2::NEG_INFINITY, DVec2::INFINITY))
}

/// The environment that is chosen, or else the scene's; where nothing gives light, one of radiance 1.
fn environment(
    description: &Description,
    options: &SceneOptions,
    matter: &Matter,
    notices: &mut Vec<String>,
) -> Result<Option<Environment>, SceneError> {
    let usual = EnvironmentDescription::Constant([1.0; 3]);
    let chosen = options.environment.as_ref();
    let environment = match chosen.or(description.environment.as_ref()) {
        Some(environment) => environment,
        None if emits(description, matter) => return Ok(None),
        None => {
            notices.push(
                "the scene has no light: a constant environment of radiance 1 is used \
                 (choose another with --environment)"
                    .to_owned(),
            );
            &usual
        }
    };
    Environment::new(environment)
        .map(Some)
        .map_err(|e| SceneError::Environment(e.to_string()))
}

/// Is there a light in the scene, or a surface that emits?
fn emits(description: &Description, matter: &Matter) -> bool {
    let mut used = matter.material_of.iter();
    !description.lights.is_empty() || used.any(|&m| matter.material(m).is_emissive())
}

/// What moves while the chosen camera's shutter is open.
fn motions(
    description: &Description,
    options: &SceneOptions,
    notices: &mut Vec<String>,
) -> Result<Motions, SceneError> {
    if description.animation.is_empty() {
        return Ok(Motions::default());
    }
    let camera = description.camera(options.camera.as_deref());
    let Some(shutter) = camera.and_then(|camera| camera.shutter) else {
        notices.push(
            "what is animated stands at rest: the camera has no shutter interval \
             (\"shutter\" in its extras.kaustik)"
                .to_owned(),
        );
        return Ok(Motions::default());
    };
    // Roughly the size of the scene at rest: a light that turns must not miss by much at its far end.
    let boxes: Vec<_> = (description.meshes.iter())
        .map(|mesh| mesh.bounds())
        .collect();
    let reach = |instance: &InstanceDescription| {
        let size = boxes.get(instance.mesh).map_or(0.0, |bounds| {
            let far = bounds.min.abs().max(bounds.max.abs());
            f64::from(instance.transform.matrix3.abs().mul_vec3(far).max_element())
        });
        size + f64::from(instance.transform.translation.abs().max_element())
    };
    let reach = description.instances.iter().map(reach);
    let reach = reach.filter(|reach| reach.is_finite()).fold(0.0, f64::max);
    Motions::new(description, shutter, reach.max(1e-30))
}

/// The motion of the chosen camera. `None` where it stands still.
fn camera_motion(
    description: &Description,
    options: &SceneOptions,
    motions: &mut Motions,
) -> Option<Arc<Motion>> {
    let chosen = description.camera(options.camera.as_deref())?;
    let cameras = motions.cameras.iter();
    let mut of_chosen =
        cameras.filter(|(index, _)| std::ptr::eq(&raw const description.cameras[*index], chosen));
    of_chosen.next().map(|(_, motion)| Arc::new(motion.clone()))
}

/// Where instances stand, and the motions of those that do not stand still. What an animation holds in one
/// place stands still there.
fn instances(
    description: &Description,
    motions: &mut Motions,
) -> (Vec<Instance>, Vec<(u32, Motion)>) {
    let mut instances: Vec<Instance> = (description.instances.iter())
        .map(|instance| Instance {
            mesh: instance.mesh as u32,
            transform: instance.transform,
        })
        .collect();
    let mut moving = std::mem::take(&mut motions.instances);
    moving.retain(|(index, motion)| {
        let first = motion.at(0.0);
        let stands = motion.is_still() && first.matrix3.as_dmat3().determinant() != 0.0;
        if stands {
            instances[*index as usize].transform = first;
        }
        !stands
    });
    // What grows from nothing while it moves is nothing at rest.
    let moves: HashSet<usize> = moving.iter().map(|(index, _)| *index as usize).collect();
    let carried = &description.animation.carried;
    for load in carried.iter().map(|carried| carried.load) {
        let Load::Instance(index) = load else {
            continue;
        };
        let Some(rest) = instances.get(index).map(|instance| instance.transform) else {
            continue;
        };
        let flat = rest.matrix3.as_dmat3().determinant() == 0.0;
        if flat && !moves.contains(&index) {
            moving.extend(Motion::new(vec![(0.0, rest)]).map(|motion| (index as u32, motion)));
        }
    }
    (instances, moving)
}

fn matter(
    description: &Description,
    options: &SceneOptions,
    motions: &mut Motions,
) -> Result<Matter, SceneError> {
    let textures = textures(description)?;
    let mut materials = materials(description, options, &textures)?;
    let mut media = Media::default();
    for (index, material) in materials.iter_mut().enumerate() {
        material.join_media(index as u32, &mut media);
    }
    let material_of = material_of(description)?;
    let (mut instances, moving) = instances(description, motions);
    let used = |test: fn(&Material) -> bool| {
        material_of
            .iter()
            .any(|&index| test(&materials[index as usize]))
    };
    let has_alpha = used(Material::has_alpha);
    let has_panes = used(Material::is_pane);
    let has_solids = used(|material| material.solid().is_some());
    let meshes = tangents::complete(&description.meshes, &mut instances, |instance| {
        let material = &materials[material_of[instance] as usize];
        material.tangents_along()
    });
    let world = World::moving(meshes, instances, moving)?;
    Ok(Matter {
        world,
        materials: materials.into(),
        textures: textures.into(),
        material_of: material_of.into(),
        has_alpha,
        has_panes,
        has_solids,
    })
}

fn textures(description: &Description) -> Result<Vec<Texture>, SceneError> {
    let textures = description.textures.iter().enumerate();
    let ready = textures.map(|(index, texture)| {
        let image = description.images.get(texture.image);
        let image = image.ok_or_else(|| SceneError::Reference {
            what: format!("texture {index}"),
            kind: "image",
            index: texture.image,
            count: description.images.len(),
        })?;
        Ok(Texture::new(texture, Arc::clone(image))?)
    });
    ready.collect()
}

/// All materials, and after them that of instances without one.
fn materials(
    description: &Description,
    options: &SceneOptions,
    textures: &[Texture],
) -> Result<Vec<Material>, SceneError> {
    let fallback = MaterialDescription::default();
    let all = description.materials.iter().chain([&fallback]);
    all.map(|material| Material::new(material, textures, options.compensation))
        .collect()
}

/// For each instance its material, as [`materials`] counts them.
fn material_of(description: &Description) -> Result<Vec<u32>, SceneError> {
    let count = description.materials.len();
    let instances = description.instances.iter();
    instances
        .map(|instance| match instance.material {
            None => Ok(count as u32),
            Some(index) if index < count => Ok(index as u32),
            Some(index) => Err(SceneError::Reference {
                what: format!("instance '{}'", instance.name),
                kind: "material",
                index,
                count,
            }),
        })
        .collect()
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

/// The geometric mean of the distances to what the camera sees, over a grid of its raster.
fn distance_seen(world: &World, camera: &Camera) -> Option<f64> {
    const SIDE: usize = 16;
    let centre = |i: usize| (i as f64 + 0.5) / SIDE as f64;
    let (mut sum, mut count) = (0.0, 0);
    for (x, y) in (0..SIDE * SIDE).map(|i| (i % SIDE, i / SIDE)) {
        let ray = camera.sample_ray(DVec2::new(centre(x), centre(y)), [0.5; 2]);
        if let Some(hit) = world.intersect(&ray.ray()).filter(|hit| hit.t > 0.0) {
            sum += libm::log(f64::from(hit.t));
            count += 1;
        }
    }
    (count > 0).then(|| libm::exp(sum / f64::from(count)))
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
                    .map(|(i, camera)| match camera.name.as_str() {
                        "" => i.to_string(),
                        name => format!("{i} ({name})"),
                    })
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
