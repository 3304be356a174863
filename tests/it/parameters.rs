//! Tests that a parameter is declared once: its type, range and words are in its declaration, which is what is checked.

use crate::common::repository;
use serde_json::{Map, Value, json};
use spectra_core::params::{Fault, Params};
use spectra_core::registry::{self, Context, list};
use spectra_core::resources::Resources;
use spectra_core::spectral::Grid;
use spectra_core::stage::{ColorModel, Film, Imager, Response, Source, WavelengthSampler};
use spectra_core::surface::Surface;
use spectra_glass::Formula;
use spectra_lens::{ApertureShape, Coating};
use spectra_plugins as _;
use spectra_scene::{FileResources, Output};
use spectra_spectrum::SpectrumKind;
use std::path::{Path, PathBuf};

/// A value just outside of what a schema allows, and its place.
#[derive(Clone, Debug)]
struct Outside {
    /// Path of the key, such as `photosite.index` or `tilt[0]`.
    path: String,
    /// The tree that contains the value.
    tree: Value,
}

/// Returns values just outside the limits of a schema.
fn outside(schema: &Value) -> Vec<Value> {
    let number = |key: &str| schema.get(key).and_then(Value::as_f64);
    let is_whole = schema.get("type").is_some_and(|t| t == "integer" || t == &json!(["integer", "null"]));
    let step = |limit: f64| if is_whole { 1.0 } else { 1e-9 * limit.abs().max(1.0) };
    let below = number("minimum").map(|least| least - step(least)).or(number("exclusiveMinimum"));
    let above = number("maximum").map(|most| most + step(most)).or(number("exclusiveMaximum"));
    let numbers: Vec<f64> = [below, above].into_iter().flatten().collect();
    let unit = schema.get("x-unit").and_then(Value::as_str).filter(|unit| !unit.ends_with('/'));
    let written = |value: f64| if is_whole { json!(value as i64) } else { json!(value) };
    let bare = numbers.iter().map(|value| written(*value));
    let with_unit = numbers.iter().filter_map(|value| Some(json!(format!("{value} {}", unit?))));
    bare.chain(with_unit).collect()
}

/// Returns all values just outside the limits in the schema of a map.
fn all_outside(schema: &Value, definitions: &Map<String, Value>) -> Vec<Outside> {
    // Parts are read later by other code.
    if schema.get("x-part").is_some() {
        return Vec::new();
    }
    let name = schema.get("$ref").and_then(Value::as_str).and_then(|r| r.strip_prefix("#/$defs/"));
    let schema = name.and_then(|name| definitions.get(name)).unwrap_or(schema);
    let here = |tree: Value| Outside { path: String::new(), tree };
    let mut found: Vec<Outside> = outside(schema).into_iter().map(here).collect();
    for (key, property) in schema.get("properties").and_then(Value::as_object).into_iter().flatten() {
        for inner in all_outside(property, definitions) {
            let dot = if inner.path.is_empty() || inner.path.starts_with('[') { "" } else { "." };
            found.push(Outside { path: format!("{key}{dot}{}", inner.path), tree: json!({ key: inner.tree }) });
        }
    }
    let size = |key: &str| schema.get(key).and_then(Value::as_u64).map(|n| n as usize);
    if let Some(items) = schema.get("items") {
        for inner in all_outside(items, definitions) {
            let dot = if inner.path.is_empty() || inner.path.starts_with('[') { "" } else { "." };
            let tree = json!(vec![inner.tree; size("minItems").unwrap_or(1).max(1)]);
            found.push(Outside { path: format!("[0]{dot}{}", inner.path), tree });
        }
    }
    if let Some(most) = size("maxItems") {
        found.push(here(json!(vec![Value::Null; most + 1])));
    }
    if let Some(least) = size("minItems").filter(|least| *least > 0) {
        found.push(here(json!(vec![Value::Null; least - 1])));
    }
    for way in ["anyOf", "oneOf"].iter().filter_map(|key| schema.get(key)?.as_array()).flatten() {
        // With several alternatives, another one may allow the value.
        if ways(schema) == 1 {
            found.extend(all_outside(way, definitions));
        }
    }
    found
}

/// Returns the number of alternatives other than null.
fn ways(schema: &Value) -> usize {
    let all = ["anyOf", "oneOf"].iter().filter_map(|key| schema.get(key)?.as_array()).flatten();
    all.filter(|way| way.get("type").is_none_or(|t| t != "null")).count()
}

fn built(stage: &str, params: &Params, context: &Context<'_>) -> Vec<Fault> {
    let faults = match stage {
        "source" => registry::build::<dyn Source>(params, context).err(),
        "surface" => registry::build::<dyn Surface>(params, context).err(),
        "wavelengths" => registry::build::<dyn WavelengthSampler>(params, context).err(),
        "imager" => registry::build::<dyn Imager>(params, context).err(),
        "film" => registry::build::<dyn Film>(params, context).err(),
        "response" => registry::build::<dyn Response>(params, context).err(),
        "color" => registry::build::<dyn ColorModel>(params, context).err(),
        "output" => registry::build::<dyn Output>(params, context).err(),
        "spectrum" => registry::build::<dyn SpectrumKind>(params, context).err(),
        "coating" => registry::build::<Coating>(params, context).err(),
        "aperture" => registry::build::<ApertureShape>(params, context).err(),
        "formula" => registry::build::<Formula>(params, context).err(),
        other => panic!("a kind of stage that this test does not know: {other}"),
    };
    faults.map(|faults| faults.0).unwrap_or_default()
}

/// Every range and length that a schema states is checked, reported at its own place with a hint that says what is allowed.
#[test]
fn what_a_schema_allows_is_what_is_checked() {
    let folder = tempfile::tempdir().expect("a folder");
    let resources = FileResources::beside(folder.path());
    let context = Context::new(&resources, Grid { start_nm: 350.0, step_nm: 1.0, count: 481 });
    let (mut wrong, mut looked_at) = (Vec::new(), 0);
    for stage in list() {
        let mut generator = schemars::SchemaGenerator::default();
        let schema = (stage.schema)(&mut generator);
        let definitions = generator.take_definitions(true);
        for Outside { path, mut tree } in all_outside(schema.as_value(), &definitions) {
            tree[stage.key] = stage.name.into();
            std::fs::write(folder.path().join("t.yaml"), tree.to_string()).expect("written");
            let file = resources.document("t.yaml", &[], &[]).expect("YAML");
            let params = Params::kinded(file.node().clone(), "x", stage.key).expect("a stage");
            let faults = built(stage.stage, &params, &context);
            let wanted = format!("x.{path}");
            let told = faults.iter().any(|fault| {
                let is_range = fault.message.contains("which is out of range")
                    || fault.message.contains("expected a")
                    || fault.message.contains("found a list of");
                fault.path == wanted && is_range && fault.hint.is_some()
            });
            if !told {
                let said: Vec<String> = faults.iter().map(|f| format!("{}: {f}", f.path)).collect();
                wrong.push(format!("{}/{} {wanted} in {tree}:\n  {}", stage.stage, stage.name, said.join("\n  ")));
            }
            looked_at += 1;
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(looked_at > 150, "{looked_at} values");
}

fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for path in std::fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path()) {
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.push(path);
        }
    }
}

/// Returns the words of each enum with a derived schema.
fn words_of_enums(code: &str) -> Vec<Vec<String>> {
    let mut enums = Vec::new();
    for part in code.split("#[derive(").skip(1) {
        let (derived, rest) = part.split_once(")]").unwrap_or((part, ""));
        let head = rest.split('{').next().unwrap_or_default();
        if !derived.contains("JsonSchema") || !head.contains("kebab-case") || !head.contains("enum ") {
            continue;
        }
        let body = rest.split_once('{').map_or("", |(_, body)| body.split("\n}").next().unwrap_or_default());
        let variants = body.lines().filter_map(|line| line.trim().strip_suffix(','));
        let variants = variants.filter(|v| v.starts_with(char::is_uppercase) && v.chars().all(char::is_alphanumeric));
        enums.push(variants.map(kebab).collect());
    }
    enums
}

fn kebab(variant: &str) -> String {
    let dash = |(i, c): (usize, char)| if i > 0 && c.is_uppercase() { format!("-{c}") } else { c.to_string() };
    variant.char_indices().map(dash).collect::<String>().to_lowercase()
}

/// Returns the numbers of `range(min = A, max = B)` and of `"exclusiveMinimum" = A, "maximum" = B`.
fn ranges(code: &str) -> Vec<[String; 2]> {
    let mut found = Vec::new();
    for attribute in code.split("#[schemars(").skip(1).map(|rest| rest.split(")]").next().unwrap_or_default()) {
        let value = |names: [&str; 2]| {
            let after = names.iter().find_map(|name| attribute.split_once(name))?.1.trim_start().strip_prefix('=')?;
            let end = after.find([',', ')']).unwrap_or(after.len());
            Some(after[..end].trim().to_owned())
        };
        if let (Some(least), Some(most)) = (value(["min", "\"exclusiveMinimum\""]), value(["max", "\"maximum\""])) {
            found.push([least, most]);
        }
    }
    found
}

/// No range and no list of words is repeated outside the declaration that is checked.
#[test]
fn nothing_is_said_twice() {
    let mut files = Vec::new();
    for folder in ["crates", "plugins"] {
        sources(&repository(folder), &mut files);
    }
    let (mut twice, mut words, mut limits) = (Vec::new(), 0, 0);
    for path in files.iter().filter(|path| path.components().any(|c| c.as_os_str() == "src")) {
        let code = std::fs::read_to_string(path).expect("text");
        let code = code.split("#[cfg(test)]").next().unwrap_or_default();
        let mut say = |what: String| twice.push(format!("{}: {what}", path.display()));
        if code.contains("extend(\"enum\"") {
            say("a list of words beside a type that takes any: write an enum".to_owned());
        }
        if code.contains("thread_local!") {
            say("thread_local".to_owned());
        }
        for all in words_of_enums(code).into_iter().filter(|all| !all.is_empty()) {
            words += all.len();
            let by_hand = |word: &String| {
                [format!("\"{word}\" =>"), format!("Some(\"{word}\")"), format!("\"{word}\" |")]
                    .iter()
                    .any(|form| code.contains(form))
            };
            if all.iter().all(by_hand) {
                say(format!("words are matched by hand: {}", all.join(", ")));
            }
        }
        for [least, most] in ranges(code) {
            limits += 1;
            let number =
                |text: &str| text.replace('_', "").parse::<f64>().map_or(text.to_owned(), |v| format!("{v:?}"));
            // A named constant is declared once, wherever it is used.
            let named = |text: &str| text.starts_with(char::is_uppercase);
            if named(&least) || named(&most) {
                continue;
            }
            for [a, b] in [[least.clone(), most.clone()], [number(&least), number(&most)]] {
                if code.contains(&format!("({a}..={b}).contains")) {
                    say(format!("the range {a} to {b} is checked again"));
                }
            }
        }
    }
    assert!(twice.is_empty(), "{}", twice.join("\n"));
    assert!(words > 60 && limits > 20, "{words} words, {limits} ranges");
}
