//! The positive: a print of a black-and-white negative, looked at as a scan.

use crate::curve::{CurveError, ToeShoulder};
use crate::lookup::{Lookup, PIXELS_A_TASK};
use rayon::prelude::*;
use spectra_core::math::{exp, log10};
use std::f64::consts::LN_10;

/// What a mid gray subject, exposed as the meter says, is shown as in linear light: the reflectance of the
/// gray card.
pub const MID_GRAY: f64 = 0.18;

/// Exposure of a mid gray subject that is exposed as the meter says, lx s, on a film of ISO speed `iso`:
/// 10/S, by the definition of exposure meters (ISO 2720:1974).
#[must_use]
pub fn metered_exposure_lx_s(iso: f64) -> f64 {
    10.0 / iso
}

/// A photographic paper.
///
/// Density rises along a [`ToeShoulder`]. Its exposure range is that of ISO 6846:1992: between 0.04
/// over the paper's white and nine tenths of its maximum density.
#[derive(Clone, Debug, PartialEq)]
pub struct Paper {
    /// Exposure range, log10; ISO range over 100.
    pub range: f64,
    /// Maximum density over the white of the paper.
    pub maximum_density: f64,
    /// Width of the toe, where the highlights are, log10 of exposure.
    pub toe: f64,
    /// Sharpness of the shoulder, where the shadows are.
    pub shoulder: f64,
}

/// ISO ranges of papers of the grades 0 to 5, softest first: R140-170, 115-140, 95-115, 80-95, 65-80 and 50-65 (ISO 6846:1992).
pub const GRADES: [[f64; 2]; 6] =
    [[140.0, 170.0], [115.0, 140.0], [95.0, 115.0], [80.0, 95.0], [65.0, 80.0], [50.0, 65.0]];

/// The grade that fits a usual negative.
pub const USUAL_GRADE: f64 = 2.0;

impl Default for Paper {
    /// Grade 2, with the black of a glossy paper, 2.1.
    fn default() -> Self {
        Self { range: Self::range_of_grade(USUAL_GRADE).unwrap_or(1.05), maximum_density: 2.1, toe: 0.1, shoulder: 4.0 }
    }
}

impl Paper {
    /// Exposure range, log10, of a grade from 0 to 5: the middle of its ISO range, over 100, and straight between grades, as
    /// papers of variable contrast have them; `None` for others.
    #[must_use]
    pub fn range_of_grade(grade: f64) -> Option<f64> {
        if !(0.0..=5.0).contains(&grade) {
            return None;
        }
        let middle = |i: usize| (GRADES[i][0] + GRADES[i][1]) / 200.0;
        let i = (grade as usize).min(GRADES.len() - 2);
        Some(middle(i) + (middle(i + 1) - middle(i)) * (grade - i as f64))
    }

    /// Its curve, with log10 exposure 0 at the density of 0.04.
    ///
    /// # Errors
    /// [`CurveError`] for values that are no paper.
    pub fn curve(&self) -> Result<ToeShoulder, CurveError> {
        let high = [self.range, 0.9 * self.maximum_density];
        ToeShoulder::through([0.0, 0.04], high, self.toe, self.maximum_density, self.shoulder)
    }
}

/// A paper and the light it is printed with.
///
/// The light is set so that the density of a mid gray subject comes out as [`MID_GRAY`]. The picture is a scan of
/// the print: white is the bare paper, black is what unexposed film prints as, which is how a darkroom finds
/// its printing time, and between them picture values are proportional to reflectance.
#[derive(Clone, Debug, PartialEq)]
pub struct Print {
    paper: ToeShoulder,
    light: f64,
    black: f64,
}

impl Print {
    /// Prints negatives whose unexposed density is `unexposed_density`, and whose mid gray has
    /// `gray_density`, on `paper`.
    ///
    /// # Errors
    /// [`CurveError`]: the paper cannot be, or no printing light shows that gray as [`MID_GRAY`], since it is not denser
    /// than unexposed film.
    pub fn balanced(paper: &Paper, unexposed_density: f64, gray_density: f64) -> Result<Self, CurveError> {
        let curve = paper.curve()?;
        let of_light = |light: f64| {
            let black = reflectance(&curve, light - unexposed_density);
            Self { paper: curve.clone(), light, black }
        };
        // More light, darker gray: from a light that leaves both white to one that turns both black.
        let (mut left, mut right) = (gray_density, gray_density + 2.0 * paper.range);
        let above = |light: f64| of_light(light).picture(gray_density) > MID_GRAY;
        if !above(left) || above(right) {
            return Err(CurveError::OutOfRange {
                what: "density of mid gray",
                wanted: "well above that of the unexposed film, for a print",
                value: gray_density,
            });
        }
        loop {
            let middle = 0.5 * (left + right);
            if middle <= left || middle >= right {
                return Ok(of_light(left));
            }
            if above(middle) {
                left = middle;
            } else {
                right = middle;
            }
        }
    }

    /// Prints a whole negative as a printer does who looks at it: of the papers from grade 5 to grade 0 takes the one on which
    /// the darkest and the lightest two hundredth of `densities` come out just off its black and its white. A negative of too
    /// little contrast even for grade 5 is not stretched: `None`; of one of too much the highlights are kept. White is the bare
    /// paper and black the paper's own.
    ///
    /// # Errors
    /// [`CurveError`] for values that are no paper.
    pub fn automatic(paper: &Paper, densities: &[f32]) -> Result<Option<Self>, CurveError> {
        let Some([thin, dense]) = ends(densities) else { return Ok(None) };
        let [soft, hard] = [GRADES[0][1], GRADES[5][0]].map(|r| r / 100.0);
        let contrast = dense - thin;
        if contrast < hard {
            return Ok(None);
        }
        // Log10 of exposure from just off white to just off black, which rises with the paper's range.
        let reach = |range: f64| -> Result<(ToeShoulder, f64, f64), CurveError> {
            let curve = Paper { range, ..paper.clone() }.curve()?;
            let at = |reflectance: f64| curve.log10_exposure_at(-log10(reflectance)).unwrap_or(f64::NAN);
            let black = exp(-LN_10 * paper.maximum_density);
            let (white, black) = (at(1.0 - JUST_OFF_WHITE), at(black + JUST_OFF_BLACK * (1.0 - black)));
            Ok((curve, white, black))
        };
        let (mut left, mut right) = (hard, soft);
        for _ in 0..60 {
            let middle = 0.5 * (left + right);
            let (_, white, black) = reach(middle)?;
            if black - white > contrast { right = middle } else { left = middle }
        }
        let (curve, white, black) = reach(0.5 * (left + right))?;
        // What grade 5 leaves over is shared by both ends; what grade 0 lacks, the shadows lose.
        let spare = (black - white - contrast).max(0.0);
        let light = dense + white + 0.5 * spare;
        let black = exp(-LN_10 * paper.maximum_density);
        Ok(Some(Self { paper: curve, light, black }))
    }

    /// What a place of the negative with `density` is shown as, linear light in [0, 1].
    #[must_use]
    pub fn picture(&self, density: f64) -> f64 {
        (reflectance(&self.paper, self.light - density) - self.black) / (1.0 - self.black)
    }

    /// Density of the print over the paper's white, at a place of the negative with `density`.
    #[must_use]
    pub fn density(&self, density: f64) -> f64 {
        -log10(reflectance(&self.paper, self.light - density))
    }

    /// The picture of a whole negative: [`Print::picture`] of each density, within 1e-6.
    #[must_use]
    pub fn pictures(&self, density: &[f32]) -> Vec<f32> {
        // Curves end below a density of 10. The picture's second derivative over density is below 60 (a gradient of
        // 4 at most), so steps of 3e-4 interpolate within 60 / 8 * 9e-8 = 7e-7.
        const HIGHEST: f64 = 10.0;
        const STEPS: usize = 1 << 15;
        let sampled = Lookup::new(0.0, HIGHEST, STEPS, |d| self.picture(d));
        let one = |d: &f32| sampled.at(f64::from(*d)) as f32;
        density.par_iter().with_min_len(PIXELS_A_TASK).map(one).collect()
    }
}

/// By how much the lightest of an automatic print is darker than the paper's white, and the darkest lighter than its black, in
/// reflectance: 0.8 in L*.
const JUST_OFF_WHITE: f64 = 0.0204;
const JUST_OFF_BLACK: f64 = 0.0008857;

/// Densities that a two hundredth of the negative is thinner and denser than; `None` where there is nothing.
fn ends(densities: &[f32]) -> Option<[f64; 2]> {
    let mut all: Vec<f32> = densities.iter().copied().filter(|d| d.is_finite()).collect();
    let last = all.len().checked_sub(1)?;
    let mut at = |rank: usize| f64::from(*all.select_nth_unstable_by(rank, f32::total_cmp).1);
    let few = last / 200;
    Some([at(few), at(last - few)])
}

/// Reflectance relative to the white of the paper.
fn reflectance(paper: &ToeShoulder, log10_exposure: f64) -> f64 {
    exp(-LN_10 * paper.density(log10_exposure))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curve::CharacteristicCurve;

    /// A soft paper.
    fn soft() -> Paper {
        Paper { range: 1.6, ..Paper::default() }
    }

    fn film() -> CharacteristicCurve {
        ToeShoulder::through([-2.0, 0.1], [-0.5, 1.09], 0.2, 2.5, 4.0).expect("a film's curve").into()
    }

    fn print() -> Print {
        let gray = film().density(log10(metered_exposure_lx_s(80.0)));
        Print::balanced(&soft(), 0.0, gray).expect("balanced")
    }

    #[test]
    fn paper_has_its_range_and_its_black() {
        let paper = soft();
        let curve = CharacteristicCurve::from(paper.curve().expect("a paper"));
        let low = curve.log10_exposure_at(0.04).expect("above white");
        let high = curve.log10_exposure_at(0.9 * paper.maximum_density).expect("below black");
        assert!((high - low - 1.6).abs() < 1e-12);
        assert_eq!(curve.density_range(), (0.0, 2.1));
    }

    /// Each grade has the exposure range between 0.04 and nine tenths of the black that ISO 6846 asks for, 2 is the usual one.
    #[test]
    fn grades_have_their_iso_ranges() {
        for (grade, [least, most]) in GRADES.iter().enumerate() {
            let paper = Paper { range: Paper::range_of_grade(grade as f64).expect("a grade"), ..Paper::default() };
            let curve = CharacteristicCurve::from(paper.curve().expect("a paper"));
            let low = curve.log10_exposure_at(0.04).expect("above white");
            let high = curve.log10_exposure_at(0.9 * paper.maximum_density).expect("below black");
            let iso = 100.0 * (high - low);
            assert!((*least..=*most).contains(&iso), "{grade}: R{iso}");
        }
        assert_eq!(Paper::range_of_grade(2.0), Some(Paper::default().range));
        assert!((Paper::range_of_grade(2.5).expect("between") - 0.9625).abs() < 1e-12);
        assert_eq!([-0.1, 5.1, f64::NAN].map(Paper::range_of_grade), [None; 3]);
    }

    fn lightness(y: f64) -> f64 {
        spectra_color::lab([y; 3], [1.0; 3])[0]
    }

    /// The darkest and lightest 0.5 % come within 1 L* of the paper's own where a paper of grade 5 to 0 can do it.
    #[test]
    fn an_automatic_print_reaches_black_and_white() {
        for contrast in [0.9, 1.0, 1.3, 1.8, 2.2] {
            let density: Vec<f32> = (0..2000).map(|i| (0.3 + contrast * f64::from(i) / 1999.0) as f32).collect();
            let print = Print::automatic(&Paper::default(), &density).expect("a paper").expect("contrast enough");
            let shown = print.pictures(&density);
            let mean = |of: &[f32]| of.iter().map(|v| f64::from(*v)).sum::<f64>() / of.len() as f64;
            let (black, white) = (lightness(mean(&shown[..10])), lightness(mean(&shown[1990..])));
            println!("{contrast}: {black:.2} {white:.2}");
            assert!(black <= 1.0 && (99.0..=100.0).contains(&white), "{contrast}: {black} {white}");
        }
        // Too much for any paper: the highlights are kept.
        let density: Vec<f32> = (0..2000).map(|i| 0.3 + 3.0 * i as f32 / 1999.0).collect();
        let print = Print::automatic(&Paper::default(), &density).expect("a paper").expect("contrast enough");
        assert!((99.0..100.0).contains(&lightness(print.picture(3.3 - 0.015))) && print.picture(0.6) < 1e-3);
        // A flat scene is not stretched, nor is nothing.
        let flat: Vec<f32> = (0..2000).map(|i| 0.8 + 0.3 * i as f32 / 1999.0).collect();
        assert_eq!(Print::automatic(&Paper::default(), &flat), Ok(None));
        assert_eq!(Print::automatic(&Paper::default(), &[]), Ok(None));
        assert_eq!(Print::automatic(&Paper::default(), &[f32::NAN]), Ok(None));
    }

    #[test]
    fn mid_gray_is_shown_as_such_and_clear_film_as_black() {
        let (print, film) = (print(), film());
        let shown = |lx_s: f64| print.picture(film.density(log10(lx_s)));
        assert!((shown(0.125) - MID_GRAY).abs() < 1e-12);
        assert_eq!(shown(0.0), 0.0);
        // A white subject (0.9 over 0.18) is bright but not yet bare paper; far beyond it is.
        assert!((0.75..0.95).contains(&shown(0.125 * 5.0)), "{}", shown(0.125 * 5.0));
        assert!(shown(0.125 * 64.0) > 0.98 && shown(f64::INFINITY) < 1.0 + 1e-12);
        // Five stops under mid gray are black to the eye: under 1 % of white.
        assert!(shown(0.125 / 32.0) < 0.01, "{}", shown(0.125 / 32.0));
    }

    #[test]
    fn a_whole_negative_prints_like_its_places() {
        let print = print();
        let density: Vec<f32> = (0..60_000).map(|i| i as f32 * 5e-5).collect();
        for (d, shown) in density.iter().zip(print.pictures(&density)) {
            // As stated, and the rounding to 24 bits.
            assert!((f64::from(shown) - print.picture(f64::from(*d))).abs() < 1.1e-6, "{d}");
        }
        assert_eq!(print.pictures(&[0.0]), [0.0]);
    }

    #[test]
    fn picture_rises_with_exposure() {
        let (print, film) = (print(), film());
        let mut before = -1.0;
        for i in 0..400 {
            let v = print.picture(film.density(-5.0 + f64::from(i) * 0.02));
            assert!(v >= before, "{i}");
            before = v;
        }
    }

    #[test]
    fn system_gradient_at_mid_gray_is_as_stated() {
        // Change of log10 of the picture's light per change of log10 of the exposure.
        let step = 1e-4;
        let at = |x: f64| log10(print().picture(film().density(x)));
        let gradient = (at(log10(0.125) + step) - at(log10(0.125) - step)) / (2.0 * step);
        assert!((gradient - 1.3).abs() < 0.01, "{gradient}");
    }

    /// Base and fog weaken the printing light and change nothing else.
    #[test]
    fn base_and_fog_do_not_change_the_picture() {
        let film = film();
        let gray = film.density(log10(0.125));
        let fogged = Print::balanced(&soft(), 0.3, gray + 0.3).expect("balanced");
        for i in 0..50 {
            let d = f64::from(i) * 0.05;
            assert!((fogged.picture(d + 0.3) - print().picture(d)).abs() < 1e-12);
        }
    }

    #[test]
    fn a_gray_as_clear_as_the_film_cannot_be_printed() {
        assert!(Print::balanced(&Paper::default(), 0.3, 0.3).is_err());
        assert!(Print::balanced(&Paper { range: -1.0, ..Paper::default() }, 0.0, 0.8).is_err());
    }
}
