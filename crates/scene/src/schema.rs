//! JSON Schemas of the files that a person writes, from the types that read them and from what is registered.

use crate::assemble::{BandSection, SceneFile};
use crate::films::FilmKeys;
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde_json::{Value, json};
use spectra_core::registry::{self, Documentation};
use spectra_film::stock::Stock;

/// A kind of file that has a schema.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileKind {
    /// A scene.
    Scene,
    /// A lens.
    Lens,
    /// A film stock.
    Stock,
    /// A spectrum.
    Spectrum,
}

impl FileKind {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Scene, Self::Lens, Self::Stock, Self::Spectrum];

    /// Its name in commands.
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

/// The JSON Schema (2020-12) of a kind of file, with every stage that this program has.
#[must_use]
pub fn file_schema(kind: FileKind) -> Value {
    let mut generator = SchemaGenerator::default();
    let mut schema = match kind {
        FileKind::Scene => SceneFile::json_schema(&mut generator),
        FileKind::Lens => spectra_lens::lens_schema(&mut generator),
        FileKind::Stock => Stock::schema(&mut generator),
        FileKind::Spectrum => spectra_spectrum::document_schema(&mut generator),
    };
    if matches!(kind, FileKind::Scene | FileKind::Lens) {
        let shared = shared(&mut generator);
        registry::definitions(&mut generator, &shared);
    }
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
    whole
}

/// A text that is all digits (`format: 135`) is a number to other readers of YAML.
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

/// What a person reads about a kind of file.
#[must_use]
pub fn file_documentation(kind: FileKind) -> Documentation {
    Documentation::of(match kind {
        FileKind::Scene => SceneFile::json_schema,
        FileKind::Lens => spectra_lens::lens_schema,
        FileKind::Stock => Stock::schema,
        FileKind::Spectrum => spectra_spectrum::document_schema,
    })
}

/// What a person reads about the keys that all stages of a kind take beside their own; `None` where there are none.
#[must_use]
pub fn shared_documentation(stage: &str) -> Option<Documentation> {
    Some(Documentation::of(match stage {
        "surface" => spectra_lens::surface_keys,
        "wavelengths" => BandSection::json_schema,
        "film" => FilmKeys::json_schema,
        _ => return None,
    }))
}

/// Keys that belong to the place of a stage, not to the stage itself.
fn shared(generator: &mut SchemaGenerator) -> Vec<(&'static str, Schema)> {
    vec![
        ("surface", spectra_lens::surface_keys(generator)),
        ("wavelengths", BandSection::json_schema(generator)),
        ("film", FilmKeys::json_schema(generator)),
    ]
}

/// The definitions that something refers to.
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
                // No plugin is linked into this test: the stages' definitions come with them.
                let stage = ["source", "color", "wavelengths", "surface", "imager", "film"].contains(&name.as_str());
                assert!(stage || schema["$defs"].get(&name).is_some(), "{}: {name}", kind.name());
            }
        }
    }
}
