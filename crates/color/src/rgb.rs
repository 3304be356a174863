//! RGB color spaces: matrices from primaries, and transfer curves.

use crate::matrix::{Matrix, apply, inverse};
use std::sync::OnceLock;

/// A curve from linear light to the code values of a picture file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Transfer {
    /// No curve: the code value is linear light.
    Linear,
    /// The curve of sRGB (IEC 61966-2-1).
    Srgb,
    /// The curve of ITU-R BT.2020, with constants of full precision.
    Rec2020,
}

/// Constants of BT.2020: the curve and its slope are continuous at beta.
const REC2020_ALPHA: f64 = 1.099_296_826_809_442_9;
const REC2020_BETA: f64 = 0.018_053_968_510_807_807;

impl Transfer {
    /// Encodes `linear` light as a code value. The curve is odd: a negative value yields the negative code value of its
    /// magnitude.
    #[must_use]
    pub fn encode(self, linear: f64) -> f64 {
        let x = linear.abs();
        let y = match self {
            Self::Linear => x,
            Self::Srgb if x <= 0.003_130_8 => 12.92 * x,
            Self::Srgb => 1.055 * libm::pow(x, 1.0 / 2.4) - 0.055,
            Self::Rec2020 if x < REC2020_BETA => 4.5 * x,
            Self::Rec2020 => REC2020_ALPHA * libm::pow(x, 0.45) - (REC2020_ALPHA - 1.0),
        };
        y.copysign(linear)
    }

    /// Decodes the code value `encoded` to linear light. The curve is odd: a negative value yields the negative light of its
    /// magnitude.
    #[must_use]
    pub fn decode(self, encoded: f64) -> f64 {
        let y = encoded.abs();
        let x = match self {
            Self::Linear => y,
            Self::Srgb if y <= 0.040_45 => y / 12.92,
            Self::Srgb => libm::pow((y + 0.055) / 1.055, 2.4),
            Self::Rec2020 if y < 4.5 * REC2020_BETA => y / 4.5,
            Self::Rec2020 => libm::pow((y + (REC2020_ALPHA - 1.0)) / REC2020_ALPHA, 1.0 / 0.45),
        };
        x.copysign(encoded)
    }
}

/// An RGB color space for the CIE 1931 2-degree observer.
#[derive(Clone, Debug, PartialEq)]
pub struct RgbSpace {
    /// Name of the space.
    pub name: &'static str,
    /// Chromaticities x, y of red, green and blue.
    pub primaries_xy: [[f64; 2]; 3],
    /// Chromaticity x, y of white.
    pub white_xy: [f64; 2],
    /// Transfer curve of picture files in this space.
    pub transfer: Transfer,
    /// Matrix from linear RGB to XYZ, where white has Y = 1.
    pub xyz_from_rgb: Matrix,
    /// Matrix from XYZ, where white has Y = 1, to linear RGB.
    pub rgb_from_xyz: Matrix,
}

impl RgbSpace {
    /// Builds a space from its primaries and white; white is RGB (1, 1, 1) with Y = 1.
    #[must_use]
    pub fn new(name: &'static str, primaries_xy: [[f64; 2]; 3], white_xy: [f64; 2], transfer: Transfer) -> Self {
        let columns = primaries_xy.map(|xy| xyz_of_xy(xy, 1.0));
        let unscaled: Matrix = [0, 1, 2].map(|i| [0, 1, 2].map(|j| columns[j][i]));
        let scale = apply(&inverse(&unscaled), xyz_of_xy(white_xy, 1.0));
        let xyz_from_rgb: Matrix = unscaled.map(|row| [0, 1, 2].map(|j| row[j] * scale[j]));
        Self { name, primaries_xy, white_xy, transfer, rgb_from_xyz: inverse(&xyz_from_rgb), xyz_from_rgb }
    }

    /// Returns sRGB, IEC 61966-2-1:1999: primaries of ITU-R BT.709, white D65 (0.3127, 0.3290).
    pub fn srgb() -> &'static Self {
        static ONE: OnceLock<RgbSpace> = OnceLock::new();
        ONE.get_or_init(|| {
            Self::new("sRGB", [[0.64, 0.33], [0.30, 0.60], [0.15, 0.06]], [0.3127, 0.3290], Transfer::Srgb)
        })
    }

    /// Returns Rec. 2020, ITU-R BT.2020-2: primaries of 630, 532 and 467 nm, white D65.
    pub fn rec2020() -> &'static Self {
        static ONE: OnceLock<RgbSpace> = OnceLock::new();
        ONE.get_or_init(|| {
            let primaries = [[0.708, 0.292], [0.170, 0.797], [0.131, 0.046]];
            Self::new("Rec. 2020", primaries, [0.3127, 0.3290], Transfer::Rec2020)
        })
    }

    /// Returns ACEScg, S-2014-004: primaries AP1, the ACES white near D60 (0.32168, 0.33767), linear.
    pub fn aces_cg() -> &'static Self {
        static ONE: OnceLock<RgbSpace> = OnceLock::new();
        ONE.get_or_init(|| {
            let primaries = [[0.713, 0.293], [0.165, 0.830], [0.128, 0.044]];
            Self::new("ACEScg", primaries, [0.32168, 0.33767], Transfer::Linear)
        })
    }

    /// Returns Display P3: the digital cinema primaries (SMPTE RP 431-2) with the white D65 and the curve of sRGB (Apple, 2017).
    pub fn display_p3() -> &'static Self {
        static ONE: OnceLock<RgbSpace> = OnceLock::new();
        ONE.get_or_init(|| {
            let primaries = [[0.680, 0.320], [0.265, 0.690], [0.150, 0.060]];
            Self::new("Display P3", primaries, [0.3127, 0.3290], Transfer::Srgb)
        })
    }

    /// Returns the spaces that a chromaticity diagram shows: sRGB, Rec. 2020 and ACEScg.
    #[must_use]
    pub fn all() -> [&'static Self; 3] {
        [Self::srgb(), Self::rec2020(), Self::aces_cg()]
    }

    /// XYZ of white, with Y = 1.
    #[must_use]
    pub fn white_xyz(&self) -> [f64; 3] {
        xyz_of_xy(self.white_xy, 1.0)
    }

    /// Converts `xyz`, where white has Y = 1, to linear RGB without adaptation. Values are negative outside the gamut.
    #[must_use]
    pub fn from_xyz(&self, xyz: [f64; 3]) -> [f64; 3] {
        apply(&self.rgb_from_xyz, xyz)
    }

    /// Converts linear RGB to XYZ, where white has Y = 1.
    #[must_use]
    pub fn to_xyz(&self, rgb: [f64; 3]) -> [f64; 3] {
        apply(&self.xyz_from_rgb, rgb)
    }

    /// Relative luminance Y of linear RGB; 1 for white.
    #[must_use]
    pub fn luminance(&self, rgb: [f64; 3]) -> f64 {
        self.to_xyz(rgb)[1]
    }

    /// Encodes linear RGB as code values.
    #[must_use]
    pub fn encode(&self, rgb: [f64; 3]) -> [f64; 3] {
        rgb.map(|v| self.transfer.encode(v))
    }

    /// Decodes code values to linear RGB.
    #[must_use]
    pub fn decode(&self, encoded: [f64; 3]) -> [f64; 3] {
        encoded.map(|v| self.transfer.decode(v))
    }
}

/// Returns XYZ of the chromaticity `xy` at luminance `y`.
#[must_use]
pub fn xyz_of_xy(xy: [f64; 2], y: f64) -> [f64; 3] {
    [xy[0] / xy[1] * y, y, (1.0 - xy[0] - xy[1]) / xy[1] * y]
}

/// Converts a value of 0 to 1 to 8 bits, where 1 becomes 255. It rounds to nearest and clips; NaN becomes 0.
#[must_use]
pub fn to_u8(value: f64) -> u8 {
    // The cast saturates and converts NaN to 0.
    (value * 255.0 + 0.5).floor() as u8
}

/// Converts an 8-bit value to the range 0 to 1, where 255 becomes 1.
#[must_use]
pub fn from_u8(value: u8) -> f64 {
    f64::from(value) / 255.0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(got: &Matrix, want: &Matrix, tolerance: f64) {
        for i in 0..3 {
            for j in 0..3 {
                assert!((got[i][j] - want[i][j]).abs() <= tolerance, "{got:?} {want:?}");
            }
        }
    }

    /// Compares the matrices with the standards: IEC 61966-2-1 prints four digits, ITU-R BT.2020 the luminance row, S-2014-004 ten digits.
    #[test]
    fn matrices_are_those_of_the_standards() {
        let srgb = [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]];
        close(&RgbSpace::srgb().xyz_from_rgb, &srgb, 1e-4);
        let back = [[3.2406, -1.5372, -0.4986], [-0.9689, 1.8758, 0.0415], [0.0557, -0.2040, 1.0570]];
        close(&RgbSpace::srgb().rgb_from_xyz, &back, 4e-4);
        let y = RgbSpace::rec2020().xyz_from_rgb[1];
        assert!(y.iter().zip([0.2627, 0.6780, 0.0593]).all(|(a, b)| (a - b).abs() < 5e-5), "{y:?}");
        let ap1 = [
            [0.662_454_181_1, 0.134_004_206_5, 0.156_187_687_0],
            [0.272_228_716_8, 0.674_081_765_8, 0.053_689_517_4],
            [-0.005_574_649_5, 0.004_060_733_5, 1.010_339_100_3],
        ];
        close(&RgbSpace::aces_cg().xyz_from_rgb, &ap1, 1e-10);
        // CSS Color Module Level 4 (W3C), Display P3.
        let p3 = [
            [0.486_570_948_6, 0.265_667_693_2, 0.198_217_285_2],
            [0.228_974_564_1, 0.691_738_521_8, 0.079_286_914_1],
            [0.0, 0.045_113_381_9, 1.043_944_368_9],
        ];
        close(&RgbSpace::display_p3().xyz_from_rgb, &p3, 1e-9);
    }

    /// Compares the sRGB values of the 1931 functions at 575 nm with an independent computation.
    #[test]
    fn srgb_of_575_nm() {
        let rgb = RgbSpace::srgb().from_xyz(spectra_spectrum::Observer::cie_1931_2deg().at(575.0));
        for (got, want) in rgb.into_iter().zip([1.3222, 0.9009, -0.1379]) {
            assert!((got - want).abs() < 0.005, "{rgb:?}");
        }
    }

    /// Checks values of IEC 61966-2-1: code value 0.5 is 0.2140 in light; mid gray 0.18 is code value 0.4614.
    #[test]
    fn transfer_curves_are_those_of_the_standards_and_invert() {
        assert!((Transfer::Srgb.decode(0.5) - 0.214_041_14).abs() < 1e-8);
        assert!((Transfer::Srgb.encode(0.18) - 0.461_356_13).abs() < 1e-8);
        assert!((Transfer::Rec2020.encode(REC2020_BETA) - 4.5 * REC2020_BETA).abs() < 1e-12);
        for t in [Transfer::Linear, Transfer::Srgb, Transfer::Rec2020] {
            assert!((t.encode(1.0) - 1.0).abs() < 1e-15 && t.encode(0.0) == 0.0);
            for i in -300..=300 {
                let x = f64::from(i) / 200.0;
                // The sRGB standard rounds its constants: its two branches differ by 3e-8 where they meet.
                assert!((t.decode(t.encode(x)) - x).abs() < 1e-8, "{t:?} {x}");
            }
        }
    }

    #[test]
    fn eight_bits_round_trip_and_255_is_one() {
        assert!((0..=255).all(|v| to_u8(from_u8(v)) == v));
        assert_eq!(from_u8(255), 1.0);
        assert_eq!([to_u8(-0.2), to_u8(1.7), to_u8(f64::NAN), to_u8(0.5)], [0, 255, 0, 128]);
    }
}
