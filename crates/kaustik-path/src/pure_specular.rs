/// What becomes of purely specular paths: emitters and surroundings that are seen directly, or by way of Dirac
/// surfaces alone (E S* L in Heckbert's notation; a path of one edge is one of them).
///
/// Only a walk from the eye finds them, and of a light one that runs into a lens with area or is joined to the lens at once, so that
/// a chain meets a lamp behind glass by chance, if at all. Samples spread evenly over the image do so in each pixel: one
/// builder leaves these paths out, another makes them alone, and the sum of both is what a builder makes that
/// keeps them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PureSpecular {
    /// They are made like any others.
    #[default]
    Kept,
    /// They are not made.
    LeftOut,
    /// No others are made: a walk ends where it scatters otherwise.
    Alone,
}

impl PureSpecular {
    /// Is a path made that is purely specular, or is not?
    #[inline]
    pub fn admits(self, pure: bool) -> bool {
        match self {
            Self::Kept => true,
            Self::LeftOut => !pure,
            Self::Alone => pure,
        }
    }
}
