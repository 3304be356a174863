//! Where a spectrum comes from.

use super::files;
use spectra_core::resources::Resources;
use spectra_spectrum::bundled_spectra;
use spectra_spectrum::table::{MAX_BYTES, Table};

/// The table behind a name: bundled, or a file. `None` for a spectrum that is written out, and for what is no table.
///
/// Names are read as `find_in` does.
pub(crate) fn table(name: &str) -> Option<Table> {
    let name = name.trim();
    let file = name.rsplit_once('#').map_or(name, |(file, _)| file.trim());
    if file.ends_with(".csv") || file.contains(['/', '\\']) {
        let resource = files().read(file, &["spectra"], &[".csv"], MAX_BYTES).ok()?;
        return Table::parse_bytes(&resource.name, &resource.bytes, None).ok();
    }
    let key = normalized(file);
    let fluorescent = key.strip_prefix('f').filter(|n| n.starts_with(|c: char| c.is_ascii_digit()));
    let key = fluorescent.map_or(key.clone(), |n| format!("fl{n}"));
    let (_, path) = bundled_spectra().find(|(known, _)| normalized(known) == key)?;
    bundled(path)
}

/// A bundled table.
pub(crate) fn bundled(path: &str) -> Option<Table> {
    Table::parse_bytes(path, spectra_data::get(path)?, None).ok()
}

fn normalized(name: &str) -> String {
    name.chars().filter(|c| !matches!(c, ' ' | '-' | '_')).flat_map(char::to_lowercase).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spectrum::load;

    #[test]
    fn what_is_found_as_a_spectrum_is_found_as_a_table() {
        for (name, path) in bundled_spectra() {
            let meta = table(name).unwrap_or_else(|| panic!("{name}")).meta;
            assert!(meta.source.is_some() && meta.licence.is_some() && meta.range_nm.is_some(), "{path}");
        }
        for name in ["F11", "d 65", "colorchecker#red", "illuminants/A.csv"] {
            assert!(load(name).is_ok() && table(name).is_some(), "{name}");
        }
        assert!(table("blackbody:5800").is_none() && table("no such").is_none());
    }
}
