use glam::{Vec3, Vec4};

use super::frame::{Frame, ROUNDING};
use super::group::Group;

/// Groups in a node.
pub(super) const WIDTH: usize = 4;

/// Up to four groups of emitters, side by side so that all are weighed at once: of each a sphere around them, the cone of what they
/// shine into, and what they send out in all. Numbers are those of the tree's [`Frame`].
#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    /// Centers: x, y, z.
    center: [Vec4; 3],
    radius: Vec4,
    power: Vec4,
    /// Axes of the cones: x, y, z.
    axis: [Vec4; 3],
    cos_spread: Vec4,
    sin_spread: Vec4,
    /// Cosine beyond the cone and the sphere from which on light comes.
    least_cos: Vec4,
    /// Distance from the center beyond which all have faded to nothing.
    end: Vec4,
    /// Where each group goes on.
    below: [Below; WIDTH],
}

/// What stands for a group one level below.
#[derive(Clone, Copy, Debug)]
pub(super) enum Below {
    /// One emitter, by its number in the list.
    Emitter(u32),
    /// The node that parts the group further.
    Node(u32),
}

/// No cosine is taken to be smaller, so that what shines at a point at a grazing angle is not lost.
const LEAST_COS: f32 = 1e-3;

/// By how much cosines may be rounded: where light leaves within a right angle of a normal, the sine of nearly half a turn, a root, is known to 6e-4 at least
/// (of a million tried at random); where it leaves along the cone alone, to 3e-7.
const SLACK: [f64; 2] = [2e-3, 1e-5];

/// By which ranges are longer, for the same reason.
const LONGER: f64 = 1.0 + 1e-5;

impl Node {
    /// Without any group.
    pub(super) const EMPTY: Self = Self {
        center: [Vec4::ZERO; 3],
        radius: Vec4::ONE,
        power: Vec4::ZERO,
        axis: [Vec4::ZERO, Vec4::ZERO, Vec4::ONE],
        cos_spread: Vec4::ONE,
        sin_spread: Vec4::ZERO,
        least_cos: Vec4::ONE,
        end: Vec4::ZERO,
        below: [Below::Emitter(0); WIDTH],
    };

    /// Puts a group into a lane.
    pub(super) fn set(&mut self, lane: usize, group: &Group, frame: &Frame, below: Below) {
        let center = frame.local(group.center());
        let axis = group.cone.axis.as_vec3();
        for i in 0..3 {
            self.center[i][lane] = center[i];
            self.axis[i][lane] = axis[i];
        }
        let radius = group.radius();
        self.radius[lane] = frame.length(radius) + ROUNDING;
        self.power[lane] = frame.power(group.power);
        self.cos_spread[lane] = libm::cos(group.cone.spread) as f32;
        self.sin_spread[lane] = libm::sin(group.cone.spread) as f32;
        let slack = SLACK[usize::from(group.cone.reach <= 0.0)];
        self.least_cos[lane] = (libm::cos(group.cone.reach) - slack) as f32;
        self.end[lane] = frame.length((group.range + radius) * LONGER) + ROUNDING;
        self.below[lane] = below;
    }

    #[inline]
    pub(super) fn below(&self, lane: usize) -> Below {
        self.below[lane]
    }

    /// Each group's part of what comes to a point from all of them; `None` if nothing does.
    #[inline]
    pub(super) fn shares(&self, point: Vec3) -> Option<[f64; WIDTH]> {
        let of = self.importances(point).to_array().map(f64::from);
        let sum: f64 = of.iter().sum();
        (sum > 0.0).then(|| of.map(|importance| importance / sum))
    }

    /// About how much light comes to a point from each group: the power over the square of the distance, times the largest cosine at
    /// which any of the emitters may send out light toward it. 0 where none does.
    ///
    /// Without jumps, so that four lanes are computed side by side.
    #[inline]
    fn importances(&self, point: Vec3) -> Vec4 {
        let to = [0, 1, 2].map(|i| Vec4::splat(point[i]) - self.center[i]);
        let distance = (to[0] * to[0] + to[1] * to[1] + to[2] * to[2]).sqrt();
        // Within the sphere as at its surface.
        let scale = distance.max(self.radius).recip();
        let near = self.power * scale * scale;
        // The angle between the axis and the way to the point, less the spread of the normals, less the angle that the sphere fills.
        let [x, y, z] = [0, 1, 2].map(|i| self.axis[i] * to[i]);
        let cos = (x + y + z) * scale;
        let sin = side(cos);
        let beyond_cos = cos * self.cos_spread + sin * self.sin_spread;
        let beyond_sin = sin * self.cos_spread - cos * self.sin_spread;
        let filled_sin = self.radius * scale;
        let filled_cos = side(filled_sin);
        let largest = beyond_cos * filled_cos + beyond_sin * filled_sin;
        let shines = largest.cmpge(self.least_cos);
        let turned = Vec4::select(shines, largest.max(Vec4::splat(LEAST_COS)), Vec4::ZERO);
        let inside = distance.cmple(self.radius);
        let faces = inside | cos.cmpge(self.cos_spread) | beyond_cos.cmpge(filled_cos);
        let cosine = Vec4::select(faces, Vec4::ONE, turned);
        let comes = inside | distance.cmple(self.end);
        near * Vec4::select(comes, cosine, Vec4::ZERO)
    }
}

/// The sine of a cosine, or the other way round, of an angle up to half a turn.
#[inline]
fn side(of: Vec4) -> Vec4 {
    (Vec4::ONE - of * of).max(Vec4::ZERO).sqrt()
}
