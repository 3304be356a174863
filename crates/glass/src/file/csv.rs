//! Tables of n, and of k where it is known, as CSV; of one material or of several.

use super::{OWN_MAKER, sensible};
use crate::fit::samples::{IndexRow, Material, read_rows};
use crate::{Category, Extinction, Formula, Glass, Table};
use spectra_core::names::nearest;
use spectra_core::params::{Fault, Faults, SourceFile, Span};
use std::sync::Arc;

/// Largest number of rows that are read.
const MAX_ROWS: usize = 100_000;

/// Reads the table of a material, or the only table of a file. The glass is named after the material or else the file.
pub(super) fn read(name: &str, bytes: &[u8], material: Option<&str>) -> Result<Glass, Faults> {
    let text = std::str::from_utf8(bytes).map_err(|_| Fault::new(format!("{name}: is not UTF-8 text")))?;
    if text.lines().count() > MAX_ROWS + 1000 {
        return Err(Fault::new(format!("{name}: more than {MAX_ROWS} rows")).into());
    }
    let file = Arc::new(SourceFile::new(name, text));
    let at = |place: Span, message: String| Fault::new(message).at(Arc::clone(&file), place);
    let found = read_rows(text).map_err(|e| match e.hint {
        Some(hint) => at(e.place, e.message).hint(hint),
        None => at(e.place, e.message),
    })?;
    let stem = name.rsplit(['/', '\\']).next().unwrap_or(name);
    let rows = rows_of(&found, material, stem)?;
    let stem = stem.rsplit_once('.').map_or(stem, |(stem, _)| stem);
    if let Some(pair) = rows.windows(2).find(|pair| pair[1].wavelength_nm <= pair[0].wavelength_nm) {
        let message = format!("{} nm is not above the wavelength of the row before", pair[1].wavelength_nm);
        let fault = at(Span::of(pair[1].cell, text), message);
        return Err(fault.hint("wavelengths must increase; a column `material` separates several tables").into());
    }
    let points: Vec<(f64, f64)> = rows.iter().map(|row| (row.wavelength_nm, row.n)).collect();
    let table = Table::new(&points).map_err(|e| Fault::new(format!("{name}: {e}")))?;
    let range_nm = table.range_nm();
    let called = material.unwrap_or(stem);
    let mut glass = Glass::new(OWN_MAKER, called, Category::User, Formula::Table(table.into()), range_nm);
    let k: Option<Vec<f64>> = rows.iter().map(|row| row.k).collect();
    glass.extinction = k.and_then(|k| Extinction::new(rows.iter().map(|row| row.wavelength_nm).collect(), k));
    sensible(&glass).map_err(|text| Fault::new(format!("{name}: {text}")))?;
    Ok(glass)
}

/// Returns the rows of the requested material, or of the only one.
fn rows_of<'a>(found: &'a [Material<'a>], material: Option<&str>, shown: &str) -> Result<&'a [IndexRow<'a>], Fault> {
    let names = || found.iter().filter_map(|(name, _)| name.as_deref());
    match (material, found) {
        (None, [(_, rows)]) => Ok(rows),
        (None, many) => {
            let fault = Fault::new(format!("`{shown}` holds {} materials", many.len()));
            let which = names().next().unwrap_or_default();
            let all = names().take(12).collect::<Vec<_>>().join(", ");
            Err(fault.hint(format!("name one, such as `{shown}#{which}`; it has {all}")))
        }
        (Some(wanted), found) => {
            let same = |name: &Option<String>| name.as_deref().is_some_and(|name| name.eq_ignore_ascii_case(wanted));
            if let Some((_, rows)) = found.iter().find(|(name, _)| same(name)) {
                return Ok(rows);
            }
            if names().next().is_none() {
                let fault = Fault::new(format!("`{shown}` holds one glass; there is no `#{wanted}`"));
                return Err(fault.hint(format!("write `{shown}`")));
            }
            let fault = Fault::new(format!("`{shown}` has no material `{wanted}`"));
            let all = names().take(12).collect::<Vec<_>>().join(", ");
            Err(match nearest(wanted, names()) {
                Some(near) => fault.hint(format!("did you mean `{shown}#{near}`?")),
                None => fault.hint(format!("it has {all}")),
            })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Water at 20 C: n of IAPWS, k of Hale and Querry 1973, roughly; what matters is that both come back at their rows.
    #[test]
    fn n_and_k_come_back_and_faults_have_their_place() {
        let text = "# water\nwavelength_um, n, k\n0.4, 1.3435, 1.86e-9\n0.6, 1.3325, 1.09e-8\n0.8, 1.3290, 1.25e-7\n";
        let glass = read("data/water.csv", text.as_bytes(), None).expect("a table");
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
            let faults = read("f.csv", text.as_bytes(), None).expect_err(text);
            assert_eq!(faults.0[0].place_text().as_deref(), Some(place), "{faults}");
        }
        assert!(read("f.csv", b"wavelength_nm,n\n400,1.5\n", None).is_err() && read("f.csv", b"\xff", None).is_err());
    }

    /// Several materials in one file, each with its rows anywhere, as `glass fit` reads them.
    #[test]
    fn a_material_of_several() {
        let text = "material;nm;n\nA;400;1.5\nB;500;1.6\nA;600;1.4\nB;700;1.55\n";
        let glass = |material| read("x/two.csv", text.as_bytes(), material);
        let b = glass(Some("b")).expect("a table");
        assert_eq!((b.name.as_str(), b.range_nm, b.index(500.0)), ("b", (500.0, 700.0), 1.6));
        for (material, words) in [(None, "two.csv#A"), (Some("C"), "no material `C`")] {
            let faults = glass(material).expect_err("not one").to_string();
            assert!(faults.contains(words) && faults.contains("A, B") || faults.contains("did you mean"), "{faults}");
        }
    }
}
