//! Estimates of XYZ against integrals, chromaticities, matrices, transfer functions.

use kaustik_spectrum::{
    Illuminant, Rgb, Spectrum, WavelengthSampling, Wavelengths, Xyz, Y_INTEGRAL, cie_1931,
    integrate_xyz, linear_to_srgb, srgb_to_linear, uplift_emission, uplift_reflectance,
};
use proptest::prelude::*;

/// Mean of an estimate over u, by the midpoint rule: the expectation but for its discretisation.
fn expectation(sampling: WavelengthSampling, estimate: impl Fn(&Wavelengths) -> Xyz) -> [f64; 3] {
    const N: u32 = 200_000;
    let mut sum = [0.0; 3];
    for i in 0..N {
        let w = Wavelengths::sample((f64::from(i) + 0.5) / f64::from(N), sampling);
        let xyz = estimate(&w).0;
        for c in 0..3 {
            sum[c] += f64::from(xyz[c]) / f64::from(N);
        }
    }
    sum
}

fn assert_near(a: [f64; 3], b: [f64; 3], tolerance: f64) {
    for c in 0..3 {
        assert!((a[c] - b[c]).abs() < tolerance, "{a:?} {b:?}");
    }
}

#[test]
fn illuminants_have_their_chromaticities() {
    let wanted = [
        (Illuminant::A, [0.4476, 0.4074]),
        (Illuminant::D50, [0.3457, 0.3585]),
        (Illuminant::D65, [0.3127, 0.3290]),
        (Illuminant::E, [1.0 / 3.0, 1.0 / 3.0]),
        (Illuminant::Fl2, [0.3721, 0.3751]),
        (Illuminant::Fl11, [0.3805, 0.3769]),
    ];
    for (light, xy) in wanted {
        let xyz = integrate_xyz(|nm| f64::from(light.at(nm as f32)));
        let sum = xyz[0] + xyz[1] + xyz[2];
        // the published values of lamps with lines stand on sums every 5 nm
        let lines = matches!(light, Illuminant::Fl2 | Illuminant::Fl11);
        let tolerance = if lines { 4e-4 } else { 1e-4 };
        for c in 0..2 {
            assert!(
                (xyz[c] / sum - xy[c]).abs() < tolerance,
                "{light:?} {xyz:?}"
            );
        }
        assert!((xyz[1] - 1.0).abs() < 1e-6, "{light:?} has Y = {}", xyz[1]);
    }
}

#[test]
fn to_xyz_is_unbiased() {
    for light in Illuminant::ALL {
        let integral = integrate_xyz(|nm| f64::from(light.at(nm as f32)));
        let all = expectation(WavelengthSampling::Hero, |w| w.to_xyz(light.eval(w)));
        let hero = expectation(WavelengthSampling::Hero, |w| w.hero_to_xyz(light.eval(w)));
        assert_near(all, integral, 2e-5);
        assert_near(hero, integral, 5e-5);
    }
}

/// Weights without the division by pdf, the fault to fear, move D65 far beyond the bound above.
#[test]
fn a_lost_pdf_is_noticed() {
    let integral = integrate_xyz(|nm| f64::from(Illuminant::D65.at(nm as f32)));
    let wrong = expectation(WavelengthSampling::Hero, |w| {
        let pdf = Spectrum::from_fn(|lane| w.pdf(lane) * 320.0);
        w.to_xyz(Illuminant::D65.eval(w) * pdf)
    });
    assert!(
        (0..3).any(|c| (wrong[c] - integral[c]).abs() > 0.1),
        "{wrong:?}"
    );
}

#[test]
fn one_wavelength_sees_400_to_700_nm() {
    let light = Illuminant::D65;
    let mut integral = [0.0; 3];
    for i in 0..30_000_u16 {
        let nm = 400.005 + 0.01 * f32::from(i);
        for (sum, m) in integral.iter_mut().zip(cie_1931(nm)) {
            *sum += 0.01 * f64::from(m * light.at(nm)) / Y_INTEGRAL;
        }
    }
    let all = expectation(WavelengthSampling::Single, |w| w.to_xyz(light.eval(w)));
    let hero = expectation(WavelengthSampling::Single, |w| w.hero_to_xyz(light.eval(w)));
    assert_near(all, hero, 1e-6);
    assert_near(all, integral, 2e-5);
    assert!((all[1] - 0.9996).abs() < 1e-4, "{}", all[1]);
    let sum = all[0] + all[1] + all[2];
    assert!((all[0] / sum - 0.3127).abs() < 1e-4 && (all[1] / sum - 0.3295).abs() < 1e-4);
}

/// A white path's target must not depend on its wavelengths much; see the module's table.
#[test]
fn the_target_of_a_white_path_hardly_depends_on_its_wavelengths() {
    const N: u32 = 10_000;
    let (mut sum, mut squares) = (0.0, 0.0);
    for i in 0..N {
        let w = Wavelengths::sample(
            (f64::from(i) + 0.5) / f64::from(N),
            WavelengthSampling::Hero,
        );
        let target = f64::from(w.to_xyz(Illuminant::D65.eval(&w)).sum());
        (sum, squares) = (sum + target, squares + target * target);
    }
    let mean = sum / f64::from(N);
    let deviation = (squares / f64::from(N) - mean * mean).sqrt() / mean;
    assert!(deviation < 0.04, "{deviation}");
}

#[test]
fn d65_is_white() {
    let xyz = integrate_xyz(|nm| f64::from(Illuminant::D65.at(nm as f32)));
    let Rgb(rgb) = Xyz(xyz.map(|c| c as f32)).into();
    for c in rgb {
        assert!((c - 1.0).abs() < 1e-6, "{rgb:?}");
    }
    let white: Xyz = Rgb::WHITE.into();
    assert!((white.luminance() - 1.0).abs() < 1e-6);
}

/// The published sRGB matrix, to the four digits in which integrals of D65 agree.
#[test]
fn the_matrix_is_that_of_rec_709() {
    let Xyz(red) = Rgb([1.0, 0.0, 0.0]).into();
    let Xyz(green) = Rgb([0.0, 1.0, 0.0]).into();
    for (a, b) in red.into_iter().zip([0.4124, 0.2126, 0.0193]) {
        assert!((a - b).abs() < 2e-4, "{red:?}");
    }
    for (a, b) in green.into_iter().zip([0.3576, 0.7152, 0.1192]) {
        assert!((a - b).abs() < 2e-4, "{green:?}");
    }
}

#[test]
fn emission_of_one_is_d65() {
    let white = uplift_emission([1.0; 3]);
    let bright = uplift_emission([300.0; 3]);
    for nm in [360.0, 400.0, 507.3, 650.0, 830.0] {
        assert!((white.at(nm) - Illuminant::D65.at(nm)).abs() < 1e-6);
        assert!((bright.at(nm) / 300.0 - Illuminant::D65.at(nm)).abs() < 1e-5);
    }
    let w = Wavelengths::sample(0.3, WavelengthSampling::Hero);
    assert!(uplift_emission([0.0; 3]).eval(&w).is_zero());
    assert!(
        uplift_emission([f32::NAN, -1.0, f32::INFINITY])
            .eval(&w)
            .is_zero()
    );
}

/// The colour of an emission, over its largest component.
fn emitted(rgb: [f32; 3]) -> [f32; 3] {
    let spectrum = uplift_emission(rgb);
    let xyz = integrate_xyz(|nm| f64::from(spectrum.at(nm as f32)));
    let Rgb(back) = Xyz(xyz.map(|c| c as f32)).into();
    let most = rgb[0].max(rgb[1]).max(rgb[2]);
    back.map(|c| c / most)
}

/// Brightness is a factor, so a grid over the three faces of the cube on which one component is 1
/// meets every colour there is.
#[test]
fn emission_has_its_colour() {
    const STEPS: u16 = 61;
    let (mut worst, mut mean, mut where_) = (0.0_f32, 0.0_f64, [0.0; 3]);
    for face in 0..3 {
        for i in 0..STEPS * STEPS {
            let other = |step: u16| f32::from(step) / f32::from(STEPS - 1);
            let mut rgb = [1.0, other(i / STEPS), other(i % STEPS)];
            rgb.rotate_right(face);
            let error = (emitted(rgb).into_iter().zip(rgb))
                .map(|(a, b)| (a - b).abs())
                .fold(0.0, f32::max);
            mean += f64::from(error) / f64::from(3 * STEPS * STEPS);
            if error > worst {
                (worst, where_) = (error, rgb);
            }
        }
    }
    // Measured: 0.0080 at (0.05, 0, 1), between nodes of the table; 0.00024 on average.
    assert!(worst < 0.0085, "{worst} at {where_:?}");
    assert!(mean < 2.7e-4, "{mean}");
}

#[test]
fn brightness_of_an_emission_is_a_factor() {
    for rgb in [[0.044, 0.0, 1.0], [1.0, 0.3, 0.1], [0.5, 1.0, 0.75]] {
        let dim = emitted(rgb);
        for factor in [1e-6, 37.0, 1e20] {
            for (a, b) in emitted(rgb.map(|c| c * factor)).into_iter().zip(dim) {
                assert!((a - b).abs() < 1e-5, "{rgb:?} {factor}: {a} {b}");
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn matrices_are_inverse(r in -2.0..2.0_f32, g in -2.0..2.0_f32, b in -2.0..2.0_f32) {
        let Rgb(back) = Xyz::from(Rgb([r, g, b])).into();
        for (a, b) in back.into_iter().zip([r, g, b]) {
            prop_assert!((a - b).abs() < 2e-6);
        }
    }

    #[test]
    fn transfer_functions_are_inverse(v in 0.0..1.0_f32) {
        prop_assert!((linear_to_srgb(srgb_to_linear(v)) - v).abs() < 1e-6);
        prop_assert!((srgb_to_linear(linear_to_srgb(v)) - v).abs() < 1e-6);
    }
}

#[test]
fn transfer_functions_at_known_points() {
    assert_eq!(srgb_to_linear(0.0), 0.0);
    assert_eq!(srgb_to_linear(1.0), 1.0);
    assert_eq!(linear_to_srgb(1.0), 1.0);
    assert!((srgb_to_linear(0.5) - 0.214_041).abs() < 1e-6);
    assert!((linear_to_srgb(0.18) - 0.461_356).abs() < 1e-6);
}

#[test]
fn an_average_of_estimates_is_the_colour_of_the_paint() {
    let (lamp, paint) = (
        uplift_emission([1.0; 3]),
        uplift_reflectance([0.1, 0.5, 0.3]),
    );
    let xyz = expectation(WavelengthSampling::Hero, |w| {
        w.to_xyz(lamp.eval(w) * paint.eval(w))
    });
    let Rgb(rgb) = Xyz(xyz.map(|c| c as f32)).into();
    for (a, b) in rgb.into_iter().zip([0.1, 0.5, 0.3]) {
        assert!((a - b).abs() < 1e-3, "{rgb:?}");
    }
}

#[test]
fn a_laser_has_the_matching_functions() {
    let w = Wavelengths::monochromatic(555.0);
    let Xyz(xyz) = w.to_xyz(Spectrum::ONE);
    let wanted = cie_1931(555.0).map(|c| c / 106.857);
    for (a, b) in xyz.into_iter().zip(wanted) {
        assert!((a / b - 1.0).abs() < 1e-4, "{xyz:?}");
    }
}
