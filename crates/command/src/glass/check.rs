//! `spectra glass check`: compares computed indices with the values that makers list.

use super::arguments::GlassCheck;
use super::catalogue;
use crate::console;
use crate::outcome::{DONE, Outcome};
use spectra_glass::{LISTED_TOLERANCE_ND, LISTED_TOLERANCE_VD, ListedCheck};
use spectra_sheet::{Column, Sheet, Table};

/// Compares computed values with listed ones, and writes the result to standard output.
pub(crate) fn check(arguments: &GlassCheck) -> Outcome {
    console::sheet(&sheet(&catalogue(&arguments.own)?.check_listed()), arguments.report.json)?;
    Ok(DONE)
}

/// Makes the sheet of a check. `listed` counts the media that have listed nd and Vd as well as coefficients.
fn sheet(check: &ListedCheck) -> Sheet {
    let (listed, deviating) = (check.listed, check.deviating.len());
    let share = 100.0 * (1.0 - deviating as f64 / listed.max(1) as f64);
    let within = format!("the listed nd within {LISTED_TOLERANCE_ND} and Vd within {LISTED_TOLERANCE_VD}");
    let agreeing = listed - deviating;
    let mut sheet = Sheet::new(&format!("{agreeing} of {listed} media ({share:.2} %) have {within}; the others:"));
    sheet.data("listed", listed);
    sheet.data("tolerance_nd", LISTED_TOLERANCE_ND);
    sheet.data("tolerance_vd", LISTED_TOLERANCE_VD);
    let columns = [
        Column::text("name", "glass"),
        Column::fixed("listed_nd", "nd listed", 5),
        Column::fixed("nd", "computed", 5),
        Column::fixed("listed_vd", "Vd", 2),
        Column::fixed("vd", "computed", 2),
    ];
    let mut table = Table::new("deviating", columns);
    for d in &check.deviating {
        table.push((d.glass.full_name(), d.listed_nd, d.nd, d.listed_vd, d.vd));
    }
    sheet.table(table);
    sheet
}
