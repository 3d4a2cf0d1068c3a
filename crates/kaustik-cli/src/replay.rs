//! `kaustik replay`: a sample or step of a render once more, part by part.

use std::fmt::Write;
use std::path::Path;
use std::process::ExitCode;

use glam::DVec3;
use kaustik::film::{check_writable, write_file};
use kaustik::path::{Event, Role, Side, Stand};
use kaustik::scene::Scene;
use kaustik::scene::gltf::{Line, lines};
use kaustik::spectrum::Spectrum;
use kaustik::{RenderSettings, Source, State, replay_from};
use serde_json::json;

use crate::arguments::ReplayWords;
use crate::picture::remark;
use crate::render::{failure, load, settings};
use crate::{Failure, output};

pub(crate) fn run(words: &ReplayWords) -> Result<ExitCode, Failure> {
    if let Some(path) = &words.gltf {
        check_writable(path).map_err(Failure::input)?;
    }
    let Asked {
        settings,
        source,
        size,
        state,
    } = asked(words)?;
    let outputs = &words.render.outputs;
    let scene = load(outputs, &source, words.render.max_memory, &settings, size)?;
    let [width, height] = scene.image_size();
    let settings = RenderSettings {
        width,
        height,
        ..settings
    };
    let place = words.at.place;
    let mut ahead = |iterations| {
        remark(
            outputs,
            &format!(
                "light paths follow from those of the iterations before: {iterations} of them run first"
            ),
        );
    };
    let events = replay_from(&scene, &settings, state.as_ref(), place, &mut ahead)
        .map_err(|error| failure(&error))?;
    let RenderSettings { method, seed, .. } = settings;
    let what = format!("{method} of {}, step {seed}:{place}", source.scene);
    output::print(&told(&what, &events, &scene));
    if let Some(path) = &words.gltf {
        let notes = json!({ "kaustik": what });
        let text = lines(&drawn(&events), &notes);
        write_file(path, |file| file.write_all(text.as_bytes())).map_err(Failure::other)?;
    }
    Ok(ExitCode::SUCCESS)
}

/// Columns and rows as far as they are known.
type Size = (Option<u32>, Option<u32>);

/// What is known of the render.
struct Asked {
    settings: RenderSettings,
    source: Source,
    size: Size,
    /// One that it left behind.
    state: Option<State>,
}

/// The settings and the scene of the render, from its words or from its state.
fn asked(words: &ReplayWords) -> Result<Asked, Failure> {
    let render = &words.render;
    let path = Path::new(&render.scene);
    let read = |path: &Path| State::read(path).map_err(|error| wrong(path, &error));
    if !State::is_at(path) {
        let mut settings = settings(render)?;
        settings.seed = words.at.seed.unwrap_or(settings.seed);
        let source = Source {
            scene: render.scene.clone(),
            camera: render.camera.clone(),
            variant: render.variant.clone(),
            environment: render.environment.clone(),
        };
        return Ok(Asked {
            settings,
            source,
            size: (render.width, render.height),
            state: render.resume.as_deref().map(read).transpose()?,
        });
    }
    let state = read(path)?;
    let settings = state.settings().map_err(|error| wrong(path, &error))?;
    if let Some(seed) = words.at.seed.filter(|seed| *seed != settings.seed) {
        let found = format!("seed is {} in the state, {seed} in --at", settings.seed);
        return Err(wrong(path, &found));
    }
    Ok(Asked {
        size: (Some(settings.width), Some(settings.height)),
        settings,
        source: state.source().clone(),
        state: Some(state),
    })
}

fn wrong(path: &Path, error: &dyn std::fmt::Display) -> Failure {
    Failure::Input(format!("{}: {error}", path.display()))
}

/// The text: a line for each event, indented by walk; what is not finite is marked.
fn told(what: &str, events: &[Event], scene: &Scene) -> String {
    let mut text = format!("{what}\n");
    let mut evaluations = 0;
    for event in events {
        if *event == Event::Begin {
            evaluations += 1;
        }
        let _ = write!(text, "{}", line(event, evaluations, scene));
        if let Some(fault) = fault(event) {
            let _ = write!(text, "   <- {fault}");
        }
        text.push('\n');
    }
    let faults = events.iter().filter(|event| fault(event).is_some()).count();
    let count = |of: fn(&Event) -> bool| events.iter().filter(|&event| of(event)).count();
    let others = [
        (count(|e| matches!(e, Event::Splat { .. })), "splats"),
        (count(|e| matches!(e, Event::Path { .. })), "paths"),
        (
            count(|e| matches!(e, Event::LightPath { .. })),
            "light paths",
        ),
        (count(|e| matches!(e, Event::Proposal { .. })), "proposals"),
        (count(|e| matches!(e, Event::Photon { .. })), "photons"),
        (count(|e| matches!(e, Event::Deposit { .. })), "deposits"),
    ];
    let others = others.into_iter().filter(|(count, _)| *count > 0);
    let others: String = others.map(|(n, what)| format!(", {n} {what}")).collect();
    let _ = writeln!(
        text,
        "{evaluations} evaluations{others}; {}",
        match faults {
            0 => "everything is finite".to_owned(),
            n => format!("{n} lines have numbers that are not finite, or left out"),
        }
    );
    text
}

/// What is wrong with it.
fn fault(event: &Event) -> Option<&'static str> {
    match event {
        _ if !event.is_finite() => Some("not finite"),
        Event::Splat {
            xyz, kept: false, ..
        }
        | Event::Deposit {
            xyz, kept: false, ..
        } => Some(match xyz.0.iter().all(|&v| v >= 0.0) {
            // Each number by itself is.
            true => "its sum is not finite, left out",
            false => "negative, left out",
        }),
        _ => None,
    }
}

fn line(event: &Event, evaluation: u32, scene: &Scene) -> String {
    match *event {
        Event::Begin => format!("evaluation {evaluation}"),
        Event::Start {
            side,
            position,
            direction,
            throughput,
        } => format!(
            "  {} walk from {} toward {}: throughput {}",
            name(side),
            point(position),
            point(direction),
            spectrum(throughput)
        ),
        Event::Vertex {
            side,
            edge,
            position,
            normal,
            shading,
            material,
            triangle: [instance, triangle],
            distance,
            throughput,
        } => format!(
            "    {} vertex {edge} at {} after {distance:.6}: normal {}, shading normal {}, {}, instance {instance}, triangle {triangle}, throughput {}",
            name(side),
            point(position),
            point(normal),
            point(shading),
            named(material, scene),
            spectrum(throughput)
        ),
        Event::Escape {
            side,
            edge,
            direction,
        } => format!(
            "    {} edge {edge} leaves the scene toward {}",
            name(side),
            point(direction)
        ),
        Event::Scatter {
            side,
            edge,
            direction,
            pdf,
            delta,
            transmitted,
            throughput,
        } => format!(
            "      {} vertex {edge} scatters toward {}: {}{} {pdf:.6e}, throughput {}",
            name(side),
            point(direction),
            if transmitted { "transmitted, " } else { "" },
            if delta { "Dirac, pdf" } else { "pdf" },
            spectrum(throughput)
        ),
        Event::Roulette {
            side,
            edge,
            survival,
            survived,
        } => format!(
            "      {} vertex {edge}: roulette with {survival:.6} {}",
            name(side),
            if survived { "goes on" } else { "ends the walk" }
        ),
        Event::Join {
            s,
            t,
            points,
            weight,
            value,
        } => format!(
            "      strategy s = {s}, t = {t}{}: weight {weight:.6}, {} before visibility",
            points.map_or(String::new(), |[from, to]| {
                format!(" joins {} and {}", point(from), point(to))
            }),
            spectrum(value)
        ),
        Event::Light { class, value } => {
            format!("      brings light of class {class:?}: {}", spectrum(value))
        }
        Event::Index { of, number } => format!("{of} {number}"),
        Event::LightPath { .. }
        | Event::Visit { .. }
        | Event::Path { .. }
        | Event::PathVertex { .. }
        | Event::Proposal { .. }
        | Event::Decision { .. } => of_chain(event, scene),
        Event::Photon {
            position,
            direction,
            power,
            edges,
            met,
        } => format!(
            "      photon {edges} at {} from {}: power {}, counts at {met} points",
            point(position),
            point(direction),
            spectrum(power)
        ),
        Event::Deposit { raster, xyz, kept } => format!(
            "  {} at raster ({:.6}, {:.6}): XYZ {:?}",
            if kept { "deposit" } else { "left out" },
            raster.x,
            raster.y,
            xyz.0
        ),
        Event::Splat {
            raster,
            xyz,
            class,
            kept,
        } => format!(
            "  {} at raster ({:.6}, {:.6}), class {class:?}: XYZ {:?}",
            if kept { "splat" } else { "left out" },
            raster.x,
            raster.y,
            xyz.0
        ),
    }
}

/// What chains of paths do.
fn of_chain(event: &Event, scene: &Scene) -> String {
    match *event {
        Event::LightPath { role } => format!("light path {}", stands_for(role)),
        Event::Visit { level, weight } => {
            format!("  chain {level} reports a path for {weight:.6} steps")
        }
        Event::Path {
            role,
            raster,
            density,
            colour,
        } => format!(
            "{} at raster ({:.6}, {:.6}): density {density:.6e}, colour {:?}",
            match role {
                Role::Sampled(weight) => format!("sampled path of weight {weight:.6e}"),
                Role::Current => "current path".to_owned(),
                Role::Proposed => "proposed path".to_owned(),
            },
            raster.x,
            raster.y,
            colour.0
        ),
        Event::PathVertex {
            index,
            stand,
            position,
            normal,
            shading,
            material,
            specular,
            transmitted,
            value,
        } => {
            let mut text = format!("    vertex {index}: {} ", stands(stand));
            text += &point(position);
            if let Some(material) = material {
                text += &format!(
                    ", normal {}, shading normal {}, {}",
                    point(normal),
                    point(shading),
                    named(material, scene)
                );
            }
            for (is, word) in [(specular, ", Dirac"), (transmitted, ", transmitted")] {
                text += if is { word } else { "" };
            }
            format!("{text}, value {}", spectrum(value))
        }
        Event::Proposal {
            kernel,
            ratio,
            acceptance,
        } => {
            let nothing = if ratio > 0.0 { "" } else { " finds no path," };
            format!(
                "  mutation '{kernel}':{nothing} densities back over there {ratio:.6e}, accepted with {acceptance:.6}"
            )
        }
        Event::Decision { accepted } => {
            format!("  {}", if accepted { "accepted" } else { "rejected" })
        }
        _ => String::new(),
    }
}

/// A material by its index in the file, and its name if it has one.
fn named(material: u32, scene: &Scene) -> String {
    let name = scene.material_name(material);
    name.map_or(format!("material {material}"), |name| {
        format!("material {material} '{name}'")
    })
}

fn stands_for(role: Role) -> &'static str {
    match role {
        Role::Sampled(_) => "that was sampled",
        Role::Current => "where the chain is",
        Role::Proposed => "where it may go",
    }
}

fn stands(stand: Stand) -> &'static str {
    match stand {
        Stand::Emitter => "emitter at",
        Stand::Distant => "emitter infinitely far away toward",
        Stand::Surface => "surface at",
        Stand::Lens => "lens at",
    }
}

fn name(side: Side) -> &'static str {
    match side {
        Side::Camera => "camera",
        Side::Light => "light",
    }
}

fn point(p: DVec3) -> String {
    format!("({:.6}, {:.6}, {:.6})", p.x, p.y, p.z)
}

fn spectrum(value: Spectrum) -> String {
    let lanes = value.lanes().map(|lane| format!("{lane:.6e}"));
    format!("[{}]", lanes.join(", "))
}

fn color(role: Role) -> [f32; 3] {
    match role {
        Role::Sampled(_) => [1.0, 0.4, 0.0],
        Role::Current => [0.1, 0.3, 1.0],
        Role::Proposed => [0.1, 0.8, 0.2],
    }
}

/// Walks and connections as lines: blue from the camera, orange from the light, green for what was joined; paths of chains blue where
/// the chain is, green where it may go, orange those that were sampled.
fn drawn(events: &[Event]) -> Vec<Line> {
    let mut all: Vec<Line> = Vec::new();
    // An edge into nothing is drawn as long as the one before it.
    let mut length = 1.0;
    let mut walk = 0;
    // Where light comes from that has no place.
    let mut away = None;
    let mut of_chain = None;
    for event in events {
        match *event {
            Event::Start { side, position, .. } => {
                length = 1.0;
                walk = all.len();
                all.push(Line {
                    name: format!("{} walk {}", name(side), all.len()),
                    color: match (side, of_chain.take()) {
                        (_, Some(role)) => color(role),
                        (Side::Camera, None) => [0.1, 0.3, 1.0],
                        (Side::Light, None) => [1.0, 0.4, 0.0],
                    },
                    points: vec![position.as_vec3()],
                });
            }
            // A chain's, unless nothing leaves the light; what comes after its decision is none of it.
            Event::LightPath { role } => of_chain = Some(role),
            Event::Decision { .. } => of_chain = None,
            Event::Vertex {
                position, distance, ..
            } => {
                length = distance;
                if let Some(line) = all.get_mut(walk) {
                    line.points.push(position.as_vec3());
                }
            }
            Event::Escape { direction, .. } => {
                if let Some(line) = all.get_mut(walk)
                    && let Some(last) = line.points.last().copied()
                {
                    line.points.push(last + (direction * length).as_vec3());
                }
            }
            Event::Join {
                s,
                t,
                points: Some(points),
                ..
            } => all.push(Line {
                name: format!("s = {s}, t = {t}"),
                color: [0.1, 0.8, 0.2],
                points: points.map(|p| p.as_vec3()).to_vec(),
            }),
            Event::Path { role, .. } => {
                away = None;
                all.push(Line {
                    name: format!("{role:?} path {}", all.len()),
                    color: color(role),
                    points: Vec::new(),
                });
            }
            Event::PathVertex {
                stand, position, ..
            } => {
                let Some(line) = all.last_mut() else { continue };
                match (stand, away.take()) {
                    // Drawn when it is known from where.
                    (Stand::Distant, _) => away = Some(position),
                    (_, Some(toward)) => {
                        let end = (position + toward).as_vec3();
                        line.points.extend([end, position.as_vec3()]);
                    }
                    (_, None) => line.points.push(position.as_vec3()),
                }
            }
            _ => {}
        }
    }
    all
}
