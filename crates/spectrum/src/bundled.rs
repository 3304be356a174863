//! Tables that are compiled into the program.

use crate::table::Table;

/// Returns the bundled table `path`.
///
/// # Panics
/// If the table is not bundled or is faulty; a test reads every one of them.
pub(crate) fn table(path: &str) -> Table {
    let text = spectra_data::text(path).unwrap_or_else(|| panic!("{path} is bundled"));
    Table::parse(path, text, None).unwrap_or_else(|e| panic!("bundled tables are sound: {e}"))
}
