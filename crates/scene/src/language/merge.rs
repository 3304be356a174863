//! Merging of an included file with the file that includes it.

use spectra_core::params::{Key, Node, Value};
use spectra_core::registry;

/// The key that names the kind of a stage.
const KIND: &str = "kind";

/// Merges `over` on top of `base`; both are the maps of whole files.
///
/// Maps merge key by key at any depth. Anything else (a list, a text, a number) replaces the value below it. A key with an empty
/// value (`film:`, `film: null`) removes the key. A stage of another `kind` replaces the whole map, because keys of one kind mean
/// nothing to another. A map that names no kind extends the one below it. A variable, a swept list and the keyframes of a
/// parameter are replaced as a whole.
#[must_use]
pub(super) fn merge(base: Node, over: Node) -> Node {
    merge_at(base, over, &mut Vec::new())
}

fn merge_at(base: Node, over: Node, path: &mut Vec<String>) -> Node {
    let base = as_map(base, &over, path);
    match (base.value, over.value) {
        (Value::Map(mut entries), Value::Map(own)) if !is_whole(path) && is_same_kind(&entries, &own, path) => {
            for (key, node) in own {
                let at = entries.iter().position(|(k, _)| k.text == key.text);
                match at {
                    Some(at) if matches!(node.value, Value::Null) => drop(entries.remove(at)),
                    Some(at) => {
                        let placeholder = Node { value: Value::Null, ..node.clone() };
                        let below = std::mem::replace(&mut entries[at].1, placeholder);
                        path.push(key.text.clone());
                        entries[at] = (key, merge_at(below, node, path));
                        path.pop();
                    }
                    None => entries.push((key, node)),
                }
            }
            Node::new(Value::Map(entries), over.span, over.file)
        }
        (_, value) => Node::new(value, over.span, over.file),
    }
}

/// Turns a stage given only by its kind (`imager: film`) into a map, if a map goes on top of it.
fn as_map(base: Node, over: &Node, path: &[String]) -> Node {
    match (&base.value, &over.value) {
        (Value::String(_), Value::Map(_)) if default_kind(path).is_some() => {
            let key = Key { text: KIND.to_owned(), span: base.span };
            let (span, file) = (base.span, base.file.clone());
            Node::new(Value::Map(vec![(key, base)]), span, file)
        }
        _ => base,
    }
}

/// Returns whether the value at this place counts as a whole, even if it is written as a map.
fn is_whole(path: &[String]) -> bool {
    let path: Vec<&str> = path.iter().map(String::as_str).collect();
    matches!(path[..], ["variables" | "sweep", _] | ["animation", "animate", _])
}

fn is_same_kind(base: &[(Key, Node)], over: &[(Key, Node)], path: &[String]) -> bool {
    let kind = |entries: &[(Key, Node)]| {
        let named = entries.iter().find(|(key, _)| key.text == KIND);
        named.and_then(|(_, node)| node.as_str()).map(str::to_owned)
    };
    match (kind(base), kind(over)) {
        (_, None) => true,
        (Some(base), Some(over)) => base == over,
        (None, Some(over)) => default_kind(path).flatten() == Some(over.as_str()),
    }
}

/// Returns the default kind of the stage at this place; `None` if no stage is expected there.
#[expect(clippy::option_option, reason = "no stage, a stage without a default, a stage with one")]
fn default_kind(path: &[String]) -> Option<Option<&'static str>> {
    let stage = path.last()?;
    let all = registry::list();
    let mut of_stage = all.iter().filter(|listed| listed.stage == stage.as_str()).peekable();
    of_stage.peek()?;
    Some(of_stage.find(|listed| listed.default).map(|listed| listed.name))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::language::yaml_writer;
    use crate::yaml::parse;
    use spectra_core::params::SourceFile;

    fn merged(base: &str, over: &str) -> String {
        let tree = |name: &str, text: &str| parse(SourceFile::new(name, text)).expect(text);
        yaml_writer::one_line(&merge(tree("base.yaml", base), tree("over.yaml", over)))
    }

    #[test]
    fn maps_merge_deeply_and_lists_are_replaced() {
        for (base, over, wanted) in [
            ("{a: 1, b: {c: 2, d: 3}}", "{b: {d: 4, e: 5}, f: 6}", "{a: 1, b: {c: 2, d: 4, e: 5}, f: 6}"),
            ("{a: [1, 2], b: {c: 2}}", "{a: [3], b: 7}", "{a: [3], b: 7}"),
            ("{a: 1}", "{a: {b: 2}}", "{a: {b: 2}}"),
            ("{a: 1, b: {c: 2, d: 3}}", "{a: , b: {c: }}", "{b: {d: 3}}"),
            ("{a: 1}", "{b: }", "{a: 1, b: null}"),
        ] {
            assert_eq!(merged(base, over), wanted, "{base} {over}");
        }
    }

    #[test]
    fn another_kind_brings_no_keys_of_the_old_one() {
        for (base, over, wanted) in [
            ("{x: {kind: a, p: 1}}", "{x: {kind: b, q: 2}}", "{x: {kind: b, q: 2}}"),
            ("{x: {kind: a, p: 1}}", "{x: {kind: a, q: 2}}", "{x: {kind: a, p: 1, q: 2}}"),
            ("{x: {kind: a, p: 1}}", "{x: {q: 2}}", "{x: {kind: a, p: 1, q: 2}}"),
            // An unknown stage without a kind counts as being of another kind.
            ("{x: {p: 1}}", "{x: {kind: a, q: 2}}", "{x: {kind: a, q: 2}}"),
            ("{x: {kind: a, p: 1}}", "{x: b}", "{x: b}"),
        ] {
            assert_eq!(merged(base, over), wanted, "{base} {over}");
        }
    }

    #[test]
    fn variables_sweeps_and_keyframes_are_values() {
        for (base, over, wanted) in [
            ("{variables: {a: {p: 1}, b: 2}}", "{variables: {a: {q: 3}}}", "{variables: {a: {q: 3}, b: 2}}"),
            ("{sweep: {a: {from: 1}}}", "{sweep: {a: {to: 1}, b: [2]}}", "{sweep: {a: {to: 1}, b: [2]}}"),
            (
                "{animation: {animate: {a: {1: 2}}, frames: 3}}",
                "{animation: {animate: {a: {2: 2}}}}",
                "{animation: {animate: {a: {2: 2}}, frames: 3}}",
            ),
        ] {
            assert_eq!(merged(base, over), wanted, "{base} {over}");
        }
    }

    #[test]
    fn places_are_those_of_the_file_that_says_it() {
        let tree = |name: &str, text: &str| parse(SourceFile::new(name, text)).expect(text);
        let root = merge(tree("base.yaml", "a: {b: 1, c: 2}"), tree("over.yaml", "\na: {c: 3}"));
        let place = |path: &str| root.at_path(path).expect(path).fault("x").place_text().expect("a place");
        assert_eq!([place("a.b"), place("a.c")], ["base.yaml:1:8", "over.yaml:2:8"]);
    }
}
