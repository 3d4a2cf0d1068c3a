//! Filter weights: they sum to one, stay in the support, and make every pixel's weight integrate to one.

use kaustik_film::Filter;
use proptest::prelude::*;

/// Any filter with its default radius or any other that it can have.
fn any_filter() -> impl Strategy<Value = Filter> {
    let least = |name| match name {
        "box" => 0.5,
        "mitchell" => 1.5,
        _ => 1.0,
    };
    (0..Filter::names().len(), 0.0..1.0f64).prop_map(move |(row, u)| {
        let name = Filter::names()[row];
        let radius = (u >= 0.3).then(|| least(name) + (u - 0.3) / 0.7 * (8.0 - least(name)));
        Filter::new(name, radius).unwrap()
    })
}

proptest! {
    #[test]
    fn weights_sum_to_one(filter in any_filter(), x in -100.0..100.0f64) {
        for x in [x, x.floor(), x.floor() + 0.5] {
            let taps = filter.taps(x);
            let sum: f64 = taps.weights().iter().sum();
            prop_assert!((sum - 1.0).abs() < 1e-12, "{filter} at {x}: {sum}");
            prop_assert!(taps.weights().iter().all(|w| w.abs() <= 1.2), "{filter} at {x}");
        }
    }

    #[test]
    fn support_is_within_the_radius(filter in any_filter(), x in -100.0..100.0f64) {
        let taps = filter.taps(x);
        for (i, _) in taps.weights().iter().enumerate() {
            let centre = (taps.first() + i as i64) as f64 + 0.5;
            prop_assert!((centre - x).abs() <= filter.radius() + 1e-9);
        }
        let next = (taps.first() + taps.weights().len() as i64) as f64 + 0.5;
        prop_assert!(next - x > filter.radius() - 1e-9);
    }

    #[test]
    fn text_round_trips(filter in any_filter()) {
        prop_assert_eq!(filter.to_string().parse::<Filter>().unwrap(), filter);
    }
}

#[test]
fn a_box_is_the_pixel_that_holds_the_point() {
    for (x, pixel) in [(0.0, 0), (0.999, 0), (1.0, 1), (-0.001, -1), (7.5, 7)] {
        let taps = Filter::BOX.taps(x);
        assert_eq!((taps.first(), taps.weights()), (pixel, &[1.0][..]));
    }
}

#[test]
fn every_pixel_integrates_to_one() {
    for name in Filter::names() {
        let filter = Filter::new(name, None).unwrap();
        let n = 4000;
        let mut sum = 0.0;
        for k in 0..n {
            let x = -10.0 + 20.0 * (k as f64 + 0.5) / n as f64;
            let taps = filter.taps(x);
            let index = -taps.first();
            if (0..taps.weights().len() as i64).contains(&index) {
                sum += taps.weights()[index as usize] * 20.0 / n as f64;
            }
        }
        assert!((sum - 1.0).abs() < 1e-3, "{name}: {sum}");
    }
}

#[test]
fn mitchell_is_the_published_cubic() {
    // B = C = 1/3 at a pixel's centre: 8/9 in the middle, 1/18 beside, and negative further out.
    let taps = Filter::MITCHELL.taps(0.5);
    let expected = [0.0, 1.0 / 18.0, 8.0 / 9.0, 1.0 / 18.0];
    for pixel in -2i64..=1 {
        let index = (pixel - taps.first()) as usize;
        let weight = taps.weights().get(index).copied().unwrap_or(0.0);
        assert!(
            (weight - expected[(pixel + 2) as usize]).abs() < 1e-12,
            "{pixel}: {weight}"
        );
    }
    assert!(
        Filter::MITCHELL
            .taps(0.2)
            .weights()
            .iter()
            .any(|&weight| weight < 0.0)
    );
}

#[test]
fn blackman_harris_is_the_published_window() {
    // in the middle of a pixel: the window at 0 beside that at two thirds of its half width
    let taps = Filter::BLACKMAN_HARRIS.taps(0.5);
    let at = |x: f64| {
        let angle = std::f64::consts::TAU * 0.5 * (x + 1.0);
        0.35875 - 0.48829 * angle.cos() + 0.14128 * (2.0 * angle).cos()
            - 0.01168 * (3.0 * angle).cos()
    };
    assert!((at(0.0) - 1.0).abs() < 1e-12 && (at(1.0) - 6e-5).abs() < 1e-12);
    let sum = at(0.0) + 2.0 * at(2.0 / 3.0);
    let middle = taps.weights()[(-taps.first()) as usize];
    assert!((middle - at(0.0) / sum).abs() < 1e-12, "{middle}");
    assert!(taps.weights().iter().all(|&weight| weight > 0.0));
}

#[test]
fn errors_list_the_names() {
    let message = "lanczos".parse::<Filter>().unwrap_err().to_string();
    for name in Filter::names() {
        assert!(message.contains(name), "{message}");
    }
    for text in ["tent:0.5", "box:9", "box:nan", "gaussian:x", ""] {
        assert!(text.parse::<Filter>().is_err(), "{text}");
    }
}
