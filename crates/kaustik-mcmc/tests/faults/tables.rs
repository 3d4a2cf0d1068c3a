//! The faults, by what they break. A new one is one more entry: see [`Fault`] for what its
//! fields mean. A new table is one more constant and its name in [`TABLES`].

use crate::Fault;

/// Short for an entry.
const fn fault(
    name: &'static str,
    file: &'static str,
    find: &'static str,
    replace: &'static str,
    caught_by: &'static str,
) -> Fault {
    Fault {
        name,
        file,
        find,
        replace,
        caught_by,
    }
}

/// All of them.
pub(crate) const TABLES: &[&[Fault]] =
    &[DECISION, CHAIN, KERNEL, POINT, MUTATION, START, SUMS, KIT];

// Each entry: name, file, what stands there, what shall, who finds it.

/// The acceptance probability.
const DECISION: &[Fault] = &[
    fault(
        "acceptance upside down",
        "decide.rs",
        "(ratio * (proposed / current)).min(1.0)",
        "(ratio * (current / proposed)).min(1.0)",
        "stationarity::point_kernel_is_reversible",
    ),
    fault(
        "acceptance too large by 2 %",
        "decide.rs",
        "(ratio * (proposed / current)).min(1.0)",
        "(1.02 * ratio * (proposed / current)).min(1.0)",
        "stationarity::point_kernel_is_reversible",
    ),
    fault(
        "density ratio to the power 1.02",
        "decide.rs",
        "(ratio * (proposed / current)).min(1.0)",
        "(ratio * libm::pow(proposed / current, 1.02)).min(1.0)",
        "stationarity::point_kernel_is_reversible",
    ),
    fault(
        "ratio of proposals left out",
        "decide.rs",
        "(ratio * (proposed / current)).min(1.0)",
        "(proposed / current).min(1.0)",
        "exact::symmetric_and_skewed_kernels_keep_the_target",
    ),
    fault(
        "ratio of proposals upside down",
        "decide.rs",
        "(ratio * (proposed / current)).min(1.0)",
        "(proposed / current / ratio).min(1.0)",
        "exact::symmetric_and_skewed_kernels_keep_the_target",
    ),
    fault(
        "defective densities pass",
        "decide.rs",
        "x.is_finite() && x >= 0.0",
        "!x.is_nan()",
        "lib:decide::tests::follows_metropolis_and_hastings",
    ),
    fault(
        "a dark start is never left",
        "decide.rs",
        "return 1.0;",
        "return 0.0;",
        "chain::a_dark_start_is_left_and_not_reported",
    ),
];

/// The chain: decisions carried out, visits reported.
const CHAIN: &[Fault] = &[
    fault(
        "visits: a and 1 - a exchanged",
        "metropolis.rs",
        "self.pending.weight += 1.0 - a;",
        "self.pending.weight += a;",
        "unbiased::expected_values_are_unbiased",
    ),
    fault(
        "visits: proposals count 1 - a",
        "metropolis.rs",
        "            weight: a,\n",
        "            weight: 1.0 - a,\n",
        "unbiased::expected_values_are_unbiased",
    ),
    fault(
        "visits: accepted states lose their own a",
        "metropolis.rs",
        "self.pending = visit;",
        "self.pending = Pending { weight: 0.0, ..visit };",
        "unbiased::expected_values_are_unbiased",
    ),
    fault(
        "visits: no flush on acceptance",
        "metropolis.rs",
        "            self.flush(recorder);\n            std::mem::swap",
        "            std::mem::swap",
        "unbiased::expected_values_are_unbiased chain::weights_sum_to_the_steps_and_independent_proposals_come_once",
    ),
    fault(
        "visits: flushed after the values are exchanged",
        "metropolis.rs",
        "            self.flush(recorder);\n            std::mem::swap(&mut self.value, &mut self.proposed);",
        "            std::mem::swap(&mut self.value, &mut self.proposed);\n            self.flush(recorder);",
        "unbiased::expected_values_are_unbiased",
    ),
    fault(
        "visits: flushed twice what was pending",
        "metropolis.rs",
        "let pending = std::mem::take(&mut self.pending);",
        "let pending = self.pending;",
        "unbiased::expected_values_are_unbiased",
    ),
    fault(
        "visits: rejected proposals are not reported",
        "metropolis.rs",
        "visit.report(self.level, &self.proposed, densities, recorder);",
        "let _ = (visit, densities);",
        "unbiased::expected_values_are_unbiased",
    ),
    fault(
        "visits: time in the dark counts",
        "metropolis.rs",
        "if weight > 0.0 || (self.independent > 0.0 && !dark)",
        "if self.weight > 0.0 || (self.independent > 0.0 && !dark)",
        "chain::a_dark_start_is_left_and_not_reported",
    ),
    fault(
        "independent proposals count only if accepted",
        "metropolis.rs",
        "            independent: f64::from(u8::from(proposal.independent)),\n        };",
        "            independent: f64::from(u8::from(proposal.independent && accepted)),\n        };",
        "unbiased::independent_proposals_are_unbiased unbiased::the_split_form_is_unbiased_for_every_b0",
    ),
    fault(
        "densities of the old state are kept",
        "metropolis.rs",
        "            self.densities = densities;\n            self.pending",
        "            self.pending",
        "stationarity::a_scan_keeps_the_target",
    ),
    fault(
        "values are not exchanged",
        "metropolis.rs",
        "            std::mem::swap(&mut self.value, &mut self.proposed);\n",
        "",
        "unbiased::expected_values_are_unbiased roll_back::a_rebuilt_state_has_its_old_value",
    ),
    fault(
        "the kernel is not told of acceptance",
        "metropolis.rs",
        "            kernel.accept_move(&mut self.state, &decided.proposal);\n",
        "",
        "roll_back::a_rebuilt_state_has_its_old_value",
    ),
    fault(
        "the kernel is not told of rejection",
        "metropolis.rs",
        "            kernel.reject_move(&mut self.state, &decided.proposal);\n",
        "",
        "exact::symmetric_and_skewed_kernels_keep_the_target",
    ),
];

/// The point kernel.
const KERNEL: &[Fault] = &[
    fault(
        "large steps are 2 % too frequent",
        "kernel.rs",
        "draws.bernoulli(self.large)",
        "draws.bernoulli(self.large * 1.02)",
        "unbiased::independent_proposals_are_unbiased unbiased::the_split_form_is_unbiased_for_every_b0",
    ),
    fault(
        "small steps pass for independent",
        "kernel.rs",
        "if large { Move::large() } else { Move::small() }",
        "{ let _ = large; Move::large() }",
        "unbiased::independent_proposals_are_unbiased",
    ),
    fault(
        "rejection leaves the point moved",
        "kernel.rs",
        "    fn reject(&self, point: &mut Point<M>) {\n        point.roll_back();",
        "    fn reject(&self, point: &mut Point<M>) {\n        point.undo.clear();",
        "stationarity::point_kernel_is_reversible",
    ),
];

/// The lazy point: undo, debts, stamps.
const POINT: &[Fault] = &[
    fault(
        "pushed before the coordinate is caught up",
        "proposal.rs",
        r"        if !clock.large {
            // Before the push: the caught-up value belongs to the CURRENT state and must
            // survive a rejection (spec 2.1).
            Point::bring_up(coordinate, (stream, index), clock, mutation, self.draws);
        }
        let old = *coordinate;
        undo.push(Undo { stream, index, old });",
        r"        undo.push(Undo { stream, index, old: *coordinate });
        if !clock.large {
            Point::bring_up(coordinate, (stream, index), clock, mutation, self.draws);
        }
        let old = *coordinate;",
        "lazy::lazy_is_eager_with_sleepers_of_several_ages",
    ),
    fault(
        "asked twice, moved twice",
        "proposal.rs",
        "if coordinate.modify == clock.time {",
        "if coordinate.modify == clock.time && clock.large {",
        "roll_back::every_way_to_reject_restores",
    ),
    fault(
        "a proposal does not say that it read",
        "proposal.rs",
        "            seen: clock.time,\n",
        "            seen: old.seen,\n",
        "lazy::lazy_is_eager_with_sleepers_of_several_ages roll_back::refresh_keeps_what_was_seen",
    ),
    fault(
        "small steps draw anew",
        "proposal.rs",
        "mutation.mutate_at(stream, index, old.value, self.draws)",
        "{ let _ = &mutation; self.draws.uniform() }",
        "lazy::lazy_is_eager_with_sleepers_of_several_ages",
    ),
    fault(
        "large steps mutate",
        "proposal.rs",
        "            value: if clock.large {\n                self.draws.uniform()",
        "            value: if clock.large {\n                mutation.mutate(old.value, self.draws)",
        "lazy::lazy_is_eager_with_sleepers_of_several_ages",
    ),
    fault(
        "no debt paid at a change of mutation",
        "point/mod.rs",
        "        self.settle(draws);\n        self.mutation = mutation;",
        "        let _ = draws;\n        self.mutation = mutation;",
        "lazy::lazy_is_eager_with_sleepers_of_several_ages stationarity::a_settled_change_of_mutation_keeps_the_target",
    ),
    fault(
        "no debt paid at an exchange",
        "point/mod.rs",
        "        self.settle(draws);\n        other.settle(draws);\n",
        "        let _ = draws;\n",
        "lazy::exchanged_lazy_points_are_exchanged_eager_ones exact::exchanged_points_carry_no_debt",
    ),
    fault(
        "one of two debts paid at an exchange",
        "point/mod.rs",
        "        other.settle(draws);\n",
        "",
        "lazy::exchanged_lazy_points_are_exchanged_eager_ones exact::exchanged_points_carry_no_debt",
    ),
    fault(
        "clocks stay at an exchange",
        "point/mod.rs",
        "        std::mem::swap(&mut self.clock, &mut other.clock);\n",
        "",
        "lazy::exchanged_lazy_points_are_exchanged_eager_ones",
    ),
    fault(
        "mutations go along at an exchange",
        "point/mod.rs",
        "        std::mem::swap(&mut self.clock, &mut other.clock);\n",
        "        std::mem::swap(&mut self.clock, &mut other.clock);\n        std::mem::swap(&mut self.mutation, &mut other.mutation);\n",
        "lazy::exchanged_lazy_points_are_exchanged_eager_ones",
    ),
    fault(
        "refresh by the time of change, not of reading",
        "point/mod.rs",
        "if coordinate.seen != current {",
        "if coordinate.modify != current {",
        "lazy::lazy_is_eager_with_sleepers_of_several_ages",
    ),
    fault(
        "refresh forgets everything",
        "point/mod.rs",
        "if coordinate.seen != current {",
        "if coordinate.seen != current + 1 {",
        "roll_back::refresh_keeps_what_was_seen",
    ),
    fault(
        "catching up passes for reading",
        "point/mod.rs",
        "    coordinate.modify = coordinate.modify.max(now);",
        "    coordinate.modify = coordinate.modify.max(now);\n    coordinate.seen = coordinate.modify;",
        "lazy::lazy_is_eager_with_sleepers_of_several_ages",
    ),
    fault(
        "rejection forgets what was seen",
        "point/mod.rs",
        "self.streams[stream as usize][index as usize] = old;",
        "let slot = &mut self.streams[stream as usize][index as usize];\n            *slot = Coordinate { seen: slot.seen, ..old };",
        "lazy::lazy_is_eager_with_sleepers_of_several_ages",
    ),
    fault(
        "the first coordinate is not rolled back",
        "point/mod.rs",
        "in &self.undo {",
        "in self.undo.iter().skip(1) {",
        "stationarity::point_kernel_is_reversible roll_back::every_way_to_reject_restores",
    ),
    fault(
        "a large step leaves no stamp",
        "point/mod.rs",
        "            self.clock.large_time = self.clock.time;\n",
        "",
        "lazy::lazy_is_eager_with_sleepers_of_several_ages",
    ),
    fault(
        "what a large step read is stale",
        "point/mod.rs",
        "if coordinate.modify < clock.large_time {",
        "if coordinate.modify <= clock.large_time {",
        "roll_back::a_rebuilt_state_has_its_old_value",
    ),
    fault(
        "what was drawn anew is of the next state",
        "point/mod.rs",
        "coordinate.modify = clock.time - 1;",
        "coordinate.modify = clock.time;",
        "lazy::lazy_is_eager_with_sleepers_of_several_ages",
    ),
    fault(
        "one step too few is replayed",
        "point/mod.rs",
        "now.saturating_sub(coordinate.modify)",
        "(now - 1).saturating_sub(coordinate.modify)",
        "lazy::lazy_is_eager_with_sleepers_of_several_ages",
    ),
    fault(
        "sleepers are drawn anew",
        "point/mod.rs",
        "if owed > mutation.mixed_after_at(stream, index) {",
        "if owed > 0 {",
        "lazy::lazy_is_eager_with_sleepers_of_several_ages",
    ),
    fault(
        "what slept since a large step is not settled",
        "point/mod.rs",
        "if coordinate.modify >= clock.large_time {",
        "if coordinate.modify > clock.large_time {",
        "lazy::lazy_is_eager_with_sleepers_of_several_ages lazy::exchanged_lazy_points_are_exchanged_eager_ones",
    ),
];

/// How one coordinate moves.
const MUTATION: &[Fault] = &[
    fault(
        "exponential: steps go up alone",
        "mutation/exponential.rs",
        "wrap(x + sign * step",
        "wrap(x + f64::abs(sign) * step",
        "stationarity::exponential_steps_are_reversible mutation::steps_come_in_pairs_there_and_back",
    ),
    fault(
        "exponential: downward steps shorter by 2 %",
        "mutation/mod.rs",
        "(-1.0, xi - 1.0)",
        "(-0.98, xi - 1.0)",
        "stationarity::exponential_steps_are_reversible mutation::steps_come_in_pairs_there_and_back",
    ),
    fault(
        "exponential: down less often than up",
        "mutation/mod.rs",
        "if xi < 1.0 {",
        "if xi < 1.1 {",
        "stationarity::exponential_steps_are_reversible",
    ),
    fault(
        "exponential: sizes uniform, not their logarithms",
        "mutation/exponential.rs",
        "self.s2 * exp2_below_zero(self.octaves * xi)",
        "self.s2 + (self.s1 - self.s2) * xi + 0.0 * exp2_below_zero(self.octaves)",
        "mutation::steps_have_uniform_logarithm_and_the_stated_mean",
    ),
    fault(
        "exponential: forgets ten times too early",
        "mutation/exponential.rs",
        "(8.0 * mean_square)",
        "(80.0 * mean_square)",
        "mutation::a_long_sleep_forgets",
    ),
    fault(
        "wrap: exactly 1 stays",
        "mutation/mod.rs",
        "let x = if x >= 1.0 {",
        "let x = if x > 1.0 {",
        "mutation::wraps_at_both_ends",
    ),
    fault(
        "wrap: reflected at 0",
        "mutation/mod.rs",
        "x + 1.0\n",
        "-x\n",
        "stationarity::exponential_steps_are_reversible",
    ),
    fault(
        "uniform: off the centre",
        "mutation/uniform.rs",
        "(draws.uniform() - 0.5)",
        "(draws.uniform() - 0.48)",
        "stationarity::uniform_steps_are_reversible",
    ),
];

/// Pools of starts.
const START: &[Fault] = &[
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
        "            pool.normaliser.push(density);\n",
        "            if density > 0.0 {\n                pool.normaliser.push(density);\n            }\n",
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
const SUMS: &[Fault] = &[
    fault(
        "expected acceptance counts certain ones",
        "statistics.rs",
        "kind.expected += a;",
        "kind.expected += a.floor();",
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
        "                rest -= weight;\n",
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

/// The testing kit itself.
const KIT: &[Fault] = &[
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
