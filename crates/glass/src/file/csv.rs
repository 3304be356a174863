//! A table of n, and k where it is known, as CSV.

use super::{OWN_MAKER, sensible};
use crate::{Category, Extinction, Formula, Glass, Table};
use spectra_core::params::{Fault, Faults, SourceFile, Span};
use std::sync::Arc;

/// Most rows that are read.
const MAX_ROWS: usize = 100_000;

/// Columns by place.
struct Columns {
    wavelength: usize,
    unit_nm: f64,
    n: usize,
    k: Option<usize>,
}

/// Reads a table; its name is that of the file.
pub(super) fn read(name: &str, bytes: &[u8]) -> Result<Glass, Faults> {
    let text = std::str::from_utf8(bytes).map_err(|_| Fault::new(format!("{name}: is not UTF-8 text")))?;
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let file = Arc::new(SourceFile::new(name, text));
    let mut columns = None;
    let mut rows: Vec<(f64, f64, Option<f64>)> = Vec::new();
    let mut offset = 0;
    for (i, whole) in text.split_inclusive('\n').enumerate() {
        let start = offset;
        offset += whole.len();
        let line = whole.trim_end();
        if line.trim().is_empty() || line.starts_with('#') {
            continue;
        }
        let fields: Vec<&str> = line.split(',').collect();
        let place = |at: usize| {
            let field = fields.get(at).copied().unwrap_or("");
            let from = if at < fields.len() { field.as_ptr() as usize - line.as_ptr() as usize } else { line.len() };
            let from = from + field.len() - field.trim_start().len();
            let column = line[..from].chars().count() + 1;
            Span { line: i + 1, column, offset: start + from, len: field.trim().len() }
        };
        let fault = |at: usize, text: String| Fault::new(text).at(Arc::clone(&file), place(at));
        let Some(columns) = &columns else {
            columns = Some(head(&fields).map_err(|text| {
                fault(0, text).hint("columns `wavelength_nm` (or `wavelength_um`), `n` and, where it is known, `k`")
            })?);
            continue;
        };
        if rows.len() == MAX_ROWS {
            return Err(fault(0, format!("more than {MAX_ROWS} rows")).into());
        }
        let number = |at: usize| {
            let field = fields.get(at).copied().unwrap_or("").trim();
            let value = field.parse::<f64>().ok().filter(|v| v.is_finite());
            value.ok_or_else(|| fault(at, format!("`{field}` is not a number")))
        };
        let nm = number(columns.wavelength)? * columns.unit_nm;
        if !(10.0..=1e6).contains(&nm) {
            let fault = fault(columns.wavelength, format!("a wavelength of {nm} nm"));
            return Err(fault.hint("name the column `wavelength_um` where it is in micrometers").into());
        }
        if rows.last().is_some_and(|&(before, ..)| nm <= before) {
            return Err(fault(columns.wavelength, format!("{nm} nm does not come after the row before")).into());
        }
        let n = number(columns.n)?;
        if !(1.0..=10.0).contains(&n) {
            return Err(fault(columns.n, format!("an index of {n}")).hint("it lies between 1 and 10").into());
        }
        let k = columns.k.map(&number).transpose()?;
        if let (Some(at), Some(k)) = (columns.k, k.filter(|k| *k < 0.0)) {
            return Err(fault(at, format!("k is {k}")).hint("k is 0 or more").into());
        }
        rows.push((nm, n, k));
    }
    let points: Vec<(f64, f64)> = rows.iter().map(|&(nm, n, _)| (nm, n)).collect();
    let table = Table::new(&points).map_err(|e| Fault::new(format!("{name}: {e}")))?;
    let range_nm = table.range_nm();
    let stem = name.rsplit(['/', '\\']).next().unwrap_or(name);
    let stem = stem.rsplit_once('.').map_or(stem, |(stem, _)| stem);
    let mut glass = Glass::new(OWN_MAKER, stem, Category::User, Formula::Table(table.into()), range_nm);
    let k: Option<Vec<f64>> = rows.iter().map(|row| row.2).collect();
    glass.extinction = k.and_then(|k| Extinction::new(rows.iter().map(|row| row.0).collect(), k));
    sensible(&glass).map_err(|text| Fault::new(format!("{name}: {text}")))?;
    Ok(glass)
}

fn head(fields: &[&str]) -> Result<Columns, String> {
    let names: Vec<String> = fields.iter().map(|f| f.trim().to_lowercase()).collect();
    let place = |name: &str| names.iter().position(|n| n == name);
    let wavelength = match (place("wavelength_nm"), place("wavelength_um")) {
        (Some(at), None) => Some((at, 1.0)),
        (None, Some(at)) => Some((at, 1000.0)),
        _ => None,
    };
    let (Some((wavelength, unit_nm)), Some(n)) = (wavelength, place("n")) else {
        return Err(format!(
            "no head of a table of indices: `{}`",
            names.join(",").chars().take(60).collect::<String>()
        ));
    };
    Ok(Columns { wavelength, unit_nm, n, k: place("k") })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Water at 20 C: n of IAPWS, k of Hale and Querry 1973, roughly; what matters is that both come back at their rows.
    #[test]
    fn n_and_k_come_back_and_faults_have_their_place() {
        let text = "# water\nwavelength_um, n, k\n0.4, 1.3435, 1.86e-9\n0.6, 1.3325, 1.09e-8\n0.8, 1.3290, 1.25e-7\n";
        let glass = read("data/water.csv", text.as_bytes()).expect("a table");
        assert_eq!((glass.name.as_str(), glass.range_nm), ("water", (400.0, 800.0)));
        assert_eq!(glass.index(600.0), 1.3325);
        // exp(-4 pi k d / lambda) of a meter at 600 nm: 0.796.
        let tau = glass.internal_transmittance(600.0, 1000.0).expect("known");
        assert!((tau - libm::exp(-4.0 * std::f64::consts::PI * 1.09e-8 * 1e9 / 600.0)).abs() < 1e-12, "{tau}");
        for (text, place) in [
            ("wavelength_nm,n\n400,1.5\n500,x\n", "f.csv:3:5"),
            ("wavelength_nm,n\n400,1.5\n300,1.5\n", "f.csv:3:1"),
            ("wavelength_nm,n,k\n400,1.5, -1\n", "f.csv:2:10"),
            ("lambda,n\n", "f.csv:1:1"),
            ("wavelength_nm,n\n0.4,1.5\n", "f.csv:2:1"),
            ("wavelength_nm,n\n400\n", "f.csv:2:4"),
        ] {
            let faults = read("f.csv", text.as_bytes()).expect_err(text);
            assert_eq!(faults.0[0].place_text().as_deref(), Some(place), "{faults}");
        }
        assert!(read("f.csv", b"wavelength_nm,n\n400,1.5\n").is_err() && read("f.csv", b"\xff").is_err());
    }
}
