//! Spectral density of developed film, and how density is measured.

use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::math::pow;
use spectra_core::params::{Fault, Params};
use spectra_core::spectral::{BAND, Grid};
use spectra_spectrum::Kind;
use spectra_spectrum::table::Table;

/// Optical density (transmission, diffuse) over wavelength: linear between points, constant beyond them.
#[derive(Clone, Debug, PartialEq)]
pub struct SpectralDensity {
    points: Vec<[f64; 2]>,
}

impl SpectralDensity {
    /// Builds a density from points (wavelength in nm, density), wavelengths increasing.
    ///
    /// # Errors
    /// A text that says which point is wrong: wavelengths that do not increase, or values outside -1 to 10 (the difference of two
    /// measurements may be a little below 0). Also if there are no points.
    pub fn new(points: &[[f64; 2]]) -> Result<Self, Fault> {
        let mut before = 0.0;
        for [nm, density] in points {
            if !(*nm > before && nm.is_finite()) {
                return Err(Fault::new(format!("wavelengths must increase: {nm} nm comes after {before} nm")));
            }
            if !(-1.0..=10.0).contains(density) {
                return Err(Fault::new(format!("{density} at {nm} nm is not a density")));
            }
            before = *nm;
        }
        if points.is_empty() {
            return Err("a density needs at least one point".into());
        }
        Ok(Self { points: points.to_vec() })
    }

    /// Points of the table: wavelength in nm, and density.
    #[must_use]
    pub fn points(&self) -> &[[f64; 2]] {
        &self.points
    }

    /// Returns the density at a wavelength.
    #[must_use]
    pub fn at(&self, wavelength_nm: f64) -> f64 {
        let i = self.points.partition_point(|p| p[0] <= wavelength_nm);
        let last = self.points.len() - 1;
        if i == 0 || i > last {
            return self.points[i.min(last)][1];
        }
        let ([x0, y0], [x1, y1]) = (self.points[i - 1], self.points[i]);
        y0 + (y1 - y0) * (wavelength_nm - x0) / (x1 - x0)
    }

    /// Returns the densities at the wavelengths of a grid.
    #[must_use]
    pub fn on_grid(&self, grid: &Grid) -> Vec<f64> {
        grid.wavelengths_nm().map(|w| self.at(w)).collect()
    }
}

/// The dye of one layer: name and spectral density.
#[derive(Clone, Debug, PartialEq)]
pub struct Dye {
    /// Name of the dye: `cyan`, `magenta`, `yellow`.
    pub name: String,
    /// Spectral density of the unit amount; amounts are counted in this unit.
    pub density: SpectralDensity,
}

/// Minimum density of unexposed film: base, fog, mask.
#[derive(Clone, Debug, PartialEq)]
pub struct MinimumDensity {
    /// Spectral density of base, fog and mask.
    pub density: SpectralDensity,
    /// Whether the density is assumed because the sheet has none.
    pub assumed: bool,
    /// Reasons for the values.
    pub remark: Option<String>,
}

/// Densitometry with which the densities of a curve were measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Densitometry {
    /// Visual density, for silver: the same at all wavelengths.
    Visual,
    /// Status A of ISO 5-3: for positives, which are viewed.
    StatusA,
    /// Status M of ISO 5-3: for negatives, which are printed.
    StatusM,
}

impl Densitometry {
    /// Name of the densitometry in a stock file.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Visual => "visual",
            Self::StatusA => "status-a",
            Self::StatusM => "status-m",
        }
    }

    /// Returns the spectral products of the channels (ISO 5-3:2009) on the band, each with integral 1, for layers with these names. `None`
    /// for visual density, which is the same at all wavelengths, and if a name is not red, green or blue.
    #[must_use]
    pub fn products(self, names: &[&str]) -> Option<Vec<Vec<f64>>> {
        let path = match self {
            Self::Visual => return None,
            Self::StatusA => "spectra/film/status-a.csv",
            Self::StatusM => "spectra/film/status-m.csv",
        };
        let text = spectra_data::text(path)?;
        let table = Table::parse(path, text, Some(Kind::Sensitivity)).ok()?;
        names
            .iter()
            .map(|name| {
                let column = table.columns.iter().position(|c| c == name)?;
                // 0 means no response: the tables are logarithms with 5 at the peak.
                let points = table.wavelengths_nm.iter().zip(table.values[column].iter());
                let points: Vec<[f64; 2]> = points.map(|(w, v)| [*w, *v]).collect();
                let logarithm = SpectralDensity::new(&points).ok()?;
                let (first, last) = (points[0][0], points[points.len() - 1][0]);
                let product = |w: f64| match logarithm.at(w) {
                    v if v > 0.0 && w >= first && w <= last => pow(10.0, v - 5.0),
                    _ => 0.0,
                };
                let values: Vec<f64> = BAND.wavelengths_nm().map(product).collect();
                let sum: f64 = values.iter().sum();
                Some(values.into_iter().map(|v| v / sum).collect())
            })
            .collect()
    }
}

/// Densitometry with which densities were measured.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(super) enum DensityFile {
    /// Visual density: silver, gray.
    #[default]
    Visual,
    /// Status A of ISO 5-3: positives with dyes.
    StatusA,
    /// Status M of ISO 5-3: negatives with dyes.
    StatusM,
}

/// Checks the densitometry against the number of layers.
pub(super) fn densitometry(params: &Params, file: DensityFile, layers: usize) -> Result<Densitometry, Fault> {
    let densitometry = match file {
        DensityFile::Visual => Densitometry::Visual,
        DensityFile::StatusA => Densitometry::StatusA,
        DensityFile::StatusM => Densitometry::StatusM,
    };
    match (densitometry, layers) {
        (Densitometry::Visual, 2..) => {
            let fault = params.fault("density", "curves of several layers are measured through three filters");
            Err(fault.hint("`density: status-m` for negatives, `density: status-a` for positives"))
        }
        (Densitometry::StatusA | Densitometry::StatusM, layers) if layers != 3 => {
            let text = format!("{} densities need three layers, not {layers}", densitometry.name());
            Err(params.fault("density", text).hint("name the layers red, green and blue"))
        }
        _ => Ok(densitometry),
    }
}

/// The dye of a layer.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct DyeFile {
    /// Color or name of the dye.
    name: String,
    /// Pairs of wavelength (nm, ascending) and density of the amount 1 of the dye.
    table: Vec<[f64; 2]>,
}

impl DyeFile {
    pub(super) fn read(&self, params: &Params, at: &str) -> Result<Dye, Fault> {
        let density = SpectralDensity::new(&self.table)
            .map_err(|fault| params.fault(&format!("{at}.dye.table"), fault.message))?;
        if !self.table.iter().any(|p| p[1] > 0.0) {
            return Err(params.fault(&format!("{at}.dye.table"), "this dye absorbs nothing"));
        }
        Ok(Dye { name: self.name.clone(), density })
    }
}

/// Minimum density of a film with dyes: base, fog and mask.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct MinimumDensityFile {
    /// Whether it was chosen rather than measured; then `remark` says why.
    #[serde(default)]
    assumed: bool,
    /// Remarks for people, for example doubts and choices.
    remark: Option<String>,
    /// Pairs of wavelength (nm, ascending) and density of unexposed film.
    table: Vec<[f64; 2]>,
}

impl MinimumDensityFile {
    pub(super) fn read(&self, params: &Params) -> Result<MinimumDensity, Fault> {
        let density =
            SpectralDensity::new(&self.table).map_err(|fault| params.fault("minimum-density.table", fault.message))?;
        if self.assumed && self.remark.as_ref().is_none_or(|r| r.trim().is_empty()) {
            let fault = params.fault("minimum-density.assumed", "an assumed density needs a remark");
            return Err(fault.hint("add a `remark` that says what it is based on"));
        }
        Ok(MinimumDensity { density, assumed: self.assumed, remark: self.remark.clone() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Peaks of ISO 5-3:2009: Status A at 620, 530 and 440 nm, Status M at 640, 540 and 450 nm.
    #[test]
    fn status_products_peak_where_the_standard_says() {
        let names = ["red", "green", "blue"];
        for (status, peaks) in [(Densitometry::StatusA, [620, 530, 440]), (Densitometry::StatusM, [640, 540, 450])] {
            let products = status.products(&names).expect("bundled");
            for (product, peak) in products.iter().zip(peaks) {
                let sum: f64 = product.iter().sum();
                assert!((sum - 1.0).abs() < 1e-12);
                let highest = (0..BAND.count).max_by(|a, b| product[*a].total_cmp(&product[*b])).expect("not empty");
                assert_eq!(BAND.wavelength_nm(highest) as i32, peak);
            }
        }
        assert!(Densitometry::Visual.products(&names).is_none());
        assert!(Densitometry::StatusA.products(&["cyan"]).is_none());
    }

    #[test]
    fn densities_are_straight_inside_and_held_outside() {
        let density = SpectralDensity::new(&[[400.0, 1.0], [500.0, 0.5]]).expect("valid");
        assert_eq!([350.0, 400.0, 450.0, 500.0, 800.0].map(|w| density.at(w)), [1.0, 1.0, 0.75, 0.5, 0.5]);
        assert!(SpectralDensity::new(&[[400.0, 1.0], [400.0, 0.5]]).is_err() && SpectralDensity::new(&[]).is_err());
        assert!(SpectralDensity::new(&[[400.0, f64::NAN]]).is_err());
    }
}
