//! The testing kit itself.

use super::fault;
use crate::Fault;

/// The testing kit itself.
pub(crate) const KIT: &[Fault] = &[
    fault(
        "kit: a coin's tail is certain",
        "testing/enumerator.rs",
        "{ p } else { 1.0 - p }",
        "{ p } else { 1.0 }",
        "lib:testing::enumerator::tests::probabilities_sum_to_one_and_impossible_branches_are_not_taken",
    ),
    fault(
        "kit: imbalance has one direction",
        "testing/matrix.rs",
        "(there - back).abs()",
        "(there - back).max(0.0)",
        "kit::a_slip_of_two_percent_is_named",
    ),
    fault(
        "kit: drift is not seen",
        "testing/matrix.rs",
        "(after - pi).abs()",
        "(after - pi)",
        "kit::a_slip_of_two_percent_is_named",
    ),
    fault(
        "kit: one channel of deposits is looked at",
        "testing/asserts.rs",
        "for channel in 0..C {",
        "for channel in 0..C.min(1) {",
        "kit::deposits_are_exact_in_every_channel_or_named",
    ),
    fault(
        "kit: all coordinates pass for read",
        "testing/grid.rs",
        ".seen = -1; // never",
        ".seen += 0; // never",
        "stationarity::a_settled_change_of_mutation_keeps_the_target",
    ),
    fault(
        "kit: ties go to the lowest rank",
        "testing/rank.rs",
        "rng.index(&even[..=ties[h]])",
        "0 * rng.index(&even[..=ties[h]])",
        "kit::ranks_with_ties_are_uniform",
    ),
    fault(
        "kit: the exact draw is always first",
        "testing/rank.rs",
        "let middle = rng.index(&even);",
        "let middle = 0 * rng.index(&even);",
        "kit::p_values_of_a_correct_kernel_are_uniform",
    ),
    fault(
        "kit: pairs are not weighted",
        "testing/paired.rs",
        "weight * (after[h] - before[h])",
        "(after[h] - before[h])",
        "kit::missing_factors_of_a_path_kernel_are_found",
    ),
    fault(
        "kit: standing still is well",
        "testing/paired.rs",
        "return 0.0;",
        "return 1.0;",
        "kit::nothing_moved_is_a_failure",
    ),
    fault(
        "kit: a degree of freedom too many",
        "testing/chance.rs",
        "(degrees / 2.0, x / 2.0)",
        "((degrees + 1.0) / 2.0, x / 2.0)",
        "lib:testing::chance::tests::tails_agree_with_closed_forms",
    ),
    fault(
        "kit: twice the false alarms",
        "testing/chance.rs",
        "p.is_nan() || p <= reject",
        "p.is_nan() || p <= 2.0 * reject",
        "lib:testing::chance::tests::a_sequence_fails_as_rarely_as_it_says",
    ),
    fault(
        "kit: random steps are skewed",
        "testing/strategies.rs",
        "(-reach, weight / 2.0)",
        "(-reach, weight / 2.1)",
        "lib:testing::strategies::tests::mutations_are_symmetric_and_skewed_ones_are_not",
    ),
];
