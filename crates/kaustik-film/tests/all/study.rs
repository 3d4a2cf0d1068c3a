//! The metrics of studies on cases computed by hand.

use kaustik_film::Image;
use kaustik_film::metrics::{Reference, Spread, difference, matched, measure};

fn gray(value: &[f32]) -> Image {
    let plane = value.to_vec();
    Image::from_rgb(value.len() as u32, 1, [plane.clone(), plane.clone(), plane]).unwrap()
}

fn close(a: f64, b: f64) {
    assert!((a - b).abs() <= 1e-6 * b.abs().max(1e-6), "{a} is not {b}");
}

#[test]
fn brightness_is_matched_before_errors_are_measured() {
    // x = (1, 4), r = (2, 3): x comes to the same sum already.
    let (x, r) = (gray(&[1.0, 4.0]), gray(&[2.0, 3.0]));
    let reference = Reference::exact(&r);
    let plain = measure(&x, &reference).unwrap();
    assert_eq!(matched(&x, &reference).unwrap(), plain);
    // Twice as bright it is the same picture; its plain error is (0 + 25)/2.
    let twice = gray(&[2.0, 8.0]);
    let m = matched(&twice, &reference).unwrap();
    close(m.raw.mse, 1.0);
    close(m.raw.bias, 0.0);
    close(measure(&twice, &reference).unwrap().raw.mse, 12.5);
    // Nothing can be scaled to light, and a pixel that is no number does not count.
    let black = gray(&[0.0, 0.0]);
    close(matched(&black, &reference).unwrap().raw.bias, -1.0);
    let broken = matched(&gray(&[4.0, f32::NAN]), &reference).unwrap();
    assert_eq!(broken.non_finite, 1);
    close(broken.raw.bias, 0.0);
    assert!(matched(&gray(&[1.0]), &reference).is_none());
}

#[test]
fn differences_keep_their_sign() {
    // mean(Y_r) = 2, so the floor is 0.04: (1 - 2)/sqrt(4.04), (4 - 2)/sqrt(4.04).
    let r = gray(&[2.0, 2.0, 2.0]);
    let d = difference(&gray(&[1.0, 4.0, f32::NAN]), &Reference::exact(&r)).unwrap();
    close(f64::from(d[0]), -1.0 / 4.04f64.sqrt());
    close(f64::from(d[1]), 2.0 / 4.04f64.sqrt());
    assert!(d[2].is_nan());
    let black = gray(&[0.0]);
    assert_eq!(
        difference(&black, &Reference::exact(&black)).unwrap(),
        [0.0]
    );
    assert!(difference(&black, &Reference::exact(&r)).is_none());
}

#[test]
fn the_spread_of_two_pixels_is_that_worked_out_by_hand() {
    let mut spread = Spread::new(2, 1);
    assert_eq!(spread.relative_error(), None);
    let mut black = Spread::new(2, 1);
    assert!((0..2).all(|_| black.add(&gray(&[0.0, 0.0]))));
    assert_eq!(black.relative_error(), Some(f64::INFINITY));
    for values in [[1.0, 2.0], [3.0, 2.0], [2.0, 2.0], [2.0, 2.0]] {
        assert!(spread.add(&gray(&values)));
    }
    assert!(!spread.add(&gray(&[1.0])));
    assert_eq!(spread.count(), 4);
    assert_eq!(spread.mean().unwrap(), gray(&[2.0, 2.0]));
    let [a, b] = spread.halves().unwrap();
    assert_eq!((a, b), (gray(&[1.5, 2.0]), gray(&[2.5, 2.0])));
    // First pixel: s^2 = (1 + 1)/3, so s^2/4 = 1/6; second: 0; r^2 + floor = 4.04.
    close(
        spread.relative_error().unwrap(),
        (0.5 / 6.0 / 4.04f64).sqrt(),
    );
}

/// The square of the stated error is what a noisy reference adds to a relative MSE.
#[test]
fn the_stated_error_is_the_reference_s_own() {
    let truth = gray(&[1.0; 4000]);
    let mut state = 1u64;
    let mut noise = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (state >> 40) as f32 / (1 << 24) as f32 - 0.5
    };
    let mut spread = Spread::new(4000, 1);
    for _ in 0..16 {
        let values: Vec<f32> = (0..4000).map(|_| 1.0 + noise()).collect();
        spread.add(&gray(&values));
    }
    let mean = spread.mean().unwrap();
    let added = measure(&truth, &Reference::exact(&mean))
        .unwrap()
        .raw
        .relative_mse;
    let stated = spread.relative_error().unwrap().powi(2);
    assert!((stated / added - 1.0).abs() < 0.1, "{stated} for {added}");
    // Halves take it away again.
    let [a, b] = spread.halves().unwrap();
    let left = measure(&truth, &Reference::halves(&a, &b).unwrap())
        .unwrap()
        .raw
        .relative_mse;
    assert!(left.abs() < 0.15 * added, "{left} of {added}");
}
