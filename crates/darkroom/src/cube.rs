//! A film stock as a 3-D look-up table for other programs: from scene light to the picture, color by color.
//!
//! The table leaves out effects that need a pixel's neighbors: scatter, halation, adjacency, grain, and the lens of the printer
//! or scanner.

use crate::pipeline::{FilmPipeline, GRAY};
use rayon::prelude::*;
use spectra_color::{RgbSpace, ciede2000, lab, xyz_of_reflectance};
use spectra_core::math::{log2, pow};
use spectra_core::numbers::mix64;
use spectra_core::params::Fault;
use spectra_core::spectral::{BAND, Line, SpectralPower};
use spectra_spectrum::{COLOR_CHECKER, Observer, find_reflectance, illuminant};
use std::fmt::Write as _;

/// A 3-D look-up table to compute: film, light and resolution.
pub struct Cube {
    /// The film, exposed in the light of the scene.
    pub film: FilmPipeline,
    /// Name of the light of the scene.
    pub illuminant: String,
    /// Number of points along each side.
    pub size: usize,
    /// Range of a side in stops, half of them above mid gray.
    pub stops: f64,
}

/// Color errors of a table, as CIEDE2000 differences between its pictures and those of the film that it was computed from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CubeErrors {
    /// Errors for [`RANDOM_COLORS`] random screen colors, read as picture files are: mean, 95th percentile, largest.
    pub colors: [f64; 3],
    /// Errors for the 24 patches of a ColorChecker: mean, largest. The film is exposed to their measured reflectances, and the
    /// table gets their colors.
    pub reflectances: [f64; 2],
}

/// A computed look-up table, as text.
#[derive(Clone, Debug)]
pub struct CubeFile {
    /// Content of the `.cube` file.
    pub text: String,
    /// Description of the film.
    pub film: String,
    /// Errors of the table against the film.
    pub errors: CubeErrors,
}

/// Number of random colors that a table is tested with.
pub const RANDOM_COLORS: usize = 10_000;

impl Cube {
    /// Computes the table. `version` is written into its header.
    ///
    /// # Errors
    /// A message: the film cannot be developed.
    pub fn file(&self, version: &str) -> Result<CubeFile, Fault> {
        let chain = &self.film;
        let side: Vec<f64> = (0..self.size).map(|i| self.linear(i as f64 / (self.size - 1) as f64)).collect();
        let mut lattice = Vec::with_capacity(self.size * self.size * self.size);
        // Red varies fastest, as in every `.cube` file.
        for b in &side {
            for g in &side {
                lattice.extend(side.iter().map(|r| [*r, *g, *b]));
            }
        }
        let exposures: Vec<Vec<f64>> =
            lattice.par_iter().map(|rgb| chain.exposures(&chain.model.spectrum(*rgb))).collect();
        let points = chain.pictures(&exposures)?;
        let errors = self.errors(&points)?;
        let film = chain.film.describe();
        let mut text = self.header(&film, version, errors);
        for [r, g, b] in &points {
            // Writing to a String cannot fail.
            let _ = writeln!(text, "{r:.6} {g:.6} {b:.6}");
        }
        Ok(CubeFile { text, film, errors })
    }

    /// Returns the linear light at a place from 0 to 1 along a side.
    fn linear(&self, place: f64) -> f64 {
        GRAY * pow(2.0, (place - 0.5) * self.stops)
    }

    /// Returns the place from 0 to 1 along a side of some linear light; values outside the table get its ends.
    fn place(&self, linear: f64) -> f64 {
        if linear <= 0.0 { 0.0 } else { (0.5 + log2(linear / GRAY) / self.stops).clamp(0.0, 1.0) }
    }

    /// Interpolates the table trilinearly, as other programs do.
    fn at(&self, points: &[[f64; 3]], rgb: [f64; 3]) -> [f64; 3] {
        let cells = rgb.map(|v| {
            let p = self.place(v) * (self.size - 1) as f64;
            let i = (p as usize).min(self.size - 2);
            (i, p - i as f64)
        });
        let mut sum = [0.0; 3];
        for corner in 0..8_usize {
            let [r, g, b] = [0, 1, 2].map(|k| (corner >> k) & 1);
            let weight: f64 =
                [r, g, b].iter().zip(cells).map(|(up, (_, t))| if *up == 1 { t } else { 1.0 - t }).product();
            let point = points[((cells[2].0 + b) * self.size + cells[1].0 + g) * self.size + cells[0].0 + r];
            sum.iter_mut().zip(point).for_each(|(s, p)| *s += weight * p);
        }
        sum
    }

    fn errors(&self, points: &[[f64; 3]]) -> Result<CubeErrors, Fault> {
        let chain = &self.film;
        let space = RgbSpace::srgb();
        let of_code = |code: u64| space.transfer.decode((code & 0xff) as f64 / 255.0);
        let colors: Vec<[f64; 3]> = (0..RANDOM_COLORS as u64)
            .map(mix64)
            .map(|bits| [of_code(bits), of_code(bits >> 8), of_code(bits >> 16)])
            .collect();
        let mut off = self.differences(
            points,
            &colors,
            &chain.pictures_of_lights(colors.iter().map(|rgb| chain.model.spectrum(*rgb)))?,
        );
        let mean = |off: &[f64]| off.iter().sum::<f64>() / off.len().max(1) as f64;
        let of_colors = mean(&off);
        off.sort_by(f64::total_cmp);
        let largest = |off: &[f64]| off.iter().copied().fold(0.0, f64::max);
        let colors = [of_colors, off[off.len() * 95 / 100], largest(&off)];

        let daylight = illuminant("D65").map_err(|e| Fault::new(e.to_string()))?;
        let observer = Observer::cie_1931_2deg();
        let white = chain.model.spectrum([1.0; 3]);
        let (mut seen, mut lights) = (Vec::new(), Vec::new());
        for patch in COLOR_CHECKER {
            let surface = find_reflectance(&format!("colorchecker#{patch}")).map_err(|e| Fault::new(e.to_string()))?;
            let xyz = xyz_of_reflectance(&surface, &daylight, observer).unwrap_or_default();
            seen.push(space.from_xyz(xyz.map(|v| v / 100.0)).map(|v| v.max(0.0)));
            let lit = white.continuum.iter().zip(surface.on_grid(&BAND)).map(|(p, r)| p * r).collect();
            let lines = white.lines.iter().map(|l| Line { power: l.power * surface.at(l.wavelength_nm), ..*l });
            lights.push(SpectralPower { grid: BAND, continuum: lit, lines: lines.collect() });
        }
        let off = self.differences(points, &seen, &chain.pictures_of_lights(lights.into_iter())?);
        Ok(CubeErrors { colors, reflectances: [mean(&off), largest(&off)] })
    }

    /// Returns the CIEDE2000 difference of each color between the table's picture and `pictures`, sRGB encoded.
    fn differences(&self, points: &[[f64; 3]], colors: &[[f64; 3]], pictures: &[[f64; 3]]) -> Vec<f64> {
        let space = RgbSpace::srgb();
        let look = |encoded: [f64; 3]| lab(space.to_xyz(space.decode(encoded)), space.white_xyz());
        colors
            .iter()
            .zip(pictures)
            .map(|(rgb, picture)| ciede2000(look(self.at(points, *rgb)), look(*picture)))
            .collect()
    }

    fn header(&self, film: &str, version: &str, errors: CubeErrors) -> String {
        let half = self.stops / 2.0;
        let low = log2(GRAY) - half;
        let [mean, p95, most] = errors.colors;
        let [patches, worst] = errors.reflectances;
        let title: String = film.chars().map(|c| if c == '"' || c.is_control() { ' ' } else { c }).collect();
        format!(
            "TITLE \"{title}\"\n\
             # spectra {version}: {title}\n\
             # Input: logarithm of linear scene light x in sRGB (Rec. 709) primaries, where 0.18 is mid gray as metered:\n\
             #   value = 0.5 + log2(x / 0.18) / {stops}, {half} stops to either side of mid gray. OpenColorIO: apply this file after\n\
             #   AllocationTransform {{allocation: lg2, vars: [{low:.6}, {high:.6}]}}.\n\
             # Scene light: {light}. Output: the picture, sRGB encoded, 0 to 1.\n\
             # Left out, because it needs the neighbors of a pixel: scatter, halation, adjacency, grain, the lens of printer or scanner.\n\
             # Error against the film without these, linear interpolation, CIEDE2000: {count} random screen colors mean {mean:.2},\n\
             #   95 % below {p95:.2}, largest {most:.2}; ColorChecker by measured reflectances mean {patches:.2}, largest {worst:.2}.\n\
             LUT_3D_SIZE {size}\nDOMAIN_MIN 0.0 0.0 0.0\nDOMAIN_MAX 1.0 1.0 1.0\n",
            stops = self.stops,
            high = low + self.stops,
            light = self.illuminant,
            count = RANDOM_COLORS,
            size = self.size,
        )
    }
}
