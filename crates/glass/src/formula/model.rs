//! Glasses that are known by an index and an Abbe number only, or by the indices at a few lines.
//!
//! Two figures leave the curve between and beyond the lines open. Ordinary glasses settle it: their partial dispersions lie on
//! straight lines over the Abbe number, the normal lines of Schott's technical information TIE-29. The model is the polynomial
//! in 1, L^2, L^-2, L^-4 and L^-6 (Schott's old series, for n instead of n^2) that has nd, n_F - n_C and the normal P_g,F,
//! P_C,s and P_i,g. Nine of ten optical glasses of the catalogue lie within 4e-4 of it at g, 9e-4 at h, 2e-4 at r. Glasses that
//! depart from the normal lines by design (fluor and phosphate crowns, short flints, dense flints) are farther off. Indices at
//! more lines, if stated, take the place of the normal lines.

use crate::lines::{C, D, F, G, I, Line, LineTriple, S};
use spectra_numerics::linear;

/// Partial dispersions of the normal lines over F - C, g - F, C - s, i - g: P = intercept + slope Vd.
const INTERCEPT: [f64; 4] = [1.0, 0.6438, 0.4029, 1.7241];
const SLOPE: [f64; 4] = [0.0, -0.001_682, 0.002_331, -0.008_382];
/// Pairs of lines that these partial dispersions lie between.
const SPANS: [(Line, Line); 4] = [(F, C), (G, F), (C, S), (I, G)];
/// Largest Abbe number to which the lines are extended: beyond it the index would rise again in the red.
const LARGEST_VD: f64 = 140.0;

/// Departure of P_g,F from its normal line in the catalogue's glasses, root mean square.
const SPREAD_G_F: f64 = 0.006;
/// Departure of P_C,s and P_i,g per departure of P_g,F in the same glasses, and the spread of the rest.
const C_S_WITH_G_F: (f64, f64) = (-0.7, 0.006);
const I_G_WITH_G_F: (f64, f64) = (6.3, 0.012);
/// Tolerance within which stated indices are met; patents have five or six decimals.
const INDEX: f64 = 1e-6;
/// Relative tolerance within which a stated Abbe number is met if indices at other lines are stated, too.
const ABBE: f64 = 1e-4;

/// Returns L^2, L^-2, L^-4, L^-6 at a wavelength, L in micrometers.
fn powers(wavelength_nm: f64) -> [f64; 4] {
    let square = wavelength_nm * wavelength_nm * 1e-6;
    let inverse = 1.0 / square;
    [square, inverse, inverse * inverse, inverse * inverse * inverse]
}

fn sum(coefficients: &[f64; 4], wavelength_nm: f64) -> f64 {
    let [a, b, c, d] = powers(wavelength_nm);
    let [ka, kb, kc, kd] = coefficients;
    ka * a + kb * b + kc * c + kd * d
}

fn difference(coefficients: &[f64; 4], from: Line, to: Line) -> f64 {
    sum(coefficients, from.wavelength_nm) - sum(coefficients, to.wavelength_nm)
}

/// Returns the coefficients of L^2, L^-2, L^-4, L^-6 that have these differences over [`SPANS`].
fn series(differences: [f64; 4]) -> [f64; 4] {
    let row = |(from, to): (Line, Line)| {
        let (a, b) = (powers(from.wavelength_nm), powers(to.wavelength_nm));
        std::array::from_fn::<f64, 4, _>(|k| a[k] - b[k])
    };
    let matrix: Vec<f64> = SPANS.into_iter().flat_map(row).collect();
    let solution = linear::solve(&matrix, &differences).unwrap_or_default();
    std::array::from_fn(|k| solution.get(k).copied().unwrap_or(0.0))
}

fn combine(a: &[f64; 4], factor: f64, b: &[f64; 4]) -> [f64; 4] {
    std::array::from_fn(|k| a[k] + factor * b[k])
}

/// A glass on the normal lines of partial dispersion, through a stated index and Abbe number at any line triple, or
/// through the indices at several lines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModelGlass {
    index_mid: f64,
    abbe_number: f64,
    lines: LineTriple,
    stated_lines: usize,
    constant: f64,
    coefficients: [f64; 4],
}

impl ModelGlass {
    /// Creates the model with index `n` at the middle line of `lines` and Abbe number `v` for these lines; an infinite or zero
    /// `v` means no dispersion. `None` unless `n` is finite and at least 1, `v` is not negative, and the three lines are in
    /// order (short, then long, beyond 200 nm).
    #[must_use]
    pub fn new(n: f64, v: f64, lines: LineTriple) -> Option<ModelGlass> {
        let (short, mid, long) = (lines.short.wavelength_nm, lines.mid.wavelength_nm, lines.long.wavelength_nm);
        let in_order = 200.0 <= short && short < long && 200.0 <= mid;
        if !(n.is_finite() && n >= 1.0 && v >= 0.0 && in_order) {
            return None;
        }
        let stated = (n - 1.0) / v;
        let coefficients = if v == 0.0 || stated == 0.0 { [0.0; 4] } else { normal(n, stated, lines)? };
        let constant = n - sum(&coefficients, mid);
        Some(ModelGlass { index_mid: n, abbe_number: v, lines, stated_lines: 1, constant, coefficients })
    }

    /// Creates the model through the indices stated at several lines, and the stated Abbe numbers with their lines. What these
    /// leave open follows the normal lines of partial dispersion. Departures from the normal lines are weighted by their spread
    /// among the catalogue's glasses.
    ///
    /// The first index is met to the last bit, the others within 1e-6 unless they contradict each other; the caller has to
    /// compare. `None` with fewer than two figures, an index below 1 or above 4, the same line twice, figures without dispersion,
    /// or an Abbe number that is not positive and finite.
    #[must_use]
    pub fn through(indices: &[(Line, f64)], abbe: &[(f64, LineTriple)]) -> Option<ModelGlass> {
        if let (&[(line, n)], &[(v, lines)]) = (indices, abbe)
            && line == lines.mid
        {
            return ModelGlass::new(n, v, lines).filter(|_| v > 0.0 && v.is_finite());
        }
        let &(first, n_first) = indices.first()?;
        let usable = indices.iter().all(|(_, n)| (1.0..=4.0).contains(n))
            && abbe.iter().all(|(v, _)| *v > 0.0 && v.is_finite())
            && (1..indices.len())
                .all(|i| indices[..i].iter().all(|other| other.0.wavelength_nm != indices[i].0.wavelength_nm));
        if !usable || indices.len() + abbe.len() < 2 {
            return None;
        }
        // Unknown: nd - 1, n_F - n_C, and the departures of the three partial dispersions, times n_F - n_C.
        let (intercept, slope) = (series(INTERCEPT), series(SLOPE));
        let units: [[f64; 4]; 3] =
            std::array::from_fn(|k| series(std::array::from_fn(|i| f64::from(u8::from(i == k + 1)))));
        let at = |line: Line| -> [f64; 5] {
            let of = |shape: &[f64; 4]| difference(shape, line, D);
            [1.0 + of(&slope), of(&intercept), of(&units[0]), of(&units[1]), of(&units[2])]
        };
        let scale = match abbe.first() {
            Some((v, _)) => (n_first - 1.0) / v,
            None => {
                let by_line = |a: &&(Line, f64), b: &&(Line, f64)| a.0.wavelength_nm.total_cmp(&b.0.wavelength_nm);
                let (short, long) = (indices.iter().min_by(by_line)?, indices.iter().max_by(by_line)?);
                (short.1 - long.1) / difference(&combine(&intercept, 50.0, &slope), short.0, long.0)
            }
        };
        if !(scale > 0.0 && scale.is_finite()) {
            return None;
        }
        let mut rows: Vec<[f64; 5]> = Vec::new();
        let mut wanted = Vec::new();
        let mut state = |row: [f64; 5], value: f64, tolerance: f64| {
            rows.push(row.map(|entry| entry / tolerance));
            wanted.push(value / tolerance);
        };
        for &(line, n) in indices {
            state(at(line), n - 1.0, INDEX);
        }
        for (v, lines) in abbe {
            let (short, mid, long) = (at(lines.short), at(lines.mid), at(lines.long));
            state(std::array::from_fn(|k| short[k] - long[k] - mid[k] / v), 0.0, ABBE * scale);
        }
        state([0.0, 0.0, 1.0, 0.0, 0.0], 0.0, SPREAD_G_F * scale);
        state([0.0, 0.0, -C_S_WITH_G_F.0, 1.0, 0.0], 0.0, C_S_WITH_G_F.1 * scale);
        state([0.0, 0.0, -I_G_WITH_G_F.0, 0.0, 1.0], 0.0, I_G_WITH_G_F.1 * scale);
        let found = linear::least_squares(&rows.concat(), &wanted, 5)?;
        let mut coefficients = combine(&combine(&[0.0; 4], found[1], &intercept), found[0], &slope);
        for (unit, departure) in units.iter().zip(&found[2..]) {
            coefficients = combine(&coefficients, *departure, unit);
        }
        let constant = n_first - sum(&coefficients, first.wavelength_nm);
        let mut model = ModelGlass {
            index_mid: n_first,
            abbe_number: f64::INFINITY,
            lines: LineTriple::FDC,
            stated_lines: indices.len(),
            constant,
            coefficients,
        };
        model.index_mid = model.index(D.wavelength_nm);
        model.abbe_number = LineTriple::FDC.abbe_number(|w| model.index(w));
        model.index_mid.is_finite().then_some(model).filter(|m| m.abbe_number > 0.0)
    }

    /// Refractive index at a wavelength in nm.
    #[must_use]
    pub fn index(&self, wavelength_nm: f64) -> f64 {
        self.constant + sum(&self.coefficients, wavelength_nm)
    }

    /// Returns whether the index falls with wavelength all the way from 350 to 830 nm, as in every glass.
    #[must_use]
    pub fn falls(&self) -> bool {
        (350..830).all(|nm| self.index(f64::from(nm)) > self.index(f64::from(nm + 1)))
    }

    /// Stated index; for a model through several lines, the index at d.
    #[must_use]
    pub fn index_mid(&self) -> f64 {
        self.index_mid
    }

    /// Stated Abbe number; for a model through several lines, the one for d, F and C.
    #[must_use]
    pub fn abbe_number(&self) -> f64 {
        self.abbe_number
    }

    /// Lines of the stated index and Abbe number.
    #[must_use]
    pub fn lines(&self) -> LineTriple {
        self.lines
    }

    /// Number of lines at which an index was stated.
    #[must_use]
    pub fn stated_lines(&self) -> usize {
        self.stated_lines
    }
}

/// Returns the coefficients of the normal glass with index `n` at the middle line and `stated` = n_short - n_long.
fn normal(n: f64, stated: f64, lines: LineTriple) -> Option<[f64; 4]> {
    let (intercept, slope) = (series(INTERCEPT), series(SLOPE));
    let over = |shape: &[f64; 4]| difference(shape, lines.short, lines.long);
    // n_F - n_C and Vd. Coefficients are linear in n_F - n_C and in their product, nd - 1.
    let (dispersion, vd) = if lines == LineTriple::FDC {
        (stated, (n - 1.0) / stated)
    } else {
        let to_d = |shape: &[f64; 4]| difference(shape, lines.mid, D);
        let (a, b, c, d) = (over(&intercept), over(&slope), to_d(&intercept), 1.0 + to_d(&slope));
        let determinant = a * d - b * c;
        let dispersion = (stated * d - b * (n - 1.0)) / determinant;
        let nd_less_1 = (a * (n - 1.0) - c * stated) / determinant;
        (dispersion, nd_less_1 / dispersion)
    };
    if dispersion > 0.0 && vd <= LARGEST_VD {
        return Some(combine(&[0.0; 4], dispersion, &combine(&intercept, vd, &slope)));
    }
    let shape = combine(&intercept, LARGEST_VD, &slope);
    let factor = stated / over(&shape);
    (factor.is_finite() && factor > 0.0).then(|| combine(&[0.0; 4], factor, &shape))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lines::{E, H};

    fn partial(model: &ModelGlass, from: Line, to: Line) -> f64 {
        let n = |line: Line| model.index(line.wavelength_nm);
        (n(from) - n(to)) / (n(F) - n(C))
    }

    #[test]
    fn gives_back_what_was_stated_for_any_lines() {
        for lines in [LineTriple::FDC, LineTriple::F_SODIUM_C, LineTriple::FEC, LineTriple::F_PRIME_E_C_PRIME] {
            for (n, v) in [(1.5168, 64.17), (1.78472, 25.68), (1.43875, 94.95), (1.64329, 47.72), (1.5, 190.0)] {
                let model = ModelGlass::new(n, v, lines).expect("a glass");
                assert!((model.index(lines.mid.wavelength_nm) - n).abs() < 1e-15);
                assert!((lines.abbe_number(|w| model.index(w)) - v).abs() < 1e-10 * v);
            }
        }
    }

    /// TIE-29's normal lines, including P_F,e, which the model does not use.
    #[test]
    fn partial_dispersions_lie_on_the_normal_lines_and_the_index_falls() {
        for tenths in 200..=950 {
            let vd = f64::from(tenths) * 0.1;
            for nd in [1.44, 1.6, 1.85] {
                let model = ModelGlass::new(nd, vd, LineTriple::FDC).expect("a glass");
                assert!((partial(&model, G, F) - (0.6438 - 0.001_682 * vd)).abs() < 2e-4, "P_gF at {vd}");
                assert!((partial(&model, F, E) - (0.4884 - 0.000_526 * vd)).abs() < 5e-4, "P_Fe at {vd}");
                let mut last = f64::INFINITY;
                for nm in (3500..=8300).step_by(5) {
                    let n = model.index(f64::from(nm) * 0.1);
                    assert!(n < last, "Vd {vd}: the index rises at {nm} / 10 nm");
                    last = n;
                }
            }
        }
        // Abbe numbers that a lens file may state, too: from 5 to 200.
        for vd in [5.0, 10.0, 15.0, 110.0, 139.0, 141.0, 170.0, 200.0] {
            let model = ModelGlass::new(1.5, vd, LineTriple::FDC).expect("a glass");
            assert!((350..830).all(|nm| model.index(f64::from(nm)) > model.index(f64::from(nm + 1))), "{vd}");
        }
    }

    /// nd and Vd at the makers' own precision against the makers' ng and nh (Schott's data sheets).
    #[test]
    fn follows_an_ordinary_glass() {
        for (nd, vd, ng, nh) in [(1.5168, 64.17, 1.526_68, 1.530_24), (1.620_04, 36.37, 1.642_02, 1.650_64)] {
            let model = ModelGlass::new(nd, vd, LineTriple::FDC).expect("a glass");
            assert!((model.index(G.wavelength_nm) - ng).abs() < 5e-5);
            assert!((model.index(H.wavelength_nm) - nh).abs() < 1e-4);
        }
    }

    /// ne and Ve of N-BK7 say the same as nd and Vd.
    #[test]
    fn other_reference_lines_are_the_same_family() {
        let d = ModelGlass::new(1.5168, 64.17, LineTriple::FDC).expect("a glass");
        for lines in [LineTriple::F_SODIUM_C, LineTriple::F_PRIME_E_C_PRIME, LineTriple::FEC] {
            let v = lines.abbe_number(|w| d.index(w));
            let other = ModelGlass::new(d.index(lines.mid.wavelength_nm), v, lines).expect("a glass");
            for nm in 350..=830 {
                assert!((other.index(f64::from(nm)) - d.index(f64::from(nm))).abs() < 1e-12, "{nm}");
            }
        }
    }

    /// SF6 departs from the normal line by 0.009 in P_g,F; with ng, or nF' and ng of the data sheet, n_h comes right.
    #[test]
    fn more_lines_take_the_place_of_the_normal_lines() {
        let (nd, vd, ng, nh, ne) = (1.805_18, 25.43, 1.847_073, 1.864_365, 1.812_65);
        let n_h = |model: &ModelGlass| (model.index(H.wavelength_nm) - nh).abs();
        let plain = ModelGlass::new(nd, vd, LineTriple::FDC).expect("a glass");
        let with_g = ModelGlass::through(&[(D, nd), (G, ng)], &[(vd, LineTriple::FDC)]).expect("a glass");
        assert!(n_h(&plain) > 6e-4 && n_h(&with_g) < 1e-4, "{} {}", n_h(&plain), n_h(&with_g));
        assert!((with_g.index(G.wavelength_nm) - ng).abs() < 1e-6 && with_g.index(D.wavelength_nm) == nd);
        assert!((with_g.abbe_number() - vd).abs() < 1e-2 && with_g.stated_lines() == 2);
        // Without an Abbe number two lines give it: nd and ng, or nd, ne and ng.
        for lines in [&[(D, nd), (G, ng)][..], &[(D, nd), (E, ne), (G, ng)]] {
            let model = ModelGlass::through(lines, &[]).expect("a glass");
            assert!(lines.iter().all(|(line, n)| (model.index(line.wavelength_nm) - n).abs() < 3e-6));
            assert!((model.abbe_number() - vd).abs() < 0.25, "{}", model.abbe_number());
        }
        // One index with its Abbe number is the plain model.
        let same = ModelGlass::through(&[(E, 1.518_722)], &[(63.96, LineTriple::F_PRIME_E_C_PRIME)]);
        assert_eq!(same, ModelGlass::new(1.518_722, 63.96, LineTriple::F_PRIME_E_C_PRIME));
        for (indices, abbe) in [
            (&[(D, 1.5)][..], &[][..]),
            (&[], &[(60.0, LineTriple::FDC)]),
            (&[(D, 1.5), (D, 1.6)], &[]),
            (&[(D, 1.5), (G, 1.4)], &[]),
            (&[(D, 1.5), (G, 9.0)], &[]),
            (&[(D, 1.5), (G, 1.51)], &[(-5.0, LineTriple::FDC)]),
        ] {
            assert_eq!(ModelGlass::through(indices, abbe), None, "{indices:?}");
        }
    }

    #[test]
    fn no_dispersion_and_no_glass() {
        for v in [0.0, f64::INFINITY] {
            let model = ModelGlass::new(1.5, v, LineTriple::FDC).expect("a glass");
            assert_eq!(model.index(350.0), model.index(830.0));
        }
        for (n, v) in [(0.9, 50.0), (f64::NAN, 50.0), (1.5, -1.0), (1.5, f64::NAN)] {
            assert!(ModelGlass::new(n, v, LineTriple::FDC).is_none());
        }
    }
}
