//! `kind: html`: a page in one HTML file.

use crate::rays;
use schemars::JsonSchema;
use serde::Deserialize;
use serde_json::Value;
use spectra_core::params::{Faults, Params};
use spectra_core::registry::Context;
use spectra_core::shutter;
use spectra_core::sink::{Out, WriteFault};
use spectra_pictures::write::{PictureSpace, png8, squared};
use spectra_plot::{Cell, Page};
use spectra_scene::{FileContent, Output, OutputEntry, SeriesSummary, Shot};
use std::io::Cursor;

/// A page about the picture for a browser, in one file that needs no network.
///
/// The page shows the picture, the lens with its rays, the film, how much light arrived and where the rest went, the render time and the
/// scene itself: everything to show somebody else what was done. Pictures by several films are on one page. A sweep or an animation also
/// gets `SCENE-series.html`, with the contact sheet and a row for each picture, in addition to a page for each picture.
///
/// # Example
/// ```yaml
/// {kind: html}
/// ```
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct HtmlParams {}

spectra_core::register!(OutputEntry, "html": HtmlParams, build);

struct Html;

fn build(params: &Params, _: &Context<'_>) -> Result<Box<dyn Output>, Faults> {
    params.parse::<HtmlParams>().map(|_| Box::new(Html) as Box<dyn Output>)
}

impl Output for Html {
    fn kind(&self) -> &'static str {
        "html"
    }

    fn ending(&self) -> [&'static str; 2] {
        ["", ".html"]
    }

    /// Returns the kind of content: a figure, because all films share one page.
    fn content(&self) -> FileContent {
        FileContent::Figure
    }

    fn write(&self, shot: &Shot<'_>, _: usize, out: &mut dyn Out) -> Result<(), WriteFault> {
        Ok(out.write_all(of_picture(shot)?.to_html().as_bytes())?)
    }

    fn is_of_series(&self) -> bool {
        true
    }

    fn write_series(&self, told: &SeriesSummary<'_>, out: &mut dyn Out) -> Result<(), WriteFault> {
        Ok(out.write_all(of_series(told).to_html().as_bytes())?)
    }
}

/// Longest side of a picture on the page, CSS pixels.
const SIDE: f64 = 1100.0;

fn of_picture(shot: &Shot<'_>) -> Result<Page, WriteFault> {
    let (scene, report) = (shot.scene, shot.report());
    let mut page = Page::new(&scene.name);
    page.aside(&scene.source.describe());
    // Not every imager has something to show; the page then says why.
    match shot.pictures() {
        Ok(pictures) => {
            for (film, (name, _)) in pictures.iter().enumerate() {
                let (bytes, size) = picture(shot, film)?;
                page.picture(&bytes, size, name.as_deref().unwrap_or(&scene.name));
            }
        }
        Err(why) => page.aside(&why.to_string()),
    }
    if report["partial"] == true {
        page.paragraph("Partial: stopped before all samples were taken.");
    }
    page.heading("Lens");
    // A lens that cannot be drawn is still described.
    if let Ok(canvas) = rays::on_paper(scene) {
        page.figure(&canvas, &format!("{} with rays of the scene's light", scene.lens.name));
    }
    page.facts(&lens(shot));
    page.heading(if scene.films.is_empty() { "Imager" } else { "Film" });
    page.facts(&recorder(shot));
    page.heading("Light");
    light(&mut page, shot);
    if !report.is_null() {
        page.heading("Time");
        page.facts(&time(report, "light traced in"));
    }
    let warnings: Vec<&str> = report["warnings"].as_array().into_iter().flatten().filter_map(Value::as_str).collect();
    if !warnings.is_empty() {
        page.heading("Warnings");
        warnings.iter().for_each(|text| page.paragraph(text));
    }
    page.heading("Scene");
    page.text(&scene.text);
    Ok(page)
}

/// Returns a picture as a PNG with square pixels, and the size in which it is shown, CSS pixels.
fn picture(shot: &Shot<'_>, film: usize) -> Result<(Vec<u8>, [f64; 2]), WriteFault> {
    let picture = squared(shot.picture(film)?, shot.pixel_aspect());
    let mut bytes = Cursor::new(Vec::new());
    png8(&mut bytes, &picture, PictureSpace::Srgb, 1.0)?;
    let [width, height] = [picture.width_px, picture.height_px].map(f64::from);
    // Small pictures are enlarged by whole factors, so that all pixels have the same size.
    let fits = SIDE / width.max(height);
    let factor = if fits >= 1.0 { fits.floor().min(4.0) } else { fits };
    Ok((bytes.into_inner(), [width * factor, height * factor]))
}

type Facts = Vec<(String, String)>;

fn fact(name: &str, value: impl Into<String>) -> (String, String) {
    (name.to_owned(), value.into())
}

fn lens(shot: &Shot<'_>) -> Facts {
    let (scene, lens) = (shot.scene, &shot.scene.lens);
    let first = lens.first_order(lens.reference_nm);
    let mut facts = vec![fact("lens", &*lens.name)];
    if first.efl_mm.is_finite() {
        facts.push(fact("focal length", format!("{:.2} mm", first.efl_mm)));
    }
    let marginal = lens.marginal_ray().ok().map(|ray| ray.f_number());
    if let Some(f_number) = marginal.filter(|n| n.is_finite() && *n < 1e4) {
        facts.push(fact("f-number", format!("f/{f_number:.2}")));
    }
    facts.push(fact("focus", scene.focus.to_string()));
    facts.push(fact("losses", lens.losses()));
    facts.extend(lens.patent.as_ref().map(|patent| fact("patent", &**patent)));
    facts.extend(lens.source.as_ref().map(|source| fact("source", &**source)));
    facts.extend(lens.notes.iter().map(|note| fact("note", &**note)));
    facts
}

fn recorder(shot: &Shot<'_>) -> Facts {
    let size = shot.exposure.size;
    let mut facts = vec![
        fact("frame", format!("{} x {} mm", size.width_mm, size.height_mm)),
        fact("pixels", format!("{} x {}", size.width_px, size.height_px)),
    ];
    for (film, time) in shot.scene.films.iter().zip(shot.times) {
        let name = film.name.as_deref().unwrap_or("film");
        facts.push(fact(name, film.film.describe()));
        facts.push(fact("exposed for", shutter::format_time(time.time_s)));
    }
    facts
}

/// Formats a value with five significant digits, and with a power of ten if it is large or small.
fn significant(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let shown = format!("{value:.4e}");
    match shown.split_once('e').and_then(|(_, power)| power.parse::<i32>().ok()) {
        Some(power @ -4..=4) => format!("{value:.*}", (4 - power) as usize),
        _ => shown,
    }
}

fn percent(part: f64, of: f64) -> String {
    match 100.0 * part / of {
        _ if of <= 0.0 => "-".to_owned(),
        p if p > 0.0 && p < 0.01 => "< 0.01 %".to_owned(),
        p => format!("{p:.2} %"),
    }
}

/// Writes tables of the light that arrived, channel by channel, and of where the rest of the rays went.
fn light(page: &mut Page, shot: &Shot<'_>) {
    let gains = shot.gains();
    let rows: Vec<Vec<Cell>> = shot
        .exposure
        .channels
        .iter()
        .zip(gains)
        .map(|(channel, gain)| {
            let values = || channel.values.iter().map(|v| f64::from(*v) * gain).filter(|v| v.is_finite());
            let mean = values().sum::<f64>() / values().count().max(1) as f64;
            let [low, high] = values().fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], v| [a.min(v), b.max(v)]);
            let number = |v: f64| Cell::Number(if v.is_finite() { significant(v) } else { "-".to_owned() });
            let name = [channel.name.clone(), channel.unit.clone()].map(Cell::Text);
            name.into_iter().chain([number(low), number(mean), number(high)]).collect()
        })
        .collect();
    // A page shows only some of the bands of a spectrum.
    const MOST: usize = 12;
    page.table(&["channel", "unit", "least", "mean", "most"], &rows[..rows.len().min(MOST)]);
    if rows.len() > MOST {
        page.aside(&format!("and {} more channels", rows.len() - MOST));
    }
    let report = shot.report();
    let Some(rays) = report["rays"].as_f64().filter(|rays| *rays > 0.0) else { return };
    let mut rows = vec![("traced".to_owned(), rays)];
    rows.extend(report["detected"].as_f64().map(|detected| ("recorded".to_owned(), detected)));
    for (cause, many) in report["lost"]["by_cause"].as_object().into_iter().flatten() {
        rows.extend(many.as_f64().filter(|many| *many > 0.0).map(|many| (cause.replace('_', " "), many)));
    }
    let row = |(name, many): &(String, f64)| {
        vec![Cell::Text(name.clone()), Cell::Number(format!("{many:.0}")), Cell::Number(percent(*many, rays))]
    };
    page.table(&["rays", "number", "share"], &rows.iter().map(row).collect::<Vec<_>>());
    if let Some(ledger) = report["ledger"].as_object() {
        let emitted = ledger.get("emitted").and_then(Value::as_f64).unwrap_or(0.0);
        let watts = |(name, of): (&str, &Value)| {
            let watts = of.as_f64()?;
            let number = |text: String| Cell::Number(text);
            Some(vec![Cell::Text(name.replace('_', " ")), number(significant(watts)), number(percent(watts, emitted))])
        };
        let parts = |key: &str| ledger.get(key).and_then(Value::as_object).into_iter().flatten();
        let all = ["emitted", "detected", "lost", "not_traced"]
            .into_iter()
            .filter_map(|name| Some((name, ledger.get(name)?)));
        let all =
            all.chain(["detected_by", "lost_by"].into_iter().flat_map(parts).map(|(name, of)| (name.as_str(), of)));
        page.table(&["light of the lights", "W", "share"], &all.filter_map(watts).collect::<Vec<_>>());
    }
}

/// Lists the render time, under the name `seconds`, and the machine and versions that rendered.
fn time(report: &Value, seconds: &str) -> Facts {
    let number = |key: &str| report[key].as_f64();
    let mut facts = Facts::new();
    facts.extend(number("seconds").map(|s| fact(seconds, format!("{s:.1} s"))));
    facts.extend(number("rays_per_second").map(|r| fact("rays a second", format!("{:.2} million", r / 1e6))));
    facts.extend(number("samples_per_pixel").map(|n| fact("samples a pixel", format!("{n:.0}"))));
    let percent = |key: &str| report["noise"][key].as_f64().map(|v| format!("{:.2} %", 100.0 * v));
    let noise = percent("median").zip(percent("p95"));
    facts.extend(noise.map(|(median, p95)| fact("noise", format!("{median}, 95 % of the frame below {p95}"))));
    facts.extend(number("seed").map(|seed| fact("seed", format!("{seed:.0}"))));
    let machine = number("threads").zip(report["isa"].as_str());
    facts.extend(machine.map(|(threads, isa)| fact("threads", format!("{threads:.0}, {isa}"))));
    let versions = report["versions"].as_object().into_iter().flatten();
    facts.extend(versions.filter_map(|(name, version)| Some(fact(name, version.as_str()?))));
    facts
}

/// Builds the page of a sweep or an animation.
fn of_series(told: &SeriesSummary<'_>) -> Page {
    let report = told.report;
    let mut page = Page::new(told.name);
    let pictures: Vec<&Value> = report["pictures"].as_array().into_iter().flatten().collect();
    let kind = report["kind"].as_str().unwrap_or("series");
    page.aside(&format!("{kind}: {} of {} pictures", pictures.len(), report["count"]));
    for (name, png) in told.contact_sheets {
        // The size is in the header of the file (PNG, 11.2.2).
        let side =
            |at: usize| png.get(at..at + 4).map_or(0.0, |b| f64::from(u32::from_be_bytes([b[0], b[1], b[2], b[3]])));
        let (width, height) = (side(16), side(20));
        let factor = (SIDE / width.max(1.0)).min(1.0);
        page.picture(png, [width * factor, height * factor], name);
    }
    page.heading("Pictures");
    let mut paths: Vec<&String> = Vec::new();
    for path in pictures.iter().filter_map(|p| p["values"].as_object()).flat_map(|values| values.keys()) {
        if !paths.contains(&path) {
            paths.push(path);
        }
    }
    let mut head = vec!["number"];
    head.extend(paths.iter().map(|path| path.as_str()));
    head.extend(["seconds", "rays", "page"]);
    let row = |picture: &&Value| {
        let number = |value: Option<String>| Cell::Number(value.unwrap_or_default());
        let mut cells = vec![number(Some(picture["number"].to_string()))];
        cells.extend(paths.iter().map(|path| {
            Cell::Text(picture["values"][path.as_str()].as_str().unwrap_or_default().trim_matches('"').to_owned())
        }));
        cells.push(number(picture["seconds"].as_f64().map(|s| format!("{s:.1}"))));
        cells.push(number(picture["rays"].as_f64().map(|r| format!("{r:.0}"))));
        let files = picture["files"].as_array().into_iter().flatten().filter_map(Value::as_str);
        let own =
            files.map(|file| file.rsplit(['/', '\\']).next().unwrap_or(file)).find(|file| file.ends_with(".html"));
        cells.push(own.map_or_else(|| Cell::Text(String::new()), |file| Cell::Beside(file.to_owned())));
        cells
    };
    page.table(&head, &pictures.iter().map(row).collect::<Vec<_>>());
    page.heading("Time");
    page.facts(&time(report, "all pictures in"));
    page.heading("Scene");
    page.text(told.text);
    page
}
