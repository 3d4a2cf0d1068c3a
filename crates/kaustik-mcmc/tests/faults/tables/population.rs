//! Populations that climb levels.

use super::fault;
use crate::Fault;

/// Weights, resampling, moves, errors.
pub(crate) const POPULATION: &[Fault] = &[
    fault(
        "systematic: the offset is not narrowed",
        "resample.rs",
        "            high = part;\n            true",
        "            true",
        "lib:resample::tests::expected_copies_are_proportional_to_weights",
    ),
    fault(
        "systematic: odds upside down",
        "resample.rs",
        "&[part - low, high - part]",
        "&[high - part, part - low]",
        "lib:resample::tests::expected_copies_are_proportional_to_weights lib:population::tests::normalisers_are_unbiased",
    ),
    fault(
        "multinomial: the wrong half",
        "resample.rs",
        "sum(high) - sum(middle)]",
        "sum(high) - sum(low)]",
        "lib:resample::tests::multinomial_choices_are_independent",
    ),
    fault(
        "annealing: the largest weight is lost",
        "population.rs",
        "largest * (sum / count)",
        "sum / count",
        "lib:population::tests::normalisers_are_unbiased lib:population::tests::normalisers_are_unbiased_whatever_the_levels",
    ),
    fault(
        "annealing: weights forget where they come from",
        "population.rs",
        "here.map_or(1.0, |here| particle.densities[here])",
        "here.map_or(1.0, |_| 1.0)",
        "lib:population::tests::normalisers_are_unbiased lib:population::tests::normalisers_are_unbiased_whatever_the_levels",
    ),
    fault(
        "annealing: nobody is resampled",
        "population.rs",
        "        if resampled {\n            self.resample(draws);",
        "        if false {\n            self.resample(draws);",
        "lib:population::tests::normalisers_are_unbiased lib:population::tests::starts_and_visits_weighted_by_their_normaliser_are_unbiased",
    ),
    fault(
        "annealing: moves depend on weights",
        "anneal.rs",
        "let moves = if level == 0 { 0 }",
        "let moves = if !stage.resampled { 0 }",
        "lib:population::tests::starts_and_visits_weighted_by_their_normaliser_are_unbiased",
    ),
    fault(
        "annealing: particles stay at the old level",
        "population.rs",
        "particle.enter(level, kernel, draws);",
        "particle.enter(self.level.unwrap_or(level), kernel, draws);",
        "lib:population::tests::starts_and_visits_weighted_by_their_normaliser_are_unbiased",
    ),
    fault(
        "annealing: founders are not copied",
        "population.rs",
        "            self.founders[dead] = self.founders[parent];\n",
        "",
        "lib:population::tests::the_squared_error_is_an_unbiased_variance",
    ),
    fault(
        "annealing: no correction for choices",
        "population.rs",
        "self.correction *= count as f64 / (count as f64 - 1.0);",
        "",
        "lib:population::tests::the_squared_error_is_an_unbiased_variance",
    ),
    fault(
        "annealing: the start is the best",
        "population.rs",
        "let index = descend(self.particles.len(), |i| i as f64, draws);",
        "let density = |i: &usize| self.particles[*i].density();\n        let index = (0..self.particles.len()).max_by(|a, b| density(a).total_cmp(&density(b))).unwrap_or(0);",
        "lib:population::tests::starts_and_visits_weighted_by_their_normaliser_are_unbiased",
    ),
];
