//! The engine for a web page without a server.
//!
//! A worker of the page writes a request as JSON into the [`inbox`], makes a [`call`], and reads the answer from the [`outbox`].
//! The answer is JSON, or a picture in the format of `spectra view`. There is one session, one thread, no disk and no clock. The
//! worker states how many samples to trace, and thereby how long a call takes. The result has the same bits as that of the
//! command.
//!
//! Build it with `cargo run -p xtask -- web`.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod module;
mod request_handler;

pub use module::{call, inbox, outbox, start};
pub use request_handler::RequestHandler;

use spectra_plugins as _;
