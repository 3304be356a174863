//! What can be wrong with a spectrum that is not read from a file.

use crate::table_error::TableError;
use spectra_core::params::{Fault, Faults};
use spectra_core::quantity::NotLight;

/// A spectrum that cannot be.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SpectrumError {
    /// A parameter outside of its range.
    #[error("{what} must be {wanted}, not {}", shown(*.value))]
    OutOfRange {
        /// The parameter, with its unit.
        what: &'static str,
        /// What it may be.
        wanted: &'static str,
        /// What it was.
        value: f64,
    },
    /// An expression that cannot be read: a parenthesis that is not closed, a sign without a value.
    #[error("{message} at character {} of `{text}`", .at + 1)]
    Expression {
        /// The expression.
        text: String,
        /// The character, from 0.
        at: usize,
        /// What is wrong.
        message: String,
        /// What to write.
        hint: String,
    },
    /// What is wrong with a part of an expression.
    #[error("{cause}")]
    Within {
        /// The expression.
        text: String,
        /// The character of the expression at which the part begins, from 0.
        at: usize,
        /// How many characters it has.
        len: usize,
        /// What is wrong with it.
        cause: Box<SpectrumError>,
    },
    /// A spectrum that is negative where it cannot be: a difference of two.
    #[error("the whole is {} at {at_nm} nm, but {kind} cannot be negative", shown(*.value))]
    Negative {
        /// What it is.
        kind: &'static str,
        /// Where it is smallest, nm.
        at_nm: f64,
        /// Its value there.
        value: f64,
    },
    /// A spectrum without a value somewhere: a division by 0, a root of a negative number.
    #[error("the whole has no finite value at {at_nm} nm")]
    NotFinite {
        /// The first wavelength without one, nm.
        at_nm: f64,
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
    /// A wavelength that is none of light: given in micrometers.
    #[error(transparent)]
    NotLight(#[from] NotLight),
    /// A table with a fault.
    #[error(transparent)]
    Table(#[from] TableError),
}

impl SpectrumError {
    /// The same as faults: what is wrong within a file, there; everything else as `here` places a message, with what to
    /// do about it.
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
                // What is wrong in another file has its place there.
                cause.placed(Box::new(|message| here(message).within(text, *at, *len)))
            }
            Self::Negative { .. } => here(self.to_string())
                .hint("subtract less: what is subtracted must nowhere be more than what it is taken from")
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
            Self::NothingToScale(_) => here(self.to_string()).hint("light that is somewhere more than 0").into(),
            Self::OutOfRange { wanted, .. } => here(self.to_string()).hint(*wanted).into(),
        }
    }
}

/// What a person may have meant by a name that nothing bears.
fn hint_for_unknown(name: &str, candidates: &[String]) -> String {
    if let Some(hint) = crate::common_words::meant(name) {
        return hint;
    }
    match candidates {
        _ if name.contains(['*', '+', '(']) => {
            "a sum or a product has spaces around its signs and a spectrum behind each: `D65 + 5000 * line:e`"
                .to_owned()
        }
        [one] => format!("did you mean `{one}`?"),
        [first, others @ ..] => format!("did you mean `{first}`? Similar: {}", others.join(", ")),
        [] if name.contains(['/', '\\']) || name.contains('.') => {
            "a file is looked for beside the one that names it, then among the bundled ones".to_owned()
        }
        [] => "`spectra list spectrum` shows all names; or a file such as `lamp.csv`, or `blackbody:3200`".to_owned(),
    }
}

/// A value as a person reads it: as it is, or with a power of ten where that would be a long row of digits.
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

/// `value` if `test` holds and it is finite.
pub(crate) fn check(
    what: &'static str,
    wanted: &'static str,
    value: f64,
    test: impl Fn(f64) -> bool,
) -> Result<f64, SpectrumError> {
    if value.is_finite() && test(value) { Ok(value) } else { Err(SpectrumError::OutOfRange { what, wanted, value }) }
}
