use super::*;
use crate::{Draws, Mean, generator};

/// Independent visits of a stone from weights 1 with ratio 2 x^2, and one from there with
/// 0.6 x: batch means must agree with what independent samples give.
fn visits(index: u64, sweeps: u64) -> SteppingStone<3> {
    let mut rng = generator(31, index);
    let mut stone = SteppingStone::line();
    for _ in 0..sweeps {
        let x = rng.uniform();
        for level in [0, 1] {
            stone.record(Visit {
                level,
                value: &(),
                densities: &[0.5, x * x, 0.6 * x * x * x],
                weight: 1.0,
                independent: 0.0,
            });
        }
        stone.end_sweep();
    }
    stone
}

#[test]
fn errors_are_those_of_repeated_runs() {
    // ratio 1 is 2 E x^2 = 2/3, ratio 2 is 0.6 E x = 0.3: positively correlated
    let (mut value, mut error) = ([Mean::new(); 2], [Mean::new(); 2]);
    for index in 0..800 {
        let estimates = *visits(index, 500).normalisers(3.0).estimates();
        for k in [0, 1] {
            value[k].push(estimates[k + 1].value);
            error[k].push(estimates[k + 1].standard_error);
        }
    }
    for (k, exact) in [(0, 2.0), (1, 0.6)] {
        assert!((value[k].mean() / exact - 1.0).abs() < 0.01, "{value:?}");
        let spread = value[k].variance().sqrt();
        let ratio = error[k].mean() / spread;
        assert!((ratio - 1.0).abs() < 0.08, "level {}: {ratio}", k + 1);
    }
}

#[test]
fn merging_is_one_long_run() {
    let mut pooled = visits(1, 700);
    pooled.merge(&visits(2, 1300));
    let (sum, moments) = (pooled.normalisers(1.0), pooled.moments().sum);
    assert!((moments.weight[1] - 2000.0).abs() < 1e-9);
    let single = |index, sweeps| visits(index, sweeps).moments().sum.ratio[2];
    assert!((moments.ratio[2] - single(1, 700) - single(2, 1300)).abs() < 1e-9);
    // an error of 2000 sweeps, not of 700
    let (short, long) = (
        visits(1, 700).normalisers(1.0),
        visits(3, 2000).normalisers(1.0),
    );
    let error = |n: &RunningNormalisers<3>| n.estimates()[2].relative_error();
    assert!((error(&sum) / error(&long) - 1.0).abs() < 0.35);
    assert!(error(&short) / error(&sum) > 1.2);
}

/// Densities so small or so large that their squares are none: nothing is known of the error, and not that
/// there is none.
#[test]
fn an_error_that_cannot_be_computed_is_not_zero() {
    for scale in [1e-170, 1e170] {
        let mut rng = generator(33, 0);
        let mut stone = SteppingStone::<2>::line();
        for _ in 0..200 {
            stone.record(Visit {
                level: 0,
                value: &(),
                densities: &[1.0, scale * rng.uniform()],
                weight: 1.0,
                independent: 0.0,
            });
            stone.end_sweep();
        }
        let estimate = stone.normalisers(1.0).estimates()[1];
        assert!((estimate.value / scale - 0.5).abs() < 0.1, "{estimate:?}");
        assert!(estimate.standard_error.is_infinite(), "{estimate:?}");
    }
}

/// Ladders that each stay where they are: batches in time see no spread at all, ladders do.
#[test]
fn ladders_as_batches_see_what_batches_in_time_do_not() {
    let mut rng = generator(32, 0);
    let (mut in_time, mut as_one) = (SteppingStone::<2>::line(), SteppingStone::line());
    for _ in 0..400 {
        let x = rng.uniform();
        let mut ladder = SteppingStone::line();
        for _ in 0..100 {
            ladder.record(Visit {
                level: 0,
                value: &(),
                densities: &[1.0, x],
                weight: 1.0,
                independent: 0.0,
            });
            ladder.end_sweep();
        }
        in_time.merge(&ladder);
        as_one.merge_as_one(&ladder);
    }
    let error = |stone: &SteppingStone<2>| stone.normalisers(1.0).estimates()[1].standard_error;
    // 400 uniform numbers, of variance 1/12
    let exact = (1.0_f64 / 12.0 / 400.0).sqrt();
    assert!((error(&as_one) / exact - 1.0).abs() < 0.1);
    assert!(
        error(&in_time) < 0.3 * exact,
        "a hundredth of the batches would do"
    );
    let value = |stone: &SteppingStone<2>| stone.normalisers(1.0).values()[1];
    assert!((value(&in_time) - value(&as_one)).abs() < 1e-12);
}

#[test]
fn what_was_never_met_is_unknown() {
    let empty = SteppingStone::<3>::line().normalisers(2.0);
    let [base, first, second] = *empty.estimates();
    assert_eq!((base, first.value.to_bits()), (Estimate::exact(2.0), 0));
    assert!(first.standard_error.is_infinite() && second.standard_error.is_infinite());
}

#[test]
fn levels_may_stand_on_any_level_before() {
    let mut stone = SteppingStone::<3>::on([0, 0, 0]);
    let densities = &[2.0, 1.0, 0.5];
    stone.record(Visit {
        level: 0,
        value: &(),
        densities,
        weight: 3.0,
        independent: 0.0,
    });
    let values = stone.normalisers(1.0).values();
    assert!((values[1] - 0.5).abs() < 1e-15 && (values[2] - 0.25).abs() < 1e-15);
}

#[test]
fn a_ratio_that_is_not_finite_is_counted_and_left_out() {
    let mut stone = SteppingStone::<2>::line();
    stone.record(Visit {
        level: 0,
        value: &(),
        densities: &[5e-324, 1e10],
        weight: 1.0,
        independent: 0.0,
    });
    assert_eq!(stone.defects(), 1);
    assert!(stone.normalisers(1.0).values()[1] <= 0.0);
}
