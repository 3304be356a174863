//! What a developed film holds back, wavelength by wavelength, and how that is measured.

use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::math::pow;
use spectra_core::params::{Fault, Params};
use spectra_core::spectral::{BAND, Grid};
use spectra_spectrum::Kind;
use spectra_spectrum::table::Table;

/// Optical density (transmission, diffuse) over wavelengths, straight between points, held beyond them.
#[derive(Clone, Debug, PartialEq)]
pub struct SpectralDensity {
    points: Vec<[f64; 2]>,
}

impl SpectralDensity {
    /// Points (wavelength in nm, density), wavelengths increasing.
    ///
    /// # Errors
    /// A text that says which point is no density: wavelengths that do not increase, or values beyond -1 to 10 (the
    /// difference of two measurements may come out a little below 0).
    pub fn new(points: &[[f64; 2]]) -> Result<Self, String> {
        let mut before = 0.0;
        for [nm, density] in points {
            if !(*nm > before && nm.is_finite()) {
                return Err(format!("wavelengths increase: {nm} nm comes after {before} nm"));
            }
            if !(-1.0..=10.0).contains(density) {
                return Err(format!("{density} at {nm} nm is not a density"));
            }
            before = *nm;
        }
        if points.is_empty() {
            return Err("a density needs at least one point".into());
        }
        Ok(Self { points: points.to_vec() })
    }

    /// The points.
    #[must_use]
    pub fn points(&self) -> &[[f64; 2]] {
        &self.points
    }

    /// Density at a wavelength.
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

    /// Densities on a grid.
    #[must_use]
    pub fn on_grid(&self, grid: &Grid) -> Vec<f64> {
        grid.wavelengths_nm().map(|w| self.at(w)).collect()
    }
}

/// The dye of one layer.
#[derive(Clone, Debug, PartialEq)]
pub struct Dye {
    /// Its name: `cyan`, `magenta`, `yellow`.
    pub name: String,
    /// Its density; the amount in the table is the unit in which amounts are counted.
    pub density: SpectralDensity,
}

/// What is left where nothing was exposed: base, fog, mask.
#[derive(Clone, Debug, PartialEq)]
pub struct MinimumDensity {
    /// It.
    pub density: SpectralDensity,
    /// Whether the sheet has no such figure.
    pub assumed: bool,
    /// What it rests on.
    pub remark: Option<String>,
}

/// How densities of a curve were measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Densitometry {
    /// Of silver, by eye: the same at all wavelengths.
    Visual,
    /// Status A of ISO 5-3: what is looked at.
    StatusA,
    /// Status M of ISO 5-3: what is printed.
    StatusM,
}

impl Densitometry {
    /// Its name.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Visual => "visual",
            Self::StatusA => "status-a",
            Self::StatusM => "status-m",
        }
    }

    /// The spectral products of its channels (of ISO 5-3:2009) on the band, each of integral 1, for layers called
    /// `names`; `None` for a visual density, which all wavelengths share, and for a name other than red, green and blue.
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
                // 0 is nothing at all: the tables are logarithms with 5 at the peak.
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

/// How densities were measured.
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
            let text = format!("{} densities are of three layers, not {layers}", densitometry.name());
            Err(params.fault("density", text).hint("layers called red, green and blue"))
        }
        _ => Ok(densitometry),
    }
}

/// The dye of a layer.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct DyeFile {
    /// Its color or name.
    name: String,
    /// Pairs of wavelength, nm, increasing, and density of the amount 1 of the dye.
    table: Vec<[f64; 2]>,
}

impl DyeFile {
    pub(super) fn read(&self, params: &Params, at: &str) -> Result<Dye, Fault> {
        let density =
            SpectralDensity::new(&self.table).map_err(|text| params.fault(&format!("{at}.dye.table"), text))?;
        if !self.table.iter().any(|p| p[1] > 0.0) {
            return Err(params.fault(&format!("{at}.dye.table"), "this dye absorbs nothing"));
        }
        Ok(Dye { name: self.name.clone(), density })
    }
}

/// Base, fog and mask of a film with dyes.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct MinimumDensityFile {
    /// Whether it was chosen rather than measured; then `remark` says why.
    #[serde(default)]
    assumed: bool,
    /// Doubts and choices, for people.
    remark: Option<String>,
    /// Pairs of wavelength, nm, increasing, and density where nothing is exposed.
    table: Vec<[f64; 2]>,
}

impl MinimumDensityFile {
    pub(super) fn read(&self, params: &Params) -> Result<MinimumDensity, Fault> {
        let density = SpectralDensity::new(&self.table).map_err(|text| params.fault("minimum-density.table", text))?;
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
