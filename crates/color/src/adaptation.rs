//! Chromatic adaptation: finds the color that looks the same under another white.

use crate::matrix::{Matrix, apply, inverse, product};

/// A von Kries transform, named by the cone-like responses in which whites are scaled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Adaptation {
    /// Bradford (K. M. Lam, 1985) in its linear form (ICC.1:2010, annex E).
    Bradford,
    /// CAT02, the transform of CIECAM02 (CIE 159:2004).
    Cat02,
    /// CAT16, the transform of CAM16 (C. Li et al., Color Res. Appl. 42, 703 (2017)).
    Cat16,
}

impl Adaptation {
    /// Returns the matrix from XYZ to the cone-like responses.
    #[must_use]
    pub fn responses_from_xyz(self) -> Matrix {
        match self {
            Self::Bradford => [[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]],
            Self::Cat02 => [[0.7328, 0.4296, -0.1624], [-0.7036, 1.6975, 0.0061], [0.0030, 0.0136, 0.9834]],
            Self::Cat16 => [
                [0.401_288, 0.650_173, -0.051_461],
                [-0.250_268, 1.204_414, 0.045_854],
                [-0.002_079, 0.048_952, 0.953_127],
            ],
        }
    }

    /// Returns the matrix from XYZ under the white `from` to XYZ under the white `to`, for complete adaptation.
    #[must_use]
    pub fn matrix(self, from: [f64; 3], to: [f64; 3]) -> Matrix {
        let m = self.responses_from_xyz();
        let (before, after) = (apply(&m, from), apply(&m, to));
        let scaled: Matrix = [0, 1, 2].map(|i| m[i].map(|v| v * (after[i] / before[i])));
        product(&inverse(&m), &scaled)
    }

    /// Converts `xyz`, seen under the white `from`, to the XYZ that looks the same under the white `to`. Adaptation is complete.
    #[must_use]
    pub fn adapt(self, xyz: [f64; 3], from: [f64; 3], to: [f64; 3]) -> [f64; 3] {
        apply(&self.matrix(from, to), xyz)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const D65: [f64; 3] = [0.95047, 1.0, 1.08883];
    const D50: [f64; 3] = [0.96422, 1.0, 0.82521];

    /// Compares D65 to D50 by Bradford with the matrix that B. Lindbloom publishes (brucelindbloom.com, chromatic adaptation) for the same
    /// two whites.
    #[test]
    fn bradford_from_d65_to_d50() {
        let want = [
            [1.047_811_2, 0.022_886_6, -0.050_127_0],
            [0.029_542_4, 0.990_484_4, -0.017_049_1],
            [-0.009_234_5, 0.015_043_6, 0.752_131_6],
        ];
        let got = Adaptation::Bradford.matrix(D65, D50);
        for i in 0..3 {
            for j in 0..3 {
                assert!((got[i][j] - want[i][j]).abs() < 1e-6, "{got:?}");
            }
        }
    }

    #[test]
    fn white_becomes_white_and_back() {
        for a in [Adaptation::Bradford, Adaptation::Cat02, Adaptation::Cat16] {
            assert!(a.adapt(D65, D65, D50).iter().zip(D50).all(|(x, y)| (x - y).abs() < 1e-14), "{a:?}");
            let color = [0.3, 0.2, 0.5];
            let there = a.adapt(color, D65, D50);
            assert!(a.adapt(there, D50, D65).iter().zip(color).all(|(x, y)| (x - y).abs() < 1e-14), "{a:?}");
        }
    }

    /// Compares (0.2065, 0.1200, 0.0514), adapted from D65 to D50, with colour-science 0.4.7.
    #[test]
    fn cat02_and_cat16_agree_with_an_independent_program() {
        for (a, want) in [
            (Adaptation::Cat02, [0.216_257_755_0, 0.123_713_851_8, 0.038_518_673_7]),
            (Adaptation::Cat16, [0.211_853_708_9, 0.120_408_857_5, 0.038_160_252_5]),
        ] {
            let got = a.adapt([0.2065, 0.12, 0.0514], D65, D50);
            assert!(got.iter().zip(want).all(|(x, y)| (x - y).abs() < 1e-8), "{a:?} {got:?}");
        }
    }
}
