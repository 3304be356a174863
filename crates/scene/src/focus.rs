//! The light and spatial frequency that a lens is focused with, and the record of how it was focused.

use spectra_core::spectral::{Channel, SpectralPower, SystemResponse};
use spectra_core::stage::{Imager, Source};
use std::fmt;
use std::sync::Arc;

/// Spatial frequency to focus for on a 135 frame, line pairs per mm: that of a sharp negative.
const FREQUENCY_135_PER_MM: f64 = 30.0;
/// Diagonal of a 135 frame, 36 x 24 mm.
const DIAGONAL_135_MM: f64 = 43.266_615_305_567_87;
/// Diagonal of the smallest film frame, super 8. A smaller frame counts as a part of a picture seen closely: the lens is not
/// focused any finer for it.
const SMALLEST_DIAGONAL_MM: f64 = 7.516;
/// Number of wavelengths that represent the light.
const WAVELENGTHS: usize = 12;

/// The light that a lens is focused in, and the spatial frequency to focus for.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct FocusLight {
    /// Spatial frequency at which the contrast is maximized, line pairs per mm.
    pub(crate) per_mm: f64,
    /// Wavelengths (nm) and their weights. A weight is the source times the summed response. Empty if no channel responds to the
    /// light.
    pub(crate) light: Vec<(f64, f64)>,
}

impl FocusLight {
    /// Returns the focus light for a source, an imager and the channels that make the picture.
    pub(crate) fn of(source: &dyn Source, imager: &dyn Imager, pictured: Arc<[Channel]>) -> Self {
        let size = imager.size();
        let diagonal_mm = (size.width_mm * size.width_mm + size.height_mm * size.height_mm).sqrt();
        let source = source.focus_light().clone();
        let system = SystemResponse { grid: source.grid, source, channels: pictured };
        Self {
            per_mm: FREQUENCY_135_PER_MM * (DIAGONAL_135_MM / diagonal_mm.max(SMALLEST_DIAGONAL_MM)),
            light: representatives(&system.source, &system.summed_response(), WAVELENGTHS),
        }
    }
}

impl FocusLight {
    /// Returns the wavelength, in nm, below which the fraction `share` of the light lies, from 0 to 1. `None` if no channel
    /// responds to the light.
    pub(crate) fn wavelength_nm(&self, share: f64) -> Option<f64> {
        let total: f64 = self.light.iter().map(|(_, weight)| weight).sum();
        let mut before = 0.0;
        let at = self.light.iter().find(|(_, weight)| {
            before += weight;
            share * total < before
        });
        at.or(self.light.last()).map(|(nm, _)| *nm)
    }
}

/// Chooses wavelengths that represent light seen through a response. Each stands for an equal part of the light and lies in the
/// middle of that part. A spectral line that holds several parts appears once, with the sum of their weights.
fn representatives(light: &SpectralPower, response: &[f64], count: usize) -> Vec<(f64, f64)> {
    let grid = light.grid;
    // Pieces of the band in order: start, end, and the light in it. A spectral line has no width.
    let seen: Vec<f64> = light.continuum.iter().zip(response).map(|(p, r)| p * r).collect();
    let mut pieces: Vec<[f64; 3]> = (1..grid.count)
        .map(|i| {
            let power = 0.5 * (seen[i - 1] + seen[i]) * grid.step_nm;
            [grid.wavelength_nm(i - 1), grid.wavelength_nm(i), power]
        })
        .collect();
    let line = |l: &spectra_core::spectral::Line| {
        [l.wavelength_nm, l.wavelength_nm, l.power * grid.interpolate(response, l.wavelength_nm)]
    };
    pieces.extend(light.lines.iter().map(line));
    pieces.sort_by(|a, b| (a[0] + a[1]).total_cmp(&(b[0] + b[1])));
    let total: f64 = pieces.iter().map(|p| p[2]).sum();
    if !(total > 0.0 && total.is_finite()) {
        return Vec::new();
    }
    let mut all: Vec<(f64, f64)> = Vec::new();
    let mut before = 0.0;
    let mut next = 0;
    for [from, to, power] in pieces {
        while next < count {
            let wanted = total * (next as f64 + 0.5) / count as f64;
            if !(wanted < before + power) {
                break;
            }
            let nm = from + (to - from) * ((wanted - before) / power);
            match all.last_mut() {
                Some(last) if last.0 == nm => last.1 += 1.0,
                _ => all.push((nm, 1.0)),
            }
            next += 1;
        }
        before += power;
    }
    all
}

/// Criterion by which a lens was focused.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FocusBy {
    /// No focusing: the lens stands as in its file.
    File,
    /// Focusing by first-order optics.
    Paraxial,
    /// Focusing for the smallest RMS spot radius.
    Spot,
    /// Focusing for the highest contrast at a spatial frequency.
    Contrast {
        /// Spatial frequency, line pairs per mm.
        per_mm: f64,
    },
}

impl FocusBy {
    /// Returns the name of the criterion, such as `contrast`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::File => "lens file",
            Self::Paraxial => "paraxial",
            Self::Spot => "spot",
            Self::Contrast { .. } => "contrast",
        }
    }
}

/// Record of how the lens of a scene was focused.
#[derive(Clone, Debug, PartialEq)]
pub struct Focus {
    /// Requested distance in front of the first vertex, mm; `None` if none was requested.
    pub distance_mm: Option<f64>,
    /// Criterion that was used.
    pub by: FocusBy,
    /// Reason for a difference from the request, if there is one.
    pub remark: Option<String>,
}

/// Formats a distance as a photographer says it.
fn distance(mm: f64) -> String {
    if mm >= 1000.0 && mm.is_finite() { format!("{} m", mm / 1000.0) } else { format!("{mm} mm") }
}

impl fmt::Display for Focus {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.distance_mm {
            None => return write!(f, "as the lens file has it"),
            Some(f64::INFINITY) => write!(f, "infinity")?,
            Some(mm) => write!(f, "{}", distance(mm))?,
        }
        match self.by {
            FocusBy::File => {}
            FocusBy::Paraxial => write!(f, ", paraxial")?,
            FocusBy::Spot => write!(f, ", by the smallest spot")?,
            FocusBy::Contrast { per_mm } => write!(f, ", by contrast at {} lp/mm", (per_mm * 100.0).round() / 100.0)?,
        }
        self.remark.as_ref().map_or(Ok(()), |remark| write!(f, " ({remark})"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use spectra_core::spectral::{Grid, Line};

    /// Tests equal parts of a flat spectrum, two lines with powers of 1 and 3, and one line alone.
    #[test]
    fn wavelengths_stand_for_equal_parts_of_the_light() {
        let grid = Grid { start_nm: 400.0, step_nm: 100.0, count: 5 };
        let flat = SpectralPower { continuum: vec![1.0; 5], ..SpectralPower::dark(grid) };
        let seen = representatives(&flat, &[1.0; 5], 4);
        for ((nm, weight), want) in seen.iter().zip([450.0, 550.0, 650.0, 750.0]) {
            assert!((nm - want).abs() < 1e-9 && *weight == 1.0, "{seen:?}");
        }
        let lines = [(450.0, 1.0), (610.0, 3.0)].map(|(wavelength_nm, power)| Line { wavelength_nm, power });
        let lamp = SpectralPower { lines: lines.to_vec(), ..SpectralPower::dark(grid) };
        assert_eq!(representatives(&lamp, &[1.0; 5], 8), [(450.0, 2.0), (610.0, 6.0)]);
        assert_eq!(representatives(&lamp, &[0.0, 0.0, 1.0, 1.0, 0.0], 8), [(610.0, 8.0)]);
        assert_eq!(representatives(&lamp, &[0.0; 5], 8), []);
        let both = SpectralPower { continuum: vec![0.01; 5], ..lamp };
        let seen = representatives(&both, &[1.0; 5], 8);
        // Four are from the continuum, one each from the middle of 100 nm; the first coincides with the weaker line.
        assert_eq!(seen, [(450.0, 2.0), (550.0, 1.0), (610.0, 3.0), (650.0, 1.0), (750.0, 1.0)]);
    }

    #[test]
    fn a_focus_reads_as_it_was_set() {
        let focus = |distance_mm, by| Focus { distance_mm, by, remark: None }.to_string();
        assert_eq!(focus(Some(2500.0), FocusBy::Contrast { per_mm: 30.0 }), "2.5 m, by contrast at 30 lp/mm");
        assert_eq!(focus(Some(f64::INFINITY), FocusBy::Paraxial), "infinity, paraxial");
        assert_eq!(focus(Some(770.0), FocusBy::Spot), "770 mm, by the smallest spot");
        assert_eq!(focus(None, FocusBy::File), "as the lens file has it");
    }
}
