//! The solids around emitters that stand still.

use std::sync::OnceLock;

use kaustik_geometry::{Surface, offset_origin};

use glam::DVec3;

use super::{Emitters, Punctual, TriangleEmitter};
use crate::Interior;
use crate::matter::Matter;

/// The solids around each emissive triangle, in front of it and behind, and around each punctual light.
///
/// Looked up when the first light path asks: rays that meet everything on their way are slow, a scene may have a million
/// emitters, and a picture may need few of them. What is found does not depend on who asks first.
#[derive(Debug, Default)]
pub(super) struct Surroundings {
    triangles: Vec<OnceLock<[Interior; 2]>>,
    punctual: Vec<OnceLock<Interior>>,
}

impl Surroundings {
    /// Of so many triangles and so many punctual lights, nothing of which is known yet.
    pub(super) fn new(matter: &Matter, triangles: usize, punctual: usize) -> Self {
        // Where geometry moves they are looked up for each sample.
        let asked = matter.has_solids && !matter.world.moves();
        let of = |count: usize| if asked { count } else { 0 };
        Self {
            triangles: (0..of(triangles)).map(|_| OnceLock::new()).collect(),
            punctual: (0..of(punctual)).map(|_| OnceLock::new()).collect(),
        }
    }
}

impl Emitters {
    /// The solids around a point of a triangle, on the side of `direction`.
    pub(super) fn interior_beside(
        &self,
        matter: &Matter,
        triangle: &TriangleEmitter,
        surface: &Surface,
        direction: DVec3,
    ) -> Interior {
        if !matter.has_solids {
            return Interior::VACUUM;
        }
        if matter.world.moves() {
            let point = offset_origin(surface, direction.as_vec3());
            return matter.interior_at(point.as_dvec3());
        }
        let known = &self.surroundings.triangles[self.number(triangle) as usize];
        let around = known.get_or_init(|| around(matter, triangle));
        let behind = surface.geometric_normal.as_dvec3().dot(direction) < 0.0;
        around[usize::from(behind)]
    }

    /// The solids around a punctual light, which stands there now.
    pub(super) fn interior_about(&self, matter: &Matter, index: u32, light: &Punctual) -> Interior {
        if !matter.has_solids || light.is_directional() {
            return Interior::VACUUM;
        }
        if matter.world.moves() || self.punctual[index as usize].moves() {
            return matter.interior_at(light.position);
        }
        let known = &self.surroundings.punctual[index as usize];
        *known.get_or_init(|| matter.interior_at(light.position))
    }
}

/// The solids in front of a triangle and behind it.
fn around(matter: &Matter, triangle: &TriangleEmitter) -> [Interior; 2] {
    let [instance, primitive] = [triangle.instance, triangle.primitive];
    let middle = (matter.world).surface_at(instance, primitive, 1.0 / 3.0, 1.0 / 3.0);
    let area = matter.world.triangle_area(instance, primitive);
    let off = middle.geometric_normal.as_dvec3() * (1e-4 * area.sqrt());
    let position = middle.position.as_dvec3();
    [position + off, position - off].map(|point| matter.interior_at(point))
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use crate::description::LightKind;
    use crate::testing::{Rng, Stage, cuboid, dielectric, lamp, punctual, rectangle, wavelengths};

    /// A lamp and a point in a block of glass and a lamp beside it: nothing is looked up before it is needed, and of
    /// emitters that are never chosen nothing ever.
    #[test]
    fn surroundings_are_looked_up_when_they_are_needed() {
        let far = Vec3::new(9.0, 0.0, 0.0);
        let scene = Stage::new()
            .add(
                dielectric(1.5, 0.0, [1.0; 3]),
                cuboid(Vec3::splat(-2.0), Vec3::splat(2.0)),
            )
            .add(lamp(1.0), rectangle(Vec3::ZERO, Vec3::X, Vec3::Y))
            .add(lamp(1.0), rectangle(far, Vec3::X, Vec3::Y))
            .light(punctual(LightKind::Point, 1.0, Vec3::Y, Vec3::Z))
            .build();
        let around = &scene.emitters().surroundings;
        let known = || {
            around
                .triangles
                .iter()
                .filter(|t| t.get().is_some())
                .count()
        };
        assert_eq!((around.triangles.len(), around.punctual.len()), (4, 1));
        assert_eq!((known(), around.punctual[0].get()), (0, None));
        let mut rng = Rng::new(5);
        scene
            .sample_emission(&wavelengths(), |_| rng.uniform())
            .expect("light");
        assert!(known() + around.punctual.iter().filter(|p| p.get().is_some()).count() == 1);
        for _ in 0..100 {
            let sample = scene.sample_emission(&wavelengths(), |_| rng.uniform());
            let sample = sample.expect("light");
            let inside = sample.ray.origin.abs().max_element() < 2.0;
            assert_eq!(sample.interior.is_vacuum(), !inside, "{:?}", sample.ray);
        }
        assert_eq!(known(), 4);
    }
}
