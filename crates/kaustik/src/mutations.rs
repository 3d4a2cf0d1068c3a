/// Which mutations `mlt` or `erpt` makes, by their number in [`Mutations::NAMES`].
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
    /// Those that keep the string of scatterings, and the wavelengths: what `erpt` makes.
    pub const PERTURBATIONS: Self = Self([false, true, true, true, false, true]);
    /// All of them.
    pub const ALL: Self = Self([true; Self::NAMES.len()]);

    /// Is it made?
    pub fn holds(self, index: usize) -> bool {
        self.0[index]
    }

    /// Does the other set hold all of this one?
    pub(crate) fn within(self, other: Self) -> bool {
        self.0
            .iter()
            .zip(other.0)
            .all(|(here, there)| there || !here)
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
