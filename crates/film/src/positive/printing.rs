//! The printing light, and the exposure of a print stock through a negative.

use super::PositiveError;
use super::viewing::{Viewing, on_band};
use crate::deposit::{Deposit, third};
use crate::emulsion::Emulsion;
use crate::print::MID_GRAY;
use crate::stock::{AimDensity, Process, Stock};
use crate::viewing_options::{PictureBlack, PictureWhite, Surround, ViewingOptions};
use spectra_core::math::{log10, pow};
use spectra_core::spectral::BAND;
use spectra_numerics::linear;
use spectra_spectrum::Emission;

/// A negative in the printer.
#[derive(Clone, Debug)]
pub(super) struct Printing {
    /// Sensitivity times printing light of each print layer, over the band.
    pub weights: Vec<Vec<f64>>,
    /// The developed print stock.
    pub emulsion: Emulsion,
    /// Viewing conditions of the print.
    pub viewing: Viewing,
    /// Names of the print's layers, and the filters through which a densitometer reads each (`filters`); `None` for silver.
    pub names: Vec<String>,
    pub filters: Option<Vec<Vec<f64>>>,
}

impl Printing {
    /// Sets the printing light so that a negative of the amounts `gray` prints as a gray of the color of white.
    ///
    /// The gray is shown as [`MID_GRAY`], or in a dark surround with the visual density of the print stock's aim densities. White is the
    /// clear print or the lamp; black, if it is stretched, is the print of a negative of the amounts `unexposed`.
    ///
    /// A print stock of three layers is printed by an additive lamp house: `lamp` is split at 500 and 590 nm, and each part has its own
    /// strength. A stock of a single layer is printed by the whole `lamp`. Without a lamp, each layer is printed separately from its own
    /// separation negative.
    pub(super) fn balanced(
        negative: &Deposit,
        unexposed: &[f64],
        gray: &[f64],
        stock: &Stock,
        emulsion: Emulsion,
        lamp: Option<&Emission>,
        viewing: Viewing,
        look: ViewingOptions,
    ) -> Result<Self, PositiveError> {
        if stock.process != Process::Print {
            return Err(PositiveError::NoPrintStock { stock: stock.name.clone() });
        }
        let layers = emulsion.layers();
        let power = lamp.map(on_band);
        let part = |w: f64| if layers == 1 { 0 } else { third(w) };
        // Sensitivity of a layer to one part of the lamp.
        let sensitivity = |layer: usize, of: usize| -> Vec<f64> {
            let at = |(i, w): (usize, f64)| match &power {
                _ if part(w) != of => 0.0,
                Some(power) => stock.layers[layer].sensitivity.at(w) * power[i],
                None if layer == of => 1.0,
                None => 0.0,
            };
            BAND.wavelengths_nm().enumerate().map(at).collect()
        };
        let parts: Vec<Vec<Vec<f64>>> =
            (0..layers).map(|layer| (0..layers).map(|p| sensitivity(layer, p)).collect()).collect();
        let clear = match look.white {
            PictureWhite::Film => {
                viewing.xyz(emulsion.deposit(), &(0..layers).map(|i| emulsion.range(i).0).collect::<Vec<_>>())
            }
            PictureWhite::Lamp => viewing.white(),
        };
        let unbalanced = |reason: &'static str| PositiveError::Unbalanced { stock: stock.name.clone(), reason };
        let aim = match stock.aim_density {
            Some(aim) if look.surround == Surround::Dark => Some(
                aimed(stock, &emulsion, aim, &viewing)
                    .ok_or_else(|| unbalanced("its dyes do not reach its aim densities"))?,
            ),
            _ => None,
        };
        let (mut black, mut darkest) = (0.0, 0.0);
        let mut printing = None;
        // Black depends on the light and the light on black, but little: each pass is some hundred times closer.
        for _ in 0..8 {
            let shown = black + viewing.share_shown_as(MID_GRAY) * (clear[1] - black);
            let share = aim.unwrap_or(shown) / clear[1];
            let wanted: Vec<f64> = clear.iter().map(|w| -log10(w * share)).collect();
            let amounts = match layers {
                1 => emulsion.deposit().amounts_for(&wanted[1..2], &viewing.weights()[1..2], &[0.7]),
                _ => emulsion.deposit().amounts_for(&wanted, viewing.weights(), &vec![0.7; layers]),
            };
            let amounts = amounts.ok_or_else(|| unbalanced("its dyes cannot make a neutral gray"))?;
            let needed = amounts.iter().enumerate().map(|(i, a)| Some(pow(10.0, emulsion.log10_exposure_at(i, *a)?)));
            let needed: Vec<f64> =
                needed.collect::<Option<_>>().ok_or_else(|| unbalanced("its curves do not reach a mid gray"))?;
            let system: Vec<f64> = parts.iter().flat_map(|of_layer| negative.receiver_sums(gray, of_layer)).collect();
            let lights = linear::solve(&system, &needed).filter(|l| l.iter().all(|v| *v > 0.0 && v.is_finite()));
            let lights =
                lights.ok_or_else(|| unbalanced("no light of its printer prints this negative's gray as gray"))?;
            let weights = parts.iter().map(|of_layer| {
                (0..BAND.count).map(|i| of_layer.iter().zip(&lights).map(|(p, l)| p[i] * l).sum()).collect()
            });
            let now = Self {
                weights: weights.collect(),
                emulsion: emulsion.clone(),
                viewing: viewing.clone(),
                names: stock.layers.iter().map(|layer| layer.name.clone()).collect(),
                filters: stock.filters(),
            };
            darkest = now.viewing.xyz(now.emulsion.deposit(), &now.printed(negative, unexposed))[1];
            let next = if look.black == PictureBlack::Stretched { darkest } else { 0.0 };
            let moved = (next - black).abs();
            black = next;
            printing = Some(Self { viewing: now.viewing.clone().between(black, clear), ..now });
            if moved < 1e-9 {
                break;
            }
        }
        let printing = printing.ok_or_else(|| unbalanced("no printing light was found"))?;
        if printing.gray_luminance(negative, gray) <= darkest + 0.02 * (clear[1] - darkest) {
            return Err(unbalanced("its mid gray is hardly denser than unexposed film"));
        }
        Ok(printing)
    }

    /// Luminance of a mid gray printed to its aim, relative to the bare light.
    pub(super) fn gray_luminance(&self, negative: &Deposit, gray: &[f64]) -> f64 {
        self.viewing.xyz(self.emulsion.deposit(), &self.printed(negative, gray))[1]
    }

    /// Amounts in the print of a negative.
    pub(super) fn printed(&self, negative: &Deposit, amounts: &[f64]) -> Vec<f64> {
        let exposures = negative.receiver_sums(amounts, &self.weights);
        exposures.iter().enumerate().map(|(i, h)| self.emulsion.amount(i, log10(*h))).collect()
    }

    /// XYZ of the print of a negative, relative to the bare viewing light.
    pub(super) fn xyz(&self, negative: &Deposit, amounts: &[f64]) -> [f64; 3] {
        self.viewing.xyz(self.emulsion.deposit(), &self.printed(negative, amounts))
    }
}

impl Printing {
    /// XYZ of the print of a hole, exposed by the whole printing light.
    pub(super) fn hole(&self) -> [f64; 3] {
        let exposures = self.weights.iter().map(|w| w.iter().sum::<f64>());
        let amounts: Vec<f64> = exposures.enumerate().map(|(i, h)| self.emulsion.amount(i, log10(h))).collect();
        self.viewing.xyz(self.emulsion.deposit(), &amounts)
    }
}

/// Luminance, relative to the bare light, of a print stock with its aim densities; `None` if it cannot have them.
fn aimed(stock: &Stock, emulsion: &Emulsion, aim: AimDensity, viewing: &Viewing) -> Option<f64> {
    let names: Vec<&str> = stock.layers.iter().map(|l| l.name.as_str()).collect();
    let products = stock.densitometry.products(&names)?;
    let wanted: Vec<f64> = names.iter().map(|name| aim.of(name)).collect::<Option<_>>()?;
    let amounts = emulsion.deposit().amounts_for(&wanted, &products, &vec![0.7; names.len()])?;
    Some(viewing.xyz(emulsion.deposit(), &amounts)[1])
}
