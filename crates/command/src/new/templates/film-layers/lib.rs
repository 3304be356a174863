//! `kind: my-stage`, a film.

use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::math::exp;
use spectra_core::prelude::*;

/// Number of layers. They divide the band equally, starting at its short end.
const LAYERS: usize = {{layers}};
/// The band that the film sees, nm.
const BAND_NM: [f64; 2] = [400.0, 700.0];
/// Density of a layer's dye without exposure.
const DENSITY: f64 = 3.0;
/// Exposure that halves the density of a layer's dye, J m^-2. With more layers, each receives less of the light.
const HALF: f64 = 4e-3 / LAYERS as f64;
/// Wavelengths of the red, green and blue of a screen, nm.
const SCREEN_NM: [f64; 3] = [640.0, 545.0, 455.0];

/// A color reversal film whose layers divide the spectrum equally.
///
/// Light bleaches the dye that absorbs its color, so the film is clear where the scene was white and black where it was dark.
///
/// # Example
/// ```yaml
/// {kind: my-stage, exposure: 1/8 s}
/// ```
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct MyStageParams {
    /// Exposure time, s if bare.
    exposure: Positive<Time>,
}

spectra_core::register!(film "my-stage": MyStageParams, build);

fn build(params: &Params, context: &Context<'_>) -> Result<Box<dyn Film>, Faults> {
    let p: MyStageParams = params.parse()?;
    Ok(Box::new(MyStage { layers: layers(&context.grid), exposure_time_s: p.exposure.s() }))
}

struct MyStage {
    layers: Vec<Channel>,
    exposure_time_s: f64,
}

/// Center of a layer's band, nm.
fn center_nm(layer: usize) -> f64 {
    BAND_NM[0] + (layer as f64 + 0.5) * (BAND_NM[1] - BAND_NM[0]) / LAYERS as f64
}

/// Gaussian around `center_nm`, 1 at the center.
fn bell(nm: f64, center_nm: f64, width_nm: f64) -> f64 {
    exp(-((nm - center_nm) / width_nm) * ((nm - center_nm) / width_nm))
}

/// Responses of the layers to spectral irradiance; times the exposure time they give J m^-2.
fn layers(grid: &Grid) -> Vec<Channel> {
    let width_nm = 0.5 * (BAND_NM[1] - BAND_NM[0]) / LAYERS as f64;
    let layer = |i| {
        let response = grid.wavelengths_nm().map(|nm| bell(nm, center_nm(i), width_nm)).collect();
        Channel { name: format!("layer-{}", i + 1), unit: "J m^-2".to_owned(), response }
    };
    (0..LAYERS).map(layer).collect()
}

/// Returns the linear red, green and blue that pass the dyes after exposures of all layers, J m^-2.
fn color(exposures: &[f64]) -> [f64; 3] {
    SCREEN_NM.map(|nm| {
        let weights: Vec<f64> = (0..LAYERS).map(|i| bell(nm, center_nm(i), 50.0)).collect();
        let all: f64 = weights.iter().sum();
        let density = |(weight, exposure): (&f64, &f64)| weight / all * DENSITY / (1.0 + exposure / HALF);
        let sum: f64 = weights.iter().zip(exposures).map(density).sum();
        exp(-std::f64::consts::LN_10 * sum)
    })
}

impl Film for MyStage {
    fn channels(&self) -> Vec<Channel> {
        self.layers.clone()
    }

    fn exposure_time_s(&self) -> f64 {
        self.exposure_time_s
    }

    fn develop(&self, exposure: &ExposureFrame) -> Result<DisplayPicture, Fault> {
        let planes = self.layers.iter().map(|layer| exposure.values(&layer.name)).collect::<Result<Vec<_>, _>>()?;
        let pixel = |i| {
            let exposures: Vec<f64> = planes.iter().map(|plane| f64::from(plane[i])).collect();
            color(&exposures).map(|c| c as f32)
        };
        let (width_px, height_px) = (exposure.size.width_px, exposure.size.height_px);
        Ok(DisplayPicture { width_px, height_px, rgb: (0..exposure.size.pixels()).map(pixel).collect() })
    }

    fn describe(&self) -> String {
        format!("my-stage, {LAYERS} layers, exposed for {} s", self.exposure_time_s)
    }
}

#[cfg(test)]
mod tests {
    use super::{DENSITY, HALF, LAYERS, color};
    use spectra_testing::{FilmLaws, assert_fault, film};

    /// All dye is left without light, `HALF` halves its density, and much light leaves none.
    #[test]
    fn light_bleaches_the_dyes() {
        for (exposure, density) in [(0.0, DENSITY), (HALF, 0.5 * DENSITY), (1e12 * HALF, 0.0)] {
            for value in color(&[exposure; LAYERS]) {
                assert!((value.log10() + density).abs() < 1e-9, "{exposure} J m^-2 gives {value}");
            }
        }
    }

    #[test]
    fn every_layer_is_a_channel() {
        let film = film("{kind: my-stage, exposure: 1/8 s}");
        let channels = film.channels();
        assert_eq!(channels.len(), LAYERS);
        assert!(channels.iter().all(|channel| channel.response.iter().any(|r| *r > 0.5)));
    }

    #[test]
    fn it_keeps_the_laws_of_films() {
        FilmLaws::default().hold(&*film("{kind: my-stage, exposure: 1/8 s}"));
    }

    #[test]
    fn wrong_exposures_are_refused() {
        assert_fault("film", "{kind: my-stage}", "exposure");
        assert_fault("film", "{kind: my-stage, exposure: 0}", "exposure");
        assert_fault("film", "{kind: my-stage, exposure: 2 mm}", "exposure");
    }
}
