//! This program in its role as the linker of the WebAssembly module.
//!
//! No code refers to the statics by which plugins register their stages, and for WebAssembly the linker drops symbols without
//! references. This program therefore stands in for the linker: it asks for the plugins' libraries as a whole, and passes the
//! arguments on to the toolchain's own linker.

use crate::TaskResult;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Environment variable that makes this program act as a linker; its value is the path of the toolchain's own linker.
pub const ASKED: &str = "SPECTRA_WEB_LINKER";

/// Links the module, with the arguments that the compiler passes to its linker.
///
/// # Errors
/// The linker cannot be started, or it failed and has printed why.
pub fn link(arguments: Vec<OsString>) -> TaskResult {
    let own = std::env::var_os(ASKED).unwrap_or_default();
    let status = Command::new(&own).args(["-flavor", "wasm"]).args(whole(arguments)).status();
    let status = status.map_err(|error| format!("{}: {error}", own.display()))?;
    if status.success() { Ok(()) } else { Err(format!("{}: {status}", own.display()).into()) }
}

/// Returns the arguments with each library of a plugin included as a whole.
fn whole(arguments: Vec<OsString>) -> Vec<OsString> {
    let mut all = Vec::with_capacity(arguments.len());
    for argument in arguments {
        let name = Path::new(&argument).file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        if name.starts_with("libspectra_plugin") && name.ends_with(".rlib") {
            all.extend(["--whole-archive".into(), argument, "--no-whole-archive".into()]);
        } else if argument != "-flavor" && argument != "wasm" {
            all.push(argument);
        }
    }
    all
}

/// Returns the path of the linker that comes with the toolchain.
///
/// # Errors
/// The toolchain has no linker, or `rustc` cannot be run.
pub fn own() -> TaskResult<PathBuf> {
    let ask = |what: &str| -> TaskResult<String> {
        let said = Command::new("rustc").args(["--print", what]).output().map_err(|error| format!("rustc: {error}"))?;
        Ok(String::from_utf8_lossy(&said.stdout).trim().to_owned())
    };
    let (sysroot, host) = (ask("sysroot")?, ask("host-tuple")?);
    let linker = Path::new(&sysroot).join("lib/rustlib").join(host).join("bin/rust-lld");
    let linker = linker.with_extension(std::env::consts::EXE_EXTENSION);
    if linker.is_file() { Ok(linker) } else { Err(format!("the toolchain has no {}", linker.display()).into()) }
}
