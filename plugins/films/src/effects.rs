//! Parameters of the effects inside the film (scatter, halation, adjacency, grain), and the [`Effects`] that a scene asks for.

use crate::view::View;
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::frame::FrameSize;
use spectra_core::params::{Fault, Faults, Length, Params, Positive};
use spectra_film::develop::{Effects, Granularity};
use spectra_film::emulsion::Emulsion;
use spectra_film::grain::ColorGrain;
use spectra_film::halation::{Halation, HalationBase};
use spectra_film::raster::Raster;
use spectra_film::scatter::Modulation;
use spectra_film::stock::{Backing, Stock};

/// The map `halation` as written in a scene; see [`HalationBase`].
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct HalationParams {
    /// Light that enters the base, relative to the light that exposes the layer, 0 to 10; the stock's value if left out.
    #[schemars(range(min = 0, max = 10))]
    pub entering: Option<f64>,
    /// Backing that keeps light from coming back, instead of the stock's: `rem-jet` absorbs nearly all of it, `silver` most, `dye` some.
    /// `removed` leaves the clear base, as on cinema film whose rem-jet was washed off before it was shot.
    pub backing: Option<Backing>,
    /// Transmittance of base and backing in one pass, 0 to 1. Write either this or `backing`; the stock's value if both are left
    /// out.
    #[schemars(range(min = 0, max = 1))]
    pub transmittance: Option<f64>,
    /// Thickness of the base, 0.001 to 10 mm, mm if bare; that of the stock's first base if left out.
    pub thickness: Option<Positive<Length>>,
    /// Refractive index of the base, above 1 to 4; that of the stock's first base if left out.
    #[schemars(extend("exclusiveMinimum" = 1, "maximum" = 4))]
    pub index: Option<f64>,
    /// Fraction of the returning light that the emulsion reflects into the base again for another trip, 0 to 0.95. If left out, the
    /// stock's value, or 0 if it has none.
    #[schemars(range(min = 0, max = 0.95))]
    pub reflected: Option<f64>,
}

/// The word `off`: the effect is disabled.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Off {
    /// The effect is disabled.
    Off,
}

/// The value of `halation` as written in a scene: a map of figures, or `off`.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum HalationSetting {
    /// The word `off`: no halation.
    Word(Off),
    /// Properties of the film's base and backing.
    Back(HalationParams),
}

/// The map `optics` as written in a scene.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct OpticsParams {
    /// Spatial frequency on the film at which the lens keeps half of the contrast, cycles/mm, 5 to 1000.
    #[schemars(range(min = 5, max = 1000))]
    pub mtf50: f64,
}

/// The value of `optics` as written in a scene: a lens, or `off`.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum OpticsSetting {
    /// The word `off`: no loss of contrast.
    Word(Off),
    /// Properties of the lens.
    Lens(OpticsParams),
}

/// Spatial frequency on the film, cycles/mm, at which enlargers, printers, scanners and projectors keep half of the contrast. Assumed, for
/// a good lens at a fourth to a tenth of its picture's size.
const USUAL_MTF50: f64 = 60.0;

/// Returns the frequency, cycles/mm, at which the lens between the film and its picture keeps half of the contrast; `None` if there is no
/// lens, because it is `off` or the film itself is viewed.
pub(crate) fn mtf50(optics: Option<OpticsSetting>, view: Option<View>) -> Option<f64> {
    match optics {
        Some(OpticsSetting::Word(Off::Off)) => None,
        Some(OpticsSetting::Lens(lens)) => Some(lens.mtf50),
        None if view == Some(View::Negative) => None,
        None => Some(USUAL_MTF50),
    }
}

/// The value of `assumed` as written in a scene.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub enum Assumed {
    /// Figures that are assumed are used, too.
    #[default]
    On,
    /// Only figures that are measured or stated are used.
    Off,
}

/// The effects that a scene asks for on one stock.
pub(crate) struct Switches<'a> {
    /// Key of the scene at which the stock is named.
    pub key: &'a str,
    pub scatter: Option<bool>,
    pub adjacency: Option<bool>,
    pub halation: Option<HalationSetting>,
    pub grain: Option<bool>,
    pub assumed: Assumed,
    pub grain_seed: u64,
    /// Number of the stock's first layer among all layers of the picture; each layer has its own grains.
    pub first_layer: u32,
}

/// Returns a hint on how to get square pixels: another number of rows, or a crop to the aspect ratio of the resolution.
fn square_frame(size: &FrameSize) -> String {
    let rows = (f64::from(size.width_px) * size.height_mm / size.width_mm).round();
    let [mut common, mut rest] = [size.width_px, size.height_px];
    while rest > 0 {
        [common, rest] = [rest, common % rest];
    }
    let [across, down] = [size.width_px, size.height_px].map(|side| side / common.max(1));
    format!("`resolution: [{}, {rows:.0}]`, or `crop: {across}:{down}` for a frame of that shape", size.width_px)
}

/// Returns the width and height of a pixel, mm.
pub(crate) fn pixel_mm(size: &FrameSize) -> [f64; 2] {
    [size.width_mm / f64::from(size.width_px), size.height_mm / f64::from(size.height_px)]
}

/// Builds the effects that a scene asks for on a stock.
pub(crate) fn effects(
    p: &Switches<'_>,
    params: &Params,
    stock: &Stock,
    emulsion: &Emulsion,
) -> Result<Effects, Faults> {
    let mut faults = Faults::new();
    let counts = p.assumed == Assumed::On || stock.assumed.mtf.is_none();
    if p.scatter == Some(true) && !(counts && stock.layers.iter().any(|l| !l.mtf.is_empty())) {
        let measured = if counts { "" } else { "measured " };
        let text = format!("{} has no {measured}modulation transfer in its file", stock.name);
        faults.push(params.fault("scatter", text).hint("leave `scatter` out, or give the stock's layers an `mtf`"));
    }
    let (mut mtf, mut adjacency) = (Vec::new(), Vec::new());
    for layer in &stock.layers {
        let unfit = |e| params.fault(p.key, format!("{}: {e}", stock.name));
        let known = counts && !layer.mtf.is_empty();
        let parts = known.then(|| Modulation::measured(&layer.mtf).map_err(unfit));
        let parts = parts.and_then(|m| faults.take(m));
        adjacency.push(parts.as_ref().and_then(|m| m.adjacency).filter(|_| p.adjacency.unwrap_or(true)));
        mtf.push(parts.map(|m| m.mtf).filter(|_| p.scatter.unwrap_or(true)));
    }
    if p.adjacency == Some(true) && adjacency.iter().all(Option::is_none) {
        let text = format!("{} has no modulation transfer above 1 in its file", stock.name);
        faults.push(
            params
                .fault("adjacency", text)
                .hint("leave `adjacency` out, or give the stock's layers an `mtf` that exceeds 1"),
        );
    }
    let granularity = granularity(p, params, stock, emulsion, &mut faults);
    let halation = halation(p, params, stock, &mut faults);
    let mut assumed = Vec::new();
    if p.halation.is_none() && halation.iter().any(Option::is_some) && halation_is_assumed(stock) {
        assumed.push("halation");
    }
    if granularity.is_some() && granularity_is_assumed(stock) {
        assumed.push("grain");
    }
    if stock.assumed.mtf.is_some() && mtf.iter().any(Option::is_some) {
        assumed.push("scatter");
    }
    let (piece, first_layer) = (p.grain_seed, p.first_layer);
    faults.into_result(Effects { mtf, adjacency, halation, granularity, assumed, piece, seed: piece, first_layer })
}

/// Checks that the pixels of a frame are square, to 1 %, if any effect on the film needs that. The error is a message and a hint.
pub(crate) fn check_frame(effects: &Effects, size: &FrameSize) -> Result<(), [String; 2]> {
    let [across, down] = pixel_mm(size);
    if effects.need_raster() && (across / down - 1.0).abs() > 0.01 {
        let text = format!("scatter, halation, adjacency and grain need square pixels, not {across:.5} x {down:.5} mm");
        let hint = format!(
            "{}, or `scatter: false, adjacency: false, halation: off, grain: false` for the film",
            square_frame(size)
        );
        return Err([text, hint]);
    }
    Ok(())
}

/// Returns the raster that says where the pixels of a frame lie on the film. Fails if they must be square and are not.
pub(crate) fn raster(effects: &Effects, size: FrameSize) -> Result<Raster, Fault> {
    check_frame(effects, &size).map_err(|[text, hint]| format!("{text}: {hint}"))?;
    let [across, down] = pixel_mm(&size);
    Ok(Raster::new(size.width_px as usize, size.height_px as usize, (across * down).sqrt()))
}

fn granularity(
    p: &Switches<'_>,
    params: &Params,
    stock: &Stock,
    emulsion: &Emulsion,
    faults: &mut Faults,
) -> Option<Granularity> {
    let known = match stock.granularity {
        // The variance is proportional to density (Nutting) and inversely proportional to the aperture's area (Selwyn).
        Some(g) => Some(Granularity::Silver(g.rms * (g.aperture_mm / 0.048) / g.density.sqrt())),
        None => ColorGrain::new(stock, emulsion).map(Granularity::Dyes),
    };
    if p.grain == Some(true) && known.is_none() {
        let text = format!("{} has no granularity in its file", stock.name);
        faults.push(params.fault("grain", text).hint("leave `grain` out, or give the stock a `granularity`"));
    }
    let left_out = p.assumed == Assumed::Off && granularity_is_assumed(stock);
    let known = known.filter(|_| p.grain.unwrap_or(true) && !left_out)?;
    match known.grain(0, 0, 0) {
        Ok(_) => Some(known),
        Err(error) => {
            faults.push(params.fault(p.key, format!("{}: {error}", stock.name)));
            None
        }
    }
}

/// Returns whether the stock's granularity, that of its silver or of its layers, is assumed.
fn granularity_is_assumed(stock: &Stock) -> bool {
    stock.granularity.is_some_and(|g| g.assumed) || stock.assumed.granularity.is_some()
}

/// Returns whether the stock's own halation, or the base that it is computed with, is assumed.
fn halation_is_assumed(stock: &Stock) -> bool {
    stock.halation.as_ref().is_some_and(|h| h.assumed) || stock.bases.first().is_some_and(|b| b.assumed)
}

/// Returns the halation of each layer; all `None` if there is none.
fn halation(p: &Switches<'_>, params: &Params, stock: &Stock, faults: &mut Faults) -> Vec<Option<HalationBase>> {
    let none = vec![None; stock.layers.len()];
    let base = stock.bases.first();
    let (own, of_stock) = match (p.halation, &stock.halation) {
        (Some(HalationSetting::Word(Off::Off)), _) | (None, None) => return none,
        (Some(HalationSetting::Back(h)), of_stock) => (Some(h), of_stock.as_ref()),
        (None, Some(_)) if p.assumed == Assumed::Off && halation_is_assumed(stock) => return none,
        (None, Some(h)) => (None, Some(h)),
    };
    if own.is_some_and(|h| h.backing.is_some() && h.transmittance.is_some()) {
        let fault = params.fault("halation.transmittance", "`backing` already implies a transmittance");
        faults.push(fault.hint("leave one of the two out"));
        return none;
    }
    // With `assumed: off`, assumed values of the stock's file do not fill in what the scene leaves out.
    let fills = of_stock.filter(|_| p.assumed == Assumed::On || !halation_is_assumed(stock));
    let entering = own.and_then(|h| h.entering).or_else(|| fills.map(|h| h.scattered));
    let stated = own.and_then(|h| h.transmittance.or_else(|| h.backing.map(Backing::transmittance)));
    let (Some(entering), Some(transmittance)) = (entering, stated.or_else(|| fills.map(|h| h.backing))) else {
        let fault = params.fault("halation", format!("{} does not say how much light its base reflects", stock.name));
        faults.push(fault.hint("write, for example, `halation: {entering: 0.3, backing: dye}`"));
        return none;
    };
    let thickness_mm = own.and_then(|h| h.thickness).map(|t| t.mm()).or_else(|| base.map(|b| b.thickness_mm));
    let index = own.and_then(|h| h.index).or_else(|| base.and_then(|b| b.index));
    let (Some(thickness_mm), Some(index)) = (thickness_mm, index) else {
        let missing = if thickness_mm.is_none() { "thickness" } else { "index" };
        let fault = params.fault("halation", format!("the {missing} of the base of {} is not known", stock.name));
        faults.push(fault.hint(
            "write, for example, `halation: {entering: 0.2, transmittance: 0.5, thickness: 0.125 mm, index: 1.48}`",
        ));
        return none;
    };
    let reflected = own.and_then(|h| h.reflected).or_else(|| of_stock.map(|h| h.reflected)).unwrap_or(0.0);
    let share = |layer: usize| of_stock.map_or(1.0, |h| h.layers[layer]);
    let base = |layer: usize| HalationBase {
        thickness_mm,
        index,
        entering: entering * share(layer),
        transmittance,
        reflected,
    };
    // Building it for an empty frame is enough to check the values.
    if let Err(error) = Halation::new(&base(0), &Raster::new(0, 0, 1.0)) {
        faults.push(params.fault("halation", error.to_string()));
        return none;
    }
    (0..stock.layers.len()).map(|layer| Some(base(layer)).filter(|b| b.entering > 0.0)).collect()
}
