//! Messages that the stages of a scene gave when they were built.

use crate::frame_view::UncoveredFrame;
use spectra_core::params::{DataEnd, Warning};

/// Messages of stages from the time when they were built.
#[derive(Clone, Debug, Default)]
pub(crate) struct BuildMessages {
    pub warnings: Vec<Warning>,
    pub ends: Vec<DataEnd>,
    /// The part of the frame that the lens leaves dark, if any.
    pub dark: Option<UncoveredFrame>,
}
