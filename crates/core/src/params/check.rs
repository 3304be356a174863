//! Check of a tree against the schema of a type: all faults in one pass, each at its token.
//!
//! The check knows the part of JSON Schema that `schemars` writes for parameters: types, words, limits, keys, lists,
//! alternatives. A number may stand where a text is wanted (`format: 135`), and `x-quantity` makes a text with a unit a number,
//! so that limits hold for both.

use super::at::At;
use super::fault::{Fault, Faults};
use super::node::{Key, Node, Value};
use super::path::Step;
use super::schema::PART;
use super::text::found;
use super::whole::{Exact, limits_of};
use crate::names::{self, nearest, shown};
use crate::quantity::{Limits, QuantityFormat, Reading};
use serde_json::Value as Schema;
use std::sync::Arc;

/// Largest number of faults that one map reports.
const MOST_FAULTS: usize = 100;

/// Returns the hint for a key without a value, in a file or on the command line.
fn no_value(node: &Node) -> String {
    let before = node.file.text.get(..node.span.offset).unwrap_or("");
    if node.file.is_argument() && before.trim_end().ends_with('=') {
        "write the value after the `=`; `null` takes the key away".to_owned()
    } else {
        "write the value after the `:`, or leave the key out".to_owned()
    }
}

/// Returns everything in which a tree violates a schema, in the order of the file.
pub(super) fn check(at: &At<'_, '_>, schema: &Schema) -> Result<(), Faults> {
    let mut check = Check { root: schema, faults: Vec::new() };
    check.value(at, schema);
    let mut faults = check.faults;
    faults.sort_by_key(|fault| fault.place.as_ref().map_or(0, |(_, span)| span.offset));
    if faults.len() > MOST_FAULTS {
        faults.truncate(MOST_FAULTS);
        faults.push(at.node.fault(format!("more than {MOST_FAULTS} faults; the others are not shown")));
    }
    Faults(faults).into_result(())
}

struct Check<'s> {
    /// Schema in which references are looked up.
    root: &'s Schema,
    faults: Vec<Fault>,
}

/// Returns the list that a schema has under a keyword.
fn list<'s>(schema: &'s Schema, keyword: &str) -> &'s [Schema] {
    schema.get(keyword).and_then(Schema::as_array).map_or(&[], Vec::as_slice)
}

fn texts<'s>(schema: &'s Schema, keyword: &str) -> Vec<&'s str> {
    list(schema, keyword).iter().filter_map(Schema::as_str).collect()
}

fn count(schema: &Schema, keyword: &str) -> Option<usize> {
    schema.get(keyword)?.as_u64().and_then(|count| usize::try_from(count).ok())
}

fn has_type(schema: &Schema, name: &str) -> bool {
    schema.get("type").is_some_and(|t| t == name || t.as_array().is_some_and(|all| all.iter().any(|t| t == name)))
}

/// Returns the alternatives for a value, if there are several.
fn ways(schema: &Schema) -> impl Iterator<Item = &Schema> {
    list(schema, "anyOf").iter().chain(list(schema, "oneOf"))
}

/// Returns the words of a closed list; `None` if other values are allowed too.
fn words(schema: &Schema) -> Option<Vec<&str>> {
    if let Some(word) = schema.get("const").and_then(Schema::as_str) {
        return Some(vec![word]);
    }
    if schema.get("enum").is_some() {
        return Some(texts(schema, "enum"));
    }
    let all: Option<Vec<_>> = ways(schema).filter(|way| !has_only_null(way)).map(words).collect();
    all.map(|all| all.concat()).filter(|all| !all.is_empty())
}

fn has_only_null(schema: &Schema) -> bool {
    schema.get("type").is_some_and(|t| t == "null")
}

/// Returns the names that a schema has for the type of a value.
fn kinds(value: &Value) -> &'static [&'static str] {
    match value {
        Value::Null => &["null"],
        Value::Bool(_) => &["boolean"],
        Value::Number(_) => &["number", "integer"],
        Value::String(_) => &["string"],
        Value::Seq(_) => &["array"],
        Value::Map(_) => &["object"],
    }
}

impl<'s> Check<'s> {
    fn resolved(&self, schema: &'s Schema) -> &'s Schema {
        let name = schema.get("$ref").and_then(Schema::as_str).and_then(|path| path.strip_prefix('#'));
        name.and_then(|path| self.root.pointer(path)).unwrap_or(schema)
    }

    fn say(&mut self, at: &At<'_, '_>, fault: Fault) {
        if self.faults.len() <= MOST_FAULTS {
            self.faults.push(at.fault(fault));
        }
    }

    fn value(&mut self, at: &At<'_, '_>, schema: &'s Schema) {
        let said = schema;
        let schema = self.resolved(schema);
        let nothing = matches!(at.node.value, Value::Null);
        if said.get(PART).is_some() || schema.as_object().is_none_or(serde_json::Map::is_empty) {
            return;
        }
        if nothing && self.allows_nothing(schema) {
            return;
        }
        if let Some(words) = words(schema) {
            self.word(at, &words);
        } else if ways(schema).next().is_some() {
            let ways = ways(schema).filter(|way| !has_only_null(way)).collect();
            self.one_of(at, ways);
        } else if let Some(form) = QuantityFormat::of(schema) {
            self.quantity(at, &form);
        } else if has_type(schema, "object") {
            self.map(at, schema);
        } else if has_type(schema, "array") {
            self.list(at, schema);
        } else if has_type(schema, "integer") {
            self.whole(at, schema);
        } else if has_type(schema, "number") {
            self.number(at, Limits::of(schema));
        } else if has_type(schema, "boolean") {
            self.boolean(at);
        } else if has_type(schema, "string") {
            self.text(at);
        }
    }

    fn allows_nothing(&self, schema: &'s Schema) -> bool {
        has_type(schema, "null")
            || list(schema, "enum").iter().any(Schema::is_null)
            || ways(schema).any(|way| self.allows_nothing(self.resolved(way)))
    }

    /// Reports `found ..., expected ...`, with a hint that usually helps.
    fn mismatch(&mut self, at: &At<'_, '_>, expected: &str, hint: Option<String>) {
        let text = match &at.node.value {
            Value::String(text) => Some(text),
            _ => None,
        };
        let plain = text.map(|text| Value::from_plain(text));
        let unquoted = at.node.is_quoted() && matches!(plain, Some(Value::Number(_) | Value::Bool(_)));
        // `10 000`, `10_000` and `10'000` are numbers to a person.
        let joined = text.filter(|text| text.starts_with(|c: char| c.is_ascii_digit()) && expected.contains("number"));
        let between = |c: char| matches!(c, ' ' | '_' | '\'' | '\u{a0}');
        let by_thousands = |text: &&String| {
            text.split(between).skip(1).all(|group| group.split('.').next().unwrap_or_default().len() == 3)
        };
        let joined: Option<String> =
            joined.filter(by_thousands).map(|text| text.chars().filter(|c| !between(*c)).collect());
        let hint = match (joined, expected.split_once(" such as ")) {
            _ if hint.is_some() => hint,
            _ if unquoted => Some("remove the quotes".to_owned()),
            (Some(joined), _) if matches!(Value::from_plain(&joined), Value::Number(_)) => {
                Some(format!("write `{}`", shown(&joined)))
            }
            _ if matches!(at.node.value, Value::Null) => Some(no_value(at.node)),
            (_, Some((_, example))) => Some(format!("write it as in `{example}`")),
            _ => None,
        };
        self.say(at, Fault { hint, ..Fault::new(format!("found {}, expected {expected}", found(at.node))) });
    }

    fn word(&mut self, at: &At<'_, '_>, words: &[&str]) {
        match at.node.as_str() {
            Some(text) if words.contains(&text) => {}
            Some(text) => {
                let hint = names::hint(text, words, "");
                let of = at.key().map_or_else(String::new, |key| format!(" for `{}`", shown(key)));
                self.say(at, Fault::new(format!("unknown value `{}`{of}", shown(text))).hint(hint));
            }
            None => self.mismatch(at, &format!("one of {}", names::listed(words, "")), None),
        }
    }

    /// Checks a value that has several alternatives: the only one of the node's type, or the one with the fewest faults.
    fn one_of(&mut self, at: &At<'_, '_>, ways: Vec<&'s Schema>) {
        let of_kind = |names| ways.iter().copied().filter(|way| self.fits(at.node, way, names)).collect::<Vec<_>>();
        let mut fitting = of_kind(kinds(&at.node.value));
        if fitting.is_empty() && matches!(at.node.value, Value::Number(_)) {
            // A number may stand for its spelling.
            fitting = of_kind(&["string"]);
        }
        // If each alternative is a map with one required key, that key is a choice.
        let one_key = |way: &&'s Schema| match texts(self.resolved(way), "required")[..] {
            [key] => Some(key),
            _ => None,
        };
        if let (Value::Map(entries), Some(known)) =
            (&at.node.value, fitting.iter().map(one_key).collect::<Option<Vec<_>>>())
            && let [(key, node)] = &entries[..]
            && fitting.len() > 1
            && !known.contains(&key.text.as_str())
        {
            self.unknown(&at.child(Step::Key(&key.text), node), key, at.node, &known);
            return;
        }
        // If a number is wrong in each way, the message is about the quantity, not the word.
        fitting.sort_by_key(|way| words(self.resolved(way)).is_some());
        let mut best: Option<Vec<Fault>> = None;
        for way in &fitting {
            let mut inner = Check { root: self.root, faults: Vec::new() };
            inner.value(at, way);
            // A word that is nearly right is the one that was meant.
            let near = |words: Vec<&str>| at.node.as_str().is_some_and(|text| nearest(text, words).is_some());
            let is_meant = words(self.resolved(way)).is_some_and(near);
            if is_meant || best.as_ref().is_none_or(|best| inner.faults.len() < best.len()) {
                best = Some(inner.faults);
            }
            if is_meant {
                break;
            }
        }
        let is_text = matches!(&at.node.value, Value::String(text) if matches!(Reading::of(text), Reading::Text));
        let is_clear = |faults: &[Fault]| {
            fitting.len() == 1 || !is_text || faults[0].hint.as_ref().is_some_and(|h| h.starts_with("did"))
        };
        match best {
            Some(faults) if faults.is_empty() || is_clear(&faults) => self.faults.extend(faults),
            // What is neither a word nor a number could have been meant as either.
            _ => {
                let forms = ways.iter().map(|way| self.form(way));
                let text = at.node.as_str().unwrap_or_default();
                let lists = ways.iter().filter_map(|way| count(self.resolved(way), "maxItems"));
                let as_list = lists.map(|len| list_hint(text, len)).find(|hint| hint.starts_with("write `"));
                let (forms, examples): (Vec<String>, Vec<String>) = forms
                    .map(|form| match form.split_once(" such as ") {
                        Some((_, example)) => (form.clone(), format!("`{example}`")),
                        None => (form.clone(), form),
                    })
                    .unzip();
                let hint = as_list.unwrap_or_else(|| match &at.node.value {
                    Value::Null => no_value(at.node),
                    _ => format!("write it as in {}", examples.join(" or ")),
                });
                self.mismatch(at, &forms.join(" or "), Some(hint));
            }
        }
    }

    /// Returns whether a node may be meant for a schema that allows values of these types.
    fn fits(&self, node: &Node, schema: &'s Schema, types: &[&str]) -> bool {
        let schema = self.resolved(schema);
        let scalar = matches!(node.value, Value::Number(_) | Value::String(_));
        schema.get(PART).is_some()
            || (scalar && words(schema).is_some())
            || types.iter().any(|name| has_type(schema, name))
            || ways(schema).any(|way| self.fits(node, way, types))
    }

    /// Describes a schema in words.
    fn form(&self, schema: &'s Schema) -> String {
        let schema = self.resolved(schema);
        if let Some(words) = words(schema) {
            return words.iter().map(|word| format!("`{word}`")).collect::<Vec<_>>().join(" or ");
        }
        if let Some(form) = QuantityFormat::of(schema) {
            return form.expected();
        }
        let forms = [
            ("object", "a map such as {key: value}"),
            ("array", "a list such as [1, 2]"),
            ("integer", "a whole number such as 16"),
            ("number", "a number such as 1.5"),
            ("boolean", "true or false"),
        ];
        forms.iter().find(|(name, _)| has_type(schema, name)).map_or("a text", |(_, form)| form).to_owned()
    }

    fn quantity(&mut self, at: &At<'_, '_>, form: &QuantityFormat<'_>) {
        let result = match &at.node.value {
            Value::Number(number) if number.value.is_finite() => form.allowed(number.value, &number.text),
            Value::Number(super::Number { text, .. }) | Value::String(text) => form.read(text).map(|_| ()),
            value => {
                let hint = match value {
                    Value::Null => no_value(at.node),
                    Value::Seq(_) => "one value, without brackets".to_owned(),
                    _ => format!("write it as in `{}`", form.example()),
                };
                Err(Fault::new(format!("found {}, expected {}", found(at.node), form.expected())).hint(hint))
            }
        };
        if let Err(fault) = result {
            self.say(at, fault);
        }
    }

    fn number(&mut self, at: &At<'_, '_>, limits: Limits) {
        let Value::Number(number) = &at.node.value else { return self.mismatch(at, "a number such as 1.5", None) };
        let text = shown(&number.text);
        let is_written_out = !number.text.to_ascii_lowercase().contains("inf");
        let as_in = "write it as in `1.5`";
        if number.value.is_infinite() && is_written_out {
            self.say(at, Fault::new(format!("found {text}, which is too large; expected a number")).hint(as_in));
        } else if !number.value.is_finite() {
            self.say(at, Fault::new(format!("found {text}, expected a number such as 1.5")).hint(as_in));
        } else if !limits.allow(number.value) {
            let fault = Fault::new(format!("found {text}, which is out of range"));
            self.say(at, fault.hint(format!("a number {}", limits.words(""))));
        }
    }

    fn whole(&mut self, at: &At<'_, '_>, schema: &Schema) {
        let Value::Number(number) = &at.node.value else { return self.mismatch(at, "a whole number such as 16", None) };
        let (least, most) = limits_of(schema);
        let text = shown(&number.text);
        match Exact::of(&number.text) {
            Exact::Is(value) if (least..=most).contains(&value) => {}
            // A version number: only one value is allowed.
            _ if least == most => {
                let key = at.key().unwrap_or("it");
                let fault = Fault::new(format!("unknown value {text} for `{key}`"));
                self.say(at, fault.hint(format!("this program reads `{key}: {least}`")));
            }
            Exact::Not => self.mismatch(at, "a whole number such as 16", Some(format!("from {least} to {most}"))),
            Exact::Is(_) | Exact::Beyond => {
                let fault = Fault::new(format!("found {text}, which is out of range"));
                self.say(at, fault.hint(format!("a whole number from {least} to {most}")));
            }
        }
    }

    fn boolean(&mut self, at: &At<'_, '_>) {
        let hint = match &at.node.value {
            Value::Bool(_) => return,
            Value::String(text) => match text.to_ascii_lowercase().as_str() {
                "yes" | "on" | "y" | "true" => Some("write `true`, without quotes"),
                "no" | "off" | "n" | "false" => Some("write `false`, without quotes"),
                _ => None,
            },
            _ => None,
        };
        self.mismatch(at, "true or false", hint.map(str::to_owned));
    }

    fn text(&mut self, at: &At<'_, '_>) {
        match &at.node.value {
            Value::String(_) | Value::Number(_) => {}
            Value::Bool(value) => self.mismatch(at, "a text", Some(format!("write \"{value}\" with quotes"))),
            _ => self.mismatch(at, "a text", None),
        }
    }

    fn list(&mut self, at: &At<'_, '_>, schema: &'s Schema) {
        let (least, most) = (count(schema, "minItems"), count(schema, "maxItems"));
        let exact = least.filter(|least| Some(*least) == most);
        let Value::Seq(elements) = &at.node.value else {
            let hint = match (&at.node.value, exact) {
                (Value::Null, _) => None,
                (Value::String(text), Some(len)) => Some(list_hint(text, len)),
                (_, Some(len)) => Some(list_hint("", len)),
                (Value::Map(_), _) => Some("put it in brackets, or start each entry with `- `".to_owned()),
                _ => at.node.as_str().map(|text| format!("put it in brackets: `[{}]`", shown(text))),
            };
            let expected = match (exact, &hint) {
                (Some(len), _) => format!("a list of {len}"),
                (None, Some(_)) => "a list".to_owned(),
                (None, None) => "a list such as [1, 2]".to_owned(),
            };
            return self.mismatch(at, &expected, hint);
        };
        let found = elements.len();
        match exact {
            Some(len) if len != found => {
                let fault = Fault::new(format!("found a list of {found}, expected a list of {len}"));
                return self.say(at, fault.hint(list_hint("", len)));
            }
            None if least.is_some_and(|least| found < least) || most.is_some_and(|most| found > most) => {
                let hint = match (least, most) {
                    (Some(least), Some(most)) => format!("{least} to {most} of them"),
                    (Some(least), None) => format!("at least {least} of them"),
                    (None, most) => format!("at most {} of them", most.unwrap_or_default()),
                };
                self.say(at, Fault::new(format!("found a list of {found}")).hint(hint));
            }
            _ => {}
        }
        let first = list(schema, "prefixItems");
        for (i, element) in elements.iter().enumerate() {
            if let Some(of_element) = first.get(i).or_else(|| schema.get("items")) {
                self.value(&at.child(Step::Index(i), element), of_element);
            }
        }
    }

    fn map(&mut self, at: &At<'_, '_>, schema: &'s Schema) {
        let properties = schema.get("properties").and_then(Schema::as_object);
        let others = schema.get("additionalProperties").or_else(|| schema.get("unevaluatedProperties"));
        let fields: Vec<&str> = properties.iter().flat_map(|all| all.keys()).map(String::as_str).collect();
        let Value::Map(entries) = &at.node.value else {
            return match (fields.is_empty(), others) {
                (false, _) => {
                    self.mismatch(at, "a map such as {key: value}", Some(format!("known keys: {}", fields.join(", "))))
                }
                (true, Some(Schema::Bool(false))) => self.mismatch(at, "a map without keys, {}", None),
                _ => self.mismatch(at, "a map such as {key: value}", None),
            };
        };
        let mut meant = Vec::new();
        for (key, node) in entries {
            let child = at.child(Step::Key(&key.text), node);
            match (properties.and_then(|all| all.get(&key.text)), others) {
                (Some(property), _) => self.value(&child, property),
                // A struct takes no other keys, whether it says so or not.
                (None, None | Some(Schema::Bool(false))) => meant.extend(self.unknown(&child, key, at.node, &fields)),
                (None, Some(of_others)) => self.value(&child, of_others),
            }
        }
        for key in texts(schema, "required") {
            if at.node.get(key).is_none() && !meant.contains(&key) {
                self.say(at, Fault::new(format!("missing key `{key}`")).hint(format!("add `{key}: ...`")));
                if let Some(fault) = self.faults.last_mut() {
                    fault.path = super::path::joined(&at.path(), Step::Key(key));
                }
            }
        }
    }

    /// Reports an unknown key; returns the key that was meant, if it is clear.
    fn unknown<'f>(&mut self, at: &At<'_, '_>, key: &Key, map: &Node, fields: &[&'f str]) -> Option<&'f str> {
        let free = fields.iter().copied().filter(|field| map.get(field).is_none());
        let near = nearest(&key.text, free);
        let named = || near.or_else(|| nearest(&key.text, fields.iter().copied()));
        let hint = slip(key, at.node, fields).or_else(|| named().map(|near| format!("did you mean `{near}`?")));
        let hint = hint.unwrap_or_else(|| match fields {
            [] => "no keys are allowed here".to_owned(),
            _ => format!("known keys: {}", fields.join(", ")),
        });
        if self.faults.len() <= MOST_FAULTS {
            let fault = Fault::new(format!("unknown key `{}`", shown(&key.text)));
            self.faults.push(fault.at(Arc::clone(&at.node.file), key.span).path(at.path()).hint(hint));
        }
        near
    }
}

/// Returns how to write a list of `len` values that was written as a text, such as `960x640`.
fn list_hint(text: &str, len: usize) -> String {
    let parts: Vec<&str> =
        text.split(['x', 'X', '\u{d7}', '*', ',', ';', '/', ' ']).filter(|p| !p.is_empty()).collect();
    if parts.len() == len && parts.iter().all(|p| matches!(Value::from_plain(p), Value::Number(_))) {
        format!("write `[{}]`", parts.join(", "))
    } else {
        format!("write {len} values in brackets, separated by commas")
    }
}

/// Returns what an impossible key was meant to be: a decimal comma within braces, an `=` in place of the colon.
fn slip(key: &Key, value: &Node, fields: &[&str]) -> Option<String> {
    if !matches!(value.value, Value::Null) {
        return None;
    }
    if let Some((name, given)) = key.text.split_once('=')
        && let Some(near) = nearest(name.trim(), fields.iter().copied())
    {
        return Some(format!("write `{near}: {}`, with a colon", shown(given.trim())));
    }
    let is_fraction = key.text.starts_with(|c: char| c.is_ascii_digit());
    is_fraction.then(|| "is this a decimal comma? Write a decimal point: the comma ends a value".to_owned())
}
