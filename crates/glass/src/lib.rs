//! Refractive index: dispersion formulas, catalogues, fast evaluation.
//!
//! - [`Formula`] is n(lambda) as makers and papers write it; [`Glass`] is a named medium with its data; [`Catalog`] finds one
//!   by name, or the nearest to a patent's (n, V).
//! - [`Medium`] is a medium that light travels in; [`Dispersion`] is its index, fitted for tracing.
//! - [`fit`] makes formulas from tables, [`interface`] has Fresnel's equations, [`agf`] reads users' catalogues.
//!
//! Conventions: wavelengths are in nanometers in air in every public interface; glass formulas take micrometers inside. The
//! index of a glass is relative to air as its maker gives it, so air is 1 and vacuum a little less than 1 (see [`air`]).
//!
//! ```
//! use spectra_glass::{Catalog, Dispersion, Medium, lines};
//!
//! let glass = Catalog::bundled().find("SCHOTT/N-BK7")?;
//! assert!((glass.index(lines::D.wavelength_nm) - 1.516_800).abs() < 1e-6);
//! let fast = Dispersion::fit(&Medium::from(glass), 350.0, 830.0)?;
//! assert!(fast.max_error() <= 2e-10);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod agf;
pub mod air;
mod catalog;
mod dispersion;
pub mod file;
pub mod fit;
mod formula;
mod glass;
pub mod interface;
pub mod lines;
mod medium;

pub use catalog::{
    Absorption, AbsorptionSubstitute, Candidate, Catalog, CatalogError, ChosenGlass, Deviation, Era, EraError,
    FindError, GlassFacts, LISTED_TOLERANCE_ND, LISTED_TOLERANCE_VD, ListedCheck, Match, Query,
};
pub use dispersion::{Dispersion, DispersionError, Rational};
pub use formula::{
    ClosedForm, ClosedFormula, Formula, FormulaEntry, Melt, ModelGlass, NumberedFormula, Table, TableError,
};
pub use glass::{Category, Extinction, Glass, Status, Thermal};
pub use lines::{Line, LineTriple};
pub use medium::Medium;
