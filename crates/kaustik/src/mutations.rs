/// Which mutations `mlt` makes, by their number in [`Mutations::NAMES`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mutations([bool; Mutations::NAMES.len()]);

impl Mutations {
    /// Names of all, in the order of the statistics.
    pub const NAMES: [&'static str; 6] = [
        "bidirectional",
        "lens",
        "multichain",
        "caustic",
        "subpath",
        "wavelengths",
    ];
    /// All of them.
    pub const ALL: Self = Self([true; Self::NAMES.len()]);

    /// Is it made?
    pub fn holds(self, index: usize) -> bool {
        self.0[index]
    }

    /// From a list of names, at least one.
    pub(crate) fn parse(list: &str) -> Option<Self> {
        let mut made = [false; Self::NAMES.len()];
        for word in list.split(',') {
            made[Self::NAMES.iter().position(|name| *name == word)?] = true;
        }
        Some(Self(made))
    }
}

impl std::fmt::Display for Mutations {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let names = Self::NAMES.iter().zip(self.0);
        let made: Vec<&str> = names.filter(|(_, on)| *on).map(|(name, _)| *name).collect();
        f.write_str(&made.join(","))
    }
}
