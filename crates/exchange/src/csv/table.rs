//! Rows to surfaces.

use super::columns::{Column, HINT, by_name};
use crate::place::{Source, shown};
use crate::prescription::{Item, Medium, Prescription, Shape, Surface};
use crate::{MAX_ITEMS, glass, number};
use spectra_core::params::Faults;

/// Reads the text of a table; `name` is how faults name it.
///
/// # Errors
/// No usable columns, no rows, several lenses in one table, and each cell that cannot be read, with its place.
pub fn read(name: &str, text: &str) -> Result<Prescription, Faults> {
    let source = Source::new(name, text);
    let mut rows = source.text().lines().enumerate().filter(|(_, line)| {
        let line = line.trim();
        !line.is_empty() && !line.starts_with('#')
    });
    let mut faults = Faults::new();
    let Some((_, head)) = rows.next() else {
        return Err(source.fault_here("the table is empty").hint(HINT).into());
    };
    let separator = [';', '\t'].into_iter().find(|c| head.contains(*c)).unwrap_or(',');
    let mut columns = Vec::new();
    for cell in cells(head, separator) {
        let column = by_name(cell);
        let doubled = column.is_some_and(|column| columns.contains(&Some(column)));
        if doubled {
            faults.push(source.fault(cell, format!("column `{}` comes twice", shown(cell))));
        }
        if column.is_none() && !cell.is_empty() {
            faults.push(source.fault(cell, format!("unknown column `{}`", shown(cell))).hint(HINT));
        }
        columns.push(column);
    }
    if !columns.iter().flatten().any(|c| matches!(c, Column::Radius | Column::Curvature)) {
        faults.push(source.fault_here("no column `radius`").hint(HINT));
    }
    let mut lens = Prescription::default();
    for (at, line) in rows {
        if lens.items.len() >= MAX_ITEMS {
            faults.push(source.fault(line, format!("more than {MAX_ITEMS} surfaces")));
            break;
        }
        let mut row = Row { line: at + 1, separator, source: &source, faults: &mut faults, cells: Vec::new() };
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
    if lens.items.is_empty() && faults.is_empty() {
        faults.push(source.fault_here("the table has no surfaces"));
    }
    faults.into_result(lens)
}

/// Cells of a line, without blanks and quotes around them.
fn cells(line: &str, separator: char) -> Vec<&str> {
    let mut cells = Vec::new();
    let mut quoted = false;
    let mut start = 0;
    for (at, c) in line.char_indices() {
        if c == '"' {
            quoted = !quoted;
        } else if c == separator && !quoted {
            cells.push(&line[start..at]);
            start = at + c.len_utf8();
        }
    }
    cells.push(&line[start..]);
    cells.into_iter().map(|cell| cell.trim().trim_matches('"').trim()).collect()
}

struct Row<'a, 'f> {
    line: usize,
    separator: char,
    source: &'a Source,
    faults: &'f mut Faults,
    cells: Vec<(Column, &'a str)>,
}

impl<'a> Row<'a, '_> {
    /// What stands in a column; `None` where nothing does.
    fn text(&self, column: Column) -> Option<&'a str> {
        self.cells.iter().find(|(c, cell)| *c == column && !cell.is_empty()).map(|(_, cell)| *cell)
    }

    fn number(&mut self, column: Column) -> Option<f64> {
        let cell = self.text(column)?;
        self.parse(cell)
    }

    fn parse(&mut self, cell: &str) -> Option<f64> {
        let value = match self.separator {
            ',' => number::parse(cell),
            _ => number::parse(&cell.replacen(',', ".", 1)),
        };
        if value.is_none() {
            self.faults.push(self.source.fault(cell, format!("`{}` is not a number", shown(cell))));
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
                lens.name = shown(name);
            } else if lens.name != shown(name) {
                let fault = self.source.fault(name, format!("a second lens, `{}`, after `{}`", shown(name), lens.name));
                self.faults.push(fault.hint("a table holds one lens: take the rows of one"));
                return;
            }
        }
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
        let stop = kind == "stop" || kind == "aperture" || marked(Column::Number) || marked(Column::Comment);
        let mirror =
            kind == "mirror" || self.text(Column::Glass).is_some_and(|cell| cell.eq_ignore_ascii_case("mirror"));
        let radius = self.radius();
        let medium = if mirror { Medium::Air } else { self.medium(lens) };
        let semi_diameter_mm = match self.finite(Column::SemiDiameter) {
            Some(size) => Some(size),
            None => self.finite(Column::Diameter).map(|d| d / 2.0),
        };
        let shape = self.shape(&kind, radius, lens);
        let air_before = lens.surfaces().last().is_none_or(|last| last.medium == Medium::Air);
        let bends_nothing = shape == Shape::Plane && medium == Medium::Air && air_before && !mirror;
        lens.items.push(Item::Surface(Box::new(Surface {
            shape: if stop && (bends_nothing || kind == "stop" && shape == Shape::Plane) { Shape::Stop } else { shape },
            thickness_mm: thickness,
            medium,
            mirror,
            stop,
            semi_diameter_mm: semi_diameter_mm.filter(|size| *size > 0.0),
            comment: self.text(Column::Comment).map(shown).unwrap_or_default(),
            ..Surface::default()
        })));
    }

    fn radius(&mut self) -> f64 {
        if let Some(cell) = self.text(Column::Radius) {
            if ["plane", "plano", "flat", "-", "∞"].contains(&cell.to_ascii_lowercase().as_str()) {
                return f64::INFINITY;
            }
            let radius = self.number(Column::Radius).unwrap_or(f64::INFINITY);
            return if radius == 0.0 || radius.is_infinite() { f64::INFINITY } else { radius };
        }
        self.finite(Column::Curvature).map_or(f64::INFINITY, |curvature| number::radius_mm(curvature, 1.0))
    }

    fn medium(&mut self, lens: &mut Prescription) -> Medium {
        let (nd, vd) = (self.finite(Column::Index), self.finite(Column::Abbe));
        if let (Some(index), Some(cell)) = (nd, self.text(Column::Index))
            && !(1.0..=4.0).contains(&index)
        {
            self.faults.push(self.source.fault(cell, format!("an index of {index}")).hint("it lies between 1 and 4"));
            return Medium::Air;
        }
        let found = match (self.text(Column::Glass), nd) {
            (None, None) => return Medium::Air,
            (None, Some(nd)) => glass::model(nd, vd.unwrap_or(0.0)),
            (Some(name), Some(nd)) if nd != 1.0 => glass::look_up(name, Some((nd, vd.unwrap_or(0.0))), &[]),
            (Some(name), _) => glass::look_up(name, None, &[]),
        };
        if let Some((alters, text)) = found.note {
            lens.leave_out(self.line, alters, text);
        }
        found.medium
    }

    fn shape(&mut self, kind: &str, radius: f64, lens: &mut Prescription) -> Shape {
        let conic = self.finite(Column::Conic).unwrap_or(0.0);
        let coefficients = self.coefficients();
        match kind {
            "cyl-x" | "cylinder-x" | "cylx" if radius.is_finite() => return Shape::Cylinder { radius, along_x: true },
            "cyl-y" | "cylinder-y" | "cyly" if radius.is_finite() => return Shape::Cylinder { radius, along_x: false },
            "" | "spherical" | "sphere" | "standard" | "plane" | "plano" | "flat" | "stop" | "aperture" | "conic"
            | "aspherical" | "asphere" | "aspheric" | "even-asphere" | "evenasph" | "mirror" | "cyl-x" | "cyl-y"
            | "cylinder-x" | "cylinder-y" | "cylx" | "cyly" => {}
            other => {
                let text = format!("the type {} is unknown, carried as its sphere, conic or asphere", shown(other));
                lens.leave_out(self.line, true, text);
            }
        }
        if coefficients.is_empty() {
            Shape::conic(radius, conic)
        } else {
            Shape::EvenAsphere { radius, conic, coefficients }
        }
    }

    /// Of r^2, r^4, ...
    fn coefficients(&mut self) -> Vec<f64> {
        let mut coefficients = Vec::new();
        if let Some(cell) = self.text(Column::Coefficients) {
            for word in cell.split([' ', ';', '|']).filter(|word| !word.is_empty()).take(20) {
                let value = self.parse(word).unwrap_or(0.0);
                coefficients.push(value);
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
