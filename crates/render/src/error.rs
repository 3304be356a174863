//! Why a scene cannot be rendered.

/// Why a scene cannot be rendered as asked.
#[derive(Debug, thiserror::Error)]
pub enum RenderError {
    /// The source has no forward ability.
    #[error("this source cannot emit rays: render it backward")]
    CannotEmit,
    /// The imager has no forward ability.
    #[error("this imager cannot receive rays: render it backward")]
    CannotReceive,
    /// The imager has no backward ability.
    #[error("this imager cannot launch rays: render it forward")]
    CannotLaunch,
    /// The source has no backward ability.
    #[error("this source cannot be looked at: render it forward")]
    NoRadiance,
    /// No surface states a size.
    #[error("no surface of the lens states a semi-diameter: nothing says where light may enter")]
    NoAperture,
    /// The wavelength strategy refuses.
    #[error("wavelengths: {0}")]
    Sampler(String),
    /// A medium of the lens has no index in the band.
    #[error("lens: {0}")]
    Lens(String),
    /// A sum or a contribution did not fit.
    #[error("the sums overflowed: some light is more than 2^20 times brighter than a pilot run saw")]
    Overflow,
    /// No threads to be had.
    #[error("cannot start threads: {0}")]
    Threads(String),
}
