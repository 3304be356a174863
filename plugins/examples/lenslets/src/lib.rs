//! The source `kind: lenslets`, an integral photograph.

use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::math::{cos, exp, sin};
use spectra_core::prelude::*;
use std::f64::consts::TAU;

/// An integral photograph: a panel of lenslets, each of which shows a different view of a wheel.
///
/// Behind each lenslet lies a small picture, so the panel emits the light of a wheel that floats in front of it or behind it.
/// A lens focused on the panel sees sharp lenslets and a blurred wheel. A lens focused on the wheel sees the wheel as sharply
/// as the pitch allows.
///
/// # Example
/// ```yaml
/// {kind: lenslets, distance: 1 m, width: 40 cm, pitch: 4 mm, depth: 20 cm}
/// ```
/// # References
/// - G. Lippmann, "La photographie integrale", Comptes rendus 146, 446 (1908).
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct LensletsParams {
    /// Distance of the panel from the first vertex of the lens, mm if bare.
    distance: Positive<Length>,
    /// Width and height of the panel, mm if bare.
    width: Positive<Length>,
    /// Distance between neighboring lenslets, mm if bare; they form a square grid.
    pitch: Positive<Length>,
    /// Distance of the floating wheel behind the panel, mm if bare. Negative: in front of the panel, but behind the first
    /// vertex of the lens.
    depth: Length,
}

spectra_core::register!(source "lenslets": LensletsParams, build);

fn build(params: &Params, context: &Context<'_>) -> Result<Box<dyn Source>, Faults> {
    let p: LensletsParams = params.parse()?;
    let (distance_mm, width_mm, pitch_mm) = (p.distance.mm(), p.width.mm(), p.pitch.mm());
    let mut faults = Faults::new();
    if pitch_mm > width_mm {
        faults.push(params.fault("pitch", "one lenslet is wider than the panel").hint("write at most `width`"));
    }
    if p.depth.mm() <= -distance_mm {
        let fault = params.fault("depth", "the wheel would float inside the lens or behind it");
        faults.push(fault.hint(format!("write more than -{distance_mm} mm, the negative distance of the panel")));
    }
    // The spectrum of a light-emitting diode: 530 nm, 40 nm wide, 0.1 W m^-2 sr^-1 nm^-1 at its peak.
    let grid = context.grid;
    let continuum = grid.wavelengths_nm().map(|nm| 0.1 * exp(-0.5 * ((nm - 530.0) / 17.0) * ((nm - 530.0) / 17.0)));
    let radiance = SpectralPower { grid, continuum: continuum.collect(), lines: Vec::new() };
    faults.into_result(Box::new(Lenslets { distance_mm, width_mm, pitch_mm, depth_mm: p.depth.mm(), radiance }))
}

struct Lenslets {
    distance_mm: f64,
    width_mm: f64,
    pitch_mm: f64,
    depth_mm: f64,
    /// Radiance of the parts that shine, W m^-2 sr^-1 nm^-1.
    radiance: SpectralPower,
}

impl Lenslets {
    /// Returns whether light leaves a point of the panel (mm) along the slopes dx/dz and dy/dz.
    fn shines(&self, [x, y]: [f64; 2], [along_x, along_y]: [f64; 2]) -> bool {
        let half = 0.5 * self.width_mm;
        if x.abs() > half || y.abs() > half {
            return false;
        }
        // Every point of a lenslet shows what its center shows.
        let center = |at: f64| ((at / self.pitch_mm).floor() + 0.5) * self.pitch_mm;
        let (px, py) = (center(x) - self.depth_mm * along_x, center(y) - self.depth_mm * along_y);
        wheel(px / half, py / half)
    }
}

/// Returns whether a point lies on a wheel of radius 0.8 with eight spokes.
fn wheel(x: f64, y: f64) -> bool {
    let radius = (x * x + y * y).sqrt();
    let spoke = (0..4).any(|i| (x * sin(f64::from(i) * TAU / 8.0) - y * cos(f64::from(i) * TAU / 8.0)).abs() < 0.03);
    (0.7..0.8).contains(&radius) || radius < 0.12 || (radius < 0.7 && spoke)
}

impl Source for Lenslets {
    fn spectrum(&self) -> &SpectralPower {
        &self.radiance
    }
    fn distance_mm(&self) -> f64 {
        self.distance_mm
    }
    fn radiance(&self) -> Option<&dyn Radiance> {
        Some(self)
    }
    fn describe(&self) -> String {
        format!(
            "integral photograph, {} mm before the lens, of a wheel {} mm behind it",
            self.distance_mm, self.depth_mm
        )
    }
}

/// Radiance that rays meet at the panel.
impl Radiance for Lenslets {
    fn radiance(&self, rays: &mut RayBatch) {
        let c = rays.columns_mut();
        for i in 0..c.x.len() {
            let slopes = [c.l[i] / c.n[i], c.m[i] / c.n[i]];
            let t = -self.distance_mm - c.z[i];
            let shines = c.n[i] < 0.0 && self.shines([c.x[i] + t * slopes[0], c.y[i] + t * slopes[1]], slopes);
            let radiance = self.radiance.grid.interpolate(&self.radiance.continuum, c.wavelength_nm[i]);
            c.weight[i] *= if shines { radiance } else { 0.0 };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use spectra_testing::{SourceLaws, assert_fault, source};

    /// Rays toward one point of the floating wheel agree from every lenslet, to within the pitch.
    #[test]
    fn the_wheel_floats() {
        let p = Lenslets {
            distance_mm: 1000.0,
            width_mm: 400.0,
            pitch_mm: 0.01,
            depth_mm: 200.0,
            radiance: SpectralPower::dark(spectra_core::spectral::BAND),
        };
        for (wheel_x, shines) in [(0.0, true), (150.0, true), (180.0, false)] {
            for from in [-100.0, 0.0, 120.0] {
                // The line through (from, 0) on the panel and (wheel_x, 0), 200 mm behind it.
                let slope = (from - wheel_x) / 200.0;
                assert_eq!(p.shines([from, 0.005], [slope, 0.0]), shines, "{wheel_x} from {from}");
            }
        }
    }

    #[test]
    fn it_keeps_the_laws_of_sources() {
        let laws = SourceLaws { extent_mm: 210.0, ..SourceLaws::default() };
        laws.hold(&*source("{kind: lenslets, distance: 1 m, width: 400, pitch: 4, depth: 200}"));
    }

    #[test]
    fn what_cannot_be_is_said() {
        assert_fault("source", "{kind: lenslets, distance: 1 m, width: 40, pitch: 50, depth: 0}", "pitch");
        assert_fault("source", "{kind: lenslets, distance: 1 m, width: 40, pitch: 5, depth: -1 m}", "depth");
    }
}
