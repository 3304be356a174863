//! `spectra spectrum info`: shows the figures of a spectrum.

use super::arguments::{ObserverName, SpectrumInfo};
use super::{files, load_as, load_illuminant, tell_reading};
use crate::console;
use crate::outcome::{DONE, Failure, Outcome};
use serde::Serialize;
use spectra_color::{
    Adaptation, Dominant, Gamut, RgbSpace, cct, chromaticity, color_rendering, dominant_wavelength, fidelity,
    into_gamut, lab, luminous_efficacy, to_u8, uv_1976, xyz_of_light, xyz_of_reflectance, xyz_of_transmittance,
};
use spectra_core::quantity::light_nm;
use spectra_spectrum::{
    AnySpectrum, BAND, Emission, Kind, Observer, SpectralFunction, Strengths, Tabulated, find_in, function_in, meta_in,
    named_line,
};
use std::fmt::Write;

/// Approximate smallest luminance that an eye sees after an hour in the dark, cd/m2.
const DARK_CD_M2: f64 = 1e-6;

/// Figures of a spectrum. Those that do not apply are `None`.
#[derive(Debug, Serialize)]
struct Report {
    name: String,
    kind: &'static str,
    title: Option<String>,
    source: Option<String>,
    license: Option<String>,
    conditions: Option<String>,
    /// Origin of the strengths of a lamp's lines: measured, computed or estimated.
    strengths: Option<&'static str>,
    notes: Vec<String>,
    range_nm: Option<[f64; 2]>,
    observer: &'static str,
    /// Light on a surface or behind a filter; also the white of `lab`, `dominant_wavelength_nm` and `purity`.
    illuminant: String,
    xyz: Option<[f64; 3]>,
    xy: Option<[f64; 2]>,
    lab: Option<[f64; 3]>,
    cct_k: Option<f64>,
    /// Distance from the Planckian locus, CIE 1960.
    duv: Option<f64>,
    dominant_wavelength_nm: Option<f64>,
    /// Complementary wavelength of a purple, which has no dominant wavelength.
    complementary_wavelength_nm: Option<f64>,
    purity: Option<f64>,
    /// Luminance of a light: cd/m2 if its unit is W m^-2 sr^-1 nm^-1, relative otherwise.
    luminance: Option<f64>,
    peak_nm: Option<f64>,
    /// Mean wavelength over 350-830 nm, weighted by power or value, including lines.
    centroid_nm: Option<f64>,
    /// Wavelengths on both sides where the spectrum has fallen to half of its peak; `width_nm` is their distance.
    half_height_nm: Option<[f64; 2]>,
    width_nm: Option<f64>,
    /// Power of a light over 350-830 nm, including lines: W if its unit is W/nm.
    power: Option<f64>,
    luminous_efficacy_lm_per_w: Option<f64>,
    /// CIE 1976 u', v'.
    uv_1976: Option<[f64; 2]>,
    /// CIE 13.3 general color rendering index of a light with a color temperature; `cie_r` has the special indices R1 to R14.
    cie_ra: Option<f64>,
    cie_r: Option<Vec<f64>>,
    /// CIE 224 and TM-30 fidelity index.
    tm30_rf: Option<f64>,
    /// Values at the requested wavelengths.
    values: Vec<At>,
    srgb: Option<[u8; 3]>,
    srgb_linear: Option<[f64; 3]>,
}

/// Value of a spectrum at a wavelength; for a light that of the continuum.
#[derive(Debug, Serialize)]
struct At {
    wavelength_nm: f64,
    value: f64,
    /// Power of the lines within 0.5 nm.
    #[serde(skip_serializing_if = "Option::is_none")]
    lines: Option<f64>,
}

/// Writes the figures of a spectrum to standard output, as text or JSON.
pub(crate) fn info(arguments: &SpectrumInfo) -> Outcome {
    if let Some((kind, function)) = function_in(&arguments.name, &files())
        && find_in(&arguments.name, &files()).is_err()
    {
        return show_function(arguments, kind, &function);
    }
    let asked = wavelengths(&arguments.wavelength_nm)?;
    let found = load_as(&arguments.name, arguments.kind)?;
    tell_reading(&arguments.name);
    let illuminant = load_illuminant(&arguments.illuminant)?;
    let observer = observer(arguments.observer);
    let standard = Observer::cie_1931_2deg();
    let white = |observer| {
        let none = || Failure::Input(format!("--illuminant: `{}` has no visible light", arguments.illuminant));
        xyz_of_light(&illuminant, observer).ok_or_else(none)
    };
    let meta = meta_in(&arguments.name, &files()).unwrap_or_default();
    let xyz = xyz(&found, &illuminant, observer);
    let color = Color::of(&found, &illuminant, white(standard)?);
    let dominant = color.as_ref().and_then(|c| c.dominant);
    let temperature =
        color.as_ref().and_then(|c| c.xy).filter(|_| !matches!(found, AnySpectrum::Reflectance(_))).and_then(cct);
    let white = white(observer)?;
    let light = if let AnySpectrum::Emission(light) = &found { Some(light) } else { None };
    let half_height_nm = half_height_nm(&found);
    let rendering = light.and_then(color_rendering);
    let report = Report {
        name: arguments.name.trim().to_owned(),
        kind: found.kind().word(),
        title: meta.name,
        source: meta.source,
        license: meta.license,
        conditions: meta.conditions,
        strengths: meta.strengths.map(Strengths::word),
        notes: meta.notes,
        range_nm: meta.range_nm.map(|(from, to)| [from, to]),
        observer: observer.name(),
        illuminant: arguments.illuminant.trim().to_owned(),
        xyz,
        xy: xyz.and_then(chromaticity),
        lab: xyz.map(|xyz| lab(xyz, white)),
        cct_k: temperature.map(|t| t.kelvin),
        duv: temperature.map(|t| t.duv),
        dominant_wavelength_nm: dominant.filter(|d| !d.complementary).map(|d| d.wavelength_nm),
        complementary_wavelength_nm: dominant.filter(|d| d.complementary).map(|d| d.wavelength_nm),
        purity: dominant.map(|d| d.purity),
        luminance: light.map(Emission::luminance),
        peak_nm: peak_nm(&found),
        centroid_nm: match &found {
            AnySpectrum::Emission(light) => light.centroid_nm(),
            matter => shape_of(matter).and_then(SpectralFunction::centroid_nm),
        },
        half_height_nm,
        width_nm: half_height_nm.map(|[low, high]| high - low),
        power: light.map(|light| light.power(&BAND)),
        luminous_efficacy_lm_per_w: light.and_then(luminous_efficacy),
        uv_1976: xyz.and_then(chromaticity).map(uv_1976),
        cie_ra: rendering.as_ref().map(|r| r.ra),
        cie_r: rendering.map(|r| r.special),
        tm30_rf: light.and_then(fidelity).map(|f| f.rf),
        values: asked.into_iter().map(|nm| value_at(&found, nm)).collect(),
        srgb: color.as_ref().map(|c| RgbSpace::srgb().encode(c.linear).map(to_u8)),
        srgb_linear: color.as_ref().map(|c| c.linear),
    };
    if arguments.json {
        console::pretty_json(&report)?;
    } else {
        console::out(&text(&report, &found))?;
    }
    Ok(DONE)
}

/// Parses the wavelengths of `--wavelength-nm`, numbers or letters of lines; returns nm.
fn wavelengths(texts: &[String]) -> Result<Vec<f64>, Failure> {
    let one = |text: &String| {
        let nm = named_line(text).map(|line| line.nominal_nm).or_else(|| text.trim().parse().ok());
        let wrong = || {
            Failure::Input(format!(
                "--wavelength-nm: `{text}` is not a wavelength: write nm or a line, such as 546.07,C'"
            ))
        };
        let nm = nm.filter(|nm: &f64| nm.is_finite() && *nm > 0.0 && *nm <= 1e6).ok_or_else(wrong)?;
        light_nm(nm).map_err(|wrong| Failure::Input(format!("--wavelength-nm: {wrong}: {}", wrong.hint())))
    };
    texts.iter().map(one).collect()
}

/// Returns the curve of a filter, a surface or a detector, or the continuum of a light; `None` for a light with lines alone.
fn shape_of(found: &AnySpectrum) -> Option<&SpectralFunction> {
    match found {
        AnySpectrum::Emission(light) => light.continuum(),
        AnySpectrum::Transmittance(filter) => Some(filter.shape()),
        AnySpectrum::Reflectance(surface) => Some(surface.shape()),
        AnySpectrum::Sensitivity(detector) => Some(detector.shape()),
    }
}

/// Returns the wavelengths at half height. `None` for a light with lines, because lines have no height to compare with.
fn half_height_nm(found: &AnySpectrum) -> Option<[f64; 2]> {
    match found {
        AnySpectrum::Emission(light) if !light.lines().is_empty() => None,
        found => shape_of(found).and_then(SpectralFunction::half_height_nm),
    }
}

fn value_at(found: &AnySpectrum, wavelength_nm: f64) -> At {
    let value = shape_of(found).map_or(0.0, |shape| shape.at(wavelength_nm));
    let lines = match found {
        AnySpectrum::Emission(light) if !light.lines().is_empty() => {
            let near = light.lines().iter().filter(|line| (line.wavelength_nm - wavelength_nm).abs() <= 0.5);
            Some(near.map(|line| line.power).sum())
        }
        _ => None,
    };
    At { wavelength_nm, value, lines }
}

/// Writes where a function of wavelength is highest and lowest, if it is not a light, a filter, a surface or a detector.
fn show_function(arguments: &SpectrumInfo, kind: Kind, function: &Tabulated) -> Outcome {
    let values = BAND.wavelengths_nm().map(|nm| (nm, function.at(nm)));
    let values: Vec<(f64, f64)> = values.collect();
    let by_value = |a: &&(f64, f64), b: &&(f64, f64)| a.1.total_cmp(&b.1);
    let (Some(highest), Some(lowest)) = (values.iter().max_by(by_value), values.iter().min_by(by_value)) else {
        return Ok(DONE);
    };
    let meta = meta_in(&arguments.name, &files()).unwrap_or_default();
    let name = arguments.name.trim();
    if arguments.json {
        console::pretty_json(&serde_json::json!({
            "name": name,
            "kind": kind.word(),
            "title": meta.name,
            "source": meta.source,
            "license": meta.license,
            "range_nm": meta.range_nm.map(|(from, to)| [from, to]),
            "peak_nm": highest.0,
            "highest": highest.1,
            "lowest_nm": lowest.0,
            "lowest": lowest.1,
        }))?;
        return Ok(DONE);
    }
    let title = meta.name.map_or(String::new(), |title| format!(" ({title})"));
    let mut out = format!("{name}{title}: {}\n\n", kind.word());
    let mut row = |name: &str, value: String| {
        // Writing to a String cannot fail.
        let _ = writeln!(out, "  {name:<22}{value}");
    };
    row("source", meta.source.unwrap_or_default());
    row("license", meta.license.unwrap_or_default());
    row("range", meta.range_nm.map_or(String::new(), |(from, to)| format!("{from} to {to} nm")));
    row("highest", format!("{} at {} nm", significant(highest.1), highest.0));
    row("lowest", format!("{} at {} nm", significant(lowest.1), lowest.0));
    console::out(&out)?;
    Ok(DONE)
}

pub(super) fn observer(name: ObserverName) -> &'static Observer {
    match name {
        ObserverName::Cie1931 => Observer::cie_1931_2deg(),
        ObserverName::Cie1964 => Observer::cie_1964_10deg(),
        ObserverName::Cie2015Narrow => Observer::cie_2015_2deg(),
        ObserverName::Cie2015Wide => Observer::cie_2015_10deg(),
    }
}

fn xyz(found: &AnySpectrum, illuminant: &Emission, observer: &Observer) -> Option<[f64; 3]> {
    match found {
        AnySpectrum::Emission(light) => xyz_of_light(light, observer),
        AnySpectrum::Transmittance(filter) => xyz_of_transmittance(filter, illuminant, observer),
        AnySpectrum::Reflectance(surface) => xyz_of_reflectance(surface, illuminant, observer),
        AnySpectrum::Sensitivity(_) => None,
    }
}

/// Color values that are defined only for the CIE 1931 observer.
struct Color {
    xy: Option<[f64; 2]>,
    dominant: Option<Dominant>,
    /// Linear sRGB from 0 to 1. A light is scaled so that its largest component is 1; for matter the white of the illuminant is adapted
    /// to D65.
    linear: [f64; 3],
}

impl Color {
    fn of(found: &AnySpectrum, illuminant: &Emission, white: [f64; 3]) -> Option<Self> {
        let srgb = RgbSpace::srgb();
        let xyz = xyz(found, illuminant, Observer::cie_1931_2deg())?;
        let xy = chromaticity(xyz);
        let dominant = xy.zip(chromaticity(white)).and_then(|(xy, white)| dominant_wavelength(xy, white));
        let linear = if let AnySpectrum::Emission(_) = found {
            let rgb = srgb.from_xyz(xyz).map(|v| v.max(0.0));
            let brightest = rgb.into_iter().fold(0.0, f64::max);
            if brightest > 0.0 { rgb.map(|v| v / brightest) } else { rgb }
        } else {
            let unit = |xyz: [f64; 3]| xyz.map(|v| v / 100.0);
            let adapted = Adaptation::Bradford.adapt(unit(xyz), unit(white), srgb.white_xyz());
            into_gamut(srgb.from_xyz(adapted), srgb, Gamut::Perceptual)
        };
        Some(Self { xy, dominant, linear })
    }
}

/// Returns the values on the band at whole nanometers; for a light those of the continuum.
fn on_band(found: &AnySpectrum) -> Vec<f64> {
    match found {
        AnySpectrum::Emission(light) => light.on_grid(&BAND),
        AnySpectrum::Transmittance(filter) => filter.on_grid(&BAND),
        AnySpectrum::Reflectance(surface) => surface.on_grid(&BAND),
        AnySpectrum::Sensitivity(detector) => detector.on_grid(&BAND),
    }
}

/// Returns the wavelength (nm) of the highest value on the band, the first of equal ones. Without a continuum, returns that of the
/// strongest line.
fn peak_nm(found: &AnySpectrum) -> Option<f64> {
    let values = on_band(found);
    let best = BAND.wavelengths_nm().zip(values).fold((0.0, 0.0), |best, now| if now.1 > best.1 { now } else { best });
    match found {
        _ if best.1 > 0.0 => Some(best.0),
        AnySpectrum::Emission(light) => {
            light.lines().iter().max_by(|a, b| a.power.total_cmp(&b.power)).map(|l| l.wavelength_nm)
        }
        _ => None,
    }
}

/// Distance from the Planckian locus up to which the CIE's color rendering index is defined (CIE 13.3-1995, 5.3).
const RENDERING_DUV: f64 = 5.4e-3;

/// Text shown for estimated strengths of lines.
const ESTIMATED: &str = "estimated by eye: lines far apart are not comparable, so the colors below are a guess";

/// Formats the report as text.
fn text(report: &Report, found: &AnySpectrum) -> String {
    let matter = matches!(found, AnySpectrum::Transmittance(_) | AnySpectrum::Reflectance(_));
    let title = report.title.as_deref().filter(|title| *title != report.name);
    let mut out = format!("{}{}: {}\n\n", report.name, title.map_or(String::new(), |t| format!(" ({t})")), report.kind);
    let mut row = |name: &str, value: Option<String>| {
        if let Some(value) = value {
            // Writing to a String cannot fail.
            let _ = writeln!(out, "  {name:<22}{value}");
        }
    };
    row("source", report.source.clone());
    row("license", report.license.clone());
    row("conditions", report.conditions.clone());
    row("strengths", report.strengths.map(|s| if s == Strengths::Estimated.word() { ESTIMATED } else { s }.to_owned()));
    report.notes.iter().for_each(|note| row("note", Some(note.clone())));
    row("range", report.range_nm.map(|[from, to]| format!("{from} to {to} nm")));
    row("peak", report.peak_nm.map(|nm| peak_in_words(nm, &on_band(found))));
    row(
        "centroid",
        report.centroid_nm.map(|nm| format!("{nm:.2} nm, weighted by {}", if matter { "value" } else { "power" })),
    );
    let half = report.half_height_nm.zip(report.width_nm);
    row(
        "width at half height",
        half.map(|([low, high], width)| format!("{width:.2} nm, from {low:.2} to {high:.2} nm")),
    );
    for At { wavelength_nm, value, lines } in &report.values {
        let lines = lines
            .filter(|p| *p > 0.0)
            .map_or(String::new(), |p| format!(" and lines of {} within 0.5 nm", significant(p)));
        row(&format!("at {wavelength_nm} nm"), Some(format!("{}{lines}", significant(*value))));
    }
    if report.xyz.is_some() {
        let light = if matter { format!(", under {}", report.illuminant) } else { String::new() };
        row("observer", Some(format!("{}{light}", report.observer)));
    }
    row("XYZ", report.xyz.map(|v| numbers(&v, 4)));
    row("xy", report.xy.map(|v| numbers(&v, 5)));
    row("u'v'", report.uv_1976.map(|v| numbers(&v, 5)));
    row("Lab", report.lab.map(|v| format!("{}  (white: {})", numbers(&v, 3), report.illuminant)));
    let far = |duv: Option<f64>| duv.map_or(String::new(), |duv| format!("  (Duv {duv:+.4})"));
    row("color temperature", report.cct_k.map(|k| format!("{k:.1} K{}", far(report.duv))));
    row("dominant wavelength", report.dominant_wavelength_nm.map(|nm| format!("{nm:.2} nm")));
    row("complementary", report.complementary_wavelength_nm.map(|nm| format!("{nm:.2} nm")));
    row("excitation purity", report.purity.map(|p| format!("{:.2} %", 100.0 * p)));
    // The unit of a black body is known, so its luminance can be compared with the limit of vision.
    let is_dark = report.name.starts_with("blackbody") && report.luminance.is_some_and(|l| l < DARK_CD_M2);
    row("light", is_dark.then(|| "too little between 350 and 830 nm to see".to_owned()));
    row("luminance", report.luminance.map(|l| format!("{} cd/m2, if its unit is W/(m2 sr nm)", significant(l))));
    row("power", report.power.map(|p| format!("{} W over 350-830 nm, if its unit is W/nm", significant(p))));
    row("luminous efficacy", report.luminous_efficacy_lm_per_w.map(|e| format!("{e:.2} lm/W over 350-830 nm")));
    let far = if report.duv.is_some_and(|duv| duv.abs() > RENDERING_DUV) {
        "; of little meaning so far from white"
    } else {
        ""
    };
    row("CIE Ra", report.cie_ra.map(|ra| format!("{ra:.1}{far}")));
    row("TM-30 Rf", report.tm30_rf.map(|rf| format!("{rf:.1}{far}")));
    let srgb = report.srgb.zip(report.srgb_linear);
    row(
        "sRGB",
        srgb.map(|([r, g, b], linear)| {
            format!("{r} {g} {b}  #{r:02x}{g:02x}{b:02x}  (linear {})", numbers(&linear, 4))
        }),
    );
    out
}

/// Returns the peak as text, or says that the band ends before there is a peak, or that all values are equal.
fn peak_in_words(nm: f64, values: &[f64]) -> String {
    let highest = values.iter().copied().fold(0.0, f64::max);
    let stays = highest > 0.0 && values.last() == Some(&highest);
    match nm {
        _ if stays && values.iter().all(|value| *value == highest) => "none: the same over the whole band".to_owned(),
        nm if nm >= BAND.end_nm() => format!("none: rises to the end of the band, {nm} nm"),
        nm if stays && nm > BAND.start_nm => format!("none: rises to {nm} nm and stays there to the end of the band"),
        nm if nm <= BAND.start_nm => format!("none: falls from the start of the band, {nm} nm"),
        // Computed values have more digits than are meaningful.
        nm => format!("{} nm", (nm * 1000.0).round_ties_even() / 1000.0),
    }
}

fn numbers(values: &[f64], decimals: usize) -> String {
    let shown: Vec<String> = values.iter().map(|v| format!("{:.decimals$}", v + 0.0)).collect();
    shown.join("  ")
}

/// Formats a number with six digits, with a power of ten if it is large or small.
fn significant(value: f64) -> String {
    if value == 0.0 || (1e-3..1e6).contains(&value.abs()) {
        let whole = format!("{:.0}", value.abs()).len();
        format!("{value:.*}", 6_usize.saturating_sub(whole))
    } else {
        format!("{value:.5e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spectrum::load;

    #[test]
    fn a_band_may_end_before_the_peak() {
        assert_eq!(peak_in_words(560.0, &[0.0, 1.0, 0.0]), "560 nm");
        assert_eq!(peak_in_words(830.0, &[0.0, 0.5, 1.0]), "none: rises to the end of the band, 830 nm");
        assert_eq!(
            peak_in_words(700.0, &[0.0, 1.0, 1.0]),
            "none: rises to 700 nm and stays there to the end of the band"
        );
        assert_eq!(peak_in_words(350.0, &[1.0, 0.5, 0.0]), "none: falls from the start of the band, 350 nm");
        assert_eq!(peak_in_words(350.0, &[1.0, 1.0, 1.0]), "none: the same over the whole band");
        // A light with lines alone has no continuum.
        assert_eq!(peak_in_words(546.0, &[0.0, 0.0, 0.0]), "546 nm");
    }

    #[test]
    fn numbers_keep_six_digits() {
        assert_eq!(
            [0.0, 12.3456789, 123_456.7, 1.5e9, 2e-5].map(significant),
            ["0.00000", "12.3457", "123457", "1.50000e9", "2.00000e-5"]
        );
    }

    #[test]
    fn peaks_are_of_continuum_or_lines() {
        let peak = |name: &str| load(name).ok().and_then(|found| peak_nm(&found));
        assert_eq!(
            [peak("gaussian:550,20"), peak("line:632.8"), peak("v-lambda-1924")],
            [Some(550.0), Some(632.8), Some(555.0)]
        );
        assert_eq!(peak("constant:0"), None);
    }
}
