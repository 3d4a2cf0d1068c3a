//! Studies of light transport: methods x scenes x seeds x budgets, measured against a reference.
//!
//! A [`Study`] is plain data, from code or from a TOML file ([`Study::load`]). A [`Runner`] renders what is
//! missing of it and keeps every finished render at once, so that a study that was cut goes on where it was; the
//! reference is rendered likewise, until its own standard error is small enough. What comes of it are
//! [`Results`], and of these tables ([`csv`]), curves ([`chart()`]) and one page ([`page()`]); [`write()`]
//! writes all three. The papers' own studies, with what each paper claims, are in [`named`].
//!
//! ```
//! use std::ops::ControlFlow;
//! use std::path::Path;
//! use kaustik_study::{Runner, Section, Study, write};
//!
//! let study = Study::parse(
//!     r#"
//!     width = 8
//!     height = 8
//!     seeds = [0, 1]
//!     budget = { per_pixel = [1, 2] }
//!     reference = { method = "path", per_pixel = 16, error = 0.5 }
//!     scene = [{ scene = "builtin:furnace" }]
//!     method = [{ method = "path" }, { method = "light" }]
//!     "#,
//!     "example.toml",
//!     Path::new(""),
//! )?;
//! let folder = tempfile::tempdir()?;
//! let results = Runner::new(&study, folder.path()).run(&mut |_| ControlFlow::Continue(()))?;
//! let section = Section { results: &results, judged: &[] };
//! let page = write(folder.path(), &study.title, &[("study", section)])?;
//! assert!(page.exists());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod chart;
mod claim;
mod clock;
pub mod csv;
mod error;
mod figure;
mod file;
mod key;
mod layers;
mod look;
pub mod named;
mod page;
mod parts;
mod picture;
mod ranks;
mod report;
mod results;
mod run;
mod stage;
mod store;
mod study;

pub use chart::{Axis, chart};
pub use claim::{Claim, Finding, Judged, Verdict, judge};
pub use clock::{Clock, CpuClock, WallClock};
pub use error::StudyError;
pub use figure::{Curve, Figure, Quartiles, mean_and_error};
pub use page::{Section, page};
pub use report::write;
pub use results::{Cell, Group, ReferenceResult, Results, SceneResults, Shown};
pub use run::{Listener, Runner, StudyProgress};
pub use study::{Budgets, MethodEntry, ReferenceEntry, SceneEntry, SceneSource, Study, Unit};
