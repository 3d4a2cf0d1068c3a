//! glTF materials in pieces: where a texture gives the base colour, all else is the same at each point.

use kaustik_spectrum::Spectrum;

use super::body::Body;
use super::clear::Clear;
use super::{Glossy, Principled};
use crate::shared::Shared;

/// The pieces.
#[derive(Clone, Debug, Default)]
pub(crate) struct PrincipledStore {
    glossy: Shared<Glossy>,
    /// Without their colours.
    bodies: Shared<Body>,
    colours: Shared<Spectrum>,
    /// Colours of what bodies let through.
    through: Shared<Spectrum>,
    clear: Shared<Option<Clear>>,
    /// All but the colour.
    rests: Shared<Rest>,
}

/// The numbers of one material's pieces; or what the numbers of another store's pieces grow by in this one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PrincipledPieces {
    rest: u32,
    colour: u32,
}

/// The numbers of a material's pieces without its colour.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Rest {
    glossy: u32,
    body: u32,
    through: u32,
    clear: u32,
}

impl PrincipledStore {
    pub(crate) fn number(&mut self, whole: &Principled) -> PrincipledPieces {
        let rest = Rest {
            glossy: self.glossy.number(&whole.glossy),
            body: self.bodies.number(&whole.body.blackened()),
            through: self.through.number(&whole.body.through()),
            clear: self.clear.number(&whole.clear),
        };
        PrincipledPieces {
            rest: self.rests.number(&rest),
            colour: self.colours.number(&whole.body.colour()),
        }
    }

    #[inline]
    pub(crate) fn get(&self, pieces: PrincipledPieces) -> Principled {
        let rest = self.rests.get(pieces.rest);
        Principled {
            glossy: self.glossy.get(rest.glossy),
            body: (self.bodies.get(rest.body)).coloured(
                self.colours.get(pieces.colour),
                self.through.get(rest.through),
            ),
            clear: self.clear.get(rest.clear),
        }
    }

    pub(crate) fn append(&mut self, other: &Self) -> PrincipledPieces {
        let glossy = self.glossy.append(&other.glossy);
        let body = self.bodies.append(&other.bodies);
        let through = self.through.append(&other.through);
        let clear = self.clear.append(&other.clear);
        let moved = |rest: &Rest| Rest {
            glossy: glossy + rest.glossy,
            body: body + rest.body,
            through: through + rest.through,
            clear: clear + rest.clear,
        };
        PrincipledPieces {
            rest: self.rests.append_as(&other.rests, moved),
            colour: self.colours.append(&other.colours),
        }
    }

    pub(crate) fn clear(&mut self) {
        self.glossy.clear();
        self.bodies.clear();
        self.colours.clear();
        self.through.clear();
        self.clear.clear();
        self.rests.clear();
    }

    pub(crate) fn bytes(&self) -> usize {
        self.glossy.bytes()
            + self.bodies.bytes()
            + self.colours.bytes()
            + self.through.bytes()
            + self.clear.bytes()
            + self.rests.bytes()
    }
}

impl PrincipledPieces {
    #[must_use]
    pub(crate) fn after(self, first: Self) -> Self {
        Self {
            rest: first.rest + self.rest,
            colour: first.colour + self.colour,
        }
    }
}
