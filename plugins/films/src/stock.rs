//! The film kind `stock`: film from a data file, exposed, developed, and printed, scanned or projected.

use crate::camera::{Camera, exposed_by_camera};
use crate::described_process::build_process;
use crate::development::develop_as;
use crate::effects::{check_frame, effects, mtf50, pixel_mm, raster};
use crate::frame::{FrameEffects, Laid};
use crate::metering::{ExposureSettings, Meter, Metering};
use crate::misexposure::{ends, misexposure};
use crate::settings::StockParams;
use crate::stocks::load_stock;
use crate::view::{Picture, ScanParams};
use spectra_core::frame::{
    DisplayPicture, ExposureChannel, ExposureFrame, ExtraData, ExtraRequest, FinishedPicture, FrameSize, ImageState,
};
use spectra_core::math::pow;
use spectra_core::params::{Fault, Faults, Params, Positive};
use spectra_core::registry::Context;
use spectra_core::stage::{Film, GrainNoise, Misexposure, Negative};
use spectra_film::develop::{Effects, develop};
use spectra_film::display::channel;
use spectra_film::emulsion::Emulsion;
use spectra_film::optics::Optics;
use spectra_film::positive::{GamutLimit, densities};
use spectra_film::print::{Print, metered_exposure_lx_s};
use spectra_film::raster::Raster;
use spectra_film::stock::{MeterResponse, Process, Stock, unknown_reciprocity};
use std::any::Any;

/// A camera film from a data file, with its development and the way it is viewed.
#[derive(Clone, Debug)]
pub struct StockFilm {
    stock: Stock,
    development: String,
    emulsion: Emulsion,
    camera: Camera,
    effects: Effects,
    frame: Option<FrameEffects>,
    /// Exposure of a mid gray subject, lx s.
    gray_lx_s: f64,
    /// Frequency at which the lens between film and picture keeps half of the contrast, cycles/mm; `None` without a lens.
    mtf50: Option<f64>,
    /// Whether the result is a scale of densities and not a picture.
    is_data: bool,
    picture: Picture,
    words: String,
}

impl StockFilm {
    /// Builds the film that `params` describe.
    ///
    /// # Errors
    /// Faults in the parameters or in the stock's file.
    pub fn build(params: &Params, context: &Context<'_>) -> Result<Self, Faults> {
        let p: StockParams = params.parse()?;
        let stock = load_stock(&p.stock, "stock", params, context.resources)?;
        let mut faults = Faults::new();
        let Some(iso) = stock.iso.filter(|_| stock.process != Process::Print) else {
            let fault = params.fault("stock", format!("{} is not a camera film", stock.name));
            return Err(fault.hint("name a print stock at `print`").into());
        };
        let exposed = faults.take(ExposureSettings::new(p.exposure, p.metering, params).map_err(Faults::from));
        let metering = exposed.map_or(Metering::Average, |exposed| exposed.metering);
        let developed = faults.take(develop_as(&p, params, &stock));
        let speed = p.iso.map_or(iso * pow(2.0, p.push.unwrap_or(0.0)), Positive::get);
        let meter = Meter::new(params, metering, p.spot, speed, p.compensation);
        let meter = faults.take(meter.map_err(Faults::from));
        let blind = |error| Faults::from(params.fault("stock", format!("{}: {error}", stock.name)));
        let channels = faults.take(stock.channels(&context.grid).map_err(blind));
        let (Some((emulsion, development)), Some(exposed), Some(meter), Some(mut channels)) =
            (developed, exposed, meter, channels)
        else {
            return Err(faults);
        };
        let effects = faults.take(effects(&(&p).into(), params, &stock, &emulsion));
        let Some(effects) = faults.into_result(effects)? else { return Err(Faults::new()) };
        let gray_lx_s = metered_exposure_lx_s(speed);
        // Curves that do not match the stated speed are the likeliest reason why a film cannot be printed, and otherwise make the picture
        // too light or too dark.
        let doubts = stock.warnings();
        let seen =
            build_process(&p, params, context.resources, &stock, &emulsion, gray_lx_s).map_err(|mut faults| {
                for fault in faults.0.iter_mut().filter(|fault| fault.hint.is_none()) {
                    fault.hint = doubts.first().cloned();
                }
                faults
            })?;
        // Bundled stocks keep their makers' speeds, whatever the digitized curves give, so only the user's own files are checked.
        let is_own = p.stock.ends_with(".yaml") || p.stock.ends_with(".yml");
        for doubt in doubts.iter().filter(|_| is_own) {
            let (what, remedy) = doubt.split_once(": ").unwrap_or((doubt.as_str(), "see `spectra film info`"));
            context.warn(params.fault("stock", format!("{}: {what}", stock.name)).hint(remedy));
        }
        let frame = p.frame.map(|frame| FrameEffects::new(frame, &stock.name, p.grain_seed));
        let own = channels.first().filter(|_| stock.meter == MeterResponse::Film).cloned();
        channels.extend(meter.channel(&context.grid, own.as_ref()));
        let (picture, words) = (seen.picture, seen.words);
        Ok(Self {
            stock,
            development,
            emulsion,
            camera: Camera { channels, settings: exposed, frames: p.meter, meter },
            effects,
            frame,
            gray_lx_s,
            mtf50: mtf50(p.optics, p.view),
            is_data: p.scan.is_some_and(|scan| scan != ScanParams::Picture),
            picture,
            words,
        })
    }

    /// The stock, as read from its file.
    #[must_use]
    pub fn stock(&self) -> &Stock {
        &self.stock
    }

    /// The emulsion of the stock, with its curves for the chosen development.
    #[must_use]
    pub fn emulsion(&self) -> &Emulsion {
        &self.emulsion
    }

    /// The print on paper, at the metered exposure; `None` if the film is not printed on paper.
    #[must_use]
    pub fn print(&self) -> Option<&Print> {
        match &self.picture {
            Picture::Paper(print) => Some(&print.metered),
            Picture::Positive(_) => None,
        }
    }

    /// Returns the exposure of the layers, lx s, after scatter in the emulsion and reflection from the base: one plane per layer, in
    /// the order of the stock.
    ///
    /// # Errors
    /// A message that names the missing channel, or says that pixels must be square.
    pub fn exposed(&self, exposure: &ExposureFrame) -> Result<Vec<Vec<f32>>, Fault> {
        let factor = self.camera.meter.factor(exposure) as f32;
        let raster = raster(&self.effects, exposure.size)?;
        let mut spare = Vec::new();
        let layers = self.light(exposure)?.into_iter().enumerate().map(|(i, light)| {
            let mut plane = self.effects.spread(i, light, &raster, &mut spare)?;
            plane.iter_mut().for_each(|v| *v *= factor);
            Ok(plane)
        });
        layers.collect()
    }

    /// Develops the film and returns one plane of amounts per layer (see [`spectra_film::deposit::Deposit`]), in the order of the stock.
    ///
    /// # Errors
    /// A message that names the missing channel, or says that pixels must be square.
    pub fn developed(&self, exposure: &ExposureFrame) -> Result<Vec<Vec<f32>>, Fault> {
        self.planes(exposure, false).map(|planes| planes.amounts)
    }

    /// Returns the color, linear RGB, of a place where there is no film.
    fn hole(&self, reach: GamutLimit) -> [f32; 3] {
        match &self.picture {
            Picture::Paper(print) => [print.metered.picture(0.0) as f32; 3],
            Picture::Positive(positive) => positive.hole(reach).map(|v| v as f32),
        }
    }

    /// Returns the planes of `exposure` that the layers record, in the order of the stock.
    fn light<'a>(&self, exposure: &'a ExposureFrame) -> Result<Vec<&'a [f32]>, Fault> {
        let layers = self.stock.layers.iter();
        let planes = layers.map(|layer| channel(exposure, &layer.name).map(|channel| &channel.values[..]));
        Ok(planes.collect::<Result<_, _>>().map_err(|error| error.to_string())?)
    }

    /// Develops the film; if `kept`, also returns the exposure of its layers as layers of a file.
    fn planes(&self, exposure: &ExposureFrame, kept: bool) -> Result<DevelopedPlanes, Fault> {
        let metered = self.camera.meter.factor(exposure);
        let effect = self.reciprocity_effect(metered);
        let breathing = self.breathing();
        let factor = metered * effect * breathing;
        let gate = raster(&self.effects, exposure.size)?;
        let laid = self.frame.as_ref().map(|frame| frame.laid(&gate));
        let raster = laid.as_ref().map_or(gate, |laid| laid.raster);
        let mut exposed = Vec::new();
        let lay = |i: usize, mut plane: Vec<f32>| {
            if let Some(laid) = &laid {
                plane = laid.lay(plane, &gate);
                laid.print(&mut plane, (EDGE_PRINT * self.gray_lx_s / factor) as f32);
            }
            if kept {
                let got = plane.iter().map(|v| *v * (metered * breathing) as f32).collect();
                exposed.push(layer_of("exposure", &self.stock.layers[i].name, "lx s", got));
            }
            plane
        };
        let soil = |i: usize, plane: &mut [f32]| {
            if let (Some(frame), Some(laid)) = (&self.frame, &laid) {
                let clear = self.emulsion.amount(i, f64::NEG_INFINITY);
                frame.soil(plane, laid, self.emulsion.range(i), clear, self.stock.process == Process::Reversal);
            }
        };
        let light = self.light(exposure)?;
        let amounts = develop(&self.emulsion, &self.effects, &light, factor, [&gate, &raster], lay, soil)?;
        Ok(DevelopedPlanes { amounts, exposed, raster, laid })
    }

    /// Returns the factor by which flicker changes the exposure of the frame.
    fn breathing(&self) -> f64 {
        self.frame.as_ref().map_or(1.0, FrameEffects::exposure)
    }

    /// Returns how much the exposure of a frame counts, relative to a short one, if the meter lengthens it by the factor `metered`.
    fn reciprocity_effect(&self, metered: f64) -> f64 {
        self.stock.reciprocity.as_ref().map_or(1.0, |r| r.effect(self.camera.settings.time_s * metered))
    }

    /// Develops the film, applies the blur of the lens that views it, and returns the other `wanted` planes as layers of a file.
    fn seen_through(
        &self,
        exposure: &ExposureFrame,
        wanted: ExtraRequest,
    ) -> Result<(DevelopedPlanes, Vec<ExposureChannel>), Fault> {
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

    /// Prints, scans or projects a developed film and returns the finished picture.
    fn printed(
        &self,
        negative: &DevelopedPlanes,
        mut layers: Vec<ExposureChannel>,
        wanted: ExtraRequest,
    ) -> Result<FinishedPicture, Fault> {
        let DevelopedPlanes { amounts, raster, laid, .. } = negative;
        let planes: Vec<&[f32]> = amounts.iter().map(Vec::as_slice).collect();
        if wanted.layers {
            let print = match (&self.picture, &planes[..]) {
                (Picture::Paper(print), [silver]) => Some(vec![("silver".to_owned(), print.densities(silver)?)]),
                (Picture::Positive(positive), planes) => positive.print_densities(planes),
                (Picture::Paper(_), _) => None,
            };
            let print = print.into_iter().flatten();
            layers.extend(print.map(|(layer, values)| layer_of("print", &layer, "", values)));
        }
        let (mut shown, mut open): (Vec<[f32; 3]>, _) = match (&self.picture, &planes[..]) {
            // A print on paper is a gray between the paper's black and white, which any screen can show.
            (Picture::Paper(print), [silver]) => (print.pictures(silver)?.into_iter().map(|v| [v; 3]).collect(), None),
            (Picture::Positive(positive), planes) => {
                (positive.picture(planes), wanted.unclamped.then(|| positive.unclamped_picture(planes)))
            }
            // `build` makes paper prints of one layer only.
            (Picture::Paper(_), _) => {
                return Err(Fault::new(format!("{}: a print on paper needs a single-layer film", self.stock.name)));
            }
        };
        if let Some(laid) = laid {
            laid.punch(&mut shown, self.hole(GamutLimit::Screen));
            if let Some(open) = &mut open {
                laid.punch(open, self.hole(GamutLimit::Open));
            }
        }
        let picture = |rgb| DisplayPicture { width_px: raster.width as u32, height_px: raster.height as u32, rgb };
        Ok(FinishedPicture {
            display: picture(shown),
            extra: ExtraData { unclamped: open.map(picture), layers, white: None },
        })
    }
}

/// Exposure of the letters on a film's edge, as a multiple of the exposure of a mid gray; dense on any film.
const EDGE_PRINT: f64 = 30.0;

/// The planes of a developed film.
struct DevelopedPlanes {
    /// One plane of amounts per layer.
    amounts: Vec<Vec<f32>>,
    /// Exposure of the layers, if it was kept.
    exposed: Vec<ExposureChannel>,
    /// Position of the pixels on the film; with a border the planes are larger than the frame.
    raster: Raster,
    laid: Option<Laid>,
}

/// Returns a plane as a layer of a file, named `group.layer`.
pub(crate) fn layer_of(group: &str, layer: &str, unit: &str, values: Vec<f32>) -> ExposureChannel {
    ExposureChannel { name: format!("{group}.{layer}"), unit: unit.to_owned(), values }
}

impl Film for StockFilm {
    exposed_by_camera!();

    fn grain_noise(&self, metered: &ExposureFrame) -> Option<Vec<GrainNoise>> {
        let factor = self.camera.meter.factor(metered);
        let factor = factor * self.reciprocity_effect(factor) * self.breathing();
        let pitch_mm = raster(&self.effects, metered.size).ok()?.pitch_mm;
        let layers = 0..self.emulsion.layers();
        layers.map(|layer| self.effects.grain_noise(layer, &self.emulsion, factor, pitch_mm)).collect()
    }

    fn check_frame(&self, size: &FrameSize) -> Result<(), [String; 2]> {
        if let Some(frame) = &self.frame {
            let [across, down] = pixel_mm(size);
            if (across / down - 1.0).abs() > 0.01 {
                let text = format!("`frame` needs square pixels, not {across:.5} x {down:.5} mm");
                return Err([text, "set a `resolution` with the aspect ratio of the format".to_owned()]);
            }
            frame.check(size)?;
        }
        check_frame(&self.effects, size)
    }

    fn misexposure(&self, exposure: &ExposureFrame) -> Option<Misexposure> {
        let factor = self.camera.meter.factor(exposure);
        let effect = self.reciprocity_effect(factor);
        let layers = self.stock.layers.iter().enumerate().map(|(i, layer)| {
            let plane = &exposure.channel(&layer.name)?.values[..];
            let curve = |x: f64| match &self.picture {
                Picture::Paper(print) => print.metered.picture(self.emulsion.amount(i, x)),
                Picture::Positive(_) => self.emulsion.amount(i, x),
            };
            Some((plane, ends(curve)))
        });
        misexposure(&layers.collect::<Option<Vec<_>>>()?, factor * effect)
    }

    fn balanced_channels(&self) -> usize {
        if self.stock.layers.len() == 3 { 3 } else { 0 }
    }

    fn long_exposure_warning(&self, time_s: f64) -> Option<String> {
        unknown_reciprocity(self.stock.reciprocity.as_ref(), &self.stock.name, time_s)
    }

    fn gray_time_s(&self, exposure: &ExposureFrame) -> Option<f64> {
        let plane = &exposure.channel(&self.stock.layers.first()?.name)?.values;
        let mean = plane.iter().map(|v| f64::from(*v)).sum::<f64>() / plane.len() as f64;
        Some(self.camera.settings.time_s * self.gray_lx_s / mean).filter(|time| time.is_finite() && *time > 0.0)
    }

    fn name(&self) -> String {
        self.stock.name.clone()
    }

    fn develop(&self, exposure: &ExposureFrame) -> Result<DisplayPicture, Fault> {
        self.finish(exposure, ExtraRequest::default()).map(|finished| finished.display)
    }

    fn finish(&self, exposure: &ExposureFrame, wanted: ExtraRequest) -> Result<FinishedPicture, Fault> {
        let (negative, layers) = self.seen_through(exposure, wanted)?;
        self.printed(&negative, layers, wanted)
    }

    fn negative(&self, exposure: &ExposureFrame, wanted: ExtraRequest) -> Result<Option<Negative>, Fault> {
        Ok(Some(Box::new(self.seen_through(exposure, wanted)?)))
    }

    fn print(&self, negative: &Negative, wanted: ExtraRequest) -> Result<FinishedPicture, Fault> {
        let made = negative.downcast_ref::<(DevelopedPlanes, Vec<ExposureChannel>)>();
        let (negative, layers) = made.ok_or_else(|| format!("{} did not make this negative", self.stock.name))?;
        self.printed(negative, layers.clone(), wanted)
    }

    fn develops_as(&self, other: &dyn Film) -> bool {
        let of = |film: &Self| (film.camera.settings.time_s, film.camera.meter, film.gray_lx_s, film.mtf50);
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
        assumed.extend(&self.effects.assumed);
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
            self.camera.meter.words(self.camera.settings.time_s),
            self.words
        )
    }
}

fn build(params: &Params, context: &Context<'_>) -> Result<Box<dyn Film>, Faults> {
    Ok(Box::new(StockFilm::build(params, context)?))
}

spectra_core::register!(film "stock" (default): StockParams, build);
