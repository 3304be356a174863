//! Viewing of the developed film: parameters of prints, scans and projections, and prints on paper.

use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::params::Fault;
use spectra_core::params::Positive as AboveZero;
use spectra_film::positive::{Positive, ScanScale};
use spectra_film::print::{Paper, Print};
use spectra_film::viewing_options::{PictureBlack, PictureWhite, Surround};
use std::borrow::Cow;

/// The value of `view` as written in a scene.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub enum View {
    /// A negative is printed on paper or on a print stock.
    Print,
    /// The film itself is viewed on a light table.
    Negative,
    /// A negative is scanned and inverted.
    Scan,
    /// A reversal film is projected.
    Projection,
}

/// The value of `scan` as written in a scene.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub enum ScanParams {
    /// A picture to look at, with a soft shoulder for the highlights.
    #[default]
    Picture,
    /// Density over unexposed film, as in Cineon files: value = (95 + density / 0.002) / 1023.
    Log,
    /// Density over unexposed film on the scale of ADX16: value = (1520 + 8000 density) / 65535.
    Adx,
    /// Density including the base: value = density / 4.
    Density,
}

impl From<ScanParams> for ScanScale {
    fn from(scan: ScanParams) -> Self {
        match scan {
            ScanParams::Picture => Self::Picture,
            ScanParams::Log => Self::Log,
            ScanParams::Adx => Self::Adx,
            ScanParams::Density => Self::Density,
        }
    }
}

/// The value of `white` as written in a scene: what is shown as white.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub enum WhiteParams {
    /// The clear film or print is white.
    #[default]
    Film,
    /// The bare light is white.
    Lamp,
}

impl From<WhiteParams> for PictureWhite {
    fn from(white: WhiteParams) -> Self {
        match white {
            WhiteParams::Film => Self::Film,
            WhiteParams::Lamp => Self::Lamp,
        }
    }
}

/// The value of `black` as written in a scene: what is shown as black.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub enum BlackParams {
    /// The medium keeps its own black; a print on paper also reflects half a percent of the room's light.
    #[default]
    Kept,
    /// The darkest tone of print or slide is shown as black.
    Stretched,
}

impl From<BlackParams> for PictureBlack {
    fn from(black: BlackParams) -> Self {
        match black {
            BlackParams::Kept => Self::Kept,
            BlackParams::Stretched => Self::Stretched,
        }
    }
}

/// The value of `surround` as written in a scene.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub enum SurroundParams {
    /// The picture as seen by an eye adapted to a dark room.
    Dark,
    /// The picture as seen by an eye adapted to a dim room.
    Dim,
    /// The picture with the density of the film itself.
    #[default]
    Average,
}

impl From<SurroundParams> for Surround {
    fn from(surround: SurroundParams) -> Self {
        match surround {
            SurroundParams::Dark => Self::Dark,
            SurroundParams::Dim => Self::Dim,
            SurroundParams::Average => Self::Average,
        }
    }
}

/// The map `paper` as written in a scene; see [`Paper`].
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct PaperParams {
    /// Paper grade, 0 (soft) to 5 (hard): ISO ranges R155, 127, 105, 87, 72 and 57, interpolated linearly between grades. `auto` chooses
    /// grade and exposure for each frame, so that the lightest 1 % of it are printed at the beginning of the paper's exposure range and
    /// the darkest 1 % at its end. A frame too flat for grade 5 is printed on grade 2, as metered. 2 if left out.
    pub grade: Option<Grade>,
    /// Exposure range of the paper, log10 of exposure (the ISO range divided by 100), more than 0; that of the grade if left out.
    pub range: Option<AboveZero<f64>>,
    /// Maximum density over the paper's white, more than 0; 2.1, a glossy paper, if left out.
    pub maximum_density: Option<AboveZero<f64>>,
    /// Width of the toe, where the highlights are, log10 of exposure, above 0 to 2. If left out, 0.2 for grade 2, and in proportion to the
    /// range for others.
    #[schemars(range(max = 2))]
    pub toe: Option<AboveZero<f64>>,
    /// Sharpness of the shoulder, where the shadows are, 1 to 64; 6 if left out.
    #[schemars(range(min = 1, max = 64))]
    pub shoulder: Option<AboveZero<f64>>,
}

/// The value of `grade` as written in a scene.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq)]
#[serde(untagged)]
pub enum Grade {
    /// The word `auto`: the grade that suits the frame.
    Auto(AutoWord),
    /// A paper grade, 0 to 5.
    Number(f64),
}

/// The word `auto` as the value of `grade`.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub enum AutoWord {
    /// The grade that suits the frame.
    Auto,
}

/// A print on paper, with one grade and exposure for all frames or with its own for each.
#[derive(Clone, Debug)]
pub(crate) struct PaperPrint {
    /// The print at the exposure that the meter chose.
    pub metered: Print,
    /// The paper, if grade and exposure are chosen for each frame.
    pub automatic: Option<Paper>,
    /// Black of the finished picture.
    pub black: PictureBlack,
}

impl PaperPrint {
    /// Returns the finished picture of a negative, given its densities: one gray value per pixel.
    pub(crate) fn pictures(&self, density: &[f32]) -> Result<Vec<f32>, Fault> {
        Ok(self.of(density)?.pictures(density))
    }

    /// Returns the densities of the print over the paper's white, given the densities of the negative.
    pub(crate) fn densities(&self, density: &[f32]) -> Result<Vec<f32>, Fault> {
        let print = self.of(density)?;
        Ok(density.iter().map(|d| print.density(f64::from(*d)) as f32).collect())
    }

    fn of(&self, density: &[f32]) -> Result<Cow<'_, Print>, Fault> {
        let automatic = self.automatic.as_ref().map(|paper| Print::automatic(paper, density, self.black));
        let automatic = automatic.transpose().map_err(|error| error.to_string())?.flatten();
        Ok(automatic.map_or(Cow::Borrowed(&self.metered), Cow::Owned))
    }
}

/// The process that turns a developed film into the finished picture.
#[derive(Clone, Debug)]
pub(crate) enum Picture {
    /// A print of a black-and-white negative on paper.
    Paper(Box<PaperPrint>),
    /// Any other print, a scan, a projection, or the film itself.
    Positive(Box<Positive>),
}
