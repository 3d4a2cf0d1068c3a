use glam::DAffine3;

/// How values between two keys come about (glTF's samplers).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Interpolation {
    /// The value of the key before.
    Step,
    /// Straight; rotations along the shortest arc at even speed.
    Linear,
    /// A cubic Hermite spline; rotations made unit after it.
    CubicSpline,
}

/// Values over time.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel<const N: usize> {
    /// Between the keys.
    pub interpolation: Interpolation,
    /// In seconds, strictly increasing, at least one. Before the first and after the last, their values hold.
    pub times: Vec<f32>,
    /// One a key; of a cubic spline three: incoming tangent, value, outgoing tangent. Tangents are per second.
    pub values: Vec<[f32; N]>,
}

/// A node that moves by itself: what is placed below it moves along.
#[derive(Clone, Debug, PartialEq)]
pub struct Joint {
    /// Name of the node, for messages.
    pub name: String,
    /// The next joint above, an index below this one's own; `None` is the world.
    pub parent: Option<usize>,
    /// From the node's parent to the joint above, or to the world: what stands still in between.
    pub to_parent: DAffine3,
    /// Where it is not animated.
    pub rest: Rest,
    /// The translation in its parent's space.
    pub translation: Option<Channel<3>>,
    /// Rotation: quaternions `[x, y, z, w]`.
    pub rotation: Option<Channel<4>>,
    /// Scale along its own axes.
    pub scale: Option<Channel<3>>,
}

/// Translation, rotation and scale of a node that stands still.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rest {
    /// In the space of the parent.
    pub translation: [f32; 3],
    /// Quaternion `[x, y, z, w]` of any length; without length it is no rotation.
    pub rotation: [f32; 4],
    /// Along its own axes.
    pub scale: [f32; 3],
}

/// What a joint carries.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Load {
    /// Index into [`Description::instances`](super::Description::instances).
    Instance(usize),
    /// Index into [`Description::lights`](super::Description::lights).
    Light(usize),
    /// Index into [`Description::cameras`](super::Description::cameras).
    Camera(usize),
}

/// Something that moves with a joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Carried {
    /// What it is. Its own transform is where it stands without a shutter interval.
    pub load: Load,
    /// Index into [`AnimationDescription::joints`].
    pub joint: usize,
    /// From its own space to the joint's.
    pub offset: DAffine3,
}

/// What moves, and how. Only a camera with a [shutter interval](super::Shutter) sees any of it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AnimationDescription {
    /// Nodes that move, parents before children.
    pub joints: Vec<Joint>,
    /// What they carry, each once.
    pub carried: Vec<Carried>,
}

impl AnimationDescription {
    /// Does anything move?
    pub fn is_empty(&self) -> bool {
        self.carried.is_empty()
    }
}
