//! The `spectra` command: arguments in, pictures and figures out.
//!
//! Exit codes: 0 done (or a picture that `--time-limit` ended); 1 something failed on the way, such as a full disk;
//! 2 the input is wrong; 130 interrupted by Ctrl-C, 143 by SIGTERM, 129 by SIGHUP. Requested results go to standard output;
//! progress, warnings and errors go to standard error.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod arguments;
mod bench;
mod build;
mod check;
mod completions;
mod console;
mod doc;
mod eye;
mod film;
mod folder;
mod formatting;
mod frames;
mod glass;
mod glossary;
mod guess;
mod interrupt;
mod lens;
mod licenses;
mod limits;
mod list;
mod memory;
mod new;
mod outcome;
mod picture;
mod quantity;
mod report;
mod run;
mod schema;
mod set;
mod sources;
mod spectrum;
mod time_limit;
mod version;
mod view;

use arguments::{Arguments, Command};
use clap::Parser;
use outcome::{Failure, Outcome};
pub use sources::Unpack;
use spectra_core::{Isa, registry};
use std::ffi::OsString;
use std::process::ExitCode;
use std::time::Instant;

/// Runs the program with the arguments of this process and returns its exit code. `unpack` unpacks the program's own sources
/// (`spectra_workspace::unpack`).
pub fn main(unpack: Unpack) -> ExitCode {
    main_with_notices(unpack, "")
}

/// Runs a program made by `spectra build` and returns its exit code. `notices` holds the licenses of its plugins and of the
/// crates they depend on; `--licenses` shows them after the program's own. See [`main`] for `unpack`.
pub fn main_with_notices(unpack: Unpack, notices: &'static str) -> ExitCode {
    limits::report_large_files();
    spectra_session::make_threads();
    ExitCode::from(answer(std::env::args_os(), unpack, notices))
}

/// Result of a command line that ran in this process.
#[derive(Clone, Debug)]
pub struct CommandOutput {
    /// Exit code of the command line.
    pub code: u8,
    /// Bytes that the command wrote to standard output.
    pub out: Vec<u8>,
    /// Bytes that the command wrote to standard error.
    pub err: Vec<u8>,
}

/// Runs a command line in this process; `arguments` excludes the name of the program. The result is that of a separate process,
/// with three exceptions. Signals are left to the caller, a `--time-limit` that is too short is noticed later, and no
/// stream counts as a terminal.
pub fn call(arguments: impl IntoIterator<Item = OsString>, unpack: Unpack) -> CommandOutput {
    let line = std::iter::once(OsString::from("spectra")).chain(arguments);
    let (code, kept) = console::captured(|| answer(line, unpack, ""));
    CommandOutput { code, out: kept.out, err: kept.err }
}

/// Replaces `~` in an argument like `--output=~/picture.png` with the user's home folder. Shells do this only at the beginning of
/// a word.
fn at_home(argument: OsString) -> OsString {
    let Some((name, path)) = argument.to_str().and_then(|text| text.split_once("=~/")) else { return argument };
    match std::env::home_dir().filter(|home| name.starts_with("--") && !home.as_os_str().is_empty()) {
        Some(home) => {
            let mut whole = OsString::from(format!("{name}="));
            whole.push(home.join(path));
            whole
        }
        None => argument,
    }
}

/// Runs a command line, the name of the program first; returns the exit code.
fn answer(line: impl Iterator<Item = OsString>, unpack: Unpack, notices: &str) -> u8 {
    let started = Instant::now();
    let line: Vec<OsString> = line.map(at_home).collect();
    if let Some(fault) = guess::set_without_equals(&line) {
        console::faults(&fault.into());
        return outcome::BAD_INPUT;
    }
    let arguments = match Arguments::try_parse_from(&line).map_err(guess::without_false_tips) {
        Ok(arguments) => arguments,
        Err(error) => {
            // clap also reports help and version as errors, with exit code 0.
            match guess::suggestion(&error, &line) {
                Some(hint) => console::faults(&hint.into()),
                None => console::parsed(&error),
            }
            return u8::try_from(error.exit_code()).unwrap_or(outcome::BAD_INPUT);
        }
    };
    if arguments.verbose {
        log_to_stderr();
    }
    dispatch(&arguments, unpack, notices, started).unwrap_or_else(|failure| failure.report())
}

fn dispatch(arguments: &Arguments, unpack: Unpack, notices: &str, started: Instant) -> Outcome {
    registry::check()
        .map_err(|faults| Failure::Failed(format!("the stages of this program conflict: {}", faults.join("; "))))?;
    let isa = instruction_set()?;
    tracing::debug!(isa = isa.name(), "instruction set");
    if arguments.licenses {
        return licenses::show(notices);
    }
    match &arguments.command {
        Some(Command::Run(run)) => run::run(run, isa, started),
        Some(Command::Check(check)) => check::check(check, isa),
        Some(Command::View(arguments)) => view::view(arguments, isa),
        Some(Command::List(list)) => list::list(list),
        Some(Command::Doc(arguments)) => doc::doc(arguments),
        Some(Command::Schema(arguments)) => schema::schema(arguments),
        Some(Command::Lens(lens)) => lens::lens(&lens.command),
        Some(Command::Film(arguments)) => film::film(&arguments.command, isa, started),
        Some(Command::Bench(bench)) => bench::bench(bench, isa),
        Some(Command::Spectrum(spectrum)) => spectrum::spectrum(&spectrum.command),
        Some(Command::Glass(glass)) => glass::glass(&glass.command),
        Some(Command::Picture(arguments)) => picture::picture(&arguments.command),
        Some(Command::New(arguments)) => new::new(arguments, unpack),
        Some(Command::Build(arguments)) => build::build(arguments, unpack, started),
        Some(Command::Completions(arguments)) => completions::completions(arguments),
        Some(Command::Man) => completions::man(),
        // Without a command or a flag, the parser has already shown the help.
        None => Ok(outcome::DONE),
    }
}

/// Returns the instruction set that `SPECTRA_ISA` names, or else the widest one of this machine.
fn instruction_set() -> Result<Isa, Failure> {
    match std::env::var_os("SPECTRA_ISA") {
        Some(name) if !name.is_empty() => {
            let isa = Isa::by_name(&name.to_string_lossy())
                .map_err(|error| Failure::Input(format!("SPECTRA_ISA: {error}")))?;
            // Code that is not passed an `Isa` must respect it too: film, searches, plugins.
            isa.limit();
            Ok(isa)
        }
        _ => Ok(Isa::detect()),
    }
}

fn log_to_stderr() {
    let format = tracing_subscriber::fmt().with_writer(std::io::stderr).with_max_level(tracing::Level::DEBUG);
    // This fails only if a logger is already installed; that one stays in use.
    let _ = format.with_ansi(console::stderr_is_colored()).try_init();
}
