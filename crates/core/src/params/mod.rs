//! Typed parameters with their places in the file, and the messages when they are wrong.
//!
//! A file becomes a tree of [`Node`]s, each with the place where it was written. A stage gets its own
//! map of it as [`Params`] and states what it wants as a plain struct: keys are the kebab-case names of
//! the fields, other keys are faults, and a quantity such as [`Length`] takes a bare number in the unit
//! that it documents or a text with a unit, checked by dimension. [`Params::parse`] reports every fault of
//! the map in one go, each at the exact token. What a type cannot say (a range, a combination) is checked
//! afterwards and placed with [`Params::fault`]; a nested stage is a [`StageNode`].
//!
//! ```
//! use schemars::JsonSchema;
//! use serde::Deserialize;
//! use spectra_core::params::{Faults, Key, LengthOrInfinity, Length, Node, Params, Positive, SourceFile, Span, Value};
//! use std::sync::Arc;
//!
//! /// Parameters of `kind: bubble` as written in a lens file.
//! #[derive(Debug, Deserialize, JsonSchema)]
//! #[serde(deny_unknown_fields, rename_all = "kebab-case")]
//! struct BubbleParams {
//!     /// Radius of curvature, mm if bare; `inf` is a plane.
//!     radius: LengthOrInfinity,
//!     /// Clear semi-diameter, at most 1 m, mm if bare.
//!     #[schemars(range(max = 1000))]
//!     semi_diameter: Positive<Length>,
//! }
//!
//! fn build(params: &Params) -> Result<BubbleParams, Faults> {
//!     let bubble: BubbleParams = params.parse()?;
//!     if bubble.semi_diameter.mm() > bubble.radius.mm().abs() {
//!         return Err(params.fault("semi-diameter", "the rim lies beyond the sphere").hint("at most the radius").into());
//!     }
//!     Ok(bubble)
//! }
//!
//! // A reader of files makes the tree; here by hand, as `{radius: 4 cm, semi-diameter: 2 m}`.
//! # let file = Arc::new(SourceFile::new("bubble.yaml", "{radius: 4 cm, semi-diameter: 2 m}"));
//! # let span = |offset, len| Span { line: 1, column: offset + 1, offset, len };
//! # let entry = |key: &str, at, value: &str, value_at| {
//! #     let node = Node::new(Value::from_plain(value), span(value_at, value.len()), Arc::clone(&file));
//! #     (Key { text: key.to_owned(), span: span(at, key.len()) }, node)
//! # };
//! # let entries = vec![entry("radius", 1, "4 cm", 9), entry("semi-diameter", 15, "2 m", 30)];
//! # let node = Node::new(Value::Map(entries), span(0, file.text.len()), Arc::clone(&file));
//! let faults = build(&Params::stage(node, "surfaces[0]")?).unwrap_err();
//! assert_eq!(
//!     faults.to_string(),
//!     "bubble.yaml:1:31: found 2 m, which is out of range (a length greater than 0, up to 1000 mm)"
//! );
//! # Ok::<(), Faults>(())
//! ```
//!
//! The struct is the only declaration. `schemars` makes its schema, `check` compares the tree with the schema, and serde then reads
//! the tree. A check by serde itself (`try_from`, a hand-written `Deserialize`) comes last, and its fault is placed at the map
//! around the value; it may add a hint to its message, on a line that starts with `hint: `.

mod at;
mod check;
mod fault;
mod node;
#[allow(clippy::module_inception)] // The type `Params` is the idea of the module `params`.
mod params;
mod part;
mod parts;
mod path;
mod place;
mod reader;
mod schema;
#[cfg(test)]
mod tests;
mod text;
mod warning;
mod whole;

pub use crate::quantity::{
    Angle, Bound, Dimension, Exposure, FNumber, Illuminance, Length, LengthOrInfinity, Luminance, NonNegative,
    OrInfinity, Positive, Power, Quantity, RadiantIntensity, Ratio, Reading, SpatialFrequency, Temperature, Time, Unit,
    Wavelength, schema_of,
};
pub use fault::{Fault, Faults};
pub use node::{Key, MAX_DEPTH, Node, Number, Value};
pub use params::Params;
pub use part::{Part, StageNode};
pub use path::{Step, steps};
pub use place::{SourceFile, Span};
pub use reader::{Readable, keys_of};
pub use schema::Kinds;
pub use warning::{DataEnd, Warning, Warnings};
pub use whole::Whole;
