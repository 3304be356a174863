//! Tables as printed in patents, each compared with its figures typed by hand.

use serde_json::Value;
use spectra_exchange::{Format, Medium, SurfaceShape, read};
use std::path::Path;

/// Reads tables in the style of American, Japanese and German patents and of a forum, typed by somebody who had not seen the reader.
#[test]
fn tables_in_the_manner_of_patents_are_read() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/patents");
    let mut wrong = Vec::new();
    let mut count = 0;
    for entry in std::fs::read_dir(&folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.extension().is_none_or(|ending| ending != "txt") {
            continue;
        }
        count += 1;
        let name = path.display().to_string();
        let text = std::fs::read_to_string(path.with_extension("json")).expect("figures");
        let right: Value = serde_json::from_str(&text).expect("JSON");
        let lens = match read(Format::Csv, &name, &std::fs::read(&path).expect("a file")) {
            Ok(lens) => lens,
            Err(faults) => {
                wrong.push(faults.to_string());
                continue;
            }
        };
        let surfaces: Vec<_> = lens.surfaces().collect();
        let radius = |shape: &SurfaceShape| match shape {
            SurfaceShape::Sphere { radius }
            | SurfaceShape::Conic { radius, .. }
            | SurfaceShape::EvenAsphere { radius, .. } => Some(*radius).filter(|r| r.is_finite()),
            _ => None,
        };
        let index = |medium: &Medium| match medium {
            Medium::Model { nd, .. } => *nd,
            Medium::Glass { nd, .. } => nd.unwrap_or(f64::NAN),
            _ => 1.0,
        };
        let mut same = |what: &str, got: Vec<Option<f64>>| {
            let want: Vec<Option<f64>> = right[what].as_array().expect("a list").iter().map(Value::as_f64).collect();
            let near = |(a, b): (&Option<f64>, &Option<f64>)| match (a, b) {
                (Some(a), Some(b)) => (a - b).abs() <= 1e-9 * b.abs(),
                (a, b) => a == b,
            };
            // The table may state nothing for the last gap.
            let states_all = what != "thicknesses" || want.last().is_none_or(Option::is_some);
            let compared = if states_all { want.len() } else { want.len() - 1 };
            if got.len() != want.len() || !got.iter().zip(&want).take(compared).all(near) {
                wrong.push(format!("{name}: {what}: {got:?}, not {want:?}"));
            }
        };
        same("radii", surfaces.iter().map(|s| radius(&s.shape)).collect());
        same("thicknesses", surfaces.iter().map(|s| Some(s.thickness_mm)).collect());
        same("nd", surfaces.iter().map(|s| Some(index(&s.medium))).collect());
        let stop = surfaces.iter().position(|s| s.stop || s.shape == SurfaceShape::Stop).map(|at| at as u64 + 1);
        if stop != right["stop"].as_u64() {
            wrong.push(format!("{name}: the stop is {stop:?}"));
        }
        // A stop that is only mentioned in a sentence must be noted.
        if stop.is_none() && !lens.left_out.iter().any(|note| note.alters && note.text.contains("the stop has no row"))
        {
            wrong.push(format!("{name}: nothing is said of the stop"));
        }
        for (number, terms) in right["aspheres"].as_object().expect("a map") {
            let at: usize = number.parse().expect("a number");
            let SurfaceShape::EvenAsphere { conic, coefficients, .. } = &surfaces[at - 1].shape else {
                wrong.push(format!("{name}: surface {at} is no asphere"));
                continue;
            };
            for (term, want) in terms.as_object().expect("a map") {
                let got = match term.strip_prefix('a') {
                    Some(power) => {
                        coefficients.get(power.parse::<usize>().expect("a power") / 2 - 1).copied().unwrap_or(0.0)
                    }
                    None => *conic,
                };
                if (got - want.as_f64().expect("a number")).abs() > 1e-9 * got.abs() {
                    wrong.push(format!("{name}: surface {at}, {term}: {got}, not {want}"));
                }
            }
        }
    }
    assert_eq!(count, 38);
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
