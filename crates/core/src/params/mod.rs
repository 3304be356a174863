//! Typed parameters with places, and what is said when they are wrong.
//!
//! A file becomes a tree of [`Node`]s, each with the place where it was written. A stage gets its own
//! map of it as [`Params`] and states what it wants as a plain struct: keys are the kebab-case names of
//! the fields, other keys are faults, and a quantity such as [`Length`] takes a bare number in the unit
//! that it documents or a text with a unit, checked by dimension. [`Params::parse`] reports every fault of
//! the map in one go, each at the exact token. What a type cannot say (a range, a combination) is checked
//! afterwards and placed with [`Params::fault`]; a nested stage is a [`StageNode`].
//!
//! ```
//! use serde::Deserialize;
//! use spectra_core::params::{Faults, Length, LengthOrInfinity, Params, Positive, StageNode};
//!
//! /// Parameters of `kind: bubble` as written in a lens file.
//! #[derive(Debug, Deserialize)]
//! #[serde(deny_unknown_fields, rename_all = "kebab-case")]
//! struct BubbleParams {
//!     /// Radius of curvature, mm if bare; `inf` is a plane.
//!     radius: LengthOrInfinity,
//!     /// Clear semi-diameter, mm if bare.
//!     semi_diameter: Positive<Length>,
//!     /// Wall thickness, mm if bare.
//!     #[serde(default)]
//!     wall: Option<Positive<Length>>,
//!     /// The color of the film, a stage of its own.
//!     #[serde(default)]
//!     color: Option<StageNode>,
//! }
//!
//! fn build(params: &Params) -> Result<BubbleParams, Faults> {
//!     let bubble: BubbleParams = params.parse()?;
//!     let mut faults = Faults::new();
//!     if bubble.semi_diameter.mm() > bubble.radius.mm().abs() {
//!         faults.push(params.fault("semi-diameter", "the rim lies beyond the sphere").hint("at most the radius"));
//!     }
//!     if let Some(color) = &bubble.color {
//!         faults.take(color.params()); // goes to the registry from here
//!     }
//!     faults.into_result(bubble)
//! }
//!
//! // A reader of files makes the tree; here by hand, as `{radius: 4 cm, wal: 2 s}`.
//! # use spectra_core::params::{Key, Node, SourceFile, Span, Value};
//! # use std::sync::Arc;
//! let file = Arc::new(SourceFile::new("bubble.yaml", "{radius: 4 cm, wal: 2 s}"));
//! # let span = |offset, len| Span { line: 1, column: offset + 1, offset, len };
//! # let entry = |key: &str, at, value: &str, value_at| {
//! #     let node = Node::new(Value::from_plain(value), span(value_at, value.len()), Arc::clone(&file));
//! #     (Key { text: key.to_owned(), span: span(at, key.len()) }, node)
//! # };
//! # let entries = vec![entry("radius", 1, "4 cm", 9), entry("wal", 15, "2 s", 20)];
//! # let node = Node::new(Value::Map(entries), span(0, file.text.len()), Arc::clone(&file));
//! let params = Params::stage(node, "surfaces[0]")?;
//! let faults = build(&params).unwrap_err();
//! assert_eq!(
//!     faults.to_string(),
//!     "bubble.yaml:1:1: missing key `semi-diameter` (add `semi-diameter: ...`)\n\
//!      bubble.yaml:1:16: unknown key `wal` (did you mean `wall`?)"
//! );
//! # Ok::<(), Faults>(())
//! ```
//!
//! A `Deserialize` written by hand may put a hint behind its message, on a line that starts with `hint: `.
//! serde's `flatten`, `untagged` and internal tags work, but buffer values without their places: a fault
//! inside of them is placed at the whole value.

mod de;
mod fault;
mod node;
#[allow(clippy::module_inception)] // The type `Params` is the idea of the module `params`.
mod params;
mod parts;
mod path;
mod quantities;
pub mod quantity;
mod schema;
mod stage_node;
#[cfg(test)]
mod tests;
mod text;
mod units;
mod warning;
mod whole;

pub use fault::{Fault, Faults};
pub use node::{Key, MAX_DEPTH, Node, Number, SourceFile, Span, Value};
pub use params::Params;
pub use path::{Step, steps};
pub use quantities::{
    Angle, Exposure, FNumber, Illuminance, Length, LengthOrInfinity, Luminance, NonNegative, OrInfinity, Positive,
    Power, RadiantIntensity, Ratio, SpatialFrequency, Temperature, Time, Wavelength,
};
pub use quantity::{Bound, Quantity};
pub use schema::{Kinds, schema_of};
pub use stage_node::StageNode;
pub use text::nearest;
pub use units::{Dimension, Reading, Unit};
pub use warning::{DataEnd, Warning, Warnings};
pub use whole::Whole;
