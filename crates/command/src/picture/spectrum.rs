//! `spectra picture spectrum`: shows the mean color and the spectrum of areas.

use super::arguments::PictureSpectrum;
use super::{load, not_written, refuse, significant, stem};
use crate::console;
use crate::outcome::{DONE, Failure, Outcome};
use serde::Serialize;
use spectra_analysis::figure;
use spectra_analysis::picture::{Area, Measured, Rectangle};
use spectra_color::{cct, chromaticity, dominant_wavelength};
use spectra_files::write_atomically;
use spectra_plot::Format;
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;

/// Figures of an area of a picture.
#[derive(Debug, Serialize)]
struct Report {
    /// Column, row, width and height of the area, pixels.
    area_px: [u32; 4],
    /// Mean XYZ (CIE 1931) in `unit`.
    xyz: Option<[f64; 3]>,
    unit: &'static str,
    xy: Option<[f64; 2]>,
    cct_k: Option<f64>,
    duv: Option<f64>,
    /// Dominant wavelength with a white of D65. For a purple, the complementary wavelength with a negative sign.
    dominant_wavelength_nm: Option<f64>,
    purity: Option<f64>,
    /// Mean irradiance of each band, W m^-2 nm^-1; `edges_nm` has the edges of the bands.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    irradiance_w_m2_nm: Vec<f64>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    edges_nm: Vec<f64>,
}

/// Shows the mean colors of areas, and writes a spectrum and a diagram of them if requested.
pub(super) fn spectrum(arguments: &PictureSpectrum) -> Outcome {
    let path = &arguments.file;
    if let Some(diagram) = &arguments.diagram {
        Format::of(diagram).map_err(not_written)?;
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
    let asked: Vec<Option<Rectangle>> = match arguments.areas.as_slice() {
        [] => vec![None],
        areas => areas.iter().copied().map(Some).collect(),
    };
    let areas = asked.into_iter().map(|area| Area::of(&picture, area).map_err(|error| refuse(path, error)));
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
        figure::chromaticity(&points).write(diagram).map_err(not_written)?;
        console::note(&format!("wrote {}", diagram.display()));
    }
    let reports: Vec<Report> = areas.into_iter().map(|area| report(area, &picture)).collect();
    if arguments.report.json {
        console::pretty_json(&serde_json::json!({ "file": path.display().to_string(), "areas": reports }))?;
    } else {
        console::out(&reports.iter().map(text).collect::<Vec<_>>().join("\n"))?;
    }
    Ok(DONE)
}

fn is_yaml(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("yaml") || e.eq_ignore_ascii_case("yml"))
}

/// Formats an area as it is written on the command line.
fn written(area: Rectangle) -> String {
    let Rectangle { from: [x, y], size: [width, height] } = area;
    format!("{x},{y},{width},{height}")
}

fn report(area: Area, picture: &Measured) -> Report {
    let xy = area.xyz.and_then(chromaticity);
    let d65 = spectra_color::RgbSpace::srgb().white_xy;
    let temperature = xy.and_then(cct);
    let dominant = xy.and_then(|xy| dominant_wavelength(xy, d65));
    let Rectangle { from: [x, y], size: [width, height] } = area.rectangle;
    Report {
        area_px: [x, y, width, height],
        xyz: area.xyz,
        unit: picture.unit.symbol(),
        xy,
        cct_k: temperature.map(|t| t.kelvin),
        duv: temperature.map(|t| t.duv),
        dominant_wavelength_nm: dominant.map(|d| if d.complementary { -d.wavelength_nm } else { d.wavelength_nm }),
        purity: dominant.map(|d| d.purity),
        irradiance_w_m2_nm: area.bands,
        edges_nm: area.edges_nm,
    }
}

/// Formats the report as text.
fn text(report: &Report) -> String {
    let [x, y, width, height] = report.area_px;
    let mut out = format!("area {x},{y},{width},{height}\n");
    let mut row = |name: &str, value: Option<String>| {
        if let Some(value) = value {
            // Writing to a String cannot fail.
            let _ = writeln!(out, "  {name:<22}{}", value.trim_end());
        }
    };
    row("XYZ", report.xyz.map(|xyz| format!("{}  {}", xyz.map(significant).join("  "), report.unit)));
    row("xy", report.xy.map(|[x, y]| format!("{x:.5}  {y:.5}")));
    let duv = report.duv.map_or_else(String::new, |duv| format!("  (Duv {duv:+.4})"));
    row("color temperature", report.cct_k.map(|k| format!("{k:.1} K{duv}")));
    row("dominant wavelength", report.dominant_wavelength_nm.filter(|nm| *nm > 0.0).map(|nm| format!("{nm:.2} nm")));
    row("complementary", report.dominant_wavelength_nm.filter(|nm| *nm < 0.0).map(|nm| format!("{:.2} nm", -nm)));
    row("excitation purity", report.purity.map(|p| format!("{:.2} %", 100.0 * p)));
    let widths = report.edges_nm.windows(2).map(|pair| pair[1] - pair[0]);
    let power: f64 = report.irradiance_w_m2_nm.iter().zip(widths).map(|(mean, width)| mean * width).sum();
    let ends = report.edges_nm.first().zip(report.edges_nm.last());
    row("irradiance", ends.map(|(a, b)| format!("{} W/m2 from {a:.1} to {b:.1} nm", significant(power))));
    let peak = report.irradiance_w_m2_nm.iter().zip(report.edges_nm.windows(2));
    let peak = peak.max_by(|a, b| a.0.total_cmp(b.0)).map(|(_, pair)| (pair[0], pair[1]));
    row("highest band", peak.map(|(a, b)| format!("{a:.1} to {b:.1} nm")));
    out
}
