//! The color model `fraunhofer`: each channel is one spectral line, given by its short name or its wavelength.

use crate::Basis;
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::params::{Faults, Params, Wavelength};
use spectra_core::registry::Context;
use spectra_core::spectral::{Grid, Line, SpectralPower};
use spectra_core::stage::ColorModel;
use spectra_spectrum::LineOrWavelength;

/// One spectral line per channel, with optional secondary lines between them.
///
/// The picture consists of spectral lines only, so lateral color shows as three sharp pictures on top of each other. The
/// usual lines are C' (643.85 nm), e (546.07 nm) and g (435.84 nm). A line is written as its short name (`C'` in quotes:
/// `"C'"`) or as a wavelength, and the three must lie in the order blue, green, red.
///
/// `secondary` lines fill the gaps: the power of each channel is linear between its own line and those of its
/// neighbors, and zero at the cuts. They change the colors of a picture, because a gray patch also gets light between
/// the lines.
///
/// # Example
/// ```yaml
/// {kind: fraunhofer, R: "C'", G: e, B: g}
/// ```
/// ```yaml
/// {kind: fraunhofer, R: C, G: d, B: F, secondary: [610 nm, 520 nm], balance: false}
/// ```
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct FraunhoferParams {
    /// Line of the red channel: a short name such as `C'`, or a wavelength, nm if bare; C' if left out.
    #[serde(rename = "R")]
    red: Option<LineOrWavelength>,
    /// Line of the green channel: a short name, or a wavelength, nm if bare; e if left out.
    #[serde(rename = "G")]
    green: Option<LineOrWavelength>,
    /// Line of the blue channel: a short name, or a wavelength, nm if bare; g if left out.
    #[serde(rename = "B")]
    blue: Option<LineOrWavelength>,
    /// Further lines, by name or wavelength, nm if bare. Their power is linear between the three main lines and zero at the cuts. No
    /// further lines if left out.
    #[serde(default)]
    secondary: Vec<LineOrWavelength>,
    /// Wavelength at which the ultraviolet ends and secondary lines have no power, nm if bare; 380 nm if left out.
    #[serde(rename = "uv-cut")]
    uv_cut: Option<Wavelength>,
    /// Wavelength at which the infrared begins and secondary lines have no power, nm if bare; 780 nm if left out.
    #[serde(rename = "ir-cut")]
    ir_cut: Option<Wavelength>,
    /// Whether the lines are scaled so that white has the illuminant's chromaticity; if not, each has the power 1.
    #[serde(default = "yes")]
    balance: bool,
}

fn yes() -> bool {
    true
}

const UV_CUT_NM: f64 = 380.0;
const IR_CUT_NM: f64 = 780.0;

spectra_core::register!(color "fraunhofer": FraunhoferParams, build);

fn build(params: &Params, context: &Context<'_>) -> Result<Box<dyn ColorModel>, Faults> {
    let p: FraunhoferParams = params.parse()?;
    let mut faults = Faults::new();
    let nm = |line: Option<LineOrWavelength>, default| line.map_or_else(|| named(default), LineOrWavelength::nm);
    let [red, green, blue] = [nm(p.red, "C'"), nm(p.green, "e"), nm(p.blue, "g")];
    let secondary: Vec<f64> = p.secondary.iter().map(|line| line.nm()).collect();
    if !(blue < green && green < red) {
        faults.push(params.fault("R", "the lines must lie in the order blue, green, red"));
    }
    let (uv, ir) = (p.uv_cut.map_or(UV_CUT_NM, |w| w.nm()), p.ir_cut.map_or(IR_CUT_NM, |w| w.nm()));
    faults.into_result(())?;
    let spectra =
        [0, 1, 2].map(|channel| channel_lines([red, green, blue], &secondary, [uv, ir], channel, context.grid));
    match context.illuminant.filter(|_| p.balance) {
        None => Ok(Box::new(Basis::new(&spectra))),
        Some(white) => match Basis::balanced(spectra, white) {
            Some(basis) => Ok(Box::new(basis)),
            None => {
                let fault = params.fault("R", "no mixture of these lines has the color of the illuminant");
                Err(fault.hint("choose lines further apart, another illuminant, or `balance: false`").into())
            }
        },
    }
}

fn named(symbol: &str) -> f64 {
    spectra_spectrum::named_line(symbol).map_or(0.0, |line| line.nominal_nm)
}

/// Returns the lines of one channel at full value: its own line with power 1, and the channel's part of each secondary line.
fn channel_lines(
    [red, green, blue]: [f64; 3],
    secondary: &[f64],
    [uv, ir]: [f64; 2],
    channel: usize,
    grid: Grid,
) -> SpectralPower {
    let own = [red, green, blue][channel];
    // Knots of the interpolation; at the cuts the power is zero.
    let knots = [(uv.min(blue), 0.0), (blue, 2.0), (green, 1.0), (red, 0.0), (ir.max(red), 0.0)];
    let value = |knot: usize| if (1..=3).contains(&knot) && knots[knot].1 == channel as f64 { 1.0 } else { 0.0 };
    let mut lines = vec![Line { wavelength_nm: own, power: 1.0 }];
    for &nm in secondary {
        for knot in 0..4 {
            let (a, b) = (knots[knot].0, knots[knot + 1].0);
            if nm > a && nm < b {
                let part = (nm - a) / (b - a);
                let power = value(knot) * (1.0 - part) + value(knot + 1) * part;
                lines.push(Line { wavelength_nm: nm, power });
            }
        }
    }
    SpectralPower { lines, ..SpectralPower::dark(grid) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use spectra_core::spectral::BAND;

    /// The example of the dispersion study: (255, 0, 0) with R = C', G = e, B = g and secondaries F, D gives the powers 1 0 0 0
    /// 0.44211495 of C' e g F D.
    #[test]
    fn red_with_secondaries_reaches_into_the_yellow() {
        let [red, green, blue, f, d] = ["C'", "e", "g", "F", "D"].map(named);
        let spectrum = channel_lines([red, green, blue], &[f, d], [380.0, 780.0], 0, BAND);
        let power = |nm: f64| spectrum.lines.iter().filter(|l| l.wavelength_nm == nm).map(|l| l.power).sum::<f64>();
        let got = [red, green, blue, f, d].map(power);
        for (got, want) in got.iter().zip([1.0, 0.0, 0.0, 0.0, 0.442_114_95]) {
            assert!((got - want).abs() < 5e-9, "{got} {want}");
        }
    }
}
