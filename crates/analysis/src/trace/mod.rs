//! Rays as CSV through a lens, and where they end as CSV.
//!
//! In: columns `x_mm, y_mm, z_mm` (a point of the ray before the first surface, frame of the lens: its
//! vertex is the origin, +z toward the image), `l, m, n` (unit direction) and `wavelength_nm`, by name
//! and in any order. Out, a row for each:
//! `status,surface,x_mm,y_mm,z_mm,l,m,n,wavelength_nm,transmittance,optical_path_mm`. A `hit` is where the ray
//! meets the image plane, in the frame of the lens, with its direction there, the part of its light that glass and coatings left, and
//! index times length from its start, with what gratings and ideal lenses add ([`spectra_core::surface::Surface::phase_mm`]); a ray that ended on the way
//! gives `missed`, `vignetted`, `tir` or `absorbed` and the number of the surface, and its other fields are
//! empty. A ray that leaves along the image plane has `missed` it: one surface more than the lens has.
//! On request there is a row `passed` before it for each surface that the ray went through, and the number of the ray before each.

mod csv;
mod row;

use crate::Light;
use csv::NumberRows;
use glam::DVec3;
use row::Light as Left;
use row::{Fate, Row};
use spectra_core::quantity::light_nm;
use spectra_core::spectral::BAND;
use spectra_core::{Isa, Loss, LossCounts, RayBatch};
use spectra_lens::{Indices, Lens, Path, Pose, Tracer, Travel, Work};
use std::io::{BufRead, Write};

pub use row::Format;

/// Why rays could not be traced.
#[derive(Debug, thiserror::Error)]
pub enum TraceError {
    /// Something is wrong in the table of rays.
    #[error("{file}:{line}:{column}: {message}")]
    Input {
        /// The file.
        file: String,
        /// Row of the file, from 1.
        line: usize,
        /// Column in characters, from 1.
        column: usize,
        /// What was found and what is expected.
        message: String,
    },
    /// The table of rays cannot be read.
    #[error("{file}: cannot be read: {cause}")]
    Read {
        /// The file.
        file: String,
        /// The system's word.
        cause: std::io::Error,
    },
    /// The result cannot be written.
    #[error("the result cannot be written: {0}")]
    Write(#[source] std::io::Error),
    /// A medium of the lens has no index in some light.
    #[error("the lens cannot be traced: {0}")]
    Lens(#[from] spectra_glass::DispersionError),
}

/// What became of the rays of a table.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TraceSummary {
    /// Rays traced.
    pub rays: u64,
    /// Rays that reached the image plane.
    pub hits: u64,
    /// The others, by cause and surface.
    pub losses: LossCounts,
    /// What a person should know: glasses used beyond their data.
    pub warnings: Vec<String>,
}

/// Rays a batch.
const BATCH: usize = 1024;
/// How far the length of a direction may be from 1; nearer ones are scaled to it.
const UNIT_TOLERANCE: f64 = 1e-6;
const COLUMNS: [&str; 7] = ["x_mm", "y_mm", "z_mm", "l", "m", "n", "wavelength_nm"];

/// How a table of rays is traced and written.
#[derive(Clone, Copy, Debug, Default)]
pub struct Tracing<'a> {
    /// The light of all rays; each has a wavelength of its own where there is none.
    pub light: Option<Light>,
    /// The path that they take; straight through where there is none.
    pub path: Option<&'a Path>,
    /// How the result is written.
    pub format: Format,
    /// Whether every surface gets a row.
    pub every_surface: bool,
}

/// Traces the rays of `input` (called `file` in messages) and writes a row for each to `output`, in the
/// order of the input. Memory does not grow with the number of rays.
///
/// # Errors
/// [`TraceError`]; rows before the faulty one are written.
pub fn trace(
    lens: &Lens,
    tracing: Tracing<'_>,
    isa: Isa,
    input: impl BufRead,
    file: &str,
    output: &mut impl Write,
) -> Result<TraceSummary, TraceError> {
    let Tracing { light, path, format, every_surface } = tracing;
    let wanted = if light.is_some() { &COLUMNS[..6] } else { &COLUMNS[..] };
    let mut rows = NumberRows::new(input, file, wanted)?;
    let mut bench = Bench::new(lens, light, path, every_surface, isa)?;
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

/// A batch of so many rays, with what is asked of each.
fn room_for(rays: usize, tracer: &Tracer) -> RayBatch {
    let batch = RayBatch::with_optical_path(rays);
    if tracer.polarizes() { batch.with_polarization() } else { batch }
}

/// A batch of rays in front of a lens.
struct Bench<'a> {
    lens: &'a Lens,
    light: Option<Light>,
    isa: Isa,
    path: Path,
    tracer: Tracer,
    work: Work,
    rays: RayBatch,
    /// Rows of the batch whose wavelength lies outside of the band that the tracer was made for.
    outside: Vec<usize>,
    /// The tracer of the last of them.
    single: Option<(f64, Tracer)>,
    start: Vec<[f64; 7]>,
    /// Whether every surface gets a row.
    every_surface: bool,
    seen_nm: Option<(f64, f64)>,
    summary: TraceSummary,
}

impl<'a> Bench<'a> {
    fn new(
        lens: &'a Lens,
        light: Option<Light>,
        path: Option<&Path>,
        every_surface: bool,
        isa: Isa,
    ) -> Result<Self, TraceError> {
        let indices = match light {
            Some(Light::Stated) => Indices::Stated,
            Some(Light::Wavelength(nm)) => Indices::At(nm),
            None => Indices::Band { min_nm: BAND.start_nm, max_nm: BAND.end_nm() },
        };
        let tracer = Tracer::new(lens, indices, isa)?;
        Ok(Self {
            lens,
            light,
            isa,
            path: path.cloned().unwrap_or_else(|| Path::through(tracer.surfaces(), Travel::Forward)),
            work: tracer.work_in_place(BATCH),
            rays: room_for(BATCH, &tracer),
            tracer,
            every_surface,
            outside: Vec::new(),
            single: None,
            start: Vec::with_capacity(BATCH),
            seen_nm: light.and_then(Light::wavelength_nm).map(|nm| (nm, nm)),
            summary: TraceSummary::default(),
        })
    }

    /// How far a point lies behind the first surface and its vertex, within its rim.
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

    /// Reads a batch; false where the table ended.
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
            // False too for a length that overflowed.
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
                        "the ray begins {mm:.3} mm behind the first surface, expected a point of it in front of the lens, where z_mm is \
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

    /// Traces the batch.
    fn trace(&mut self) -> Result<Vec<Row>, TraceError> {
        let len = self.start.len();
        self.rays.restart(len);
        // What an index that is held is held for, coatings and glass pass at.
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
        let is_stated = self.light == Some(Light::Stated);
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
                rows.push(Row { ray, wavelength_nm, fate });
            }
        }
        Ok(rows)
    }

    /// One ray at the formulas' own indices for its wavelength.
    fn trace_outside(&mut self, ray: [f64; 7]) -> Result<Vec<Fate>, TraceError> {
        let nm = ray[6];
        let tracer = match self.single.take() {
            Some((made_for, tracer)) if made_for == nm => tracer,
            _ => Tracer::new(self.lens, Indices::At(nm), self.isa)?,
        };
        let mut rays = room_for(1, &tracer);
        rays.restart(1);
        let c = rays.columns_mut();
        [c.x[0], c.y[0], c.z[0], c.l[0], c.m[0], c.n[0], c.wavelength_nm[0]] = ray;
        let followed = Followed { lens: self.lens, path: &self.path, wavelengths: &[nm], is_stated: false };
        let mut fates = followed.fates(&tracer, &mut rays, &mut tracer.work_in_place(1), self.every_surface);
        self.single = Some((nm, tracer));
        Ok(fates.swap_remove(0))
    }

    fn summary(mut self) -> TraceSummary {
        if let Some((low, high)) = self.seen_nm {
            for medium in &self.lens.media {
                if let (false, Some((from, to))) = (medium.medium.covers(low, high), medium.medium.range_nm()) {
                    let message =
                        format!("{} is measured from {from} to {to} nm; rays beyond went by its formula", medium.label);
                    if !self.summary.warnings.contains(&message) {
                        self.summary.warnings.push(message);
                    }
                }
            }
        }
        self.summary
    }
}

/// A batch on its way.
struct Followed<'a> {
    lens: &'a Lens,
    path: &'a Path,
    /// Of each ray, nm.
    wavelengths: &'a [f64],
    /// Whether every medium has the index that the prescription states.
    is_stated: bool,
}

impl Followed<'_> {
    /// What became of each ray: where it ended, last, and before it each surface that it passed, where that is asked for.
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

    /// What became of ray `i`, which left the tracer in the frame of the image plane.
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

/// What is left of ray `i`, whose place is given in the frame of `pose`; carried on by a distance, mm, in a medium of some index.
fn left_of(rays: &RayBatch, i: usize, pose: &Pose, on: Option<(f64, f64)>) -> Left {
    let [x, y, z] = rays.positions().map(|column| column[i]);
    let [l, m, n] = rays.directions().map(|column| column[i]);
    let path = rays.optical_path_mm().map_or(f64::NAN, |column| column[i]);
    let (point, more) = match on {
        None => (DVec3::new(x, y, z), 0.0),
        // On the plane itself.
        Some((distance, index)) => (DVec3::new(x + distance * l, y + distance * m, 0.0), distance * index),
    };
    Left {
        point_mm: pose.point(point).into(),
        direction: pose.direction(DVec3::new(l, m, n)).into(),
        transmittance: rays.weights()[i],
        optical_path_mm: path + more,
    }
}
