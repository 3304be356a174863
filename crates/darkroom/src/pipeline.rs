//! Pictures of single colors on a film, without neighbors.

use crate::generated::MADE;
use crate::photograph::Setting;
use crate::still::{F_NUMBER, WHITE_CD_M2};
use spectra_color::RgbSpace;
use spectra_core::frame::{ExposureChannel, ExposureFrame, ExtraRequest, FrameSize};
use spectra_core::params::{Fault, Faults, Key, Node, Params, SourceFile, Value};
use spectra_core::registry::{self, Context};
use spectra_core::spectral::{BAND, Channel, SpectralPower};
use spectra_core::stage::{ColorModel, Film};
use spectra_scene::{FileResources, yaml};
use spectra_spectrum::{Observer, find_emission_in};
use std::f64::consts::PI;
use std::path::Path;

/// Fraction of the light that a mid gray reflects.
pub(crate) const GRAY: f64 = 0.18;

/// Pictures of single colors on a film: the film, and the color model that gives the exposure by a color.
pub struct FilmPipeline {
    pub(crate) film: Box<dyn Film>,
    pub(crate) model: Box<dyn ColorModel>,
    channels: Vec<Channel>,
    /// Exposure, lx s, per integral over the model's spectra.
    factor: f64,
    /// Exposure of each channel by a mid gray, which the meter sees.
    pub(crate) metered: Vec<f64>,
}

impl FilmPipeline {
    /// Builds the film that `settings` describe, metered for a mid gray in the light named by `illuminant`. Effects that need a
    /// pixel's neighbors are off.
    ///
    /// # Errors
    /// Faults of the settings.
    pub fn of(settings: &[Setting], illuminant: &Setting) -> Result<Self, Faults> {
        let resources = FileResources::beside(Path::new(""));
        let text = "{kind: stock, metering: average, scatter: false, adjacency: false, halation: off, grain: false, optics: off}";
        let film = yaml::parse(SourceFile::new(MADE, text))?;
        let entries = vec![(Key { text: "film".to_owned(), span: Default::default() }, film.clone())];
        let mut root = Node::new(Value::Map(entries), film.span, film.file);
        let mut faults = Faults::new();
        for setting in settings {
            let node = faults.take(yaml::parse(SourceFile::new(setting.as_typed.as_str(), setting.value.as_str())));
            if let Some(node) = node {
                if setting.path == "film.paper.grade" && node.as_str() == Some("auto") {
                    let fault =
                        node.fault("an automatic grade differs from frame to frame, but a table is the same for all");
                    faults.push(fault.hint("write a grade from 0 to 5"));
                }
                faults.take(root.set_path(&setting.path, node));
            }
        }
        let light = yaml::parse(SourceFile::new(illuminant.as_typed.as_str(), illuminant.value.as_str()))?;
        let named = light.as_str().unwrap_or_default();
        let found = find_emission_in(named, &resources).map_err(|e| e.faults(|text| light.fault(text)));
        let found = faults.take(found);
        let Some(found) = faults.into_result(found)? else { return Err(Faults::new()) };
        let light = found.to_power(&BAND);
        let context = Context::new(&resources, BAND);
        let film = root.get("film").cloned().unwrap_or(root);
        let film = registry::build::<dyn Film>(&Params::stage(film, "film")?, &context)?;
        let color = Params::stage(yaml::parse(SourceFile::new(MADE, "{kind: smooth}"))?, "source.color")?;
        let model = registry::build::<dyn ColorModel>(&color, &Context { illuminant: Some(&light), ..context })?;
        let channels = film.channels();
        let white = model.spectrum([1.0; 3]);
        let lux =
            spectra_spectrum::constants::LUMINOUS_EFFICACY_LM_PER_W * Observer::cie_1931_2deg().xyz_of_power(&white)[1];
        let factor = WHITE_CD_M2 / lux * PI / (4.0 * F_NUMBER * F_NUMBER) * film.exposure_time_s();
        let gray = model.spectrum([GRAY; 3]);
        let mut chain = Self { film, model, channels, factor, metered: Vec::new() };
        chain.metered = chain.exposures(&gray);
        Ok(chain)
    }

    /// Returns the picture of each light, sRGB encoded, 0 to 1.
    pub(crate) fn pictures_of_lights(
        &self,
        lights: impl Iterator<Item = SpectralPower>,
    ) -> Result<Vec<[f64; 3]>, Fault> {
        self.pictures(&lights.map(|light| self.exposures(&light)).collect::<Vec<_>>())
    }

    /// Returns the exposure of each channel by a light, lx s.
    pub(crate) fn exposures(&self, light: &SpectralPower) -> Vec<f64> {
        self.channels.iter().map(|channel| self.factor * light.seen_by(&channel.response)).collect()
    }

    /// Returns the picture of each set of channel exposures, sRGB encoded, 0 to 1. The meter sees mid gray.
    pub(crate) fn pictures(&self, exposures: &[Vec<f64>]) -> Result<Vec<[f64; 3]>, Fault> {
        let picture = self.film.develop(&self.frame(exposures))?;
        let space = RgbSpace::srgb();
        let encoded = |rgb: &[f32; 3]| space.encode(rgb.map(|v| f64::from(v).clamp(0.0, 1.0)));
        Ok(picture.rgb.iter().map(encoded).collect())
    }

    /// Returns the picture of each set of channel exposures in linear light of sRGB primaries, not compressed into a gamut if the
    /// film can give such a picture.
    pub(crate) fn unclamped_pictures(&self, exposures: &[Vec<f64>]) -> Result<Vec<[f64; 3]>, Fault> {
        let wanted = ExtraRequest { unclamped: true, ..ExtraRequest::default() };
        let finished = self.film.finish(&self.frame(exposures), wanted)?;
        let picture = finished.extra.unclamped.unwrap_or(finished.display);
        Ok(picture.rgb.iter().map(|rgb| rgb.map(f64::from)).collect())
    }

    /// Returns a frame of one row, with a pixel for each set of channel exposures. Channels of the meter hold mid gray.
    fn frame(&self, exposures: &[Vec<f64>]) -> ExposureFrame {
        let pictured = self.film.picture_channels();
        let plane = |k: usize| -> Vec<f32> {
            let of_meter = k >= pictured;
            exposures.iter().map(|got| if of_meter { self.metered[k] as f32 } else { got[k] as f32 }).collect()
        };
        let channels = self.channels.iter().enumerate().map(|(k, channel)| ExposureChannel {
            name: channel.name.clone(),
            unit: channel.unit.clone(),
            values: plane(k),
        });
        let width = exposures.len() as u32;
        let size = FrameSize { width_px: width, height_px: 1, width_mm: f64::from(width), height_mm: 1.0 };
        ExposureFrame { size, channels: channels.collect() }
    }
}
