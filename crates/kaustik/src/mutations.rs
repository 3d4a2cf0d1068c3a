/// Which mutations `mlt` or `erpt` makes, by their number in [`Mutations::NAMES`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mutations {
    made: [bool; Mutations::NAMES.len()],
    /// The share of its domain that [`Mutations::EVERY`] moves a variable by, in (0, 1].
    pub fraction: f64,
}

impl Mutations {
    /// Names of all, in the order of the statistics.
    pub const NAMES: [&'static str; 8] = [
        "bidirectional",
        "lens",
        "multichain",
        "caustic",
        "subpath",
        "wavelengths",
        "time",
        "every",
    ];
    /// The number of the one that moves every variable of a path.
    pub const EVERY: usize = 7;
    /// All but that one.
    pub const STANDARD: Self = Self {
        made: [true, true, true, true, true, true, true, false],
        fraction: 0.2,
    };
    /// Those that keep the string of scatterings, and the wavelengths: what `erpt` makes.
    pub const PERTURBATIONS: Self = Self {
        made: [false, true, true, true, false, true, false, false],
        fraction: 0.2,
    };

    /// Is it made?
    pub fn holds(self, index: usize) -> bool {
        self.made[index]
    }

    /// Does the other set hold all of this one?
    pub(crate) fn within(self, other: Self) -> bool {
        (self.made.iter().zip(other.made)).all(|(here, there)| there || !here)
    }

    /// From a list of names, at least one. `every` may be followed by a colon and its fraction.
    pub(crate) fn parse(list: &str) -> Option<Self> {
        let mut made = [false; Self::NAMES.len()];
        let mut fraction = Self::STANDARD.fraction;
        for word in list.split(',') {
            let (name, number) = word.split_once(':').unwrap_or((word, ""));
            let index = Self::NAMES.iter().position(|known| *known == name)?;
            if word.len() > name.len() {
                fraction = (number.parse::<f64>().ok())
                    .filter(|share| index == Self::EVERY && *share > 0.0 && *share <= 1.0)?;
            }
            made[index] = true;
        }
        Some(Self { made, fraction })
    }
}

impl std::fmt::Display for Mutations {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let names = Self::NAMES.iter().zip(self.made);
        let made: Vec<&str> = names.filter(|(_, on)| *on).map(|(name, _)| *name).collect();
        f.write_str(&made.join(","))?;
        if self.holds(Self::EVERY) {
            write!(f, ":{}", self.fraction)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_are_read_as_they_are_written() {
        for list in ["bidirectional", "lens,caustic", "bidirectional,every:0.01"] {
            let found = Mutations::parse(list).map(|made| made.to_string());
            assert_eq!(found.as_deref(), Some(list));
        }
        let found = Mutations::parse("every,lens").map(|made| made.to_string());
        assert_eq!(found.as_deref(), Some("lens,every:0.2"));
        for list in [
            "",
            "lens,",
            "lens:0.1",
            "every:",
            "every:0",
            "every:1.1",
            "every:x",
            "all",
        ] {
            assert_eq!(Mutations::parse(list), None, "{list}");
        }
    }
}
