//! The directions into which a group of emitters shines.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec3;

/// Every normal lies within `spread` of `axis`, and light leaves within `reach` of a normal, with its cosine (Conty Estevez and
/// Kulla 2018, sec. 4.1).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Cone {
    /// Unit.
    pub(super) axis: DVec3,
    /// Radians, from 0 to pi.
    pub(super) spread: f64,
    /// Radians, from 0 to pi / 2.
    pub(super) reach: f64,
}

/// Axes that are so near to opposite, in radians, have nothing between them.
const OPPOSITE: f64 = 1e-4;

impl Cone {
    /// What shines everywhere.
    pub(super) const ALL: Self = Self {
        axis: DVec3::Z,
        spread: PI,
        reach: FRAC_PI_2,
    };

    /// One side of a surface with this normal, of length 1 about.
    pub(super) fn side(normal: DVec3) -> Self {
        Self {
            axis: normal.normalize_or(DVec3::Z),
            spread: 0.0,
            reach: FRAC_PI_2,
        }
    }

    /// What shines within an angle of an axis of length 1 about, by any law.
    pub(super) fn spot(axis: DVec3, angle: f64) -> Self {
        Self {
            axis: axis.normalize_or(DVec3::Z),
            spread: angle.clamp(0.0, PI),
            reach: 0.0,
        }
    }

    /// A cone around both, the narrowest up to rounding.
    pub(super) fn union(self, other: Self) -> Self {
        let reach = self.reach.max(other.reach);
        let (wide, narrow) = match self.spread >= other.spread {
            true => (self, other),
            false => (other, self),
        };
        let between = angle(wide.axis, narrow.axis);
        if (between + narrow.spread).min(PI) <= wide.spread {
            return Self { reach, ..wide };
        }
        let spread = 0.5 * (wide.spread + between + narrow.spread);
        // The axis turns toward the narrow one until both just fit in.
        let across = narrow.axis - wide.axis * wide.axis.dot(narrow.axis);
        // Of opposite axes it is rounding that says where to.
        let known = spread < PI && between < PI - OPPOSITE;
        let Some(across) = across.try_normalize().filter(|_| known) else {
            return Self { reach, ..Self::ALL };
        };
        let turn = spread - wide.spread;
        let axis = wide.axis * libm::cos(turn) + across * libm::sin(turn);
        Self {
            axis: axis.normalize(),
            spread,
            reach,
        }
    }
}

/// Between two unit vectors, exact for small ones too.
pub(super) fn angle(a: DVec3, b: DVec3) -> f64 {
    libm::atan2(a.cross(b).length(), a.dot(b))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::tests::unit;
    use super::*;

    fn cone() -> impl Strategy<Value = Cone> {
        let spread = prop_oneof![Just(0.0), Just(PI), 0.0..PI];
        (unit(), spread).prop_map(|(axis, spread)| Cone {
            axis,
            spread,
            reach: FRAC_PI_2,
        })
    }

    proptest! {
        /// What lies in either lies in both together.
        #[test]
        fn a_union_holds_both(a in cone(), b in cone(), direction in unit()) {
            let both = a.union(b);
            for part in [a, b] {
                if angle(part.axis, direction) <= part.spread {
                    prop_assert!(angle(both.axis, direction) <= both.spread + 1e-7);
                }
            }
            prop_assert!(both.spread <= PI && both.axis.is_normalized());
        }

        /// So do those of opposite sides, in single precision as meshes have them.
        #[test]
        fn opposite_sides_are_held(axis in unit(), aside in unit(), off in -10..-2i32, angle_of in 0.0..0.5f64) {
            let other = -axis + aside * 10.0_f64.powi(off);
            for (a, b) in [(axis, -axis), (axis, other)] {
                let rounded = [a, b].map(|axis| Cone::side(axis.as_vec3().as_dvec3()));
                for [a, b] in [rounded, [Cone::spot(a, angle_of), Cone::spot(b, angle_of)]] {
                    let both = a.union(b);
                    for part in [a, b] {
                        let furthest = angle(both.axis, part.axis) + part.spread;
                        prop_assert!(furthest.min(PI) <= both.spread + 1e-7, "{a:?} {b:?} {both:?}");
                    }
                }
            }
        }
    }
}
