//! JSON Schema of nested stages: one of several kinds of a map.

use schemars::{Schema, json_schema};
use serde_json::{Map, Value, json};

/// The keyword of a schema at which a check stops: what is there is read later.
pub(super) const PART: &str = "x-part";

/// One of several kinds of a map, as the schema of each.
pub struct Kinds<'a> {
    /// The key that names the kind.
    pub key: &'a str,
    /// Names, each with the schema of a map without that key.
    pub kinds: Vec<(&'a str, Schema)>,
    /// The kind that is taken where none is named.
    pub default: Option<&'a str>,
    /// Keys that every kind takes beside its own: the schema of a map.
    pub shared: Option<&'a Schema>,
    /// Whether a kind's name alone, as a text, stands for it.
    pub by_name: bool,
}

impl Kinds<'_> {
    /// The schema. It is made of `if` and `then`, not of alternatives, so that a fault is told about the kind that was meant.
    #[must_use]
    pub fn schema(&self) -> Schema {
        let names: Vec<&str> = self.kinds.iter().map(|(name, _)| *name).collect();
        let is = |name: &str| json!({ "type": "object", "properties": { self.key: { "const": name } }, "required": [self.key] });
        let mut cases = Vec::new();
        if self.by_name {
            cases.push(json!({ "if": { "type": "string" }, "then": { "enum": names } }));
        }
        for (name, own) in &self.kinds {
            let whole = self.whole(name, own);
            if self.default == Some(*name) {
                let none = json!({ "type": "object", "not": { "required": [self.key] } });
                cases.push(json!({ "if": none, "then": whole.clone() }));
            }
            cases.push(json!({ "if": is(name), "then": whole }));
        }
        // What it says of each kind is the first paragraph of the kind's own description.
        let mut said = format!("Its {}.", self.key);
        for (name, own) in &self.kinds {
            if let Some(text) = own.get("description").and_then(Value::as_str) {
                let summary = text.split("\n\n").next().unwrap_or(text).replace('\n', " ");
                said.push_str(&format!(" `{name}`: {summary}"));
            }
        }
        let mut schema = json_schema!({
            "type": if self.by_name { json!(["object", "string"]) } else { json!("object") },
            "properties": { self.key: { "enum": names, "description": said } },
            "allOf": cases,
        });
        if self.default.is_none() {
            schema.insert("required".to_owned(), json!([self.key]));
        }
        schema
    }

    /// A map with its kind, the kind's own keys and the shared ones.
    fn whole(&self, name: &str, own: &Schema) -> Value {
        let description = own.get("description").cloned().unwrap_or_else(|| "".into());
        let mut properties = Map::new();
        properties.insert(self.key.to_owned(), json!({ "const": name, "description": description }));
        let mut required = Vec::new();
        for schema in std::iter::once(own).chain(self.shared) {
            if let Some(Value::Object(more)) = schema.get("properties") {
                let own_keys = more.iter().filter(|(key, _)| *key != self.key);
                properties.extend(own_keys.map(|(key, value)| (key.clone(), value.clone())));
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
}
