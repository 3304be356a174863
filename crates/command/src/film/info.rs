//! `spectra film info`: shows the data of a stock.

use super::arguments::FilmInfo;
use super::load;
use crate::console;
use crate::outcome::{DONE, Outcome};
use serde_json::{Value, json};
use spectra_core::math::log10;
use spectra_core::spectral::BAND;
use spectra_film::curve::{AVERAGE_GRADIENT_SPAN, CharacteristicCurve};
use spectra_film::print::metered_exposure_lx_s;
use spectra_film::scatter::Modulation;
use spectra_film::stock::{ISO_6_SPAN, Layer, MeterResponse, Process, Reciprocity, SpeedKind, Stock};
use spectra_sheet::{Column, Sheet, Table, percent};
use spectra_spectrum::illuminant;
use std::collections::BTreeMap;
use std::iter::once;

/// Writes the data of a stock to standard output, as text or JSON.
pub(crate) fn info(arguments: &FilmInfo) -> Outcome {
    console::sheet(&sheet(&load(&arguments.name)?), arguments.json)?;
    Ok(DONE)
}

/// Returns the process of the stock: negative, reversal or print.
pub(super) fn process(stock: &Stock) -> &'static str {
    match stock.process {
        Process::Negative => "negative",
        Process::Reversal => "reversal",
        Process::Print => "print",
    }
}

/// Returns pairs of wavelength (nm) and log10 of a layer's sensitivity to equal energy, 0 at its peak, where it is above zero.
pub(super) fn sensitivity(layer: &Layer, step_nm: usize) -> Vec<[f64; 2]> {
    let all: Vec<[f64; 2]> = BAND.wavelengths_nm().map(|w| [w, layer.sensitivity.at(w)]).collect();
    let peak = all.iter().fold(0.0_f64, |a, p| a.max(p[1]));
    let seen = all.into_iter().step_by(step_nm).filter(|p| p[1] > 0.0 && peak > 0.0);
    seen.map(|[w, s]| [w, log10(s / peak)]).collect()
}

/// Returns evenly spaced points (log10 exposure in lx s, density) of a curve, at most `step` apart in log10 exposure.
pub(super) fn points(curve: &CharacteristicCurve, step: f64) -> Vec<[f64; 2]> {
    let (low, high) = curve.exposure_range();
    let steps = ((high - low) / step).ceil().max(1.0) as usize;
    let at = |i: usize| low + (high - low) * i as f64 / steps as f64;
    (0..=steps).map(|i| [at(i), curve.density(at(i))]).collect()
}

fn peak_nm(layer: &Layer) -> Option<f64> {
    let peak = |a: f64, b: f64| layer.sensitivity.at(a).total_cmp(&layer.sensitivity.at(b));
    BAND.wavelengths_nm().max_by(|a, b| peak(*a, *b))
}

/// Returns the ratio of the layer's speed in daylight to that in tungsten light, both of ISO 7589 through the standard lens.
fn daylight_over_tungsten(layer: &Layer) -> Option<f64> {
    let day = illuminant("iso-7589-sensitometric-daylight").ok()?;
    let tungsten = illuminant("iso-7589-sensitometric-studio-tungsten").ok()?;
    let ratio = layer.sensitivity.per_lux(&day) / layer.sensitivity.per_lux(&tungsten);
    ratio.is_finite().then_some(ratio)
}

/// Returns the data of a stock.
fn sheet(stock: &Stock) -> Sheet {
    let layers = match stock.layers.len() {
        1 => "1 layer".to_owned(),
        several => format!("{several} layers"),
    };
    let mut sheet = Sheet::new(&format!("{}: {} film, {layers}", stock.name, process(stock)));
    exposure(&mut sheet, stock);
    structure(&mut sheet, stock);
    practice(&mut sheet, stock);
    let layers: Vec<Value> = stock.layers.iter().map(|layer| layer_data(&mut sheet, stock, layer)).collect();
    sheet.data("layers", layers);
    sensitivities(&mut sheet, stock);
    let warnings = stock.warnings();
    warnings.iter().for_each(|doubt| sheet.note(&format!("warning: {doubt}")));
    sheet.data("warnings", warnings);
    sheet
}

/// Returns the remark for figures that are assumed, not measured.
fn assumed(is_assumed: bool) -> &'static str {
    if is_assumed { " (assumed)" } else { "" }
}

/// Adds name, maker, speed and the light in which the curves were measured.
fn exposure(sheet: &mut Sheet, stock: &Stock) {
    sheet.data("name", &stock.name);
    sheet.text("maker", "maker", stock.maker.as_deref());
    sheet.fact("year", "year", stock.year, i32::to_string);
    sheet.data("process", process(stock));
    sheet.line("speed", speed(stock));
    sheet.data("iso", stock.iso);
    sheet.data("iso_tungsten", stock.iso_tungsten);
    sheet.data("speed_kind", stock.iso.map(|_| stock.speed_kind.name()));
    sheet.data("speed_of_curves", stock.curve_speed());
    sheet.line("by ISO 6", iso_6(stock));
    sheet.data("iso_6", stock.iso_6());
    sheet.fact("relative_exposures_slid_by_log10", "exposures", stock.slid, |by| {
        format!("relative in the file; slid by {by:+.2} in log10 of lx s to the stated speed")
    });
    let by_film = stock.meter == MeterResponse::Film;
    sheet.line("metered", by_film.then(|| "by the film's own sensitivity".to_owned()));
    sheet.data("meter", stock.iso.map(|_| stock.meter.name()));
    sheet.fact("mid_gray_lx_s", "mid gray", stock.iso.map(metered_exposure_lx_s), |h| format!("{h:.4} lx s"));
    sheet.text("reference_illuminant", "reference light", Some(&stock.reference_illuminant));
    sheet.text("densitometry", "densitometry", Some(stock.densitometry.name()));
}

/// Adds the bases, the halation in them, and the figures that hold for all layers.
fn structure(sheet: &mut Sheet, stock: &Stock) {
    for b in &stock.bases {
        let index = b.index.map_or(String::new(), |n| format!(", index {n}"));
        let (material, assumed) = (b.material.as_deref().unwrap_or(""), assumed(b.assumed));
        sheet.line("base", Some(format!("{} mm {material}{index}, for {}{assumed}", b.thickness_mm, b.formats)));
    }
    sheet.data("bases", &stock.bases);
    sheet.fact("halation", "halation", stock.halation.as_ref(), |h| {
        let shares: Vec<String> = h.layers.iter().map(f64::to_string).collect();
        let layers = if shares.len() > 1 { format!(", by layer {}", shares.join(" : ")) } else { String::new() };
        let kind = h.kind.map_or(String::new(), |kind| format!("{} ", kind.name()));
        format!("{} enters the base, {kind}backing passes {}{layers}{}", h.scattered, h.backing, assumed(h.assumed))
    });
    sheet.fact("interlayer", "interlayer", stock.interlayer.as_ref(), |i| {
        format!("{:?} log10 exposure per unit of dye{}", i.inhibition, assumed(i.assumed))
    });
    sheet.fact("aim_density", "aim density", stock.aim_density, |a| {
        format!("red {}, green {}, blue {} for a mid gray", a.red, a.green, a.blue)
    });
    sheet.fact("granularity", "granularity", stock.granularity, |g| {
        format!("RMS {} at density {}, aperture {} mm{}", g.rms, g.density, g.aperture_mm, assumed(g.assumed))
    });
    stock.assumed.iter().for_each(|(part, text)| sheet.line("assumed", Some(format!("{part}: {text}"))));
    sheet.data("assumed", stock.assumed.iter().collect::<BTreeMap<_, _>>());
    let minimum = stock.minimum_density.as_ref();
    let points = minimum
        .map(|m| json!({ "assumed": m.assumed, "remark": m.remark, "wavelength_nm_and_density": m.density.points() }));
    sheet.data("minimum_density", points);
}

/// Adds what a photographer needs to know to use the stock, and the source of its figures.
fn practice(sheet: &mut Sheet, stock: &Stock) {
    let (text, data) = match &stock.reciprocity {
        Some(Reciprocity::PowerLaw { exponent, above_s }) => {
            (Some(format!("Tm^{exponent} above {above_s} s")), json!({ "exponent": exponent, "above_s": above_s }))
        }
        Some(Reciprocity::Table { above_s, rows }) => {
            let text: Vec<String> = rows.iter().map(|[m, a]| format!("{m} s -> {a} s")).collect();
            (Some(text.join(", ")), json!({ "above_s": above_s, "metered_and_adjusted_s": rows }))
        }
        None => (None, Value::Null),
    };
    sheet.line("reciprocity", text);
    sheet.data("reciprocity", data);
    sheet.data("filter_factors", &stock.filter_factors);
    sheet.text("print", "print on", stock.print.as_deref());
    sheet.text("source", "source", Some(&stock.source));
    sheet.text("license", "license", Some(&stock.license));
    sheet.data("remark", &stock.remark);
}

/// Adds a layer for readers, and returns its data.
fn layer_data(sheet: &mut Sheet, stock: &Stock, layer: &Layer) -> Value {
    let (peak_nm, ratio) = (peak_nm(layer), daylight_over_tungsten(layer));
    let (from, to) = layer.sensitivity.range_nm();
    let dye = layer.dye.as_ref().map_or(String::new(), |d| format!(", forms {} dye", d.name));
    let peak = peak_nm.map_or(String::new(), |nm| format!(", peak at {nm} nm"));
    sheet.heading(&format!("layer {}{dye}: {from} to {to} nm{peak}{}", layer.name, assumed(layer.assumed)));
    let shown = ratio.filter(|_| stock.process != Process::Print);
    sheet.line("speed", shown.map(|ratio| format!("in daylight over tungsten (ISO 7589): {ratio:.2}")));
    // A modulation that cannot be fitted is left out.
    let modulation = Modulation::measured(&layer.mtf).ok();
    sheet.line("modulation", modulation.as_ref().map(modulation_text));
    let middle = |p: &&[f64; 2], q: &&[f64; 2]| (p[0] - 0.7).abs().total_cmp(&(q[0] - 0.7).abs());
    let granularity = layer
        .granularity
        .iter()
        .min_by(middle)
        .map(|[density, rms]| format!("RMS {rms:.1} at {density:.2} over the minimum density, aperture 0.048 mm"));
    sheet.line("granularity", granularity);
    let modulation = modulation.map(|m| {
        let adjacency = m.adjacency.map(|a| json!({ "gain": a.gain, "length_mm": a.length_mm }));
        json!({ "spread_mm_and_weight": m.mtf.spread().terms(), "adjacency": adjacency })
    });
    json!({
        "name": layer.name,
        "peak_nm": peak_nm,
        "range_nm": [from, to],
        "assumed": layer.assumed,
        "remark": layer.remark,
        "daylight_over_tungsten_speed": ratio,
        "wavelength_nm_and_log10_sensitivity": sensitivity(layer, 5),
        "dye": layer.dye.as_ref().map(|d| json!({ "name": d.name, "wavelength_nm_and_density": d.density.points() })),
        "cycles_per_mm_and_response": (!layer.mtf.is_empty()).then_some(&layer.mtf),
        "modulation": modulation,
        "density_and_granularity": (!layer.granularity.is_empty()).then_some(&layer.granularity),
        "developments": developments(sheet, stock, layer),
    })
}

/// Returns the modulation of fine detail by a layer's emulsion and developer as text.
fn modulation_text(modulation: &Modulation) -> String {
    let at = |f: f64| format!("{:.2} at {f}", modulation.response(f));
    let edges = modulation.adjacency.map_or(String::new(), |a| {
        format!("; adjacency adds up to {}, over {:.0} um", percent(a.gain, 0), 1e3 * a.length_mm)
    });
    format!("{}, {}, {} cycles/mm{edges}", at(10.0), at(30.0), at(60.0))
}

/// Adds a table of the curves of a layer, and returns their data. The speed point of ISO 6 applies only to silver negatives.
fn developments(sheet: &mut Sheet, stock: &Stock, layer: &Layer) -> Vec<Value> {
    let is_silver = stock.process == Process::Negative && stock.layers.len() == 1;
    let columns = [
        Column::text("development", "development"),
        Column::fixed("speed_point_log10_lx_s", "speed point/log lx s", 2),
        if is_silver { Column::fixed("speed", "0.8/Hm", 0) } else { Column::hidden("speed") },
        Column::fixed("average_gradient", "average gradient", 2),
        Column::fixed("minimum_density", "Dmin", 2),
        Column::fixed("maximum_density", "Dmax", 2),
        Column::text("assumed", ""),
    ];
    let (mut table, mut data) = (Table::new("developments", columns), Vec::new());
    for d in &layer.developments {
        let (low, high) = d.curve.density_range();
        let (point, gradient) = (d.curve.speed_point(), d.curve.average_gradient(AVERAGE_GRADIENT_SPAN));
        let speed = is_silver.then(|| d.speed());
        table.push((&d.name, point, speed, gradient, low, high, assumed(d.assumed).trim()));
        data.push(json!({
            "development": d.name,
            "minutes": d.minutes,
            "assumed": d.assumed,
            "remark": d.remark,
            "minimum_density": low,
            "maximum_density": high,
            "speed_point_log10_lx_s": point,
            "speed": speed,
            "average_gradient": gradient,
            "average_gradient_iso_6": d.curve.average_gradient(ISO_6_SPAN),
            "log10_lx_s_and_density": points(&d.curve, 0.1),
        }));
    }
    sheet.show(table);
    data
}

/// Adds a table of the layers' sensitivities, in steps of 20 nm.
fn sensitivities(sheet: &mut Sheet, stock: &Stock) {
    sheet.heading("log10 sensitivity to equal energy, 0 at the peak");
    let all: Vec<_> = stock.layers.iter().map(|layer| sensitivity(layer, 1)).collect();
    let layers = stock.layers.iter().map(|layer| Column::fixed(&layer.name, &layer.name, 2));
    let mut table = Table::new("sensitivities", once(Column::fixed("nm", "nm", 0)).chain(layers));
    for nm in (350..=830).step_by(20).map(f64::from) {
        let at = |layer: &Vec<[f64; 2]>| layer.iter().find(|p| p[0] == nm).map(|p| p[1]);
        let values: Vec<Option<f64>> = all.iter().map(at).collect();
        if values.iter().any(Option::is_some) {
            table.push(once(Some(nm)).chain(values).collect::<Vec<_>>());
        }
    }
    sheet.show(table);
}

/// Returns the speed as text, with its kind and what the kind means.
fn speed(stock: &Stock) -> Option<String> {
    let tungsten = stock.iso_tungsten.map_or(String::new(), |t| format!(", in tungsten light {t}"));
    let kind = match stock.speed_kind {
        SpeedKind::Iso | SpeedKind::Assumed => "",
        SpeedKind::ExposureIndex => "; the maker's exposure index, to which meters are set",
    };
    stock.speed_text().map(|speed| format!("{speed}{tungsten}{kind}"))
}

/// Returns the speed that the curves have by ISO 6, compared with the stated speed.
fn iso_6(stock: &Stock) -> Option<String> {
    let (stated, found) = (stock.iso?, stock.iso_6()?);
    let stops = log10(found.speed / stated) / log10(2.0);
    Some(format!("{:.0}, after {:.1} min: {stops:+.2} stops from the stated speed", found.speed, found.minutes))
}
