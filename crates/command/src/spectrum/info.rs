//! `spectra spectrum info`: shows the figures of a spectrum.

use super::arguments::{ObserverName, SpectrumInfo};
use super::{files, load_as, load_illuminant, tell_reading};
use crate::console;
use crate::outcome::{DONE, Failure, Outcome};
use serde_json::{Value, json};
use spectra_color::{
    Adaptation, Cct, Gamut, RgbSpace, cct, chromaticity, color_rendering, dominant_wavelength, fidelity, into_gamut,
    lab, luminous_efficacy, to_u8, uv_1976, xyz_of_light, xyz_of_reflectance, xyz_of_transmittance,
};
use spectra_core::quantity::light_nm;
use spectra_sheet::{Sheet, percent};
use spectra_spectrum::{
    AnySpectrum, BAND, Emission, Grid, Kind, Meta, Observer, SpectralFunction, Strengths, Tabulated, find_in,
    function_in, meta_in, named_line,
};

/// Approximate smallest luminance that an eye sees after an hour in the dark, cd/m2.
const DARK_CD_M2: f64 = 1e-6;

/// Distance from the Planckian locus up to which the CIE's color rendering index is defined (CIE 13.3-1995, 5.3).
const RENDERING_DUV: f64 = 5.4e-3;

/// Text shown for estimated strengths of lines.
const ESTIMATED: &str = "estimated by eye: lines far apart are not comparable, so the colors below are a guess";

/// Writes the figures of a spectrum to standard output, as text or JSON.
pub(crate) fn info(arguments: &SpectrumInfo) -> Outcome {
    let meta = meta_in(&arguments.name, &files()).unwrap_or_default();
    let sheet = match function_in(&arguments.name, &files()) {
        Some((kind, function)) if find_in(&arguments.name, &files()).is_err() => {
            function_sheet(arguments.name.trim(), &meta, kind, &function)
        }
        _ => spectrum_sheet(arguments, &meta)?,
    };
    console::sheet(&sheet, arguments.json)?;
    Ok(DONE)
}

/// Returns the figures of a spectrum. In the data, those that do not apply are `null`.
fn spectrum_sheet(arguments: &SpectrumInfo, meta: &Meta) -> Result<Sheet, Failure> {
    let name = arguments.name.trim();
    let asked = wavelengths(&arguments.wavelength_nm)?;
    let found = load_as(&arguments.name, arguments.kind)?;
    tell_reading(&arguments.name);
    let kind = found.kind().word();
    let title = meta.name.as_ref().filter(|title| title.as_str() != name);
    let mut sheet = Sheet::new(&format!("{name}{}: {kind}", title.map_or(String::new(), |t| format!(" ({t})"))));
    sheet.data("name", name);
    sheet.data("kind", kind);
    origin(&mut sheet, meta);
    curve(&mut sheet, &found, &asked);
    let (temperature, linear) = color(&mut sheet, arguments, &found)?;
    let light = if let AnySpectrum::Emission(light) = &found { Some(light) } else { None };
    lamp(&mut sheet, name, light, temperature);
    let code = |linear: [f64; 3]| RgbSpace::srgb().encode(linear).map(to_u8);
    sheet.data("srgb", linear.map(code));
    sheet.fact("srgb_linear", "sRGB", linear, |linear| {
        let [r, g, b] = code(*linear);
        format!("{r} {g} {b}  #{r:02x}{g:02x}{b:02x}  (linear {})", numbers(linear, 4))
    });
    Ok(sheet)
}

/// Adds where the figures come from, and the range of their table.
fn origin(sheet: &mut Sheet, meta: &Meta) {
    sheet.data("title", &meta.name);
    sheet.text("source", "source", meta.source.as_deref());
    sheet.text("license", "license", meta.license.as_deref());
    sheet.text("conditions", "conditions", meta.conditions.as_deref());
    let words =
        |strengths: Strengths| if strengths == Strengths::Estimated { ESTIMATED } else { strengths.word() }.to_owned();
    sheet.line("strengths", meta.strengths.map(words));
    sheet.data("strengths", meta.strengths.map(Strengths::word));
    meta.notes.iter().for_each(|note| sheet.line("note", Some(note.clone())));
    sheet.data("notes", &meta.notes);
    sheet.fact("range_nm", "range", meta.range_nm, |(from, to)| format!("{from} to {to} nm"));
}

/// Adds peak, centroid and width of a spectrum, and its values at the wavelengths that the user asked for, nm.
fn curve(sheet: &mut Sheet, found: &AnySpectrum, asked: &[f64]) {
    sheet.fact("peak_nm", "peak", peak_nm(found), |nm| peak_in_words(*nm, &on_grid(found, &BAND)));
    let centroid_nm = match found {
        AnySpectrum::Emission(light) => light.centroid_nm(),
        matter => shape_of(matter).and_then(SpectralFunction::centroid_nm),
    };
    let weight = if is_matter(found) { "value" } else { "power" };
    sheet.fact("centroid_nm", "centroid", centroid_nm, |nm| format!("{nm:.2} nm, weighted by {weight}"));
    let half_height_nm = match found {
        // Lines have no height to compare with.
        AnySpectrum::Emission(light) if !light.lines().is_empty() => None,
        found => shape_of(found).and_then(SpectralFunction::half_height_nm),
    };
    sheet.fact("half_height_nm", "width at half height", half_height_nm, |[low, high]| {
        format!("{:.2} nm, from {low:.2} to {high:.2} nm", high - low)
    });
    sheet.data("width_nm", half_height_nm.map(|[low, high]| high - low));
    let values: Vec<Value> = asked.iter().map(|nm| value_at(sheet, found, *nm)).collect();
    sheet.data("values", values);
}

/// Adds a line with the value at a wavelength, for a light that of the continuum, and the power of the lines within 0.5 nm. Returns both as
/// data.
fn value_at(sheet: &mut Sheet, found: &AnySpectrum, wavelength_nm: f64) -> Value {
    let value = shape_of(found).map_or(0.0, |shape| shape.at(wavelength_nm));
    let mut data = json!({ "wavelength_nm": wavelength_nm, "value": value });
    let mut text = significant(value);
    if let AnySpectrum::Emission(light) = found
        && !light.lines().is_empty()
    {
        let near = light.lines().iter().filter(|line| (line.wavelength_nm - wavelength_nm).abs() <= 0.5);
        let power: f64 = near.map(|line| line.power).sum();
        data["lines"] = json!(power);
        if power > 0.0 {
            text += &format!(" and lines of {} within 0.5 nm", significant(power));
        }
    }
    sheet.line(&format!("at {wavelength_nm} nm"), Some(text));
    data
}

/// Adds the color of a light, or of matter in the illuminant. Returns the color temperature and linear sRGB.
fn color(
    sheet: &mut Sheet,
    arguments: &SpectrumInfo,
    found: &AnySpectrum,
) -> Result<(Option<Cct>, Option<[f64; 3]>), Failure> {
    let (name, observer) = (arguments.illuminant.trim(), observer(arguments.observer));
    let illuminant = load_illuminant(&arguments.illuminant)?;
    let white = |observer| {
        let none = || Failure::Input(format!("--illuminant: `{}` has no visible light", arguments.illuminant));
        xyz_of_light(&illuminant, observer).ok_or_else(none)
    };
    let (xyz, own_white) = (xyz_of(found, &illuminant, observer), white(observer)?);
    let under = if is_matter(found) { format!(", under {name}") } else { String::new() };
    sheet.line("observer", xyz.map(|_| format!("{}{under}", observer.name())));
    sheet.data("observer", observer.name());
    sheet.data("illuminant", name);
    sheet.fact("xyz", "XYZ", xyz, |v| numbers(v, 4));
    let xy = xyz.and_then(chromaticity);
    sheet.fact("xy", "xy", xy, |v| numbers(v, 5));
    sheet.fact("uv_1976", "u'v'", xy.map(uv_1976), |v| numbers(v, 5));
    sheet.fact("lab", "Lab", xyz.map(|xyz| lab(xyz, own_white)), |v| format!("{}  (white: {name})", numbers(v, 3)));
    // The other values are defined only for the CIE 1931 observer.
    let standard = Observer::cie_1931_2deg();
    let (xyz, white) = (xyz_of(found, &illuminant, standard), white(standard)?);
    let xy = xyz.and_then(chromaticity);
    let temperature = xy.filter(|_| !matches!(found, AnySpectrum::Reflectance(_))).and_then(cct);
    sheet.line("color temperature", temperature.map(|t| format!("{:.1} K  (Duv {:+.4})", t.kelvin, t.duv)));
    sheet.data("cct_k", temperature.map(|t| t.kelvin));
    sheet.data("duv", temperature.map(|t| t.duv));
    let dominant = xy.zip(chromaticity(white)).and_then(|(xy, white)| dominant_wavelength(xy, white));
    let wavelength = |complementary| dominant.filter(|d| d.complementary == complementary).map(|d| d.wavelength_nm);
    let in_nm = |nm: &f64| format!("{nm:.2} nm");
    sheet.fact("dominant_wavelength_nm", "dominant wavelength", wavelength(false), in_nm);
    sheet.fact("complementary_wavelength_nm", "complementary", wavelength(true), in_nm);
    sheet.fact("purity", "excitation purity", dominant.map(|d| d.purity), |p| percent(*p, 2));
    Ok((temperature, xyz.map(|xyz| linear_srgb(found, xyz, white))))
}

/// Adds luminance, power, efficacy and color rendering of a light.
fn lamp(sheet: &mut Sheet, name: &str, light: Option<&Emission>, temperature: Option<Cct>) {
    let luminance = light.map(Emission::luminance);
    // The unit of a black body is known, so its luminance can be compared with the limit of vision.
    let is_dark = name.starts_with("blackbody") && luminance.is_some_and(|l| l < DARK_CD_M2);
    sheet.line("light", is_dark.then(|| "too little between 350 and 830 nm to see".to_owned()));
    sheet.fact("luminance", "luminance", luminance, |l| {
        format!("{} cd/m2, if its unit is W/(m2 sr nm)", significant(*l))
    });
    sheet.fact("power", "power", light.map(|light| light.power(&BAND)), |p| {
        format!("{} W over 350-830 nm, if its unit is W/nm", significant(*p))
    });
    let efficacy = light.and_then(luminous_efficacy);
    sheet.fact("luminous_efficacy_lm_per_w", "luminous efficacy", efficacy, |e| format!("{e:.2} lm/W over 350-830 nm"));
    let is_far = temperature.is_some_and(|t| t.duv.abs() > RENDERING_DUV);
    let far = if is_far { "; of little meaning so far from white" } else { "" };
    let index = |index: &f64| format!("{index:.1}{far}");
    let rendering = light.and_then(color_rendering);
    sheet.fact("cie_ra", "CIE Ra", rendering.as_ref().map(|r| r.ra), index);
    sheet.data("cie_r", rendering.map(|r| r.special));
    sheet.fact("tm30_rf", "TM-30 Rf", light.and_then(fidelity).map(|f| f.rf), index);
}

/// Returns where a function of wavelength is highest and lowest, if it is not a light, a filter, a surface or a detector.
fn function_sheet(name: &str, meta: &Meta, kind: Kind, function: &Tabulated) -> Sheet {
    let title = meta.name.as_ref().map_or(String::new(), |title| format!(" ({title})"));
    let mut sheet = Sheet::new(&format!("{name}{title}: {}", kind.word()));
    sheet.data("name", name);
    sheet.data("kind", kind.word());
    sheet.data("title", &meta.name);
    for (key, text) in [("source", &meta.source), ("license", &meta.license)] {
        sheet.line(key, Some(text.clone().unwrap_or_default()));
        sheet.data(key, text);
    }
    let range = meta.range_nm.map_or(String::new(), |(from, to)| format!("{from} to {to} nm"));
    sheet.line("range", Some(range));
    sheet.data("range_nm", meta.range_nm);
    let values = || BAND.wavelengths_nm().map(|nm| (nm, function.at(nm)));
    let by_value = |a: &(f64, f64), b: &(f64, f64)| a.1.total_cmp(&b.1);
    for (label, key_nm, extreme) in
        [("highest", "peak_nm", values().max_by(by_value)), ("lowest", "lowest_nm", values().min_by(by_value))]
    {
        sheet.line(label, extreme.map(|(nm, value)| format!("{} at {nm} nm", significant(value))));
        sheet.data(key_nm, extreme.map(|(nm, _)| nm));
        sheet.data(label, extreme.map(|(_, value)| value));
    }
    sheet
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
pub(super) fn shape_of(found: &AnySpectrum) -> Option<&SpectralFunction> {
    match found {
        AnySpectrum::Emission(light) => light.continuum(),
        AnySpectrum::Transmittance(filter) => Some(filter.shape()),
        AnySpectrum::Reflectance(surface) => Some(surface.shape()),
        AnySpectrum::Sensitivity(detector) => Some(detector.shape()),
    }
}

/// Returns the values on a grid; for a light those of the continuum.
pub(super) fn on_grid(found: &AnySpectrum, grid: &Grid) -> Vec<f64> {
    match found {
        AnySpectrum::Emission(light) => light.on_grid(grid),
        AnySpectrum::Transmittance(filter) => filter.on_grid(grid),
        AnySpectrum::Reflectance(surface) => surface.on_grid(grid),
        AnySpectrum::Sensitivity(detector) => detector.on_grid(grid),
    }
}

/// Whether the spectrum is that of matter in a light: a filter or a surface.
fn is_matter(found: &AnySpectrum) -> bool {
    matches!(found, AnySpectrum::Transmittance(_) | AnySpectrum::Reflectance(_))
}

/// Returns the observer with this name.
pub(super) fn observer(name: ObserverName) -> &'static Observer {
    match name {
        ObserverName::Cie1931 => Observer::cie_1931_2deg(),
        ObserverName::Cie1964 => Observer::cie_1964_10deg(),
        ObserverName::Cie2015Narrow => Observer::cie_2015_2deg(),
        ObserverName::Cie2015Wide => Observer::cie_2015_10deg(),
    }
}

/// Returns the tristimulus values of a light, or of a filter or surface in the illuminant; `None` for a detector and without visible light.
pub(super) fn xyz_of(found: &AnySpectrum, illuminant: &Emission, observer: &Observer) -> Option<[f64; 3]> {
    match found {
        AnySpectrum::Emission(light) => xyz_of_light(light, observer),
        AnySpectrum::Transmittance(filter) => xyz_of_transmittance(filter, illuminant, observer),
        AnySpectrum::Reflectance(surface) => xyz_of_reflectance(surface, illuminant, observer),
        AnySpectrum::Sensitivity(_) => None,
    }
}

/// Returns linear sRGB from 0 to 1. A light is scaled so that its largest component is 1; for matter the white of the illuminant is
/// adapted to D65.
fn linear_srgb(found: &AnySpectrum, xyz: [f64; 3], white: [f64; 3]) -> [f64; 3] {
    let srgb = RgbSpace::srgb();
    if let AnySpectrum::Emission(_) = found {
        let rgb = srgb.from_xyz(xyz).map(|v| v.max(0.0));
        let brightest = rgb.into_iter().fold(0.0, f64::max);
        return if brightest > 0.0 { rgb.map(|v| v / brightest) } else { rgb };
    }
    let unit = |xyz: [f64; 3]| xyz.map(|v| v / 100.0);
    let adapted = Adaptation::Bradford.adapt(unit(xyz), unit(white), srgb.white_xyz());
    into_gamut(srgb.from_xyz(adapted), srgb, Gamut::Perceptual)
}

/// Returns the wavelength (nm) of the highest value on the band, the first of equal ones. Without a continuum, returns that of the
/// strongest line.
fn peak_nm(found: &AnySpectrum) -> Option<f64> {
    let values = on_grid(found, &BAND);
    let best = BAND.wavelengths_nm().zip(values).fold((0.0, 0.0), |best, now| if now.1 > best.1 { now } else { best });
    match found {
        _ if best.1 > 0.0 => Some(best.0),
        AnySpectrum::Emission(light) => {
            light.lines().iter().max_by(|a, b| a.power.total_cmp(&b.power)).map(|l| l.wavelength_nm)
        }
        _ => None,
    }
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
