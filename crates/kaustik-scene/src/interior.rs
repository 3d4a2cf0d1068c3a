//! Which solids a walk is inside of.

/// Solids nested deeper than this are forgotten from the outside in.
const DEPTH: usize = 6;

/// The solids (each by the first material that is filled with the same medium) that contain the current point, in the order of entry.
///
/// Identity is the medium, with multiplicity, so that a solid whose surface is split over
/// several primitives, be they clear and frosted, opens and closes as one. Where solids overlap, the one of higher
/// priority is what light travels in; equal priorities: the one
/// entered last.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Interior {
    solids: [u32; DEPTH],
    len: u8,
}

impl Interior {
    /// Outside of everything.
    pub const VACUUM: Self = Self {
        solids: [0; DEPTH],
        len: 0,
    };

    /// Media of the solids, first entered first.
    #[inline]
    pub fn solids(&self) -> &[u32] {
        &self.solids[..usize::from(self.len)]
    }

    /// Outside of everything?
    #[inline]
    pub fn is_vacuum(&self) -> bool {
        self.len == 0
    }

    /// How many times it is within a solid of this medium: overlapping objects are one.
    #[inline]
    pub fn times(&self, medium: u32) -> usize {
        let solids = self.solids().iter();
        solids.filter(|&&solid| solid == medium).count()
    }

    /// Goes into a solid; beyond six the one that was entered first is forgotten.
    pub fn enter(&mut self, medium: u32) {
        if usize::from(self.len) == DEPTH {
            self.solids.copy_within(1.., 0);
            self.len -= 1;
        }
        self.solids[usize::from(self.len)] = medium;
        self.len += 1;
    }

    /// Leaves a solid; leaving one that was never entered changes nothing.
    pub fn leave(&mut self, medium: u32) {
        if let Some(at) = self.solids().iter().rposition(|&solid| solid == medium) {
            self.solids.copy_within(at + 1.., at);
            self.len -= 1;
        }
    }

    /// Goes through a surface of a solid, in by its front or out by its back.
    pub fn pass(&mut self, medium: u32, front: bool) {
        if front {
            self.enter(medium);
        } else {
            self.leave(medium);
        }
    }

    /// The same without one occurrence of `medium`.
    #[must_use]
    pub fn without(mut self, medium: u32) -> Self {
        self.leave(medium);
        self
    }

    /// The same with `medium` entered.
    #[must_use]
    pub fn with(mut self, medium: u32) -> Self {
        self.enter(medium);
        self
    }

    /// The solid that fills the point: the highest priority, the last entered among equals.
    #[inline]
    pub fn dominant(&self, priority: impl Fn(u32) -> i32) -> Option<u32> {
        self.solids()
            .iter()
            .copied()
            .max_by_key(|&solid| priority(solid))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nests_and_unnests() {
        let mut interior = Interior::VACUUM;
        interior.enter(3);
        interior.enter(5);
        interior.enter(3);
        assert_eq!(interior.solids(), [3, 5, 3]);
        interior.leave(3);
        assert_eq!(interior.solids(), [3, 5]);
        interior.leave(9);
        assert_eq!(interior.solids(), [3, 5]);
        assert_eq!(interior.without(3).solids(), [5]);
    }

    #[test]
    fn the_higher_priority_fills() {
        let interior = Interior::VACUUM.with(1).with(2).with(3);
        assert_eq!(interior.dominant(|_| 0), Some(3));
        assert_eq!(interior.dominant(|m| if m == 1 { 7 } else { 0 }), Some(1));
        assert_eq!(Interior::VACUUM.dominant(|_| 0), None);
    }

    #[test]
    fn overflow_forgets_the_outermost() {
        let mut interior = Interior::VACUUM;
        for solid in 0..10 {
            interior.enter(solid);
        }
        assert_eq!(interior.solids(), [4, 5, 6, 7, 8, 9]);
    }
}
