//! Which surface light lies on.

use kaustik_bsdf::{Bsdf, Lobe};
use kaustik_scene::{Scene, Vertex};

/// Which surface a photon or a point lies on, as far as that matters: whether light goes on behind the surface, and a hash of its
/// mesh instance.
///
/// The whole light lands on each of several surfaces that let it through. Where they lie closer together than a disc
/// reaches, those of the others must not count.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sheet(u16);

impl Sheet {
    const LETS_THROUGH: u16 = 1 << 15;

    pub(super) fn new(scene: &Scene, vertex: &Vertex, bsdf: &Bsdf) -> Self {
        let lets_through = bsdf.transmits() || scene.is_passed(vertex);
        // Fibonacci hashing: neighbours in a file get numbers far apart.
        let hash = (vertex.instance.wrapping_mul(0x9E37_79B9) >> 17) as u16;
        Self(hash | if lets_through { Self::LETS_THROUGH } else { 0 })
    }

    /// May light that lies on the one count on the other?
    #[inline]
    pub(super) fn is_shared_with(self, other: Self) -> bool {
        let one = (self.0 ^ other.0) & !Self::LETS_THROUGH == 0;
        one || (self.0 | other.0) & Self::LETS_THROUGH == 0
    }
}
