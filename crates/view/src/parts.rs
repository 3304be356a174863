//! What a page needs wherever its engine runs: controls, the drawing of the lens, pictures and faults as it takes them.

pub use crate::controls::{Control, of_scene};
pub use crate::section::svg;

use serde_json::{Value, json};
use spectra_core::params::Fault;
use spectra_session::SessionError;

/// A head and the numbers of a picture, these from a place that is a multiple of four.
#[must_use]
pub fn packed(head: &Value, numbers: &[f32]) -> Vec<u8> {
    let mut head = head.to_string();
    head.push_str(&" ".repeat((4 - head.len() % 4) % 4));
    let mut bytes = Vec::with_capacity(4 + head.len() + 4 * numbers.len());
    bytes.extend((head.len() as u32).to_le_bytes());
    bytes.extend(head.as_bytes());
    bytes.extend(numbers.iter().flat_map(|v| v.to_le_bytes()));
    bytes
}

/// What is wrong, with the control that it is about.
#[must_use]
pub fn said(error: &SessionError, path: &str) -> Value {
    match error {
        SessionError::Faults(faults) => {
            let all: Vec<Value> = faults.iter().map(fault_json).collect();
            json!({"path": path, "faults": all})
        }
        other => json!({"path": path, "faults": [{"message": other.to_string()}]}),
    }
}

/// A fault as the page shows it.
#[must_use]
pub fn fault_json(fault: &Fault) -> Value {
    json!({"message": fault.message, "place": fault.place_text(), "hint": fault.hint})
}
