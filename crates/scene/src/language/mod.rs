//! The scene language: `include`, `variables`, `sweep` and `animation`.
//!
//! All of it works on the tree of nodes, before any stage is built, and leaves a plain scene: stages know nothing of
//! it, and a scene without these keys is assembled as it is written.
//!
//! # Order
//!
//! 1. **Files.** The scene is read, and below it what it includes ([`include`]). Maps merge, the scene's own keys win.
//! 2. **Command line.** `--set` puts its values there, over all files; `--set include=...` is heeded in step 1.
//! 3. **Series.** `sweep` and `animation` are taken out of the tree, and say which pictures there are, and which values
//!    each of them sets. `$name` in ranges and keyframes stands for the scene's variables as they are now.
//! 4. **For each picture,** its values are put at their paths, as by `--set`; `variables.x` is a path like any other.
//! 5. **Variables** are replaced by their values ([`variables`]), and the section is taken out.
//! 6. What is left is **assembled**.
//!
//! # A walk
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
//! `spectra run portrait.yaml --set variables.stop=f/8`: the files (1) merge to one tree, in which `variables` is
//! `{far: 1 m, stop: f/4}` and `imager` is the film's, with nothing left of `kind: xyz`; the command line (2) makes it
//! `stop: f/8`; the sweep (3) says that there are two pictures; (4) the second one sets `variables.far` to `3 m`; (5)
//! source and lens read `distance: 3 m`, `focus: 3 m`, `f-number: f/8`; (6) is a scene as if written so.

mod animation;
mod flat;
mod include;
mod law;
mod merge;
mod series;
mod setting;
mod sweep;
mod variables;

pub(crate) use animation::Section as AnimationForm;
pub(crate) use include::Form as IncludeForm;
pub(crate) use sweep::Form as SweepForm;

pub use flat::document;
pub use series::{Member, Series, SeriesKind, SweptAxis, load, load_series, series_of_text, series_of_tree};

use spectra_core::params::{Node, Value};

/// How many values a tree has, itself counted.
fn count(node: &Node) -> usize {
    1 + match &node.value {
        Value::Seq(items) => items.iter().map(count).sum(),
        Value::Map(entries) => entries.iter().map(|(_, item)| count(item)).sum(),
        Value::Null | Value::Bool(_) | Value::Number(_) | Value::String(_) => 0,
    }
}
