//! Reads the CSV files in which spectra are kept.
//!
//! Front matter of `# key: value` lines (see [`Meta`]), a header row `wavelength_nm,<columns>`, then one row a
//! wavelength, in increasing order.
//!
//! Without `# spectra: 1` on the first line the table is read as people have it: lines that begin with `#` are plain
//! comments, the reader is told the kind, and [`Table::notes`] says what was made of the rest. Columns are separated by
//! commas, semicolons, tabs or blanks (all but the first with decimal commas, too), the header may be missing, wavelengths
//! may be in micrometers, and may fall.
//!
//! ```
//! use spectra_spectrum::table::Table;
//! use spectra_spectrum::Kind;
//!
//! let fault = Table::parse("mine.csv", "wavelength_nm,red\n400,0.5\n410,80\n", Some(Kind::Sensitivity)).unwrap_err();
//! assert_eq!(fault.to_string(), "mine.csv: row 3, column 2 (red): 80 is more than 2: given as percent? divide by 100");
//! ```

use std::fmt;
use std::sync::Arc;

use spectra_core::params::{Fault, SourceFile, Span, Unit};

use crate::meta::{Interpolation, Kind, Meta, Scale};
use crate::sprague;
use crate::tabulated::{Reading, Tabulated};

/// Most rows that are read.
pub const MAX_ROWS: usize = 100_000;
/// Most columns that are read.
pub const MAX_COLUMNS: usize = 256;
/// Largest file that is read, bytes.
pub const MAX_BYTES: u64 = 32 << 20;
/// A table that ends below this was not given in nanometers, nm.
const SHORTEST_NM: f64 = 20.0;
/// Words of which one stands in the name of a column of wavelengths.
const WAVELENGTH_WORDS: [&str; 8] = ["wave", "lambda", "\u{3bb}", "nm", "nano", "um", "\u{b5}m", "micro"];

/// What is wrong with a table, and where.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{place}: {cause}")]
pub struct TableError {
    /// Where it is.
    pub place: Box<Place>,
    /// What is wrong.
    pub cause: TableFault,
}

impl TableError {
    /// The same as a fault of the table's file, at its line and field.
    #[must_use]
    pub fn fault(&self) -> Fault {
        let fault = Fault::new(self.cause.to_string()).path(self.place.column_name.clone()).hint(self.cause.hint());
        if self.cause == TableFault::NotText {
            return Fault { message: self.to_string(), ..fault };
        }
        // Of a row with a field too many or too few the row is shown.
        let row = matches!(self.cause, TableFault::FieldCount { .. } | TableFault::Header(_));
        let place = Place { column: if row { 0 } else { self.place.column }, ..(*self.place).clone() };
        let span = if place.row == 0 { Span::default() } else { place.span() };
        fault.at(Arc::clone(&self.place.text), span)
    }
}

/// A place in a table. As text: `mine.csv: row 3, column 2 (red)`.
#[derive(Clone, Debug, PartialEq)]
pub struct Place {
    /// The file.
    pub file: String,
    /// Line of the file, from 1; 0 for the file as a whole.
    pub row: usize,
    /// Field of the row, from 1; 0 for the row as a whole.
    pub column: usize,
    /// The column's name in the header, empty where there is none.
    pub column_name: String,
    /// The whole text.
    pub text: Arc<SourceFile>,
    /// What stands between its fields.
    pub separator: Separator,
}

/// What stands between the fields of a row.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Separator {
    /// `,`: numbers have a decimal point.
    #[default]
    Comma,
    /// `;`.
    Semicolon,
    /// A tab.
    Tab,
    /// One blank or more.
    Blanks,
}

impl Separator {
    /// Its name.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Comma => "commas",
            Self::Semicolon => "semicolons",
            Self::Tab => "tabs",
            Self::Blanks => "blanks",
        }
    }

    /// That of a row of numbers.
    fn of(row: &str) -> Self {
        let row = row.trim();
        let has_decimal_comma =
            |word: &str| word.split(',').count() <= 2 && word.split(',').all(|part| part.starts_with(is_of_number));
        let mut words = row.split_whitespace();
        match () {
            () if row.contains(';') => Self::Semicolon,
            () if row.contains('\t') => Self::Tab,
            // `400 0,5`, but not `400, 0.5`.
            () if row.contains(',') && words.clone().count() > 1 && words.all(has_decimal_comma) => Self::Blanks,
            () if row.contains(',') => Self::Comma,
            () => Self::Blanks,
        }
    }

    /// The fields of a row.
    fn fields(self, row: &str) -> Vec<&str> {
        match self {
            Self::Comma => row.split(',').collect(),
            Self::Semicolon => row.split(';').collect(),
            Self::Tab => row.split('\t').collect(),
            Self::Blanks => row.split_whitespace().collect(),
        }
    }
}

fn is_of_number(c: char) -> bool {
    c.is_ascii_digit() || matches!(c, '+' | '-' | '.')
}

impl Place {
    /// Where the field is written, or the row.
    #[must_use]
    pub fn span(&self) -> Span {
        let text = &self.text.text;
        let line = text.split_inclusive('\n').nth(self.row.saturating_sub(1)).unwrap_or_default();
        let start: usize = text.split_inclusive('\n').take(self.row.saturating_sub(1)).map(str::len).sum();
        let trimmed = line.trim_end();
        let (mut from, mut to) = (0, trimmed.len());
        let field = self.column.checked_sub(1).and_then(|i| self.separator.fields(trimmed).get(i).copied());
        if let Some(field) = field {
            from = field.as_ptr() as usize - trimmed.as_ptr() as usize;
            to = from + field.trim_end().len();
            from += field.len() - field.trim_start().len();
        }
        let to = to.max(from);
        Span { line: self.row, column: trimmed[..from].chars().count() + 1, offset: start + from, len: to - from }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { file, row, column, column_name, .. } = self;
        match (row, column, column_name.as_str()) {
            (0, ..) => f.write_str(file),
            (_, 0, _) => write!(f, "{file}: row {row}"),
            (.., "") => write!(f, "{file}: row {row}, column {column}"),
            (.., name) => write!(f, "{file}: row {row}, column {column} ({name})"),
        }
    }
}

/// Causes of a [`TableError`].
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TableFault {
    /// No row of numbers.
    #[error("holds no data")]
    Empty,
    /// Not text.
    #[error("is not UTF-8 text")]
    NotText,
    /// More rows than [`MAX_ROWS`].
    #[error("more than {MAX_ROWS} rows")]
    TooManyRows,
    /// More columns than [`MAX_COLUMNS`].
    #[error("more than {MAX_COLUMNS} columns")]
    TooManyColumns,
    /// A key of the front matter that has no meaning.
    #[error("unknown key `{0}`; known are {known}", known = Meta::KEYS.join(", "))]
    UnknownKey(String),
    /// A value of the front matter that has no meaning.
    #[error("`{key}` should be {wanted}, not `{found}`")]
    FrontMatter {
        /// The key.
        key: String,
        /// What it should be.
        wanted: &'static str,
        /// What it is.
        found: String,
    },
    /// A comment line in the front matter that is no `key: value`.
    #[error("front matter is written as `# key: value`")]
    NotKeyValue,
    /// The kind is stated nowhere.
    #[error("the kind is not stated; write `# spectra: 1` and `# kind: emission` (or another) above the header")]
    NoKind,
    /// The first row of the table is no header.
    #[error("a header such as `wavelength_nm,power` is expected here, not `{0}`")]
    Header(String),
    /// A column name that is empty or appears twice.
    #[error("column name `{0}` is empty or appears twice")]
    ColumnName(String),
    /// A row with too few or too many fields.
    #[error("number of fields: {found}, but the header has {expected}")]
    FieldCount {
        /// Fields in this row.
        found: usize,
        /// Fields in the header.
        expected: usize,
    },
    /// A field that is no number.
    #[error("`{0}` is not a number")]
    NotANumber(String),
    /// NaN or infinity.
    #[error("`{0}` is not a finite number")]
    NotFinite(String),
    /// A wavelength that is not positive.
    #[error("a wavelength is a positive number of nanometres, not {0}")]
    Wavelength(f64),
    /// A table whose wavelengths are all below any light.
    #[error("{0} nm is not a wavelength of light")]
    NoLight(f64),
    /// A wavelength that is not larger than the one above it.
    #[error("{found} nm does not come after {before} nm: wavelengths must increase")]
    OutOfOrder {
        /// The wavelength of the row before.
        before: f64,
        /// The wavelength of this row.
        found: f64,
    },
    /// A negative value where none can be.
    #[error("{kind} cannot be negative: {value}")]
    Negative {
        /// Kind of the table.
        kind: Kind,
        /// The value.
        value: f64,
    },
    /// A value too large for its kind.
    #[error("{value} is more than {bound}: given as percent? divide by 100")]
    AboveBound {
        /// The value.
        value: f64,
        /// The largest that is believed.
        bound: f64,
    },
    /// Sprague's interpolation of points that it is not made for.
    #[error("interpolation: sprague wants at least six equally spaced wavelengths")]
    Sprague,
    /// A logarithm to base 10 that is no plausible one.
    #[error("{0} is implausible as a logarithm to base 10")]
    Logarithm(f64),
}

impl TableFault {
    /// What to do about it.
    #[must_use]
    pub fn hint(&self) -> &'static str {
        match self {
            Self::Empty => "a header such as `wavelength_nm,power`, then one row per wavelength, such as `400,0.5`",
            Self::NotText => "save it as CSV in UTF-8",
            Self::TooManyRows | Self::TooManyColumns => "is this a table of a spectrum? Thin it out, or split it",
            Self::UnknownKey(_) => "keep other remarks under `# note: ...`",
            Self::FrontMatter { .. } | Self::NotKeyValue => "`# key: value`, as in the files under spectra/",
            Self::NoKind => "or name it where one kind is wanted",
            Self::Header(_) => "call the first column `wavelength_nm`, or leave the header out; wavelengths are in nm",
            Self::ColumnName(_) => "each column has a name of its own",
            Self::FieldCount { found, expected } if found > expected => {
                "write a decimal point in numbers, or separate the columns with semicolons"
            }
            Self::FieldCount { .. } => "each row has a value for each column",
            Self::NotANumber(_) | Self::NotFinite(_) => "write a number with a decimal point, such as 0.5 or 1e-3",
            Self::Wavelength(_) => "such as 550",
            Self::NoLight(_) => "given in micrometers? Multiply by 1000",
            Self::OutOfOrder { .. } => "sort the rows by wavelength, each wavelength once",
            Self::Negative { .. } => "write 0 where nothing was measured",
            Self::AboveBound { .. } => "values are fractions of 1, not percentages",
            Self::Sprague => "leave `interpolation` out, or space the wavelengths equally",
            Self::Logarithm(_) => "is the column linear? Then write `# unit: 1`",
        }
    }
}

/// A table as a file holds it.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// The file it came from.
    pub file: String,
    /// Its front matter.
    pub meta: Meta,
    /// What its columns are.
    pub kind: Kind,
    /// Names of the columns after the wavelength.
    pub columns: Vec<String>,
    /// Wavelengths in air, nm, increasing.
    pub wavelengths_nm: Arc<[f64]>,
    /// What was made of a table that is not written as the bundled ones are: `no header`, `wavelengths in micrometers`.
    pub notes: Vec<&'static str>,
    /// Values by column, then by row, in the unit of the front matter.
    pub values: Vec<Arc<[f64]>>,
}

impl Table {
    /// Reads `bytes` of a file; see [`Table::parse`].
    ///
    /// # Errors
    /// [`TableError`], also when they are not UTF-8.
    pub fn parse_bytes(file: &str, bytes: &[u8], kind: Option<Kind>) -> Result<Self, TableError> {
        let text = std::str::from_utf8(bytes).map_err(|_| whole(file, TableFault::NotText))?;
        Self::parse(file, text, kind)
    }

    /// Reads a table. `kind` is taken where the file does not state one; `file` is for messages.
    ///
    /// # Errors
    /// [`TableError`] with row and column: no data, more than [`MAX_ROWS`], a bad front matter or header, a wrong
    /// number of fields, no number, NaN, wavelengths that do not increase, negative power, percentages.
    pub fn parse(file: &str, text: &str, kind: Option<Kind>) -> Result<Self, TableError> {
        Reader::new(file, text.strip_prefix('\u{feff}').unwrap_or(text), kind).read()
    }

    /// The column `name`, ready to be evaluated.
    #[must_use]
    pub fn column(&self, name: &str) -> Option<Tabulated> {
        let at = self.columns.iter().position(|c| c == name)?;
        Some(self.column_at(at))
    }

    /// Column `index` (from 0), ready to be evaluated.
    ///
    /// # Panics
    /// If there is no such column.
    #[must_use]
    pub fn column_at(&self, index: usize) -> Tabulated {
        Tabulated::from_checked(
            Arc::clone(&self.wavelengths_nm),
            Arc::clone(&self.values[index]),
            Reading {
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
    let place = Place { file: file.into(), row: 0, column: 0, column_name: String::new(), text, separator };
    TableError { place: Box::new(place), cause }
}

struct Reader<'a> {
    file: &'a str,
    text: &'a str,
    kind: Option<Kind>,
    /// Whether the table is written as the bundled ones are.
    strict: bool,
    separator: Separator,
    header: Vec<String>,
    notes: Vec<&'static str>,
}

impl<'a> Reader<'a> {
    fn new(file: &'a str, text: &'a str, kind: Option<Kind>) -> Self {
        let strict = text.lines().next().is_some_and(|l| key_value(l).is_some_and(|(k, _)| k == "spectra"));
        let separator = Separator::Comma;
        Self { file, text, kind, strict, separator, header: Vec::new(), notes: Vec::new() }
    }

    fn fault(&self, row: usize, column: usize, cause: TableFault) -> TableError {
        let name = column.checked_sub(1).and_then(|i| self.header.get(i)).cloned().unwrap_or_default();
        let text = Arc::new(SourceFile::new(self.file, self.text));
        let separator = self.separator;
        let place = Place { file: self.file.into(), row, column, column_name: name, text, separator };
        TableError { place: Box::new(place), cause }
    }

    /// Lines with something on them that is no comment, by their number from 1.
    fn rows(&self) -> impl Iterator<Item = (usize, &'a str)> + use<'a> {
        let lines = self.text.lines().enumerate().map(|(i, line)| (i + 1, line.trim()));
        lines.filter(|(_, line)| !line.is_empty() && !line.starts_with('#'))
    }

    fn read(mut self) -> Result<Table, TableError> {
        let mut meta = Meta::default();
        // What lies beyond the rows may be said in any file: nothing else about it is in the numbers.
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
            // A row with one field says nothing of what separates several.
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
        let kind = meta.kind.or(self.kind).ok_or_else(|| self.fault(first, 0, TableFault::NoKind))?;
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
        // A table that falls, but for a row that stands wrongly: that row is told, not every other one.
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
        if begin.max(end) < SHORTEST_NM {
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

    fn read_header(&mut self, row: usize, line: &str) -> Result<(), TableError> {
        let header: Vec<&str> = self.separator.fields(line).into_iter().map(bare).collect();
        let first = header[0].to_lowercase();
        let of_wavelengths = !self.strict && WAVELENGTH_WORDS.iter().any(|word| first.contains(word));
        if self.separator == Separator::Blanks && of_wavelengths {
            // Blanks also stand within names: `Wavelength [nm]   Power [W]`.
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

    /// Names of columns that have none: `value`, or their numbers where there are several.
    fn name_columns(&mut self, row: usize, fields: usize) -> Result<(), TableError> {
        if fields < 2 {
            return Err(self.fault(row, 0, TableFault::FieldCount { found: fields, expected: 2 }));
        }
        if fields - 1 > MAX_COLUMNS {
            return Err(self.fault(row, MAX_COLUMNS + 2, TableFault::TooManyColumns));
        }
        self.notes.push("no names of columns");
        let names = (1..fields).map(|i| if fields == 2 { "value".to_owned() } else { i.to_string() });
        self.header = std::iter::once("wavelength_nm".to_owned()).chain(names).collect();
        Ok(())
    }

    /// Puts the values of a row behind those of their columns, and gives its wavelength as it is written.
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

/// A field without its blanks and quotes.
fn bare(field: &str) -> &str {
    field.trim().trim_matches('"').trim()
}

fn key_value(line: &str) -> Option<(&str, &str)> {
    let (key, value) = line.trim().strip_prefix('#')?.split_once(':')?;
    Some((key.trim(), value.trim()))
}

/// The first 40 characters, for a message.
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
