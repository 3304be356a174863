//! Spectral transmittance of a developed film: dyes or silver on its base.

use crate::stock::Stock;
use spectra_core::math::{exp, log10};
use spectra_core::spectral::BAND;
use spectra_numerics::linear;
use std::f64::consts::LN_10;

/// The spectral density of a developed film as a function of the amounts in its layers, on the band of 350-830 nm in steps of 1 nm.
///
/// Amounts of dye are in units of the stock's dye tables, above the minimum density. A silver film has one layer: its amount is the visual
/// density, including base and fog, equal at all wavelengths.
#[derive(Clone, Debug, PartialEq)]
pub struct Deposit {
    base: Vec<f64>,
    per_unit: Vec<Vec<f64>>,
}

impl Deposit {
    /// Builds the spectral density of a stock.
    #[must_use]
    pub fn of(stock: &Stock) -> Self {
        let flat = |value: f64| vec![value; BAND.count];
        let base = stock.minimum_density.as_ref().map_or_else(|| flat(0.0), |m| m.density.on_grid(&BAND));
        let dye =
            |layer: &crate::stock::Layer| layer.dye.as_ref().map_or_else(|| flat(1.0), |d| d.density.on_grid(&BAND));
        Self { base, per_unit: stock.layers.iter().map(dye).collect() }
    }

    /// Builds three separation negatives, each of which is printed separately: each absorbs only its third of the spectrum, in the order
    /// blue, green, red.
    #[must_use]
    pub(crate) fn separations() -> Self {
        let part = |record: usize| BAND.wavelengths_nm().map(|w| if third(w) == record { 1.0 } else { 0.0 }).collect();
        Self { base: vec![0.0; BAND.count], per_unit: (0..3).map(part).collect() }
    }

    /// Number of layers of the film.
    #[must_use]
    pub fn layers(&self) -> usize {
        self.per_unit.len()
    }

    /// Returns the transmittance of layer `layer` alone, without the base, if it holds `amount`; one value at each wavelength of
    /// the band.
    #[must_use]
    pub fn layer_transmittance(&self, layer: usize, amount: f64) -> Vec<f64> {
        self.per_unit[layer].iter().map(|d| exp(-LN_10 * amount * d)).collect()
    }

    /// Returns the transmittance of the base alone, at each wavelength of the band.
    #[must_use]
    pub fn base_transmittance(&self) -> Vec<f64> {
        self.base.iter().map(|d| exp(-LN_10 * d)).collect()
    }

    /// Returns the transmittance of the whole film, at each wavelength of the band; `amounts` has one value per layer.
    #[must_use]
    pub fn transmittance(&self, amounts: &[f64]) -> Vec<f64> {
        let density = |i: usize| self.base[i] + self.per_unit.iter().zip(amounts).map(|(d, a)| d[i] * a).sum::<f64>();
        (0..self.base.len()).map(|i| exp(-LN_10 * density(i))).collect()
    }

    /// Returns the light that each of several receivers measures behind a film with `amounts` in its layers. `weights` has one
    /// spectrum on the band per receiver. The light is the sum over the band of weight times transmittance.
    #[must_use]
    pub fn receiver_sums(&self, amounts: &[f64], weights: &[Vec<f64>]) -> Vec<f64> {
        let passes = self.transmittance(amounts);
        weights.iter().map(|w| w.iter().zip(&passes).map(|(w, t)| w * t).sum()).collect()
    }

    /// Finds the amounts for which each receiver measures its density in `wanted` (-log10 of its light in
    /// [`Deposit::receiver_sums`]). Newton's method starts at the amounts `start`. There are as many receivers as layers. Returns
    /// `None` if there are no such amounts.
    #[must_use]
    pub fn amounts_for(&self, wanted: &[f64], weights: &[Vec<f64>], start: &[f64]) -> Option<Vec<f64>> {
        const STEPS: usize = 60;
        let n = self.layers();
        let mut amounts = start.to_vec();
        for _ in 0..STEPS {
            let passes = self.transmittance(&amounts);
            // Rows: derivatives of each receiver's density with respect to the amounts, and the missing density.
            let (mut slopes, mut missing) = (Vec::with_capacity(n * n), Vec::with_capacity(n));
            for (weight, wanted) in weights.iter().zip(wanted) {
                let sum: f64 = weight.iter().zip(&passes).map(|(w, t)| w * t).sum();
                let slope =
                    |d: &Vec<f64>| weight.iter().zip(&passes).zip(d).map(|((w, t), d)| w * t * d).sum::<f64>() / sum;
                slopes.extend(self.per_unit.iter().map(slope));
                missing.push(wanted + log10(sum));
            }
            let step = linear::solve(&slopes, &missing)?;
            let largest = step.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
            // Far from the solution, a step is at most half a unit.
            let damping = if largest > 0.5 { 0.5 / largest } else { 1.0 };
            amounts.iter_mut().zip(&step).for_each(|(a, s)| *a += damping * s);
            if largest < 1e-12 {
                return Some(amounts);
            }
        }
        None
    }
}

/// Wavelengths at which an additive printer splits its lamp into blue, green and red, nm.
const THIRDS_NM: [f64; 2] = [500.0, 590.0];

/// Part of the lamp to which a wavelength belongs: 0 blue, 1 green, 2 red.
pub(crate) fn third(wavelength_nm: f64) -> usize {
    THIRDS_NM.iter().filter(|edge| wavelength_nm >= **edge).count()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Newton's method finds amounts of overlapping dyes with the wanted densities, and narrow receivers follow Beer's law.
    #[test]
    fn amounts_are_found_from_densities() {
        let bell = |center: f64, width: f64| -> Vec<f64> {
            BAND.wavelengths_nm().map(|w| exp(-((w - center) / width) * ((w - center) / width))).collect()
        };
        let deposit = Deposit {
            base: vec![0.1; BAND.count],
            per_unit: vec![bell(440.0, 60.0), bell(540.0, 60.0), bell(650.0, 70.0)],
        };
        let weights = [bell(440.0, 20.0), bell(540.0, 20.0), bell(640.0, 20.0)].to_vec();
        for amounts in [[0.0, 0.0, 0.0], [1.0, 0.5, 2.0], [3.0, 3.0, 3.0], [0.1, 2.5, 0.0]] {
            let wanted: Vec<f64> = deposit.receiver_sums(&amounts, &weights).into_iter().map(|v| -log10(v)).collect();
            let found = deposit.amounts_for(&wanted, &weights, &[0.5; 3]).expect("there are such amounts");
            assert!(found.iter().zip(amounts).all(|(a, b)| (a - b).abs() < 1e-9), "{amounts:?} {found:?}");
        }
        let mut narrow = vec![0.0; BAND.count];
        narrow[(540 - 350) as usize] = 1.0;
        let passes = deposit.receiver_sums(&[0.0, 1.3, 0.0], &[narrow])[0];
        assert!((-log10(passes) - 1.4).abs() < 1e-12);
    }
}
