//! Metals, glasses, water and tables against their check values.

use kaustik_spectrum::{
    Glass, Illuminant, Metal, SpectrumError, Tabulated, WavelengthSampling, Wavelengths,
    water_absorption,
};
use proptest::prelude::*;

#[test]
fn metals_at_their_knots() {
    assert_eq!(Metal::Au.at(548.6), [0.43, 2.455]);
    assert_eq!(Metal::Cu.at(548.6), [1.02, 2.577]);
    assert_eq!(Metal::Ag.at(548.6), [0.06, 3.586]);
    assert_eq!(Metal::Al.at(563.57), [1.0728, 6.7839]);
}

#[test]
fn metals_between_their_knots() {
    let [n, k] = Metal::Au.at(f32::midpoint(548.6, 582.1));
    assert!(
        (n - 0.36).abs() < 1e-4 && (k - 2.659).abs() < 1e-4,
        "{n} {k}"
    );
    for metal in Metal::ALL {
        assert_eq!(Metal::named(metal.name()), Some(metal));
        let w = Wavelengths::sample(0.01, WavelengthSampling::Hero);
        let (n, k) = metal.eta_k(&w);
        for (lane, nm) in w.nm().into_iter().enumerate() {
            assert_eq!([n[lane], k[lane]], metal.at(nm));
            assert!(k[lane] > 1.0);
        }
    }
}

#[test]
fn glasses_every_10_nm() {
    let csv = include_str!("../data/dielectrics_10nm.csv");
    let mut lines = csv.lines();
    let names: Vec<&str> = lines.next().unwrap().split(',').skip(1).collect();
    assert_eq!(names, Glass::names().collect::<Vec<_>>());
    for line in lines {
        let row: Vec<f32> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
        for (name, ior) in names.iter().zip(&row[1..]) {
            let glass = Glass::named(name).unwrap();
            assert!(
                (glass.at(row[0]) - ior).abs() < 2e-6,
                "{name} at {} nm",
                row[0]
            );
            assert!(glass.is_dispersive());
        }
    }
}

#[test]
fn glasses_from_words_and_numbers() {
    assert!((Glass::named("N-BK7").unwrap().at(587.5618) - 1.5168).abs() < 2e-6);
    assert_eq!(Glass::named("butter"), None);
    let own = Glass::sellmeier(
        &[1.039_612, 0.231_792_34, 1.010_469_5],
        &[0.006_000_698_7, 0.020_017_914, 103.560_65],
    );
    assert!((own.unwrap().at(587.5618) - 1.5168).abs() < 2e-6);
    let plain = Glass::constant(1.5).unwrap();
    assert!(!plain.is_dispersive());
    assert_eq!(plain.at(400.0), 1.5);
    assert!(matches!(
        Glass::sellmeier(&[1.0], &[]),
        Err(SpectrumError::SellmeierTerms { .. })
    ));
    assert!(matches!(
        Glass::sellmeier(&[1.0; 5], &[0.01; 5]),
        Err(SpectrumError::SellmeierTerms { .. })
    ));
    assert!(matches!(
        Glass::sellmeier(&[1.0], &[0.25]),
        Err(SpectrumError::Ior { .. })
    ));
    // A weak resonance between two whole nanometres.
    let resonant = Glass::sellmeier(&[1.0, 1e-4], &[0.01, 0.303_05]);
    assert!(matches!(resonant, Err(SpectrumError::Ior { nm, .. }) if (nm - 550.5).abs() < 0.1));
    assert!(Glass::sellmeier(&[1.0, 0.0], &[0.01, 0.303_05]).is_ok());
    assert!(matches!(
        Glass::constant(f32::NAN),
        Err(SpectrumError::Ior { .. })
    ));
    assert!(matches!(Glass::abbe(1.5, 0.0), Err(SpectrumError::Abbe(_))));
    assert!(matches!(
        Glass::abbe(1.5, f32::NAN),
        Err(SpectrumError::Abbe(_))
    ));
}

proptest! {
    #[test]
    fn cauchy_goes_through_nd_with_its_abbe_number(nd in 1.2..2.5_f32, v in 15.0..90.0_f32) {
        let glass = Glass::abbe(nd, v).unwrap();
        let at = |nm| f64::from(glass.at(nm));
        prop_assert!((at(587.5618) - f64::from(nd)).abs() < 1e-6);
        let abbe = (f64::from(nd) - 1.0) / (at(486.1327) - at(656.2725));
        prop_assert!((abbe / f64::from(v) - 1.0).abs() < 1e-3, "{}", abbe);
    }

    #[test]
    fn tables_are_linear_between_knots(
        mut nm in proptest::collection::vec(300.0..900.0_f32, 1..60),
        x in 360.0..830.0_f32,
    ) {
        nm.sort_by(f32::total_cmp);
        nm.dedup();
        let knots: Vec<_> = nm.iter().map(|&nm| (nm, (nm * 0.37) % 3.0)).collect();
        let table = Tabulated::new(knots.clone()).unwrap();
        let wanted = match knots.iter().position(|knot| knot.0 > x) {
            Some(0) => knots[0].1,
            None => knots[knots.len() - 1].1,
            Some(i) => {
                let ((x0, y0), (x1, y1)) = (knots[i - 1], knots[i]);
                y0 + (x - x0) / (x1 - x0) * (y1 - y0)
            }
        };
        prop_assert!((table.at(x) - wanted).abs() < 1e-5);
    }
}

#[test]
fn tables_outside_the_visible_range() {
    let table = Tabulated::new(vec![
        (200.0, 1.0),
        (300.0, 2.0),
        (900.0, 4.0),
        (1000.0, 5.0),
    ])
    .unwrap();
    for (nm, value) in [
        (100.0, 1.0),
        (250.0, 1.5),
        (600.0, 3.0),
        (950.0, 4.5),
        (2000.0, 5.0),
    ] {
        assert!((table.at(nm) - value).abs() < 1e-6, "{nm}");
    }
}

#[test]
fn tables_that_are_refused() {
    let error = |knots: &[(f32, f32)]| Tabulated::new(knots.to_vec()).unwrap_err();
    assert_eq!(error(&[]), SpectrumError::NoKnots);
    assert!(matches!(
        error(&[(f32::NAN, 1.0)]),
        SpectrumError::NotFinite { index: 0, .. }
    ));
    assert!(matches!(
        error(&[(400.0, f32::INFINITY)]),
        SpectrumError::NotFinite { index: 0, .. }
    ));
    assert!(matches!(
        error(&[(400.0, 1.0), (400.0, 2.0)]),
        SpectrumError::NotSorted { index: 1, .. }
    ));
    assert!(matches!(
        error(&[(400.0, 1.0), (500.0, -0.1)]),
        SpectrumError::Negative { index: 1, .. }
    ));
    let many: Vec<_> = (0..70_000).map(|i| (i as f32, 1.0)).collect();
    assert!(matches!(error(&many), SpectrumError::TooManyKnots { .. }));
}

#[test]
fn named_tables() {
    for name in Tabulated::NAMES {
        assert!(Tabulated::named(name).is_some(), "{name}");
    }
    assert!(Tabulated::named("cornell-purple").is_none());
    let white = Tabulated::named("cornell-white").unwrap();
    assert_eq!(white.at(400.0), 0.343);
    assert_eq!(white.at(360.0), 0.343);
    assert!((white.at(402.0) - 0.394).abs() < 1e-6);
    assert_eq!(Tabulated::named("cornell-light").unwrap().at(550.0), 11.8);
    assert!(white.max() < 1.0);
    assert_eq!(white.scaled(0.5).unwrap().at(400.0), 0.1715);
}

#[test]
fn named_illuminants() {
    for light in Illuminant::ALL {
        assert_eq!(Illuminant::named(&light.name().to_uppercase()), Some(light));
    }
    assert_eq!(Illuminant::named("candle"), None);
}

#[test]
fn water_absorbs_red() {
    let at = |nm| water_absorption(&Wavelengths::monochromatic(nm)).hero();
    // 4 pi 1.64e-8 / 650e-9 m
    assert!((at(650.0) - 0.317_06).abs() < 1e-4, "{}", at(650.0));
    assert!(at(475.0) < 0.03 && at(475.0) > 0.02);
}
