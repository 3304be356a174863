//! The floor: a fraction of the samples that follows the response of the channels, so that the density is nowhere zero where a channel
//! is sensitive.

use crate::Cells;
use crate::recorded_spectrum::RecordedSpectrum;
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use spectra_core::params::{Fault, NonNegative, Quantity, Ratio, schema_of};
use spectra_core::quantity;
use spectra_core::spectral::Grid;

/// Fraction of the samples that follow the summed response of all channels, whatever else a strategy draws. It is 0 to below 1, written as
/// `5 %` or `0.05`.
///
/// A density that is zero where a channel is sensitive causes bias. (A uniform floor over the band would cost ten times as much, because
/// its strata straddle the ends of a film's sensitivity.)
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Floor(f64);

impl Floor {
    /// No floor. The strategy's own density must then be positive wherever a channel is sensitive.
    pub const NONE: Self = Self(0.0);

    /// Creates a floor of `share` of the samples; `None` unless it is 0 or more and below 1.
    #[must_use]
    pub fn new(share: f64) -> Option<Self> {
        (0.0..1.0).contains(&share).then_some(Self(share))
    }

    /// Fraction of the samples, 0 to below 1.
    #[must_use]
    pub fn share(self) -> f64 {
        self.0
    }

    /// Returns the density from which the floor draws; `None` if the fraction is 0.
    pub(crate) fn cells(self, grid: Grid, seen: &RecordedSpectrum) -> Option<Cells> {
        if self.0 > 0.0 { Cells::of(grid, &seen.response) } else { None }
    }
}

impl JsonSchema for Floor {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Floor".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let mut schema = schema_of::<NonNegative<Ratio>>();
        schema.insert("exclusiveMaximum".to_owned(), 1.into());
        schema
    }
}

impl Serialize for Floor {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_f64(self.0)
    }
}

impl Default for Floor {
    /// Returns a floor of 1/16, which is four strata of 64.
    fn default() -> Self {
        Self(0.0625)
    }
}

impl<'de> Deserialize<'de> for Floor {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let share: Ratio = quantity::deserialize(deserializer)?;
        Self::new(share.bare()).ok_or_else(|| {
            let fault = Fault::new("a floor must be a share of the samples");
            serde::de::Error::custom(fault.hint("write 0 or more and less than 1, such as `5 %`"))
        })
    }
}
