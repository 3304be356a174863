//! `kind: sag-table`: a measured or computed surface, given at the points of a grid.

use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::params::{Faults, Length, Params, Positive};
use spectra_core::registry::Context;
use spectra_core::surface::{FromSag, PerRay, SagShape, Surface};

/// Smallest number of points along a side: a cubic spline needs four.
const FEWEST: usize = 4;
/// Largest number of points along a side.
const MOST: usize = 1024;
/// Size limit of the file, bytes: 1024 x 1024 numbers of 24 characters.
const MAX_BYTES: u64 = 26_000_000;

/// A surface given by its sag at the points of a square grid around the vertex. The sag between the points is the tensor
/// product of cubic splines (continuous to the second derivative, with not-a-knot ends), so cubic surfaces are reproduced
/// exactly. There is no surface beyond the outermost points.
///
/// In a lens file: `{kind: sag-table, step: 0.5, file: measured.csv, glass: SCHOTT/N-BK7}`. Rows run along x from -x to +x;
/// the first row has the smallest y.
///
/// Spline: C. de Boor, "Bicubic spline interpolation", J. Math. and Phys. 41, 212 (1962).
#[derive(Clone, Debug, PartialEq)]
pub struct SagTable {
    step_mm: f64,
    columns: usize,
    rows: usize,
    /// Nodes row by row: the sag and its derivatives with respect to x, to y and to both, in mm per cell.
    nodes: Vec<[f64; 4]>,
}

impl SagTable {
    /// Creates the surface through these sags, in mm. The rows have equal lengths and are in order of ascending y; the sags of a
    /// row are in order of ascending x.
    /// `step_mm` is the distance between neighboring points, mm. `None` if a side has fewer than 4 or more than 1024 points,
    /// rows differ in length, or a number is not finite.
    #[must_use]
    pub fn new(step_mm: f64, sag_mm: &[Vec<f64>]) -> Option<Self> {
        let (rows, columns) = (sag_mm.len(), sag_mm.first()?.len());
        let sides = (FEWEST..=MOST).contains(&rows) && (FEWEST..=MOST).contains(&columns);
        if !sides || sag_mm.iter().any(|row| row.len() != columns || row.iter().any(|v| !v.is_finite())) {
            return None;
        }
        let mut nodes: Vec<[f64; 4]> = sag_mm.iter().flatten().map(|z| [*z, 0.0, 0.0, 0.0]).collect();
        // Differentiate the sag along rows and along columns, then the x derivatives along columns for the mixed ones.
        for row in 0..rows {
            differentiate(&mut nodes, row * columns, 1, columns, 0, 1);
        }
        for column in 0..columns {
            differentiate(&mut nodes, column, columns, rows, 0, 2);
            differentiate(&mut nodes, column, columns, rows, 1, 3);
        }
        Some(Self { step_mm, columns, rows, nodes })
    }

    /// Returns the sag (mm) and the slopes along x and y at a point. `None` outside the grid.
    fn at(&self, x_mm: f64, y_mm: f64) -> Option<(f64, f64, f64)> {
        let place = |v: f64, count: usize| {
            let last = (count - 1) as f64;
            let u = v / self.step_mm + 0.5 * last;
            (u >= 0.0 && u <= last).then(|| {
                let cell = (u as usize).min(count - 2);
                (cell, u - cell as f64)
            })
        };
        let (i, u) = place(x_mm, self.columns)?;
        let (j, v) = place(y_mm, self.rows)?;
        let ((a, da), (b, db)) = (hermite(u), hermite(v));
        let (mut z, mut by_x, mut by_y) = (0.0, 0.0, 0.0);
        for (dj, di) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            let [f, fx, fy, fxy] = self.nodes[(j + dj) * self.columns + i + di];
            // Weights of this node's value and of its derivative, and the derivatives of these weights.
            let (x0, x1, dx0, dx1) = (a[di], a[2 + di], da[di], da[2 + di]);
            let (y0, y1, dy0, dy1) = (b[dj], b[2 + dj], db[dj], db[2 + dj]);
            z += y0 * (x0 * f + x1 * fx) + y1 * (x0 * fy + x1 * fxy);
            by_x += y0 * (dx0 * f + dx1 * fx) + y1 * (dx0 * fy + dx1 * fxy);
            by_y += dy0 * (x0 * f + x1 * fx) + dy1 * (x0 * fy + x1 * fxy);
        }
        Some((z, by_x / self.step_mm, by_y / self.step_mm))
    }
}

/// Returns the Hermite weights at `u` (0 to 1) in a cell, and their derivatives. The order is: values at both ends, then
/// derivatives at both ends.
fn hermite(u: f64) -> ([f64; 4], [f64; 4]) {
    let w = 1.0 - u;
    (
        [w * w * (1.0 + 2.0 * u), u * u * (1.0 + 2.0 * w), u * w * w, -(u * u * w)],
        [-6.0 * u * w, 6.0 * u * w, w * (w - 2.0 * u), u * (u - 2.0 * w)],
    )
}

/// Differentiates the cubic spline through `count` nodes, from index `first` on and `stride` apart. Reads component `from`
/// of each node and writes the derivative per cell to component `to`.
fn differentiate(nodes: &mut [[f64; 4]], first: usize, stride: usize, count: usize, from: usize, to: usize) {
    let f = |nodes: &[[f64; 4]], i: usize| nodes[first + i * stride][from];
    let last = count - 1;
    // d[i-1] + 4 d[i] + d[i+1] = 3 (f[i+1] - f[i-1]) inside; at the ends d[0] + 2 d[1] = (-5 f[0] + 4 f[1] + f[2]) / 2.
    // Forward elimination: row i reads diagonal d[i] + above d[i+1] = right.
    let (mut above, mut right) = (vec![0.0; count], vec![0.0; count]);
    above[0] = 2.0;
    right[0] = 0.5 * (4.0 * f(nodes, 1) + f(nodes, 2) - 5.0 * f(nodes, 0));
    for i in 1..last {
        let pivot = 4.0 - above[i - 1];
        above[i] = 1.0 / pivot;
        right[i] = (3.0 * (f(nodes, i + 1) - f(nodes, i - 1)) - right[i - 1]) / pivot;
    }
    let end = 0.5 * (5.0 * f(nodes, last) - 4.0 * f(nodes, last - 1) - f(nodes, last - 2));
    let mut d = (end - 2.0 * right[last - 1]) / (1.0 - 2.0 * above[last - 1]);
    nodes[first + last * stride][to] = d;
    for i in (0..last).rev() {
        d = right[i] - above[i] * d;
        nodes[first + i * stride][to] = d;
    }
}

impl SagShape for SagTable {
    fn scaled(&self, factor: f64) -> Option<Self> {
        let nodes = self.nodes.iter().map(|node| node.map(|v| v * factor)).collect();
        Some(Self { step_mm: self.step_mm * factor, nodes, ..self.clone() })
    }

    fn sag_mm(&self, x_mm: f64, y_mm: f64) -> Option<f64> {
        self.at(x_mm, y_mm).map(|(z, _, _)| z)
    }

    fn slope(&self, x_mm: f64, y_mm: f64) -> Option<(f64, f64)> {
        self.at(x_mm, y_mm).map(|(_, by_x, by_y)| (by_x, by_y))
    }

    fn vertex_curvature_per_mm(&self) -> (f64, f64) {
        // The curvature of a cubic spline is piecewise linear, so the slopes half a cell to either side give its value.
        let h = 0.5 * self.step_mm;
        let slope = |x: f64, y: f64| self.slope(x, y).unwrap_or((0.0, 0.0));
        ((slope(h, 0.0).0 - slope(-h, 0.0).0) / (2.0 * h), (slope(0.0, h).1 - slope(0.0, -h).1) / (2.0 * h))
    }
}

/// A surface given by its sag at the points of a grid.
///
/// Use it for a measured surface (an interferogram, a profilometer's scan) or one computed elsewhere. The grid has square
/// cells and is centered on the vertex. Between its points the sag is the tensor product of cubic splines, continuous to
/// the second derivative, so cubic surfaces are reproduced exactly. There is no surface beyond the outermost points: rays
/// that pass there count as missed.
///
/// Rows run along x from the smallest to the largest; the first row has the smallest y. Write the sags in the lens file
/// itself (`sag`) or in a CSV file (`file`), one row per line, with commas between the numbers. Lines that begin with `#`
/// are ignored.
///
/// # Example
/// ```yaml
/// {kind: sag-table, step: 0.5 mm, file: measured.csv, thickness: 3, glass: SCHOTT/N-BK7, semi-diameter: 0.7}
/// ```
/// ```yaml
/// kind: sag-table
/// step: 2 mm
/// sag:
///   - [0.18, 0.10, 0.10, 0.18]
///   - [0.10, 0.02, 0.02, 0.10]
///   - [0.10, 0.02, 0.02, 0.10]
///   - [0.18, 0.10, 0.10, 0.18]
/// thickness: 3
/// glass: SCHOTT/N-BK7
/// semi-diameter: 3
/// ```
/// # References
/// - C. de Boor, "Bicubic spline interpolation", J. Math. and Phys. 41, 212 (1962).
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct SagTableParams {
    /// Distance between neighboring points, along x and along y, mm if bare, more than 0.
    step: Positive<Length>,
    /// Rows of sags in mm: rows in order of ascending y, the sags of a row in order of ascending x; 4 to 1024 per side. Write
    /// either this or `file`.
    #[serde(default)]
    #[schemars(length(min = FEWEST, max = MOST), inner(length(min = FEWEST, max = MOST)))]
    sag: Option<Vec<Vec<f64>>>,
    /// CSV file beside the scene with the rows of sags, mm; empty lines and lines that begin with `#` are ignored. Write
    /// either this or `sag`.
    #[serde(default)]
    file: Option<String>,
}

spectra_core::register!(surface "sag-table": SagTableParams, build);

fn build(params: &Params, context: &Context<'_>) -> Result<Box<dyn Surface>, Faults> {
    let p: SagTableParams = params.parse()?;
    let (key, rows) = match (p.sag, p.file) {
        (Some(rows), None) => ("sag", rows),
        (None, Some(file)) => ("file", read(params, context, &file)?),
        (None, None) => {
            return Err(params
                .fault_here("no sags are given")
                .hint("write `sag: [[...], ...]` or `file: NAME.csv`")
                .into());
        }
        (Some(_), Some(_)) => {
            return Err(params.fault("file", "both `sag` and `file` are given").hint("leave one of them out").into());
        }
    };
    let mut faults = Faults::new();
    let columns = rows.first().map_or(0, Vec::len);
    for (what, count) in [("rows", rows.len()), ("columns", columns)] {
        if !(FEWEST..=MOST).contains(&count) {
            faults.push(params.fault(key, format!("{count} {what}; a table needs {FEWEST} to {MOST}")));
        }
    }
    for (j, row) in rows.iter().enumerate() {
        let place = if key == "sag" { format!("sag[{j}]") } else { key.to_owned() };
        if row.len() != columns {
            let text = format!("row {} has {} numbers, the first has {columns}", j + 1, row.len());
            faults.push(params.fault(&place, text));
        }
        if let Some(i) = row.iter().position(|v| !v.is_finite()) {
            faults.push(params.fault(&place, format!("row {}, number {}: {} is not finite", j + 1, i + 1, row[i])));
        }
    }
    match SagTable::new(p.step.mm(), &rows) {
        Some(table) if faults.is_empty() => Ok(Box::new(PerRay(FromSag(table)))),
        _ => Err(faults),
    }
}

/// Reads the rows of sags (mm) from a CSV file.
fn read(params: &Params, context: &Context<'_>, file: &str) -> Result<Vec<Vec<f64>>, Faults> {
    let fault = |text: String| Faults::from(params.fault("file", text));
    let found = context.resources.read(file, &[], &[], MAX_BYTES).map_err(|e| fault(format!("{file}: {e}")))?;
    let Ok(text) = std::str::from_utf8(&found.bytes) else {
        return Err(fault(format!("{}: this is not a text file", found.name)));
    };
    let mut rows = Vec::new();
    for (number, line) in (1..).zip(text.lines()) {
        let line = line.trim();
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let row: Result<Vec<f64>, String> =
            line.split(',').map(|cell| cell.trim().parse().map_err(|_| cell.trim().to_owned())).collect();
        rows.push(row.map_err(|cell| {
            let cell: String = cell.chars().take(40).collect();
            fault(format!("{}, line {number}: `{cell}` is not a number", found.name))
        })?);
        if rows.len() > MOST {
            return Err(fault(format!("{}: more than {MOST} rows", found.name)));
        }
    }
    Ok(rows)
}
