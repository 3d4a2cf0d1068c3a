//! What moves, for tests of this crate.

use glam::DAffine3;

use crate::description::{Channel, Interpolation, Joint, Rest};

/// A joint that rests where the world begins.
pub(crate) fn joint() -> Joint {
    Joint {
        name: "joint".to_owned(),
        parent: None,
        to_parent: DAffine3::IDENTITY,
        rest: Rest {
            translation: [0.0; 3],
            rotation: [0.0, 0.0, 0.0, 1.0],
            scale: [1.0; 3],
        },
        translation: None,
        rotation: None,
        scale: None,
    }
}

/// What moves a joint.
pub(crate) fn channel<const N: usize>(
    interpolation: Interpolation,
    times: &[f32],
    values: &[[f32; N]],
) -> Channel<N> {
    Channel {
        interpolation,
        times: times.to_vec(),
        values: values.to_vec(),
    }
}
