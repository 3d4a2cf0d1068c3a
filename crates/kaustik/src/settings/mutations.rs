use crate::MutationKind;

/// Which kinds of mutations `mlt` or `erpt` makes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mutations {
    made: [bool; MutationKind::COUNT],
    /// The share of its domain that [`MutationKind::Every`] moves a variable by, in (0, 1].
    pub fraction: f64,
}

impl Mutations {
    /// All but [`MutationKind::Every`].
    pub const STANDARD: Self = Self::of(&[
        MutationKind::Bidirectional,
        MutationKind::Lens,
        MutationKind::Multichain,
        MutationKind::Caustic,
        MutationKind::Subpath,
        MutationKind::Wavelengths,
        MutationKind::Time,
    ]);
    /// Those that keep the string of scatterings: what `erpt` makes. Its chains are short, and each stays at the time of the
    /// sample that it begins with.
    pub const PERTURBATIONS: Self = Self::of(&[
        MutationKind::Lens,
        MutationKind::Multichain,
        MutationKind::Caustic,
        MutationKind::Wavelengths,
    ]);

    const fn of(kinds: &[MutationKind]) -> Self {
        let mut made = [false; MutationKind::COUNT];
        let mut i = 0;
        while i < kinds.len() {
            made[kinds[i] as usize] = true;
            i += 1;
        }
        Self {
            made,
            fraction: 0.2,
        }
    }

    /// Is it made?
    pub fn holds(self, kind: MutationKind) -> bool {
        self.made[kind as usize]
    }

    /// Does the other set hold all of this one?
    pub(crate) fn within(self, other: Self) -> bool {
        (self.made.iter().zip(other.made)).all(|(here, there)| there || !here)
    }

    /// From a list of names, at least one. `every` may be followed by a colon and its fraction.
    pub(crate) fn parse(list: &str) -> Option<Self> {
        let mut parsed = Self::of(&[]);
        for word in list.split(',') {
            let (name, number) = word.split_once(':').unwrap_or((word, ""));
            let kind = MutationKind::named(name)?;
            if word.len() > name.len() {
                parsed.fraction = (number.parse::<f64>().ok())
                    .filter(|share| kind == MutationKind::Every && *share > 0.0 && *share <= 1.0)?;
            }
            parsed.made[kind as usize] = true;
        }
        Some(parsed)
    }
}

impl std::fmt::Display for Mutations {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let made = MutationKind::ALL
            .into_iter()
            .filter(|kind| self.holds(*kind));
        let names: Vec<&str> = made.map(MutationKind::name).collect();
        f.write_str(&names.join(","))?;
        if self.holds(MutationKind::Every) {
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
