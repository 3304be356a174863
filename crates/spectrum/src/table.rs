//! Reads CSV files of spectra.
//!
//! A file has front matter of `# key: value` lines (see [`Meta`]), a header row `wavelength_nm,<columns>`, then one row per
//! wavelength, in increasing order.
//!
//! If the first line is not `# spectra: 1`, the table is read in any common format. Lines that begin with `#` are plain comments,
//! the caller supplies the kind, and [`Table::notes`] says how the rest was interpreted. Columns are separated by commas,
//! semicolons, tabs or spaces; decimal commas are accepted with all of these except commas. The header may be missing, and
//! wavelengths may be in micrometers or in descending order.
//!
//! ```
//! use spectra_spectrum::table::Table;
//! use spectra_spectrum::Kind;
//!
//! let fault = Table::parse("mine.csv", "wavelength_nm,red\n400,0.5\n410,80\n", Some(Kind::Sensitivity)).unwrap_err();
//! assert_eq!(fault.to_string(), "mine.csv: row 3, column 2 (red): 80 is more than 2: given as percent? divide by 100");
//! ```

use std::sync::Arc;

use spectra_core::params::{SourceFile, Unit};
use spectra_core::quantity::SHORTEST_LIGHT_NM;

use crate::meta::{Interpolation, Kind, Meta, Scale};
use crate::names::normalized;
use crate::separator::is_of_number;
use crate::sprague;
use crate::tabulated::{TableInterpretation, Tabulated};

pub use crate::separator::Separator;
pub use crate::table_error::{MAX_COLUMNS, MAX_ROWS, TableError, TableFault, TablePosition};

/// Size of the largest file that is read, bytes.
pub const MAX_BYTES: u64 = 32 << 20;
/// Words that identify a column of wavelengths: the name of such a column contains one of them.
const WAVELENGTH_WORDS: [&str; 8] = ["wave", "lambda", "\u{3bb}", "nm", "nano", "um", "\u{b5}m", "micro"];

/// Table of spectra as read from a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// Name of the file.
    pub file: String,
    /// Front matter of the file.
    pub meta: Meta,
    /// Kind of quantity in the columns.
    pub kind: Kind,
    /// Names of the columns after the wavelength column.
    pub columns: Vec<String>,
    /// Wavelengths in air, in nm, ascending.
    pub wavelengths_nm: Arc<[f64]>,
    /// Notes on how a table that is not in the format of the bundled ones was interpreted: `no column names`,
    /// `falling wavelengths`, `wavelengths in micrometers`.
    pub notes: Vec<&'static str>,
    /// Values by column, then by row, in the unit that the front matter states.
    pub values: Vec<Arc<[f64]>>,
}

impl Table {
    /// Reads a table from the bytes of a file; see [`Table::parse`].
    ///
    /// # Errors
    /// [`TableError`] as in [`Table::parse`], and if `bytes` is not UTF-8.
    pub fn parse_bytes(file: &str, bytes: &[u8], kind: Option<Kind>) -> Result<Self, TableError> {
        let text = std::str::from_utf8(bytes).map_err(|_| whole(file, TableFault::NotText))?;
        Self::parse(file, text, kind)
    }

    /// Reads a table from text. `kind` is used if the file does not state a kind; `file` is the file's name in messages.
    ///
    /// # Errors
    /// [`TableError`] with row and column: no data, more than [`MAX_ROWS`], a bad front matter or header, a wrong number of
    /// fields, a field that is not a number, NaN, wavelengths that do not increase, negative power, or percentages.
    pub fn parse(file: &str, text: &str, kind: Option<Kind>) -> Result<Self, TableError> {
        Reader::new(file, text.strip_prefix('\u{feff}').unwrap_or(text), kind).read()
    }

    /// Reads a table from the bytes of a file. `kind` and `scale` are used if the file does not state its kind and its unit.
    ///
    /// # Errors
    /// As [`Table::parse_bytes`].
    pub fn parse_read_as(file: &str, bytes: &[u8], kind: Kind, scale: Scale) -> Result<Self, TableError> {
        let text = std::str::from_utf8(bytes).map_err(|_| whole(file, TableFault::NotText))?;
        let reader = Reader::new(file, text.strip_prefix('\u{feff}').unwrap_or(text), Some(kind));
        Reader { scale, ..reader }.read()
    }

    /// Reads a table for which the caller requires no kind. The kind is, in this order: the kind that the file states; the kind
    /// that the name of `column` suggests; `kind`. If `column` is `None`, all column names that suggest a kind count, if they
    /// agree.
    ///
    /// # Errors
    /// As [`Table::parse_bytes`].
    pub fn parse_by_header(file: &str, bytes: &[u8], column: Option<&str>, kind: Kind) -> Result<Self, TableError> {
        let text = std::str::from_utf8(bytes).map_err(|_| whole(file, TableFault::NotText))?;
        let reader = Reader::new(file, text.strip_prefix('\u{feff}').unwrap_or(text), Some(kind));
        Reader { by_header: Some(column.unwrap_or_default()), ..reader }.read()
    }

    /// Returns the column `name` as a function of wavelength; `None` if there is no such column.
    #[must_use]
    pub fn column(&self, name: &str) -> Option<Tabulated> {
        let at = self.columns.iter().position(|c| c == name)?;
        Some(self.column_at(at))
    }

    /// Returns column `index` (from 0, without the wavelengths) as a function of wavelength.
    ///
    /// # Panics
    /// If there is no such column.
    #[must_use]
    pub fn column_at(&self, index: usize) -> Tabulated {
        Tabulated::from_checked(
            Arc::clone(&self.wavelengths_nm),
            Arc::clone(&self.values[index]),
            TableInterpretation {
                outside: self.meta.outside.unwrap_or(self.kind.outside()),
                scale: self.meta.scale(),
                interpolation: self.meta.interpolation,
                // The polynomial may dip below 0 between two small values; matter and detectors do not.
                at_least_zero: !self.kind.may_be_negative() && self.meta.scale() == Scale::Linear,
            },
        )
    }
}

fn whole(file: &str, cause: TableFault) -> TableError {
    let text = Arc::new(SourceFile::new(file, ""));
    let separator = Separator::Comma;
    let place = TablePosition { file: file.into(), row: 0, column: 0, column_name: String::new(), text, separator };
    TableError { place: Box::new(place), cause }
}

struct Reader<'a> {
    file: &'a str,
    text: &'a str,
    kind: Option<Kind>,
    /// The column whose name gives the kind; all columns if it is empty; `None` to ignore the header.
    by_header: Option<&'a str>,
    /// Scale of the values of a table without front matter.
    scale: Scale,
    /// Whether the table is in the format of the bundled ones.
    strict: bool,
    separator: Separator,
    header: Vec<String>,
    notes: Vec<&'static str>,
}

impl<'a> Reader<'a> {
    fn new(file: &'a str, text: &'a str, kind: Option<Kind>) -> Self {
        let strict = text.lines().next().is_some_and(|l| key_value(l).is_some_and(|(k, _)| k == "spectra"));
        let separator = Separator::Comma;
        Self {
            file,
            text,
            kind,
            by_header: None,
            scale: Scale::Linear,
            strict,
            separator,
            header: Vec::new(),
            notes: Vec::new(),
        }
    }

    fn fault(&self, row: usize, column: usize, cause: TableFault) -> TableError {
        let name = column.checked_sub(1).and_then(|i| self.header.get(i)).cloned().unwrap_or_default();
        let text = Arc::new(SourceFile::new(self.file, self.text));
        let separator = self.separator;
        let place = TablePosition { file: self.file.into(), row, column, column_name: name, text, separator };
        TableError { place: Box::new(place), cause }
    }

    /// Lines that are neither empty nor comments, with their numbers from 1.
    fn rows(&self) -> impl Iterator<Item = (usize, &'a str)> + use<'a> {
        let lines = self.text.lines().enumerate().map(|(i, line)| (i + 1, line.trim()));
        lines.filter(|(_, line)| !line.is_empty() && !line.starts_with('#'))
    }

    fn read(mut self) -> Result<Table, TableError> {
        let mut meta = Meta::default();
        // Any file may state `outside`: nothing else about the continuation is in the numbers.
        let is_meant = |line: &str| {
            line.starts_with('#') && (self.strict || key_value(line).is_some_and(|(key, _)| key == "outside"))
        };
        let comments: Vec<(usize, &str)> =
            self.text.lines().map(str::trim).enumerate().filter(|(_, line)| is_meant(line)).collect();
        for (i, line) in comments {
            self.front_matter(&mut meta, i + 1, line)?;
        }
        if !self.strict
            && let Some((_, row)) = self.rows().find(|(_, row)| row.starts_with(is_of_number))
        {
            // A row with one field does not show what separates several.
            let single = Separator::of(row).fields(row).len() < 2;
            let header = self.rows().map(|(_, line)| line).next().filter(|_| single);
            self.separator = Separator::of(header.unwrap_or(row));
        }
        let mut rows = self.rows().peekable();
        let Some(&(first, line)) = rows.peek() else { return Err(self.fault(0, 0, TableFault::Empty)) };
        if self.strict || !line.starts_with(is_of_number) {
            self.read_header(first, line)?;
            rows.next();
        } else {
            self.name_columns(first, self.separator.fields(line).len())?;
        }
        if !self.strict && self.scale == Scale::Log10 {
            meta.unit = Some("log10".to_owned());
        }
        let kind = meta
            .kind
            .or_else(|| self.kind_from_header())
            .or(self.kind)
            .ok_or_else(|| self.fault(first, 0, TableFault::NoKind))?;
        let mut values: Vec<Vec<f64>> = vec![Vec::new(); self.header.len() - 1];
        let (mut numbers, mut wavelengths): (Vec<usize>, Vec<f64>) = (Vec::new(), Vec::new());
        for (row, line) in rows {
            if wavelengths.len() == MAX_ROWS {
                return Err(self.fault(row, 0, TableFault::TooManyRows));
            }
            wavelengths.push(self.read_row(row, line, kind, meta.scale(), &mut values)?);
            numbers.push(row);
        }
        let (Some(&begin), Some(&end)) = (wavelengths.first(), wavelengths.last()) else {
            return Err(self.fault(0, 0, TableFault::Empty));
        };
        // If a table falls except for one misplaced row, the error names that row, not every other one.
        let falls = wavelengths.windows(2).filter(|pair| pair[0] > pair[1]).count();
        if 2 * falls + 1 > wavelengths.len() && !self.strict {
            self.notes.push("falling wavelengths");
            numbers.reverse();
            wavelengths.reverse();
            values.iter_mut().for_each(|column| column.reverse());
        }
        for i in 1..wavelengths.len() {
            let (before, found) = (wavelengths[i - 1], wavelengths[i]);
            if found <= before {
                return Err(self.fault(numbers[i], 1, TableFault::OutOfOrder { before, found }));
            }
        }
        if begin.max(end) < SHORTEST_LIGHT_NM {
            let Some((um, nm)) = Unit::find("um").zip(Unit::find("nm")).filter(|_| !self.strict) else {
                return Err(self.fault(numbers[0], 1, TableFault::NoLight(begin)));
            };
            self.notes.push("wavelengths in micrometers");
            wavelengths.iter_mut().for_each(|w| *w = um.convert(*w, nm));
        }
        if meta.interpolation == Interpolation::Sprague && !sprague::applies(&wavelengths) {
            return Err(self.fault(0, 0, TableFault::Sprague));
        }
        Ok(Table {
            file: self.file.into(),
            kind,
            columns: self.header.split_off(1),
            wavelengths_nm: wavelengths.into(),
            notes: self.notes,
            values: values.into_iter().map(Into::into).collect(),
            meta,
        })
    }

    fn front_matter(&self, meta: &mut Meta, row: usize, line: &str) -> Result<(), TableError> {
        let (key, value) = key_value(line).ok_or_else(|| self.fault(row, 0, TableFault::NotKeyValue))?;
        meta.set(key, value).map_err(|wanted| {
            let cause = match wanted {
                Some(wanted) => TableFault::FrontMatter { key: key.into(), wanted, found: value.into() },
                None => TableFault::UnknownKey(key.into()),
            };
            self.fault(row, 0, cause)
        })
    }

    /// Returns the kind that the names of columns suggest, if the header is to be used and they agree.
    fn kind_from_header(&self) -> Option<Kind> {
        let column = normalized(self.by_header?);
        let asked = |name: &&String| column.is_empty() || normalized(name) == column;
        let mut said = self.header[1..].iter().filter(asked).filter_map(|name| Kind::of_header(name));
        let kind = said.next()?;
        said.all(|other| other == kind).then_some(kind)
    }

    fn read_header(&mut self, row: usize, line: &str) -> Result<(), TableError> {
        let header: Vec<&str> = self.separator.fields(line).into_iter().map(bare).collect();
        let first = header[0].to_lowercase();
        let of_wavelengths = !self.strict && WAVELENGTH_WORDS.iter().any(|word| first.contains(word));
        if self.separator == Separator::Blanks && of_wavelengths {
            // Spaces also occur within names: `Wavelength [nm]   Power [W]`.
            let next = self.rows().find(|(_, line)| line.starts_with(is_of_number));
            let fields = next.map_or(header.len(), |(_, line)| self.separator.fields(line).len());
            if fields != header.len() {
                return self.name_columns(row, fields);
            }
        }
        if !(header[0] == "wavelength_nm" || of_wavelengths) || header.len() < 2 {
            return Err(self.fault(row, 1, TableFault::Header(shorten(line))));
        }
        if header.len() - 1 > MAX_COLUMNS {
            return Err(self.fault(row, MAX_COLUMNS + 2, TableFault::TooManyColumns));
        }
        for (i, name) in header.iter().enumerate() {
            if name.is_empty() || header[..i].contains(name) {
                return Err(self.fault(row, i + 1, TableFault::ColumnName(shorten(name))));
            }
        }
        self.header = header.into_iter().map(str::to_owned).collect();
        Ok(())
    }

    /// Assigns names to columns that have none: `value`, or their numbers if there are several.
    fn name_columns(&mut self, row: usize, fields: usize) -> Result<(), TableError> {
        if fields < 2 {
            return Err(self.fault(row, 0, TableFault::FieldCount { found: fields, expected: 2 }));
        }
        if fields - 1 > MAX_COLUMNS {
            return Err(self.fault(row, MAX_COLUMNS + 2, TableFault::TooManyColumns));
        }
        self.notes.push("no column names");
        let names = (1..fields).map(|i| if fields == 2 { "value".to_owned() } else { i.to_string() });
        self.header = std::iter::once("wavelength_nm".to_owned()).chain(names).collect();
        Ok(())
    }

    /// Appends the values of a row to those of their columns, and returns its wavelength as written.
    fn read_row(
        &self,
        row: usize,
        line: &str,
        kind: Kind,
        scale: Scale,
        values: &mut [Vec<f64>],
    ) -> Result<f64, TableError> {
        let fields = self.separator.fields(line);
        if fields.len() != self.header.len() {
            let cause = TableFault::FieldCount { found: fields.len(), expected: self.header.len() };
            return Err(self.fault(row, fields.len().min(self.header.len()), cause));
        }
        let read = |i: usize| {
            let has_decimal_comma = self.separator != Separator::Comma && fields[i].contains(',');
            if has_decimal_comma { number(&fields[i].replacen(',', ".", 1)) } else { number(fields[i]) }
        };
        let wavelength = read(0).map_err(|cause| self.fault(row, 1, cause))?;
        if wavelength <= 0.0 {
            return Err(self.fault(row, 1, TableFault::Wavelength(wavelength)));
        }
        for i in 1..fields.len() {
            let value = read(i).and_then(|value| check_value(value, kind, scale).map(|()| value));
            values[i - 1].push(value.map_err(|cause| self.fault(row, i + 1, cause))?);
        }
        Ok(wavelength)
    }
}

/// Returns a field without surrounding spaces and quotes.
fn bare(field: &str) -> &str {
    field.trim().trim_matches('"').trim()
}

fn key_value(line: &str) -> Option<(&str, &str)> {
    let (key, value) = line.trim().strip_prefix('#')?.split_once(':')?;
    Some((key.trim(), value.trim()))
}

/// Returns the first 40 characters, for a message.
fn shorten(text: &str) -> String {
    text.chars().take(40).collect()
}

fn number(field: &str) -> Result<f64, TableFault> {
    let field = bare(field);
    let value: f64 = field.parse().map_err(|_| TableFault::NotANumber(shorten(field)))?;
    if value.is_finite() { Ok(value) } else { Err(TableFault::NotFinite(shorten(field))) }
}

fn check_value(value: f64, kind: Kind, scale: Scale) -> Result<(), TableFault> {
    // Sensitivities in cm^2/erg or m^2/J span some ten decades; a percentage or a wavelength in this
    // column does not fit.
    const LOG10_BOUND: f64 = 20.0;
    if scale == Scale::Log10 {
        return if value.abs() <= LOG10_BOUND { Ok(()) } else { Err(TableFault::Logarithm(value)) };
    }
    if value < 0.0 && !kind.may_be_negative() {
        return Err(TableFault::Negative { kind, value });
    }
    match kind.bound() {
        Some(bound) if value > bound => Err(TableFault::AboveBound { value, bound }),
        _ => Ok(()),
    }
}
