//! `imager: film`, a plane that a film lies on: the film decides what is recorded.

use crate::params::imager_params;
use crate::plane::Plane;
use spectra_core::frame::{DisplayPicture, ExposureFrame, FrameSize};
use spectra_core::params::{Faults, Params};
use spectra_core::registry::Context;
use spectra_core::spectral::Channel;
use spectra_core::stage::{Imager, Launch, Receive};

imager_params! {
    /// A frame with a film on it; what it records is the film's.
    FilmPlaneParams {}
}

/// A plane imager without channels of its own.
#[derive(Clone, Debug)]
pub struct FilmPlane {
    plane: Plane,
}

impl FilmPlane {
    /// A film on that frame.
    #[must_use]
    pub fn new(plane: Plane) -> Self {
        Self { plane }
    }
}

impl Imager for FilmPlane {
    fn size(&self) -> FrameSize {
        self.plane.size()
    }

    fn channels(&self) -> Option<Vec<Channel>> {
        None
    }

    fn receive(&self) -> Option<&dyn Receive> {
        Some(&self.plane)
    }

    fn launch(&self) -> Option<&dyn Launch> {
        Some(&self.plane)
    }

    fn display(&self, _exposure: &ExposureFrame) -> Option<DisplayPicture> {
        None
    }
}

fn build(params: &Params, context: &Context<'_>) -> Result<Box<dyn Imager>, Faults> {
    Ok(Box::new(FilmPlane::new(params.parse::<FilmPlaneParams>()?.frame().plane(params, context)?)))
}

spectra_core::register!(imager "film": FilmPlaneParams, build);
