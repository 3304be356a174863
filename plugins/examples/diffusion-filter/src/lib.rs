//! The surface `kind: diffusion-filter`, which needs random numbers.

use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::glam::{DVec2, DVec3};
use spectra_core::math::{log, sin, sin_cos_turns};
use spectra_core::params::Ratio;
use spectra_core::prelude::*;
use spectra_core::surface::{Action, Bending, Intersection, ScalarShape};

/// A filter that scatters a share of the light: lamps get a glow, and dark parts of the picture a veil.
///
/// The scattered light has a narrow and a wide lobe. Each lobe is a normal distribution of direction cosines: the direction
/// across the surface changes by a step that depends on neither direction nor position, as behind a thin rough layer (Harvey
/// 1979). `glow` and `veil` are the standard deviations of the step along each axis, given as angles of light that arrives
/// along the axis. A step and its reverse are equally likely, and steps keep the etendue. Therefore light keeps its weight in
/// both directions of travel, and the picture is the same from the source and from the imager. Light that would leave at more
/// than 90 degrees is absorbed.
///
/// The surface is a plane. Put it in front of the lens, in air or on a glass. Its own reflections are not computed. Drawings,
/// focus and f-numbers use the light that is not scattered.
///
/// # Example
/// ```yaml
/// {kind: diffusion-filter, share: 0.3, glow: 0.5 deg, veil: 4 deg, thickness: 8, semi-diameter: 26}
/// ```
/// # References
/// - J. E. Harvey, "Fourier treatment of near-field scalar diffraction theory", Am. J. Phys. 47, 974 (1979).
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct DiffusionFilterParams {
    /// Share of the light that is scattered, 0 to 1.
    #[schemars(range(max = 1))]
    share: NonNegative<Ratio>,
    /// Width of the narrow lobe, degrees if bare, up to 20.
    glow: NonNegative<Angle>,
    /// Width of the wide lobe, degrees if bare, up to 20.
    veil: NonNegative<Angle>,
    /// Share of the scattered light that is in the wide lobe, 0 to 1; 0.5 if absent.
    #[schemars(range(max = 1))]
    veil_share: Option<NonNegative<Ratio>>,
}

/// Largest width of a lobe, degrees. A wider lobe would lose much of its light beyond 90 degrees.
const WIDEST_DEG: f64 = 20.0;

spectra_core::register!(surface "diffusion-filter": DiffusionFilterParams, build);

fn build(params: &Params, _: &Context<'_>) -> Result<Box<dyn Surface>, Faults> {
    let p: DiffusionFilterParams = params.parse()?;
    let mut faults = Faults::new();
    let veil_share = p.veil_share.map_or(0.5, |share| share.number());
    for (key, share) in [("share", p.share.number()), ("veil-share", veil_share)] {
        if share > 1.0 {
            faults
                .push(params.fault(key, format!("a share of {share} is more than all the light")).hint("write 0 to 1"));
        }
    }
    for (key, width) in [("glow", p.glow), ("veil", p.veil)] {
        if width.rad() > WIDEST_DEG.to_radians() {
            faults.push(params.fault(key, "this lobe is too wide").hint(format!("write at most {WIDEST_DEG} degrees")));
        }
    }
    let widths = [p.glow, p.veil].map(|width| sin(width.rad()));
    faults.into_result(Box::new(PerRay(DiffusionFilter { share: p.share.number(), veil_share, widths })))
}

#[derive(Debug)]
struct DiffusionFilter {
    share: f64,
    veil_share: f64,
    /// Standard deviations of the glow and the veil, as direction cosines.
    widths: [f64; 2],
}

/// Index of the ray's random number that selects the lobe.
const WHICH_LOBE: u32 = 0;
/// Index of the ray's random numbers that select the step.
const HOW_FAR: u32 = 1;

impl DiffusionFilter {
    /// Returns the change of a ray's direction cosines, or `None` if the ray is not scattered.
    fn step(&self, at: &Bending) -> Option<DVec2> {
        let numbers = at.numbers?;
        // Below the share, the ray is scattered; the same number, scaled to 0..1, selects the lobe.
        let part = numbers.number(WHICH_LOBE) / self.share;
        if part.is_nan() || part >= 1.0 {
            return None;
        }
        let [u, v] = numbers.pair(HOW_FAR);
        let far = self.widths[usize::from(part < self.veil_share)] * (-2.0 * log(1.0 - u)).sqrt();
        let (sin, cos) = sin_cos_turns(v);
        Some(far * DVec2::new(cos, sin))
    }
}

impl ScalarShape for DiffusionFilter {
    fn intersect(&self, position: DVec3, direction: DVec3) -> Option<Intersection> {
        Some(Intersection { distance_mm: -position.z / direction.z, normal: DVec3::Z })
    }

    fn sag_mm(&self, _: f64, _: f64) -> Option<f64> {
        Some(0.0)
    }

    fn vertex_curvature_per_mm(&self) -> (f64, f64) {
        (0.0, 0.0)
    }

    fn draws(&self) -> bool {
        true
    }

    fn redirect(&self, at: &Bending) -> Option<Result<DVec3, Loss>> {
        let step = self.step(at)?;
        // Refraction keeps the component of index times direction along the plane.
        let n_after = if at.action == Action::Reflect { at.n_before } else { at.n_after };
        let along = (at.n_before * at.direction.truncate() + step) / n_after;
        let square = 1.0 - along.length_squared();
        if square.is_nan() || square <= 0.0 {
            return Some(Err(Loss::Absorbed));
        }
        let away = if at.action == Action::Reflect { -at.normal.z } else { at.normal.z };
        Some(Ok(along.extend(away * square.sqrt())))
    }
}

#[cfg(test)]
mod tests {
    use spectra_core::Loss;
    use spectra_core::glam::DVec3;
    use spectra_testing::{Rays, SurfaceLaws, assert_fault, surface};

    const RAYS: usize = 1 << 14;

    /// Returns the steps in direction cosines of rays from this direction, and how many rays end.
    fn steps(yaml: &str, from: DVec3) -> (Vec<DVec3>, usize) {
        let how = Rays { indices: (1.0, 1.0), seed: Some(5), ..Rays::default() };
        let met = how.meet(&*surface(yaml), &vec![(-10.0 * from, from); RAYS]);
        assert!(met.iter().all(|met| met.is_ok() || *met == Err(Loss::Absorbed)));
        let steps: Vec<DVec3> = met.iter().flatten().map(|(_, d)| *d - from).collect();
        let ended = RAYS - steps.len();
        (steps, ended)
    }

    /// The share of rays that are not scattered is exact to one ray, for any direction and either direction of travel.
    #[test]
    fn the_share_is_what_is_stated() {
        for from in [DVec3::Z, DVec3::NEG_Z, DVec3::new(0.5, -0.3, 1.0).normalize()] {
            let (steps, ended) =
                steps("{kind: diffusion-filter, share: 0.3, glow: 0.5 deg, veil: 4 deg, veil-share: 0.2}", from);
            let straight = steps.iter().filter(|step| **step == DVec3::ZERO).count();
            assert!((straight as f64 - 0.7 * RAYS as f64).abs() <= 1.0, "{straight}");
            assert_eq!(ended, 0);
            // The standard deviations are 0.0087 and 0.07. A step within 0.03 belongs to the narrow lobe, or with probability
            // 1 - exp(-0.03^2 / (2 0.0698^2)) = 0.0884 to the wide one; a longer step belongs to the wide lobe.
            let wide = steps.iter().filter(|step| step.truncate().length() > 0.03).count() as f64;
            let (s, g) = (4_f64.to_radians().sin(), 0.5_f64.to_radians().sin());
            let beyond = |width: f64| (-0.5 * (0.03 / width) * (0.03 / width)).exp();
            let want = 0.3 * (0.2 * beyond(s) + 0.8 * beyond(g)) * RAYS as f64;
            assert!((wide - want).abs() < 3.0 * want.sqrt(), "{wide} {want}");
        }
    }

    /// Closed forms of the normal distribution: mean 0, mean square s^2 along each axis, fourth power of the length 8 s^4, no
    /// correlation between the axes. Checked on the axis and obliquely, within 3 standard errors of independent samples.
    #[test]
    fn lobes_have_the_moments_of_their_widths() {
        let n = RAYS as f64;
        for (veil_share, width_deg) in [(0.0, 0.5_f64), (1.0, 4.0)] {
            let yaml =
                format!("{{kind: diffusion-filter, share: 1, glow: 0.5 deg, veil: 4 deg, veil-share: {veil_share}}}");
            for from in [DVec3::Z, DVec3::new(0.4, 0.2, -1.0).normalize()] {
                let (steps, _) = steps(&yaml, from);
                let s = width_deg.to_radians().sin();
                let mean = |f: &dyn Fn(f64, f64) -> f64| steps.iter().map(|d| f(d.x / s, d.y / s)).sum::<f64>() / n;
                let near = |got: f64, want: f64, variance: f64| {
                    assert!((got - want).abs() < 3.0 * (variance / n).sqrt(), "{width_deg} deg: {got}, not {want}");
                };
                near(mean(&|x, _| x), 0.0, 1.0);
                near(mean(&|_, y| y), 0.0, 1.0);
                near(mean(&|x, _| x * x), 1.0, 2.0);
                near(mean(&|_, y| y * y), 1.0, 2.0);
                near(mean(&|x, y| x * y), 0.0, 1.0);
                near(mean(&|x, y| (x * x + y * y) * (x * x + y * y)), 8.0, 384.0 - 64.0);
            }
        }
    }

    /// Part of grazing light is scattered back behind the plane and lost there.
    #[test]
    fn what_would_not_leave_is_absorbed() {
        let from = DVec3::new(0.995, 0.0, 0.1).normalize();
        let (steps, ended) = steps("{kind: diffusion-filter, share: 1, glow: 4 deg, veil: 4 deg}", from);
        assert!(ended > RAYS / 4 && steps.len() > RAYS / 4, "{ended}");
    }

    #[test]
    fn it_keeps_the_laws_of_surfaces() {
        let filter = "{kind: diffusion-filter, share: 0.4, glow: 1 deg, veil: 5 deg}";
        SurfaceLaws::default().hold(&*surface(filter));
    }

    #[test]
    fn what_cannot_be_is_said() {
        assert_fault("surface", "{kind: diffusion-filter, share: 1.2, glow: 1, veil: 5}", "share");
        assert_fault("surface", "{kind: diffusion-filter, share: 0.2, glow: 1, veil: 50}", "veil");
        assert_fault("surface", "{kind: diffusion-filter, share: 0.2, glow: -1, veil: 5}", "glow");
        assert_fault("surface", "{kind: diffusion-filter, share: 0.2, glow: 1, veil: 5, veil-share: 2}", "veil-share");
    }
}
