//! The origin of the clear semi-diameters of a lens. They determine the light in the corners and the shapes of blurs, but patents seldom
//! state them.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::fmt;

/// The origin of the semi-diameters of a lens.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
pub enum Rims {
    /// The source states each figure.
    Stated,
    /// Computed from rays that were meant to pass: the axial beam, and a part of the beam at the edge of the frame.
    Computed,
    /// Round figures chosen by the person who drew the lens.
    Guessed,
    /// Chosen so that the illumination over the frame matches that of a real lens.
    Fitted(
        /// What was measured, on which copy, and by whom.
        String,
    ),
}

impl fmt::Display for Rims {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Stated => f.write_str("stated by the source"),
            Self::Computed => {
                f.write_str("computed from rays that were meant to pass; corners and blur shapes are estimates")
            }
            Self::Guessed => f.write_str("guessed; corners and blur shapes may be far off"),
            Self::Fitted(to) => write!(f, "fitted to {to}"),
        }
    }
}
