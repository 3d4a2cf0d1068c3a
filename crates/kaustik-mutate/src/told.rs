//! Paths and what chains do with them, told to whoever listens ([`kaustik_path::trace`]).

use glam::DVec3;
use kaustik_mcmc::{Draws, Family, Kernel, Move, acceptance};
use kaustik_path::{Event, Role, Stand, is_listening, note};
use kaustik_scene::EmitterPoint;
use kaustik_spectrum::Spectrum;

use crate::vertex::VertexKind;
use crate::{Path, PathSpace};

/// A kernel that tells what it proposes and what becomes of it. In a render nobody listens, and a proposal
/// costs a few looks at one flag of the thread.
#[derive(Clone, Copy, Debug)]
pub struct Told<'a, N, F> {
    /// Makes the proposals.
    pub kernel: N,
    /// The density that the chain follows.
    pub family: F,
    /// Where paths run.
    pub space: &'a PathSpace<'a>,
    /// A name for each kind of move.
    pub names: &'static [&'static str],
}

#[deny(clippy::missing_trait_methods)]
impl<N: Kernel<(), Value = Path>, F: Family<Path, 1>> Kernel<()> for Told<'_, N, F> {
    type Value = Path;

    #[inline]
    fn propose<D: Draws + ?Sized>(
        &self,
        state: &mut (),
        current: &Path,
        proposed: &mut Path,
        draws: &mut D,
    ) -> Move {
        let made = self.kernel.propose(state, current, proposed, draws);
        if is_listening() {
            self.space.tell(current, Role::Current);
            // Of a move that leads nowhere there is no path.
            let density = |path: &Path| self.family.densities(path)[0];
            let there = if made.ratio > 0.0 {
                self.space.tell(proposed, Role::Proposed);
                density(proposed)
            } else {
                0.0
            };
            note(|| Event::Proposal {
                kernel: self.names.get(made.kind).copied().unwrap_or_default(),
                ratio: made.ratio,
                acceptance: acceptance(density(current), there, made.ratio),
            });
        }
        made
    }

    fn accept(&self, state: &mut ()) {
        self.kernel.accept(state);
    }

    fn reject(&self, state: &mut ()) {
        self.kernel.reject(state);
    }

    fn enter<D: Draws + ?Sized>(&self, state: &mut (), draws: &mut D) {
        self.kernel.enter(state, draws);
    }

    fn exchange<D: Draws + ?Sized>(&self, a: &mut (), b: &mut (), draws: &mut D) {
        self.kernel.exchange(a, b, draws);
    }

    #[inline]
    fn accept_move(&self, state: &mut (), proposal: &Move) {
        note(|| Event::Decision { accepted: true });
        self.kernel.accept_move(state, proposal);
    }

    #[inline]
    fn reject_move(&self, state: &mut (), proposal: &Move) {
        note(|| Event::Decision { accepted: false });
        self.kernel.reject_move(state, proposal);
    }
}

impl PathSpace<'_> {
    /// Tells of a path, vertex by vertex from the emitter to the lens.
    pub fn tell(&self, path: &Path, role: Role) {
        if !is_listening() {
            return;
        }
        note(|| Event::Path {
            role,
            raster: path.raster(),
            density: path.density(),
            colour: path.colour(),
        });
        self.at(path.time, |space| {
            for index in 0..path.len() {
                note(|| space.told(path, index));
            }
        });
    }

    fn told(&self, path: &Path, index: usize) -> Event {
        let at = path.at(index);
        let toward = || path.at(index + 1).toward_light;
        let (stand, position) = match at.kind {
            VertexKind::Surface => (Stand::Surface, at.vertex.position),
            VertexKind::Lens => (Stand::Lens, at.vertex.position),
            VertexKind::Emitter(EmitterPoint::Surface) => (Stand::Emitter, at.vertex.position),
            VertexKind::Emitter(EmitterPoint::Environment(toward)) => (Stand::Distant, toward),
            VertexKind::Emitter(EmitterPoint::Punctual(lamp)) => {
                match self.scene.punctual_position(lamp) {
                    Some(position) => (Stand::Emitter, position),
                    None => (Stand::Distant, toward()),
                }
            }
        };
        let on_surface = matches!(
            at.kind,
            VertexKind::Surface | VertexKind::Emitter(EmitterPoint::Surface)
        );
        let normal = |normal| if on_surface { normal } else { DVec3::ZERO };
        Event::PathVertex {
            index: index as u32,
            stand,
            position,
            normal: normal(at.vertex.normal),
            shading: normal(at.vertex.frame.z),
            material: on_surface.then_some(at.vertex.material),
            specular: at.specular,
            transmitted: at.specular && at.transmitted,
            value: match stand {
                Stand::Lens => Spectrum::ONE,
                _ => at.value,
            },
        }
    }
}
