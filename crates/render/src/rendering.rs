//! The results of a render.

use crate::diffracted::Diffracted;
use crate::ghosts::LightLedger;
use crate::noise::Noise;
use spectra_core::LossCounts;
use spectra_core::frame::ExposureFrame;
use spectra_scene::LightLayer;

/// The results of a render, complete or partial.
#[derive(Clone, Debug)]
pub struct Rendering {
    /// Linear exposure of each channel.
    pub exposure: ExposureFrame,
    /// Exposure that a mid gray of the source picture gives in each meter channel (lx s, in the exposure time), 0 in the other channels.
    /// `None` if the source has no mid gray.
    pub mid_gray: Option<Vec<f32>>,
    /// Exposure of the kinds of light and of the ghost paths for which an output of the scene holds layers.
    pub layers: Vec<LightLayer>,
    /// Number of rays launched toward the first or last surface. Rays from the film to the rim of the pupil, one for 16 others, are not
    /// counted.
    pub rays: u64,
    /// Number of rays lost, by cause and surface.
    pub losses: LossCounts,
    /// Number of rays that brought light to the imager; together with the lost rays, all that were launched.
    pub detected: u64,
    /// Whether the render was stopped before its end.
    pub partial: bool,
    /// Number of samples that every pixel got, except in places that were clean earlier.
    pub samples: u64,
    /// Noise of the picture, if the scene limits it.
    pub noise: Option<Noise>,
    /// Names of the estimators whose light this is, such as `forward` and `backward`.
    pub estimators: Vec<&'static str>,
    /// Ledger of the light of the source's lights, if ghosts are traced.
    pub ledger: Option<LightLedger>,
    /// Expected noise of the ghosts, if their light is spread over footprints.
    pub ghost_noise: Option<GhostNoise>,
    /// Fraction of the exposure of the whole frame, over all channels, that is veiling glare, if the scene asks for glare.
    pub glare: Option<f64>,
    /// What diffraction did to each channel of the picture, if the scene asks for it or it matters.
    pub diffraction: Option<Vec<Diffracted>>,
    /// Warnings to read before believing the picture, each with what to write.
    pub warnings: Vec<String>,
}

/// The expected noise of ghosts: the noise of a pixel as a fraction of the ghosts' light there, in the median over the frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GhostNoise {
    /// Expected noise in this picture.
    pub noise: f64,
    /// Samples per pixel that would reach [`GhostNoise::CLEAN`], if this picture is noisier than that.
    pub clean_samples: Option<u64>,
}

impl GhostNoise {
    /// Noise up to which ghosts look smooth.
    pub const CLEAN: f64 = 0.04;
}
