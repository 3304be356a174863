//! Settings that turn the pixels of a picture into light on its plane.

use super::edges::Mixed;
use super::gamut;
use super::light_sampler::LightSampler;
use super::lights::{self, Lights};
use super::picture_file::PictureFile;
use super::picture_texture::{Importance, PictureTexture, are_lamps};
use crate::frame::Edge;
use crate::split_source::LightPart;
use crate::white;
use spectra_core::params::{Deferred, Faults, Params};
use spectra_core::registry::{Context, StageOf, build as build_stage};
use spectra_core::spectral::SpectralPower;
use spectra_core::stage::{ColorModel, Still};
use spectra_pictures::read::LinearPicture;
use std::sync::Arc;

/// Parameters that turn the pixels of a picture into light.
pub(crate) struct PictureSettings {
    pub model: Arc<dyn ColorModel>,
    pub width_mm: f64,
    pub luminance_cd_m2: f64,
    pub edge: Edge,
}

impl PictureSettings {
    /// Reads a file, with colors moved into the gamut of the color model.
    pub(crate) fn read(&self, file: &PictureFile, overscan: [u32; 2]) -> Result<LinearPicture, Faults> {
        let mut linear = file.read(overscan)?;
        gamut::bring_in(&mut linear, &*self.model);
        Ok(linear)
    }

    /// Returns a white picture with this ratio of width to height.
    pub(crate) fn white(&self, aspect: f64, name: &str) -> PictureTexture {
        let pixel = LinearPicture {
            width: 1,
            height: 1,
            pixel_aspect: aspect,
            rgb: vec![[1.0; 3]],
            alpha: None,
            depth: None,
            clipped_at: None,
            warnings: Vec::new(),
        };
        self.map(pixel, name)
    }

    /// Returns the factor that gives the model's white the luminance of white.
    fn scale(&self) -> f64 {
        self.luminance_cd_m2 / white::luminance_cd_m2(&self.model.spectrum([1.0; 3]))
    }

    /// Returns the pixels of the picture, for exposing film without a lens.
    pub(super) fn still(&self, linear: LinearPicture) -> Still {
        let LinearPicture { width, height, pixel_aspect, rgb, .. } = linear;
        let (model, scale) = (Arc::clone(&self.model), self.scale());
        Still { width_px: width, height_px: height, pixel_aspect, rgb, model, scale }
    }

    /// Returns the picture on its plane. Its pixels are replaced in place by the coefficients of the color model.
    pub(crate) fn map(&self, linear: LinearPicture, name: &str) -> PictureTexture {
        assemble(linear, name, self, None)
    }
}

/// Builds the color model under `color`, for this light.
pub(crate) fn color_model(
    color: Option<Deferred<StageOf<dyn ColorModel>>>,
    light: &SpectralPower,
    params: &Params,
    context: &Context<'_>,
) -> Result<Arc<dyn ColorModel>, Faults> {
    let color = color.map_or_else(|| Ok(params.default_stage("color")), |node| node.params())?;
    build_stage::<dyn ColorModel>(&color, &Context { illuminant: Some(light), ..*context }).map(Arc::from)
}

/// Returns the luminance by the weights of linear sRGB (IEC 61966-2-1), which is accurate enough to find where a picture is bright. Deep
/// violets and reds, which film sees better than the eye, count at least as much as the blue of sRGB, so that rays are drawn from them.
fn brightness([r, g, b]: [f32; 3]) -> f32 {
    (0.2126 * r + 0.7152 * g + 0.0722 * b).max(0.0721 * r.max(g).max(b))
}

/// Makes the map of a picture on its plane. `rgb` holds the front color of mixed pixels.
pub(super) fn assemble(
    linear: LinearPicture,
    name: &str,
    making: &PictureSettings,
    mixed: Option<&Mixed>,
) -> PictureTexture {
    let (width, height) = (linear.width as usize, linear.height as usize);
    let model = &making.model;
    let scale = making.scale();
    let mut rgb = linear.rgb;
    let pixels = rgb.len() as f64;
    let behind = |cell: usize| mixed.and_then(|mixed| mixed.cells.place(cell).map(|place| &mixed.behind[place]));
    // The light of a whole pixel, and the brighter of its front and back, since either may be a light.
    let whole = |cell: usize| match behind(cell) {
        None => rgb[cell],
        Some(behind) => [0, 1, 2].map(|k| behind.rgb[k] + (rgb[cell][k] - behind.rgb[k]) * behind.opacity),
    };
    let bright = |cell: usize| {
        let front = brightness(rgb[cell]);
        behind(cell).map_or(front, |behind| front.max(brightness(behind.rgb)))
    };
    let mut mean = [0.0_f64; 3];
    for cell in 0..rgb.len() {
        for (sum, value) in mean.iter_mut().zip(whole(cell)) {
            *sum += f64::from(value) / pixels;
        }
    }
    let mean_brightness = (0..rgb.len()).map(|cell| f64::from(brightness(whole(cell)))).sum::<f64>() / pixels;
    let peak = (0..rgb.len()).fold(0.0_f32, |a, cell| a.max(bright(cell)));
    let importance = Arc::new(Importance::new(width, height, bright));
    let is_lamps = are_lamps(width, bright, rgb.len());
    let all = if f64::from(peak) > mean_brightness { (0..rgb.len()).map(bright).collect() } else { Vec::new() };
    let lights = if all.is_empty() { None } else { lights::find(width, &all) };
    let lights = lights.map(|found| {
        let mut sums = [[0.0_f64; 3]; 2];
        for (cell, level) in found.level.iter().enumerate() {
            let sum = &mut sums[usize::from(*level == 0.0)];
            sum.iter_mut().zip(whole(cell)).for_each(|(sum, value)| *sum += f64::from(value) / pixels);
        }
        Arc::new(Lights {
            places: LightSampler::new(width, &found.level, found.limit),
            touched: lights::touched(width, &found.level),
            level: found.level,
            mean: sums.map(|sum| model.spectrum(sum).scaled(scale)),
            peak_over_mean: found.peak_over_mean,
            pays: found.pays,
        })
    });
    for pixel in &mut rgb {
        *pixel = model.coefficients(pixel.map(f64::from));
    }
    PictureTexture {
        width_px: width,
        height_px: height,
        width_mm: making.width_mm,
        height_mm: making.width_mm * height as f64 / (width as f64 * linear.pixel_aspect),
        coefficients: Arc::new(rgb),
        mean: model.spectrum(mean).scaled(scale),
        peak_over_mean: if mean_brightness > 0.0 { f64::from(peak) / mean_brightness } else { 1.0 },
        importance,
        is_lamps,
        lights,
        half: LightPart::Whole,
        scale,
        model: Arc::clone(model),
        name: name.to_owned(),
        edge: making.edge,
    }
}
