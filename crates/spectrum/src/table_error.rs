//! Errors of tables of spectra.

use std::fmt;
use std::sync::Arc;

use spectra_core::params::{Fault, SourceFile, Span};

use crate::meta::{Kind, Meta};
use crate::separator::Separator;

/// Largest number of rows that is read.
pub const MAX_ROWS: usize = 100_000;
/// Largest number of columns that is read.
pub const MAX_COLUMNS: usize = 256;

/// Error in a table, with its place.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{place}: {cause}")]
pub struct TableError {
    /// Place of the error.
    pub place: Box<TablePosition>,
    /// Cause of the error.
    pub cause: TableFault,
}

impl TableError {
    /// Converts the error to a fault that is placed at its line and field in the table's file.
    #[must_use]
    pub fn fault(&self) -> Fault {
        let fault = Fault::new(self.cause.to_string()).path(self.place.column_name.clone()).hint(self.cause.hint());
        if self.cause == TableFault::NotText {
            return Fault { message: self.to_string(), ..fault };
        }
        // For a row with too many or too few fields the whole row is shown.
        let row = matches!(self.cause, TableFault::FieldCount { .. } | TableFault::Header(_));
        let place = TablePosition { column: if row { 0 } else { self.place.column }, ..(*self.place).clone() };
        let span = if place.row == 0 { Span::default() } else { place.span() };
        fault.at(Arc::clone(&self.place.text), span)
    }
}

/// Place in a table. Displayed as `mine.csv: row 3, column 2 (red)`.
#[derive(Clone, Debug, PartialEq)]
pub struct TablePosition {
    /// Name of the file.
    pub file: String,
    /// Line of the file, from 1; 0 for the whole file.
    pub row: usize,
    /// Field of the row, from 1; 0 for the whole row.
    pub column: usize,
    /// Name of the column in the header; empty if there is none.
    pub column_name: String,
    /// Text of the whole file.
    pub text: Arc<SourceFile>,
    /// Separator between the fields.
    pub separator: Separator,
}

impl TablePosition {
    /// Returns the span of the field in the text, or the span of the row if no field is known.
    #[must_use]
    pub fn span(&self) -> Span {
        let text = &self.text.text;
        let line = text.lines().nth(self.row.saturating_sub(1)).unwrap_or_default().trim_end();
        let field = self.column.checked_sub(1).and_then(|i| self.separator.fields(line).get(i).copied());
        Span::of(field.map_or(line, |field| field.trim_start().trim_end()), text)
    }
}

impl fmt::Display for TablePosition {
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
    /// The table has no row of numbers.
    #[error("holds no data")]
    Empty,
    /// The file is not UTF-8 text.
    #[error("is not UTF-8 text")]
    NotText,
    /// The table has more rows than [`MAX_ROWS`].
    #[error("more than {MAX_ROWS} rows")]
    TooManyRows,
    /// The table has more columns than [`MAX_COLUMNS`].
    #[error("more than {MAX_COLUMNS} columns")]
    TooManyColumns,
    /// The front matter has a key that is not known.
    #[error("unknown key `{0}`; known keys: {known}", known = Meta::KEYS.join(", "))]
    UnknownKey(String),
    /// The front matter has a value that is not valid for its key.
    #[error("`{key}` should be {wanted}, not `{found}`")]
    FrontMatter {
        /// Key of the front matter.
        key: String,
        /// Description of valid values.
        wanted: &'static str,
        /// Value that was written.
        found: String,
    },
    /// A comment line in the front matter is not of the form `key: value`.
    #[error("front matter is written as `# key: value`")]
    NotKeyValue,
    /// The kind of the spectrum is stated nowhere.
    #[error("the kind is not stated; write `# spectra: 1` and `# kind: emission` (or another) above the header")]
    NoKind,
    /// The first row of the table is not a header.
    #[error("a header such as `wavelength_nm,power` is expected here, not `{0}`")]
    Header(String),
    /// A column name is empty or appears twice.
    #[error("column name `{0}` is empty or appears twice")]
    ColumnName(String),
    /// A row has too few or too many fields.
    #[error("fields in this row: {found}; fields in the header: {expected}")]
    FieldCount {
        /// Number of fields in this row.
        found: usize,
        /// Number of fields in the header.
        expected: usize,
    },
    /// A field is not a number.
    #[error("`{0}` is not a number")]
    NotANumber(String),
    /// A field is NaN or infinite.
    #[error("`{0}` is not a finite number")]
    NotFinite(String),
    /// A wavelength is not positive.
    #[error("a wavelength is a positive number of nanometers, not {0}")]
    Wavelength(f64),
    /// All wavelengths of the table are shorter than any light.
    #[error("{0} nm is not a wavelength of light")]
    NoLight(f64),
    /// A wavelength is not larger than the one before it.
    #[error("{found} nm does not come after {before} nm: wavelengths must increase")]
    OutOfOrder {
        /// Wavelength of the row before, nm.
        before: f64,
        /// Wavelength of this row, nm.
        found: f64,
    },
    /// A value is negative, which its kind does not allow.
    #[error("{kind} cannot be negative: {value}")]
    Negative {
        /// Kind of the table's spectra.
        kind: Kind,
        /// Value in the table.
        value: f64,
    },
    /// A value is too large for its kind.
    #[error("{value} is more than {bound}: given as percent? divide by 100")]
    AboveBound {
        /// Value that is too large.
        value: f64,
        /// Largest plausible value of this kind.
        bound: f64,
    },
    /// Sprague's interpolation was asked for, but the points do not suit it.
    #[error("`interpolation: sprague` needs at least six equally spaced wavelengths")]
    Sprague,
    /// A value is implausible as a logarithm to base 10.
    #[error("{0} is implausible as a logarithm to base 10")]
    Logarithm(f64),
}

impl TableFault {
    /// Returns a hint on how to correct the table.
    #[must_use]
    pub fn hint(&self) -> &'static str {
        match self {
            Self::Empty => "write a header like `wavelength_nm,power` and one row per wavelength, such as `400,0.5`",
            Self::NotText => "save it as CSV in UTF-8",
            Self::TooManyRows | Self::TooManyColumns => "is this a table of a spectrum? Thin it out, or split it",
            Self::UnknownKey(_) => "keep other remarks under `# note: ...`",
            Self::FrontMatter { .. } | Self::NotKeyValue => "write `# key: value`, as in the files under spectra/",
            Self::NoKind => "or name the file where a certain kind is expected",
            Self::Header(_) => "call the first column `wavelength_nm`, or leave the header out; wavelengths are in nm",
            Self::ColumnName(_) => "give each column its own name",
            Self::FieldCount { found, expected } if found > expected => {
                "write a decimal point in numbers, or separate the columns with semicolons"
            }
            Self::FieldCount { .. } => "give each row a value for each column",
            Self::NotANumber(_) | Self::NotFinite(_) => "write a number with a decimal point, such as 0.5 or 1e-3",
            Self::Wavelength(_) => "write a wavelength such as 550",
            Self::NoLight(_) => "given in micrometers? Multiply by 1000",
            Self::OutOfOrder { .. } => "sort the rows by wavelength, each wavelength once",
            Self::Negative { .. } => "write 0 where nothing was measured",
            Self::AboveBound { .. } => "values are fractions of 1, not percentages",
            Self::Sprague => "leave `interpolation` out, or space the wavelengths equally",
            Self::Logarithm(_) => "is the column linear? Then write `# unit: 1`",
        }
    }
}
