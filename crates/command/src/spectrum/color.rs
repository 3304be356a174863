//! `spectra spectrum color` and `spectra spectrum models`: convert colors to spectra and back to colors.

use super::arguments::{ColorModels, SpectrumColor, SpectrumModels};
use super::{files, load_illuminant};
use crate::console;
use crate::formatting::counted;
use crate::outcome::{DONE, Failure, Outcome};
use serde::Serialize;
use spectra_analysis::figure;
use spectra_color::{RgbSpace, RoundTrip, from_u8, to_u8};
use spectra_core::params::{Params, SourceFile};
use spectra_core::registry::{self, Context, Entry, Stage};
use spectra_core::stage::ColorModel;
use spectra_plot::Format;
use spectra_scene::yaml;
use spectra_spectrum::{BAND, LineColor, Observer, named_line};
use std::fmt::Write as _;

/// A color model with the name under which it is shown.
struct Model {
    name: String,
    model: Box<dyn ColorModel>,
    default: bool,
}

fn entries() -> Vec<&'static Entry<dyn ColorModel>> {
    let mut entries = <dyn ColorModel as Stage>::entries();
    // The default model of scenes comes first.
    entries.sort_by_key(|e| (!e.default, e.name));
    entries
}

/// Builds the requested models. `wanted` has names, with keys in braces if any; `all` means every registered model.
fn models(ColorModels { model, illuminant }: &ColorModels) -> Result<Vec<Model>, Failure> {
    let light = load_illuminant(illuminant)?.to_power(&BAND);
    let all = || entries().iter().map(|e| e.name.to_owned()).collect::<Vec<_>>();
    let names: Vec<String> =
        model.iter().flat_map(|w| if w.trim() == "all" { all() } else { vec![w.trim().to_owned()] }).collect();
    let files = files();
    let build = |name: String| {
        let text = match name.split_once('{') {
            Some((kind, keys)) => format!("{{kind: {}, {keys}", kind.trim()),
            None => format!("{{kind: {name}}}"),
        };
        let node = yaml::parse(SourceFile::new("--model", text))?;
        let params = Params::stage(node, "color")?;
        let context = Context { illuminant: Some(&light), ..Context::new(&files, BAND) };
        let model = registry::build::<dyn ColorModel>(&params, &context)?;
        let default = entries().iter().any(|e| e.default && e.name == name);
        Ok(Model { name, model, default })
    };
    names.into_iter().map(build).collect()
}

fn round_trip(model: &Model) -> Result<RoundTrip<'_>, Failure> {
    RoundTrip::new(model.model.as_ref())
        .ok_or_else(|| Failure::Input(format!("--model {}: the white of this model has no visible light", model.name)))
}

/// Round trip of a color through one model: to a spectrum and back.
#[derive(Debug, Serialize)]
struct Trip {
    model: String,
    /// Code values on the scale of 0 to 255, clipped but not rounded.
    back: [f64; 3],
    srgb: [u8; 3],
    srgb_linear: [f64; 3],
    largest_difference: f64,
    xy: Option<[f64; 2]>,
    peak_nm: f64,
    lines: usize,
}

/// Converts a color to a spectrum and back with each model, and writes the results to standard output.
pub(crate) fn color(arguments: &SpectrumColor) -> Outcome {
    let rgb = rgb(&arguments.color)?;
    let srgb = RgbSpace::srgb();
    let linear = srgb.decode(rgb.map(from_u8));
    let mut trips = Vec::new();
    for model in &models(&arguments.models)? {
        let trip = round_trip(model)?;
        let back = trip.code(rgb);
        let power = model.model.spectrum(linear);
        let highest = |best: (f64, f64), now: (f64, f64)| if now.1 > best.1 { now } else { best };
        let continuum = BAND.wavelengths_nm().zip(power.continuum.iter().copied());
        let lines = power.lines.iter().map(|l| (l.wavelength_nm, l.power));
        let of_continuum = continuum.fold((0.0, 0.0), highest);
        let peak = if of_continuum.1 > 0.0 { of_continuum } else { lines.fold((0.0, 0.0), highest) };
        trips.push(Trip {
            model: model.name.clone(),
            back,
            srgb: back.map(|v| to_u8(v / 255.0)),
            srgb_linear: trip.linear(linear),
            largest_difference: back.iter().zip(rgb).map(|(b, v)| (b - f64::from(v)).abs()).fold(0.0, f64::max),
            xy: spectra_color::chromaticity(Observer::cie_1931_2deg().xyz_of_power(&power)),
            peak_nm: peak.0,
            lines: power.lines.iter().filter(|l| l.power > 0.0).count(),
        });
    }
    if arguments.report.json {
        console::pretty_json(&serde_json::json!({
            "srgb": rgb, "srgb_linear": linear, "illuminant": arguments.models.illuminant.trim(), "models": trips,
        }))?;
        return Ok(DONE);
    }
    let [r, g, b] = rgb;
    let mut out = format!(
        "{r} {g} {b}  #{r:02x}{g:02x}{b:02x}  linear {:.5} {:.5} {:.5}, under {}\n\n",
        linear[0],
        linear[1],
        linear[2],
        arguments.models.illuminant.trim()
    );
    let width = trips.iter().map(|t| t.model.len()).max().unwrap_or(0).max(5);
    // Writing to a String cannot fail.
    let _ = writeln!(out, "  {:<width$}  {:<24}  {:>10}  {:<16}  spectrum", "model", "comes back as", "off by", "xy");
    for t in &trips {
        let [r, g, b] = t.back;
        let back = format!("{r:.2} {g:.2} {b:.2}");
        let xy = t.xy.map_or_else(String::new, |[x, y]| format!("{x:.4} {y:.4}"));
        let lines = if t.lines > 0 { format!(", {}", counted(t.lines as u64, "line")) } else { String::new() };
        let _ = writeln!(
            out,
            "  {:<width$}  {back:<24}  {:>10.3}  {xy:<16}  peak {} nm{lines}",
            t.model, t.largest_difference, t.peak_nm
        );
    }
    console::out(&out)?;
    Ok(DONE)
}

/// Parses a color: `255 128 64`, or `#ff8040`.
fn rgb(words: &[String]) -> Result<[u8; 3], Failure> {
    let wrong = || {
        let text = format!("`{}` is not a color: write three values from 0 to 255, or #ff8040", words.join(" "));
        Failure::Input(text)
    };
    match words {
        [hex] => {
            let digits = hex.trim().trim_start_matches('#');
            if digits.len() != 6 || !digits.bytes().all(|b| b.is_ascii_hexdigit()) {
                return Err(wrong());
            }
            let value = u32::from_str_radix(digits, 16).map_err(|_| wrong())?;
            Ok([(value >> 16) as u8, (value >> 8) as u8, value as u8])
        }
        [r, g, b] => {
            let one = |text: &String| text.trim().parse::<u8>().map_err(|_| wrong());
            Ok([one(r)?, one(g)?, one(b)?])
        }
        _ => Err(wrong()),
    }
}

/// Largest and mean difference of a model's round trips.
#[derive(Debug, Serialize)]
struct Measured {
    model: String,
    default: bool,
    /// Largest difference, in 255ths.
    largest: f64,
    mean: f64,
    worst: [u8; 3],
    worst_back: [f64; 3],
    /// Largest green code value that a pure red has after the round trip.
    phantom_green: f64,
}

/// Measures the round trips of every model over 8-bit colors, writes the results, and plots them if requested.
pub(crate) fn measure(arguments: &SpectrumModels) -> Outcome {
    if let Some(path) = &arguments.output {
        Format::of(path).map_err(|e| Failure::Input(e.to_string()))?;
    }
    let models = models(&arguments.models)?;
    let mut measured = Vec::new();
    for model in &models {
        let e = round_trip(model)?.errors(arguments.step);
        let (largest, mean, worst, worst_back) = (e.largest, e.mean, e.worst, e.worst_back);
        let (model, default, phantom_green) = (model.name.clone(), model.default, e.phantom_green);
        measured.push(Measured { model, default, largest, mean, worst, worst_back, phantom_green });
    }
    if let Some(path) = &arguments.output {
        let rows = rows(&models)?;
        let canvas = figure::swatches("Colors to spectra and back", &rows);
        canvas.write(path).map_err(|e| Failure::Failed(e.to_string()))?;
        console::note(&format!("wrote {}", path.display()));
    }
    if arguments.report.json {
        console::pretty_json(&serde_json::json!({
            "illuminant": arguments.models.illuminant.trim(), "step": arguments.step, "models": measured,
        }))?;
        return Ok(DONE);
    }
    let width = measured.iter().map(|m| m.model.len() + 10).max().unwrap_or(0);
    let mut out = format!(
        "8-bit colors in steps of {}, under {}: to a spectrum and back to a color; differences in 255ths\n\n",
        arguments.step,
        arguments.models.illuminant.trim()
    );
    // Writing to a String cannot fail.
    let _ =
        writeln!(out, "  {:<width$}  {:>8}  {:>7}  {:>14}  worst color", "model", "largest", "mean", "green in red");
    for m in &measured {
        let name = format!("{}{}", m.model, if m.default { " (default)" } else { "" });
        let ([r, g, b], [x, y, z]) = (m.worst, m.worst_back);
        let _ = writeln!(
            out,
            "  {name:<width$}  {:>8.3}  {:>7.3}  {:>14.2}  {r} {g} {b} -> {x:.1} {y:.1} {z:.1}",
            m.largest, m.mean, m.phantom_green
        );
    }
    console::out(&out)?;
    Ok(DONE)
}

/// A row of the picture: its label and the colors of its patches.
type PatchRow = (String, Vec<[u8; 3]>);

/// Number of patches in a row of the picture.
const PATCHES: usize = 60;

/// Returns the rows of the picture. Each row has the hues at full value, then red from black to white; first the original colors, then
/// the results of each model.
fn rows(models: &[Model]) -> Result<Vec<PatchRow>, Failure> {
    let colors: Vec<[u8; 3]> = (0..PATCHES).map(patch).collect();
    let mut rows = vec![("as given".to_owned(), colors.clone())];
    for model in models {
        let trip = round_trip(model)?;
        let back = colors.iter().map(|c| trip.code(*c).map(|v| to_u8(v / 255.0))).collect();
        rows.push((format!("{}, as the eye sees it", model.name), back));
    }
    if let Some(study) = study() {
        let srgb = RgbSpace::srgb();
        let back = |c: &[u8; 3]| {
            let values = study.values(srgb.decode(c.map(from_u8)));
            srgb.encode(study.rgb(&values)).map(to_u8)
        };
        rows.push((
            "lines C' e g with F and D, split back: phantom green".to_owned(),
            colors.iter().map(back).collect(),
        ));
    }
    Ok(rows)
}

/// Returns a model of primary lines C', e and g with secondary lines F and D, which are split between their neighbors on the way back.
fn study() -> Option<LineColor> {
    let nm = |symbol| named_line(symbol).map(|l| l.nominal_nm);
    let [red, green, blue, f, d] = [nm("C'")?, nm("e")?, nm("g")?, nm("F")?, nm("D")?];
    LineColor::new([red, green, blue], &[f, d], [380.0, 780.0]).ok()
}

/// Returns the color of a patch: two thirds of the row are hues, the rest goes from black through red to white.
fn patch(i: usize) -> [u8; 3] {
    let hues = PATCHES * 2 / 3;
    if i < hues {
        let hue = 6.0 * i as f64 / hues as f64;
        let value = |from: f64| {
            let h = (hue + from) % 6.0;
            (2.0 - (h - 3.0).abs()).clamp(0.0, 1.0)
        };
        // Red, green and blue are two units apart on a circle of six.
        return [value(3.0), value(1.0), value(5.0)].map(to_u8);
    }
    let t = 2.0 * (i - hues) as f64 / (PATCHES - hues - 1) as f64;
    [t.min(1.0), (t - 1.0).max(0.0), (t - 1.0).max(0.0)].map(to_u8)
}
