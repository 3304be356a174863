//! Filters in front of the lens: one transmittance that multiplies all light, from any source.
//!
//! A ray passes a filter once, and the effect depends only on the wavelength. The filter is therefore folded into the responses
//! of the channels. Both directions, every source, the choice of wavelengths and every exposure meter see it that way. Filters
//! are used at normal incidence, and their thickness does not shift the focus. The lens is focused in the light that they leave.

use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::math::exp;
use spectra_core::params::{Deferred, Faults, Length, Params, Positive, StageNode, keys_of};
use spectra_core::resources::Resources;
use spectra_core::spectral::{Channel, Grid};
use spectra_glass::Medium;
use spectra_lens::{Coating, read_coating};

/// The keys of the `lens` section for what stands in front of the lens.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct FrontSection {
    /// Filters, in any order: a name of a transmittance, `{file: ...}`, `{glass: ..., thickness: ...}`, or `{mired: ...}`.
    #[serde(default)]
    #[schemars(length(max = 16))]
    filters: Vec<Deferred<FilterForm>>,
}

/// A filter with a measured transmittance.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(crate) struct Measured {
    /// A table of transmittance over wavelength beside the scene, or a bundled name.
    file: String,
}

/// A plate of glass as a filter.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(crate) struct Plate {
    /// Name of the glass in a catalogue, such as `SCHOTT/N-BK7`.
    glass: String,
    /// Thickness of the plate, mm if bare.
    thickness: Positive<Length>,
    /// Coating of both faces: `ideal`, `bare`, or a layer; `bare` if absent.
    coating: Option<Deferred<spectra_lens::CoatingForm>>,
}

/// An ideal color conversion filter.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(crate) struct Conversion {
    /// Shift of the reciprocal color temperature of light, mired, -500 to 500. A shift of 131 turns light of 5500 K into light of
    /// 3200 K, as a Wratten 85B does; -131 does the opposite, as an 80A does.
    #[schemars(range(min = -500, max = 500))]
    mired: f64,
}

/// Returns the transmittance of an ideal conversion filter on the grid: exp(-c2 m / wavelength), with m = `mired` * 10^-6 / K. By
/// Wien's law it turns the light of a black body of any temperature T into that of one with `mired` added to 10^6 / T. It is
/// scaled to 1 at the end of the visible range where it passes most, 400 or 700 nm, and limited to 1 beyond that.
pub(crate) fn conversion(mired: f64, grid: &Grid) -> Vec<f64> {
    /// Second radiation constant, nm K (CODATA 2018).
    const C2_NM_K: f64 = 1.438_776_877e7;
    let clear_nm = if mired > 0.0 { 700.0 } else { 400.0 };
    let exponent = |nm: f64| C2_NM_K * mired * 1e-6 * (1.0 / clear_nm - 1.0 / nm);
    grid.wavelengths_nm().map(|nm| exp(exponent(nm)).min(1.0)).collect()
}

/// The forms in which a filter can be written.
#[derive(JsonSchema)]
#[serde(untagged)]
#[expect(dead_code, reason = "states what is allowed; `one` reads it")]
pub(crate) enum FilterForm {
    /// Name of a transmittance.
    Named(String),
    /// A table beside the scene.
    Measured(Measured),
    /// A plate of glass.
    Plate(Plate),
    /// A conversion filter.
    Conversion(Conversion),
}

/// Returns the combined transmittance, on the grid, of all filters of a `lens` section; `None` if it has no filters.
pub(crate) fn filters_of(lens: &Params, grid: Grid, resources: &dyn Resources) -> Result<Option<Vec<f64>>, Faults> {
    let (front, _) = lens.split(&keys_of::<FrontSection>());
    let section: FrontSection = front.parse()?;
    if section.filters.is_empty() {
        return Ok(None);
    }
    let mut faults = Faults::new();
    let mut product = vec![1.0; grid.count];
    for node in &section.filters {
        for (p, t) in product.iter_mut().zip(faults.take(one(node, grid, resources)).unwrap_or_default()) {
            *p *= t;
        }
    }
    if faults.is_empty() && product.iter().all(|t| *t == 0.0) {
        faults.push(front.fault("filters", "no light of the band passes these filters"));
    }
    faults.into_result(Some(product))
}

/// Multiplies the responses of the channels by the transmittance.
pub(crate) fn fold(channels: &mut [Channel], transmittance: &[f64]) {
    for channel in channels {
        for (response, t) in channel.response.iter_mut().zip(transmittance) {
            *response *= t;
        }
    }
}

fn one(node: &StageNode, grid: Grid, resources: &dyn Resources) -> Result<Vec<f64>, Faults> {
    let named = |name: &str| match spectra_spectrum::find_transmittance_in(name, resources) {
        Ok(found) => Ok(found.on_grid(&grid)),
        Err(e) => Err(e.faults(|text| node.fault(text))),
    };
    if let Some(name) = node.node().as_str() {
        return named(name);
    }
    let is_known = |key: &&str| node.node().get(key).is_some();
    if !["file", "mired", "glass"].iter().any(is_known) {
        let hint = "such as `wratten-15`, `{mired: 131}`, `{glass: SCHOTT/N-BK7, thickness: 2 mm}`, or `{file: gel.csv}`: a table in rows \
                    of wavelength and transmittance, `400, 0.9`";
        return Err(node.fault("this is not a filter").hint(hint).into());
    }
    if node.node().get("mired").is_some() {
        let p: Conversion = node.parse()?;
        if !(p.mired.abs() <= 500.0) {
            return Err(node
                .fault(format!("`mired: {}` is out of range", p.mired))
                .hint("use -500 to 500, such as 131")
                .into());
        }
        return Ok(conversion(p.mired, &grid));
    }
    if node.node().get("glass").is_none() {
        return named(&node.parse::<Measured>()?.file);
    }
    let params = Params::section(node.node().clone(), node.path())?;
    let p: Plate = params.parse()?;
    let medium = spectra_glass::file::medium(&p.glass, &params, "glass", resources)?;
    let coating = p.coating.as_ref().map_or(Ok(Coating::Bare), |node| read_coating(node, resources))?;
    plate(&medium, p.thickness.mm(), &coating, grid).ok_or_else(|| {
        let fault = params.fault("glass", format!("the absorption of {} is not known", medium.name()));
        fault.hint("give its transmittance as a table: `{file: ...}`").into()
    })
}

/// Returns the transmittance of a plate at normal incidence, with all incoherent reflections between its two faces, which is (1 -
/// R)^2 t / (1 - R^2 t^2). R is what the coating does not transmit; for a bare face it is ((n - 1) / (n + 1))^2. Source: Born and
/// Wolf, "Principles of Optics", 1.5.2, and 7.6.1 without interference. Beyond the catalogue's table of absorption its last value
/// is kept.
fn plate(medium: &Medium, thickness_mm: f64, coating: &Coating, grid: Grid) -> Option<Vec<f64>> {
    let inside: Vec<Option<f64>> =
        grid.wavelengths_nm().map(|nm| medium.internal_transmittance(nm, thickness_mm)).collect();
    let first = inside.iter().position(Option::is_some)?;
    let mut last = inside[first]?;
    let all = grid.wavelengths_nm().zip(inside).map(|(nm, known)| {
        let t = known.unwrap_or(last);
        last = t;
        let n = medium.index(nm);
        let r = 1.0 - coating.transmittance(1.0, n, 1.0, nm).mean();
        (1.0 - r) * (1.0 - r) * t / (1.0 - r * r * t * t)
    });
    Some(all.collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use spectra_core::spectral::BAND;
    use spectra_glass::Catalog;

    /// Light of a black body of 5500 K has, after +131 mired, the chromaticity of one of about 3197 K. Wien's law approximates
    /// Planck's.
    #[test]
    fn a_conversion_filter_moves_the_color_temperature() {
        for (kelvin, mired) in [(5500.0, 131.0), (3200.0, -131.0), (4000.0, 60.0)] {
            let light = BAND.wavelengths_nm().map(|nm| spectra_spectrum::planck_radiance(nm, kelvin));
            let continuum = light.zip(conversion(mired, &BAND)).map(|(l, t)| l * t).collect();
            let power = spectra_core::spectral::SpectralPower { grid: BAND, continuum, lines: Vec::new() };
            let [x, y, z] = spectra_spectrum::Observer::cie_1931_2deg().xyz_of_power(&power);
            let got = spectra_color::cct([x / (x + y + z), y / (x + y + z)]).expect("white");
            let want = 1e6 / (1e6 / kelvin + mired);
            assert!(
                (got.kelvin / want - 1.0).abs() < 0.01 && got.duv.abs() < 1e-3,
                "{kelvin} {mired}: {got:?}, not {want}"
            );
        }
        assert!(conversion(0.0, &BAND).iter().all(|t| *t == 1.0));
    }

    /// N-BK7 at 587.56 nm has nd 1.5168, so a plate without absorption passes 2 n / (n^2 + 1) = 0.91907. 10 mm of it absorb
    /// hardly anything there (SCHOTT's data sheet: internal transmittance 0.998 at 580 nm).
    #[test]
    fn a_plate_of_crown_passes_92_percent() {
        let glass = Catalog::bundled().medium("SCHOTT/N-BK7").unwrap();
        let thin = plate(&glass, 1e-6, &Coating::Bare, BAND).unwrap();
        let at = |table: &[f64], nm: f64| BAND.interpolate(table, nm);
        assert!((at(&thin, 587.56) - 0.919_07).abs() < 2e-5, "{}", at(&thin, 587.56));
        let thick = plate(&glass, 10.0, &Coating::Ideal, BAND).unwrap();
        assert!((at(&thick, 580.0) - 0.998).abs() < 1.5e-3, "{}", at(&thick, 580.0));
        let squared = plate(&glass, 20.0, &Coating::Ideal, BAND).unwrap();
        for (one, two) in thick.iter().zip(squared) {
            assert!((one * one - two).abs() < 1e-12, "Bouguer's law");
        }
    }
}
