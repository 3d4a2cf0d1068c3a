//! Events as lines in space.

use glam::DVec3;
use kaustik::path::{Event, Role, Side, Stand};
use kaustik::scene::gltf::Line;

use super::text::name;

/// Walks and connections as lines: blue from the camera, orange from the light, green for what was joined; paths of
/// chains blue where the chain is, green where it may go, orange those that were sampled.
pub(super) fn of(events: &[Event]) -> Vec<Line> {
    let mut drawing = Drawing {
        lines: Vec::new(),
        walk: 0,
        length: 1.0,
        away: None,
        of_chain: None,
    };
    for event in events {
        drawing.add(event);
    }
    drawing.lines
}

/// Lines so far, and what the next event needs to know of those before it.
struct Drawing {
    lines: Vec<Line>,
    /// The line of the walk.
    walk: usize,
    /// Of the walk's last edge: one into nothing is drawn as long as the one before it.
    length: f64,
    /// Where the light of a whole path comes from, if that has no place.
    away: Option<DVec3>,
    /// What the walk that begins next is to its chain, if it is a chain's.
    of_chain: Option<Role>,
}

impl Drawing {
    fn add(&mut self, event: &Event) {
        match *event {
            Event::Start { side, position, .. } => self.start(side, position),
            // A chain's, unless nothing leaves the light; what comes after its decision is none of it.
            Event::LightPath { role } => self.of_chain = Some(role),
            Event::Decision { .. } => self.of_chain = None,
            Event::Vertex {
                position, distance, ..
            } => {
                self.length = distance;
                if let Some(line) = self.lines.get_mut(self.walk) {
                    line.points.push(position.as_vec3());
                }
            }
            Event::Escape { direction, .. } => {
                if let Some(line) = self.lines.get_mut(self.walk)
                    && let Some(last) = line.points.last().copied()
                {
                    line.points.push(last + (direction * self.length).as_vec3());
                }
            }
            Event::Join {
                s,
                t,
                points: Some(points),
                ..
            } => self.lines.push(Line {
                name: format!("s = {s}, t = {t}"),
                color: [0.1, 0.8, 0.2],
                points: points.map(|p| p.as_vec3()).to_vec(),
            }),
            Event::Path { role, .. } => {
                self.away = None;
                self.lines.push(Line {
                    name: format!("{role:?} path {}", self.lines.len()),
                    color: color(role),
                    points: Vec::new(),
                });
            }
            Event::PathVertex {
                stand, position, ..
            } => self.path_vertex(stand, position),
            _ => {}
        }
    }

    /// A walk begins.
    fn start(&mut self, side: Side, position: DVec3) {
        self.length = 1.0;
        self.walk = self.lines.len();
        self.lines.push(Line {
            name: format!("{} walk {}", name(side), self.lines.len()),
            color: match (side, self.of_chain.take()) {
                (_, Some(role)) => color(role),
                (Side::Camera, None) => [0.1, 0.3, 1.0],
                (Side::Light, None) => [1.0, 0.4, 0.0],
            },
            points: vec![position.as_vec3()],
        });
    }

    /// The whole path, which is the last line, goes on.
    fn path_vertex(&mut self, stand: Stand, position: DVec3) {
        let Some(line) = self.lines.last_mut() else {
            return;
        };
        match (stand, self.away.take()) {
            // Drawn when it is known from where.
            (Stand::Distant, _) => self.away = Some(position),
            (_, Some(toward)) => {
                let end = (position + toward).as_vec3();
                line.points.extend([end, position.as_vec3()]);
            }
            (_, None) => line.points.push(position.as_vec3()),
        }
    }
}

fn color(role: Role) -> [f32; 3] {
    match role {
        Role::Sampled(_) => [1.0, 0.4, 0.0],
        Role::Current => [0.1, 0.3, 1.0],
        Role::Proposed => [0.1, 0.8, 0.2],
    }
}
