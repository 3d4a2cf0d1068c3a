//! A world at an instant is the world that stands as its motions say.

use std::sync::Arc;

use glam::{Affine3A, Vec3};
use kaustik_geometry::{Instance, Mesh, Motion, Ray, World, WorldError};

use crate::support::Random;

/// Three keys anywhere, one of them with a jump.
fn motion(random: &mut Random) -> Motion {
    let keys = [0.0, 0.3, 0.3, 1.0].map(|time| (time, random.transform()));
    Motion::new(keys.to_vec()).unwrap()
}

/// What a world that moves is built from.
type Parts = (Vec<Arc<Mesh>>, Vec<Instance>, Vec<(u32, Motion)>);

/// Some instances that move, some that do not, of two meshes.
fn parts(random: &mut Random) -> Parts {
    let meshes = vec![Arc::new(random.soup(40)), Arc::new(random.soup(3))];
    let instances = (0..8).map(|index| Instance {
        mesh: index % 2,
        transform: random.transform(),
    });
    let instances: Vec<Instance> = instances.collect();
    let motions = [1, 2, 4, 7].map(|index| (index, motion(random)));
    (meshes, instances, motions.to_vec())
}

/// The same instances, standing where they are at a time.
fn still(
    meshes: &[Arc<Mesh>],
    instances: &[Instance],
    motions: &[(u32, Motion)],
    time: f32,
) -> World {
    let mut instances = instances.to_vec();
    for (index, motion) in motions {
        instances[*index as usize].transform = motion.at(time);
    }
    World::build(meshes.to_vec(), instances).unwrap()
}

/// Rays meet the same triangles at the same distance, but for rounding at a few edges, and the same surfaces there.
#[test]
fn an_instant_is_a_still_world() {
    let mut random = Random(11);
    let (mut met, mut odd) = (0, 0);
    for _ in 0..20 {
        let (meshes, instances, motions) = parts(&mut random);
        let world = World::moving(meshes.clone(), instances.clone(), motions.clone()).unwrap();
        assert!(world.moves() && world.is_moving(4) && !world.is_moving(0));
        for time in [0.0, 0.1, 0.299, 0.3, 0.77, 1.0] {
            let (there, still) = (world.at(time), still(&meshes, &instances, &motions, time));
            let bounds = world.bounds();
            let of_still = still.bounds();
            assert!(bounds.min.cmple(of_still.min).all() && bounds.max.cmpge(of_still.max).all());
            for _ in 0..3000 {
                let origin = random.cube() * 6.0;
                let ray = Ray::new(origin, random.cube() * 4.0 - origin);
                let (a, b) = (there.intersect(&ray), still.intersect(&ray));
                let same = match (a, b) {
                    (None, None) => true,
                    (Some(a), Some(b)) => {
                        met += 1;
                        (a.instance, a.primitive) == (b.instance, b.primitive)
                            && (a.t - b.t).abs() <= 1e-4 * b.t.max(1e-2)
                    }
                    _ => false,
                };
                odd += u32::from(!same);
                assert_eq!(there.occluded(&ray), a.is_some());
                if let (Some(a), Some(b), true) = (a, b, same) {
                    let (p, q) = (there.surface(&ray, &a), still.surface(&ray, &b));
                    assert!((p.position - q.position).length() < 1e-3, "{p:?} {q:?}");
                    assert!(p.geometric_normal.dot(q.geometric_normal) > 0.99);
                    assert_eq!(p.front, q.front);
                    let area = there.triangle_area(a.instance, a.primitive);
                    let other = still.triangle_area(a.instance, a.primitive);
                    assert!((area - other).abs() <= 1e-3 * other.max(1e-6));
                    // What leaves the surface does not meet it again.
                    let away = Ray::spawn(&p, ray.direction);
                    let again = there.intersect(&away);
                    assert!(again.is_none_or(|hit| {
                        (hit.instance, hit.primitive) != (a.instance, a.primitive)
                    }));
                }
            }
        }
    }
    assert!(met > 4_000 && odd * 500 < met, "{odd} of {met}");
}

/// The portable walk gives the same bits.
#[test]
fn both_walks_agree_on_what_moves() {
    let mut random = Random(5);
    let (meshes, instances, motions) = parts(&mut random);
    let build = || World::moving(meshes.clone(), instances.clone(), motions.clone()).unwrap();
    let (fast, slow) = (build().at(0.4), build().portable().at(0.4));
    for _ in 0..3000 {
        let origin = random.cube() * 6.0;
        let ray = Ray::new(origin, random.cube() * 4.0 - origin);
        assert_eq!(fast.intersect(&ray), slow.intersect(&ray));
    }
}

/// A mesh of one triangle, and an instance of it.
fn triangle() -> (Vec<Arc<Mesh>>, Instance) {
    let mesh = Mesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]]).unwrap();
    let instance = Instance {
        mesh: 0,
        transform: Affine3A::IDENTITY,
    };
    (vec![Arc::new(mesh)], instance)
}

fn scale(x: f32) -> Affine3A {
    Affine3A::from_scale(Vec3::splat(x))
}

fn between(a: Affine3A, b: Affine3A) -> Motion {
    Motion::new(vec![(0.0, a), (1.0, b)]).unwrap()
}

#[test]
fn what_is_flat_for_an_instant_is_not_met_then() {
    let (meshes, instance) = triangle();
    let through = between(scale(-1.0), scale(1.0));
    let world = World::moving(meshes, vec![instance], vec![(0, through)]).unwrap();
    let ray = Ray::new(Vec3::new(0.2, 0.2, 1.0), -Vec3::Z);
    let back = Ray::new(Vec3::new(-0.2, -0.2, 1.0), -Vec3::Z);
    let met = |time, ray| world.at(time).intersect(ray).is_some();
    assert!(met(1.0, &ray) && met(0.0, &back) && !met(0.5, &ray) && !met(0.5, &back));
    assert!(!met(0.0, &ray) && !met(1.0, &back));
    assert!(world.at(0.5).triangle_area(0, 0) == 0.0);
}

#[test]
fn motions_of_nothing_doubled_or_beyond_the_finite_numbers_are_refused() {
    let (meshes, instance) = triangle();
    let build = |motions| World::moving(meshes.clone(), vec![instance], motions);
    let through = between(scale(-1.0), scale(1.0));
    for motions in [
        vec![(1, through.clone())],
        vec![(0, through.clone()), (0, through)],
    ] {
        assert!(matches!(build(motions), Err(WorldError::Motion { .. })));
    }
    let far = Affine3A::from_translation(Vec3::splat(3e38));
    let wide = between(scale(3e38), far);
    assert!(build(vec![(0, wide)]).is_ok());
    let mut beyond = scale(3e38);
    beyond.translation = Vec3::splat(3e38).into();
    let result = build(vec![(0, between(scale(1.0), beyond))]);
    assert!(matches!(result, Err(WorldError::NonFinite { instance: 0 })));
}
