//! The film `kind: night-vision`, a phosphor screen.

use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::math::exp;
use spectra_core::numbers::{Numbers, poisson};
use spectra_core::prelude::*;

/// The phosphor screen of an image intensifier: every photoelectron makes a spark.
///
/// A gallium arsenide cathode sees 450 to 900 nm, so give the scene such a band: `wavelengths: {band: [400, 930]}`. The
/// electrons of a pixel are counted and amplified. They excite the green phosphor P43, of chromaticity (0.33, 0.56), until it
/// saturates.
///
/// # Example
/// ```yaml
/// {kind: night-vision, exposure: 1/30 s, full: 20}
/// ```
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct NightVisionParams {
    /// Integration time of the eye, s if bare.
    exposure: Positive<Time>,
    /// Number of electrons that light a pixel to 63 % of the maximum of the screen.
    full: Positive<f64>,
}

spectra_core::register!(film "night-vision": NightVisionParams, build);

fn build(params: &Params, context: &Context<'_>) -> Result<Box<dyn Film>, Faults> {
    let p: NightVisionParams = params.parse()?;
    // Electrons per mm^2 for an exposure of 1 J m^-2: quantum efficiency, a plateau with soft edges, over the energy of a
    // photon.
    let efficiency = |nm: f64| 0.35 / (1.0 + exp((450.0 - nm) / 15.0)) / (1.0 + exp((nm - 890.0) / 8.0));
    let sees = move |nm: f64| efficiency(nm) * nm / 1.986_445_857e-10;
    let screen = move |per_mm2: f64, pixel: Pixel| {
        let sparks = poisson(per_mm2 * pixel.area_mm2, Numbers::random(pixel.frame).one(pixel.index, 0, 0));
        [0.23, 1.0, 0.03].map(|green| green * (1.0 - exp(-sparks / p.full.get())))
    };
    Ok(Box::new(OneLayer::new("night vision", "mm^-2", context, sees, p.exposure.s(), screen)))
}

#[cfg(test)]
mod tests {
    use spectra_core::frame::{ExposureChannel, ExposureFrame, FrameSize};
    use spectra_testing::{FilmLaws, assert_fault, film};

    const FILM: &str = "{kind: night-vision, exposure: 1 s, full: 20}";

    /// The number of dark pixels follows Poisson's formula within four standard errors, for five expected electrons per pixel.
    #[test]
    fn electrons_are_counted() {
        let size = FrameSize { width_px: 200, height_px: 100, width_mm: 2.0, height_mm: 1.0 };
        let values = vec![(5.0 / size.pixel_area_mm2()) as f32; size.pixels()];
        let name = film(FILM).channels()[0].name.clone();
        let channels = vec![ExposureChannel { name, unit: "mm^-2".into(), values }];
        let picture = film(FILM).develop(&ExposureFrame { size, channels }).unwrap();
        let dark = picture.rgb.iter().filter(|c| c[1] == 0.0).count() as f64;
        let expected = 20_000.0 * (-5.0_f64).exp();
        assert!((dark - expected).abs() < 4.0 * expected.sqrt(), "{dark} of {expected}");
    }

    #[test]
    fn it_keeps_the_laws_of_films() {
        FilmLaws { brighter_with_light: false, ..FilmLaws::default() }.hold(&*film(FILM));
    }

    #[test]
    fn what_cannot_be_is_said() {
        assert_fault("film", "{kind: night-vision, exposure: 1 s}", "full");
        assert_fault("film", "{kind: night-vision, exposure: 1 s, full: 0}", "full");
    }
}
