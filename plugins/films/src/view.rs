//! How the developed film is looked at.

use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::params::Positive as AboveZero;
use spectra_film::look::{PictureBlack, PictureWhite, Surround};
use spectra_film::positive::{Positive, ScanScale};
use spectra_film::print::{Paper, Print};
use std::borrow::Cow;

/// `view` as written in a scene.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub enum View {
    /// A negative printed on paper or on a print stock.
    Print,
    /// The film itself on a light table.
    Negative,
    /// A negative scanned and turned around.
    Scan,
    /// A reversal film, projected.
    Projection,
}

/// `scan` as written in a scene.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub enum ScanParams {
    /// A picture to look at, its highlights under a soft shoulder.
    #[default]
    Picture,
    /// Density over unexposed film as Cineon files hold it: value = (95 + density / 0.002) / 1023.
    Log,
    /// Density over unexposed film on the scale of ADX16: value = (1520 + 8000 density) / 65535.
    Adx,
    /// Density, base included: value = density / 4.
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

/// `white` as written in a scene.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub enum WhiteParams {
    /// The clear film or print.
    #[default]
    Film,
    /// The bare light.
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

/// `black` as written in a scene.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub enum BlackParams {
    /// The medium keeps its black; a print on paper reflects half a percent of the room's light besides.
    #[default]
    Kept,
    /// The darkest of print or slide is shown as black.
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

/// `surround` as written in a scene.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub enum SurroundParams {
    /// As an eye sees it that has adapted to a dark room.
    Dark,
    /// As an eye sees it in a dim one.
    Dim,
    /// The density of the film itself.
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

/// `paper` as written in a scene; see [`Paper`].
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct PaperParams {
    /// Contrast: 0 (soft) to 5 (hard), of ISO ranges R155, 127, 105, 87, 72 and 57, and straight between; or `auto`, the
    /// grade and the exposure that print the lightest 1 % of this frame at the beginning of the paper's exposure range and the
    /// darkest at its end, if grade 5 can: a flatter frame is printed on grade 2, as metered. 2 if left out.
    pub grade: Option<Grade>,
    /// Exposure range, log10 of exposure (the ISO range over 100), more than 0; that of the grade if left out.
    pub range: Option<AboveZero<f64>>,
    /// Maximum density over the paper's white, more than 0; 2.1, a glossy paper, if left out.
    pub maximum_density: Option<AboveZero<f64>>,
    /// Width of the toe, where the highlights are, log10 of exposure, above 0 to 2; 0.2 of grade 2 and as much wider as the range if left out.
    #[schemars(range(max = 2))]
    pub toe: Option<AboveZero<f64>>,
    /// Sharpness of the shoulder, where the shadows are, 1 to 64; 6 if left out.
    #[schemars(range(min = 1, max = 64))]
    pub shoulder: Option<AboveZero<f64>>,
}

/// `grade` as written.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq)]
#[serde(untagged)]
pub enum Grade {
    /// As the frame needs it.
    Auto(AutoWord),
    /// 0 to 5.
    Number(f64),
}

/// The word.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub enum AutoWord {
    /// As the frame needs it.
    Auto,
}

/// A print on paper: made for one frame, or for all of the film.
#[derive(Clone, Debug)]
pub(crate) struct PaperPrint {
    /// As the meter says.
    pub metered: Print,
    /// The paper, if grade and exposure are chosen for each frame.
    pub automatic: Option<Paper>,
    /// What is shown as black.
    pub black: PictureBlack,
}

impl PaperPrint {
    /// The picture of a negative.
    pub(crate) fn pictures(&self, density: &[f32]) -> Result<Vec<f32>, String> {
        Ok(self.of(density)?.pictures(density))
    }

    /// Densities of the print of a negative over the paper's white.
    pub(crate) fn densities(&self, density: &[f32]) -> Result<Vec<f32>, String> {
        let print = self.of(density)?;
        Ok(density.iter().map(|d| print.density(f64::from(*d)) as f32).collect())
    }

    fn of(&self, density: &[f32]) -> Result<Cow<'_, Print>, String> {
        let automatic = self.automatic.as_ref().map(|paper| Print::automatic(paper, density, self.black));
        let automatic = automatic.transpose().map_err(|error| error.to_string())?.flatten();
        Ok(automatic.map_or(Cow::Borrowed(&self.metered), Cow::Owned))
    }
}

/// The positive that the film ends in.
#[derive(Clone, Debug)]
pub(crate) enum Picture {
    /// Paper under silver.
    Paper(Box<PaperPrint>),
    /// All else.
    Positive(Box<Positive>),
}
