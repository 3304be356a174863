//! Forward: paths from the source, splatted where they land.

use crate::error::RenderError;
use crate::pipeline::{Pipeline, ThreadState};
use crate::sums::ExactSums;
use spectra_core::isa::Vectorized;
use spectra_core::math::{concentric_disk, polar_disk};
use spectra_core::numbers::{Dimension, Numbers};
use spectra_core::stage::{Emit, Receive};
use spectra_lens::{FrontDisk, Travel};
use spectra_scene::ConePattern;

/// Paths a unit of work: some milliseconds.
pub(crate) const PATHS_PER_UNIT: u64 = 1 << 16;
/// All forward paths form one stream of numbers.
const STREAM: u64 = 0;

pub(crate) struct Forward<'a> {
    pub pipeline: Pipeline<'a>,
    emit: &'a dyn Emit,
    receive: &'a dyn Receive,
    front: FrontDisk,
    numbers: Numbers,
    cone: Numbers,
}

impl<'a> Forward<'a> {
    pub(crate) fn new(pipeline: Pipeline<'a>, seed: u64) -> Result<Self, RenderError> {
        let scene = pipeline.scene;
        let numbers = pipeline.numbers(seed);
        let cone = if scene.render.cone == ConePattern::Random { numbers.as_random() } else { numbers.clone() };
        Ok(Self {
            emit: scene.source.emit().ok_or(RenderError::CannotEmit)?,
            receive: scene.imager.receive().ok_or(RenderError::CannotReceive)?,
            front: FrontDisk::of(&scene.lens).ok_or(RenderError::NoAperture)?,
            numbers,
            cone,
            pipeline,
        })
    }

    /// Traces paths `first .. first + len`; what arrived is left in the batch, pixels in the tags.
    pub(crate) fn batch(&self, state: &mut ThreadState, first: u64, len: usize) {
        let isa = self.pipeline.isa;
        for (dimension, column) in state.numbers.iter_mut().enumerate() {
            let numbers = if dimension >= Dimension::PupilU as usize { &self.cone } else { &self.numbers };
            let group = self.pipeline.group(dimension);
            numbers.fill_rotated(isa, STREAM, first, group, dimension as u32, column.slice_mut(len));
        }
        state.draw_wavelengths(&self.pipeline, len);
        let [_, u, v, a, b] = &state.numbers;
        self.emit.place(&mut state.rays, u.slice(len), v.slice(len), isa);
        let aim = Aim { front: self.front, u: a.slice(len), v: b.slice(len), rays: &mut state.rays };
        if self.pipeline.scene.render.cone == ConePattern::Rings {
            isa.run(AimBy::<true>(aim));
        } else {
            isa.run(AimBy::<false>(aim));
        }
        self.emit.radiate(&mut state.rays, isa);
        self.pipeline.tracer.trace(&mut state.rays, &mut state.work, Travel::Forward);
        let before = state.rays.alive();
        self.receive.receive(&mut state.rays, isa);
        let outside = before - state.rays.alive();
        state.work.losses.add(spectra_core::Loss::OutOfFrame, 0, outside as u64);
        state.rays.compact();
    }

    /// Adds a unit of paths to the sums.
    pub(crate) fn unit(&self, state: &mut ThreadState, first: u64, paths: u64, scale: f64, sums: &ExactSums) {
        let batch = state.rays.capacity() as u64;
        let channels = state.integers.len();
        let mut at = first;
        while at < first + paths {
            let len = batch.min(first + paths - at);
            self.batch(state, at, len as usize);
            if !state.contributions(&self.pipeline, scale) {
                sums.mark_overflow();
            }
            for (i, pixel) in state.rays.tags().iter().enumerate() {
                let cell = *pixel as usize * channels;
                for (channel, integers) in state.integers.iter().enumerate() {
                    sums.add(cell + channel, integers[i]);
                }
            }
            at += len;
        }
    }
}

/// Turns rays toward points of the front disk, and starts them there.
struct Aim<'a> {
    front: FrontDisk,
    u: &'a [f64],
    v: &'a [f64],
    rays: &'a mut spectra_core::RayBatch,
}

struct AimBy<'a, const RINGS: bool>(Aim<'a>);

impl<const RINGS: bool> Vectorized for AimBy<'_, RINGS> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Aim { front, u, v, rays } = self.0;
        let c = rays.columns_mut();
        let len = c.x.len();
        let (u, v) = (&u[..len], &v[..len]);
        let (x, y, z) = (&mut c.x[..len], &mut c.y[..len], &mut c.z[..len]);
        let (l, m, n) = (&mut c.l[..len], &mut c.m[..len], &mut c.n[..len]);
        let weight = &mut c.weight[..len];
        let area = std::f64::consts::PI * front.radius_mm * front.radius_mm;
        for i in 0..len {
            let (p, q) = if RINGS { polar_disk(u[i], v[i]) } else { concentric_disk(u[i], v[i]) };
            let (tx, ty, tz) = (p * front.radius_mm, q * front.radius_mm, front.z_mm);
            let (dx, dy, dz) = (tx - x[i], ty - y[i], tz - z[i]);
            let inverse = 1.0 / (dx * dx + dy * dy + dz * dz).sqrt();
            (l[i], m[i], n[i]) = (dx * inverse, dy * inverse, dz * inverse);
            // Solid angle of the disk's area element as the source point sees it.
            weight[i] *= area * n[i] * inverse * inverse;
            (x[i], y[i], z[i]) = (tx, ty, tz);
        }
    }
}
