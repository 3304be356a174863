//! Warnings: what a person should know before trusting a picture.

use super::Fault;
use std::cell::RefCell;
use std::fmt;

/// Something that was probably not intended, or that makes a picture less accurate than it looks. It has a message, a place and a
/// hint like a [`Fault`], but the scene can still be rendered.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Warning(pub Fault);

impl From<Fault> for Warning {
    fn from(fault: Fault) -> Self {
        Self(fault)
    }
}

impl From<String> for Warning {
    /// Creates a warning without a place.
    fn from(message: String) -> Self {
        Self(Fault::new(message))
    }
}

impl fmt::Display for Warning {
    /// Writes one line: `file:line:column: message (hint)`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

/// Collects warnings while stages are built; builders only need a shared reference to it.
#[derive(Debug, Default)]
pub struct Warnings {
    all: RefCell<Vec<Warning>>,
    ends: RefCell<Vec<DataEnd>>,
}

/// A table of light that is extended at a constant value beyond its rows. Whether the extension matters is known only once the
/// film or sensor is.
#[derive(Clone, Debug, PartialEq)]
pub struct DataEnd {
    /// Place at which the table is named in the scene; the message of this fault is the table's name.
    pub place: Fault,
    /// First and last wavelength of its rows, nm.
    pub measured_nm: [f64; 2],
}

impl Warnings {
    /// Creates a collector without any warnings.
    #[must_use]
    pub const fn new() -> Self {
        Self { all: RefCell::new(Vec::new()), ends: RefCell::new(Vec::new()) }
    }

    /// Adds a warning, unless it is already there.
    pub fn push(&self, warning: impl Into<Warning>) {
        let warning = warning.into();
        let mut all = self.all.borrow_mut();
        if !all.contains(&warning) {
            all.push(warning);
        }
    }

    /// Returns the warnings added so far, in the order in which they were added.
    #[must_use]
    pub fn all(&self) -> Vec<Warning> {
        self.all.borrow().clone()
    }

    /// Adds a table that ends within the band; see [`DataEnd`].
    pub fn push_end(&self, end: DataEnd) {
        self.ends.borrow_mut().push(end);
    }

    /// Returns the tables that were added so far by [`Warnings::push_end`].
    #[must_use]
    pub fn ends(&self) -> Vec<DataEnd> {
        self.ends.borrow().clone()
    }
}
