//! What stands before the silicon: microlens, filter, a stack of wiring, and how deep light goes.
//!
//! Light that comes at a slant lands beside the middle of its pixel, by the height of the stack times the tangent of its
//! angle in there, and goes on sideways in the silicon until it is absorbed, red deeper than blue. What lands in the well
//! of a neighbor has passed the wrong filter: colors mix, and pale. A microlens gathers light toward the middle; shifted
//! toward the center of the frame it meets the slant of one exit pupil (P. B. Catrysse, B. A. Wandell, J. Opt. Soc. Am. A
//! 19, 1610 (2002) have the geometry).

use glam::{DMat3, DVec2, DVec3};
use spectra_core::numbers::mix64;
use spectra_core::spectral::Grid;
use spectra_glass::Medium;

/// The parts of a pixel, by geometry.
#[derive(Clone, Debug, PartialEq)]
pub struct Photosite {
    /// Distance of the centers of two pixels, mm.
    pub pitch_mm: f64,
    /// From the filter to the silicon, mm.
    pub stack_mm: f64,
    /// Refractive index of the stack.
    pub stack_index: f64,
    /// How far the microlens gathers light toward the middle: 0 not at all, 1 to a point.
    pub microlens: f64,
    /// Distance of the exit pupil for which the microlenses are shifted, mm; infinity: not shifted.
    pub exit_pupil_mm: f64,
    /// How deep the well is from which charge is collected, mm; 0: all is absorbed at the surface.
    pub well_mm: f64,
    silicon: Silicon,
}

/// Silicon on the grid of the band.
#[derive(Clone, Debug, PartialEq)]
struct Silicon {
    grid: Grid,
    index: Vec<f64>,
    absorption_mm: Vec<f64>,
}

impl Photosite {
    /// Pixels of that pitch; `silicon` gives index and absorption.
    #[must_use]
    pub fn new(pitch_mm: f64, silicon: &Medium, grid: &Grid) -> Self {
        const THIN_MM: f64 = 1e-4;
        let absorption = |w: f64| {
            let passed = silicon.internal_transmittance(w, THIN_MM).unwrap_or(0.0);
            // Where nothing is known to pass, all stays at the surface; where nothing is absorbed, all goes deep.
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

    /// How far aside light of direction `way` (unit, axes of the surface) gets from filter to charge, mm. `number` in
    /// [0, 1) chooses the depth.
    fn aside_mm(&self, way: DVec3, wavelength_nm: f64, number: f64) -> DVec2 {
        let sideways = DVec2::new(way.x, way.y);
        let run = |index: f64| sideways / (index * index - sideways.length_squared()).max(1e-12).sqrt();
        let mut aside = run(self.stack_index) * self.stack_mm;
        if self.well_mm > 0.0 {
            let length = self.silicon.grid.interpolate(&self.silicon.absorption_mm, wavelength_nm);
            if length > 0.0 {
                // Exponential, of what is absorbed within the well.
                let share = -spectra_core::math::expm1(-self.well_mm / length);
                let depth = -length * spectra_core::math::log1p(-number * share);
                aside += run(self.silicon.grid.interpolate(&self.silicon.index, wavelength_nm).max(1.0)) * depth;
            }
        }
        aside
    }

    /// How far aside the microlens at (x, y) of the frame is made for, mm.
    fn made_for_mm(&self, x_mm: f64, y_mm: f64) -> DVec2 {
        if self.exit_pupil_mm.is_infinite() {
            return DVec2::ZERO;
        }
        let chief = DVec3::new(x_mm, y_mm, self.exit_pupil_mm).normalize();
        let sideways = DVec2::new(chief.x, chief.y);
        sideways / (self.stack_index * self.stack_index - sideways.length_squared()).sqrt() * self.stack_mm
    }

    /// Columns and rows from the pixel that light enters to the one whose well it ends in.
    ///
    /// `entry` is where it enters, in pixels from the middle along columns and rows; `place_mm` where that is on the
    /// frame, `axes` the surface's axes there, `way` the direction of travel toward the silicon.
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
        // Columns count against x, rows along y.
        [entry[0] * gathered - aside.x, entry[1] * gathered + aside.y].map(|at| (at + 0.5).floor() as i32)
    }
}

/// A number in [0, 1) that is a ray's own: by its bits, so that it does not depend on who else is in the batch.
pub(crate) fn number_of(way: DVec3, wavelength_nm: f64, entry: [f64; 2]) -> f64 {
    let mut hash = 0x5eed_u64;
    for part in [way.x, way.y, wavelength_nm, entry[0], entry[1]] {
        hash = mix64(hash ^ part.to_bits()).wrapping_add(0x9e37_79b9_7f4a_7c15);
    }
    (mix64(hash) >> 11) as f64 / (1_u64 << 53) as f64
}
