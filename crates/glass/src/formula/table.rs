//! Measured points, and a monotone cubic between them.

use thiserror::Error;

/// Reason why points cannot form a table.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum TableError {
    /// There are fewer than two points.
    #[error("a table needs at least two points")]
    TooFewPoints,
    /// The wavelength of a point is not larger than that of the point before it.
    #[error("row {row}: wavelengths must increase")]
    NotRising {
        /// Row of the point, from 1.
        row: usize,
    },
    /// A wavelength is not positive, or a value is not a number.
    #[error("row {row}: wavelength and value must be finite and the wavelength positive")]
    NotANumber {
        /// Row of the point, from 1.
        row: usize,
    },
}

/// A quantity measured at some wavelengths.
///
/// A monotone cubic interpolates between the points (F. N. Fritsch and R. E. Carlson, SIAM J. Numer. Anal. 17, 238, 1980). Its
/// slopes are those of parabolas through three points, limited as J. M. Hyman has it (SIAM J. Sci. Stat. Comput. 4, 645, 1983).
/// Its variable is 1 / lambda^2, in which the index of a glass is nearly a straight line: there is no overshoot, and the error
/// between the lines of a maker's table is a few 1e-6. Outside the points the table continues along the tangent of the last
/// one.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    wavelength_nm: Box<[f64]>,
    value: Box<[f64]>,
    /// Derivative by 1 / lambda^2 (um^2) at each point.
    slope: Box<[f64]>,
}

impl Table {
    /// Creates a table from pairs of wavelength (nm, ascending) and value.
    ///
    /// # Errors
    /// Fewer than two points, wavelengths that do not rise, numbers that are not finite.
    pub fn new(points: &[(f64, f64)]) -> Result<Table, TableError> {
        if points.len() < 2 {
            return Err(TableError::TooFewPoints);
        }
        for (i, &(w, v)) in points.iter().enumerate() {
            if !(w.is_finite() && w > 0.0 && v.is_finite()) {
                return Err(TableError::NotANumber { row: i + 1 });
            }
            if i > 0 && w <= points[i - 1].0 {
                return Err(TableError::NotRising { row: i + 1 });
            }
        }
        let (x, y): (Vec<f64>, Vec<f64>) = points.iter().map(|&(w, v)| (abscissa(w), v)).unzip();
        Ok(Table { wavelength_nm: points.iter().map(|p| p.0).collect(), slope: slopes(&x, &y).into(), value: y.into() })
    }

    /// Value at `wavelength_nm`, on the tangent outside the points.
    #[must_use]
    pub fn value(&self, wavelength_nm: f64) -> f64 {
        let last = self.wavelength_nm.len() - 1;
        let after = self.wavelength_nm.partition_point(|&w| w <= wavelength_nm);
        let x = abscissa(wavelength_nm);
        if after == 0 || after > last {
            let end = if after == 0 { 0 } else { last };
            return self.value[end] + self.slope[end] * (x - abscissa(self.wavelength_nm[end]));
        }
        let i = after - 1;
        let (x0, x1) = (abscissa(self.wavelength_nm[i]), abscissa(self.wavelength_nm[i + 1]));
        let h = x1 - x0;
        let t = (x - x0) / h;
        let s = 1.0 - t;
        let (y0, y1) = (self.value[i], self.value[i + 1]);
        y0 * s * s * (1.0 + 2.0 * t)
            + y1 * t * t * (1.0 + 2.0 * s)
            + h * t * s * (self.slope[i] * s - self.slope[i + 1] * t)
    }

    /// First and last wavelength of the points, nm.
    #[must_use]
    pub fn range_nm(&self) -> (f64, f64) {
        (self.wavelength_nm[0], self.wavelength_nm[self.wavelength_nm.len() - 1])
    }

    /// Iterates over the points: wavelength (nm) and value.
    pub fn points(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        self.wavelength_nm.iter().copied().zip(self.value.iter().copied())
    }
}

/// 1 / lambda^2, um^-2.
fn abscissa(wavelength_nm: f64) -> f64 {
    1e6 / (wavelength_nm * wavelength_nm)
}

/// Computes the slopes of a monotone cubic: those of parabolas through three points, kept between 0 and three times the smaller
/// of the neighboring secants.
fn slopes(x: &[f64], y: &[f64]) -> Vec<f64> {
    let n = x.len();
    let h: Vec<f64> = x.windows(2).map(|x| x[1] - x[0]).collect();
    let secant: Vec<f64> = (0..n - 1).map(|i| (y[i + 1] - y[i]) / h[i]).collect();
    if n == 2 {
        return vec![secant[0]; 2];
    }
    let limit = |slope: f64, a: f64, b: f64| {
        let most = 3.0 * a.abs().min(b.abs());
        if a * b <= 0.0 || slope * a <= 0.0 { 0.0 } else { slope.clamp(-most, most) }
    };
    let end = |h0: f64, h1: f64, d0: f64, d1: f64| limit(d0 + (d0 - d1) * h0 / (h0 + h1), d0, d0);
    let mut slope = vec![0.0; n];
    slope[0] = end(h[0], h[1], secant[0], secant[1]);
    slope[n - 1] = end(h[n - 2], h[n - 3], secant[n - 2], secant[n - 3]);
    for i in 1..n - 1 {
        let (d0, d1) = (secant[i - 1], secant[i]);
        slope[i] = limit((h[i] * d0 + h[i - 1] * d1) / (h[i - 1] + h[i]), d0, d1);
    }
    slope
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formula::SELLMEIER_1;

    /// A table of N-BK7 at the maker's lines reproduces the maker's formula between them.
    #[test]
    fn between_the_lines_of_a_glass() {
        let n_bk7 = SELLMEIER_1.with(&[
            1.039_612_12,
            0.006_000_698_67,
            0.231_792_344,
            0.020_017_914_4,
            1.010_469_45,
            103.560_653,
        ]);
        let points: Vec<_> =
            crate::lines::ALL.iter().map(|l| (l.wavelength_nm, n_bk7.index(l.wavelength_nm))).collect();
        let table = Table::new(&points).expect("a table");
        for (w, n) in &points {
            assert_eq!(table.value(*w), *n);
        }
        let worst = |from: u32, to: u32| {
            (from..=to).map(f64::from).map(|w| (table.value(w) - n_bk7.index(w)).abs()).fold(0.0, f64::max)
        };
        assert!(worst(366, 800) < 3e-6, "{}", worst(366, 800));
        // From s to t the lines lie far apart.
        assert!(worst(800, 1013) < 3e-5, "{}", worst(800, 1013));
    }

    #[test]
    fn is_monotone_where_the_points_are() {
        let table =
            Table::new(&[(400.0, 1.0), (410.0, 1.0), (420.0, 2.0), (430.0, 2.0), (700.0, 2.5)]).expect("a table");
        let mut previous = table.value(400.0);
        for i in 0..=3000 {
            let value = table.value(400.0 + f64::from(i) * 0.1);
            assert!(value >= previous - 1e-15 && value <= 2.5 + 1e-15);
            previous = value;
        }
    }

    #[test]
    fn bad_points_are_refused_with_their_row() {
        assert_eq!(Table::new(&[(400.0, 1.5)]), Err(TableError::TooFewPoints));
        assert_eq!(Table::new(&[(400.0, 1.5), (400.0, 1.6)]), Err(TableError::NotRising { row: 2 }));
        assert_eq!(Table::new(&[(400.0, 1.5), (500.0, f64::NAN)]), Err(TableError::NotANumber { row: 2 }));
        assert_eq!(Table::new(&[(0.0, 1.5), (500.0, 1.0)]), Err(TableError::NotANumber { row: 1 }));
    }
}
