//! What can be wrong with a table.

use std::fmt;
use std::sync::Arc;

use spectra_core::params::{Fault, SourceFile, Span};

use crate::meta::{Kind, Meta};
use crate::separator::Separator;

/// Most rows that are read.
pub const MAX_ROWS: usize = 100_000;
/// Most columns that are read.
pub const MAX_COLUMNS: usize = 256;

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
