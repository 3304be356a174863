//! The scene language: `include`, `variables`, `sweep` and `animation`.
//!
//! All of it works on the tree of nodes, before any stage is built, and leaves a plain scene. Stages know nothing of it, and a
//! scene without these keys is assembled as it is written.
//!
//! # Order
//!
//! 1. **Files.** The scene is read and merged with the files that it includes ([`include`]). The scene's own keys win.
//! 2. **Command line.** `--set` sets its values on top of all files; `--set include=...` acts already in step 1.
//! 3. **Series.** `sweep` and `animation` are removed from the tree. They define the pictures, and the values that each of them
//!    sets. `$name` in ranges and keyframes stands for the scene's variables at this step.
//! 4. **Each picture** gets its values set at their paths, as by `--set`; `variables.x` is a path like any other.
//! 5. **Variables** are replaced by their values ([`variables`]), and their section is removed.
//! 6. The remaining scene is **assembled**.
//!
//! All of several pictures are assembled before any light is traced, and only whole ones are written. A section that has the same
//! values as in the picture before keeps its stage. Pupils are searched only to render.
//!
//! Names in a file are looked up beside that file, then beside the scene, then among the bundled data
//! ([`spectra_core::resources::beside`]). A fault points into the file where the value was written.
//!
//! # An example
//!
//! ```yaml
//! # studio.yaml                                   # portrait.yaml
//! source: {kind: chart, chart: color-checker,     include: studio.yaml
//!   distance: $far, width: 0.6 m}                 variables: {stop: f/4}
//! variables: {far: 1 m, stop: f/2}                imager: {kind: film, format: 135}
//! lens: {file: zeiss-biotar-50-f1.4,              film: {stock: ilford-ortho-plus, exposure: 1/60 s}
//!   focus: $far, f-number: $stop}                 sweep: {variables.far: [1 m, 3 m]}
//! imager: {kind: xyz, format: 135}
//! ```
//!
//! With `spectra run portrait.yaml --set variables.stop=f/8`, the files (1) merge to one tree. In it, `variables` is
//! `{far: 1 m, stop: f/4}`, and `imager` is the film imager, without anything of `kind: xyz`. The command line (2) changes the
//! variable to `stop: f/8`. The sweep (3) defines two pictures, and (4) the second one sets `variables.far` to `3 m`. Then (5)
//! source and lens have `distance: 3 m`, `focus: 3 m`, `f-number: f/8`, and (6) the scene is assembled as if it were written that
//! way.

mod animation;
mod include;
mod law;
mod merge;
mod picture_values;
mod series;
mod sweep;
mod variables;
mod yaml_writer;

pub(crate) use animation::Section as AnimationForm;
pub(crate) use include::Form as IncludeForm;
pub(crate) use sweep::Form as SweepForm;

pub use series::{Member, Series, SeriesKind, SweptAxis, load, load_series, series_of_text, series_of_tree};
pub use yaml_writer::document;

use spectra_core::params::{Node, Value};

/// Returns the number of values in a tree, including the root.
fn count(node: &Node) -> usize {
    1 + match &node.value {
        Value::Seq(items) => items.iter().map(count).sum(),
        Value::Map(entries) => entries.iter().map(|(_, item)| count(item)).sum(),
        Value::Null | Value::Bool(_) | Value::Number(_) | Value::String(_) => 0,
    }
}
