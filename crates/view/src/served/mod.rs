//! The page with its server: connections, threads, and the scene's file.

mod bench;
mod choices;
mod desk;
mod guard;
mod http;
mod memory;
mod order;
mod photograph;
mod save;
mod server;
mod study;
mod tester;
mod told;

use crate::controls;
use order::Order;
use server::Server;
use spectra_core::Isa;
use spectra_session::SessionError;
use std::path::PathBuf;

/// What is viewed, and how.
#[derive(Clone, Debug)]
pub struct View {
    /// A scene file, the name of a bundled scene, or a photograph: a file of a picture, which is developed on a film.
    pub scene: PathBuf,
    /// The film of a photograph, by its whole name or its file; the usual one if not said.
    pub stock: Option<String>,
    /// Texts `path=value` on top of it.
    pub overrides: Vec<String>,
    /// Port of 127.0.0.1; 0 is a free one.
    pub port: u16,
    /// The instruction set to trace with.
    pub isa: Isa,
    /// Threads that a page's picture is traced on.
    pub threads: usize,
}

/// Serves a scene until the process ends; `ready` gets the address to open.
///
/// # Errors
/// Everything that is wrong with the scene; a port that cannot be had.
pub fn view(view: View, ready: impl FnOnce(&str)) -> Result<std::convert::Infallible, SessionError> {
    let View { scene, stock, overrides, port, isa, threads } = view;
    memory::keep_little();
    let order = Order::of(scene, stock.as_deref(), overrides, isa, threads)?;
    // Faults are told at the start, and not by a page.
    order.session()?;
    let server = bound(port, Some(order))?;
    ready(&server.address());
    // A page that is there sooner waits for it; without a thread for it, too.
    let _ = std::thread::Builder::new().name("gather".to_owned()).spawn(controls::gather);
    Err(SessionError::Failed(format!("the server ended: {}", server.serve())))
}

/// Serves the color tester, lights of one wavelength as a screen shows them, until the process ends; `ready` gets the address to open.
///
/// # Errors
/// A port that cannot be had.
pub fn color_tester(port: u16, ready: impl FnOnce(&str)) -> Result<std::convert::Infallible, SessionError> {
    let server = bound(port, None)?;
    ready(&server.address());
    Err(SessionError::Failed(format!("the server ended: {}", server.serve())))
}

fn bound(port: u16, order: Option<Order>) -> Result<Server, SessionError> {
    Server::bind(port, order)
        .map_err(|error| SessionError::Request(format!("port {port} of this machine cannot be had: {error}")))
}
