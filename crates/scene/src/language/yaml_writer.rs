//! Conversion of a tree back to YAML, to record the scene of a picture.

use spectra_core::params::{Node, Value};
use std::fmt::Write as _;

/// Writes a whole scene in block style, with lists and maps of scalars on one line. Reading the text gives the same tree.
#[must_use]
pub fn document(root: &Node) -> String {
    let mut out = String::new();
    block(root, 0, &mut out);
    out
}

/// Writes a value on one line: `f/2.8`, `[1, 2]`, `{stock: ilford-ortho-plus}`.
#[must_use]
pub(crate) fn one_line(node: &Node) -> String {
    let mut out = String::new();
    flow(node, &mut out);
    out
}

/// Largest number of characters of a list or map on one line.
const LINE: usize = 96;

fn block(node: &Node, indent: usize, out: &mut String) {
    match &node.value {
        Value::Map(entries) if !entries.is_empty() => {
            for (key, value) in entries {
                out.push_str(&" ".repeat(indent));
                out.push_str(&key_text(&key.text));
                out.push(':');
                value_behind(value, indent, out);
            }
        }
        _ => {
            out.push_str(&" ".repeat(indent));
            flow(node, out);
            out.push('\n');
        }
    }
}

/// Writes a value after its key, on the same line or below.
fn value_behind(node: &Node, indent: usize, out: &mut String) {
    let line = one_line(node);
    let long = line.chars().count() > LINE;
    match &node.value {
        Value::Map(entries) if long && !entries.is_empty() => {
            out.push('\n');
            block(node, indent + 2, out);
        }
        Value::Seq(elements) if long && !elements.is_empty() => {
            out.push('\n');
            for element in elements {
                out.push_str(&" ".repeat(indent + 2));
                out.push_str("- ");
                flow(element, out);
                out.push('\n');
            }
        }
        _ => {
            out.push(' ');
            out.push_str(&line);
            out.push('\n');
        }
    }
}

fn flow(node: &Node, out: &mut String) {
    match &node.value {
        Value::Null => out.push_str("null"),
        Value::Bool(value) => out.push_str(if *value { "true" } else { "false" }),
        Value::Number(number) => out.push_str(&number.text),
        Value::String(value) => out.push_str(&text(value)),
        Value::Seq(elements) => {
            out.push('[');
            for (i, element) in elements.iter().enumerate() {
                out.push_str(if i > 0 { ", " } else { "" });
                flow(element, out);
            }
            out.push(']');
        }
        Value::Map(entries) => {
            out.push('{');
            for (i, (key, value)) in entries.iter().enumerate() {
                out.push_str(if i > 0 { ", " } else { "" });
                out.push_str(&key_text(&key.text));
                out.push_str(": ");
                flow(value, out);
            }
            out.push('}');
        }
    }
}

/// Writes a text as YAML: plain if that reads as the same text, otherwise in double quotes.
fn text(value: &str) -> String {
    if is_plain(value) && matches!(Value::from_plain(value), Value::String(_)) {
        value.to_owned()
    } else {
        quoted(value)
    }
}

/// Writes a key, which is a text whatever it looks like.
fn key_text(value: &str) -> String {
    if is_plain(value) { value.to_owned() } else { quoted(value) }
}

fn is_plain(value: &str) -> bool {
    value.starts_with(|c: char| c.is_alphanumeric() || c == '/' || c == '.')
        && !value.ends_with(' ')
        && value.chars().all(|c| c.is_alphanumeric() || "/._-+%()^\u{b0}' ".contains(c))
}

fn quoted(value: &str) -> String {
    let mut out = String::from('"');
    for c in value.chars() {
        match c {
            '"' => out.push_str("\\\""),
            '\\' => out.push_str("\\\\"),
            '\n' => out.push_str("\\n"),
            '\t' => out.push_str("\\t"),
            // Writing to a String cannot fail.
            c if c.is_control() || matches!(c, '\u{2028}' | '\u{2029}' | '\u{feff}') => {
                let _ = write!(out, "\\U{:08x}", u32::from(c));
            }
            c => out.push(c),
        }
    }
    out.push('"');
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::yaml::parse;
    use spectra_core::params::SourceFile;

    fn tree(text: &str) -> Node {
        parse(SourceFile::new("t.yaml", text)).unwrap_or_else(|faults| panic!("{faults}\n{text}"))
    }

    /// Written trees read as the same tree: texts remain texts, and numbers keep their digits.
    #[test]
    fn what_is_written_is_read_back() {
        let long = format!("a: {{list: [{}], map: {{b: {{c: {}}}}}}}", "12 mm, ".repeat(40), "x".repeat(100));
        for source in [
            "spectra: 1\nsource: {kind: chart, distance: 2 m, color: {R: \"C'\", G: e}}\nfilm: [{stock: a}, {stock: b}]\n",
            "a: \"1\"\nb: 1\nc: \"true\"\nd: true\ne: ''\nf: ~\ng: \"null\"\nh: [1, [2, {x: []}], {}]\n",
            "a: \"two\\nlines \\\\ \\\" \\t \\u2028\"\nb: '# no comment'\nc: 'a: b'\nd: '- x'\ne: ' edge '\nf: f/2.8\ng: .inf\n",
            "\"a b: c\": 1\n\"1\": 2\n'': 3\n300: 0x1F\n\u{e9}: \u{3bb} 550 nm, 1/60 s\n",
            &long,
            "[]",
        ] {
            let read = tree(source);
            let written = document(&read);
            assert_eq!(one_line(&tree(&written)), one_line(&read), "{written}");
            assert_eq!(one_line(&tree(&one_line(&read))), one_line(&read));
            let kinds = |node: &Node| format!("{:?}", strip(node));
            assert_eq!(kinds(&tree(&written)), kinds(&read), "{written}");
        }
    }

    /// Returns the values without their places.
    fn strip(node: &Node) -> Value {
        let at = |node: &Node| Node::new(strip(node), Default::default(), std::sync::Arc::new(SourceFile::new("", "")));
        match &node.value {
            Value::Seq(items) => Value::Seq(items.iter().map(at).collect()),
            Value::Map(entries) => Value::Map(
                entries
                    .iter()
                    .map(|(k, n)| (spectra_core::params::Key { text: k.text.clone(), span: Default::default() }, at(n)))
                    .collect(),
            ),
            other => other.clone(),
        }
    }
}
