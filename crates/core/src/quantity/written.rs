//! Writing quantities: the JSON Schema of a quantity, and its value as documentation shows it.
//!
//! The keywords beyond JSON Schema are `x-quantity` (what is measured), `x-unit` (unit of a bare number) and `x-infinity`.

use super::kinds::{
    Angle, Exposure, FNumber, Illuminance, Length, Luminance, NonNegative, OrInfinity, Positive, Power,
    RadiantIntensity, Ratio, SpatialFrequency, Temperature, Time, Wavelength,
};
use super::quantity_format::{Bound, Quantity, deserialize};
use super::units::{Dimension, UNITS};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::borrow::Cow;

/// Returns the schema of a quantity: a number, or a text of the form that [`Quantity::from_text`] reads.
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

/// Returns the texts of a dimension as a regular expression, in the dialect that all validators share.
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

/// Returns a spelling of a unit as a regular expression that also accepts equivalent characters.
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

/// Serializes the value as documentation shows it: a number if there is no unit, else a text with the unit.
fn written<Q: Quantity, S: Serializer>(quantity: Q, serializer: S) -> Result<S::Ok, S::Error> {
    let value = quantity.bare();
    match (Q::BARE_UNIT, value.is_finite()) {
        (_, false) => serializer.serialize_str("inf"),
        ("", _) => serializer.serialize_f64(value),
        ("f/", _) => serializer.serialize_str(&format!("f/{value}")),
        (unit, _) => serializer.serialize_str(&format!("{value} {unit}")),
    }
}

/// Implements reading, showing and checking of a quantity, all by its [`Quantity`].
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
