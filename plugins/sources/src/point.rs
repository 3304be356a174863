//! `kind: point`: a point source of light.

use crate::picture::color_model;
use crate::white;
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_color::Transfer;
use spectra_core::params::{Angle, Deferred, Faults, Length, Params, Positive, Quantity, RadiantIntensity};
use spectra_core::registry::{Context, StageOf};
use spectra_core::spectral::SpectralPower;
use spectra_core::stage::{ColorModel, Emit, Source};
use spectra_core::{RayBatch, batch::CONTINUUM};

/// A point source of light at a finite distance.
///
/// Use it for spots, point spread functions, flare and stars. It radiates equally in all directions, with the given radiant
/// intensity in the band. It is rendered from the source (`direction: forward`), since no ray from the imager would ever
/// meet it.
///
/// The point lies on a plane perpendicular to the axis: at a `position` there, or under the angles of `field` as seen from
/// the first vertex. If neither is given, it lies on the axis. Coordinates are the photographer's: to the right, and up.
///
/// # Example
/// ```yaml
/// {kind: point, distance: 10 m, field: [12 deg, 0], spectrum: D65}
/// ```
/// ```yaml
/// {kind: point, distance: 2 m, position: [30 cm, 10 cm], spectrum: hydrogen, intensity: 0.01 W/sr}
/// ```
/// ```yaml
/// {kind: point, distance: 2 m, rgb: [255, 128, 64]}
/// ```
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct PointParams {
    /// Distance of the plane of the point from the first vertex, mm if bare.
    distance: Positive<Length>,
    /// Position on that plane (to the photographer's right, and up), mm if bare; on the axis if left out.
    position: Option<[Length; 2]>,
    /// Direction of the point as seen from the first vertex (right, up), instead of `position`; degrees if bare, each within
    /// 85.9 degrees.
    field: Option<[Angle; 2]>,
    /// Spectrum of the point: the name of a light or lamp, a file beside the scene, or an expression such as
    /// `blackbody:5800`; D65 if neither this nor `rgb` is given.
    spectrum: Option<String>,
    /// Color of the point in sRGB (red, green and blue, 0 to 255), instead of `spectrum`. `intensity` sets its brightness.
    #[schemars(inner(range(min = 0, max = 255)))]
    rgb: Option<[f64; 3]>,
    /// Color model that turns `rgb` into a spectrum; `smooth` if left out.
    color: Option<Deferred<StageOf<dyn ColorModel>>>,
    /// Radiant intensity of the point in the band, W/sr if bare.
    #[serde(default = "intensity")]
    intensity: Positive<RadiantIntensity>,
}

/// Default spectrum of a point, and the white of its `rgb` colors.
const DAYLIGHT: &str = "D65";

fn intensity() -> Positive<RadiantIntensity> {
    Positive::from_bare(1e-3)
}

spectra_core::register!(source "point": PointParams, build);

fn build(params: &Params, context: &Context<'_>) -> Result<Box<dyn Source>, Faults> {
    let p: PointParams = params.parse()?;
    let distance_mm = p.distance.mm();
    let [x_mm, y_mm] = match (p.position, p.field) {
        (Some(_), Some(_)) => {
            return Err(params.fault("field", "`position` and `field` exclude each other".to_owned()).into());
        }
        (Some(position), None) => position.map(|l| l.mm()),
        (None, Some(field)) => {
            if let Some(bad) = field.iter().position(|a| a.rad().abs() >= 1.5) {
                return Err(params
                    .fault(&format!("field[{bad}]"), "the field angle must be less than 86 degrees".to_owned())
                    .into());
            }
            field.map(|a| distance_mm * spectra_core::math::tan(a.rad()))
        }
        (None, None) => [0.0; 2],
    };
    let named = light(&p, params, context)?;
    let lines: f64 = named.lines.iter().filter(|l| context.grid.contains(l.wavelength_nm)).map(|l| l.power).sum();
    let power = context.grid.integrate(&named.continuum) + lines;
    let spectrum = named.scaled(p.intensity.w_per_sr() / power);
    Ok(Box::new(Point { place: [x_mm, y_mm, -distance_mm], spectrum }))
}

/// Returns the spectrum of the point, in any scale.
fn light(p: &PointParams, params: &Params, context: &Context<'_>) -> Result<SpectralPower, Faults> {
    let Some(rgb) = p.rgb else {
        if p.color.is_some() {
            let fault = params.fault("color", "`color` turns `rgb` into a spectrum, but there is no `rgb`");
            return Err(fault.hint("leave `color` out, or write `rgb: [255, 128, 64]`").into());
        }
        return white::light("spectrum", p.spectrum.as_deref().unwrap_or(DAYLIGHT), params, context);
    };
    if p.spectrum.is_some() {
        return Err(params
            .fault("rgb", "`spectrum` and `rgb` exclude each other")
            .hint("leave one of them out")
            .into());
    }
    if rgb == [0.0; 3] {
        let fault = params.fault("rgb", "the color of a light cannot be black");
        return Err(fault.hint("write the color of the light; `intensity` sets its brightness").into());
    }
    let daylight = white::light("rgb", DAYLIGHT, params, context)?;
    let model = color_model(p.color.clone(), &daylight, params, context)?;
    Ok(model.spectrum(rgb.map(|v| Transfer::Srgb.decode(v / 255.0))))
}

struct Point {
    place: [f64; 3],
    /// Radiant intensity, W sr^-1 nm^-1, and W/sr in lines.
    spectrum: SpectralPower,
}

impl Source for Point {
    fn spectrum(&self) -> &SpectralPower {
        &self.spectrum
    }
    fn distance_mm(&self) -> f64 {
        -self.place[2]
    }
    fn emit(&self) -> Option<&dyn Emit> {
        Some(self)
    }
    fn describe(&self) -> String {
        format!("point at ({}, {}) mm, {} mm in front of the lens", self.place[0], self.place[1], -self.place[2])
    }
}

/// Square millimeters per square meter. With this factor, flux over an area in mm^2 is irradiance in W m^-2.
const MM2_PER_M2: f64 = 1e6;

impl Emit for Point {
    fn place(&self, rays: &mut RayBatch, _: &[f64], _: &[f64]) {
        let c = rays.columns_mut();
        for i in 0..c.x.len() {
            (c.x[i], c.y[i], c.z[i]) = self.place.into();
            let radiated = if c.line[i] == CONTINUUM {
                self.spectrum.grid.interpolate(&self.spectrum.continuum, c.wavelength_nm[i])
            } else {
                self.spectrum.lines.get(c.line[i] as usize).map_or(0.0, |l| l.power)
            };
            c.weight[i] *= radiated * MM2_PER_M2;
        }
    }

    /// Leaves the weights unchanged, since a point radiates equally in all directions.
    fn radiate(&self, _: &mut RayBatch) {}
}
