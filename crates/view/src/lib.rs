//! A scene in a browser: `spectra view`.
//!
//! A server in the renderer's process gives out one page. The page opens a desk, a session of its own on a thread of its own, leaves
//! changes on it and takes pictures from it: linear light, which the page codes for the screen, so that brightness, false color and
//! zoom ask nothing of the server. `ARCHITECTURE.md`, "The viewer", follows one slider.
//!
//! The server listens on this machine's own address alone. Its address holds a token that opens once; after that a cookie counts. Host and
//! origin must be exact. A page sends numbers, switches, and words of lists that the program made: no path of a file comes from a page.

mod controls;
pub mod parts;
mod picks;
mod section;

// Where there are no threads and no connections, another program stands in for the server.
#[cfg(not(target_family = "wasm"))]
mod served;

#[cfg(not(target_family = "wasm"))]
pub use served::{View, color_tester, view};
