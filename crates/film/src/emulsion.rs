//! A stock with one of its developments: converts exposure to amounts of silver or dye.
//!
//! The integral densities of a sheet are separated into amounts of dye. A neutral subject gets the densities of the sheet. For other colors
//! the exposure of each layer is first shifted by the inhibition of the other layers' dyes, relative to that of a neutral subject.

use crate::cache::Cache;
use crate::curve::CharacteristicCurve;
use crate::deposit::Deposit;
use crate::lookup::{Lookup, PIXELS_A_TASK, Pair, from_octaves, octaves};
use crate::stock::{Densitometry, Process, Stock};
use rayon::prelude::*;
use spectra_core::isa::{Isa, Vectorized};
use spectra_core::math::log10;

/// A stock whose layers cannot be developed as requested.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum EmulsionError {
    /// A layer has no such development.
    #[error("layer `{layer}` has no curve for the development `{development}`; known: {known}")]
    NoCurve {
        /// Name of the layer.
        layer: String,
        /// Name of the requested development.
        development: String,
        /// Names of the layer's developments.
        known: String,
    },
    /// No amounts of the dyes give the densities of the curves.
    #[error("at log10 exposure {log10_exposure:.2} no amounts of its dyes give the densities of its curves")]
    NoAmounts {
        /// Log10 of the exposure (lx s) at which this happens.
        log10_exposure: f64,
    },
    /// The layers do not have the names that the densitometry needs.
    #[error("a film of three dyes must have layers named red, green and blue")]
    Layers,
}

/// Caches of curves sampled over the exposure, by curve and exposure factor: of one layer, and of three layers that interact.
static SAMPLED: Cache<(AmountCurve, u64), Lookup> = Cache::new();
static TOGETHER: Cache<(Emulsion, u64), [Pair; 3]> = Cache::new();

/// Dyes, the curves of a film that has them, and the weights of the three filters of its densitometry.
type Measured = (Deposit, Vec<CharacteristicCurve>, Vec<Vec<f64>>);

/// Cache of the amounts of dye in the curves of color films.
static AMOUNTS: Cache<Measured, Result<Vec<AmountCurve>, EmulsionError>> = Cache::new();

/// A stock with one development, ready to convert exposures to amounts; see [`Deposit`] for their unit.
#[derive(Clone, Debug, PartialEq)]
pub struct Emulsion {
    deposit: Deposit,
    curves: Vec<AmountCurve>,
    /// Log10 of exposure that a layer (row) loses per unit of dye in another (column); empty if layers do not interact. Negative for a
    /// reversal film, whose dye forms where silver did not develop first.
    inhibition: Vec<Vec<f64>>,
}

#[derive(Clone, Debug, PartialEq)]
enum AmountCurve {
    /// Silver: the curve itself.
    Density(CharacteristicCurve),
    /// Dye: amounts over log10 exposure, linear between samples.
    Amount(Lookup),
}

impl AmountCurve {
    #[inline(always)]
    fn at(&self, log10_exposure: f64) -> f64 {
        match self {
            Self::Density(curve) => curve.density(log10_exposure),
            Self::Amount(table) => table.at(log10_exposure),
        }
    }
}

/// Finds the amounts of dye that have the densities of `curves` above the clear film, seen through the filters `products`.
fn amounts(
    deposit: &Deposit,
    curves: &[CharacteristicCurve],
    products: &[Vec<f64>],
) -> Result<Vec<AmountCurve>, EmulsionError> {
    let layers = deposit.layers();
    let clear: Vec<f64> = deposit.receiver_sums(&vec![0.0; layers], products).into_iter().map(|v| -log10(v)).collect();
    let spans: Vec<(f64, f64)> = curves.iter().map(CharacteristicCurve::exposure_range).collect();
    let low = spans.iter().fold(f64::INFINITY, |a, s| a.min(s.0));
    let high = spans.iter().fold(f64::NEG_INFINITY, |a, s| a.max(s.1));
    let steps = (((high - low) * SAMPLES_A_DECADE).ceil() as usize).max(1);
    let mut amounts = vec![Vec::with_capacity(steps + 1); layers];
    let mut last = vec![0.0; layers];
    for i in 0..=steps {
        let x = low + (high - low) * i as f64 / steps as f64;
        let over = |c: &CharacteristicCurve| c.density(x) - c.density_range().0;
        let wanted: Vec<f64> = curves.iter().zip(&clear).map(|(c, clear)| clear + over(c)).collect();
        let found = deposit.amounts_for(&wanted, products, &last);
        last = found.ok_or(EmulsionError::NoAmounts { log10_exposure: x })?;
        amounts.iter_mut().zip(&last).for_each(|(all, one)| all.push(*one));
    }
    let table = |values: Vec<f64>| AmountCurve::Amount(Lookup::from_values(low, high, values));
    Ok(amounts.into_iter().map(table).collect())
}

/// Samples of a dye curve per decade of exposure. With a second derivative below 15 (a print film's toe), linear interpolation is accurate
/// to 15 / 8 / 200^2 = 5e-5.
const SAMPLES_A_DECADE: f64 = 200.0;

impl Emulsion {
    /// Prepares the stock with the development named `development`.
    ///
    /// # Errors
    /// [`EmulsionError`]: a layer lacks this development, or its curves cannot be converted to amounts.
    pub fn new(stock: &Stock, development: &str) -> Result<Self, EmulsionError> {
        let curve = |layer: &crate::stock::Layer| {
            layer.development(development).map(|d| d.curve.clone()).ok_or_else(|| EmulsionError::NoCurve {
                layer: layer.name.clone(),
                development: development.into(),
                known: layer.developments.iter().map(|d| d.name.as_str()).collect::<Vec<_>>().join(", "),
            })
        };
        Self::with_curves(stock, stock.layers.iter().map(curve).collect::<Result<_, _>>()?)
    }

    /// Prepares the stock with a given curve for each layer, in its densitometry.
    ///
    /// Curves of color film are densities of neutral exposures, measured through three filters, each of which sees all three dyes.
    /// They are separated into amounts: at each exposure, those amounts of the sheet's dyes that give the sheet's densities above the
    /// minimum.
    /// For neutral subjects, these curves already include the interaction of the layers. [`Emulsion::developed`] adds it for other
    /// subjects.
    ///
    /// # Errors
    /// [`EmulsionError`]: the layers have other names, or no amounts give the densities.
    pub fn with_curves(stock: &Stock, curves: Vec<CharacteristicCurve>) -> Result<Self, EmulsionError> {
        let deposit = Deposit::of(stock);
        if stock.densitometry == Densitometry::Visual {
            let curves = curves.into_iter().map(AmountCurve::Density).collect();
            return Ok(Self { deposit, curves, inhibition: Vec::new() });
        }
        let names: Vec<&str> = stock.layers.iter().map(|l| l.name.as_str()).collect();
        let products = stock.densitometry.products(&names).ok_or(EmulsionError::Layers)?;
        let key = (deposit.clone(), curves, products);
        let amounts = AMOUNTS.get_or_compute(key.clone(), || amounts(&key.0, &key.1, &key.2));
        let curves = Result::clone(&amounts)?;
        let sign = if stock.process == Process::Reversal { -1.0 } else { 1.0 };
        let signed = |row: &Vec<f64>| row.iter().map(|v| sign * v).collect();
        let inhibition = stock.interlayer.as_ref().map_or_else(Vec::new, |i| i.inhibition.iter().map(signed).collect());
        Ok(Self { deposit, curves, inhibition })
    }

    /// Prepares three separation negatives of silver, in the order blue, green, red; see [`crate::positive::Positive::from_separations`].
    #[must_use]
    pub fn separations(curves: [CharacteristicCurve; 3]) -> Self {
        let curves = curves.into_iter().map(AmountCurve::Density).collect();
        Self { deposit: Deposit::separations(), curves, inhibition: Vec::new() }
    }

    /// Spectral density of the film as a function of the amounts.
    #[must_use]
    pub fn deposit(&self) -> &Deposit {
        &self.deposit
    }

    /// Number of layers of the film.
    #[must_use]
    pub fn layers(&self) -> usize {
        self.curves.len()
    }

    /// Computes the amounts in all layers from log10 of the exposure of each (lx s), including the interaction of the layers.
    ///
    /// Each layer i develops as if its log10 exposure x_i were x_i + sum_j K_ij (n_j(x_i) - n_j(x_j)), where n_j(x) is the amount in layer
    /// j of a neutral subject.
    /// The more dye the other layers hold, the less develops. By construction, a neutral subject does not change.
    /// This models inhibitors released by couplers (C. R. Barr, J. R. Thirtle and P. W. Vittum, Photogr. Sci. Eng. 13, 74, 1969).
    #[must_use]
    pub fn developed(&self, log10_exposures: &[f64]) -> Vec<f64> {
        let own: Vec<f64> = log10_exposures.iter().enumerate().map(|(j, x)| self.amount(j, *x)).collect();
        if self.inhibition.is_empty() {
            return own;
        }
        let layer =
            |(i, x): (usize, &f64)| self.amount(i, x + self.relief(i, *x) - inhibited(&self.inhibition[i], &own));
        log10_exposures.iter().enumerate().map(layer).collect()
    }

    /// Inhibition of layer `i` by a neutral subject of log10 exposure `x`, in log10 of exposure.
    fn relief(&self, i: usize, x: f64) -> f64 {
        inhibited(&self.inhibition[i], &self.neutral(x))
    }

    /// Returns the amount in a layer for a neutral subject, at log10 of its exposure (lx s); -infinity is no exposure.
    #[must_use]
    pub fn amount(&self, layer: usize, log10_exposure: f64) -> f64 {
        self.curves[layer].at(log10_exposure)
    }

    /// Returns the amounts in all layers at the same log10 exposure (lx s) of each: a neutral subject in the light for which the film is
    /// made.
    #[must_use]
    pub fn neutral(&self, log10_exposure: f64) -> Vec<f64> {
        (0..self.layers()).map(|i| self.amount(i, log10_exposure)).collect()
    }

    /// Returns how much the amount in a layer changes with log10 of its own exposure, where the subject is neutral with this log10 exposure
    /// (lx s) and the other layers keep theirs: the slope of the curve, steepened by their inhibition.
    #[must_use]
    pub fn gradient(&self, layer: usize, log10_exposure: f64) -> f64 {
        const STEP: f64 = 0.01;
        let slope =
            |j: usize| (self.amount(j, log10_exposure + STEP) - self.amount(j, log10_exposure - STEP)) / (2.0 * STEP);
        let row = self.inhibition.get(layer).into_iter().flatten().enumerate();
        let relief: f64 = row.filter(|(j, _)| *j != layer).map(|(j, k)| k * slope(j)).sum();
        slope(layer) * (1.0 + relief)
    }

    /// Returns the smallest and largest amount in a layer.
    #[must_use]
    pub fn range(&self, layer: usize) -> (f64, f64) {
        match &self.curves[layer] {
            AmountCurve::Density(curve) => curve.density_range(),
            AmountCurve::Amount(table) => table.extremes(),
        }
    }

    /// Finds the log10 exposure (lx s) of a neutral subject that gives `amount` in a layer, by bisection; `None` if there is
    /// none.
    #[must_use]
    pub fn log10_exposure_at(&self, layer: usize, amount: f64) -> Option<f64> {
        let at = |x: f64| self.amount(layer, x) - amount;
        let (mut left, mut right) = (-12.0, 12.0);
        let rising = at(right) > at(left);
        let over = |x: f64| (at(x) > 0.0) == rising;
        if at(left) == 0.0 || at(right) == 0.0 || over(left) || !over(right) {
            return None;
        }
        loop {
            let middle = 0.5 * (left + right);
            if middle <= left || middle >= right {
                return Some(right);
            }
            if over(middle) { right = middle } else { left = middle }
        }
    }

    /// Converts the exposures of all layers (lx s; a plane per layer, of equal length) to amounts, in place, as [`Emulsion::developed`]
    /// does for one place.
    /// `effect` multiplies the exposures first, to account for reciprocity failure (see [`crate::stock::Reciprocity`]). Negative exposures
    /// and NaN count as no exposure.
    pub fn develop_all(&self, planes: &mut [Vec<f32>], effect: f64) {
        match planes {
            [a, b, c] if self.inhibition.len() == 3 => self.develop_together([a, b, c], effect),
            _ => planes.iter_mut().enumerate().for_each(|(i, plane)| self.develop(i, plane, effect)),
        }
    }

    fn develop_together(&self, [a, b, c]: [&mut Vec<f32>; 3], effect: f64) {
        let sampled = TOGETHER.get_or_compute((self.clone(), effect.to_bits()), || {
            [0, 1, 2].map(|i| {
                let own = per_octave(|x| self.amount(i, x), effect);
                Pair::new(&own, &per_octave(|x| x + self.relief(i, x), effect))
            })
        });
        let clear = [0, 1, 2].map(|i| self.amount(i, f64::NEG_INFINITY));
        let rows = [0, 1, 2].map(|i| [0, 1, 2].map(|j| self.inhibition[i].get(j).copied().unwrap_or(0.0)));
        let (isa, sampled) = (Isa::detect(), &*sampled);
        let chunks = a.par_chunks_mut(PIXELS_A_TASK).zip(b.par_chunks_mut(PIXELS_A_TASK));
        chunks.zip(c.par_chunks_mut(PIXELS_A_TASK)).for_each(|((a, b), c)| {
            isa.run(Together { emulsion: self, sampled, clear, rows: &rows, planes: [a, b, c] });
        });
    }

    /// Converts `plane`, the exposures of layer number `layer` (lx s), to amounts, in place. The other layers are taken to have
    /// the amounts of a neutral subject. `effect` multiplies the exposures first, as in [`Emulsion::develop_all`].
    pub fn develop(&self, layer: usize, plane: &mut [f32], effect: f64) {
        let curve = &self.curves[layer];
        let made = || per_octave(|log10_exposure| curve.at(log10_exposure), effect);
        let sampled = SAMPLED.get_or_compute((curve.clone(), effect.to_bits()), made);
        let unexposed = curve.at(f64::NEG_INFINITY) as f32;
        plane.par_chunks_mut(PIXELS_A_TASK).for_each(|pixels| {
            for h in pixels {
                *h = if *h > 0.0 { sampled.at(octaves(*h)) as f32 } else { unexposed };
            }
        });
    }
}

/// A run of pixels of three layers that develop together.
struct Together<'a> {
    emulsion: &'a Emulsion,
    /// Tables of each layer, by octaves of its exposure: its own amount, and its log10 exposure plus the inhibition by a neutral subject.
    sampled: &'a [Pair; 3],
    /// Amounts without exposure.
    clear: [f64; 3],
    rows: &'a [[f64; 3]; 3],
    planes: [&'a mut [f32]; 3],
}

impl Vectorized for Together<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Self { emulsion, sampled, clear, rows, planes: [a, b, c] } = self;
        for ((a, b), c) in a.iter_mut().zip(b).zip(c) {
            let exposure = [*a, *b, *c];
            let (mut own, mut held) = (clear, [0.0; 3]);
            for i in 0..3 {
                if exposure[i] > 0.0 {
                    [own[i], held[i]] = sampled[i].at(octaves(exposure[i]));
                }
            }
            for (i, to) in [a, b, c].into_iter().enumerate() {
                let is_lit = exposure[i] > 0.0;
                let amount = if is_lit { emulsion.curves[i].at(held[i] - inhibited(&rows[i], &own)) } else { clear[i] };
                *to = amount as f32;
            }
        }
    }
}

/// Inhibition of the layer with this row at these amounts, log10 of exposure.
#[inline(always)]
fn inhibited(row: &[f64], amounts: &[f64]) -> f64 {
    row.iter().zip(amounts).map(|(k, n)| k * n).sum()
}

/// Samples per octave of exposure. With a second derivative of density below 1 in octaves (a film of gradient 3 at most), linear
/// interpolation is accurate to 1 / 8 / 512^2 = 5e-7.
const STEPS_AN_OCTAVE: usize = 512;

/// Range of octaves above the smallest normal `f32` that is sampled: 2^-40 to 2^40 lx s, about 1e-12 to 1e12.
const OCTAVES: (usize, usize) = (126 - 40, 126 + 40);

/// Samples a function of log10 exposure over octaves of an `f32`.
pub(crate) fn per_octave(f: impl Fn(f64) -> f64 + Sync, effect: f64) -> Lookup {
    let (low, high) = OCTAVES;
    Lookup::new(low as f64, high as f64, (high - low) * STEPS_AN_OCTAVE, |o| f(log10(from_octaves(o) * effect)))
}
