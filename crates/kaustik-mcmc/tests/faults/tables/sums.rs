//! Starts, statistics, draws, generators.

use super::fault;
use crate::Fault;

/// Pools of starts.
pub(crate) const START: &[Fault] = &[
    fault(
        "a start is chosen with equal chances",
        "pool.rs",
        "draws.index(&self.densities)",
        "draws.index(&self.densities.iter().map(|d| f64::from(u8::from(*d > 0.0))).collect::<Vec<_>>())",
        "unbiased::expected_values_are_unbiased",
    ),
    fault(
        "dark samples are left out of the normaliser",
        "pool.rs",
        "            self.normaliser.push(density);\n",
        "            if density > 0.0 {\n                self.normaliser.push(density);\n            }\n",
        "unbiased::expected_values_are_unbiased lib:pool::tests::defects_are_counted_and_never_chosen",
    ),
    fault(
        "defective samples can be chosen",
        "pool.rs",
        "if sound { density } else { 0.0 }",
        "if sound { density } else { 1.0 }",
        "lib:pool::tests::defects_are_counted_and_never_chosen",
    ),
    fault(
        "a start is not checked",
        "pool.rs",
        "if found.to_bits() != self.density.to_bits() {",
        "if found.is_nan() {",
        "chain::a_start_is_rebuilt_to_the_bit_or_refused chain::a_target_that_asks_twice_is_refused",
    ),
];

/// Statistics, means, draws, generators.
pub(crate) const SUMS: &[Fault] = &[
    fault(
        "expected acceptance counts certain ones",
        "statistics.rs",
        "self.expected += acceptance;",
        "self.expected += acceptance.floor();",
        "unbiased::statistics_are_right_in_the_mean",
    ),
    fault(
        "defects are left out of the normaliser",
        "statistics.rs",
        "        if proposal.independent {\n            let densities",
        "        if proposal.independent && densities.is_some() {\n            let densities",
        "chain::defects_never_enter",
    ),
    fault(
        "the longest of two stays is their sum",
        "statistics.rs",
        "self.longest_stay.max(other.longest_stay)",
        "self.longest_stay + other.longest_stay",
        "chain::merged_statistics_are_sums",
    ),
    fault(
        "merged means forget their distance",
        "mean.rs",
        "self.squares += other.squares + delta * delta * (n * m / (n + m));",
        "self.squares += other.squares;",
        "lib:mean::tests::merging_is_taking_both",
    ),
    fault(
        "an index forgets the weights before it",
        "draws.rs",
        "            rest -= weight;\n",
        "",
        "lib:draws::tests::indices_follow_their_weights",
    ),
    fault(
        "samples share the ladder's generator",
        "generator.rs",
        "absorb(LANES, [SAMPLE, seed, ladder])",
        "absorb(LANES, [LADDER, seed, ladder])",
        "lib:generator::tests::values_are_pinned",
    ),
];
