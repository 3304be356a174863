//! `kind: sun`: a disk of light at infinity, alone or over another source.

use crate::white;
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::loss::ALIVE;
use spectra_core::math::{concentric_disk, cos, tan};
use spectra_core::params::{Angle, Deferred, Faults, Illuminance, Params, Positive, Quantity, Warning};
use spectra_core::registry::{Context, StageOf, build as build_stage};
use spectra_core::spectral::SpectralPower;
use spectra_core::stage::{Emit, Radiance, Source, Split};
use spectra_core::{RayBatch, batch::CONTINUUM};

/// The sun: a disk of uniform brightness at infinity.
///
/// The angles of `field` give its direction as seen from the lens. A surface that faces the sun receives `illuminance`. With `over`
/// the sun is added to another source, such as a picture of the sky. The sun is then traced forward, from the sun, and the other
/// source backward, from the film. Ghosts of the sun appear where they are bright enough to matter. Objects in the picture do not
/// hide the sun.
///
/// The default diameter is the mean one of the sun, 0.53 degrees; that of the moon is nearly the same. Limb darkening is not modeled.
///
/// # Example
/// ```yaml
/// {kind: sun, field: [15 deg, 9 deg]}
/// ```
/// ```yaml
/// {kind: sun, field: [0, 12 deg], illuminance: 50000 lx, spectrum: "blackbody:5400", over: {kind: chart, chart: white, distance: 10 m, width: fill}}
/// ```
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct SunParams {
    /// Direction of the center of the sun (to the photographer's right, and up), degrees if bare, each within 85.9 degrees.
    field: [Angle; 2],
    /// Angular diameter of the sun, degrees if bare, up to 20 degrees.
    #[serde(default = "diameter")]
    diameter: Positive<Angle>,
    /// Spectrum of the sun: the name of a light or lamp, a file beside the scene, or an expression such as `blackbody:5400`.
    #[serde(default = "spectrum")]
    spectrum: String,
    /// Illuminance on a surface in front of the lens that faces the sun, lx if bare.
    #[serde(default = "illuminance")]
    illuminance: Positive<Illuminance>,
    /// Source to which the sun is added, such as a picture or a chart; black if left out.
    over: Option<Deferred<StageOf<dyn Source>>>,
}

fn diameter() -> Positive<Angle> {
    Positive::from_bare(0.53)
}

fn spectrum() -> String {
    "blackbody:5800".to_owned()
}

fn illuminance() -> Positive<Illuminance> {
    Positive::from_bare(100_000.0)
}

/// Limit of the angles of `field`, rad.
const WIDEST: f64 = 1.5;
/// Largest diameter of the disk, rad.
const LARGEST: f64 = 0.35;

spectra_core::register!(source "sun": SunParams, build);

fn build(params: &Params, context: &Context<'_>) -> Result<Box<dyn Source>, Faults> {
    let p: SunParams = params.parse()?;
    let mut faults = Faults::new();
    if let Some(bad) = p.field.iter().position(|a| a.rad().abs() >= WIDEST) {
        faults.push(params.fault(&format!("field[{bad}]"), "the field angle must be less than 86 degrees"));
    }
    let radius_rad = 0.5 * p.diameter.rad();
    if 2.0 * radius_rad > LARGEST {
        let fault = params.fault("diameter", "the disk is larger than 20 degrees");
        faults.push(fault.hint("the sun is 0.53 degrees wide; for a larger light, use a picture"));
    }
    let named = faults.take(white::light("spectrum", &p.spectrum, params, context));
    let over = match p.over {
        Some(part) => faults.take(part.params().and_then(|over| build_stage::<dyn Source>(&over, context))).map(Some),
        None => Some(None),
    };
    let (Some(named), Some(over)) = faults.into_result((named, over))? else { return Err(Faults::new()) };
    let lux = white::luminance_cd_m2(&named);
    if !(lux > 0.0) {
        let fault =
            params.fault("spectrum", format!("`{}` has no visible light, so no illuminance can be set", p.spectrum));
        return Err(fault.hint("write a light with power between 380 and 780 nm, such as D65").into());
    }
    if over.is_some() && !named.lines.is_empty() {
        let fault = params.fault(
            "spectrum",
            format!("`{}` has spectral lines, which a sun over another source cannot have", p.spectrum),
        );
        return Err(fault.hint("write a continuous spectrum such as `blackbody:5800` or D65").into());
    }
    let [right, up] = p.field.map(|a| tan(a.rad()));
    let length = (1.0 + right * right + up * up).sqrt();
    let disk = Disk {
        toward: [right / length, up / length, -1.0 / length],
        radius: tan(radius_rad),
        cos_radius: cos(radius_rad),
        // Luminous efficacy and observer are the same for radiance and irradiance.
        irradiance: named.scaled(p.illuminance.lx() / lux),
        field_deg: p.field.map(|a| a.rad().to_degrees()),
    };
    Ok(match over {
        None => Box::new(disk),
        Some(over) => Box::new(Over { disk, over }),
    })
}

/// Distance of the plane on which rays start, mm. The rays from one of its points are parallel within 1e-9 over a lens of 10 mm.
const FAR_MM: f64 = 1e10;

struct Disk {
    /// Unit vector from the lens to the center of the disk.
    toward: [f64; 3],
    /// Tangent of the angular radius of the disk.
    radius: f64,
    /// Cosine of the angular radius of the disk.
    cos_radius: f64,
    /// Irradiance on a surface that faces the sun: W m^-2 nm^-1, and W m^-2 in spectral lines.
    irradiance: SpectralPower,
    field_deg: [f64; 2],
}

impl Disk {
    fn irradiance(&self, wavelength_nm: f64, line: u32) -> f64 {
        let power = &self.irradiance;
        if line == CONTINUUM {
            power.grid.interpolate(&power.continuum, wavelength_nm)
        } else {
            power.lines.get(line as usize).map_or(0.0, |l| l.power)
        }
    }

    /// Returns whether a ray from the lens in this direction meets the disk.
    fn is_met(&self, [l, m, n]: [f64; 3]) -> bool {
        l * self.toward[0] + m * self.toward[1] + n * self.toward[2] >= self.cos_radius
    }

    /// Returns the radiance per irradiance: the inverse of the solid angle of the disk, 1/sr.
    fn per_solid_angle(&self) -> f64 {
        1.0 / (std::f64::consts::PI * self.radius * self.radius)
    }
}

impl Source for Disk {
    fn spectrum(&self) -> &SpectralPower {
        &self.irradiance
    }
    fn distance_mm(&self) -> f64 {
        f64::INFINITY
    }
    fn emit(&self) -> Option<&dyn Emit> {
        Some(self)
    }
    fn radiance(&self) -> Option<&dyn Radiance> {
        Some(self)
    }
    fn describe(&self) -> String {
        let [right, up] = self.field_deg;
        format!("sun {right:.1} degrees to the right and {up:.1} degrees up")
    }
}

impl Emit for Disk {
    fn place(&self, rays: &mut RayBatch, u: &[f64], v: &[f64]) {
        // Two unit vectors perpendicular to the direction of the sun, the first one horizontal.
        let [l, m, n] = self.toward;
        let flat = (l * l + n * n).sqrt();
        let (right, up) = ([-n / flat, 0.0, l / flat], [-l * m / flat, flat, -m * n / flat]);
        let c = rays.columns_mut();
        for i in 0..c.x.len() {
            let (a, b) = concentric_disk(u[i], v[i]);
            let (a, b) = (self.radius * a, self.radius * b);
            let at = |k: usize| FAR_MM * (self.toward[k] + a * right[k] + b * up[k]);
            (c.x[i], c.y[i], c.z[i]) = (at(0), at(1), at(2));
            // The weight is an intensity: irradiance times the square of the distance.
            c.weight[i] *= self.irradiance(c.wavelength_nm[i], c.line[i]) * FAR_MM * FAR_MM;
        }
    }

    /// Leaves the weights unchanged, since the whole disk faces the lens.
    fn radiate(&self, _: &mut RayBatch) {}
}

impl Radiance for Disk {
    fn radiance(&self, rays: &mut RayBatch) {
        let c = rays.columns_mut();
        for i in 0..c.x.len() {
            let met = self.is_met([c.l[i], c.m[i], c.n[i]]);
            let radiance =
                if met { self.irradiance(c.wavelength_nm[i], c.line[i]) * self.per_solid_angle() } else { 0.0 };
            c.weight[i] *= radiance;
        }
    }
}

/// A sun that is added to another source.
struct Over {
    disk: Disk,
    over: Box<dyn Source>,
}

impl Source for Over {
    fn prepare(&self) -> Result<(), Faults> {
        self.over.prepare()
    }
    fn warnings(&self) -> &[Warning] {
        self.over.warnings()
    }
    fn spectrum(&self) -> &SpectralPower {
        self.over.spectrum()
    }
    fn focus_light(&self) -> &SpectralPower {
        self.over.focus_light()
    }
    fn white(&self) -> &SpectralPower {
        self.over.white()
    }
    /// Estimates the sun's radiance over the mean of the other source, as if a white card lit by the sun filled the frame.
    fn peak_over_mean(&self) -> f64 {
        self.over.peak_over_mean().max(std::f64::consts::PI * self.disk.per_solid_angle())
    }
    fn distance_mm(&self) -> f64 {
        self.over.distance_mm()
    }
    fn radiance(&self) -> Option<&dyn Radiance> {
        self.over.radiance().is_some().then_some(self as &dyn Radiance)
    }
    fn split(&self) -> Option<Split<'_>> {
        self.over.radiance().is_some().then_some(Split { lights: &self.disk, rest: &*self.over, pays: true })
    }
    fn describe(&self) -> String {
        format!("{}, over {}", self.disk.describe(), self.over.describe())
    }
}

impl Radiance for Over {
    fn radiance(&self, rays: &mut RayBatch) {
        let met = |rays: &RayBatch, i: usize| {
            let [l, m, n] = rays.directions();
            // Spectral lines belong to the other source.
            rays.states()[i] == ALIVE && rays.lines()[i] == CONTINUUM && self.disk.is_met([l[i], m[i], n[i]])
        };
        let of_sun: Vec<(usize, f64)> = (0..rays.len())
            .filter(|i| met(rays, *i))
            .map(|i| {
                let own = self.disk.irradiance(rays.wavelengths_nm()[i], CONTINUUM) * self.disk.per_solid_angle();
                (i, rays.weights()[i] * own)
            })
            .collect();
        if let Some(over) = self.over.radiance() {
            over.radiance(rays);
        }
        let c = rays.columns_mut();
        for (i, own) in of_sun {
            // The sun also shines where the other source has no light.
            let beside = if c.state[i] == ALIVE { c.weight[i] } else { 0.0 };
            c.state[i] = ALIVE;
            c.weight[i] = beside + own;
        }
    }

    fn draws(&self) -> bool {
        self.over.radiance().is_some_and(Radiance::draws)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use spectra_core::spectral::Grid;

    fn disk(right: f64, up: f64) -> Disk {
        let length = (1.0 + right * right + up * up).sqrt();
        let grid = Grid { start_nm: 350.0, step_nm: 5.0, count: 97 };
        Disk {
            toward: [right / length, up / length, -1.0 / length],
            radius: tan(0.00462),
            cos_radius: cos(0.00462),
            irradiance: SpectralPower { grid, continuum: vec![2.0; grid.count], lines: Vec::new() },
            field_deg: [0.0; 2],
        }
    }

    /// Emission and radiance describe the same disk: rays that start on the disk meet it and fill it evenly, and its radiance times its
    /// solid angle is its irradiance.
    #[test]
    fn both_ways_are_the_same_disk() {
        let disk = disk(0.4, -0.3);
        let steps = 64;
        let mut rays = RayBatch::new(steps * steps);
        rays.restart(steps * steps);
        let (u, v): (Vec<f64>, Vec<f64>) = (0..steps * steps)
            .map(|i| (((i % steps) as f64 + 0.5) / steps as f64, ((i / steps) as f64 + 0.5) / steps as f64))
            .unzip();
        rays.columns_mut().wavelength_nm.fill(550.0);
        disk.place(&mut rays, &u, &v);
        let c = rays.columns_mut();
        let mut off_axis = 0.0;
        for i in 0..c.x.len() {
            let distance = (c.x[i] * c.x[i] + c.y[i] * c.y[i] + c.z[i] * c.z[i]).sqrt();
            // The weight over the squared distance is the irradiance in W/m2.
            assert!((c.weight[i] / (distance * distance) / 2.0 - 1.0).abs() < 1e-4);
            (c.l[i], c.m[i], c.n[i]) = (c.x[i] / distance, c.y[i] / distance, c.z[i] / distance);
            let cosine = c.l[i] * disk.toward[0] + c.m[i] * disk.toward[1] + c.n[i] * disk.toward[2];
            off_axis += 2.0 * (1.0 - cosine) / steps as f64 / steps as f64;
            c.weight[i] = 1.0;
        }
        // The mean squared angle of a uniform disk is half the square of its radius.
        assert!((off_axis / (0.5 * 0.00462 * 0.00462) - 1.0).abs() < 1e-3, "{off_axis}");
        Radiance::radiance(&disk, &mut rays);
        let solid_angle = std::f64::consts::PI * 0.00462 * 0.00462;
        assert!(rays.weights().iter().all(|w| (w * solid_angle / 2.0 - 1.0).abs() < 1e-4));
        let (mut beside, up) = (RayBatch::new(1), disk.cos_radius - 1e-6);
        beside.restart(1);
        let c = beside.columns_mut();
        let [l, m, n] = disk.toward;
        let flat = (l * l + n * n).sqrt();
        let across = [-l * m / flat, flat, -m * n / flat];
        let sine = (1.0 - up * up).sqrt();
        [c.l[0], c.m[0], c.n[0]] = std::array::from_fn(|k| [l, m, n][k] * up + across[k] * sine);
        c.wavelength_nm[0] = 550.0;
        Radiance::radiance(&disk, &mut beside);
        assert_eq!(beside.weights(), [0.0]);
    }
}
