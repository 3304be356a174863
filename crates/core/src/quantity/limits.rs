//! Limits of a number, as a schema states them.

use serde_json::Value;

/// Limits of a number: the keywords `minimum`, `exclusiveMinimum`, `maximum` and `exclusiveMaximum` of JSON Schema.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Limits {
    /// Lower limit, and whether the limit itself is allowed.
    least: Option<(f64, bool)>,
    /// Upper limit, and whether the limit itself is allowed.
    most: Option<(f64, bool)>,
}

impl Limits {
    pub(crate) const ANY: Self = Self { least: None, most: None };
    pub(crate) const NOT_NEGATIVE: Self = Self { least: Some((0.0, true)), most: None };
    pub(crate) const POSITIVE: Self = Self { least: Some((0.0, false)), most: None };

    pub(crate) fn of(schema: &Value) -> Self {
        let number = |key: &str, included| Some((schema.get(key)?.as_f64()?, included));
        let stricter = |one: Option<(f64, bool)>, other: Option<(f64, bool)>, sign: f64| match (one, other) {
            (Some(a), Some(b)) => Some(if a.0 * sign > b.0 * sign { a } else { b }),
            (one, other) => one.or(other),
        };
        Self {
            least: stricter(number("minimum", true), number("exclusiveMinimum", false), 1.0),
            most: stricter(number("maximum", true), number("exclusiveMaximum", false), -1.0),
        }
    }

    /// Returns whether a value is within the limits; NaN never is.
    pub(crate) fn allow(self, value: f64) -> bool {
        let above = self.least.is_none_or(|(least, included)| value > least || (included && value == least));
        let below = self.most.is_none_or(|(most, included)| value < most || (included && value == most));
        above && below && !value.is_nan()
    }

    /// Returns `positive `, `non-negative ` or nothing.
    pub(crate) fn adjective(self) -> &'static str {
        match self.least {
            Some((least, included)) if least > 0.0 || (least == 0.0 && !included) => "positive ",
            Some((0.0, _)) => "non-negative ",
            _ => "",
        }
    }

    /// Returns whether a value has the wrong sign for these limits; the adjective then says what is wrong.
    pub(crate) fn sign_is_wrong(self, value: f64) -> bool {
        !self.adjective().is_empty() && value <= 0.0
    }

    /// Describes the limits: `from 1 mm to 5 mm`, `0 or more`, with a unit after each number (or before it, if the unit ends in `/`).
    pub(crate) fn words(self, unit: &str) -> String {
        let number = |value: f64| match unit {
            _ if value == 0.0 || unit.is_empty() => format!("{value}"),
            unit if unit.ends_with('/') => format!("{unit}{value}"),
            unit => format!("{value} {unit}"),
        };
        match (self.least.map(|(v, i)| (number(v), i)), self.most.map(|(v, i)| (number(v), i))) {
            (Some((least, true)), Some((most, true))) if least == most => format!("{least} only"),
            (Some((least, true)), Some((most, true))) => format!("from {least} to {most}"),
            (Some((least, true)), Some((most, false))) => format!("from {least} to below {most}"),
            (Some((least, false)), Some((most, true))) => format!("greater than {least}, up to {most}"),
            (Some((least, false)), Some((most, false))) => format!("greater than {least} and below {most}"),
            (Some((least, true)), None) => format!("{least} or more"),
            (Some((least, false)), None) => format!("greater than {least}"),
            (None, Some((most, true))) => format!("up to {most}"),
            (None, Some((most, false))) => format!("below {most}"),
            (None, None) => "any".to_owned(),
        }
    }
}
