//! Options with which a session is opened.

use spectra_core::Isa;
use spectra_render::Effort;

/// Options of a [`Session`](crate::Session). The defaults open the first picture of a scene, as it is rendered.
#[derive(Clone, Copy, Debug)]
pub struct SessionOptions {
    /// Instruction set of all rays; any one gives the same bits.
    pub isa: Isa,
    /// Index of the picture in its series, from 0.
    pub picture: usize,
    /// Effort of the search for the rays that pass the lens, and for those that frame and meters see. The bits of a draft differ
    /// from those of the picture.
    pub effort: Effort,
    /// Whether the light itself is kept in a file that the scene does not name.
    pub keeps_light: bool,
}

impl Default for SessionOptions {
    fn default() -> Self {
        Self { isa: Isa::detect(), picture: 0, effort: Effort::Full, keeps_light: false }
    }
}
