//! Comments and documents that can be read alone.
//!
//! rustdoc shows each doc comment without its neighbors, so none may begin with a word that needs the one above, and none of a public item may
//! be shorter than four words. Sentences of the two pages that a newcomer reads first are short.

use crate::common::repository;
use std::path::Path;

/// Beginnings of a doc comment that refer to something outside of it.
const FRAGMENTS: [&str; 26] = [
    "The same ",
    "Of ",
    "That ",
    "Those ",
    "As ",
    "Who ",
    "Whose ",
    "Which ",
    "Nothing ",
    "None ",
    "With ",
    "Without ",
    "For ",
    "Its ",
    "It ",
    "They ",
    "Their ",
    "So ",
    "Such ",
    "And ",
    "But ",
    "Then ",
    "In which ",
    "To which ",
    "By which ",
    "Also ",
];
/// Fewest words of the doc comment of a public function, type, trait, macro or module.
const FEWEST_WORDS: usize = 4;
/// Most words of a sentence of `README.md` and `ARCHITECTURE.md`.
const MOST_WORDS: usize = 30;

/// A doc comment: the line on which it begins, from 1, its text, and the line of code below it.
struct Comment {
    line: usize,
    text: String,
    item: String,
    is_module: bool,
}

/// Returns the doc comments of a source file.
fn comments(source: &str) -> Vec<Comment> {
    let mut found: Vec<Comment> = Vec::new();
    let mut open: Option<Comment> = None;
    for (number, line) in source.lines().enumerate() {
        let line = line.trim();
        let doc = line.strip_prefix("//!").or(line.strip_prefix("///").filter(|rest| !rest.starts_with('/')));
        let is_module = line.starts_with("//!");
        match (doc, open.as_mut()) {
            (Some(text), Some(comment)) if comment.is_module == is_module => {
                comment.text.push(' ');
                comment.text.push_str(text.trim());
            }
            (Some(text), _) => {
                found.extend(open.take());
                open = Some(Comment { line: number + 1, text: text.trim().to_owned(), item: String::new(), is_module });
            }
            (None, Some(_)) if line.starts_with("#[") || line.starts_with("//") => {}
            (None, _) => {
                if let Some(mut comment) = open.take() {
                    comment.item = line.to_owned();
                    found.push(comment);
                }
            }
        }
    }
    found.extend(open);
    found
}

/// Returns every Rust file of the workspace's sources below `folder`.
fn sources(folder: &Path, all: &mut Vec<std::path::PathBuf>) {
    let Ok(entries) = std::fs::read_dir(folder) else { return };
    for path in entries.filter_map(|entry| Some(entry.ok()?.path())) {
        if path.is_dir() && !path.ends_with("target") {
            sources(&path, all);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            all.push(path);
        }
    }
}

#[test]
fn doc_comments_can_be_read_alone() {
    let mut files = Vec::new();
    ["src", "crates", "plugins"].iter().for_each(|folder| sources(&repository(folder), &mut files));
    assert!(files.len() > 500, "{} files", files.len());
    files.sort();
    let mut faults = Vec::new();
    for file in files {
        let source = std::fs::read_to_string(&file).expect("a source");
        let name = file.strip_prefix(repository("")).expect("below the root").display().to_string();
        for Comment { line, text, item, is_module } in comments(&source) {
            if FRAGMENTS.iter().any(|fragment| text.starts_with(fragment)) {
                faults.push(format!("{name}:{line}: begins with a fragment: {text}"));
            }
            let kinds = ["pub fn ", "pub struct ", "pub enum ", "pub trait ", "pub type ", "pub mod ", "macro_rules! "];
            let is_public = is_module || kinds.iter().any(|kind| item.starts_with(kind));
            if is_public && text.split_whitespace().count() < FEWEST_WORDS {
                faults.push(format!("{name}:{line}: under {FEWEST_WORDS} words: {text}"));
            }
        }
    }
    assert!(faults.is_empty(), "{} comments:\n{}", faults.len(), faults.join("\n"));
}

/// Returns the sentences of a Markdown page, without code blocks, tables and headings.
fn sentences(page: &str) -> Vec<String> {
    let mut paragraphs = vec![String::new()];
    let mut is_code = false;
    for line in page.lines() {
        let line = line.trim();
        if line.starts_with("```") {
            is_code = !is_code;
        }
        let is_item = line.starts_with("- ") || line.chars().next().is_some_and(|c| c.is_ascii_digit());
        if is_code || line.is_empty() || is_item || ["|", "#", "!", "```"].iter().any(|mark| line.starts_with(mark)) {
            paragraphs.push(String::new());
        }
        if !is_code && !["|", "#", "!", "```"].iter().any(|mark| line.starts_with(mark)) {
            let last = paragraphs.last_mut().expect("one at least");
            last.push(' ');
            last.push_str(line);
        }
    }
    let ends = |text: String| -> Vec<String> {
        text.replace("? ", ". ").replace(": ", ". ").split(". ").map(str::to_owned).collect()
    };
    paragraphs.into_iter().flat_map(ends).collect()
}

#[test]
fn sentences_for_newcomers_are_short() {
    for page in ["README.md", "ARCHITECTURE.md"] {
        let text = std::fs::read_to_string(repository(page)).expect("a page");
        let all = sentences(&text);
        assert!(all.len() > 30, "{page}: {} sentences", all.len());
        let long: Vec<&String> = all.iter().filter(|s| s.split_whitespace().count() > MOST_WORDS).collect();
        assert!(long.is_empty(), "{page}: {} sentences over {MOST_WORDS} words: {long:#?}", long.len());
    }
}

/// Pages that a newcomer reads stay as short as they were made: bytes at most, with room for what is added.
#[test]
fn pages_for_newcomers_are_short() {
    for (page, most) in
        [("README.md", 7_000), ("ARCHITECTURE.md", 12_000), ("CHANGELOG.md", 4_000), ("benches/README.md", 8_000)]
    {
        let bytes = std::fs::metadata(repository(page)).expect("a page").len();
        assert!(bytes <= most, "{page}: {bytes} bytes, at most {most}");
    }
}
