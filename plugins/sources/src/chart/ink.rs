//! Inks with which a chart is printed.

/// The 24 patches of a classic ColorChecker, row by row from the top left.
///
/// The names are those of colour-science for its data set `ISO 17321-1`.
pub const PATCHES: [&str; 24] = [
    "dark skin",
    "light skin",
    "blue sky",
    "foliage",
    "blue flower",
    "bluish green",
    "orange",
    "purplish blue",
    "moderate red",
    "purple",
    "yellow green",
    "orange yellow",
    "blue",
    "green",
    "red",
    "yellow",
    "magenta",
    "cyan",
    "white 9.5 (.05 D)",
    "neutral 8 (.23 D)",
    "neutral 6.5 (.44 D)",
    "neutral 5 (.70 D)",
    "neutral 3.5 (1.05 D)",
    "black 2 (1.5 D)",
];

/// Ink number of points outside the chart.
pub const NO_INK: u16 = u16::MAX;

/// An ink of a chart: a uniform, opaque, diffuse color.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ink {
    /// A color in encoded sRGB (the values of a picture file, not linear light; IEC 61966-2-1), each 0 to 1.
    Rgb([f64; 3]),
    /// The measured reflectance of a ColorChecker patch, by its name in [`PATCHES`].
    Patch(&'static str),
    /// A spectrally neutral reflectance: the same linear factor, 0 to 1, at every wavelength.
    Gray(f64),
    /// A patch with the user's reflectance, by number from 0.
    Own(u16),
}

impl Ink {
    /// Creates a neutral ink of optical density `density` (decadic): reflectance 10^-density.
    #[must_use]
    pub fn density(density: f64) -> Self {
        Self::Gray(libm::pow(10.0, -density))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patch_names_are_unique() {
        for (i, name) in PATCHES.iter().enumerate() {
            assert!(!PATCHES[..i].contains(name), "{name}");
        }
    }

    #[test]
    fn density_is_decadic() {
        let Ink::Gray(reflectance) = Ink::density(0.3) else { panic!("density gives a gray") };
        assert!((reflectance - 0.501_187_233_627_272_2).abs() < 1e-15);
        assert_eq!(Ink::density(0.0), Ink::Gray(1.0));
    }
}
