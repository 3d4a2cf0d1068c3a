/// A kind of mutation of a path, as the settings `mutations` and `perturbations` and the statistics name it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MutationKind {
    /// Deletes a part of the path and traces a new one (Veach 1997, 11.4.2).
    Bidirectional,
    /// Moves the raster point and follows the same scatterings to the first join.
    Lens,
    /// As [`Lens`](Self::Lens), and moves the direction at the diffuse vertices on the way.
    Multichain,
    /// Moves the direction in which light leaves the last but one of the vertices before the lens that do not scatter into
    /// Dirac directions, and follows the same scatterings to the last of them. `erpt` makes it only where a mirror or
    /// glass lies between the two: a caustic.
    Caustic,
    /// A fresh subpath from the lens, somewhere else in the image (Veach 1997, 11.4.4).
    Subpath,
    /// Fresh wavelengths for the same vertices.
    Wavelengths,
    /// A fresh time.
    Time,
    /// Moves every variable of the path a little (the rival of Kelemen Fig. 5).
    Every,
}

impl MutationKind {
    /// How many there are.
    pub const COUNT: usize = Self::ALL.len();

    /// All, in the order of the statistics: `kind as usize` is the place of a kind.
    pub const ALL: [Self; 8] = [
        Self::Bidirectional,
        Self::Lens,
        Self::Multichain,
        Self::Caustic,
        Self::Subpath,
        Self::Wavelengths,
        Self::Time,
        Self::Every,
    ];

    /// The names of [`ALL`](Self::ALL).
    pub const NAMES: [&'static str; Self::COUNT] = {
        let mut names = [""; Self::COUNT];
        let mut i = 0;
        while i < Self::COUNT {
            names[i] = Self::ALL[i].name();
            i += 1;
        }
        names
    };

    /// The word for it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Bidirectional => "bidirectional",
            Self::Lens => "lens",
            Self::Multichain => "multichain",
            Self::Caustic => "caustic",
            Self::Subpath => "subpath",
            Self::Wavelengths => "wavelengths",
            Self::Time => "time",
            Self::Every => "every",
        }
    }

    /// The kind of a name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.name() == name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_place_of_a_kind_is_its_number() {
        for (place, kind) in MutationKind::ALL.into_iter().enumerate() {
            assert_eq!(kind as usize, place);
            assert_eq!(MutationKind::named(MutationKind::NAMES[place]), Some(kind));
        }
        assert_eq!(MutationKind::named("all"), None);
    }
}
