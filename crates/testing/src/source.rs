//! The laws that every source must obey.

use crate::test_numbers::{TestNumbers, mean_and_error};
use glam::DVec3;
use spectra_core::batch::CONTINUUM;
use spectra_core::math::concentric_disk;
use spectra_core::spectral::BAND;
use spectra_core::stage::{Emit, Radiance, Source};
use spectra_core::{Isa, RayBatch};
use std::f64::consts::PI;

/// The laws of sources, with the facts about a source that are needed to check them.
///
/// - Its spectrum is finite, not negative and not dark; its distance is positive; its peak is not below its mean.
/// - Weights are finite and not negative, and positions and directions are finite.
/// - If it both emits rays and returns radiance, the same flux passes an aperture either way, within 5 standard errors.
/// - The result does not depend on how rays are split into batches, nor on the instruction set.
#[derive(Clone, Copy, Debug)]
pub struct SourceLaws {
    /// Radius of a disk across the axis, at the source's distance, that contains the whole source, mm.
    pub extent_mm: f64,
    /// Radius of the aperture through which flux is measured, mm.
    pub aperture_mm: f64,
    /// Number of rays that are tried.
    pub rays: usize,
}

impl Default for SourceLaws {
    /// Returns the laws of a source within 1 m of the axis, with an aperture of 10 mm radius.
    fn default() -> Self {
        Self { extent_mm: 1000.0, aperture_mm: 10.0, rays: 1 << 16 }
    }
}

/// Size of batches and instruction set for a run.
#[derive(Clone, Copy)]
struct How {
    batch: usize,
    isa: Isa,
}

const PLAIN: How = How { batch: 256, isa: Isa::Baseline };

impl SourceLaws {
    /// Checks all laws on a source.
    ///
    /// # Panics
    /// At the first case that breaks a law; the message describes it.
    pub fn hold(&self, source: &dyn Source) {
        source.prepare().unwrap_or_else(|faults| panic!("it cannot be prepared: {faults}"));
        let spectrum = source.spectrum();
        assert_eq!(spectrum.continuum.len(), spectrum.grid.count, "the spectrum has not one value per grid point");
        for (power, nm) in spectrum.continuum.iter().zip(spectrum.grid.wavelengths_nm()) {
            assert!(*power >= 0.0 && power.is_finite(), "the spectrum is {power} at {nm} nm");
        }
        for line in &spectrum.lines {
            assert!(
                line.power >= 0.0 && line.power.is_finite(),
                "the line at {} nm has {}",
                line.wavelength_nm,
                line.power
            );
        }
        assert!(!spectrum.is_dark(), "the source is dark");
        assert!(source.distance_mm() > 0.0, "its distance is {} mm", source.distance_mm());
        assert!(source.peak_over_mean() >= 1.0 - 1e-9, "its peak is {} of its mean", source.peak_over_mean());
        assert!(!source.describe().trim().is_empty(), "`describe` says nothing");
        assert!(source.emit().is_some() || source.radiance().is_some(), "it neither emits nor returns radiance");
        // The continuum, and each line separately.
        let lines = std::iter::once(None).chain((0..spectrum.lines.len().min(4)).map(Some));
        for line in lines {
            if line.is_none() && spectrum.continuum.iter().all(|p| *p == 0.0) {
                continue;
            }
            if line.is_some_and(|l| !BAND.contains(spectrum.lines[l].wavelength_nm)) {
                continue;
            }
            let forward = source.emit().map(|emit| self.forward(source, emit, line));
            let backward = source.radiance().map(|radiance| self.backward(source, radiance, line));
            let directed = source.emit().is_some_and(Emit::is_directed);
            if let (Some(forward), Some(backward), false) = (forward, backward, directed) {
                let ((a, da), (b, db)) = (mean_and_error(&forward), mean_and_error(&backward));
                let error = (da * da + db * db).sqrt();
                assert!(
                    (a - b).abs() < 5.0 * error + 1e-9 * (a + b),
                    "{}: through the aperture it emits {a:.6e} +- {da:.1e}, but its radiance is {b:.6e} +- {db:.1e}: {:.1} \
                     standard errors apart{}",
                    what(line),
                    (a - b).abs() / error,
                    if b < a { "; is all of it within `extent_mm`?" } else { "" }
                );
            }
        }
    }

    /// Returns the flux of each ray that the source emits through the aperture.
    fn forward(&self, source: &dyn Source, emit: &dyn Emit, line: Option<usize>) -> Vec<f64> {
        let want = self.emitted(source, emit, line, PLAIN);
        for (how, name) in others() {
            assert!(self.emitted(source, emit, line, how) == want, "{}: it emits different rays {name}", what(line));
        }
        want
    }

    fn emitted(&self, source: &dyn Source, emit: &dyn Emit, line: Option<usize>, how: How) -> Vec<f64> {
        let spread = TestNumbers::new(41);
        let columns: Vec<Vec<f64>> = (0..5).map(|d| spread.column(self.rays, d)).collect();
        let area_mm2 = PI * self.aperture_mm * self.aperture_mm;
        let mut flux = Vec::with_capacity(self.rays);
        for first in (0..self.rays).step_by(how.batch) {
            let part = first..(first + how.batch).min(self.rays);
            let mut rays = start(source, line, &columns[4][part.clone()], how.isa);
            emit.place(&mut rays, &columns[0][part.clone()], &columns[1][part.clone()]);
            let mut factor = vec![1.0; rays.len()];
            if !emit.is_directed() {
                let c = rays.columns_mut();
                for (i, ray) in part.clone().enumerate() {
                    let from = DVec3::new(c.x[i], c.y[i], c.z[i]);
                    let toward = self.aperture(columns[2][ray], columns[3][ray]) - from;
                    let direction = toward.normalize();
                    (c.l[i], c.m[i], c.n[i]) = direction.into();
                    factor[i] = area_mm2 * direction.z.abs() / toward.length_squared();
                }
            }
            emit.radiate(&mut rays);
            check(&rays, line);
            let alive = |i: usize| if rays.loss(i).is_none() { rays.weights()[i] } else { 0.0 };
            flux.extend((0..rays.len()).map(|i| alive(i) * factor[i]));
        }
        flux
    }

    /// Returns the flux that arrives along each ray from the aperture toward the source.
    fn backward(&self, source: &dyn Source, radiance: &dyn Radiance, line: Option<usize>) -> Vec<f64> {
        let want = self.answered(source, radiance, line, PLAIN);
        for (how, name) in others() {
            assert!(self.answered(source, radiance, line, how) == want, "{}: radiance differs {name}", what(line));
        }
        want
    }

    fn answered(&self, source: &dyn Source, radiance: &dyn Radiance, line: Option<usize>, how: How) -> Vec<f64> {
        let spread = TestNumbers::new(42);
        let columns: Vec<Vec<f64>> = (0..5).map(|d| spread.column(self.rays, d)).collect();
        let distance_mm = source.distance_mm().min(1e9);
        let areas = PI * self.aperture_mm * self.aperture_mm * PI * self.extent_mm * self.extent_mm;
        let mut flux = Vec::with_capacity(self.rays);
        for first in (0..self.rays).step_by(how.batch) {
            let part = first..(first + how.batch).min(self.rays);
            let mut rays = start(source, line, &columns[4][part.clone()], how.isa);
            let c = rays.columns_mut();
            for (i, ray) in part.enumerate() {
                let from = self.aperture(columns[2][ray], columns[3][ray]);
                let (x, y) = concentric_disk(columns[0][ray], columns[1][ray]);
                let toward = DVec3::new(self.extent_mm * x, self.extent_mm * y, -distance_mm) - from;
                let direction = toward.normalize();
                (c.x[i], c.y[i], c.z[i]) = from.into();
                (c.l[i], c.m[i], c.n[i]) = direction.into();
                c.weight[i] = areas * direction.z * direction.z / toward.length_squared();
            }
            radiance.radiance(&mut rays);
            check(&rays, line);
            flux.extend((0..rays.len()).map(|i| if rays.loss(i).is_none() { rays.weights()[i] } else { 0.0 }));
        }
        flux
    }

    /// Returns a point in the aperture, mm.
    fn aperture(&self, u: f64, v: f64) -> DVec3 {
        let (x, y) = concentric_disk(u, v);
        self.aperture_mm * DVec3::new(x, y, 0.0)
    }
}

/// Starts rays with the wavelength of one line, or with wavelengths from the whole band.
fn start(source: &dyn Source, line: Option<usize>, u: &[f64], isa: Isa) -> RayBatch {
    let mut rays = RayBatch::new(u.len()).on(isa);
    rays.restart(u.len());
    let c = rays.columns_mut();
    for (i, u) in u.iter().enumerate() {
        match line {
            Some(line) => (c.line[i], c.wavelength_nm[i]) = (line as u32, source.spectrum().lines[line].wavelength_nm),
            None => (c.line[i], c.wavelength_nm[i]) = (CONTINUUM, BAND.start_nm + u * (BAND.end_nm() - BAND.start_nm)),
        }
        (c.x[i], c.y[i], c.z[i], c.l[i], c.m[i], c.n[i]) = (0.0, 0.0, 0.0, 0.0, 0.0, 1.0);
    }
    rays
}

fn check(rays: &RayBatch, line: Option<usize>) {
    for i in (0..rays.len()).filter(|i| rays.loss(*i).is_none()) {
        let weight = rays.weights()[i];
        let nm = rays.wavelengths_nm()[i];
        assert!(weight >= 0.0 && weight.is_finite(), "{}: a ray of {nm} nm weighs {weight}", what(line));
        let finite = rays.positions().iter().chain(&rays.directions()).all(|column| column[i].is_finite());
        assert!(finite, "{}: a ray of {nm} nm has a position or direction that is not finite", what(line));
    }
}

fn what(line: Option<usize>) -> String {
    line.map_or_else(|| "the continuum".to_owned(), |line| format!("line {line}"))
}

/// Returns other batch sizes and instruction sets, which must give the same result, each with its words for a message.
fn others() -> Vec<(How, String)> {
    let batches = [1, 100, 1024].map(|batch| (How { batch, ..PLAIN }, format!("in batches of {batch}")));
    let tiers = Isa::available().into_iter().map(|isa| (How { isa, ..PLAIN }, format!("on {}", isa.name())));
    batches.into_iter().chain(tiers).collect()
}
