//! Absorption of glass, tabulated for a tracer.

use spectra_core::isa::Vectorized;
use spectra_glass::Medium;

/// Step of the tables, nm.
const STEP_NM: f64 = 0.5;

/// The wavelength grid on which all media of a tracer are tabulated.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Grid {
    start_nm: f64,
    /// Number of steps.
    count: usize,
}

impl Grid {
    /// Creates the grid over a band, nm.
    pub(crate) fn over(min_nm: f64, max_nm: f64) -> Self {
        Self { start_nm: min_nm, count: ((max_nm - min_nm) / STEP_NM).ceil() as usize + 1 }
    }

    /// Returns the cell that contains a wavelength (nm), and the fraction of the cell below that wavelength. Outside the band the
    /// ends are used.
    pub(crate) fn place(&self, wavelength_nm: f64) -> (u64, f64) {
        let place = ((wavelength_nm - self.start_nm) * (1.0 / STEP_NM)).clamp(0.0, self.count as f64);
        let cell = place.floor().min((self.count - 1) as f64);
        (cell as u64, place - cell)
    }
}

/// Kernel that finds, for each wavelength, the cell of a grid and the fraction of the cell before it. Outside the band the ends are used.
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
        // Adding 2^52 rounds to whole numbers, which are then in the lowest bits.
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

/// The absorption of one medium over a band.
#[derive(Clone, Debug)]
pub(crate) struct Absorption {
    /// Absorption coefficient at each step of the grid, 1/mm, and its increase to the next step.
    per_mm: Vec<[f64; 2]>,
}

impl Absorption {
    /// Tabulates a medium of a lens of that year, from its own data or those of a similar glass ([`Medium::absorption`]). Returns `None` if
    /// no absorption is known. Beyond the data the nearest value is used.
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

    /// Absorption coefficient at a position on the grid, 1/mm.
    pub(crate) fn at(&self, (cell, part): (u64, f64)) -> f64 {
        let [here, step] = self.per_mm[cell as usize];
        here + part * step
    }
}

/// The absorption of all media of a tracer, tabulated side by side, so that a wavelength finds all of them at one place in memory.
#[derive(Clone, Debug)]
pub(crate) struct Absorptions {
    pub(crate) grid: Grid,
    /// Number of the table of each medium; `None` if the medium absorbs nothing.
    table_of: Vec<Option<usize>>,
    /// Number of tables.
    tables: usize,
    /// Values by step of the grid, then by table, as in [`Absorption`].
    per_mm: Vec<[f64; 2]>,
}

impl Absorptions {
    /// Combines the tables of the media; `None` if none of them absorbs anything.
    pub(crate) fn of(grid: Grid, media: &[Option<Absorption>]) -> Option<Self> {
        let absorbing: Vec<&Absorption> = media.iter().flatten().collect();
        let number = |medium: usize| media[..medium].iter().flatten().count();
        let table_of = media.iter().enumerate().map(|(k, own)| own.as_ref().map(|_| number(k))).collect();
        let per_mm = (0..grid.count).flat_map(|cell| absorbing.iter().map(move |own| own.per_mm[cell])).collect();
        (!absorbing.is_empty()).then_some(Self { grid, table_of, tables: absorbing.len(), per_mm })
    }

    /// Number of tables.
    pub(crate) fn tables(&self) -> usize {
        self.tables
    }

    /// Returns the number of the table of a medium; `None` if it absorbs nothing.
    pub(crate) fn table_of(&self, medium: usize) -> Option<usize> {
        self.table_of[medium]
    }

    /// Absorption coefficient of a table at a position on the grid, 1/mm.
    pub(crate) fn at(&self, table: usize, (cell, part): (u64, f64)) -> f64 {
        let [here, step] = self.per_mm[cell as usize * self.tables + table];
        here + part * step
    }

    /// Fills in the absorption coefficients of a table at many positions on the grid, 1/mm.
    pub(crate) fn fill(&self, table: usize, cells: &[u64], parts: &[f64], per_mm: &mut [f64]) {
        for ((to, cell), part) in per_mm.iter_mut().zip(cells).zip(parts) {
            *to = self.at(table, (*cell, *part));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use spectra_core::Isa;

    /// The position is cell + part, whatever the wavelength; outside the band it stays at the ends.
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

    /// Side by side each medium keeps the values of its own table, bit by bit.
    #[test]
    fn media_keep_their_own_absorption() {
        let grid = Grid::over(380.0, 400.25);
        let table = |by: f64| Absorption { per_mm: (0..grid.count).map(|k| [by * k as f64, 0.1 * by]).collect() };
        let media = [None, Some(table(0.3)), None, Some(table(0.7))];
        let all = Absorptions::of(grid, &media).expect("two absorb");
        assert_eq!((all.tables(), all.table_of(0), all.table_of(3)), (2, None, Some(1)));
        let (cells, parts): (Vec<u64>, Vec<f64>) = (0..grid.count as u64).map(|k| (k, 1.0 / (k + 2) as f64)).unzip();
        let mut found = vec![0.0; cells.len()];
        for (medium, own) in media.iter().enumerate().filter_map(|(k, own)| Some((k, own.as_ref()?))) {
            all.fill(all.table_of(medium).expect("it absorbs"), &cells, &parts, &mut found);
            for ((cell, part), found) in cells.iter().zip(&parts).zip(&found) {
                assert_eq!(found.to_bits(), own.at((*cell, *part)).to_bits());
            }
        }
        assert!(Absorptions::of(grid, &[None, None]).is_none());
    }
}
