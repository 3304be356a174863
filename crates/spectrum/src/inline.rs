//! Spectra written out in one line: `blackbody:5800`, `line:e`, `FdC`.

use spectra_core::params::{Dimension, Reading, Unit};
use spectra_core::registry::inventory;
use spectra_core::spectral::Line;

use crate::emission::Emission;
use crate::error::SpectrumError;
use crate::illuminants::daylight;
use crate::lines::{line_set, named_line};
use crate::meta::Kind;
use crate::pending_spectrum::PendingSpectrum;
use crate::spectral_function::SpectralFunction;

/// A form in which a spectrum is written out in one line; see [`expression!`](crate::expression).
pub struct Expression {
    example: &'static str,
    wanted: &'static str,
    read: Read,
}

/// Function that reads the part after the `:` as a spectrum; `None` if it is not understood.
#[derive(Clone, Copy)]
enum Read {
    Plain(fn(&str) -> Option<Result<PendingSpectrum, SpectrumError>>),
    /// Function that is also told which kind of spectrum is wanted.
    Wanted(fn(&str, Kind) -> Option<Result<PendingSpectrum, SpectrumError>>),
}

impl Expression {
    /// Creates a form; see [`expression!`](crate::expression).
    #[must_use]
    pub const fn new(
        example: &'static str,
        wanted: &'static str,
        read: fn(&str) -> Option<Result<PendingSpectrum, SpectrumError>>,
    ) -> Self {
        Self { example, wanted, read: Read::Plain(read) }
    }

    /// Creates a form that means one spectrum as a light and another as a surface, as a color does.
    #[must_use]
    pub const fn of_wanted(
        example: &'static str,
        wanted: &'static str,
        read: fn(&str, Kind) -> Option<Result<PendingSpectrum, SpectrumError>>,
    ) -> Self {
        Self { example, wanted, read: Read::Wanted(read) }
    }

    fn head(&self) -> &'static str {
        self.example.split_once(':').map_or(self.example, |(head, _)| head)
    }
}

inventory::collect!(Expression);

/// Registers a form in which a spectrum is written out in one line. The first argument is an example such as `gaussian:550,20`,
/// whose first word names the form. The second is a hint that says how to write it. The third is a function that reads the part
/// after the `:` and returns `None` if it does not understand it.
#[macro_export]
macro_rules! expression {
    ($example:literal, $wanted:literal, $read:expr $(,)?) => {
        $crate::inventory::submit! { $crate::Expression::new($example, $wanted, $read) }
    };
}

/// Registers a form like [`expression!`](crate::expression), whose function is also told which [`Kind`](crate::Kind) is wanted: a
/// color is one spectrum as a light and another as a surface. An example without `:` is a name; the function then gets an empty
/// text.
#[macro_export]
macro_rules! expression_of_wanted {
    ($example:literal, $wanted:literal, $read:expr $(,)?) => {
        $crate::inventory::submit! { $crate::Expression::of_wanted($example, $wanted, $read) }
    };
}

/// Returns one example of each form, sorted, for messages.
pub(crate) fn examples() -> Vec<&'static str> {
    let all = inventory::iter::<Expression>.into_iter().map(|expression| expression.example);
    let mut all: Vec<&str> = all.chain(["constant"]).collect();
    all.sort_unstable();
    all
}

/// Reads a single spectrum that is written out; `None` if `text` is not one.
pub(crate) fn single(text: &str, wanted: Kind) -> Option<Result<PendingSpectrum, SpectrumError>> {
    if text.eq_ignore_ascii_case("constant") {
        return Some(SpectralFunction::constant(1.0).map(PendingSpectrum::Bare));
    }
    if let Some(kelvin) = color_temperature(text) {
        return Some(of_color_temperature(kelvin).map(PendingSpectrum::from));
    }
    if let Some(lines) = line_set(text) {
        let lines = lines.map(|line| Line { wavelength_nm: line.nominal_nm, power: 1.0 });
        return Some(Emission::new(None, lines.to_vec()).map(PendingSpectrum::from));
    }
    let (head, arguments) = match text.split_once(':') {
        Some((head, arguments)) => (head.trim(), Some(arguments.trim())),
        None => (text, None),
    };
    let mut all = inventory::iter::<Expression>.into_iter();
    let found = all.find(|expression| {
        expression.example.contains(':') == arguments.is_some() && expression.head().eq_ignore_ascii_case(head)
    })?;
    let fault = || SpectrumError::Inline { text: text.chars().take(80).collect(), wanted: found.wanted };
    let arguments = arguments.unwrap_or("");
    let read = match found.read {
        Read::Plain(read) => read(arguments),
        Read::Wanted(read) => read(arguments, wanted),
    };
    Some(read.unwrap_or_else(|| Err(fault())))
}

/// Reads a line by its letter, or a number of nm.
pub(crate) fn line_nm(text: &str) -> Option<f64> {
    let text = text.trim();
    named_line(text).map(|l| l.nominal_nm).or_else(|| measure(text, "nm"))
}

/// Reads the temperature (in K) of a text such as `5600 K`.
fn color_temperature(text: &str) -> Option<f64> {
    match Reading::of(text) {
        Reading::Quantity { value, unit } if unit.dimension == Dimension::Temperature => Some(value),
        _ => None,
    }
}

/// Returns the light that a color temperature alone stands for: a black body below 5000 K, CIE daylight from there on, as CIE
/// 13.3-1995 (5.3) chooses the reference of a lamp.
fn of_color_temperature(kelvin: f64) -> Result<Emission, SpectrumError> {
    if kelvin < 5000.0 { Emission::blackbody(kelvin) } else { daylight(kelvin) }
}

/// Reads a number with or without its unit, and returns it in `unit`.
pub(crate) fn measure(text: &str, unit: &str) -> Option<f64> {
    let wanted = Unit::find(unit)?;
    let value = match Reading::of(text) {
        Reading::Bare(value) => value,
        Reading::Quantity { value, unit } if unit.dimension == wanted.dimension => unit.convert(value, wanted),
        _ => return None,
    };
    value.is_finite().then_some(value)
}

/// Reads wavelengths with or without their unit, and returns them in nm.
pub(crate) fn wavelengths(text: &str) -> Option<Vec<f64>> {
    text.split(',').map(|text| measure(text, "nm")).collect()
}

pub(crate) fn number(text: &str) -> Option<f64> {
    text.trim().parse().ok().filter(|v: &f64| v.is_finite())
}

pub(crate) fn numbers(text: &str) -> Option<Vec<f64>> {
    text.split(',').map(number).collect()
}
