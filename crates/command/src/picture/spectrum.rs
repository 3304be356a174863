//! `spectra picture spectrum`: shows the mean color and the spectrum of areas.

use super::arguments::PictureSpectrum;
use super::{load, refuse, stem};
use crate::console;
use crate::formatting::is_yaml;
use crate::outcome::{DONE, Failure, Outcome};
use serde_json::{Value, json};
use spectra_analysis::figure;
use spectra_analysis::picture::{Area, Rectangle};
use spectra_color::{RgbSpace, cct, chromaticity, dominant_wavelength};
use spectra_files::write_atomically;
use spectra_plot::Format;
use spectra_sheet::{Sheet, percent, significant};
use std::io::Write;

/// Shows the mean colors of areas, and writes a spectrum and a diagram of them if requested.
pub(super) fn spectrum(arguments: &PictureSpectrum) -> Outcome {
    let path = &arguments.file;
    if let Some(diagram) = &arguments.diagram {
        Format::of(diagram)?;
    }
    if let Some(output) = &arguments.output {
        if !is_yaml(output) {
            return Err(Failure::Input(format!("{}: the name of a spectrum file must end in .yaml", output.display())));
        }
        if arguments.areas.len() > 1 {
            return Err(Failure::Input("-o writes the spectrum of only one area: give `--area` once".to_owned()));
        }
    }
    let picture = load(path)?;
    let whole = arguments.areas.is_empty().then_some(None);
    let asked = arguments.areas.iter().copied().map(Some).chain(whole);
    let areas = asked.map(|area| Area::of(&picture, area).map_err(|error| refuse(path, error)));
    let areas = areas.collect::<Result<Vec<Area>, Failure>>()?;
    if picture.colors.is_none() {
        return Err(refuse(path, picture.without_colors()));
    }
    if let (Some(output), [area]) = (&arguments.output, areas.as_slice()) {
        let said = format!("{}, area {}", stem(path), written(area.rectangle));
        let text = area.histogram(&said).map_err(|error| refuse(path, error))?;
        write_atomically(output, |out| Ok(out.write_all(text.as_bytes())?))?;
        console::note(&format!("wrote {}", output.display()));
    }
    if let Some(diagram) = &arguments.diagram {
        let point = |area: &Area| Some((written(area.rectangle), chromaticity(area.xyz?)?));
        let points: Vec<_> = areas.iter().filter_map(point).collect();
        if points.is_empty() {
            let text = format!("{}: no light falls on the area, so it has no chromaticity", path.display());
            return Err(Failure::Input(text));
        }
        figure::chromaticity(&points).write(diagram)?;
        console::note(&format!("wrote {}", diagram.display()));
    }
    let sheets: Vec<Sheet> = areas.iter().map(|area| sheet(area, picture.unit.symbol())).collect();
    if arguments.report.json {
        let areas: Vec<Value> = sheets.iter().map(Sheet::to_json).collect();
        console::pretty_json(&json!({ "file": path.display().to_string(), "areas": areas }))?;
    } else {
        console::sheets(&sheets, false)?;
    }
    Ok(DONE)
}

/// Formats an area as it is written on the command line.
fn written(area: Rectangle) -> String {
    let Rectangle { from: [x, y], size: [width, height] } = area;
    format!("{x},{y},{width},{height}")
}

/// Makes the sheet of an area, whose XYZ are in `unit`. The dominant wavelength is for a white of D65; a purple has the complementary
/// wavelength with a negative sign. Irradiance is the mean of each band between two edges, W m^-2 nm^-1.
fn sheet(area: &Area, unit: &str) -> Sheet {
    let mut sheet = Sheet::new(&format!("area {}", written(area.rectangle)));
    let Rectangle { from: [x, y], size: [width, height] } = area.rectangle;
    sheet.data("area_px", [x, y, width, height]);
    let xyz_text = |xyz: &[f64; 3]| format!("{}  {unit}", xyz.map(significant).join("  ")).trim_end().to_owned();
    sheet.fact("xyz", "XYZ", area.xyz, xyz_text);
    sheet.data("unit", unit);
    let xy = area.xyz.and_then(chromaticity);
    sheet.fact("xy", "xy", xy, |[x, y]| format!("{x:.5}  {y:.5}"));
    let temperature = xy.and_then(cct);
    sheet.line("color temperature", temperature.map(|t| format!("{:.1} K  (Duv {:+.4})", t.kelvin, t.duv)));
    sheet.data("cct_k", temperature.map(|t| t.kelvin));
    sheet.data("duv", temperature.map(|t| t.duv));
    let dominant = xy.and_then(|xy| dominant_wavelength(xy, RgbSpace::srgb().white_xy));
    let signed_nm = dominant.map(|d| if d.complementary { -d.wavelength_nm } else { d.wavelength_nm });
    let label = if dominant.is_some_and(|d| d.complementary) { "complementary" } else { "dominant wavelength" };
    sheet.fact("dominant_wavelength_nm", label, signed_nm, |nm| format!("{:.2} nm", nm.abs()));
    sheet.fact("purity", "excitation purity", dominant.map(|d| d.purity), |p| percent(*p, 2));
    if let [first, .., last] = area.edges_nm[..] {
        let bands = || area.bands.iter().zip(area.edges_nm.windows(2));
        let power: f64 = bands().map(|(mean, pair)| mean * (pair[1] - pair[0])).sum();
        let power = format!("{} W/m2 from {first:.1} to {last:.1} nm", significant(power));
        sheet.line("irradiance", Some(power));
        let peak = bands().max_by(|a, b| a.0.total_cmp(b.0));
        sheet.line("highest band", peak.map(|(_, pair)| format!("{:.1} to {:.1} nm", pair[0], pair[1])));
        sheet.data("irradiance_w_m2_nm", &area.bands);
        sheet.data("edges_nm", &area.edges_nm);
    }
    sheet
}
