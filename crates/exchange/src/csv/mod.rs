//! Tables of surfaces: one row per surface, with a line of column names.
//!
//! | column | other names | meaning |
//! |---|---|---|
//! | `radius` | `r`, `radius_mm`, `roc` | length; empty, `plane`, `inf` or 0 is a plane, `stop` a plane that is the stop |
//! | `curvature` | `c`, `curv` | 1/length, instead of a radius |
//! | `thickness` | `t`, `d`, `distance`, `thickness_mm` | length to the next surface, required behind a glass; for the last one, to the image plane |
//! | `glass` | `material`, `medium`, `glass_after` | name behind the surface, `mirror` reflects |
//! | `nd`, `vd` | `n`, `index`, `nd_after`; `v`, `abbe`, `vd_after` | figures of the medium behind |
//! | `semi-diameter` | `sd`, `semi_diameter_mm`, `semi_aperture`; `diameter` | clear semi-diameter; 0 or empty is unknown |
//! | `type` | `kind`, `surface_type` | `spherical`, `plane`, `stop`, `conic`, `aspherical`, `cyl-x`, `cyl-y`; `object` and `image` rows are no surfaces |
//! | `conic` | `k` | conic constant |
//! | `a2`, `a4`, ... | | coefficients of an even asphere, length^(1-power) |
//! | `asphere_coefficients` | `coefficients` | coefficients of r^2, r^4, ... in one cell, separated by blanks or `;` |
//! | `lens` | `name` | name of the lens, the same in all rows |
//! | `surface` | `#`, `no`, `number` | numbers that rise from row to row; `stop` marks the stop |
//! | `comment` | `remark`, `note` | any text |
//!
//! Tables as patents print them are first converted to this form. They may have titles, headings of several words, columns separated by
//! blanks, equations, marks and blocks of coefficients.
//!
//! Names ignore case, blanks, `-` and `_`. A unit may follow in brackets: `radius [in]`, `a4 [mm^-3]`. Without one, lengths are in mm; but
//! if one column states another unit, all columns of lengths must state theirs. Cells are separated by commas, semicolons or tabs; with
//! semicolons and tabs a decimal comma is understood. Lines that start with `#` are comments.

mod cells;
mod columns;
mod patent;
mod table;
#[cfg(test)]
mod tests;
mod units;

pub use table::read;
