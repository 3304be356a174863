//! Dominant wavelength and excitation purity.

use spectra_spectrum::Observer;
use std::sync::OnceLock;

/// The wavelength of the spectral color that yields a given color when mixed with white, and the color's purity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dominant {
    /// Dominant wavelength, nm; for a purple, the complementary wavelength.
    pub wavelength_nm: f64,
    /// Whether the color is a purple, which lies on the far side of white from `wavelength_nm`.
    pub complementary: bool,
    /// Excitation purity: 0 at white, 1 on the spectral locus or the line of purples.
    pub purity: f64,
}

/// Range of wavelengths (nm) over which the chromaticity of the locus changes. Outside it the color matching functions keep their
/// ratios, and rounding would give the locus random directions.
const LOCUS_NM: (u32, u32) = (380, 699);

fn locus() -> &'static [(f64, [f64; 2])] {
    static ONE: OnceLock<Vec<(f64, [f64; 2])>> = OnceLock::new();
    ONE.get_or_init(|| {
        (LOCUS_NM.0..=LOCUS_NM.1)
            .map(|w| {
                let [x, y, z] = Observer::cie_1931_2deg().at(f64::from(w));
                (f64::from(w), [x / (x + y + z), y / (x + y + z)])
            })
            .collect()
    })
}

/// Finds where the ray from `from` along `along` crosses the segment from `a` to `b`. Returns the distance in lengths of `along` and the
/// fraction of the way from `a` to `b`.
fn crossing(from: [f64; 2], along: [f64; 2], a: [f64; 2], b: [f64; 2]) -> Option<(f64, f64)> {
    let edge = [b[0] - a[0], b[1] - a[1]];
    let to = [a[0] - from[0], a[1] - from[1]];
    let cross = along[0] * edge[1] - along[1] * edge[0];
    let distance = (to[0] * edge[1] - to[1] * edge[0]) / cross;
    let share = (to[0] * along[1] - to[1] * along[0]) / cross;
    (distance > 0.0 && (0.0..=1.0).contains(&share)).then_some((distance, share))
}

fn on_locus(from: [f64; 2], along: [f64; 2]) -> Option<(f64, f64)> {
    locus().windows(2).find_map(|pair| {
        let (distance, share) = crossing(from, along, pair[0].1, pair[1].1)?;
        Some((distance, pair[0].0 + share * (pair[1].0 - pair[0].0)))
    })
}

/// Computes the dominant wavelength of the chromaticity `xy` seen against `white_xy`, on the CIE 1931 locus between 380 and 699 nm.
///
/// Returns `None` if `xy` and `white_xy` agree within 1e-6, or if the white lies outside the diagram.
#[must_use]
pub fn dominant_wavelength(xy: [f64; 2], white_xy: [f64; 2]) -> Option<Dominant> {
    let along = [xy[0] - white_xy[0], xy[1] - white_xy[1]];
    if !(along[0].abs() > 1e-6 || along[1].abs() > 1e-6) {
        return None;
    }
    let (first, last) = (locus()[0].1, locus()[locus().len() - 1].1);
    let on_purples = |along| crossing(white_xy, along, last, first).map(|(distance, _)| distance);
    let back = along.map(|c| -c);
    // From a white inside the diagram each direction meets its boundary once: on the locus, or on the line of purples.
    if let Some((distance, wavelength_nm)) = on_locus(white_xy, along) {
        let within = on_locus(white_xy, back).is_some() || on_purples(back).is_some();
        return within.then_some(Dominant { wavelength_nm, complementary: false, purity: 1.0 / distance });
    }
    let (_, wavelength_nm) = on_locus(white_xy, back)?;
    let distance = on_purples(along)?;
    Some(Dominant { wavelength_nm, complementary: true, purity: 1.0 / distance })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chromaticity;
    use spectra_spectrum::Emission;

    const E: [f64; 2] = [1.0 / 3.0, 1.0 / 3.0];
    const D65: [f64; 2] = [0.3127, 0.3290];

    #[test]
    fn a_line_dominates_itself_with_full_purity() {
        for nm in [400.0, 450.25, 486.1, 546.074, 589.3, 650.0, 690.0] {
            let line = Emission::line(nm, 1.0).expect("valid");
            let xy = chromaticity(Observer::cie_1931_2deg().xyz(&line)).expect("light");
            let got = dominant_wavelength(xy, E).expect("not white");
            assert!((got.wavelength_nm - nm).abs() < 0.02 && !got.complementary, "{nm}: {got:?}");
            assert!((got.purity - 1.0).abs() < 1e-3, "{nm}: {got:?}");
            // Half way to white: the same wavelength, half the purity.
            let half = dominant_wavelength([0.5 * (xy[0] + E[0]), 0.5 * (xy[1] + E[1])], E).expect("not white");
            assert!(
                (half.wavelength_nm - got.wavelength_nm).abs() < 1e-9 && (half.purity - 0.5 * got.purity).abs() < 1e-9
            );
        }
    }

    /// Compares the sRGB primaries under D65 with colour-science 0.4.7, which gives whole nanometers.
    #[test]
    fn srgb_primaries() {
        for (xy, want) in [([0.64, 0.33], 611.0), ([0.30, 0.60], 549.0), ([0.15, 0.06], 464.0)] {
            let got = dominant_wavelength(xy, D65).expect("not white");
            assert!((got.wavelength_nm - want).abs() < 0.6 && !got.complementary, "{xy:?} {got:?}");
        }
    }

    #[test]
    fn purples_have_a_complement() {
        let got = dominant_wavelength([0.32, 0.15], D65).expect("not white");
        // colour-science 0.4.7 gives 549 nm, in whole nanometers.
        assert!(got.complementary && (got.wavelength_nm - 549.0).abs() < 0.6, "{got:?}");
        assert!((0.0..1.0).contains(&got.purity));
    }

    #[test]
    fn white_has_none() {
        assert_eq!(dominant_wavelength(D65, D65), None);
        assert_eq!(dominant_wavelength([f64::NAN, 0.3], D65), None);
        assert_eq!(dominant_wavelength([0.3, 0.3], [2.0, 2.0]), None);
    }
}
