//! A paper print of a black-and-white negative, viewed as a scan.

use crate::curve::{CurveError, ToeShoulder};
use crate::lookup::{Lookup, PIXELS_A_TASK};
use crate::viewing_options::{FLARE, PictureBlack};
use rayon::prelude::*;
use spectra_core::math::{exp, log10};
use std::f64::consts::LN_10;

/// Linear light that shows a mid gray subject exposed as metered: the reflectance of the gray card.
pub const MID_GRAY: f64 = 0.18;

/// Returns the exposure (lx s) of a mid gray subject exposed as metered, on a film of ISO speed `iso`. It is 10/S, by the
/// definition of exposure meters (ISO 2720:1974).
#[must_use]
pub fn metered_exposure_lx_s(iso: f64) -> f64 {
    10.0 / iso
}

/// A photographic paper.
///
/// Density rises along a [`ToeShoulder`]. The exposure range follows ISO 6846:1992: it goes from 0.04 above the paper's white to nine
/// tenths of the maximum density ([`RANGE_ENDS`]).
#[derive(Clone, Debug, PartialEq)]
pub struct Paper {
    /// Exposure range, log10: the ISO range divided by 100.
    pub range: f64,
    /// Maximum density above the white of the paper.
    pub maximum_density: f64,
    /// Width of the toe, which holds the highlights, in log10 of exposure.
    pub toe: f64,
    /// Sharpness of the shoulder, which holds the shadows.
    pub shoulder: f64,
}

/// ISO ranges of papers of the grades 0 to 5, softest first: R140-170, 115-140, 95-115, 80-95, 65-80 and 50-65 (ISO 6846:1992).
pub const GRADES: [[f64; 2]; 6] =
    [[140.0, 170.0], [115.0, 140.0], [95.0, 115.0], [80.0, 95.0], [65.0, 80.0], [50.0, 65.0]];

/// Ends of a paper's exposure range: the density above white where it begins, and the fraction of the maximum density where it ends (ISO
/// 6846).
pub const RANGE_ENDS: [f64; 2] = [0.04, 0.9];

/// Paper grade that fits a negative of normal contrast.
pub const USUAL_GRADE: f64 = 2.0;

/// Exposure range of grade 2, and width of its toe, in log10 of exposure.
const USUAL_RANGE: f64 = 1.05;
const USUAL_TOE: f64 = 0.2;

impl Default for Paper {
    /// Returns grade 2 with the black of a glossy paper, 2.1. Toe and shoulder give prints of a normal negative the tones of a
    /// darkroom print.
    fn default() -> Self {
        Self { range: USUAL_RANGE, maximum_density: 2.1, toe: USUAL_TOE, shoulder: 6.0 }
    }
}

impl Paper {
    /// Returns the default paper with a different exposure range, in log10 of exposure. The toe scales with the range.
    #[must_use]
    pub fn of_range(range: f64) -> Self {
        Self { range, toe: USUAL_TOE * range / USUAL_RANGE, ..Self::default() }
    }

    /// Returns the exposure range (log10) of a grade from 0 to 5: the middle of its ISO range over 100, linear between grades as
    /// in variable-contrast papers. `None` for other grades.
    #[must_use]
    pub fn range_of_grade(grade: f64) -> Option<f64> {
        if !(0.0..=5.0).contains(&grade) {
            return None;
        }
        let middle = |i: usize| (GRADES[i][0] + GRADES[i][1]) / 200.0;
        let i = (grade as usize).min(GRADES.len() - 2);
        Some(middle(i) + (middle(i + 1) - middle(i)) * (grade - i as f64))
    }

    /// Returns the curve of the paper, with log10 exposure 0 at the density of 0.04.
    ///
    /// # Errors
    /// [`CurveError`] for values that do not describe a paper.
    pub fn curve(&self) -> Result<ToeShoulder, CurveError> {
        let high = [self.range, RANGE_ENDS[1] * self.maximum_density];
        ToeShoulder::through([0.0, RANGE_ENDS[0]], high, self.toe, self.maximum_density, self.shoulder)
    }
}

/// A paper and the light with which it is printed.
///
/// The light is set so that a mid gray subject is shown as [`MID_GRAY`]. White is the bare paper.
/// The paper's black is either kept, with the flare of the room added, or stretched. If it is stretched, the print of unexposed film is
/// shown as black, and picture values are proportional to the reflectance above it.
#[derive(Clone, Debug, PartialEq)]
pub struct Print {
    paper: ToeShoulder,
    light: f64,
    /// Reflectance, relative to white paper, that is shown as black, and additional light reflected by the surface.
    black: f64,
    flare: f64,
}

impl Print {
    /// Builds a print on a paper of this curve with this light; `darkest` is the reflectance shown as black if that is stretched.
    fn with(paper: ToeShoulder, light: f64, black: PictureBlack, darkest: f64) -> Self {
        match black {
            PictureBlack::Kept => Self { paper, light, black: 0.0, flare: FLARE },
            PictureBlack::Stretched => Self { paper, light, black: darkest, flare: 0.0 },
        }
    }

    /// Prints negatives on `paper`. Their unexposed density is `unexposed_density`, and the density of a mid gray subject is
    /// `gray_density`.
    ///
    /// # Errors
    /// [`CurveError`]: the paper is impossible, or no printing light shows that gray as [`MID_GRAY`], because it is not denser than
    /// unexposed film.
    pub fn balanced(
        paper: &Paper,
        unexposed_density: f64,
        gray_density: f64,
        black: PictureBlack,
    ) -> Result<Self, CurveError> {
        let curve = paper.curve()?;
        let of_light = |light: f64| {
            let darkest = reflectance(&curve, light - unexposed_density);
            Self::with(curve.clone(), light, black, darkest)
        };
        // More light gives a darker gray: search from a light that leaves both white to one that turns both black.
        let (mut left, mut right) = (gray_density, gray_density + 2.0 * paper.range);
        let above = |light: f64| of_light(light).picture(gray_density) > MID_GRAY;
        let is_between = above(left) && !above(right);
        // Bisects until both are neighboring numbers.
        let between =
            |left: f64, right: f64| Some(0.5 * (left + right)).filter(|middle| left < *middle && *middle < right);
        while let Some(middle) = between(left, right).filter(|_| is_between) {
            if above(middle) {
                left = middle;
            } else {
                right = middle;
            }
        }
        let print = of_light(left);
        // A gray that is hardly denser than unexposed film can be shown as gray, but leaves no tones below it.
        if !is_between || print.density(unexposed_density) < print.density(gray_density) + LEAST_BELOW_GRAY {
            return Err(CurveError::OutOfRange {
                what: "density of mid gray",
                wanted: "well above that of the unexposed film, for a print",
                value: gray_density,
            });
        }
        Ok(print)
    }

    /// Prints a whole negative as a printer does by eye: on a paper of grade 5 to 0 whose exposure range matches the contrast of
    /// the negative.
    ///
    /// `densities` are those of the negative's pixels. The lightest hundredth of them is printed at one of [`RANGE_ENDS`] and the
    /// darkest hundredth at the other. Returns `None` for a negative with too little contrast even for grade 5. If the contrast
    /// is too high for any paper, the highlights are kept.
    ///
    /// # Errors
    /// [`CurveError`] for values that do not describe a paper.
    pub fn automatic(paper: &Paper, densities: &[f32], black: PictureBlack) -> Result<Option<Self>, CurveError> {
        let Some([thin, dense]) = ends(densities) else { return Ok(None) };
        let [soft, hard] = [GRADES[0][1], GRADES[5][0]].map(|r| r / 100.0);
        let contrast = dense - thin;
        if contrast < hard {
            return Ok(None);
        }
        let range = contrast.min(soft);
        let curve = Paper { range, toe: paper.toe * range / paper.range, ..paper.clone() }.curve()?;
        // The zero of the curve is where the exposure range begins.
        Ok(Some(Self::with(curve, dense, black, exp(-LN_10 * paper.maximum_density))))
    }

    /// Returns the linear light, in [0, 1], that shows a place of the negative with `density`.
    #[must_use]
    pub fn picture(&self, density: f64) -> f64 {
        let share = (reflectance(&self.paper, self.light - density) - self.black) / (1.0 - self.black);
        (share + self.flare) / (1.0 + self.flare)
    }

    /// Returns the density of the print above the paper's white, at a place of the negative with `density`.
    #[must_use]
    pub fn density(&self, density: f64) -> f64 {
        -log10(reflectance(&self.paper, self.light - density))
    }

    /// Computes the picture of a whole negative: [`Print::picture`] of each density, within 1e-6.
    #[must_use]
    pub fn pictures(&self, density: &[f32]) -> Vec<f32> {
        // Curves end below a density of 10. The picture's second derivative over density is below 60 (a gradient of 4 at most), so steps of
        // 3e-4 interpolate to within 60 / 8 * 9e-8 = 7e-7.
        const HIGHEST: f64 = 10.0;
        const STEPS: usize = 1 << 15;
        let sampled = Lookup::new(0.0, HIGHEST, STEPS, |d| self.picture(d));
        let one = |d: &f32| sampled.at(f64::from(*d)) as f32;
        density.par_iter().with_min_len(PIXELS_A_TASK).map(one).collect()
    }
}

/// Smallest print density of unexposed film above that of mid gray.
const LEAST_BELOW_GRAY: f64 = 0.05;

/// Densities below and above which a hundredth of the negative lies; `None` for an empty negative.
fn ends(densities: &[f32]) -> Option<[f64; 2]> {
    let mut all: Vec<f32> = densities.iter().copied().filter(|d| d.is_finite()).collect();
    let last = all.len().checked_sub(1)?;
    let mut at = |rank: usize| f64::from(*all.select_nth_unstable_by(rank, f32::total_cmp).1);
    let few = last / 100;
    Some([at(few), at(last - few)])
}

/// Reflectance of the print relative to the white of the paper.
fn reflectance(paper: &ToeShoulder, log10_exposure: f64) -> f64 {
    exp(-LN_10 * paper.density(log10_exposure))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curve::CharacteristicCurve;

    /// Returns a soft paper.
    fn soft() -> Paper {
        Paper::of_range(1.6)
    }

    fn film() -> CharacteristicCurve {
        ToeShoulder::through([-2.0, 0.1], [-0.5, 1.09], 0.2, 2.5, 4.0).expect("a film's curve").into()
    }

    fn print() -> Print {
        let gray = film().density(log10(metered_exposure_lx_s(80.0)));
        Print::balanced(&soft(), 0.0, gray, PictureBlack::Stretched).expect("balanced")
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

    /// Each grade has the exposure range of ISO 6846, between 0.04 and nine tenths of the black. Grade 2 is the default.
    #[test]
    fn grades_have_their_iso_ranges() {
        for (grade, [least, most]) in GRADES.iter().enumerate() {
            let paper = Paper::of_range(Paper::range_of_grade(grade as f64).expect("a grade"));
            let curve = CharacteristicCurve::from(paper.curve().expect("a paper"));
            let low = curve.log10_exposure_at(0.04).expect("above white");
            let high = curve.log10_exposure_at(0.9 * paper.maximum_density).expect("below black");
            let iso = 100.0 * (high - low);
            assert!((*least..=*most).contains(&iso), "{grade}: R{iso}");
        }
        assert_eq!(Paper::of_range(Paper::range_of_grade(USUAL_GRADE).expect("a grade")), Paper::default());
        assert!((Paper::range_of_grade(2.5).expect("between") - 0.9625).abs() < 1e-12);
        assert_eq!([-0.1, 5.1, f64::NAN].map(Paper::range_of_grade), [None; 3]);
    }

    fn lightness(y: f64) -> f64 {
        spectra_color::lab([y; 3], [1.0; 3])[0]
    }

    /// The darkest and the lightest hundredth are printed at the ends of the paper's exposure range if a paper of grade 5 to 0 can do it,
    /// and the extremes stay within the paper's densities.
    #[test]
    fn an_automatic_print_uses_the_range_of_its_paper() {
        for contrast in [0.9, 1.0, 1.3, 1.65] {
            let density: Vec<f32> = (0..2001).map(|i| (0.3 + contrast * f64::from(i) / 2000.0) as f32).collect();
            let print =
                Print::automatic(&Paper::default(), &density, PictureBlack::Kept).expect("a paper").expect("contrast");
            let [dark, light] = [20, 1980].map(|i| print.density(f64::from(density[i])));
            println!("{contrast}: {dark:.3} {light:.3}");
            assert!((dark - 0.9 * 2.1).abs() < 1e-5 && (light - 0.04).abs() < 1e-5, "{contrast}: {dark} {light}");
        }
        // Too much contrast for any paper: the highlights are kept.
        let density: Vec<f32> = (0..2001).map(|i| 0.3 + 3.0 * i as f32 / 2000.0).collect();
        let automatic = |density: &[f32]| Print::automatic(&Paper::default(), density, PictureBlack::Stretched);
        let print = automatic(&density).expect("a paper").expect("contrast enough");
        assert!((print.density(f64::from(density[1980])) - 0.04).abs() < 1e-5 && print.picture(0.6) < 1e-3);
        // A flat scene is not stretched, nor is an empty one.
        let flat: Vec<f32> = (0..2000).map(|i| 0.8 + 0.3 * i as f32 / 1999.0).collect();
        assert_eq!(automatic(&flat), Ok(None));
        assert_eq!(automatic(&[]), Ok(None));
        assert_eq!(automatic(&[f32::NAN]), Ok(None));
    }

    /// Checks L* of Tri-X from 3 stops below mid gray to 2 above, on grades 0 and 2. Grade 0 is compared with Ansel Adams's values of a
    /// normal print (zones III to VIII; densities 1.6, 1.3, 1.0, 0.74, 0.5, 0.3).
    #[test]
    fn grades_have_the_tones_of_a_darkroom() {
        let film =
            crate::stock::Stock::load("kodak-tri-x-400", &spectra_scene::FileResources::beside("/nowhere".as_ref()));
        let film = film.unwrap_or_else(|faults| panic!("{faults}"));
        let film = crate::emulsion::Emulsion::new(&film, film.developments().next().expect("one")).expect("sound");
        let at = |stops: f64| film.amount(0, log10(10.0 / 400.0) + stops * log10(2.0));
        let tones = |grade: f64| -> Vec<f64> {
            let paper = Paper::of_range(Paper::range_of_grade(grade).expect("a grade"));
            let print = Print::balanced(&paper, film.amount(0, f64::NEG_INFINITY), at(0.0), PictureBlack::Kept);
            let print = print.expect("balanced");
            (-3..=2).map(|stops| lightness(print.picture(at(f64::from(stops))))).collect()
        };
        let (soft, usual) = (tones(0.0), tones(2.0));
        println!("{soft:.1?} {usual:.1?}");
        for (got, want) in soft.iter().zip([17.0, 27.0, 38.0, 50.0, 63.0, 76.0]) {
            assert!((got - want).abs() <= 5.0, "{soft:?}");
        }
        assert!(usual[0] >= 11.0 && usual[1] >= 14.0 && usual[2] >= 27.0, "{usual:?}");
        assert!(usual[4] <= 72.0 && usual[5] <= 87.0, "{usual:?}");
    }

    #[test]
    fn mid_gray_is_shown_as_such_and_clear_film_as_black() {
        let (print, film) = (print(), film());
        let shown = |lx_s: f64| print.picture(film.density(log10(lx_s)));
        assert!((shown(0.125) - MID_GRAY).abs() < 1e-12);
        assert_eq!(shown(0.0), 0.0);
        // A white subject (0.9 over 0.18) is bright but not yet bare paper. Six stops above gray look like bare paper, within 3 L*.
        assert!((0.6..0.95).contains(&shown(0.125 * 5.0)), "{}", shown(0.125 * 5.0));
        assert!(lightness(shown(0.125 * 64.0)) > 97.0 && shown(f64::INFINITY) < 1.0 + 1e-12);
        // Five stops below mid gray look black: below 1 % of white.
        assert!(shown(0.125 / 32.0) < 0.01, "{}", shown(0.125 / 32.0));
    }

    #[test]
    fn a_whole_negative_prints_like_its_places() {
        let print = print();
        let density: Vec<f32> = (0..60_000).map(|i| i as f32 * 5e-5).collect();
        for (d, shown) in density.iter().zip(print.pictures(&density)) {
            // The stated accuracy, plus rounding to 24 bits.
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

    /// The slope of log10 of the picture's light over log10 of the exposure is the product of both gradients, reduced by flare.
    #[test]
    fn gradients_of_film_and_paper_multiply() {
        let (film, step) = (film(), 1e-4);
        let x = log10(0.125);
        let print = Print::balanced(&soft(), 0.0, film.density(x), PictureBlack::Kept).expect("balanced");
        let slope = |of: &dyn Fn(f64) -> f64, at: f64| (of(at + step) - of(at - step)) / (2.0 * step);
        let found = slope(&|x| log10(print.picture(film.density(x))), x);
        let paper = CharacteristicCurve::from(soft().curve().expect("a paper"));
        let exposed = paper.log10_exposure_at(print.density(film.density(x))).expect("on the curve");
        let reflectance = exp(-LN_10 * print.density(film.density(x)));
        let want = slope(&|x| film.density(x), x) * slope(&|x| paper.density(x), exposed) * reflectance
            / (reflectance + FLARE);
        assert!((found - want).abs() < 1e-5, "{found} {want}");
    }

    /// Base and fog weaken the printing light and change nothing else.
    #[test]
    fn base_and_fog_do_not_change_the_picture() {
        let film = film();
        let gray = film.density(log10(0.125));
        let fogged = Print::balanced(&soft(), 0.3, gray + 0.3, PictureBlack::Stretched).expect("balanced");
        for i in 0..50 {
            let d = f64::from(i) * 0.05;
            assert!((fogged.picture(d + 0.3) - print().picture(d)).abs() < 1e-12);
        }
    }

    #[test]
    fn a_gray_as_clear_as_the_film_cannot_be_printed() {
        assert!(Print::balanced(&Paper::default(), 0.3, 0.3, PictureBlack::Kept).is_err());
        assert!(Print::balanced(&Paper { range: -1.0, ..Paper::default() }, 0.0, 0.8, PictureBlack::Kept).is_err());
    }
}
