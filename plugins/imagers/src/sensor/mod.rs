//! `imager: sensor`, a chip of pixels: color filters, measured sensitivities, photons counted, a converter.

mod color;
mod convert;
mod demosaic;
mod noise;
mod params;
mod pattern;
mod photosite;

pub use color::CameraColor;
pub use convert::{Converter, electrons};
pub use demosaic::demosaic;
pub use noise::PixelNumbers;
pub use params::{PhotositeParams, SensorParams};
pub use pattern::{PATTERNS, Pattern};
pub use photosite::Photosite;

use crate::plane::Plane;
use glam::DVec3;
use spectra_core::batch::{Columns, pixel_and_channel, tag_of};
use spectra_core::frame::{DisplayPicture, ExposureFrame, FrameSize, RawFrame};
use spectra_core::isa::Isa;
use spectra_core::loss::ALIVE;
use spectra_core::spectral::Channel;
use spectra_core::stage::{Imager, Launch, Receive};
use spectra_core::{Loss, RayBatch};

/// A sensor. Its channels are electrons by the filter that their light passed: each pixel's well holds their sum.
#[derive(Clone, Debug)]
pub struct Sensor {
    pub(crate) pixels: Pixels,
    pub(crate) channels: Vec<Channel>,
    pub(crate) converter: Converter,
}

/// The geometry of the pixels.
#[derive(Clone, Debug)]
pub(crate) struct Pixels {
    pub(crate) plane: Plane,
    pub(crate) pattern: Pattern,
    /// Side of the open part of a pixel over the pitch.
    pub(crate) open: f64,
    pub(crate) photosite: Option<Photosite>,
}

/// Why a ray adds nothing.
const BESIDE: (Loss, u32) = (Loss::OutOfFrame, 0);
const WALLED: (Loss, u32) = (Loss::Absorbed, 0);

impl Pixels {
    fn tag(&self, column: u32, row: u32, well: u32) -> u32 {
        match self.pattern {
            Pattern::Monochrome => well,
            Pattern::Bayer(_) => tag_of(well, self.pattern.channel(column, row)),
        }
    }

    /// Column and row of a place on the frame, with fractions.
    fn place(&self, x: f64, y: f64) -> [f64; 2] {
        let FrameSize { width_px, height_px, width_mm, height_mm } = self.plane.size();
        [(0.5 - x / width_mm) * f64::from(width_px), (0.5 + y / height_mm) * f64::from(height_px)]
    }

    fn neighbor(&self, column: u32, row: u32, [dc, dr]: [i32; 2]) -> Option<(u32, u32)> {
        let size = self.plane.size();
        let (column, row) = (column.checked_add_signed(dc)?, row.checked_add_signed(dr)?);
        (column < size.width_px && row < size.height_px).then_some((column, row))
    }

    /// From the pixel whose filter light passes to the one whose well it ends in.
    fn landing(&self, entry: [f64; 2], x: f64, y: f64, way: DVec3, nm: f64) -> Result<[i32; 2], (Loss, u32)> {
        let Some(photosite) = &self.photosite else { return Ok([0, 0]) };
        let by = photosite.landing(entry, [x, y], self.plane.axes(x, y), way, nm);
        // Farther than the next well there are walls of metal.
        if by.iter().all(|d| d.abs() <= 1) { Ok(by) } else { Err(WALLED) }
    }

    fn receive_one(&self, c: &mut Columns<'_>, i: usize) -> Result<(), (Loss, u32)> {
        let (from, way) = (DVec3::new(c.x[i], c.y[i], c.z[i]), DVec3::new(c.l[i], c.m[i], c.n[i]));
        let (point, x, y) = self.plane.meet(from, way).ok_or(BESIDE)?;
        let pixel = self.plane.size().pixel_at(x, y).ok_or(BESIDE)?;
        let (column, row) = (pixel % self.plane.size().width_px, pixel / self.plane.size().width_px);
        let [at_column, at_row] = self.place(x, y);
        let entry = [at_column - f64::from(column) - 0.5, at_row - f64::from(row) - 0.5];
        if entry.iter().any(|e| e.abs() > 0.5 * self.open) {
            return Err(WALLED);
        }
        let by = self.landing(entry, x, y, way, c.wavelength_nm[i])?;
        let (to_column, to_row) = self.neighbor(column, row, by).ok_or(BESIDE)?;
        c.tag[i] = self.tag(column, row, to_row * self.plane.size().width_px + to_column);
        [c.x[i], c.y[i], c.z[i]] = point.to_array();
        Ok(())
    }

    fn admit_one(&self, c: &mut Columns<'_>, i: usize) -> Result<(), (Loss, u32)> {
        let (at, way) = (DVec3::new(c.x[i], c.y[i], c.z[i]), -DVec3::new(c.l[i], c.m[i], c.n[i]));
        let size = self.plane.size();
        let (well, _) = pixel_and_channel(c.tag[i]);
        let (column, row) = (well % size.width_px, well / size.width_px);
        c.weight[i] *= self.open * self.open;
        if self.photosite.is_none() {
            c.tag[i] = self.tag(column, row, well);
            return Ok(());
        }
        let (_, x, y) = self.plane.meet(at, way).ok_or(WALLED)?;
        let [at_column, at_row] = self.place(x, y);
        let entry = [at_column - f64::from(column) - 0.5, at_row - f64::from(row) - 0.5];
        let [dc, dr] = self.landing(entry, x, y, way, c.wavelength_nm[i])?;
        // What ends in this well came in by that neighbor: the ray is moved there.
        let (from_column, from_row) = self.neighbor(column, row, [-dc, -dr]).ok_or(WALLED)?;
        c.tag[i] = self.tag(from_column, from_row, well);
        if [dc, dr] != [0, 0] {
            let axes = self.plane.axes(x, y);
            let across = size.width_mm / f64::from(size.width_px) * f64::from(dc);
            let down = size.height_mm / f64::from(size.height_px) * f64::from(dr);
            [c.x[i], c.y[i], c.z[i]] = (at + axes.x_axis * across - axes.y_axis * down).to_array();
        }
        Ok(())
    }
}

/// Does `one` to each living ray, and ends those for which it says why.
fn each(rays: &mut RayBatch, one: impl Fn(&mut Columns<'_>, usize) -> Result<(), (Loss, u32)>) {
    let mut c = rays.columns_mut();
    for i in 0..c.x.len() {
        if c.state[i] != ALIVE {
            continue;
        }
        if let Err((cause, surface)) = one(&mut c, i) {
            c.state[i] = cause.state(surface);
        }
    }
}

impl Receive for Pixels {
    fn receive(&self, rays: &mut RayBatch, _isa: Isa) {
        each(rays, |c, i| self.receive_one(c, i));
    }
}

impl Launch for Pixels {
    fn place(&self, rays: &mut RayBatch, u: &[f64], v: &[f64], isa: Isa) {
        if self.open == 1.0 {
            return self.plane.place(rays, u, v, isa);
        }
        let open = |u: &[f64]| -> Vec<f64> { u.iter().map(|u| 0.5 + (u - 0.5) * self.open).collect() };
        self.plane.place(rays, &open(u), &open(v), isa);
    }

    fn admit(&self, rays: &mut RayBatch, _isa: Isa) {
        each(rays, |c, i| self.admit_one(c, i));
    }
}

impl Imager for Sensor {
    fn size(&self) -> FrameSize {
        self.pixels.plane.size()
    }

    fn channels(&self) -> Option<Vec<Channel>> {
        Some(self.channels.clone())
    }

    fn receive(&self) -> Option<&dyn Receive> {
        Some(&self.pixels)
    }

    fn launch(&self) -> Option<&dyn Launch> {
        Some(&self.pixels)
    }

    fn display(&self, exposure: &ExposureFrame) -> Option<DisplayPicture> {
        self.converter.show(&self.converter.convert(exposure))
    }

    fn exposure_time_s(&self) -> Option<f64> {
        Some(self.converter.exposure_time_s)
    }

    fn has_converter(&self) -> bool {
        true
    }

    fn raw(&self, exposure: &ExposureFrame) -> Option<RawFrame> {
        Some(self.converter.convert(exposure))
    }
}
