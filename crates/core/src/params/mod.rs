//! Typed parameters with their places in the file, and the messages when they are wrong.
//!
//! A file becomes a tree of [`Node`]s, each with the place where it was written. A stage gets its own map of the tree as
//! [`Params`] and states what it wants as a plain struct. Keys are the kebab-case names of the fields, and other keys are
//! faults. A quantity such as [`Length`] takes a bare number in the unit that it documents, or a text with a unit, checked by
//! dimension. [`Params::parse`] reports every fault of the map in one go, each at the exact token. What a type cannot express
//! (a range, a combination) is checked afterwards and placed with [`Params::fault`]; a nested stage is a [`StageNode`].
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
//! The struct is the only declaration: its type states unit and form, attributes state the range, an enum states the words, and the
//! doc comment states the meaning. `schemars` makes its schema, `check` compares the tree with the schema, and serde then reads
//! the tree. A check by serde itself (`try_from`, a hand-written `Deserialize`) comes last, and its message is placed at the map
//! around the value. A stage's `build` checks only what concerns several keys, or what depends on the world (a file, a glass, a
//! lens).
//!
//! Three modules share the work, each of which uses only those before it: [`names`](crate::names) finds what a typed name meant,
//! [`quantity`](crate::quantity) knows how `50 mm` or `f/2.8` is read, shown and bounded, and this module places messages in a file.
//!
//! # One value
//!
//! `film: {stock: ilford-ortho-plus, exposure: 1/60 s, compensation: 12}` is read in four steps:
//!
//! 1. The crate `yaml` makes it a [`Node`]: map, keys and values, each with its place. The registry finds the stage and gives it
//!    [`Params`].
//! 2. `params.parse::<StockParams>()` makes the schema. That of `compensation` is `{type: number, minimum: -10, maximum: 10}`.
//! 3. `check` walks node and schema side by side, once, and collects every fault: unknown and missing keys, types, words, lengths,
//!    ranges. The schema of a quantity has `x-quantity` and `x-unit`, so its limits, in the unit of a bare number, hold for `12 cm`
//!    as for `120`. Here the fault is `found 12, which is out of range`, at the line and column of the `12`, with the path
//!    `film.compensation` and the hint `a number from -10 to 10`.
//! 4. If nothing is wrong, serde reads the tree by a small deserializer of nodes (`reader`): `1/60 s` becomes a [`Time`].
//!
//! A part that is read later (a nested stage, a section by itself) is a field [`Deferred<T>`](Deferred). Its schema is that of `T`, marked
//! `x-part`; the check stops there, and the field keeps its node. Keys that all kinds of a stage share are a separate struct. It is
//! flattened (imagers), or split off by [`keys_of`] (surfaces, apertures).
//!
//! There is no derive macro of our own for this. It would also have to write the schema, for editors and `spectra doc`, and to read
//! serde's attributes or replace them in 150 types.

mod at;
mod check;
mod deferred;
mod fault;
mod node;
#[allow(clippy::module_inception)] // The type `Params` is the idea of the module `params`.
mod params;
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
pub use deferred::{Deferred, StageNode};
pub use fault::{Fault, Faults};
pub use node::{Key, MAX_DEPTH, Node, Number, Value};
pub use params::Params;
pub use path::{Step, steps};
pub use place::{SourceFile, Span};
pub use reader::{Readable, keys_of};
pub use schema::Kinds;
pub use warning::{DataEnd, Warning, Warnings};
pub use whole::Whole;
