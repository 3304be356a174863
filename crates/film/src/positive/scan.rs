//! A negative, scanned and turned around.

use super::PositiveError;
use crate::deposit::Deposit;
use crate::emulsion::Emulsion;
use crate::print::MID_GRAY;
use crate::stock::Stock;
use spectra_color::{Gamut, RgbSpace, into_gamut};
use spectra_core::math::{exp, log10};
use spectra_core::spectral::BAND;
use std::f64::consts::LN_10;

/// Log10 of exposure on either side of mid gray over which the slope is taken: the span of ISO 6 in all.
const HALF_SPAN: f64 = 0.65;

/// A scanner, set for one film.
#[derive(Clone, Debug)]
pub(super) struct Scan {
    /// Spectral products of the scanner's channels, in the order red, green, blue; one for silver.
    pub weights: Vec<Vec<f64>>,
    gray: Vec<f64>,
    slope: Vec<f64>,
    black: Vec<f64>,
}

impl Scan {
    pub(super) fn new(stock: &Stock, film: &Emulsion, gray_lx_s: f64) -> Result<Self, PositiveError> {
        // Silver is neutral: any filter sees its density.
        let weights = match stock.densitometry.products(&["red", "green", "blue"]) {
            Some(products) => products,
            None => vec![vec![1.0 / BAND.count as f64; BAND.count]],
        };
        let densities = |x: f64| read(film.deposit(), &film.neutral(x), &weights);
        let gray = log10(gray_lx_s);
        let (low, high) = (densities(gray - HALF_SPAN), densities(gray + HALF_SPAN));
        let slope: Vec<f64> = low.iter().zip(&high).map(|(l, h)| (h - l) / (2.0 * HALF_SPAN)).collect();
        let gray = densities(gray);
        if slope.iter().any(|s| s.abs() < 0.05) {
            return Err(PositiveError::NoGray);
        }
        // What shows as black: no exposure.
        let unexposed = densities(f64::NEG_INFINITY);
        let mut scan = Self { weights, gray, slope, black: vec![0.0; 3] };
        scan.black = (0..unexposed.len()).map(|i| scan.light(i, unexposed[i])).collect();
        if scan.black.iter().any(|b| *b >= 0.9 * MID_GRAY) {
            return Err(PositiveError::NoGray);
        }
        Ok(scan)
    }

    /// Densities of a place through the scanner's filters.
    pub(super) fn densities(&self, film: &Deposit, amounts: &[f64]) -> Vec<f64> {
        read(film, amounts, &self.weights)
    }

    fn light(&self, channel: usize, density: f64) -> f64 {
        MID_GRAY * exp(LN_10 * (density - self.gray[channel]) / self.slope[channel])
    }

    /// What the screen shows of densities.
    pub(super) fn shown(&self, densities: &[f64]) -> [f64; 3] {
        let rgb = [0, 1, 2].map(|i| {
            let channel = i.min(densities.len() - 1);
            let black = self.black[channel];
            // Mid gray keeps its place, black goes to 0.
            (self.light(channel, densities[channel]) - black) * MID_GRAY / (MID_GRAY - black)
        });
        into_gamut(rgb, RgbSpace::srgb(), Gamut::Desaturate)
    }
}

fn read(film: &Deposit, amounts: &[f64], weights: &[Vec<f64>]) -> Vec<f64> {
    film.seen(amounts, weights).into_iter().map(|v| -log10(v)).collect()
}
