//! A function given at some wavelengths.

use std::sync::Arc;

use crate::error::{SpectrumError, check};
use crate::meta::{Interpolation, Outside, Scale};
use crate::sprague;

/// Width over which the rate of a geometric extension is taken, nm.
const RATE_NM: f64 = 10.0;

/// Values at increasing wavelengths, interpolated between them, with a stated extension beyond the ends. Values given as log10
/// are interpolated as logarithms.
#[derive(Clone, Debug, PartialEq)]
pub struct Tabulated {
    wavelengths_nm: Arc<[f64]>,
    values: Arc<[f64]>,
    reading: TableInterpretation,
}

/// The way in which the numbers of a table are read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TableInterpretation {
    pub outside: Outside,
    pub scale: Scale,
    pub interpolation: Interpolation,
    pub at_least_zero: bool,
}

impl Tabulated {
    /// Creates a table from memory, linear between its points. For a table of a file, use [`crate::table::Table::column`].
    ///
    /// # Errors
    /// [`SpectrumError::OutOfRange`] for no points, unequal numbers of wavelengths and values, wavelengths that are
    /// not positive or do not increase, and values that are not finite.
    pub fn new(wavelengths_nm: &[f64], values: &[f64], outside: Outside, scale: Scale) -> Result<Self, SpectrumError> {
        check("number of points", "at least 1", wavelengths_nm.len() as f64, |n| n >= 1.0)?;
        let equal = |n| n == wavelengths_nm.len() as f64;
        check("number of values", "the number of wavelengths", values.len() as f64, equal)?;
        let mut before = 0.0;
        for w in wavelengths_nm {
            before = check("wavelength, nm", "positive and larger than the one before", *w, |w| w > before)?;
        }
        for v in values {
            check("value", "finite", *v, |_| true)?;
        }
        let reading =
            TableInterpretation { outside, scale, interpolation: Interpolation::Linear, at_least_zero: false };
        Ok(Self::from_checked(wavelengths_nm.into(), values.into(), reading))
    }

    /// Creates a table whose points a reader has checked.
    pub(crate) fn from_checked(wavelengths_nm: Arc<[f64]>, values: Arc<[f64]>, reading: TableInterpretation) -> Self {
        Self { wavelengths_nm, values, reading }
    }

    /// Wavelengths of the points, nm.
    #[must_use]
    pub fn wavelengths_nm(&self) -> &[f64] {
        &self.wavelengths_nm
    }

    /// Values of the points on the scale in which they were given, linear or log10.
    #[must_use]
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// Extension of the table beyond its ends.
    #[must_use]
    pub fn outside(&self) -> Outside {
        self.reading.outside
    }

    /// First and last wavelength, nm.
    #[must_use]
    pub fn range_nm(&self) -> (f64, f64) {
        (self.wavelengths_nm[0], self.wavelengths_nm[self.wavelengths_nm.len() - 1])
    }

    /// Smallest and largest value of the points, on a linear scale.
    #[must_use]
    pub fn extremes(&self) -> (f64, f64) {
        let fold = |a: (f64, f64), v: &f64| (a.0.min(*v), a.1.max(*v));
        let (low, high) = self.values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), fold);
        (self.linear(low), self.linear(high))
    }

    fn linear(&self, value: f64) -> f64 {
        match self.reading.scale {
            Scale::Linear => value,
            Scale::Log10 => libm::exp10(value),
        }
    }

    /// Value at `wavelength_nm`, on a linear scale; 0 for NaN.
    #[must_use]
    pub fn at(&self, wavelength_nm: f64) -> f64 {
        let (first, last) = self.range_nm();
        if wavelength_nm.is_nan() {
            return 0.0;
        }
        if wavelength_nm < first || wavelength_nm > last {
            return self.beyond(wavelength_nm, first, last);
        }
        self.linear(self.between(wavelength_nm))
    }

    /// Interpolates on the table's own scale; `wavelength_nm` lies within the range.
    fn between(&self, wavelength_nm: f64) -> f64 {
        let above = self.wavelengths_nm.partition_point(|w| *w < wavelength_nm);
        let (w1, v1) = (self.wavelengths_nm[above], self.values[above]);
        if above == 0 || w1 == wavelength_nm {
            return v1;
        }
        let (w0, v0) = (self.wavelengths_nm[above - 1], self.values[above - 1]);
        let share = (wavelength_nm - w0) / (w1 - w0);
        match self.reading.interpolation {
            Interpolation::Linear => v0 + (v1 - v0) * share,
            Interpolation::Sprague if self.reading.at_least_zero => {
                sprague::between(&self.values, above - 1, share).max(0.0)
            }
            Interpolation::Sprague => sprague::between(&self.values, above - 1, share),
        }
    }

    fn beyond(&self, wavelength_nm: f64, first: f64, last: f64) -> f64 {
        let end = if wavelength_nm < first { first } else { last };
        match self.reading.outside {
            Outside::Zero => 0.0,
            Outside::Constant => self.linear(self.between(end)),
            Outside::Geometric => {
                let inner =
                    if wavelength_nm < first { (first + RATE_NM).min(last) } else { (last - RATE_NM).max(first) };
                let (at_end, at_inner) = (self.at(end), self.at(inner));
                let ratio = at_end / at_inner;
                if !(ratio > 0.0 && ratio < 1.0) {
                    return 0.0;
                }
                at_end * libm::pow(ratio, (wavelength_nm - end) / (end - inner))
            }
        }
    }

    /// Returns the knots strictly between `low_nm` and `high_nm`.
    pub(crate) fn knots(&self, low_nm: f64, high_nm: f64) -> &[f64] {
        let from = self.wavelengths_nm.partition_point(|w| *w <= low_nm);
        let to = self.wavelengths_nm.partition_point(|w| *w < high_nm);
        &self.wavelengths_nm[from..to.max(from)]
    }

    /// Smallest distance between neighboring points, nm; infinite for a single point.
    pub(crate) fn finest_step_nm(&self) -> f64 {
        self.wavelengths_nm.windows(2).map(|w| w[1] - w[0]).fold(f64::INFINITY, f64::min)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(outside: Outside, scale: Scale) -> Tabulated {
        Tabulated::new(&[400.0, 410.0, 430.0], &[1.0, 2.0, 0.0], outside, scale).expect("valid")
    }

    #[test]
    fn linear_between_points_and_exact_at_them() {
        let t = table(Outside::Zero, Scale::Linear);
        for (w, want) in [(400.0, 1.0), (405.0, 1.5), (410.0, 2.0), (420.0, 1.0), (430.0, 0.0)] {
            assert_eq!(t.at(w), want, "{w}");
        }
    }

    #[test]
    fn logarithms_are_interpolated_as_such() {
        let t = table(Outside::Constant, Scale::Log10);
        for (w, want) in [(390.0, 10.0), (405.0, 31.622_776_601_683_793), (410.0, 100.0), (440.0, 1.0)] {
            assert!((t.at(w) / want - 1.0).abs() < 1e-14, "{w} {}", t.at(w));
        }
    }

    #[test]
    fn beyond_the_ends_it_is_as_stated() {
        for (outside, below, above) in
            [(Outside::Zero, 0.0, 0.0), (Outside::Constant, 1.0, 0.0), (Outside::Geometric, 0.5, 0.0)]
        {
            let t = table(outside, Scale::Linear);
            assert!((t.at(390.0) - below).abs() < 1e-15 && t.at(431.0) == above, "{outside:?}");
        }
        assert_eq!(table(Outside::Constant, Scale::Linear).at(f64::NAN), 0.0);
    }

    #[test]
    fn a_single_point_is_a_table() {
        let one = |outside| Tabulated::new(&[500.0], &[3.0], outside, Scale::Linear).expect("valid");
        let t = one(Outside::Geometric);
        assert_eq!((t.at(500.0), t.at(499.0), t.at(501.0)), (3.0, 0.0, 0.0));
        assert_eq!(one(Outside::Constant).at(1.0), 3.0);
    }

    #[test]
    fn faulty_points_are_refused() {
        for (w, v) in [
            (&[][..], &[][..]),
            (&[400.0, 400.0], &[1.0, 1.0]),
            (&[410.0, 400.0], &[1.0, 1.0]),
            (&[-1.0, 400.0], &[1.0, 1.0]),
            (&[400.0, f64::NAN], &[1.0, 1.0]),
            (&[400.0, 410.0], &[1.0, f64::INFINITY]),
            (&[400.0, 410.0], &[1.0]),
        ] {
            assert!(Tabulated::new(w, v, Outside::Zero, Scale::Linear).is_err(), "{w:?} {v:?}");
        }
    }
}
