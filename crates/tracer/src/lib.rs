//! Batches of rays through the surfaces of a lens.
//!
//! A [`Tracer`] is a [`Lens`](spectra_lens::Lens) made ready for one band of light. Rays enter it in the frame of the lens (vertex of the
//! first surface at the origin) and leave it in the frame of the image plane (z = 0 there); backward it is the other way round. A
//! [`Path`] says in which order light meets the surfaces: straight through, or by reflections as ghosts do.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod absorption;
mod branches;
mod ghost_paths;
mod ledger;
mod path;
mod scatter;
mod stray;
mod tracer;
mod transmission;

pub use branches::Branches;
pub use ledger::{Ledger, StepLedger};
pub use path::{Act, Path, PathError, PathStep};
pub use spectra_core::surface::Travel;
pub use stray::{BLACK_PAINT, Chance, Interior, Particle, StrayError, StrayLedger, StrayMatter, Walker};
pub use tracer::{Indices, RayPath, Route, Tracer, Work};
