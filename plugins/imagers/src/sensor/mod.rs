//! `imager: sensor`: a chip of pixels with color filters, measured sensitivities, photon noise and an analog-to-digital
//! converter.

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
pub use pattern::{Pattern, PatternName};
pub use photosite::Photosite;

use crate::plane::{FrameHit, Plane};
use glam::DVec3;
use spectra_core::batch::{Columns, pixel_and_channel, tag_of};
use spectra_core::cover::CoverStack;
use spectra_core::frame::{DisplayPicture, ExposureFrame, ExtraRequest, FinishedPicture, FrameSize};
use spectra_core::loss::ALIVE;
use spectra_core::numbers::seed_of_frame;
use spectra_core::spectral::Channel;
use spectra_core::stage::{Digitize, Imager, Launch, Receive, Response};
use spectra_core::{Loss, RayBatch};

/// An image sensor. Each channel holds the electrons of light that passed one filter; the well of a pixel holds the sum of all
/// channels.
#[derive(Clone, Debug)]
pub struct Sensor {
    pub(crate) pixels: Pixels,
    pub(crate) channels: Vec<Channel>,
    pub(crate) converter: Converter,
}

/// Geometry of the pixels of a sensor.
#[derive(Clone, Debug)]
pub(crate) struct Pixels {
    pub(crate) plane: Plane,
    pub(crate) pattern: Pattern,
    /// Side of the light-sensitive part of a pixel, as a fraction of the pitch.
    pub(crate) open: f64,
    pub(crate) photosite: Option<Photosite>,
    /// Whether the picture is rendered with its own, coarser pixels. A neighbor's well then lies in the same pixel of the picture,
    /// and only the filter that light has passed is a different one.
    pub(crate) coarse: bool,
}

/// The cause of loss of a ray that misses the frame.
const BESIDE: (Loss, u32) = (Loss::OutOfFrame, 0);
/// The cause of loss of a ray that hits the walls between pixels.
const WALLED: (Loss, u32) = (Loss::Absorbed, 0);

impl Pixels {
    fn tag(&self, column: u32, row: u32, well: u32) -> u32 {
        match self.pattern {
            Pattern::Monochrome => well,
            Pattern::Bayer(_) => tag_of(well, self.pattern.channel(column, row)),
        }
    }

    /// Returns the column and row of a point on the frame, with fractions.
    fn place(&self, x: f64, y: f64) -> [f64; 2] {
        let FrameSize { width_px, height_px, width_mm, height_mm } = self.plane.size();
        [(0.5 - x / width_mm) * f64::from(width_px), (0.5 + y / height_mm) * f64::from(height_px)]
    }

    fn neighbor(&self, column: u32, row: u32, [dc, dr]: [i32; 2]) -> Option<(u32, u32)> {
        let size = self.plane.size();
        let (column, row) = (column.checked_add_signed(dc)?, row.checked_add_signed(dr)?);
        (column < size.width_px && row < size.height_px).then_some((column, row))
    }

    /// Returns the columns and rows from the pixel whose filter light passes to the one whose well collects it, or the cause of
    /// its loss.
    fn landing(&self, entry: [f64; 2], x: f64, y: f64, way: DVec3, nm: f64) -> Result<[i32; 2], (Loss, u32)> {
        let Some(photosite) = &self.photosite else { return Ok([0, 0]) };
        let by = photosite.landing(entry, [x, y], self.plane.axes(x, y), way, nm);
        // Metal walls stop light that would go beyond the adjacent wells.
        if by.iter().all(|d| d.abs() <= 1) { Ok(by) } else { Err(WALLED) }
    }

    fn receive_one(&self, c: &mut Columns<'_>, i: usize) -> Result<(), (Loss, u32)> {
        let (from, way) = (DVec3::new(c.x[i], c.y[i], c.z[i]), DVec3::new(c.l[i], c.m[i], c.n[i]));
        let FrameHit { point, x, y, passed } =
            self.plane.meet(from, way, c.wavelength_nm[i], c.numbers.of(i)).ok_or(BESIDE)?;
        let pixel = self.plane.size().pixel_at(x, y).ok_or(BESIDE)?;
        let (column, row) = (pixel % self.plane.size().width_px, pixel / self.plane.size().width_px);
        let [at_column, at_row] = self.place(x, y);
        let entry = [at_column - f64::from(column) - 0.5, at_row - f64::from(row) - 0.5];
        if entry.iter().any(|e| e.abs() > 0.5 * self.open) {
            return Err(WALLED);
        }
        let by = self.landing(entry, x, y, way, c.wavelength_nm[i])?;
        c.tag[i] = if self.coarse {
            self.tag(column.wrapping_add_signed(-by[0]), row.wrapping_add_signed(-by[1]), pixel)
        } else {
            let (to_column, to_row) = self.neighbor(column, row, by).ok_or(BESIDE)?;
            self.tag(column, row, to_row * self.plane.size().width_px + to_column)
        };
        [c.x[i], c.y[i], c.z[i]] = point.to_array();
        c.weight[i] *= passed;
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
        let FrameHit { x, y, .. } = self.plane.meet(at, way, c.wavelength_nm[i], c.numbers.of(i)).ok_or(WALLED)?;
        let [at_column, at_row] = self.place(x, y);
        let entry = [at_column - f64::from(column) - 0.5, at_row - f64::from(row) - 0.5];
        let [dc, dr] = self.landing(entry, x, y, way, c.wavelength_nm[i])?;
        if self.coarse {
            c.tag[i] = self.tag(column.wrapping_add_signed(-dc), row.wrapping_add_signed(-dr), well);
            return Ok(());
        }
        // The light of this well came in through that neighbor: move the ray there.
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

/// Applies `one` to each living ray, and ends those for which it returns a cause of loss.
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
    fn receive(&self, rays: &mut RayBatch) {
        each(rays, |c, i| self.receive_one(c, i));
    }

    fn draws(&self) -> bool {
        self.plane.splits()
    }
}

impl Launch for Pixels {
    fn place(&self, rays: &mut RayBatch, u: &[f64], v: &[f64]) {
        if self.open == 1.0 {
            return self.plane.place(rays, u, v);
        }
        let open = |u: &[f64]| -> Vec<f64> { u.iter().map(|u| 0.5 + (u - 0.5) * self.open).collect() };
        self.plane.place(rays, &open(u), &open(v));
    }

    fn admit(&self, rays: &mut RayBatch) {
        self.plane.admit(rays);
        each(rays, |c, i| self.admit_one(c, i));
    }

    fn draws(&self) -> bool {
        self.plane.splits()
    }
}

impl Imager for Sensor {
    fn size(&self) -> FrameSize {
        self.pixels.plane.size()
    }

    fn response(&self) -> Option<&dyn Response> {
        Some(self)
    }

    fn receive(&self) -> Option<&dyn Receive> {
        Some(&self.pixels)
    }

    fn launch(&self) -> Option<&dyn Launch> {
        Some(&self.pixels)
    }

    fn cover(&self) -> Option<CoverStack> {
        self.pixels.plane.cover()
    }

    fn set_frame(&mut self, frame: u64) {
        self.converter.noise = self.converter.noise.map(|seed| seed_of_frame(seed, frame));
    }
}

impl Response for Sensor {
    fn channels(&self) -> Vec<Channel> {
        self.channels.clone()
    }

    fn exposure_time_s(&self) -> Option<f64> {
        Some(self.converter.exposure_time_s)
    }

    fn display(&self, exposure: &ExposureFrame) -> Option<DisplayPicture> {
        self.converter.show(&self.converter.raw(exposure))
    }

    fn finish(&self, exposure: &ExposureFrame, wanted: ExtraRequest) -> Option<FinishedPicture> {
        self.converter.finish(&self.converter.raw(exposure), wanted)
    }

    fn digitize(&self) -> Option<&dyn Digitize> {
        Some(&self.converter)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::placement::{FrameShape, Placement};
    use spectra_core::Isa;
    use spectra_core::numbers::Numbers;
    use spectra_core::spectral::BAND;

    /// A ray that a well admits, sent back along its path, ends in that well with the same filter, on the sensor's own pixels
    /// and on coarser ones. At 35 to 50 degrees many rays have passed a neighbor's filter; beyond that, walls stop them.
    #[test]
    fn receive_undoes_admit() {
        let silicon = spectra_glass::Catalog::bundled().medium("Si/Green-2008").expect("bundled");
        let size = FrameSize { width_px: 60, height_px: 40, width_mm: 0.3, height_mm: 0.2 };
        let standing = Placement::new([12.0, 6.0], [0.05, -0.03], FrameShape::Flat);
        let n = 2000;
        let column = |dimension: u32| {
            let mut out = vec![0.0; n];
            Numbers::random(5).fill(Isa::Baseline, 0, 0, dimension, &mut out);
            out
        };
        let [u, v, a, b] = [0, 1, 2, 3].map(column);
        for coarse in [false, true] {
            let mut photosite = Photosite::new(0.005, &silicon, &BAND);
            (photosite.stack_mm, photosite.stack_index, photosite.microlens) = (0.003, 1.46, 0.4);
            let plane = Plane::new(size).with_placement(standing);
            let pattern = PatternName::Grbg.pattern();
            let pixels = Pixels { plane, pattern, open: 0.9, photosite: Some(photosite), coarse };
            let mut rays = RayBatch::new(n);
            rays.restart(n);
            let c = rays.columns_mut();
            for i in 0..n {
                // Stay away from the border, where neighbors would lie outside the frame.
                let (x, y) = (2 + i as u32 % 56, 2 + i as u32 / 56 % 36);
                (c.tag[i], c.wavelength_nm[i]) = (y * 60 + x, 550.0);
            }
            Launch::place(&pixels, &mut rays, &u, &v);
            let c = rays.columns_mut();
            for i in 0..n {
                let at = DVec3::new(c.x[i], c.y[i], c.z[i]);
                let target = DVec3::new(6.0 * a[i] - 3.0, 6.0 * b[i] - 3.0, -15.0);
                [c.x[i], c.y[i], c.z[i]] = target.to_array();
                [c.l[i], c.m[i], c.n[i]] = (target - at).normalize().to_array();
            }
            pixels.admit(&mut rays);
            rays.compact();
            let left = rays.len();
            let admitted = rays.tags().to_vec();
            let c = rays.columns_mut();
            for i in 0..left {
                (c.l[i], c.m[i], c.n[i], c.tag[i]) = (-c.l[i], -c.m[i], -c.n[i], 0);
                assert!((c.weight[i] - 0.81).abs() < 1e-12);
            }
            pixels.receive(&mut rays);
            assert_eq!(rays.alive(), left);
            assert_eq!(rays.tags(), admitted);
            let strange = |tag: &&u32| {
                let (well, only) = pixel_and_channel(**tag);
                only != Some(pattern.channel(well % 60, well / 60))
            };
            let crossed = admitted.iter().filter(strange).count() as f64 / left as f64;
            println!("coarse {coarse}: {left} of {n} admitted, {crossed:.3} by another filter");
            assert!(left > n / 2 && (0.1..0.9).contains(&crossed), "{left} {crossed}");
        }
    }
}
