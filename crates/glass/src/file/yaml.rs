//! Glass files in YAML.

use super::{Figures, MAX_BYTES, OWN_MAKER, csv, sensible};
use crate::{Category, Extinction, Formula, Glass, Medium, Table};
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::params::{Fault, Faults, Length, NonNegative, Params, Positive, Wavelength, Whole};
use spectra_core::registry::{self, Context, NameOf, Stage};
use spectra_core::resources::{Resources, beside};
use spectra_core::spectral::BAND;

/// A glass as a file writes it.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(deny_unknown_fields)]
pub struct GlassFile {
    /// Version of the format.
    #[expect(dead_code, reason = "its schema allows one version")]
    spectra: Option<Whole<1, 1>>,
    /// Name for people.
    name: Option<String>,
    /// Maker of the glass.
    maker: Option<String>,
    /// Source of the figures.
    source: Option<String>,
    /// License of the figures.
    #[expect(dead_code, reason = "for the reader of the file")]
    license: Option<String>,
    /// License of the figures, as older files spell it.
    #[expect(dead_code, reason = "for the reader of the file")]
    licence: Option<String>,
    /// Anything else worth knowing.
    #[expect(dead_code, reason = "for the reader of the file")]
    remark: Option<String>,
    /// Name of a dispersion formula; see `spectra list formula`.
    formula: Option<NameOf<Formula>>,
    /// Coefficients of the formula, for micrometers unless `unit` says otherwise.
    coefficients: Option<Vec<f64>>,
    /// The unit of wavelengths in the formula: `um` (the default), or `nm` where the formula is `cauchy` (B in nm^2), `conrady`, `schott`
    /// or `sellmeier-1`.
    unit: Option<LengthUnit>,
    /// Index as a formula of the wavelength `w` in nm, for `formula: function`.
    #[expect(dead_code, reason = "the formula reads it")]
    n: Option<String>,
    /// Measured indices: wavelength, nm if bare, and n.
    table: Option<Vec<(Wavelength, f64)>>,
    /// CSV file beside this one with measured indices, and k where it is known.
    file: Option<String>,
    /// First and last wavelength of the data, nm if bare. If absent, that of the table, else 350 to 830 nm.
    range: Option<[Wavelength; 2]>,
    /// Figures of the glass. With an Abbe number, or at several lines, they are the whole glass; beside a formula or a table
    /// they are checked against it.
    #[serde(flatten)]
    figures: Figures,
    /// Temperature of the data, degrees Celsius.
    temperature: Option<f64>,
    /// Extinction: wavelength, nm if bare, and k of the complex index n - i k.
    extinction: Option<Vec<(Wavelength, NonNegative<f64>)>>,
    /// Absorption as makers print it.
    internal_transmittance: Option<InternalTransmittance>,
}

/// The unit of wavelengths in a formula.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq, JsonSchema)]
#[schemars(inline)]
enum LengthUnit {
    /// Micrometers.
    #[serde(rename = "um")]
    Micrometer,
    /// Nanometers.
    #[serde(rename = "nm")]
    Nanometer,
}

/// Transmittance inside the glass, without reflections.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct InternalTransmittance {
    /// Thickness for which the transmittance is stated, mm if bare.
    thickness: Positive<Length>,
    /// Wavelength, nm if bare, and transmittance, above 0 and at most 1.
    table: Vec<(Wavelength, f64)>,
}

/// Reads the glass of a parsed file. It is named after the file, unless it states a name.
pub(super) fn from_file(params: &Params, resources: &dyn Resources) -> Result<Glass, Faults> {
    let file = &params.node().file.name;
    let stem = file.rsplit(['/', '\\']).next().unwrap_or(file);
    let stem = stem.rsplit_once('.').map_or(stem, |(stem, _)| stem).to_owned();
    from_params(params, &stem, resources)
}

/// Reads a glass from a map with the keys of a glass file. Its name is `called` if the map states none.
///
/// # Errors
/// All faults of the map, with places.
pub fn from_params(params: &Params, called: &str, resources: &dyn Resources) -> Result<Glass, Faults> {
    let p: GlassFile = params.parse()?;
    let mut faults = Faults::new();
    let range_nm = p.range.map(|r| r.map(|w| w.nm()));
    if range_nm.is_some_and(|[from, to]| !(from < to && to <= 1e6)) {
        faults.push(params.fault("range", "two wavelengths, the shorter one first").hint("[365 nm, 1014 nm]"));
    }
    let base = faults.take(base(params, &p, resources));
    let extinction = faults.take(extinction(params, &p));
    let (Some(base), Some(extinction)) = (base, extinction) else { return Err(faults) };
    let own_range = base.range_nm;
    let range = range_nm.map_or(own_range, |[from, to]| (from, to));
    let mut glass = Glass {
        maker: p.maker.as_deref().unwrap_or(OWN_MAKER).into(),
        name: p.name.clone().unwrap_or_else(|| called.to_owned()),
        range_nm: range,
        temperature_c: p.temperature,
        source: p.source.as_deref().unwrap_or_default().into(),
        ..base
    };
    glass.extinction = extinction.or(glass.extinction);
    if !faults.is_empty() {
        return Err(faults);
    }
    if let Err(text) = sensible(&glass) {
        let key = ["coefficients", "table", "nd"].into_iter().find(|key| params.get(key).is_some()).unwrap_or("file");
        let hint = "give coefficients for wavelengths in micrometers, and limit `range` to the wavelengths for which they hold";
        return Err(params.fault(key, text).hint(hint).into());
    }
    faults.take(p.figures.checked(params));
    for (key, stated, own, tolerance) in p.figures.against(|nm| glass.index(nm)) {
        if !((stated - own).abs() <= tolerance) {
            let fault = params.fault(key, format!("{key} is stated as {stated}, but the data give {own:.5}"));
            faults.push(fault.hint("the figures contradict each other: which one is wrong?"));
        }
    }
    (glass.listed_nd, glass.listed_vd) = (p.figures.nd, p.figures.vd);
    faults.into_result(glass)
}

/// Reads the index of the glass; all other data are left out.
fn base(params: &Params, p: &GlassFile, resources: &dyn Resources) -> Result<Glass, Faults> {
    const BAND_NM: (f64, f64) = (350.0, 830.0);
    let plain = |formula, range| Glass::new("", "", Category::User, formula, range);
    let forms = [("formula", p.formula.is_some()), ("table", p.table.is_some()), ("file", p.file.is_some())];
    let given: Vec<&str> = forms.iter().filter(|(_, is)| *is).map(|(key, _)| *key).collect();
    if given.len() > 1 {
        let text = format!("the index is given by `{}` and again by `{}`", given[0], given[1]);
        return Err(params.fault(given[1], text).hint("one of `formula`, `table` and `file`").into());
    }
    if p.coefficients.is_some() && p.formula.is_none() {
        let fault = params.fault("coefficients", "coefficients of which formula?");
        return Err(fault.hint("add `formula: sellmeier-1`, or another formula").into());
    }
    if p.unit.is_some() && p.formula.is_none() {
        let fault = params.fault("unit", "the unit of which formula?");
        return Err(fault.hint("add `formula: cauchy`, or another formula, with its `coefficients`").into());
    }
    if p.formula.is_some() {
        let formula = formula(params, resources)?;
        let is_nm = p.unit == Some(LengthUnit::Nanometer);
        let converted = if is_nm { formula.in_micrometers() } else { Some(formula) };
        let formula = converted.ok_or_else(|| {
            let fault = params.fault("unit", "this formula has its coefficients in micrometers only");
            fault.hint("leave `unit` out and convert them; `nm` goes with cauchy, conrady, schott and sellmeier-1")
        })?;
        return Ok(plain(formula, BAND_NM));
    }
    if let Some(table) = &p.table {
        let points: Vec<(f64, f64)> = table.iter().map(|(w, n)| (w.nm(), *n)).collect();
        let table = Table::new(&points).map_err(|e| params.fault("table", e.to_string()))?;
        let range = table.range_nm();
        return Ok(plain(Formula::Table(table.into()), range));
    }
    if let Some(file) = &p.file {
        let (file, material) = super::parts(file);
        let path = params.get("file").map_or_else(|| file.to_owned(), |node| beside(node, file));
        let found = resources.read(&path, &[], &[], MAX_BYTES);
        let found = found.map_err(|e| params.fault("file", format!("`{file}`: {e}")))?;
        return csv::read(&found.name, &found.bytes, material).map_err(|faults| params.place_at("file", faults));
    }
    if p.figures.is_empty() {
        let fault = params.fault_here("the glass has no index");
        return Err(fault.hint("write `formula` and `coefficients`, a `table`, a CSV `file`, or `nd` and `vd`").into());
    }
    let formula = match p.figures.medium(params)?.0 {
        Medium::Model(model) => Formula::Model(model),
        Medium::Glass(glass) => glass.formula.clone(),
        medium => Formula::Constant(medium.index(crate::lines::D.wavelength_nm)),
    };
    Ok(plain(formula, BAND_NM))
}

/// Builds the formula that the registry knows by its name.
fn formula(params: &Params, resources: &dyn Resources) -> Result<Formula, Faults> {
    let (own, _) = params.split(&[Formula::KEY, "coefficients", "n"]);
    let own = Params::kinded(own.node().clone(), params.path(), Formula::KEY)?;
    registry::build::<Formula>(&own, &Context::new(resources, BAND)).map(|formula| *formula)
}

fn extinction(params: &Params, p: &GlassFile) -> Result<Option<Extinction>, Fault> {
    let (key, rows): (&str, Vec<(f64, f64)>) = match (&p.extinction, &p.internal_transmittance) {
        (None, None) => return Ok(None),
        (Some(_), Some(_)) => {
            let fault = params.fault("internal-transmittance", "absorption is given twice");
            return Err(fault.hint("give either `extinction` or `internal-transmittance`"));
        }
        (Some(rows), None) => ("extinction", rows.iter().map(|(w, k)| (w.nm(), k.get())).collect()),
        (None, Some(given)) => {
            let mm = given.thickness.mm();
            let mut rows = Vec::new();
            for (i, (w, tau)) in given.table.iter().enumerate() {
                if !(*tau > 0.0 && *tau <= 1.0) {
                    let at = format!("internal-transmittance.table[{i}]");
                    return Err(params
                        .fault(&at, format!("a transmittance of {tau} is out of range"))
                        .hint("write a number above 0, at most 1"));
                }
                // tau = exp(-4 pi k d / lambda); + 0 makes the -0 of a clear row 0.
                let k = -libm::log(*tau) * w.nm() * 1e-6 / (4.0 * std::f64::consts::PI * mm) + 0.0;
                rows.push((w.nm(), k));
            }
            ("internal-transmittance", rows)
        }
    };
    let (wavelengths, k): (Vec<f64>, Vec<f64>) = rows.into_iter().unzip();
    let fault = || params.fault(key, "wavelengths must increase, and at least one is needed");
    Extinction::new(wavelengths.into(), k).map(Some).ok_or_else(fault)
}
