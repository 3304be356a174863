//! Patches of the ColorChecker, the usual test chart for cameras.

/// Names of the 24 patches of the ColorChecker, row by row from the top left. They are the columns of `colorchecker`, so that
/// `colorchecker#dark-skin` is the reflectance of the first. The last six are white, four grays and black.
pub const COLOR_CHECKER: [&str; 24] = [
    "dark-skin",
    "light-skin",
    "blue-sky",
    "foliage",
    "blue-flower",
    "bluish-green",
    "orange",
    "purplish-blue",
    "moderate-red",
    "purple",
    "yellow-green",
    "orange-yellow",
    "blue",
    "green",
    "red",
    "yellow",
    "magenta",
    "cyan",
    "white",
    "neutral-8",
    "neutral-6.5",
    "neutral-5",
    "neutral-3.5",
    "black",
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{BAND, find_reflectance};

    /// Every patch is bundled; the last row gets darker from patch to patch.
    #[test]
    fn every_patch_has_a_reflectance() {
        let paint = |name: &&str| find_reflectance(&format!("colorchecker#{name}")).expect("bundled");
        let mean = |name: &&str| BAND.wavelengths_nm().map(|w| paint(name).at(w)).sum::<f64>() / BAND.count as f64;
        let means: Vec<f64> = COLOR_CHECKER.iter().map(mean).collect();
        assert!(means.iter().all(|m| *m > 0.02 && *m < 0.95), "{means:?}");
        assert!(means[18..].windows(2).all(|pair| pair[0] > 1.3 * pair[1]), "{means:?}");
    }
}
