//! Tests of this crate's public interface, in one program so that dependencies are linked once.

mod browser;
mod server;
