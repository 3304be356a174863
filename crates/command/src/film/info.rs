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
use spectra_spectrum::illuminant;
use std::fmt::Write;

/// Writes the data of a stock to standard output, as text or JSON.
pub(crate) fn info(arguments: &FilmInfo) -> Outcome {
    let stock = load(&arguments.name)?;
    if arguments.json {
        console::pretty_json(&to_json(&stock))?;
    } else {
        console::out(&text(&stock))?;
    }
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

fn to_json(stock: &Stock) -> Value {
    let layers: Vec<Value> = stock.layers.iter().map(|layer| layer_json(stock, layer)).collect();
    let reciprocity = stock.reciprocity.as_ref().map(|r| match r {
        Reciprocity::PowerLaw { exponent, above_s } => json!({ "exponent": exponent, "above_s": above_s }),
        Reciprocity::Table { above_s, rows } => json!({ "above_s": above_s, "metered_and_adjusted_s": rows }),
    });
    let bases: Vec<Value> = stock
        .bases
        .iter()
        .map(|b| {
            json!({ "formats": b.formats, "material": b.material, "thickness_mm": b.thickness_mm, "index": b.index,
                "assumed": b.assumed })
        })
        .collect();
    let factors: Vec<Value> = stock
        .filter_factors
        .iter()
        .map(|f| json!({ "filter": f.filter, "daylight": f.daylight, "tungsten": f.tungsten }))
        .collect();
    json!({
        "name": stock.name,
        "maker": stock.maker,
        "year": stock.year,
        "process": process(stock),
        "densitometry": stock.densitometry.name(),
        "iso": stock.iso,
        "iso_tungsten": stock.iso_tungsten,
        "speed_kind": stock.iso.map(|_| stock.speed_kind.name()),
        "meter": stock.iso.map(|_| stock.meter.name()),
        "speed_of_curves": stock.curve_speed(),
        "relative_exposures_slid_by_log10": stock.slid,
        "warnings": stock.warnings(),
        "iso_6": stock.iso_6().map(|at| json!({ "speed": at.speed, "minutes": at.minutes })),
        "reference_illuminant": stock.reference_illuminant,
        "mid_gray_lx_s": stock.iso.map(metered_exposure_lx_s),
        "layers": layers,
        "bases": bases,
        "minimum_density": stock.minimum_density.as_ref().map(|m| {
            json!({ "assumed": m.assumed, "remark": m.remark, "wavelength_nm_and_density": m.density.points() })
        }),
        "interlayer": stock.interlayer.as_ref().map(|i| {
            json!({ "assumed": i.assumed, "remark": i.remark, "inhibition": i.inhibition })
        }),
        "aim_density": stock.aim_density.map(|a| json!({ "red": a.red, "green": a.green, "blue": a.blue })),
        "assumed": stock.assumed.iter().collect::<std::collections::BTreeMap<_, _>>(),
        "granularity": stock.granularity.map(|g| {
            json!({ "rms": g.rms, "aperture_mm": g.aperture_mm, "density": g.density, "assumed": g.assumed })
        }),
        "halation": stock.halation.as_ref().map(|h| {
            json!({ "scattered": h.scattered, "backing": h.backing, "backing_kind": h.kind.map(|kind| kind.name()), "reflected": h.reflected, "layers": h.layers,
                "assumed": h.assumed, "remark": h.remark })
        }),
        "reciprocity": reciprocity,
        "filter_factors": factors,
        "print": stock.print,
        "source": stock.source,
        "license": stock.license,
        "remark": stock.remark,
    })
}

fn layer_json(stock: &Stock, layer: &Layer) -> Value {
    let developments: Vec<Value> = layer
        .developments
        .iter()
        .map(|d| {
            let (low, high) = d.curve.density_range();
            json!({
                "development": d.name,
                "minutes": d.minutes,
                "assumed": d.assumed,
                "remark": d.remark,
                "minimum_density": low,
                "maximum_density": high,
                "speed_point_log10_lx_s": d.curve.speed_point(),
                "speed": silver_negative(stock).then(|| d.speed()),
                "average_gradient": d.curve.average_gradient(AVERAGE_GRADIENT_SPAN),
                "average_gradient_iso_6": d.curve.average_gradient(ISO_6_SPAN),
                "log10_lx_s_and_density": points(&d.curve, 0.1),
            })
        })
        .collect();
    json!({
        "name": layer.name,
        "peak_nm": peak_nm(layer),
        "range_nm": [layer.sensitivity.range_nm().0, layer.sensitivity.range_nm().1],
        "assumed": layer.assumed,
        "remark": layer.remark,
        "daylight_over_tungsten_speed": daylight_over_tungsten(layer),
        "wavelength_nm_and_log10_sensitivity": sensitivity(layer, 5),
        "dye": layer.dye.as_ref().map(|d| json!({ "name": d.name, "wavelength_nm_and_density": d.density.points() })),
        "cycles_per_mm_and_response": (!layer.mtf.is_empty()).then_some(&layer.mtf),
        "modulation": modulation(layer).map(|m| {
            let adjacency = m.adjacency.map(|a| json!({ "gain": a.gain, "length_mm": a.length_mm }));
            json!({ "spread_mm_and_weight": m.mtf.spread().terms(), "adjacency": adjacency })
        }),
        "density_and_granularity": (!layer.granularity.is_empty()).then_some(&layer.granularity),
        "developments": developments,
    })
}

/// Returns the modulation of fine detail by a layer's emulsion and developer; `None` if it cannot be fitted.
fn modulation(layer: &Layer) -> Option<Modulation> {
    Modulation::measured(&layer.mtf).ok()
}

/// Whether the stock is a silver negative, so that the speed point of ISO 6 applies to its curves.
fn silver_negative(stock: &Stock) -> bool {
    stock.process == Process::Negative && stock.layers.len() == 1
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

fn text(stock: &Stock) -> String {
    let layers = match stock.layers.len() {
        1 => "1 layer".to_owned(),
        several => format!("{several} layers"),
    };
    let mut out = format!("{}: {} film, {layers}\n\n", stock.name, process(stock));
    let mut row = |name: &str, value: Option<String>| {
        if let Some(value) = value {
            // Writing to a String cannot fail.
            let _ = writeln!(out, "  {name:<20}{value}");
        }
    };
    row("maker", stock.maker.clone());
    row("year", stock.year.map(|year| year.to_string()));
    row("speed", speed(stock));
    row("by ISO 6", iso_6(stock));
    row(
        "exposures",
        stock.slid.map(|by| format!("relative in the file; slid by {by:+.2} in log10 of lx s to the stated speed")),
    );
    if stock.meter == MeterResponse::Film {
        row("metered", Some("by the film's own sensitivity".to_owned()));
    }
    row("mid gray", stock.iso.map(|iso| format!("{:.4} lx s", metered_exposure_lx_s(iso))));
    row("reference light", Some(stock.reference_illuminant.clone()));
    row("densitometry", Some(stock.densitometry.name().to_owned()));
    for base in &stock.bases {
        let assumed = if base.assumed { " (assumed)" } else { "" };
        let index = base.index.map_or(String::new(), |n| format!(", index {n}"));
        let material = base.material.as_deref().unwrap_or("");
        row("base", Some(format!("{} mm {material}{index}, for {}{assumed}", base.thickness_mm, base.formats)));
    }
    row(
        "halation",
        stock.halation.as_ref().map(|h| {
            let assumed = if h.assumed { " (assumed)" } else { "" };
            let shares: Vec<String> = h.layers.iter().map(f64::to_string).collect();
            let layers = if shares.len() > 1 { format!(", by layer {}", shares.join(" : ")) } else { String::new() };
            let kind = h.kind.map_or(String::new(), |kind| format!("{} ", kind.name()));
            format!("{} enters the base, {kind}backing passes {}{layers}{assumed}", h.scattered, h.backing)
        }),
    );
    row(
        "interlayer",
        stock.interlayer.as_ref().map(|i| {
            let assumed = if i.assumed { " (assumed)" } else { "" };
            format!("{:?} log10 exposure per unit of dye{assumed}", i.inhibition)
        }),
    );
    row(
        "aim density",
        stock.aim_density.map(|a| format!("red {}, green {}, blue {} for a mid gray", a.red, a.green, a.blue)),
    );
    row(
        "granularity",
        stock.granularity.map(|g| {
            let assumed = if g.assumed { " (assumed)" } else { "" };
            format!("RMS {} at density {}, aperture {} mm{assumed}", g.rms, g.density, g.aperture_mm)
        }),
    );
    for (part, text) in stock.assumed.iter() {
        row("assumed", Some(format!("{part}: {text}")));
    }
    row(
        "reciprocity",
        stock.reciprocity.as_ref().map(|r| match r {
            Reciprocity::PowerLaw { exponent, above_s } => format!("Tm^{exponent} above {above_s} s"),
            Reciprocity::Table { rows, .. } => {
                let rows: Vec<String> = rows.iter().map(|[m, a]| format!("{m} s -> {a} s")).collect();
                rows.join(", ")
            }
        }),
    );
    row("print on", stock.print.clone());
    row("source", Some(stock.source.clone()));
    row("license", Some(stock.license.clone()));
    for layer in &stock.layers {
        let assumed = if layer.assumed { " (assumed)" } else { "" };
        let dye = layer.dye.as_ref().map_or(String::new(), |d| format!(", forms {} dye", d.name));
        let (from, to) = layer.sensitivity.range_nm();
        let peak = peak_nm(layer).map_or(String::new(), |nm| format!(", peak at {nm} nm"));
        let _ = writeln!(out, "\nlayer {}{dye}: {from} to {to} nm{peak}{assumed}", layer.name);
        if let Some(ratio) = daylight_over_tungsten(layer).filter(|_| stock.process != Process::Print) {
            let _ = writeln!(out, "  speed in daylight over tungsten (ISO 7589): {ratio:.2}");
        }
        if let Some(modulation) = modulation(layer) {
            let at = |f: f64| format!("{:.2} at {f}", modulation.response(f));
            let edges = modulation.adjacency.map_or(String::new(), |a| {
                format!("; adjacency adds up to {:.0} %, over {:.0} um", 100.0 * a.gain, 1e3 * a.length_mm)
            });
            let _ = writeln!(out, "  modulation: {}, {}, {} cycles/mm{edges}", at(10.0), at(30.0), at(60.0));
        }
        if let Some([density, rms]) =
            layer.granularity.iter().min_by(|a, b| (a[0] - 0.7).abs().total_cmp(&(b[0] - 0.7).abs()))
        {
            let text = format!("RMS {rms:.1} at {density:.2} over the minimum density, aperture 0.048 mm");
            let _ = writeln!(out, "  granularity: {text}");
        }
        let silver = silver_negative(stock);
        let speeds = if silver { "   0.8/Hm" } else { "" };
        let _ = writeln!(out, "  development   speed point/log lx s{speeds}   average gradient   Dmin   Dmax");
        for d in &layer.developments {
            let (low, high) = d.curve.density_range();
            let number = |v: Option<f64>| v.map_or("-".to_owned(), |v| format!("{v:.2}"));
            let (point, gradient) =
                (number(d.curve.speed_point()), number(d.curve.average_gradient(AVERAGE_GRADIENT_SPAN)));
            let assumed = if d.assumed { "  (assumed)" } else { "" };
            let speed = d.speed().filter(|_| silver).map_or(String::new(), |s| format!("{s:>9.0}"));
            let _ = writeln!(out, "  {:<14}{point:>20}{speed}{gradient:>19}{low:>7.2}{high:>7.2}{assumed}", d.name);
        }
    }
    let _ = writeln!(out, "\nlog10 sensitivity to equal energy, 0 at the peak");
    let names: String = stock.layers.iter().fold(String::new(), |all, l| format!("{all}{:>16}", l.name));
    let _ = writeln!(out, "      nm{names}");
    for w in (350..=830).step_by(20).map(f64::from) {
        let values = stock.layers.iter().map(|l| sensitivity(l, 1).into_iter().find(|p| p[0] == w).map(|p| p[1]));
        let values: Vec<Option<f64>> = values.collect();
        if values.iter().any(Option::is_some) {
            let shown = values.iter().map(|v| v.map_or(format!("{:>16}", "-"), |v| format!("{v:>16.2}")));
            let _ = writeln!(out, "{w:>8}{}", shown.collect::<String>());
        }
    }
    for doubt in stock.warnings() {
        let _ = writeln!(out, "\nwarning: {doubt}");
    }
    out
}
