//! The foreign renderer: all randomness comes from a function that gives the next number.

use std::ops::{Add, Mul, Sub};

#[derive(Clone, Copy, Default)]
pub(crate) struct V(pub(crate) f64, pub(crate) f64, pub(crate) f64);

impl Add for V {
    type Output = V;
    fn add(self, b: V) -> V {
        V(self.0 + b.0, self.1 + b.1, self.2 + b.2)
    }
}
impl Sub for V {
    type Output = V;
    fn sub(self, b: V) -> V {
        V(self.0 - b.0, self.1 - b.1, self.2 - b.2)
    }
}
impl Mul<f64> for V {
    type Output = V;
    fn mul(self, s: f64) -> V {
        V(self.0 * s, self.1 * s, self.2 * s)
    }
}
impl Mul for V {
    type Output = V;
    fn mul(self, b: V) -> V {
        V(self.0 * b.0, self.1 * b.1, self.2 * b.2)
    }
}
impl V {
    pub(crate) fn dot(self, b: V) -> f64 {
        self.0 * b.0 + self.1 * b.1 + self.2 * b.2
    }
    pub(crate) fn sum(self) -> f64 {
        self.0 + self.1 + self.2
    }
    fn cross(self, b: V) -> V {
        V(
            self.1 * b.2 - self.2 * b.1,
            self.2 * b.0 - self.0 * b.2,
            self.0 * b.1 - self.1 * b.0,
        )
    }
    fn unit(self) -> V {
        self * (1.0 / self.dot(self).sqrt())
    }
}

enum Surface {
    Lamp(V),
    Matt(V),
    Glass,
}
use Surface::{Glass, Lamp, Matt};

/// Centre, radius, surface. Walls are large spheres.
const SCENE: [(V, f64, Surface); 7] = [
    (V(0.0, -1e3, 0.0), 1e3, Matt(V(0.7, 0.7, 0.7))), // floor
    (V(0.0, 1003.0, 0.0), 1e3, Matt(V(0.7, 0.7, 0.7))), // ceiling
    (V(-1002.0, 0.0, 0.0), 1e3, Matt(V(0.7, 0.25, 0.2))),
    (V(1002.0, 0.0, 0.0), 1e3, Matt(V(0.25, 0.5, 0.7))),
    (V(0.0, 0.0, 1002.0), 1e3, Matt(V(0.7, 0.7, 0.7))), // back
    (V(0.2, 1.1, 0.3), 0.6, Glass),
    (V(0.9, 2.6, -0.4), 0.16, Lamp(V(60.0, 54.0, 40.0))),
];

/// The nearest thing beyond `o` towards `d`: distance and index.
fn hit(o: V, d: V) -> Option<(f64, usize)> {
    let mut nearest = None;
    for (i, (centre, radius, _)) in SCENE.iter().enumerate() {
        let to = *centre - o;
        let (b, c) = (to.dot(d), to.dot(to) - radius * radius);
        let root = b * b - c;
        if root > 0.0 {
            for t in [b - root.sqrt(), b + root.sqrt()] {
                if t > 1e-6 * radius.max(1.0) && nearest.is_none_or(|(far, _)| t < far) {
                    nearest = Some((t, i));
                }
            }
        }
    }
    nearest
}

/// Radiance along the path through (x, y) of the picture, both in [0, 1). Each bounce takes
/// two numbers.
pub(crate) fn trace(x: f64, y: f64, next: &mut dyn FnMut() -> f64) -> V {
    let mut o = V(0.0, 1.5, -4.5);
    let mut d = V(x - 0.5, 0.42 - y, 1.1).unit();
    let mut throughput = V(1.0, 1.0, 1.0);
    for _ in 0..8 {
        let Some((t, i)) = hit(o, d) else {
            break; // out through the open front
        };
        let (centre, radius, surface) = &SCENE[i];
        o = o + d * t;
        let normal = (o - *centre) * (1.0 / radius);
        let numbers = [next(), next()];
        match surface {
            Lamp(radiance) => return throughput * *radiance,
            Matt(albedo) => {
                throughput = throughput * *albedo;
                let side = if normal.dot(d) < 0.0 {
                    normal
                } else {
                    normal * -1.0
                };
                d = cosine(side, numbers);
            }
            Glass => d = refract(d, normal, numbers[0]),
        }
    }
    V::default()
}

fn cosine(n: V, [a, b]: [f64; 2]) -> V {
    let axis = if n.0.abs() < 0.5 {
        V(1.0, 0.0, 0.0)
    } else {
        V(0.0, 1.0, 0.0)
    };
    let s = n.cross(axis).unit();
    let (phi, r) = (std::f64::consts::TAU * a, b.sqrt());
    (s * (r * phi.cos()) + s.cross(n) * (r * phi.sin()) + n * (1.0 - b).sqrt()).unit()
}

/// Through or off a surface of glass, as Fresnel's mean says.
fn refract(d: V, normal: V, u: f64) -> V {
    let into = normal.dot(d) < 0.0;
    let (n, eta) = if into {
        (normal, 1.0 / 1.5)
    } else {
        (normal * -1.0, 1.5)
    };
    let cos = -n.dot(d);
    let reflected = d + n * (2.0 * cos);
    let k = 1.0 - eta * eta * (1.0 - cos * cos);
    if k <= 0.0 {
        return reflected;
    }
    let cos_t = k.sqrt();
    let s = (eta * cos - cos_t) / (eta * cos + cos_t);
    let p = (eta * cos_t - cos) / (eta * cos_t + cos);
    if u < 0.5 * (s * s + p * p) {
        reflected
    } else {
        (d * eta + n * (eta * cos - cos_t)).unit()
    }
}
