//! `kind: my-stage`, a film.

use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::math::exp;
use spectra_core::prelude::*;

/// A tintype: silver from wet collodion on black iron, a positive at once.
///
/// The plate is sensitive only to blue and ultraviolet light: skies come out white, lips and grass dark.
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
    Ok(Box::new(OneLayer::new("tintype", "J m^-2", context, sees, p.exposure.s(), tone)))
}

/// Returns the warm color of silver on black iron after a radiant exposure in J m^-2, as linear RGB.
fn tone(exposure: f64, _: Pixel) -> [f64; 3] {
    let silver = 1.0 - exp(-exposure / 0.06);
    [1.0, 0.9, 0.76].map(|warm| warm * (0.01 + 0.75 * silver))
}

#[cfg(test)]
mod tests {
    use super::tone;
    use spectra_core::prelude::Pixel;
    use spectra_testing::{FilmLaws, assert_fault, film};

    /// There is only black iron without light; at 0.06 J m^-2 a fraction 1/e of the silver is missing.
    #[test]
    fn silver_grows_toward_its_most() {
        let red = |exposure| tone(exposure, Pixel { index: 0, area_mm2: 1.0, frame: 0 })[0];
        assert!((red(0.0) - 0.01).abs() < 1e-12);
        assert!((red(0.06) - (0.01 + 0.75 * 0.632_120_558_8)).abs() < 1e-9);
        assert!((red(1e3) - 0.76).abs() < 1e-12);
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
