//! YAML files as trees with the place of every key and value.
//!
//! A file is one document of maps, lists, texts, numbers, booleans and nulls by the core schema of YAML 1.2,
//! with strict booleans (`true`, `false`); anchors and aliases are expanded, tags, merge keys, directives and
//! further documents are faults. What a file may cost is bounded: [`MAX_BYTES`], [`MAX_NODES`] values with
//! aliases expanded, and [`MAX_DEPTH`] levels.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod build;
mod items;
mod reports;
mod slips;
mod syntax;
#[cfg(test)]
mod tests;
mod tree;

use spectra_core::params::{Fault, Faults, MAX_DEPTH, Node, SourceFile, Span};
use std::sync::Arc;

/// Largest file that is read, in bytes.
pub const MAX_BYTES: usize = 4 * 1024 * 1024;

/// Most values in a file, aliases expanded.
pub const MAX_NODES: usize = 200_000;

/// Parses a text.
///
/// # Errors
/// Everything that is wrong with it up to the first error of syntax, each with its place.
pub fn parse(mut file: SourceFile) -> Result<Node, Faults> {
    if file.text.len() > MAX_BYTES {
        return Err(too_large(&file.name, file.text.len() as u64).into());
    }
    if file.text.starts_with('\u{feff}') {
        file.text.remove(0);
    }
    build::document(&Arc::new(file), Span::default())
}

/// Parses the bytes of a file with a name for messages.
///
/// # Errors
/// As [`parse`]; and where the bytes are not UTF-8.
pub fn parse_bytes(name: &str, bytes: &[u8]) -> Result<Node, Faults> {
    if bytes.len() > MAX_BYTES {
        return Err(too_large(name, bytes.len() as u64).into());
    }
    match std::str::from_utf8(bytes) {
        Ok(text) => parse(SourceFile::new(name, text)),
        Err(error) => Err(not_utf8(name, bytes, error.valid_up_to()).into()),
    }
}

/// That a file has too many bytes.
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
    // Up to the first bad byte both texts are equal.
    let before = text.get(..valid).unwrap_or("");
    let span = Span { len: '\u{fffd}'.len_utf8(), ..behind(Span::default(), before) };
    Fault::new("this byte is not UTF-8").at(Arc::new(SourceFile::new(name, text)), span).hint(hint)
}

/// Whether the bytes begin as PNG, JPEG, OpenEXR, TIFF or GIF files do.
fn is_picture(bytes: &[u8]) -> bool {
    const MAGIC: [&[u8]; 6] = [b"\x89PNG", b"\xff\xd8\xff", b"\x76\x2f\x31\x01", b"II*\0", b"MM\0*", b"GIF8"];
    MAGIC.iter().any(|magic| bytes.starts_with(magic))
}

/// The place behind `skipped`, which starts at `place`. Lines end as the parser ends them: LF, CR, or both.
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

/// One `--set path=value` of the command line.
#[derive(Clone, Debug)]
pub struct Override {
    /// Where it goes, such as `film.exposure`.
    pub path: String,
    /// What is put there. Its place reads `--set film.exposure=...`.
    pub node: Node,
}

impl Override {
    /// Puts it into a tree; maps that are missing are created.
    ///
    /// # Errors
    /// The path leads through what is no map or no list.
    pub fn apply(self, root: &mut Node) -> Result<(), Fault> {
        root.set_path(&self.path, self.node)
    }
}

/// Parses `path=value`, the value as YAML: `film.exposure=1/60 s`, `output=[exr, png]`.
///
/// # Errors
/// The argument has no `=` or nothing behind it, its path is ill-formed, or its value is not YAML.
pub fn parse_override(argument: &str) -> Result<Override, Faults> {
    /// Longest argument that a message repeats, in bytes.
    const SHOWN: usize = 60;
    let is_path =
        |text: &str| !text.is_empty() && text.chars().all(|c| c.is_ascii_alphanumeric() || ".-_[]".contains(c));
    let hint = if is_path(argument) && argument.len() <= SHOWN {
        format!("write a value behind it, without a space: `--set {argument}=VALUE`")
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
    // A variable of the shell that holds nothing: what is taken then would not be what was meant.
    if value.trim().is_empty() {
        let fault = Fault::new(format!("`{path}` has no value")).at(file, Span { len: path.len(), ..Span::default() });
        return Err(fault.hint(format!("write one behind `=`; `--set {path}=null` leaves the key out")).into());
    }
    let start = Span { line: 1, column: 1 + before.chars().count(), offset: before.len(), len: value.len() };
    let node = build::document(&file, start)?;
    Ok(Override { path: path.to_owned(), node })
}
