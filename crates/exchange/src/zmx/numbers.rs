//! Numbered values of a surface, and which of them its type uses.

use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};

/// The values of `PARM` or `XDAT` records by their numbers, in the file's units. What nobody asks for is told of in the end.
#[derive(Clone, Debug, Default)]
pub(super) struct Numbers {
    values: BTreeMap<u32, f64>,
    asked: RefCell<BTreeSet<u32>>,
}

impl Numbers {
    pub(super) fn insert(&mut self, at: u32, value: f64) {
        self.values.insert(at, value);
    }

    /// The value of a number; 0 where the file states none.
    pub(super) fn get(&self, at: u32) -> f64 {
        self.asked.borrow_mut().insert(at);
        self.values.get(&at).copied().unwrap_or(0.0)
    }

    /// Values that are no part of the form of a surface, or of which is told otherwise.
    pub(super) fn set_aside(&self, numbers: impl IntoIterator<Item = u32>) {
        self.asked.borrow_mut().extend(numbers);
    }

    /// All of them that are stated.
    pub(super) fn set_all_aside(&self) {
        self.set_aside(self.values.keys().copied());
    }

    /// Values other than 0 that nobody asked for.
    pub(super) fn unused(&self) -> Vec<(u32, f64)> {
        let asked = self.asked.borrow();
        self.values.iter().filter(|(at, value)| **value != 0.0 && !asked.contains(at)).map(|(a, v)| (*a, *v)).collect()
    }
}
