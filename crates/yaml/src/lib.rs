//! Parses YAML files to trees that know the place of every key and value.
//!
//! A file is one document of maps, lists, texts, numbers, booleans and nulls by the core schema of YAML 1.2,
//! with strict booleans (`true`, `false`). Anchors and aliases are expanded. Tags, merge keys, directives and
//! further documents are faults. The cost of a file is bounded by [`MAX_BYTES`], by [`MAX_NODES`] values after
//! expansion of aliases, and by [`MAX_DEPTH`] levels.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod build;
mod items;
mod mistakes;
mod reports;
mod syntax;
#[cfg(test)]
mod tests;
mod tree;

use spectra_core::params::{Fault, Faults, MAX_DEPTH, Node, SourceFile, Span};
use std::sync::Arc;

/// Size of the largest file that is read, bytes.
pub const MAX_BYTES: usize = 4 * 1024 * 1024;

/// Largest number of values in a file, after expansion of aliases.
pub const MAX_NODES: usize = 200_000;

/// Parses the text of a YAML file.
///
/// # Errors
/// Returns every fault up to the first syntax error, each with its place.
pub fn parse(mut file: SourceFile) -> Result<Node, Faults> {
    if file.text.len() > MAX_BYTES {
        return Err(too_large(&file.name, file.text.len() as u64).into());
    }
    if file.text.starts_with('\u{feff}') {
        file.text.remove(0);
    }
    build::document(&Arc::new(file), Span::default())
}

/// Parses the bytes of a YAML file; `name` is the name of the file in messages.
///
/// # Errors
/// Fails like [`parse`], and if the bytes are not UTF-8.
pub fn parse_bytes(name: &str, bytes: &[u8]) -> Result<Node, Faults> {
    if bytes.len() > MAX_BYTES {
        return Err(too_large(name, bytes.len() as u64).into());
    }
    match std::str::from_utf8(bytes) {
        Ok(text) => parse(SourceFile::new(name, text)),
        Err(error) => Err(not_utf8(name, bytes, error.valid_up_to()).into()),
    }
}

/// Returns the fault for a file that is larger than [`MAX_BYTES`].
#[must_use]
pub fn too_large(name: &str, bytes: u64) -> Fault {
    Fault::new(format!("the file has {bytes} bytes, at most {MAX_BYTES} are read"))
        .at(Arc::new(SourceFile::new(name, "")), Span::default())
        .hint("is this a scene, lens or stock file?")
}

fn not_utf8(name: &str, bytes: &[u8], valid: usize) -> Fault {
    let hint = match bytes {
        [0xff, 0xfe, ..] | [0xfe, 0xff, ..] => "it looks like UTF-16: save it as UTF-8",
        _ if is_picture(bytes) => "it is a picture: a scene names it under `source: {kind: picture, file: ...}`",
        [b'P', b'K', 3, 4, ..] | [0x1f, 0x8b, ..] => "it is an archive: unpack it first",
        _ => "save it as UTF-8",
    };
    let text = String::from_utf8_lossy(bytes).into_owned();
    // Both texts are equal up to the first invalid byte.
    let before = text.get(..valid).unwrap_or("");
    let span = Span { len: '\u{fffd}'.len_utf8(), ..behind(Span::default(), before) };
    Fault::new("this byte is not UTF-8").at(Arc::new(SourceFile::new(name, text)), span).hint(hint)
}

/// Whether the bytes begin like a PNG, JPEG, OpenEXR, TIFF or GIF file.
fn is_picture(bytes: &[u8]) -> bool {
    const MAGIC: [&[u8]; 6] = [b"\x89PNG", b"\xff\xd8\xff", b"\x76\x2f\x31\x01", b"II*\0", b"MM\0*", b"GIF8"];
    MAGIC.iter().any(|magic| bytes.starts_with(magic))
}

/// Returns the place after the text `skipped`, which starts at `place`. Lines end as for the parser: with LF, CR, or both.
fn behind(place: Span, skipped: &str) -> Span {
    let mut at = Span { offset: place.offset + skipped.len(), len: 0, ..place };
    let mut characters = skipped.chars().peekable();
    while let Some(c) = characters.next() {
        match c {
            '\r' if characters.peek() == Some(&'\n') => {}
            '\n' | '\r' => at = Span { line: at.line + 1, column: 1, ..at },
            _ => at.column += 1,
        }
    }
    at
}

/// A setting of the command line, `--set path=value`.
#[derive(Clone, Debug)]
pub struct Override {
    /// Path of the key to set, such as `film.exposure`.
    pub path: String,
    /// Value to set. Messages state its place as the argument, such as `--set film.exposure=2 s`.
    pub node: Node,
}

impl Override {
    /// Sets the value in a tree; missing maps are created.
    ///
    /// # Errors
    /// Fails if the path leads through a value that is neither a map nor a list.
    pub fn apply(self, root: &mut Node) -> Result<(), Fault> {
        root.set_path(&self.path, self.node)
    }
}

/// Parses `path=value` with a value in YAML: `film.exposure=1/60 s`, `output=[exr, png]`.
///
/// # Errors
/// Fails if the argument has no `=` or nothing after it, if its path is ill-formed, or if its value is not YAML.
pub fn parse_override(argument: &str) -> Result<Override, Faults> {
    /// Longest argument that a message repeats, in bytes.
    const SHOWN: usize = 60;
    let is_path =
        |text: &str| !text.is_empty() && text.chars().all(|c| c.is_ascii_alphanumeric() || ".-_[]".contains(c));
    let hint = if is_path(argument) && argument.len() <= SHOWN {
        format!("write a value after it, without a space: `--set {argument}=VALUE`")
    } else {
        "write `--set film.exposure=\"1/60 s\"`".to_owned()
    };
    let Some((path, value)) = argument.split_once('=') else {
        let file = SourceFile::new(
            if argument.len() > SHOWN { "--set".to_owned() } else { format!("--set {argument}") },
            argument,
        );
        return Err(Fault::new("`=` is missing").at(Arc::new(file), Span::default()).hint(hint).into());
    };
    let name = if argument.len() <= SHOWN { format!("--set {argument}") } else { format!("--set {path:.SHOWN$}=...") };
    let file = Arc::new(SourceFile::new(name, argument));
    if argument.len() > MAX_BYTES {
        return Err(too_large(&file.name, argument.len() as u64).into());
    }
    let path = path.trim();
    if let Err(message) = spectra_core::params::steps(path) {
        return Err(Fault::new(message).at(file, Span { len: path.len(), ..Span::default() }).hint(hint).into());
    }
    let before = &argument[..argument.len() - value.len()];
    // The value may come from an empty shell variable; a null would then not be what the user meant.
    if value.trim().is_empty() {
        let fault = Fault::new(format!("`{path}` has no value")).at(file, Span { len: path.len(), ..Span::default() });
        return Err(fault.hint(format!("write one after `=`; `--set {path}=null` leaves the key out")).into());
    }
    let start = Span { line: 1, column: 1 + before.chars().count(), offset: before.len(), len: value.len() };
    let node = build::document(&file, start)?;
    Ok(Override { path: path.to_owned(), node })
}
