//! `spectra doc`: shows what a stage does and which parameters it takes.

use crate::arguments::Doc;
use crate::console;
use crate::outcome::{DONE, Failure, Outcome};
use serde_json::{Value, json};
use spectra_core::names::{self, Match};
use spectra_core::params::Fault;
use spectra_core::registry::{self, Documentation, Listed, Parameter, ValueForm};
use spectra_scene::bundled::{self, Bundled};
use spectra_scene::{FileKind, FoundKeys, file_documentation, find_keys, key_pages, shared_documentation};
use std::fmt::Write;

/// Width of a page, characters.
const WIDTH: usize = 100;

/// Writes a documentation page, or the results of `--search`, to standard output.
pub(crate) fn doc(arguments: &Doc) -> Outcome {
    if let Some(word) = &arguments.search {
        let hits = search(word)?;
        if arguments.report.json {
            console::pretty_json(&hits.iter().map(Hit::to_json).collect::<Vec<_>>())?;
        } else {
            console::out(&hits.iter().map(Hit::text).collect::<String>())?;
        }
        return Ok(DONE);
    }
    let page = find(arguments.name.as_deref().unwrap_or_default().trim())?;
    if arguments.report.json {
        console::pretty_json(&page.to_json())?;
    } else {
        console::out(&page.text())?;
    }
    Ok(DONE)
}

/// A documentation page.
enum Page {
    /// One stage, such as `surface/sphere`.
    Stage(Listed),
    /// A kind of stage: its members and the parameters that they share.
    Kind(&'static str, Vec<Listed>),
    /// A kind of file.
    File(FileKind),
    /// A key given by name or path.
    Keys(FoundKeys),
}

/// Looks up a name without a page: a lens, a film, a spectrum or a term of photography. Returns what it is and the command that shows it.
fn elsewhere(name: &str) -> Option<(String, String)> {
    if let Some((what, command)) = crate::glossary::lookup(name) {
        return Some((what.to_owned(), command.to_owned()));
    }
    let (kind, name) = bundled::meanings(name).into_iter().next()?;
    let command = match kind {
        Bundled::Scene => "check",
        Bundled::Lens => "lens info",
        Bundled::Stock => "film info",
        Bundled::Spectrum => "spectrum info",
        Bundled::Glass => "glass info",
    };
    Some((kind.noun().to_owned(), format!("spectra {command} {name}")))
}

/// A stage or a key found by `--search`.
struct Hit {
    page: String,
    /// Path of the key; empty if the page itself matched.
    key: String,
    text: String,
}

impl Hit {
    fn to_json(&self) -> Value {
        json!({ "page": self.page, "key": self.key, "text": self.text })
    }

    fn text(&self) -> String {
        let mut out = if self.key.is_empty() { self.page.clone() } else { format!("{}  {}", self.page, self.key) };
        out.push('\n');
        wrapped(&mut out, &self.text, 6, 6);
        out
    }
}

/// Finds every page and key whose name or text contains the word. Fails if there is none.
fn search(word: &str) -> Result<Vec<Hit>, Failure> {
    let wanted = word.trim().to_lowercase();
    let holds = |text: &str| !wanted.is_empty() && text.to_lowercase().contains(&wanted);
    let mut hits = Vec::new();
    for page in key_pages() {
        if page.page.contains('/') && (holds(&page.page) || holds(&page.summary)) {
            hits.push(Hit { page: page.page.clone(), key: String::new(), text: page.summary.clone() });
        }
        for p in page.parameters.iter().filter(|p| holds(&p.key) || holds(&p.description)) {
            hits.push(Hit { page: page.page.clone(), key: p.key.clone(), text: p.description.clone() });
        }
    }
    if hits.is_empty() {
        let fault = Fault::new(format!("no stage or key mentions `{word}`"));
        return Err(fault.hint("try a shorter word; `spectra list` shows all names").into());
    }
    Ok(hits)
}

/// Finds the page of a name: a stage (`surface/sphere`, or `sphere` if unique), a kind of stage, a kind of file, or a key.
fn find(name: &str) -> Result<Page, Failure> {
    let all = registry::list();
    let wanted: Vec<&Listed> = match name.split_once('/') {
        Some((stage, kind)) => all.iter().filter(|l| l.stage == stage && l.name == kind).collect(),
        None => {
            // A name of both a file and a stage means the file: `spectra doc lens`.
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
            let meaning = elsewhere(name);
            let near_keys = match find_keys(name, meaning.is_some()) {
                Ok(found) => return Ok(Page::Keys(found)),
                Err(near) => near,
            };
            let mut names: Vec<String> = all.iter().map(full).collect();
            names.extend(all.iter().map(|l| l.stage.to_owned()));
            names.extend(all.iter().map(|l| l.name.to_owned()));
            names.extend(FileKind::ALL.map(|kind| kind.name().to_owned()));
            if let Some((what, command)) = meaning {
                let fault = Fault::new(format!("`{name}` has no page of its own: {what}"));
                return Err(fault.hint(format!("see `{command}`")).into());
            }
            let fault = Fault::new(format!("nothing is called `{name}`"));
            if let Match::One(one) = names::find(name, names.iter().map(String::as_str)) {
                return find(one);
            }
            if let Err(glasses) = Bundled::Glass.find(name)
                && !glasses.is_empty()
            {
                return Err(fault.hint(format!("glasses: `spectra list glass {name}`")).into());
            }
            let near = names::nearest(name, names.iter().map(String::as_str)).map(str::to_owned);
            let hint = match (near, near_keys.as_slice()) {
                (Some(near), _) => format!("did you mean `{near}`?"),
                (None, [one]) => format!("did you mean `{one}`?"),
                (None, [_, ..]) => format!("which one? {}", near_keys.join(", ")),
                (None, []) => {
                    "`spectra list` shows all names, `spectra doc --search WORD` searches the descriptions".to_owned()
                }
            };
            Err(fault.hint(hint).into())
        }
        _ => {
            let names: Vec<String> = wanted.into_iter().map(full).collect();
            Err(Failure::Input(format!("`{name}` is ambiguous: {}", names.join(", "))))
        }
    }
}

/// Returns the documentation of a stage as JSON.
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
            Self::Keys(found) => json!({
                "key": found.key,
                "found": found.pages.iter().map(|(page, all)| json!({ "page": page, "parameters": all })).collect::<Vec<_>>(),
            }),
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
                    let _ = writeln!(out, "\nParameters that every {0} has: `spectra doc {0}`.", stage.stage);
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
                    let _ = writeln!(out, "\nParameters of every {kind}:");
                    parameters(&mut out, &shared.parameters);
                }
                let _ = writeln!(out, "\nMore: `spectra doc {kind}/NAME`.");
            }
            Self::File(kind) => {
                let _ = writeln!(out, "{} file\n", kind.name());
                body(&mut out, &file_documentation(*kind));
            }
            Self::Keys(found) => {
                for (at, (page, all)) in found.pages.iter().enumerate() {
                    let gap = if at == 0 { "" } else { "\n" };
                    let _ = writeln!(out, "{gap}{page} (the whole page: `spectra doc {page}`)");
                    parameters(&mut out, all);
                }
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

/// Smallest number of keys that a reference replaces; fewer keys are written out again.
const WORTH_A_REFERENCE: usize = 3;

/// Returns the keys below the key at index `at`, with their paths relative to it.
fn below(all: &[Parameter], at: usize) -> Vec<(&str, &Parameter)> {
    let head = all[at].key.as_str();
    let inside = all[at + 1..].iter().map_while(|p| Some((p.key.strip_prefix(head)?, p)));
    let inside = inside.take_while(|(rest, _)| rest.starts_with(['.', '[', '(']));
    // A list of maps has the same keys as a single map.
    inside.map(|(rest, p)| (rest.trim_start_matches("[]"), p)).collect()
}

/// Writes parameters in the order of their declaration. A key shared by several kinds is described once, and so are the keys of a
/// map that occurs in several places.
fn parameters(out: &mut String, all: &[Parameter]) {
    let mut told: Vec<usize> = Vec::new();
    let mut skip = 0;
    for (at, p) in all.iter().enumerate() {
        if skip > 0 {
            skip -= 1;
            continue;
        }
        // A key that occurs in several forms of a map was described with the first of them.
        if all[..at].iter().any(|other| other.key == p.key) {
            continue;
        }
        let forms: Vec<&Parameter> = all[at..].iter().filter(|other| other.key == p.key).collect();
        let own = below(all, at);
        let alike = |a: &(&str, &Parameter), b: &(&str, &Parameter)| a.0 == b.0 && a.1.description == b.1.description;
        let equal = |other: &usize| {
            let theirs = below(all, *other);
            theirs.len() == own.len() && theirs.iter().zip(&own).all(|(a, b)| alike(a, b))
        };
        let before = told.iter().copied().find(|other| own.len() >= WORTH_A_REFERENCE && equal(other));
        told.push(at);
        skip = if before.is_some() { own.len() } else { 0 };
        let reference = before.map(|other| format!(" Its keys are the same as those of `{}` above.", all[other].key));
        let mut words = vec![p.form.to_string()];
        if !p.unit.is_empty() && p.unit != "f/" && !p.description.contains("if bare") {
            words.push(format!("in {} if bare", p.unit));
        }
        words.extend([p.range.to_string()].into_iter().filter(|range| !range.is_empty()));
        match (&p.default, forms.iter().all(|form| form.required)) {
            (_, true) => words.push("required".to_owned()),
            (Some(default), _) => words.push(format!("default {}", plain(default))),
            (None, false) => {}
        }
        wrapped(out, &format!("{}: {}", p.key, words.join(", ")), 2, 10);
        let mut said = p.description.clone();
        // The usual example of a quantity shows how to write its unit. For a parameter whose unit is stated it would only mislead.
        let is_plain_number = match &p.form {
            ValueForm::Number => true,
            ValueForm::Quantity { noun, or_infinity } => noun == "ratio" && !or_infinity,
            _ => false,
        };
        if let (Some(example), false) = (p.examples.first(), is_plain_number || said.contains("if bare")) {
            let _ = write!(said, " Example: {}.", plain(example));
        }
        for form in &forms[1..] {
            if !said.contains(&form.description) {
                let _ = write!(said, " Or: {}", form.description);
            }
        }
        said.push_str(&reference.unwrap_or_default());
        wrapped(out, said.trim(), 6, 6);
    }
}

/// Formats a value as it is written in a scene.
fn plain(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        other => other.to_string(),
    }
}

/// Writes Markdown text: wraps paragraphs and lists, and leaves blocks of code as they are.
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

/// Writes a paragraph wrapped at [`WIDTH`], with the first line indented by `first` and the others by `others`.
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
