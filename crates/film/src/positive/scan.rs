//! Scans of negatives: densities on a linear or a logarithmic scale, or inverted into a picture.

use super::{GamutLimit, PositiveError};
use crate::deposit::Deposit;
use crate::emulsion::Emulsion;
use crate::lookup::Lookup;
use crate::print::MID_GRAY;
use crate::stock::Stock;
use spectra_color::{Gamut, RgbSpace, Transfer, into_gamut};
use spectra_core::math::{exp, log, log10};
use spectra_core::spectral::BAND;
use std::f64::consts::LN_10;

/// Scale of the values that a scan returns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ScanScale {
    /// A picture to view: inverted along the film's own curves, with highlights under a soft shoulder.
    #[default]
    Picture,
    /// Density above unexposed film on the scale of Cineon files: value = (95 + density / 0.002) / 1023.
    Log,
    /// Density above unexposed film on the scale of ADX16: value = (1520 + 8000 density) / 65535.
    Adx,
    /// Density including the base: value = density / 4.
    Density,
}

/// Cineon files: code of unexposed film, density per code, and largest code (G. Kennel, "Conversion of 10-bit Log Film Data to 8-bit Linear
/// or Video Data for the Cineon Digital Film System", Eastman Kodak, 1995).
const CINEON: (f64, f64, f64) = (95.0, 0.002, 1023.0);

/// ADX16: code of unexposed film, codes per unit of density, and largest code (SMPTE ST 2065-3). The standard means Academy printing
/// density; here it is the density of the stock's own densitometry.
const ADX16: (f64, f64, f64) = (1520.0, 8000.0, 65_535.0);

/// Density that the value 1 means on the linear scale.
pub const DENSITY_OF_ONE: f64 = 4.0;

/// Log10 of exposure on either side of mid gray over which the slope is measured; both sides together are the interval of ISO 6.
const HALF_SPAN: f64 = 0.65;

/// Fraction of the slope around mid gray below which a curve is not inverted but continued in a straight line: there is more grain than
/// tone.
const LEAST_SLOPE: f64 = 0.25;

/// Steps of the inverted curves.
const STEPS: usize = 2048;

/// Light up to which a picture is proportional to the light of the scene; the shoulder takes what is brighter.
const KNEE: f64 = 0.5;

/// A scanner, set up for one film.
#[derive(Clone, Debug)]
pub(super) struct Scan {
    /// Spectral products of the scanner's channels, in the order red, green, blue; one for silver.
    pub weights: Vec<Vec<f64>>,
    scale: ScanScale,
    /// Density of unexposed film in each channel.
    clear: Vec<f64>,
    turned: Vec<Turned>,
    black: Vec<f64>,
    shoulder: Shoulder,
}

impl Scan {
    pub(super) fn new(stock: &Stock, film: &Emulsion, gray_lx_s: f64, scale: ScanScale) -> Result<Self, PositiveError> {
        // Silver is neutral: any filter measures its density.
        let weights = match stock.densitometry.products(&["red", "green", "blue"]) {
            Some(products) => products,
            None => vec![vec![1.0 / BAND.count as f64; BAND.count]],
        };
        let densities = |x: f64| read(film.deposit(), &film.neutral(x), &weights);
        let gray = log10(gray_lx_s);
        let (low, high) = (densities(gray - HALF_SPAN), densities(gray + HALF_SPAN));
        let slopes: Vec<f64> = low.iter().zip(&high).map(|(l, h)| (h - l) / (2.0 * HALF_SPAN)).collect();
        if slopes.iter().any(|s| *s < 0.05) {
            return Err(PositiveError::NoGray);
        }
        let turned: Vec<Turned> =
            (0..weights.len()).map(|i| Turned::new(|x| densities(x)[i], gray, LEAST_SLOPE * slopes[i])).collect();
        // Unexposed film is shown as black.
        let clear = densities(f64::NEG_INFINITY);
        let black: Vec<f64> = clear.iter().zip(&turned).map(|(d, t)| t.light(*d)).collect();
        if black.iter().any(|b| *b >= 0.9 * MID_GRAY) {
            return Err(PositiveError::NoGray);
        }
        let brightest = turned.iter().map(|t| t.brightest).fold(2.0, f64::max);
        Ok(Self { weights, scale, clear, turned, black, shoulder: Shoulder::to(brightest) })
    }

    /// Densities of a place through the scanner's filters.
    pub(super) fn densities(&self, film: &Deposit, amounts: &[f64]) -> Vec<f64> {
        read(film, amounts, &self.weights)
    }

    /// Converts densities to linear light for the screen. A file scale is encoded so that the file's values are those of the scale.
    pub(super) fn shown(&self, densities: &[f64]) -> [f64; 3] {
        self.shown_in(densities, GamutLimit::Screen)
    }

    /// Converts densities to linear light for the screen, or to the values of the scale themselves.
    pub(super) fn shown_in(&self, densities: &[f64], reach: GamutLimit) -> [f64; 3] {
        let written = |value: f64| if reach == GamutLimit::Open { value } else { written(value) };
        let of = |i: usize| i.min(densities.len() - 1);
        match self.scale {
            ScanScale::Picture => {
                let rgb = [0, 1, 2].map(|i| {
                    let channel = of(i);
                    let black = self.black[channel];
                    let light = self.turned[channel].light(densities[channel]);
                    // Mid gray keeps its value, black becomes 0.
                    self.shoulder.at((light - black) * MID_GRAY / (MID_GRAY - black))
                });
                if reach == GamutLimit::Open { rgb } else { into_gamut(rgb, RgbSpace::srgb(), Gamut::Desaturate) }
            }
            ScanScale::Log => {
                let (foot, step, most) = CINEON;
                let value = |d: f64, clear: f64| (foot + (d - clear) / step) / most;
                [0, 1, 2].map(|i| written(value(densities[of(i)], self.clear[of(i)])))
            }
            ScanScale::Adx => {
                let (foot, steps, most) = ADX16;
                [0, 1, 2].map(|i| written((foot + steps * (densities[of(i)] - self.clear[of(i)])) / most))
            }
            ScanScale::Density => [0, 1, 2].map(|i| written(densities[of(i)] / DENSITY_OF_ONE)),
        }
    }
}

/// Linear light that a picture file stores as `value`.
fn written(value: f64) -> f64 {
    Transfer::Srgb.decode(value.clamp(0.0, 1.0))
}

/// Inverted curve of a neutral subject: exposure over density, continued in a straight line where the curve gets flat.
#[derive(Clone, Debug)]
struct Turned {
    low: f64,
    high: f64,
    /// Log10 of light over density, between the ends.
    table: Lookup,
    ends: [f64; 2],
    /// Slope beyond the ends, density per unit of log10 of light.
    least_slope: f64,
    /// Light of the densest place of the curve.
    brightest: f64,
}

impl Turned {
    /// Inverts `density` over log10 exposure, with `gray` shown as mid gray. Parts flatter than `least_slope` are not inverted.
    fn new(density: impl Fn(f64) -> f64, gray: f64, least_slope: f64) -> Self {
        let step = 0.01;
        let slope = |x: f64| (density(x + step) - density(x - step)) / (2.0 * step);
        let end = |sign: f64| {
            let mut x = gray;
            while (x - gray).abs() < 6.0 && slope(x + sign * step) >= least_slope {
                x += sign * step;
            }
            x
        };
        let (first, last) = (end(-1.0), end(1.0));
        let (low, high) = (density(first), density(last));
        let light = |d: f64| {
            let (mut left, mut right) = (first, last);
            for _ in 0..60 {
                let middle = 0.5 * (left + right);
                if density(middle) > d { right = middle } else { left = middle }
            }
            right - gray + log10(MID_GRAY)
        };
        let values = (0..=STEPS).map(|i| light(low + (high - low) * i as f64 / STEPS as f64)).collect();
        let ends = [first, last].map(|x| x - gray + log10(MID_GRAY));
        let turned =
            Self { low, high, table: Lookup::from_values(low, high, values), ends, least_slope, brightest: 0.0 };
        Self { brightest: turned.light(density(f64::INFINITY)), ..turned }
    }

    fn light(&self, density: f64) -> f64 {
        let log10_light = if density < self.low {
            self.ends[0] + (density - self.low) / self.least_slope
        } else if density > self.high {
            self.ends[1] + (density - self.high) / self.least_slope
        } else {
            self.table.at(density)
        };
        exp(LN_10 * log10_light)
    }
}

/// A tone curve: straight up to the knee, logarithmic above, with a continuous slope, and 1 at the brightest light that the film holds.
#[derive(Clone, Copy, Debug)]
struct Shoulder {
    scale: f64,
}

impl Shoulder {
    fn to(brightest: f64) -> Self {
        // s ln(1 + (brightest - knee) / s) = 1 - knee, which rises with s.
        let reach = |s: f64| s * log(1.0 + (brightest - KNEE) / s);
        let (mut left, mut right) = (1e-9, 1e3);
        for _ in 0..200 {
            let middle = 0.5 * (left + right);
            if reach(middle) > 1.0 - KNEE { right = middle } else { left = middle }
        }
        Self { scale: right }
    }

    fn at(self, light: f64) -> f64 {
        if light <= KNEE { light } else { KNEE + self.scale * log(1.0 + (light - KNEE) / self.scale) }
    }
}

fn read(film: &Deposit, amounts: &[f64], weights: &[Vec<f64>]) -> Vec<f64> {
    film.receiver_sums(amounts, weights).into_iter().map(|v| -log10(v)).collect()
}
