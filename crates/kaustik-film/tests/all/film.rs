//! Integer sums: order, threads, rounding, what is counted, cropping, development.

use crate::random::Random;
use kaustik_film::{Added, Film, FilmError, Filter, Layout, Quantum, Window, develop, develop_xyz};
use kaustik_spectrum::Xyz;

/// A raster point with its value.
type Splat = (f64, f64, Xyz);

fn splats(count: usize, seed: u64, layout: &Layout) -> Vec<Splat> {
    let mut random = Random(seed);
    let bounds = layout.extended_bounds();
    (0..count)
        .map(|_| {
            let [x, y] = bounds.point(random.uniform(), random.uniform());
            let value = Xyz([0; 3].map(|_| libm::exp(4.0 * random.normal()) as f32));
            (x, y, value)
        })
        .collect()
}

fn sums(film: &Film) -> Vec<i64> {
    film.sums().collect()
}

#[test]
fn same_sums_for_any_order_and_any_number_of_threads() {
    for name in Filter::names() {
        let layout = Layout::new(37, 23).with_filter(name.parse().unwrap());
        let quantum = Quantum::from_mean(100.0);
        let splats = splats(20_000, 7, &layout);
        let film = |threads: usize, reverse: bool| {
            let film = Film::with_layout(&layout, quantum).unwrap();
            std::thread::scope(|scope| {
                for share in splats.chunks(splats.len().div_ceil(threads)) {
                    let film = &film;
                    scope.spawn(move || {
                        let mut share = share.to_vec();
                        if reverse {
                            share.reverse();
                        }
                        for (x, y, value) in share {
                            film.splat(x, y, value);
                        }
                    });
                }
            });
            sums(&film)
        };
        let one = film(1, false);
        assert_eq!(one, film(1, true), "{name}: reversed");
        for threads in [2, 3, 16] {
            assert_eq!(
                one,
                film(threads, threads % 2 == 1),
                "{name}: {threads} threads"
            );
        }
    }
}

#[test]
fn merged_shares_are_the_whole() {
    let layout = Layout::new(16, 16).with_filter(Filter::TENT);
    let quantum = Quantum::from_mean(1.0);
    let splats = splats(5000, 3, &layout);
    let make = || Film::with_layout(&layout, quantum).unwrap();
    let (whole, left, right) = (make(), make(), make());
    for (i, &(x, y, value)) in splats.iter().enumerate() {
        whole.splat(x, y, value);
        if i % 3 == 0 { &left } else { &right }.splat(x, y, value);
    }
    left.splat(0.5, 0.5, Xyz([f32::NAN, 0.0, 0.0]));
    right.merge(&left).unwrap();
    assert_eq!(sums(&whole), sums(&right));
    assert_eq!(right.counters().non_finite, 1);

    let restored = make();
    restored.add_sums(whole.sums(), &whole.counters()).unwrap();
    assert_eq!(sums(&whole), sums(&restored));
    let short = restored.add_sums([1, 2, 3].into_iter(), &whole.counters());
    assert!(matches!(short, Err(FilmError::Length { found: 3, .. })));
    assert_eq!(sums(&whole), sums(&restored));
    let other = Film::with_layout(&layout, Quantum::from_mean(8.0)).unwrap();
    assert_eq!(restored.merge(&other), Err(FilmError::Mismatch("quantum")));
}

#[test]
fn a_million_adds_round_to_within_a_millionth() {
    // The quantum comes from the mean; values spread over eight orders of magnitude.
    let mut random = Random(11);
    let values: Vec<f32> = (0..1_000_000)
        .map(|_| libm::exp(3.0 * random.normal()) as f32)
        .collect();
    let exact: f64 = values.iter().map(|&v| f64::from(v)).sum();
    let film = Film::new(1, 1, Quantum::from_mean(exact / 1e6)).unwrap();
    let mut singles = 0.0f32;
    for &value in &values {
        film.splat(0.5, 0.5, Xyz([value, 1e-3 * value, 1e-6 * value]));
        singles += value;
    }
    let sums = sums(&film);
    let total = |c: usize| sums[c] as f64 * film.quantum().value();
    assert!(
        (total(0) / exact - 1.0).abs() < 1e-9,
        "{}",
        total(0) / exact - 1.0
    );
    // Where the mean is a thousandth of what the quantum was made for; and a millionth, where the
    // smallest values vanish.
    let relative = |c: usize, part: f64| (total(c) / (part * exact) - 1.0).abs();
    assert!(relative(1, 1e-3) < 1e-6, "{}", relative(1, 1e-3));
    assert!(relative(2, 1e-6) < 1e-5, "{}", relative(2, 1e-6));
    // The test sees errors of this size: an f32 sum fails it.
    assert!((f64::from(singles) / exact - 1.0).abs() > 1e-6);
}

#[test]
fn rounds_to_nearest_at_every_magnitude() {
    let film = |value: f64| {
        let film = Film::new(1, 1, Quantum::from_exponent(0)).unwrap();
        film.splat_weighted(0.5, 0.5, Xyz([1.0, -1.0, 0.0]), value);
        let sums = sums(&film);
        assert_eq!(sums[0], -sums[1]);
        sums[0]
    };
    for (value, expected) in [
        (0.49, 0),
        (0.51, 1),
        (1.5, 2),
        (2.5, 2),
        (1e15 + 0.75, 1_000_000_000_000_001),
    ] {
        assert_eq!(film(value), expected, "{value}");
    }
    for power in 40..61 {
        let value = (1i64 << power) + (1 << (power - 40));
        assert_eq!(film(value as f64), value);
    }
    assert_eq!(film(2f64.powi(51) - 0.5), 1 << 51);
    assert_eq!(film(2f64.powi(51) + 0.5), 1 << 51);
}

#[test]
fn what_cannot_be_added_is_counted() {
    let film = Film::new(4, 4, Quantum::from_mean(1.0)).unwrap();
    let white = Xyz([1.0; 3]);
    assert_eq!(
        film.splat(0.5, 0.5, Xyz([f32::NAN, 0.0, 0.0])),
        Added::NonFinite
    );
    assert_eq!(
        film.splat(0.5, 0.5, Xyz([0.0, f32::INFINITY, 0.0])),
        Added::NonFinite
    );
    assert_eq!(film.splat(f64::NAN, 0.5, white), Added::NonFinite);
    assert_eq!(
        film.splat_weighted(0.5, 0.5, white, f64::INFINITY),
        Added::NonFinite
    );
    assert_eq!(film.splat(0.5, 0.5, Xyz([0.0, 1e9, 0.0])), Added::TooLarge);
    assert_eq!(film.add(0, 0, Xyz([-1e9, 0.0, 0.0])), Added::TooLarge);
    for (x, y) in [(-0.1, 0.5), (4.0, 0.5), (0.5, 4.0), (0.5, -1e300)] {
        assert_eq!(film.splat(x, y, white), Added::Outside);
    }
    assert_eq!(film.add(4, 0, white), Added::Outside);
    let counters = film.counters();
    assert_eq!(
        (counters.non_finite, counters.too_large, counters.overflowed),
        (4, 2, 0)
    );
    assert!(sums(&film).iter().all(|&sum| sum == 0));
}

#[test]
fn a_sum_past_the_guard_band_is_reported() {
    let film = Film::new(1, 1, Quantum::from_exponent(0)).unwrap();
    let large = 2f32.powi(60);
    for _ in 0..3 {
        film.splat(0.5, 0.5, Xyz([large, -large, 0.0]));
    }
    assert_eq!(film.counters().overflowed, 0);
    film.splat(0.5, 0.5, Xyz([large, -large, 0.0]));
    assert!(film.counters().overflowed > 0);

    // A merge that would wrap is reported as well.
    let (a, b) = (
        Film::new(1, 1, Quantum::FALLBACK).unwrap(),
        Film::new(1, 1, Quantum::FALLBACK).unwrap(),
    );
    a.add_sums([i64::MAX, 0, 0].into_iter(), &Default::default())
        .unwrap();
    b.add_sums([i64::MAX, 0, 0].into_iter(), &Default::default())
        .unwrap();
    a.merge(&b).unwrap();
    assert!(a.counters().overflowed >= 3);
}

/// Whatever the radius: a splat adds what the filter says.
#[test]
fn splats_have_the_weights_of_their_filter() {
    let mut random = Random(11);
    for text in [
        "box",
        "box:0.7",
        "box:1.5",
        "tent:2",
        "gaussian",
        "mitchell:3",
        "blackman-harris",
    ] {
        let filter: Filter = text.parse().unwrap();
        let layout = Layout::new(9, 7).with_filter(filter);
        for _ in 0..50 {
            let film = Film::with_layout(&layout, Quantum::from_mean(1.0)).unwrap();
            let [x, y] = [2.0 + 5.0 * random.uniform(), 2.0 + 3.0 * random.uniform()];
            film.splat(x, y, Xyz([0.0, 1.0, 0.0]));
            let image = develop_xyz(&[(&film, 1.0)]).unwrap();
            let [_, luminance, _] = image.rgb();
            let (across, down) = (filter.taps(x), filter.taps(y));
            for row in 0..7i64 {
                for column in 0..9i64 {
                    let weight = |taps: &kaustik_film::Taps, at: i64| {
                        let index = usize::try_from(at - taps.first()).ok();
                        index
                            .and_then(|i| taps.weights().get(i).copied())
                            .unwrap_or(0.0)
                    };
                    let wanted = weight(&across, column) * weight(&down, row);
                    let got = f64::from(luminance[(row * 9 + column) as usize]);
                    assert!(
                        (got - wanted).abs() < 1e-4,
                        "{text} at {x}, {y}: {got} {wanted}"
                    );
                }
            }
        }
    }
}

#[test]
fn a_crop_holds_the_same_sums_as_the_whole() {
    for name in Filter::names() {
        let whole = Layout::new(20, 10).with_filter(name.parse().unwrap());
        let crop = Window {
            x0: 3,
            y0: 2,
            x1: 11,
            y1: 9,
        };
        let part = whole.with_crop(crop);
        let quantum = Quantum::from_mean(1.0);
        let (a, b) = (
            Film::with_layout(&whole, quantum).unwrap(),
            Film::with_layout(&part, quantum).unwrap(),
        );
        for (x, y, value) in splats(5000, 5, &whole) {
            a.splat(x, y, value);
            b.splat(x, y, value);
        }
        let (a, b) = (
            develop(&[(&a, 0.5)]).unwrap(),
            develop(&[(&b, 0.5)]).unwrap(),
        );
        let cut = a.cropped(crop).unwrap();
        assert_eq!(cut, b, "{name}");
        assert_eq!((b.origin(), b.full_size()), ([3, 2], [20, 10]));
    }
}

#[test]
fn nothing_is_lost_or_renormalised_at_the_border() {
    // Uniform points over the extended bounds: the border is as bright as the middle.
    for name in Filter::names() {
        let layout = Layout::new(8, 8).with_filter(name.parse().unwrap());
        let film = Film::with_layout(&layout, Quantum::from_mean(1.0)).unwrap();
        let bounds = film.extended_bounds();
        let n = 1500;
        for i in 0..n * n {
            let [x, y] = bounds.point(
                (i % n) as f64 / n as f64 + 1e-4,
                (i / n) as f64 / n as f64 + 1e-4,
            );
            film.splat(x, y, Xyz([1.0; 3]));
        }
        let image = develop_xyz(&[(&film, bounds.area() / (n * n) as f64)]).unwrap();
        for value in image.rgb()[0] {
            assert!((value - 1.0).abs() < 2e-2, "{name}: {value}");
        }
    }
}

#[test]
fn development_combines_films() {
    let (a, b) = (
        Film::new(2, 1, Quantum::from_mean(1.0)).unwrap(),
        Film::new(2, 1, Quantum::from_mean(64.0)).unwrap(),
    );
    a.add(0, 0, Xyz([1.0, 2.0, 3.0]));
    b.add(0, 0, Xyz([10.0, 20.0, 30.0]));
    b.add(1, 0, Xyz([0.0, 8.0, 0.0]));
    let image = develop_xyz(&[(&a, 2.0), (&b, -0.5)]).unwrap();
    assert_eq!(image.rgb(), [&[-3.0, 0.0][..], &[-6.0, -4.0], &[-9.0, 0.0]]);

    // D65 of Y = 1 is white.
    let white = Film::new(1, 1, Quantum::from_mean(1.0)).unwrap();
    white.add(0, 0, Xyz::from(kaustik_spectrum::Rgb([1.0; 3])));
    for plane in develop(&[(&white, 1.0)]).unwrap().rgb() {
        assert!((plane[0] - 1.0).abs() < 1e-5);
    }
    assert!(develop(&[]).is_err());
    assert!(develop(&[(&a, f64::NAN)]).is_err());
    assert!(develop(&[(&a, 1.0), (&white, 1.0)]).is_err());
}

#[test]
fn impossible_films_are_errors() {
    let quantum = Quantum::FALLBACK;
    assert!(matches!(
        Film::new(0, 5, quantum),
        Err(FilmError::Empty { .. })
    ));
    let beyond = Layout::new(4, 4).with_crop(Window {
        x0: 2,
        y0: 0,
        x1: 5,
        y1: 4,
    });
    assert!(Film::with_layout(&beyond, quantum).is_err());
    let swapped = Layout::new(4, 4).with_crop(Window {
        x0: 3,
        y0: 0,
        x1: 2,
        y1: 4,
    });
    assert!(Film::with_layout(&swapped, quantum).is_err());
    assert!(matches!(
        Film::new(u32::MAX, u32::MAX, quantum),
        Err(FilmError::Memory { .. })
    ));
}

#[test]
fn a_layout_survives_serialisation() {
    let layout = Layout::new(64, 48)
        .with_filter("gaussian:2.5".parse().unwrap())
        .with_crop(Window {
            x0: 1,
            y0: 2,
            x1: 3,
            y1: 4,
        });
    let text = serde_json::to_string(&(layout, Quantum::from_mean(3.0))).unwrap();
    let back: (Layout, Quantum) = serde_json::from_str(&text).unwrap();
    assert_eq!(back, (layout, Quantum::from_mean(3.0)));
    let wrong = text.replace("gaussian:2.5", "gaussian:-1");
    assert!(serde_json::from_str::<(Layout, Quantum)>(&wrong).is_err());
}

/// The best of many short runs in nanoseconds a step: short, so that some run undisturbed.
fn cost(steps: usize, mut run: impl FnMut()) -> f64 {
    let mut best = f64::INFINITY;
    for _ in 0..3000 {
        let start = std::time::Instant::now();
        run();
        best = best.min(start.elapsed().as_secs_f64() * 1e9 / steps as f64);
    }
    best
}

/// Nanoseconds a splat, beside the three bare atomic adds that a box splat cannot do without:
/// `cargo test -p kaustik-film --release -- --ignored --nocapture splat_cost`.
#[test]
#[ignore = "long"]
fn splat_cost() {
    use std::sync::atomic::{AtomicI64, Ordering::Relaxed};
    for size in [32, 512] {
        let mut random = Random(1);
        let cells: Vec<AtomicI64> = (0..3 * size * size).map(|_| AtomicI64::new(0)).collect();
        let pixels: Vec<usize> = (0..4096)
            .map(|_| random.below((size * size) as usize))
            .collect();
        let bare = cost(pixels.len(), || {
            for &pixel in &pixels {
                for cell in &cells[3 * pixel..3 * pixel + 3] {
                    std::hint::black_box(cell.fetch_add(5, Relaxed));
                }
            }
        });
        println!("{size} x {size}: three atomic adds {bare:.1} ns");
        for name in Filter::names() {
            let layout = Layout::new(size, size).with_filter(name.parse().unwrap());
            let film = Film::with_layout(&layout, Quantum::from_mean(1.0)).unwrap();
            let splats = splats(4096, 1, &layout);
            let splat = cost(splats.len(), || {
                for &(x, y, value) in &splats {
                    std::hint::black_box(film.splat(x, y, value));
                }
            });
            println!("{size} x {size}: {name} {splat:.1} ns a splat");
        }
    }
}
