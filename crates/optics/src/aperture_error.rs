//! Reasons why the aperture of a lens is unknown or cannot be set.

use spectra_glass::DispersionError;

/// Formats an f-number for a message.
fn stop(number: &f64) -> String {
    if (1e-3..1e6).contains(number) { format!("f/{number:.3}") } else { format!("f/{number:e}") }
}

/// The reason why an f-number cannot be set.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ApertureError {
    /// The lens passes no axial ray, or no rim limits it.
    #[error("the lens states no clear semi-diameter that limits the axial beam, so its full aperture is unknown")]
    Unlimited,
    /// The requested f-number is faster than the lens.
    #[error("{} is faster than the lens, which is {} wide open{}", stop(.asked), stop(.widest), limited(.rim, *.asked))]
    TooFast {
        /// F-number that was requested.
        asked: f64,
        /// F-number of the lens wide open.
        widest: f64,
        /// Rim that limits the aperture; `None` if it is not one rim.
        rim: Option<LimitingRim>,
    },
    /// The lens has no stop that could be set.
    #[error("the lens has no `stop` surface to set")]
    NoStop,
    /// A medium has no usable index.
    #[error(transparent)]
    Medium(#[from] DispersionError),
    /// No axial ray leaves the lens at this f-number.
    #[error("no axial ray leaves the lens at {}", stop(.0))]
    NoRay(f64),
}

/// The rim that limits the axial beam.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LimitingRim {
    /// Number of the surface that has the rim, from 1.
    pub surface: u32,
    /// Clear semi-diameter of that surface, mm.
    pub semi_diameter_mm: f64,
    /// Semi-diameter that the requested f-number would need there, mm. `None` if no ray leaves at such a steep angle even without
    /// rims.
    pub needed_mm: Option<f64>,
}

/// Describes what limits the aperture, as the end of a sentence.
fn limited(rim: &Option<LimitingRim>, asked: f64) -> String {
    let Some(rim) = rim else { return String::new() };
    let needed = match rim.needed_mm {
        Some(r) => format!("f/{asked:.3} would need r = {r:.2} mm there"),
        None => format!("even without rims no ray would leave the lens at f/{asked:.3}"),
    };
    format!(": the rim of surface {} (r = {:.2} mm) limits it; {needed}", rim.surface, rim.semi_diameter_mm)
}
