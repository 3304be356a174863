//! `kind: beam`: a thin beam of parallel light, round or cut by a slit.

use crate::white;
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::math::{concentric_disk, tan};
use spectra_core::params::{Angle, Faults, Length, Params, Positive, Power, Quantity};
use spectra_core::registry::Context;
use spectra_core::spectral::SpectralPower;
use spectra_core::stage::{Emit, Source};
use spectra_core::{RayBatch, batch::CONTINUUM};

/// A thin beam of parallel light, round or cut by a slit.
///
/// Use it as a ray box for prisms, gratings and anything on an optical bench. All of its rays run in one direction, from a
/// disk (`diameter`) or a rectangle (`slit`) perpendicular to the beam. It is rendered from the source
/// (`direction: forward`). To draw its path, write `output: [{kind: rays}]`.
///
/// # Example
/// ```yaml
/// {kind: beam, distance: 60, direction: [0, 10 deg], slit: [0.2 mm, 5 mm], spectrum: "blackbody:5800", power: 1 mW}
/// ```
/// ```yaml
/// {kind: beam, distance: 100 mm, diameter: 1 mm, spectrum: he-ne}
/// ```
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct BeamParams {
    /// Distance of the start of the beam from the first vertex, mm if bare.
    distance: Positive<Length>,
    /// Position of the start of the beam (to the photographer's right, and up), mm if bare; on the axis if left out.
    position: Option<[Length; 2]>,
    /// Tilt of the beam (toward the photographer's right, and upward), degrees if bare, each within 85.9 degrees; along the
    /// axis if left out.
    direction: Option<[Angle; 2]>,
    /// Diameter of a round beam, mm if bare. Write either this or `slit`.
    diameter: Option<Positive<Length>>,
    /// Width and height of a slit that cuts the beam, mm if bare. Write either this or `diameter`.
    slit: Option<[Positive<Length>; 2]>,
    /// Spectrum of the beam: the name of a light or lamp, a file beside the scene, or an expression such as `blackbody:5800`.
    #[serde(default = "daylight")]
    spectrum: String,
    /// Radiant power of the beam in the band, W if bare.
    #[serde(default = "power")]
    power: Positive<Power>,
}

fn daylight() -> String {
    "D65".to_owned()
}

fn power() -> Positive<Power> {
    Positive::from_bare(1e-3)
}

spectra_core::register!(source "beam": BeamParams, build);

fn build(params: &Params, context: &Context<'_>) -> Result<Box<dyn Source>, Faults> {
    let p: BeamParams = params.parse()?;
    let shape = match (p.diameter, p.slit) {
        (Some(diameter), None) => BeamShape::Disk { radius_mm: 0.5 * diameter.mm() },
        (None, Some([width, height])) => BeamShape::Slit { half_mm: [0.5 * width.mm(), 0.5 * height.mm()] },
        (Some(_), Some(_)) => {
            return Err(params.fault("slit", "`diameter` and `slit` exclude each other").into());
        }
        (None, None) => {
            let fault = params.fault("diameter", "the width of the beam is missing");
            return Err(fault.hint("write `diameter: 1 mm`, or `slit: [0.2 mm, 5 mm]`").into());
        }
    };
    let angles = p.direction.map_or([0.0; 2], |d| d.map(|a| a.rad()));
    if let Some(bad) = angles.iter().position(|a| a.abs() >= 1.5) {
        return Err(params
            .fault(&format!("direction[{bad}]"), "the tilt of the beam must be less than 86 degrees")
            .into());
    }
    let slopes = angles.map(tan);
    let length = (1.0 + slopes[0] * slopes[0] + slopes[1] * slopes[1]).sqrt();
    let [x_mm, y_mm] = p.position.map_or([0.0; 2], |position| position.map(|l| l.mm()));
    let named = white::light("spectrum", &p.spectrum, params, context)?;
    let lines: f64 = named.lines.iter().filter(|l| context.grid.contains(l.wavelength_nm)).map(|l| l.power).sum();
    let in_band = context.grid.integrate(&named.continuum) + lines;
    let spectrum = named.scaled(p.power.w() / in_band);
    Ok(Box::new(Beam {
        start_mm: [x_mm, y_mm, -p.distance.mm()],
        direction: [slopes[0] / length, slopes[1] / length, 1.0 / length],
        shape,
        spectrum,
    }))
}

#[derive(Clone, Copy, Debug)]
enum BeamShape {
    Disk { radius_mm: f64 },
    Slit { half_mm: [f64; 2] },
}

struct Beam {
    start_mm: [f64; 3],
    direction: [f64; 3],
    shape: BeamShape,
    /// Radiant power, W/nm, and W in lines.
    spectrum: SpectralPower,
}

impl Source for Beam {
    fn spectrum(&self) -> &SpectralPower {
        &self.spectrum
    }
    fn distance_mm(&self) -> f64 {
        -self.start_mm[2]
    }
    fn emit(&self) -> Option<&dyn Emit> {
        Some(self)
    }
    fn describe(&self) -> String {
        format!("beam from {} mm in front of the lens", -self.start_mm[2])
    }
}

/// Square millimeters per square meter. With this factor, flux over an area in mm^2 is irradiance in W m^-2.
const MM2_PER_M2: f64 = 1e6;

impl Emit for Beam {
    fn place(&self, rays: &mut RayBatch, u: &[f64], v: &[f64]) {
        // Two unit vectors perpendicular to the beam, the first one horizontal. x runs to the photographer's right.
        let [l, m, n] = self.direction;
        let flat = (l * l + n * n).sqrt();
        let (right, up) = ([n / flat, 0.0, -l / flat], [-l * m / flat, flat, -m * n / flat]);
        let c = rays.columns_mut();
        for i in 0..c.x.len() {
            let (a, b) = match self.shape {
                BeamShape::Disk { radius_mm } => {
                    let (a, b) = concentric_disk(u[i], v[i]);
                    (radius_mm * a, radius_mm * b)
                }
                BeamShape::Slit { half_mm } => ((2.0 * u[i] - 1.0) * half_mm[0], (2.0 * v[i] - 1.0) * half_mm[1]),
            };
            let at = |k: usize| self.start_mm[k] + a * right[k] + b * up[k];
            (c.x[i], c.y[i], c.z[i]) = (at(0), at(1), at(2));
            (c.l[i], c.m[i], c.n[i]) = (l, m, n);
            let radiated = if c.line[i] == CONTINUUM {
                self.spectrum.grid.interpolate(&self.spectrum.continuum, c.wavelength_nm[i])
            } else {
                self.spectrum.lines.get(c.line[i] as usize).map_or(0.0, |l| l.power)
            };
            c.weight[i] *= radiated * MM2_PER_M2;
        }
    }

    fn is_directed(&self) -> bool {
        true
    }

    fn radiate(&self, _: &mut RayBatch) {}
}
