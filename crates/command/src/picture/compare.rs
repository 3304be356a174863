//! `spectra picture compare`: compares two pictures.

use super::arguments::PictureCompare;
use super::{MOST_CHANNELS, load, percent, refuse, stem};
use crate::console;
use crate::folder::apart;
use crate::outcome::{DONE, Outcome};
use serde_json::json;
use spectra_analysis::picture::{self, Difference, Differs, NotMeasured, Scale, view};
use spectra_core::params::Fault;
use spectra_plot::Format;
use spectra_sheet::{Column, Sheet, Table};

/// Compares two pictures and writes the result to standard output, and a map of CIEDE2000 if requested.
pub(super) fn compare(arguments: &PictureCompare) -> Outcome {
    let [first_path, second_path] = [&arguments.first, &arguments.second];
    if let Some(output) = &arguments.output {
        Format::of(output)?;
        apart(output, &[first_path, second_path])?;
    }
    let (first, second) = (load(first_path)?, load(second_path)?);
    let between = |error: NotMeasured| {
        let text = format!("{}, {}: {}", first_path.display(), second_path.display(), error.text);
        Fault::new(text).hint(error.hint)
    };
    let difference = picture::compare(&first, &second, arguments.white.white).map_err(between)?;
    if let Some(output) = &arguments.output {
        let Some(field) = difference.field() else {
            let colorless = if first.colors.is_none() { (&first, first_path) } else { (&second, second_path) };
            return Err(refuse(colorless.1, colorless.0.without_colors()));
        };
        let title = format!("{} and {}", stem(first_path), stem(second_path));
        let canvas = view(&first, &field, Scale::default(), &title).map_err(between)?;
        canvas.write(output)?;
        console::note(&format!("wrote {}", output.display()));
    }
    let names = [first_path, second_path].map(|path| path.display().to_string());
    console::sheet(&sheet(&names, &difference, first.planes.width), arguments.report.json)?;
    Ok(DONE)
}

/// Makes the sheet of a comparison of two pictures, `width` pixels wide.
fn sheet([first, second]: &[String; 2], difference: &Difference, width: u32) -> Sheet {
    let mut sheet = Sheet::new(&format!("{first} and {second}"));
    sheet.data("first", first);
    sheet.data("second", second);
    let delta_e = difference.delta_e_figures(width).map(|([mean, median, below, maximum], [column, row])| {
        sheet.line("CIEDE2000", Some(format!(
            "mean {mean:.4}, median {median:.4}, 95 % below {below:.4}, largest {maximum:.4} at column {column}, row {row}"
        )));
        sheet.line("", difference.white.clone());
        json!({
            "mean": mean, "median": median, "percentile_95": below, "maximum": maximum, "maximum_at": [column, row],
            "white": difference.white,
        })
    });
    sheet.data("delta_e_2000", delta_e);
    sheet.show(channels(&difference.channels));
    sheet.data("channels", &difference.channels);
    sheet
}

/// Makes the table of the differences by channel.
fn channels(channels: &[Differs]) -> Table {
    let columns = [
        Column::text("name", "channel"),
        Column::significant("mean_1", "mean 1"),
        Column::significant("mean_2", "mean 2"),
        Column::percent("relative_mean", "difference", 3),
        Column::percent("relative_standard_error", "+-", 3),
        Column::percent("relative_rms", "RMS", 3),
        Column::percent("relative_noise", "noise", 3),
        Column::plain("blocks_beyond_3", "blocks > 3 se"),
        Column::text("unit", ""),
    ];
    let mut table = Table::new("channels", columns).most(MOST_CHANNELS);
    for c in channels {
        let [difference, error] = [c.relative_mean, c.relative_standard_error];
        let blocks = c.blocks_beyond_3.map(percent);
        table.push((
            &c.name,
            c.means[0],
            c.means[1],
            difference,
            error,
            c.relative_rms,
            c.relative_noise,
            blocks,
            &c.unit,
        ));
    }
    table
}
