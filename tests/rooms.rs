//! Rooms by chance: what no author of a scene would put together.
//!
//! A number decides on all of it: walls, three things of the many materials that files may ask for, lamps, a camera. Lamps are
//! large or far and depths small, so that independent methods come to the same picture in seconds.

mod kinds;
mod shapes;

use std::sync::Arc;

use glam::{Affine3A, EulerRot, Mat3, Quat, Vec3};
use kaustik::geometry::Mesh;
use kaustik::mcmc::{Draws, Pcg64Dxsm, generator};
use kaustik::scene::Description;
use kaustik::scene::description::{
    CameraDescription, EnvironmentDescription, ImageData, InstanceDescription, Lens,
    LightDescription, LightKind, MaterialDescription, Pixels, Projection, TextureDescription,
};

use kinds::{KINDS, Kind, LEAVES, Swatch, diffuse, metal};
use shapes::{ball, cube, faces, sheet};

/// A room that a number made.
pub(crate) struct Room {
    /// What is in it.
    pub(crate) words: String,
    pub(crate) description: Description,
    /// Longest paths, in edges.
    pub(crate) max_depth: u32,
    /// Light of a single point or direction, which a walk from the camera meets only where it joins it.
    pub(crate) has_points: bool,
    /// Something scatters into single directions.
    pub(crate) has_dirac: bool,
}

struct Builder {
    draws: Pcg64Dxsm,
    words: Vec<String>,
    description: Description,
    has_points: bool,
    has_dirac: bool,
    /// May there be leaves?
    has_leaves: bool,
}

/// Rooms from this on have leaves among their things; those before are as they were when they were looked at.
const WITH_LEAVES: u64 = 100;

/// The room of this number.
pub(crate) fn room(number: u64) -> Room {
    let mut builder = Builder {
        draws: generator(number, 0),
        words: Vec::new(),
        description: Description::default(),
        has_points: false,
        has_dirac: false,
        has_leaves: number >= WITH_LEAVES,
    };
    builder.texture();
    let is_open = builder.draws.bernoulli(0.35);
    builder.walls(is_open);
    for place in [
        Vec3::new(-0.45, -0.55, -0.3),
        Vec3::new(0.45, -0.5, 0.1),
        Vec3::new(0.1, 0.25, -0.45),
    ] {
        builder.thing(place);
    }
    builder.lamps(is_open);
    builder.camera();
    let max_depth = 4 + builder.draws.index(&[1.0; 6]) as u32;
    Room {
        words: format!("{}; {max_depth} edges", builder.words.join(", ")),
        description: builder.description,
        max_depth,
        has_points: builder.has_points,
        has_dirac: builder.has_dirac,
    }
}

impl Builder {
    fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.draws.uniform() as f32
    }

    fn color(&mut self, low: f32, high: f32) -> [f32; 3] {
        [(); 3].map(|()| self.between(low, high))
    }

    fn one_in(&mut self, of: usize) -> bool {
        self.draws.index(&vec![1.0; of]) == 0
    }

    /// Four by four texels of any colour, half of them half there.
    fn texture(&mut self) {
        let texel = |draws: &mut Pcg64Dxsm| {
            let [r, g, b] = [(); 3].map(|()| (60.0 + 180.0 * draws.uniform()) as u8);
            [r, g, b, if draws.bernoulli(0.5) { 255 } else { 110 }]
        };
        let texels = (0..16).flat_map(|_| texel(&mut self.draws)).collect();
        self.description.images.push(Arc::new(ImageData {
            name: "squares".to_owned(),
            width: 4,
            height: 4,
            pixels: Pixels::Rgba8(texels),
            encoded: Vec::new(),
        }));
        self.description.textures.push(TextureDescription {
            image: 0,
            wrap_s: Default::default(),
            wrap_t: Default::default(),
            filtering: Default::default(),
        });
    }

    fn place(&mut self, material: MaterialDescription, mesh: Mesh, transform: Affine3A) {
        let description = &mut self.description;
        description.instances.push(InstanceDescription {
            name: material.name.clone(),
            mesh: description.meshes.len(),
            material: Some(description.materials.len()),
            transform,
        });
        description.materials.push(material);
        description.meshes.push(Arc::new(mesh));
    }

    /// Five or six walls of a cube of two units.
    fn walls(&mut self, is_open: bool) {
        let [.., ceiling] = faces(-1.0);
        for face in faces(-1.0) {
            if is_open && face == ceiling {
                continue;
            }
            let albedo = self.color(0.2, 0.75);
            let mut wall = diffuse(albedo);
            if self.one_in(8) {
                self.words.push("a wall of rough metal".to_owned());
                wall = metal(albedo, self.between(0.3, 0.6));
            }
            self.place(wall, face, Affine3A::IDENTITY);
        }
    }

    fn thing(&mut self, at: Vec3) {
        let (material, is_solid) = self.material();
        let size = Vec3::from([(); 3].map(|()| self.between(0.2, 0.38)));
        let [yaw, pitch] = [(); 2].map(|()| self.between(-1.5, 1.5));
        let turn = Quat::from_euler(EulerRot::YXZ, yaw, 0.4 * pitch, 0.0);
        let transform = Affine3A::from_scale_rotation_translation(size, turn, at);
        // A sheet would have no inside, and a curved pane takes many triangles for little.
        let (shape, mesh) = match self
            .draws
            .index(&[1.0, 1.0, f64::from(u8::from(!is_solid))])
        {
            0 => ("block", cube()),
            1 => ("ball", ball()),
            _ => ("sheet", sheet()),
        };
        self.words.push(format!("{shape} of {}", material.name));
        self.place(material, mesh, transform);
    }

    /// A material, and whether it bounds a solid.
    fn material(&mut self) -> (MaterialDescription, bool) {
        let swatch = Swatch {
            albedo: self.color(0.2, 0.85),
            roughness: self.between(0.25, 0.7),
        };
        let mut kinds: Vec<&Kind> = KINDS.iter().collect();
        if self.has_leaves {
            kinds.extend(LEAVES.iter().cycle().take(12));
        }
        let kind = kinds[self.draws.index(&vec![1.0; kinds.len()])];
        let material = MaterialDescription {
            name: kind.name.to_owned(),
            ..(kind.make)(self, swatch)
        };
        self.has_dirac |= kind.is_dirac;
        let is_solid = material.volume.is_some();
        (material, is_solid)
    }

    /// One to three sorts of light.
    fn lamps(&mut self, is_open: bool) {
        let mut sorts: Vec<usize> = vec![0, 1, 2];
        if is_open {
            sorts.extend([3, 4, 5]);
        }
        for count in 0..3 {
            if count > 0 && !self.one_in(2) {
                break;
            }
            let at = self.draws.index(&vec![1.0; sorts.len()]);
            let sort = sorts.remove(at);
            self.lamp(sort);
        }
    }

    fn lamp(&mut self, sort: usize) {
        let color = self.color(0.4, 1.0);
        let [x, z] = [(); 2].map(|()| self.between(-0.4, 0.4));
        let words = match sort {
            0 => {
                let strength = self.between(1.5, 4.0);
                let lamp = MaterialDescription {
                    emissive: color.map(|c| c * strength),
                    double_sided: self.one_in(3),
                    ..diffuse([0.4; 3])
                };
                let half = self.between(0.3, 0.5);
                let turn = Quat::from_euler(EulerRot::XZY, 0.5 * x, 0.5 * z, 0.0)
                    * Quat::from_rotation_x(std::f32::consts::FRAC_PI_2);
                let at = Vec3::new(x, 0.8, z);
                let size = Vec3::splat(half);
                let transform = Affine3A::from_scale_rotation_translation(size, turn, at);
                self.place(lamp, sheet(), transform);
                "a lamp"
            }
            1 => self.punctual(LightKind::Point, color, 1.0, Vec3::new(x, 0.7, z)),
            2 => {
                let kind = LightKind::Spot {
                    inner: 0.4,
                    outer: self.between(0.6, 1.1),
                };
                self.punctual(kind, color, 3.0, Vec3::new(x, 0.9, z))
            }
            3 => self.punctual(LightKind::Directional, color, 2.0, Vec3::ZERO),
            4 => {
                self.description.environment = Some(EnvironmentDescription::Constant(color));
                "an even sky"
            }
            _ => {
                let sky = self.sky(color);
                self.description.environment = Some(sky);
                "a sky"
            }
        };
        self.words.push(words.to_owned());
    }

    /// Downward, a little aslant.
    fn punctual(
        &mut self,
        kind: LightKind,
        color: [f32; 3],
        intensity: f32,
        at: Vec3,
    ) -> &'static str {
        self.has_points = true;
        let [tilt, aside] = [(); 2].map(|()| self.between(-0.4, 0.4));
        let down = -std::f32::consts::FRAC_PI_2;
        let turn = Quat::from_euler(EulerRot::XYZ, down + tilt, aside, 0.0);
        self.description.lights.push(LightDescription {
            name: "light".to_owned(),
            kind,
            color,
            intensity,
            range: None,
            transform: Affine3A::from_rotation_translation(turn, at),
        });
        match kind {
            LightKind::Point => "a point light",
            LightKind::Spot { .. } => "a spot",
            LightKind::Directional => "a sun",
        }
    }

    /// Sixteen by eight pixels, one of them bright.
    fn sky(&mut self, color: [f32; 3]) -> EnvironmentDescription {
        let bright = self.draws.index(&[1.0; 32]);
        let pixels = (0..128).flat_map(|pixel| {
            let factor = if pixel == bright { 20.0 } else { 0.3 };
            color.map(|c| c * factor)
        });
        EnvironmentDescription::Image {
            image: Arc::new(ImageData {
                name: "sky".to_owned(),
                width: 16,
                height: 8,
                pixels: Pixels::RgbF32(pixels.collect()),
                encoded: Vec::new(),
            }),
            strength: 1.5,
            rotation: Quat::from_rotation_y(0.7),
        }
    }

    fn camera(&mut self) {
        let at = Vec3::new(self.between(-0.3, 0.3), self.between(-0.3, 0.3), 0.95);
        let back = (at - Vec3::new(0.0, -0.2, -0.4)).normalize();
        let right = Vec3::Y.cross(back).normalize();
        let axes = Mat3::from_cols(right, back.cross(right), back);
        let looks = Affine3A::from_mat3_translation(axes, at);
        let mut lens = None;
        let kind = self.draws.index(&[2.0, 1.0, 1.0]);
        let projection = match kind {
            0 | 1 => Projection::Perspective {
                yfov: self.between(0.9, 1.3),
                aspect_ratio: None,
            },
            _ => Projection::Orthographic {
                xmag: 0.7,
                ymag: 0.7,
            },
        };
        if kind == 1 {
            lens = Some(Lens {
                aperture: 0.06,
                focus: 1.2,
                blades: None,
            });
        }
        self.words
            .push(["a pinhole", "a lens", "parallel rays"][kind].to_owned());
        self.description.cameras.push(CameraDescription {
            name: "camera".to_owned(),
            transform: looks,
            projection,
            lens,
            shutter: None,
        });
    }
}
