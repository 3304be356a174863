//! Numbered values of a surface, and a record of which of them its type uses.

use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};

/// The values of `PARM` or `XDAT` records by number, in the file's units. Values that are never read are noted in the end.
#[derive(Clone, Debug, Default)]
pub(super) struct NumberedValues {
    values: BTreeMap<u32, f64>,
    asked: RefCell<BTreeSet<u32>>,
}

impl NumberedValues {
    pub(super) fn insert(&mut self, at: u32, value: f64) {
        self.values.insert(at, value);
    }

    /// Returns the value of a number and marks it as used; 0 if the file states none.
    pub(super) fn get(&self, at: u32) -> f64 {
        self.asked.borrow_mut().insert(at);
        self.values.get(&at).copied().unwrap_or(0.0)
    }

    /// Marks values as used that do not affect the shape of a surface, or that are noted otherwise.
    pub(super) fn set_aside(&self, numbers: impl IntoIterator<Item = u32>) {
        self.asked.borrow_mut().extend(numbers);
    }

    /// Marks all stated values as used.
    pub(super) fn set_all_aside(&self) {
        self.set_aside(self.values.keys().copied());
    }

    /// Returns the values other than 0 that were not used.
    pub(super) fn unused(&self) -> Vec<(u32, f64)> {
        let asked = self.asked.borrow();
        self.values.iter().filter(|(at, value)| **value != 0.0 && !asked.contains(at)).map(|(a, v)| (*a, *v)).collect()
    }
}
