//! The tests would notice: planted faults are found.

use crate::catalogue::{Case, facets, some};
use crate::chi_square::{bound, directions, p_value};
use crate::consistency::{adjoint, reciprocal, sample_agrees};
use crate::energy::throughput;
use crate::support::{Random, at};
use glam::DVec3;
use kaustik_bsdf::{Bsdf, Lobe, Mode, Sample};
use kaustik_spectrum::Spectrum;

/// What is wrong with it.
#[derive(Clone, Copy, PartialEq)]
enum Fault {
    /// Weights of samples 2 % too large.
    Weight,
    /// The density of a slightly rougher surface.
    Density,
    /// Forgets eta squared.
    Squared,
    /// Not symmetric.
    OneWay,
}

struct Faulty {
    right: Bsdf,
    other: Bsdf,
    fault: Fault,
}

impl Lobe for Faulty {
    fn eval(&self, wo: DVec3, wi: DVec3, mode: Mode) -> Spectrum {
        match self.fault {
            Fault::Squared => self.right.eval(wo, wi, Mode::Importance),
            Fault::OneWay => self.right.eval(wo, wi, mode) * ((1.0 + 0.1 * wo.z.abs()) as f32),
            _ => self.right.eval(wo, wi, mode),
        }
    }

    fn pdf(&self, wo: DVec3, wi: DVec3, mode: Mode) -> f64 {
        let pdf = if self.fault == Fault::Density {
            &self.other
        } else {
            &self.right
        };
        pdf.pdf(wo, wi, mode)
    }

    fn sample(&self, wo: DVec3, uc: f64, u: [f64; 2], mode: Mode) -> Option<Sample> {
        let s = self.right.sample(wo, uc, u, mode)?;
        let scale = if self.fault == Fault::Weight {
            1.02
        } else {
            1.0
        };
        Some(Sample {
            weight: s.weight * scale,
            ..s
        })
    }

    fn albedo(&self, wo: DVec3) -> Spectrum {
        self.right.albedo(wo)
    }

    fn dispersive_between(&self, wo: DVec3, wi: DVec3) -> bool {
        self.right.dispersive_between(wo, wi)
    }
}

fn glass(alpha: f64) -> Case {
    let mut all = facets(alpha, true).into_iter();
    all.find(|case| case.name.starts_with("glass 1.5"))
        .unwrap_or_else(|| unreachable!("the catalogue has it"))
}

fn faulty(fault: Fault) -> (Case, Faulty) {
    let case = glass(0.3);
    (
        case.clone(),
        Faulty {
            right: case.bsdf,
            other: glass(0.32).bsdf,
            fault,
        },
    )
}

fn all_samples_agree(lobe: &impl Lobe, wo: DVec3) -> bool {
    let mut random = Random::new(7);
    (0..50).all(|_| {
        let (uc, u) = (random.uniform(), [random.uniform(), random.uniform()]);
        let sample = lobe.sample(wo, uc, u, Mode::Radiance);
        sample.is_none_or(|s| sample_agrees(lobe, wo, &s, Mode::Radiance))
    })
}

#[test]
fn a_wrong_weight_is_found() {
    let (case, wrong) = faulty(Fault::Weight);
    let wo = at(0.7, 0.1);
    assert!(all_samples_agree(&case.bsdf, wo));
    assert!(!all_samples_agree(&wrong, wo));
    assert!(throughput(&wrong, case.eta, wo, Mode::Radiance, 4096) > 1.007);
}

#[test]
fn a_wrong_density_is_found() {
    let (case, wrong) = faulty(Fault::Density);
    let wo = directions(&case)[1];
    assert!(p_value(&case, &case.bsdf, wo, Mode::Radiance, 50_000, 9) > 0.001);
    assert!(p_value(&case, &wrong, wo, Mode::Radiance, 50_000, 9) < bound(1000));
    assert!(!all_samples_agree(&wrong, wo));
}

#[test]
fn a_forgotten_square_is_found() {
    let (case, wrong) = faulty(Fault::Squared);
    let (wo, wi) = (at(0.7, 0.1), at(-0.8, 0.6));
    assert!(adjoint(&case.bsdf, wo, wi) && reciprocal(&case.bsdf, case.eta, wo, wi));
    assert!(!adjoint(&wrong, wo, wi) && !reciprocal(&wrong, case.eta, wo, wi));
}

#[test]
fn asymmetry_is_found() {
    let (case, wrong) = faulty(Fault::OneWay);
    let (wo, wi) = (at(0.7, 0.1), at(0.3, 0.6));
    assert!(!adjoint(&wrong, wo, wi) && !reciprocal(&wrong, case.eta, wo, wi));
}

/// Every continuous lobe's chi-square notices if the numbers are drawn for another direction.
#[test]
fn samples_of_another_direction_are_found() {
    struct Turned(Bsdf);
    impl Lobe for Turned {
        fn eval(&self, wo: DVec3, wi: DVec3, mode: Mode) -> Spectrum {
            self.0.eval(wo, wi, mode)
        }
        fn pdf(&self, wo: DVec3, wi: DVec3, mode: Mode) -> f64 {
            self.0.pdf(wo, wi, mode)
        }
        fn sample(&self, wo: DVec3, uc: f64, u: [f64; 2], mode: Mode) -> Option<Sample> {
            // squeezed towards one corner
            self.0.sample(wo, uc, [u[0], u[1] * u[1]], mode)
        }
        fn albedo(&self, wo: DVec3) -> Spectrum {
            self.0.albedo(wo)
        }
    }
    for case in some()
        .into_iter()
        .step_by(7)
        .filter(|case| !case.bsdf.is_delta())
    {
        let wo = directions(&case)[0];
        let p = p_value(&case, &Turned(case.bsdf), wo, Mode::Radiance, 20_000, 11);
        assert!(p < bound(1000), "{}: {p}", case.name);
    }
}
