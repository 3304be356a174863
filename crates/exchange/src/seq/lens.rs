//! Builds a prescription from the data that the commands have defined.

use super::glass::{self, Private};
use crate::glass::UserCatalog;
use crate::number;
use crate::prescription::{
    ApertureShape, AxisItem, CoordinateBreak, Displacement, Medium, Prescription, Surface, SurfaceShape,
};
use std::collections::BTreeMap;

/// Distance (mm) from which on an object counts as at infinity.
const INFINITY_MM: f64 = 1e10;

/// Role of a surface in the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Role {
    Object,
    Surface,
    Image,
}

/// Shapes that a command names; without one the surface is a conic.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SurfaceType {
    Conic,
    Asphere,
    Cylinder,
    ToroidY,
    ToroidX,
    Anamorphic,
}

/// Effect of a decenter on what follows its surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum DecenterKind {
    /// Applies to everything that follows.
    Basic,
    /// Applies to this surface only.
    AndReturn,
    /// Undone behind the surface.
    Reverse,
    /// Applied once more behind a mirror, so that the axis follows the light.
    Bend,
}

/// A decenter as stated: lengths in the file's unit, angles in degrees. Angles about x and y are left-handed in the file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Decenter {
    pub(super) kind: DecenterKind,
    pub(super) shift: [f64; 3],
    pub(super) turn: [f64; 3],
}

/// An aperture as stated, in the file's unit.
#[derive(Clone, Debug)]
pub(super) struct Aperture {
    use_of: u8,
    label: String,
    pub(super) shape: Option<ApertureShape>,
    pub(super) center: [f64; 2],
}

impl Aperture {
    /// Use of an aperture: light passes inside.
    pub(super) const CLEAR: u8 = 0;
    /// Use of an aperture: the edge of the element.
    pub(super) const EDGE: u8 = 1;
    /// Use of an aperture: light is blocked inside.
    pub(super) const OBSCURES: u8 = 2;
    /// Use of an aperture: a hole in the element.
    pub(super) const HOLE: u8 = 3;
}

/// A surface, the object or the image, as stated.
#[derive(Clone, Debug)]
pub(super) struct Raw {
    pub(super) role: Role,
    pub(super) line: usize,
    /// Radius or curvature in the y-z plane.
    pub(super) bend: f64,
    /// Whether `bend` is a radius, if the command says so.
    pub(super) bend_is_radius: Option<bool>,
    /// Radius or curvature in the x-z plane, and whether it is a radius.
    pub(super) bend_x: Option<(f64, bool)>,
    pub(super) thickness: f64,
    /// Whether the line that began the surface states its radius or curvature, and its thickness.
    pub(super) stated: [bool; 2],
    glass: Option<String>,
    pub(super) mirror: bool,
    pub(super) stop: bool,
    pub(super) form: SurfaceType,
    pub(super) conic: f64,
    pub(super) conic_x: f64,
    /// Coefficients by power.
    pub(super) coefficients: BTreeMap<u32, f64>,
    apertures: Vec<Aperture>,
    pub(super) decenter: Decenter,
    pub(super) comment: String,
}

impl Raw {
    pub(super) fn new(role: Role, line: usize) -> Self {
        Self {
            role,
            line,
            bend: 0.0,
            bend_is_radius: None,
            bend_x: None,
            thickness: 0.0,
            stated: [false; 2],
            glass: None,
            mirror: false,
            stop: false,
            form: SurfaceType::Conic,
            conic: 0.0,
            conic_x: 0.0,
            coefficients: BTreeMap::new(),
            apertures: Vec::new(),
            decenter: Decenter { kind: DecenterKind::Basic, shift: [0.0; 3], turn: [0.0; 3] },
            comment: String::new(),
        }
    }

    /// Whether the line that began the surface states the value of a command.
    pub(super) fn states(&self, command: &str) -> bool {
        match command {
            "RDY" | "CUY" => self.stated[0],
            "THI" => self.stated[1],
            _ => false,
        }
    }

    pub(super) fn set_glass(&mut self, name: &str) {
        if name.to_ascii_uppercase().starts_with("REFL") {
            self.mirror = true;
        } else {
            self.glass = Some(crate::source::shortened(name));
        }
    }

    /// Returns the aperture with this use and label, adding it if there is none.
    pub(super) fn aperture(&mut self, use_of: u8, label: &str) -> &mut Aperture {
        let known = self.apertures.iter().position(|a| a.use_of == use_of && a.label == label);
        let at = known.unwrap_or_else(|| {
            self.apertures.push(Aperture { use_of, label: label.to_owned(), shape: None, center: [0.0; 2] });
            self.apertures.len() - 1
        });
        &mut self.apertures[at]
    }

    /// Whether the surface has a shape beyond its radius in y-z.
    fn has_form(&self) -> bool {
        let is_set = |value: f64| value != 0.0;
        self.form != SurfaceType::Conic
            || is_set(self.conic)
            || is_set(self.conic_x)
            || self.bend_x.is_some_and(|(value, _)| is_set(value))
            || self.coefficients.values().any(|value| is_set(*value))
    }

    fn radius_mm(&self, radius_mode: bool, unit_mm: f64) -> f64 {
        radius(self.bend, self.bend_is_radius.unwrap_or(radius_mode), unit_mm)
    }
}

/// Returns the radius (mm) from a stated radius or curvature.
fn radius(value: f64, is_radius: bool, unit_mm: f64) -> f64 {
    match is_radius {
        _ if value == 0.0 || !value.is_finite() => f64::INFINITY,
        true => value * unit_mm,
        false => number::radius_mm(value, unit_mm),
    }
}

/// Fills in the prescription.
pub(super) fn build(
    lens: &mut Prescription,
    raws: &[Raw],
    mode: Option<bool>,
    unit_mm: f64,
    glasses: (&[Private], &[UserCatalog]),
) {
    let (private, own) = glasses;
    let radius_mode = mode.unwrap_or_else(|| guess_mode(lens, raws));
    let mut medium = Medium::Air;
    let mut number = 0;
    for raw in raws {
        let thickness_mm = raw.thickness * unit_mm;
        match raw.role {
            Role::Object => {
                if thickness_mm.abs() < INFINITY_MM {
                    lens.object_distance_mm = Some(thickness_mm);
                }
                object(lens, raw, radius_mode, unit_mm);
                continue;
            }
            Role::Image => {
                image(lens, raw, thickness_mm, radius_mode, unit_mm);
                continue;
            }
            Role::Surface => number += 1,
        }
        let thickness_mm = if thickness_mm.is_finite() {
            thickness_mm
        } else {
            lens.leave_out(raw.line, true, format!("surface {number}: its infinite thickness is set to 0"));
            0.0
        };
        let before = medium.clone();
        if !raw.mirror {
            medium = match &raw.glass {
                None => Medium::Air,
                Some(name) => {
                    let found = glass::medium(name, private, own);
                    if let Some((alters, text)) = found.note {
                        lens.leave_out(raw.line, alters, format!("surface {number}: {text}"));
                    }
                    found.medium
                }
            };
        }
        let mut surface = Surface {
            shape: shape(lens, raw, number, radius_mode, unit_mm),
            thickness_mm,
            medium: medium.clone(),
            mirror: raw.mirror,
            stop: raw.stop,
            comment: raw.comment.clone(),
            ..Surface::default()
        };
        apertures(lens, raw, &mut surface, number, unit_mm);
        let bends_nothing =
            surface.shape == SurfaceShape::Plane && !raw.mirror && before == Medium::Air && medium == Medium::Air;
        if raw.stop && bends_nothing && surface.apertures.is_empty() {
            surface.shape = SurfaceShape::Stop;
        }
        place(lens, raw, surface, number, unit_mm);
    }
    if !raws.iter().any(|raw| raw.role == Role::Image) {
        lens.leave_out(0, false, "no image surface: the last thickness is used as the gap to the image");
    }
}

/// Guesses whether a file that does not say so states radii. Curvatures, the default of the program, are assumed unless one of the values
/// would, as a curvature, belong to a ball with a diameter of less than two units.
fn guess_mode(lens: &mut Prescription, raws: &[Raw]) -> bool {
    let largest = raws.iter().map(|raw| raw.bend.abs()).filter(|bend| bend.is_finite()).fold(0.0, f64::max);
    let radii = largest > 1.0;
    let what =
        if radii { "radii, since they are too large for curvatures" } else { "curvatures, the program's default" };
    lens.leave_out(0, true, format!("RDM is missing: the values of surfaces are read as {what}"));
    radii
}

/// Notes what the object has and cannot have here.
fn object(lens: &mut Prescription, raw: &Raw, radius_mode: bool, unit_mm: f64) {
    if raw.radius_mm(radius_mode, unit_mm).is_finite() || raw.has_form() {
        lens.leave_out(raw.line, false, "the object is curved");
    }
    if raw.glass.is_some() || raw.mirror {
        lens.leave_out(raw.line, true, "the object is in a glass: here air is in front of the lens");
    }
    if raw.apertures.iter().any(|aperture| aperture.shape.is_some() || aperture.center != [0.0; 2]) {
        lens.leave_out(raw.line, false, "the aperture of the object");
    }
    if raw.decenter.shift != [0.0; 3] || raw.decenter.turn != [0.0; 3] {
        lens.leave_out(raw.line, true, "the object is decentered or tilted");
    }
}

fn image(lens: &mut Prescription, raw: &Raw, defocus_mm: f64, radius_mode: bool, unit_mm: f64) {
    if defocus_mm != 0.0 && defocus_mm.is_finite() {
        if let Some(last) = lens.items.last_mut() {
            *last.thickness_mm_mut() += defocus_mm;
        }
        let text = format!("The last gap includes the image surface's defocus of {} mm.", number::shortest(defocus_mm));
        lens.remarks.push(text);
    }
    if raw.radius_mm(radius_mode, unit_mm).is_finite() || raw.has_form() {
        lens.leave_out(raw.line, true, "the image surface is curved: here it is a plane");
    }
    if raw.glass.is_some() || raw.mirror {
        lens.leave_out(raw.line, true, "a glass or a mirror behind the image surface");
    }
    if raw.apertures.iter().any(|aperture| aperture.shape.is_some() || aperture.center != [0.0; 2]) {
        lens.leave_out(raw.line, false, "the aperture of the image surface");
    }
    let by = displacement(&raw.decenter, unit_mm);
    let along_mm = raw.decenter.shift[2] * unit_mm;
    if along_mm != 0.0
        && let Some(last) = lens.items.last_mut()
    {
        *last.thickness_mm_mut() += along_mm;
    }
    if !by.is_none() {
        lens.items.push(AxisItem::Break(CoordinateBreak { by, ..CoordinateBreak::default() }));
    }
}

fn shape(lens: &mut Prescription, raw: &Raw, number: usize, radius_mode: bool, unit_mm: f64) -> SurfaceShape {
    let radius_y = raw.radius_mm(radius_mode, unit_mm);
    let radius_x = raw.bend_x.map_or(f64::INFINITY, |(value, is_radius)| radius(value, is_radius, unit_mm));
    // Start at the 4th power; the first coefficient is that of the square.
    let mut coefficients: Vec<f64> = (1..=10)
        .map(|i| {
            let power: u32 = 2 * i;
            let scale = (1..power).fold(1.0, |product, _| product * unit_mm);
            raw.coefficients.get(&power).copied().filter(|a| a.is_finite()).unwrap_or(0.0) / scale
        })
        .collect();
    while coefficients.last() == Some(&0.0) {
        coefficients.pop();
    }
    let conic = raw.conic;
    let simple = SurfaceShape::conic(radius_y, conic);
    let has_x_radius = matches!(raw.form, SurfaceType::ToroidX | SurfaceType::ToroidY | SurfaceType::Anamorphic);
    let has_x_conic = matches!(raw.form, SurfaceType::ToroidX | SurfaceType::Anamorphic);
    if radius_x.is_finite() && !has_x_radius || raw.conic_x != 0.0 && !has_x_conic {
        let text = format!("surface {number}: a radius or a conic constant in x-z, which its type does not have");
        lens.leave_out(raw.line, true, text);
    }
    let has_terms = !coefficients.is_empty();
    match raw.form {
        SurfaceType::Conic | SurfaceType::Asphere if has_terms => {
            SurfaceShape::EvenAsphere { radius: radius_y, conic, coefficients }
        }
        SurfaceType::Conic | SurfaceType::Asphere => simple,
        SurfaceType::Cylinder if !has_terms && conic == 0.0 && radius_y.is_finite() => {
            SurfaceShape::Cylinder { radius: radius_y, along_x: true }
        }
        SurfaceType::Cylinder => {
            SurfaceShape::Toroid { radius: radius_y, conic, coefficients, rotation_radius: f64::INFINITY }
        }
        SurfaceType::ToroidY => {
            SurfaceShape::Toroid { radius: radius_y, conic, coefficients, rotation_radius: radius_x }
        }
        SurfaceType::ToroidX if radius_y.is_infinite() && !has_terms && raw.conic_x == 0.0 && conic == 0.0 => {
            SurfaceShape::Cylinder { radius: radius_x, along_x: false }
        }
        SurfaceType::Anamorphic if !has_terms => {
            SurfaceShape::Biconic { radius_x, radius_y, conic_x: raw.conic_x, conic_y: conic }
        }
        SurfaceType::ToroidX | SurfaceType::Anamorphic => {
            let text =
                format!("surface {number}: a toroid about x or an anamorphic asphere, carried by its radius in y-z");
            lens.leave_out(raw.line, true, text);
            simple
        }
    }
}

fn apertures(lens: &mut Prescription, raw: &Raw, surface: &mut Surface, number: usize, unit_mm: f64) {
    for stated in &raw.apertures {
        let scaled = match &stated.shape {
            Some(ApertureShape::Ring { inner, outer }) => {
                ApertureShape::Ring { inner: inner * unit_mm, outer: outer * unit_mm }
            }
            Some(ApertureShape::Rectangle { half_width, half_height }) => {
                ApertureShape::Rectangle { half_width: half_width * unit_mm, half_height: half_height * unit_mm }
            }
            Some(ApertureShape::Ellipse { half_width, half_height }) => {
                ApertureShape::Ellipse { half_width: half_width * unit_mm, half_height: half_height * unit_mm }
            }
            _ => continue,
        };
        let sound = match scaled {
            ApertureShape::Ring { outer, .. } => outer > 0.0,
            ApertureShape::Rectangle { half_width, half_height }
            | ApertureShape::Ellipse { half_width, half_height } => half_width > 0.0 && half_height > 0.0,
            _ => false,
        };
        if !sound {
            lens.leave_out(
                raw.line,
                true,
                format!("surface {number}: an aperture with a size that is missing or not positive"),
            );
            continue;
        }
        let center_mm = stated.center.map(|c| c * unit_mm);
        let centered = center_mm == [0.0; 2];
        match (stated.use_of, &scaled) {
            (Aperture::EDGE, ApertureShape::Ring { outer, .. }) if centered => {
                surface.outer_semi_diameter_mm = Some(*outer)
            }
            (Aperture::EDGE, _) => {
                lens.leave_out(raw.line, false, format!("surface {number}: an edge that is not a circle"))
            }
            (Aperture::CLEAR, ApertureShape::Ring { outer, .. }) if centered => surface.semi_diameter_mm = Some(*outer),
            (use_of, _) => {
                if use_of == Aperture::HOLE {
                    let text = format!("surface {number}: a hole: light that would pass through it is blocked");
                    lens.leave_out(raw.line, false, text);
                }
                let obscures = use_of != Aperture::CLEAR;
                surface.apertures.push(crate::prescription::Aperture { shape: scaled, center_mm, obscures });
            }
        }
    }
    let clear = surface.semi_diameter_mm.unwrap_or(0.0);
    surface.outer_semi_diameter_mm = surface.outer_semi_diameter_mm.filter(|edge| *edge > clear);
}

/// Converts a decenter to right-handed angles and mm.
fn displacement(stated: &Decenter, unit_mm: f64) -> Displacement {
    let finite = |v: f64| if v.is_finite() { v } else { 0.0 };
    let [a, b, c] = stated.turn.map(finite);
    // Write 0 - a, so that a zero has no minus sign.
    Displacement {
        decenter_mm: [finite(stated.shift[0]) * unit_mm, finite(stated.shift[1]) * unit_mm],
        tilt_deg: [0.0 - a, 0.0 - b, c],
    }
}

/// Adds a surface and the coordinate breaks that belong to it.
fn place(lens: &mut Prescription, raw: &Raw, mut surface: Surface, number: usize, unit_mm: f64) {
    let by = displacement(&raw.decenter, unit_mm);
    let along_mm = raw.decenter.shift[2] * unit_mm;
    let thickness_mm = surface.thickness_mm;
    if along_mm != 0.0 && along_mm.is_finite() {
        lens.items.push(AxisItem::Break(CoordinateBreak { thickness_mm: along_mm, ..CoordinateBreak::default() }));
    }
    let axis = |by, tilt_first, thickness_mm| AxisItem::Break(CoordinateBreak { by, tilt_first, thickness_mm });
    match raw.decenter.kind {
        _ if by.is_none() => {
            if matches!(raw.decenter.kind, DecenterKind::AndReturn | DecenterKind::Reverse) {
                surface.thickness_mm -= along_mm;
            }
            lens.items.push(AxisItem::Surface(Box::new(surface)));
        }
        DecenterKind::Basic => {
            lens.items.push(axis(by, false, 0.0));
            lens.items.push(AxisItem::Surface(Box::new(surface)));
        }
        DecenterKind::AndReturn => {
            surface.displacement = by;
            surface.thickness_mm -= along_mm;
            lens.items.push(AxisItem::Surface(Box::new(surface)));
        }
        DecenterKind::Reverse => {
            // The transformation comes after the surface, and is the inverse of the stated one.
            let back =
                Displacement { decenter_mm: by.decenter_mm.map(|v| 0.0 - v), tilt_deg: by.tilt_deg.map(|v| 0.0 - v) };
            surface.thickness_mm = 0.0;
            lens.items.push(AxisItem::Surface(Box::new(surface)));
            lens.items.push(axis(back, true, thickness_mm - along_mm));
        }
        DecenterKind::Bend => {
            if by.tilt_deg.iter().filter(|angle| **angle != 0.0).count() > 1 {
                let text = format!(
                    "surface {number}: BEN with tilts about several axes: the axis behind it may not follow the light"
                );
                lens.leave_out(raw.line, true, text);
            }
            lens.items.push(axis(by, false, 0.0));
            surface.thickness_mm = 0.0;
            lens.items.push(AxisItem::Surface(Box::new(surface)));
            let turn = Displacement { decenter_mm: [0.0; 2], tilt_deg: by.tilt_deg };
            lens.items.push(axis(turn, false, thickness_mm));
        }
    }
}
