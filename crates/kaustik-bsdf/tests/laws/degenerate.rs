//! Input that means nothing does no harm.

use crate::catalogue::some;
use glam::DVec3;
use kaustik_bsdf::{Bsdf, Interface, Lobe, Mode, Principled, PrincipledParameters};
use kaustik_spectrum::Spectrum;

const ODD: [f64; 7] = [
    0.0,
    -0.0,
    1e-300,
    1e-12,
    1.0 - 1e-16,
    f64::NAN,
    f64::INFINITY,
];

fn directions() -> Vec<DVec3> {
    let mut all: Vec<DVec3> = ODD
        .into_iter()
        .flat_map(|z| [DVec3::new(1.0, 0.0, z), DVec3::new(1.0, 0.0, -z)])
        .collect();
    all.extend([
        DVec3::NAN,
        DVec3::ZERO,
        DVec3::Z,
        -DVec3::Z,
        DVec3::new(f64::NAN, 0.0, 1.0),
    ]);
    all.extend([1e-9, 1e-6, -1e-9].map(|z: f64| DVec3::new((1.0 - z * z).sqrt(), 0.0, z)));
    all
}

fn check(bsdf: &Bsdf, name: &str) {
    let corners = [0.0, 0.5, 1.0 - f64::EPSILON / 2.0];
    for wo in directions() {
        for wi in directions() {
            let value = bsdf.eval(wo, wi, Mode::Radiance);
            assert!(
                value.is_finite() && value.min() >= 0.0,
                "{name} {wo} {wi}: {value:?}"
            );
            let pdf = bsdf.pdf(wo, wi, Mode::Importance);
            assert!(pdf.is_finite() && pdf >= 0.0, "{name} {wo} {wi}: {pdf}");
        }
        for uc in corners {
            for u in corners.into_iter().flat_map(|a| corners.map(|b| [a, b])) {
                for mode in [Mode::Radiance, Mode::Importance] {
                    let Some(s) = bsdf.sample(wo, uc, u, mode) else {
                        continue;
                    };
                    assert!(
                        s.weight.is_finite() && s.weight.min() >= 0.0,
                        "{name} {wo} {s:?}"
                    );
                    assert!(
                        s.pdf > 0.0 && s.pdf.is_finite() && s.wi.is_finite(),
                        "{name} {s:?}"
                    );
                }
            }
        }
        let _ = bsdf.albedo(wo);
    }
}

#[test]
fn odd_directions_scatter_nothing_or_something_finite() {
    for case in some() {
        check(&case.bsdf, &case.name);
    }
}

#[test]
fn odd_parameters_make_something_that_works() {
    for x in [0.0, -1.0, 1e30, f64::NAN, f64::INFINITY] {
        let s = Spectrum::splat(x as f32);
        for alpha in [0.0, 0.3, x] {
            check(
                &Bsdf::dielectric(Interface::clear(s), alpha, true),
                "dielectric",
            );
            check(
                &Bsdf::thin_dielectric(Interface::clear(s), alpha, true),
                "pane",
            );
            check(
                &Bsdf::metal(Spectrum::ONE, Spectrum::ONE, alpha, true),
                "metal",
            );
        }
        check(&Bsdf::coated(Spectrum::ONE, x), "coated");
        check(&Bsdf::phong(Spectrum::ONE, Spectrum::ONE, x), "phong");
        let p = PrincipledParameters {
            base_color: s,
            metallic: x,
            roughness: x,
            specular: x,
            specular_color: s,
            ior: s,
            transmission: x,
            ..Default::default()
        };
        check(&Bsdf::principled(&p), "principled");
        check(&Bsdf::Principled(Principled::new(&p)), "principled in full");
    }
}
