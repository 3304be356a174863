//! Units, and texts that contain a unit: `50 mm`, `1/125 s`, `f/2.8`, `50 %`.
//!
//! Factors are exact by definition: prefixes and the units of time and angle from the SI Brochure (9th edition, 2019, tables 7
//! and 8), inch and foot from the international yard and pound agreement of 1959.

use std::borrow::Cow;

/// The kind of quantity that a unit measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Dimension {
    /// A number without a unit.
    Number,
    /// A fraction of a whole, in per cent or as a number.
    Ratio,
    /// Length, including wavelength.
    Length,
    /// Time.
    Time,
    /// Plane angle.
    Angle,
    /// Thermodynamic or color temperature.
    Temperature,
    /// Luminance.
    Luminance,
    /// Illuminance.
    Illuminance,
    /// Photometric exposure: illuminance times time.
    Exposure,
    /// Radiant flux.
    Power,
    /// Radiant intensity.
    RadiantIntensity,
    /// Luminous flux; known only so that messages can name it.
    LuminousFlux,
    /// Luminous intensity; known only so that messages can name it.
    LuminousIntensity,
    /// Spatial frequency: cycles, line pairs or grooves per length.
    SpatialFrequency,
    /// Frequency; known only so that messages can name it.
    Frequency,
    /// Focal length over the diameter of the entrance pupil.
    FNumber,
}

impl Dimension {
    /// Name of the dimension, without an article.
    #[must_use]
    pub const fn noun(self) -> &'static str {
        match self {
            Self::Number => "number",
            Self::Ratio => "ratio",
            Self::Length => "length",
            Self::Time => "time",
            Self::Angle => "angle",
            Self::Temperature => "temperature",
            Self::Luminance => "luminance",
            Self::Illuminance => "illuminance",
            Self::Exposure => "exposure",
            Self::Power => "power",
            Self::RadiantIntensity => "radiant intensity",
            Self::LuminousFlux => "luminous flux",
            Self::LuminousIntensity => "luminous intensity",
            Self::SpatialFrequency => "spatial frequency",
            Self::Frequency => "frequency",
            Self::FNumber => "f-number",
        }
    }

    /// Preferred spellings of all units of this dimension.
    #[must_use]
    pub fn units(self) -> Vec<&'static str> {
        UNITS.iter().filter(|u| u.dimension == self).map(|u| u.symbols[0]).collect()
    }
}

/// A unit of measurement with its spellings.
#[derive(Debug, PartialEq)]
pub struct Unit {
    /// Spellings of the unit; messages use the first.
    pub symbols: &'static [&'static str],
    /// Dimension that the unit measures.
    pub dimension: Dimension,
    /// Size of the unit relative to a reference of its dimension, chosen to make sizes whole numbers.
    size: f64,
}

impl Unit {
    const fn new(symbols: &'static [&'static str], dimension: Dimension, size: f64) -> Self {
        Self { symbols, dimension, size }
    }

    /// Finds the unit with this spelling (`µ` and `μ` are read as `u`, superscripts as digits, a raised dot as a space).
    #[must_use]
    pub fn find(spelling: &str) -> Option<&'static Self> {
        let spelling = normal_spelling(spelling);
        UNITS.iter().find(|u| u.symbols.contains(&spelling.as_ref()))
    }

    /// Converts `value` of this unit to `other`; both must have the same dimension. Divides instead of multiplying by a rounded
    /// inverse, so that `550 nm` is 550 nm and `5 um` is the f64 nearest to 0.005 mm.
    #[must_use]
    pub fn convert(&self, value: f64, other: &Self) -> f64 {
        if self.size >= other.size { value * (self.size / other.size) } else { value / (other.size / self.size) }
    }
}

use Dimension as D;

pub(super) static UNITS: &[Unit] = &[
    // Reference: nanometer.
    Unit::new(&["nm"], D::Length, 1.0),
    Unit::new(&["um", "micron", "microns"], D::Length, 1e3),
    Unit::new(&["mm"], D::Length, 1e6),
    Unit::new(&["cm"], D::Length, 1e7),
    Unit::new(&["m"], D::Length, 1e9),
    Unit::new(&["km"], D::Length, 1e12),
    Unit::new(&["in", "inch", "inches"], D::Length, 25.4e6),
    Unit::new(&["ft", "foot", "feet"], D::Length, 304.8e6),
    // Reference: microsecond.
    Unit::new(&["us"], D::Time, 1.0),
    Unit::new(&["ms"], D::Time, 1e3),
    Unit::new(&["s", "sec"], D::Time, 1e6),
    Unit::new(&["min"], D::Time, 60e6),
    Unit::new(&["h"], D::Time, 3600e6),
    // Reference: second of arc; radians are converted by `Angle` itself.
    Unit::new(&["deg", "°", "degree", "degrees"], D::Angle, 3600.0),
    Unit::new(&["arcmin"], D::Angle, 60.0),
    Unit::new(&["arcsec"], D::Angle, 1.0),
    Unit::new(&["rad"], D::Angle, 648_000.0 / std::f64::consts::PI),
    Unit::new(&["mrad"], D::Angle, 648.0 / std::f64::consts::PI),
    Unit::new(&["K"], D::Temperature, 1.0),
    Unit::new(&["cd/m2", "cd/m^2", "nit", "nits", "nt"], D::Luminance, 1.0),
    Unit::new(&["lx", "lux", "lm/m2", "lm/m^2"], D::Illuminance, 1.0),
    Unit::new(&["klx"], D::Illuminance, 1e3),
    Unit::new(&["lx s", "lux s", "lx*s", "lux*s", "lxs"], D::Exposure, 1.0),
    // Reference: microwatt.
    Unit::new(&["uW"], D::Power, 1.0),
    Unit::new(&["mW"], D::Power, 1e3),
    Unit::new(&["W"], D::Power, 1e6),
    Unit::new(&["kW"], D::Power, 1e9),
    // Reference: microwatt per steradian.
    Unit::new(&["uW/sr"], D::RadiantIntensity, 1.0),
    Unit::new(&["mW/sr"], D::RadiantIntensity, 1e3),
    Unit::new(&["W/sr"], D::RadiantIntensity, 1e6),
    Unit::new(&["lm"], D::LuminousFlux, 1.0),
    Unit::new(&["cd"], D::LuminousIntensity, 1.0),
    Unit::new(&["1/mm", "/mm", "lp/mm", "cycles/mm", "lines/mm", "l/mm"], D::SpatialFrequency, 1.0),
    Unit::new(&["Hz"], D::Frequency, 1.0),
    Unit::new(&["kHz"], D::Frequency, 1e3),
    // Reference: per cent.
    Unit::new(&["%"], D::Ratio, 1.0),
    Unit::new(&[""], D::Ratio, 100.0),
    // Written in front: `f/2.8`.
    Unit::new(&["f/"], D::FNumber, 1.0),
];

/// Replaces characters that can be written in several ways by one spelling.
fn normal_spelling(text: &str) -> Cow<'_, str> {
    let text = text.trim();
    if text.is_ascii() && !text.contains("  ") && !text.contains('\t') {
        return Cow::Borrowed(text);
    }
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '\u{b5}' | '\u{3bc}' => out.push('u'),
            '\u{b2}' => out.push('2'),
            '\u{b7}' | '\u{22c5}' => out.push(' '),
            c if c.is_whitespace() => out.push(' '),
            c => out.push(c),
        }
    }
    Cow::Owned(out.split(' ').filter(|word| !word.is_empty()).collect::<Vec<_>>().join(" "))
}

/// Result of reading a text as a quantity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reading<'a> {
    /// A number without a unit.
    Bare(f64),
    /// A number with a unit.
    Quantity {
        /// Number in the unit that was written.
        value: f64,
        /// Unit that was written after the number.
        unit: &'static Unit,
    },
    /// A number with an unknown unit.
    UnknownUnit(&'a str),
    /// `inf`, `.inf`, `infinity` or the infinity sign; true if negative.
    Infinity(bool),
    /// `nan`.
    NotANumber,
    /// A number beyond the range of an f64.
    TooLarge,
    /// A number with a decimal comma.
    DecimalComma,
    /// Any other text.
    Text,
}

impl<'a> Reading<'a> {
    /// Reads a text as a quantity. A text that is too long for one is plain text.
    #[must_use]
    pub fn of(text: &'a str) -> Self {
        /// Length of the longest f64 when written out, with a unit.
        const LONGEST: usize = 1200;
        let text = text.trim();
        if text.len() > LONGEST {
            return Self::Text;
        }
        let lower = text.to_ascii_lowercase();
        match lower.trim_start_matches(['+', '-', '.']) {
            "inf" | "infinity" | "\u{221e}" => return Self::Infinity(text.starts_with('-')),
            "nan" => return Self::NotANumber,
            _ => {}
        }
        if let Some(rest) = text.strip_prefix("f/") {
            return match number(rest) {
                Some((value, "")) if value.is_finite() => match Unit::find("f/") {
                    Some(unit) => Self::Quantity { value, unit },
                    None => Self::Text,
                },
                _ => Self::Text,
            };
        }
        let Some((mut value, mut rest)) = number(text) else { return Self::Text };
        if let Some(after) = rest.trim_start().strip_prefix('/')
            && let Some((below, after)) = number(after.trim_start())
            && below > 0.0
        {
            value /= below;
            rest = after;
        }
        if !value.is_finite() {
            return Self::TooLarge;
        }
        let unit = rest.trim();
        if unit.is_empty() {
            return Self::Bare(value);
        }
        if unit.strip_prefix(',').is_some_and(|after| after.starts_with(|c: char| c.is_ascii_digit())) {
            return Self::DecimalComma;
        }
        match Unit::find(unit) {
            Some(unit) => Self::Quantity { value, unit },
            // `50mm-lens` and `2020-01-01` are texts; `50 mn` is a quantity with a slip in it.
            None if unit.len() > 12 || unit.starts_with(['-', '.', ':', '+']) || unit.contains(char::is_control) => {
                Self::Text
            }
            None => Self::UnknownUnit(unit),
        }
    }
}

/// Reads the decimal number at the start of a text; also returns the rest of the text.
fn number(text: &str) -> Option<(f64, &str)> {
    let unsigned = text.strip_prefix(['+', '-']).unwrap_or(text);
    let end = decimal_end(unsigned)?;
    let end = text.len() - unsigned.len() + end;
    Some((text[..end].parse().ok()?, &text[end..]))
}

/// Returns where the decimal number at the start of `text` (without a sign) ends, in bytes; `None` if there is no number.
pub(crate) fn decimal_end(text: &str) -> Option<usize> {
    let bytes = text.as_bytes();
    let digits = |from: usize| bytes[from..].iter().take_while(|b| b.is_ascii_digit()).count();
    let whole = digits(0);
    let mut end = whole;
    if bytes.get(end) == Some(&b'.') {
        let fraction = digits(end + 1);
        if whole + fraction == 0 {
            return None;
        }
        end += 1 + fraction;
    } else if whole == 0 {
        return None;
    }
    if matches!(bytes.get(end), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
        let exponent = digits(end + 1 + sign);
        if exponent > 0 {
            end += 1 + sign + exponent;
        }
    }
    Some(end)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Option<(f64, &'static str)> {
        match Reading::of(text) {
            Reading::Quantity { value, unit } => Some((value, unit.symbols[0])),
            _ => None,
        }
    }

    #[test]
    fn numbers_with_units_are_read() {
        for (text, value, unit) in [
            ("50 mm", 50.0, "mm"),
            ("50mm", 50.0, "mm"),
            ("-1.5e1 cm", -15.0, "cm"),
            ("1/125 s", 0.008, "s"),
            ("1 / 125 s", 0.008, "s"),
            ("f/2.8", 2.8, "f/"),
            ("50 %", 50.0, "%"),
            ("50%", 50.0, "%"),
            ("300 cd/m2", 300.0, "cd/m2"),
            ("300 cd/m\u{b2}", 300.0, "cd/m2"),
            ("3 \u{b5}m", 3.0, "um"),
            ("3 \u{3bc}m", 3.0, "um"),
            ("0.1 lx\u{b7}s", 0.1, "lx s"),
            ("0.1 lx  s", 0.1, "lx s"),
            ("45\u{b0}", 45.0, "deg"),
            ("600 lines/mm", 600.0, "1/mm"),
            ("600 1/mm", 600.0, "1/mm"),
            (".5 m", 0.5, "m"),
            ("5. m", 5.0, "m"),
            ("\u{a0}5\u{a0}m", 5.0, "m"),
        ] {
            assert_eq!(read(text), Some((value, unit)), "{text}");
        }
    }

    #[test]
    fn other_texts_are_told_apart() {
        for (text, reading) in [
            ("1/125", Reading::Bare(0.008)),
            ("-7", Reading::Bare(-7.0)),
            ("inf", Reading::Infinity(false)),
            (".inf", Reading::Infinity(false)),
            ("-Infinity", Reading::Infinity(true)),
            ("\u{221e}", Reading::Infinity(false)),
            (".nan", Reading::NotANumber),
            ("1e999 mm", Reading::TooLarge),
            ("2,8", Reading::DecimalComma),
            ("50 mn", Reading::UnknownUnit("mn")),
            ("5 MM", Reading::UnknownUnit("MM")),
            ("1/0 s", Reading::UnknownUnit("/0 s")),
            ("N-BK7", Reading::Text),
            ("f/x", Reading::Text),
            ("f/", Reading::Text),
            ("", Reading::Text),
            ("-", Reading::Text),
            (".", Reading::Text),
            ("2020-01-01", Reading::Text),
            ("16:9", Reading::Text),
        ] {
            assert_eq!(Reading::of(text), reading, "{text}");
        }
    }

    #[test]
    fn spellings_are_unique() {
        let mut all: Vec<&str> = UNITS.iter().flat_map(|u| u.symbols).copied().collect();
        let count = all.len();
        all.sort_unstable();
        all.dedup();
        assert_eq!(all.len(), count);
    }

    #[test]
    fn conversion_is_correctly_rounded() {
        let convert =
            |value: f64, from: &str, to: &str| Unit::find(from).unwrap().convert(value, Unit::find(to).unwrap());
        for (value, from, to, expected) in [
            (5.0, "um", "mm", 0.005),
            (550.0, "nm", "mm", 0.000_55),
            (1.0, "in", "mm", 25.4),
            (2.0, "m", "mm", 2000.0),
            (1.0, "ft", "in", 12.0),
            (0.55, "um", "nm", 550.0),
            (20.0, "ms", "s", 0.02),
            (2.0, "min", "s", 120.0),
            (50.0, "%", "", 0.5),
            (18.0, "%", "", 0.18),
            (3.0, "mW", "W", 0.003),
        ] {
            assert_eq!(convert(value, from, to).to_bits(), f64::to_bits(expected), "{value} {from} in {to}");
        }
    }
}
