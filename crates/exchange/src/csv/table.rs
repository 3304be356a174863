//! Converts the rows of a table to surfaces.

use super::cells::cells;
use super::columns::{self, Column, HINT, by_name};
use super::{patent, units};
use crate::glass::{Catalogs, UserCatalog};
use crate::prescription::{AxisItem, Medium, Prescription, Surface, SurfaceShape};
use crate::source::{Source, shortened};
use crate::{MAX_ITEMS, glass, number};
use spectra_core::params::{Fault, Faults};

/// Reads the text of a table. `name` is the name of the file in error messages; glasses are searched for in the catalogs `own`
/// first.
///
/// # Errors
/// The table has no usable columns, no rows or several lenses, or cells cannot be read; each such cell is reported with its
/// position.
pub fn read(name: &str, text: &str, own: &[UserCatalog]) -> Result<Prescription, Faults> {
    let printed = patent::plain(text);
    let retyped = patent::retype(&printed);
    let source = Source::new(name, retyped.as_ref().map_or(printed.as_str(), |retyped| retyped.text.as_str()));
    let mut rows = source.text().lines().enumerate().filter(|(_, line)| {
        let line = line.trim();
        !line.is_empty() && !line.starts_with('#')
    });
    let mut faults = Faults::new();
    let Some((_, head)) = rows.next() else {
        return Err(source.fault_here("the table is empty").hint(HINT).into());
    };
    let separator = [';', '\t'].into_iter().find(|c| head.contains(*c)).unwrap_or(',');
    if separator == ','
        && let Some(fault) = decimal_commas(&source, head, rows.clone().map(|(_, line)| line))
    {
        return Err(fault.into());
    }
    let mut columns = Vec::new();
    for cell in cells(head, separator) {
        let column = by_name(cell);
        let doubled = column.is_some_and(|column| columns.contains(&Some(column)));
        if doubled {
            faults.push(source.fault(cell, format!("column `{}` appears twice", shortened(cell))));
        }
        if column.is_none() && !cell.is_empty() {
            faults.push(source.fault(cell, format!("unknown column `{}`", shortened(cell))).hint(HINT));
        }
        columns.push(column);
    }
    if !columns.iter().flatten().any(|c| matches!(c, Column::Radius | Column::Curvature)) {
        faults.push(source.fault_here("no column `radius`").hint(HINT));
    }
    let units_mm = units_mm(&source, &cells(head, separator), &columns, &mut faults);
    if !columns.contains(&Some(Column::Thickness)) && rows.clone().next().is_some() {
        faults.push(source.fault_here("no column `thickness`").hint(HINT));
    }
    let mut lens = Prescription::default();
    if head_line_is_e(&cells(head, separator)) {
        lens.reference_line = Some("e".to_owned());
    }
    let mut seen = TableState { no_thickness: !columns.contains(&Some(Column::Thickness)), ..TableState::default() };
    for (at, line) in rows {
        if lens.items.len() >= MAX_ITEMS {
            faults.push(source.fault(line, format!("more than {MAX_ITEMS} surfaces")));
            break;
        }
        let mut row = RowReader {
            line: at + 1,
            separator,
            source: &source,
            faults: &mut faults,
            cells: Vec::new(),
            units_mm: &units_mm,
            seen: &mut seen,
            own,
        };
        for (at, cell) in cells(line, separator).into_iter().enumerate() {
            match columns.get(at) {
                Some(Some(column)) => row.cells.push((*column, cell)),
                _ if cell.is_empty() => {}
                Some(None) => {}
                None => row.faults.push(row.source.fault(cell, "this cell has no column")),
            }
        }
        row.surface(&mut lens);
    }
    for (line, alters, text) in retyped.into_iter().flat_map(|retyped| retyped.notes) {
        lens.leave_out(line, alters, text);
    }
    if let Some((line, count)) = seen.zero_radii {
        let rows = if count > 1 { format!(" ({count} rows)") } else { String::new() };
        lens.leave_out(line, false, format!("a radius of 0 is taken as a plane{rows}"));
    }
    lens.left_out.sort_by_key(|note| note.line);
    if lens.items.is_empty() && faults.is_empty() {
        faults.push(source.fault_here("the table has no surfaces"));
    }
    faults.into_result(lens)
}

/// Whether the indices are at the line e, according to their heading.
fn head_line_is_e(heads: &[&str]) -> bool {
    heads.iter().any(|head| head.eq_ignore_ascii_case("ne"))
}

/// State carried from row to row.
#[derive(Default)]
struct TableState {
    /// Whether the table has no column of thicknesses, which is reported once.
    no_thickness: bool,
    /// Latest number of a surface.
    number: Option<f64>,
    /// First line with a radius of 0, and the number of such lines.
    zero_radii: Option<(usize, usize)>,
}

/// Returns the unit (in mm) of each column that states a unit for lengths or their powers.
fn units_mm(source: &Source, heads: &[&str], columns: &[Option<Column>], faults: &mut Faults) -> Vec<(Column, f64)> {
    let mut found = Vec::new();
    let mut silent = Vec::new();
    for (head, column) in heads.iter().zip(columns) {
        let Some(column) = column.filter(|column| columns::power(*column).is_some()) else { continue };
        match units::split(head).1 {
            None => silent.push((head, column)),
            Some(unit) => match columns::unit_mm(unit, column) {
                Some(mm) => found.push((column, mm)),
                None => {
                    let text = format!("`{}` is not a unit for this column", shortened(unit));
                    let hint = match columns::power(column) {
                        Some(1) => units::HINT.to_owned(),
                        _ if column == Column::Coefficients => {
                            "write the unit of the lens, as in `coefficients [mm]`".to_owned()
                        }
                        power => format!("write a unit such as [mm^{}]", power.unwrap_or(1)),
                    };
                    faults.push(source.fault(head, text).hint(hint));
                }
            },
        }
    }
    if found.iter().any(|(_, mm)| *mm != 1.0) {
        for (head, column) in silent {
            let text = format!("`{}` states no unit, but other columns do", shortened(head));
            let power = match columns::power(column) {
                Some(power) if power != 1 && column != Column::Coefficients => format!("^{power}"),
                _ => String::new(),
            };
            let hint = format!("write it after the name, such as `{} [mm{power}]`", shortened(head));
            faults.push(source.fault(head, text).hint(hint));
        }
    }
    found
}

/// Returns a fault if commas both separate cells and are decimal commas: rows are longer than the header, and no number has a point.
fn decimal_commas<'a>(source: &Source, head: &str, rows: impl Iterator<Item = &'a str>) -> Option<Fault> {
    let columns = cells(head, ',').len();
    let (mut count, mut longer, mut first) = (0, 0, None);
    for row in rows {
        let found = cells(row, ',');
        if found.iter().any(|cell| cell.contains('.') && number::parse(cell).is_some()) {
            return None;
        }
        count += 1;
        let filled = found.iter().rposition(|cell| !cell.is_empty()).map_or(0, |at| at + 1);
        if filled > columns {
            longer += 1;
            first.get_or_insert((row, filled));
        }
    }
    let (row, filled) = first.filter(|_| 2 * longer >= count)?;
    let text =
        format!("{filled} cells, but the header has {columns}: commas seem to be in numbers as well as between cells");
    Some(source.fault(row, text).hint("write numbers with a decimal point, or separate cells with semicolons or tabs"))
}

/// Returns a hint for a cell that is not a number.
fn hint_of(cell: &str) -> Option<String> {
    if patent::is_variable(cell) {
        let text = "the gap varies with zoom or focus: write its value at one setting, in mm, from the patent's table of variable gaps";
        return Some(text.to_owned());
    }
    let point = cell.replacen(',', ".", 1);
    if number::parse(&point).is_some() {
        return Some(format!(
            "write it with a point, `{}`, or separate cells with semicolons or tabs",
            shortened(&point)
        ));
    }
    let at = cell.find(|c: char| !(c.is_ascii_digit() || "+-.,".contains(c)))?;
    let (figure, unit) = cell.split_at(at);
    number::parse(&figure.replacen(',', ".", 1))?;
    units::length_mm(unit)?;
    let unit = unit.trim();
    Some(format!("write the unit in the column header, such as `radius [{unit}]`, and here `{figure}`"))
}

struct RowReader<'a, 'f> {
    line: usize,
    separator: char,
    source: &'a Source,
    faults: &'f mut Faults,
    cells: Vec<(Column, &'a str)>,
    units_mm: &'f [(Column, f64)],
    seen: &'f mut TableState,
    /// Catalogs that are searched for glasses first.
    own: &'a [UserCatalog],
}

impl<'a> RowReader<'a, '_> {
    /// Text of the cell in a column; `None` if it is empty or missing.
    fn text(&self, column: Column) -> Option<&'a str> {
        self.cells.iter().find(|(c, cell)| *c == column && !cell.is_empty()).map(|(_, cell)| *cell)
    }

    /// Parses a number. Lengths and their powers are converted to mm.
    fn number(&mut self, column: Column) -> Option<f64> {
        let cell = self.text(column)?;
        let value = self.parse(cell)?;
        Some(columns::power(column).map_or(value, |power| self.in_mm(column, value, power)))
    }

    /// Converts a value of a column to mm to a power.
    fn in_mm(&self, column: Column, value: f64, power: i32) -> f64 {
        let mm = self.units_mm.iter().find(|(known, _)| *known == column).map_or(1.0, |(_, mm)| *mm);
        let scale = (0..power.unsigned_abs()).fold(1.0, |product, _| product * mm);
        if power < 0 { value / scale } else { value * scale }
    }

    /// Checks that the surface numbers rise, since rows are in the order of the light.
    fn count(&mut self) {
        let Some(cell) = self.text(Column::Number) else { return };
        let Some(number) = number::parse(cell).filter(|number| number.is_finite()) else { return };
        if let Some(last) = self.seen.number.filter(|last| number <= *last) {
            let fault = self.source.fault(cell, format!("surface {number} comes after surface {last}"));
            self.faults
                .push(fault.hint("write rows in the order of the light, with numbers that rise from row to row"));
        }
        self.seen.number = Some(number);
    }

    fn parse(&mut self, cell: &str) -> Option<f64> {
        let value = match self.separator {
            ',' => number::parse(&patent::figure(cell)),
            _ => number::parse(&patent::figure(&cell.replacen(',', ".", 1))),
        };
        if value.is_none() {
            let fault = self.source.fault(cell, format!("`{}` is not a number", shortened(cell)));
            self.faults.push(match hint_of(cell) {
                Some(hint) => fault.hint(hint),
                None => fault,
            });
        }
        value
    }

    fn finite(&mut self, column: Column) -> Option<f64> {
        let value = self.number(column)?;
        if !value.is_finite() {
            let cell = self.text(column).unwrap_or_default();
            self.faults.push(self.source.fault(cell, "a finite number is needed here"));
        }
        Some(value)
    }

    fn surface(&mut self, lens: &mut Prescription) {
        if let Some(name) = self.text(Column::Lens) {
            if lens.items.is_empty() && lens.name.is_empty() {
                lens.name = shortened(name);
            } else if lens.name != shortened(name) {
                let fault =
                    self.source.fault(name, format!("a second lens, `{}`, after `{}`", shortened(name), lens.name));
                self.faults.push(fault.hint("a table holds one lens: keep the rows of one"));
                return;
            }
        }
        self.count();
        let kind = self.text(Column::Kind).unwrap_or_default().to_ascii_lowercase();
        let thickness = self.number(Column::Thickness).unwrap_or(0.0);
        match kind.as_str() {
            "object" | "obj" => {
                lens.object_distance_mm = thickness.is_finite().then_some(thickness);
                return;
            }
            "image" | "img" => return,
            _ => {}
        }
        if !thickness.is_finite() {
            let cell = self.text(Column::Thickness).unwrap_or_default();
            self.faults.push(self.source.fault(cell, "a finite thickness is needed here"));
        }
        let marked = |column| self.text(column).is_some_and(|cell| cell.eq_ignore_ascii_case("stop"));
        let stop = kind == "stop"
            || kind == "aperture"
            || marked(Column::Number)
            || self.text(Column::Comment).is_some_and(patent::is_stop_phrase)
            || marked(Column::Radius);
        let mirror =
            kind == "mirror" || self.text(Column::Glass).is_some_and(|cell| cell.eq_ignore_ascii_case("mirror"));
        let radius = self.radius();
        let medium = if mirror { Medium::Air } else { self.medium(lens) };
        if medium != Medium::Air && !self.seen.no_thickness && self.text(Column::Thickness).is_none() {
            let cell = self.text(Column::Glass).or(self.text(Column::Index)).unwrap_or_default();
            let fault = self.source.fault(cell, "the glass behind this surface needs a thickness");
            self.faults
                .push(fault.hint("fill in `thickness`, the distance to the next surface; write 0 where they touch"));
        }
        let semi_diameter_mm = match self.finite(Column::SemiDiameter) {
            Some(size) => Some(size),
            None => self.finite(Column::Diameter).map(|d| d / 2.0),
        };
        let shape = self.shape(&kind, radius, lens);
        let air_before = lens.surfaces().last().is_none_or(|last| last.medium == Medium::Air);
        let bends_nothing = shape == SurfaceShape::Plane && medium == Medium::Air && air_before && !mirror;
        lens.items.push(AxisItem::Surface(Box::new(Surface {
            shape: if stop && (bends_nothing || kind == "stop" && shape == SurfaceShape::Plane) {
                SurfaceShape::Stop
            } else {
                shape
            },
            thickness_mm: thickness,
            medium,
            mirror,
            stop,
            semi_diameter_mm: semi_diameter_mm.filter(|size| *size > 0.0),
            comment: self.text(Column::Comment).map(shortened).unwrap_or_default(),
            ..Surface::default()
        })));
    }

    fn radius(&mut self) -> f64 {
        if let Some(cell) = self.text(Column::Radius) {
            if ["plane", "plano", "flat", "-", "∞", "stop"].contains(&cell.to_ascii_lowercase().as_str()) {
                return f64::INFINITY;
            }
            let radius = self.number(Column::Radius).unwrap_or(f64::INFINITY);
            if radius == 0.0 {
                self.seen.zero_radii = Some(self.seen.zero_radii.map_or((self.line, 1), |(line, n)| (line, n + 1)));
            }
            return if radius == 0.0 || radius.is_infinite() { f64::INFINITY } else { radius };
        }
        self.finite(Column::Curvature).map_or(f64::INFINITY, |curvature| number::radius_mm(curvature, 1.0))
    }

    fn medium(&mut self, lens: &mut Prescription) -> Medium {
        let catalogues = Catalogs { own: self.own, ..Catalogs::default() };
        let (nd, vd) = (self.finite(Column::Index), self.finite(Column::Abbe));
        if let (Some(index), Some(cell)) = (nd, self.text(Column::Index))
            && !(1.0..=4.0).contains(&index)
        {
            self.faults.push(self.source.fault(cell, format!("an index of {index}")).hint("write one from 1 to 4"));
            return Medium::Air;
        }
        let found = match (self.text(Column::Glass), nd) {
            (None, None) => return Medium::Air,
            (None, Some(nd)) => glass::model(nd, vd.unwrap_or(0.0)),
            (Some(name), Some(nd)) if nd != 1.0 => glass::look_up(name, Some((nd, vd.unwrap_or(0.0))), catalogues),
            (Some(name), _) => glass::look_up(name, None, catalogues),
        };
        if let Some((alters, text)) = found.note {
            lens.leave_out(self.line, alters, text);
        }
        found.medium
    }

    fn shape(&mut self, kind: &str, radius: f64, lens: &mut Prescription) -> SurfaceShape {
        let conic = self.finite(Column::Conic).unwrap_or(0.0);
        let coefficients = self.coefficients();
        match kind {
            "cyl-x" | "cylinder-x" | "cylx" if radius.is_finite() => {
                return SurfaceShape::Cylinder { radius, along_x: true };
            }
            "cyl-y" | "cylinder-y" | "cyly" if radius.is_finite() => {
                return SurfaceShape::Cylinder { radius, along_x: false };
            }
            "" | "spherical" | "sphere" | "standard" | "plane" | "plano" | "flat" | "stop" | "aperture" | "conic"
            | "aspherical" | "asphere" | "aspheric" | "even-asphere" | "evenasph" | "mirror" | "cyl-x" | "cyl-y"
            | "cylinder-x" | "cylinder-y" | "cylx" | "cyly" => {}
            other => {
                let text = format!("the type {} is unknown, carried as its sphere, conic or asphere", shortened(other));
                lens.leave_out(self.line, true, text);
            }
        }
        if coefficients.is_empty() {
            SurfaceShape::conic(radius, conic)
        } else {
            SurfaceShape::EvenAsphere { radius, conic, coefficients }
        }
    }

    /// Returns the coefficients of r^2, r^4, ..., without zeros at the end.
    fn coefficients(&mut self) -> Vec<f64> {
        let mut coefficients = Vec::new();
        if let Some(cell) = self.text(Column::Coefficients) {
            for word in cell.split([' ', ';', '|']).filter(|word| !word.is_empty()).take(20) {
                let value = self.parse(word).unwrap_or(0.0);
                let power = -1 - 2 * coefficients.len() as i32;
                coefficients.push(self.in_mm(Column::Coefficients, value, power));
            }
        }
        for power in (2..=40).step_by(2) {
            if let Some(value) = self.finite(Column::Coefficient(power)) {
                let at = power as usize / 2 - 1;
                coefficients.resize(coefficients.len().max(at + 1), 0.0);
                coefficients[at] = value;
            }
        }
        while coefficients.last() == Some(&0.0) {
            coefficients.pop();
        }
        coefficients
    }
}
