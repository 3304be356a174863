//! Function of wavelength, whatever its origin.
//!
//! A shape does not know which quantity it describes: [`crate::Emission`], [`crate::Transmittance`], [`crate::Reflectance`] and
//! [`crate::Sensitivity`] do.

use std::sync::Arc;

use spectra_core::spectral::{BAND, Grid};
use spectra_numerics::formula::Formula;

use crate::cell;
use crate::error::{SpectrumError, check};
use crate::gaussian::{GaussianMixture, GaussianTerm};
use crate::meta::Outside;
use crate::planck::planck_radiance;
use crate::tabulated::Tabulated;

/// Function of wavelength: constant, rectangle, Gaussian, signed sum of Gaussians, black body, table, histogram or formula, or
/// a combination of others.
#[derive(Clone, Debug, PartialEq)]
pub struct SpectralFunction(Node);

#[derive(Clone, Debug, PartialEq)]
enum Node {
    Constant(f64),
    Rectangle {
        from_nm: f64,
        to_nm: f64,
    },
    Gaussian {
        center_nm: f64,
        sigma_nm: f64,
    },
    Mixture {
        terms: Arc<GaussianMixture>,
        at_least_zero: bool,
    },
    Blackbody {
        temperature_k: f64,
    },
    Tabulated(Tabulated),
    Histogram(Arc<Histogram>),
    Scaled(f64, Arc<SpectralFunction>),
    Sum(Arc<[SpectralFunction; 2]>),
    Product(Arc<[SpectralFunction; 2]>),
    Quotient(Arc<[SpectralFunction; 2]>),
    Power(Arc<[SpectralFunction; 2]>),
    /// The other shape, cut off at 0 where it is negative.
    Positive(Arc<SpectralFunction>),
    /// A formula, and whether points 1 nm apart would miss some of it.
    Function {
        formula: Arc<Formula>,
        is_fine: bool,
    },
}

/// Extreme values of a shape on 350-830 nm.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Survey {
    /// Smallest value, and its wavelength, nm.
    pub low: (f64, f64),
    /// Largest value, and its wavelength, nm.
    pub high: (f64, f64),
    /// First wavelength (nm) at which the value is not finite; `None` if all are finite.
    pub not_finite_nm: Option<f64>,
}

#[derive(Debug, PartialEq)]
struct Histogram {
    edges_nm: Vec<f64>,
    per_nm: Vec<f64>,
}

impl Histogram {
    /// Returns the value at a wavelength. A bin includes its lower edge; the last one also its upper edge.
    fn at(&self, wavelength_nm: f64) -> f64 {
        let after = self.edges_nm.partition_point(|e| *e <= wavelength_nm);
        let last = self.edges_nm.len() - 1;
        match after {
            0 => 0.0,
            n if n <= last => self.per_nm[n - 1],
            _ if wavelength_nm == self.edges_nm[last] => self.per_nm[last - 1],
            _ => 0.0,
        }
    }
}

impl SpectralFunction {
    /// Creates a function with the same `value` everywhere.
    ///
    /// # Errors
    /// [`SpectrumError::OutOfRange`] if `value` is not finite.
    pub fn constant(value: f64) -> Result<Self, SpectrumError> {
        Ok(Self(Node::Constant(check("value", "finite", value, |_| true)?)))
    }

    /// Creates a function that is 1 from `from_nm` to `to_nm`, both included, and 0 elsewhere.
    ///
    /// # Errors
    /// [`SpectrumError::OutOfRange`] unless 0 <= from < to, both finite.
    pub fn rectangle(from_nm: f64, to_nm: f64) -> Result<Self, SpectrumError> {
        let from_nm = check("lower edge, nm", "0 or more", from_nm, |w| w >= 0.0)?;
        let to_nm = check("upper edge, nm", "above the lower one", to_nm, |w| w > from_nm)?;
        Ok(Self(Node::Rectangle { from_nm, to_nm }))
    }

    /// Creates the Gaussian exp(-(x - center)^2 / (2 sigma^2)), with peak 1 and standard deviation `sigma_nm`.
    ///
    /// # Errors
    /// [`SpectrumError::OutOfRange`] unless `center_nm` and `sigma_nm` are finite and `sigma_nm` is positive.
    pub fn gaussian(center_nm: f64, sigma_nm: f64) -> Result<Self, SpectrumError> {
        let center_nm = check("center, nm", "finite", center_nm, |_| true)?;
        let sigma_nm = check("standard deviation, nm", "positive", sigma_nm, |s| s > 0.0)?;
        Ok(Self(Node::Gaussian { center_nm, sigma_nm }))
    }

    /// Creates a signed sum of Gaussian terms, which may be negative.
    #[must_use]
    pub fn mixture(terms: GaussianMixture) -> Self {
        Self(Node::Mixture { terms: Arc::new(terms), at_least_zero: false })
    }

    /// Creates a signed sum of Gaussian terms for a quantity that cannot be negative, and returns it with its largest value on
    /// 350-830 nm. Where the sum falls below 0, as a fit does at its edges, it is cut off at 0.
    ///
    /// # Errors
    /// [`SpectrumError::OutOfRange`] if the sum is nowhere positive, falls below 0 by more than a tenth of its largest value (too
    /// much for the error of a fit), or is not finite.
    pub(crate) fn positive_mixture(terms: GaussianMixture) -> Result<(Self, f64), SpectrumError> {
        let centers = terms.terms().iter().map(GaussianTerm::center_nm).filter(|c| BAND.contains(*c));
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for w in BAND.wavelengths_nm().chain(centers) {
            let v = check("value of the sum of Gaussians", "finite", terms.at(w), |_| true)?;
            (low, high) = (low.min(v), high.max(v));
        }
        check("largest value of the sum of Gaussians", "positive", high, |h| h > 0.0)?;
        check("smallest value of the sum of Gaussians over its largest", "-0.1 or more", low / high, |l| l >= -0.1)?;
        Ok((Self(Node::Mixture { terms: Arc::new(terms), at_least_zero: low < 0.0 }), high))
    }

    /// Returns the shape as an exact sum of Gaussian terms; `None` if the shape is no such sum, or is cut off at 0.
    ///
    /// Gaussians and mixtures are such sums, and so are sums, products and multiples of them.
    #[must_use]
    pub fn as_mixture(&self) -> Option<GaussianMixture> {
        match &self.0 {
            Node::Gaussian { center_nm, sigma_nm } => {
                Some(GaussianMixture::new(vec![GaussianTerm::new(1.0, *center_nm, *sigma_nm).ok()?]))
            }
            Node::Mixture { terms, at_least_zero: false } => Some(GaussianMixture::clone(terms)),
            Node::Scaled(factor, shape) => Some(shape.as_mixture()?.scaled(*factor)),
            Node::Sum(parts) => Some(parts[0].as_mixture()?.plus(&parts[1].as_mixture()?)),
            Node::Product(parts) => Some(parts[0].as_mixture()?.times(&parts[1].as_mixture()?)),
            _ => None,
        }
    }

    /// Creates the spectral radiance of a black body, W m^-2 sr^-1 nm^-1; see [`planck_radiance`].
    ///
    /// # Errors
    /// [`SpectrumError::OutOfRange`] unless the temperature is positive and at most 1e9 K.
    pub fn blackbody(temperature_k: f64) -> Result<Self, SpectrumError> {
        let temperature_k =
            check("temperature, K", "positive and at most 1e9", temperature_k, |t| t > 0.0 && t <= 1e9)?;
        Ok(Self(Node::Blackbody { temperature_k }))
    }

    /// Creates a function from a table.
    #[must_use]
    pub fn tabulated(table: Tabulated) -> Self {
        Self(Node::Tabulated(table))
    }

    /// Returns the first and last wavelength (nm) of a table that continues with constant values beyond its ends; `None` if the
    /// function is anything else.
    #[must_use]
    pub fn flat_beyond_nm(&self) -> Option<(f64, f64)> {
        match &self.0 {
            Node::Tabulated(table) if table.outside() == Outside::Constant => Some(table.range_nm()),
            Node::Scaled(_, shape) => shape.flat_beyond_nm(),
            _ => None,
        }
    }

    /// Creates a histogram as a detector measures it: `contents[i]` is the power between `edges_nm[i]` and `edges_nm[i + 1]`.
    ///
    /// The value of the function is the content divided by the width of the bin: power per nanometer.
    ///
    /// # Errors
    /// [`SpectrumError::OutOfRange`] unless there is at least one bin, one more edge than contents, the edges increase from 0
    /// or more, and all are finite.
    pub fn histogram(edges_nm: &[f64], contents: &[f64]) -> Result<Self, SpectrumError> {
        check("number of bins", "at least 1", contents.len() as f64, |n| n >= 1.0)?;
        let wanted = (contents.len() + 1) as f64;
        check("number of edges", "one more than the number of bins", edges_nm.len() as f64, |n| n == wanted)?;
        let mut before = check("edge, nm", "0 or more", edges_nm[0], |e| e >= 0.0)?;
        let mut per_nm = Vec::with_capacity(contents.len());
        for (edge, content) in edges_nm[1..].iter().zip(contents) {
            let after = check("edge, nm", "larger than the one before", *edge, |e| e > before)?;
            per_nm.push(check("content of a bin", "finite", *content, |_| true)? / (after - before));
            before = after;
        }
        Ok(Self(Node::Histogram(Arc::new(Histogram { edges_nm: edges_nm.to_vec(), per_nm }))))
    }

    /// Multiplies the shape by a number.
    ///
    /// # Errors
    /// [`SpectrumError::OutOfRange`] if `factor` is not finite.
    pub fn scaled(&self, factor: f64) -> Result<Self, SpectrumError> {
        check("factor", "finite", factor, |_| true)?;
        Ok(match &self.0 {
            Node::Scaled(before, shape) => Self(Node::Scaled(before * factor, Arc::clone(shape))),
            _ => Self(Node::Scaled(factor, Arc::new(self.clone()))),
        })
    }

    /// Returns the sum of both shapes at each wavelength.
    #[must_use]
    pub fn plus(&self, other: &Self) -> Self {
        Self(Node::Sum(Arc::new([self.clone(), other.clone()])))
    }

    /// Returns the product of both shapes at each wavelength.
    #[must_use]
    pub fn times(&self, other: &Self) -> Self {
        Self(Node::Product(Arc::new([self.clone(), other.clone()])))
    }

    /// Divides this shape by the other at each wavelength; the result is not finite where the other is 0.
    #[must_use]
    pub fn over(&self, other: &Self) -> Self {
        Self(Node::Quotient(Arc::new([self.clone(), other.clone()])))
    }

    /// Raises this shape to the power `exponent`, wavelength by wavelength; NaN where the power is not defined.
    #[must_use]
    pub fn to_the_power(&self, exponent: &Self) -> Self {
        Self(Node::Power(Arc::new([self.clone(), exponent.clone()])))
    }

    /// Returns the shape cut off at 0 where it is negative.
    #[must_use]
    pub fn at_least_zero(&self) -> Self {
        Self(Node::Positive(Arc::new(self.clone())))
    }

    /// Creates a function from a formula of the wavelength in nm.
    #[must_use]
    pub fn function(formula: Formula) -> Self {
        // A formula does not say how fine it is, so this compares sums by 1 nm with sums by eighths of a nanometer.
        let formula = Arc::new(formula);
        let shape = Self(Node::Function { formula: Arc::clone(&formula), is_fine: true });
        let (mut largest, mut apart) = (0.0_f64, 0.0_f64);
        for (w, mean) in BAND.wavelengths_nm().zip(shape.on_grid(&BAND)) {
            largest = largest.max(mean.abs());
            apart = apart.max((mean - formula.at(w)).abs());
        }
        // The threshold is the effect of the curvature of a Gaussian of two steps, 1 / (24 * 2^2), as in `is_finer_than`.
        let is_fine = apart * 96.0 > largest;
        Self(Node::Function { formula, is_fine })
    }

    /// Returns the value if it is the same everywhere; `None` for anything else.
    #[must_use]
    pub(crate) fn as_constant(&self) -> Option<f64> {
        match &self.0 {
            Node::Constant(value) => Some(*value),
            Node::Scaled(factor, shape) => Some(factor * shape.as_constant()?),
            _ => None,
        }
    }

    /// Returns the sum of the absolute values that are added up at `wavelength_nm`: the scale of the roundoff of a difference.
    #[must_use]
    pub(crate) fn magnitude(&self, wavelength_nm: f64) -> f64 {
        match &self.0 {
            Node::Scaled(factor, shape) => factor.abs() * shape.magnitude(wavelength_nm),
            Node::Sum(parts) => parts[0].magnitude(wavelength_nm) + parts[1].magnitude(wavelength_nm),
            Node::Product(parts) => parts[0].magnitude(wavelength_nm) * parts[1].magnitude(wavelength_nm),
            Node::Quotient(parts) => parts[0].magnitude(wavelength_nm) / parts[1].at(wavelength_nm).abs(),
            _ => self.at(wavelength_nm).abs(),
        }
    }

    /// Returns whether the shape contains a fit by signed Gaussians.
    #[must_use]
    pub(crate) fn has_mixture(&self) -> bool {
        match &self.0 {
            Node::Mixture { .. } => true,
            Node::Scaled(_, shape) | Node::Positive(shape) => shape.has_mixture(),
            Node::Sum(parts) | Node::Product(parts) | Node::Quotient(parts) | Node::Power(parts) => {
                parts.iter().any(Self::has_mixture)
            }
            _ => false,
        }
    }

    /// Returns the value at `wavelength_nm`; 0 for NaN.
    #[must_use]
    pub fn at(&self, wavelength_nm: f64) -> f64 {
        match &self.0 {
            _ if wavelength_nm.is_nan() => 0.0,
            Node::Constant(value) => *value,
            Node::Rectangle { from_nm, to_nm } => {
                if (*from_nm..=*to_nm).contains(&wavelength_nm) {
                    1.0
                } else {
                    0.0
                }
            }
            Node::Gaussian { center_nm, sigma_nm } => {
                let t = (wavelength_nm - center_nm) / sigma_nm;
                libm::exp(-0.5 * t * t)
            }
            Node::Mixture { terms, at_least_zero } => {
                let value = terms.at(wavelength_nm);
                if *at_least_zero { value.max(0.0) } else { value }
            }
            Node::Blackbody { temperature_k } => planck_radiance(wavelength_nm, *temperature_k),
            Node::Tabulated(table) => table.at(wavelength_nm),
            Node::Histogram(histogram) => histogram.at(wavelength_nm),
            Node::Scaled(factor, shape) => factor * shape.at(wavelength_nm),
            Node::Sum(parts) => parts[0].at(wavelength_nm) + parts[1].at(wavelength_nm),
            Node::Product(parts) => parts[0].at(wavelength_nm) * parts[1].at(wavelength_nm),
            Node::Quotient(parts) => parts[0].at(wavelength_nm) / parts[1].at(wavelength_nm),
            Node::Power(parts) => libm::pow(parts[0].at(wavelength_nm), parts[1].at(wavelength_nm)),
            // NaN stays NaN.
            Node::Positive(shape) => {
                let value = shape.at(wavelength_nm);
                if value < 0.0 { 0.0 } else { value }
            }
            Node::Function { formula, .. } => formula.at(wavelength_nm),
        }
    }

    /// Returns the values on `grid`.
    ///
    /// Normally these are the values at the points of the grid. If the shape has edges or is finer than the grid, each is the
    /// mean over a cell, from half a step below to half a step above the point. That is so for a rectangle, a histogram, a
    /// Gaussian of under two steps and a table of closer points. No power is then lost or counted twice.
    #[must_use]
    pub fn on_grid(&self, grid: &Grid) -> Vec<f64> {
        if !self.is_finer_than(grid.step_nm) {
            return grid.wavelengths_nm().map(|w| self.at(w)).collect();
        }
        let half = 0.5 * grid.step_nm;
        grid.wavelengths_nm().map(|w| self.mean(w - half, w + half)).collect()
    }

    /// Returns the mean of the function over the wavelengths from `low_nm` to `high_nm`.
    #[must_use]
    pub fn mean(&self, low_nm: f64, high_nm: f64) -> f64 {
        let mut breaks = vec![low_nm, high_nm];
        self.breaks(low_nm, high_nm, &mut breaks);
        breaks.retain(|b| (low_nm..=high_nm).contains(b));
        breaks.sort_by(f64::total_cmp);
        cell::integral(|w| self.at(w), &breaks) / (high_nm - low_nm)
    }

    /// Returns the integral from `low_nm` to `high_nm`. The quadrature has breaks at all points where a part of the shape is
    /// not smooth, and at least every `panel_nm`.
    #[must_use]
    pub fn integral(&self, low_nm: f64, high_nm: f64, panel_nm: f64) -> f64 {
        self.weighted(low_nm, high_nm, panel_nm, |_| 1.0)
    }

    /// Returns the integral of the shape times a smooth weight of the wavelength, as [`SpectralFunction::integral`] does without it.
    pub(crate) fn weighted(&self, low_nm: f64, high_nm: f64, panel_nm: f64, weight: impl Fn(f64) -> f64) -> f64 {
        let panels = ((high_nm - low_nm) / panel_nm).clamp(1.0, 1e6).ceil() as u32;
        let mut breaks: Vec<f64> =
            (0..=panels).map(|i| low_nm + (high_nm - low_nm) * f64::from(i) / f64::from(panels)).collect();
        self.breaks(low_nm, high_nm, &mut breaks);
        breaks.retain(|b| (low_nm..=high_nm).contains(b));
        breaks.sort_by(f64::total_cmp);
        cell::integral(|w| weight(w) * self.at(w), &breaks)
    }

    /// Returns the finest step between the points of a table in the function, nm: the largest of these steps if it has several
    /// tables, 0 if it has none.
    #[must_use]
    pub fn spacing_nm(&self) -> f64 {
        match &self.0 {
            Node::Tabulated(table) => table.finest_step_nm(),
            Node::Scaled(_, shape) | Node::Positive(shape) => shape.spacing_nm(),
            Node::Sum(parts) | Node::Product(parts) | Node::Quotient(parts) | Node::Power(parts) => {
                parts.iter().map(Self::spacing_nm).fold(0.0, f64::max)
            }
            _ => 0.0,
        }
    }

    /// Returns the smallest and largest value on 350-830 nm, evaluated at whole nanometers, knots, centers and edges.
    pub(crate) fn extremes(&self) -> (f64, f64) {
        let Survey { low, high, .. } = self.survey();
        (low.0, high.0)
    }

    /// Returns the smallest and largest value on 350-830 nm with their wavelengths, and the first wavelength without a finite value.
    pub(crate) fn survey(&self) -> Survey {
        let (low_nm, high_nm) = (BAND.start_nm, BAND.end_nm());
        let mut places: Vec<f64> = BAND.wavelengths_nm().collect();
        self.breaks(low_nm, high_nm, &mut places);
        let (low, high) = ((f64::INFINITY, low_nm), (f64::NEG_INFINITY, low_nm));
        let mut survey = Survey { low, high, not_finite_nm: None };
        for w in places.into_iter().filter(|w| BAND.contains(*w)) {
            let v = self.at(w);
            if v < survey.low.0 {
                survey.low = (v, w);
            }
            if v > survey.high.0 {
                survey.high = (v, w);
            }
            if !v.is_finite() && survey.not_finite_nm.is_none_or(|before| w < before) {
                survey.not_finite_nm = Some(w);
            }
        }
        survey
    }

    /// Returns whether points `step_nm` apart would miss or double some of it.
    fn is_finer_than(&self, step_nm: f64) -> bool {
        match &self.0 {
            Node::Constant(_) | Node::Blackbody { .. } => false,
            Node::Rectangle { .. } | Node::Histogram(_) => true,
            Node::Gaussian { sigma_nm, .. } => *sigma_nm < 2.0 * step_nm,
            Node::Mixture { terms, .. } => terms.terms().iter().any(|t| t.sigma_nm() < 2.0 * step_nm),
            Node::Tabulated(table) => table.finest_step_nm() < step_nm * (1.0 - 1e-9),
            Node::Scaled(_, shape) | Node::Positive(shape) => shape.is_finer_than(step_nm),
            Node::Sum(parts) | Node::Product(parts) | Node::Quotient(parts) | Node::Power(parts) => {
                parts.iter().any(|p| p.is_finer_than(step_nm))
            }
            // Judged at a step of 1 nm.
            Node::Function { is_fine, .. } => *is_fine || step_nm > BAND.step_nm,
        }
    }

    /// Adds to `out` the wavelengths between which the shape is smooth enough for a quadrature of high order.
    fn breaks(&self, low_nm: f64, high_nm: f64, out: &mut Vec<f64>) {
        match &self.0 {
            Node::Constant(_) | Node::Blackbody { .. } => {}
            Node::Rectangle { from_nm, to_nm } => out.extend([*from_nm, *to_nm]),
            Node::Gaussian { center_nm, sigma_nm } => bell_breaks(*center_nm, *sigma_nm, out),
            Node::Mixture { terms, .. } => {
                terms.terms().iter().for_each(|t| bell_breaks(t.center_nm(), t.sigma_nm(), out));
            }
            Node::Tabulated(table) => out.extend(table.knots(low_nm, high_nm)),
            Node::Histogram(histogram) => {
                let edges = &histogram.edges_nm;
                let from = edges.partition_point(|e| *e < low_nm);
                let to = edges.partition_point(|e| *e <= high_nm);
                out.extend(&edges[from..to.max(from)]);
            }
            Node::Scaled(_, shape) | Node::Positive(shape) => shape.breaks(low_nm, high_nm, out),
            Node::Sum(parts) | Node::Product(parts) | Node::Quotient(parts) | Node::Power(parts) => {
                parts.iter().for_each(|p| p.breaks(low_nm, high_nm, out));
            }
            // A formula does not say where: every eighth of a nanometer, with a limit on the number.
            Node::Function { .. } => {
                const MOST: f64 = 4096.0;
                let count = (8.0 * (high_nm - low_nm)).clamp(1.0, MOST);
                out.extend((1..count as u32).map(|i| low_nm + (high_nm - low_nm) * f64::from(i) / count));
            }
        }
    }
}

/// Adds the wavelengths at which a Gaussian is divided for a quadrature.
fn bell_breaks(center_nm: f64, sigma_nm: f64, out: &mut Vec<f64>) {
    for k in [0.0, 1.0, 2.0, 3.0, 4.5, 6.0, 9.0] {
        out.extend([center_nm - k * sigma_nm, center_nm + k * sigma_nm]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GRID: Grid = spectra_core::spectral::BAND;

    fn sum(shape: &SpectralFunction) -> f64 {
        shape.on_grid(&GRID).iter().sum::<f64>() * GRID.step_nm
    }

    /// Areas on the grid are exact: the width of a rectangle, and sigma sqrt(2 pi) of a Gaussian, however narrow and wherever
    /// between the points.
    #[test]
    fn power_on_the_grid_is_kept() {
        let root = (2.0 * std::f64::consts::PI).sqrt();
        for offset in [0.0, 0.1, 0.5, 0.77] {
            for sigma in [0.01, 0.1, 0.5, 1.9, 2.1, 20.0] {
                let g = SpectralFunction::gaussian(550.0 + offset, sigma).expect("valid");
                assert!(
                    (sum(&g) / (sigma * root) - 1.0).abs() < 1e-9,
                    "{sigma} at {offset}: {}",
                    sum(&g) / (sigma * root)
                );
            }
            let r = SpectralFunction::rectangle(500.0 + offset, 500.3 + 2.0 * offset).expect("valid");
            assert!((sum(&r) - (0.3 + offset)).abs() < 1e-12, "{}", sum(&r));
        }
        let h = SpectralFunction::histogram(&[400.0, 400.25, 401.0, 499.4], &[1.0, 0.0, 5.0]).expect("valid");
        assert!((sum(&h) - 6.0).abs() < 1e-12);
    }

    /// A product has edges where a factor has: half of a ramp under a rectangle.
    #[test]
    fn products_keep_the_edges_of_their_factors() {
        let ramp = Tabulated::new(&[500.0, 600.0], &[0.0, 1.0], crate::Outside::Zero, crate::Scale::Linear);
        let ramp = SpectralFunction::tabulated(ramp.expect("valid"));
        let half = ramp.times(&SpectralFunction::rectangle(500.0, 550.4).expect("valid"));
        assert!((sum(&half) - 50.4 * 50.4 / 200.0).abs() < 1e-9, "{}", sum(&half));
        let twice = half.plus(&half).scaled(0.5).expect("valid");
        assert!((sum(&twice) - sum(&half)).abs() < 1e-12);
    }

    #[test]
    fn a_table_finer_than_the_grid_keeps_its_power() {
        // A triangle of half width 0.2 nm between two points of the grid.
        let t = Tabulated::new(&[500.3, 500.5, 500.7], &[0.0, 4.0, 0.0], crate::Outside::Zero, crate::Scale::Linear);
        assert!((sum(&SpectralFunction::tabulated(t.expect("valid"))) - 0.8).abs() < 1e-12);
    }

    fn terms(all: &[[f64; 3]]) -> GaussianMixture {
        let term = |[a, c, s]: &[f64; 3]| GaussianTerm::new(*a, *c, *s).expect("valid");
        GaussianMixture::new(all.iter().map(term).collect())
    }

    /// A mixture is a shape like any other: narrow terms keep their integral on the grid, products stay exact.
    #[test]
    fn mixtures_are_shapes() {
        let m = terms(&[[1.0, 550.3, 0.4], [0.2, 520.0, 60.0], [-0.1, 500.0, 30.0]]);
        let shape = SpectralFunction::mixture(m.clone());
        let want = m.band_integral(349.5, 830.5);
        assert!((sum(&shape) / want - 1.0).abs() < 1e-9, "{} {want}", sum(&shape));
        let filter = SpectralFunction::gaussian(540.0, 50.0).expect("valid").scaled(0.5).expect("valid");
        let product = shape.times(&filter).plus(&shape);
        let exact = product.as_mixture().expect("made of Gaussians only");
        assert_eq!(exact.terms().len(), 6);
        for w in [400.0, 500.0, 550.0, 700.0] {
            assert!((exact.at(w) / product.at(w) - 1.0).abs() < 1e-12, "{w}");
        }
        assert!(shape.times(&SpectralFunction::constant(1.0).expect("valid")).as_mixture().is_none());
    }

    #[test]
    fn what_cannot_be_negative_is_cut_off_at_0() {
        let ripple = terms(&[[1.0, 550.0, 40.0], [-0.05, 650.0, 20.0]]);
        let (shape, high) = SpectralFunction::positive_mixture(ripple.clone()).expect("a small ripple");
        assert!(ripple.at(660.0) < 0.0 && shape.at(660.0) == 0.0 && shape.at(550.0) == ripple.at(550.0));
        assert!((high - 1.0).abs() < 1e-6 && shape.as_mixture().is_none());
        let (whole, _) = SpectralFunction::positive_mixture(terms(&[[1.0, 550.0, 40.0]])).expect("positive");
        assert!(whole.as_mixture().is_some());
        assert!(SpectralFunction::positive_mixture(terms(&[[1.0, 550.0, 40.0], [-0.2, 700.0, 20.0]])).is_err());
        assert!(SpectralFunction::positive_mixture(terms(&[[-1.0, 550.0, 40.0]])).is_err());
        assert!(SpectralFunction::positive_mixture(terms(&[])).is_err());
    }

    #[test]
    fn histogram_bins_hold_their_lower_edge() {
        let h = SpectralFunction::histogram(&[400.0, 410.0, 412.0], &[10.0, 4.0]).expect("valid");
        for (w, want) in [(399.9, 0.0), (400.0, 1.0), (409.9, 1.0), (410.0, 2.0), (412.0, 2.0), (412.1, 0.0)] {
            assert_eq!(h.at(w), want, "{w}");
        }
    }

    #[test]
    fn impossible_parameters_are_refused() {
        let nan = f64::NAN;
        assert!(SpectralFunction::constant(f64::INFINITY).is_err());
        assert!(SpectralFunction::rectangle(500.0, 500.0).is_err() && SpectralFunction::rectangle(nan, 500.0).is_err());
        assert!(SpectralFunction::gaussian(550.0, 0.0).is_err() && SpectralFunction::gaussian(nan, 1.0).is_err());
        assert!(SpectralFunction::blackbody(0.0).is_err() && SpectralFunction::blackbody(f64::INFINITY).is_err());
        assert!(
            SpectralFunction::histogram(&[400.0], &[]).is_err()
                && SpectralFunction::histogram(&[400.0, 390.0], &[1.0]).is_err()
        );
        assert!(SpectralFunction::histogram(&[400.0, 410.0], &[nan]).is_err());
    }
}
