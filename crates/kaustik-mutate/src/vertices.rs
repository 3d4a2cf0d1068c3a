//! Vertices of a path in a row, wherever they are kept.

use kaustik_spectrum::Wavelengths;

use crate::Path;
use crate::vertex::PathVertex;

/// Vertices from the emitter to the lens.
pub(crate) trait Vertices {
    /// How many.
    fn len(&self) -> usize;

    /// One of them, 0 at the emitter.
    fn at(&self, i: usize) -> &PathVertex;

    /// Those of the light on the path.
    fn wavelengths(&self) -> &Wavelengths;
}

impl Vertices for Path {
    #[inline]
    fn len(&self) -> usize {
        self.len()
    }

    #[inline]
    fn at(&self, i: usize) -> &PathVertex {
        self.at(i)
    }

    #[inline]
    fn wavelengths(&self) -> &Wavelengths {
        &self.wavelengths
    }
}

/// Three pieces, one after the other: of a walk from the light, of what was joined, and of a walk from the eye.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pieces<'a> {
    pub(crate) vertices: [&'a [PathVertex]; 3],
    pub(crate) wavelengths: &'a Wavelengths,
}

impl Vertices for Pieces<'_> {
    #[inline]
    fn len(&self) -> usize {
        self.vertices.iter().map(|piece| piece.len()).sum()
    }

    #[inline]
    fn at(&self, i: usize) -> &PathVertex {
        let [light, joined, eye] = self.vertices;
        let from_joint = i.wrapping_sub(light.len());
        match light.get(i) {
            Some(vertex) => vertex,
            None => match joined.get(from_joint) {
                Some(vertex) => vertex,
                None => &eye[from_joint - joined.len()],
            },
        }
    }

    #[inline]
    fn wavelengths(&self) -> &Wavelengths {
        self.wavelengths
    }
}
