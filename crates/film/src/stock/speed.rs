//! The speed of a stock: by a standard, by its maker's advice, or assumed; and the speed that its curves give.

use super::{Development, Process, Stock};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use spectra_core::math::{log10, pow};

/// Exposure at the speed point of a film of ISO 1, in lx s (ISO 6:1993).
const SPEED_POINT_LX_S: f64 = 0.8;
/// Distance from the speed point at which ISO 6:1993 sets the contrast of the development, log10 of exposure.
pub const ISO_6_SPAN: f64 = 1.3;
/// Average gradient of the development that ISO 6 requires: a density 0.8 above that of the speed point at this distance.
const ISO_6_GRADIENT: f64 = 0.8 / ISO_6_SPAN;

/// Density above the minimum at which the speed of a color negative is measured (ISO 5800:1987).
const COLOR_NEGATIVE_DENSITY: f64 = 0.15;
/// Densities above the minimum whose exposures are averaged for a reversal film (ISO 2240:2003).
const REVERSAL_DENSITIES: [f64; 2] = [0.2, 2.0];
/// Stops between the speed of the curves and the stated one above which a mistake is likely.
const DOUBTED_STOPS: f64 = 1.0;

/// Zero of the exposure axis of a stock's printed curves.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub(super) enum ExposureFile {
    /// Exposures are in lux-seconds of the reference illuminant.
    #[default]
    LuxSeconds,
    /// Exposures are relative, without a stated zero.
    Relative,
}

/// Kind of a stock's stated speed.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub enum SpeedKind {
    /// An ISO speed (measured by a standard).
    #[default]
    Iso,
    /// An exposure index: the maker's recommendation for the meter.
    ExposureIndex,
    /// An assumed speed that nobody measured.
    Assumed,
}

impl SpeedKind {
    /// Name of this kind in a stock file.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Iso => "iso",
            Self::ExposureIndex => "exposure-index",
            Self::Assumed => "assumed",
        }
    }
}

/// Spectral response of an exposure meter for a stock.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub enum MeterResponse {
    /// The eye's response, V(lambda).
    #[default]
    Photopic,
    /// The film's own sensitivity, in lux-seconds of its reference illuminant.
    Film,
}

impl MeterResponse {
    /// Name of this response in a stock file.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Photopic => "photopic",
            Self::Film => "film",
        }
    }
}

/// Speed that the curves of a negative give with the development of ISO 6.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Iso6 {
    /// Arithmetic speed.
    pub speed: f64,
    /// Development time, min.
    pub minutes: f64,
}

impl Stock {
    /// Returns the speed with its kind, for example `ISO 400`, `EI 250` or `ISO 25 (assumed)`; `None` if the stock has none.
    #[must_use]
    pub fn speed_text(&self) -> Option<String> {
        self.iso.map(|iso| match self.speed_kind {
            SpeedKind::Iso => format!("ISO {iso}"),
            SpeedKind::ExposureIndex => format!("EI {iso}"),
            SpeedKind::Assumed => format!("ISO {iso} (assumed)"),
        })
    }

    /// Computes the speed of a silver negative at the contrast that ISO 6 requires: 0.80 above the speed point at 1.30 to its
    /// right. Interpolates between the two developments whose contrasts lie on either side. `None` for any other stock, and if
    /// there are no two such developments.
    #[must_use]
    pub fn iso_6(&self) -> Option<Iso6> {
        let [layer] = &self.layers[..] else { return None };
        if self.process != Process::Negative {
            return None;
        }
        let measured = |d: &Development| {
            Some((d.curve.average_gradient(ISO_6_SPAN)?, d.minutes.filter(|_| !d.assumed)?, d.curve.speed_point()?))
        };
        let mut all: Vec<(f64, f64, f64)> = layer.developments.iter().filter_map(measured).collect();
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        let pair = all.windows(2).find(|w| w[0].0 <= ISO_6_GRADIENT && ISO_6_GRADIENT < w[1].0)?;
        let share = (ISO_6_GRADIENT - pair[0].0) / (pair[1].0 - pair[0].0);
        let between = |a: f64, b: f64| a + share * (b - a);
        let speed = SPEED_POINT_LX_S / pow(10.0, between(pair[0].2, pair[1].2));
        Some(Iso6 { speed, minutes: between(pair[0].1, pair[1].1) })
    }
}

impl Stock {
    /// Computes the speed that the curves of the default development give, whatever their contrast. The standard is ISO 6 for a
    /// silver negative, ISO 5800 for a color negative (the green layer and the slowest), and ISO 2240 for a reversal film (the
    /// mean of its layers). `None` for a print stock, and if a curve does not reach these densities.
    #[must_use]
    pub fn curve_speed(&self) -> Option<f64> {
        let curves: Vec<_> =
            self.layers.iter().map(|l| l.developments.first().map(|d| &d.curve)).collect::<Option<_>>()?;
        let at = |over: f64| {
            curves.iter().map(|c| c.log10_exposure_at(c.density_range().0 + over)).collect::<Option<Vec<f64>>>()
        };
        let mean = |all: &[f64]| all.iter().sum::<f64>() / all.len() as f64;
        match (self.process, curves.len()) {
            (Process::Print, _) | (_, 0) => None,
            (Process::Negative, 1) => Some(SPEED_POINT_LX_S / pow(10.0, curves[0].speed_point()?)),
            (Process::Negative, _) => {
                let points = at(COLOR_NEGATIVE_DENSITY)?;
                let green = self.layers.iter().position(|l| l.name == "green").unwrap_or(points.len() / 2);
                let slowest = points.iter().copied().fold(f64::NEG_INFINITY, f64::max);
                Some(std::f64::consts::SQRT_2 / pow(10.0, 0.5 * (points[green] + slowest)))
            }
            (Process::Reversal, _) => {
                let [low, high] = REVERSAL_DENSITIES;
                Some(10.0 / pow(10.0, 0.5 * (mean(&at(low)?) + mean(&at(high)?))))
            }
        }
    }

    /// Returns warnings about a likely mistake in the stock's file: curves more than a stop faster or slower than the stated speed.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let Some((stated, found)) = self.iso.zip(self.curve_speed()) else { return Vec::new() };
        let stops = log10(found / stated) / log10(2.0);
        if stops.abs() <= DOUBTED_STOPS {
            return Vec::new();
        }
        vec![format!(
            "its curves have the speed {}, {:.1} stops {} than the stated {stated}: are exposures in lux-seconds? `exposure: relative` slides the \
             curves to the speed",
            if found < 10.0 { format!("{found:.2}") } else { format!("{found:.0}") },
            stops.abs(),
            if stops > 0.0 { "faster" } else { "slower" }
        )]
    }

    /// Shifts all curves together until they have the stated speed; `None` if they give no speed or none is stated.
    pub(super) fn slide(&mut self) -> Option<()> {
        let by = log10(self.curve_speed()? / self.iso?);
        for development in self.layers.iter_mut().flat_map(|layer| &mut layer.developments) {
            development.curve = development.curve.slid(by);
        }
        self.slid = Some(by);
        Some(())
    }
}

impl Development {
    /// Returns the speed that this curve gives by the speed point of ISO 6, whatever its contrast.
    #[must_use]
    pub fn speed(&self) -> Option<f64> {
        Some(SPEED_POINT_LX_S / pow(10.0, self.curve.speed_point()?))
    }
}
