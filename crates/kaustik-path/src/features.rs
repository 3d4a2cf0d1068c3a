//! What a pixel shows first: for denoisers, for a look at the scene.

use glam::{DVec2, DVec3, Vec3};
use kaustik_bsdf::{Bsdf, Lobe, Mode};
use kaustik_scene::{Scene, Vertex};
use kaustik_spectrum::{Illuminant, Rgb, WavelengthSampling, Wavelengths};

/// Of the first surface that a camera ray meets; panes that it is more likely to pass than not are passed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Features {
    /// Reflectance under D65, linear Rec.709; an estimate from four wavelengths.
    pub albedo: [f32; 3],
    /// Unit shading normal in the world, on the camera's side; zero if nothing is met.
    pub normal: Vec3,
    /// Distance in scene units; 0 if nothing is met.
    pub depth: f32,
    /// Light tracing cannot show all of this point: its surface scatters into a Dirac direction, or it is the environment.
    pub beyond_light_tracing: bool,
}

/// Looks through a raster point, from the centre of the lens, with the wavelengths of a number in [0, 1).
pub fn features(scene: &Scene, raster: DVec2, wavelength: f64) -> Features {
    let wavelengths = Wavelengths::sample(wavelength, WavelengthSampling::Hero);
    let ray = scene.camera().sample_ray(raster, [0.5; 2]);
    let mut interior = scene.camera_interior();
    let traced = ray.ray();
    let mut vertex = Vertex::default();
    let segment = scene.advance(&traced, &mut interior, &wavelengths, || 0.5, &mut vertex);
    if segment.escapes() {
        return Features {
            beyond_light_tracing: true,
            ..Features::default()
        };
    }
    let bsdf = scene.bsdf(&vertex, &wavelengths, &interior);
    let wo = vertex.frame.to_local(-ray.direction);
    let lit = bsdf.albedo(wo) * Illuminant::D65.eval(&wavelengths);
    let normal = vertex.frame.z.as_vec3();
    Features {
        albedo: Rgb::from(wavelengths.to_xyz(lit)).0,
        normal: if normal.dot(traced.direction) > 0.0 {
            -normal
        } else {
            normal
        },
        depth: segment.distance as f32,
        // What a pane reflects is lost as what any mirror does.
        beyond_light_tracing: segment.through_pane || has_dirac(&bsdf, wo),
    }
}

/// Does it scatter light from `wo` into a Dirac direction, be it by a varnish alone? What is seen in it no light path can be joined to.
fn has_dirac(bsdf: &Bsdf, wo: DVec3) -> bool {
    [false, true]
        .into_iter()
        .any(|transmitted| bsdf.delta(wo, transmitted, Mode::Radiance).is_some())
}
