//! Parameters of `kind: sensor`, as written in a scene.

use super::{CameraColor, Converter, Pattern, PatternName, Photosite, Pixels, Sensor};
use crate::params::Frame;
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::params::{Faults, Length, NonNegative, OrInfinity, Params, Positive, Quantity, Ratio, Time, Whole};
use spectra_core::registry::Context;
use spectra_core::spectral::Channel;
use spectra_core::stage::Imager;
use spectra_glass::Catalog;
use spectra_spectrum::constants::{LIGHT_M_PER_S, PLANCK_J_S};
use spectra_spectrum::{find_emission, find_emission_in, find_sensitivity_in};

/// A chip of pixels with color filters, with electrons, noise and raw files.
///
/// The sensitivities of filters and pixels turn light into electrons. Their number has photon noise (Poisson) and read noise
/// (normal), and a well holds a limited number. A converter turns them into whole numbers. These go into a DNG file
/// (`output: [dng]`), and a picture is developed from them, with demosaicing and white balance. Color matrices are fitted
/// to the 24 patches of a ColorChecker. The DNG file holds the matrices for A and D65, the noise, the exposure and the
/// lens. It has no date, so that the same scene gives the same bytes.
///
/// With `photosite`, oblique light lands beside the center of its pixel, by the height of the stack, and continues sideways
/// in the silicon. At the edge of the frame of a wide-angle lens, colors then mix and shift. Figures that are not known for a
/// sensor (quantum efficiency, full well, read noise) have a default, marked as an assumption. All colors share one peak
/// quantum efficiency. The table alone therefore sets red and blue relative to green, and with them the values of white
/// before balancing and the noise of each color. The bundled sensor was measured color by color; its colors are
/// scaled relative to each other by the camera's response to D65.
///
/// `resolution` is the number of pixels across and down. If its aspect ratio differs from that of the frame, the pixels
/// are not square. The frame lies in the image plane of the lens unless you shift it, tilt it (as on a view camera) or
/// curve it.
///
/// # Example
/// ```yaml
/// {kind: sensor, format: 135, resolution: [960, 640], exposure: 1/125 s}
/// ```
/// ```yaml
/// # A small part of a sensor, pixel for pixel, behind its cover glass
/// kind: sensor
/// width: 2.4 mm
/// height: 1.6 mm
/// resolution: [400, 267]
/// exposure: 1/60 s
/// iso: 800
/// cover: [{glass: SCHOTT/N-BK7, thickness: 1 mm}]
/// photosite: {stack: 0.004 mm, microlens: 0.6, exit-pupil: 80 mm, well: 0.006 mm}
/// ```
/// # References
/// - P. B. Catrysse and B. A. Wandell, J. Opt. Soc. Am. A 19, 1610 (2002): oblique light in a pixel.
/// - M. A. Green, Solar Energy Materials and Solar Cells 92, 1305 (2008): index and absorption of silicon.
/// - ISO 17321-1: the patches to which the color matrix is fitted.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(deny_unknown_fields)]
pub struct SensorParams {
    #[serde(flatten)]
    frame: Frame,
    /// Exposure time, s if bare.
    exposure: Positive<Time>,
    /// Color filters from the upper left of the picture: `rggb` (the default), `bggr`, `grbg`, `gbrg`; or
    /// `monochrome`.
    #[serde(default)]
    pattern: PatternName,
    /// Spectral sensitivity of the pixels: a bundled table or a file with the columns red, green and blue, relative per power.
    /// A monochrome sensor needs one sensitivity, such as `file#column`; with filters the default is `nikon-d5100`.
    #[serde(default)]
    sensitivity: Option<String>,
    /// Largest number of electrons per photon, above 0 to 1, which makes a relative table absolute; 0.5 if left out, an
    /// assumption.
    #[serde(default)]
    #[schemars(extend("maximum" = 1))]
    peak_quantum_efficiency: Option<Positive<Ratio>>,
    /// Distance between two pixels of the sensor, mm if bare; that of `resolution` if left out. With it, a picture with fewer
    /// pixels shows the signal of the sensor's own pixels.
    #[serde(default)]
    pitch: Option<Positive<Length>>,
    /// Fraction of a pixel's area that receives light, microlens included, above 0 to 1; 1 if left out.
    #[serde(default)]
    #[schemars(extend("maximum" = 1))]
    fill_factor: Option<Positive<Ratio>>,
    /// Layers in front of the silicon. If left out, a pixel has the same sensitivity for all directions.
    #[serde(default)]
    photosite: Option<PhotositeParams>,
    /// Largest number of electrons in a well, more than 0; 30000 if left out, an assumption.
    #[serde(default)]
    full_well: Option<Positive<f64>>,
    /// Standard deviation of the read noise, electrons, 0 or more; 3 if left out, an assumption.
    #[serde(default)]
    read_noise: Option<NonNegative<f64>>,
    /// ISO setting, `base-iso` or more; `base-iso` if left out. The largest digital number is reached at the full well times
    /// `base-iso` / `iso`.
    #[serde(default)]
    iso: Option<Positive<f64>>,
    /// ISO setting at which a full well gives the largest digital number; 100 if left out.
    #[serde(default)]
    base_iso: Option<Positive<f64>>,
    /// Bits of the converter, 8 to 16; 14 if left out.
    #[serde(default)]
    bits: Option<Whole<8, 16>>,
    /// Digital number without light, below the largest number; 1/32 of the range if left out.
    #[serde(default)]
    black_level: Option<Whole<0, 65534>>,
    /// Whether there is photon noise and read noise; `true` if left out.
    #[serde(default)]
    noise: Option<bool>,
    /// Seed of the noise, 0 or more; 1 if left out.
    #[serde(default)]
    noise_seed: Option<u64>,
    /// Light that is shown as white: the name of a spectrum, or a file beside the scene; D65 if left out.
    #[serde(default)]
    white_balance: Option<String>,
    /// Name of the camera in the raw file; `sensor` if left out.
    #[serde(default)]
    model: Option<String>,
}

/// `photosite` as written in a scene.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct PhotositeParams {
    /// Height of the stack, from the color filter to the silicon, mm if bare.
    pub stack: NonNegative<Length>,
    /// Refractive index of the stack, 1 to 5; 1.46 (silica) if left out.
    #[serde(default)]
    #[schemars(extend("minimum" = 1, "maximum" = 5))]
    pub index: Option<Positive<f64>>,
    /// Strength with which the microlens concentrates light toward the center, 0 (not at all) to 1 (to a point); 0 if left out.
    #[serde(default)]
    #[schemars(extend("maximum" = 1))]
    pub microlens: Option<NonNegative<Ratio>>,
    /// Distance of the exit pupil for which the microlenses are shifted, mm if bare; no shift if left out.
    #[serde(default)]
    pub exit_pupil: Option<OrInfinity<Positive<Length>>>,
    /// Depth of the well, mm if bare; 0 if left out, which means that all light is absorbed at the surface.
    #[serde(default)]
    pub well: Option<NonNegative<Length>>,
}

const DEFAULT_SENSITIVITY: &str = "nikon-d5100";
const DEFAULT_PEAK: f64 = 0.5;
const DEFAULT_FULL_WELL: f64 = 30_000.0;
const DEFAULT_READ_NOISE: f64 = 3.0;
const SILICA: f64 = 1.46;
/// Name of silicon in the glass catalog: M. A. Green, Solar Energy Materials and Solar Cells 92, 1305 (2008).
const SILICON: &str = "Si/Green-2008";
/// EXIF numbers (`LightSource`) of standard lights; 255 is any other.
const LIGHT_SOURCES: [(&str, u16); 7] =
    [("A", 17), ("B", 18), ("C", 19), ("D55", 20), ("D65", 21), ("D75", 22), ("D50", 23)];

/// The two lights for which raw files hold color matrices, the warmer one first.
const CALIBRATION_LIGHTS: [&str; 2] = ["A", "D65"];

impl SensorParams {
    /// Builds the channels, which are in electrons.
    fn channels(
        &self,
        params: &Params,
        context: &Context<'_>,
        pattern: Pattern,
        area_mm2: f64,
    ) -> Result<Vec<Channel>, Faults> {
        let mut faults = Faults::new();
        let name = self.sensitivity.as_deref().unwrap_or(DEFAULT_SENSITIVITY);
        if pattern == Pattern::Monochrome && self.sensitivity.is_none() {
            let fault = params.fault("sensitivity", "a monochrome sensor needs a `sensitivity`");
            return Err(fault
                .hint("write a file beside the scene with the columns `wavelength_nm` and `sensitivity`")
                .into());
        }
        let wanted: Vec<(&str, String)> = match pattern {
            Pattern::Monochrome => vec![("Y", name.to_owned())],
            Pattern::Bayer(_) => [("R", "red"), ("G", "green"), ("B", "blue")]
                .map(|(channel, column)| (channel, format!("{name}#{column}")))
                .into(),
        };
        let grid = &context.grid;
        let mut tables = Vec::new();
        for (channel, text) in wanted {
            let found = find_sensitivity_in(&text, context.resources);
            let found = found.map_err(|e| e.faults(|text| params.fault("sensitivity", text)));
            tables.extend(faults.take(found.map(|s| (channel, s.on_grid(grid)))));
        }
        faults.into_result(())?;
        // Photons per joule are proportional to the wavelength, so electrons per photon are sensitivity / wavelength.
        let peak = tables
            .iter()
            .flat_map(|(_, table)| table.iter().zip(grid.wavelengths_nm()).map(|(s, w)| s / w))
            .fold(0.0, f64::max);
        if !(peak > 0.0) {
            return Err(params
                .fault("sensitivity", format!("`{name}` has no sensitivity in the band of the scene"))
                .into());
        }
        let efficiency = self.peak_quantum_efficiency.map_or(DEFAULT_PEAK, |q| q.number());
        const M2_PER_MM2: f64 = 1e-6;
        const M_PER_NM: f64 = 1e-9;
        let scale = efficiency / peak * area_mm2 * M2_PER_MM2 * M_PER_NM / (PLANCK_J_S * LIGHT_M_PER_S);
        let channel = |(name, table): (&str, Vec<f64>)| Channel {
            name: name.to_owned(),
            unit: "e-".to_owned(),
            response: table.into_iter().map(|s| s * scale).collect(),
        };
        Ok(tables.into_iter().map(channel).collect())
    }

    fn photosite(&self, params: &Params, context: &Context<'_>, pitch_mm: f64) -> Result<Option<Photosite>, Faults> {
        let Some(p) = &self.photosite else { return Ok(None) };
        let mut faults = Faults::new();
        let index = p.index.map_or(SILICA, |i| i.bare());
        let microlens = p.microlens.map_or(0.0, |m| m.number());
        let silicon = Catalog::bundled().medium(SILICON).map_err(|e| params.fault("photosite", e.to_string()));
        let Some(silicon) = faults.take(silicon) else { return Err(faults) };
        let mut photosite = Photosite::new(pitch_mm, &silicon, &context.grid);
        photosite.stack_mm = p.stack.mm();
        photosite.stack_index = index;
        photosite.microlens = microlens;
        photosite.exit_pupil_mm = p.exit_pupil.map_or(f64::INFINITY, |e| e.mm());
        photosite.well_mm = p.well.map_or(0.0, |w| w.mm());
        faults.into_result(Some(photosite))
    }

    fn converter(
        &self,
        params: &Params,
        context: &Context<'_>,
        pattern: Pattern,
        channels: &[Channel],
    ) -> Result<Converter, Faults> {
        let mut faults = Faults::new();
        let bits = self.bits.unwrap_or(Whole::known(14)).get_u32();
        let white_level = ((1_u32 << bits) - 1) as u16;
        let black = self.black_level.map_or(u32::from(white_level).div_ceil(32), Whole::get_u32);
        if black >= u32::from(white_level) {
            faults.push(
                params
                    .fault("black-level", format!("a black level of {black} leaves no range"))
                    .hint(format!("write less than {white_level}")),
            );
        }
        let base_iso = self.base_iso.map_or(100.0, |i| i.bare());
        let iso = self.iso.map_or(base_iso, |i| i.bare());
        if iso < base_iso {
            faults.push(
                params.fault("iso", format!("{iso} is below `base-iso`")).hint(format!("write {base_iso} or more")),
            );
        }
        let light = self.white_balance.as_deref().unwrap_or("D65");
        let color = match pattern {
            Pattern::Monochrome => None,
            Pattern::Bayer(_) => {
                let found = find_emission_in(light, context.resources)
                    .map_err(|e| e.faults(|text| params.fault("white-balance", text)));
                faults.take(found).and_then(|light| {
                    let color = CameraColor::fit(channels, &light, &context.grid);
                    let blind = || {
                        params.fault("white-balance", "these sensitivities cannot distinguish colors under this light")
                    };
                    faults.take(color.ok_or_else(blind))
                })
            }
        };
        let number_of = |light: &str| LIGHT_SOURCES.iter().find(|(name, _)| *name == light).map_or(255, |(_, n)| *n);
        let calibrations = match (pattern, &color) {
            (Pattern::Monochrome, _) | (_, None) => Vec::new(),
            (Pattern::Bayer(_), Some(white)) => {
                let fitted = CALIBRATION_LIGHTS.iter().map(|name| {
                    let light = find_emission(name).ok()?;
                    CameraColor::fit(channels, &light, &context.grid).map(|color| (number_of(name), color))
                });
                // If one of the two lights shows no colors in this band, use the matrices of the white light.
                fitted.collect::<Option<Vec<_>>>().unwrap_or_else(|| vec![(number_of(light), *white)])
            }
        };
        let model = self.model.clone().unwrap_or_else(|| "sensor".to_owned());
        let unique_model = match self.sensitivity.as_deref().unwrap_or(DEFAULT_SENSITIVITY) {
            name if model.contains(name) => format!("spectra {model}"),
            name => format!("spectra {model} {name}"),
        };
        let full_well = self.full_well.map_or(DEFAULT_FULL_WELL, |w| w.bare());
        let range = f64::from(white_level) - f64::from(black.min(u32::from(white_level) - 1));
        faults.into_result(Converter {
            pattern,
            exposure_time_s: self.exposure.s(),
            full_well,
            read_noise: self.read_noise.map_or(DEFAULT_READ_NOISE, |r| r.bare()),
            electrons_per_number: full_well * base_iso / iso / range,
            black_level: black as u16,
            white_level,
            noise: self.noise.unwrap_or(true).then_some(self.noise_seed.unwrap_or(1)),
            iso,
            color,
            illuminant: number_of(light),
            calibrations,
            model,
            unique_model,
        })
    }
}

fn build(params: &Params, context: &Context<'_>) -> Result<Box<dyn Imager>, Faults> {
    let parsed: SensorParams = params.parse()?;
    let mut faults = Faults::new();
    let plane = faults.take(parsed.frame.plane(params, context));
    let fill = parsed.fill_factor.map_or(1.0, |f| f.number());
    let pattern = parsed.pattern.pattern();
    let Some(plane) = plane else { return Err(faults) };
    let size = plane.size();
    let pitch_mm = parsed.pitch.map(|p| p.mm());
    let area_mm2 = pitch_mm.map_or(size.pixel_area_mm2(), |p| p * p);
    let channels = faults.take(parsed.channels(params, context, pattern, area_mm2));
    let photosite = faults.take(parsed.photosite(params, context, pitch_mm.unwrap_or(area_mm2.sqrt())));
    let converter = channels.as_ref().and_then(|c| faults.take(parsed.converter(params, context, pattern, c)));
    let (Some(channels), Some(photosite), Some(converter)) = (channels, photosite, converter) else {
        return Err(faults);
    };
    let pixels = Pixels { plane, pattern, open: fill.sqrt(), photosite, coarse: parsed.pitch.is_some() };
    faults.into_result(Box::new(Sensor { pixels, channels, converter }))
}

spectra_core::register!(imager "sensor": SensorParams, build);
