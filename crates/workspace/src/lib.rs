//! The sources of the program, packed into it, so that plugins can be built against them without checkout or network.
//!
//! The archive holds manifests, the lock file and the source files of every crate (tar and deflate, the same bytes wherever it is
//! packed). The program holds its data anyway, so they are not stored again: the caller of [`unpack()`] passes them in.
//!
//! ```no_run
//! # fn data() -> impl Iterator<Item = (&'static str, &'static [u8])> { std::iter::empty() }
//! let sources = spectra_workspace::unpack(std::path::Path::new("cache"), &mut data())?;
//! assert!(sources.join("crates/core/Cargo.toml").is_file());
//! # Ok::<(), std::io::Error>(())
//! ```

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod unpack;

pub use unpack::{Data, unpack};

/// Version of the sources.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");

/// The packed sources: tar, compressed with zlib. Empty in a program that was built from a registry.
pub static ARCHIVE: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/sources.tar.zz"));

/// Returns whether this program was built without its sources.
#[must_use]
pub fn is_empty() -> bool {
    ARCHIVE.is_empty()
}
