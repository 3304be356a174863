//! Arguments with units, parsed the same way as in a scene.

use spectra_core::params::{Fault, Quantity, Wavelength};
use spectra_core::quantity::light_nm;

/// Parses a wavelength of light; a bare number is in nm.
///
/// # Errors
/// Fails like [`Quantity::from_text`], and for a wavelength too short for light, which was probably meant in micrometers.
pub(crate) fn wavelength(text: &str) -> Result<Wavelength, Fault> {
    let wavelength = Wavelength::from_text(text)?;
    light_nm(wavelength.nm()).map_err(|wrong| Fault::new(wrong.to_string()).hint(wrong.hint()))?;
    Ok(wavelength)
}

/// Returns a percentage unchanged, as text. Refuses a bare positive number, which could mean a percentage or a fraction.
pub(crate) fn percent(text: &str) -> Result<String, Fault> {
    match text.trim().parse::<f64>() {
        // Rounding removes digits that come only from the product: 57, not 56.99999999999999.
        Ok(number) => {
            let percent = (1e10 * number).round() / 1e8;
            match number {
                1.0.. => Err(format!("is this a percentage? Write `{number}%`").into()),
                n if n > 0.0 => Err(format!("percentage or fraction? Write `{number}%` or `{percent}%`").into()),
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
        assert_eq!(wavelength("0.5876").map_err(|fault| fault.to_string()), Err(wrong.to_owned()));
        assert_eq!(wavelength("587.6"), Ok(Wavelength::from_nm(587.6)));
        assert_eq!(wavelength("0.5 um"), Ok(Wavelength::from_nm(500.0)));
    }

    #[test]
    fn a_bare_number_is_no_percentage() {
        assert_eq!(percent("0.5%"), Ok("0.5%".to_owned()));
        assert_eq!(percent("5"), Err("is this a percentage? Write `5%`".into()));
        assert_eq!(percent("0"), Ok("0".to_owned()));
        assert_eq!(percent("0.57"), Err("percentage or fraction? Write `0.57%` or `57%`".into()));
    }

    use spectra_core::params::{FNumber, Length, OrInfinity, Positive, Time};

    #[test]
    fn units_may_touch_their_numbers() {
        assert_eq!(Positive::<Time>::from_text("30s").map(f64::from), Ok(30.0));
        assert_eq!(Positive::<Time>::from_text("1.5 min").map(f64::from), Ok(90.0));
        assert_eq!(OrInfinity::<Positive<Length>>::from_text("2m").map(|l| l.mm()), Ok(2000.0));
        assert_eq!(OrInfinity::<Positive<Length>>::from_text("inf").map(|l| l.mm()), Ok(f64::INFINITY));
        assert_eq!(FNumber::from_text("f/2").map(|n| n.number()), Ok(2.0));
    }

    #[test]
    fn faults_fit_on_one_line() {
        for text in ["2 s", "-2 m", "far", "2 mmm", ""] {
            let message = Positive::<Length>::from_text(text).unwrap_err().to_string();
            assert!(!message.contains('\n') && message.contains("expected a positive length"), "{message}");
        }
    }
}
