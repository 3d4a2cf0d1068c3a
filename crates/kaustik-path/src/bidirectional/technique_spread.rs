//! How far the values of each strategy spread: what a table of how often each is tried goes by.

use kaustik_pss::Coordinates;
use kaustik_scene::Scene;
use kaustik_spectrum::Xyz;

use super::witness::{Seen, Witness};
use super::workspace::Workspace;
use super::{Bidirectional, Form};
use crate::instant::at_its_time;
use crate::{Contributions, ScalarTarget};

/// The root mean square of what each technique brings, up to a factor that all have in common.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TechniqueSpread {
    /// Of each length in edges, then of each `s`, the sum of squares.
    squares: Vec<Vec<f64>>,
}

impl TechniqueSpread {
    /// Looks at all strategies of one point of the cube, in the full form.
    ///
    /// Walks play roulette, which those of a single strategy do not, as they know how long they are to be. What
    /// survives with probability Q brings 1 / Q of its light; its square counts by Q, so that the mean is that of
    /// squares without roulette.
    pub fn look(
        &mut self,
        paths: &Bidirectional,
        scene: &Scene,
        target: ScalarTarget,
        u: &mut dyn Coordinates,
        out: &mut Contributions,
    ) {
        let form = Form::Full;
        let paths = Bidirectional { form, ..*paths };
        let spread = self;
        at_its_time(scene, u, |scene, u| {
            Workspace::with(|workspace| {
                let mut survey = Survey { spread, target };
                paths.evaluate(scene, u, out, workspace, &mut survey);
            });
        });
    }

    /// Adds what a sample of the technique (s, t), s + t >= 2, has brought that survived with this probability. What is not
    /// finite or not positive counts as nothing.
    pub(super) fn add(&mut self, (s, t): (u32, u32), survived: f32, light: f64) {
        if light > 0.0 {
            let edges = s + t - 1;
            self.add_square(
                edges as usize,
                s as usize,
                light * light * f64::from(survived),
            );
        }
    }

    fn add_square(&mut self, edges: usize, s: usize, square: f64) {
        if !(square > 0.0 && square.is_finite()) {
            return;
        }
        if self.squares.len() <= edges {
            self.squares.resize(edges + 1, Vec::new());
        }
        let squares = &mut self.squares[edges];
        if squares.len() <= s {
            squares.resize(s + 1, 0.0);
        }
        squares[s] = (squares[s] + square).min(f64::MAX);
    }

    /// Adds what others saw.
    pub fn merge(&mut self, other: &Self) {
        for (edges, squares) in other.squares.iter().enumerate() {
            for (s, square) in squares.iter().enumerate() {
                self.add_square(edges, s, *square);
            }
        }
    }

    /// Has no sample brought light?
    pub fn is_empty(&self) -> bool {
        self.squares.is_empty()
    }

    fn squares(&self, edges: u32) -> &[f64] {
        let squares = self.squares.get(edges as usize);
        squares.map_or(&[], Vec::as_slice)
    }

    /// Of one technique.
    pub(super) fn of(&self, edges: u32, s: usize) -> f64 {
        self.squares(edges).get(s).copied().unwrap_or(0.0).sqrt()
    }

    /// Of a length whose techniques are tried in proportion to their spreads.
    pub(super) fn length(&self, edges: u32) -> f64 {
        self.squares(edges).iter().copied().map(f64::sqrt).sum()
    }

    /// Of a length of which all so many techniques are tried alike.
    pub(super) fn even_length(&self, edges: u32, count: usize) -> f64 {
        let squares: f64 = self.squares(edges).iter().sum();
        (count as f64 * squares).sqrt()
    }
}

/// Sees the light of all strategies.
struct Survey<'a> {
    spread: &'a mut TechniqueSpread,
    target: ScalarTarget,
}

impl Witness for Survey<'_> {
    fn see(&mut self, _: &Seen<'_>) {}

    fn lit(&mut self, strategy: (u32, u32), survived: f32, light: impl FnOnce() -> Xyz) {
        let light = self.target.of(light());
        self.spread.add(strategy, survived, light);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is met once in a hundred, a hundred times as bright, spreads ten times as far as what is always there.
    #[test]
    fn what_is_met_seldom_spreads_further() {
        let mut spread = TechniqueSpread::default();
        assert!(spread.is_empty());
        (0..100).for_each(|_| spread.add((1, 2), 1.0, 1.0));
        spread.add((2, 1), 1.0, 100.0);
        spread.add((2, 1), 1.0, f64::NAN);
        spread.add((2, 1), 1.0, -1e9);
        assert!((spread.of(2, 2) / spread.of(2, 1) - 10.0).abs() < 1e-12);
        assert!((spread.length(2) / spread.of(2, 1) - 11.0).abs() < 1e-12);
        // tried alike: three strategies, of which one brings nothing
        let even = spread.even_length(2, 3) / spread.of(2, 1);
        assert!((even - 303_f64.sqrt()).abs() < 1e-12);
        assert!(!spread.is_empty());
    }

    /// Half of the walks bring twice the light: the spread is that of walks which all go on.
    #[test]
    fn roulette_does_not_show() {
        let (mut with, mut without) = (TechniqueSpread::default(), TechniqueSpread::default());
        (0..8).for_each(|_| without.add((3, 2), 1.0, 1.5));
        (0..4).for_each(|_| with.add((3, 2), 0.5, 3.0));
        assert!((with.of(4, 3) / without.of(4, 3) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn parts_together_are_the_whole() {
        let light = [
            (0, 2, 1.5),
            (1, 2, 3.0),
            (4, 1, 2.0),
            (1, 2, 0.5),
            (0, 9, 7.0),
        ];
        let of = |light: &[(u32, u32, f64)]| {
            let mut spread = TechniqueSpread::default();
            light
                .iter()
                .for_each(|&(s, t, light)| spread.add((s, t), 1.0, light));
            spread
        };
        let mut parts = of(&light[..2]);
        parts.merge(&of(&light[2..]));
        assert_eq!(parts, of(&light));
    }
}
