//! Changes of controls that a page sends.

/// A change of one control.
#[derive(Clone, Debug)]
pub(super) struct Change {
    /// Path of the control.
    pub(super) control: String,
    pub(super) what: ChangeKind,
}

/// The effect of a change.
#[derive(Clone, Debug)]
pub(super) enum ChangeKind {
    /// Sets texts `path=value` together; the first one is that of the control.
    Set(Vec<String>),
    /// Sets the width of the picture, pixels.
    Width(u32),
    /// Selects a picture of the series by its index, from 0.
    Picture(usize),
}

impl Change {
    /// Index of the picture of the series that the change selects; `None` if it selects none.
    pub(super) fn picture(&self) -> Option<usize> {
        match self.what {
            ChangeKind::Picture(index) => Some(index),
            _ => None,
        }
    }
}
