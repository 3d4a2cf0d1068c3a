//! Stages on which things move while the shutter is open.

use glam::{DAffine3, DVec3};
use kaustik_scene::description::{
    AnimationDescription, Carried, Channel, Interpolation, Joint, Load, Rest, Shutter,
};
use kaustik_scene::testing::Stage;

/// From where something goes and as how many times as large, along each axis, to where.
pub(super) type Way = [([f32; 3], [f32; 3]); 2];

fn channel<const N: usize>(values: [[f32; N]; 2]) -> Option<Channel<N>> {
    Some(Channel {
        interpolation: Interpolation::Linear,
        times: vec![0.0, 1.0],
        values: values.to_vec(),
    })
}

/// What moves on a stage.
pub(super) trait Moving {
    /// Has something go its way about a place, turning about an axis by the rotations of these two
    /// quaternions, while the shutter is open.
    fn moving(self, load: Load, about: DVec3, way: Way, turn: [[f32; 4]; 2]) -> Self;

    /// The camera, which looks about.
    fn looking(self) -> Self;
}

impl Moving for Stage {
    fn moving(mut self, load: Load, about: DVec3, way: Way, turn: [[f32; 4]; 2]) -> Self {
        self.description.cameras[0].shutter = Some(Shutter {
            open: 0.0,
            close: 1.0,
        });
        let AnimationDescription { joints, carried } = &mut self.description.animation;
        // Meshes are where the scene has them, lights at the origin of their nodes.
        let offset = match load {
            Load::Instance(_) => DAffine3::from_translation(-about),
            _ => DAffine3::IDENTITY,
        };
        carried.push(Carried {
            load,
            joint: joints.len(),
            offset,
        });
        joints.push(Joint {
            name: "joint".to_owned(),
            parent: None,
            to_parent: DAffine3::from_translation(about),
            rest: Rest {
                translation: [0.0; 3],
                rotation: [0.0, 0.0, 0.0, 1.0],
                scale: [1.0; 3],
            },
            translation: channel(way.map(|(at, _)| at)),
            rotation: channel(turn),
            scale: channel(way.map(|(_, scale)| scale)),
        });
        self
    }

    fn looking(mut self) -> Self {
        let camera = &mut self.description.cameras[0].transform;
        let rest = DAffine3 {
            matrix3: camera.matrix3.as_dmat3(),
            translation: camera.translation.as_dvec3(),
        };
        let way = [([0.1, 0.0, 0.0], [1.0; 3]), ([-0.2, 0.1, 0.3], [1.0; 3])];
        let turn = [[0.0, 0.05, 0.0, 0.998_749], [0.04, -0.06, 0.0, 0.997_396]];
        self = self.moving(Load::Camera(0), DVec3::ZERO, way, turn);
        // The camera's own place comes from its node alone.
        if let Some(joint) = self.description.animation.joints.last_mut() {
            joint.to_parent = rest;
        }
        self
    }
}

/// Nothing turns.
pub(super) const STRAIGHT: [[f32; 4]; 2] = [[0.0, 0.0, 0.0, 1.0]; 2];
/// A quarter about the vertical, or nearly.
pub(super) const QUARTER: [[f32; 4]; 2] = [[0.0, -0.3, 0.0, 0.953_939], [0.0, 0.3, 0.0, 0.953_939]];
