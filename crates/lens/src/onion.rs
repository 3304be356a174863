//! Onion rings: the rings that a turning tool left on the mold of an asphere. Out-of-focus highlights show them like a cut onion.

use glam::DVec3;
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::loss::ALIVE;
use spectra_core::math::sin_cos_turns;
use spectra_core::params::{Length, Positive};
use spectra_core::{Loss, RayBatch};
use std::f64::consts::PI;

/// A ring-shaped height error of a surface: a cosine of the distance from the axis. The height is too small to move the point
/// where a ray meets the surface; only the slope matters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OnionRings {
    /// Distance from ring to ring, mm.
    pub period_mm: f64,
    /// Height from valley to peak, mm.
    pub height_mm: f64,
}

/// Rings left on an asphere by the turning of its mold: out-of-focus highlights look like an onion cut in two.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
#[schemars(inline)]
pub struct OnionRingsForm {
    /// Distance from ring to ring, mm if bare, 10 um to 100 mm.
    #[schemars(range(min = 0.01, max = 100))]
    period: Positive<Length>,
    /// Height from valley to peak, mm if bare, up to 1 um; some tens of nm are visible.
    #[schemars(range(max = 0.001))]
    height: Positive<Length>,
}

impl OnionRingsForm {
    /// Returns the rings that the form states.
    pub fn rings(&self) -> OnionRings {
        OnionRings { period_mm: self.period.mm(), height_mm: self.height.mm() }
    }
}

/// The directions and indices of a batch of rays at a surface, needed to correct the rays for onion rings. The surface has
/// already refracted or reflected the rays as if it had no rings.
pub struct Bent<'a> {
    /// Components of the unit directions in front of the surface.
    pub before: [&'a [f64]; 3],
    /// Refractive indices in front of the surface and behind it.
    pub n: [&'a [f64]; 2],
    /// Whether the surface is a mirror.
    pub mirror: bool,
    /// Number of the surface, from 1, recorded in the rays that end there.
    pub number: u32,
}

impl OnionRings {
    /// Slope of the height error in the outward direction, at a distance `r_mm` from the axis.
    #[must_use]
    pub fn slope(&self, r_mm: f64) -> f64 {
        let turns = r_mm / self.period_mm;
        -PI * self.height_mm / self.period_mm * sin_cos_turns(turns - turns.floor()).0
    }

    /// Corrects the directions of live rays, in the frame of the surface, for the rings. Returns how many rays ended by total
    /// reflection.
    pub fn bend(&self, rays: &mut RayBatch, bent: &Bent<'_>) -> usize {
        let c = rays.columns_mut();
        let mut ended = 0;
        for i in 0..c.x.len() {
            let r = (c.x[i] * c.x[i] + c.y[i] * c.y[i]).sqrt();
            if c.state[i] != ALIVE || r == 0.0 {
                continue;
            }
            let before = DVec3::from_array(bent.before.map(|column| column[i]));
            let after = DVec3::new(c.l[i], c.m[i], c.n[i]);
            let [n, n_after] = bent.n.map(|column| column[i]);
            // Refraction and reflection change the direction along the normal.
            let normal = if bent.mirror { after - before } else { n_after * after - n * before };
            if normal.z == 0.0 {
                continue;
            }
            let slope = self.slope(r);
            let normal = (normal / normal.z - DVec3::new(slope * c.x[i] / r, slope * c.y[i] / r, 0.0)).normalize();
            let normal = if normal.dot(before) < 0.0 { -normal } else { normal };
            let cosine = normal.dot(before);
            let direction = if bent.mirror {
                before - 2.0 * cosine * normal
            } else {
                let mu = n / n_after;
                let square = 1.0 - mu * mu * (1.0 - cosine * cosine);
                if square < 0.0 {
                    c.state[i] = Loss::TotalReflection.state(bent.number);
                    ended += 1;
                    continue;
                }
                mu * before + (square.sqrt() - mu * cosine) * normal
            };
            (c.l[i], c.m[i], c.n[i]) = direction.into();
        }
        ended
    }
}
