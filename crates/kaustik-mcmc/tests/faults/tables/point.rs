//! The lazy point and how one coordinate moves.

use super::fault;
use crate::Fault;

/// The lazy point: undo, debts, stamps.
pub(crate) const POINT: &[Fault] = &[
    fault(
        "pushed before the coordinate is caught up",
        "proposal.rs",
        r"        if !clock.large {
            // Before the push: the caught-up value belongs to the CURRENT state and must
            // survive a rejection (Kelemen sec. 6).
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
        "        streams[stream as usize][index as usize] = old;",
        "        let slot = &mut streams[stream as usize][index as usize];\n        *slot = Coordinate { seen: slot.seen, ..old };",
        "lazy::lazy_is_eager_with_sleepers_of_several_ages",
    ),
    fault(
        "the first coordinate is not rolled back",
        "point/mod.rs",
        "for &Undo { stream, index, old } in undo {",
        "for &Undo { stream, index, old } in undo.iter().skip(1) {",
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
        "(clock.time - 1).saturating_sub(coordinate.modify)",
        "(clock.time - 2).saturating_sub(coordinate.modify)",
        "lazy::lazy_is_eager_with_sleepers_of_several_ages",
    ),
    fault(
        "sleepers are drawn anew",
        "point/mod.rs",
        "(owed <= mutation.mixed_after_at(stream, index)).then_some(owed)",
        "(owed == 0).then_some(owed)",
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
pub(crate) const MUTATION: &[Fault] = &[
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
