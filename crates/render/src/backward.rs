//! Backward: each pixel asks, through the rear of the lens, what light arrives.

use crate::error::RenderError;
use crate::pipeline::{Pipeline, ThreadState};
use crate::sums::ExactSums;
use spectra_core::RayBatch;
use spectra_core::isa::Vectorized;
use spectra_core::numbers::Numbers;
use spectra_core::stage::{Launch, Radiance};
use spectra_lens::{RearPupil, Travel};

/// Pixels of a unit of work.
pub(crate) const PIXELS_PER_UNIT: u32 = 64;
/// Samples of each pixel in a unit of work.
pub(crate) const SAMPLES_PER_PASS: u32 = 32;

pub(crate) struct Backward<'a> {
    pub pipeline: Pipeline<'a>,
    launch: &'a dyn Launch,
    radiance: &'a dyn Radiance,
    rear: RearPupil,
    numbers: Numbers,
}

impl<'a> Backward<'a> {
    pub(crate) fn new(pipeline: Pipeline<'a>, seed: u64) -> Result<Self, RenderError> {
        let scene = pipeline.scene;
        let size = scene.imager.size();
        let film_radius_mm = 0.5 * (size.width_mm * size.width_mm + size.height_mm * size.height_mm).sqrt();
        let grid = scene.grid;
        let rear = RearPupil::search(&scene.lens, &pipeline.tracer, film_radius_mm, grid.start_nm, grid.end_nm());
        Ok(Self {
            launch: scene.imager.launch().ok_or(RenderError::CannotLaunch)?,
            radiance: scene.source.radiance().ok_or(RenderError::NoRadiance)?,
            rear: rear.ok_or(RenderError::NoAperture)?,
            numbers: pipeline.numbers(seed),
            pipeline,
        })
    }

    /// Traces `count` samples, from `first` on, of each of `pixels`: pixel after pixel. Afterwards
    /// the weights are irradiance, and 0 for rays that ended.
    pub(crate) fn batch(
        &self,
        state: &mut ThreadState,
        pixels: impl Iterator<Item = u32> + Clone,
        first: u32,
        count: usize,
    ) {
        let isa = self.pipeline.isa;
        let mut len = 0;
        for pixel in pixels.clone() {
            for (dimension, column) in state.numbers.iter_mut().enumerate() {
                let out = &mut column.slice_mut(len + count)[len..];
                let (group, pixel, first) = (self.pipeline.group(dimension), u64::from(pixel), u64::from(first));
                self.numbers.fill_rotated(isa, pixel, first, group, dimension as u32, out);
            }
            len += count;
        }
        state.draw_wavelengths(&self.pipeline, len);
        let c = state.rays.columns_mut();
        for (chunk, pixel) in c.tag.chunks_mut(count).zip(pixels) {
            chunk.fill(pixel);
        }
        let [_, u, v, a, b] = &state.numbers;
        self.launch.place(&mut state.rays, u.slice(len), v.slice(len), isa);
        isa.run(AimRear { rear: &self.rear, u: a.slice(len), v: b.slice(len), rays: &mut state.rays });
        self.pipeline.tracer.trace(&mut state.rays, &mut state.work, Travel::Backward);
        self.radiance.radiance(&mut state.rays, isa);
        state.silence_ended(isa);
    }

    /// Adds samples `first .. first + samples` of pixels `begin .. end` to the sums.
    pub(crate) fn unit(
        &self,
        state: &mut ThreadState,
        begin: u32,
        end: u32,
        first: u32,
        samples: u32,
        scale: f64,
        sums: &ExactSums,
    ) {
        let channels = state.integers.len();
        let mut local = vec![0_i64; (end - begin) as usize * channels];
        let capacity = state.rays.capacity() as u32;
        // As many whole pixels as the batch holds; where it holds not even one, parts of a pixel.
        let part = samples.min(capacity);
        let whole = (capacity / part).max(1);
        let mut pixel = begin;
        while pixel < end {
            let upto = (pixel + whole).min(end);
            let mut sample = first;
            while sample < first + samples {
                let count = part.min(first + samples - sample);
                self.batch(state, pixel..upto, sample, count as usize);
                if !state.contributions(&self.pipeline, scale) {
                    sums.mark_overflow();
                }
                for (i, tag) in state.rays.tags().iter().enumerate() {
                    let cell = (*tag - begin) as usize * channels;
                    for (channel, integers) in state.integers.iter().enumerate() {
                        local[cell + channel] += integers[i];
                    }
                }
                sample += count;
            }
            pixel = upto;
        }
        let base = begin as usize * channels;
        for (i, value) in local.iter().enumerate() {
            sums.add(base + i, *value);
        }
    }
}

/// Turns rays from the film toward the rear of the lens, and starts them on its plane.
struct AimRear<'a> {
    rear: &'a RearPupil,
    u: &'a [f64],
    v: &'a [f64],
    rays: &'a mut RayBatch,
}

impl Vectorized for AimRear<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let c = self.rays.columns_mut();
        let len = c.x.len();
        let (u, v) = (&self.u[..len], &self.v[..len]);
        for i in 0..len {
            let (x, y, z) = (c.x[i], c.y[i], c.z[i]);
            let radius = (x * x + y * y).sqrt();
            let r = self.rear.rectangle(radius);
            // Unit vector along the radius; any will do on the axis.
            let (ex, ey) = if radius > 0.0 { (x / radius, y / radius) } else { (0.0, 1.0) };
            let along = r.along_min_mm + u[i] * (r.along_max_mm - r.along_min_mm);
            let across = (2.0 * v[i] - 1.0) * r.across_mm;
            let (tx, ty, tz) = (along * ex - across * ey, along * ey + across * ex, self.rear.z_mm);
            let (dx, dy, dz) = (tx - x, ty - y, tz - z);
            let inverse = 1.0 / (dx * dx + dy * dy + dz * dz).sqrt();
            let (l, m, n) = (dx * inverse, dy * inverse, dz * inverse);
            let area = (r.along_max_mm - r.along_min_mm) * 2.0 * r.across_mm;
            // The imager's normal stands in the place of the direction.
            let cosine = (l * c.l[i] + m * c.m[i] + n * c.n[i]).max(0.0);
            c.weight[i] *= area * n.abs() * cosine * inverse * inverse;
            (c.x[i], c.y[i], c.z[i]) = (tx, ty, tz);
            (c.l[i], c.m[i], c.n[i]) = (l, m, n);
        }
    }
}
