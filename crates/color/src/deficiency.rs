//! Simulation of color vision deficiency: colors as seen by an eye that lacks one kind of cone.

/// The kind of cone that an eye lacks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Deficiency {
    /// No long-wavelength cones: reds are dark, and red and green look alike. About 1 % of men.
    Protan,
    /// No medium-wavelength cones: red and green look alike. About 1 % of men, and another 5 % in part.
    Deutan,
    /// No short-wavelength cones: blue and green look alike, and so do yellow and violet. Rare.
    Tritan,
}

impl Deficiency {
    /// Matrix from linear sRGB to the linear sRGB that this eye sees, at severity 1.
    /// Source: G. M. Machado, M. M. Oliveira, L. A. F. Fernandes, "A physiologically-based model for simulation of color vision
    /// deficiency", IEEE Transactions on Visualization and Computer Graphics 15, 1291 (2009).
    const fn matrix(self) -> [[f64; 3]; 3] {
        match self {
            Self::Protan => {
                [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]]
            }
            Self::Deutan => {
                [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]]
            }
            Self::Tritan => {
                [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]]
            }
        }
    }

    /// Converts a color in linear sRGB to the color that shows a normal eye what this eye sees, in linear sRGB. Results may lie
    /// slightly outside 0 to 1.
    #[must_use]
    pub fn simulate(self, linear_srgb: [f64; 3]) -> [f64; 3] {
        crate::matrix::apply(&self.matrix(), linear_srgb)
    }

    /// Converts 8-bit sRGB code values as [`Deficiency::simulate`] does, clipped to the gamut.
    #[must_use]
    pub fn simulate_srgb8(self, code: [u8; 3]) -> [u8; 3] {
        let srgb = crate::RgbSpace::srgb();
        let seen = self.simulate(srgb.decode(code.map(crate::from_u8)));
        srgb.encode(seen.map(|v| v.clamp(0.0, 1.0))).map(crate::to_u8)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Grays do not change (rows sum to 1), and two colors that the eye confuses come closer.
    #[test]
    fn grays_stay_and_confused_colors_meet() {
        for eye in [Deficiency::Protan, Deficiency::Deutan, Deficiency::Tritan] {
            for gray in [0, 37, 128, 255] {
                let seen = eye.simulate_srgb8([gray; 3]);
                assert!(seen.iter().all(|v| v.abs_diff(gray) <= 1), "{eye:?} {gray}: {seen:?}");
            }
        }
        let apart = |a: [u8; 3], b: [u8; 3]| a.iter().zip(b).map(|(a, b)| i32::from(a.abs_diff(b))).sum::<i32>();
        let (red, green) = ([213, 94, 0], [120, 140, 10]);
        let deutan = apart(Deficiency::Deutan.simulate_srgb8(red), Deficiency::Deutan.simulate_srgb8(green));
        assert!(2 * deutan < apart(red, green), "{deutan} of {}", apart(red, green));
        let (yellow, blue) = ([240, 230, 60], [0, 90, 200]);
        let far = apart(Deficiency::Deutan.simulate_srgb8(yellow), Deficiency::Deutan.simulate_srgb8(blue));
        assert!(far > 250, "{far}");
    }
}
