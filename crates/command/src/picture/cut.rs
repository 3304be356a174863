//! `spectra picture cut`: plots quantities along a line through a picture.

use super::arguments::PictureCut;
use super::{field, load, output, quantity, refuse, stem};
use crate::console;
use crate::folder::apart;
use crate::outcome::{DONE, Failure, Outcome};
use spectra_analysis::picture::{Cut, CutLine, Quantity, curve};
use spectra_files::write_atomically;
use spectra_plot::Format;
use std::io::Write as _;
use std::path::Path;

/// Plots quantities along a row, a column or a line, or writes them as a table.
pub(super) fn cut(arguments: &PictureCut) -> Outcome {
    let path = &arguments.file;
    let output = output(arguments.output.as_ref(), path, "cut.svg");
    apart(&output, &[path])?;
    let is_table = ending_is_csv(&output);
    if !is_table && Format::of(&output).is_err() {
        let text = format!("{}: the name of a cut must end in .svg, .png or .csv", output.display());
        return Err(Failure::Input(text));
    }
    let picture = load(path)?;
    let asked = arguments.quantity.iter().map(|name| quantity(name, &picture, &[]));
    let mut quantities = asked.collect::<Result<Vec<Quantity>, Failure>>()?;
    if quantities.is_empty() {
        quantities = match picture.colors {
            Some(_) => vec![Quantity::usual(&picture)],
            None => picture.planes.channels.iter().take(7).map(|c| Quantity::Channel(c.name.clone())).collect(),
        };
    }
    let white = arguments.white.white;
    let fields = quantities.iter().map(|quantity| field(path, &picture, quantity, white));
    let fields = fields.collect::<Result<Vec<_>, Failure>>()?;
    let (way, said) = match (arguments.way.row, arguments.way.column, arguments.way.line) {
        (Some(row), ..) => (CutLine::Row(row), format!("row {row}")),
        (_, Some(column), _) => (CutLine::Column(column), format!("column {column}")),
        (_, _, Some([x, y, to_x, to_y])) => {
            (CutLine::Line { from: [x, y], to: [to_x, to_y] }, format!("from {x}, {y} to {to_x}, {to_y}"))
        }
        // The parser requires one of the three.
        _ => return Err(Failure::Input("say where to cut with --row, --column or --line".to_owned())),
    };
    let cut = Cut::of(&picture, &fields, way).map_err(|error| refuse(path, error))?;
    if is_table {
        let table = cut.to_csv();
        write_atomically(&output, |out| Ok(out.write_all(table.as_bytes())?))?;
    } else {
        let title = format!("{}: {said}", stem(path));
        let canvas = curve(&cut, arguments.log, &title).map_err(|error| refuse(path, error))?;
        canvas.write(&output)?;
    }
    console::note(&format!("wrote {}", output.display()));
    Ok(DONE)
}

fn ending_is_csv(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("csv"))
}
