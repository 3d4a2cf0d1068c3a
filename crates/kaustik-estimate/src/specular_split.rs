use kaustik_path::{Class, Contributions};

use crate::ScalarTarget;

/// A scalar of the light of a value, in the two parts that films of replicas keep apart (RELT
/// 5.1.4).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SpecularSplit {
    /// Implicit specular light that nothing else finds ([`Class::L0`]). Of what other strategies find as well, heuristics
    /// leave only so much to the walk from the eye as that finds no worse.
    pub specular: f64,
    /// All other.
    pub other: f64,
}

impl SpecularSplit {
    /// Of a value, by `scalar`.
    #[inline]
    pub fn of(value: &Contributions, scalar: ScalarTarget) -> Self {
        let classes = value.by_class(scalar);
        let mut split = Self {
            specular: classes[Class::L0 as usize],
            other: 0.0,
        };
        for class in Class::ALL.into_iter().filter(|class| *class != Class::L0) {
            split.other += classes[class as usize];
        }
        split
    }

    /// Both parts.
    #[inline]
    pub fn whole(self) -> f64 {
        self.specular + self.other
    }
}
