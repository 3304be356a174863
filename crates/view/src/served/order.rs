//! What is asked of a desk.

use super::photograph;
use spectra_core::Isa;
use spectra_session::{Photograph, Session, SessionError, is_picture};
use std::path::{Path, PathBuf};

/// What is rendered, and by what means.
#[derive(Clone, Debug)]
pub(crate) struct Order {
    /// A scene file, the name of a bundled scene, or the file of a photograph.
    pub scene: PathBuf,
    /// What is made of a photograph, if it is one.
    pub photograph: Option<Photograph>,
    pub overrides: Vec<String>,
    pub isa: Isa,
    pub threads: usize,
}

impl Order {
    /// The order for a scene, or for a photograph on a stock: on the one that is usual if none is named.
    ///
    /// # Errors
    /// A stock that cannot be read.
    pub(crate) fn of(
        scene: PathBuf,
        stock: Option<&str>,
        overrides: Vec<String>,
        isa: Isa,
        threads: usize,
    ) -> Result<Self, SessionError> {
        let photograph = is_picture(&scene).then(|| photograph::of(&scene, stock)).transpose()?;
        Ok(Self { scene, photograph, overrides, isa, threads })
    }

    /// Opens it.
    ///
    /// # Errors
    /// Everything that is wrong with it.
    pub(crate) fn session(&self) -> Result<Session, SessionError> {
        match &self.photograph {
            Some(photograph) => Session::of_series(photograph.series(&self.overrides, self.isa)?, 0, self.isa),
            None => Session::open(&self.scene, &self.overrides, self.isa),
        }
    }

    /// The file that a scene is written to; none of a photograph.
    pub(crate) fn file(&self) -> Option<&Path> {
        self.photograph.is_none().then_some(&*self.scene)
    }
}
