//! Arguments with units, parsed the same way as in a scene.

use spectra_core::params::{Quantity, Wavelength};
use spectra_core::quantity::light_nm;

/// Parses an argument such as `2m`, `f/2` or `30s`.
///
/// # Errors
/// Says on one line what was found and what is expected.
pub(crate) fn parse<Q: Quantity>(text: &str) -> Result<Q, String> {
    Q::from_text(text).map_err(|message| match message.split_once("\nhint: ") {
        Some((message, hint)) => format!("{message} ({hint})"),
        None => message,
    })
}

/// Parses a wavelength of light; a bare number is in nm.
///
/// # Errors
/// Fails like [`parse`], and for a wavelength too short for light, which was probably meant in micrometers.
pub(crate) fn wavelength(text: &str) -> Result<Wavelength, String> {
    let wavelength = parse::<Wavelength>(text)?;
    light_nm(wavelength.nm()).map_err(|wrong| format!("{wrong} ({})", wrong.hint()))?;
    Ok(wavelength)
}

/// Returns a percentage unchanged, as text. Refuses a bare positive number, which could mean a percentage or a fraction.
pub(crate) fn percent(text: &str) -> Result<String, String> {
    match text.trim().parse::<f64>() {
        // Rounding removes digits that come only from the product: 57, not 56.99999999999999.
        Ok(number) => {
            let percent = (1e10 * number).round() / 1e8;
            match number {
                1.0.. => Err(format!("is this a percentage? Write `{number}%`")),
                n if n > 0.0 => Err(format!("percentage or fraction? Write `{number}%` or `{percent}%`")),
                // The scene reader reports what is wrong with it.
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
        assert_eq!(percent("5"), Err("is this a percentage? Write `5%`".to_owned()));
        assert_eq!(percent("0"), Ok("0".to_owned()));
        assert_eq!(percent("0.57"), Err("percentage or fraction? Write `0.57%` or `57%`".to_owned()));
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
