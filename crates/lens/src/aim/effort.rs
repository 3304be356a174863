//! How closely what passes is searched.

/// How closely a pupil is searched. Light is estimated without bias either way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Effort {
    /// As closely as pays for a picture.
    #[default]
    Full,
    /// In a tenth of the time or less, for a first look: few zones and no outlines, so that more rays end on the way.
    Draft,
}

/// What the search of zones takes from its effort.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fineness {
    /// Zones of the angle, with an axis of revolution and without one.
    pub zones: [usize; 2],
    /// Zones of the azimuth, without one.
    pub azimuths: usize,
    /// Zones of the depth, at most.
    pub depths: usize,
    /// Grid over what passes from one point, with an axis of revolution and without one.
    pub grid: [usize; 2],
    /// Step in which the end of the field is looked for, in the measure of the angle.
    pub step: f64,
    /// Random rays beside each zone's shape, none of which may pass.
    pub checks: usize,
    /// Whether outlines are made.
    pub outlines: bool,
}

impl Effort {
    pub(super) fn fineness(self) -> Fineness {
        match self {
            // A step of under two degrees.
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
