//! `kind: point`: one point of light.

use crate::picture::color_model;
use crate::white;
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_color::Transfer;
use spectra_core::params::{Angle, Faults, Length, Params, Part, Positive, Quantity, RadiantIntensity};
use spectra_core::registry::{Context, StageOf};
use spectra_core::spectral::SpectralPower;
use spectra_core::stage::{ColorModel, Emit, Source};
use spectra_core::{Isa, RayBatch, batch::CONTINUUM};

/// One point of light at a finite distance.
///
/// For spots, point spread functions, flare and stars. It shines alike to all sides, with the stated radiant intensity
/// in the band. It is rendered from the source (`direction: forward`), since no ray from the imager would ever meet it.
///
/// It stands on a plane across the axis: at a `position` there, or under the angles of `field` as seen from the first
/// vertex; on the axis where neither is given. Coordinates are the photographer's: to the right, and up.
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
    /// Distance of the plane that holds it from the first vertex, mm if bare.
    distance: Positive<Length>,
    /// Place on that plane (to the photographer's right, up), mm if bare; on the axis if absent.
    position: Option<[Length; 2]>,
    /// In place of `position`: the angles under which it is seen from the first vertex (right, up), degrees if bare,
    /// each within 85.9 degrees.
    field: Option<[Angle; 2]>,
    /// Its spectrum: the name of a light or lamp, a file beside the scene, or an expression such as `blackbody:5800`; D65 if
    /// neither it nor `rgb` is given.
    spectrum: Option<String>,
    /// In place of `spectrum`: its color in sRGB, red, green and blue of 0 to 255. `intensity` says how bright it is.
    #[schemars(inner(range(min = 0, max = 255)))]
    rgb: Option<[f64; 3]>,
    /// With `rgb`, how the color becomes a spectrum: a color model, `smooth` if absent.
    color: Option<Part<StageOf<dyn ColorModel>>>,
    /// Radiant intensity in the band, W/sr if bare.
    #[serde(default = "intensity")]
    intensity: Positive<RadiantIntensity>,
}

/// The spectrum of a point that says none, and white of its colors.
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
                    .fault(&format!("field[{bad}]"), "a field angle of 86 degrees or more".to_owned())
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

/// Its light in any scale.
fn light(p: &PointParams, params: &Params, context: &Context<'_>) -> Result<SpectralPower, Faults> {
    let Some(rgb) = p.rgb else {
        if p.color.is_some() {
            let fault = params.fault("color", "`color` says how an `rgb` becomes a spectrum, and there is none");
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
        let fault = params.fault("rgb", "black is no light");
        return Err(fault.hint("the color of the light; `intensity` says how bright it is").into());
    }
    let daylight = white::light("rgb", DAYLIGHT, params, context)?;
    let model = color_model(p.color.clone(), &daylight, params, context)?;
    Ok(model.spectrum(rgb.map(|v| Transfer::Srgb.decode(v / 255.0))))
}

struct Point {
    place: [f64; 3],
    /// W sr^-1 nm^-1, and W/sr in lines.
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

/// mm^2 a m^2: flux over an area in mm^2 is to be irradiance in W m^-2.
const MM2_PER_M2: f64 = 1e6;

impl Emit for Point {
    fn place(&self, rays: &mut RayBatch, _: &[f64], _: &[f64], _: Isa) {
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

    /// A point shines alike to all sides.
    fn radiate(&self, _: &mut RayBatch, _: Isa) {}
}
