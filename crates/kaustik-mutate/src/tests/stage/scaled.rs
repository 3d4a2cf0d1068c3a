use glam::{Affine3A, Vec3};
use kaustik_scene::description::{LightKind, Projection};
use kaustik_scene::testing::Stage;

/// The same in another unit of length, as bright as before. Nothing in it may move.
pub(crate) fn scaled(mut stage: Stage, factor: f32) -> Stage {
    let scale = Affine3A::from_scale(Vec3::splat(factor));
    let description = &mut stage.description;
    for instance in &mut description.instances {
        instance.transform = scale * instance.transform;
    }
    for camera in &mut description.cameras {
        camera.transform.translation *= factor;
        if let Some(lens) = &mut camera.lens {
            lens.aperture *= factor;
            lens.focus *= factor;
        }
        if let Projection::Orthographic { xmag, ymag } = &mut camera.projection {
            *xmag *= factor;
            *ymag *= factor;
        }
    }
    for light in &mut description.lights {
        light.transform.translation *= factor;
        if light.kind != LightKind::Directional {
            light.intensity *= factor * factor;
        }
    }
    for volume in description
        .materials
        .iter_mut()
        .filter_map(|m| m.volume.as_mut())
    {
        volume.thickness *= factor;
        volume.attenuation_distance *= factor;
    }
    stage
}
