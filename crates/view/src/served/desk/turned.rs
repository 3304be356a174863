//! What was turned on a page.

/// A value that was turned.
#[derive(Clone, Debug)]
pub(super) struct Turned {
    /// The path of its control.
    pub(super) control: String,
    pub(super) what: What,
}

/// What a value is of.
#[derive(Clone, Debug)]
pub(super) enum What {
    /// Texts `path=value`, set together; the first one is that of the control.
    Set(Vec<String>),
    /// The width of the picture, pixels.
    Width(u32),
    /// Which picture of the series it is, from 0.
    Picture(usize),
}

impl Turned {
    /// The picture of the series that it asks for.
    pub(super) fn picture(&self) -> Option<usize> {
        match self.what {
            What::Picture(index) => Some(index),
            _ => None,
        }
    }
}
