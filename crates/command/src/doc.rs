//! `spectra doc`: what a stage does, and what is written in it.

use crate::arguments::Doc;
use crate::console;
use crate::outcome::{DONE, Failure, Outcome};
use serde_json::{Value, json};
use spectra_core::params::nearest;
use spectra_core::registry::{self, Documentation, Listed, Parameter};
use spectra_scene::{FileKind, file_documentation, shared_documentation};
use std::fmt::Write;

/// Columns of a page.
const WIDTH: usize = 100;

/// Shows a page.
pub(crate) fn doc(arguments: &Doc) -> Outcome {
    let page = find(&arguments.name)?;
    if arguments.json {
        console::pretty_json(&page.to_json())?;
    } else {
        console::out(&page.text())?;
    }
    Ok(DONE)
}

/// What can be read about.
enum Page {
    /// A stage.
    Stage(Listed),
    /// A kind of stage: which there are, and what all of them take.
    Kind(&'static str, Vec<Listed>),
    /// A file.
    File(FileKind),
}

/// A stage as `surface/sphere`, or by its name alone where only one has it; a kind of stage; a kind of file.
fn find(name: &str) -> Result<Page, Failure> {
    let all = registry::list();
    let wanted: Vec<&Listed> = match name.split_once('/') {
        Some((stage, kind)) => all.iter().filter(|l| l.stage == stage && l.name == kind).collect(),
        None => {
            // What names both is a file: `spectra doc lens`.
            if let Some(kind) = FileKind::ALL.into_iter().find(|kind| kind.name() == name) {
                return Ok(Page::File(kind));
            }
            let of: Vec<Listed> = all.iter().filter(|l| l.stage == name).copied().collect();
            if let Some(first) = of.first() {
                return Ok(Page::Kind(first.stage, of));
            }
            all.iter().filter(|l| l.name == name).collect()
        }
    };
    let full = |l: &Listed| format!("{}/{}", l.stage, l.name);
    match wanted[..] {
        [one] => Ok(Page::Stage(*one)),
        [] => {
            let mut names: Vec<String> = all.iter().map(full).collect();
            names.extend(all.iter().map(|l| l.stage.to_owned()));
            names.extend(all.iter().map(|l| l.name.to_owned()));
            names.extend(FileKind::ALL.map(|kind| kind.name().to_owned()));
            let near = nearest(name, names.iter().map(String::as_str));
            let hint = near
                .map_or_else(|| "`spectra list` shows what there is".to_owned(), |n| format!("did you mean `{n}`?"));
            Err(Failure::Input(format!("nothing is called `{name}` ({hint})")))
        }
        _ => {
            let names: Vec<String> = wanted.into_iter().map(full).collect();
            Err(Failure::Input(format!("`{name}` is the name of several: {}", names.join(", "))))
        }
    }
}

/// A stage as a program reads it.
pub(crate) fn stage_json(stage: &Listed) -> Value {
    let documentation = stage.documentation();
    json!({
        "stage": stage.stage,
        "name": stage.name,
        "package": stage.package,
        "version": stage.version,
        "default": stage.default,
        "documentation": documentation,
    })
}

impl Page {
    fn to_json(&self) -> Value {
        match self {
            Self::Stage(stage) => stage_json(stage),
            Self::Kind(kind, all) => json!({
                "stage": kind,
                "kinds": all.iter().map(stage_json).collect::<Vec<_>>(),
                "shared": shared_documentation(kind),
            }),
            Self::File(kind) => json!({ "file": kind.name(), "documentation": file_documentation(*kind) }),
        }
    }

    fn text(&self) -> String {
        let mut out = String::new();
        // Writing to a String cannot fail.
        match self {
            Self::Stage(stage) => {
                let doc = stage.documentation();
                let default = if stage.default { ", the default" } else { "" };
                let _ =
                    writeln!(out, "{}/{} ({} {}{default})\n", stage.stage, stage.name, stage.package, stage.version);
                body(&mut out, &doc);
                if shared_documentation(stage.stage).is_some() {
                    let _ = writeln!(out, "\nWhat every {0} takes beside these: `spectra doc {0}`.", stage.stage);
                }
            }
            Self::Kind(kind, all) => {
                let _ = writeln!(out, "{kind}: one of\n");
                let width = all.iter().map(|l| l.name.len()).max().unwrap_or(0);
                for l in all {
                    let default = if l.default { " (default)" } else { "" };
                    let mut line = String::new();
                    wrapped(&mut line, &format!("{}{default}", l.documentation().summary), width + 4, width + 4);
                    line.replace_range(2..2 + l.name.len(), l.name);
                    out.push_str(&line);
                }
                if let Some(shared) = shared_documentation(kind) {
                    let _ = writeln!(out, "\nEvery {kind} takes, beside its own:");
                    parameters(&mut out, &shared.parameters);
                }
                let _ = writeln!(out, "\nMore: `spectra doc {kind}/NAME`.");
            }
            Self::File(kind) => {
                let _ = writeln!(out, "{} file\n", kind.name());
                body(&mut out, &file_documentation(*kind));
            }
        }
        out
    }
}

fn body(out: &mut String, doc: &Documentation) {
    wrapped(out, &doc.summary, 0, 0);
    if !doc.text.is_empty() {
        out.push('\n');
        markdown(out, &doc.text);
    }
    if doc.parameters.is_empty() {
        let _ = writeln!(out, "\nNo parameters.");
    } else {
        let _ = writeln!(out, "\nParameters");
        parameters(out, &doc.parameters);
    }
    for example in &doc.examples {
        let _ = writeln!(out, "\nExample");
        for line in example.lines() {
            let _ = writeln!(out, "  {line}");
        }
    }
    if !doc.references.is_empty() {
        let _ = writeln!(out, "\nReferences");
        for reference in &doc.references {
            wrapped(out, &format!("- {reference}"), 2, 4);
        }
    }
}

fn parameters(out: &mut String, all: &[Parameter]) {
    for p in all {
        let mut words = vec![p.kind.clone()];
        if !p.unit.is_empty() && p.unit != "f/" && !p.description.contains("if bare") {
            words.push(format!("in {} if bare", p.unit));
        }
        if !p.range.is_empty() {
            words.push(p.range.clone());
        }
        match (&p.default, p.required) {
            (_, true) => words.push("required".to_owned()),
            (Some(default), _) => words.push(format!("default {}", plain(default))),
            (None, false) => {}
        }
        wrapped(out, &format!("{}: {}", p.key, words.join(", ")), 2, 10);
        let mut said = p.description.clone();
        // The usual example of a quantity shows how it is written; where the unit is told it would only mislead.
        if let (Some(example), false) = (p.examples.first(), p.kind == "number" || said.contains("if bare")) {
            let _ = write!(said, " Such as {}.", plain(example));
        }
        wrapped(out, said.trim(), 6, 6);
    }
}

/// A value as a scene has it.
fn plain(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        other => other.to_string(),
    }
}

/// Markdown: paragraphs and lists are wrapped, blocks of code stay as they are.
fn markdown(out: &mut String, text: &str) {
    let mut paragraph = String::new();
    let end = |out: &mut String, paragraph: &mut String| {
        let hanging = if paragraph.starts_with("- ") { 2 } else { 0 };
        wrapped(out, paragraph, 0, hanging);
        paragraph.clear();
    };
    let mut in_block = false;
    for line in text.lines() {
        if line.trim_start().starts_with("```") {
            end(out, &mut paragraph);
            in_block = !in_block;
        } else if in_block {
            let _ = writeln!(out, "  {line}");
        } else if line.trim().is_empty() {
            end(out, &mut paragraph);
            out.push('\n');
        } else {
            if line.starts_with("- ") {
                end(out, &mut paragraph);
            }
            paragraph.push_str(line);
            paragraph.push(' ');
        }
    }
    end(out, &mut paragraph);
}

/// A paragraph in lines of [`WIDTH`], the first one and the others indented.
fn wrapped(out: &mut String, text: &str, first: usize, others: usize) {
    let (mut column, mut indent) = (0, first);
    for word in text.split_whitespace() {
        let length = word.chars().count();
        if column > 0 && column + 1 + length > WIDTH {
            out.push('\n');
            column = 0;
        }
        if column == 0 {
            let _ = write!(out, "{:indent$}", "");
            column = indent;
            indent = others;
        } else {
            out.push(' ');
            column += 1;
        }
        out.push_str(word);
        column += length;
    }
    if column > 0 {
        out.push('\n');
    }
}
