//! Parameters of a film from a data file, as written in a scene.

use crate::effects::{Assumed, HalationSetting, OpticsSetting, Switches};
use crate::frame::FrameParams;
use crate::metering::{ExposureParams, Metered, Metering, SpotParams};
use crate::view::{BlackParams, PaperParams, ScanParams, SurroundParams, View, WhiteParams};
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::params::Positive;

/// Film from a data file, developed, and printed, scanned or projected.
///
/// The sensitivity of each layer turns the light on the frame into exposure in lux-seconds. The characteristic curve of
/// the development turns exposure into density. The way the film is viewed turns density into a picture: a
/// black-and-white negative is printed on paper, a color negative on its maker's print stock, and a reversal film is
/// projected. Scatter in the emulsion and reflection from the base act before the curve; adjacency (edges that stand out
/// in development) and grain act after it. Each acts only if the stock's file has figures for it. `optics` is the lens
/// through which the film is printed, scanned or projected.
///
/// The scene states the exposure time (`exposure`), or the camera meters: then the metered area gets 10/S lx s, the
/// exposure of a mid gray. S is the speed that the stock's file states; `spectra film info` shows it with its kind: an
/// ISO speed, its maker's exposure index (EI), or assumed. The meter is a perfect photometer, unless the stock's file
/// says `meter: film`, as those of plates do: then it has the film's own spectral sensitivity. `spectra film info NAME`
/// shows what a stock's file holds, and `spectra list stock` lists the bundled stocks.
///
/// # Example
/// ```yaml
/// {stock: ilford-ortho-plus, exposure: 1/60 s}
/// ```
/// ```yaml
/// # Pushed by one stop, and exposed for the higher speed
/// {kind: stock, stock: kodak-tri-x-400, metering: average, iso: 800, push: 1, paper: {grade: 3}}
/// ```
/// ```yaml
/// # A color negative, metered on the middle of the frame and printed
/// kind: stock
/// stock: kodak-vision3-250d-5207
/// metering: spot
/// spot: {center: [0.5, 0.5], diameter: 0.2}
/// compensation: 0.5
/// view: print
/// ```
/// # References
/// - ISO 2720:1974: exposure meters; 10/S lx s is the exposure of a mid gray.
/// - ISO 6:1993: the speed point of black-and-white negatives. ISO 6846:1992: the exposure range of papers.
/// - C. J. Bartleson and E. J. Breneman, "Brightness reproduction in the photographic process", Photogr. Sci. Eng. 11
///   (1967): the contrast of a print.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct StockParams {
    /// Name of a bundled stock, such as `ilford-ortho-plus`, or a YAML file beside the scene.
    pub stock: String,
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
    /// Speed (ISO or EI) that the meter and the printer are set to, more than 0. If left out, the stock's speed, doubled for each stop
    /// pushed.
    pub iso: Option<Positive<f64>>,
    /// Development of the film: a name from the stock's file; the first one there if left out.
    pub development: Option<String>,
    /// Stops of push, or of pull if negative, within the series of development times in the stock's file. A stock with a single time
    /// allows up to 2 stops, by the median change of contrast and fog on other films' data sheets; this is assumed, and the description
    /// of the film says so. 0 if left out.
    pub push: Option<f64>,
    /// View of the developed film: `print`, `negative`, `scan`, or, for a reversal film, `projection`. If left out, `projection` for a
    /// reversal film and `print` for any other.
    pub view: Option<View>,
    /// Print stock: the name of a bundled one or a YAML file beside the scene. If left out, the print stock that the film's file names,
    /// or paper for black and white.
    pub print: Option<String>,
    /// Development of the print: a name from the print stock's file; the first one there if left out.
    pub print_development: Option<String>,
    /// Paper of a black-and-white print, instead of `print`.
    pub paper: Option<PaperParams>,
    /// Lamp of the printer: the name of a light or a file; the print stock's reference light if left out.
    pub lamp: Option<String>,
    /// Light by which film and prints are viewed: the name of a light or a file; D55 if left out.
    pub light: Option<String>,
    /// Result of `view: scan`: a `picture` to look at, or the densities for grading and measuring: `log` (on the scale of Cineon files),
    /// `adx` (on the scale of ADX16) or `density` (a quarter of the density). Write densities with 16 bits. `picture` if left out.
    pub scan: Option<ScanParams>,
    /// White of the picture: `film`, the clear film or print, or `lamp`, the bare light of a print on film, of a projection or of three
    /// strips. `lamp` shows the base as the gray or tint that it is. `film` if left out.
    pub white: Option<WhiteParams>,
    /// Black of the picture: `kept` shows no light as black, so that a print or slide keeps its own black; on paper, half a percent of the
    /// room's light is added (assumed). `stretched` shows the darkest tone of print or slide as black. `kept` if left out.
    pub black: Option<BlackParams>,
    /// Surround of a print on film or a projection: `average` shows the density of the film itself, mid gray as 18 %. `dark` and `dim`
    /// show the picture as an eye adapted to such a room sees it (CIECAM02), lighter and softer; in the dark a print has the aim densities
    /// of the laboratory. `average` if left out.
    pub surround: Option<SurroundParams>,
    /// Whether the emulsion scatters light, if the stock's file states its MTF; `true` if left out.
    pub scatter: Option<bool>,
    /// Whether edges stand out in development, if the MTF in the stock's file exceeds 1; `true` if left out.
    pub adjacency: Option<bool>,
    /// Reflection from the back of the film, or `off`; as in the stock's file if left out.
    pub halation: Option<HalationSetting>,
    /// Whether there is grain, if the stock's file states its granularity; `true` if left out.
    pub grain: Option<bool>,
    /// Lens through which the film is printed, scanned or projected, or `off`. If left out, a lens that keeps half of the contrast at
    /// 60 cycles/mm, or no lens with `view: negative`.
    pub optics: Option<OpticsSetting>,
    /// Whether effects whose figures are assumed in the stock's file, rather than measured or stated, are applied: `on` or `off`.
    #[serde(default)]
    pub assumed: Assumed,
    /// Traces of camera and handling on the film: `gate-weave`, `breathing`, `dust`, `scratches`, and a `border` with perforations around
    /// the frame. All are off if left out.
    pub frame: Option<FrameParams>,
    /// Seed of the grain and of everything random in `frame`, 0 or more.
    #[serde(default)]
    pub grain_seed: u64,
}

impl From<&StockParams> for Switches<'static> {
    fn from(p: &StockParams) -> Self {
        Self {
            key: "stock",
            scatter: p.scatter,
            adjacency: p.adjacency,
            halation: p.halation,
            grain: p.grain,
            assumed: p.assumed,
            grain_seed: p.grain_seed,
            first_layer: 0,
        }
    }
}
