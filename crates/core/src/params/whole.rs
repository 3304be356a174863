//! Whole numbers, read from their digits, because an f64 would silently change those above 2^53.

use super::fault::Fault;
use crate::quantity::decimal_end;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{Deserializer, Error};
use serde::{Deserialize, Serialize, Serializer};
use std::borrow::Cow;

/// A whole number from `MIN` to `MAX`, both included: `16`, `2e6`, `0x10`. Exact up to 2^64 - 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Whole<const MIN: u64, const MAX: u64>(u64);

impl<const MIN: u64, const MAX: u64> Whole<MIN, MAX> {
    /// Returns the number, or `None` outside the range.
    #[must_use]
    pub const fn new(value: u64) -> Option<Self> {
        if MIN <= value && value <= MAX { Some(Self(value)) } else { None }
    }

    /// Creates a number that is known at compile time.
    ///
    /// # Panics
    /// If the number is outside the range.
    #[must_use]
    pub const fn known(value: u64) -> Self {
        assert!(MIN <= value && value <= MAX, "outside of the range");
        Self(value)
    }

    /// Returns the number as 64 bits.
    #[must_use]
    pub const fn get(self) -> u64 {
        self.0
    }

    /// Returns the number as a `usize`, clamped to the largest one that the machine has.
    #[must_use]
    pub fn size(self) -> usize {
        usize::try_from(self.0).unwrap_or(usize::MAX)
    }

    /// Returns the number as 32 bits.
    #[must_use]
    pub const fn get_u32(self) -> u32 {
        const { assert!(MAX <= u32::MAX as u64, "the range exceeds 32 bits") };
        self.0 as u32
    }
}

/// Result of reading a spelling as a whole number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Exact {
    /// The spelling is this number.
    Is(i128),
    /// The number is too large for 128 bits.
    Beyond,
    /// The spelling has a fraction or is not a number.
    Not,
}

impl Exact {
    /// Reads the spelling of a number by the core schema of YAML: digits are read exactly, and `2.5e3` is 2500.
    pub(super) fn of(text: &str) -> Self {
        for (prefix, radix) in [("0x", 16), ("0o", 8)] {
            if let Some(digits) = text.strip_prefix(prefix) {
                return match i128::from_str_radix(digits, radix) {
                    Ok(value) => Self::Is(value),
                    Err(_) if !digits.is_empty() && digits.chars().all(|c| c.is_digit(radix)) => Self::Beyond,
                    Err(_) => Self::Not,
                };
            }
        }
        let unsigned = text.strip_prefix(['+', '-']).unwrap_or(text);
        if decimal_end(unsigned) != Some(unsigned.len()) {
            return Self::Not;
        }
        let (figure, exponent) = unsigned.split_once(['e', 'E']).unwrap_or((unsigned, "0"));
        let (whole, fraction) = figure.split_once('.').unwrap_or((figure, ""));
        let digits = format!("{whole}{fraction}");
        let kept = digits.trim_end_matches('0');
        // The value is `significant` times ten to the power of `zeros`.
        let significant = kept.trim_start_matches('0');
        if significant.is_empty() {
            return Self::Is(0);
        }
        // An exponent that i64 cannot hold exceeds all digits that a file can have.
        let beyond = if exponent.starts_with('-') { i64::MIN / 2 } else { i64::MAX / 2 };
        let zeros = exponent.parse::<i64>().unwrap_or(beyond).clamp(i64::MIN / 2, i64::MAX / 2)
            + (digits.len() - kept.len()) as i64
            - fraction.len() as i64;
        if zeros < 0 {
            return Self::Not;
        }
        let value = u32::try_from(zeros).ok().and_then(|zeros| 10_i128.checked_pow(zeros)).and_then(|power| {
            let value = significant.parse::<i128>().ok()?.checked_mul(power)?;
            Some(if text.starts_with('-') { -value } else { value })
        });
        value.map_or(Self::Beyond, Self::Is)
    }
}

impl<'de, const MIN: u64, const MAX: u64> Deserialize<'de> for Whole<MIN, MAX> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let value = u64::deserialize(deserializer)?;
        Self::new(value).ok_or_else(|| {
            let fault = Fault::new(format!("found {value}, which is out of range"));
            D::Error::custom(fault.hint(format!("a whole number from {MIN} to {MAX}")))
        })
    }
}

impl<const MIN: u64, const MAX: u64> Serialize for Whole<MIN, MAX> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_u64(self.0)
    }
}

impl<const MIN: u64, const MAX: u64> JsonSchema for Whole<MIN, MAX> {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        format!("Whole_{MIN}_{MAX}").into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let mut schema = json_schema!({"type": "integer", "minimum": MIN});
        // Nobody has to know the full range of 64 bits.
        if MAX < u64::MAX {
            schema.insert("maximum".to_owned(), MAX.into());
        }
        schema
    }
}

/// Returns the limits of a schema of whole numbers.
pub(super) fn limits_of(schema: &serde_json::Value) -> (i128, i128) {
    let bits =
        schema.get("format").and_then(|format| format.as_str()?.trim_start_matches(['u', 'i', 'n', 't']).parse().ok());
    let stated = |key: &str| schema.get(key).and_then(|v| v.as_i64().map(i128::from).or(v.as_u64().map(i128::from)));
    let least = stated("minimum").unwrap_or(i64::MIN.into());
    let highest = if least < 0 { i64::MAX.into() } else { u64::MAX.into() };
    let of_type = bits.map_or(highest, |bits: u32| (1_i128 << (bits.min(64) - u32::from(least < 0))) - 1);
    (least, stated("maximum").unwrap_or(of_type).min(of_type))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_are_taken_as_they_are() {
        for (text, value) in [
            ("9007199254740993", 9_007_199_254_740_993),
            ("18446744073709551615", u64::MAX.into()),
            ("18446744073709551616", 1_i128 << 64),
            ("-1", -1),
            ("+7", 7),
            ("2e6", 2_000_000),
            ("2.5e3", 2500),
            ("1.50e+1", 15),
            ("1e18", 1_000_000_000_000_000_000),
            ("1800e-2", 18),
            ("16.000", 16),
            ("-0.0", 0),
            ("0e99999999999999999999", 0),
            ("0x10", 16),
            ("0o17", 15),
        ] {
            assert_eq!(Exact::of(text), Exact::Is(value), "{text}");
        }
        for text in ["1e300", "-1e39", "1e99999999999999999999", "0xffffffffffffffffffffffffffffffffff"] {
            assert_eq!(Exact::of(text), Exact::Beyond, "{text}");
        }
        for text in ["1.5", "1e-1", "1e-99999999999999999999", "x", "", ".inf", ".nan", "0x", "1e", "1 2"] {
            assert_eq!(Exact::of(text), Exact::Not, "{text}");
        }
    }
}
