//! What a filter of redistribution took away of a picture (Batty sec. 4.2 and 6).

use kaustik_film::{Film, Layer, develop, develop_xyz};
use kaustik_path::ScalarTarget;
use kaustik_spectrum::Xyz;

use crate::RenderError;

/// A layer, and its share of the light.
pub(crate) struct Lost {
    name: &'static str,
    /// Linear Rec.709 planes: the unfiltered picture less the filtered one.
    difference: [Vec<f32>; 3],
    /// The scalar of it, as a share of all light.
    pub(crate) share: f64,
}

impl Lost {
    /// Of a filter: what it took away, and of how much, in the scalar that chains follow.
    pub(crate) fn new(
        name: &'static str,
        difference: [Vec<f32>; 3],
        [away, all]: [f64; 2],
    ) -> Self {
        Self {
            name,
            difference,
            share: if all > 0.0 { away / all } else { 0.0 },
        }
    }

    /// What the filter by consecutive samples kept off the picture, on a film of its own; the films of the picture. Each
    /// with what turns its sums into means.
    pub(crate) fn held(
        held: (&Film, f64),
        picture: &[(&Film, f64)],
        target: ScalarTarget,
    ) -> Result<Self, RenderError> {
        let (away, kept) = (sum(&[held], target)?, sum(picture, target)?);
        let difference = develop(&[held])?;
        let difference = difference.rgb().map(<[f32]>::to_vec);
        Ok(Self::new("consecutive", difference, [away, away + kept]))
    }

    pub(crate) fn layer(&self) -> Layer {
        let channels = ["R", "G", "B"]
            .into_iter()
            .zip(self.difference.iter().cloned());
        Layer::new(self.name, channels.collect())
    }
}

/// The scalar of all light on films.
pub(crate) fn sum(films: &[(&Film, f64)], target: ScalarTarget) -> Result<f64, RenderError> {
    Ok(scalars(films, |xyz| target.of(xyz))?.iter().sum())
}

/// A number of each pixel of films, each with what turns its sums into means.
pub(crate) fn scalars(
    films: &[(&Film, f64)],
    of: impl Fn(Xyz) -> f64,
) -> Result<Vec<f64>, RenderError> {
    let image = develop_xyz(films)?;
    let [x, y, z] = image.rgb();
    let pixels = x.iter().zip(y).zip(z);
    Ok(pixels.map(|((&x, &y), &z)| of(Xyz([x, y, z]))).collect())
}
