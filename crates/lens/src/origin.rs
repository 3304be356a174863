//! Where the clear semi-diameters of a lens come from: they decide the light of corners and the shapes of blurs, and patents state them
//! seldom.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::fmt;

/// Where the semi-diameters of a lens come from.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
pub enum Rims {
    /// By the source, figure by figure.
    Stated,
    /// By rays that were to pass: the axial beam, and a part of that at the edge of the frame.
    Computed,
    /// Round figures of somebody who drew the lens.
    Guessed,
    /// Chosen so that the light over the frame is that of a real lens: what was measured, and by whom.
    Fitted(
        /// What was measured, of which copy, and by whom.
        String,
    ),
}

impl fmt::Display for Rims {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Stated => f.write_str("stated by the source"),
            Self::Computed => {
                f.write_str("computed by rays that were to pass; corners and shapes of blurs are an estimate")
            }
            Self::Guessed => f.write_str("guessed; corners and shapes of blurs may be far off"),
            Self::Fitted(to) => write!(f, "fitted to {to}"),
        }
    }
}
