//! The decision, the chain that carries it out, the point kernel.

use super::fault;
use crate::Fault;

/// The acceptance probability.
pub(crate) const DECISION: &[Fault] = &[
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
pub(crate) const CHAIN: &[Fault] = &[
    fault(
        "visits: a and 1 - a exchanged",
        "metropolis.rs",
        "self.pending.weight += 1.0 - decided.acceptance;",
        "self.pending.weight += decided.acceptance;",
        "unbiased::expected_values_are_unbiased",
    ),
    fault(
        "visits: proposals count 1 - a",
        "metropolis.rs",
        "            weight: decided.acceptance,\n",
        "            weight: 1.0 - decided.acceptance,\n",
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
pub(crate) const KERNEL: &[Fault] = &[
    fault(
        "large steps are 2 % too frequent",
        "kernel.rs",
        "draws.bernoulli(self.p_large)",
        "draws.bernoulli(self.p_large * 1.02)",
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
