//! JSON Schema of what can stand where a stage is wanted.

use super::{Listed, Stage};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde_json::{Map, Value, json};
use std::borrow::Cow;
use std::marker::PhantomData;

/// The schema of any registered stage of a kind: a name, or a map with `kind` and that stage's own parameters. For nested
/// stages, kept as a `StageNode`:
///
/// ```
/// # use {schemars::JsonSchema, spectra_core::{params::StageNode, registry::StageOf, stage::ColorModel}};
/// #[derive(JsonSchema)]
/// struct LampParams {
///     /// How the lamp's color becomes a spectrum.
///     #[schemars(with = "Option<StageOf<dyn ColorModel>>")]
///     color: Option<StageNode>,
/// }
/// ```
///
/// It refers to a definition that [`definitions`] writes.
pub struct StageOf<S: ?Sized>(PhantomData<S>);

impl<S: Stage + ?Sized> JsonSchema for StageOf<S> {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        S::NAME.into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "$ref": format!("#/$defs/{}", S::NAME) })
    }
}

/// Writes one definition a kind of stage (`source`, `surface`, ...) into a generator, with everything that is registered.
/// `shared` are keys that all stages of a kind take beside their own: a schema of a map, by kind.
pub fn definitions(generator: &mut SchemaGenerator, shared: &[(&str, Schema)]) {
    let all = super::list();
    for entries in all.chunk_by(|a, b| a.stage == b.stage) {
        let stage = entries[0].stage;
        let beside = shared.iter().find(|(name, _)| *name == stage).map(|(_, schema)| schema);
        let definition = any_of(entries, beside, generator);
        generator.definitions_mut().insert(stage.to_owned(), definition);
    }
}

/// One of these stages. `if` and `then` instead of alternatives, so that a fault is told about the kind that was meant.
fn any_of(entries: &[Listed], shared: Option<&Schema>, generator: &mut SchemaGenerator) -> Value {
    let names: Vec<&str> = entries.iter().map(|e| e.name).collect();
    let mut cases = vec![json!({ "if": { "type": "string" }, "then": { "enum": names } })];
    for entry in entries {
        let whole = one(entry, shared, generator);
        if entry.default {
            cases.push(json!({
                "if": { "type": "object", "not": { "required": ["kind"] } },
                "then": whole.clone(),
            }));
        }
        cases.push(json!({
            "if": { "type": "object", "properties": { "kind": { "const": entry.name } }, "required": ["kind"] },
            "then": whole,
        }));
    }
    let mut schema = json!({
        "type": ["object", "string"],
        "properties": { "kind": { "enum": names } },
        "allOf": cases,
    });
    if !entries.iter().any(|e| e.default) {
        schema["required"] = json!(["kind"]);
    }
    schema
}

/// A map with `kind` and the parameters of one stage.
fn one(entry: &Listed, shared: Option<&Schema>, generator: &mut SchemaGenerator) -> Value {
    let own = (entry.schema)(generator);
    let description = own.get("description").cloned().unwrap_or_else(|| "".into());
    let mut properties = Map::new();
    properties.insert("kind".to_owned(), json!({ "const": entry.name, "description": description }));
    let mut required = Vec::new();
    for schema in std::iter::once(&own).chain(shared) {
        if let Some(Value::Object(more)) = schema.get("properties") {
            properties.extend(more.iter().map(|(key, value)| (key.clone(), value.clone())));
        }
        if let Some(Value::Array(more)) = schema.get("required") {
            required.extend(more.iter().cloned());
        }
    }
    let mut whole = json!({
        "type": "object",
        "description": description,
        "properties": properties,
        "additionalProperties": false,
    });
    if !required.is_empty() {
        whole["required"] = required.into();
    }
    whole
}
