//! The `spectra` program: the built-in plugins and the command line that runs them.

use spectra_plugins as _;

fn main() -> std::process::ExitCode {
    spectra_command::main(spectra_workspace::unpack)
}
