/// What a coordinate is for. Streams are numbered apart, so that a longer camera
/// walk does not shift the meaning of the light walk's coordinates (Kelemen sec. 2).
///
/// Only the names come from light transport: other programs may take them for seven independent
/// sequences.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[repr(u8)]
pub enum Stream {
    /// The walk from the camera: raster position, lens, then each bounce.
    Camera = 0,
    /// The walk from a light: choice, position, direction, then each bounce.
    Light = 1,
    /// Joining two walks: the light point of next-event estimation, the lens point.
    Connection = 2,
    /// The choice of a sampling technique or path length.
    Technique = 3,
    /// The wavelengths of the path.
    Wavelength = 4,
    /// The instant within the shutter interval.
    Time = 5,
    /// Passing through partly transparent surfaces (alpha) and smooth panes.
    Transparency = 6,
}

impl Stream {
    /// How many streams there are.
    pub const COUNT: usize = 7;
    /// All streams in the order of their numbers: `ALL[i] as usize == i`.
    pub const ALL: [Self; Self::COUNT] = [
        Self::Camera,
        Self::Light,
        Self::Connection,
        Self::Technique,
        Self::Wavelength,
        Self::Time,
        Self::Transparency,
    ];
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_positions() {
        for (i, stream) in Stream::ALL.into_iter().enumerate() {
            assert_eq!(stream as usize, i);
        }
    }
}
