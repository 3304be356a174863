//! Spectra written out in one line: `blackbody:5800`, `0.5 * D65 + line:e`.

use spectra_core::params::{Dimension, Reading, Unit};
use spectra_core::spectral::Line;

use crate::by_name::Found;
use crate::emission::Emission;
use crate::error::SpectrumError;
use crate::illuminants::daylight;
use crate::lines::named_line;
use crate::piece::Piece;
use crate::shape::Shape;

/// One of each, for messages.
pub(crate) const EXAMPLES: [&str; 8] = [
    "blackbody:5800",
    "daylight:5500",
    "line:C'",
    "lines:404.66=1,435.84=2",
    "gaussian:550,20",
    "rectangle:500,600",
    "constant:1",
    "constant",
];

/// A single spectrum that is written out; `None` if `text` is none.
pub(crate) fn single(text: &str) -> Option<Result<Piece, SpectrumError>> {
    if text.eq_ignore_ascii_case("constant") {
        return Some(Shape::constant(1.0).map(Piece::Bare));
    }
    if let Some(kelvin) = color_temperature(text) {
        return Some(of_color_temperature(kelvin).map(|light| Piece::Typed(Found::Emission(light))));
    }
    let (head, arguments) = text.split_once(':')?;
    let arguments = arguments.trim();
    let fault = |wanted| SpectrumError::Inline { text: text.chars().take(80).collect(), wanted };
    let kelvin = |help| measure(arguments, "K").ok_or_else(|| fault(help));
    let one = |help| numbers(arguments).and_then(|n| <[f64; 1]>::try_from(n).ok()).ok_or_else(|| fault(help));
    let two = |help| wavelengths(arguments).and_then(|n| <[f64; 2]>::try_from(n).ok()).ok_or_else(|| fault(help));
    let light = |light| Piece::Typed(Found::Emission(light));
    Some(match head.trim().to_ascii_lowercase().as_str() {
        "blackbody" => {
            kelvin("write a temperature in kelvin, such as blackbody:5800").and_then(Emission::blackbody).map(light)
        }
        "daylight" => kelvin("write a temperature in kelvin, such as daylight:5500").and_then(daylight).map(light),
        "line" => line_nm(arguments)
            .ok_or_else(|| fault("write a letter or a wavelength in nm, such as line:C' or line:632.8"))
            .and_then(|nm| Emission::line(nm, 1.0))
            .map(light),
        "lines" => arguments
            .split(',')
            .map(weighted_line)
            .collect::<Option<Vec<_>>>()
            .ok_or_else(|| fault("write wavelengths (or letters) with their powers, such as lines:404.66=1,435.84=2"))
            .and_then(|lines| Emission::new(None, lines))
            .map(light),
        "gaussian" => two("write center and standard deviation in nm, such as gaussian:550,20")
            .and_then(|[center, sigma]| Shape::gaussian(center, sigma))
            .map(Piece::Bare),
        "rectangle" => two("write two wavelengths in nm, such as rectangle:500,600")
            .and_then(|[from, to]| Shape::rectangle(from, to))
            .map(Piece::Bare),
        "constant" => {
            one("write a value, such as constant:0.18").and_then(|[value]| Shape::constant(value)).map(Piece::Bare)
        }
        _ => return None,
    })
}

/// A line by its letter, or a number of nm.
fn line_nm(text: &str) -> Option<f64> {
    let text = text.trim();
    named_line(text).map(|l| l.nominal_nm).or_else(|| measure(text, "nm"))
}

/// The temperature of `5600 K`.
fn color_temperature(text: &str) -> Option<f64> {
    match Reading::of(text) {
        Reading::Quantity { value, unit } if unit.dimension == Dimension::Temperature => Some(value),
        _ => None,
    }
}

/// The light that a color temperature alone stands for: a black body below 5000 K, CIE daylight from there on, as CIE
/// 13.3-1995 (5.3) chooses the reference of a lamp.
fn of_color_temperature(kelvin: f64) -> Result<Emission, SpectrumError> {
    if kelvin < 5000.0 { Emission::blackbody(kelvin) } else { daylight(kelvin) }
}

/// A number with or without its unit, in that unit.
fn measure(text: &str, unit: &str) -> Option<f64> {
    let wanted = Unit::find(unit)?;
    let value = match Reading::of(text) {
        Reading::Bare(value) => value,
        Reading::Quantity { value, unit } if unit.dimension == wanted.dimension => unit.convert(value, wanted),
        _ => return None,
    };
    value.is_finite().then_some(value)
}

/// Wavelengths with or without their unit, nm.
fn wavelengths(text: &str) -> Option<Vec<f64>> {
    text.split(',').map(|text| measure(text, "nm")).collect()
}

fn weighted_line(text: &str) -> Option<Line> {
    let (nm, power) = match text.split_once('=') {
        Some((nm, power)) => (nm, number(power)?),
        None => (text, 1.0),
    };
    Some(Line { wavelength_nm: line_nm(nm)?, power })
}

fn number(text: &str) -> Option<f64> {
    text.trim().parse().ok().filter(|v: &f64| v.is_finite())
}

fn numbers(text: &str) -> Option<Vec<f64>> {
    text.split(',').map(number).collect()
}

/// A factor of a product: a number, or what has a name.
pub(crate) enum Factor<'a> {
    Number(f64),
    Named(&'a str),
}

/// The products of a sum, each by its factors; `None` where neither ` + ` nor ` * ` is written, with their spaces.
pub(crate) fn sum_of_products(text: &str) -> Option<Vec<Vec<Factor<'_>>>> {
    if !(text.contains(" + ") || text.contains(" * ")) {
        return None;
    }
    Some(text.split(" + ").map(|product| product.split(" * ").map(as_factor).collect()).collect())
}

fn as_factor(text: &str) -> Factor<'_> {
    let text = text.trim();
    number(text).map_or(Factor::Named(text), Factor::Number)
}
