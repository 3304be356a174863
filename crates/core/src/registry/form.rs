//! The form and the range of a parameter's value, taken from its schema, and the words for them.

use serde::{Serialize, Serializer};
use serde_json::{Map, Number, Value};
use std::fmt;

/// Form of a parameter's value. It is printed and serialized in words, such as `list of 2 of angle`.
#[derive(Clone, Debug, PartialEq)]
pub enum ValueForm {
    /// True or false.
    Boolean,
    /// A whole number.
    Integer,
    /// A number without a unit.
    Number,
    /// A number that may have a unit.
    Quantity {
        /// Name of the quantity, such as `length`.
        noun: String,
        /// Whether the value may be infinite.
        or_infinity: bool,
    },
    /// Any text.
    Text,
    /// One of these words.
    Choice(Vec<String>),
    /// A map with keys of its own.
    Map,
    /// A list of values of one form.
    List {
        /// Number of values; `None` if it is not fixed.
        count: Option<u64>,
        /// Form of each value.
        of: Box<ValueForm>,
    },
    /// A list with a form for each of its values.
    Tuple(Vec<ValueForm>),
    /// One of several forms; the usual one is first.
    Either(Vec<ValueForm>),
    /// A part of a file that its type describes in words of its own.
    Part {
        /// Description of the part.
        words: String,
        /// Page of `spectra doc` that documents the part; `None` if it has none.
        page: Option<String>,
    },
    /// Any value.
    Anything,
}

impl ValueForm {
    /// Reads the form from a schema.
    pub(super) fn of(schema: &Value, definitions: &Map<String, Value>) -> Self {
        let schema = resolved(schema, definitions);
        let text = |key: &str| schema.get(key).and_then(Value::as_str);
        if let Some(words) = text("x-words") {
            return Self::Part { words: words.to_owned(), page: text("x-see").map(str::to_owned) };
        }
        if let Some(stage) = text("$ref").and_then(|r| r.strip_prefix("#/$defs/")) {
            return Self::Part { words: stage.to_owned(), page: Some(stage.to_owned()) };
        }
        if let Some(noun) = text("x-quantity") {
            return Self::Quantity { noun: noun.to_owned(), or_infinity: schema.get("x-infinity").is_some() };
        }
        if let Some(all) = schema.get("enum").and_then(Value::as_array) {
            return Self::Choice(all.iter().filter_map(Value::as_str).map(str::to_owned).collect());
        }
        let several: Vec<&Value> = alternatives(schema).filter(|a| !is_null(a)).collect();
        if !several.is_empty() {
            let name = |a: &&Value| a.get("const").and_then(Value::as_str).map(str::to_owned);
            return several.iter().map(name).collect::<Option<_>>().map_or_else(
                || {
                    let mut all: Vec<Self> = several.iter().map(|a| Self::of(a, definitions)).collect();
                    all.dedup();
                    Self::Either(all)
                },
                Self::Choice,
            );
        }
        if let Some(each) = schema.get("prefixItems").and_then(Value::as_array) {
            return Self::Tuple(each.iter().map(|item| Self::of(item, definitions)).collect());
        }
        if is(schema, "array") {
            let [least, most] = ["minItems", "maxItems"].map(|key| schema.get(key).and_then(Value::as_u64));
            let of = schema.get("items").map_or(Self::Anything, |items| Self::of(items, definitions));
            return Self::List { count: least.filter(|_| least == most), of: Box::new(of) };
        }
        let plain = [
            ("object", Self::Map),
            ("boolean", Self::Boolean),
            ("integer", Self::Integer),
            ("number", Self::Number),
            ("string", Self::Text),
        ];
        plain.into_iter().find(|(name, _)| is(schema, name)).map_or(Self::Anything, |(_, form)| form)
    }

    /// Returns the first of several forms, or the form itself if there is only one.
    #[must_use]
    pub fn usual(&self) -> &Self {
        match self {
            Self::Either(all) => all.first().map_or(self, Self::usual),
            _ => self,
        }
    }
}

impl fmt::Display for ValueForm {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let joined = |all: &[Self], by: &str| all.iter().map(ToString::to_string).collect::<Vec<_>>().join(by);
        match self {
            Self::Boolean => f.write_str("true or false"),
            Self::Integer => f.write_str("whole number"),
            Self::Number => f.write_str("number"),
            Self::Quantity { noun, or_infinity } => {
                f.write_str(noun)?;
                f.write_str(if *or_infinity { " or inf" } else { "" })
            }
            Self::Text => f.write_str("text"),
            Self::Choice(words) => f.write_str(&words.join(" | ")),
            Self::Map => f.write_str("map"),
            Self::List { count: Some(count), of } => write!(f, "list of {count} of {of}"),
            Self::List { count: None, of } => write!(f, "list of {of}"),
            Self::Tuple(each) => write!(f, "[{}]", joined(each, ", ")),
            Self::Either(all) => f.write_str(&joined(all, ", or ")),
            Self::Part { words, page: Some(page) } => write!(f, "{words} (see `spectra doc {page}`)"),
            Self::Part { words, page: None } => f.write_str(words),
            Self::Anything => f.write_str("anything"),
        }
    }
}

impl Serialize for ValueForm {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// Allowed values of a parameter, in its unit. The range is printed and serialized in words, such as `0 to 10`; empty if the form allows
/// all values.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ValueRange {
    least: Option<Number>,
    most: Option<Number>,
    /// The values are greater than this number.
    above: Option<Number>,
    /// The values are less than this number.
    below: Option<Number>,
    /// Range of each value of a list.
    each: Option<Box<ValueRange>>,
    /// Smallest and largest number of values of a list, unless it is fixed.
    count: [Option<u64>; 2],
}

impl ValueRange {
    /// Reads the range from a schema.
    pub(super) fn of(schema: &Value) -> Self {
        let bound = |key: &str| match schema.get(key) {
            Some(Value::Number(number)) => Some(number.clone()),
            _ => None,
        };
        let least = bound("minimum").filter(|least| least.as_f64() != Some(f64::from(i32::MIN)));
        // If both are stated, the greater one is enough.
        let above =
            bound("exclusiveMinimum").filter(|above| least.as_ref().is_none_or(|l| l.as_f64() <= above.as_f64()));
        let count = ["minItems", "maxItems"].map(|key| schema.get(key).and_then(Value::as_u64));
        Self {
            least,
            most: bound("maximum"),
            above,
            below: bound("exclusiveMaximum"),
            each: schema.get("items").map(Self::of).filter(|each| *each != Self::default()).map(Box::new),
            count: if count[0] == count[1] { [None; 2] } else { count },
        }
    }

    /// Returns the lower and upper limit of a number, or of each number of a list; `None` where there is none.
    #[must_use]
    pub fn limits(&self) -> [Option<f64>; 2] {
        let own = [self.above.as_ref().or(self.least.as_ref()), self.below.as_ref().or(self.most.as_ref())];
        match &self.each {
            Some(each) if own == [None; 2] => each.limits(),
            _ => own.map(|limit| limit.and_then(Number::as_f64)),
        }
    }
}

impl fmt::Display for ValueRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut parts = Vec::new();
        match (&self.least, &self.most) {
            (Some(least), Some(most)) if least == most => parts.push(format!("{least} only")),
            (Some(least), Some(most)) => parts.push(format!("{least} to {most}")),
            (Some(least), None) => parts.push(format!(">= {least}")),
            _ => {}
        }
        parts.extend(self.above.as_ref().map(|above| format!("> {above}")));
        if self.least.is_none() {
            parts.extend(self.most.as_ref().map(|most| format!("<= {most}")));
        }
        parts.extend(self.below.as_ref().map(|below| format!("< {below}")));
        parts.extend(self.each.as_ref().map(|each| format!("each {each}")));
        match self.count {
            [Some(least), Some(most)] => parts.push(format!("{least} to {most} of them")),
            [Some(least), None] => parts.push(format!("{least} of them or more")),
            [None, Some(most)] => parts.push(format!("{most} of them at most")),
            [None, None] => {}
        }
        f.write_str(&parts.join(", "))
    }
}

impl Serialize for ValueRange {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

pub(super) fn alternatives(schema: &Value) -> impl Iterator<Item = &Value> {
    ["anyOf", "oneOf"].into_iter().filter_map(|key| schema.get(key)?.as_array()).flatten()
}

pub(super) fn is(schema: &Value, name: &str) -> bool {
    match schema.get("type") {
        Some(Value::String(one)) => one == name,
        Some(Value::Array(several)) => several.iter().any(|s| s.as_str() == Some(name)),
        _ => false,
    }
}

/// Follows references. If a schema allows something or null, it follows the something.
pub(super) fn resolved<'a>(schema: &'a Value, definitions: &'a Map<String, Value>) -> &'a Value {
    let mut at = schema;
    for _ in 0..8 {
        if let Some(name) = at.get("$ref").and_then(Value::as_str).and_then(|r| r.strip_prefix("#/$defs/")) {
            match definitions.get(name) {
                Some(definition) => at = definition,
                None => return at,
            }
            continue;
        }
        let mut others = alternatives(at).filter(|a| !is_null(a));
        match (others.next(), others.next()) {
            (Some(only), None) => at = only,
            _ => return at,
        }
    }
    at
}

fn is_null(schema: &Value) -> bool {
    schema.get("type").and_then(Value::as_str) == Some("null")
}
