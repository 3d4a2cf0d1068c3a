use std::ops::AddAssign;

/// How many rays were traced. What is partly transparent, a smooth pane, or hidden by a solid of higher priority, is passed by the
/// same ray.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RayCounts {
    /// Asked for the closest hit: the edges of walks.
    pub closest: u64,
    /// Asked for any hit: joins, as to an emitter or to the lens (shadow rays).
    pub any: u64,
}

impl AddAssign for RayCounts {
    #[inline]
    fn add_assign(&mut self, other: Self) {
        self.closest += other.closest;
        self.any += other.any;
    }
}
