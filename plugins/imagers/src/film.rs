//! `imager: film`, a plane that a film lies on: the film decides what is recorded.

use crate::params::Frame;
use crate::plane::Plane;
use serde::Deserialize;
use spectra_core::frame::{DisplayPicture, ExposureFrame, FrameSize};
use spectra_core::params::{Faults, Length, Params, Positive};
use spectra_core::registry::{Context, ImagerEntry};
use spectra_core::spectral::Channel;
use spectra_core::stage::{Imager, Launch, Receive};

/// Parameters of `kind: film` as written in a scene.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct FilmPlaneParams {
    /// Size by name, such as `135` (36 x 24 mm), `6x6` or `super-35`.
    #[serde(default)]
    pub format: Option<String>,
    /// Width of the frame, mm if bare; together with `height`, in place of `format`.
    #[serde(default)]
    pub width: Option<Positive<Length>>,
    /// Height of the frame, mm if bare.
    #[serde(default)]
    pub height: Option<Positive<Length>>,
    /// Pixels across and down, 1 to 32768 each and at most 200 million.
    pub resolution: [u32; 2],
}

/// A plane imager without channels of its own.
#[derive(Clone, Debug)]
pub struct FilmPlane {
    plane: Plane,
}

impl FilmPlane {
    /// A film of that size in the nominal image plane.
    #[must_use]
    pub fn new(size: FrameSize) -> Self {
        Self { plane: Plane::new(size) }
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

fn build(params: &Params, _context: &Context<'_>) -> Result<Box<dyn Imager>, Faults> {
    let FilmPlaneParams { format, width, height, resolution } = params.parse()?;
    let size = Frame { format, width, height, resolution }.size(params)?;
    Ok(Box::new(FilmPlane::new(size)))
}

inventory::submit! {
    ImagerEntry::new(
        "film",
        "A flat frame with a film on it; what it records is the film's.",
        env!("CARGO_PKG_NAME"),
        env!("CARGO_PKG_VERSION"),
        build,
    )
}
