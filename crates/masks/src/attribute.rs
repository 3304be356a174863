//! Parses values of SVG attributes.

use std::str::FromStr;
use svgtypes::LengthUnit;

/// Returns the first 40 characters of a user's text, for a message.
pub(super) fn shortened(text: &str) -> String {
    text.chars().take(40).collect()
}

/// Parses a length: returns its number, and the mm per unit if the unit is an absolute one (mm, cm, in, pt, pc). `None` for a percentage,
/// for em or ex, and for an invalid text.
pub(super) fn length(text: &str) -> Option<(f64, Option<f64>)> {
    let parsed = svgtypes::Length::from_str(text.trim()).ok()?;
    let mm = match parsed.unit {
        LengthUnit::Mm => Some(1.0),
        LengthUnit::Cm => Some(10.0),
        LengthUnit::In => Some(25.4),
        LengthUnit::Pt => Some(25.4 / 72.0),
        LengthUnit::Pc => Some(25.4 / 6.0),
        LengthUnit::None | LengthUnit::Px => None,
        LengthUnit::Em | LengthUnit::Ex | LengthUnit::Percent => return None,
    };
    Some((parsed.number, mm))
}

/// Parses a length and returns it in user units, 96 to the inch.
pub(super) fn plain_length(text: &str) -> Result<f64, String> {
    let found = length(text).map(|(number, mm)| mm.map_or(number, |mm| number * mm * 96.0 / 25.4));
    found.filter(|v| v.is_finite()).ok_or_else(|| format!("not a length: `{}`", shortened(text)))
}
