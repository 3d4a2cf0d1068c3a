//! Path builders, which turn a point of the unit cube into light paths: path tracing, light tracing, bidirectional
//! path tracing, and its single strategies one at a time (multiplexed). Also photon paths and the measurement
//! points that they touch, and sights: walks from the camera alone that look for implicit
//! specular light ([`Class::L0`]).
//!
//! A [`PathBuilder`] draws every number from [`Coordinates`](kaustik_pss::Coordinates) and
//! nothing else. It knows no chain and no random generator, so that plain Monte Carlo, Markov
//! chains and the replay of one recorded path all use it alike. Here `kaustik-mcmc` lends independent uniform numbers, so
//! that the mean over the samples is the mean luminance of the image:
//!
//! ```
//! use kaustik_mcmc::{Independent, generator};
//! use kaustik_path::{
//!     Bidirectional, BuilderSettings, Contributions, Form, Heuristic, PathBuilder, ScalarTarget,
//! };
//! use kaustik_scene::{Scene, SceneOptions, builtin};
//!
//! let description = builtin::load("cornell")?;
//! let scene = Scene::new(&description, &SceneOptions { width: 8, height: 8, ..Default::default() })?;
//! let paths = Bidirectional {
//!     settings: BuilderSettings::default(),
//!     form: Form::Full, // every vertex of one walk is joined to every vertex of the other
//!     heuristic: Heuristic::Power, // which strategies share a path, and how
//! };
//! // A point of the cube is drawn coordinate by coordinate, as the builder asks for them.
//! let mut value = Contributions::default();
//! let mut light = 0.0;
//! for sample in 0..1000 {
//!     let mut u = Independent::new(generator(7, sample));
//!     paths.build(&scene, &mut u, &mut value);
//!     let splats = value.splats().iter();
//!     light += splats.map(|splat| ScalarTarget::Luminance.of(splat.xyz)).sum::<f64>();
//! }
//! assert!(light / 1000.0 > 0.01);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod bidirectional;
mod builder;
mod camera_walk;
mod class;
mod contributions;
mod endpoint;
mod features;
mod instant;
pub mod layout;
mod light;
mod next_event;
mod photon;
mod pure_specular;
mod rays;
mod roulette;
mod scalar;
mod shadow;
mod sighting;
mod splitting;
mod trace;
mod unidirectional;
mod unjoined;
mod walk;

pub use bidirectional::{
    Bidirectional, Form, Heuristic, Multiplexed, Technique, TechniqueSpread, Techniques,
};
pub use builder::{BuilderSettings, PathBuilder};
pub use class::Class;
pub use contributions::{Contributions, Splat};
pub use endpoint::Endpoint;
pub use features::{Features, features};
pub use light::LightTracing;
pub use photon::{
    Disc, Lookup, MeasurementPoint, MeasurementPoints, MeasurementWalk, Photon, PhotonPath,
    PhotonTracing, Remainder, Sheet,
};
pub use pure_specular::PureSpecular;
pub use rays::RayCounts;
pub use scalar::ScalarTarget;
pub use sighting::{Sighting, sight};
pub use splitting::{Find, sight_branches};
pub use trace::{Event, Role, Side, Stand, is_listening, note, trace};
pub use unidirectional::Unidirectional;
pub use unjoined::Unjoined;
