//! Compiles the bridge to OpenImageIO; does nothing without the feature `oiio`.

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    #[cfg(feature = "oiio")]
    bridge();
}

#[cfg(feature = "oiio")]
fn bridge() {
    for file in ["src/bridge.rs", "src/bridge.h", "src/bridge.cc"] {
        println!("cargo::rerun-if-changed={file}");
    }
    const HINT: &str = "the feature `oiio` needs OpenImageIO 2.4 or later with its headers, pkg-config and a C++17 \
                        compiler; on Debian: apt-get install libopenimageio-dev pkg-config g++";
    let stop = |cause: String| -> ! {
        for line in cause.lines().filter(|line| !line.trim().is_empty()) {
            println!("cargo::warning={line}");
        }
        println!("cargo::error={HINT}");
        std::process::exit(1);
    };
    // The compiler checks the version, from the headers that it really finds.
    let library = pkg_config::Config::new().cargo_metadata(false).probe("OpenImageIO");
    let library = library.unwrap_or_else(|e| stop(e.to_string()));
    let mut build = cxx_build::bridge("src/bridge.rs");
    build.file("src/bridge.cc").std("c++17").flag_if_supported("-Wno-deprecated-declarations");
    build.includes(&library.include_paths);
    build.try_compile("spectra-oiio").unwrap_or_else(|e| stop(e.to_string()));
    // These flags follow the bridge, which needs the library: linkers go from left to right.
    for path in &library.link_paths {
        println!("cargo::rustc-link-search=native={}", path.display());
    }
    for name in &library.libs {
        println!("cargo::rustc-link-lib={name}");
    }
}
