//! Color profiles of four printing inks (ICC.1:2022): convert amounts of ink to colors by tables.
//!
//! The table for relative colorimetry is used if the profile has one, otherwise its first table. Paper becomes white, and the darkest ink
//! stays as dark as it is.
//! Interpolation between table entries is linear along the first ink, and tetrahedral in the cube of the other three.

use super::profile::{D50, fixed, light, long, tag};
use spectra_color::matrix::{Matrix, apply, product};
use spectra_color::{Adaptation, RgbSpace};

/// Number of inks.
const INKS: usize = 4;
/// Largest number of table entries: 33 to the fourth power.
const MOST_ENTRIES: usize = 1_185_921;
/// Number of points at which parametric and other curves are sampled.
const POINTS: usize = 4096;

/// A color profile that converts four inks to linear light.
#[derive(Clone, Debug)]
pub(super) struct InkProfile {
    /// Input curve of each ink.
    input: [Vec<f64>; INKS],
    /// Number of entries along each ink; the last ink varies fastest.
    grid: [usize; INKS],
    table: Vec<[f32; 3]>,
    /// Stages after the table: curves, and a matrix with an offset. Other curves (`output`) follow them.
    middle: Option<([Vec<f64>; 3], Matrix, [f64; 3])>,
    output: [Vec<f64>; 3],
    /// Meaning of the three output values.
    connection: Connection,
    /// Matrix from XYZ under D50 to linear light in the target space.
    to_rgb: Matrix,
}

/// Encodings of a color by the three numbers of a profile, 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Connection {
    Xyz,
    /// CIE Lab: L* up to 100, and a*, b* from -128 to 127.
    Lab,
    /// CIE Lab in the 16-bit encoding of version 2, where 0xff00 is 100 (6.3.4.2).
    OldLab,
}

impl InkProfile {
    /// Reads a profile that converts to linear light of `space`; `None` if it is of another kind or broken.
    pub(super) fn read(bytes: &[u8], space: &RgbSpace) -> Option<Self> {
        if bytes.get(36..40)? != b"acsp" || bytes.get(16..20)? != b"CMYK" {
            return None;
        }
        let of_lab = match bytes.get(20..24)? {
            b"XYZ " => false,
            b"Lab " => true,
            _ => return None,
        };
        let lut = tag(bytes, b"A2B1").or_else(|| tag(bytes, b"A2B0"))?;
        let to_rgb = product(&space.rgb_from_xyz, &Adaptation::Bradford.matrix(D50, space.white_xyz()));
        if (*lut.get(8)?, *lut.get(9)?) != (INKS as u8, 3) {
            return None;
        }
        match lut.get(..4)? {
            b"mft1" => Self::plain(lut, 1, if of_lab { Connection::Lab } else { Connection::Xyz }, to_rgb),
            b"mft2" => Self::plain(lut, 2, if of_lab { Connection::OldLab } else { Connection::Xyz }, to_rgb),
            b"mAB " => Self::staged(lut, if of_lab { Connection::Lab } else { Connection::Xyz }, to_rgb),
            _ => None,
        }
    }

    /// Reads curves, a table and curves, with `bytes` bytes per number (10.10 and 10.11). The matrix of these types applies only to XYZ
    /// input and is ignored.
    fn plain(lut: &[u8], bytes: usize, connection: Connection, to_rgb: Matrix) -> Option<Self> {
        let grid = [usize::from(*lut.get(10)?); INKS];
        let short = |at: usize| Some(usize::from(u16::from_be_bytes([*lut.get(at)?, *lut.get(at + 1)?])));
        let (entries_in, entries_out, start) = if bytes == 1 { (256, 256, 48) } else { (short(48)?, short(50)?, 52) };
        if !(2..=4096).contains(&entries_in) || !(2..=4096).contains(&entries_out) {
            return None;
        }
        let numbers = Numbers { bytes: lut, size: bytes };
        let curve =
            |at: usize, many: usize| (0..many).map(|i| numbers.at(at + i * bytes)).collect::<Option<Vec<f64>>>();
        let mut at = start;
        let mut next = |many: usize| {
            let own = curve(at, many);
            at += many * bytes;
            own
        };
        let input = [next(entries_in)?, next(entries_in)?, next(entries_in)?, next(entries_in)?];
        let table_at = start + INKS * entries_in * bytes;
        let table = numbers.table(table_at, grid)?;
        let mut at = table_at + 3 * table.len() * bytes;
        let mut next = || {
            let own = curve(at, entries_out);
            at += entries_out * bytes;
            own
        };
        let output = [next()?, next()?, next()?];
        Some(Self { input, grid, table, middle: None, output, connection, to_rgb })
    }

    /// Reads curves, a table, curves, a matrix and curves (10.12).
    fn staged(lut: &[u8], connection: Connection, to_rgb: Matrix) -> Option<Self> {
        let offset = |at: usize| long(lut, at).map(|at| at as usize);
        let [b, matrix, m, table, a] = [offset(12)?, offset(16)?, offset(20)?, offset(24)?, offset(28)?];
        if b == 0 || table == 0 || a == 0 {
            return None;
        }
        let input = curves::<INKS>(lut, a)?;
        let grid: [usize; INKS] =
            std::array::from_fn(|ink| lut.get(table.saturating_add(ink)).map_or(0, |n| usize::from(*n)));
        let size = usize::from(*lut.get(table.checked_add(16)?)?);
        if !(1..=2).contains(&size) {
            return None;
        }
        let table = Numbers { bytes: lut, size }.table(table.checked_add(20)?, grid)?;
        let middle = if m == 0 || matrix == 0 {
            None
        } else {
            let number = |i: usize| fixed(lut, matrix.checked_add(4 * i)?);
            let mut rows = [[0.0; 3]; 3];
            for (i, value) in rows.as_flattened_mut().iter_mut().enumerate() {
                *value = number(i)?;
            }
            Some((curves::<3>(lut, m)?, rows, [number(9)?, number(10)?, number(11)?]))
        };
        Some(Self { input, grid, table, middle, output: curves::<3>(lut, b)?, connection, to_rgb })
    }

    /// Converts amounts of ink, each from 0 (none) to 1, to linear light; paper is (1, 1, 1).
    pub(super) fn light(&self, inks: [f64; INKS]) -> [f64; 3] {
        let mut values = self.interpolated(std::array::from_fn(|ink| along(&self.input[ink], inks[ink])));
        if let Some((curves, matrix, offset)) = &self.middle {
            let curved = std::array::from_fn(|k| along(&curves[k], values[k]));
            let turned = apply(matrix, curved);
            values = std::array::from_fn(|k| turned[k] + offset[k]);
        }
        let values: [f64; 3] = std::array::from_fn(|k| along(&self.output[k], values[k]));
        apply(&self.to_rgb, self.connection.xyz(values))
    }

    fn interpolated(&self, place: [f64; INKS]) -> [f64; 3] {
        let (mut from, mut part) = ([0_usize; INKS], [0.0; INKS]);
        for ink in 0..INKS {
            let at = place[ink].clamp(0.0, 1.0) * (self.grid[ink] - 1) as f64;
            from[ink] = (at as usize).min(self.grid[ink] - 2);
            part[ink] = at - from[ink] as f64;
        }
        let mut step = [1_usize; INKS];
        for ink in (0..INKS - 1).rev() {
            step[ink] = step[ink + 1] * self.grid[ink + 1];
        }
        let corner: usize = (0..INKS).map(|ink| from[ink] * step[ink]).sum();
        // Tetrahedral interpolation: goes from the near corner of the cube to the far one, along the largest fraction first.
        let mut order = [1, 2, 3];
        order.sort_by(|a, b| part[*b].total_cmp(&part[*a]));
        let in_cube = |corner: usize| -> [f64; 3] {
            let mut at = corner;
            let mut sum = self.table[at].map(|v| f64::from(v) * (1.0 - part[order[0]]));
            for (k, ink) in order.iter().enumerate() {
                at += step[*ink];
                let weight = part[*ink] - order.get(k + 1).map_or(0.0, |next| part[*next]);
                sum = std::array::from_fn(|c| sum[c] + f64::from(self.table[at][c]) * weight);
            }
            sum
        };
        let [near, far] = [in_cube(corner), in_cube(corner + step[0])];
        std::array::from_fn(|c| near[c] + (far[c] - near[c]) * part[0])
    }
}

impl Connection {
    /// XYZ under D50, where white has Y = 1.
    fn xyz(self, values: [f64; 3]) -> [f64; 3] {
        /// Scale of L* in the old encoding, and of a* and b* over 255.
        const OLD: f64 = 65_535.0 / 65_280.0;
        let (scale, [l, a, b]) = match self {
            Self::Xyz => return values.map(|v| v * (1.0 + 32_767.0 / 32_768.0)),
            Self::Lab => (1.0, values),
            Self::OldLab => (OLD, values),
        };
        let (l, a, b) = (100.0 * scale * l, 255.0 * scale * a - 128.0, 255.0 * scale * b - 128.0);
        // CIE 15:2018, 8.2.1.
        let fy = (l + 16.0) / 116.0;
        let f = [fy + a / 500.0, fy, fy - b / 200.0];
        let light =
            |f: f64| if f > 6.0 / 29.0 { f * f * f } else { (f - 4.0 / 29.0) * 3.0 * (6.0 / 29.0) * (6.0 / 29.0) };
        std::array::from_fn(|k| D50[k] * light(f[k]))
    }
}

/// Numbers of one or two bytes each, scaled to 0 to 1.
struct Numbers<'a> {
    bytes: &'a [u8],
    size: usize,
}

impl Numbers<'_> {
    fn at(&self, at: usize) -> Option<f64> {
        let first = *self.bytes.get(at)?;
        Some(match self.size {
            1 => f64::from(first) / 255.0,
            _ => f64::from(u16::from_be_bytes([first, *self.bytes.get(at + 1)?])) / 65_535.0,
        })
    }

    fn table(&self, at: usize, grid: [usize; INKS]) -> Option<Vec<[f32; 3]>> {
        if grid.iter().any(|n| *n < 2) {
            return None;
        }
        let entries = grid.iter().try_fold(1_usize, |all, n| all.checked_mul(*n)).filter(|n| *n <= MOST_ENTRIES)?;
        // Checks that all entries are there before allocating.
        self.bytes.get(at..at.checked_add(3 * entries * self.size)?)?;
        let entry = |i: usize| -> Option<[f32; 3]> {
            let value = |c: usize| self.at(at + (3 * i + c) * self.size).map(|v| v as f32);
            Some([value(0)?, value(1)?, value(2)?])
        };
        (0..entries).map(entry).collect()
    }
}

/// Reads consecutive curves, each aligned to four bytes.
fn curves<const N: usize>(lut: &[u8], mut at: usize) -> Option<[Vec<f64>; N]> {
    let mut all: [Vec<f64>; N] = std::array::from_fn(|_| Vec::new());
    for curve in &mut all {
        let own = lut.get(at..)?;
        *curve = (0..POINTS)
            .map(|i| light(own, i as f64 / (POINTS - 1) as f64).filter(|v| v.is_finite()))
            .collect::<Option<_>>()?;
        let length = match own.get(..4)? {
            b"curv" => (long(own, 8)? as usize).checked_mul(2)?.checked_add(12)?,
            _ => 12 + 4 * [1, 3, 4, 5, 7].get(usize::from(*own.get(9)?))?,
        };
        at = at.checked_add(length.checked_next_multiple_of(4)?)?;
    }
    Some(all)
}

/// Interpolates a curve at a place from 0 to 1.
fn along(curve: &[f64], place: f64) -> f64 {
    let at = place.clamp(0.0, 1.0) * (curve.len() - 1) as f64;
    let from = (at as usize).min(curve.len() - 2);
    curve[from] + (curve[from + 1] - curve[from]) * (at - from as f64)
}
