//! Random and evenly spread numbers, directions.

use glam::DVec3;

/// SplitMix64: small, seeded, good enough to draw test samples.
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ 0x5851_f42d_4c95_7f2d)
    }

    /// Uniform in `[0, 1)`.
    pub(crate) fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Uniform over the sphere.
    pub(crate) fn direction(&mut self) -> DVec3 {
        kaustik_bsdf::warp::uniform_sphere([self.uniform(), self.uniform()])
    }
}

/// The `i`th point of an evenly spread sequence in the cube (additive recurrence).
pub(crate) fn spread(i: usize) -> [f64; 3] {
    const STEP: [f64; 3] = [
        0.819_172_513_396_164_4,
        0.671_043_606_703_789_2,
        0.549_700_477_901_970_2,
    ];
    STEP.map(|step| (0.5 + (i + 1) as f64 * step).fract())
}

/// Direction at cosine `z` (negative: below) and azimuth `turns`.
pub(crate) fn at(z: f64, turns: f64) -> DVec3 {
    let (s, c) = kaustik_bsdf::warp::sin_cos_turns(turns);
    let r = (1.0 - z * z).sqrt();
    DVec3::new(r * c, r * s, z)
}
