//! Traces rays given as CSV through a lens and writes where they end as CSV.
//!
//! Input columns, found by name and in any order: `x_mm, y_mm, z_mm` (a point of the ray in front of the first surface, in the frame of the
//! lens: origin at its vertex, +z toward the image), `l, m, n` (unit direction) and `wavelength_nm`.
//!
//! Output, one row for each ray: `status,surface,x_mm,y_mm,z_mm,l,m,n,wavelength_nm,transmittance,optical_path_mm`.
//! A `hit` gives the point where the ray meets the image plane and its direction there, both in the frame of the lens. `transmittance` is
//! the part of the light that glass and coatings leave. `optical_path_mm` is index times length from the start of the ray, plus what
//! gratings and ideal lenses add ([`spectra_core::surface::Surface::phase_mm`]).
//! A ray that ends on the way gives `missed`, `vignetted`, `tir` or `absorbed` and the number of the surface; its other fields are empty. A
//! ray that leaves parallel to the image plane has `missed` it: its surface number is one more than the lens has surfaces.
//! On request a row `passed` for each surface that the ray went through comes before the last row, and every row begins with the number of
//! the ray.

mod csv;
mod trace_row;

use crate::AnalysisLight;
use csv::NumberRows;
use glam::DVec3;
use spectra_core::quantity::light_nm;
use spectra_core::spectral::BAND;
use spectra_core::{Loss, LossCounts, RayBatch};
use spectra_lens::Pose;
use spectra_optics::Optics;
use spectra_tracer::{Indices, Path, Tracer, Travel, Work};
use std::io::{BufRead, Write};
use std::sync::Arc;
use trace_row::RayState as Left;
use trace_row::{Fate, TraceRow};

pub use trace_row::Format;

/// Why rays could not be traced.
#[derive(Debug, thiserror::Error)]
pub enum TraceError {
    /// The table of rays is faulty.
    #[error("{file}:{line}:{column}: {message}")]
    Input {
        /// Name of the file.
        file: String,
        /// Line of the file, from 1.
        line: usize,
        /// Column in characters, from 1.
        column: usize,
        /// Message: what was found and what was expected.
        message: String,
    },
    /// The table of rays cannot be read.
    #[error("{file}: cannot be read: {cause}")]
    Read {
        /// Name of the file.
        file: String,
        /// The error of the operating system.
        cause: std::io::Error,
    },
    /// The result cannot be written.
    #[error("the result cannot be written: {0}")]
    Write(#[source] std::io::Error),
    /// A medium of the lens has no index at some wavelength.
    #[error("the lens cannot be traced: {0}")]
    Lens(#[from] spectra_glass::DispersionError),
}

/// Summary of the traced rays of a table.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TraceSummary {
    /// Number of rays traced.
    pub rays: u64,
    /// Number of rays that reached the image plane.
    pub hits: u64,
    /// Number of other rays, by cause and surface.
    pub losses: LossCounts,
    /// Warnings for the user: glasses used outside the range of their data.
    pub warnings: Vec<String>,
}

/// Number of rays in a batch.
const BATCH: usize = 1024;
/// Largest deviation of the length of a direction from 1. Directions within it are scaled to unit length.
const UNIT_TOLERANCE: f64 = 1e-6;
const COLUMNS: [&str; 7] = ["x_mm", "y_mm", "z_mm", "l", "m", "n", "wavelength_nm"];

/// Settings for tracing a table of rays and writing the result.
#[derive(Clone, Copy, Debug, Default)]
pub struct Tracing<'a> {
    /// Light of all rays; if `None`, each ray has its own wavelength in the table.
    pub light: Option<AnalysisLight>,
    /// Path that all rays follow; straight through the lens if `None`.
    pub path: Option<&'a Path>,
    /// Format of the result.
    pub format: Format,
    /// Whether each surface that a ray passes gets a row.
    pub every_surface: bool,
}

/// Traces the rays of `input` (called `file` in messages) through a lens and writes one row for each to `output`, in the order of the
/// input. With `every_surface` a ray has one row more for each surface it passes. Memory use does not depend on the number of rays.
///
/// # Errors
/// [`TraceError`]; rows before the faulty one are written.
pub fn trace(
    lens: &Optics,
    tracing: Tracing<'_>,
    input: impl BufRead,
    file: &str,
    output: &mut impl Write,
) -> Result<TraceSummary, TraceError> {
    let Tracing { light, path, format, every_surface } = tracing;
    let wanted = if light.is_some() { &COLUMNS[..6] } else { &COLUMNS[..] };
    let mut rows = NumberRows::new(input, file, wanted)?;
    let mut bench = BatchTracer::new(lens, light, path, every_surface)?;
    let mut text = format.header(every_surface);
    let mut more = true;
    while more {
        more = bench.fill(&mut rows)?;
        for row in bench.trace()? {
            row.write(format, &mut text);
        }
        output.write_all(text.as_bytes()).map_err(TraceError::Write)?;
        text.clear();
    }
    output.flush().map_err(TraceError::Write)?;
    Ok(bench.summary())
}

/// Creates an empty batch of `rays` rays with optical path, and with polarization if the lens polarizes.
fn room_for(rays: usize, tracer: &Tracer) -> RayBatch {
    let batch = RayBatch::with_optical_path(rays);
    if tracer.polarizes() { batch.with_polarization() } else { batch }
}

/// State of tracing a table batch by batch.
struct BatchTracer<'a> {
    lens: &'a Optics,
    light: Option<AnalysisLight>,
    path: Path,
    tracer: Arc<Tracer>,
    work: Work,
    rays: RayBatch,
    /// Indices in the batch of rays whose wavelength lies outside the band of the tracer.
    outside: Vec<usize>,
    start: Vec<[f64; 7]>,
    /// Whether each surface gets a row.
    every_surface: bool,
    seen_nm: Option<(f64, f64)>,
    summary: TraceSummary,
}

impl<'a> BatchTracer<'a> {
    fn new(
        lens: &'a Optics,
        light: Option<AnalysisLight>,
        path: Option<&Path>,
        every_surface: bool,
    ) -> Result<Self, TraceError> {
        let indices = match light {
            Some(AnalysisLight::Stated) => Indices::Stated,
            Some(AnalysisLight::Wavelength(nm)) => Indices::At(nm),
            None => Indices::Band { min_nm: BAND.start_nm, max_nm: BAND.end_nm() },
        };
        let tracer = lens.tracer(indices)?;
        Ok(Self {
            lens,
            light,
            path: path.cloned().unwrap_or_else(|| Path::through(tracer.surfaces(), Travel::Forward)),
            work: tracer.work_in_place(BATCH),
            rays: room_for(BATCH, &tracer),
            tracer,
            every_surface,
            outside: Vec::new(),
            start: Vec::with_capacity(BATCH),
            seen_nm: light.and_then(AnalysisLight::wavelength_nm).map(|nm| (nm, nm)),
            summary: TraceSummary::default(),
        })
    }

    /// Returns how far a point lies behind the first surface and its vertex, in mm. `None` unless the point lies within the rim
    /// and more than 1e-6 mm behind them, and for a first surface off the axis.
    fn behind_front_mm(&self, [x, y, z]: [f64; 3]) -> Option<f64> {
        let first = self.lens.elements.first()?;
        let pose = if first.reversed { first.pose.reversed() } else { first.pose };
        let rim = first.semi_diameter_mm.unwrap_or(f64::INFINITY);
        if !pose.is_on_axis() || x * x + y * y > rim * rim {
            return None;
        }
        let sag = first.surface.sag_mm(x, y)?;
        let front = first.vertex_z_mm() + if first.reversed { -sag } else { sag }.max(0.0);
        Some(z - front).filter(|mm| *mm > 1e-6)
    }

    /// Reads a batch of rays and checks them; returns false if the table has ended.
    fn fill(&mut self, rows: &mut NumberRows<impl BufRead>) -> Result<bool, TraceError> {
        self.start.clear();
        self.outside.clear();
        let mut more = true;
        while more && self.start.len() < BATCH {
            let mut ray = [0.0; 7];
            let wanted = if self.light.is_some() { 6 } else { 7 };
            more = rows.next_row(&mut ray[..wanted])?;
            if !more {
                break;
            }
            let [.., l, m, n, nm] = ray;
            let length = (l * l + m * m + n * n).sqrt();
            // This is false also if the length overflowed.
            let is_unit = (length - 1.0).abs() <= UNIT_TOLERANCE;
            if !is_unit {
                return Err(rows.fault_at(
                    "l",
                    &format!("the direction (l, m, n) has the length {length}, expected a unit vector"),
                ));
            }
            for cosine in &mut ray[3..6] {
                *cosine /= length;
            }
            if let Some(mm) = self.behind_front_mm([ray[0], ray[1], ray[2]]) {
                return Err(rows.fault_at(
                    "z_mm",
                    &format!(
                        "the ray begins {mm:.3} mm behind the first surface, expected a point in front of the lens, where z_mm is \
                         0 or negative"
                    ),
                ));
            }
            if self.light.is_none() {
                self.check_wavelength(nm).map_err(|message| rows.fault_at("wavelength_nm", &message))?;
            }
            self.start.push(ray);
        }
        Ok(more)
    }

    fn check_wavelength(&mut self, nm: f64) -> Result<(), String> {
        if nm <= 0.0 {
            return Err(format!("column `wavelength_nm`: found {nm}, expected a positive number"));
        }
        light_nm(nm).map_err(|wrong| format!("column `wavelength_nm`: {wrong}; {}", wrong.hint()))?;
        let (low, high) = self.seen_nm.unwrap_or((nm, nm));
        self.seen_nm = Some((low.min(nm), high.max(nm)));
        if !BAND.contains(nm) {
            let none = |n: f64| !(n.is_finite() && n > 0.0);
            if let Some(medium) = self.lens.media.iter().find(|medium| none(medium.medium.index(nm))) {
                return Err(format!("{} has no refractive index at {nm} nm", medium.label));
            }
            self.outside.push(self.start.len());
        }
        Ok(())
    }

    /// Traces the batch and returns the rows to write.
    fn trace(&mut self) -> Result<Vec<TraceRow>, TraceError> {
        let len = self.start.len();
        self.rays.restart(len);
        // Fixed indices belong to one wavelength; coatings and absorption use the same wavelength.
        let held = self.light.map(|light| light.wavelength_nm().unwrap_or(self.lens.reference_nm));
        let c = self.rays.columns_mut();
        for (i, ray) in self.start.iter_mut().enumerate() {
            ray[6] = held.unwrap_or(ray[6]);
            [c.x[i], c.y[i], c.z[i], c.l[i], c.m[i], c.n[i], c.wavelength_nm[i]] = *ray;
            if held.is_none() && !BAND.contains(c.wavelength_nm[i]) {
                c.wavelength_nm[i] = self.lens.reference_nm;
            }
        }
        let wavelengths: Vec<f64> = self.start.iter().map(|ray| ray[6]).collect();
        let is_stated = self.light == Some(AnalysisLight::Stated);
        let followed = Followed { lens: self.lens, path: &self.path, wavelengths: &wavelengths, is_stated };
        let mut fates = followed.fates(&self.tracer, &mut self.rays, &mut self.work, self.every_surface);
        for at in std::mem::take(&mut self.outside) {
            fates[at] = self.trace_outside(self.start[at])?;
        }
        let first = self.summary.rays + 1;
        self.summary.rays += len as u64;
        let mut rows = Vec::with_capacity(len);
        for (i, of_ray) in fates.into_iter().enumerate() {
            let (ray, wavelength_nm) = (self.every_surface.then_some(first + i as u64), wavelengths[i]);
            for fate in of_ray {
                match fate {
                    Fate::Hit(_) => self.summary.hits += 1,
                    Fate::Lost { cause, surface } => self.summary.losses.add(cause, surface, 1),
                    Fate::Passed { .. } => {}
                }
                rows.push(TraceRow { ray, wavelength_nm, fate });
            }
        }
        Ok(rows)
    }

    /// Traces one ray whose wavelength is outside the band, with the indices that the formulas give at that wavelength.
    fn trace_outside(&mut self, ray: [f64; 7]) -> Result<Vec<Fate>, TraceError> {
        let nm = ray[6];
        let tracer = self.lens.tracer(Indices::At(nm))?;
        let mut rays = room_for(1, &tracer);
        rays.restart(1);
        let c = rays.columns_mut();
        [c.x[0], c.y[0], c.z[0], c.l[0], c.m[0], c.n[0], c.wavelength_nm[0]] = ray;
        let followed = Followed { lens: self.lens, path: &self.path, wavelengths: &[nm], is_stated: false };
        let mut fates = followed.fates(&tracer, &mut rays, &mut tracer.work_in_place(1), self.every_surface);
        Ok(fates.swap_remove(0))
    }

    fn summary(mut self) -> TraceSummary {
        if let Some((low, high)) = self.seen_nm {
            for medium in &self.lens.media {
                if let (false, Some((from, to))) = (medium.medium.covers(low, high), medium.medium.range_nm()) {
                    let message =
                        format!("{} is measured from {from} to {to} nm; rays outside used its formula", medium.label);
                    if !self.summary.warnings.contains(&message) {
                        self.summary.warnings.push(message);
                    }
                }
            }
        }
        self.summary
    }
}

/// Context for tracing a batch of rays along a path.
struct Followed<'a> {
    lens: &'a Optics,
    path: &'a Path,
    /// Wavelength of each ray, nm.
    wavelengths: &'a [f64],
    /// Whether every medium has the index stated in the prescription.
    is_stated: bool,
}

impl Followed<'_> {
    /// Traces the rays and returns what became of each: its end as the last entry and, with `every_surface`, each surface that it passed
    /// before.
    fn fates(&self, tracer: &Tracer, rays: &mut RayBatch, work: &mut Work, every_surface: bool) -> Vec<Vec<Fate>> {
        let mut fates: Vec<Vec<Fate>> = vec![Vec::new(); rays.len()];
        tracer.follow_each(&tracer.route(self.path), rays, work, |at, rays| {
            if !every_surface {
                return;
            }
            let pose = &self.lens.elements[at].pose;
            for (i, fates) in fates.iter_mut().enumerate().filter(|(i, _)| rays.loss(*i).is_none()) {
                fates.push(Fate::Passed { surface: at as u32 + 1, light: left_of(rays, i, pose, None) });
            }
        });
        let surfaces = tracer.surfaces() as u32;
        for (i, fates) in fates.iter_mut().enumerate() {
            fates.push(self.end_of(rays, i, surfaces));
        }
        fates
    }

    /// Returns the end of ray `i`, which left the tracer in the frame of the image plane.
    fn end_of(&self, rays: &RayBatch, i: usize, surfaces: u32) -> Fate {
        if let Some((cause, surface)) = rays.loss(i) {
            return Fate::Lost { cause, surface };
        }
        let z = rays.positions()[2][i];
        let n = rays.directions()[2][i];
        let distance_mm = -z / n;
        let behind = self.path.steps().last().map_or(0, |step| self.lens.elements[step.element].medium_after);
        let medium = &self.lens.media[behind];
        let index = medium.stated_nd.filter(|_| self.is_stated);
        let index = index.unwrap_or_else(|| medium.medium.index(self.wavelengths[i]));
        let light = left_of(rays, i, &self.lens.image_pose, Some((distance_mm, index)));
        if light.point_mm.iter().all(|v| v.is_finite()) {
            Fate::Hit(light)
        } else {
            Fate::Lost { cause: Loss::Missed, surface: surfaces + 1 }
        }
    }
}

/// Returns the state of ray `i`, whose position is in the frame of `pose`. `on` holds the distance (mm) to the plane z = 0 and
/// the index of the medium; if given, the ray is moved to that plane.
fn left_of(rays: &RayBatch, i: usize, pose: &Pose, on: Option<(f64, f64)>) -> Left {
    let [x, y, z] = rays.positions().map(|column| column[i]);
    let [l, m, n] = rays.directions().map(|column| column[i]);
    let path = rays.optical_path_mm().map_or(f64::NAN, |column| column[i]);
    let (point, more) = match on {
        None => (DVec3::new(x, y, z), 0.0),
        // Set z to exactly 0: the point is on the plane.
        Some((distance, index)) => (DVec3::new(x + distance * l, y + distance * m, 0.0), distance * index),
    };
    Left {
        point_mm: pose.point(point).into(),
        direction: pose.direction(DVec3::new(l, m, n)).into(),
        transmittance: rays.weights()[i],
        optical_path_mm: path + more,
    }
}
