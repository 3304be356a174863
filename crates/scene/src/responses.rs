//! Checks of the channels' responses, which plugins provide. A NaN would end the render far from its cause, and a negative value
//! would spoil a picture without notice.

use spectra_core::params::{Fault, Params};
use spectra_core::spectral::{Channel, Grid};

/// Returns the faults of the channels of a film (`section` is `film`) or of an imager, at most one for each channel.
pub(crate) fn faults(channels: &[Channel], grid: &Grid, section: &str, params: &Params) -> Vec<Fault> {
    let is_film = section == "film";
    let fault = |channel: &Channel| {
        let (text, hint) = wrong(&channel.response, grid, is_film)?;
        Some(params.fault(section, format!("channel `{}`: {text}", channel.name)).hint(hint))
    };
    channels.iter().filter_map(fault).collect()
}

/// Returns what is wrong with a response, and a hint where to look.
fn wrong(response: &[f64], grid: &Grid, is_film: bool) -> Option<(String, &'static str)> {
    if response.len() != grid.count {
        let text = format!("its response has {} values, not one at each of {} wavelengths", response.len(), grid.count);
        return Some((
            text,
            "check the code of this kind: it must give one value for each of `context.grid.wavelengths_nm()`",
        ));
    }
    let at = |bad: fn(f64) -> bool| {
        let mut points = grid.wavelengths_nm().zip(response);
        points.find(|(_, value)| bad(**value)).map(|(nm, value)| (nm, *value))
    };
    if let Some((nm, value)) = at(|v| !v.is_finite()) {
        let what = if value.is_nan() { "not a number" } else { "infinite" };
        let hint = "check its keys, and the code of this kind that computes the response";
        return Some((format!("its response at {nm} nm is {what}"), hint));
    }
    let (nm, value) = is_film.then(|| at(|v| v < 0.0)).flatten()?;
    let hint = "check its keys, and the code of this kind: light never reduces exposure, so 0 is the smallest value";
    Some((format!("its response at {nm} nm is negative ({value:.3e})"), hint))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_response_is_a_number_at_each_wavelength_and_a_films_is_none_below_zero() {
        let grid = Grid { start_nm: 400.0, step_nm: 10.0, count: 4 };
        let said = |response: &[f64], is_film| wrong(response, &grid, is_film).map(|(text, _)| text);
        assert_eq!(said(&[0.0, 1.0, 2.0, 0.0], true), None);
        for (response, text) in [
            ([0.0, f64::NAN, f64::INFINITY, 0.0], "its response at 410 nm is not a number"),
            ([0.0, 1.0, f64::INFINITY, 0.0], "its response at 420 nm is infinite"),
        ] {
            assert_eq!(said(&response, true).as_deref(), Some(text));
            assert_eq!(said(&response, false).as_deref(), Some(text));
        }
        let short = "its response has 3 values, not one at each of 4 wavelengths";
        assert_eq!(said(&[0.0; 3], false).as_deref(), Some(short));
        let below = "its response at 430 nm is negative (-2.500e-1)";
        assert_eq!(said(&[0.0, 1.0, 1.0, -0.25], true).as_deref(), Some(below));
        // Color matching functions of real primaries have negative parts, and a detector may have them.
        assert_eq!(said(&[0.0, 1.0, 1.0, -0.25], false), None);
    }
}
