//! Spectral bands of a picture.

use spectra_spectrum::Observer;
use spectra_spectrum::constants::LUMINOUS_EFFICACY_LM_PER_W;

/// A band of a spectral picture. Its channel holds the mean spectral irradiance, W m^-2 nm^-1.
#[derive(Clone, Debug, PartialEq)]
pub struct Band {
    /// Index of the channel in the file.
    pub channel: usize,
    /// Lower and upper edge, nm.
    pub edges_nm: [f64; 2],
    /// CIE XYZ (1931), lx, of a mean of 1 W m^-2 nm^-1 in the band.
    pub xyz: [f64; 3],
}

/// Reads the center of the band (nm) from the name of its channel (`S0.550,0nm`): A. Fichet, R. Pacanowski and A. Wilkie, "An
/// OpenEXR layout for spectral images", J. Computer Graphics Techniques 10 (2021). Only unpolarized light (`S0`) in nm is read.
pub(super) fn middle_nm(name: &str) -> Option<f64> {
    let number = name.strip_prefix("S0.")?.strip_suffix("nm")?.replace(',', ".");
    number.parse().ok().filter(|nm: &f64| nm.is_finite() && *nm > 0.0)
}

/// Returns the number by which the imager names a band with this center.
fn called(middle_nm: f64) -> String {
    format!("{middle_nm:.1}")
}

/// Returns the edges of bands with these centers, both in nm and in ascending order; `None` for fewer than two bands. Names are
/// rounded to a tenth of a nanometer. Bands of equal width whose outer edges lie on tenths of a nanometer are therefore found by
/// comparing the names that they would have. Otherwise an edge lies midway between neighbors.
pub(super) fn edges_nm(middles_nm: &[f64]) -> Option<Vec<f64>> {
    let [first, .., last] = *middles_nm else { return None };
    let count = middles_nm.len();
    let width = (last - first) / (count - 1) as f64;
    let [start, end] = [first - 0.5 * width, last + 0.5 * width].map(|nm| (10.0 * nm).round_ties_even() / 10.0);
    let names: Vec<String> = middles_nm.iter().map(|nm| called(*nm)).collect();
    // Try the nearest tenths to this edge, whole nanometers first, because people write those.
    let near = |nm: f64| {
        let mut all: Vec<f64> = (-2..=2).map(|i| (10.0 * nm + f64::from(i)).round_ties_even() / 10.0).collect();
        all.sort_by_key(|nm| nm.fract() != 0.0);
        all
    };
    for from in near(start) {
        for to in near(end) {
            let width = (to - from) / count as f64;
            if names.iter().enumerate().all(|(i, name)| called(from + width * i as f64 + 0.5 * width) == *name) {
                return Some((0..=count).map(|i| from + width * i as f64).collect());
            }
        }
    }
    let between = middles_nm.windows(2).map(|pair| 0.5 * (pair[0] + pair[1]));
    let ends = [1.5 * first - 0.5 * middles_nm[1], 1.5 * last - 0.5 * middles_nm[count - 2]];
    Some(std::iter::once(ends[0]).chain(between).chain([ends[1]]).collect())
}

/// Computes XYZ, lx, of 1 W m^-2 nm^-1 between these edges.
pub(super) fn xyz_of_band(edges_nm: [f64; 2]) -> [f64; 3] {
    const STEP_NM: f64 = 0.1;
    let [from, to] = edges_nm;
    let steps = ((to - from) / STEP_NM).ceil().clamp(1.0, 1e5);
    let step = (to - from) / steps;
    let observer = Observer::cie_1931_2deg();
    let mut sum = [0.0; 3];
    for i in 0..steps as usize {
        let at = observer.at(from + (i as f64 + 0.5) * step);
        sum.iter_mut().zip(at).for_each(|(sum, v)| *sum += v * step * LUMINOUS_EFFICACY_LM_PER_W);
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_follow_from_rounded_names() {
        for (count, from, to) in [(16_usize, 400.0, 700.0), (40, 380.0, 780.0), (256, 350.0, 830.0), (2, 500.0, 501.0)]
        {
            let width = (to - from) / count as f64;
            let name = |i: usize| called(from + (i as f64 + 0.5) * width).parse().expect("a number");
            let middles: Vec<f64> = (0..count).map(name).collect();
            let edges = edges_nm(&middles).expect("two bands or more");
            assert_eq!(edges.len(), count + 1);
            assert!((edges[0] - from).abs() < 1e-9 && (edges[count] - to).abs() < 1e-9, "{count}: {edges:?}");
        }
        assert_eq!(edges_nm(&[400.0, 500.0, 650.0]), Some(vec![350.0, 450.0, 575.0, 725.0]));
        assert_eq!(edges_nm(&[400.0]), None);
        assert_eq!([middle_nm("S0.409,4nm"), middle_nm("S1.409,4nm"), middle_nm("S0.x")], [Some(409.4), None, None]);
    }

    /// The integral of y-bar is 106.857 nm (CIE 1931, sums of 1 nm from 360 to 830 nm).
    #[test]
    fn a_watt_is_683_lumens_times_v() {
        let y = xyz_of_band([360.0, 830.0])[1];
        assert!((y / (LUMINOUS_EFFICACY_LM_PER_W * 106.857) - 1.0).abs() < 1e-5, "{y}");
    }
}
