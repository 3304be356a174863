//! The engine for a page without a server.
//!
//! A worker of the page writes a request as JSON into the [`inbox`], says [`call`], and reads the answer from the [`outbox`]: JSON, or
//! a picture as `spectra view` sends it. There is one session, one thread, no disk and no clock: the worker says how many samples to
//! trace, and so how long a call takes. The bits are those of the command.
//!
//! Built by `cargo run -p xtask -- web`.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod desk;
mod module;

pub use desk::Desk;
pub use module::{call, inbox, outbox, start};

use spectra_plugins as _;
