//! JSON Schema of nested stages: one of several kinds of a map.

use schemars::{Schema, json_schema};
use serde_json::{Map, Value, json};

/// Keyword of a schema at which a check stops, because the value there is read later.
pub(super) const PART: &str = "x-part";

/// A map of one of several kinds, chosen by a key; each kind has its own schema.
pub struct Kinds<'a> {
    /// Key that names the kind.
    pub key: &'a str,
    /// Names of the kinds, each with the schema of a map without that key.
    pub kinds: Vec<(&'a str, Schema)>,
    /// Kind that is used if none is named.
    pub default: Option<&'a str>,
    /// Keys that every kind takes in addition to its own: the schema of a map.
    pub shared: Option<&'a Schema>,
    /// Whether a text with just the name of a kind stands for a map of that kind.
    pub by_name: bool,
}

impl Kinds<'_> {
    /// Returns the schema of the map. It uses `if` and `then` instead of alternatives, so that faults refer to the kind that was
    /// meant.
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
        // The description of each kind is the first paragraph of the kind's own description.
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

    /// Returns the schema of a map with its kind, the kind's own keys and the shared ones.
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
