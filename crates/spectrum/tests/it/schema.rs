//! Every file under `spectra/` keeps to the format and says where it comes from.

use spectra_spectrum::table::Table;
use spectra_spectrum::{Kind, bundled_spectra, find};

/// Folders whose files have a format of their own, read and tested by the crate that owns them.
const ELSEWHERE: [&str; 2] = ["spectra/glass/", "spectra/film/"];

fn files() -> impl Iterator<Item = &'static str> {
    spectra_data::list("spectra/")
}

#[test]
fn every_table_reads_and_states_its_origin() {
    let mut count = 0;
    for path in files().filter(|p| p.ends_with(".csv") && !ELSEWHERE.iter().any(|e| p.starts_with(e))) {
        let text = spectra_data::text(path).unwrap_or_else(|| panic!("{path} is text"));
        let table = Table::parse(path, text, None).unwrap_or_else(|e| panic!("{e}"));
        assert!(table.meta.missing().is_empty(), "{path}: no {}", table.meta.missing().join(", "));
        let (first, last) = (table.wavelengths_nm[0], table.wavelengths_nm[table.wavelengths_nm.len() - 1]);
        assert_eq!(table.meta.range_nm, Some((first, last)), "{path}: the range stated is not that of the rows");
        assert!(first >= 200.0 && last <= 2500.0, "{path}: {first}-{last} nm is not in nanometres");
        assert!(table.meta.outside.is_some() || table.kind == Kind::Lines, "{path}: what holds beyond the ends?");
        if matches!(table.kind, Kind::Emission | Kind::Lines | Kind::Sensitivity) {
            for (name, values) in table.columns.iter().zip(&table.values) {
                assert!(values.iter().any(|v| *v > 0.0), "{path}: {name} is 0 everywhere");
            }
        }
        count += 1;
    }
    assert!(count >= 69, "{count}");
}

/// Every file in `spectra/` is a table, or text about tables, or belongs to a folder with its own test; no stray files are allowed.
#[test]
fn nothing_else_lies_there() {
    for path in files() {
        let known = path.ends_with(".csv") || path.ends_with(".md") || ELSEWHERE.iter().any(|e| path.starts_with(e));
        assert!(known, "{path}");
    }
}

/// Data of any format has known terms: each data file states `source` and `license` in its first lines.
#[test]
fn every_data_file_states_source_and_license() {
    let stated = spectra_data::licenses();
    for path in files().filter(|p| !p.ends_with(".md")) {
        assert!(stated.iter().any(|l| l.files.contains(&path)), "{path} does not state source and license");
    }
}

/// A file can be named without its folder, so no two may share a name.
#[test]
fn names_are_unique_and_found() {
    let mut names: Vec<_> =
        bundled_spectra().map(|(name, _)| name.to_lowercase().replace(['-', '_', ' '], "")).collect();
    let all = names.len();
    names.sort();
    names.dedup();
    assert_eq!(names.len(), all);
    for (name, path) in
        bundled_spectra().filter(|(_, p)| p.starts_with("spectra/illuminants/") || p.starts_with("spectra/lamps/"))
    {
        let found = find(name).unwrap_or_else(|e| panic!("{path}: {e}"));
        assert_eq!(found.kind(), Kind::Emission, "{path}");
    }
}
