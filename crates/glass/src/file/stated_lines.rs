//! Spectral lines as a file writes them.

use crate::lines::{Line, LineTriple};
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::params::{Fault, Params};

/// A line by its name, such as `F'`, or a wavelength, nm if bare.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
#[schemars(inline)]
pub enum StatedLine {
    /// Wavelength of the line, nm.
    Wavelength(f64),
    /// Name of the line, or a wavelength with its unit.
    Name(String),
}

impl StatedLine {
    fn line(&self) -> Option<Line> {
        match self {
            Self::Wavelength(nm) => Line::at(*nm),
            Self::Name(text) => Line::read(text),
        }
    }

    fn text(&self) -> String {
        match self {
            Self::Wavelength(nm) => nm.to_string(),
            Self::Name(text) => text.chars().take(40).collect(),
        }
    }
}

/// The lines at which an index and an Abbe number are stated. A single line is that of the index; the usual two go with it (`d`
/// and `D` with F and C, `e` with F' and C'). Three lines go from blue to red, with the index at the middle one: `[F', e, C']`,
/// `[450 nm, 580 nm, 680 nm]`.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
#[schemars(inline)]
pub enum StatedLines {
    /// The line of the index.
    Reference(StatedLine),
    /// Blue, middle and red.
    Three([StatedLine; 3]),
}

/// Three lines, from blue to red: `[F', e, C']`, `[450 nm, 580 nm, 680 nm]`.
pub type ThreeLines = [StatedLine; 3];

impl StatedLines {
    /// Returns the three lines, with faults placed at the key `key` of `params`. A single line that is neither d, D nor e is
    /// combined with F and C.
    ///
    /// # Errors
    /// An unknown line; three lines that do not rise.
    pub fn triple(&self, params: &Params, key: &str) -> Result<LineTriple, Fault> {
        match self {
            Self::Reference(line) => {
                let mid = known(line, params, key)?;
                Ok(LineTriple::of_reference(mid).unwrap_or(LineTriple { mid, ..LineTriple::FDC }))
            }
            Self::Three(three) => triple(three, params, key),
        }
    }
}

/// Converts three stated lines, with faults placed at the key `key` of `params`.
///
/// # Errors
/// An unknown line; lines that do not rise.
pub fn triple(three: &ThreeLines, params: &Params, key: &str) -> Result<LineTriple, Fault> {
    let at = |i: usize| known(&three[i], params, &format!("{key}[{i}]"));
    let (short, mid, long) = (at(0)?, at(1)?, at(2)?);
    LineTriple::rising(short, mid, long).ok_or_else(|| {
        params
            .fault(key, "the lines must go from blue to red")
            .hint("write three lines such as [F', e, C'] or [450, 580, 680]")
    })
}

/// Returns the three lines, if they rise.
pub(super) fn rising(three: &ThreeLines) -> Option<LineTriple> {
    LineTriple::rising(three[0].line()?, three[1].line()?, three[2].line()?)
}

fn known(line: &StatedLine, params: &Params, key: &str) -> Result<Line, Fault> {
    line.line().ok_or_else(|| {
        let fault = params.fault(key, format!("unknown spectral line `{}`", line.text()));
        fault.hint("d, D and e are usual; any of i h g F' F e d D C' C r A' s t, or a wavelength in nm")
    })
}
