//! Errors of spectra, whether written inline or read from files.

use crate::table_error::TableError;
use spectra_core::params::{Fault, Faults};
use spectra_core::quantity::NotLight;

/// Error in the definition or use of a spectrum.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SpectrumError {
    /// A parameter is outside of its range.
    #[error("{what} must be {wanted}, not {}", shown(*.value))]
    OutOfRange {
        /// Name of the parameter, with its unit.
        what: &'static str,
        /// Description of allowed values.
        wanted: &'static str,
        /// Value of the parameter.
        value: f64,
    },
    /// An expression cannot be read: a parenthesis is not closed, or a sign has no value after it.
    #[error("{message} at character {} of `{text}`", .at + 1)]
    Expression {
        /// Expression that cannot be read.
        text: String,
        /// Position of the error in characters, from 0.
        at: usize,
        /// Message of the error.
        message: String,
        /// Hint on what to write.
        hint: String,
    },
    /// An error in a part of an expression.
    #[error("{cause}")]
    Within {
        /// Expression that contains the part.
        text: String,
        /// Character of the expression at which the part begins, from 0.
        at: usize,
        /// Number of characters of the part.
        len: usize,
        /// Error in the part.
        cause: Box<SpectrumError>,
    },
    /// A spectrum is negative where it cannot be, such as a difference of two.
    #[error("the result is {} at {at_nm} nm, but {kind} cannot be negative", shown(*.value))]
    Negative {
        /// Kind of the spectrum.
        kind: &'static str,
        /// Wavelength at which it is smallest, nm.
        at_nm: f64,
        /// Value at that wavelength.
        value: f64,
    },
    /// A spectrum has no value at some wavelength: a division by 0, or a root of a negative number.
    #[error("the result has no finite value at {at_nm} nm")]
    NotFinite {
        /// First wavelength without a finite value, nm.
        at_nm: f64,
    },
    /// The light has nothing that could be scaled: no luminance, power or peak.
    #[error("the spectrum has no {0} to scale")]
    NothingToScale(&'static str),
    /// No spectrum has this name.
    #[error("no spectrum is called `{name}`{}", near(.candidates))]
    Unknown {
        /// Name that was asked for.
        name: String,
        /// Similar names, in descending order of similarity.
        candidates: Vec<String>,
    },
    /// An inline spectrum such as `gaussian:550,20` has wrong arguments.
    #[error("`{text}` is not understood: {wanted}")]
    Inline {
        /// Text of the inline spectrum.
        text: String,
        /// Description of the correct form.
        wanted: &'static str,
    },
    /// A file with several spectra is given where one is expected.
    #[error("`{name}` holds {}; write `{name}#{}`", .columns.join(", "), .columns[0])]
    Ambiguous {
        /// File or bundled name that was given.
        name: String,
        /// Names of the file's columns.
        columns: Vec<String>,
    },
    /// The file does not have the requested column.
    #[error("`{name}` has no column `{column}`; it has {}", .columns.join(", "))]
    NoColumn {
        /// Name of the file, or bundled name.
        name: String,
        /// Column that was asked for.
        column: String,
        /// Names of the columns that the file has.
        columns: Vec<String>,
    },
    /// A spectrum of one kind is given where another is expected, such as a light as a filter.
    #[error("`{name}` is of kind {found}, but {wanted} is expected here")]
    WrongKind {
        /// Name of the given spectrum.
        name: String,
        /// Kind of the given spectrum.
        found: &'static str,
        /// Kind that is expected.
        wanted: &'static str,
    },
    /// Two spectra cannot be combined, such as the product of two lights or the sum of a light and a filter.
    #[error("{left} and {right} have no {operation}")]
    NotTogether {
        /// Kind of the first spectrum.
        left: &'static str,
        /// Kind of the second spectrum.
        right: &'static str,
        /// Name of the operation: `product`, `sum`, `difference`, `quotient` or `power`.
        operation: &'static str,
    },
    /// A file refers to itself, or to an unreasonable number of spectra.
    #[error("`{0}` refers to too many spectra, or to itself")]
    TooMany(String),
    /// A YAML file has faults, each with its place.
    #[error("{0}")]
    Document(Faults),
    /// A file cannot be read.
    #[error("{name}: {cause}")]
    Io {
        /// Name of the file.
        name: String,
        /// Error message of the operating system or of the loader.
        cause: String,
    },
    /// A wavelength is too short for light, for example because it was given in micrometers.
    #[error(transparent)]
    NotLight(#[from] NotLight),
    /// A table has an error.
    #[error(transparent)]
    Table(#[from] TableError),
}

impl SpectrumError {
    /// Converts the error to faults. An error within a file gets its place there; any other gets the place that `here` assigns
    /// to its message, and a hint.
    #[must_use]
    pub fn faults(&self, here: impl FnOnce(String) -> Fault) -> Faults {
        self.placed(Box::new(here))
    }

    fn placed(&self, here: Box<dyn FnOnce(String) -> Fault + '_>) -> Faults {
        match self {
            Self::Expression { text, at, message, hint } => {
                here(message.clone()).hint(hint.clone()).within(text, *at, 1).into()
            }
            Self::Within { text, at, len, cause } => {
                // An error in another file already has its place there.
                cause.placed(Box::new(|message| here(message).within(text, *at, *len)))
            }
            Self::Negative { .. } => here(self.to_string())
                .hint("subtract less: the result must not be negative anywhere")
                .into(),
            Self::NotFinite { .. } => here(self.to_string())
                .hint("a divisor must not be 0 anywhere from 350 to 830 nm; add a little to it, such as `A / (B + 0.001)`")
                .into(),
            Self::Document(faults) => faults.clone(),
            Self::NotLight(wrong) => here(wrong.to_string()).hint(wrong.hint()).into(),
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
            Self::NothingToScale(_) => here(self.to_string()).hint("use light that is above 0 somewhere").into(),
            Self::OutOfRange { wanted, .. } => here(self.to_string()).hint(*wanted).into(),
        }
    }
}

/// Returns a hint for an unknown name: what the writer may have meant.
fn hint_for_unknown(name: &str, candidates: &[String]) -> String {
    if let Some(hint) = crate::common_words::hint_for_word(name) {
        return hint;
    }
    match candidates {
        _ if name.contains(['*', '+', '(']) => {
            "put spaces around `+` and `*`, with a spectrum after each: `D65 + 5000 * line:e`".to_owned()
        }
        [one] => format!("did you mean `{one}`?"),
        [first, others @ ..] => format!("did you mean `{first}`? Similar: {}", others.join(", ")),
        [] if name.contains(['/', '\\']) || name.contains('.') => {
            "a file is looked up beside the one that names it, then among the bundled files".to_owned()
        }
        [] => "`spectra list spectrum` shows all names; or write a file such as `lamp.csv`, or `blackbody:3200`"
            .to_owned(),
    }
}

/// Formats a value for a message: as it is, or with a power of ten if it would have many digits.
fn shown(value: f64) -> String {
    let size = value.abs();
    if size == 0.0 || !size.is_finite() || (1e-4..1e15).contains(&size) {
        value.to_string()
    } else {
        format!("{value:e}")
    }
}

fn near(candidates: &[String]) -> String {
    if candidates.is_empty() { String::new() } else { format!("; near: {}", candidates.join(", ")) }
}

/// Returns `value` if it is finite and `test` holds.
pub(crate) fn check(
    what: &'static str,
    wanted: &'static str,
    value: f64,
    test: impl Fn(f64) -> bool,
) -> Result<f64, SpectrumError> {
    if value.is_finite() && test(value) { Ok(value) } else { Err(SpectrumError::OutOfRange { what, wanted, value }) }
}
