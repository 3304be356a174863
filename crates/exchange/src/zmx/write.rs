//! Writes a prescription as a `.zmx` file.

use super::OPEN_STOP;
use crate::glass::{deviation, everyday_name, maker_of_catalogue};
use crate::number::shortest;
use crate::prescription::{
    ApertureShape, AxisItem, CoordinateBreak, Displacement, FieldKind, Medium, Note, Prescription, Surface,
    SurfaceShape, SystemAperture, ZernikeOrdering,
};
use crate::source::shortened;
use spectra_glass::{Catalog, Line, lines};
use std::fmt::Write;

/// The text of a written file, with notes on what it could not hold.
#[derive(Clone, Debug, PartialEq)]
pub struct Written {
    /// Text of the file.
    pub text: String,
    /// Notes on what could not be carried over, including those of the prescription. Line numbers refer to the lens file.
    pub left_out: Vec<Note>,
}

/// Encodes the text of a file as OpticStudio does: as ASCII if possible, otherwise as UTF-16 with a byte order mark.
#[must_use]
pub fn encode(text: &str) -> Vec<u8> {
    if text.is_ascii() {
        return text.as_bytes().to_vec();
    }
    [0xff, 0xfe].into_iter().chain(text.encode_utf16().flat_map(u16::to_le_bytes)).collect()
}

/// Writes a lens as a `.zmx` file. Lengths are in mm, and numbers have all digits. A surface that is displaced alone is written
/// between two coordinate breaks.
#[must_use]
pub fn write(lens: &Prescription) -> Written {
    let mut writer = Writer {
        out: String::new(),
        left_out: lens.left_out.clone(),
        surfaces: 0,
        makers: Vec::new(),
        stop_written: false,
        needs_stop: !lens.surfaces().any(|surface| surface.stop),
    };
    writer.blocks(lens);
    let body = std::mem::take(&mut writer.out);
    writer.system(lens);
    writer.out.push_str(&body);
    if let Some(year) = lens.year {
        writer.note(false, format!("the year {year}, from which a coating is assumed: surfaces read back are bare"));
    }
    Written { text: writer.out, left_out: writer.left_out }
}

struct Writer {
    out: String,
    left_out: Vec<Note>,
    /// Number of blocks written so far.
    surfaces: usize,
    /// Catalogs of the glasses, in order of appearance.
    makers: Vec<String>,
    stop_written: bool,
    /// Whether no surface of the lens is its stop.
    needs_stop: bool,
}

/// Writes one line of a surface record. The result is ignored, because writing to a string cannot fail.
macro_rules! record {
    ($writer:expr, $($text:tt)*) => {{
        let _ = write!($writer.out, "  ");
        let _ = writeln!($writer.out, $($text)*);
    }};
}

impl Writer {
    fn note(&mut self, alters: bool, text: String) {
        self.left_out.push(Note { line: 0, text, alters });
    }

    fn system(&mut self, lens: &Prescription) {
        let mut line = |text: String| {
            self.out.push_str(&text);
            self.out.push('\n');
        };
        line("VERS 120928 0 0".to_owned());
        line("MODE SEQ".to_owned());
        line(format!("NAME {}", shortened(&lens.name)));
        line("UNIT MM X W X CM MR CPMM".to_owned());
        let stop_size = lens.surfaces().find(|surface| surface.stop).and_then(|stop| stop.semi_diameter_mm);
        let front = lens.surfaces().find_map(|surface| surface.semi_diameter_mm);
        let aperture = lens.system_aperture.or(stop_size.map(|_| SystemAperture::StopSize));
        let missing = match aperture {
            Some(SystemAperture::EntrancePupilDiameter(d)) => {
                line(format!("ENPD {}", shortest(d)));
                None
            }
            Some(SystemAperture::FNumber(n)) => {
                line(format!("FNUM {} 0", shortest(n)));
                None
            }
            Some(SystemAperture::ObjectNumericalAperture(n)) => {
                line(format!("OBNA {} 0", shortest(n)));
                None
            }
            Some(SystemAperture::StopSize) => {
                line("FLOA".to_owned());
                None
            }
            Some(SystemAperture::ImageNumericalAperture(_)) if stop_size.is_some() => {
                line("FLOA".to_owned());
                None
            }
            Some(SystemAperture::ImageNumericalAperture(_)) | None => {
                let size = front.unwrap_or(1.0);
                line(format!("ENPD {}", shortest(2.0 * size)));
                Some(size)
            }
        };
        if stop_size.is_none() {
            line(format!("NOTE 0 {OPEN_STOP}"));
        }
        if !self.makers.is_empty() {
            line(format!("GCAT {}", self.makers.join(" ")));
        }
        let kind = match lens.fields.as_ref().map(|fields| fields.kind) {
            None | Some(FieldKind::Angle) => 0,
            Some(FieldKind::ObjectHeight) => 1,
            Some(FieldKind::ParaxialImageHeight) => 2,
            Some(FieldKind::RealImageHeight) => 3,
        };
        let points = lens.fields.as_ref().map_or(vec![[0.0; 2]], |fields| fields.points.clone());
        let reference = lens.reference_line.as_deref().and_then(Line::read).unwrap_or(lines::D);
        let mut wavelengths: Vec<(f64, f64)> = lens.wavelengths.iter().map(|w| (w.nm, w.weight)).collect();
        if wavelengths.is_empty() {
            wavelengths.push((reference.wavelength_nm, 1.0));
        }
        line(format!("FTYP {kind} 0 {} {} 0 0 0", points.len(), wavelengths.len()));
        for (keyword, axis) in [("XFLN", 0), ("YFLN", 1)] {
            let values: Vec<String> = points.iter().map(|point| shortest(point[axis])).collect();
            line(format!("{keyword} {}", values.join(" ")));
        }
        for (at, (nm, weight)) in wavelengths.iter().enumerate() {
            line(format!("WAVM {} {} {}", at + 1, shortest(nm / 1000.0), shortest(*weight)));
        }
        line(format!("PWAV {}", lens.primary.unwrap_or(0) + 1));
        if let Some(size) = missing {
            let text = format!(
                "the lens does not state the size of its stop: the entrance pupil diameter {} is a guess",
                shortest(2.0 * size)
            );
            self.note(false, text);
        }
    }

    fn blocks(&mut self, lens: &Prescription) {
        self.start("STANDARD", 0.0);
        let distance = lens.object_distance_mm.map_or("INFINITY".to_owned(), shortest);
        record!(self, "DISZ {distance}");
        let mut before = Medium::Air;
        for (at, item) in lens.items.iter().enumerate() {
            match item {
                AxisItem::Break(axis) => self.coordinate_break(axis),
                AxisItem::Surface(surface) => {
                    let after = if surface.mirror { before.clone() } else { surface.medium.clone() };
                    self.surface(surface, &after, at + 1);
                    before = after;
                }
            }
        }
        self.start("STANDARD", 0.0);
        record!(self, "DISZ 0");
    }

    fn start(&mut self, kind: &str, curvature_per_mm: f64) {
        let _ = writeln!(self.out, "SURF {}", self.surfaces);
        self.surfaces += 1;
        record!(self, "TYPE {kind}");
        record!(self, "CURV {} 0 0 0 0", shortest(curvature_per_mm));
    }

    fn coordinate_break(&mut self, axis: &CoordinateBreak) {
        self.start("COORDBRK", 0.0);
        let Displacement { decenter_mm: [x, y], tilt_deg: [a, b, c] } = axis.by;
        for (at, value) in [x, y, a, b, c, f64::from(u8::from(axis.tilt_first))].into_iter().enumerate() {
            record!(self, "PARM {} {}", at + 1, shortest(value));
        }
        record!(self, "DISZ {}", shortest(axis.thickness_mm));
    }

    fn surface(&mut self, surface: &Surface, after: &Medium, number: usize) {
        let displaced = !surface.displacement.is_none();
        if displaced {
            self.coordinate_break(&CoordinateBreak { by: surface.displacement, ..CoordinateBreak::default() });
        }
        self.shape(&surface.shape, number);
        if surface.stop || self.needs_stop && !self.stop_written {
            record!(self, "STOP");
            if !surface.stop {
                self.note(false, "the lens has no stop: its first surface is marked as one".to_owned());
            }
            self.stop_written = true;
        }
        if !surface.comment.is_empty() {
            record!(self, "COMM {}", shortened(&surface.comment));
        }
        record!(self, "DISZ {}", shortest(if displaced { 0.0 } else { surface.thickness_mm }));
        if surface.mirror {
            record!(self, "GLAS MIRROR 0 0 1.5 40 0 0 0 0 0 0");
        } else {
            self.glass(after, number);
        }
        self.apertures(surface, number);
        if displaced {
            // Undo the displacement: the tilts in reverse order and direction, then the shift.
            let Displacement { decenter_mm: [x, y], tilt_deg: [a, b, c] } = surface.displacement;
            self.coordinate_break(&CoordinateBreak {
                by: Displacement { decenter_mm: [-x, -y], tilt_deg: [-a, -b, -c] },
                tilt_first: true,
                thickness_mm: surface.thickness_mm,
            });
        }
    }

    fn parameters(&mut self, first: usize, values: &[f64]) {
        for (at, value) in values.iter().enumerate() {
            record!(self, "PARM {} {}", first + at, shortest(*value));
        }
    }

    fn extra(&mut self, values: &[f64]) {
        for (at, value) in values.iter().enumerate() {
            record!(self, "XDAT {} {} 0 0 1.0 0.0 0 \"\"", at + 1, shortest(*value));
        }
    }

    fn conic(&mut self, conic: f64) {
        if conic != 0.0 {
            record!(self, "CONI {}", shortest(conic));
        }
    }

    fn shape(&mut self, shape: &SurfaceShape, number: usize) {
        match shape {
            SurfaceShape::Plane | SurfaceShape::Stop | SurfaceShape::Other { .. } => self.start("STANDARD", 0.0),
            SurfaceShape::Sphere { radius } => self.start("STANDARD", 1.0 / radius),
            SurfaceShape::Conic { radius, conic } => {
                self.start("STANDARD", 1.0 / radius);
                self.conic(*conic);
            }
            SurfaceShape::EvenAsphere { radius, conic, coefficients } if coefficients.len() <= 8 => {
                self.start("EVENASPH", 1.0 / radius);
                self.conic(*conic);
                self.parameters(1, coefficients);
            }
            SurfaceShape::EvenAsphere { radius, conic, coefficients } => {
                self.start("XASPHERE", 1.0 / radius);
                self.conic(*conic);
                let values: Vec<f64> =
                    [coefficients.len() as f64, 1.0].into_iter().chain(coefficients.iter().copied()).collect();
                self.extra(&values);
            }
            SurfaceShape::OddAsphere { radius, conic, coefficients } => {
                self.start("ODDASPHE", 1.0 / radius);
                self.conic(*conic);
                self.parameters(1, &coefficients[..coefficients.len().min(8)]);
                if coefficients.iter().skip(8).any(|a| *a != 0.0) {
                    self.note(true, format!("surface {number}: coefficients of an odd asphere beyond r^8"));
                }
            }
            SurfaceShape::Cylinder { radius, along_x: true } => {
                self.start("TOROIDAL", 1.0 / radius);
                self.parameters(1, &[0.0]);
            }
            SurfaceShape::Cylinder { radius, along_x: false } => {
                self.start("TOROIDAL", 0.0);
                self.parameters(1, &[*radius]);
            }
            SurfaceShape::Toroid { radius, conic, coefficients, rotation_radius } => {
                self.start("TOROIDAL", 1.0 / radius);
                self.conic(*conic);
                let turn = if rotation_radius.is_finite() { *rotation_radius } else { 0.0 };
                self.parameters(1, &[turn]);
                self.parameters(2, &coefficients[..coefficients.len().min(7)]);
                if coefficients.iter().skip(7).any(|a| *a != 0.0) {
                    self.note(true, format!("surface {number}: coefficients of a toroid beyond y^14"));
                }
            }
            SurfaceShape::Biconic { radius_x, radius_y, conic_x, conic_y } => {
                self.start("BICONICX", 1.0 / radius_y);
                self.conic(*conic_y);
                self.parameters(1, &[if radius_x.is_finite() { *radius_x } else { 0.0 }, *conic_x]);
            }
            SurfaceShape::TiltedPlane { tan_x, tan_y } => {
                self.start("TILTSURF", 0.0);
                self.parameters(1, &[*tan_x, *tan_y]);
            }
            SurfaceShape::ThinLens { focal_length } => {
                self.start("PARAXIAL", 0.0);
                self.parameters(1, &[*focal_length, 1.0]);
            }
            SurfaceShape::Grating { lines_per_mm, order, radius, conic, direction_deg } => {
                self.start("DGRATING", 1.0 / radius);
                self.conic(*conic);
                self.parameters(1, &[lines_per_mm / 1000.0, *order]);
                if *direction_deg != 0.0 {
                    self.note(true, format!("surface {number}: the direction {direction_deg} degrees of a grating"));
                }
            }
            SurfaceShape::Zernike { radius, conic, normalization_radius, coefficients, ordering } => {
                self.start(if *ordering == ZernikeOrdering::Noll { "SZERNSAG" } else { "FZERNSAG" }, 1.0 / radius);
                self.conic(*conic);
                let head = [coefficients.len() as f64, *normalization_radius];
                self.extra(&head.into_iter().chain(coefficients.iter().copied()).collect::<Vec<_>>());
            }
        }
    }

    fn glass(&mut self, medium: &Medium, number: usize) {
        match medium {
            Medium::Air => {}
            Medium::Model { nd, vd, ng } => {
                let off = shortest(deviation(*nd, *vd, *ng));
                record!(self, "GLAS ___BLANK 1 0 {} {} {off} 0 0 0 0 0", shortest(*nd), shortest(vd.unwrap_or(0.0)));
            }
            Medium::Glass { name, nd, vd } => match Catalog::bundled().find(name) {
                Ok(glass) => {
                    let vd = vd.unwrap_or_else(|| glass.vd());
                    let vd = if vd.is_finite() { vd } else { 0.0 };
                    let nd = nd.unwrap_or_else(|| glass.nd());
                    let maker = maker_of_catalogue(&glass.maker);
                    let everyday = if maker.is_none() { everyday_name(&glass.full_name()) } else { None };
                    match maker.map(|maker| (maker, &*glass.name)).or(everyday.map(|name| ("MISC", name))) {
                        Some((maker, name)) => {
                            if !self.makers.iter().any(|known| known == maker) {
                                self.makers.push(maker.to_owned());
                            }
                            let prefix = if maker == "LZOS" { "LZ_" } else { "" };
                            record!(self, "GLAS {prefix}{name} 0 0 {} {} 0 0 0 0 0 0", shortest(nd), shortest(vd));
                        }
                        None => {
                            let vd = if (0.0..=200.0).contains(&vd) { vd } else { 0.0 };
                            record!(self, "GLAS ___BLANK 1 0 {} {} 0 0 0 0 0 0", shortest(nd), shortest(vd));
                            self.note(false, format!("surface {number}: {name} is written by its nd and Vd"));
                        }
                    }
                }
                // The name is `vacuum`, or is shared by several glasses, of which the stated index selects one: write the figures.
                Err(_) => match nd {
                    Some(nd) => {
                        let bare = name.rsplit('/').next().unwrap_or(name);
                        record!(self, "GLAS {bare} 0 0 {} {} 0 0 0 0 0 0", shortest(*nd), shortest(vd.unwrap_or(0.0)));
                    }
                    None => record!(self, "GLAS {} 0 0 1.5 40 0 0 0 0 0 0", name.to_uppercase()),
                },
            },
            Medium::Unknown { name } => record!(self, "GLAS {name} 0 0 1.5 40 0 0 0 0 0 0"),
        }
    }

    fn apertures(&mut self, surface: &Surface, number: usize) {
        // A typed-in size clips on a surface that bends light; that of the edge does not.
        if let Some(size) = surface.semi_diameter_mm {
            record!(self, "DIAM {} 1 0 0 1 \"\"", shortest(size));
        } else if let Some(size) = surface.outer_semi_diameter_mm {
            record!(self, "DIAM {} 0 0 0 1 \"\"", shortest(size));
        }
        if let Some(outer) = surface.outer_semi_diameter_mm {
            record!(self, "MEMA {} 0 0 0 1 \"\"", shortest(outer));
        }
        let mut written = false;
        if let Some(size) = surface.semi_diameter_mm {
            record!(self, "CLAP 0 {} 0", shortest(size));
            written = true;
        }
        for aperture in &surface.apertures {
            let (keyword, a, b) = match (&aperture.shape, aperture.obscures) {
                (ApertureShape::Ring { inner, outer }, false) => ("CLAP", *inner, *outer),
                (ApertureShape::Ring { inner, outer }, true) => ("OBSC", *inner, *outer),
                (ApertureShape::Rectangle { half_width, half_height }, false) => ("SQAP", *half_width, *half_height),
                (ApertureShape::Rectangle { half_width, half_height }, true) => ("SQOB", *half_width, *half_height),
                (ApertureShape::Ellipse { half_width, half_height }, false) => ("ELAP", *half_width, *half_height),
                (ApertureShape::Ellipse { half_width, half_height }, true) => ("ELOB", *half_width, *half_height),
                (ApertureShape::Polygon { .. } | ApertureShape::Other { .. }, _) => {
                    self.note(true, format!("surface {number}: an aperture that is not a ring, rectangle or ellipse"));
                    continue;
                }
            };
            if written {
                self.note(true, format!("surface {number}: a second aperture ({keyword}), where a .zmx holds one"));
                continue;
            }
            // Give a ring without an outer edge a radius larger than any lens.
            record!(self, "{keyword} {} {} 0", shortest(a), shortest(b.min(1e6)));
            if aperture.center_mm != [0.0; 2] {
                record!(self, "OBDC {} {}", shortest(aperture.center_mm[0]), shortest(aperture.center_mm[1]));
            }
            written = true;
        }
    }
}
