use glam::DVec3;
use kaustik_bsdf::{Bsdf, Frame, Lobe, Mode};
use kaustik_mcmc::{Draws, Pcg64Dxsm, generator};
use kaustik_scene::{EmissionPdf, Vertex};
use kaustik_spectrum::Spectrum;

use super::reference::{Fault, Kind, Lens, Node, Path, Surface};
use crate::bidirectional::joined::Joined;
use crate::bidirectional::running::{Departure, End, Running};
use crate::bidirectional::vertex::PathVertex;
use crate::bidirectional::weights::{DirectEnd, LensEnd, Weights};
use crate::{Form, Heuristic};

const HEURISTICS: [Heuristic; 3] = [Heuristic::Balance, Heuristic::Power, Heuristic::Maximum];

fn within(u: &mut Pcg64Dxsm, low: f64, high: f64) -> f64 {
    low + (high - low) * u.uniform()
}

fn direction(u: &mut Pcg64Dxsm) -> DVec3 {
    let z = within(u, -1.0, 1.0);
    let phi = within(u, 0.0, std::f64::consts::TAU);
    let across = (1.0 - z * z).sqrt();
    DVec3::new(across * phi.cos(), across * phi.sin(), z)
}

/// A point of a plane or of a sphere with its normal.
fn place(u: &mut Pcg64Dxsm) -> (DVec3, DVec3) {
    let centre = direction(u) * within(u, 0.0, 3.0);
    let normal = direction(u);
    if u.bernoulli(0.5) {
        (centre + normal * within(u, 0.1, 1.0), normal)
    } else {
        let frame = Frame::from_z(normal);
        let across = frame.x * within(u, -2.0, 2.0) + frame.y * within(u, -2.0, 2.0);
        (centre + across, normal)
    }
}

fn bsdf(u: &mut Pcg64Dxsm) -> Bsdf {
    let grey = Spectrum::splat(within(u, 0.1, 0.9) as f32);
    match u.index(&[1.0; 4]) {
        0 => Bsdf::lambertian(grey),
        1 => Bsdf::phong(grey * 0.5, grey * 0.4, within(u, 1.0, 40.0)),
        2 => Bsdf::coated(grey, 1.5),
        _ => Bsdf::metal(grey, Spectrum::ONE, within(u, 0.2, 1.0), true),
    }
}

/// A random path of `n` vertices, each a Dirac scattering with probability `delta`. Densities are
/// functions of both directions at a vertex alone, so that it need not be a path that light takes.
fn path(u: &mut Pcg64Dxsm, form: Form, n: usize, delta: f64) -> Path {
    let mut nodes = Vec::new();
    let infinite = u.bernoulli(0.3);
    let pdf = EmissionPdf {
        position: within(u, 0.1, 3.0),
        direction: within(u, 0.1, 3.0),
        cos: if infinite { 1.0 } else { within(u, 0.1, 1.0) },
        infinite,
        hittable: u.bernoulli(0.7),
        emitter: 0,
    };
    // Sometimes next event never chooses an emitter that light walks begin at.
    let choice = [1.0, 0.0, within(u, 0.1, 3.0)][u.index(&[0.45, 0.1, 0.45])];
    let position = place(u).0;
    let toward = direction(u);
    nodes.push(Node {
        position,
        kind: Kind::Emitter { pdf, toward },
    });
    for _ in 1..n - 1 {
        let (position, normal) = place(u);
        let frame = Frame::from_z((normal + direction(u) * 0.2).normalize());
        let delta = u.bernoulli(delta);
        // A Dirac event may happen on a surface that could be joined as well.
        let bsdf = if delta && u.bernoulli(0.5) {
            Bsdf::mirror(Spectrum::ONE)
        } else {
            bsdf(u)
        };
        nodes.push(Node {
            position,
            kind: Kind::Surface(Surface {
                normal,
                frame,
                bsdf,
                onward: form.at_surface(&bsdf),
                delta,
            }),
        });
    }
    let parallel = u.bernoulli(0.2);
    let lens = Lens {
        pdf: (!parallel && u.bernoulli(0.5)).then(|| within(u, 0.1, 3.0)),
        direction: within(u, 0.1, 3.0),
        cos: if parallel { 1.0 } else { within(u, 0.1, 1.0) },
        parallel,
    };
    nodes.push(Node {
        position: place(u).0,
        kind: Kind::Lens(lens),
    });
    if !infinite {
        let first = (nodes[0].position - nodes[1].position).normalize();
        nodes[0].kind = Kind::Emitter { pdf, toward: first };
    }
    Path {
        nodes,
        choice,
        at_emitter: form.at_emitter(),
        at_lens: form.at_lens(),
    }
}

/// All vertices on surfaces as the subpath from one end would store them, index `i` at `[i]`, and what
/// runs to the other end.
fn subpath(path: &Path, heuristic: Heuristic, from_light: bool) -> (Vec<PathVertex>, Running) {
    let n = path.len();
    let order: Vec<usize> = if from_light {
        (0..n).collect()
    } else {
        (0..n).rev().collect()
    };
    let (end, onward) = if from_light {
        let pdf = path.emitter();
        let end = End {
            position: if pdf.hittable { pdf.position } else { 0.0 },
            direction: pdf.direction,
            cos: pdf.cos,
            infinite: pdf.infinite,
        };
        (end, path.at_emitter)
    } else {
        let lens = path.lens();
        let end = End {
            position: lens.pdf.unwrap_or(0.0),
            direction: lens.direction,
            cos: lens.cos,
            infinite: lens.parallel,
        };
        (end, path.at_lens)
    };
    let mut departure = Departure::from_end(heuristic, end, onward.onward, onward.odds());
    let mut vertices = vec![PathVertex::default(); n];
    for at in 1..n - 1 {
        let (before, i, after) = (order[at - 1], order[at], order[at + 1]);
        let surface = path.surface(i);
        let edge = (path.squared(i, before), path.cos(i, before));
        let running = match from_light && at == 1 {
            true => departure.arrive_first(heuristic, edge, path.choice),
            false => departure.arrive(heuristic, edge.0, edge.1),
        };
        let vertex = PathVertex {
            vertex: Vertex {
                position: path.nodes[i].position,
                normal: surface.normal,
                frame: surface.frame,
                ..Vertex::default()
            },
            bsdf: surface.bsdf,
            wo: surface.frame.to_local(path.toward(i, before)),
            ng: surface.frame.to_local(surface.normal),
            running,
            onward: surface.onward,
            edges: at as u32,
            ..PathVertex::default()
        };
        let wi = surface.frame.to_local(path.toward(i, after));
        let (mode, reverse) = if from_light {
            (Mode::Importance, Mode::Radiance)
        } else {
            (Mode::Radiance, Mode::Importance)
        };
        let (densities, odds) = if surface.delta {
            ([1.0; 2], 0.0)
        } else {
            let pdf = surface.bsdf.pdf(vertex.wo, wi, mode);
            let back = surface.bsdf.pdf(wi, vertex.wo, reverse);
            ([pdf, back], surface.onward.odds())
        };
        let cos = path.cos(i, after);
        departure = Departure::from_surface(heuristic, &vertex.running, densities, cos, odds);
        vertices[i] = vertex;
    }
    let (last, before) = (order[n - 1], order[n - 2]);
    let cos = path.cos(last, before);
    let running = departure.arrive(heuristic, path.squared(last, before), cos);
    (vertices, running)
}

/// The weights of all strategies as the builder has them; 0 where a strategy cannot make the path.
fn running_weights(path: &Path, form: Form, heuristic: Heuristic) -> Vec<f64> {
    let n = path.len();
    let weights = Weights { form, heuristic };
    let (light, at_lens) = subpath(path, heuristic, true);
    let (eye, at_emitter) = subpath(path, heuristic, false);
    let (emitter, lens) = (path.emitter(), path.lens());
    let local = |i: usize, to: usize| path.surface(i).frame.to_local(path.toward(i, to));
    (0..=n)
        .map(|s| match s {
            0 if !emitter.hittable => 0.0,
            0 => weights.implicit(n as u32 - 1, emitter, || path.choice, &at_emitter),
            s if s == n => lens.pdf.map_or(0.0, |position| {
                weights.lens_hit(&at_lens, position, lens.direction)
            }),
            s if n > 2 && (1..n - 1).contains(&s) && path.surface(s).delta => 0.0,
            s if s > 1 && path.surface(s - 1).delta => 0.0,
            1 if path.choice == 0.0 => 0.0,
            1 => {
                let squared = path.squared(0, 1);
                let cos = path.cos(0, 1);
                // at infinity the position's density is per solid angle
                let found = path.choice * emitter.position * squared
                    / if emitter.infinite { 1.0 } else { cos };
                let end = DirectEnd {
                    pdf: emitter.hittable.then_some(found),
                    odds: path.choice,
                    emission_pdf: emitter.direction,
                    squared,
                };
                let z = Joined::new(&eye[1], local(1, 0), Mode::Radiance);
                weights.direct(&z, &end)
            }
            s if s == n - 1 => {
                let squared = path.squared(n - 1, n - 2);
                let end = LensEnd {
                    raster: lens.direction / squared,
                    squared,
                    cos: lens.cos,
                    pdf: lens.pdf,
                };
                let wy = local(n - 2, n - 1);
                let y = Joined::new(&light[n - 2], wy, Mode::Importance);
                weights.lens_joined(&y, &end)
            }
            s => {
                let y = Joined::new(&light[s - 1], local(s - 1, s), Mode::Importance);
                let z = Joined::new(&eye[s], local(s, s - 1), Mode::Radiance);
                weights.joined(&y, &z, path.squared(s - 1, s))
            }
        })
        .collect()
}

/// Differences between the builder's weights and their definition, and of their sum from 1: the
/// largest of many paths.
fn worst(form: Form, heuristic: Heuristic, paths: u32, fault: Fault) -> (f64, f64) {
    let mut u = generator(21, u64::from(form == Form::Simple));
    let (mut difference, mut sum_off) = (0.0_f64, 0.0_f64);
    let mut used = 0;
    for _ in 0..paths {
        let n = 3 + u.index(&[1.0; 6]);
        let delta = [0.0, 0.3, 0.7][u.index(&[1.0; 3])];
        let path = path(&mut u, form, n, delta);
        let densities = path.densities(fault);
        let all = densities.forward.iter().chain(&densities.reverse);
        if !all.clone().all(|p| *p > 0.0 && p.is_finite()) {
            continue; // not a path: directions on different sides of an opaque surface
        }
        if densities.odds.iter().all(|&odds| odds == 0.0) {
            continue;
        }
        used += 1;
        let running = running_weights(&path, form, heuristic);
        let sum: f64 = running.iter().sum();
        sum_off = sum_off.max((sum - 1.0).abs());
        for (s, weight) in running.iter().enumerate() {
            let wanted = densities.weight(heuristic, s, fault);
            difference = difference.max((weight - wanted).abs());
        }
    }
    assert!(used > paths / 200, "only {used} paths");
    (difference, sum_off)
}

const PATHS: u32 = 60_000;

#[test]
fn running_weights_are_the_walk_and_sum_to_one() {
    for form in [Form::Full, Form::Simple] {
        for heuristic in HEURISTICS {
            let (difference, sum_off) = worst(form, heuristic, PATHS, Fault::None);
            assert!(difference < 1e-9, "{form:?}, {heuristic:?}: {difference}");
            assert!(sum_off < 1e-9, "{form:?}, {heuristic:?}: {sum_off}");
        }
    }
}

/// The test of the test: a walk that forgets a strategy, or a cosine, is not the same.
#[test]
fn a_wrong_walk_is_noticed() {
    for heuristic in HEURISTICS {
        let faults = [
            Fault::Without(0),
            Fault::Without(2),
            Fault::NoCosine,
            Fault::EvenChoice,
        ];
        for fault in faults {
            let (difference, _) = worst(Form::Full, heuristic, PATHS, fault);
            assert!(difference > 1e-2, "{heuristic:?}, {fault:?}: {difference}");
        }
    }
}
