//! The workspace's one integration binary: it links once.
//!
//! The first modules hold the house together: what the manifests, the sources and
//! the documents promise each other. Each scan is itself tested on a planted violation. The
//! others render: methods against each other, against closed forms, against themselves.

/// Who depends on whom, and who must not.
mod arrows;
/// One accept/reject decision in the whole workspace.
mod decision;
/// Every link in the documents leads somewhere.
mod links;
mod merged;
/// Reading the tree: files, and Rust without its comments, strings and tests.
mod source;
/// Manifests, lengths, leftovers, paths of somebody's machine.
mod tidy;
/// Methods, settings, extensions, scenes: the words of the documents and of the program.
mod vocabulary;

/// Methods agree in the mean; planted faults are found.
mod agreement;
/// Every method comes to pictures of another renderer.
mod another_renderer;
/// The same bits for any number of threads, and across a glTF file.
mod bits;
mod black;
/// The scale of a chain's picture and its error.
mod brightness;
/// A second path tracer, and what it takes to tell a wrong one from a right one.
mod by_the_book;
/// Agreement tile by tile, where most of the noise is in a few tiles.
mod by_tile;
/// Orthographic cameras, lenses with blades, windows of the image: in every method.
mod cameras;
/// Renders that go on beside a test.
mod child;
/// States that are damaged.
mod damaged;
/// Scenes of caustics with their own small lamps.
mod default_lamps;
/// Direct light beside chains.
mod direct;
/// Energy redistribution on paths.
mod erpt;
/// Methods agree on every built-in scene, more roughly.
mod every_scene;
/// Lamps as faint and as bright as numbers are.
mod extremes;
/// Contributions that are not finite: listed, and shown once more.
mod faults;
/// Pictures known in closed form.
mod furnace;
/// Long paths between glossy surfaces.
mod glossy;
/// Faults at the system's calls.
mod injected;
/// What a scene is made from is not written over.
mod inputs;
/// The command and its states: signals, kills, disks that are full.
mod kept;
/// Many lamps.
mod lamps;
/// Diffuse light through thin surfaces.
mod leaves;
/// Two commands on one output.
mod locks;
/// Implicit specular light that a meter finds, and its errors.
mod meter;
/// What moves while the shutter is open.
mod motion;
/// Chains on paths: sets of mutations.
mod mutations;
/// A scene opens nothing outside its folder.
mod outside;
/// Light through smooth panes.
mod panes;
/// Photon methods: as the radius shrinks, and against each other.
mod photon;
/// Photon methods against each other and against bidirectional paths, tile by tile.
mod photon_by_tile;
/// Photons beside walls and behind veils.
mod photon_walls;
/// Methods agree in rooms that chance puts together.
mod random_rooms;
/// Samples and steps of renders, shown once more.
mod replay;
/// Replica exchange: variants, parts, replicas that do not run.
mod replicas;
/// Rooms by chance.
mod rooms;
/// Nothing depends on the unit of length.
mod scale;
/// Renders that are told to stop.
mod signals;
/// Renders of hours: memory, descriptors, signals.
mod soak;
/// Stages that even out the picture.
mod stages;
mod starts;
/// States: resumed, merged, refused.
mod state;
/// What the tests of whole renders share.
mod support;
/// Methods against each other, window by window of the image.
mod windows;
/// The command as a user meets it.
mod words;
