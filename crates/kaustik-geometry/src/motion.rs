//! Instances that move while light is gathered.

use glam::{Affine3A, Mat3A};

/// Where something stands over an interval of time: transforms at times from 0 to 1, between which every point
/// moves on a straight line.
///
/// Turning is thus a matter of enough keys: whoever makes them decides how near to its arc a point stays. What is
/// gained is that the boxes around moving triangles are exact (the hull of what the keys give) and that an instant
/// costs a handful of multiplications.
///
/// Before the first key and after the last one it stands still. Of two keys with the same time the second holds from
/// that time on: a jump.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    keys: Vec<(f32, Affine3A)>,
}

impl Motion {
    /// From keys in the order of their times, which lie in \[0, 1\]. `None` without keys, where times are not in
    /// order or out of range, and of transforms that are not finite.
    pub fn new(keys: Vec<(f32, Affine3A)>) -> Option<Motion> {
        let ordered = keys.windows(2).all(|pair| pair[0].0 <= pair[1].0);
        let sound = |(time, key): &(f32, Affine3A)| (0.0..=1.0).contains(time) && key.is_finite();
        (!keys.is_empty() && ordered && keys.iter().all(sound)).then_some(Motion { keys })
    }

    /// The transform at a time, object to world.
    pub fn at(&self, time: f32) -> Affine3A {
        let next = self.keys.partition_point(|(key, _)| *key <= time);
        let Some((t1, b)) = self.keys.get(next) else {
            return self.keys[self.keys.len() - 1].1;
        };
        let Some(before) = next.checked_sub(1) else {
            return *b;
        };
        let (t0, a) = self.keys[before];
        let share = (time - t0) / (t1 - t0);
        // Not `a + (b - a) s`: both ends are exact.
        let blend = |a, b| a * (1.0 - share) + b * share;
        let (m, n) = (&a.matrix3, &b.matrix3);
        Affine3A {
            matrix3: Mat3A::from_cols(
                blend(m.x_axis, n.x_axis),
                blend(m.y_axis, n.y_axis),
                blend(m.z_axis, n.z_axis),
            ),
            translation: blend(a.translation, b.translation),
        }
    }

    /// The keys: times and transforms.
    pub fn keys(&self) -> &[(f32, Affine3A)] {
        &self.keys
    }

    /// Does nothing move at all?
    pub fn is_still(&self) -> bool {
        self.keys.iter().all(|(_, key)| *key == self.keys[0].1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    fn at(x: f32) -> Affine3A {
        Affine3A::from_translation(Vec3::X * x)
    }

    #[test]
    fn it_goes_straight_from_key_to_key_jumps_and_stands_at_the_ends() {
        let keys = vec![
            (0.25, at(1.0)),
            (0.5, at(3.0)),
            (0.5, at(8.0)),
            (1.0, at(8.0)),
        ];
        let motion = Motion::new(keys).expect("sound keys");
        let x = |time| motion.at(time).translation.x;
        let expected = [
            (0.0, 1.0),
            (0.25, 1.0),
            (0.375, 2.0),
            (0.499_999_97, 3.0),
            (0.5, 8.0),
            (1.0, 8.0),
        ];
        for (time, place) in expected {
            assert!((x(time) - place).abs() < 1e-5, "{time}: {}", x(time));
        }
        assert!(!motion.is_still());
    }

    #[test]
    fn keys_out_of_order_or_range_are_refused() {
        let nan = at(f32::NAN);
        for keys in [
            vec![],
            vec![(0.5, at(0.0)), (0.25, at(0.0))],
            vec![(1.5, at(0.0))],
            vec![(f32::NAN, at(0.0))],
            vec![(0.5, nan)],
        ] {
            assert_eq!(Motion::new(keys.clone()), None, "{keys:?}");
        }
    }
}
