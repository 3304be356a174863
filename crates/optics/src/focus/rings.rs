//! The light of a point on the axis of a round lens: rays in one section, each of which represents a ring.
//!
//! A ring of rays that meets a plane at radius r has the contrast J0(2 pi f r) at the frequency f, whatever the azimuth
//! of the lines (the Hankel transform of a ring). A few such rays say as much as many thousands over the whole pupil.

use crate::Optics;
use crate::beam::{STEEP2, highest};
use crate::bundle::{Bundle, ObjectPoint};
use spectra_core::loss::ALIVE;
use spectra_core::math::{cos, j0};
use spectra_glass::DispersionError;
use spectra_tracer::Indices;
use std::f64::consts::{PI, TAU};
use std::sync::OnceLock;

/// Rings of rays behind a lens, in the frame of the image plane, after the plates in front of it.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Rings {
    /// Radius of each ring at z = 0, in mm, of either sign.
    place_mm: Vec<f64>,
    /// Change of the radius with z.
    slope: Vec<f64>,
    /// Flux of each ring, in arbitrary units.
    weight: Vec<f64>,
}

/// Numbers of heights at which the front of the lens is probed; the larger one is used if nothing passes at the smaller one.
const PROBES: [usize; 2] = [64, 1024];
/// Accuracy of the edges of the zones that pass, as a fraction of the window.
const ACCURACY: f64 = 1e-9;
/// Rings in each zone that passes: nodes of Gauss's rule over its area. At f/1.5 with much spherical aberration 24 rings leave
/// the best contrast at 30/mm 8 um off, 48 rings 5 um, and 96 none. At 60/mm 96 rings leave it 1.5 um off.
const NODES: usize = 192;
/// Stride of the rings that are evaluated on every plane; the planes with the highest contrast are evaluated with all rings.
const SCANNED: usize = 3;

impl Rings {
    /// Traces the light of a point on the axis, `object_mm` in front of the first vertex (infinity allowed), at wavelengths (nm)
    /// with their weights. Returns `None` if the lens is not round or nothing passes.
    pub(super) fn trace(
        optics: &Optics,
        object_mm: f64,
        light: &[(f64, f64)],
    ) -> Result<Option<Self>, DispersionError> {
        if !optics.has_axis_of_revolution() || optics.largest_semi_diameter_mm().is_none() {
            return Ok(None);
        }
        let point = ObjectPoint::on_plane(optics, object_mm, 0.0);
        static KNOWN: OnceLock<Vec<(f64, f64)>> = OnceLock::new();
        let nodes = KNOWN.get_or_init(|| gauss_legendre(NODES));
        let mut rings = Self::default();
        for (wavelength_nm, weight) in light {
            let Some(bundle) = Bundle::before(optics, point, Indices::At(*wavelength_nm))? else { continue };
            for [inner, outer] in zones(&bundle) {
                // Equal parts of the square of the height are equal areas.
                let (low, high) = (inner * inner, outer * outer);
                let heights = nodes.iter().map(|(t, _)| (0.5 * (low + high) + 0.5 * (high - low) * t).sqrt());
                let rays = bundle.trace(&heights.map(|height| [0.0, height]).collect::<Vec<_>>());
                let ([_, y, z], [_, m, n]) = (rays.positions(), rays.directions());
                for (i, (_, share)) in nodes.iter().enumerate() {
                    let slope = m[i] / n[i];
                    let place_mm = y[i] - z[i] * slope;
                    if rays.states()[i] != ALIVE || !place_mm.is_finite() {
                        continue;
                    }
                    let depth_mm = optics.cover.as_ref().map_or(0.0, |c| c.depth_mm(slope.abs(), *wavelength_nm));
                    rings.place_mm.push(place_mm - slope * depth_mm);
                    rings.slope.push(slope);
                    rings.weight.push(weight * rays.weights()[i] * share * (high - low));
                }
            }
        }
        let total: f64 = rings.weight.iter().sum();
        Ok((total > 0.0).then_some(rings))
    }

    /// Weighted mean of a function of radius and slope, over every `stride`-th ring.
    fn mean(&self, stride: usize, of: impl Fn(f64, f64) -> f64) -> f64 {
        let all = || self.place_mm.iter().zip(&self.slope).zip(&self.weight).step_by(stride);
        let total: f64 = all().map(|(_, w)| w).sum();
        all().map(|((r, s), w)| w * of(*r, *s)).sum::<f64>() / total
    }

    /// Plane of the smallest spot, mm behind the image plane; `None` for parallel rays.
    pub(super) fn least_rms_z_mm(&self) -> Option<f64> {
        Some(-self.mean(1, |r, s| r * s) / self.mean(1, |_, s| s * s)).filter(|z| z.is_finite())
    }

    /// Contrast at `per_mm` line pairs per mm on the plane `z_mm` behind the image plane; negative if black and white are swapped.
    fn contrast(&self, z_mm: f64, per_mm: f64, stride: usize) -> f64 {
        self.mean(stride, |r, s| j0(TAU * per_mm * (r + s * z_mm)))
    }

    /// Plane of the highest contrast at `per_mm` line pairs per mm, mm behind the image plane; `None` for parallel rays.
    pub(super) fn best_contrast_z_mm(&self, per_mm: f64) -> Option<f64> {
        let steepest = self.slope.iter().fold(0.0_f64, |a, s| a.max(s.abs()));
        let steep = |(_, s): &(&f64, &f64)| *s * *s > STEEP2 * steepest * steepest;
        let crossings = self.place_mm.iter().zip(&self.slope).filter(steep).map(|(r, s)| -r / s);
        let coarse = |z: f64| self.contrast(z, per_mm, SCANNED);
        let fine = |z: f64| self.contrast(z, per_mm, 1);
        highest(crossings, 1.0 / (per_mm * steepest), coarse, fine).map(|(z, _)| z)
    }
}

/// Returns the annular zones of the window that pass, from the axis outward: inner and outer radius, mm.
fn zones(bundle: &Bundle<'_>) -> Vec<[f64; 2]> {
    let looks = PROBES.map(|probes| move || bundle.zones(&bundle.upward(), probes, ACCURACY));
    looks.into_iter().map(|look| look()).find(|zones| !zones.is_empty()).unwrap_or_default()
}

/// Computes nodes and weights (with the sum 1) of the Gauss-Legendre rule on [-1, 1], by Newton's method from F. G. Tricomi's first
/// guess (M. Abramowitz, I. A. Stegun, Handbook of Mathematical Functions, 22.16.6 and 25.4.29).
fn gauss_legendre(count: usize) -> Vec<(f64, f64)> {
    let n = count as f64;
    let at = |i: usize| {
        let mut x = cos(PI * (i as f64 + 0.75) / (n + 0.5));
        let mut slope = 1.0;
        for _ in 0..8 {
            let (mut p, mut before) = (x, 1.0);
            for k in 2..=count {
                let k = k as f64;
                (p, before) = (((2.0 * k - 1.0) * x * p - (k - 1.0) * before) / k, p);
            }
            slope = n * (x * p - before) / (x * x - 1.0);
            x -= p / slope;
        }
        (x, 1.0 / ((1.0 - x * x) * slope * slope))
    };
    (0..count).map(at).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// [`NODES`] nodes integrate x^46 exactly.
    #[test]
    fn gauss_is_exact() {
        let nodes = gauss_legendre(NODES);
        let sum = |power: i32| nodes.iter().map(|(x, w)| w * x.powi(power)).sum::<f64>();
        for (power, want) in [(0, 1.0), (2, 1.0 / 3.0), (20, 1.0 / 21.0), (46, 1.0 / 47.0), (7, 0.0)] {
            assert!((sum(power) - want).abs() < 1e-14, "{power}: {}", sum(power));
        }
    }
}
