//! What a visit of a Kelemen chain adds to the film (Kelemen sec. 5).

use kaustik_film::Film;
use kaustik_mcmc::{Recorder, Visit};
use kaustik_path::{Class, Contributions};

/// How large steps, which are independent samples, are put to use a second time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mis {
    /// Two films. The weights sum to one for every `b0`, so only the estimate of `b` that scales the first
    /// film contributes an error.
    #[default]
    Split,
    /// One film as Kelemen's eq. 1 and 2 print it: biased by the error of `b`.
    Printed,
    /// Expected values alone (Kelemen sec. 1.2).
    Off,
}

/// From raster to pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    /// Columns of the full image.
    pub width: f64,
    /// Rows of the full image.
    pub height: f64,
}

impl Scale {
    /// Adds all splats of a value, times a weight. Neighbours in the list that fall on one point (the
    /// classes of a camera walk) go to the film as one.
    #[inline]
    pub fn splat(self, film: &Film, value: &Contributions, weight: f64) {
        for group in value.splats().chunk_by(|a, b| a.raster == b.raster) {
            let raster = group[0].raster;
            let xyz = group.iter().map(|splat| splat.xyz).sum();
            film.splat_weighted(raster.x * self.width, raster.y * self.height, xyz, weight);
        }
    }

    /// As [`splat`](Self::splat), for the classes that are wanted.
    #[inline]
    pub fn splat_classes(
        self,
        film: &Film,
        value: &Contributions,
        weight: f64,
        wanted: impl Fn(Class) -> bool,
    ) {
        for group in value.splats().chunk_by(|a, b| a.raster == b.raster) {
            let mut some = group.iter().filter(|splat| wanted(splat.class)).peekable();
            if some.peek().is_some() {
                let raster = group[0].raster;
                let xyz = some.map(|splat| splat.xyz).sum();
                film.splat_weighted(raster.x * self.width, raster.y * self.height, xyz, weight);
            }
        }
    }
}

/// Takes the visits of chains whose density is `I*`.
///
/// With [`Mis::Split`] the image is `(b / b0) chain + large`, with [`Mis::Printed`] it is
/// `chain`, with [`Mis::Off`] it is `(b / b0) chain`; each times raster area in pixels over mutations.
#[derive(Debug)]
pub struct KelemenDeposit<'a> {
    /// Deposits of the chain.
    pub chain: &'a Film,
    /// Deposits of large steps as independent samples ([`Mis::Split`] only).
    pub large: Option<&'a Film>,
    /// Raster to pixels.
    pub scale: Scale,
    /// The constant in the weights: a rough estimate of `b`, never changed; 0 where nothing is known of it, and large steps count
    /// as independent samples alone.
    pub b0: f64,
    /// Probability of a large step.
    pub p_large: f64,
    /// Which weights.
    pub mis: Mis,
}

impl Recorder<Contributions, 1> for KelemenDeposit<'_> {
    #[inline]
    fn record(&mut self, visit: Visit<'_, Contributions, 1>) {
        let density = visit.density();
        if density <= 0.0 {
            return;
        }
        // Kelemen eqs. 1 and 2: the sum of both techniques' densities, per mutation.
        let (of_chain, weight) = if self.b0 > 0.0 {
            (density / self.b0, visit.weight)
        } else {
            (0.0, 0.0)
        };
        let combined = of_chain + self.p_large;
        match self.mis {
            Mis::Split => {
                self.add(self.chain, &visit, weight / combined);
                if let Some(large) = self.large {
                    self.add(large, &visit, visit.independent / combined);
                }
            }
            Mis::Printed => {
                self.add(self.chain, &visit, (weight + visit.independent) / combined);
            }
            Mis::Off => self.add(self.chain, &visit, weight * self.b0 / density),
        }
    }
}

impl KelemenDeposit<'_> {
    #[inline]
    fn add(&self, film: &Film, visit: &Visit<'_, Contributions, 1>, weight: f64) {
        if weight > 0.0 {
            self.scale.splat(film, visit.value, weight);
        }
    }
}

#[cfg(test)]
mod tests {
    use kaustik_film::{Layout, Quantum};
    use kaustik_path::Class;
    use kaustik_spectrum::Xyz;

    use super::*;

    /// X of the two films after one visit of density 2, weight 0.7, that is independent as well.
    fn films(b0: f64, mis: Mis) -> [f64; 2] {
        let film = || Film::with_layout(&Layout::new(1, 1), Quantum::from_mean(1.0));
        let [chain, large] = [(); 2].map(|()| film().expect("a pixel"));
        let mut value = Contributions::default();
        value.push([0.5, 0.5].into(), Xyz([2.0 / 3.0; 3]), Class::ALL[0]);
        let mut deposit = KelemenDeposit {
            chain: &chain,
            large: (mis == Mis::Split).then_some(&large),
            scale: Scale {
                width: 1.0,
                height: 1.0,
            },
            b0,
            p_large: 0.25,
            mis,
        };
        deposit.record(Visit {
            level: 0,
            value: &value,
            densities: &[2.0],
            weight: 0.7,
            independent: 1.0,
        });
        [&chain, &large].map(|film| {
            let x = film.sums().next().unwrap_or_default() as f64;
            x * film.quantum().value() * 1.5
        })
    }

    /// Weights of the chain and of independent samples: 0.7 and 1 over the sum of their densities.
    #[test]
    fn visits_are_weighed_by_both_ways_to_find_them() {
        let near = |found: [f64; 2], wanted: [f64; 2]| {
            (found.iter().zip(wanted)).all(|(found, wanted)| (found - wanted).abs() < 1e-5)
        };
        let all = 2.0 / 0.5 + 0.25;
        assert!(near(films(0.5, Mis::Split), [0.7 / all, 1.0 / all]));
        assert!(near(films(0.5, Mis::Printed), [1.7 / all, 0.0]));
        assert!(near(films(0.5, Mis::Off), [0.7 * 0.25, 0.0]));
        // A chain whose constant nobody knows has no part in it.
        assert!(near(films(0.0, Mis::Split), [0.0, 4.0]));
        assert!(near(films(0.0, Mis::Printed), [4.0, 0.0]));
        assert!(near(films(0.0, Mis::Off), [0.0, 0.0]));
    }
}
