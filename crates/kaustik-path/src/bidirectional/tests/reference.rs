//! Weights by the walk over all strategies of a whole path.

use glam::DVec3;
use kaustik_bsdf::{Bsdf, Frame, Lobe, Mode};
use kaustik_scene::EmissionPdf;

use crate::Heuristic;
use crate::bidirectional::form::Onward;

/// A vertex of a whole path.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    pub(super) position: DVec3,
    pub(super) kind: Kind,
}

#[derive(Clone, Copy, Debug)]
#[expect(clippy::large_enum_variant, reason = "most are surfaces")]
pub(super) enum Kind {
    /// x_0; `toward` is the direction to it from x_1.
    Emitter {
        pdf: EmissionPdf,
        toward: DVec3,
    },
    Surface(Surface),
    /// x_{n-1}.
    Lens(Lens),
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Surface {
    pub(super) normal: DVec3,
    pub(super) frame: Frame,
    pub(super) bsdf: Bsdf,
    pub(super) onward: Onward,
    /// Scatters into a Dirac direction on this path.
    pub(super) delta: bool,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Lens {
    /// Density of the point; `None` where no ray can run into the lens.
    pub(super) pdf: Option<f64>,
    /// Density of the first direction, per solid angle or, with parallel rays, per area.
    pub(super) direction: f64,
    pub(super) cos: f64,
    pub(super) parallel: bool,
}

/// A whole path, from the light to the eye.
#[derive(Clone, Debug)]
pub(super) struct Path {
    pub(super) nodes: Vec<Node>,
    /// How much more often next event from x_1 chooses the emitter than light walks do.
    pub(super) choice: f64,
    pub(super) at_emitter: Onward,
    pub(super) at_lens: Onward,
}

/// What is wrong with a weight.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fault {
    None,
    /// One strategy is left out of the sum of the others.
    Without(usize),
    /// The area density of a vertex lacks the cosine there.
    NoCosine,
    /// Next event is taken to choose its emitter as light walks do.
    EvenChoice,
}

/// Densities of all vertices both ways, and the odds of all strategies.
#[derive(Clone, Debug, Default)]
pub(super) struct Densities {
    pub(super) forward: Vec<f64>,
    pub(super) reverse: Vec<f64>,
    pub(super) odds: Vec<f64>,
}

impl Path {
    pub(super) fn len(&self) -> usize {
        self.nodes.len()
    }

    pub(super) fn surface(&self, i: usize) -> &Surface {
        match &self.nodes[i].kind {
            Kind::Surface(surface) => surface,
            _ => panic!("vertex {i} is an end"),
        }
    }

    pub(super) fn emitter(&self) -> &EmissionPdf {
        match &self.nodes[0].kind {
            Kind::Emitter { pdf, .. } => pdf,
            _ => panic!("the path begins at an emitter"),
        }
    }

    pub(super) fn lens(&self) -> &Lens {
        match &self.nodes[self.len() - 1].kind {
            Kind::Lens(lens) => lens,
            _ => panic!("the path ends at the lens"),
        }
    }

    /// Unit direction from a surface to its neighbour.
    pub(super) fn toward(&self, i: usize, neighbour: usize) -> DVec3 {
        match &self.nodes[neighbour].kind {
            Kind::Emitter { toward, .. } => *toward,
            _ => (self.nodes[neighbour].position - self.nodes[i].position).normalize(),
        }
    }

    /// Square of the distance between neighbours; 1 where directions are drawn per area.
    pub(super) fn squared(&self, i: usize, j: usize) -> f64 {
        for end in [i, j] {
            match &self.nodes[end].kind {
                Kind::Emitter { pdf, .. } if pdf.infinite => return 1.0,
                Kind::Lens(lens) if lens.parallel => return 1.0,
                _ => {}
            }
        }
        (self.nodes[i].position - self.nodes[j].position).length_squared()
    }

    /// Geometric cosine at `i` of the edge to a neighbour.
    pub(super) fn cos(&self, i: usize, neighbour: usize) -> f64 {
        match &self.nodes[i].kind {
            Kind::Emitter { pdf, .. } => pdf.cos,
            Kind::Lens(lens) => lens.cos,
            Kind::Surface(surface) => surface.normal.dot(self.toward(i, neighbour)).abs(),
        }
    }

    /// Density with which a walk that came to `i` from `from` goes on to `to`.
    fn direction_pdf(&self, from: usize, i: usize, to: usize, mode: Mode) -> f64 {
        let surface = self.surface(i);
        if surface.delta {
            return 1.0;
        }
        let local = |to| surface.frame.to_local(self.toward(i, to));
        surface.bsdf.pdf(local(from), local(to), mode)
    }

    pub(super) fn densities(&self, fault: Fault) -> Densities {
        let n = self.len();
        let last = n - 1;
        let area = |pdf: f64, i: usize, from: usize| {
            let cos = if fault == Fault::NoCosine {
                1.0
            } else {
                self.cos(i, from)
            };
            pdf * cos / self.squared(i, from)
        };
        let (emitter, lens) = (self.emitter(), self.lens());
        let mut densities = Densities {
            forward: vec![emitter.position, area(emitter.direction, 1, 0)],
            reverse: vec![0.0; n],
            odds: Vec::new(),
        };
        for i in 2..n {
            let pdf = self.direction_pdf(i - 2, i - 1, i, Mode::Importance);
            densities.forward.push(area(pdf, i, i - 1));
        }
        densities.reverse[last] = lens.pdf.unwrap_or(1.0);
        densities.reverse[last - 1] = area(lens.direction, last - 1, last);
        for i in (0..last - 1).rev() {
            let pdf = self.direction_pdf(i + 2, i + 1, i, Mode::Radiance);
            densities.reverse[i] = area(pdf, i, i + 1);
        }
        densities.odds = (0..=n).map(|s| self.odds(s)).collect();
        if n > 2 && fault != Fault::EvenChoice {
            densities.odds[1] *= self.choice;
        }
        densities
    }

    /// How often strategy `s` is tried for each time that all walks go on.
    fn odds(&self, s: usize) -> f64 {
        let n = self.len();
        let of = |i: usize| match &self.nodes[i].kind {
            Kind::Emitter { .. } => self.at_emitter.odds(),
            Kind::Lens(_) => self.at_lens.odds(),
            Kind::Surface(surface) if surface.delta => 0.0,
            Kind::Surface(surface) => surface.onward.odds(),
        };
        if n == 2 {
            return f64::from(u8::from(s == 0));
        }
        match s {
            0 if self.emitter().hittable => 1.0 / self.at_emitter.onward,
            0 => 0.0,
            s if s == n && self.lens().pdf.is_some() => 1.0 / self.at_lens.onward,
            s if s == n => 0.0,
            s => of(s - 1) * of(s),
        }
    }
}

impl Densities {
    /// Ratio of the density of every strategy to that of `s`.
    fn ratios(&self, s: usize) -> Vec<f64> {
        let n = self.forward.len();
        let mut ratios = vec![1.0; n + 1];
        for i in s..n {
            ratios[i + 1] = ratios[i] * self.forward[i] / self.reverse[i];
        }
        for i in (0..s).rev() {
            ratios[i] = ratios[i + 1] * self.reverse[i] / self.forward[i];
        }
        let own = self.odds[s];
        (0..=n).map(|i| ratios[i] * self.odds[i] / own).collect()
    }

    /// The weight of strategy `s`; 0 where it cannot make the path.
    pub(super) fn weight(&self, heuristic: Heuristic, s: usize, fault: Fault) -> f64 {
        if self.odds[s] == 0.0 {
            return 0.0;
        }
        let counts = |i: usize| fault != Fault::Without(i) && self.odds[i] > 0.0;
        let ratios = self.ratios(s);
        let rivals = || (0..ratios.len()).filter(|&i| i != s && counts(i));
        match heuristic {
            Heuristic::Maximum => {
                let beaten = rivals().any(|i| {
                    let ratio = ratios[i];
                    ratio > 1.0 || (i < s && ratio >= 1.0)
                });
                f64::from(u8::from(!beaten))
            }
            Heuristic::Balance => 1.0 / (1.0 + rivals().map(|i| ratios[i]).sum::<f64>()),
            Heuristic::Power => {
                let sum: f64 = rivals().map(|i| ratios[i] * ratios[i]).sum();
                1.0 / (1.0 + sum)
            }
        }
    }
}
