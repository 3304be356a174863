//! Separators between the fields of a table row.

/// Separator between the fields of a table row.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Separator {
    /// A comma, `,`; numbers then have a decimal point.
    #[default]
    Comma,
    /// A semicolon, `;`.
    Semicolon,
    /// A tab.
    Tab,
    /// One space or more.
    Blanks,
}

impl Separator {
    /// Returns the name of the separator, in the plural.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Comma => "commas",
            Self::Semicolon => "semicolons",
            Self::Tab => "tabs",
            Self::Blanks => "blanks",
        }
    }

    /// Guesses the separator from a row of numbers.
    pub(crate) fn of(row: &str) -> Self {
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

    /// Splits a row into its fields.
    pub(crate) fn fields(self, row: &str) -> Vec<&str> {
        match self {
            Self::Comma => row.split(',').collect(),
            Self::Semicolon => row.split(';').collect(),
            Self::Tab => row.split('\t').collect(),
            Self::Blanks => row.split_whitespace().collect(),
        }
    }
}

pub(crate) fn is_of_number(c: char) -> bool {
    c.is_ascii_digit() || matches!(c, '+' | '-' | '.')
}
