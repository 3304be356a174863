//! What a render gives.

use crate::diffracted::Diffracted;
use crate::ghosts::LightLedger;
use crate::noise::Noise;
use spectra_core::LossCounts;
use spectra_core::frame::ExposureFrame;
use spectra_scene::LightLayer;

/// What a render gives.
#[derive(Clone, Debug)]
pub struct Rendering {
    /// Linear exposure per channel.
    pub exposure: ExposureFrame,
    /// What a mid gray of the picture that is the source leaves in each channel of a meter (lx s, in the time of the recording), 0 in the
    /// others; `None` where the source has no mid gray.
    pub mid_gray: Option<Vec<f32>>,
    /// The same by kinds of light, and by paths of ghosts, of those of which an output of the scene holds layers.
    pub layers: Vec<LightLayer>,
    /// Rays launched toward the first or last surface; of those from the film, rays to the rim of the pupil, one for 16, are not counted.
    pub rays: u64,
    /// What was lost, by cause and surface.
    pub losses: LossCounts,
    /// Rays that brought light to the imager: with those that were lost, all that were launched.
    pub detected: u64,
    /// Whether it was stopped before its end.
    pub partial: bool,
    /// How noisy it is, where the scene asks.
    pub noise: Option<Noise>,
    /// The estimators whose light it is: `forward`, `backward`.
    pub estimators: Vec<&'static str>,
    /// Where the light of the source's lights goes, if ghosts are traced.
    pub ledger: Option<LightLedger>,
    /// How noisy ghosts are expected to be, where their light is spread over footprints.
    pub ghost_noise: Option<GhostNoise>,
    /// What part of the exposure of the whole frame, all channels together, is veiling glare, where it is asked for.
    pub glare: Option<f64>,
    /// What diffraction did to each channel of the picture, where the scene asks for it.
    pub diffraction: Option<Vec<Diffracted>>,
    /// What a person should know before believing the picture, and what to write.
    pub warnings: Vec<String>,
}

/// The expected noise of ghosts: that of a pixel, as a part of the ghosts' light there, in the median over the frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GhostNoise {
    /// Of this picture.
    pub noise: f64,
    /// The samples a pixel that would bring [`GhostNoise::CLEAN`], where this picture has more noise than that.
    pub clean_samples: Option<u64>,
}

impl GhostNoise {
    /// Ghosts with no more noise than this look smooth.
    pub const CLEAN: f64 = 0.04;
}
