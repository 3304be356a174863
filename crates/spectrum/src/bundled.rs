//! Tables that are compiled in.

use crate::table::Table;

/// The bundled table `path`.
///
/// # Panics
/// If it is not bundled or faulty: a test reads every one of them.
pub(crate) fn table(path: &str) -> Table {
    let text = spectra_data::text(path).unwrap_or_else(|| panic!("{path} is bundled"));
    Table::parse(path, text, None).unwrap_or_else(|e| panic!("bundled tables are sound: {e}"))
}
