//! Events as lines of text.

use std::fmt::Write;

use glam::DVec3;
use kaustik::path::{Event, Role, Side, Stand};
use kaustik::scene::Scene;
use kaustik::spectrum::Spectrum;

/// A line for each event, indented by walk; what is not finite is marked.
pub(super) fn of(what: &str, events: &[Event], scene: &Scene) -> String {
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
        Event::Index { of, number } => format!("{of} {number}"),
        Event::Start { .. }
        | Event::Vertex { .. }
        | Event::Escape { .. }
        | Event::Scatter { .. }
        | Event::Roulette { .. } => of_walk(event, scene),
        Event::Join { .. }
        | Event::Light { .. }
        | Event::Photon { .. }
        | Event::Deposit { .. }
        | Event::Splat { .. } => of_light(event),
        Event::Path { .. } | Event::PathVertex { .. } => of_path(event, scene),
        Event::LightPath { .. }
        | Event::Visit { .. }
        | Event::Proposal { .. }
        | Event::Decision { .. } => of_chain(event),
    }
}

/// What walks do; nothing of other events.
fn of_walk(event: &Event, scene: &Scene) -> String {
    match *event {
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
        _ => String::new(),
    }
}

/// What light is found, and where it falls; nothing of other events.
fn of_light(event: &Event) -> String {
    match *event {
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
        _ => String::new(),
    }
}

/// A whole path and its vertices; nothing of other events.
fn of_path(event: &Event, scene: &Scene) -> String {
    match *event {
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
        _ => String::new(),
    }
}

/// What chains do; nothing of other events.
fn of_chain(event: &Event) -> String {
    match *event {
        Event::LightPath { role } => format!("light path {}", stands_for(role)),
        Event::Visit { level, weight } => {
            format!("  chain {level} reports a path for {weight:.6} steps")
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

pub(super) fn name(side: Side) -> &'static str {
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
