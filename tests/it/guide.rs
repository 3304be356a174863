//! Runs every command of the guide in order, each chapter in an empty folder with only the program on the path.
//!
//! A block ```` ```console ```` holds commands (lines that start with `$ `), each followed by its output if that matters. In the
//! output, `...` stands for any number of lines, or for any text within a line. A block in any language with `file=NAME` is written
//! to that file; `same-as=PATH` states that it equals a file of the repository. `console fails` states that the last command of the
//! block must fail.

use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Chapters that build a program, which takes minutes.
const WITH_RUST: [&str; 2] = ["add-a-surface.md", "add-a-film-process.md"];

fn source() -> PathBuf {
    crate::common::repository("docs/guide/src")
}

/// Returns the chapters in the order of the summary.
fn chapters() -> Vec<String> {
    let summary = fs::read_to_string(source().join("SUMMARY.md")).expect("the guide has a summary");
    let names: Vec<String> =
        summary.split("](").skip(1).filter_map(|rest| Some(rest.split_once(')')?.0.to_owned())).collect();
    assert!(names.len() >= 6, "{names:?}");
    names
}

/// A fenced block: its info string, its text, and the line on which it starts.
struct Block {
    info: String,
    text: String,
    line: usize,
}

fn blocks(text: &str) -> Vec<Block> {
    let mut found: Vec<Block> = Vec::new();
    let mut open = false;
    for (at, line) in text.lines().enumerate() {
        if let Some(info) = line.strip_prefix("```") {
            open = !open;
            if open {
                found.push(Block { info: info.trim().to_owned(), text: String::new(), line: at + 1 });
            }
        } else if open && let Some(block) = found.last_mut() {
            block.text.push_str(line);
            block.text.push('\n');
        }
    }
    assert!(!open, "a block is not closed");
    found
}

/// Returns the commands of a block, each with its expected output.
fn commands(block: &Block) -> Vec<(String, Vec<String>)> {
    let mut all: Vec<(String, Vec<String>)> = Vec::new();
    for line in block.text.lines() {
        if let Some(command) = line.strip_prefix("$ ") {
            all.push((command.to_owned(), Vec::new()));
        } else if let Some((_, expected)) = all.last_mut() {
            expected.push(line.to_owned());
        } else {
            panic!("line {}: a console block starts with a command", block.line);
        }
    }
    all
}

/// Returns whether lines match the expected ones, in which `...` stands for any lines or any part of a line.
fn matches(expected: &[String], lines: &[&str]) -> bool {
    match expected.split_first() {
        None => lines.is_empty(),
        Some((first, rest)) if first == "..." => (0..=lines.len()).any(|skip| matches(rest, &lines[skip..])),
        Some((first, rest)) => {
            lines.split_first().is_some_and(|(line, others)| line_matches(first, line) && matches(rest, others))
        }
    }
}

fn line_matches(expected: &str, line: &str) -> bool {
    let mut parts = expected.split("...").map(str::trim);
    let (Some(start), mut at) = (parts.next(), line.trim()) else { return false };
    if !expected.contains("...") {
        return start == at;
    }
    at = match at.strip_prefix(start) {
        Some(rest) => rest,
        None => return false,
    };
    parts.all(|part| at.find(part).map(|found| at = &at[found + part.len()..]).is_some())
}

/// Runs the commands of a chapter in an empty folder.
fn run(chapter: &str, folder: &Path) {
    let text = fs::read_to_string(source().join(chapter)).unwrap_or_else(|e| panic!("{chapter}: {e}"));
    let program = Path::new(env!("CARGO_BIN_EXE_spectra"));
    let mut path = OsString::from(program.parent().expect("a program lies in a folder"));
    path.push(":");
    path.push(std::env::var_os("PATH").unwrap_or_default());
    for block in blocks(&text) {
        let place = |at: usize| format!("{chapter}:{at}");
        let words: Vec<&str> = block.info.split_whitespace().collect();
        if let Some(name) = words.iter().find_map(|word| word.strip_prefix("file=")) {
            let file = folder.join(name);
            fs::create_dir_all(file.parent().expect("a file lies in a folder")).expect("a folder is made");
            fs::write(file, &block.text).expect("a file is written");
        }
        if let Some(name) = words.iter().find_map(|word| word.strip_prefix("same-as=")) {
            let same = fs::read_to_string(crate::common::repository(name)).unwrap_or_else(|e| panic!("{name}: {e}"));
            assert_eq!(block.text, same, "{}: not what {name} has", place(block.line));
        }
        if words.first() != Some(&"console") {
            continue;
        }
        let all = commands(&block);
        for (at, (command, expected)) in all.iter().enumerate() {
            let output = Command::new("sh")
                .args(["-ec", command])
                .current_dir(folder)
                .env("PATH", &path)
                .env("NO_COLOR", "1")
                .env_remove("SPECTRA_ISA")
                .stdin(Stdio::null())
                .output()
                .expect("a shell runs");
            let said = format!("{}{}", crate::common::text(&output.stdout), crate::common::text(&output.stderr));
            let fails = words.contains(&"fails") && at + 1 == all.len();
            assert_eq!(output.status.success(), !fails, "{}: `{command}`\n{said}", place(block.line));
            let lines: Vec<&str> = said.lines().collect();
            assert!(
                expected.is_empty() || matches(expected, &lines),
                "{}: `{command}` printed\n{said}\nbut the guide has\n{}",
                place(block.line),
                expected.join("\n")
            );
        }
    }
}

/// Makes a test for each chapter whose commands are run as written.
macro_rules! chapters_as_written {
    ($($test:ident $chapter:literal),* $(,)?) => {
        const AS_WRITTEN: &[&str] = &[$($chapter),*];
        mod as_written {
            $(
                #[test]
                fn $test() {
                    let folder = tempfile::tempdir().expect("a folder");
                    super::run($chapter, folder.path());
                }
            )*
        }
    };
}

chapters_as_written! {
    introduction "introduction.md",
    first_picture "first-picture.md",
    view "view.md",
    lens_from_patent "lens-from-patent.md",
    examine_a_lens "examine-a-lens.md",
    add_a_film "add-a-film.md",
    data "data.md",
    scene_language "scene-language.md",
    light "light.md",
    choose_a_sampler "choose-a-sampler.md",
    finishing "finishing.md",
    measure "measure.md",
    editor "editor.md",
    what_it_does "what-it-does.md",
}

#[test]
fn every_chapter_is_run() {
    let mut known: Vec<&str> = AS_WRITTEN.iter().chain(&WITH_RUST).copied().collect();
    let mut all = chapters();
    known.sort_unstable();
    all.sort_unstable();
    assert_eq!(all, known, "chapters_as_written! must list every chapter that compiles nothing");
    let of = |chapter: &&str| fs::read_to_string(source().join(chapter)).expect("a chapter");
    let commands_run =
        AS_WRITTEN.iter().flat_map(|chapter| blocks(&of(chapter))).filter(|b| b.info.starts_with("console"));
    assert!(commands_run.count() >= 10);
}

/// Runs the chapters that make a plugin and build a program with it, which takes minutes. `.ci/run` runs this test.
#[test]
#[ignore = "compiles programs for minutes: cargo test --test it guide -- --ignored"]
fn plugins_are_made_as_written() {
    for chapter in WITH_RUST {
        let folder = tempfile::tempdir().expect("a folder");
        run(chapter, folder.path());
    }
}

#[test]
fn what_is_printed_is_compared() {
    let is = |expected: &[&str], printed: &[&str]| {
        let expected: Vec<String> = expected.iter().map(|&e| e.to_owned()).collect();
        matches(&expected, printed)
    };
    assert!(is(&["a", "..."], &["a", "b", "c"]));
    assert!(is(&["...", "f ..."], &["x", "f   12 mm"]));
    assert!(is(&["..."], &[]));
    assert!(is(&["b ... mm"], &["b 12 mm"]));
    assert!(!is(&["a"], &["a", "b"]));
    assert!(!is(&["...", "z"], &["a", "b"]));
    assert!(!is(&[], &["a"]));
    assert!(!is(&["b ... mm"], &["c 12 mm"]));
}
