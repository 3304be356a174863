//! The film kind `three-strip`: three separation negatives behind a beam splitter, printed by dye transfer.

use crate::camera::{Camera, exposed_by_camera};
use crate::effects::{HalationSetting, Off, Switches, check_frame, effects, mtf50, pixel_mm, raster};
use crate::metering::{ExposureSettings, Meter, Metering};
use crate::stock::layer_of;
use crate::stocks::load_stock;
use crate::three_strip_settings::{RecordParams, ThreeStripParams};
use spectra_core::frame::{DisplayPicture, ExposureFrame, ExtraData, ExtraRequest, FinishedPicture, FrameSize};
use spectra_core::names;
use spectra_core::params::{Fault, Faults, Params, Positive as AboveZero};
use spectra_core::registry::Context;
use spectra_core::spectral::{BAND, Channel};
use spectra_core::stage::{Film, GrainNoise};
use spectra_film::develop::{Effects, develop};
use spectra_film::display::channel;
use spectra_film::emulsion::Emulsion;
use spectra_film::optics::Optics;
use spectra_film::positive::Positive;
use spectra_film::print::metered_exposure_lx_s;
use spectra_film::stock::{Reciprocity, Stock, unknown_reciprocity};
use spectra_film::viewing_options::ViewingOptions;
use spectra_spectrum::constants::LUMINOUS_EFFICACY_LM_PER_W;
use spectra_spectrum::{Emission, Transmittance, find_emission_in, find_transmittance_in, v_lambda};

/// A three-strip camera and its dye-transfer print.
#[derive(Clone, Debug)]
pub struct ThreeStrip {
    camera: Camera,
    positive: Positive,
    /// Emulsion of each record, in the order of the print's layers.
    developed: [Emulsion; 3],
    effects: [Effects; 3],
    /// Reciprocity failure of each record; `None` if it is not known.
    reciprocity: [Option<Reciprocity>; 3],
    /// Names of the stocks whose reciprocity failure is not known, separated by commas.
    unknown: String,
    /// Frequency at which matrices and dye transfer keep half of the contrast, cycles/mm; `None` if they lose nothing.
    mtf50: Option<f64>,
    words: String,
}

/// Default ISO speed of the camera, about its speed in daylight in 1935.
const SPEED: f64 = 5.0;

/// Names of the records, in the order of the print's layers.
const RECORDS: [&str; 3] = ["blue", "green", "red"];
/// Index of the front film of the pair; `RED` is the film behind it.
const BLUE: usize = 0;
const RED: usize = 2;

impl ThreeStrip {
    /// Builds the camera that `params` describe.
    ///
    /// # Errors
    /// Faults in the parameters or in a stock's file.
    pub fn build(params: &Params, context: &Context<'_>) -> Result<Self, Faults> {
        let p: ThreeStripParams = params.parse()?;
        let iso = p.iso.map_or(SPEED, AboveZero::get);
        let mut faults = Faults::new();
        let exposed = faults.take(ExposureSettings::new(p.exposure, p.metering, params).map_err(Faults::from));
        let metering = exposed.map_or(Metering::Average, |exposed| exposed.metering);
        let meter = Meter::new(params, metering, p.spot, iso, p.compensation);
        let meter = faults.take(meter.map_err(Faults::from));
        let light = |key: &str, name: &str| {
            find_emission_in(name, context.resources).map_err(|error| error.faults(|text| params.fault(key, text)))
        };
        let balance = faults.take(light("balance", &p.balance));
        let view = faults.take(light("light", &p.light));
        let print = faults.take(load_stock(&p.print, "print", params, context.resources));
        let records = RECORDS
            .iter()
            .zip([&p.blue, &p.green, &p.red])
            .map(|(name, record)| faults.take(Record::new(name, record, params, context)));
        let records: Vec<Option<Record>> = records.collect();
        let (Some(exposed), Some(meter), Some(balance), Some(view), Some(print)) =
            (exposed, meter, balance, view, print)
        else {
            return Err(faults);
        };
        let Some(records) = records.into_iter().collect::<Option<Vec<Record>>>() else { return Err(faults) };
        let mut channels = Vec::new();
        for record in &records {
            channels.extend(faults.take(record.channel(&balance, params, context)));
        }
        faults.into_result(())?;
        channels.extend(meter.channel(&context.grid, None));
        let look = ViewingOptions { white: p.white.into(), black: p.black.into(), surround: p.surround.into() };
        let positive = dye_transfer(&records, &print, &view, look, params)?;
        // Each record is exposed for the speed of its own stock, so that a mid gray gets the density it should have on that stock.
        let gray = metered_exposure_lx_s(iso);
        let scaled: Vec<f64> = records.iter().map(|r| metered_exposure_lx_s(r.iso) / gray).collect();
        for (channel, scale) in channels.iter_mut().zip(&scaled) {
            channel.response.iter_mut().for_each(|r| *r *= scale);
        }
        let stocks: Vec<&str> = records.iter().map(|r| r.name.as_str()).collect();
        let words = format!("three-strip camera, ISO {iso} ({}), printed as {}", stocks.join(", "), print.name);
        let (mut developed, mut record_effects) = (Vec::new(), Vec::new());
        for (i, record) in records.iter().enumerate() {
            let (own, own_effects) = record.film(i, &p, params)?;
            record_effects.push(own_effects);
            developed.push(own);
        }
        let (Ok(developed), Ok(effects)) = (developed.try_into(), record_effects.try_into()) else {
            return Err(params.fault_here("three records are expected").into());
        };
        let mtf50 = mtf50(p.optics, None);
        let reciprocity = [0, 1, 2].map(|i| records[i].stock.reciprocity.clone());
        let mut unknown: Vec<&str> =
            records.iter().filter(|r| r.stock.reciprocity.is_none()).map(|r| r.name.as_str()).collect();
        unknown.dedup();
        let unknown = unknown.join(", ");
        Ok(Self {
            camera: Camera { channels, settings: exposed, frames: p.meter, meter },
            positive,
            developed,
            effects,
            reciprocity,
            unknown,
            mtf50,
            words,
        })
    }
}

impl ThreeStrip {
    /// Returns how much the exposure of record `i` counts, relative to a short one, if the meter lengthens it by the factor `metered`.
    fn reciprocity_effect(&self, i: usize, metered: f64) -> f64 {
        self.reciprocity[i].as_ref().map_or(1.0, |r| r.effect(self.camera.settings.time_s * metered))
    }

    /// Develops the three negatives and returns their densities, one plane each, in the order blue, green, red.
    ///
    /// # Errors
    /// A message that names the missing channel, or says that pixels must be square.
    pub fn negatives(&self, exposure: &ExposureFrame) -> Result<Vec<Vec<f32>>, Fault> {
        self.records(exposure, |_, _, _| ())
    }

    /// Develops the three negatives. For each record, calls `exposed` with its name, its plane of exposure after scatter and halation,
    /// and the meter's factor for that plane.
    fn records(
        &self,
        exposure: &ExposureFrame,
        mut exposed: impl FnMut(&str, &[f32], f64),
    ) -> Result<Vec<Vec<f32>>, Fault> {
        let factor = self.camera.meter.factor(exposure);
        let raster = raster(&self.effects[BLUE], exposure.size)?;
        let mut negatives = Vec::new();
        for (i, name) in RECORDS.iter().enumerate() {
            let mut light = &channel(exposure, name).map_err(|error| error.to_string())?.values[..];
            let behind;
            if i == RED {
                behind = self.effects[BLUE].scattered(0, light, &raster)?;
                light = &behind;
            }
            let factor_of_record = factor * self.reciprocity_effect(i, factor);
            let lay = |_, plane: Vec<f32>| {
                exposed(name, &plane, factor);
                plane
            };
            let (film, effects, rasters) = (&self.developed[i], &self.effects[i], [&raster; 2]);
            negatives.extend(develop(film, effects, &[light], factor_of_record, rasters, lay, |_, _| ())?);
        }
        Ok(negatives)
    }
}

/// Prepares the print of the records by the light `view`. Fails if the print stock has other dyes than those of three records.
fn dye_transfer(
    records: &[Record],
    print: &Stock,
    view: &Emission,
    look: ViewingOptions,
    params: &Params,
) -> Result<Positive, Faults> {
    let layers: Vec<&str> = print.layers.iter().map(|l| l.name.as_str()).collect();
    if layers != RECORDS {
        let fault = params.fault("print", format!("{} has no dyes for three records", print.name));
        return Err(fault.hint("name a print stock with layers called blue, green and red").into());
    }
    let development = print.developments().next().unwrap_or_default();
    let printed = Emulsion::new(print, development).map_err(|e| params.fault("print", e.to_string()))?;
    let film = Emulsion::separations([0, 1, 2].map(|i| records[i].curve.clone()));
    let grays = [0, 1, 2].map(|i| metered_exposure_lx_s(records[i].iso));
    let positive = Positive::from_separations(&film, &grays, print, printed, view, look);
    Ok(positive.map_err(|e| params.fault("print", e.to_string()))?)
}

/// One negative of the camera, with its filters.
struct Record {
    key: &'static str,
    name: String,
    iso: f64,
    stock: Stock,
    curve: spectra_film::curve::CharacteristicCurve,
    filters: Vec<Transmittance>,
}

impl Record {
    fn new(key: &'static str, p: &RecordParams, params: &Params, context: &Context<'_>) -> Result<Self, Faults> {
        let at = format!("{key}.stock");
        let stock = load_stock(&p.stock, &at, params, context.resources)?;
        let (Some(iso), [layer]) = (stock.iso, &stock.layers[..]) else {
            let fault = params.fault(&at, format!("{} is not a camera film with one layer", stock.name));
            return Err(fault.hint("name a black-and-white negative such as `kodak-double-x-5222`").into());
        };
        let development = match &p.development {
            Some(name) => layer.development(name),
            None => layer.developments.first(),
        };
        let Some(development) = development else {
            let known: Vec<&str> = stock.developments().collect();
            let fault = params.fault(&format!("{key}.development"), format!("{} has no such development", stock.name));
            let asked = p.development.as_deref().unwrap_or_default();
            return Err(fault.hint(names::hint(asked, &known, "")).into());
        };
        let mut faults = Faults::new();
        let filters = p.filters.iter().enumerate().filter_map(|(i, name)| {
            let found = find_transmittance_in(name, context.resources);
            faults.take(found.map_err(|e| e.faults(|text| params.fault(&format!("{key}.filters[{i}]"), text))))
        });
        let filters = filters.collect();
        let (name, curve) = (stock.name.clone(), development.curve.clone());
        faults.into_result(Self { key, name, iso, stock, curve, filters })
    }

    /// Returns the emulsion of record number `i` and the effects that the scene asks for on it.
    fn film(&self, i: usize, p: &ThreeStripParams, params: &Params) -> Result<(Emulsion, Effects), Faults> {
        let key = format!("{}.stock", self.key);
        let emulsion = Emulsion::with_curves(&self.stock, vec![self.curve.clone()]);
        let emulsion = emulsion.map_err(|e| params.fault(&key, e.to_string()))?;
        let switches = Switches {
            key: &key,
            scatter: p.scatter,
            adjacency: p.adjacency,
            // The pair lies emulsion to emulsion, with blue in front, so no base lies behind the blue record.
            halation: if i == BLUE { Some(HalationSetting::Word(Off::Off)) } else { p.halation },
            grain: p.grain,
            assumed: p.assumed,
            grain_seed: p.grain_seed,
            first_layer: i as u32,
        };
        let effects = effects(&switches, params, &self.stock, &emulsion)?;
        Ok((emulsion, effects))
    }

    fn sees(&self, wavelength_nm: f64) -> f64 {
        let passes: f64 = self.filters.iter().map(|f| f.at(wavelength_nm)).product();
        self.stock.layers[0].sensitivity.at(wavelength_nm) * passes
    }

    /// Returns the channel of the record's exposure, scaled so that light of the spectrum `balance` counts as its photometric lux-seconds
    /// in front of the filters. Fails if the filters pass none of that light to which the stock is sensitive.
    fn channel(&self, balance: &Emission, params: &Params, context: &Context<'_>) -> Result<Channel, Faults> {
        let power = balance.to_power(&BAND);
        let on_band = |f: &dyn Fn(f64) -> f64| BAND.wavelengths_nm().map(f).collect::<Vec<f64>>();
        let v = v_lambda();
        let lux = LUMINOUS_EFFICACY_LM_PER_W * power.seen_by(&on_band(&|w| v.at(w)));
        let seen = power.seen_by(&on_band(&|w| self.sees(w)));
        if !(seen > 0.0 && seen.is_finite()) {
            let text = format!("behind its filters, {} records none of the light of `balance`", self.name);
            return Err(params.fault(&format!("{}.filters", self.key), text).into());
        }
        let response = context.grid.wavelengths_nm().map(|w| self.sees(w) * lux / seen).collect();
        Ok(Channel { name: self.key.into(), unit: "lx s".into(), response })
    }
}

impl Film for ThreeStrip {
    exposed_by_camera!();

    fn balanced_channels(&self) -> usize {
        RECORDS.len()
    }

    fn long_exposure_warning(&self, time_s: f64) -> Option<String> {
        unknown_reciprocity(None, &self.unknown, time_s).filter(|_| !self.unknown.is_empty())
    }

    fn grain_noise(&self, metered: &ExposureFrame) -> Option<Vec<GrainNoise>> {
        let factor = self.camera.meter.factor(metered);
        let pitch_mm = raster(&self.effects[BLUE], metered.size).ok()?.pitch_mm;
        let of_record = |i: usize| {
            let factor = factor * self.reciprocity_effect(i, factor);
            self.effects[i].grain_noise(0, &self.developed[i], factor, pitch_mm)
        };
        (0..RECORDS.len()).map(of_record).collect()
    }

    fn check_frame(&self, size: &FrameSize) -> Result<(), [String; 2]> {
        self.effects.iter().try_for_each(|effects| check_frame(effects, size))
    }

    fn set_frame(&mut self, frame: u64) {
        self.effects.iter_mut().for_each(|effects| effects.set_frame(frame));
    }

    fn name(&self) -> String {
        "three-strip film".to_owned()
    }

    fn develop(&self, exposure: &ExposureFrame) -> Result<DisplayPicture, Fault> {
        self.finish(exposure, ExtraRequest::default()).map(|finished| finished.display)
    }

    fn finish(&self, exposure: &ExposureFrame, wanted: ExtraRequest) -> Result<FinishedPicture, Fault> {
        let mut layers = Vec::new();
        let mut negatives = self.records(exposure, |name, plane, factor| {
            if wanted.layers {
                let values = plane.iter().map(|v| *v * factor as f32).collect();
                layers.push(layer_of("exposure", name, "lx s", values));
            }
        })?;
        if wanted.layers {
            let named = RECORDS.iter().zip(&negatives);
            layers.extend(named.map(|(name, plane)| layer_of("density", name, "", plane.clone())));
        }
        if let Some(mtf50) = self.mtf50 {
            Optics::new(mtf50, pixel_mm(&exposure.size)).apply_to_all(&mut negatives, exposure.size.width_px as usize);
        }
        let planes: Vec<&[f32]> = negatives.iter().map(Vec::as_slice).collect();
        let size = exposure.size;
        let picture = |rgb| DisplayPicture { width_px: size.width_px, height_px: size.height_px, rgb };
        let open = wanted.unclamped.then(|| picture(self.positive.unclamped_picture(&planes)));
        let shown = picture(self.positive.picture(&planes));
        Ok(FinishedPicture { display: shown, extra: ExtraData { unclamped: open, layers, white: None } })
    }

    fn has_layers(&self) -> bool {
        true
    }

    fn describe(&self) -> String {
        let mut assumed: Vec<&str> = self.effects.iter().flat_map(|e| e.assumed.iter().copied()).collect();
        assumed.sort_unstable();
        assumed.dedup();
        let assumed = if assumed.is_empty() { String::new() } else { format!(" ({} assumed)", assumed.join(" and ")) };
        format!("{}{assumed}, {}", self.words, self.camera.meter.words(self.camera.settings.time_s))
    }
}

fn build(params: &Params, context: &Context<'_>) -> Result<Box<dyn Film>, Faults> {
    Ok(Box::new(ThreeStrip::build(params, context)?))
}

spectra_core::register!(film "three-strip": ThreeStripParams, build);
