//! The server of the page: connections, threads, and the scene's file.

mod bench;
mod choices;
mod export;
mod guard;
mod http;
mod memory;
mod page_session;
mod photograph;
mod render_job;
mod save;
mod server;
mod study;
mod tester;

use crate::declared;
use render_job::RenderJob;
use server::Server;
use spectra_core::Isa;
use spectra_session::SessionError;
use std::path::PathBuf;

/// Settings of the viewer: what is viewed, and how.
#[derive(Clone, Debug)]
pub struct ViewerSettings {
    /// Scene file, name of a bundled scene, or photograph: a picture file that is developed on a film.
    pub scene: PathBuf,
    /// Film of a photograph, by its whole name or its file; the default film if `None`.
    pub stock: Option<String>,
    /// Texts `path=value` that override values of the scene.
    pub overrides: Vec<String>,
    /// Port on 127.0.0.1; 0 takes a free one.
    pub port: u16,
    /// Instruction set to trace with.
    pub isa: Isa,
    /// Number of threads that trace the picture of a page.
    pub threads: usize,
}

/// Serves a scene until the process ends; calls `ready` with the address to open.
///
/// # Errors
/// Every fault of the scene; a port that cannot be opened; an error that ends the server.
pub fn view(view: ViewerSettings, ready: impl FnOnce(&str)) -> Result<std::convert::Infallible, SessionError> {
    let ViewerSettings { scene, stock, overrides, port, isa, threads } = view;
    memory::keep_little();
    let order = RenderJob::of(scene, stock.as_deref(), overrides, isa, threads)?;
    // Faults are reported at the start, not first by a page.
    order.session()?;
    let server = bound(port, Some(order))?;
    ready(&server.address());
    // A page that comes sooner waits for this data; without this thread, the first page gathers it.
    let _ = std::thread::Builder::new().name("gather".to_owned()).spawn(declared::gather);
    Err(SessionError::Failed(format!("the server ended: {}", server.serve())))
}

/// Serves the color tester, which shows light of one wavelength on a screen, until the process ends. Calls `ready` with the address to
/// open.
///
/// # Errors
/// A port that cannot be opened; an error that ends the server.
pub fn color_tester(port: u16, ready: impl FnOnce(&str)) -> Result<std::convert::Infallible, SessionError> {
    let server = bound(port, None)?;
    ready(&server.address());
    Err(SessionError::Failed(format!("the server ended: {}", server.serve())))
}

fn bound(port: u16, order: Option<RenderJob>) -> Result<Server, SessionError> {
    Server::bind(port, order)
        .map_err(|error| SessionError::Request(format!("port {port} of this machine cannot be opened: {error}")))
}
