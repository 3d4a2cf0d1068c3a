//! What kernels are tried on: proptest strategies for targets and mutations.
//!
//! Kernels that are right on a pleasant target are wrong on others: where a density is
//! zero, where it jumps by nine orders, where it does not change at all (acceptance 1,
//! always), where modes are far apart. These strategies make all of these, and shrink to
//! small ones.

use std::ops::Range;

use proptest::collection::{SizeRange, vec};
use proptest::prelude::*;

use super::GridStep;

/// Unnormalised masses of as many states as `states` says: random, with zeros; spikes up to
/// 1e9 on plains down to 1e-9; plateaus; modes apart from each other by valleys or by
/// nothing. At least one is positive.
pub fn targets(states: impl Into<SizeRange>) -> impl Strategy<Value = Vec<f64>> {
    let states = states.into();
    prop_oneof![
        3 => vec(prop_oneof![1 => Just(0.0), 4 => 1e-3..1.0f64], states.clone()),
        2 => vec(prop_oneof![6 => 0.5..1.0f64, 1 => any_size()], states.clone()),
        1 => vec((1e-3..1.0f64, any::<bool>()), states.clone()).prop_map(plateaus),
        1 => vec((0.5..1.0f64, prop_oneof![Just(0.0), 1e-8..1e-2f64]), states).prop_map(modes),
    ]
    .prop_map(somewhere)
}

/// A positive number of any order from -9 to 9.
fn any_size() -> impl Strategy<Value = f64> {
    (-9.0..9.0f64).prop_map(|order| libm::pow(10.0, order))
}

/// States that are flagged have the mass of the one before.
fn plateaus(states: Vec<(f64, bool)>) -> Vec<f64> {
    let mut last = 0.0;
    let flat = states.into_iter().map(|(mass, stay)| {
        if !stay {
            last = mass;
        }
        last
    });
    flat.collect()
}

/// Peaks and valleys in turn.
fn modes(states: Vec<(f64, f64)>) -> Vec<f64> {
    let masses = states.into_iter().enumerate();
    masses
        .map(|(i, (peak, valley))| if i % 3 == 0 { peak } else { valley })
        .collect()
}

/// No law is zero everywhere.
fn somewhere(mut masses: Vec<f64>) -> Vec<f64> {
    let nowhere = masses.iter().all(|mass| *mass <= 0.0);
    if let (true, Some(first)) = (nowhere, masses.first_mut()) {
        *first = 1.0;
    }
    masses
}

/// A density on the unit square, constant on each cell of a grid: the target of a chain
/// on points whose law can be enumerated.
#[derive(Clone, Debug, PartialEq)]
pub struct GridDensity {
    /// Cells of a side.
    pub cells: usize,
    /// The density of each cell, at least 0: x runs fastest.
    pub densities: Vec<f64>,
}

impl GridDensity {
    /// The density at a point of [0, 1)^2.
    pub fn at(&self, [x, y]: [f64; 2]) -> f64 {
        let [i, j] = [x, y].map(|u| (u * self.cells as f64) as usize);
        self.densities[i + j * self.cells]
    }
}

/// Densities on the unit square with so many cells a side, shaped as [`targets`].
pub fn grid_densities(cells: Range<usize>) -> impl Strategy<Value = GridDensity> {
    cells.prop_flat_map(|cells| {
        targets(cells * cells).prop_map(move |densities| GridDensity { cells, densities })
    })
}

/// Symmetric steps on a grid of so many cells: as probable up as down, of any reach; the
/// step that stays where it is among them.
pub fn mutations(cells: usize) -> impl Strategy<Value = GridStep> {
    let weight = prop_oneof![1 => Just(0.0), 2 => 0.05..1.0f64];
    vec(weight, cells / 2 + 1).prop_map(move |weights| GridStep::new(cells, &mirrored(weights)))
}

/// Steps that are more probable up than down: a kernel that takes them for symmetric breaks detailed balance
/// everywhere, and stationarity where the target is not flat. For the tests of tests. On a grid
/// of at least 3 cells.
pub fn skewed_mutations(cells: usize) -> impl Strategy<Value = GridStep> {
    (vec(0.05..1.0f64, cells / 2 + 1), 0.1..1.0f64).prop_map(move |(weights, skew)| {
        let mut steps = mirrored(weights);
        steps.push((1, skew));
        GridStep::new(cells, &steps)
    })
}

/// Steps 0, +-1, +-2, ... by their weights; never nowhere at all.
fn mirrored(weights: Vec<f64>) -> Vec<(i32, f64)> {
    let mut steps = Vec::new();
    for (reach, weight) in somewhere(weights).into_iter().enumerate() {
        match reach as i32 {
            0 => steps.push((0, weight)),
            reach => steps.extend([(reach, weight / 2.0), (-reach, weight / 2.0)]),
        }
    }
    steps
}

#[cfg(test)]
mod tests {
    use proptest::strategy::ValueTree;
    use proptest::test_runner::TestRunner;

    use super::*;
    use crate::Mutation;
    use crate::testing::{TransitionMatrix, assert_stationary};

    fn samples<S: Strategy>(strategy: S) -> impl Iterator<Item = S::Value> {
        let mut runner = TestRunner::deterministic();
        (0..2000).map(move |_| strategy.new_tree(&mut runner).unwrap().current())
    }

    /// Every kind of target that the documentation promises does come.
    #[test]
    fn targets_are_of_all_shapes() {
        let all: Vec<_> = samples(targets(2..9)).collect();
        let some = |shape: &dyn Fn(&[f64]) -> bool| all.iter().filter(|t| shape(t)).count();
        let largest = |t: &[f64]| t.iter().copied().fold(0.0, f64::max);
        assert_eq!(
            some(&|t| largest(t) > 0.0 && t.len() < 9 && t.len() > 1),
            2000
        );
        assert!(some(&|t| t.contains(&0.0)) > 300, "zeros");
        assert!(some(&|t| largest(t) > 1e4) > 50, "spikes");
        assert!(
            some(&|t| t.iter().any(|m| *m > 0.0 && *m < 1e-4)) > 50,
            "plains"
        );
        assert!(
            some(&|t| t
                .windows(2)
                .any(|w| w[0] > 0.0 && w[0].to_bits() == w[1].to_bits()))
                > 50,
            "plateaus"
        );
        let island = |t: &[f64]| {
            t.windows(3)
                .any(|w| w[0] > 0.1 && w[1] < 1e-2 && w[2] < 1e-2)
        };
        assert!(some(&island) > 50, "modes");
    }

    fn matrix(step: &GridStep) -> TransitionMatrix {
        TransitionMatrix::of(5, 5, |from, draws| {
            (step.mutate((from as f64 + 0.5) / 5.0, draws) * 5.0) as usize
        })
    }

    #[test]
    fn mutations_are_symmetric_and_skewed_ones_are_not() {
        for step in samples(mutations(5)) {
            assert!(matrix(&step).balance_defect(&[1.0; 5]) < 1e-15, "{step:?}");
        }
        for step in samples(skewed_mutations(5)) {
            assert_stationary(&matrix(&step), &[1.0; 5]);
            assert!(matrix(&step).balance_defect(&[1.0; 5]) > 1e-3, "{step:?}");
        }
    }

    #[test]
    fn a_grid_density_is_constant_on_cells() {
        for density in samples(grid_densities(1..4)).take(100) {
            let n = density.cells;
            assert_eq!(density.densities.len(), n * n);
            let last = density.at([1.0 - 1e-9, 1.0 - 1e-9]);
            assert_eq!(last.to_bits(), density.densities[n * n - 1].to_bits());
        }
    }
}
