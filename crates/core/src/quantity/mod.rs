//! Quantities as people write them: `50 mm`, `f/2.8`, `1/125 s`.
//!
//! A [`Quantity`] is a type with a dimension, the unit of its bare number and a bound; it knows how it is read, shown and
//! described in a schema. This module knows nothing of files: its faults have no place, and [`crate::params`] attaches it.

mod kinds;
mod light;
mod limits;
mod quantity_format;
mod units;
mod written;

pub use kinds::{
    Angle, Exposure, FNumber, Illuminance, Length, LengthOrInfinity, Luminance, NonNegative, OrInfinity, Positive,
    Power, RadiantIntensity, Ratio, SpatialFrequency, Temperature, Time, Wavelength,
};
pub use light::{NotLight, SHORTEST_LIGHT_NM, light_nm};
pub(crate) use limits::Limits;
pub use quantity_format::{Bound, Quantity, deserialize};
pub(crate) use quantity_format::{QuantityFormat, found_text};
pub(crate) use units::decimal_end;
pub use units::{Dimension, Reading, Unit};
pub use written::schema_of;
