//! Sums over all ways to make vertices in a row, vertex by vertex.
//!
//! Of n vertices the first i are made with the light, with densities L, and the others from the eye, with
//! densities E; J is 1 where a walk with the light and one from the eye may have been joined, else 0; behind an emitter that alone is
//! made with the light it is how much more often such a one is chosen there than a walk with the light begins at it. The sum
//! over i of `L_0 .. L_(i-1) J_i E_i .. E_(n-1)` is taken by Horner's scheme, from the light, and can be cut
//! anywhere: what has been summed is a [`Ways`], what is still to come a [`WaysOn`].

use crate::factor::{Factor, factor};

/// How one vertex is made.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Making {
    /// Density with which a walk with the light makes it: L.
    pub(crate) by_light: f64,
    /// Density with which a walk from the eye makes it: E.
    pub(crate) by_eye: f64,
    /// How often it is joined to the next vertex toward the eye, if all before it are made with the light; 0 if never: J.
    pub(crate) joins: f64,
}

/// All ways to make the vertices from the light up to one.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ways {
    /// That in which all are made with the light.
    light: f64,
    /// The sum over the ways that may have been joined, that one among them if it may.
    pub(crate) sum: f64,
}

impl Ways {
    /// To make no vertices; may what comes before the first of them be joined to it?
    pub(crate) fn none(joins: bool) -> Self {
        Self {
            // 1, unless a test leaves this factor out: the ways that begin at the light then count nothing.
            light: 1.0 - factor(Factor::OtherWays, 0.0),
            sum: f64::from(u8::from(joins)),
        }
    }

    /// With one vertex more.
    #[inline]
    pub(crate) fn then(self, vertex: Making) -> Self {
        let light = self.light * vertex.by_light;
        Self {
            light,
            sum: self.sum * vertex.by_eye + light * vertex.joins,
        }
    }

    /// The sum over all ways to make these vertices and those after them.
    #[inline]
    pub(crate) fn through(self, on: WaysOn) -> f64 {
        self.sum * on.by_eye + self.light * on.by_light
    }
}

/// All ways to make the vertices from one to the eye.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WaysOn {
    /// That in which all are made from the eye: the walks were joined before.
    by_eye: f64,
    /// The sum over those in which the first of them is made with the light.
    by_light: f64,
}

impl WaysOn {
    /// To make no vertices.
    pub(crate) const NONE: Self = Self {
        by_eye: 1.0,
        by_light: 0.0,
    };

    /// With one vertex more, before the others.
    #[inline]
    pub(crate) fn after(self, vertex: Making) -> Self {
        Self {
            by_eye: vertex.by_eye * self.by_eye,
            by_light: vertex.by_light * (vertex.joins * self.by_eye + self.by_light),
        }
    }
}
