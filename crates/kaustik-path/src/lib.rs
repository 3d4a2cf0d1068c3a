//! From a point of the unit cube to light paths: path tracing, light tracing, bidirectional
//! path tracing and its single strategies (multiplexed), photon paths and the measurement
//! points that they touch, and sights: walks from the camera alone that look for implicit
//! specular light.
//!
//! A [`PathBuilder`] draws every number from [`Coordinates`](kaustik_pss::Coordinates) and
//! nothing else. It knows no chain and no random generator, so that plain Monte Carlo, Markov
//! chains and the replay of one recorded path all use it alike.

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
mod trace;
mod unidirectional;
mod unjoined;
mod walk;
mod ways;

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
    PhotonTracing, Remainder,
};
pub use pure_specular::PureSpecular;
pub use rays::Rays;
pub use scalar::ScalarTarget;
pub use sighting::{Sighting, sight};
pub use trace::{Event, Role, Side, Stand, is_listening, note, trace};
pub use unidirectional::Unidirectional;
pub use unjoined::Unjoined;
pub use ways::{Find, sight_ways};
