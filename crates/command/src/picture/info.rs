//! `spectra picture info`: shows the figures of a picture.

use super::arguments::PictureInfo;
use super::{MOST_CHANNELS, load, percent};
use crate::console;
use crate::formatting::counted;
use crate::outcome::{DONE, Outcome};
use spectra_analysis::picture::{ChannelFigures, Colors, Measured, Summary, Unit};
use spectra_sheet::{Column, Sheet, Table, significant};
use std::collections::BTreeMap;

/// Writes the figures of a picture to standard output, as text or JSON.
pub(super) fn info(arguments: &PictureInfo) -> Outcome {
    let picture = load(&arguments.file)?;
    console::sheet(&sheet(&arguments.file.display().to_string(), &picture), arguments.json)?;
    Ok(DONE)
}

/// Makes the sheet of a picture. `unit` is the unit of XYZ.
fn sheet(file: &str, picture: &Measured) -> Sheet {
    let (planes, summary) = (&picture.planes, Summary::of(picture));
    let mut sheet = Sheet::new(&format!("{file}: {}, {} x {} pixels", planes.format, planes.width, planes.height));
    sheet.data("file", file);
    sheet.data("format", planes.format);
    sheet.data("width_px", planes.width);
    sheet.data("height_px", planes.height);
    sheet.show(channels(&summary.channels));
    sheet.data("channels", &summary.channels);
    sheet.fact("film_size_mm", "film size", picture.size_mm, |[w, h]| format!("{w} x {h} mm"));
    let aspect = planes.pixel_aspect;
    sheet.line("pixels", ((aspect - 1.0).abs() > 1e-4).then(|| format!("{aspect:.4} times as wide as high")));
    sheet.data("pixel_aspect", aspect);
    sheet.data("exposure_time_s", picture.exposure_time_s);
    sheet.line("colors", Some(colors(picture)));
    let kind = picture.colors.as_ref().map(|colors| match colors {
        Colors::Xyz(_) => "xyz",
        Colors::Rgb(..) => "rgb",
        Colors::Bands(_) => "bands",
    });
    sheet.data("colors", kind);
    sheet.data("unit", picture.unit.symbol());
    sheet.data("chromaticities", planes.chromaticities);
    figures(&mut sheet, &summary, planes.clipped_at.is_some());
    attributes(&mut sheet, picture);
    sheet
}

/// Makes the table of the channels.
fn channels(channels: &[ChannelFigures]) -> Table {
    let columns = [
        Column::text("name", "channel"),
        Column::significant("minimum", "minimum"),
        Column::significant("mean", "mean"),
        Column::significant("maximum", "maximum"),
        Column::text("unit", "unit"),
    ];
    let mut table = Table::new("channels", columns).most(MOST_CHANNELS);
    for c in channels {
        let broken = match c.not_finite {
            0 => String::new(),
            n => format!("  ({n} values are not finite)"),
        };
        table.push((&c.name, c.minimum, c.mean, c.maximum, format!("{}{broken}", c.unit)));
    }
    table
}

/// Adds the statistics of the whole picture.
fn figures(sheet: &mut Sheet, summary: &Summary, is_scaled: bool) {
    sheet.fact("illuminance_lx", "illuminance", summary.illuminance_lx, |lux| {
        let [low, mean, high] = [lux.minimum, lux.mean, lux.maximum].map(significant);
        format!("{low} to {high} lx, mean {mean}")
    });
    let lumens = |lm: &f64| format!("{} lm", significant(*lm));
    sheet.fact("luminous_flux_lm", "luminous flux", summary.luminous_flux_lm, lumens);
    let band = |[from, to]: [f64; 2]| format!(" from {from:.6} to {to:.6} nm").replace(".000000", "");
    let band = summary.band_nm.map_or_else(String::new, band);
    let watts = |w: &f64| format!("{} W{band}", significant(*w));
    sheet.fact("radiant_power_w", "radiant power", summary.radiant_power_w, watts);
    sheet.data("band_nm", summary.band_nm);
    sheet.data("mean_xyz", summary.mean_xyz);
    sheet.fact("mean_xy", "mean xy", summary.mean_xy, |[x, y]| format!("{x:.5}  {y:.5}"));
    let pixels = |share: &f64| format!("{} of the pixels", percent(*share));
    sheet.fact("lit_share", "lit", summary.lit_share, pixels);
    for outside in &summary.out_of_gamut {
        let share = format!("{} of what is lit", percent(outside.share));
        sheet.line(&format!("out of {}", outside.space), Some(share));
    }
    sheet.data("out_of_gamut", &summary.out_of_gamut);
    let limit = if is_scaled { "at the end of the scale" } else { "beyond white" };
    sheet.fact("clipped_share", limit, summary.clipped_share, pixels);
}

/// Adds the text attributes of the header. Readers see those of this program that are not shown elsewhere, and the color space.
fn attributes(sheet: &mut Sheet, picture: &Measured) {
    let all: BTreeMap<&str, &str> = picture.planes.attributes.iter().map(|(n, t)| (n.as_str(), t.as_str())).collect();
    for (name, value) in &all {
        let own = name.strip_prefix("spectra:").or_else(|| (*name == "oiio:ColorSpace").then_some("color space"));
        let Some(key) = own else { continue };
        let text = match key {
            "scene" => format!("{} of YAML (--json shows all)", counted(value.lines().count() as u64, "line")),
            "film size" | "film coordinates" => continue,
            // Illuminance does not depend on the exposure time.
            "exposure time" if picture.unit == Unit::Lux => continue,
            _ => (*value).to_owned(),
        };
        sheet.line(key, Some(text));
    }
    sheet.data("attributes", all);
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
