//! The `variables` section: named values, and their use as `$name`.

use super::count;
use crate::yaml::MAX_NODES;
use spectra_core::names::{self, nearest};
use spectra_core::params::{Fault, Faults, Key, MAX_DEPTH, Node, SourceFile, Span, Value, Warning};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// The key `variables` of a scene.
pub(super) const VARIABLES: &str = "variables";

/// Largest size of a text after replacing `${name}`, bytes.
const MAX_TEXT: usize = 1 << 16;

/// The variables of a scene as defined; a value may refer to others.
#[derive(Clone, Debug, Default)]
pub(super) struct Variables {
    entries: Vec<(Key, Node)>,
}

/// A use of a variable. Faults in its value are reported with it.
#[derive(Clone, Debug)]
pub(super) struct Use {
    /// Path of the value that the variable became, or became part of.
    path: String,
    name: String,
    used: (Arc<SourceFile>, Span),
    defined: (Arc<SourceFile>, Span),
    /// Whether the variable is the whole value, which then has the place of the definition.
    is_whole: bool,
}

/// A text split at its variables.
enum Text<'a> {
    /// A text without variables.
    Plain,
    /// A text that is one variable, of any type.
    Whole(&'a str),
    /// Pieces of text and names of scalar variables.
    Pieces(Vec<Piece<'a>>),
}

enum Piece<'a> {
    Text(&'a str),
    Variable(&'a str),
}

/// Returns whether a name can follow `$`: letters, digits, `-` and `_`, beginning with a letter or `_`.
fn is_name(text: &str) -> bool {
    text.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_')
        && text.chars().all(|c| c.is_ascii_alphanumeric() || c == '-' || c == '_')
}

/// Splits a text at its variables. The error holds the message and a hint.
fn parts(text: &str) -> Result<Text<'_>, (String, String)> {
    if !text.contains('$') {
        return Ok(Text::Plain);
    }
    let braced = |rest: &'_ str| rest.find('}').map(|end| (end, is_name(&rest[..end])));
    if let Some(name) = text.strip_prefix('$').filter(|name| is_name(name)) {
        return Ok(Text::Whole(name));
    }
    if let Some(name) = text.strip_prefix("${").and_then(|rest| rest.strip_suffix('}')).filter(|name| is_name(name)) {
        return Ok(Text::Whole(name));
    }
    let mut pieces = Vec::new();
    let mut rest = text;
    while let Some(at) = rest.find('$') {
        pieces.push(Piece::Text(&rest[..at]));
        rest = &rest[at + 1..];
        if let Some(after) = rest.strip_prefix('$') {
            pieces.push(Piece::Text("$"));
            rest = after;
        } else if let Some(inner) = rest.strip_prefix('{') {
            match braced(inner) {
                Some((end, true)) => {
                    pieces.push(Piece::Variable(&inner[..end]));
                    rest = &inner[end + 1..];
                }
                Some((end, false)) => {
                    let hint = "a name has letters, digits, `-` and `_`, and begins with a letter".to_owned();
                    return Err((format!("`${{{}}}` names no variable", shorten(&inner[..end])), hint));
                }
                None => {
                    return Err(("`${` is never closed".to_owned(), "write `${name}`; for a dollar, `$$`".to_owned()));
                }
            }
        } else {
            let name: String =
                rest.chars().take_while(|c| c.is_ascii_alphanumeric() || matches!(c, '-' | '_')).collect();
            let hint = if is_name(&name) { format!("inside of a text write `${{{name}}}`; ") } else { String::new() };
            return Err(("this `$` does not begin a variable".to_owned(), format!("{hint}for a dollar write `$$`")));
        }
    }
    pieces.push(Piece::Text(rest));
    Ok(Text::Pieces(pieces))
}

/// Returns a user's text in a form that is safe to repeat in a message.
fn shorten(text: &str) -> String {
    text.chars().filter(|c| !c.is_control()).take(48).collect()
}

/// Adds the names of all variables that a tree refers to.
pub(super) fn references(node: &Node, into: &mut BTreeSet<String>) {
    match &node.value {
        Value::String(text) => match parts(text) {
            Ok(Text::Whole(name)) => drop(into.insert(name.to_owned())),
            Ok(Text::Pieces(pieces)) => into.extend(pieces.iter().filter_map(|piece| match piece {
                Piece::Variable(name) => Some((*name).to_owned()),
                Piece::Text(_) => None,
            })),
            Ok(Text::Plain) | Err(_) => {}
        },
        Value::Seq(items) => items.iter().for_each(|item| references(item, into)),
        Value::Map(entries) => entries.iter().for_each(|(_, item)| references(item, into)),
        Value::Null | Value::Bool(_) | Value::Number(_) => {}
    }
}

/// Returns the first text in the tree that refers to a variable.
fn reference<'a>(node: &'a Node, name: &str) -> Option<&'a Node> {
    match &node.value {
        Value::Seq(items) => items.iter().find_map(|item| reference(item, name)),
        Value::Map(entries) => entries.iter().find_map(|(_, item)| reference(item, name)),
        _ => {
            let mut used = BTreeSet::new();
            references(node, &mut used);
            used.contains(name).then_some(node)
        }
    }
}

/// Replaces variables by their maps along a path, so that `lens.focus` can be set in a scene with `lens: $prime`.
pub(super) fn open(root: &mut Node, path: &str) {
    let variables = root.get(VARIABLES).cloned();
    let Some(variables) = variables else { return };
    let Ok(steps) = spectra_core::params::steps(path) else { return };
    let mut node = root;
    for step in steps {
        for _ in 0..MAX_DEPTH {
            let Value::String(text) = &node.value else { break };
            let Ok(Text::Whole(name)) = parts(text) else { break };
            let Some(value) = variables.get(name) else { break };
            *node = value.clone();
        }
        let next = match (step, &mut node.value) {
            (spectra_core::params::Step::Key(key), Value::Map(entries)) => {
                entries.iter_mut().find(|(k, _)| k.text == key).map(|(_, node)| node)
            }
            (spectra_core::params::Step::Index(at), Value::Seq(items)) => items.get_mut(at),
            _ => None,
        };
        let Some(next) = next else { return };
        node = next;
    }
}

impl Variables {
    /// Reads the section `variables`. If there is none, there are no variables.
    ///
    /// # Errors
    /// The section is not a map, or a name cannot follow `$`.
    pub(super) fn of(section: Option<&Node>) -> Result<Self, Faults> {
        let Some(section) = section else { return Ok(Self::default()) };
        let entries = match &section.value {
            Value::Map(entries) => entries.clone(),
            Value::Null => Vec::new(),
            _ => {
                let fault = section.fault("`variables` must be a map from names to values").path(VARIABLES);
                return Err(fault.hint("such as `variables: {aperture: f/2, distance: 2 m}`").into());
            }
        };
        let mut faults = Faults::new();
        for (key, node) in &entries {
            if !is_name(&key.text) {
                let message = format!("`{}` is not a valid name of a variable", shorten(&key.text));
                let fault = Fault::new(message).at(Arc::clone(&node.file), key.span).path(VARIABLES);
                faults.push(fault.hint("a name has letters, digits, `-` and `_`, and begins with a letter"));
            }
        }
        faults.into_result(Self { entries })
    }

    fn get(&self, name: &str) -> Option<&Node> {
        self.entries.iter().find(|(key, _)| key.text == name).map(|(_, node)| node)
    }

    /// Checks that no variable refers to itself, directly or through others, even if nothing uses it. Each circle is reported
    /// once.
    ///
    /// # Errors
    /// All circles, each at the place that closes it.
    pub(super) fn check_circles(&self) -> Result<(), Faults> {
        let mut faults = Faults::new();
        let (mut open, mut done) = (Vec::new(), BTreeSet::new());
        for (key, _) in &self.entries {
            self.follow(&key.text, &mut open, &mut done, &mut faults);
        }
        faults.into_result(())
    }

    /// Follows a variable to those that its value refers to. `open` holds the chain of variables that leads to it.
    fn follow(&self, name: &str, open: &mut Vec<String>, done: &mut BTreeSet<String>, faults: &mut Faults) {
        // Deeper nesting is refused where the variable is used.
        let known = self.get(name).filter(|_| !done.contains(name) && open.len() < MAX_DEPTH);
        let Some(node) = known else { return };
        open.push(name.to_owned());
        let mut used = BTreeSet::new();
        references(node, &mut used);
        for next in &used {
            if let Some(at) = open.iter().position(|n| n == next) {
                let place = reference(node, next).unwrap_or(node);
                let fault = place.fault(format!("the variable `{next}` refers to itself"));
                let chain: Vec<&str> = open[at..].iter().map(String::as_str).chain([next.as_str()]).collect();
                faults.push(fault.path(format!("{VARIABLES}.{name}")).hint(chain.join(" -> ")));
            } else {
                self.follow(next, open, done, faults);
            }
        }
        open.pop();
        done.insert(name.to_owned());
    }

    /// Returns warnings about variables that nothing refers to.
    pub(super) fn unused(&self, references: &BTreeSet<String>) -> Vec<Warning> {
        let unused = self.entries.iter().filter(|(key, _)| !references.contains(&key.text));
        let words = unused.map(|(key, node)| {
            let fault = node.fault(format!("the variable `{}` is not used", key.text));
            match nearest(&key.text, references.iter().map(String::as_str)) {
                Some(near) => fault.hint(format!("`${near}` is")).into(),
                None => fault.into(),
            }
        });
        words.collect()
    }

    /// Returns a tree with all variables replaced by their values, and adds their uses to `uses`.
    ///
    /// # Errors
    /// All unknown names, circles and malformed texts, each at its place; more values than a scene may have.
    pub(super) fn put_into(&self, root: &Node, uses: &mut Vec<Use>) -> Result<Node, Faults> {
        let mut filler = Filler { variables: self, done: BTreeMap::new(), open: Vec::new(), budget: MAX_NODES, uses };
        let mut faults = Faults::new();
        let filled = filler.fill(root, "", 0, &mut faults);
        faults.into_result(filled)
    }

    /// Replaces the variables in a part of the scene without recording their uses.
    pub(super) fn put_into_part(&self, part: &Node) -> Result<Node, Faults> {
        self.put_into(part, &mut Vec::new())
    }
}

struct Filler<'a> {
    variables: &'a Variables,
    /// Values of variables with all variables in them replaced; `None` if that failed and was reported.
    done: BTreeMap<String, Option<Node>>,
    /// Variables whose values are being computed.
    open: Vec<String>,
    /// Number of values that may still be created.
    budget: usize,
    uses: &'a mut Vec<Use>,
}

impl Filler<'_> {
    fn fill(&mut self, node: &Node, path: &str, depth: usize, faults: &mut Faults) -> Node {
        if depth > MAX_DEPTH {
            faults.push(node.fault(format!("with its variables, it is nested more than {MAX_DEPTH} deep")).path(path));
            return nothing(node);
        }
        if !self.spend(1, node, path, faults) {
            return nothing(node);
        }
        match &node.value {
            Value::String(text) => self.text(node, text, path, depth, faults),
            Value::Seq(items) => {
                let fill = |(at, item)| self.fill(item, &format!("{path}[{at}]"), depth + 1, faults);
                Node { value: Value::Seq(items.iter().enumerate().map(fill).collect()), ..node.clone_place() }
            }
            Value::Map(entries) => {
                let mut filled = Vec::with_capacity(entries.len());
                for (key, item) in entries {
                    let path = if path.is_empty() { key.text.clone() } else { format!("{path}.{}", key.text) };
                    let value = self.fill(item, &path, depth + 1, faults);
                    // A key is placed in the file of its value.
                    let moved = !Arc::ptr_eq(&value.file, &item.file);
                    let span = if moved { value.span } else { key.span };
                    filled.push((Key { text: key.text.clone(), span }, value));
                }
                Node { value: Value::Map(filled), ..node.clone_place() }
            }
            Value::Null | Value::Bool(_) | Value::Number(_) => node.clone(),
        }
    }

    fn text(&mut self, node: &Node, text: &str, path: &str, depth: usize, faults: &mut Faults) -> Node {
        match parts(text) {
            Ok(Text::Plain) => node.clone(),
            Ok(Text::Whole(name)) => {
                let Some(value) = self.value(name, node, path, depth, faults) else { return nothing(node) };
                if !self.spend(count(&value), node, path, faults) {
                    return nothing(node);
                }
                value
            }
            Ok(Text::Pieces(pieces)) => {
                let mut out = String::new();
                for piece in pieces {
                    match piece {
                        Piece::Text(text) => out.push_str(text),
                        Piece::Variable(name) => {
                            let Some(value) = self.value(name, node, path, depth, faults) else { continue };
                            match &value.value {
                                Value::String(text) => out.push_str(text),
                                Value::Number(number) => out.push_str(&number.text),
                                Value::Bool(value) => out.push_str(&value.to_string()),
                                Value::Null | Value::Seq(_) | Value::Map(_) => {
                                    let what = if matches!(value.value, Value::Null) {
                                        "nothing"
                                    } else {
                                        "not a single value"
                                    };
                                    let fault =
                                        node.fault(format!("`{name}` is {what}, and cannot stand inside of a text"));
                                    faults.push(fault.path(path).hint(format!("a whole value is written `${name}`")));
                                }
                            }
                        }
                    }
                    if out.len() > MAX_TEXT {
                        let fault = format!("with its variables filled in, this text is longer than {MAX_TEXT} bytes");
                        faults.push(node.fault(fault).path(path));
                        return nothing(node);
                    }
                }
                let value = if node.is_quoted() { Value::String(out) } else { Value::from_plain(&out) };
                Node { value, ..node.clone_place() }
            }
            Err((message, hint)) => {
                faults.push(node.fault(message).path(path).hint(hint));
                nothing(node)
            }
        }
    }

    /// Returns the value of a variable with all variables in it replaced; `None` if a fault was reported.
    fn value(&mut self, name: &str, node: &Node, path: &str, depth: usize, faults: &mut Faults) -> Option<Node> {
        let Some(defined) = self.variables.get(name) else {
            let known: Vec<&str> = self.variables.entries.iter().map(|(key, _)| key.text.as_str()).collect();
            let hint = match nearest(name, known.iter().copied()) {
                Some(near) => format!("did you mean `${near}`?"),
                None if known.is_empty() => "the scene defines none".to_owned(),
                None => names::hint(name, &known, ""),
            };
            faults.push(node.fault(format!("no variable is called `{}`", shorten(name))).path(path).hint(hint));
            return None;
        };
        if !path.is_empty() {
            self.uses.push(Use {
                path: path.to_owned(),
                name: name.to_owned(),
                used: node.place(),
                defined: defined.place(),
                is_whole: matches!(&node.value, Value::String(text) if matches!(parts(text), Ok(Text::Whole(_)))),
            });
        }
        if let Some(done) = self.done.get(name) {
            return done.clone();
        }
        if self.open.iter().any(|n| n == name) {
            let chain: Vec<&str> =
                self.open.iter().skip_while(|n| *n != name).map(String::as_str).chain([name]).collect();
            let fault = node.fault(format!("the variable `{name}` refers to itself")).path(path);
            faults.push(fault.hint(chain.join(" -> ")));
            return None;
        }
        let before = faults.len();
        self.open.push(name.to_owned());
        let defined = defined.clone();
        let filled = self.fill(&defined, "", depth + 1, faults);
        self.open.pop();
        let value = (faults.len() == before).then_some(filled);
        self.done.insert(name.to_owned(), value.clone());
        value
    }

    /// Counts values against the limit of a scene. Returns whether they fit.
    fn spend(&mut self, values: usize, node: &Node, path: &str, faults: &mut Faults) -> bool {
        let enough = values <= self.budget;
        if enough {
            self.budget -= values;
        } else if self.budget > 0 {
            self.budget = 0;
            faults
                .push(node.fault(format!("with its variables, the scene has more than {MAX_NODES} values")).path(path));
        }
        enough
    }
}

/// Copies the place of a node without its value.
trait ClonePlace {
    fn clone_place(&self) -> Node;
}

impl ClonePlace for Node {
    fn clone_place(&self) -> Node {
        Node { value: Value::Null, span: self.span, file: Arc::clone(&self.file) }
    }
}

fn nothing(node: &Node) -> Node {
    node.clone_place()
}

/// Adds to each fault in a value that came through a variable the place of its use or definition.
pub(super) fn with_variable_places(faults: Faults, uses: &[Use]) -> Faults {
    faults.into_iter().map(|fault| with_use(fault, uses)).collect::<Vec<_>>().into()
}

fn with_use(fault: Fault, uses: &[Use]) -> Fault {
    let Some((file, span)) = &fault.place else { return fault };
    let holds =
        |(in_file, at): &(Arc<SourceFile>, Span)| in_file == file && at.line == span.line && at.offset <= span.offset;
    let below =
        |path: &str| fault.path.strip_prefix(path).is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']));
    let found = uses.iter().filter(|u| below(&u.path));
    let found = found.filter(|u| if u.is_whole { u.defined.0 == *file } else { holds(&u.used) });
    let Some(found) = found.max_by_key(|u| u.path.len()) else { return fault };
    let place = |place: &(Arc<SourceFile>, Span)| {
        Fault::new("").at(Arc::clone(&place.0), place.1).place_text().unwrap_or_default()
    };
    let note = if found.is_whole {
        format!("the value of `${}`, used at {}", found.name, place(&found.used))
    } else {
        format!("with `${{{}}}` from {}", found.name, place(&found.defined))
    };
    let hint = fault.hint.as_ref().map_or_else(|| note.clone(), |hint| format!("{hint}; {note}"));
    fault.hint(hint)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::language::yaml_writer::one_line;
    use crate::yaml::parse;
    use spectra_core::params::{Length, StageNode};
    use std::fmt::Write as _;

    fn tree(text: &str) -> Node {
        parse(SourceFile::new("t.yaml", text)).unwrap_or_else(|faults| panic!("{faults}\n{text}"))
    }

    fn filled(text: &str) -> Result<String, String> {
        let root = tree(text);
        let variables = Variables::of(root.get(VARIABLES)).map_err(|f| f.to_string())?;
        let body = root.get("x").expect("a body");
        variables.put_into(body, &mut Vec::new()).map(|node| one_line(&node)).map_err(|f| f.to_string())
    }

    #[test]
    fn circles_are_faults_even_where_nothing_uses_them() {
        let circles = |text: &str| {
            let root = tree(&format!("variables: {text}\n"));
            let variables = Variables::of(root.get(VARIABLES)).expect("variables");
            variables.check_circles().map_err(|faults| faults.to_string())
        };
        for good in ["{}", "{a: 1, b: $a, c: {x: [$a, $b]}}", "{a: $missing}"] {
            assert_eq!(circles(good), Ok(()), "{good}");
        }
        for (bad, place, chain) in [
            ("{a: $a}", "t.yaml:1:16", "a -> a"),
            ("{a: $b, b: $a}", "t.yaml:1:23", "a -> b -> a"),
            ("{c: $a, a: [1, {x: 'f/${b}'}], b: $a}", "t.yaml:1:46", "a -> b -> a"),
        ] {
            let told = circles(bad).expect_err(bad);
            assert!(told.contains(place) && told.contains(chain), "{bad}: {told}");
            assert_eq!(told.matches("refers to itself").count(), 1, "{told}");
        }
    }

    #[test]
    fn values_keep_their_type_and_texts_are_put_together() {
        for (variables, body, wanted) in [
            ("{a: 2}", "$a", "2"),
            ("{a: '2'}", "$a", "\"2\""),
            ("{a: f/2}", "{n: $a, m: \"$a\"}", "{n: f/2, m: f/2}"),
            ("{a: [1, {b: $c}], c: 2 m}", "$a", "[1, {b: 2 m}]"),
            ("{a: {kind: x, y: $c}, c: $d, d: true}", "{z: $a}", "{z: {kind: x, y: true}}"),
            ("{n: 60}", "['1/${n} s', \"${n}\", '${n}${n}']", "[1/60 s, 60, \"6060\"]"),
            ("{n: 60, u: s}", "1/${n} ${u}", "1/60 s"),
            ("{n: 60}", "${n}${n}", "6060"),
            ("{n: 60}", "['$$n', 'a$$', '$$${n}']", "[\"$n\", \"a$\", \"$60\"]"),
            ("{my-lens_2: a}", "$my-lens_2", "a"),
        ] {
            let text = format!("variables: {variables}\nx: {body}\n");
            assert_eq!(filled(&text).as_deref(), Ok(wanted), "{text}");
        }
    }

    #[test]
    fn what_is_wrong_is_told_at_its_place() {
        for (variables, body, said) in [
            ("{aperture: 2}", "$apertur", "t.yaml:2:4: no variable is called `apertur` (did you mean `$aperture`?)"),
            ("{}", "$a", "no variable is called `a` (the scene defines none)"),
            ("{a: 1}", "[1, $zzz]", "t.yaml:2:8: no variable is called `zzz` (known: a)"),
            ("{a: $b, b: $c, c: $b}", "$a", "t.yaml:1:30: the variable `b` refers to itself (b -> c -> b)"),
            ("{a: 'x${a}'}", "$a", "the variable `a` refers to itself (a -> a)"),
            (
                "{a: [1]}",
                "'1${a}'",
                "`a` is not a single value, and cannot stand inside of a text (a whole value is written `$a`)",
            ),
            (
                "{a: 1}",
                "$a mm",
                "this `$` does not begin a variable (inside of a text write `${a}`; for a dollar write `$$`)",
            ),
            ("{a: 1}", "5 $", "this `$` does not begin a variable (for a dollar write `$$`)"),
            ("{a: 1}", "'${a'", "`${` is never closed"),
            ("{a: 1}", "'${a b}'", "`${a b}` names no variable"),
            ("{2a: 1}", "1", "t.yaml:1:13: `2a` is not a valid name of a variable"),
            ("[1]", "1", "`variables` must be a map from names to values"),
        ] {
            let text = format!("variables: {variables}\nx: {body}\n");
            let error = filled(&text).expect_err(said);
            assert!(error.contains(said), "{error}");
        }
        // Each fault is reported once, and all are reported.
        let error = filled("variables: {a: $q}\nx: [$a, $a, $r]\n").expect_err("three names");
        assert_eq!(error.lines().count(), 2, "{error}");
    }

    #[test]
    fn growth_is_bounded() {
        let doubled = |value: &dyn Fn(usize) -> String| {
            let mut text = String::from("variables:\n  v0: 1\n");
            for i in 1..25 {
                let _ = writeln!(text, "  v{i}: {}", value(i - 1));
            }
            text + "x: $v24\n"
        };
        let lists = filled(&doubled(&|i| format!("[$v{i}, $v{i}]"))).expect_err("too many");
        assert!(lists.contains("more than 200000 values"), "{lists}");
        let texts = filled(&doubled(&|i| format!("'${{v{i}}}${{v{i}}}'"))).expect_err("too long");
        assert!(texts.contains("longer than 65536 bytes"), "{texts}");
        let mut deep = String::from("variables:\n  v0: 1\n");
        for i in 1..100 {
            let _ = writeln!(deep, "  v{i}: [$v{}]", i - 1);
        }
        let deep = filled(&(deep + "x: $v99\n")).expect_err("too deep");
        assert!(deep.contains("nested more than 64 deep"), "{deep}");
    }

    #[test]
    fn a_fault_names_both_ends() {
        let root = tree("variables: {far: 2 s, n: 3 kg}\nx:\n  focus: $far\n  near: 1/${n}\n");
        let variables = Variables::of(root.get(VARIABLES)).expect("good");
        let mut uses = Vec::new();
        let body = variables.put_into(root.get("x").expect("a body"), &mut uses).expect("known");
        let mut faults = Faults::new();
        for key in ["focus", "near"] {
            faults.take(StageNode::new(body.get(key).expect(key).clone(), key).parse::<Length>());
        }
        let text = with_variable_places(faults, &uses).to_string();
        let [focus, near]: [&str; 2] = text.lines().collect::<Vec<_>>().try_into().expect("two faults");
        assert!(
            focus.starts_with("t.yaml:1:18: found a time")
                && focus.ends_with("the value of `$far`, used at t.yaml:3:10)"),
            "{focus}"
        );
        assert!(near.starts_with("t.yaml:4:9: ") && near.ends_with("with `${n}` from t.yaml:1:26)"), "{near}");
    }

    #[test]
    fn unused_variables_are_told() {
        let root = tree("variables: {a: 1, b: $c, c: 2, apertur: 3}\nx: [$b, '${aperture}']\n");
        let variables = Variables::of(root.get(VARIABLES)).expect("good");
        let mut known = BTreeSet::new();
        references(&root, &mut known);
        let told: Vec<String> = variables.unused(&known).iter().map(ToString::to_string).collect();
        assert_eq!(
            told,
            [
                "t.yaml:1:16: the variable `a` is not used".to_owned(),
                "t.yaml:1:41: the variable `apertur` is not used (`$aperture` is)".to_owned(),
            ]
        );
    }
}
