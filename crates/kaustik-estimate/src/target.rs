use std::cell::Cell;
use std::sync::atomic::{AtomicU64, Ordering};

use kaustik_mcmc::Target;
use kaustik_path::{Contributions, PathBuilder, RayCounts};
use kaustik_pss::Coordinates;
use kaustik_scene::Scene;

/// A path builder in a scene as what a chain evaluates.
#[derive(Clone, Copy)]
pub struct PathTarget<'a> {
    /// Where the paths run.
    pub scene: &'a Scene,
    /// How they are made.
    pub builder: &'a dyn PathBuilder,
    /// Counts contributions that were not finite.
    pub nonfinite: &'a AtomicU64,
}

impl Target for PathTarget<'_> {
    type Value = Contributions;

    #[inline]
    fn evaluate(&self, u: &mut dyn Coordinates, value: &mut Contributions) {
        self.builder.build(self.scene, u, value);
        if value.nonfinite() > 0 {
            self.nonfinite
                .fetch_add(u64::from(value.nonfinite()), Ordering::Relaxed);
        }
    }
}

/// The same where one thread evaluates: it counts the rays as well.
#[derive(Clone, Copy, Debug)]
pub struct CountedTarget<'a> {
    /// What is evaluated.
    pub target: PathTarget<'a>,
    /// The rays of all evaluations.
    pub rays: &'a Cell<RayCounts>,
}

impl Target for CountedTarget<'_> {
    type Value = Contributions;

    #[inline]
    fn evaluate(&self, u: &mut dyn Coordinates, value: &mut Contributions) {
        self.target.evaluate(u, value);
        let mut rays = self.rays.get();
        rays += value.rays();
        self.rays.set(rays);
    }
}

impl std::fmt::Debug for PathTarget<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("PathTarget").finish_non_exhaustive()
    }
}
