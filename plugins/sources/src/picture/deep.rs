//! A picture with depth as a source: what comes against a ray from the lens.

use super::field::{HeightField, Line};
use super::map::PictureMap;
use spectra_core::loss::{ALIVE, Loss};
use spectra_core::spectral::SpectralPower;
use spectra_core::stage::{Radiance, Source};
use spectra_core::{Isa, RayBatch};

/// A picture whose pixels stand at their depths. It answers for radiance only: light is asked for from the imager.
pub(super) struct DeepPicture {
    /// Colors; its size is that on the plane at `plane_mm`.
    pub map: PictureMap,
    pub field: HeightField,
    /// Distance of the plane from the center of projection, mm.
    pub plane_mm: f64,
    /// The center of projection on the axis, mm behind the first vertex.
    pub eye_mm: f64,
    pub nearest_mm: f64,
    pub farthest_mm: f64,
}

impl Source for DeepPicture {
    fn spectrum(&self) -> &SpectralPower {
        &self.map.mean
    }
    fn peak_over_mean(&self) -> f64 {
        self.map.peak_over_mean
    }
    fn distance_mm(&self) -> f64 {
        self.nearest_mm - self.eye_mm
    }
    fn radiance(&self) -> Option<&dyn Radiance> {
        Some(self)
    }
    fn describe(&self) -> String {
        let [near, far] = [self.nearest_mm, self.farthest_mm].map(|d| d - self.eye_mm);
        format!("picture {} with depth from {near:.0} to {far:.0} mm in front of the lens", self.map.name)
    }
}

impl DeepPicture {
    /// The ray through a point in a direction, over the picture.
    fn line(&self, [x, y, z]: [f64; 3], [l, m, n]: [f64; 3]) -> Line {
        let t = (self.eye_mm - z) / n;
        let map = &self.map;
        let per_mm = [map.width_px as f64 / map.width_mm, -(map.height_px as f64) / map.height_mm];
        let middle = [0.5 * map.width_px as f64, 0.5 * map.height_px as f64];
        let (slope, at_eye) = ([l / -n, m / -n], [x + t * l, y + t * m]);
        Line {
            at_infinity: [0, 1].map(|k| middle[k] + per_mm[k] * self.plane_mm * slope[k]),
            per_w: [0, 1].map(|k| per_mm[k] * self.plane_mm * at_eye[k]),
        }
    }

    /// The color that a ray meets; black beside the picture.
    fn color(&self, line: &Line) -> [f32; 3] {
        let Some(hit) = self.field.hit(line) else { return [0.0; 3] };
        let own = self.map.coefficients[hit.cell];
        if hit.guessed {
            return own;
        }
        // Between pixels of the same thing colors are smooth; others do not count.
        let spot = self.map.spot(hit.place);
        spot.mix(|cell| if self.field.together(hit.cell, cell) { self.map.coefficients[cell] } else { own })
    }
}

impl Radiance for DeepPicture {
    fn radiance(&self, rays: &mut RayBatch, _: Isa) {
        let c = rays.columns_mut();
        let mut colors = [[0.0_f32; 3]; 64];
        for start in (0..c.x.len()).step_by(64) {
            let end = (start + 64).min(c.x.len());
            for i in start..end {
                if c.state[i] == ALIVE && !(c.n[i] < 0.0) {
                    c.state[i] = Loss::Absorbed.state(0);
                }
                colors[i - start] = if c.state[i] == ALIVE {
                    self.color(&self.line([c.x[i], c.y[i], c.z[i]], [c.l[i], c.m[i], c.n[i]]))
                } else {
                    [0.0; 3]
                };
                c.weight[i] *= self.map.scale;
            }
            let (wavelength, line) = (&c.wavelength_nm[start..end], &c.line[start..end]);
            self.map.model.evaluate(&colors[..end - start], wavelength, line, &mut c.weight[start..end]);
        }
    }
}
