//! Lens mutation (lens subpaths in Veach 1997, 11.4).

use kaustik_bsdf::Lobe;
use kaustik_mcmc::Draws;

use crate::vertex::VertexKind;
use crate::walk::WalkDirection;
use crate::{Path, PathSpace};

/// Makes the part `D S* E` of `.. (L or D) D S* E` anew from a fresh raster point anywhere in the image: a
/// walk through smooth surfaces to the first one that can be joined. The number of smooth ones may change.
#[derive(Clone, Copy, Debug)]
pub struct LensMutation<'a> {
    /// Where the paths run.
    pub space: &'a PathSpace<'a>,
}

/// Walks of more vertices are not made: room for them would be set aside in every chain.
const MOST_VERTICES: usize = 256;

/// The vertex that is joined, or nothing where the path has another form. Surfaces that scatter in other ways as
/// well must not be passed as smooth ones.
fn joined(path: &Path) -> Option<usize> {
    for i in (1..path.edges()).rev() {
        if path.len() - i > MOST_VERTICES {
            return None;
        }
        if !path.is_specular(i) {
            return (!path.is_specular(i - 1)).then_some(i);
        }
        if path.at(i).bsdf.is_connectable() {
            return None;
        }
    }
    None
}

impl LensMutation<'_> {
    /// Is the path of the kind that this mutation changes?
    pub fn suits(&self, path: &Path) -> bool {
        joined(path).is_some()
    }

    pub(crate) fn mutate<D: Draws + ?Sized>(
        &self,
        x: &Path,
        y: &mut Path,
        draws: &mut D,
    ) -> Option<f64> {
        let space = self.space;
        let kept = joined(x)?;
        let longest = (space.settings.max_edges as usize + 1).min(kept + MOST_VERTICES);
        // Vertices are made at the end of the longest path that there may be, and moved when their number is known.
        y.resize(longest);
        y.tune(x);
        space.begin_at_lens(y, draws);
        if !space.leave_lens(y, draws) {
            return None;
        }
        let mut at = longest - 2;
        loop {
            // What has left the scene has no scattering function: what is there is left over from another path.
            if y.at(at).kind != VertexKind::Surface {
                return None;
            }
            if y.at(at).bsdf.is_connectable() {
                break;
            }
            if at <= kept {
                return None;
            }
            if !space.scatter(y, at, WalkDirection::ToLight, draws) {
                return None;
            }
            at -= 1;
        }
        if at < kept {
            return None;
        }
        y.shift(at, kept);
        y.copy(kept - 1, x, kept - 1..kept);
        if !space.join(y, kept - 1) {
            return None;
        }
        y.copy(0, x, 0..kept - 1);
        if !space.evaluate(y) {
            return None;
        }
        Some(self.density(x, kept) / self.density(y, kept))
    }

    fn density(&self, path: &Path, kept: usize) -> f64 {
        let start = self.space.start_at_lens();
        (kept..path.edges()).fold(start, |product, i| {
            product * self.space.step_to_light_pdf(path, i)
        })
    }
}
