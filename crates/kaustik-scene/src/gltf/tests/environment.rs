//! Environments among a scene's extras.

use serde_json::{Value, json};

use super::file::{File, png};
use crate::description::{EnvironmentDescription, Pixels};
use crate::environment::Environment;

#[test]
fn environments_are_constants_or_pictures() {
    let scene = |value: Value| {
        let mut file = File::triangle();
        file.json["scenes"][0]["extras"] = json!({ "kaustik": { "environment": value } });
        file
    };
    let constant = EnvironmentDescription::Constant([1.0, 2.0, 0.5]);
    assert_eq!(
        scene(json!([1, 2, 0.5])).clean().environment,
        Some(constant)
    );
    scene(json!([1, -2, 0.5])).refused(&["/scenes/0/extras/kaustik/environment", "0 or more"]);
    scene(json!("sky")).refused(&["environment", "\"sky\"", "[r, g, b]"]);
    let mut file = scene(json!({ "strength": 2, "rotation": [0, 1, 0, 0], "name": "sky" }));
    let view = file.view(&super::any::small_hdr());
    file.json["scenes"][0]["extras"]["kaustik"]["environment"]["bufferView"] = json!(view);
    let Some(EnvironmentDescription::Image {
        image,
        strength,
        rotation,
    }) = file.clean().environment
    else {
        panic!("a picture expected");
    };
    assert_eq!(
        (image.width, image.height, image.name.as_str()),
        (3, 2, "sky")
    );
    assert_eq!((strength, rotation.y), (2.0, 1.0));
    // Eight bits a channel are radiances too, and a scene can be made of them.
    let view = file.view(&png(3, 2));
    file.json["scenes"][0]["extras"]["kaustik"]["environment"]["bufferView"] = json!(view);
    let description = file.clean().environment.unwrap();
    assert!(Environment::new(&description).unwrap().mean_radiance() > 0.0);
    let EnvironmentDescription::Image { image, .. } = description else {
        panic!("a picture expected");
    };
    assert!(matches!(&image.pixels, Pixels::RgbF32(values) if values.len() == 18));
    let environment = &mut file.json["scenes"][0]["extras"]["kaustik"]["environment"];
    environment["rotation"] = json!([0, 0, 0, 2]);
    file.refused(&["environment/rotation", "length 1"]);
}
