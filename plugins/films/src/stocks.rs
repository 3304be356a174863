//! Loading of stocks by name.

use spectra_core::names;
use spectra_core::params::{Fault, Faults, Params};
use spectra_core::resources::Resources;
use spectra_film::stock::Stock;

/// Loads the stock `name`, which the scene names at `key`.
pub(crate) fn load_stock(name: &str, key: &str, params: &Params, resources: &dyn Resources) -> Result<Stock, Faults> {
    Stock::load(name, resources).map_err(|faults| place_at(faults, params, key, name))
}

/// Places the fault of a file that was not found at `key`, which names the file, and suggests similar names.
fn place_at(faults: Faults, params: &Params, key: &str, name: &str) -> Faults {
    let place = |fault: Fault| {
        if fault.place.is_some() {
            return fault;
        }
        let known: Vec<&str> = Stock::bundled().collect();
        let generic = |hint: &String| hint.starts_with("a file is looked for") && !name.contains('.');
        let hint = fault.hint.filter(|hint| !generic(hint));
        let hint = hint.unwrap_or_else(|| names::hint(name, &known, "spectra list stock"));
        params.fault(key, fault.message).hint(hint)
    };
    faults.into_iter().map(place).collect::<Vec<_>>().into()
}
