//! Converts surface types to shapes.

use super::surface::Block;
use crate::prescription::{Prescription, SurfaceShape, ZernikeOrdering};

/// Largest number of coefficients of an asphere in a lens file.
const MOST_COEFFICIENTS: usize = 20;
/// Largest number of unused values that are listed for a surface.
const MOST_SHOWN: usize = 6;

impl Block {
    /// Returns the shape of a surface, and notes what cannot be carried over. `number` is the number of the surface in the file.
    pub(super) fn shape(&self, number: usize, lens: &mut Prescription) -> SurfaceShape {
        let (radius, conic) = (self.curvature_radius_mm, self.conic);
        let simple = SurfaceShape::conic(radius, conic);
        let value = |at: u32| self.parameters.get(at);
        match self.kind.as_str() {
            "STANDARD" => simple,
            "EVENASPH" => even(radius, conic, self.polynomial(1..=8, 2, 2)),
            "ODDASPHE" => {
                let coefficients = self.polynomial(1..=8, 1, 1);
                if coefficients.is_empty() { simple } else { SurfaceShape::OddAsphere { radius, conic, coefficients } }
            }
            "XASPHERE" => {
                // Add both kinds of terms, since they have the same powers.
                let terms = self.polynomial(1..=8, 2, 2);
                even(radius, conic, self.extended(number, 2, terms, lens))
            }
            "XOSPHERE" => {
                let coefficients = self.extended(number, 1, Vec::new(), lens);
                if coefficients.is_empty() { simple } else { SurfaceShape::OddAsphere { radius, conic, coefficients } }
            }
            "TOROIDAL" => self.toroid(number, lens),
            "BICONICX" => {
                let radius_x = if value(1) == 0.0 { f64::INFINITY } else { value(1) * self.unit_mm };
                SurfaceShape::Biconic { radius_x, radius_y: radius, conic_x: value(2), conic_y: conic }
            }
            "TILTSURF" => SurfaceShape::TiltedPlane { tan_x: value(1), tan_y: value(2) },
            "PARAXIAL" => {
                // Ignore how optical paths are counted.
                self.parameters.set_aside([2]);
                let focal_length = value(1) * self.unit_mm;
                if focal_length == 0.0 { SurfaceShape::Plane } else { SurfaceShape::ThinLens { focal_length } }
            }
            "DGRATING" => {
                if conic != 0.0 {
                    lens.leave_out(
                        self.line,
                        true,
                        format!("surface {number}: the conic constant {conic} of a grating"),
                    );
                }
                let text = "a positive order of a grating is assumed to turn light toward +y";
                lens.leave_out(self.line, false, format!("surface {number}: {text}"));
                // The number of lines is not negative: the order has the sign.
                let sign = if value(1) < 0.0 { -1.0 } else { 1.0 };
                let (lines_per_mm, order) = (sign * value(1) * 1000.0, sign * value(2));
                SurfaceShape::Grating { lines_per_mm, order, radius, conic: 0.0, direction_deg: 0.0 }
            }
            "SZERNSAG" => self.zernike(number, ZernikeOrdering::Noll, lens).unwrap_or(simple),
            "FZERNSAG" => self.zernike(number, ZernikeOrdering::Fringe, lens).unwrap_or(simple),
            other => {
                self.parameters.set_all_aside();
                self.extra.set_all_aside();
                let what = if matches!(simple, SurfaceShape::Plane) { "a plane" } else { "its sphere or conic" };
                let other = crate::source::shortened(other);
                lens.leave_out(
                    self.line,
                    true,
                    format!("surface {number}: type {other} is unknown, carried as {what}"),
                );
                simple
            }
        }
    }

    /// Returns parameters as coefficients of the powers `first`, `first + step`, ... of a length, in mm, without zeros at the end.
    fn polynomial(&self, parameters: std::ops::RangeInclusive<u32>, first: u32, step: u32) -> Vec<f64> {
        let mut power = first;
        let mut coefficients = Vec::new();
        for at in parameters {
            coefficients.push(self.parameters.get(at) / power_of(self.unit_mm, power - 1));
            power += step;
        }
        trimmed(coefficients)
    }

    /// Returns the coefficients of an extended asphere, sum of a_i (r / R)^(step i), added to `others` of the same powers. Extra data 1 is
    /// the number of terms, 2 is R, and then a_1, ... follow.
    fn extended(&self, number: usize, step: u32, others: Vec<f64>, lens: &mut Prescription) -> Vec<f64> {
        let value = |at: u32| self.extra.get(at);
        let terms = value(1).clamp(0.0, 240.0) as u32;
        let normalization = if value(2) == 0.0 { 1.0 } else { value(2) } * self.unit_mm;
        let mut coefficients = others;
        coefficients.resize(coefficients.len().max(terms as usize), 0.0);
        for (i, coefficient) in (1..=terms).zip(&mut coefficients) {
            *coefficient += value(2 + i) * self.unit_mm / power_of(normalization, step * i);
        }
        let mut coefficients = trimmed(coefficients);
        if coefficients.len() > MOST_COEFFICIENTS || coefficients.iter().any(|a| !a.is_finite()) {
            let most = step as usize * MOST_COEFFICIENTS;
            let text = format!("surface {number}: coefficients of an asphere beyond r^{most}");
            lens.leave_out(self.line, true, text);
            coefficients.truncate(MOST_COEFFICIENTS);
            coefficients.retain(|a| a.is_finite());
        }
        coefficients
    }

    /// Returns a toroid. Parameter 1 is the radius of rotation (0 for none), followed by the coefficients of y^2, y^4, ...; extra data are
    /// Zernike terms.
    fn toroid(&self, number: usize, lens: &mut Prescription) -> SurfaceShape {
        let terms = self.extra.get(1);
        self.extra.set_aside([2]);
        if terms > 0.0 && !self.extra.unused().is_empty() {
            self.extra.set_all_aside();
            lens.leave_out(self.line, true, format!("surface {number}: Zernike terms of a toroid"));
        }
        let stated = self.parameters.get(1);
        let rotation_radius = if stated == 0.0 { f64::INFINITY } else { stated * self.unit_mm };
        let coefficients = self.polynomial(2..=8, 2, 2);
        let (radius, conic) = (self.curvature_radius_mm, self.conic);
        match (radius.is_infinite(), rotation_radius.is_infinite()) {
            (true, true) if coefficients.is_empty() => SurfaceShape::Plane,
            (false, true) if coefficients.is_empty() && conic == 0.0 => {
                SurfaceShape::Cylinder { radius, along_x: true }
            }
            (true, false) if coefficients.is_empty() => {
                SurfaceShape::Cylinder { radius: rotation_radius, along_x: false }
            }
            _ => SurfaceShape::Toroid { radius, conic, coefficients, rotation_radius },
        }
    }

    /// Returns a Zernike surface. Extra data are the number of terms, the normalization radius and the coefficients. The parameters are an
    /// even asphere and a decenter, which a lens file does not have: unless all of them are 0, returns `None`.
    fn zernike(&self, number: usize, ordering: ZernikeOrdering, lens: &mut Prescription) -> Option<SurfaceShape> {
        let value = |at: u32| self.extra.get(at);
        // Ignore how far the surface extends beyond its radius.
        self.parameters.set_aside([0]);
        if !self.parameters.unused().is_empty() {
            self.parameters.set_all_aside();
            self.extra.set_all_aside();
            let text =
                format!("surface {number}: Zernike sag with an asphere or a decenter, carried as its sphere or conic");
            lens.leave_out(self.line, true, text);
            return None;
        }
        let terms = value(1).clamp(0.0, 240.0) as u32;
        let coefficients = trimmed((1..=terms).map(|i| value(2 + i) * self.unit_mm).collect());
        let normalization_radius = value(2) * self.unit_mm;
        if coefficients.is_empty() || normalization_radius <= 0.0 {
            return None;
        }
        let (radius, conic) = (self.curvature_radius_mm, self.conic);
        Some(SurfaceShape::Zernike { radius, conic, normalization_radius, coefficients, ordering })
    }

    /// Notes values that the type of the surface does not use.
    pub(super) fn note_unused(&self, number: usize, lens: &mut Prescription) {
        for (what, numbers) in [("parameter", &self.parameters), ("extra data", &self.extra)] {
            let unused = numbers.unused();
            let of = |(at, value): &(u32, f64)| format!("{at} ({})", crate::number::shortest(*value));
            let shown: Vec<String> = unused.iter().take(MOST_SHOWN).map(of).collect();
            if !shown.is_empty() {
                let more = unused.len() - shown.len();
                let more = if more > 0 { format!(" and {more} more") } else { String::new() };
                let kind = crate::source::shortened(&self.kind);
                let text = format!("surface {number}: {what} {}{more} of {kind}", shown.join(", "));
                lens.leave_out(self.line, true, text);
            }
        }
    }
}

fn even(radius: f64, conic: f64, coefficients: Vec<f64>) -> SurfaceShape {
    if coefficients.is_empty() {
        SurfaceShape::conic(radius, conic)
    } else {
        SurfaceShape::EvenAsphere { radius, conic, coefficients }
    }
}

/// Removes zeros at the end.
fn trimmed(mut coefficients: Vec<f64>) -> Vec<f64> {
    while coefficients.last() == Some(&0.0) {
        coefficients.pop();
    }
    coefficients
}

/// Computes an integer power by multiplication, so that the bits are the same on all machines.
pub(super) fn power_of(base: f64, power: u32) -> f64 {
    (0..power).fold(1.0, |product, _| product * base)
}
