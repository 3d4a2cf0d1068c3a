//! Markov-chain kernels on light paths (Veach and Guibas 1997; Cline et al. 2005).
//!
//! The state of a chain is a [`Path`]: its vertices with all that evaluating it again takes. A
//! kernel ([`kaustik_mcmc::Kernel`]) writes a changed path over an older one, traces only what
//! changed, and returns T(y -> x) / T(x -> y); whether it is accepted is the chain's matter.
//!
//! # Measure
//! `f` and all pdfs are with respect to area at the vertices (to solid angle where an emitter lies
//! infinitely far away, to area of the lens at the lens), as in Veach 1997 ch. 8. Two neighbouring vertices that
//! do not scatter into Dirac directions contribute the geometric term `G`. For a run of Dirac scatterings between `b`
//! (nearer the eye) and `a` (nearer the light) the Jacobian
//! `cos_b d(omega_b)/dA_a` takes its place. It is a factor of `f` and of the pdf of every way to make the
//! run; it cancels wherever paths are compared, because runs are kept or made as a whole, and is set to 1. So
//! in this crate
//!
//! | step | density |
//! |---|---|
//! | to `a` from `b`, against the light | `p_w(b) P.. / cos_b` |
//! | to `b` from `a`, with the light | `p_w(a) P.. / cos_a` times `s / S` of each vertex passed |
//!
//! where `P` are the probabilities of the lobes, `s` is the factor by which refraction scales radiance, the squared ratio
//! of the indices, and `S` is the correction for shading normals in particle transport (both: Veach 1997 ch. 5). Each step has
//! two further factors: first, the probability of passing the partly transparent surfaces on the way, times the opacity of the surface where the step ends; second, where
//! that surface is a smooth pane, which rays may also pass ([`Bsdf::passing`](kaustik_bsdf::Bsdf::passing)), the probability of meeting it. `f` has only the first; for panes on the
//! way, the transmittance of the edge in `f` is what passes divided by the probability of passing.
//!
//! The unit of area is the scene's own, or in a scene of millimetres or of kilometres the square of the
//! length that is usual there: products over long paths stay within the range of `f64`.
//!
//! # Time
//! Where something moves, a path has a [time](Path::time): its vertices lie where surfaces are then, and all
//! that is asked of it is asked of the scene at that instant ([`PathSpace::at`]). A kernel is handed the
//! space at the time of the path that it starts from, so that one which keeps the time needs to know nothing
//! of it. The time of a path is uniform, and its density 1: it falls out of all ratios. A kernel that changes it
//! evaluates each path, and the density of making it, at that path's own time.
//!
//! # Another kernel
//! A kernel copies what it keeps of the path, makes the rest by the steps of a walk ([`Path`] holds what each
//! vertex needs), joins the two, evaluates, and returns the quotient of two densities: each is a product of
//! *geometry* over the vertices that were made (density per area for a density 1 of the directions) and of the
//! densities of what was drawn. Where a kernel keeps the string of scatterings, the choice among kernels and
//! the media cancel by themselves.
//!
//! Manifold exploration (Jakob and Marschner 2012) fits as follows. The direction at a
//! vertex that is not Dirac is turned ([`Radii`] or a lobe about the old direction) and traced through its run to
//! a new end, as [`CausticPerturbation`] does: rule 2, and the geometry of that part. From there a Newton walk
//! finds the run to the next kept vertex; each of its tries is one trace of a run with given modes. What it makes
//! is a run between two ends that are given, so its density is not that of a walk but 1 per area of the moved
//! end: the product of geometry over the run is replaced by the paper's generalised geometric term (`G` of the first
//! edge times `|det|` of how that edge's end moves with the run's), for which the derivatives of the constraint are
//! taken from the frames and indices of the run's vertices. f has the run's Jacobian `cos_b d(omega_b)/dA_a` set to 1
//! (above); a kernel that does not make the run by a walk must therefore put it into the quotient, for y and for x. A
//! walk back from y that does not end in x makes the move impossible (ratio 0). What is missing for it: derivatives of
//! position and normal at a vertex.
//!
//! # Example
//! ```
//! use glam::DVec2;
//! use kaustik_mcmc::{Ignore, Metropolis, generator};
//! use kaustik_mutate::{LensPerturbation, Path, PathSpace, Radii, Seeds};
//! use kaustik_path::{BuilderSettings, ScalarTarget};
//! use kaustik_scene::{Scene, SceneOptions, builtin};
//!
//! let description = builtin::load("cornell")?;
//! let scene = Scene::new(&description, &SceneOptions { width: 64, height: 64, ..Default::default() })?;
//! let space = PathSpace {
//!     scene: &scene,
//!     settings: BuilderSettings::default(),
//!     target: ScalarTarget::Luminance,
//!     pixels: DVec2::splat(64.0),
//! };
//! let [kernel, _] = LensPerturbation::runs(&space, Radii::raster(space.pixels), Radii::angles());
//!
//! // Bidirectional samples, until one carries light and is of the kind that the kernel moves.
//! let (mut seeds, mut path, mut draws) = (Seeds::new(&space), Path::default(), generator(7, 0));
//! loop {
//!     if seeds.sample(&mut path, &mut draws) > 0.0 && kernel.suits(&path) {
//!         break;
//!     }
//! }
//! // This kernel keeps what follows the first vertices: a chain that is to come everywhere mixes it with others.
//! let density = |path: &Path| [path.density()];
//! let mut chain = Metropolis::at((), path, &density, 0);
//! for _ in 0..100 {
//!     chain.step(&kernel, &density, &mut draws, &mut Ignore);
//! }
//! println!("at {}, {} edges", chain.value().raster(), chain.value().edges());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod bidirectional;
mod caustic;
mod density;
mod evaluate;
mod every;
mod factor;
mod generate;
mod jitter;
mod join;
mod kernel;
mod lens;
mod lens_subpath;
mod path;
mod printed;
mod retrace;
mod seed;
mod space;
mod time;
mod told;
mod tracer;
mod vertex;
mod vertices;
mod walk;
mod wavelength;
mod ways;

pub use bidirectional::BidirectionalMutation;
pub use caustic::CausticPerturbation;
pub use every::EveryPerturbation;
pub use jitter::Radii;
pub use lens::{LensPerturbation, Run};
pub use lens_subpath::LensMutation;
pub use path::Path;
#[cfg(feature = "serde")]
pub use path::WrittenPath;
pub use printed::RuleFive;
pub use seed::Seeds;
pub use space::PathSpace;
pub use time::TimeMutation;
pub use told::Told;
pub use tracer::Tracer;
pub use wavelength::WavelengthMutation;

#[cfg(test)]
mod tests;
