//! The viewer `spectra view`: a scene in a browser.
//!
//! A server in the renderer's process serves one page. The page opens a desk, which is a separate session on its own thread. The page
//! leaves changes on the desk and takes pictures from it. Pictures are linear light, which the page encodes for the screen, so that
//! brightness, false color and zoom need no request to the server.
//!
//! **One slider**, from the page through the server and back:
//!
//! ```text
//! slider -> turn(path, number) -> Control::text -> "lens.f-number=f/2.8" -> Session::change -> step -> develop
//!   ^                                                                                                   |
//! canvas <- brightness, false color, zoom, A and B (in the page) <- linear light of the screen <- Frame <-+
//! ```
//!
//! - `controls` makes a control for each declared parameter of the scene's stages. A page sends numbers, switches, and words of lists that
//!   the program made. `Control::text` composes the text `path=value`, so no file path comes from a page.
//! - `served::page_session` holds the scene twice, whole and as a small draft, and decides what is traced and developed when.
//! - [`page`] holds what a page knows of its session, whoever runs it: controls, counters, and the last picture.
//! - [`parts`] packs a picture: a head as JSON, and linear light as 16-bit floats (binary16), because a browser is slow to receive bytes.
//!   The page draws only the part that is seen, no finer than it is seen, and counts at most 200 000 pixels for the histogram.
//! - `served::save` writes changed values into the scene's file where they stand, if the file then states the scene that is seen.
//! - `served::bench` reads prism, beam and light of a scene for the dispersion study, and writes them back. `served::study` and
//!   `served::tester` (the color tester) need no desk: their figures are functions of what the page sends.
//!
//! **Security.** The server listens only on this machine's loopback address. The printed address holds a token that works once; after that
//! a cookie identifies the page. Host and origin must match exactly. Heads, bodies, times and connections of requests are bounded
//! (`served::http`); if there are too many connections, the one that has been silent for longest makes room.
//!
//! **Without a server** (`crates/web`) the same page talks to a worker: `serverless.js` answers what the page requests, and `worker.js`
//! holds the engine as a WebAssembly module.

mod control;
mod controls;
mod declared;
pub mod page;
pub mod parts;
mod section;
mod series_values;

// On WebAssembly there are no threads and no connections; there, another program stands in for the server.
#[cfg(not(target_family = "wasm"))]
mod served;

#[cfg(not(target_family = "wasm"))]
pub use served::{ViewerSettings, color_tester, view};
