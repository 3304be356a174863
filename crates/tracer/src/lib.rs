//! Batches of rays through the surfaces of a lens.
//!
//! A [`Tracer`] is a [`Lens`](spectra_lens::Lens) made ready for one band of light. Rays enter it in the frame of the lens (vertex of the
//! first surface at the origin) and leave it in the frame of the image plane (z = 0 there); backward it is the other way round. A
//! [`Path`] says in which order light meets the surfaces: straight through, or by reflections as ghosts do.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod absorption;
mod ghost_paths;
mod ledger;
mod path;
mod path_search;
mod scatter;
mod stray;
mod tracer;
mod transmission;

pub use ledger::{Ledger, StepLedger};
pub use path::{Interaction, Path, PathError, PathStep};
pub use path_search::PathSearch;
pub use spectra_core::surface::Travel;
pub use stray::{BLACK_PAINT, Interior, Particle, StrayError, StrayLedger, StrayReflectances, WalkNumbers, Walker};
pub use tracer::{Indices, RayPath, Route, Tracer, Work};
