//! Weights by quantities that run along a subpath, so that one connection costs the same however long
//! the path is (after Georgiev 2012).
//!
//! Along the light subpath, with `L_i` the sum over all strategies `s' <= i` of their densities
//! relative to that of the strategy that makes `x_0 .. x_i` from the light, without the density with
//! which the eye would make `x_i`:
//!
//! ```text
//! L_i = odds_i dM_i (+) p_w(x_i -> x_{i-1}) dC_i
//! dM_{i+1} = odds_i / p_fwd(i+1)
//! dC_{i+1} = cos_i / (cos_{i+1} p_w(x_i -> x_{i+1})) L_i
//! ```
//!
//! The same runs along the eye subpath with the roles exchanged. `(+)` is a sum, or the maximum
//! ([`Heuristic::join`]); with the power heuristic every factor is squared. `odds` tell how often a
//! vertex is joined where it could be, for each time that the walk goes on there: 1 in the
//! full form, where both always happen; (stop / go on) in the simple form; 0 after a Dirac
//! scattering. Strategy i, which joins `x_{i-1}` to `x_i`, counts with the product of their odds. At a Dirac
//! scattering `p_w` is 1 both ways. Where next event chooses the emitter `c` times as often from `x_1` as light walks do, strategy 1 counts with
//! that as well: `dM_1` is `c odds_0 / p_fwd(1)` ([`Departure::arrive_first`]).

use super::Heuristic;

/// What a subpath's vertex knows of its rivals.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Running {
    /// `dM`, the heuristic applied, without the odds of this vertex: the one strategy that joins this vertex to the one before it.
    pub(crate) dm: f64,
    /// `dC`, the heuristic applied: all strategies that join earlier vertices, whose walk from the other side goes back from here to
    /// the one before.
    pub(crate) dc: f64,
}

impl Running {
    /// `L`: what to multiply by the heuristic of the density with which the other side would make this
    /// vertex. `odds` are those of this vertex, `back` is the density per solid angle of the
    /// direction in which its subpath came.
    #[inline]
    pub(crate) fn rivals(&self, heuristic: Heuristic, odds: f64, back: f64) -> f64 {
        heuristic.join(heuristic.of(odds) * self.dm, heuristic.of(back) * self.dc)
    }
}

/// On the way from one vertex of a subpath to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Departure {
    /// Density of the direction: per solid angle, or per perpendicular area if it comes from infinity.
    pdf: f64,
    odds: f64,
    /// `L_i cos_i / p_w`, the heuristic applied.
    carry: f64,
    infinite: bool,
}

impl Departure {
    /// Leaves the end on the emitter or on the lens. `position` is the density of the point, 0 if no ray
    /// can run into it; `direction` and `cos` are those of the first edge; `onward` is the
    /// probability of going on here, `odds` its odds.
    #[inline]
    pub(crate) fn from_end(heuristic: Heuristic, end: End, onward: f64, odds: f64) -> Self {
        let rivals = if end.position > 0.0 {
            1.0 / (end.position * onward)
        } else {
            0.0
        };
        Self {
            pdf: end.direction,
            odds,
            carry: heuristic.of(rivals * end.cos / end.direction),
            infinite: end.infinite,
        }
    }

    /// Leaves a surface. `pdf` is the density of the direction taken, `back` that of the direction in
    /// which the subpath came, seen from the other side, `cos` the geometric cosine of the new edge;
    /// `odds` are 0 after a Dirac scattering, whose densities are 1.
    #[inline]
    pub(crate) fn from_surface(
        heuristic: Heuristic,
        running: &Running,
        [pdf, back]: [f64; 2],
        cos: f64,
        odds: f64,
    ) -> Self {
        Self {
            pdf,
            odds,
            carry: running.rivals(heuristic, odds, back) * heuristic.of(cos / pdf),
            infinite: false,
        }
    }

    /// Reaches a surface at the square of a distance, with the geometric cosine there.
    #[inline]
    pub(crate) fn arrive(&self, heuristic: Heuristic, squared: f64, cos: f64) -> Running {
        let squared = if self.infinite { 1.0 } else { squared };
        Running {
            dm: heuristic.of(self.odds * squared / (self.pdf * cos)),
            dc: self.carry * heuristic.of(1.0 / cos),
        }
    }

    /// The same of the first surface after an emitter, which next event chooses `choice` times as often from there as light walks do.
    #[inline]
    pub(crate) fn arrive_first(
        &self,
        heuristic: Heuristic,
        (squared, cos): (f64, f64),
        choice: f64,
    ) -> Running {
        let running = self.arrive(heuristic, squared, cos);
        Running {
            dm: running.dm * heuristic.of(choice),
            ..running
        }
    }

    /// Leaves the scene: what is met there has its density per solid angle.
    #[inline]
    pub(crate) fn escape(&self, heuristic: Heuristic) -> Running {
        self.arrive(heuristic, 1.0, 1.0)
    }
}

/// An end of the path as its own subpath draws it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct End {
    /// Density of the point; 0 where no ray can run into it.
    pub(crate) position: f64,
    /// Density of the first direction.
    pub(crate) direction: f64,
    /// Cosine at the end's surface.
    pub(crate) cos: f64,
    /// The first direction is drawn per perpendicular area.
    pub(crate) infinite: bool,
}
