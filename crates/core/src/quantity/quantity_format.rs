//! The forms in which a quantity is written: a bare number in a stated unit, or a text with a unit whose dimension is checked.

use super::limits::Limits;
use super::units::{Dimension, Reading, Unit};
use crate::names::{nearest, shown};
use crate::params::Fault;
use serde::de::{Deserializer, Error, Visitor};
use serde_json::Value;
use std::fmt;
use std::marker::PhantomData;

/// Bound on the sign of a quantity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bound {
    /// Any sign.
    Any,
    /// Zero or more.
    NonNegative,
    /// More than zero.
    Positive,
}

impl Bound {
    /// Returns the stricter of two bounds.
    #[must_use]
    pub const fn and(self, other: Self) -> Self {
        match (self, other) {
            (Self::Positive, _) | (_, Self::Positive) => Self::Positive,
            (Self::NonNegative, _) | (_, Self::NonNegative) => Self::NonNegative,
            (Self::Any, Self::Any) => Self::Any,
        }
    }

    pub(super) const fn limits(self) -> Limits {
        match self {
            Self::Any => Limits::ANY,
            Self::NonNegative => Limits::NOT_NEGATIVE,
            Self::Positive => Limits::POSITIVE,
        }
    }
}

/// A typed quantity in a scene file. Its constants feed messages, documentation and schemas.
pub trait Quantity: Copy {
    /// Dimension that the quantity measures.
    const DIMENSION: Dimension;
    /// Name of the quantity, without an article.
    const NOUN: &'static str = Self::DIMENSION.noun();
    /// The unit of a bare number; empty if it has none.
    const BARE_UNIT: &'static str;
    /// An example of how to write the quantity.
    const EXAMPLE: &'static str;
    /// Bound on the sign of the quantity.
    const BOUND: Bound = Bound::Any;
    /// Whether the quantity may be infinite (`inf`).
    const INFINITY: bool = false;

    /// Creates the quantity from a number in [`Self::BARE_UNIT`] that obeys the bound.
    fn from_bare(value: f64) -> Self;

    /// Returns the number in [`Self::BARE_UNIT`].
    fn bare(self) -> f64;

    /// Creates the quantity from a number in any unit of the dimension.
    #[must_use]
    fn from_unit(value: f64, unit: &Unit) -> Self {
        match Unit::find(Self::BARE_UNIT) {
            Some(bare) => Self::from_bare(unit.convert(value, bare)),
            None => Self::from_bare(value),
        }
    }

    /// Reads a text such as `50 mm`; a number without a unit is in [`Self::BARE_UNIT`].
    ///
    /// # Errors
    /// What was found and what is expected.
    fn from_text(text: &str) -> Result<Self, Fault> {
        let form = QuantityFormat {
            noun: Self::NOUN,
            dimension: Self::DIMENSION,
            unit: Self::BARE_UNIT,
            example: Self::EXAMPLE,
            limits: Self::BOUND.limits(),
            infinity: Self::INFINITY,
        };
        Ok(match form.read(text)? {
            (value, Some(unit)) => Self::from_unit(value, unit),
            (value, None) => Self::from_bare(value),
        })
    }
}

/// The written form of a quantity and its limits: a [`Quantity`] with the limits of one key.
#[derive(Clone, Copy)]
pub(crate) struct QuantityFormat<'a> {
    noun: &'a str,
    dimension: Dimension,
    /// The unit of a bare number; empty if it has none.
    unit: &'a str,
    example: &'a str,
    limits: Limits,
    infinity: bool,
}

impl<'a> QuantityFormat<'a> {
    /// Reads the form from a schema made by [`super::schema_of`], perhaps with narrower limits.
    pub(crate) fn of(schema: &'a Value) -> Option<Self> {
        let text = |key: &str| schema.get(key).and_then(Value::as_str);
        let (noun, unit) = (text("x-quantity")?, text("x-unit").unwrap_or_default());
        // A plain number has no dimension, although its empty unit is also that of ratios.
        let dimension = match Unit::find(unit) {
            Some(found) if noun != Dimension::Number.noun() => found.dimension,
            _ => Dimension::Number,
        };
        let example = schema.get("examples").and_then(|e| e.get(0)?.as_str()).unwrap_or("1.5");
        Some(Self {
            noun,
            dimension,
            unit,
            example,
            limits: Limits::of(schema),
            infinity: schema.get("x-infinity").is_some(),
        })
    }

    pub(crate) fn example(&self) -> &'a str {
        self.example
    }

    /// Describes the right form in words: `a positive length such as 50 mm`.
    pub(crate) fn expected(&self) -> String {
        let noun = format!("{}{}", self.limits.adjective(), self.noun);
        let or_infinity = if self.infinity { " or `inf`" } else { "" };
        format!("{} such as {}{or_infinity}", with_article(&noun), self.example)
    }

    /// Reads a text as a number and its unit; there is no unit if the number is bare.
    pub(crate) fn read(&self, text: &str) -> Result<(f64, Option<&'static Unit>), Fault> {
        let expected = self.expected();
        let as_in = format!("write it as in `{}`", self.example);
        let found = |what: &str, hint: &str| Err(Fault::new(format!("found {what}, expected {expected}")).hint(hint));
        match Reading::of(text) {
            Reading::Bare(value) => self.allowed(value, text).map(|()| (value, None)),
            Reading::Quantity { value, unit } if unit.dimension == self.dimension => {
                let bare = Unit::find(self.unit).map_or(value, |bare| unit.convert(value, bare));
                self.allowed(bare, text).map(|()| (value, Some(unit)))
            }
            Reading::Quantity { .. } => {
                let message = format!("found {}, expected {expected}", found_text(text));
                Err(Fault { hint: self.units_hint(), ..Fault::new(message) })
            }
            Reading::Infinity(false) if self.infinity => Ok((f64::INFINITY, None)),
            Reading::Infinity(_) | Reading::NotANumber => found(&shown(text), &as_in),
            Reading::TooLarge => {
                let message = format!("found {}, which is too large; expected {expected}", shown(text));
                Err(Fault::new(message).hint(as_in))
            }
            Reading::DecimalComma => {
                found(&format!("the text `{}`", shown(text)), "write a decimal point, not a comma")
            }
            Reading::UnknownUnit(unit) if unit.starts_with('/') => {
                found(&shown(text), "the denominator must be greater than 0, as in `1/125`")
            }
            Reading::UnknownUnit(unit) => {
                let units = self.dimension.units();
                let usual = usual_symbol(unit).filter(|symbol| units.contains(symbol));
                let near = usual.or_else(|| nearest(unit, units.iter().copied()));
                let hint = near.map(|near| format!("did you mean `{near}`?")).or_else(|| self.units_hint());
                Err(Fault { hint, ..Fault::new(format!("unknown unit `{}`, expected {expected}", shown(unit))) })
            }
            Reading::Text => found(&format!("the text `{}`", shown(text)), &self.text_hint(text)),
        }
    }

    /// Checks that a number in the unit of bare numbers is within the limits.
    pub(crate) fn allowed(&self, value: f64, written: &str) -> Result<(), Fault> {
        let written = shown(written);
        if !value.is_finite() {
            let fault = Fault::new(format!("found {written}, which is too large, expected {}", self.expected()));
            return Err(fault.hint(format!("write it as in `{}`", self.example)));
        }
        if self.limits.allow(value) {
            return Ok(());
        }
        let words = self.limits.words(self.unit);
        Err(if self.limits.sign_is_wrong(value) {
            let fault = Fault::new(format!("found {written}, expected {}", self.expected()));
            fault.hint(format!("{words}, as in `{}`", self.example))
        } else {
            let fault = Fault::new(format!("found {written}, which is out of range"));
            fault.hint(format!("{} {words}", with_article(self.noun)))
        })
    }

    /// Lists the units as a hint; `None` if there are none to choose from.
    fn units_hint(&self) -> Option<String> {
        let units: Vec<&str> = self.dimension.units().into_iter().filter(|u| !u.is_empty()).collect();
        match (units.is_empty() || self.dimension == Dimension::FNumber, self.unit) {
            (true, _) => None,
            (false, "") => Some(format!("units: {}; or a bare number", units.join(", "))),
            (false, bare) => Some(format!("units: {}; a bare number is in {bare}", units.join(", "))),
        }
    }

    fn text_hint(&self, text: &str) -> String {
        let text = text.trim();
        let figure = text.trim_start_matches(['f', 'F', '/', ' ']);
        if self.dimension == Dimension::FNumber && figure.trim_end().parse::<f64>().is_ok() {
            return format!("write `f/{}`", shown(figure));
        }
        if self.infinity && nearest(text, ["infinity"]).is_some() {
            return "did you mean `infinity`?".to_owned();
        }
        format!("write a number with its unit, as in `{}`", self.example)
    }
}

/// Returns a noun with its article, such as `a length`, `an angle`, `an f-number`.
pub(crate) fn with_article(noun: &str) -> String {
    let vowel = noun.starts_with(['a', 'e', 'i', 'o', 'u']) || noun.starts_with("f-");
    format!("{} {noun}", if vowel { "an" } else { "a" })
}

/// Describes a text: as a quantity of some dimension, or as just a text.
pub(crate) fn found_text(text: &str) -> String {
    match Reading::of(text) {
        Reading::Quantity { unit, .. } => with_article(unit.dimension.noun()),
        _ => format!("the text `{}`", shown(text)),
    }
}

/// Returns the usual symbol of a unit that is written out, or written as in another field.
fn usual_symbol(unit: &str) -> Option<&'static str> {
    Some(match unit.to_ascii_lowercase().as_str() {
        "th" | "sec" | "secs" | "second" | "seconds" => "s",
        "minute" | "minutes" => "min",
        "hour" | "hours" => "h",
        "meter" | "meters" | "metre" | "metres" | "mtr" => "m",
        "millimeter" | "millimeters" | "millimetre" | "millimetres" => "mm",
        "nanometer" | "nanometers" | "nanometre" | "nanometres" => "nm",
        "micron" | "microns" => "um",
        "inch" | "inches" | "\"" => "in",
        "foot" | "feet" | "'" => "ft",
        "degree" | "degrees" => "deg",
        "kelvin" => "K",
        "lux" => "lx",
        "nit" | "nits" => "cd/m2",
        _ => return None,
    })
}

/// Deserializes any quantity and checks its bound; the quantity's `Deserialize` calls this.
///
/// # Errors
/// What was found and what is expected.
pub fn deserialize<'de, Q: Quantity, D: Deserializer<'de>>(deserializer: D) -> Result<Q, D::Error> {
    deserializer.deserialize_any(QuantityVisitor(PhantomData))
}

struct QuantityVisitor<Q>(PhantomData<Q>);

impl<Q: Quantity> Visitor<'_> for QuantityVisitor<Q> {
    type Value = Q;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(Q::NOUN)
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<Q, E> {
        // The message for a number is the one for its text.
        if value.is_finite() && Q::BOUND.limits().allow(value) {
            Ok(Q::from_bare(value))
        } else {
            self.visit_str(&value.to_string())
        }
    }

    fn visit_u64<E: Error>(self, value: u64) -> Result<Q, E> {
        self.visit_f64(value as f64)
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<Q, E> {
        self.visit_f64(value as f64)
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<Q, E> {
        Q::from_text(text).map_err(E::custom)
    }
}
