//! Exchanges between levels, and what ladders know of normalisers.

use super::fault;
use crate::Fault;

/// Exchanges of states.
pub(crate) const EXCHANGE: &[Fault] = &[
    fault(
        "exchange: exponent 2 % too large",
        "decide.rs",
        "let (current, proposed) = (own[0] * own[1], crossed[0] * crossed[1]);",
        "let (current, proposed) = (own[0] * own[1], libm::pow(crossed[0] * crossed[1], 1.02));",
        "lib:ladder::tests::sweeps_keep_the_product_of_all_targets",
    ),
    fault(
        "exchange: max for min, as printed",
        "decide.rs",
        "            acceptance(current, proposed, 1.0)\n        } else",
        "            acceptance(current, proposed, 1.0).max(1.0)\n        } else",
        "lib:ladder::tests::sweeps_keep_the_product_of_all_targets lib:ladder::tests::elementary_exchanges_are_in_detailed_balance",
    ),
    fault(
        "exchange: products over- and underflow",
        "decide.rs",
        "    extreme_acceptance(own, crossed)\n}",
        "    acceptance(current, proposed, 1.0)\n}",
        "lib:decide::tests::exchanges_follow_the_product_of_quotients",
    ),
    fault(
        "exchange: densities of the wrong levels",
        "ladder.rs",
        "[density(a, b), density(b, a)],",
        "[density(b, b), density(a, a)],",
        "lib:ladder::tests::elementary_exchanges_are_in_detailed_balance",
    ),
    fault(
        "exchange: the second state is not flushed",
        "metropolis.rs",
        "        other.flush(recorder);\n        kernel.exchange",
        "        kernel.exchange",
        "lib:ladder::tests::every_level_is_visited_by_its_own_law",
    ),
    fault(
        "exchange: what was gathered goes along",
        "metropolis.rs",
        "        self.flush(recorder); // told at its own level\n        other.flush(recorder);\n",
        "        std::mem::swap(&mut self.pending, &mut other.pending);\n",
        "lib:ladder::tests::every_level_is_visited_by_its_own_law",
    ),
    fault(
        "exchange: densities stay",
        "metropolis.rs",
        "        std::mem::swap(&mut self.densities, &mut other.densities);\n",
        "",
        "lib:ladder::tests::sweeps_keep_the_product_of_all_targets",
    ),
    fault(
        "exchange: kernels swap, values stay",
        "metropolis.rs",
        "        std::mem::swap(&mut self.value, &mut other.value);\n",
        "",
        "lib:ladder::tests::permutations_are_drawn_from_their_exact_law",
    ),
    fault(
        "exchange: permutation transposed",
        "ladder.rs",
        "self.replicas[at].densities[level]);\n        let index",
        "self.replicas[level].densities[at]);\n        let index",
        "lib:ladder::tests::elementary_exchanges_are_in_detailed_balance lib:ladder::tests::permutations_are_drawn_from_their_exact_law",
    ),
    fault(
        "exchange: permutation weights forget their powers",
        "permutation.rs",
        "*weight = libm::ldexp(mantissa, exponent - top);",
        "*weight = mantissa;",
        "lib:permutation::tests::weights_are_products_at_any_scale",
    ),
    fault(
        "exchange: turns do not alternate",
        "ladder.rs",
        "self.turn % matchings as u64",
        "0 % matchings as u64",
        "lib:ladder::tests::schedules_try_the_pairs_they_say lib:ladder::tests::the_round_trip_rate_is_the_ideal_one",
    ),
    fault(
        "exchange: the full sweep is one pair",
        "ladder.rs",
        "Schedule::Full => 0..pairs,",
        "Schedule::Full => 0..1,",
        "lib:ladder::tests::schedules_try_the_pairs_they_say",
    ),
    fault(
        "exchange: matchings share a level",
        "swap_graph.rs",
        "level != a && level != b",
        "level != a",
        "lib:swap_graph::tests::matchings_share_no_level",
    ),
    fault(
        "exchange: any end begins a trip",
        "index_process.rs",
        "End::Top(true));\n",
        "End::Top(restart)) || matches!(*bottom, Some(End::Top(_)));\n",
        "lib:index_process::tests::trips_are_counted_from_the_bottom",
    ),
    fault(
        "level kernel: nothing is settled",
        "level_kernel.rs",
        "point.set_mutation(self.mutation.clone(), draws);",
        "let _ = draws;\n        point.mutation = self.mutation.clone();",
        "lib:population::tests::lazy_particles_that_change_their_steps_are_unbiased",
    ),
    fault(
        "point kernel: nothing is settled on entry",
        "kernel.rs",
        "        point.settle(draws);\n",
        "        let _ = (point, draws);\n",
        "exact::entering_pays_the_debt",
    ),
];

/// Rough and running normalisers.
pub(crate) const STONES: &[Fault] = &[
    fault(
        "stone: ratio not over the density",
        "stepping_stone.rs",
        "visit.weight / visit.density()",
        "visit.weight",
        "lib:ladder::tests::a_stone_expects_the_ratio_of_normalisers",
    ),
    fault(
        "stone: covariances of levels left out",
        "stepping_stone.rs",
        ".map(|(k, l)| moments.covariance(k, l))",
        ".map(|(k, l)| if k == l { moments.covariance(k, l) } else { 0.0 })",
        "lib:stepping_stone::tests::errors_are_those_of_repeated_runs",
    ),
    fault(
        "stone: a batch is lost when lengths double",
        "stepping_stone.rs",
        "self.closed.truncate(BATCHES / 2);",
        "self.closed.truncate(BATCHES / 2 - 1);",
        "lib:stepping_stone::tests::merging_is_one_long_run",
    ),
    fault(
        "stone: infinite ratios enter",
        "stepping_stone.rs",
        "if ratio.is_finite() {",
        "if !ratio.is_nan() {",
        "lib:stepping_stone::tests::a_ratio_that_is_not_finite_is_counted_and_left_out",
    ),
    fault(
        "rough: extinct populations are merged away",
        "normalisers.rs",
        "mine.value = p * mine.value + q * theirs.value;",
        "mine.value = if theirs.value > 0.0 { p * mine.value + q * theirs.value } else { mine.value };",
        "lib:normalisers::tests::rough_ones_average_by_particles_zeros_included",
    ),
    fault(
        "running: scales upside down",
        "normalisers.rs",
        "                running[k] / rough[k]\n",
        "                rough[k] / running[k]\n",
        "lib:normalisers::tests::running_ones_scale_and_compare",
    ),
];
