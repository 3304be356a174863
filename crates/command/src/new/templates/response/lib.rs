//! `kind: my-stage`, a response: the sensitivity of a detector, channel by channel, and how its data are shown.

use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::math::exp;
use spectra_core::prelude::*;

/// The eye of a honey bee: ultraviolet, blue and green.
///
/// The picture shows them as blue, green and red. Red light, which a bee cannot see, is black.
///
/// # Example
/// ```yaml
/// {kind: my-stage, white: 0.2}
/// ```
/// # References
/// - D. Peitsch et al., J. Comp. Physiol. A 170, 23 (1992): peaks at 344, 436 and 544 nm.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct MyStageParams {
    /// Irradiance, weighted by the receptors, that the picture shows as white, W m^-2 (J m^-2 with an exposure time).
    white: Positive<f64>,
}

spectra_core::register!(response "my-stage": MyStageParams, build);

/// Name, peak wavelength and standard deviation of each Gaussian, nm, in the order red, green, blue of the picture.
const RECEPTORS: [(&str, f64, f64); 3] = [("green", 544.0, 45.0), ("blue", 436.0, 35.0), ("ultraviolet", 344.0, 30.0)];

fn build(params: &Params, context: &Context<'_>) -> Result<Box<dyn Response>, Faults> {
    let p: MyStageParams = params.parse()?;
    let channels = RECEPTORS.map(|(name, peak, width)| {
        let sees = |nm: f64| exp(-0.5 * ((nm - peak) / width) * ((nm - peak) / width));
        Channel { name: name.into(), unit: "W m^-2".into(), response: context.grid.wavelengths_nm().map(sees).collect() }
    });
    Ok(Box::new(MyStage { channels, white: p.white.get() }))
}

struct MyStage {
    channels: [Channel; 3],
    white: f64,
}

impl Response for MyStage {
    fn channels(&self) -> Vec<Channel> {
        self.channels.to_vec()
    }

    fn display(&self, exposure: &ExposureFrame) -> Option<DisplayPicture> {
        let planes = RECEPTORS.map(|(name, ..)| exposure.values(name).ok());
        let [Some(red), Some(green), Some(blue)] = planes else { return None };
        let shown = |v: f32| (f64::from(v) / self.white) as f32;
        let rgb = (0..red.len()).map(|i| [shown(red[i]), shown(green[i]), shown(blue[i])]).collect();
        Some(DisplayPicture { width_px: exposure.size.width_px, height_px: exposure.size.height_px, rgb })
    }
}

#[cfg(test)]
mod tests {
    use spectra_testing::{ResponseLaws, assert_fault, response};

    /// A Gaussian falls to exp(-1/2) one standard deviation from its peak.
    #[test]
    fn receptors_see_what_they_should() {
        let channels = response("{kind: my-stage, white: 1}").channels();
        let at = |nm: usize| channels[0].response[nm - 350];
        assert_eq!(at(544), 1.0);
        assert!((at(544 + 45) - 0.606_530_659_7).abs() < 1e-9 && at(700) < 0.003);
    }

    #[test]
    fn it_keeps_the_laws_of_responses() {
        ResponseLaws::default().hold(&*response("{kind: my-stage, white: 1}"));
    }

    #[test]
    fn what_cannot_be_is_said() {
        assert_fault("response", "{kind: my-stage}", "white");
        assert_fault("response", "{kind: my-stage, white: 0}", "white");
    }
}
