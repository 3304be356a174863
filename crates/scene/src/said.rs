//! What the stages of a scene said when they were built.

use crate::sight::Dark;
use spectra_core::params::{DataEnd, Warning};

/// What stages said when they were built.
#[derive(Clone, Debug, Default)]
pub(crate) struct Said {
    pub warnings: Vec<Warning>,
    pub ends: Vec<DataEnd>,
    /// The part of the frame that the lens leaves dark.
    pub dark: Option<Dark>,
}
