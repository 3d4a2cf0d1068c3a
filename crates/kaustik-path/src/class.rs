/// The kind of a contribution `C_{s,t}`, by the lengths of the two subpaths that made it: `s` vertices
/// from the light, `t` from the eye (RELT 4.2.1, whose ranges overlap: here a partition, with its `L0` in two).
///
/// | class | strategies | meaning |
/// |---|---|---|
/// | `L0` | s = 0, with a Dirac scattering, no two neighbours that could be joined | a walk from the eye runs into an emitter after a mirror or smooth glass, as nothing else does |
/// | `L1` | s = 0, without | a walk from the eye runs into an emitter |
/// | `L2` | s = 1 | next event |
/// | `L3` | t = 0 | a walk from a light runs into the lens |
/// | `L4` | t = 1 | a walk from a light is joined to the lens; of a light tracer also the emitter itself |
/// | `L5` | s >= 2, t >= 2 | two walks are joined |
/// | `L0Joined` | s = 0, with a Dirac scattering, and two neighbours that could be joined | the same, where heuristics share it with another strategy |
///
/// Neighbours can be joined if neither scatters into a Dirac direction; the emitter and the lens count as such.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[repr(u8)]
pub enum Class {
    /// Implicit lighting, specular: paths that cannot be joined anywhere.
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
    /// Implicit lighting, specular: paths that other strategies make as well.
    L0Joined = 6,
}

impl Class {
    /// How many classes there are.
    pub const COUNT: usize = 7;
    /// All classes in the order of their numbers: `ALL[i] as usize == i`.
    pub const ALL: [Self; Self::COUNT] = [
        Self::L0,
        Self::L1,
        Self::L2,
        Self::L3,
        Self::L4,
        Self::L5,
        Self::L0Joined,
    ];
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
