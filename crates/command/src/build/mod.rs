//! `spectra build`: builds a version of this program that includes third-party plugins.
//!
//! Plugins are linked, not loaded: cargo builds a small generated crate that depends on the command, the built-in plugins and the given
//! ones. Everything that can be checked about a plugin is checked before cargo runs. Afterwards the new program is asked for its stages. It
//! gets its final name only if each plugin added some.
//!
//! The sources are those that the program carries, unpacked once into the user's cache, or a checkout. The manifest of a plugin asks for a
//! version of `spectra-core`. A `[patch]` section states where that lies, and that of the generated crate takes precedence.

mod arguments;
mod cargo;
mod metadata;
mod notices;
mod plugin;
mod program;
mod stages;

pub(crate) use arguments::BuildArguments;

use crate::console;
use crate::outcome::{DONE, Failure, Outcome};
use crate::sources::{Sources, Unpack};
use cargo::Cargo;
use plugin::Plugin;
use program::Program;
use spectra_core::params::{Fault, Faults};
use spectra_files::copy_atomically;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Builds a program with plugins and lists the stages that they add.
pub(crate) fn build(arguments: &BuildArguments, unpack: Unpack, started: Instant) -> Outcome {
    let output = output(&arguments.output, arguments.force)?;
    let sources = Sources::find(arguments.core.as_deref(), unpack)?;
    let cargo = Cargo::find(arguments.offline)?;
    let plugins = plugins(&arguments.with, &cargo, &sources)?;
    let program = Program::write(&sources, &plugins)?;
    let graph = cargo.check_graph(&program.manifest, &sources)?;
    let notices = notices::of(&graph, &program, &sources);
    if !notices.unlicensed.is_empty() {
        console::warning(&format!(
            "no license is stated by {}\n  help: without one, others may not use or pass on the program; its author can \
             add `license = \"...\"` to its Cargo.toml",
            notices.unlicensed.join(", ")
        ));
    }
    program.set_notices(&notices.text)?;
    let built = cargo.build([&program.name, arguments.profile.name()], [&program.manifest, &program.target])?;
    let added = stages::added(&built, &plugins)?;
    install(&built, &output)?;
    for (plugin, stages) in plugins.iter().zip(&added) {
        console::out(&format!("{} {}: {}\n", plugin.package, plugin.version, stages.join(", ")))?;
    }
    let took = crate::formatting::duration(started.elapsed().as_secs_f64());
    let all: Vec<&str> = added.iter().flatten().map(String::as_str).collect();
    console::out(&format!("{} is ready ({took}): all of spectra, and {}\n", output.display(), all.join(", ")))?;
    Ok(DONE)
}

/// Reads all plugins, or returns every fault in any of them.
fn plugins(with: &[PathBuf], cargo: &Cargo, sources: &Sources) -> Result<Vec<Plugin>, Failure> {
    let mut faults = Faults::new();
    let mut plugins: Vec<Plugin> = Vec::new();
    for path in with {
        let Some(plugin) = faults.take(Plugin::read(path, cargo, sources)) else { continue };
        match plugins.iter().find(|other| other.package == plugin.package) {
            // A plugin may be named twice.
            Some(other) if other.folder == plugin.folder => {}
            Some(other) => faults.push(
                Fault::new(format!(
                    "{} and {}: both packages are called `{}`",
                    other.folder.display(),
                    plugin.folder.display(),
                    plugin.package
                ))
                .hint("rename one of them in its Cargo.toml"),
            ),
            None => plugins.push(plugin),
        }
    }
    plugins.sort_by(|a, b| a.package.cmp(&b.package));
    Ok(faults.into_result(plugins)?)
}

/// Returns the path of the program to write, with the extension `.exe` on Windows. Fails if it cannot be written or if an existing file
/// must be kept.
fn output(path: &Path, force: bool) -> Result<PathBuf, Failure> {
    let mut path = path.to_owned();
    let ending = std::env::consts::EXE_EXTENSION;
    if !ending.is_empty() && path.extension().is_none() {
        path.set_extension(ending);
    }
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let fault = |text: &str, hint: &str| {
        Err(Failure::from(Fault::new(format!("--output {}: {text}", path.display())).hint(hint.to_owned())))
    };
    if path.is_dir() {
        return fault("that is a folder", "name the file to write, such as ./spectra-mine");
    }
    if !folder.is_dir() || path.file_name().is_none() {
        return fault("there is no such folder", "create it first");
    }
    if !force && path.exists() && !is_ours(&path) {
        return fault(
            "that file was not made by `spectra build`",
            "choose another name, or use --force to overwrite it",
        );
    }
    Ok(path)
}

/// Text that every program built from these sources contains, so that it can be recognized.
const MARK: &[u8] = b"spectra-program-made-by-spectra-build";

/// Whether a file is a program that contains spectra. The file is only read, because running an unknown program is not safe.
fn is_ours(path: &Path) -> bool {
    use std::io::Read;
    let mut head = [0; 4];
    let is_program = |head: &[u8; 4]| {
        // ELF; Mach-O, 64-bit and universal; Windows.
        matches!(
            head,
            [0x7f, b'E', b'L', b'F'] | [0xcf, 0xfa, 0xed, 0xfe] | [0xca, 0xfe, 0xba, 0xbe] | [b'M', b'Z', ..]
        )
    };
    let Ok(mut file) = std::fs::File::open(path) else { return false };
    if !path.is_file() || file.read_exact(&mut head).is_err() || !is_program(&head) {
        return false;
    }
    let mut bytes = Vec::new();
    // A program with spectra has some tens of MB.
    let read = file.take(1 << 30).read_to_end(&mut bytes);
    // `black_box` keeps the mark in this program's data, where another run looks for it.
    read.is_ok() && bytes.windows(MARK.len()).any(|window| window == std::hint::black_box(MARK))
}

/// Copies the finished program to its final name.
fn install(built: &Path, output: &Path) -> Result<(), Failure> {
    Ok(copy_atomically(built, output)?)
}
