//! `spectra picture info`: shows the figures of a picture.

use super::arguments::PictureInfo;
use super::{load, percent, significant};
use crate::console;
use crate::formatting::counted;
use crate::outcome::{DONE, Outcome};
use serde::Serialize;
use spectra_analysis::picture::{Colors, Measured, Summary, Unit};
use std::collections::BTreeMap;
use std::fmt::Write;

/// Figures of a picture.
#[derive(Debug, Serialize)]
struct Report<'a> {
    file: String,
    format: &'a str,
    width_px: u32,
    height_px: u32,
    pixel_aspect: f64,
    film_size_mm: Option<[f64; 2]>,
    exposure_time_s: Option<f64>,
    /// Kind of channels that colors are computed from: `xyz`, `rgb` or `bands`.
    colors: Option<&'static str>,
    /// Unit of XYZ.
    unit: &'static str,
    chromaticities: Option<[[f64; 2]; 4]>,
    #[serde(flatten)]
    summary: Summary,
    /// All text attributes of the header.
    attributes: BTreeMap<&'a str, &'a str>,
}

/// Writes the figures of a picture to standard output, as text or JSON.
pub(super) fn info(arguments: &PictureInfo) -> Outcome {
    let picture = load(&arguments.file)?;
    let summary = Summary::of(&picture);
    let planes = &picture.planes;
    let report = Report {
        file: arguments.file.display().to_string(),
        format: planes.format,
        width_px: planes.width,
        height_px: planes.height,
        pixel_aspect: planes.pixel_aspect,
        film_size_mm: picture.size_mm,
        exposure_time_s: picture.exposure_time_s,
        colors: picture.colors.as_ref().map(|colors| match colors {
            Colors::Xyz(_) => "xyz",
            Colors::Rgb(..) => "rgb",
            Colors::Bands(_) => "bands",
        }),
        unit: picture.unit.symbol(),
        chromaticities: planes.chromaticities,
        summary,
        attributes: planes.attributes.iter().map(|(name, text)| (name.as_str(), text.as_str())).collect(),
    };
    if arguments.json {
        console::pretty_json(&report)?;
    } else {
        console::out(&text(&report, &picture))?;
    }
    Ok(DONE)
}

/// Largest number of channels that are shown one by one.
const MOST_CHANNELS: usize = 12;

/// Formats the report as text.
fn text(report: &Report<'_>, picture: &Measured) -> String {
    let summary = &report.summary;
    let mut out = format!("{}: {}, {} x {} pixels\n\n", report.file, report.format, report.width_px, report.height_px);
    let width = summary.channels.iter().take(MOST_CHANNELS).map(|c| c.name.chars().count()).fold(7, usize::max);
    // Writing to a String cannot fail.
    let _ = writeln!(out, "  {:<width$}  {:>12}  {:>12}  {:>12}  unit", "channel", "minimum", "mean", "maximum");
    let number = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), significant);
    for channel in summary.channels.iter().take(MOST_CHANNELS) {
        let [low, mean, high] = [channel.minimum, channel.mean, channel.maximum].map(number);
        let broken = match channel.not_finite {
            0 => String::new(),
            n => format!("  ({n} values are not finite)"),
        };
        let row = format!("  {:<width$}  {low:>12}  {mean:>12}  {high:>12}  {}{broken}", channel.name, channel.unit);
        let _ = writeln!(out, "{}", row.trim_end());
    }
    if summary.channels.len() > MOST_CHANNELS {
        let _ = writeln!(out, "  ... {} channels in all (--json shows each)", summary.channels.len());
    }
    out.push('\n');
    let mut row = |name: &str, value: Option<String>| {
        if let Some(value) = value {
            let _ = writeln!(out, "  {name:<17} {value}");
        }
    };
    row("film size", report.film_size_mm.map(|[w, h]| format!("{w} x {h} mm")));
    let wide = (report.pixel_aspect - 1.0).abs() > 1e-4;
    row("pixels", wide.then(|| format!("{:.4} times as wide as high", report.pixel_aspect)));
    row("colors", Some(colors(picture)));
    if let Some(lux) = summary.illuminance_lx {
        let [low, mean, high] = [lux.minimum, lux.mean, lux.maximum].map(significant);
        row("illuminance", Some(format!("{low} to {high} lx, mean {mean}")));
    }
    row("luminous flux", summary.luminous_flux_lm.map(|lm| format!("{} lm", significant(lm))));
    let band = |[from, to]: [f64; 2]| format!(" from {from:.6} to {to:.6} nm").replace(".000000", "");
    let power = summary.radiant_power_w.map(|w| format!("{} W", significant(w)));
    row("radiant power", power.map(|w| w + &summary.band_nm.map_or_else(String::new, band)));
    row("mean xy", summary.mean_xy.map(|[x, y]| format!("{x:.5}  {y:.5}")));
    row("lit", summary.lit_share.map(|share| format!("{} of the pixels", percent(share))));
    for outside in &summary.out_of_gamut {
        row(&format!("out of {}", outside.space), Some(format!("{} of what is lit", percent(outside.share))));
    }
    let limit = if picture.planes.clipped_at.is_some() { "at the end of the scale" } else { "beyond white" };
    row(limit, summary.clipped_share.map(|share| format!("{} of the pixels", percent(share))));
    for (name, value) in &report.attributes {
        let Some(key) = name.strip_prefix("spectra:").or_else(|| (*name == "oiio:ColorSpace").then_some("color space"))
        else {
            continue;
        };
        match key {
            "scene" => {
                row(key, Some(format!("{} of YAML (--json shows all)", counted(value.lines().count() as u64, "line"))))
            }
            "film size" | "film coordinates" => {}
            // Illuminance does not depend on the exposure time.
            "exposure time" if picture.unit == Unit::Lux => {}
            _ => row(key, Some((*value).to_owned())),
        }
    }
    out
}

/// Returns a text that says what colors are computed from.
fn colors(picture: &Measured) -> String {
    let unit = match picture.unit {
        Unit::Lux => "Y in lx",
        Unit::LuxSeconds => "Y in lx s",
        Unit::OfWhite => "1 is white",
        Unit::Unknown => "of no stated unit",
    };
    match &picture.colors {
        Some(Colors::Xyz(_)) => format!("CIE 1931 XYZ, {unit}"),
        Some(Colors::Rgb(..)) if picture.planes.chromaticities.is_some() => {
            format!("linear RGB by the chromaticities of the file, {unit}")
        }
        Some(Colors::Rgb(..)) => format!("linear RGB in the primaries of sRGB, {unit}"),
        Some(Colors::Bands(bands)) => format!("{} bands of the spectrum", bands.len()),
        None => "none: the channels are not primaries".to_owned(),
    }
}
