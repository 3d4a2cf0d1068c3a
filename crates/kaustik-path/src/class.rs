/// The kind of a contribution `C_{s,t}`, by the lengths of the two subpaths that made it: `s` vertices
/// from the light, `t` from the eye (RELT 4.2.1, whose ranges overlap: here a partition).
///
/// | class | strategies | meaning |
/// |---|---|---|
/// | `L0` | s = 0, with a Dirac scattering | a walk from the eye runs into an emitter after a mirror or smooth glass |
/// | `L1` | s = 0, without | a walk from the eye runs into an emitter |
/// | `L2` | s = 1 | next event |
/// | `L3` | t = 0 | a walk from a light runs into the lens |
/// | `L4` | t = 1 | a walk from a light is joined to the lens; of a light tracer also the emitter itself |
/// | `L5` | s >= 2, t >= 2 | two walks are joined |
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[repr(u8)]
pub enum Class {
    /// Implicit lighting, specular.
    L0 = 0,
    /// Implicit lighting, not specular.
    L1 = 1,
    /// Explicit lighting.
    L2 = 2,
    /// Implicit caustics.
    L3 = 3,
    /// Explicit caustics.
    L4 = 4,
    /// Indirect connections.
    L5 = 5,
}

impl Class {
    /// How many classes there are.
    pub const COUNT: usize = 6;
    /// All classes in the order of their numbers: `ALL[i] as usize == i`.
    pub const ALL: [Self; Self::COUNT] =
        [Self::L0, Self::L1, Self::L2, Self::L3, Self::L4, Self::L5];

    /// Of an emitter that a walk from the eye ran into.
    #[inline]
    pub(crate) fn implicit(specular: bool) -> Self {
        if specular { Self::L0 } else { Self::L1 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_positions() {
        for (i, class) in Class::ALL.into_iter().enumerate() {
            assert_eq!(class as usize, i);
        }
    }
}
