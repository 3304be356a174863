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
pub struct Warnings(RefCell<Vec<Warning>>);

impl Warnings {
    /// None yet.
    #[must_use]
    pub const fn new() -> Self {
        Self(RefCell::new(Vec::new()))
    }

    /// Adds one, unless the same has been said.
    pub fn push(&self, warning: impl Into<Warning>) {
        let warning = warning.into();
        let mut all = self.0.borrow_mut();
        if !all.contains(&warning) {
            all.push(warning);
        }
    }

    /// All, in the order in which they came.
    #[must_use]
    pub fn into_vec(self) -> Vec<Warning> {
        self.0.into_inner()
    }
}
