//! A flat, Lambertian picture perpendicular to the axis: the common code of charts and pictures.

use spectra_core::isa::{Isa, Vectorized};
use spectra_core::spectral::SpectralPower;
use spectra_core::stage::{Emit, Radiance, Source};
use spectra_core::{Loss, RayBatch, loss::ALIVE};

/// The picture on a plane. Coordinates are mm from its center: +x to the photographer's right, +y up.
pub(crate) trait Texture: Send + Sync {
    /// Multiplies each weight by the radiance at (`x_mm`, `y_mm`): W m^-2 sr^-1 nm^-1, or
    /// W m^-2 sr^-1 on a line; 0 outside the picture.
    fn shine(&self, at: Places<'_>, weight: &mut [f64], isa: Isa);

    /// Draws a point on the picture from (`u`, `v`) in [0, 1)^2. Returns its x and y in mm, and the area that the sample
    /// represents, in mm^2: the reciprocal of the density.
    fn draw(&self, u: f64, v: f64) -> (f64, f64, f64);

    /// Half the width and height of the spots that the picture consists of, mm; `None` if it does not consist of spots. See
    /// [`Emit::spots_mm`].
    fn spots_mm(&self) -> Option<[f64; 2]> {
        None
    }

    /// Draws a point as [`Texture::draw`] does, but in the center of a spot.
    fn draw_middle(&self, u: f64, v: f64) -> (f64, f64, f64) {
        self.draw(u, v)
    }

    /// Returns whether the picture is dark beyond its border. One that continues without end cannot emit from all of its area.
    fn is_bounded(&self) -> bool {
        true
    }

    /// Spectrum of the light of the whole picture, in any scale.
    fn spectrum(&self) -> &SpectralPower;

    /// Spectrum of white in the picture, in any scale.
    fn white(&self) -> &SpectralPower {
        self.spectrum()
    }

    /// Ratio of the peak to the mean brightness.
    fn peak_over_mean(&self) -> f64;

    /// Description of the picture for the log.
    fn describe(&self) -> String;
}

/// Points and wavelengths at which a texture is evaluated.
#[derive(Clone, Copy)]
pub(crate) struct Places<'a> {
    pub x_mm: &'a [f64],
    pub y_mm: &'a [f64],
    pub wavelength_nm: &'a [f64],
    pub line: &'a [u32],
}

/// A texture on a plane at a distance in front of the first vertex.
pub(crate) struct PlaneSource<T> {
    pub texture: T,
    pub distance_mm: f64,
}

impl<T: Texture> Source for PlaneSource<T> {
    fn spectrum(&self) -> &SpectralPower {
        self.texture.spectrum()
    }
    fn white(&self) -> &SpectralPower {
        self.texture.white()
    }
    fn peak_over_mean(&self) -> f64 {
        self.texture.peak_over_mean()
    }
    fn distance_mm(&self) -> f64 {
        self.distance_mm
    }
    fn emit(&self) -> Option<&dyn Emit> {
        self.texture.is_bounded().then_some(self as &dyn Emit)
    }
    fn radiance(&self) -> Option<&dyn Radiance> {
        Some(self)
    }
    fn describe(&self) -> String {
        format!("{} at {} mm", self.texture.describe(), self.distance_mm)
    }
}

impl<T: Texture> PlaneSource<T> {
    /// Starts rays at the points that `drawn` returns.
    #[inline(always)]
    fn start(&self, rays: &mut RayBatch, drawn: impl Fn(usize) -> (f64, f64, f64)) {
        let isa = rays.isa();
        let c = rays.columns_mut();
        for i in 0..c.x.len() {
            let (x, y, area) = drawn(i);
            (c.x[i], c.y[i], c.z[i]) = (x, y, -self.distance_mm);
            c.weight[i] *= area;
        }
        let at = Places { x_mm: c.x, y_mm: c.y, wavelength_nm: c.wavelength_nm, line: c.line };
        self.texture.shine(at, c.weight, isa);
    }
}

impl<T: Texture> Emit for PlaneSource<T> {
    fn place(&self, rays: &mut RayBatch, u: &[f64], v: &[f64]) {
        self.start(rays, |i| self.texture.draw(u[i], v[i]));
    }

    fn spots_mm(&self) -> Option<[f64; 2]> {
        self.texture.spots_mm()
    }

    fn place_in_middle(&self, rays: &mut RayBatch, u: &[f64], v: &[f64]) {
        self.start(rays, |i| self.texture.draw_middle(u[i], v[i]));
    }

    fn radiate(&self, rays: &mut RayBatch) {
        let isa = rays.isa();
        let c = rays.columns_mut();
        isa.run(Cosine { n: c.n, weight: c.weight });
    }
}

impl<T: Texture> Radiance for PlaneSource<T> {
    fn radiance(&self, rays: &mut RayBatch) {
        let isa = rays.isa();
        let c = rays.columns_mut();
        isa.run(ToPlane { distance_mm: self.distance_mm, c: [c.z, c.l, c.m, c.n], x: c.x, y: c.y });
        // A ray that runs away from the plane gets no light from it.
        for (n, state) in c.n.iter().zip(c.state.iter_mut()) {
            if *state == ALIVE && !(*n < 0.0) {
                *state = Loss::Absorbed.state(0);
            }
        }
        let at = Places { x_mm: c.x, y_mm: c.y, wavelength_nm: c.wavelength_nm, line: c.line };
        self.texture.shine(at, c.weight, isa);
    }
}

struct Cosine<'a> {
    n: &'a [f64],
    weight: &'a mut [f64],
}

impl Vectorized for Cosine<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        for (n, weight) in self.n.iter().zip(self.weight) {
            *weight *= n.abs();
        }
    }
}

/// Moves rays along their direction to the plane. Leaves z unchanged, since it is not used again.
struct ToPlane<'a> {
    distance_mm: f64,
    c: [&'a [f64]; 4],
    x: &'a mut [f64],
    y: &'a mut [f64],
}

impl Vectorized for ToPlane<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let len = self.x.len();
        let [z, l, m, n] = self.c.map(|c| &c[..len]);
        let y = &mut self.y[..len];
        for i in 0..len {
            let t = (-self.distance_mm - z[i]) / n[i];
            self.x[i] += t * l[i];
            y[i] += t * m[i];
        }
    }
}
