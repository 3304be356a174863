//! What a person should know before believing a picture.

use super::Fault;
use std::cell::RefCell;
use std::fmt;

/// Something that is probably not what was meant, or that makes a picture less true than it looks: worded, placed and
/// hinted like a [`Fault`], but nothing that keeps a scene from being rendered.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Warning(pub Fault);

impl From<Fault> for Warning {
    fn from(fault: Fault) -> Self {
        Self(fault)
    }
}

impl From<String> for Warning {
    /// One without a place.
    fn from(message: String) -> Self {
        Self(Fault::new(message))
    }
}

impl fmt::Display for Warning {
    /// One line: `file:line:column: message (hint)`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

/// Warnings as they come up while stages are built: a builder only borrows what it is told.
#[derive(Debug, Default)]
pub struct Warnings {
    all: RefCell<Vec<Warning>>,
    ends: RefCell<Vec<DataEnd>>,
}

/// A table of light that is continued flat beyond its rows. Whether that matters shows once it is known who sees the light.
#[derive(Clone, Debug, PartialEq)]
pub struct DataEnd {
    /// Where it is named, with its name as the message.
    pub place: Fault,
    /// First and last wavelength of its rows, nm.
    pub measured_nm: [f64; 2],
}

impl Warnings {
    /// None yet.
    #[must_use]
    pub const fn new() -> Self {
        Self { all: RefCell::new(Vec::new()), ends: RefCell::new(Vec::new()) }
    }

    /// Adds one, unless the same has been said.
    pub fn push(&self, warning: impl Into<Warning>) {
        let warning = warning.into();
        let mut all = self.all.borrow_mut();
        if !all.contains(&warning) {
            all.push(warning);
        }
    }

    /// All, in the order in which they came.
    #[must_use]
    pub fn into_vec(self) -> Vec<Warning> {
        self.all.into_inner()
    }

    /// Adds a table whose ends may have to be warned of.
    pub fn push_end(&self, end: DataEnd) {
        self.ends.borrow_mut().push(end);
    }

    /// These tables.
    #[must_use]
    pub fn ends(&self) -> Vec<DataEnd> {
        self.ends.borrow().clone()
    }
}
