//! What glass absorbs, tabulated for a tracer.

use spectra_core::isa::Vectorized;
use spectra_glass::Medium;

/// Step of the tables, nm.
const STEP_NM: f64 = 0.5;

/// Where the tables of all media of a tracer lie.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Grid {
    start_nm: f64,
    /// Number of steps.
    count: usize,
}

impl Grid {
    /// Over a band, nm.
    pub(crate) fn over(min_nm: f64, max_nm: f64) -> Self {
        Self { start_nm: min_nm, count: ((max_nm - min_nm) / STEP_NM).ceil() as usize + 1 }
    }

    /// The same for one wavelength, nm.
    pub(crate) fn place(&self, wavelength_nm: f64) -> (u64, f64) {
        let place = ((wavelength_nm - self.start_nm) * (1.0 / STEP_NM)).clamp(0.0, self.count as f64);
        let cell = place.floor().min((self.count - 1) as f64);
        (cell as u64, place - cell)
    }
}

/// Cell of a grid, and the part of it that lies before, for each wavelength. Beyond the band its ends hold.
pub(crate) struct Locate<'a> {
    pub grid: Grid,
    pub wavelengths_nm: &'a [f64],
    pub cell: &'a mut [u64],
    pub part: &'a mut [f64],
}

impl Vectorized for Locate<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        // Adding 2^52 rounds to whole numbers, which then stand in the lowest bits.
        const ROUND: f64 = 4_503_599_627_370_496.0;
        let len = self.wavelengths_nm.len();
        let (cell, part) = (&mut self.cell[..len], &mut self.part[..len]);
        let (start_nm, last) = (self.grid.start_nm, (self.grid.count - 1) as f64);
        for i in 0..len {
            let place = (self.wavelengths_nm[i] - start_nm) * (1.0 / STEP_NM);
            let place = if place > 0.0 { place } else { 0.0 };
            let place = if place < last + 1.0 { place } else { last + 1.0 };
            let below = if place > 0.5 { place - 0.5 } else { 0.0 };
            let shifted = if below < last { below } else { last } + ROUND;
            cell[i] = shifted.to_bits() & 0xf_ffff_ffff_ffff;
            part[i] = place - (shifted - ROUND);
        }
    }
}

/// Absorption of one medium over a band.
#[derive(Clone, Debug)]
pub(crate) struct Absorption {
    /// By steps of the grid: 1/mm, and how much it is more one step further.
    per_mm: Vec<[f64; 2]>,
}

impl Absorption {
    /// Of a medium of a lens of that year, by its own data or borrowed ones ([`Medium::absorption`]); `None` where it
    /// absorbs nothing, as far as is known. Beyond the data the nearest of them holds.
    pub(crate) fn of(medium: &Medium, year: Option<i32>, grid: &Grid) -> Option<Self> {
        let k = medium.absorption(year)?.extinction;
        let (first, last) = k.range_nm();
        let at = |i: usize| {
            let wavelength_nm = grid.start_nm + STEP_NM * i as f64;
            let k = k.at(wavelength_nm.clamp(first, last)).unwrap_or(0.0);
            4.0e6 * std::f64::consts::PI * k / wavelength_nm
        };
        let per_mm: Vec<f64> = (0..=grid.count).map(at).collect();
        let steps = per_mm.windows(2).map(|pair| [pair[0], pair[1] - pair[0]]);
        per_mm.iter().any(|a| *a > 0.0).then(|| Self { per_mm: steps.collect() })
    }

    /// At places of the grid: 1/mm.
    pub(crate) fn fill(&self, cells: &[u64], parts: &[f64], per_mm: &mut [f64]) {
        for ((to, cell), part) in per_mm.iter_mut().zip(cells).zip(parts) {
            let [here, step] = self.per_mm[*cell as usize];
            *to = here + part * step;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use spectra_core::Isa;

    /// The place is cell + part, whatever the wavelength; beyond the ends of the band it stays at them.
    #[test]
    fn wavelengths_are_found() {
        let grid = Grid::over(380.0, 400.25);
        let wavelengths_nm: Vec<f64> = (0..4000).map(|i| 370.0 + 0.01 * f64::from(i)).collect();
        let (mut cell, mut part) = (vec![0; 4000], vec![0.0; 4000]);
        for isa in Isa::available() {
            isa.run(Locate { grid, wavelengths_nm: &wavelengths_nm, cell: &mut cell, part: &mut part });
            for (nm, (cell, part)) in wavelengths_nm.iter().zip(cell.iter().zip(&part)) {
                let want = ((nm - 380.0) / 0.5).clamp(0.0, grid.count as f64);
                assert!((*cell as usize) < grid.count && (*cell as f64 + part - want).abs() < 1e-12, "{nm}");
                assert!((0.0..=1.0).contains(part), "{nm}: {part}");
            }
        }
    }
}
