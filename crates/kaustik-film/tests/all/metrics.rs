//! Metrics on cases computed by hand, and the statistics of the half/half formula.

use crate::random::Random;
use kaustik_film::Image;
use kaustik_film::metrics::{
    CompareError, Reference, compare, measure, nsd, nsd_beside, nsd_map, tiles,
};

fn gray(width: u32, height: u32, value: impl FnMut(usize) -> f32) -> Image {
    let plane: Vec<f32> = (0..(width * height) as usize).map(value).collect();
    Image::from_rgb(width, height, [plane.clone(), plane.clone(), plane]).unwrap()
}

fn close(a: f64, b: f64) {
    assert!((a - b).abs() <= 1e-6 * b.abs().max(1e-6), "{a} is not {b}");
}

#[test]
fn errors_of_two_pixels_are_those_worked_out_by_hand() {
    // x = (1, 4), r = (2, 2): mean(r) = 2, so the floor is 0.04.
    let x = gray(2, 1, |i| [1.0, 4.0][i]);
    let r = gray(2, 1, |_| 2.0);
    let m = measure(&x, &Reference::exact(&r)).unwrap();
    close(m.raw.mse, 2.5);
    close(m.raw.rmse, 2.5f64.sqrt());
    close(m.raw.relative_mse, 2.5 / 4.04);
    close(m.raw.bias, 0.25);
    assert_eq!(m.trimmed, m.raw);
    close(m.shares.over_20_percent, 1.0);

    // Halves A = (1, 3), B = (3, 3): r = (2, 3), mean 2.5, floor 0.0625.
    let (a, b) = (gray(2, 1, |i| [1.0, 3.0][i]), gray(2, 1, |_| 3.0));
    let m = measure(&x, &Reference::halves(&a, &b).unwrap()).unwrap();
    close(m.raw.mse, 0.5 * (0.0 * -2.0 + 1.0 * 1.0));
    close(m.raw.relative_mse, 0.5 / 9.0625);
    close(m.raw.bias, 0.0);
}

#[test]
fn xyz_error_is_that_of_relt_25() {
    // Off by one in green alone: the error is the green column of the matrix.
    let zero = vec![0.0f32; 4];
    let x = Image::from_rgb(2, 2, [zero.clone(), vec![1.0; 4], zero.clone()]).unwrap();
    let r = Image::from_rgb(2, 2, [zero.clone(), zero.clone(), zero]).unwrap();
    let m = measure(&x, &Reference::exact(&r)).unwrap();
    let column = kaustik_spectrum::Xyz::from(kaustik_spectrum::Rgb([0.0, 1.0, 0.0])).0;
    let expected = column
        .iter()
        .map(|&v| f64::from(v) * f64::from(v))
        .sum::<f64>()
        / 3.0;
    close(m.raw.rmse_xyz, expected.sqrt());
    close(m.raw.rmse, (1.0f64 / 3.0).sqrt());
}

#[test]
fn shares_count_pixels_beyond_their_limit() {
    let r = gray(100, 1, |_| 1.0);
    let x = gray(100, 1, |i| {
        if i < 40 {
            1.0
        } else if i < 70 {
            1.06
        } else if i < 90 {
            0.88
        } else {
            2.0
        }
    });
    let m = measure(&x, &Reference::exact(&r)).unwrap();
    close(m.shares.over_5_percent, 0.6);
    close(m.shares.over_10_percent, 0.3);
    close(m.shares.over_20_percent, 0.1);
}

#[test]
fn exactly_the_worst_thousandth_is_dropped() {
    // Two fireflies among 2000 pixels: both go; a third stays.
    let r = gray(2000, 1, |_| 1.0);
    let flies = |n: usize| {
        gray(2000, 1, move |i| {
            if i % 500 == 0 && i / 500 < n {
                1000.0
            } else {
                1.0
            }
        })
    };
    let m = measure(&flies(2), &Reference::exact(&r)).unwrap();
    assert!(m.raw.bias > 0.9);
    close(m.trimmed.bias, 0.0);
    close(m.trimmed.relative_mse, 0.0);
    let m = measure(&flies(3), &Reference::exact(&r)).unwrap();
    close(m.trimmed.mse, 999.0 * 999.0 / 1998.0);
}

#[test]
fn pixels_that_are_not_finite_are_counted_and_left_out() {
    let r = gray(10, 1, |_| 1.0);
    let x = gray(10, 1, |i| if i == 3 { f32::NAN } else { 1.5 });
    let m = measure(&x, &Reference::exact(&r)).unwrap();
    assert_eq!(m.non_finite, 1);
    close(m.raw.mse, 0.25);
    close(m.raw.bias, 0.5);
}

#[test]
fn a_black_reference_is_no_division_by_zero() {
    let black = gray(4, 4, |_| 0.0);
    let m = measure(&black, &Reference::exact(&black)).unwrap();
    assert_eq!(
        (m.raw.relative_mse, m.raw.bias, m.shares.over_5_percent),
        (0.0, 0.0, 0.0)
    );
    let m = measure(&gray(4, 4, |_| 1.0), &Reference::exact(&black)).unwrap();
    close(m.shares.over_20_percent, 1.0);
    // light on black is off by no share of it, and does not pass for right
    assert!(m.raw.mse > 0.9 && m.raw.relative_mse == f64::INFINITY && m.raw.bias == f64::INFINITY);
}

#[test]
fn tiles_hold_the_means_of_their_pixels() {
    let r = gray(20, 17, |_| 2.0);
    let x = gray(20, 17, |i| {
        if i % 20 >= 16 && i / 20 == 16 {
            3.0
        } else {
            2.0
        }
    });
    let all = tiles(&x, &Reference::exact(&r), 16).unwrap();
    assert_eq!(all.len(), 4);
    close(all[0].worst(), 0.0);
    close(all[3].worst(), 0.5);
    assert_eq!((all[3].x, all[3].y), (16, 16));
    let (a, b) = (gray(4, 4, |_| 1.0), gray(4, 4, |_| 3.0));
    let tile = tiles(&r_part(), &Reference::halves(&a, &b).unwrap(), 4).unwrap()[0];
    close(tile.reference[0], 2.0);
    close(tile.reference_error.unwrap()[0], 1.0 / 4.0);
}

fn r_part() -> Image {
    gray(4, 4, |_| 2.0)
}

/// Mean of the estimate over many pictures of known noise, with its standard error.
fn estimates(measure_one: impl Fn(&Image, &Image, &Image) -> f64) -> (f64, f64) {
    let mut random = Random(99);
    let truth = |i: usize| 1.0 + (i % 7) as f64 * 0.3;
    let (noise, reference_noise) = (0.05, 0.2);
    let runs = 400;
    let mut values = Vec::new();
    for _ in 0..runs {
        let mut noisy = |sd: f64| gray(16, 16, |i| (truth(i) + sd * random.normal()) as f32);
        let (x, a, b) = (noisy(noise), noisy(reference_noise), noisy(reference_noise));
        values.push(measure_one(&x, &a, &b));
    }
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / (n - 1.0);
    (mean, (variance / n).sqrt())
}

#[test]
fn halves_cancel_the_noise_of_the_reference() {
    let truth = 0.05 * 0.05;
    let (mean, error) = estimates(|x, a, b| {
        measure(x, &Reference::halves(a, b).unwrap())
            .unwrap()
            .raw
            .mse
    });
    assert!(
        (mean - truth).abs() < 4.0 * error,
        "{mean} +- {error}, expected {truth}"
    );
    // The planted fault: (x - r)^2 with r = (A + B)/2 keeps the noise of r, and the test sees it.
    let (mean, error) = estimates(|x, a, b| {
        let planes = [0, 1, 2].map(|c: usize| {
            a.rgb()[c]
                .iter()
                .zip(b.rgb()[c])
                .map(|(a, b)| 0.5 * (a + b))
                .collect()
        });
        let r = Image::from_rgb(a.width(), a.height(), planes).unwrap();
        measure(x, &Reference::exact(&r)).unwrap().raw.mse
    });
    assert!(
        (mean - truth).abs() > 20.0 * error,
        "{mean} +- {error}: the fault is not seen"
    );
    assert!((mean - truth - 0.5 * 0.2 * 0.2).abs() < 4.0 * error);
}

#[test]
fn nsd_is_the_relative_standard_deviation() {
    let images = [gray(2, 1, |i| [1.0, 0.0][i]), gray(2, 1, |i| [3.0, 0.0][i])];
    let n = nsd(&[&images[0], &images[1]]).unwrap();
    close(n.mean, 2.0f64.sqrt() / 2.0);
    assert_eq!((n.pixels, n.images), (1, 2));
    assert!(nsd(&[&images[0]]).is_none());
    // The dark pixel counts where it should not be dark.
    let n = nsd_beside(&[&images[0], &images[1]], &gray(2, 1, |_| 1.0)).unwrap();
    close(n.mean, 0.75 * 2.0f64.sqrt());
    assert_eq!(n.pixels, 2);
    let n = nsd_beside(&[&images[0], &images[1]], &images[0]).unwrap();
    assert_eq!(n.pixels, 1);
    assert!(nsd_beside(&[&images[0], &images[1]], &gray(1, 2, |_| 1.0)).is_none());
    // Nor does one that is not finite anywhere.
    let spoilt = gray(2, 1, |i| [1.0, f32::NAN][i]);
    let n = nsd_beside(&[&images[0], &spoilt], &gray(2, 1, |_| 1.0)).unwrap();
    assert_eq!(n.pixels, 1);
    let black = gray(2, 1, |_| 0.0);
    assert!(nsd_beside(&[&black, &black], &gray(2, 1, |_| 1.0)).is_none());
    let mut random = Random(5);
    let many: Vec<Image> = (0..50)
        .map(|_| gray(32, 32, |_| (4.0 + random.normal()) as f32))
        .collect();
    let n = nsd(&many.iter().collect::<Vec<_>>()).unwrap();
    assert!(
        (n.mean - 0.25).abs() < 0.01 && (n.pooled - 0.25).abs() < 0.01,
        "{n:?}"
    );
    assert!(n.quantile_5 < n.median && n.median < n.quantile_95);
}

/// Its mean over the pixels that count is the image's NSD.
#[test]
fn the_map_of_nsd_is_that_of_each_pixel() {
    let images = [
        gray(4, 1, |i| [1.0, 0.0, 0.0, 5.0][i]),
        gray(4, 1, |i| [3.0, 0.0, 0.0, 5.0][i]),
    ];
    let images = [&images[0], &images[1]];
    let reference = gray(4, 1, |i| [2.0, 1.0, 0.0, 5.0][i]);
    let map = nsd_map(&images, &reference).unwrap();
    // s = sqrt(2) over 2; dark in all pictures alone: the bound sqrt(2); dark everywhere; the same in both
    let wanted = [0.5f64.sqrt(), 2.0f64.sqrt(), 0.0, 0.0];
    for (found, wanted) in map.iter().zip(wanted) {
        assert!((f64::from(*found) - wanted).abs() < 1e-6, "{map:?}");
    }
    let n = nsd_beside(&images, &reference).unwrap();
    let sum: f64 = map.iter().map(|&v| f64::from(v)).sum();
    assert_eq!(n.pixels, 3);
    assert!((n.mean - sum / 3.0).abs() < 1e-6);
    let lost = gray(4, 1, |i| [f32::NAN, 0.0, 0.0, 5.0][i]);
    assert!(nsd_map(&[images[0], &lost], &reference).unwrap()[0].is_nan());
    assert!(nsd_map(&images[..1], &reference).is_none());
    assert!(nsd_map(&images, &gray(2, 2, |_| 1.0)).is_none());
}

#[test]
fn a_report_is_text_and_json() {
    let r = gray(32, 32, |_| 1.0).placed([0, 0], [32, 32]);
    let x = gray(32, 32, |_| 1.1).placed([0, 0], [32, 32]);
    let crop = gray(8, 8, |_| 1.2).placed([4, 4], [32, 32]);
    let report = compare(&[("x.exr", &x), ("y.exr", &x)], &r, Some(&r)).unwrap();
    let text = report.to_string();
    for word in [
        "x.exr",
        "RMSE",
        "relative MSE",
        "bias",
        "+10.000 %",
        "NSD of 2",
        "worst 0.1 % dropped",
    ] {
        assert!(text.contains(word), "{word} is not in\n{text}");
    }
    let json = serde_json::to_value(&report).unwrap();
    assert!((json["images"][0]["raw"]["bias"].as_f64().unwrap() - 0.1).abs() < 1e-6);
    let part = compare(&[("crop", &crop)], &r, None).unwrap();
    assert!((part.images[0].raw.bias - 0.2).abs() < 1e-6);
    let small = gray(3, 3, |_| 1.0);
    assert!(matches!(
        compare(&[("s", &small)], &r, None),
        Err(CompareError::Size { .. })
    ));
    assert!(matches!(
        compare(&[("x", &x)], &r, Some(&small)),
        Err(CompareError::Halves)
    ));
    assert_eq!(compare(&[], &r, None), Err(CompareError::Nothing));
    // Two crops of one size lie on each other only if they are the same part.
    let other = gray(8, 8, |_| 1.2).placed([8, 4], [32, 32]);
    assert!(matches!(
        compare(&[("crop", &crop)], &other, None),
        Err(CompareError::Place { .. })
    ));
    assert!(compare(&[("crop", &crop)], &crop, None).is_ok());
    assert!(compare(&[("crop", &crop)], &gray(8, 8, |_| 1.0), None).is_ok());
    assert!(nsd(&[&crop, &other]).is_none());
}
