//! Build script that does nothing: the key `links` in the manifest requires one.

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
}
