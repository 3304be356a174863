//! `kind: my-stage`, a source.

use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::math::{expm1, sin_cos_turns};
use spectra_core::prelude::*;
use std::f64::consts::PI;

/// A ring lamp: a glowing ring around the axis.
///
/// The ring radiates as a black body, with the same radiance in all directions (Lambert's law).
///
/// # Example
/// ```yaml
/// {kind: my-stage, distance: 2 m, diameter: 40 cm, width: 4 cm, temperature: 3200 K}
/// ```
/// # References
/// - M. Planck, Annalen der Physik 309, 553 (1901); constants: CODATA 2018.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct MyStageParams {
    /// Distance from the first vertex of the lens, mm if bare.
    distance: Positive<Length>,
    /// Outer diameter, mm if bare.
    diameter: Positive<Length>,
    /// Width of the glowing ring, mm if bare: at most half of the diameter, which makes a disk.
    width: Positive<Length>,
    /// Temperature, 500 K to 50 000 K, K if bare; a halogen lamp has 3200 K.
    #[schemars(range(min = 500, max = 50_000))]
    temperature: Positive<Temperature>,
}

spectra_core::register!(source "my-stage": MyStageParams, build);

fn build(params: &Params, context: &Context<'_>) -> Result<Box<dyn Source>, Faults> {
    let p: MyStageParams = params.parse()?;
    let outer_mm = 0.5 * p.diameter.mm();
    let inner_mm = outer_mm - p.width.mm();
    if inner_mm < 0.0 {
        let fault = params.fault("width", "the ring is wider than half of its diameter");
        return Err(fault.hint("write at most half of the diameter, which makes a disk").into());
    }
    let kelvin = p.temperature.kelvin();
    let grid = context.grid;
    let continuum = grid.wavelengths_nm().map(|nm| planck(nm, kelvin)).collect();
    let radiance = SpectralPower { grid, continuum, lines: Vec::new() };
    Ok(Box::new(MyStage { distance_mm: p.distance.mm(), inner_mm, outer_mm, radiance }))
}

/// Radiance of a black body, W m^-2 sr^-1 nm^-1.
fn planck(nm: f64, kelvin: f64) -> f64 {
    let m = 1e-9 * nm;
    1.191_042_972e-16 / (m * m * m * m * m * expm1(0.014_387_768_77 / (m * kelvin))) * 1e-9
}

struct MyStage {
    distance_mm: f64,
    inner_mm: f64,
    outer_mm: f64,
    /// W m^-2 sr^-1 nm^-1.
    radiance: SpectralPower,
}

impl MyStage {
    fn radiance_at(&self, nm: f64) -> f64 {
        self.radiance.grid.interpolate(&self.radiance.continuum, nm)
    }
}

impl Source for MyStage {
    fn spectrum(&self) -> &SpectralPower {
        &self.radiance
    }
    fn distance_mm(&self) -> f64 {
        self.distance_mm
    }
    fn emit(&self) -> Option<&dyn Emit> {
        Some(self)
    }
    fn radiance(&self) -> Option<&dyn Radiance> {
        Some(self)
    }
    fn describe(&self) -> String {
        format!("ring lamp of {} mm, {} mm in front of the lens", 2.0 * self.outer_mm, self.distance_mm)
    }
}

/// Forward tracing, from the lamp: chooses where rays start and how much they carry.
impl Emit for MyStage {
    fn place(&self, rays: &mut RayBatch, u: &[f64], v: &[f64]) {
        let (inner2, outer2) = (self.inner_mm * self.inner_mm, self.outer_mm * self.outer_mm);
        let area_mm2 = PI * (outer2 - inner2);
        let c = rays.columns_mut();
        for i in 0..c.x.len() {
            let radius = (inner2 + u[i] * (outer2 - inner2)).sqrt();
            let (sin, cos) = sin_cos_turns(v[i]);
            (c.x[i], c.y[i], c.z[i]) = (radius * cos, radius * sin, -self.distance_mm);
            c.weight[i] *= area_mm2 * self.radiance_at(c.wavelength_nm[i]);
        }
    }

    fn radiate(&self, rays: &mut RayBatch) {
        let c = rays.columns_mut();
        for (weight, cosine) in c.weight.iter_mut().zip(c.n.iter()) {
            *weight *= cosine.abs();
        }
    }
}

/// Backward tracing, from the imager: the radiance where rays meet the plane of the lamp.
impl Radiance for MyStage {
    fn radiance(&self, rays: &mut RayBatch) {
        let c = rays.columns_mut();
        for i in 0..c.x.len() {
            let t = (-self.distance_mm - c.z[i]) / c.n[i];
            let (x, y) = (c.x[i] + t * c.l[i], c.y[i] + t * c.m[i]);
            let radius = (x * x + y * y).sqrt();
            let on_ring = c.n[i] < 0.0 && (self.inner_mm..=self.outer_mm).contains(&radius);
            c.weight[i] *= if on_ring { self.radiance_at(c.wavelength_nm[i]) } else { 0.0 };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::planck;
    use spectra_testing::{SourceLaws, assert_fault, source};

    /// Wien's displacement law, and the Rayleigh-Jeans law far beyond the peak.
    #[test]
    fn it_glows_as_black_bodies_do() {
        let peak = 2_897_771.955 / 5000.0;
        let around = [-0.1, 0.0, 0.1].map(|d| planck(peak + d, 5000.0));
        assert!(around[1] > around[0] && around[1] > around[2]);
        let (m, kelvin) = (1.0, 5000.0);
        let classical = 2.0 * 299_792_458.0 * 1.380_649e-23 * kelvin / (m * m * m * m) * 1e-9;
        assert!((planck(1e9 * m, kelvin) / classical - 1.0).abs() < 1e-5);
    }

    #[test]
    fn it_keeps_the_laws_of_sources() {
        let laws = SourceLaws { extent_mm: 50.0, ..SourceLaws::default() };
        let lamp = "{kind: my-stage, distance: 1 m, diameter: 99, width: 9, temperature: 3e3}";
        laws.hold(&*source(lamp));
    }

    #[test]
    fn what_cannot_be_is_said() {
        let wide = "{kind: my-stage, distance: 1 m, diameter: 9, width: 5, temperature: 3200}";
        assert_fault("source", wide, "width");
        let cold = "{kind: my-stage, distance: 1 m, diameter: 9, width: 4, temperature: 20}";
        assert_fault("source", cold, "temperature");
    }
}
