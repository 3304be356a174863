//! `spectra spectrum list`: lists the bundled spectra.

use super::arguments::SpectrumList;
use super::describe::bundled;
use crate::console;
use crate::outcome::{DONE, Outcome};
use serde::Serialize;
use spectra_spectrum::bundled_spectra;
use std::fmt::Write;

/// A bundled spectrum, or a file with several spectra.
#[derive(Debug, Serialize)]
struct Item {
    name: &'static str,
    title: Option<String>,
    kind: &'static str,
    range_nm: Option<[f64; 2]>,
    /// Names of columns, written after `#`; empty if the file holds one spectrum.
    columns: Vec<String>,
    source: Option<String>,
    license: Option<String>,
    file: &'static str,
}

/// Largest number of columns of a file that are listed one by one. A chart of 24 patches is.
const MOST_COLUMNS: usize = 30;

/// Writes the list of bundled spectra to standard output.
pub(crate) fn list(arguments: &SpectrumList) -> Outcome {
    let items: Vec<Item> = bundled_spectra().filter_map(|(name, path)| item(name, path)).collect();
    if arguments.json {
        console::pretty_json(&items)?;
    } else {
        console::out(&table(&items, arguments.all))?;
    }
    Ok(DONE)
}

fn item(name: &'static str, file: &'static str) -> Option<Item> {
    let table = bundled(file)?;
    let columns = if table.columns.len() > 1 { table.columns } else { Vec::new() };
    let range_nm = table.meta.range_nm.map(|(from, to)| [from, to]);
    let (title, source, license) = (table.meta.name, table.meta.source, table.meta.license);
    Some(Item { name, title, kind: table.kind.word(), range_nm, columns, source, license, file })
}

fn table(items: &[Item], all: bool) -> String {
    let width = items.iter().map(|item| item.name.len()).max().unwrap_or(0);
    let mut out = String::new();
    let mut folder = "";
    for item in items {
        let (of, _) = item.file.trim_start_matches("spectra/").split_once('/').unwrap_or((item.file, ""));
        if of != folder {
            let gap = if folder.is_empty() { "" } else { "\n" };
            folder = of;
            // Writing to a String cannot fail.
            let _ = writeln!(out, "{gap}{folder}");
        }
        let range = item.range_nm.map_or(String::new(), |[from, to]| format!("{from:.0}-{to:.0} nm"));
        let title = item.title.as_deref().unwrap_or("");
        let _ = write!(out, "  {:<width$}  {:<14}  {range:<12}  {title}", item.name, item.kind);
        let columns = item.columns.as_slice();
        match columns {
            [] => out.push('\n'),
            [first, .., last] if columns.len() > MOST_COLUMNS && !all => {
                let _ = writeln!(out, " ({} columns: #{first} ... #{last})", columns.len());
            }
            columns => {
                let _ = writeln!(out, " (#{})", columns.join(", #"));
            }
        }
    }
    if !all && items.iter().any(|item| item.columns.len() > MOST_COLUMNS) {
        out.push_str("\n--all shows every column of files that have many\n");
    }
    out.push_str(
        "\nexpressions: blackbody:5800  daylight:5500  line:C'  line:632.8  gaussian:550,20  rectangle:500,600  FdC  F'eC'  rgb-lines  rgb:#ff8040\n\
         combined with + - * / ^ and parentheses: 'D65 + 5000 * line:e', '1 - wratten-25'; or a CSV or YAML file of your own\n",
    );
    out
}
