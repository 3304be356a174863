//! The effort of the search for the light that passes.

/// The effort with which a pupil is searched. The estimate of light is unbiased in either case.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Effort {
    /// The effort that pays off for a finished picture.
    #[default]
    Full,
    /// A tenth of the time or less, for a first look. There are few zones and no outlines, so more rays end on their way.
    Draft,
}

/// The numbers of zones, rays and steps that an effort sets for the search.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fineness {
    /// Number of zones of the angle, with an axis of revolution and without one.
    pub zones: [usize; 2],
    /// Number of zones of the azimuth, without an axis of revolution.
    pub azimuths: usize,
    /// Largest number of zones of the depth.
    pub depths: usize,
    /// Cells per side of the grid over what passes from one point, with an axis of revolution and without one.
    pub grid: [usize; 2],
    /// Step of the search for the end of the field, in the measure of the angle.
    pub step: f64,
    /// Number of random rays outside each zone's shape, none of which may pass.
    pub checks: usize,
    /// Whether outlines are computed.
    pub outlines: bool,
}

impl Effort {
    pub(super) fn fineness(self) -> Fineness {
        match self {
            // The step is less than two degrees.
            Self::Full => Fineness {
                zones: [64, 32],
                azimuths: 24,
                depths: 8,
                grid: [24, 20],
                step: 0.02,
                checks: 1024,
                outlines: true,
            },
            Self::Draft => Fineness {
                zones: [8, 8],
                azimuths: 8,
                depths: 2,
                grid: [12, 12],
                step: 0.05,
                checks: 256,
                outlines: false,
            },
        }
    }
}
