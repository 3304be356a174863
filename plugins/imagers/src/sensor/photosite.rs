//! Geometry of a pixel: microlens, filter, a stack of wiring, and the depth at which silicon absorbs light.
//!
//! Oblique light lands beside the center of its pixel, by the height of the stack times the tangent of its angle inside.
//! It continues sideways in the silicon until it is absorbed, red deeper than blue. Light that lands in the well of a
//! neighbor has passed the wrong filter: colors mix and become pale. A microlens concentrates light toward the center of
//! the pixel. Shifted toward the center of the frame, it matches the angles of one exit pupil. The geometry is that of
//! P. B. Catrysse, B. A. Wandell, J. Opt. Soc. Am. A 19, 1610 (2002).

use glam::{DMat3, DVec2, DVec3};
use spectra_core::numbers::{GOLDEN, mix64, unit};
use spectra_core::spectral::Grid;
use spectra_glass::Medium;

/// Geometry of the layers of a pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct Photosite {
    /// Distance between the centers of two pixels, mm.
    pub pitch_mm: f64,
    /// Distance from the filter to the silicon, mm.
    pub stack_mm: f64,
    /// Refractive index of the stack.
    pub stack_index: f64,
    /// Strength with which the microlens concentrates light toward the center: 0 not at all, 1 to a point.
    pub microlens: f64,
    /// Distance of the exit pupil for which the microlenses are shifted, mm; infinity if they are not shifted.
    pub exit_pupil_mm: f64,
    /// Depth of the well from which charge is collected, mm; 0 if all light is absorbed at the surface.
    pub well_mm: f64,
    silicon: Silicon,
}

/// Optical properties of silicon on the grid of the band.
#[derive(Clone, Debug, PartialEq)]
struct Silicon {
    grid: Grid,
    index: Vec<f64>,
    absorption_mm: Vec<f64>,
}

impl Photosite {
    /// Creates pixels without stack, microlens and well. `silicon` gives the refractive index and the absorption of the detector
    /// material.
    #[must_use]
    pub fn new(pitch_mm: f64, silicon: &Medium, grid: &Grid) -> Self {
        const THIN_MM: f64 = 1e-4;
        let absorption = |w: f64| {
            let passed = silicon.internal_transmittance(w, THIN_MM).unwrap_or(0.0);
            // Without known transmittance all light is absorbed at the surface; without absorption it goes deep.
            if passed <= 0.0 { 0.0 } else { THIN_MM / (-spectra_core::math::log(passed)).max(1e-9) }
        };
        let silicon = Silicon {
            grid: *grid,
            index: grid.wavelengths_nm().map(|w| silicon.index(w)).collect(),
            absorption_mm: grid.wavelengths_nm().map(absorption).collect(),
        };
        Self {
            pitch_mm,
            stack_mm: 0.0,
            stack_index: 1.0,
            microlens: 0.0,
            exit_pupil_mm: f64::INFINITY,
            well_mm: 0.0,
            silicon,
        }
    }

    /// Returns the sideways shift (mm) from filter to charge for light of the unit direction `way`, in the axes of the surface.
    /// `number` in [0, 1) chooses the depth.
    fn aside_mm(&self, way: DVec3, wavelength_nm: f64, number: f64) -> DVec2 {
        let sideways = DVec2::new(way.x, way.y);
        let run = |index: f64| sideways / (index * index - sideways.length_squared()).max(1e-12).sqrt();
        let mut aside = run(self.stack_index) * self.stack_mm;
        if self.well_mm > 0.0 {
            let length = self.silicon.grid.interpolate(&self.silicon.absorption_mm, wavelength_nm);
            if length > 0.0 {
                // Exponential distribution of the light that is absorbed within the well.
                let share = -spectra_core::math::expm1(-self.well_mm / length);
                let depth = -length * spectra_core::math::log1p(-number * share);
                aside += run(self.silicon.grid.interpolate(&self.silicon.index, wavelength_nm).max(1.0)) * depth;
            }
        }
        aside
    }

    /// Returns the sideways shift (mm) for which the microlens at (`x_mm`, `y_mm`) on the frame compensates.
    fn made_for_mm(&self, x_mm: f64, y_mm: f64) -> DVec2 {
        if self.exit_pupil_mm.is_infinite() {
            return DVec2::ZERO;
        }
        let chief = DVec3::new(x_mm, y_mm, self.exit_pupil_mm).normalize();
        let sideways = DVec2::new(chief.x, chief.y);
        sideways / (self.stack_index * self.stack_index - sideways.length_squared()).sqrt() * self.stack_mm
    }

    /// Returns the offset, in columns and rows, from the pixel that light enters to the pixel whose well collects it.
    ///
    /// `entry` is the point of entry relative to the center of the pixel, in pixels along columns and rows. `place_mm` is this
    /// point on the frame. `axes` are the axes of the frame's surface there, and `way` is the direction of travel toward the
    /// silicon.
    #[must_use]
    pub fn landing(
        &self,
        entry: [f64; 2],
        place_mm: [f64; 2],
        axes: DMat3,
        way: DVec3,
        wavelength_nm: f64,
    ) -> [i32; 2] {
        let local = axes.transpose() * way;
        let number = number_of(way, wavelength_nm, entry);
        let aside =
            (self.aside_mm(local, wavelength_nm, number) - self.made_for_mm(place_mm[0], place_mm[1])) / self.pitch_mm;
        let gathered = 1.0 - self.microlens;
        // Column numbers fall with x, row numbers rise with y.
        [entry[0] * gathered - aside.x, entry[1] * gathered + aside.y].map(|at| (at + 0.5).floor() as i32)
    }
}

/// Returns a number in [0, 1) hashed from the bits of a ray, so that it does not depend on the other rays of the batch.
pub(crate) fn number_of(way: DVec3, wavelength_nm: f64, entry: [f64; 2]) -> f64 {
    let mut hash = 0x5eed_u64;
    for part in [way.x, way.y, wavelength_nm, entry[0], entry[1]] {
        hash = mix64(hash ^ part.to_bits()).wrapping_add(GOLDEN);
    }
    unit(mix64(hash))
}
