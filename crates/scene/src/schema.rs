//! JSON Schemas of the files that users write, made from the types that read them and from the registered stages.

use crate::films::FilmKeys;
use crate::scene_file::{BandSection, SceneFile};
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde_json::{Value, json};
use spectra_core::registry::{self, Documentation};
use spectra_film::stock::Stock;

/// Kinds of files that have a schema.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileKind {
    /// A scene file.
    Scene,
    /// A lens file.
    Lens,
    /// A film stock file.
    Stock,
    /// A spectrum file.
    Spectrum,
}

impl FileKind {
    /// All kinds of files.
    pub const ALL: [Self; 4] = [Self::Scene, Self::Lens, Self::Stock, Self::Spectrum];

    /// Returns the name of this kind in commands.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Scene => "scene",
            Self::Lens => "lens",
            Self::Stock => "stock",
            Self::Spectrum => "spectrum",
        }
    }
}

/// Returns the JSON Schema (2020-12) of a kind of file, with every stage that this program has.
#[must_use]
pub fn file_schema(kind: FileKind) -> Value {
    let mut generator = SchemaGenerator::default();
    let mut schema = match kind {
        FileKind::Scene => SceneFile::json_schema(&mut generator),
        FileKind::Lens => spectra_lens::lens_schema(&mut generator),
        FileKind::Stock => Stock::schema(&mut generator),
        FileKind::Spectrum => spectra_spectrum::document_schema(&mut generator),
    };
    let shared = shared(&mut generator);
    registry::definitions(&mut generator, &shared);
    let definitions = generator.take_definitions(true);
    let mut whole = json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": format!("spectra {}", kind.name()),
    });
    if let (Value::Object(all), Value::Object(own)) = (&mut whole, std::mem::take(&mut schema).to_value()) {
        all.extend(own.into_iter().filter(|(key, _)| key != "title"));
        if !definitions.is_empty() {
            all.insert("$defs".to_owned(), reached(all, definitions));
        }
    }
    allow_figures(&mut whole);
    if kind == FileKind::Scene {
        allow_variables(&mut whole);
        whole = or_part(whole);
    }
    whole
}

/// Pattern of a text that stands for a variable, see [`crate::load_series`].
const VARIABLE: &str = r"^\$[A-Za-z_{]";

/// Allows `$name` wherever a value can stand.
fn allow_variables(schema: &mut Value) {
    let Value::Object(map) = schema else {
        if let Value::Array(items) = schema {
            items.iter_mut().for_each(allow_variables);
        }
        return;
    };
    for (key, inside) in map.iter_mut() {
        allow_variables(inside);
        match (key.as_str(), inside) {
            ("properties", Value::Object(properties)) => properties.values_mut().for_each(or_variable),
            ("items", items @ Value::Object(_)) => or_variable(items),
            _ => {}
        }
    }
}

fn or_variable(schema: &mut Value) {
    let Value::Object(map) = schema else { return };
    if map.contains_key("const") {
        return;
    }
    if let Some(Value::String(pattern)) = map.get_mut("pattern") {
        *pattern = format!("{pattern}|{VARIABLE}");
        return;
    }
    let description = map.get("description").cloned();
    let mut either = json!({ "if": { "type": "string", "pattern": VARIABLE }, "else": schema.take() });
    if let Some(description) = description {
        either["description"] = description;
    }
    *schema = either;
}

/// Makes all keys optional for a scene that includes others, because it may hold only a part of what a scene needs.
fn or_part(mut whole: Value) -> Value {
    let Some(definitions) = whole.as_object_mut().and_then(|map| map.remove("$defs")) else { return whole };
    let head = json!({ "$schema": whole["$schema"].take(), "title": whole["title"].take() });
    if let Some(map) = whole.as_object_mut() {
        map.retain(|key, _| key != "$schema" && key != "title");
    }
    let mut all = serde_json::Map::new();
    if let Value::Object(definitions) = definitions {
        for (name, definition) in definitions {
            let mut part = definition.clone();
            make_part(&mut part);
            all.insert(format!("part-{name}"), part);
            all.insert(name, definition);
        }
    }
    let mut part = whole.clone();
    make_part(&mut part);
    all.insert("part-scene".to_owned(), part);
    all.insert("scene".to_owned(), whole);
    let mut schema = head;
    schema["if"] = json!({ "type": "object", "required": ["include"] });
    schema["then"] = json!({ "$ref": "#/$defs/part-scene" });
    schema["else"] = json!({ "$ref": "#/$defs/scene" });
    schema["$defs"] = Value::Object(all);
    schema
}

/// Removes `required` everywhere except where it decides between kinds.
fn make_part(schema: &mut Value) {
    match schema {
        Value::Object(map) => {
            let decides = map.get("required").is_some() && map.get("properties").is_some_and(is_one_const);
            if !decides && map.contains_key("properties") {
                map.remove("required");
            }
            if let Some(Value::String(to)) = map.get_mut("$ref") {
                *to = to.replace("#/$defs/", "#/$defs/part-");
            }
            map.values_mut().for_each(make_part);
        }
        Value::Array(items) => items.iter_mut().for_each(make_part),
        _ => {}
    }
}

fn is_one_const(properties: &Value) -> bool {
    properties.as_object().is_some_and(|map| map.len() == 1 && map.values().all(|p| p.get("const").is_some()))
}

/// Allows numbers for texts, because other YAML readers take a text that is all digits (`format: 135`) for a number.
fn allow_figures(schema: &mut Value) {
    match schema {
        Value::Object(map) => {
            let free = !["pattern", "enum", "const"].iter().any(|key| map.contains_key(*key));
            match map.get_mut("type") {
                Some(kind @ Value::String(_)) if free && kind == "string" => *kind = json!(["string", "number"]),
                Some(Value::Array(kinds))
                    if free
                        && kinds.iter().any(|k| k == "string")
                        && !kinds.iter().any(|k| k == "number" || k == "object") =>
                {
                    kinds.push("number".into());
                }
                _ => {}
            }
            map.values_mut().for_each(allow_figures);
        }
        Value::Array(items) => items.iter_mut().for_each(allow_figures),
        _ => {}
    }
}

/// Returns the documentation of a kind of file.
#[must_use]
pub fn file_documentation(kind: FileKind) -> Documentation {
    Documentation::of(match kind {
        FileKind::Scene => SceneFile::json_schema,
        FileKind::Lens => spectra_lens::lens_schema,
        FileKind::Stock => Stock::schema,
        FileKind::Spectrum => spectra_spectrum::document_schema,
    })
}

/// Returns the documentation of the keys that all stages of a kind share; `None` if there are none.
#[must_use]
pub fn shared_documentation(stage: &str) -> Option<Documentation> {
    Some(Documentation::of(match stage {
        "surface" => spectra_lens::surface_keys,
        "coating" => spectra_lens::coating_keys,
        "aperture" => spectra_lens::aperture_keys,
        "wavelengths" => BandSection::json_schema,
        "film" => FilmKeys::json_schema,
        _ => return None,
    }))
}

/// Returns the keys that belong to the place of a stage and not to the stage itself.
fn shared(generator: &mut SchemaGenerator) -> Vec<(&'static str, Schema)> {
    vec![
        ("surface", spectra_lens::surface_keys(generator)),
        ("coating", spectra_lens::coating_keys(generator)),
        ("aperture", spectra_lens::aperture_keys(generator)),
        ("wavelengths", BandSection::json_schema(generator)),
        ("film", FilmKeys::json_schema(generator)),
    ]
}

/// Returns the definitions that are referred to, directly or through others.
fn reached(root: &serde_json::Map<String, Value>, definitions: serde_json::Map<String, Value>) -> Value {
    let mut wanted: Vec<String> = Vec::new();
    for value in root.values() {
        references(value, &mut wanted);
    }
    let mut at = 0;
    while at < wanted.len() {
        if let Some(definition) = definitions.get(&wanted[at]) {
            references(definition, &mut wanted);
        }
        at += 1;
    }
    Value::Object(definitions.into_iter().filter(|(name, _)| wanted.contains(name)).collect())
}

fn references(value: &Value, found: &mut Vec<String>) {
    match value {
        Value::Object(map) => {
            if let Some(name) = map.get("$ref").and_then(Value::as_str).and_then(|r| r.strip_prefix("#/$defs/"))
                && !found.iter().any(|f| f == name)
            {
                found.push(name.to_owned());
            }
            map.values().for_each(|v| references(v, found));
        }
        Value::Array(items) => items.iter().for_each(|v| references(v, found)),
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_referred_to_is_there() {
        for kind in FileKind::ALL {
            let schema = file_schema(kind);
            let mut wanted = Vec::new();
            references(&schema, &mut wanted);
            for name in wanted {
                // No plugin is linked into this test, so the definitions of stages are missing.
                let stage = ["source", "color", "wavelengths", "surface", "imager", "film", "output"]
                    .contains(&name.trim_start_matches("part-"));
                assert!(stage || schema["$defs"].get(&name).is_some(), "{}: {name}", kind.name());
            }
        }
    }
}
