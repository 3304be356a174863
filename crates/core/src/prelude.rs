//! The items that nearly every plugin needs: `use spectra_core::prelude::*;`.

pub use crate::frame::{DisplayPicture, ExposureFrame, FrameSize};
pub use crate::one_layer::{OneLayer, Pixel};
pub use crate::params::{
    Angle, Fault, Faults, Length, LengthOrInfinity, NonNegative, Params, Positive, Quantity, Temperature, Time,
    Wavelength,
};
pub use crate::registry::Context;
pub use crate::spectral::{Channel, Grid, Line, SpectralPower, SystemResponse};
pub use crate::stage::{
    Emit, Film, Imager, Launch, Radiance, Receive, Response, Source, WavelengthDensity, WavelengthSampler,
};
pub use crate::surface::{FromSag, PerRay, SagShape, Surface};
pub use crate::{Isa, Loss, RayBatch};
