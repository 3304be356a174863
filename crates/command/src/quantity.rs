//! Arguments with units, read as a scene reads them.

use spectra_core::params::{Quantity, Wavelength};
use spectra_core::quantity::light_nm;

/// Reads an argument such as `2m`, `f/2` or `30s`.
///
/// # Errors
/// What was found and what is expected, on one line.
pub(crate) fn parse<Q: Quantity>(text: &str) -> Result<Q, String> {
    Q::from_text(text).map_err(|message| match message.split_once("\nhint: ") {
        Some((message, hint)) => format!("{message} ({hint})"),
        None => message,
    })
}

/// A wavelength of light, in nm if bare.
///
/// # Errors
/// As [`parse`], and what is too short for light: it was given in micrometers.
pub(crate) fn wavelength(text: &str) -> Result<Wavelength, String> {
    let wavelength = parse::<Wavelength>(text)?;
    light_nm(wavelength.nm()).map_err(|wrong| format!("{wrong} ({})", wrong.hint()))?;
    Ok(wavelength)
}

/// A part in percent; a bare number might be meant as either.
pub(crate) fn percent(text: &str) -> Result<String, String> {
    match text.trim().parse::<f64>() {
        // Without what a product has behind the digits that were written: 57, not 56.99999999999999.
        Ok(number) => {
            let percent = (1e10 * number).round() / 1e8;
            match number {
                1.0.. => Err(format!("percent? Write `{number}%`")),
                n if n > 0.0 => Err(format!("percent or a part? Write `{number}%` or `{percent}%`")),
                // What is wrong with it is told where it is read.
                _ => Ok(text.to_owned()),
            }
        }
        Err(_) => Ok(text.to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wavelength_in_micrometers_is_told() {
        let wrong = "a wavelength of 0.5876 nm is too short for light (0.5876 um is 587.6 nm: write 587.6)";
        assert_eq!(wavelength("0.5876"), Err(wrong.to_owned()));
        assert_eq!(wavelength("587.6"), Ok(Wavelength::from_nm(587.6)));
        assert_eq!(wavelength("0.5 um"), Ok(Wavelength::from_nm(500.0)));
    }

    #[test]
    fn a_bare_number_is_no_percentage() {
        assert_eq!(percent("0.5%"), Ok("0.5%".to_owned()));
        assert_eq!(percent("5"), Err("percent? Write `5%`".to_owned()));
        assert_eq!(percent("0"), Ok("0".to_owned()));
        assert_eq!(percent("0.57"), Err("percent or a part? Write `0.57%` or `57%`".to_owned()));
    }

    use spectra_core::params::{FNumber, Length, OrInfinity, Positive, Time};

    #[test]
    fn units_may_touch_their_numbers() {
        assert_eq!(parse::<Positive<Time>>("30s").map(f64::from), Ok(30.0));
        assert_eq!(parse::<Positive<Time>>("1.5 min").map(f64::from), Ok(90.0));
        assert_eq!(parse::<OrInfinity<Positive<Length>>>("2m").map(|l| l.mm()), Ok(2000.0));
        assert_eq!(parse::<OrInfinity<Positive<Length>>>("inf").map(|l| l.mm()), Ok(f64::INFINITY));
        assert_eq!(parse::<FNumber>("f/2").map(|n| n.number()), Ok(2.0));
    }

    #[test]
    fn faults_fit_on_one_line() {
        for text in ["2 s", "-2 m", "far", "2 mmm", ""] {
            let message = parse::<Positive<Length>>(text).unwrap_err();
            assert!(!message.contains('\n') && message.contains("expected a positive length"), "{message}");
        }
    }
}
