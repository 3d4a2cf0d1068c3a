//! Step sizes that learn, what chains say of themselves, coordinates that differ.

use super::fault;
use crate::Fault;

/// Adaptation of step sizes.
pub(crate) const ADAPTATION: &[Fault] = &[
    fault(
        "adaptation: steps shrink where they should grow",
        "adapt/acceptance.rs",
        "                round.rate() - self.target\n",
        "                self.target - round.rate()\n",
        "lib:adapt::tests::acceptance_comes_to_its_target_from_either_side",
    ),
    fault(
        "adaptation: logarithms shrink where they should grow",
        "adapt/acceptance.rs",
        "(round.rate() + LEAST) / (self.target + LEAST)",
        "(self.target + LEAST) / (round.rate() + LEAST)",
        "lib:adapt::tests::logarithms_of_acceptances_come_to_their_target_soon",
    ),
    fault(
        "adaptation: all rounds count again",
        "adapt/acceptance.rs",
        "        self.seen = *total;\n",
        "",
        "lib:adapt::tests::rounds_take_what_is_new_and_nothing_is_learnt_from_nothing",
    ),
    fault(
        "adaptation: gains do not diminish",
        "adapt/acceptance.rs",
        "libm::pow(self.rounds as f64, self.decay)",
        "libm::pow(1.0, self.decay)",
        "lib:adapt::tests::rounds_take_what_is_new_and_nothing_is_learnt_from_nothing",
    ),
    fault(
        "adaptation: towards the smaller jump",
        "adapt/jump.rs",
        "} else if below > above {",
        "} else if below < above {",
        "lib:adapt::tests::the_search_finds_the_largest_jump",
    ),
    fault(
        "adaptation: diminishes by accepted steps",
        "adapt/diminishing.rs",
        "/ self.rounds as f64",
        "/ total.accepted.max(1) as f64",
        "lib:adapt::tests::diminishing_adaptation_is_hachisuka_and_jensens",
    ),
];

/// Diagnostics.
pub(crate) const DIAGNOSTICS: &[Fault] = &[
    fault(
        "autocorrelation: batch means are not averaged",
        "diagnostics/autocorrelation.rs",
        "mean = 0.5 * (other + mean)",
        "mean = 0.5 * (mean + mean) + 0.0 * other",
        "lib:diagnostics::autocorrelation::tests::the_time_of_an_autoregressive_chain_is_known",
    ),
    fault(
        "autocorrelation: merged chains keep one mean",
        "diagnostics/autocorrelation.rs",
        "for (mine, theirs) in self.levels.iter_mut().zip(&other.levels) {",
        "for (mine, theirs) in self.levels.iter_mut().zip(&other.levels).take(1) {",
        "lib:diagnostics::autocorrelation::tests::merged_chains_have_the_time_of_each",
    ),
    fault(
        "halves: blocks double in number, not in length",
        "diagnostics/halves.rs",
        "        self.length *= 2;\n",
        "",
        "lib:diagnostics::halves::tests::two_halves_of_equal_length_are_nearly_the_whole_series",
    ),
    fault(
        "halves: the middle goes with the second",
        "diagnostics/halves.rs",
        "&self.blocks[full - half..full]",
        "&self.blocks[half..full]",
        "lib:diagnostics::halves::tests::two_halves_of_equal_length_are_nearly_the_whole_series",
    ),
    fault(
        "R-hat: between is within",
        "diagnostics/r_hat.rs",
        "sequences.iter().map(Mean::mean).collect();",
        "sequences.iter().map(Mean::standard_error).collect();",
        "lib:diagnostics::r_hat::tests::r_hat_and_normal_scores_are_those_worked_out_by_hand",
    ),
    fault(
        "jumps: the circle is a line",
        "diagnostics/jumps.rs",
        "d if self.circular => d.min(1.0 - d),",
        "d if self.circular => d,",
        "lib:diagnostics::jumps::tests::distances_are_squared_and_go_round",
    ),
];

/// Stratified pools.
pub(crate) const STRATIFICATION: &[Fault] = &[
    fault(
        "sobol: a plain digital shift",
        "sobol.rs",
        "    x ^= x.wrapping_mul(0x9e6c_63d0_876a_68de);\n    x = x.wrapping_add(first);",
        "    return x ^ second;\n    #[expect(unreachable_code, reason = \"planted\")]\n    {\n        x ^= 1;\n    }\n    x = x.wrapping_add(first);",
        "lib:sobol::tests::scrambling_is_nested_and_uniform",
    ),
    fault(
        "sobol: not nested",
        "sobol.rs",
        "x = x.wrapping_mul((second >> 32) | 1);",
        "x = x.wrapping_mul((second >> 32) | 1).rotate_left(1);",
        "lib:sobol::tests::each_dimension_has_one_number_in_each_interval",
    ),
    fault(
        "stratification: the second plan takes the first dimension",
        "stratified.rs",
        "stored[index] = self.used as u8;",
        "stored[index] = 0;",
        "lib:stratified::tests::means_are_unbiased_and_far_less_noisy",
    ),
    fault(
        "stratification: blocks share a scrambling",
        "sobol.rs",
        "key = mix(key ^ mix(block));",
        "key = mix(key ^ mix(0 * block));",
        "lib:sobol::tests::values_are_pinned",
    ),
];

/// Mutations but Kelemen's.
pub(crate) const COORDINATES: &[Fault] = &[
    fault(
        "per coordinate: debts are paid in the common coin",
        "mutation/per_coordinate.rs",
        "self.at(stream, index).mutate_at(stream, index, x, draws)",
        "self.mutations[0].mutate_at(stream, index, x, draws)",
        "per_coordinate::debts_are_paid_in_a_coordinates_own_coin",
    ),
    fault(
        "per coordinate: forgets as the first does",
        "mutation/per_coordinate.rs",
        "self.at(stream, index).mixed_after_at(stream, index)",
        "self.mutations[0].mixed_after_at(stream, index)",
        "per_coordinate::debts_are_paid_in_a_coordinates_own_coin",
    ),
    fault(
        "normal: half a deviation too wide",
        "mutation/wrapped_normal.rs",
        "sign * self.sigma * upper_quantile",
        "sign * 1.02 * self.sigma * upper_quantile",
        "mutation_laws::a_normal_step_has_its_law",
    ),
    fault(
        "cauchy: squeezed by an angle too large",
        "mutation/wrapped_cauchy.rs",
        "squeeze: libm::tanh(std::f64::consts::PI * scale),",
        "squeeze: libm::tanh(1.02 * std::f64::consts::PI * scale),",
        "mutation_laws::a_cauchy_step_has_its_law",
    ),
    fault(
        "power: exponent 1/m",
        "mutation/power.rs",
        "exponent: 1.0 + 1.0 / size,",
        "exponent: 1.0 / size,",
        "mutation_laws::a_power_step_has_its_law",
    ),
];
