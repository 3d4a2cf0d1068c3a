//! What a visit of a Kelemen chain adds to the film (Kelemen sec. 5).

use kaustik_film::Film;
use kaustik_mcmc::{Recorder, Visit};
use kaustik_path::{Class, Contributions};

/// How large steps, which are independent samples, are put to use a second time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mis {
    /// Two films whose heuristic weights sum to one for every constant `b0`: only the `b` that scales the first errs.
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
    /// The constant in the weights, > 0: a rough estimate of `b`, never changed.
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
        let combined = density / self.b0 + self.p_large;
        match self.mis {
            Mis::Split => {
                self.add(self.chain, &visit, visit.weight / combined);
                if let Some(large) = self.large {
                    self.add(large, &visit, visit.independent / combined);
                }
            }
            Mis::Printed => {
                self.add(
                    self.chain,
                    &visit,
                    (visit.weight + visit.independent) / combined,
                );
            }
            Mis::Off => self.add(self.chain, &visit, visit.weight * self.b0 / density),
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
