//! How much surfaces send back: tables that make light are refused, strengths of reflection count in all kinds of glass.

use glam::{DVec3, Vec3};
use kaustik_bsdf::{Lobe, Mode};

use super::look;
use crate::description::{Description, MaterialDescription, SpectralInput};
use crate::testing::{Stage, dielectric, diffuse, floor, wavelengths};
use crate::{Interior, Scene, SceneError, SceneOptions, builtin};

/// A built-in scene whose first material has this reflectance.
fn with(reflectance: SpectralInput) -> Result<Scene, SceneError> {
    let mut description: Description = builtin::load("cornell").expect("a built-in scene");
    description.materials[0].reflectance = Some(reflectance);
    Scene::new(&description, &SceneOptions::default())
}

#[test]
fn tables_that_make_light_are_no_reflectances() {
    let named = |name: &str| SpectralInput::Named(name.to_owned());
    let knots = |value| SpectralInput::Knots(vec![(400.0, 0.5), (600.0, value)]);
    assert!(with(named("cornell-red")).is_ok() && with(knots(1.0)).is_ok());
    for (input, words) in [
        (named("cornell-light"), "'cornell-light' reaches"),
        (named("D65"), "'D65' reaches"),
        (knots(1.5), "knots reach 1.5"),
    ] {
        let error = with(input).expect_err("a lamp's spectrum").to_string();
        assert!(
            error.contains(words) && error.contains("reflectance"),
            "{error}"
        );
    }
}

/// Four times a dielectric's reflection head-on, which is 0.04 at an index of 1.5, of glass that lets all or nearly all pass.
#[test]
fn bright_reflections_of_clear_glass_are_bright() {
    for factor in [1.0, 0.999] {
        let mut glass: MaterialDescription = dielectric(1.5, 0.0, [1.0; 3]);
        glass.specular.color = [4.0; 3];
        glass.transmission.as_mut().expect("glass").factor = factor;
        let scene = Stage::new()
            .add(
                glass,
                crate::testing::cuboid(Vec3::splat(-1.0), Vec3::splat(1.0)),
            )
            .add(diffuse([0.5; 3]), floor(-3.0, 6.0))
            .build();
        let vertex = look(&scene, Vec3::new(0.1, 3.0, 0.2), Vec3::NEG_Y);
        let bsdf = scene.bsdf(&vertex, &wavelengths(), &Interior::VACUUM);
        let mirrored = bsdf.delta(DVec3::Z, false, Mode::Radiance);
        let share = mirrored.expect("a reflection").share.mean();
        assert!((share - 0.16).abs() < 0.002, "{factor}: {share}");
    }
}
