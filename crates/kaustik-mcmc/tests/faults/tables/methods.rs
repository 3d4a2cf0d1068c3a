//! Several kernels in one, second tries, redistribution.

use super::fault;
use crate::Fault;

/// Mixtures of kernels.
pub(crate) const MIXTURE: &[Fault] = &[
    fault(
        "mixture: the choice is not corrected for",
        "mixture.rs",
        "Some(sum) if sum > 0.0 => back[component] / sum / chance,",
        "Some(sum) if sum > 0.0 => 1.0 + 0.0 * (back[component] / sum / chance),",
        "lib:mixture::tests::keeps_the_target_whatever_the_choice_depends_on",
    ),
    fault(
        "mixture: chances are not normalised",
        "mixture.rs",
        "back[component] / sum / chance,",
        "back[component] / (there[component] + 0.0 * sum * chance),",
        "lib:mixture::tests::keeps_the_target_whatever_the_choice_depends_on",
    ),
    fault(
        "mixture: another component is told of rejection",
        "mixture.rs",
        "            self.kernels.reject(component, state, &own);",
        "            self.kernels.reject((component + 1) % N, state, &own);",
        "lib:mixture::tests::keeps_the_target_whatever_the_choice_depends_on",
    ),
    fault(
        "mixture: entries reach the first component alone",
        "mixture.rs",
        "for component in 0..N {",
        "for component in 0..N.min(0) {",
        "lib:mixture::tests::exchanges_and_entries_reach_the_components",
    ),
    fault(
        "mixture: unsound weights pass",
        "mixture.rs",
        "let sound = weights.iter().all(|w| w.is_finite() && *w >= 0.0);",
        "let sound = !weights.is_empty();",
        "lib:mixture::tests::kinds_are_told_apart_and_bad_weights_are_defects",
    ),
];

/// Delayed rejection.
pub(crate) const SECOND: &[Fault] = &[
    fault(
        "second try: the first is forgotten",
        "delayed_rejection.rs",
        "acceptance(current - first, (second - first).max(0.0), ratio)",
        "acceptance(current + 0.0 * first, second, ratio)",
        "lib:delayed_rejection::tests::keeps_the_target_in_detailed_balance",
    ),
    fault(
        "second try: 2 % too bold",
        "delayed_rejection.rs",
        "acceptance(current - first, (second - first).max(0.0), ratio)",
        "acceptance(current - first, (second - first).max(0.0), 1.02 * ratio)",
        "lib:delayed_rejection::tests::keeps_the_target_in_detailed_balance",
    ),
    fault(
        "second try: after any rejection",
        "delayed_rejection.rs",
        "let again = proposal.independent;",
        "let again = true;",
        "lib:delayed_rejection::tests::keeps_the_target_in_detailed_balance",
    ),
    fault(
        "second try: the state is given 1 - a twice",
        "delayed_rejection.rs",
        "        if !again {\n            self.pending.weight += 1.0 - first.acceptance;\n        }",
        "        self.pending.weight += 1.0 - first.acceptance;",
        "lib:delayed_rejection::tests::weights_are_expected_visits",
    ),
    fault(
        "second try: its weight is halved by the first",
        "delayed_rejection.rs",
        "        self.pending.weight += 1.0 - second.acceptance;\n        let visit = Pending {\n            weight: second.acceptance,\n            independent: 0.0,",
        "        self.pending.weight += 1.0 - second.acceptance;\n        let visit = Pending {\n            weight: second.acceptance * (1.0 - first),\n            independent: 0.0,",
        "lib:delayed_rejection::tests::weights_are_expected_visits",
    ),
    fault(
        "second try: a large step",
        "delayed_rejection.rs",
        "point.propose(Step::Small, draws)",
        "point.propose(Step::Large, draws)",
        "lib:delayed_rejection::tests::the_second_try_stays_near",
    ),
];

/// Chains that deposit.
pub(crate) const REDISTRIBUTION: &[Fault] = &[
    fault(
        "deposit: 2 % too much on proposals",
        "redistribute/plan.rs",
        "(false, _) => (a * unit, (1.0 - a) * unit),",
        "(false, _) => (1.02 * a * unit, (1.0 - a) * unit),",
        "lib:redistribute::tests::the_mean_deposit_is_any_integrand lib:redistribute::tests::the_mean_deposit_is_the_integrand_in_every_channel",
    ),
    fault(
        "deposit: the start keeps the unit",
        "redistribute/plan.rs",
        "(false, _) => (a * unit, (1.0 - a) * unit),",
        "(false, _) => (a * unit, unit),",
        "lib:redistribute::tests::the_mean_deposit_is_any_integrand",
    ),
    fault(
        "deposit: plain ones fall where the step began",
        "redistribute/plan.rs",
        "            (true, true) => (unit, 0.0),",
        "            (true, true) => (0.0, unit),",
        "lib:redistribute::tests::plain_deposits_fall_where_the_step_ends",
    ),
    fault(
        "deposit: the number of chains is rounded",
        "redistribute/rounding.rs",
        "u32::from(draws.bernoulli(mean - whole))",
        "u32::from(draws.bernoulli((mean - whole).round()))",
        "lib:redistribute::tests::the_mean_deposit_is_any_integrand",
    ),
    fault(
        "deposit: what is left over of chains is lost",
        "redistribute/rounding.rs",
        "*share = sum - whole;",
        "*share = 0.0 * (sum - whole);",
        "lib:redistribute::tests::starts_that_are_rounded_together_have_the_chains_due_to_them",
    ),
    fault(
        "deposit: capped weight is lost",
        "redistribute/plan.rs",
        "(most, weight / (steps * most))",
        "(most, self.unit)",
        "lib:redistribute::tests::the_mean_deposit_is_any_integrand",
    ),
    fault(
        "deposit: a chain begins where the last ended",
        "redistribute.rs",
        "            self.reset(state, value);\n",
        "            if self.current.is_none() {\n                self.reset(state, value);\n            }\n",
        "lib:redistribute::tests::lazy_points_are_redistributed_without_bias",
    ),
    fault(
        "deposit: values are not exchanged",
        "redistribute.rs",
        "                std::mem::swap(value, &mut self.proposed);\n",
        "",
        "lib:redistribute::tests::the_mean_deposit_is_any_integrand",
    ),
    fault(
        "deposit: what is dropped is not said",
        "redistribute.rs",
        "self.statistics.dropped += here;",
        "self.statistics.dropped += 0.0 * here;",
        "lib:redistribute::tests::dropped_weight_is_accounted_for lib:redistribute::tests::impatience_drops_what_stays_too_long",
    ),
];

/// Scouts.
pub(crate) const SCOUT: &[Fault] = &[
    fault(
        "scout: followed from out of the region",
        "scout.rs",
        "region.measure(&self.value) > 0.0 && region.may_hold(&mut self.state.current(draws))",
        "region.measure(&self.value) >= 0.0 || region.may_hold(&mut self.state.current(draws))",
        "lib:scout::tests::scouts_leave_the_target_as_it_is",
    ),
    fault(
        "scout: followed from where no look would see",
        "scout.rs",
        " && region.may_hold(&mut self.state.current(draws))",
        " && (true || region.may_hold(&mut self.state.current(draws)))",
        "lib:scout::tests::a_look_at_a_part_leaves_the_target_as_it_is",
    ),
    fault(
        "scout: followed always",
        "scout.rs",
        "decide(acceptance(self.density(), wanted, 1.0), draws)",
        "decide(acceptance(wanted, wanted, 1.0), draws)",
        "lib:scout::tests::scouts_leave_the_target_as_it_is",
    ),
    fault(
        "scout: what was gathered goes with it",
        "scout.rs",
        "            self.flush(recorder);\n            spare.commit();\n",
        "            spare.commit();\n",
        "lib:scout::tests::scouts_leave_the_target_as_it_is",
    ),
];
