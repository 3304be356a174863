//! What can be wrong with a spectrum that is not read from a file.

use crate::table::TableError;
use spectra_core::params::{Fault, Faults};

/// A spectrum that cannot be.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SpectrumError {
    /// A parameter outside of its range.
    #[error("{what} must be {wanted}, not {value}")]
    OutOfRange {
        /// The parameter, with its unit.
        what: &'static str,
        /// What it may be.
        wanted: &'static str,
        /// What it was.
        value: f64,
    },
    /// Light that a scale refers to is absent: no luminance, or no power.
    #[error("the spectrum has no {0} to scale")]
    NothingToScale(&'static str),
    /// A name that nothing bears.
    #[error("no spectrum is called `{name}`{}", near(.candidates))]
    Unknown {
        /// The name asked for.
        name: String,
        /// Names that resemble it, best first.
        candidates: Vec<String>,
    },
    /// An inline spectrum such as `gaussian:550,20` with wrong arguments.
    #[error("`{text}` is not understood: {wanted}")]
    Inline {
        /// What was written.
        text: String,
        /// How to write it.
        wanted: &'static str,
    },
    /// A file of several spectra where one is wanted.
    #[error("`{name}` holds {}; write `{name}#{}`", .columns.join(", "), .columns[0])]
    Ambiguous {
        /// The file or bundled name.
        name: String,
        /// Its columns.
        columns: Vec<String>,
    },
    /// A column that the file does not hold.
    #[error("`{name}` has no column `{column}`; it has {}", .columns.join(", "))]
    NoColumn {
        /// The file or bundled name.
        name: String,
        /// The column asked for.
        column: String,
        /// Its columns.
        columns: Vec<String>,
    },
    /// A spectrum of one kind where another is wanted: a light as a filter.
    #[error("`{name}` is of kind {found}, but {wanted} is expected here")]
    WrongKind {
        /// The name asked for.
        name: String,
        /// Its kind.
        found: &'static str,
        /// The kind wanted.
        wanted: &'static str,
    },
    /// Two spectra that cannot be multiplied, or added: light and light, light and a filter.
    #[error("{left} and {right} have no {operation}")]
    NotTogether {
        /// Kind of the first.
        left: &'static str,
        /// Kind of the second.
        right: &'static str,
        /// `product` or `sum`.
        operation: &'static str,
    },
    /// A file that names itself, or spectra in such numbers that nobody wrote them.
    #[error("`{0}` refers to too many spectra, or to itself")]
    TooMany(String),
    /// A YAML file with faults, each with its place.
    #[error("{0}")]
    Document(Faults),
    /// A file that cannot be read.
    #[error("{name}: {cause}")]
    Io {
        /// The file.
        name: String,
        /// The system's word.
        cause: String,
    },
    /// A table with a fault.
    #[error(transparent)]
    Table(#[from] TableError),
}

impl SpectrumError {
    /// The same as faults: what is wrong within a file, there; everything else as `here` places a message, with what to
    /// do about it.
    #[must_use]
    pub fn faults(&self, here: impl FnOnce(String) -> Fault) -> Faults {
        match self {
            Self::Document(faults) => faults.clone(),
            Self::Table(error) => error.fault().into(),
            Self::Unknown { name, candidates } => {
                let fault = here(format!("no spectrum is called `{name}`"));
                fault.hint(hint_for_unknown(name, candidates)).into()
            }
            Self::Inline { text, wanted } => here(format!("`{text}` is not understood")).hint(*wanted).into(),
            Self::Ambiguous { name, columns } => {
                let fault = here(format!("`{name}` holds {} spectra, but one is expected", columns.len()));
                let first = columns.first().map_or("name", String::as_str);
                let all = if name.contains('.') { String::new() } else { format!("spectra list spectrum {name}") };
                fault
                    .hint(format!("pick one, such as `{name}#{first}`: {}", spectra_core::names::listed(columns, &all)))
                    .into()
            }
            Self::NoColumn { name, column, columns } => {
                let fault = here(format!("`{name}` has no column `{column}`"));
                fault.hint(format!("its columns: {}", columns.join(", "))).into()
            }
            Self::WrongKind { name, found, wanted } => {
                let fault = here(format!("`{name}` is of kind {found}, but {wanted} is expected here"));
                fault.hint(format!("`spectra list spectrum` shows what is of kind {wanted}")).into()
            }
            Self::NotTogether { .. } => here(self.to_string())
                .hint("light times filters, or like plus like: `D65 * wratten-15`, `A + line:e`")
                .into(),
            Self::Io { name, cause } => here(format!("cannot read `{name}`: {cause}")).into(),
            Self::TooMany(_) => here(self.to_string()).hint("a spectrum cannot be a part of itself").into(),
            Self::NothingToScale(_) => here(self.to_string()).hint("light that is somewhere more than 0").into(),
            Self::OutOfRange { wanted, .. } => here(self.to_string()).hint(*wanted).into(),
        }
    }
}

/// What a person may have meant by a name that nothing bears.
fn hint_for_unknown(name: &str, candidates: &[String]) -> String {
    match candidates {
        [one] => format!("did you mean `{one}`?"),
        [first, others @ ..] => format!("did you mean `{first}`? Similar: {}", others.join(", ")),
        [] if name.contains(['*', '+']) => {
            "a sum or a product has spaces around its signs and a spectrum behind each: `0.5 * D65 + line:e`".to_owned()
        }
        [] if name.contains(['/', '\\']) || name.contains('.') => {
            "a file is looked for beside the one that names it, then among the bundled ones".to_owned()
        }
        [] => "`spectra list spectrum` shows all names; or a file such as `lamp.csv`, or `blackbody:3200`".to_owned(),
    }
}

fn near(candidates: &[String]) -> String {
    if candidates.is_empty() { String::new() } else { format!("; near: {}", candidates.join(", ")) }
}

/// `value` if `test` holds and it is finite.
pub(crate) fn check(
    what: &'static str,
    wanted: &'static str,
    value: f64,
    test: impl Fn(f64) -> bool,
) -> Result<f64, SpectrumError> {
    if value.is_finite() && test(value) { Ok(value) } else { Err(SpectrumError::OutOfRange { what, wanted, value }) }
}
