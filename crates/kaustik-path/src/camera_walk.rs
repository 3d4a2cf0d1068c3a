//! A walk from the camera, from its start to the splat that it ends in.

use glam::DVec2;
use kaustik_bsdf::Mode;
use kaustik_pss::{Coordinates, Stream};
use kaustik_scene::Scene;
use kaustik_spectrum::{Spectrum, Wavelengths};

use crate::contributions::Gathered;
use crate::instant::at_its_time;
use crate::walk::Walk;
use crate::{BuilderSettings, Contributions};

/// Starts a walk at its time, has light gathered along it, and splats the sum.
#[inline]
pub(crate) fn trace(
    settings: &BuilderSettings,
    scene: &Scene,
    u: &mut dyn Coordinates,
    out: &mut Contributions,
    gather: impl FnOnce(&Scene, &mut Walk<'_>, &mut dyn Coordinates, &mut Gathered<'_>),
) {
    out.clear();
    let wavelengths = Wavelengths::sample(u.get(Stream::Wavelength, 0), settings.wavelengths);
    at_its_time(scene, u, |scene, u| {
        let (mut walk, raster) = start(settings, scene, &wavelengths, u);
        let mut gathered = Gathered::new(&wavelengths, settings.track_largest);
        gather(scene, &mut walk, u, &mut gathered);
        gathered.count_walk(walk.edges);
        out.merge(raster, &gathered);
    });
}

/// A walk at the lens, and the raster point that it serves.
#[inline]
pub(crate) fn start<'w>(
    settings: &BuilderSettings,
    scene: &Scene,
    wavelengths: &'w Wavelengths,
    u: &mut dyn Coordinates,
) -> (Walk<'w>, DVec2) {
    let raster = settings.raster(DVec2::from(u.get2(Stream::Camera, 0)));
    let camera = scene.camera();
    let lens = if !camera.has_aperture() {
        [0.5; 2]
    } else {
        u.get2(Stream::Camera, 2)
    };
    let ray = camera.sample_ray(raster, lens);
    let walk = Walk {
        mode: Mode::Radiance,
        wavelengths,
        ray: ray.ray(),
        direction: ray.direction,
        interior: scene.camera_interior(),
        throughput: Spectrum::ONE,
        start: 1.0,
        survived: 1.0,
        dispersive: false,
        specular: false,
        pure: true,
        open: true,
        joined: false,
        edges: 0,
    };
    walk.tell_start();
    (walk, raster)
}
