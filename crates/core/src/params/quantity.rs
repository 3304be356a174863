//! How a quantity is read: a bare number in a stated unit, or a text with a unit whose dimension is checked.

use super::node::Number;
use super::text::{found_text, nearest, shown, with_article};
use super::units::{Dimension, Reading, Unit};
use serde::de::{Deserializer, Error, Unexpected, Visitor};
use std::fmt;
use std::marker::PhantomData;

/// Name by which a quantity asks the deserializer of nodes for its text.
pub(super) const QUANTITY: &str = "spectra::quantity";

/// Which signs a quantity may have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bound {
    /// Any.
    Any,
    /// Zero or more.
    NonNegative,
    /// More than zero.
    Positive,
}

impl Bound {
    /// Whether a value satisfies it; NaN never does.
    #[must_use]
    pub fn allows(self, value: f64) -> bool {
        match self {
            Self::Any => !value.is_nan(),
            Self::NonNegative => value >= 0.0,
            Self::Positive => value > 0.0,
        }
    }

    /// The stricter of two.
    #[must_use]
    pub const fn and(self, other: Self) -> Self {
        match (self, other) {
            (Self::Positive, _) | (_, Self::Positive) => Self::Positive,
            (Self::NonNegative, _) | (_, Self::NonNegative) => Self::NonNegative,
            (Self::Any, Self::Any) => Self::Any,
        }
    }

    const fn adjective(self) -> &'static str {
        match self {
            Self::Any => "",
            Self::NonNegative => "non-negative ",
            Self::Positive => "positive ",
        }
    }
}

/// A typed quantity in a scene file. Its constants feed messages, documentation and schemas.
pub trait Quantity: Copy {
    /// What it measures.
    const DIMENSION: Dimension;
    /// What it is called, without an article.
    const NOUN: &'static str = Self::DIMENSION.noun();
    /// The unit of a bare number; empty if it has none.
    const BARE_UNIT: &'static str;
    /// An example of how to write it.
    const EXAMPLE: &'static str;
    /// Which signs it may have.
    const BOUND: Bound = Bound::Any;
    /// Whether it may be infinite (`inf`).
    const INFINITY: bool = false;

    /// From a number in [`Self::BARE_UNIT`] that obeys the bound.
    fn from_bare(value: f64) -> Self;

    /// Its number in [`Self::BARE_UNIT`].
    fn bare(self) -> f64;

    /// From a number in any unit of the dimension.
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
    /// What was found and what is expected, perhaps followed by a line that starts with `hint: `.
    fn from_text(text: &str) -> Result<Self, String> {
        let expected = expected::<Self>();
        match Reading::of(text) {
            Reading::Bare(value) => checked(Self::from_bare(value), text),
            Reading::Quantity { value, unit } if unit.dimension == Self::DIMENSION => {
                checked(Self::from_unit(value, unit), text)
            }
            Reading::Quantity { .. } => {
                Err(format!("found {}, expected {expected}{}", found_text(text), units_hint::<Self>()))
            }
            Reading::Infinity(false) if Self::INFINITY => Ok(Self::from_bare(f64::INFINITY)),
            Reading::Infinity(_) | Reading::NotANumber => {
                Err(format!("found {}, expected {expected}\nhint: write it as in `{}`", shown(text), Self::EXAMPLE))
            }
            Reading::TooLarge => Err(format!(
                "found {}, which is too large; expected {expected}\nhint: write it as in `{}`",
                shown(text),
                Self::EXAMPLE
            )),
            Reading::DecimalComma => Err(format!(
                "found the text `{}`, expected {expected}\nhint: write a decimal point, not a comma",
                shown(text)
            )),
            Reading::UnknownUnit(unit) if unit.starts_with('/') => Err(format!(
                "found {}, expected {expected}\nhint: the denominator must be greater than 0, as in `1/125`",
                shown(text)
            )),
            Reading::UnknownUnit(unit) => {
                let units = Self::DIMENSION.units();
                let usual = usual_symbol(unit).filter(|symbol| units.contains(symbol));
                let hint = match usual.or_else(|| nearest(unit, units.iter().copied())) {
                    Some(near) => format!("\nhint: did you mean `{near}`?"),
                    None => units_hint::<Self>(),
                };
                Err(format!("unknown unit `{}`, expected {expected}{hint}", shown(unit)))
            }
            Reading::Text => {
                Err(format!("found the text `{}`, expected {expected}{}", shown(text), text_hint::<Self>(text)))
            }
        }
    }
}

/// The symbol of a unit that is written out, or as another field writes it.
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

/// The right form in words: `a positive length such as 50 mm`.
#[must_use]
pub fn expected<Q: Quantity>() -> String {
    let noun = format!("{}{}", Q::BOUND.adjective(), Q::NOUN);
    let or_infinity = if Q::INFINITY { " or `inf`" } else { "" };
    format!("{} such as {}{or_infinity}", with_article(&noun), Q::EXAMPLE)
}

/// Lists the units as a hint, on a line of its own.
fn units_hint<Q: Quantity>() -> String {
    let units: Vec<&str> = Q::DIMENSION.units().into_iter().filter(|u| !u.is_empty()).collect();
    match (units.is_empty() || Q::DIMENSION == Dimension::FNumber, Q::BARE_UNIT) {
        (true, _) => String::new(),
        (false, "") => format!("\nhint: units: {}; or a bare number", units.join(", ")),
        (false, bare) => format!("\nhint: units: {}; a bare number is in {bare}", units.join(", ")),
    }
}

fn text_hint<Q: Quantity>(text: &str) -> String {
    let text = text.trim();
    if Q::DIMENSION == Dimension::FNumber
        && text.trim_start_matches(['f', 'F', '/', ' ']).starts_with(|c: char| c.is_ascii_digit())
    {
        let figure = text.trim_start_matches(['f', 'F', '/', ' ']);
        return format!("\nhint: write `f/{}`", shown(figure));
    }
    if Q::INFINITY && nearest(text, ["infinity"]).is_some() {
        return "\nhint: did you mean `infinity`?".to_owned();
    }
    format!("\nhint: write a number with its unit, as in `{}`", Q::EXAMPLE)
}

/// Says which values are allowed, on a line of its own.
fn range_hint<Q: Quantity>() -> String {
    match Q::BOUND {
        Bound::Positive => format!("\nhint: greater than 0, as in `{}`", Q::EXAMPLE),
        Bound::NonNegative => format!("\nhint: 0 or more, as in `{}`", Q::EXAMPLE),
        Bound::Any => String::new(),
    }
}

/// The quantity, if it obeys its bound.
fn checked<Q: Quantity>(quantity: Q, written: &str) -> Result<Q, String> {
    let value = quantity.bare();
    let (allowed, finite) = (Q::BOUND.allows(value), value.is_finite() || Q::INFINITY);
    if allowed && finite {
        Ok(quantity)
    } else {
        let large = if allowed && !finite { ", which is too large" } else { "" };
        let hint =
            if large.is_empty() { range_hint::<Q>() } else { format!("\nhint: write it as in `{}`", Q::EXAMPLE) };
        Err(format!("found {}{large}, expected {}{hint}", shown(written), expected::<Q>()))
    }
}

/// Deserializes any quantity: what its `Deserialize` calls.
///
/// # Errors
/// What was found and what is expected.
pub fn deserialize<'de, Q: Quantity, D: Deserializer<'de>>(deserializer: D) -> Result<Q, D::Error> {
    deserializer.deserialize_newtype_struct(QUANTITY, QuantityVisitor(PhantomData))
}

struct QuantityVisitor<Q>(PhantomData<Q>);

impl<'de, Q: Quantity> Visitor<'de> for QuantityVisitor<Q> {
    type Value = Q;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&expected::<Q>())
    }

    /// Other formats than nodes.
    fn visit_newtype_struct<D: Deserializer<'de>>(self, deserializer: D) -> Result<Q, D::Error> {
        deserializer.deserialize_any(self)
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<Q, E> {
        if value.is_finite() {
            checked(Q::from_bare(value), &value.to_string()).map_err(E::custom)
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

    fn visit_bool<E: Error>(self, value: bool) -> Result<Q, E> {
        Err(E::invalid_type(Unexpected::Bool(value), &self))
    }
}

/// A number without a unit that may not be infinite: the check of every bare float.
pub(super) fn finite(number: &Number) -> Result<f64, String> {
    let text = shown(&number.text);
    if number.value.is_finite() {
        Ok(number.value)
    } else if matches!(Reading::of(&number.text), Reading::TooLarge) {
        Err(format!("found {text}, which is too large; expected {}", expected::<f64>()))
    } else {
        Err(format!("found {text}, expected {}", expected::<f64>()))
    }
}
