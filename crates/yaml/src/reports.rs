//! Collects the faults of a file while it is read.

use super::{MAX_DEPTH, MAX_NODES};
use spectra_core::params::{Fault, Faults, SourceFile, Span};
use std::sync::Arc;

/// Largest number of faults reported for one file.
const MOST: usize = 100;

/// A fault that ends the parse. It is boxed because it is larger than what most calls return.
pub(super) type FatalFault = Box<Fault>;

/// Faults that do not end the parse.
#[derive(Default)]
pub(super) struct Reports {
    faults: Vec<Fault>,
    more: bool,
}

impl Reports {
    pub(super) fn push(&mut self, fault: Fault) {
        if self.faults.len() < MOST { self.faults.push(fault) } else { self.more = true }
    }

    /// Returns all faults in the order of the file, including `last`, which ended the parse.
    pub(super) fn and(mut self, last: Fault) -> Faults {
        self.faults.push(last);
        self.into_faults()
    }

    pub(super) fn is_empty(&self) -> bool {
        self.faults.is_empty()
    }

    pub(super) fn into_faults(mut self) -> Faults {
        self.faults.sort_by_key(|fault| fault.place.as_ref().map_or(0, |(_, span)| span.offset));
        if self.more {
            self.faults.push(Fault::new(format!("more than {MOST} faults; the others are not shown")));
        }
        Faults(self.faults)
    }
}

pub(super) fn fault(file: &Arc<SourceFile>, span: Span, message: impl Into<String>, hint: Option<&str>) -> FatalFault {
    let place = Some((Arc::clone(file), span.first_line(&file.text)));
    Box::new(Fault { place, hint: hint.map(str::to_owned), ..Fault::new(message) })
}

pub(super) fn too_deep(file: &Arc<SourceFile>, span: Span) -> FatalFault {
    fault(file, span, format!("nested deeper than {MAX_DEPTH} levels"), None)
}

pub(super) fn too_many(file: &Arc<SourceFile>, span: Span) -> FatalFault {
    fault(
        file,
        span,
        format!("more than {MAX_NODES} values, counting what aliases expand to"),
        Some("put large tables into a file of their own"),
    )
}

/// Returns the beginning of the text at a place, for a message.
pub(super) fn written(file: &Arc<SourceFile>, span: Span) -> String {
    const SHOWN: usize = 48;
    let text = file.text.get(span.offset..span.offset + span.len).unwrap_or("");
    let mut characters = text.chars();
    let start: String = characters.by_ref().take(SHOWN).filter(|c| !c.is_control()).collect();
    if characters.next().is_some() { start + "..." } else { start }
}
