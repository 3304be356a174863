//! What a scene says of a film from a data file.

use crate::effects::{Assumed, HalationSetting, OpticsSetting, Switches};
use crate::frame::FrameParams;
use crate::metering::{ExposureParams, Metered, Metering, SpotParams};
use crate::view::{BlackParams, PaperParams, ScanParams, SurroundParams, View, WhiteParams};
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::params::Positive;

/// Film from a data file, developed, and printed, scanned or projected.
///
/// The light on the frame becomes exposure in lux-seconds by the sensitivity of each layer, density by the
/// characteristic curve of the development, and a picture by the way the film is viewed: a black-and-white negative is
/// printed on paper, a color negative on the print stock of its maker, a reversal film is projected. Scatter in the
/// emulsion and reflection from the base act before the curve, adjacency (edges that stand out in development) and grain
/// after it, if the stock's file states them. What the film is printed, scanned or projected through is a lens, too: `optics`.
///
/// The exposure is that of the scene (`exposure`), or the camera meters: the metered area gets 10/S lx s, the exposure
/// of a mid gray. S is the speed that the stock's file states, which `spectra film info` shows with its kind: an ISO
/// speed, its maker's exposure index (EI), or assumed. The meter is a perfect photometer, unless the file says `meter:
/// film`, as those of plates do: then it has the film's own sensitivity. `spectra film info NAME` shows what a stock's
/// file holds, and `spectra list stock` the bundled stocks.
///
/// # Example
/// ```yaml
/// {stock: ilford-ortho-plus, exposure: 1/60 s}
/// ```
/// ```yaml
/// # A push by one stop, exposed for it
/// {kind: stock, stock: kodak-tri-x-400, metering: average, iso: 800, push: 1, paper: {grade: 3}}
/// ```
/// ```yaml
/// # A color negative, metered on its middle and printed
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
    /// Exposure time, s if bare; or `metered`: a picture of integers, which was exposed already, is taken as it is (18 % of its white is
    /// a mid gray), and anything else is metered by `metering: camera`. Leave it out where `metering` says how the camera meters.
    pub exposure: Option<ExposureParams>,
    /// How the camera finds its exposure: `manual`, `average`, `spot`, or `camera`, the mean of the frame with its middle counted more and
    /// lights no more than eight times the median. A metered frame is exposed so that the metered area gets 10/S lx s, the exposure of a
    /// mid gray.
    pub metering: Option<Metering>,
    /// Which frame of an animation is metered: the `first` one, for all of them, or `each` by itself, which may flicker; `first` if left
    /// out.
    #[serde(default)]
    pub meter: Metered,
    /// The spot of `metering: spot`; a tenth of the height in the middle of the frame if left out.
    pub spot: Option<SpotParams>,
    /// Stops by which a metered frame is exposed more than the meter says, -10 to 10; 0 if left out.
    #[schemars(range(min = -10, max = 10))]
    pub compensation: Option<f64>,
    /// The speed (ISO or EI) that the meter and the printer are set to, more than 0; the stock's, times two for each
    /// stop pushed, if left out.
    pub iso: Option<Positive<f64>>,
    /// How the film is developed: a name from the stock's file; the first one there if left out.
    pub development: Option<String>,
    /// Stops of push, or pull if negative, within the series of development times in the stock's file. Of a stock with one time, 2 at
    /// most, by the median change of contrast and fog that other films' sheets show: that is assumed, and said. 0 if left out.
    pub push: Option<f64>,
    /// How it is viewed: `print`, `negative`, `scan`, or `projection` of a reversal film; `projection` of a reversal
    /// film and `print` of any other if left out.
    pub view: Option<View>,
    /// The print stock, by the name of a bundled one or a YAML file beside the scene; the maker's for this film if left
    /// out, or paper for black and white.
    pub print: Option<String>,
    /// How the print is developed: a name from the print stock's file; the first one there if left out.
    pub print_development: Option<String>,
    /// The paper of a black-and-white print, in place of `print`.
    pub paper: Option<PaperParams>,
    /// The printer's lamp: the name of a light or a file; the print stock's reference light if left out.
    pub lamp: Option<String>,
    /// The light by which film and prints are viewed: the name of a light or a file; D55 if left out.
    pub light: Option<String>,
    /// What `view: scan` gives: a `picture` to look at, or for grading and measuring the densities, `log` (on the scale of
    /// Cineon files), `adx` (on that of ADX16) or `density` (a quarter of it); write those with 16 bits. `picture` if left out.
    pub scan: Option<ScanParams>,
    /// What is shown as white: `film`, the clear film or print, or `lamp`, the bare light of a print on film, of a
    /// projection or of three strips, which shows the base as the gray or tint that it is; `film` if left out.
    pub white: Option<WhiteParams>,
    /// What is shown as black: `kept`, no light, so that print or slide keeps the black that it has, on paper with half a percent of the
    /// room's light on top (assumed), or `stretched`, the darkest of it; `kept` if left out.
    pub black: Option<BlackParams>,
    /// What surrounds a print on film or a projection: `average` shows the density of the film itself, mid gray as 18 %. `dark` and
    /// `dim` show it as an eye sees it that has adapted to such a room (CIECAM02), lighter and softer; in the dark a print has the
    /// aim densities of the laboratory. `average` if left out.
    pub surround: Option<SurroundParams>,
    /// Whether the emulsion scatters light, if the stock's file states its MTF; `true` if left out.
    pub scatter: Option<bool>,
    /// Whether edges stand out in development, if the MTF in the stock's file exceeds 1; `true` if left out.
    pub adjacency: Option<bool>,
    /// Reflection from the back of the film, or `off`; as in the stock's file if left out.
    pub halation: Option<HalationSetting>,
    /// Whether there is grain, if the stock's file states its granularity; `true` if left out.
    pub grain: Option<bool>,
    /// The lens that the film is printed, scanned or projected through, or `off`; half of the contrast is left at 60 cycles/mm
    /// if left out, and no lens in `view: negative`.
    pub optics: Option<OpticsSetting>,
    /// Whether effects count whose figures are assumed in the stock's file, rather than measured or stated: `on` or `off`.
    #[serde(default)]
    pub assumed: Assumed,
    /// What becomes of the film in camera and hands: `gate-weave`, `breathing`, `dust`, `scratches`, and a `border` with perforations
    /// around the frame. None of it if left out.
    pub frame: Option<FrameParams>,
    /// Seed of the grain and of all that `frame` draws, 0 or more.
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
