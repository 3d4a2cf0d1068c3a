//! What tells scenes apart: a hash of everything that a scene is compiled from.
//!
//! Buffers and pixels go in as they are, in little-endian order. All else goes in as its derived `Debug` text, which
//! names every field, those of tomorrow included, and writes numbers so that no two of them look alike. Names
//! of the scene, of instances and of images stay out: a file may be moved.

use std::fmt::{Debug, Write};

use blake3::Hasher;
use kaustik_geometry::Mesh;

use super::SceneOptions;
use crate::description::{
    CameraDescription, Description, EnvironmentDescription, ImageData, InstanceDescription, Pixels,
};

/// Hash of a description and of the choices that replace parts of it. Size and compensation stay out:
/// they are settings of the render.
pub(super) fn content(description: &Description, options: &SceneOptions) -> [u8; 32] {
    // Without `..`: a new field is a decision.
    let Description {
        name: _,
        meshes,
        instances,
        materials,
        textures,
        images,
        lights,
        cameras,
        environment,
        animation,
    } = description;
    let mut content = Content(Hasher::new());
    content.each(meshes.iter(), |content, mesh| content.mesh(mesh));
    content.each(instances.iter(), |content, instance| {
        let InstanceDescription {
            name: _,
            mesh,
            material,
            transform,
        } = instance;
        content.text(&(mesh, material, transform));
    });
    content.text(materials);
    content.text(textures);
    content.each(images.iter(), |content, image| content.image(image));
    content.text(lights);
    content.text(cameras);
    // By its place, whatever the word for it.
    let chosen = description.camera(options.camera.as_deref());
    let place = |chosen: &CameraDescription| {
        let mut cameras = cameras.iter();
        cameras.position(|camera| std::ptr::eq(camera, chosen))
    };
    content.text(&chosen.and_then(place));
    // What stands still keeps the hash that it had before anything could move.
    if !animation.is_empty() {
        content.text(animation);
    }
    match options.environment.as_ref().or(environment.as_ref()) {
        Some(EnvironmentDescription::Image {
            image,
            strength,
            rotation,
        }) => {
            content.text(&(strength, rotation));
            content.image(image);
        }
        other => content.text(&other),
    }
    *content.0.finalize().as_bytes()
}

struct Content(Hasher);

/// `write!` into the hash.
impl Write for Content {
    fn write_str(&mut self, text: &str) -> std::fmt::Result {
        self.0.update(text.as_bytes());
        Ok(())
    }
}

impl Content {
    fn length(&mut self, length: usize) {
        self.0.update(&(length as u64).to_le_bytes());
    }

    /// The `Debug` text, and an end that no such text holds.
    fn text(&mut self, value: &dyn Debug) {
        // Hashing a text cannot fail.
        let _ = write!(self, "{value:?}\0");
    }

    fn each<T>(
        &mut self,
        items: impl ExactSizeIterator<Item = T>,
        mut add: impl FnMut(&mut Self, T),
    ) {
        self.length(items.len());
        for item in items {
            add(self, item);
        }
    }

    /// Numbers of four bytes.
    fn numbers<const N: usize>(&mut self, items: impl ExactSizeIterator<Item = [u32; N]>) {
        const MOST: usize = 1 << 16;
        self.length(items.len());
        let mut bytes = Vec::with_capacity(MOST);
        for item in items {
            for number in item {
                bytes.extend(number.to_le_bytes());
            }
            if bytes.len() + 4 * N > MOST {
                self.0.update(&bytes);
                bytes.clear();
            }
        }
        self.0.update(&bytes);
    }

    fn mesh(&mut self, mesh: &Mesh) {
        let Mesh {
            positions,
            indices,
            normals,
            tangents,
            uv,
            colors,
        } = mesh;
        self.numbers(positions.iter().map(|v| v.to_array().map(f32::to_bits)));
        self.numbers(indices.iter().copied());
        self.numbers(normals.iter().map(|v| v.to_array().map(f32::to_bits)));
        self.numbers(tangents.iter().map(|v| v.to_array().map(f32::to_bits)));
        for uv in uv {
            self.numbers(uv.iter().map(|v| v.to_array().map(f32::to_bits)));
        }
        self.numbers(colors.iter().map(|c| c.map(f32::to_bits)));
    }

    fn image(&mut self, image: &ImageData) {
        let ImageData {
            name: _,
            width,
            height,
            pixels,
            encoded: _,
        } = image;
        self.text(&(width, height));
        match pixels {
            Pixels::Rgba8(bytes) => {
                self.text(&"rgba8");
                self.length(bytes.len());
                self.0.update(bytes);
            }
            Pixels::Rgba16(values) => {
                self.text(&"rgba16");
                self.numbers(values.iter().map(|&v| [u32::from(v)]));
            }
            Pixels::RgbF32(numbers) => {
                self.text(&"rgb f32");
                self.numbers(numbers.iter().map(|v| [v.to_bits()]));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::{Affine3A, Quat, Vec3A};

    use super::*;
    use crate::builtin;
    use crate::description::{LightDescription, MaterialDescription};

    fn of(description: &Description) -> [u8; 32] {
        content(description, &SceneOptions::default())
    }

    #[test]
    fn a_camera_counts_and_the_word_for_it_does_not() {
        let mut scene = builtin::load("cornell").expect("a built-in scene");
        let mut other = scene.cameras[0].clone();
        other.name = "other".to_owned();
        scene.cameras.push(other);
        let by = |word: &str| {
            let camera = Some(word.to_owned());
            content(
                &scene,
                &SceneOptions {
                    camera,
                    ..SceneOptions::default()
                },
            )
        };
        let name = scene.cameras[0].name.clone();
        assert!(of(&scene) == by("0") && by("0") == by(&name));
        assert!(by("1") == by("other") && by("1") != by("0"));
    }

    #[test]
    fn every_built_in_scene_has_its_own_and_always_the_same() {
        let mut seen = Vec::new();
        for built_in in builtin::list() {
            let load = || builtin::load(built_in.name).expect("a built-in scene");
            assert_eq!(of(&load()), of(&load()), "{}", built_in.name);
            seen.push(of(&load()));
        }
        let count = seen.len();
        seen.sort_unstable();
        seen.dedup();
        assert_eq!(seen.len(), count);
    }

    /// One changed bit anywhere is another scene; a changed name is not.
    #[test]
    fn every_part_counts_and_names_do_not() {
        let mut scene = builtin::load("cornell").expect("a built-in scene");
        let image = ImageData {
            name: "a".to_owned(),
            width: 1,
            height: 1,
            pixels: Pixels::Rgba8(vec![1, 2, 3, 4]),
            encoded: Vec::new(),
        };
        scene.images.push(Arc::new(image));
        let whole = of(&scene);
        type Change = fn(&mut Description);
        let changes: [(&str, Change); 12] = [
            ("a position", |s| {
                let x = &mut Arc::make_mut(&mut s.meshes[0]).positions[0].x;
                *x = f32::from_bits(x.to_bits() ^ 1);
            }),
            ("an index", |s| {
                Arc::make_mut(&mut s.meshes[0]).indices[0].rotate_left(1);
            }),
            ("one mesh less", |s| drop(s.meshes.pop())),
            ("an instance", |s| {
                s.instances[0].transform = Affine3A::from_rotation_y(1e-3);
            }),
            ("its material", |s| s.instances[0].material = None),
            ("a material", |s| {
                s.materials.push(MaterialDescription::default());
            }),
            ("a pixel", |s| {
                Arc::make_mut(&mut s.images[0]).pixels = Pixels::Rgba8(vec![1, 2, 3, 5]);
            }),
            ("an image's shape", |s| {
                Arc::make_mut(&mut s.images[0]).width = 2;
            }),
            ("a camera", |s| {
                let camera: &mut CameraDescription = &mut s.cameras[0];
                camera.transform.translation += Vec3A::new(0.0, 1e-3, 0.0);
            }),
            ("a light", |s| s.lights.push(light())),
            ("a constant environment", |s| {
                s.environment = Some(EnvironmentDescription::Constant([0.5; 3]));
            }),
            ("a pictured environment", |s| {
                s.environment = Some(EnvironmentDescription::Image {
                    image: Arc::clone(&s.images[0]),
                    strength: 1.0,
                    rotation: Quat::IDENTITY,
                });
            }),
        ];
        let mut seen = vec![whole];
        for (what, change) in changes {
            let mut other = scene.clone();
            change(&mut other);
            let other = of(&other);
            assert!(!seen.contains(&other), "{what}");
            seen.push(other);
        }
        let mut renamed = scene.clone();
        renamed.name.push('!');
        renamed.instances[0].name.push('!');
        Arc::make_mut(&mut renamed.images[0]).name.push('!');
        assert_eq!(of(&renamed), whole);
        let options = SceneOptions {
            environment: Some(EnvironmentDescription::Constant([0.25; 3])),
            ..SceneOptions::default()
        };
        assert_ne!(content(&scene, &options), whole);
    }

    fn light() -> LightDescription {
        use crate::description::LightKind;
        LightDescription {
            name: String::new(),
            transform: Affine3A::IDENTITY,
            color: [1.0; 3],
            intensity: 1.0,
            range: None,
            kind: LightKind::Point,
        }
    }
}
