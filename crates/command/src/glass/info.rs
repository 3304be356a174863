//! `spectra glass info`: shows the data of a glass.

use super::arguments::GlassInfo;
use super::{catalogue, named, own_file, unknown};
use crate::console;
use crate::outcome::{DONE, Failure, Outcome};
use serde::{Serialize, Serializer};
use spectra_glass::air::{self, AirConditions, CATALOGUE_AIR};
use spectra_glass::interface::{brewster_angle, critical_angle, fresnel};
use spectra_glass::{Catalog, Category, Formula, Glass, GlassFacts, LineTriple, Medium, ModelGlass, lines};
use std::fmt::Write;

/// Thickness for which internal transmittances are stated, mm.
const THICKNESS_MM: f64 = 10.0;

/// Values with the names of their spectral lines, from short to long wavelengths.
#[derive(Debug)]
struct ByLine(Vec<(&'static str, f64)>);

impl Serialize for ByLine {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().copied())
    }
}

/// Data of a medium. Unknown values are `None`.
#[derive(Debug, Serialize)]
struct Report {
    name: String,
    maker: Option<String>,
    category: Option<&'static str>,
    status: Option<&'static str>,
    /// Years of the first and the last catalogue that list the glass.
    years: Option<(u16, u16)>,
    formula: Option<&'static str>,
    coefficients: Option<Vec<f64>>,
    /// Expected difference between the index of the formula and that of the maker, if the formula is a coarse fit.
    expected_error: Option<&'static str>,
    range_nm: Option<(f64, f64)>,
    /// Medium that indices are relative to: `air` or `vacuum`.
    relative_to: &'static str,
    /// Temperature of glass and air.
    temperature_c: f64,
    nd: Option<f64>,
    vd: Option<f64>,
    ne: Option<f64>,
    ve: Option<f64>,
    /// Wavelengths of the requested lines, from blue to red; `v_lines` is their Abbe number.
    lines_nm: Option<[f64; 3]>,
    v_lines: Option<f64>,
    listed_nd: Option<f64>,
    listed_vd: Option<f64>,
    /// Indices at the lines within the measured range.
    n: ByLine,
    wavelength_nm: Option<f64>,
    n_at: Option<f64>,
    /// Transmittance of 10 mm without reflections, at the lines where absorption is known.
    internal_transmittance_10mm: Option<ByLine>,
    internal_transmittance_10mm_at: Option<f64>,
    /// Reflectance of one bare surface to air at normal incidence, d line.
    reflectance: Option<f64>,
    /// Angle in the medium at which total reflection begins, d line.
    critical_angle_deg: Option<f64>,
    /// Angle in air at which p-polarized light is not reflected, d line.
    brewster_angle_deg: Option<f64>,
    /// Change of the index per kelvin from 20 to 40 C at the e line, relative to air, times 1e6.
    dn_dt_relative_1e6: Option<f64>,
    dn_dt_absolute_1e6: Option<f64>,
    source: Option<String>,
    warnings: Vec<String>,
}

/// Writes the data of a glass to standard output, as text or JSON.
pub(crate) fn info(arguments: &GlassInfo) -> Outcome {
    let catalogue = catalogue(&arguments.own)?;
    let medium = medium(arguments, &catalogue)?;
    let report = report(&medium, arguments);
    if arguments.json {
        console::pretty_json(&report)?;
    } else {
        console::out(&text(&report))?;
        report.warnings.iter().for_each(|warning| console::warning(warning));
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
            let glass = match own_file(name)? {
                Some(glass) => glass,
                None => {
                    let figures = Some((melt.0, Some(melt.1), LineTriple::FDC));
                    let chosen =
                        catalogue.choose(name, GlassFacts { figures, ..GlassFacts::default() }).map_err(unknown)?;
                    if let Some(note) = &chosen.note {
                        console::note(note);
                    }
                    chosen.glass
                }
            };
            glass.melt(melt.0, melt.1).map(Medium::from).ok_or_else(|| refuse(melt))
        }
        (None, None) => Err(Failure::Input("name a glass, or give --nd and --vd".into())),
    }
}

fn report(medium: &Medium, arguments: &GlassInfo) -> Report {
    let glass = match medium {
        Medium::Glass(glass) => Some(glass.as_ref()),
        _ => None,
    };
    let reference_c = glass.and_then(|g| g.temperature_c).unwrap_or(CATALOGUE_AIR.temperature_c);
    let temperature_c = arguments.temperature_c.unwrap_or(reference_c);
    let index = |nm: f64| index(medium, nm, arguments.temperature_c, temperature_c, arguments.absolute);
    let covers = |nm: f64| medium.covers(nm, nm);
    let known = |nm: f64| Some(index(nm)).filter(|n| covers(nm) && n.is_finite());
    let abbe = |lines: LineTriple| {
        let covered = [lines.short, lines.mid, lines.long].iter().all(|line| covers(line.wavelength_nm));
        Some(lines.abbe_number(index)).filter(|v| covered && v.is_finite())
    };
    let wavelength_nm = arguments.wavelength_nm.map(|w| w.nm());
    let nd = known(lines::D.wavelength_nm);
    let n_relative = Some(medium.index(lines::D.wavelength_nm)).filter(|n| covers(lines::D.wavelength_nm) && *n > 0.0);
    let n = lines::ALL.iter().filter_map(|line| Some((line.name, known(line.wavelength_nm)?))).collect();
    let internal = |nm: f64| medium.internal_transmittance(nm, THICKNESS_MM);
    let transmittances: Vec<_> =
        lines::ALL.iter().filter_map(|line| Some((line.name, internal(line.wavelength_nm)?))).collect();
    let measured = glass.is_some_and(|g| g.extinction.is_some()) && !transmittances.is_empty();
    let slope = |n: &dyn Fn(&Glass, f64) -> f64| {
        glass.filter(|g| g.thermal.is_some()).map(|g| (n(g, 40.0) - n(g, 20.0)) / 20.0 * 1e6)
    };
    let e = lines::E.wavelength_nm;
    Report {
        name: medium.name(),
        maker: glass.map(|g| g.maker.to_string()),
        category: glass.map(|g| g.category.name()),
        status: glass.map(|g| g.status.name()),
        years: glass.and_then(|g| g.years),
        formula: match medium {
            Medium::Glass(glass) => Some(glass.formula.name()),
            Medium::Model(_) => Some("normal lines of partial dispersion, from index and Abbe number"),
            Medium::Air | Medium::Vacuum => Some("Ciddor 1996"),
            Medium::Constant(_) => Some("constant"),
        },
        coefficients: glass.map(|g| g.formula.coefficients()),
        expected_error: expected_error(medium),
        range_nm: medium.range_nm(),
        relative_to: if arguments.absolute { "vacuum" } else { "air" },
        temperature_c,
        nd,
        vd: abbe(LineTriple::FDC),
        ne: known(e),
        ve: abbe(LineTriple::F_PRIME_E_C_PRIME),
        lines_nm: arguments.lines.map(|l| [l.short, l.mid, l.long].map(|line| line.wavelength_nm)),
        v_lines: arguments.lines.and_then(abbe),
        listed_nd: glass.and_then(|g| g.listed_nd),
        listed_vd: glass.and_then(|g| g.listed_vd),
        n: ByLine(n),
        wavelength_nm,
        n_at: wavelength_nm.map(index).filter(|n| n.is_finite()),
        internal_transmittance_10mm: measured.then_some(ByLine(transmittances)),
        internal_transmittance_10mm_at: wavelength_nm.filter(|_| measured).and_then(internal),
        reflectance: n_relative.map(|n| fresnel(1.0, n, 1.0).mean()),
        critical_angle_deg: n_relative.and_then(|n| critical_angle(n, 1.0)).map(f64::to_degrees),
        brewster_angle_deg: n_relative.map(|n| brewster_angle(1.0, n).to_degrees()),
        dn_dt_relative_1e6: slope(&|g, t| g.index_at(e, t)),
        dn_dt_absolute_1e6: slope(&|g, t| g.absolute_index(e, t)),
        source: glass.map(|g| g.source.to_string()).filter(|s| !s.is_empty()),
        warnings: warnings(medium, glass, arguments),
    }
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

fn warnings(medium: &Medium, glass: Option<&Glass>, arguments: &GlassInfo) -> Vec<String> {
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

/// Formats the report as text.
fn text(report: &Report) -> String {
    let mut out = format!("{}{}\n\n", report.name, report.category.map_or(String::new(), |c| format!(": {c}")));
    let mut row = |name: &str, value: Option<String>| {
        if let Some(value) = value {
            // Writing to a String cannot fail.
            let _ = writeln!(out, "  {name:<24}{}{value}", if name.chars().count() < 24 { "" } else { "  " });
        }
    };
    let years =
        report.years.map(|(first, last)| if first == last { format!("{first}") } else { format!("{first}-{last}") });
    let status = report.status.filter(|s| *s != "unknown");
    let listed = [status.map(str::to_owned), years.map(|y| format!("in catalogues of {y}"))];
    row("status", Some(listed.into_iter().flatten().collect::<Vec<_>>().join(", ")).filter(|s| !s.is_empty()));
    row("source", report.source.clone());
    row("formula", report.formula.map(str::to_owned));
    let coefficients = report.coefficients.as_ref().filter(|c| c.len() <= 20);
    row("coefficients", coefficients.map(|c| c.iter().map(ToString::to_string).collect::<Vec<_>>().join("  ")));
    row("expected error", report.expected_error.map(str::to_owned));
    row("measured", report.range_nm.map(|(from, to)| format!("{from} to {to} nm")));
    row("index relative to", Some(format!("{}, at {} C", report.relative_to, report.temperature_c)));
    let listed = |v: Option<f64>| v.map_or(String::new(), |v| format!("  (listed: {v})"));
    row("nd", report.nd.map(|n| format!("{n:.6}{}", listed(report.listed_nd))));
    row("Vd", report.vd.map(|v| format!("{v:.2}{}", listed(report.listed_vd))));
    row("ne", report.ne.map(|n| format!("{n:.6}")));
    row("Ve", report.ve.map(|v| format!("{v:.2}")));
    if let Some([blue, middle, red]) = report.lines_nm {
        let value = report.v_lines.map_or_else(|| "outside the measured range".to_owned(), |v| format!("{v:.2}"));
        row(&format!("V {blue} {middle} {red} nm"), Some(value));
    }
    if let (Some(nm), Some(n)) = (report.wavelength_nm, report.n_at) {
        let tau = report
            .internal_transmittance_10mm_at
            .map_or(String::new(), |t| format!("  (internal transmittance of 10 mm: {t:.4})"));
        row(&format!("n at {nm} nm"), Some(format!("{n:.6}{tau}")));
    }
    let slopes = report.dn_dt_relative_1e6.zip(report.dn_dt_absolute_1e6);
    row(
        "dn/dT at e, 20 to 40 C",
        slopes.map(|(relative, absolute)| format!("{relative:.2}e-6 / K  (absolute: {absolute:.2}e-6 / K)")),
    );
    row("reflectance (d, bare)", report.reflectance.map(|r| format!("{:.3} %", 100.0 * r)));
    row("critical angle (d)", report.critical_angle_deg.map(|a| format!("{a:.3} deg")));
    row("Brewster's angle (d)", report.brewster_angle_deg.map(|a| format!("{a:.3} deg")));
    let transmittance = |name: &str| {
        let of_lines = report.internal_transmittance_10mm.as_ref()?;
        of_lines.0.iter().find(|(n, _)| *n == name).map(|(_, t)| *t)
    };
    if !report.n.0.is_empty() {
        let _ = writeln!(
            out,
            "\n  line    nm          n{}",
            if report.internal_transmittance_10mm.is_some() { "         internal transmittance, 10 mm" } else { "" }
        );
    }
    for (name, n) in &report.n.0 {
        let nm = lines::by_name(name).map_or(0.0, |line| line.wavelength_nm);
        let tau = transmittance(name).map_or(String::new(), |t| format!("  {t:.4}"));
        let _ = writeln!(out, "  {name:<4} {nm:>10.4}  {n:.6}{tau}");
    }
    out
}
