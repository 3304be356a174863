//! Access to the bundled tables of spectra.

use spectra_spectrum::table::Table;

/// Loads a bundled table; `None` if there is none at this path.
pub(crate) fn bundled(path: &str) -> Option<Table> {
    Table::parse_bytes(path, spectra_data::get(path)?, None).ok()
}

#[cfg(test)]
mod tests {
    use crate::spectrum::{files, load};
    use spectra_spectrum::{bundled_spectra, meta_in};

    #[test]
    fn what_is_found_as_a_spectrum_says_where_it_is_from() {
        for (name, path) in bundled_spectra() {
            let meta = meta_in(name, &files()).unwrap_or_else(|| panic!("{name}"));
            assert!(meta.source.is_some() && meta.license.is_some() && meta.range_nm.is_some(), "{path}");
        }
        for name in ["F11", "d 65", "colorchecker#red", "illuminants/A.csv"] {
            assert!(load(name).is_ok() && meta_in(name, &files()).is_some(), "{name}");
        }
        assert!(meta_in("blackbody:5800", &files()).is_none() && meta_in("no such", &files()).is_none());
    }
}
