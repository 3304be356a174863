//! JSON Schema of what parameters are written in: quantities with their units, nested stages.
//!
//! The keywords beyond JSON Schema are `x-quantity` (what is measured), `x-unit` (unit of a bare number) and `x-infinity`.

use super::quantities::{
    Angle, Exposure, FNumber, Illuminance, Length, Luminance, NonNegative, OrInfinity, Positive, Power,
    RadiantIntensity, Ratio, SpatialFrequency, Temperature, Time, Wavelength,
};
use super::quantity::{Bound, Quantity, deserialize};
use super::units::{Dimension, UNITS};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::{Map, Value, json};
use std::borrow::Cow;

/// The schema of a quantity: a number, or a text of the form that [`Quantity::from_text`] reads.
#[must_use]
pub fn schema_of<Q: Quantity>() -> Schema {
    let mut schema = json_schema!({
        "type": ["number", "string"],
        "pattern": pattern(Q::DIMENSION, Q::BOUND, Q::INFINITY),
        "x-quantity": Q::NOUN,
        "examples": [Q::EXAMPLE],
    });
    if !Q::BARE_UNIT.is_empty() {
        schema.insert("x-unit".to_owned(), Q::BARE_UNIT.into());
    }
    if Q::INFINITY {
        schema.insert("x-infinity".to_owned(), true.into());
    }
    match Q::BOUND {
        Bound::Any => None,
        Bound::NonNegative => schema.insert("minimum".to_owned(), 0.into()),
        Bound::Positive => schema.insert("exclusiveMinimum".to_owned(), 0.into()),
    };
    schema
}

/// The keys of a map, for [`super::Params::split`].
#[must_use]
pub fn keys_of<T: JsonSchema>() -> Vec<String> {
    let schema = T::json_schema(&mut SchemaGenerator::default());
    schema.get("properties").and_then(Value::as_object).map_or_else(Vec::new, |all| all.keys().cloned().collect())
}

/// The texts of a dimension, as a regular expression of the dialect that all validators share.
fn pattern(dimension: Dimension, bound: Bound, infinity: bool) -> String {
    let sign = if bound == Bound::Any { "[+-]?" } else { r"\+?" };
    let figure = r"([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?";
    let front = if dimension == Dimension::FNumber { "(f/)?" } else { "" };
    let mut units: Vec<String> = UNITS
        .iter()
        .filter(|unit| unit.dimension == dimension && dimension != Dimension::FNumber)
        .flat_map(|unit| unit.symbols)
        .filter(|symbol| !symbol.is_empty())
        .map(|symbol| escaped(symbol))
        .collect();
    units.sort_by_key(|unit| std::cmp::Reverse(unit.len()));
    let units = if units.is_empty() { String::new() } else { format!(r"\s*({})?", units.join("|")) };
    let infinity = if infinity { r"|\s*\+?\.?[iI]nf(inity)?\s*" } else { "" };
    format!(r"^(\s*{front}{sign}{figure}(\s*/\s*{figure})?{units}\s*{infinity})$")
}

/// A spelling of a unit as a regular expression, with the signs that count as the same.
fn escaped(symbol: &str) -> String {
    let mut out = String::new();
    for (i, c) in symbol.chars().enumerate() {
        match c {
            'u' if i == 0 => out.push_str("[u\u{b5}\u{3bc}]"),
            '2' => out.push_str("[2\u{b2}]"),
            ' ' => out.push_str("[\\s\u{b7}\u{22c5}]+"),
            '^' | '*' | '.' => {
                out.push('\\');
                out.push(c);
            }
            c => out.push(c),
        }
    }
    out
}

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

/// The value as documentation shows it: a number where there is no unit, else a text with it.
fn written<Q: Quantity, S: Serializer>(quantity: Q, serializer: S) -> Result<S::Ok, S::Error> {
    let value = quantity.bare();
    match (Q::BARE_UNIT, value.is_finite()) {
        (_, false) => serializer.serialize_str("inf"),
        ("", _) => serializer.serialize_f64(value),
        ("f/", _) => serializer.serialize_str(&format!("f/{value}")),
        (unit, _) => serializer.serialize_str(&format!("{value} {unit}")),
    }
}

/// How a quantity is read, shown and checked: all by its [`Quantity`].
macro_rules! written {
    ($($name:ident $(<$inner:ident>)?)*) => {$(
        impl<'de $(, $inner: Quantity)?> Deserialize<'de> for $name $(<$inner>)? {
            fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                deserialize(deserializer)
            }
        }

        impl $(<$inner: Quantity>)? Serialize for $name $(<$inner>)? {
            fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                written(*self, serializer)
            }
        }

        impl $(<$inner: Quantity>)? JsonSchema for $name $(<$inner>)? {
            fn inline_schema() -> bool {
                true
            }

            fn schema_name() -> Cow<'static, str> {
                concat!(stringify!($name), $("_", stringify!($inner))?).into()
            }

            fn json_schema(_: &mut SchemaGenerator) -> Schema {
                schema_of::<Self>()
            }
        }
    )*};
}

written! {
    Length Wavelength Time Temperature Luminance Illuminance Exposure Power RadiantIntensity Ratio SpatialFrequency FNumber Angle
    Positive<Q> NonNegative<Q> OrInfinity<Q>
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text<Q: Quantity>() -> String {
        serde_json::to_string(&schema_of::<Q>()).unwrap()
    }

    #[test]
    fn a_quantity_states_unit_bound_and_form() {
        let schema = text::<Positive<Length>>();
        for part in [r#""x-unit":"mm""#, r#""exclusiveMinimum":0"#, r#""x-quantity":"length""#, r#""50 mm""#] {
            assert!(schema.contains(part), "{part} in {schema}");
        }
        assert!(text::<OrInfinity<Length>>().contains(r#""x-infinity":true"#));
        assert!(!text::<Length>().contains("inimum"));
    }

    #[test]
    fn values_are_shown_with_their_unit() {
        let shown = |value: &dyn erased::Shown| value.shown();
        assert_eq!(shown(&Length::from_mm(5.0)), r#""5 mm""#);
        assert_eq!(shown(&FNumber::from_number(2.8)), r#""f/2.8""#);
        assert_eq!(shown(&Ratio::from_number(0.5)), "0.5");
        assert_eq!(shown(&OrInfinity::<Length>::Infinite), r#""inf""#);
    }

    mod erased {
        pub trait Shown {
            fn shown(&self) -> String;
        }

        impl<T: serde::Serialize> Shown for T {
            fn shown(&self) -> String {
                serde_json::to_string(self).unwrap()
            }
        }
    }
}
