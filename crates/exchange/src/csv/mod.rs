//! A table of surfaces, one row each, with a line of column names.
//!
//! | column | other names | meaning |
//! |---|---|---|
//! | `radius` | `r`, `radius_mm`, `roc` | length; empty, `plane`, `inf` or 0 is a plane, `stop` a plane that is the stop |
//! | `curvature` | `c`, `curv` | 1/length, in place of a radius |
//! | `thickness` | `t`, `d`, `distance`, `thickness_mm` | length to the next surface, needed behind a glass; of the last one, to the image plane |
//! | `glass` | `material`, `medium`, `glass_after` | name behind the surface, `mirror` reflects |
//! | `nd`, `vd` | `n`, `index`, `nd_after`; `v`, `abbe`, `vd_after` | figures of the medium behind |
//! | `semi-diameter` | `sd`, `semi_diameter_mm`, `semi_aperture`; `diameter` | clear semi-diameter; 0 or empty is unknown |
//! | `type` | `kind`, `surface_type` | `spherical`, `plane`, `stop`, `conic`, `aspherical`, `cyl-x`, `cyl-y`; `object` and `image` rows are no surfaces |
//! | `conic` | `k` | conic constant |
//! | `a2`, `a4`, ... | | coefficients of an even asphere, length^(1-power) |
//! | `asphere_coefficients` | `coefficients` | the same of r^2, r^4, ... in one cell, separated by blanks or `;` |
//! | `lens` | `name` | name of the lens: one in all rows |
//! | `surface` | `#`, `no`, `number` | numbers that rise from row to row; `stop` marks the stop |
//! | `comment` | `remark`, `note` | words |
//!
//! Tables as patents print them, with titles, headings of several words, columns of blanks, equations, marks and blocks of coefficients,
//! are typed again first.
//!
//! Case, blanks, `-` and `_` do not matter in names. A unit may follow in brackets: `radius [in]`, `a4 [mm^-3]`; without one lengths are
//! in mm, and if one column states another unit, all lengths state theirs. Cells are separated by comma, semicolon or tab; with
//! semicolons and tabs a decimal comma is understood. Lines that start with `#` are comments.

mod cells;
mod columns;
mod patent;
mod table;
#[cfg(test)]
mod tests;
mod units;

pub use table::read;
