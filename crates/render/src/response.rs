//! Weighs rays by the responses of the channels.

use crate::sums::rounded;
use spectra_core::isa::Vectorized;
use spectra_core::math::floor_index;
use spectra_core::spectral::{Channel, Grid};

/// The responses of all channels, one table each, linear between their points.
#[derive(Clone, Debug)]
pub(crate) struct Responses {
    grid: Grid,
    inverse_step: f64,
    tables: Vec<Vec<f64>>,
}

impl Responses {
    pub(crate) fn new(grid: Grid, channels: &[Channel]) -> Self {
        Self { grid, inverse_step: 1.0 / grid.step_nm, tables: channels.iter().map(|c| c.response.clone()).collect() }
    }

    pub(crate) fn channels(&self) -> usize {
        self.tables.len()
    }

    /// Returns work that writes weight times response times `scale` for each channel and ray as integers ([`rounded`]), with the values of
    /// [`Responses::weigh`]. The work reports whether all of them fit.
    pub(crate) fn count<'a>(
        &'a self,
        wavelength_nm: &'a [f64],
        weight: &'a [f64],
        scale: f64,
        out: &'a mut [Vec<i64>],
    ) -> CountAll<'a> {
        CountAll { responses: self, wavelength_nm, weight, scale, out }
    }

    /// Returns work that writes weight times response of one channel for each ray; 0 outside the band.
    pub(crate) fn weigh<'a>(
        &'a self,
        channel: usize,
        wavelength_nm: &'a [f64],
        weight: &'a [f64],
        out: &'a mut [f64],
    ) -> Weigh<'a> {
        Weigh { responses: self, table: &self.tables[channel], wavelength_nm, weight, out }
    }
}

pub(crate) struct Weigh<'a> {
    responses: &'a Responses,
    table: &'a [f64],
    wavelength_nm: &'a [f64],
    weight: &'a [f64],
    out: &'a mut [f64],
}

impl Vectorized for Weigh<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let last = self.table.len() - 2;
        let top = (self.table.len() - 1) as f64;
        for ((wavelength, weight), out) in self.wavelength_nm.iter().zip(self.weight).zip(self.out) {
            let p = (wavelength - self.responses.grid.start_nm) * self.responses.inverse_step;
            let inside = p >= 0.0 && p <= top;
            let i = (if inside { p } else { 0.0 } as usize).min(last);
            let f = p - i as f64;
            let (a, b) = (self.table[i], self.table[i + 1]);
            *out = if inside { weight * (a + (b - a) * f) } else { 0.0 };
        }
    }
}

/// Number of rays processed at a time.
const CHUNK: usize = 64;

pub(crate) struct CountAll<'a> {
    responses: &'a Responses,
    wavelength_nm: &'a [f64],
    weight: &'a [f64],
    scale: f64,
    out: &'a mut [Vec<i64>],
}

impl Vectorized for CountAll<'_> {
    type Output = bool;
    #[inline(always)]
    fn run(self) -> bool {
        let Responses { grid, inverse_step, tables } = self.responses;
        // Table index and fraction toward the next point for each wavelength, and the weight of rays inside the band.
        let (mut point, mut part, mut lit) = ([0_u32; CHUNK], [0.0; CHUNK], [0.0; CHUNK]);
        let mut good = true;
        for start in (0..self.weight.len()).step_by(CHUNK) {
            let end = (start + CHUNK).min(self.weight.len());
            let (nm, weight) = (&self.wavelength_nm[start..end], &self.weight[start..end]);
            locate(grid, *inverse_step, [nm, weight], &mut point, &mut part, &mut lit);
            for (table, out) in tables.iter().zip(self.out.iter_mut()) {
                good &= count_channel(table, &point, [&part, &lit], self.scale, &mut out[start..end]);
            }
        }
        good
    }
}

#[inline(always)]
fn locate(
    grid: &Grid,
    inverse_step: f64,
    [wavelength_nm, weight]: [&[f64]; 2],
    point: &mut [u32; CHUNK],
    part: &mut [f64; CHUNK],
    lit: &mut [f64; CHUNK],
) {
    let len = wavelength_nm.len().min(CHUNK);
    let (wavelength_nm, weight) = (&wavelength_nm[..len], &weight[..len]);
    let (last, top) = ((grid.count - 2) as f64, (grid.count - 1) as f64);
    for i in 0..len {
        let p = (wavelength_nm[i] - grid.start_nm) * inverse_step;
        let inside = (p >= 0.0) & (p <= top);
        let p = if inside { p } else { 0.0 };
        let (at, below) = floor_index(p, last);
        point[i] = at;
        part[i] = p - below;
        lit[i] = if inside { weight[i] } else { 0.0 };
    }
}

#[inline(always)]
fn count_channel(
    table: &[f64],
    point: &[u32; CHUNK],
    [part, lit]: [&[f64; CHUNK]; 2],
    scale: f64,
    out: &mut [i64],
) -> bool {
    let len = out.len().min(CHUNK);
    let mut ends = [[0.0; CHUNK]; 2];
    for i in 0..len {
        let at = point[i] as usize;
        let pair = &table[at..at + 2];
        (ends[0][i], ends[1][i]) = (pair[0], pair[1]);
    }
    let [from, to] = &ends;
    let mut bad = 0_u64;
    for i in 0..len {
        let value = lit[i] * (from[i] + (to[i] - from[i]) * part[i]);
        let (whole, fits) = rounded(value * scale);
        out[i] = whole;
        bad |= u64::from(!fits);
    }
    bad == 0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sums::Round;
    use spectra_core::Isa;

    /// All channels at once give the same bits as each channel alone, on every instruction set. A weight that is NaN or too large is
    /// reported.
    #[test]
    fn all_channels_at_once_are_each_alone() {
        let grid = Grid { start_nm: 380.0, step_nm: 5.0, count: 70 };
        let table = |k: usize| (0..grid.count).map(|i| 0.3 + ((i * 37 + k * 11) % 29) as f64).collect::<Vec<_>>();
        let own = Responses { grid, inverse_step: 1.0 / grid.step_nm, tables: (0..3).map(table).collect() };
        let many = 2 * CHUNK + 7;
        let mut nm: Vec<f64> = (0..many).map(|i| 370.0 + 2.81 * i as f64).collect();
        (nm[3], nm[4], nm[5]) = (380.0, grid.end_nm(), f64::NAN);
        let weights: Vec<f64> = (0..many).map(|i| 1.0 / (1.0 + i as f64)).collect();
        for bad in [1.0, f64::NAN, 1e300] {
            let mut weights = weights.clone();
            weights[CHUNK + 1] = bad;
            for isa in Isa::available() {
                let mut out = vec![vec![0; many]; 3];
                let good = isa.run(own.count(&nm, &weights, 1024.0, &mut out));
                assert_eq!(good, bad == 1.0);
                for (channel, found) in out.iter().enumerate() {
                    let (mut values, mut want) = (vec![0.0; many], vec![0; many]);
                    isa.run(own.weigh(channel, &nm, &weights, &mut values));
                    isa.run(Round { values: &values, scale: 1024.0, out: &mut want });
                    assert!(!good || found == &want, "{channel}");
                }
            }
        }
    }
}
