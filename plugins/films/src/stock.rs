//! `film: stock`, film from a data file: exposed, developed, and printed, scanned or projected.

use crate::effects::{Assumed, Effects, HalationSetting, OpticsSetting, mtf50, pixel_mm};
use crate::frame::{FrameEffects, FrameParams, Laid};
use crate::metering::{METER, Meter, Metering, SpotParams, overruled, recorded_time_s};
use crate::view::{PaperParams, Picture, ScanParams, View, WhiteParams, seen};
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::frame::{
    Beside, DisplayPicture, ExposureChannel, ExposureFrame, Finished, FrameSize, ImageState, Wanted,
};
use spectra_core::math::pow;
use spectra_core::names;
use spectra_core::params::{Fault, Faults, Params, Positive, Time};
use spectra_core::registry::Context;
use spectra_core::resources::Resources;
use spectra_core::spectral::Channel;
use spectra_core::stage::{Film, Negative};
use spectra_film::display::channel;
use spectra_film::emulsion::Emulsion;
use spectra_film::optics::Optics;
use spectra_film::positive::{Reach, densities};
use spectra_film::print::{Print, metered_exposure_lx_s};
use spectra_film::push::pushed;
use spectra_film::raster::Raster;
use spectra_film::stock::{MeterResponse, Process, Stock};
use std::any::Any;

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
    /// Exposure time, s if bare; leave it out where the camera meters.
    pub exposure: Option<Positive<Time>>,
    /// How the camera finds its exposure: `manual`, `average` or `spot`. A metered frame is exposed so that the metered
    /// area gets 10/S lx s, the exposure of a mid gray.
    #[serde(default)]
    pub metering: Metering,
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
    /// Stops of push, or pull if negative, within the series of development times in the stock's file; 0 if left out.
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

/// A film from a data file.
#[derive(Clone, Debug)]
pub struct StockFilm {
    stock: Stock,
    development: String,
    emulsion: Emulsion,
    channels: Vec<Channel>,
    exposure_time_s: f64,
    /// An exposure time was stated, and the camera meters.
    is_overruled: bool,
    meter: Meter,
    effects: Effects,
    frame: Option<FrameEffects>,
    /// What a mid gray subject leaves on it.
    gray_lx_s: f64,
    /// Of the lens between film and picture, cycles/mm.
    mtf50: Option<f64>,
    /// What it ends in is no picture but a scale of densities.
    is_data: bool,
    picture: Picture,
    words: String,
}

impl StockFilm {
    /// The film that `params` describe.
    ///
    /// # Errors
    /// What is wrong with the parameters or with the stock's file.
    pub fn build(params: &Params, context: &Context<'_>) -> Result<Self, Faults> {
        let p: StockParams = params.parse()?;
        let stock = load_stock(&p.stock, "stock", params, context.resources)?;
        let mut faults = Faults::new();
        let Some(iso) = stock.iso.filter(|_| stock.process != Process::Print) else {
            let fault = params.fault("stock", format!("{} is not a camera film", stock.name));
            return Err(fault.hint("a print stock is named at `print`").into());
        };
        if p.exposure.is_none() && p.metering == Metering::Manual {
            let fault = params.fault("exposure", "missing key `exposure`");
            faults.push(fault.hint("add `exposure: 1/125 s`, or let the camera find it: `metering: average`"));
        }
        let developed = faults.take(develop_as(&p, params, &stock));
        let speed = p.iso.map_or(iso * pow(2.0, p.push.unwrap_or(0.0)), Positive::get);
        let meter = Meter::new(params, p.metering, p.spot, speed, p.compensation);
        let meter = faults.take(meter.map_err(Faults::from));
        let blind = |error| Faults::from(params.fault("stock", format!("{}: {error}", stock.name)));
        let channels = faults.take(stock.channels(&context.grid).map_err(blind));
        let (Some((emulsion, development)), Some(meter), Some(mut channels)) = (developed, meter, channels) else {
            return Err(faults);
        };
        let effects = faults.take(Effects::new(&(&p).into(), params, &stock, &emulsion));
        let Some(effects) = faults.into_result(effects)? else { return Err(Faults::new()) };
        let gray_lx_s = metered_exposure_lx_s(speed);
        let seen = seen(&p, params, context.resources, &stock, &emulsion, gray_lx_s)?;
        let frame = p.frame.map(|frame| FrameEffects::new(frame, &stock.name, p.grain_seed));
        let own = channels.first().filter(|_| stock.meter == MeterResponse::Film).cloned();
        channels.extend(meter.channel(&context.grid, own.as_ref()));
        let (exposure_time_s, is_overruled) = recorded_time_s(p.exposure, p.metering);
        let (picture, words) = (seen.picture, seen.words);
        Ok(Self {
            stock,
            development,
            emulsion,
            channels,
            exposure_time_s,
            is_overruled,
            meter,
            effects,
            frame,
            gray_lx_s,
            mtf50: mtf50(p.optics, p.view),
            is_data: p.scan.is_some_and(|scan| scan != ScanParams::Picture),
            picture,
            words,
        })
    }

    /// The stock.
    #[must_use]
    pub fn stock(&self) -> &Stock {
        &self.stock
    }

    /// The stock as developed.
    #[must_use]
    pub fn emulsion(&self) -> &Emulsion {
        &self.emulsion
    }

    /// The print on paper that it ends in, as metered, if it does.
    #[must_use]
    pub fn print(&self) -> Option<&Print> {
        match &self.picture {
            Picture::Paper(print) => Some(&print.metered),
            Picture::Positive(_) => None,
        }
    }

    /// What the layers are exposed to, lx s, after scatter in the emulsion and reflection from the base: a plane a layer, in
    /// the order of the stock.
    ///
    /// # Errors
    /// A text that says which channel is missing.
    pub fn exposed(&self, exposure: &ExposureFrame) -> Result<Vec<Vec<f32>>, String> {
        let factor = self.meter.factor(exposure) as f32;
        let raster = self.effects.raster(exposure.size)?;
        let mut spare = Vec::new();
        let layers = self.stock.layers.iter().enumerate().map(|(i, layer)| {
            let channel = channel(exposure, &layer.name).map_err(|error| error.to_string())?;
            let mut plane = self.effects.spread(i, &channel.values, &raster, &mut spare)?;
            plane.iter_mut().for_each(|v| *v *= factor);
            Ok(plane)
        });
        layers.collect()
    }

    /// The developed film: a plane of amounts a layer (see [`spectra_film::deposit::Deposit`]), in the order of the stock.
    ///
    /// # Errors
    /// A text that says which channel is missing.
    pub fn developed(&self, exposure: &ExposureFrame) -> Result<Vec<Vec<f32>>, String> {
        self.planes(exposure, false).map(|planes| planes.amounts)
    }

    /// What a place without film is shown as.
    fn hole(&self, reach: Reach) -> [f32; 3] {
        match &self.picture {
            Picture::Paper(print) => [print.metered.picture(0.0) as f32; 3],
            Picture::Positive(positive) => positive.hole(reach).map(|v| v as f32),
        }
    }

    /// The developed film, and where it is `kept` what its layers were exposed to, as layers of a file.
    fn planes(&self, exposure: &ExposureFrame, kept: bool) -> Result<Planes, String> {
        let factor = self.meter.factor(exposure);
        let time_s = self.exposure_time_s * factor;
        let effect = self.stock.reciprocity.as_ref().map_or(1.0, |r| r.effect(time_s));
        let frame_raster = self.effects.raster(exposure.size)?;
        let laid = self.frame.as_ref().map(|frame| frame.laid(&frame_raster));
        let raster = laid.as_ref().map_or(frame_raster, |laid| laid.raster);
        let breathing = self.frame.as_ref().map_or(1.0, FrameEffects::exposure);
        let (mut exposed, mut spare) = (Vec::new(), Vec::new());
        let spread = self.stock.layers.iter().enumerate().map(|(i, layer)| {
            let channel = channel(exposure, &layer.name).map_err(|error| error.to_string())?;
            let mut plane = self.effects.spread(i, &channel.values, &frame_raster, &mut spare)?;
            if let Some(laid) = &laid {
                plane = laid.lay(plane, &frame_raster);
                laid.print(&mut plane, (EDGE_PRINT * self.gray_lx_s / (factor * effect * breathing)) as f32);
            }
            if kept {
                let got = plane.iter().map(|v| *v * (factor * breathing) as f32).collect();
                exposed.push(layer_of("exposure", &layer.name, "lx s", got));
            }
            Ok(plane)
        });
        let mut amounts = spread.collect::<Result<Vec<_>, String>>()?;
        drop(spare);
        self.emulsion.develop_all(&mut amounts, factor * effect * breathing);
        for (i, plane) in amounts.iter_mut().enumerate() {
            let range = self.emulsion.range(i);
            self.effects.edges(i, plane, &self.emulsion, &raster);
            self.effects.grain(i, plane, range.0, &raster)?;
            if let (Some(frame), Some(laid)) = (&self.frame, &laid) {
                let clear = self.emulsion.amount(i, f64::NEG_INFINITY);
                frame.soil(plane, laid, range, clear, self.stock.process == Process::Reversal);
            }
        }
        Ok(Planes { amounts, exposed, raster, laid })
    }

    /// The developed film as the lens after it sees it, and what is `wanted` beside it, as layers of a file.
    fn seen_through(&self, exposure: &ExposureFrame, wanted: Wanted) -> Result<(Planes, Vec<ExposureChannel>), String> {
        let mut planes = self.planes(exposure, wanted.layers)?;
        let mut layers = std::mem::take(&mut planes.exposed);
        if wanted.layers {
            let amounts: Vec<&[f32]> = planes.amounts.iter().map(Vec::as_slice).collect();
            let density = densities(&self.stock, &self.emulsion, &amounts);
            let named = self.stock.layers.iter().zip(density);
            layers.extend(named.map(|(layer, values)| layer_of("density", &layer.name, "", values)));
        }
        if let Some(mtf50) = self.mtf50 {
            Optics::new(mtf50, pixel_mm(&exposure.size)).apply_to_all(&mut planes.amounts, planes.raster.width);
        }
        Ok((planes, layers))
    }

    /// The picture of a developed film.
    fn printed(&self, negative: &Planes, layers: Vec<ExposureChannel>, wanted: Wanted) -> Result<Finished, String> {
        let Planes { amounts, raster, laid, .. } = negative;
        let planes: Vec<&[f32]> = amounts.iter().map(Vec::as_slice).collect();
        let (mut shown, mut open): (Vec<[f32; 3]>, _) = match (&self.picture, &planes[..]) {
            // Paper is a gray between its own black and white: any screen has it.
            (Picture::Paper(print), [silver]) => (print.pictures(silver)?.into_iter().map(|v| [v; 3]).collect(), None),
            (Picture::Positive(positive), planes) => {
                (positive.picture(planes), wanted.open.then(|| positive.open_picture(planes)))
            }
            // `build` makes paper prints of one layer only.
            (Picture::Paper(_), _) => return Err(format!("{} is not a film with one layer", self.stock.name)),
        };
        if let Some(laid) = laid {
            laid.punch(&mut shown, self.hole(Reach::Screen));
            if let Some(open) = &mut open {
                laid.punch(open, self.hole(Reach::Open));
            }
        }
        let picture = |rgb| DisplayPicture { width_px: raster.width as u32, height_px: raster.height as u32, rgb };
        Ok(Finished { shown: picture(shown), beside: Beside { open: open.map(picture), layers, white: None } })
    }
}

/// Exposure of what stands on a film's edge, over that of a mid gray: dense on any film.
const EDGE_PRINT: f64 = 30.0;

/// A developed film.
struct Planes {
    /// A plane of amounts a layer.
    amounts: Vec<Vec<f32>>,
    /// What the layers were exposed to, if it was kept.
    exposed: Vec<ExposureChannel>,
    /// Where its pixels lie: with a border it is larger than the frame.
    raster: Raster,
    laid: Option<Laid>,
}

/// A layer of a file.
fn layer_of(group: &str, layer: &str, unit: &str, values: Vec<f32>) -> ExposureChannel {
    ExposureChannel { name: format!("{group}.{layer}"), unit: unit.to_owned(), values }
}

/// The emulsion, and the name of its development.
fn develop_as(p: &StockParams, params: &Params, stock: &Stock) -> Result<(Emulsion, String), Faults> {
    let known: Vec<&str> = stock.developments().collect();
    let chosen = p.development.as_deref().or(known.first().copied()).unwrap_or_default();
    if !known.contains(&chosen) {
        let text = format!("{} has no curve for the development `{chosen}`", stock.name);
        return Err(params.fault("development", text).hint(names::hint(chosen, &known, "")).into());
    }
    let Some(stops) = p.push else {
        let emulsion = Emulsion::new(stock, chosen).map_err(|e| params.fault("stock", e.to_string()))?;
        return Ok((emulsion, chosen.to_owned()));
    };
    let developed = pushed(stock, chosen, stops)
        .map_err(|e| params.fault("push", e.to_string()).hint("or change `iso`: the same film, exposed otherwise"))?;
    let emulsion = Emulsion::with_curves(stock, developed.curves).map_err(|e| params.fault("push", e.to_string()))?;
    Ok((emulsion, format!("{:.1} min (pushed {stops:+} stops)", developed.minutes)))
}

/// The stock that `key` names.
pub(crate) fn load_stock(name: &str, key: &str, params: &Params, resources: &dyn Resources) -> Result<Stock, Faults> {
    Stock::load(name, resources).map_err(|faults| place_at(faults, params, key, name))
}

/// A file that is not found has no place of its own: the key that names it has.
fn place_at(faults: Faults, params: &Params, key: &str, name: &str) -> Faults {
    let place = |fault: Fault| {
        if fault.place.is_some() {
            return fault;
        }
        let known: Vec<&str> = Stock::bundled().collect();
        let generic = |hint: &String| hint.starts_with("a file is looked for") && !name.contains('.');
        let hint = fault.hint.filter(|hint| !generic(hint));
        let hint = hint.unwrap_or_else(|| names::hint(name, &known, "spectra list stock"));
        params.fault(key, fault.message).hint(hint)
    };
    faults.into_iter().map(place).collect::<Vec<_>>().into()
}

impl Film for StockFilm {
    fn channels(&self) -> Vec<Channel> {
        self.channels.clone()
    }

    fn picture_channels(&self) -> usize {
        self.channels.iter().filter(|c| c.name != METER).count()
    }

    fn exposure_time_s(&self) -> f64 {
        self.exposure_time_s
    }

    fn metered_time_s(&self, exposure: &ExposureFrame) -> f64 {
        self.exposure_time_s * self.meter.factor(exposure)
    }

    fn is_metered(&self) -> bool {
        self.meter.is_on()
    }

    fn is_metered_at(&self, size: &FrameSize, pixel: u32) -> bool {
        self.meter.looks_at(size, pixel)
    }

    fn warnings(&self) -> Vec<String> {
        overruled(self.is_overruled)
    }

    fn check_frame(&self, size: &FrameSize) -> Result<(), [String; 2]> {
        if let Some(frame) = &self.frame {
            let [across, down] = pixel_mm(size);
            if (across / down - 1.0).abs() > 0.01 {
                let text = format!("`frame` needs square pixels, not {across:.5} x {down:.5} mm");
                return Err([text, "a resolution of the format's shape".to_owned()]);
            }
            frame.check(size)?;
        }
        self.effects.check_frame(size)
    }

    fn name(&self) -> String {
        self.stock.name.clone()
    }

    fn develop(&self, exposure: &ExposureFrame) -> Result<DisplayPicture, String> {
        self.finish(exposure, Wanted::default()).map(|finished| finished.shown)
    }

    fn finish(&self, exposure: &ExposureFrame, wanted: Wanted) -> Result<Finished, String> {
        let (negative, layers) = self.seen_through(exposure, wanted)?;
        self.printed(&negative, layers, wanted)
    }

    fn negative(&self, exposure: &ExposureFrame, wanted: Wanted) -> Result<Option<Negative>, String> {
        Ok(Some(Box::new(self.seen_through(exposure, wanted)?)))
    }

    fn print(&self, negative: &Negative, wanted: Wanted) -> Result<Finished, String> {
        let made = negative.downcast_ref::<(Planes, Vec<ExposureChannel>)>();
        let (negative, layers) = made.ok_or_else(|| format!("{} makes other negatives", self.stock.name))?;
        self.printed(negative, layers.clone(), wanted)
    }

    fn develops_as(&self, other: &dyn Film) -> bool {
        let of = |film: &Self| (film.exposure_time_s, film.meter, film.gray_lx_s, film.mtf50);
        (other as &dyn Any).downcast_ref::<Self>().is_some_and(|other| {
            of(self) == of(other)
                && self.effects == other.effects
                && self.frame == other.frame
                && self.emulsion == other.emulsion
                && self.stock == other.stock
        })
    }

    fn image_state(&self) -> ImageState {
        if self.is_data { ImageState::Data } else { ImageState::DisplayReferred }
    }

    fn has_layers(&self) -> bool {
        true
    }

    fn set_frame(&mut self, frame: u64) {
        if let Some(effects) = &mut self.frame {
            effects.set_frame(frame);
        }
        self.effects.set_frame(frame);
    }

    fn describe(&self) -> String {
        let named = |l: &spectra_film::stock::Layer| l.development(&self.development).is_some_and(|d| d.assumed);
        let mut assumed = Vec::new();
        if self.stock.layers.iter().any(named) {
            assumed.push("curve");
        }
        assumed.extend(self.effects.assumed());
        let assumed = match &assumed[..] {
            [] => String::new(),
            [one] => format!(" ({one} assumed)"),
            [most @ .., last] => format!(" ({} and {last} assumed)", most.join(", ")),
        };
        let iso = self.stock.speed_text().map_or(String::new(), |speed| format!(", {speed}"));
        format!(
            "{}{iso}, {} development{assumed}, {}, {}",
            self.stock.name,
            self.development,
            self.meter.words(self.exposure_time_s),
            self.words
        )
    }
}

fn build(params: &Params, context: &Context<'_>) -> Result<Box<dyn Film>, Faults> {
    Ok(Box::new(StockFilm::build(params, context)?))
}

spectra_core::register!(film "stock" (default): StockParams, build);
