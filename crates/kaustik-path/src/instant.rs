use kaustik_pss::{Coordinates, Stream};
use kaustik_scene::Scene;

/// Has `work` see the scene at the path's time: a coordinate that is asked for only where something moves, so that what
/// stands still keeps its points of the primary sample space.
#[inline(always)]
pub(crate) fn at_its_time<T>(
    scene: &Scene,
    u: &mut dyn Coordinates,
    work: impl FnOnce(&Scene, &mut dyn Coordinates) -> T,
) -> T {
    let instant;
    let scene = if scene.moves() {
        instant = scene.at(u.get(Stream::Time, 0));
        &instant
    } else {
        scene
    };
    work(scene, u)
}
