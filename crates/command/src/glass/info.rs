//! `spectra glass info`: shows the data of a glass.

use super::arguments::GlassInfo;
use super::{catalogue, chosen, named, own_file, period};
use crate::console;
use crate::outcome::{DONE, Failure, Outcome};
use serde_json::json;
use spectra_glass::air::{self, AirConditions, CATALOGUE_AIR};
use spectra_glass::interface::{brewster_angle, critical_angle, fresnel};
use spectra_glass::{Catalog, Category, Formula, Glass, GlassFacts, LineTriple, Medium, ModelGlass, lines};
use spectra_sheet::{Column, Sheet, Table, percent};
use std::collections::BTreeMap;

/// Thickness for which internal transmittances are stated, mm.
const THICKNESS_MM: f64 = 10.0;

/// Writes the data of a glass to standard output, as text or JSON.
pub(crate) fn info(arguments: &GlassInfo) -> Outcome {
    let catalogue = catalogue(&arguments.own)?;
    let medium = medium(arguments, &catalogue)?;
    let warnings = warnings(&medium, arguments);
    let mut sheet = sheet(&medium, arguments);
    sheet.data("warnings", &warnings);
    console::sheet(&sheet, arguments.json)?;
    if !arguments.json {
        warnings.iter().for_each(|warning| console::warning(warning));
    }
    Ok(DONE)
}

fn medium(arguments: &GlassInfo, catalogue: &Catalog) -> Result<Medium, Failure> {
    let melt = arguments.nd.zip(arguments.vd);
    let refuse = |(nd, vd): (f64, f64)| Failure::Input(format!("no glass has nd {nd} and Vd {vd}"));
    match (&arguments.name, melt) {
        (None, Some(melt)) => {
            if !(1.0..=4.0).contains(&melt.0) {
                return Err(refuse(melt));
            }
            let model = ModelGlass::new(melt.0, melt.1, arguments.line).map(Medium::Model);
            model.ok_or_else(|| refuse(melt))
        }
        (Some(name), None) => named(name, catalogue),
        (Some(name), Some(melt)) => {
            let figures = Some((melt.0, Some(melt.1), LineTriple::FDC));
            let glass = match own_file(name)? {
                Some(glass) => glass,
                None => chosen(name, GlassFacts { figures, ..GlassFacts::default() }, catalogue)?,
            };
            glass.melt(melt.0, melt.1).map(Medium::from).ok_or_else(|| refuse(melt))
        }
        (None, None) => Err(Failure::Input("name a glass, or give --nd and --vd".into())),
    }
}

fn glass(medium: &Medium) -> Option<&Glass> {
    match medium {
        Medium::Glass(glass) => Some(glass.as_ref()),
        _ => None,
    }
}

/// Makes the sheet of a medium. Glass and air have the same temperature.
fn sheet(medium: &Medium, arguments: &GlassInfo) -> Sheet {
    let glass = glass(medium);
    let (name, category) = (medium.name(), glass.map(|g| g.category.name()));
    let mut sheet = Sheet::new(&category.map_or_else(|| name.clone(), |category| format!("{name}: {category}")));
    sheet.data("name", name);
    sheet.data("maker", glass.map(|g| &*g.maker));
    sheet.data("category", category);
    origin(&mut sheet, medium);
    let reference_c = glass.and_then(|g| g.temperature_c).unwrap_or(CATALOGUE_AIR.temperature_c);
    let temperature_c = arguments.temperature_c.unwrap_or(reference_c);
    let relative_to = if arguments.absolute { "vacuum" } else { "air" };
    sheet.line("index relative to", Some(format!("{relative_to}, at {temperature_c} C")));
    sheet.data("relative_to", relative_to);
    sheet.data("temperature_c", temperature_c);
    let index = |nm: f64| index(medium, nm, arguments.temperature_c, temperature_c, arguments.absolute);
    let known = |nm: f64| Some(index(nm)).filter(|n| medium.covers(nm, nm) && n.is_finite());
    indices(&mut sheet, medium, arguments, &index, &known);
    heat_and_surface(&mut sheet, medium);
    by_line(&mut sheet, medium, &known);
    sheet
}

/// Adds where the data of a medium are from, and their form.
fn origin(sheet: &mut Sheet, medium: &Medium) {
    let glass = glass(medium);
    let status = glass.map(|g| g.status.name());
    let years = glass.and_then(|g| g.years);
    let listed = years.map(|years| format!("in catalogues of {}", period(years)));
    let status_text: Vec<_> = status.filter(|s| *s != "unknown").map(str::to_owned).into_iter().chain(listed).collect();
    sheet.line("status", Some(status_text.join(", ")).filter(|s| !s.is_empty()));
    sheet.data("status", status);
    sheet.data("years", years);
    sheet.text("source", "source", glass.map(|g| &*g.source).filter(|s| !s.is_empty()));
    let formula = match medium {
        Medium::Glass(glass) => glass.formula.name(),
        Medium::Model(_) => "normal lines of partial dispersion, from index and Abbe number",
        Medium::Air | Medium::Vacuum => "Ciddor 1996",
        Medium::Constant(_) => "constant",
    };
    sheet.text("formula", "formula", Some(formula));
    let coefficients = glass.map(|g| g.formula.coefficients());
    let few = coefficients.as_ref().filter(|c| c.len() <= 20);
    sheet.line("coefficients", few.map(|c| c.iter().map(ToString::to_string).collect::<Vec<_>>().join("  ")));
    sheet.data("coefficients", coefficients);
    sheet.text("expected_error", "expected error", expected_error(medium));
    sheet.fact("range_nm", "measured", medium.range_nm(), |(from, to)| format!("{from} to {to} nm"));
}

/// Adds indices and Abbe numbers at the usual and the requested lines. `known` is the index within the measured range.
fn indices(
    sheet: &mut Sheet,
    medium: &Medium,
    arguments: &GlassInfo,
    index: &dyn Fn(f64) -> f64,
    known: &dyn Fn(f64) -> Option<f64>,
) {
    let glass = glass(medium);
    let abbe = |lines: LineTriple| {
        let covered =
            [lines.short, lines.mid, lines.long].iter().all(|l| medium.covers(l.wavelength_nm, l.wavelength_nm));
        Some(lines.abbe_number(index)).filter(|v| covered && v.is_finite())
    };
    let [listed_nd, listed_vd] = [glass.and_then(|g| g.listed_nd), glass.and_then(|g| g.listed_vd)];
    let listed = |v: Option<f64>| v.map_or(String::new(), |v| format!("  (listed: {v})"));
    let abbe_text = |v: &f64| format!("{v:.2}");
    sheet.fact("nd", "nd", known(lines::D.wavelength_nm), |n| format!("{n:.6}{}", listed(listed_nd)));
    sheet.fact("vd", "Vd", abbe(LineTriple::FDC), |v| abbe_text(v) + &listed(listed_vd));
    sheet.data("listed_nd", listed_nd);
    sheet.data("listed_vd", listed_vd);
    sheet.fact("ne", "ne", known(lines::E.wavelength_nm), |n| format!("{n:.6}"));
    sheet.fact("ve", "Ve", abbe(LineTriple::F_PRIME_E_C_PRIME), abbe_text);
    let lines_nm = arguments.lines.map(|l| [l.short, l.mid, l.long].map(|line| line.wavelength_nm));
    let v_lines = arguments.lines.and_then(abbe);
    if let Some([blue, middle, red]) = lines_nm {
        let text = v_lines.as_ref().map_or_else(|| "outside the measured range".to_owned(), abbe_text);
        sheet.line(&format!("V {blue} {middle} {red} nm"), Some(text));
    }
    sheet.data("lines_nm", lines_nm);
    sheet.data("v_lines", v_lines);
    let wavelength_nm = arguments.wavelength_nm.map(|w| w.nm());
    let tau = wavelength_nm.filter(|_| transmittances(medium).is_some());
    let tau = tau.and_then(|nm| medium.internal_transmittance(nm, THICKNESS_MM));
    let tau_text = tau.map_or(String::new(), |t| format!("  (internal transmittance of 10 mm: {t:.4})"));
    let label = wavelength_nm.map_or(String::new(), |nm| format!("n at {nm} nm"));
    let n_at = wavelength_nm.map(index).filter(|n| n.is_finite());
    sheet.fact("n_at", &label, n_at, |n| format!("{n:.6}{tau_text}"));
    sheet.data("wavelength_nm", wavelength_nm);
    sheet.data("internal_transmittance_10mm_at", tau);
}

/// Adds the change of the index per kelvin from 20 to 40 C at the e line, and figures of one bare surface to air at the d line.
fn heat_and_surface(sheet: &mut Sheet, medium: &Medium) {
    let e = lines::E.wavelength_nm;
    let slope = |n: &dyn Fn(f64) -> f64| (n(40.0) - n(20.0)) / 20.0 * 1e6;
    let slopes = glass(medium)
        .filter(|g| g.thermal.is_some())
        .map(|g| [slope(&|t| g.index_at(e, t)), slope(&|t| g.absolute_index(e, t))]);
    let text = |[relative, absolute]: [f64; 2]| format!("{relative:.2}e-6 / K  (absolute: {absolute:.2}e-6 / K)");
    sheet.line("dn/dT at e, 20 to 40 C", slopes.map(text));
    sheet.data("dn_dt_relative_1e6", slopes.map(|[relative, _]| relative));
    sheet.data("dn_dt_absolute_1e6", slopes.map(|[_, absolute]| absolute));
    let d = lines::D.wavelength_nm;
    let n = Some(medium.index(d)).filter(|n| medium.covers(d, d) && *n > 0.0);
    let degrees = |angle: &f64| format!("{angle:.3} deg");
    let critical = n.and_then(|n| critical_angle(n, 1.0)).map(f64::to_degrees);
    sheet.fact("reflectance", "reflectance (d, bare)", n.map(|n| fresnel(1.0, n, 1.0).mean()), |r| percent(*r, 3));
    sheet.fact("critical_angle_deg", "critical angle (d)", critical, degrees);
    let brewster = n.map(|n| brewster_angle(1.0, n).to_degrees());
    sheet.fact("brewster_angle_deg", "Brewster's angle (d)", brewster, degrees);
}

/// Adds indices and internal transmittances at the lines, from short to long wavelengths.
fn by_line(sheet: &mut Sheet, medium: &Medium, known: &dyn Fn(f64) -> Option<f64>) {
    let taus = transmittances(medium);
    let tau_column =
        taus.is_some().then(|| Column::plain("internal_transmittance_10mm", "internal transmittance, 10 mm"));
    let columns = [Column::text("line", "line"), Column::fixed("nm", "nm", 4), Column::fixed("n", "n", 6)];
    let mut table = Table::new("n", columns.into_iter().chain(tau_column));
    let mut indices = BTreeMap::new();
    for line in lines::ALL {
        let Some(n) = known(line.wavelength_nm) else { continue };
        let mut row = vec![json!(line.name), json!(line.wavelength_nm), json!(n)];
        row.extend(taus.as_ref().map(|t| t.get(line.name).map_or(String::new(), |t| format!("{t:.4}")).into()));
        table.push(row);
        indices.insert(line.name, n);
    }
    sheet.show(table);
    sheet.data("n", indices);
    sheet.data("internal_transmittance_10mm", taus);
}

/// Returns the transmittance of 10 mm without reflections at the lines where the absorption of a glass is known. `None` if there are none.
fn transmittances(medium: &Medium) -> Option<BTreeMap<&'static str, f64>> {
    glass(medium)?.extinction.as_ref()?;
    let at = |line: &lines::Line| Some((line.name, medium.internal_transmittance(line.wavelength_nm, THICKNESS_MM)?));
    Some(lines::ALL.iter().filter_map(at).collect()).filter(|all: &BTreeMap<_, _>| !all.is_empty())
}

/// Returns the index at a wavelength (nm). Relative indices are for the catalogue's temperature unless another one is requested
/// (`asked_c`).
fn index(medium: &Medium, nm: f64, asked_c: Option<f64>, temperature_c: f64, absolute: bool) -> f64 {
    let air_at = AirConditions { temperature_c, ..CATALOGUE_AIR };
    match (medium, absolute) {
        (Medium::Glass(glass), true) => glass.absolute_index(nm, temperature_c),
        (Medium::Glass(glass), false) => asked_c.map_or_else(|| glass.index(nm), |t| glass.index_at(nm, t)),
        (Medium::Air, true) => air::index(nm, air_at),
        (Medium::Air, false) => 1.0,
        (Medium::Vacuum, true) => 1.0,
        (Medium::Vacuum, false) => 1.0 / air::index(nm, air_at),
        (Medium::Model(_) | Medium::Constant(_), true) => air::absolute(medium.index(nm), nm, air_at),
        (Medium::Model(_) | Medium::Constant(_), false) => medium.index(nm),
    }
}

fn warnings(medium: &Medium, arguments: &GlassInfo) -> Vec<String> {
    let glass = glass(medium);
    let mut warnings = Vec::new();
    let name = medium.name();
    if let Some(nm) = arguments.wavelength_nm.map(|w| w.nm()).filter(|nm| !medium.covers(*nm, *nm))
        && let Some((from, to)) = medium.range_nm()
    {
        warnings.push(format!("{name} was measured from {from} to {to} nm: the index at {nm} nm is extrapolated"));
    }
    let solid = glass.is_some_and(|g| g.thermal.is_none()) || matches!(medium, Medium::Model(_));
    if arguments.temperature_c.is_some() && solid {
        warnings.push(format!("{name} has no temperature data; only the temperature of the air is taken into account"));
    }
    let research = glass.is_some_and(|g| {
        use spectra_glass::Category::{Crystal, Inorganic, Mixed, Organic};
        matches!(g.category, Inorganic | Organic | Mixed | Crystal)
    });
    if arguments.absolute && research {
        warnings.push(format!(
            "the data of {name} are assumed to be relative to air; leave out --absolute if they are relative to vacuum, as for gases"
        ));
    }
    warnings
}

/// Returns the expected error of a glass that is described coarsely; `None` for others. Two terms of Buchdahl's form, fitted to 240 glasses
/// of SCHOTT from 400 to 700 nm, leave 3.2e-5 at the median and 6.6e-5 at the 95th percentile. The errors for an index and an Abbe number
/// are those stated in the guide.
fn expected_error(medium: &Medium) -> Option<&'static str> {
    let model = match medium {
        Medium::Model(model) => Some(model),
        Medium::Glass(glass) => match &glass.formula {
            Formula::Model(model) => Some(model),
            formula if formula.name() == "Buchdahl" && glass.category != Category::User => {
                return Some("7e-5 in n from 400 to 700 nm (two terms, fitted)");
            }
            _ => None,
        },
        _ => None,
    };
    let is_coarse = model.is_some_and(|model| model.stated_lines() == 1);
    is_coarse.then_some("2e-4 in n at r, 4e-4 at g, 9e-4 at h for nine out of ten glasses")
}
