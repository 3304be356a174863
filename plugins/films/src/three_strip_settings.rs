//! Parameters of a three-strip camera, as written in a scene.

use crate::effects::{Assumed, HalationSetting, OpticsSetting};
use crate::metering::{ExposureParams, Metered, Metering, SpotParams};
use crate::view::{BlackParams, SurroundParams, WhiteParams};
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::params::Positive;

/// Three separation negatives behind a beam splitter, printed by dye transfer.
///
/// This is the Technicolor camera of the 1930s. A prism divides the light between two gates. A green filter stands in
/// front of the film in one gate; in the other, a pair of films behind a magenta filter records blue on the front film
/// and red on the rear one. Each record becomes a matrix that carries its dye (yellow, magenta, cyan) to the print.
///
/// Here each record is any black-and-white stock with one layer, behind filters. The three are balanced so that a
/// neutral subject in the light of `balance` exposes them alike, and each is exposed for its own speed; `iso` is the
/// speed of the whole camera.
///
/// Each record has the scatter, adjacency, halation and grain of its stock's file. The pair lies emulsion to emulsion:
/// light for the red record is scattered in the blue one first, so the red record is the softest. Behind the blue one
/// there is no base that would reflect light. `optics` stands for the detail lost in matrices and dye transfer.
///
/// # Example
/// ```yaml
/// {kind: three-strip, metering: average}
/// ```
/// ```yaml
/// kind: three-strip
/// exposure: 1/50 s
/// iso: 8
/// balance: iso-7589-studio-tungsten
/// blue: {stock: kodak-double-x-5222, development: 12-min, filters: [wratten-47]}
/// ```
/// # References
/// - J. Ball, "The Technicolor process of three-color cinematography", J. SMPE 25, 127 (1935).
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct ThreeStripParams {
    /// Exposure time, s if bare, or `metered`. With `metered`, a source picture of integers, which was exposed already, keeps its
    /// exposure (18 % of its white is a mid gray), and anything else is metered by `metering: camera`. Leave it out if `metering` says
    /// how the camera meters.
    pub exposure: Option<ExposureParams>,
    /// Metering mode of the camera: `manual`, `average`, `spot` or `camera`. `camera` is a center-weighted mean of the frame in which no
    /// pixel counts for more than eight times the median. A metered frame is exposed so that the metered area gets 10/S lx s, the exposure
    /// of a mid gray.
    pub metering: Option<Metering>,
    /// Frames of an animation that are metered: `first` meters the first one and exposes all alike; `each` meters every frame, which may
    /// make the animation flicker. `first` if left out.
    #[serde(default)]
    pub meter: Metered,
    /// Spot of `metering: spot`. If left out, a spot in the middle of the frame whose diameter is a tenth of the frame's height.
    pub spot: Option<SpotParams>,
    /// Exposure compensation of a metered frame, stops, -10 to 10, positive for more exposure; 0 if left out.
    #[schemars(range(min = -10, max = 10))]
    pub compensation: Option<f64>,
    /// ISO speed of the whole camera, with beam splitter and filters, more than 0; 5 if left out.
    pub iso: Option<Positive<f64>>,
    /// Light in which a neutral subject exposes all three records alike: the name of a light or a file.
    #[serde(default = "daylight")]
    pub balance: String,
    /// Light by which the print is viewed: the name of a light or a file.
    #[serde(default = "daylight")]
    pub light: String,
    /// White of the picture: `film`, the clear print, or `lamp`, the bare light.
    #[serde(default)]
    pub white: WhiteParams,
    /// Black of the picture: `kept` shows no light as black, so that the print keeps its own black; `stretched` shows the darkest tone of
    /// the print as black.
    #[serde(default)]
    pub black: BlackParams,
    /// Surround of the print: `average` shows the print's own density, mid gray as 18 %; `dark` and `dim` show the print as an eye
    /// adapted to such a room sees it (CIECAM02), lighter and softer.
    #[serde(default)]
    pub surround: SurroundParams,
    /// Print stock, with its dyes and the curves of its matrices: a bundled stock or a YAML file beside the scene, with layers called
    /// blue, green and red.
    #[serde(default = "technicolor")]
    pub print: String,
    /// Negative of the red record and the filters in front of it; Double-X behind wratten-32 and wratten-25 if left out.
    #[serde(default = "red")]
    pub red: RecordParams,
    /// Negative of the green record and the filters in front of it; Double-X behind wratten-58 if left out.
    #[serde(default = "green")]
    pub green: RecordParams,
    /// Negative of the blue record and the filters in front of it; Double-X behind wratten-47 if left out.
    #[serde(default = "blue")]
    pub blue: RecordParams,
    /// Whether emulsions scatter light, if the files of their stocks state their MTF; `true` if left out.
    pub scatter: Option<bool>,
    /// Whether edges stand out in development, if the MTF in the file of a stock exceeds 1; `true` if left out.
    pub adjacency: Option<bool>,
    /// Reflection from the back of the green and the red record, or `off`; as in the files of their stocks if left out.
    pub halation: Option<HalationSetting>,
    /// Whether there is grain, if the file of a stock states its granularity; `true` if left out.
    pub grain: Option<bool>,
    /// Fine detail that matrices and dye transfer lose, expressed as a lens, or `off`. If left out, half of the contrast is kept at
    /// 60 cycles/mm, which is assumed.
    pub optics: Option<OpticsSetting>,
    /// Whether effects whose figures are assumed in the file of a stock, rather than measured or stated, are applied: `on` or `off`.
    #[serde(default)]
    pub assumed: Assumed,
    /// Seed of the grain, 0 or more.
    #[serde(default)]
    pub grain_seed: u64,
}

/// One record of a three-strip camera: a stock behind filters.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct RecordParams {
    /// Stock of the record, a black-and-white negative with a single layer: a bundled one or a YAML file beside the scene.
    pub stock: String,
    /// Development of the stock: a name from its file; the first one there if left out.
    pub development: Option<String>,
    /// Filters in front of the stock, as names or files of transmittances: for example, the filter of the beam splitter, or a dyed
    /// emulsion in front. No filters if left out.
    #[serde(default)]
    pub filters: Vec<String>,
}

fn record(stock: &str, development: Option<&str>, filters: &[&str]) -> RecordParams {
    let filters = filters.iter().map(|&f| f.to_owned()).collect();
    RecordParams { stock: stock.into(), development: development.map(Into::into), filters }
}

// J. Ball described the camera ("The Technicolor process of three-color cinematography", J. SMPE 25, 127, 1935): a green
// filter in front of one film, and a magenta filter in front of the pair, whose front film sees only blue and is dyed red.
// Here all three records use a later stock whose sensitivity is known; a blue filter stands in for the blue-sensitive front film.
// One stock gives all records the same contrast, as the process needs. The development is the steepest on the stock's sheet, which
// gives the print the contrast for which the process was known.
fn red() -> RecordParams {
    record("kodak-double-x-5222", Some("12-min"), &["wratten-32", "wratten-25"])
}

fn green() -> RecordParams {
    record("kodak-double-x-5222", Some("12-min"), &["wratten-58"])
}

fn blue() -> RecordParams {
    record("kodak-double-x-5222", Some("12-min"), &["wratten-47"])
}

fn daylight() -> String {
    "D55".into()
}

fn technicolor() -> String {
    "technicolor-iv".into()
}
