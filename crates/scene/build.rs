//! Does nothing: the manifest's `links` needs a build script.

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
}
