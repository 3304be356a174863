//! `kind: my-stage`, a film.

use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::math::exp;
use spectra_core::prelude::*;

/// A tintype: silver from wet collodion on black iron, a positive at once.
///
/// It sees blue and ultraviolet light only: skies are white, lips and grass dark.
///
/// # Example
/// ```yaml
/// {kind: my-stage, exposure: 2 s}
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
    let sees = |nm: f64| exp(-((nm - 410.0) / 60.0) * ((nm - 410.0) / 60.0));
    let response = context.grid.wavelengths_nm().map(sees).collect();
    let blue = Channel { name: "blue".into(), unit: "J m^-2".into(), response };
    Ok(Box::new(MyStage { blue, exposure_s: p.exposure.s() }))
}

struct MyStage {
    blue: Channel,
    exposure_s: f64,
}

impl Film for MyStage {
    fn channels(&self) -> Vec<Channel> {
        vec![self.blue.clone()]
    }
    fn exposure_time_s(&self) -> f64 {
        self.exposure_s
    }
    fn develop(&self, exposure: &ExposureFrame) -> Result<DisplayPicture, String> {
        Ok(DisplayPicture::of(exposure.size, exposure.values("blue")?, |h| tone(f64::from(*h))))
    }
    fn describe(&self) -> String {
        format!("tintype, exposed for {} s", self.exposure_s)
    }
}

/// Warm light from silver on black iron, after a radiant exposure in J m^-2.
fn tone(exposure: f64) -> [f32; 3] {
    let silver = 1.0 - exp(-exposure / 0.06);
    [1.0, 0.9, 0.76].map(|warm| (warm * (0.01 + 0.75 * silver)) as f32)
}

#[cfg(test)]
mod tests {
    use super::tone;
    use spectra_testing::{FilmLaws, assert_fault, film};

    /// No light is black iron; at 0.06 J m^-2 a part 1/e of the silver is missing.
    #[test]
    fn silver_grows_toward_its_most() {
        assert!((tone(0.0)[0] - 0.01).abs() < 1e-7);
        assert!((tone(0.06)[0] - (0.01 + 0.75 * 0.632_120_56)).abs() < 1e-6);
        assert!((tone(1e3)[0] - 0.76).abs() < 1e-6);
    }

    #[test]
    fn it_keeps_the_laws_of_films() {
        FilmLaws::default().hold(&*film("{kind: my-stage, exposure: 2 s}"));
    }

    #[test]
    fn what_cannot_be_is_said() {
        assert_fault("film", "{kind: my-stage}", "exposure");
        assert_fault("film", "{kind: my-stage, exposure: 0}", "exposure");
        assert_fault("film", "{kind: my-stage, exposure: 2 mm}", "exposure");
    }
}
