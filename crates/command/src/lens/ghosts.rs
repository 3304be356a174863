//! `spectra lens ghosts`.

use super::load;
use crate::arguments::LensGhosts;
use crate::console;
use crate::outcome::{DONE, Failure, Outcome};
use serde_json::json;
use spectra_analysis::ghosts::{Ghost, ghosts as find};
use spectra_core::Isa;

/// Lists the ghosts of a lens.
pub(crate) fn ghosts(arguments: &LensGhosts, isa: Isa) -> Outcome {
    let lens = load(&arguments.setting)?;
    let all = find(&lens, lens.reference_nm, isa)
        .map_err(|error| Failure::Input(format!("{}: {error}", arguments.setting.lens)))?;
    let sum: f64 = all.iter().map(|ghost| ghost.energy).sum();
    if arguments.json {
        console::pretty_json(&json!({
            "lens": lens.name,
            "wavelength_nm": lens.reference_nm,
            "energy": sum,
            "paths": all,
        }))?;
        return Ok(DONE);
    }
    let mut text = format!(
        "{}: {} ghosts of two reflections, together {:.3} % of the straight light (infinity, on the axis, {:.1} nm)\n",
        lens.name,
        all.len(),
        100.0 * sum,
        lens.reference_nm
    );
    if !all.is_empty() {
        text.push_str("surfaces     energy      focus   f of ghost  size on film    C' : e : F'\n");
    }
    let shown = if arguments.all { all.len() } else { MOST.min(all.len()) };
    all[..shown].iter().for_each(|ghost| text.push_str(&row(ghost)));
    if shown < all.len() {
        text.push_str(&format!("{} weaker ones: --all shows them\n", all.len() - shown));
    }
    console::out(&text)?;
    Ok(DONE)
}

/// Paths listed unless all are asked for.
const MOST: usize = 15;

fn row(ghost: &Ghost) -> String {
    let length = |mm: Option<f64>| mm.map_or_else(|| "-".to_owned(), |mm| format!("{mm:.2} mm"));
    let [a, b] = ghost.surfaces;
    let [red, green, blue] = ghost.color;
    format!(
        "{:>8} {:>10.2e} {:>10} {:>12} {:>10.2} mm    {red:.2} : {green:.0} : {blue:.2}\n",
        format!("{a}, {b}"),
        ghost.energy,
        length(ghost.focus_mm),
        length(ghost.focal_length_mm),
        ghost.size_mm
    )
}
