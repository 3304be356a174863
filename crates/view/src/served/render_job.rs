//! The order for a desk: what to render, and how.

use super::photograph;
use spectra_core::Isa;
use spectra_darkroom::{Photograph, is_picture};
use spectra_session::{Session, SessionError, SessionOptions};
use std::path::{Path, PathBuf};

/// A scene or photograph to render, and the means to do it.
#[derive(Clone, Debug)]
pub(crate) struct RenderJob {
    /// Scene file, name of a bundled scene, or file of a photograph.
    pub scene: PathBuf,
    /// Settings for a photograph; `None` for a scene.
    pub photograph: Option<Photograph>,
    pub overrides: Vec<String>,
    pub isa: Isa,
    pub threads: usize,
}

impl RenderJob {
    /// Creates the job for a scene, or for a photograph on a stock; the default stock if none is named.
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

    /// Opens a session for the order.
    ///
    /// # Errors
    /// Every fault of the scene or the photograph.
    pub(crate) fn session(&self) -> Result<Session, SessionError> {
        let options = SessionOptions { isa: self.isa, ..SessionOptions::default() };
        match &self.photograph {
            Some(photograph) => Session::new(photograph.series(&self.overrides)?, options),
            None => Session::open(&self.scene, &self.overrides, options),
        }
    }

    /// File into which changes of a scene are saved; `None` for a photograph.
    pub(crate) fn file(&self) -> Option<&Path> {
        self.photograph.is_none().then_some(&*self.scene)
    }
}
