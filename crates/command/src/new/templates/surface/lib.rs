//! `kind: my-stage`, a surface.

use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::prelude::*;

/// A cubic phase plate, which blurs near and far objects equally.
///
/// z = height ((x / radius)^3 + (y / radius)^3). A point at any distance becomes the same small comet,
/// which a computer can remove from the whole picture at once.
///
/// # Example
/// ```yaml
/// {kind: my-stage, height: 40 um, radius: 10, thickness: 2, glass: SCHOTT/N-BK7}
/// ```
/// # References
/// - E. R. Dowski and W. T. Cathey, Applied Optics 34, 1859 (1995).
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct MyStageParams {
    /// Sag on the x axis at `radius`, mm if bare; 0 is a plane.
    height: Length,
    /// Distance from the axis, along x, where the sag is `height`, mm if bare.
    radius: Positive<Length>,
}

spectra_core::register!(surface "my-stage": MyStageParams, build);

fn build(params: &Params, _: &Context<'_>) -> Result<Box<dyn Surface>, Faults> {
    let p: MyStageParams = params.parse()?;
    let (height, radius) = (p.height.mm(), p.radius.mm());
    if height.abs() > radius {
        let fault = params.fault("height", format!("{height} mm is too steep"));
        return Err(fault.hint("use at most `radius`; 40 um is already a lot").into());
    }
    let cubic_per_mm2 = height / (radius * radius * radius);
    Ok(Box::new(PerRay(FromSag(MyStage { cubic_per_mm2 }))))
}

#[derive(Debug)]
struct MyStage {
    cubic_per_mm2: f64,
}

impl SagShape for MyStage {
    fn sag_mm(&self, x: f64, y: f64) -> Option<f64> {
        Some(self.cubic_per_mm2 * (x * x * x + y * y * y))
    }

    // Without this, slopes are computed by finite differences, which is slower and less exact.
    fn slope(&self, x: f64, y: f64) -> Option<(f64, f64)> {
        Some((3.0 * self.cubic_per_mm2 * x * x, 3.0 * self.cubic_per_mm2 * y * y))
    }
}

#[cfg(test)]
mod tests {
    use spectra_core::glam::DVec3;
    use spectra_core::surface::Action;
    use spectra_testing::{SurfaceLaws, assert_fault, ray, surface};

    /// A ray parallel to the axis is turned by twice the angle of the slope: at x = 5 mm the slope is
    /// 3 (0.4 mm / 1000 mm^3) 25 mm^2 = 0.03.
    #[test]
    fn a_mirror_turns_light_by_twice_its_slope() {
        let plate = surface("{kind: my-stage, height: 0.4, radius: 10}");
        let start = (DVec3::new(5.0, 0.0, -20.0), DVec3::Z);
        let (at, toward) = ray(&*plate, start, (1.0, 1.0), Action::Reflect).unwrap();
        assert!((at.z - 0.05).abs() < 1e-12, "{at}");
        let turned = 2.0 * 0.03 / (1.0 - 0.03 * 0.03);
        assert!((toward.x / -toward.z - turned).abs() < 1e-12 && toward.y == 0.0, "{toward}");
    }

    #[test]
    fn it_keeps_the_laws_of_surfaces() {
        SurfaceLaws::default().hold(&*surface("{kind: my-stage, height: 0.5, radius: 10}"));
    }

    #[test]
    fn what_cannot_be_is_said() {
        assert_fault("surface", "{kind: my-stage, height: 11, radius: 10}", "height");
        assert_fault("surface", "{kind: my-stage, height: 1, radius: -10}", "radius");
    }
}
