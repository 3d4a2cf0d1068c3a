//! Discs that lie on one another.
//!
//! A disc is as large as a pixel would be on its surface if nothing on the way had gathered the rays. Where a lens or
//! a hollow mirror does, all of a picture may look at one spot: every photon there would meet every point.

use super::{Disc, Lookup, MeasurementPoints};

/// Discs are small enough where so few touch a cell of their size: at most 36 of a pixel's radius on a plane. Those of twenty
/// pixels' radius are let be.
const MOST: u32 = 1 << 14;
/// They shrink by no more than this at a time: what lay in a crowd may be alone after that.
const LEAST_STEP: f32 = 1.0 / 16.0;
/// So often at most.
const ROUNDS: i32 = 8;
/// Relative to how far they are from the origin: points that are nearer than that cannot be told apart.
const RESOLUTION: f32 = f32::EPSILON;

impl MeasurementPoints {
    /// Builds the lookup over the discs. Overcrowded discs are shrunk first, which is legitimate because
    /// their radii are fixed before any photon is traced.
    pub fn sort_into(&mut self, lookup: &mut Lookup) {
        lookup.rebuild(self.discs());
        for round in 1..=ROUNDS {
            if lookup.fullest() <= MOST || !shrink(self.discs_mut(), lookup, round) {
                break;
            }
            lookup.rebuild(self.discs());
        }
    }
}

/// Makes discs smaller where many were found; `false` if none can be. What would suffice on a plane has not where a
/// later round finds them again: each goes further.
fn shrink(discs: &mut [Disc], lookup: &Lookup, round: i32) -> bool {
    let mut any = false;
    for disc in discs {
        let crowd = lookup.crowd(disc);
        let least = RESOLUTION * disc.center.abs().max_element();
        if crowd > MOST && disc.radius > least {
            let step = (MOST as f32 / crowd as f32).sqrt().powi(round);
            // the least normal number: a disc has an area
            disc.radius = (disc.radius * step.max(LEAST_STEP))
                .max(least)
                .max(f32::MIN_POSITIVE);
            any = true;
        }
    }
    any
}

#[cfg(test)]
mod tests {
    use glam::{DVec2, Vec3};
    use kaustik_mcmc::{Draws, generator};

    use super::*;

    /// Discs of one radius, centres on a square of some side.
    fn discs(count: usize, side: f32, radius: f32) -> Vec<Disc> {
        let mut draws = generator(3, 0);
        let place = |_| {
            let at = DVec2::new(draws.uniform(), draws.uniform()).as_vec2() * side;
            Disc {
                center: Vec3::new(5.0 + at.x, at.y, 1.0),
                radius,
            }
        };
        (0..count).map(place).collect()
    }

    fn sorted(discs: Vec<Disc>) -> (MeasurementPoints, Lookup) {
        let (mut points, mut lookup) = (MeasurementPoints::of_discs(discs), Lookup::default());
        points.sort_into(&mut lookup);
        (points, lookup)
    }

    /// The most discs that hold any centre.
    fn most_met(points: &MeasurementPoints, lookup: &Lookup) -> usize {
        let met = |disc: &Disc| {
            let mut met = 0;
            lookup.holding(points.discs(), disc.center, |_| met += 1);
            met
        };
        points
            .discs()
            .iter()
            .step_by(997)
            .map(met)
            .max()
            .unwrap_or(0)
    }

    #[test]
    fn discs_on_one_spot_shrink_until_few_meet() {
        let (points, lookup) = sorted(discs(200_000, 0.01, 0.02));
        let met = most_met(&points, &lookup);
        assert!((100..MOST as usize).contains(&met), "{met}");
        let radii = points.discs().iter().map(|disc| disc.radius);
        assert!(radii.clone().all(|radius| radius > 1e-5 && radius < 0.02));
    }

    /// A radius of twenty pixels, on a plane.
    #[test]
    fn discs_of_a_plane_are_let_be() {
        let (points, _) = sorted(discs(200_000, 447.0, 20.0));
        assert!(
            points
                .discs()
                .iter()
                .all(|disc| disc.radius.to_bits() == 20_f32.to_bits())
        );
    }

    /// What cannot be told apart ends all the same.
    #[test]
    fn discs_in_one_point_are_as_small_as_can_be() {
        let (points, _) = sorted(discs(40_000, 0.0, 1.0));
        let most = 8.0 * RESOLUTION * 5.0;
        assert!(
            points
                .discs()
                .iter()
                .all(|disc| (1e-30..=most).contains(&disc.radius))
        );
    }
}
