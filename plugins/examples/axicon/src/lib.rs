//! The surface `kind: axicon`, a cone.

use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::math::tan;
use spectra_core::prelude::*;

/// A cone: it images a point into a line along the axis, and a star into a ring.
///
/// The sag is z = tan(angle) (sqrt(r^2 + tip^2) - tip). A ray parallel to the axis is deflected by
/// asin(n sin(angle)) - angle, wherever it meets the cone. In paraxial optics the surface is a plane, because a tip has no focal
/// length.
///
/// # Example
/// ```yaml
/// {kind: axicon, angle: 2 deg, thickness: 4, glass: SCHOTT/N-SF11, semi-diameter: 12.7}
/// ```
/// # References
/// - J. H. McLeod, "The axicon: a new type of optical element", J. Opt. Soc. Am. 44, 592 (1954).
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct AxiconParams {
    /// Angle between the side of the cone and the plane perpendicular to the axis, -80 to 80 degrees, degrees if bare.
    /// Positive: the side bends toward +z.
    #[schemars(range(min = -80, max = 80))]
    angle: Angle,
    /// Radius around the axis within which the tip is rounded, mm if bare; sharp if absent.
    tip: Option<NonNegative<Length>>,
}

spectra_core::register!(surface "axicon": AxiconParams, build);

fn build(params: &Params, _: &Context<'_>) -> Result<Box<dyn Surface>, Faults> {
    let p: AxiconParams = params.parse()?;
    Ok(Box::new(PerRay(FromSag(Axicon { slope: tan(p.angle.rad()), tip_mm: p.tip.map_or(0.0, |tip| tip.mm()) }))))
}

#[derive(Debug)]
struct Axicon {
    slope: f64,
    tip_mm: f64,
}

impl SagShape for Axicon {
    fn sag_mm(&self, x: f64, y: f64) -> Option<f64> {
        Some(self.slope * ((x * x + y * y + self.tip_mm * self.tip_mm).sqrt() - self.tip_mm))
    }

    fn slope(&self, x: f64, y: f64) -> Option<(f64, f64)> {
        let side = (x * x + y * y + self.tip_mm * self.tip_mm).sqrt().max(f64::MIN_POSITIVE);
        Some((self.slope * x / side, self.slope * y / side))
    }

    fn vertex_curvature_per_mm(&self) -> (f64, f64) {
        (0.0, 0.0)
    }
}

#[cfg(test)]
mod tests {
    use spectra_core::glam::DVec3;
    use spectra_core::surface::Action;
    use spectra_testing::{SurfaceLaws, assert_fault, ray, surface};

    /// Compares rays that leave glass of index 1.5 through a side of 10 degrees with Snell's law: all heights have the same
    /// deflection.
    #[test]
    fn every_ray_is_turned_by_the_same_angle() {
        let cone = surface("{kind: axicon, angle: -10 deg}");
        let angle = 10_f64.to_radians();
        let turned = (1.5 * angle.sin()).asin() - angle;
        for height in [0.5, 3.0, 9.0] {
            let start = (DVec3::new(0.0, height, -20.0), DVec3::Z);
            let (at, toward) = ray(&*cone, start, (1.5, 1.0), Action::Refract).unwrap();
            assert!((at.z + height * angle.tan()).abs() < 1e-12, "{at}");
            assert!((toward.y + turned.sin()).abs() < 1e-12 && toward.x == 0.0, "{toward}");
        }
    }

    #[test]
    fn it_keeps_the_laws_of_surfaces() {
        let laws = SurfaceLaws { smooth_vertex: false, ..SurfaceLaws::default() };
        laws.hold(&*surface("{kind: axicon, angle: 5 deg, tip: 0.2}"));
        laws.hold(&*surface("{kind: axicon, angle: -20 deg, tip: 1}"));
    }

    #[test]
    fn what_cannot_be_is_said() {
        assert_fault("surface", "{kind: axicon, angle: 85}", "angle");
        assert_fault("surface", "{kind: axicon, angle: 5, tip: -1}", "tip");
    }
}
