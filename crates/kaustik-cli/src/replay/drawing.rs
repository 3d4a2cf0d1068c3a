//! Events as lines in space.

use kaustik::path::{Event, Role, Side, Stand};
use kaustik::scene::gltf::Line;

use super::text::name;

/// Walks and connections as lines: blue from the camera, orange from the light, green for what was joined; paths of chains blue where
/// the chain is, green where it may go, orange those that were sampled.
pub(super) fn of(events: &[Event]) -> Vec<Line> {
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

fn color(role: Role) -> [f32; 3] {
    match role {
        Role::Sampled(_) => [1.0, 0.4, 0.0],
        Role::Current => [0.1, 0.3, 1.0],
        Role::Proposed => [0.1, 0.8, 0.2],
    }
}
