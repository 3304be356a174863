//! The wavelengths that are accepted as light.

use std::fmt;

/// Shortest wavelength that is accepted as light, nm. No glass passes shorter wavelengths, and no spectrum begins there. A
/// smaller number was meant in another unit.
pub const SHORTEST_LIGHT_NM: f64 = 50.0;
/// Longest wavelength that a hint proposes, nm.
const LONGEST_NM: f64 = 50_000.0;

/// Error of a wavelength that is too short for light, nm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NotLight(pub f64);

impl fmt::Display for NotLight {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "a wavelength of {} nm is too short for light", self.0)
    }
}

impl std::error::Error for NotLight {}

impl NotLight {
    /// Returns a hint that says what to write instead.
    #[must_use]
    pub fn hint(self) -> String {
        let sizes = [("um", 1e3), ("mm", 1e6), ("m", 1e9)];
        // Drops the digits that multiplication adds behind those that were written.
        let in_nm = |size: f64| (self.0 * size * 1e6).round() / 1e6;
        match sizes.into_iter().find(|(_, size)| (SHORTEST_LIGHT_NM..=LONGEST_NM).contains(&in_nm(*size))) {
            Some((unit, size)) => format!("{} {unit} is {nm} nm: write {nm}", self.0, nm = in_nm(size)),
            None => "wavelengths are in nm, such as 550".to_owned(),
        }
    }
}

/// Returns the wavelength (nm) unchanged, if it is long enough for light.
///
/// # Errors
/// [`NotLight`] below [`SHORTEST_LIGHT_NM`].
pub fn light_nm(nm: f64) -> Result<f64, NotLight> {
    if nm < SHORTEST_LIGHT_NM { Err(NotLight(nm)) } else { Ok(nm) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn micrometers_are_told_from_nanometers() {
        for (nm, hint) in [
            (0.5876, "0.5876 um is 587.6 nm: write 587.6"),
            (0.5875618, "0.5875618 um is 587.5618 nm: write 587.5618"),
            (10.6, "10.6 um is 10600 nm: write 10600"),
            (5.5e-4, "0.00055 mm is 550 nm: write 550"),
            (5.5e-7, "0.00000055 m is 550 nm: write 550"),
            (-1.0, "wavelengths are in nm, such as 550"),
        ] {
            assert_eq!(light_nm(nm).map_err(NotLight::hint), Err(hint.to_owned()), "{nm}");
        }
        assert_eq!(
            light_nm(0.55).map_err(|e| e.to_string()),
            Err("a wavelength of 0.55 nm is too short for light".to_owned())
        );
        for nm in [50.0, 121.6, 550.0, 10_600.0, 1e6] {
            assert_eq!(light_nm(nm), Ok(nm));
        }
    }
}
