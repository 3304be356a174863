//! `imager: film`: a plane that carries a film, which decides what is recorded.

use crate::params::Frame;
use crate::plane::Plane;
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::cover::CoverStack;
use spectra_core::frame::FrameSize;
use spectra_core::params::{Faults, Params};
use spectra_core::registry::Context;
use spectra_core::stage::{Imager, Launch, Receive, Response};

/// A frame that carries a film, which decides what is recorded.
///
/// The section `film` of the scene names the film and says how it is exposed and developed. Several films side by side
/// record the same light.
///
/// `resolution` is the number of pixels across and down. If its aspect ratio differs from that of the frame, the pixels
/// are not square. The frame lies in the image plane of the lens unless you shift it, tilt it (as on a view camera) or
/// curve it.
///
/// # Example
/// ```yaml
/// {kind: film, format: 135, resolution: [960, 640]}
/// ```
/// ```yaml
/// # A view camera, tilted for a tilted plane of focus
/// kind: film
/// format: 4x5
/// resolution: [1000, 800]
/// shift: [0, 15 mm]
/// tilt: [-4 deg, 0]
/// ```
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(deny_unknown_fields)]
pub struct FilmPlaneParams {
    #[serde(flatten)]
    frame: Frame,
}

/// A plane imager without a response of its own.
#[derive(Clone, Debug)]
pub struct FilmPlane {
    plane: Plane,
}

impl FilmPlane {
    /// Creates an imager for a film on the frame `plane`.
    #[must_use]
    pub fn new(plane: Plane) -> Self {
        Self { plane }
    }
}

impl Imager for FilmPlane {
    fn size(&self) -> FrameSize {
        self.plane.size()
    }

    fn response(&self) -> Option<&dyn Response> {
        None
    }

    fn receive(&self) -> Option<&dyn Receive> {
        Some(&self.plane)
    }

    fn launch(&self) -> Option<&dyn Launch> {
        Some(&self.plane)
    }

    fn cover(&self) -> Option<CoverStack> {
        self.plane.cover()
    }
}

fn build(params: &Params, context: &Context<'_>) -> Result<Box<dyn Imager>, Faults> {
    Ok(Box::new(FilmPlane::new(params.parse::<FilmPlaneParams>()?.frame.plane(params, context)?)))
}

spectra_core::register!(imager "film": FilmPlaneParams, build);
