//! Converts a color to three spectral lines, with secondary lines between them, and back.
//!
//! Each channel is one line. A secondary line has the value that is interpolated linearly, by wavelength, between its two
//! neighbors among the three, or between the outermost line and a cut, where the value is 0. On the way back each secondary
//! line is split between the same neighbors. That is not an inverse: for a red, the yellow line gives a part to green that was
//! never there. Because of this phantom, lines with secondaries are not the default.

use crate::emission::Emission;
use crate::error::{SpectrumError, check};
use spectra_core::spectral::Line;

/// Spectral lines for red, green and blue, and secondary lines between them.
#[derive(Clone, Debug, PartialEq)]
pub struct LineColor {
    /// Wavelengths of red, green and blue, then of the secondary lines in the order given, nm.
    lines_nm: Vec<f64>,
    /// Shares of each line that a full red, green and blue contribute.
    shares: Vec<[f64; 3]>,
}

impl LineColor {
    /// Creates the model from three lines (red, green, blue, at wavelengths in any order) and secondary lines, all in nm. The
    /// power of a secondary line is interpolated between red, green and blue. It falls to 0 at `cuts_nm`, the ultraviolet and the
    /// infrared cut (nm), and is 0 beyond them.
    ///
    /// # Errors
    /// [`SpectrumError::OutOfRange`] unless all wavelengths are positive, no line occurs twice, and red, green and blue lie
    /// between the cuts.
    pub fn new(rgb_nm: [f64; 3], secondary_nm: &[f64], cuts_nm: [f64; 2]) -> Result<Self, SpectrumError> {
        let lines_nm: Vec<f64> = rgb_nm.iter().chain(secondary_nm).copied().collect();
        for (i, nm) in lines_nm.iter().enumerate() {
            check("wavelength of a line, nm", "positive", *nm, |w| w > 0.0)?;
            check("wavelength of a line, nm", "given only once", *nm, |w| !lines_nm[..i].contains(&w))?;
        }
        let mut order = [0, 1, 2];
        order.sort_by(|a, b| rgb_nm[*a].total_cmp(&rgb_nm[*b]));
        let [low, _, high] = order.map(|c| rgb_nm[c]);
        check("ultraviolet cut, nm", "below the lines of the channels", cuts_nm[0], |w| w < low)?;
        check("infrared cut, nm", "above the lines of the channels", cuts_nm[1], |w| w > high)?;
        // Knots of the interpolation, each with its channel, if any.
        let [a, b, c] = order.map(|channel| (rgb_nm[channel], Some(channel)));
        let knots = [(cuts_nm[0], None), a, b, c, (cuts_nm[1], None)];
        let shares = lines_nm.iter().map(|nm| share(*nm, &knots)).collect();
        Ok(Self { lines_nm, shares })
    }

    /// Returns the wavelengths of all lines, nm: red, green and blue, then the secondary lines.
    #[must_use]
    pub fn lines_nm(&self) -> &[f64] {
        &self.lines_nm
    }

    /// Returns the value of each line for linear RGB, in the order of [`LineColor::lines_nm`]; 1 is full intensity (255 of 8
    /// bits).
    #[must_use]
    pub fn values(&self, linear_rgb: [f64; 3]) -> Vec<f64> {
        self.shares.iter().map(|share| share.iter().zip(linear_rgb).map(|(s, v)| s * v).sum()).collect()
    }

    /// Returns the light of linear RGB: lines whose powers are [`LineColor::values`].
    ///
    /// # Errors
    /// [`SpectrumError::OutOfRange`] if a value is negative or not finite.
    pub fn light(&self, linear_rgb: [f64; 3]) -> Result<Emission, SpectrumError> {
        let lines = self.lines_nm.iter().zip(self.values(linear_rgb));
        Emission::new(None, lines.map(|(nm, power)| Line { wavelength_nm: *nm, power }).collect())
    }

    /// Converts line values, in the order of [`LineColor::lines_nm`], to linear RGB. The value of each secondary line is split
    /// between its neighbors by distance, and white stays white.
    ///
    /// Missing values count as 0.
    #[must_use]
    pub fn rgb(&self, values: &[f64]) -> [f64; 3] {
        let split = |values: &[f64]| {
            let mut rgb = [0.0; 3];
            for (value, share) in values.iter().zip(&self.shares) {
                rgb.iter_mut().zip(share).for_each(|(sum, s)| *sum += value * s);
            }
            rgb
        };
        let white = split(&self.values([1.0; 3]));
        let rgb = split(values);
        [0, 1, 2].map(|c| rgb[c] / white[c])
    }
}

/// Returns the contribution of each channel to a line at `nm`, linear between the knots.
fn share(nm: f64, knots: &[(f64, Option<usize>); 5]) -> [f64; 3] {
    let mut share = [0.0; 3];
    for pair in knots.windows(2) {
        let [(a, below), (b, above)] = [pair[0], pair[1]];
        if (a..=b).contains(&nm) {
            let part = (nm - a) / (b - a);
            for (channel, part) in [(below, 1.0 - part), (above, part)] {
                if let Some(channel) = channel {
                    share[channel] = part;
                }
            }
        }
    }
    share
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{line_set, named_line};
    use spectra_color::from_u8;

    fn study() -> LineColor {
        let nm = |symbol| named_line(symbol).expect("named").nominal_nm;
        LineColor::new(["C'", "e", "g"].map(nm), &["F", "D"].map(nm), [380.0, 780.0]).expect("valid")
    }

    /// Example of the dispersion study: (255, 0, 0) with R = C', G = e, B = g and secondaries F, D.
    #[test]
    fn lines_of_red() {
        let lines = study();
        assert_eq!(lines.lines_nm(), [643.85, 546.07, 435.84, 486.13, 589.3]);
        let values = lines.values([from_u8(255), from_u8(0), from_u8(0)]);
        for (got, want) in values.iter().zip([1.0, 0.0, 0.0, 0.0, 0.442_114_95]) {
            assert!((got - want).abs() < 0.5e-8, "{values:?}");
        }
    }

    /// On the way back a part of the yellow line goes to green: more than 30 of 255 that was never there.
    #[test]
    fn phantom_green() {
        let lines = study();
        let [red, green, blue] = lines.rgb(&lines.values([1.0, 0.0, 0.0])).map(|v| 255.0 * v);
        println!("red comes back as {red:.1} {green:.1} {blue:.1}");
        assert!(green > 30.0 && green < 35.0 && red > 200.0 && blue == 0.0);
        // Without secondaries there is no phantom, and white comes back as white in any case.
        let three = LineColor::new([643.85, 546.07, 435.84], &[], [380.0, 780.0]).expect("valid");
        assert_eq!(three.rgb(&three.values([1.0, 0.0, 0.3])), [1.0, 0.0, 0.3]);
        for back in lines.rgb(&lines.values([0.6; 3])) {
            assert!((back - 0.6).abs() < 1e-15);
        }
    }

    /// A line halfway to a cut has half the value, and 0 beyond it. Channels may lie in any order.
    #[test]
    fn cuts_are_zero_and_any_assignment_goes() {
        let lines =
            LineColor::new([450.0, 650.0, 550.0], &[400.0, 700.0, 800.0, 600.0], [350.0, 750.0]).expect("valid");
        assert_eq!(lines.values([1.0, 0.5, 0.25]), [1.0, 0.5, 0.25, 0.5, 0.25, 0.0, 0.375]);
        let light = lines.light([1.0, 0.5, 0.25]).expect("positive");
        assert_eq!((light.lines()[3].wavelength_nm, light.lines()[3].power), (400.0, 0.5));
        assert!(lines.light([-1.0, 0.0, 0.0]).is_err());
    }

    #[test]
    fn impossible_lines_are_refused() {
        let [blue, green, red] = line_set("F'eC'").expect("known").map(|l| l.nominal_nm);
        assert!(LineColor::new([red, green, green], &[], [380.0, 780.0]).is_err());
        assert!(LineColor::new([red, green, blue], &[green], [380.0, 780.0]).is_err());
        assert!(LineColor::new([red, green, blue], &[f64::NAN], [380.0, 780.0]).is_err());
        assert!(LineColor::new([red, green, blue], &[], [500.0, 780.0]).is_err());
        assert!(LineColor::new([red, green, blue], &[], [380.0, 600.0]).is_err());
    }
}
