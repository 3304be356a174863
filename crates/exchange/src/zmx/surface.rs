//! Reads one block of records: the data of a surface.

use super::keywords;
use super::numbered_values::NumberedValues;
use super::record::Record;
use crate::number;
use crate::prescription::{Aperture, ApertureShape, CoordinateBreak, Displacement, Prescription, Surface};
use crate::source::{Source, shortened};
use spectra_core::params::Faults;
use std::collections::BTreeMap;

/// Numbers of a record. A word that is not a number is a fault if its number is needed; otherwise it is noted.
struct Numbers<'a> {
    record: &'a Record<'a>,
    /// Keyword of the record in upper case.
    keyword: &'a str,
    source: &'a Source,
    faults: &'a mut Faults,
    unread: Vec<String>,
}

impl Numbers<'_> {
    fn get(&mut self, at: usize, is_needed: bool) -> Option<f64> {
        let word = self.record.word(at)?;
        let value = number::parse(word);
        if value.is_none() {
            let text = format!("{}: `{}` is not a number", self.keyword, shortened(word));
            if is_needed {
                self.faults.push(self.source.fault(word, text));
            } else {
                self.unread.push(text);
            }
        }
        value
    }

    fn needed(&mut self, at: usize) -> Option<f64> {
        self.get(at, true)
    }

    fn optional(&mut self, at: usize) -> Option<f64> {
        self.get(at, false)
    }
}

/// A glass record of a file.
#[derive(Clone, Debug)]
pub(super) struct GlassRecord {
    /// Name, `MIRROR`, or `___BLANK`.
    pub(super) name: String,
    /// Surface from which the glass is picked up.
    pub(super) pickup: Option<usize>,
    /// Whether the glass is defined by its figures alone.
    pub(super) is_model: bool,
    /// Stated index and Abbe number; 1.5 and 40 if none were stated.
    pub(super) nd: f64,
    pub(super) vd: f64,
    /// Deviation of the relative partial dispersion of g and F from the normal line.
    pub(super) deviation: f64,
}

impl GlassRecord {
    /// Reads `GLAS name kind pickup nd Vd dPgF`; flags that follow, for variation, are ignored.
    fn read(numbers: &mut Numbers<'_>) -> Option<Self> {
        let name = numbers.record.word(0)?;
        let is_model = name.starts_with("___") || name.is_empty();
        let kind = numbers.optional(1);
        // Figures next to a name are those of a catalog at the time of writing.
        let needed = is_model && kind != Some(2.0);
        Some(Self {
            name: shortened(name),
            is_model,
            pickup: numbers.get(2, kind == Some(2.0)).filter(|_| kind == Some(2.0)).map(|n| n as usize),
            nd: numbers.get(3, needed).unwrap_or(1.5),
            vd: numbers.get(4, needed).unwrap_or(40.0),
            deviation: numbers.optional(5).filter(|_| is_model && kind != Some(2.0)).unwrap_or(0.0),
        })
    }

    /// Whether the surface reflects: by its name or, in old files, by an index of -1.
    pub(super) fn is_mirror(&self) -> bool {
        self.name.eq_ignore_ascii_case("MIRROR") || self.is_model && self.pickup.is_none() && self.nd == -1.0
    }
}

/// The apertures of a surface.
#[derive(Clone, Debug, Default)]
pub(super) struct Apertures {
    /// Semi-diameter from the `DIAM` record, mm. If the program chose it, it does not clip.
    pub(super) semi_diameter_mm: Option<f64>,
    /// Whether the user typed in that size: on a surface that bends light it then clips, unless there is an aperture.
    typed: bool,
    /// Whether there is an aperture that cannot be carried over.
    foreign: bool,
    mechanical_mm: Option<f64>,
    shape: Option<(ApertureShape, bool)>,
    center_mm: [f64; 2],
}

impl Apertures {
    /// Whether there is no aperture.
    pub(super) fn is_none(&self) -> bool {
        self.shape.is_none()
    }

    /// Copies the clear size, the apertures and the size for drawing to a surface; `bends` says whether it refracts or reflects.
    pub(super) fn place(&self, surface: &mut Surface, bends: bool) {
        let drawn = self.semi_diameter_mm.unwrap_or(0.0).max(self.mechanical_mm.unwrap_or(0.0));
        match &self.shape {
            Some((ApertureShape::Ring { inner, outer }, false)) if *inner == 0.0 && self.center_mm == [0.0; 2] => {
                surface.semi_diameter_mm = Some(*outer);
            }
            Some((shape, obscures)) => {
                let aperture = Aperture { shape: shape.clone(), center_mm: self.center_mm, obscures: *obscures };
                surface.apertures.push(aperture);
            }
            None if self.typed && bends && !self.foreign => {
                surface.semi_diameter_mm = self.semi_diameter_mm.filter(|size| *size > 0.0);
            }
            None => {}
        }
        let clear = surface.semi_diameter_mm.unwrap_or(0.0);
        surface.outer_semi_diameter_mm = (drawn > clear).then_some(drawn);
    }
}

/// A surface, the object or the image, as stated by a file. Lengths are in mm already, coefficients are not.
#[derive(Clone, Debug)]
pub(super) struct Block {
    pub(super) line: usize,
    /// Type in upper case, such as `STANDARD`.
    pub(super) kind: String,
    /// Radius of curvature, mm; infinite if flat.
    pub(super) curvature_radius_mm: f64,
    pub(super) thickness_mm: Option<f64>,
    pub(super) glass: Option<GlassRecord>,
    pub(super) conic: f64,
    /// Parameters by number.
    pub(super) parameters: NumberedValues,
    /// Extra data by number.
    pub(super) extra: NumberedValues,
    pub(super) stop: bool,
    pub(super) aperture: Apertures,
    pub(super) comment: String,
    /// Tilts and decenters of the surface itself, before and behind it.
    pub(super) before: Vec<CoordinateBreak>,
    pub(super) after: Vec<CoordinateBreak>,
    pub(super) unit_mm: f64,
}

/// Largest number of a parameter that is read.
const LARGEST_NUMBER: f64 = 500.0;

impl Block {
    pub(super) fn read(
        records: &[Record<'_>],
        source: &Source,
        unit_mm: f64,
        lens: &mut Prescription,
        unknown: &mut BTreeMap<String, (usize, usize)>,
        faults: &mut Faults,
    ) -> Self {
        let mut block = Self {
            line: records.first().map_or(0, |record| record.line),
            kind: "STANDARD".to_owned(),
            curvature_radius_mm: f64::INFINITY,
            thickness_mm: None,
            glass: None,
            conic: 0.0,
            parameters: NumberedValues::default(),
            extra: NumberedValues::default(),
            stop: false,
            aperture: Apertures::default(),
            comment: String::new(),
            before: Vec::new(),
            after: Vec::new(),
            unit_mm,
        };
        for record in records.iter().skip(1) {
            let keyword = record.keyword.to_ascii_uppercase();
            let mut numbers = Numbers { record, keyword: &keyword, source, faults, unread: Vec::new() };
            let is_known = block.read_record(&mut numbers, lens);
            for text in numbers.unread {
                lens.leave_out(record.line, true, text);
            }
            if !is_known {
                unknown.entry(shortened(&keyword)).or_insert((record.line, 0)).1 += 1;
            }
        }
        block
    }

    /// Reads a record of the surface, and returns whether its keyword is known.
    fn read_record(&mut self, numbers: &mut Numbers<'_>, lens: &mut Prescription) -> bool {
        let (unit_mm, record, keyword) = (self.unit_mm, numbers.record, numbers.keyword);
        match keyword {
            "TYPE" => self.kind = record.word(0).unwrap_or("STANDARD").to_ascii_uppercase(),
            "CURV" => {
                let curvature = numbers.needed(0).unwrap_or(0.0);
                self.curvature_radius_mm = number::radius_mm(curvature, unit_mm);
            }
            "DISZ" => self.thickness_mm = numbers.needed(0).map(|t| t * unit_mm),
            "CONI" => {
                let conic = numbers.optional(0).unwrap_or(0.0);
                if conic.is_finite() {
                    self.conic = conic;
                } else {
                    lens.leave_out(record.line, true, "CONI: an infinite conic constant");
                }
            }
            "GLAS" => self.glass = GlassRecord::read(numbers),
            "PARM" | "XDAT" => {
                let map = if keyword == "PARM" { &mut self.parameters } else { &mut self.extra };
                if let (Some(at), Some(value)) = (numbers.optional(0), numbers.optional(1)) {
                    if (0.0..=LARGEST_NUMBER).contains(&at) && value.is_finite() {
                        map.insert(at as u32, value);
                    } else if value != 0.0 {
                        let what = if at > LARGEST_NUMBER { "more data than is read" } else { "no such number" };
                        lens.leave_out(record.line, true, format!("{keyword} {at} {value}: {what}"));
                    }
                }
            }
            "STOP" => self.stop = true,
            "DIAM" => {
                self.aperture.semi_diameter_mm = numbers.optional(0).map(|d| d * unit_mm).filter(|d| d.is_finite());
                self.aperture.typed = record.number(1) == Some(1.0);
            }
            "MEMA" => self.aperture.mechanical_mm = numbers.optional(0).map(|d| d * unit_mm).filter(|d| d.is_finite()),
            "CLAP" | "FLAP" | "OBSC" | "SQAP" | "SQOB" | "ELAP" | "ELOB" => {
                let sizes =
                    [numbers.optional(0).unwrap_or(0.0) * unit_mm, numbers.optional(1).unwrap_or(0.0) * unit_mm];
                self.clip(keyword, sizes, record.line, lens);
            }
            "USAP" | "USOB" | "SPID" | "UDAP" | "UDAD" | "UDOB" => {
                self.aperture.foreign = true;
                let text = format!("{keyword} {}: an aperture from a file or a spider does not clip here", record.rest);
                lens.leave_out(record.line, true, shortened(&text));
            }
            "OBDC" => {
                self.aperture.center_mm = [0, 1].map(|at| numbers.optional(at).unwrap_or(0.0) * unit_mm);
            }
            "COMM" => self.comment = shortened(record.rest),
            // Coatings are noted once for the whole lens.
            "COAT" => {}
            "SCBD" => self.own_tilt(record, lens),
            "IGNR" => {
                if numbers.optional(0).is_some_and(|flag| flag != 0.0) {
                    lens.leave_out(record.line, true, "a surface that the program ignores is carried here");
                }
            }
            // Skip solves: their values are in the records that they solve.
            "PPAR" | "PZUP" | "MAZH" | "CHZH" => {}
            _ if keywords::is_harmless_on_surface(keyword) => {}
            _ => return false,
        }
        true
    }

    fn clip(&mut self, keyword: &str, [a, b]: [f64; 2], line: usize, lens: &mut Prescription) {
        // A floating aperture is as large as the surface.
        let b = if keyword == "FLAP" && b <= 0.0 { self.aperture.semi_diameter_mm.unwrap_or(0.0) } else { b };
        let shape = match keyword {
            "CLAP" | "FLAP" | "OBSC" => ApertureShape::Ring { inner: a.max(0.0), outer: b },
            "SQAP" | "SQOB" => ApertureShape::Rectangle { half_width: a, half_height: b },
            _ => ApertureShape::Ellipse { half_width: a, half_height: b },
        };
        let obscures = matches!(keyword, "OBSC" | "SQOB" | "ELOB");
        let sound = match shape {
            ApertureShape::Ring { inner, outer } => inner < outer && outer.is_finite(),
            _ => a > 0.0 && b > 0.0 && a.is_finite() && b.is_finite(),
        };
        if sound {
            self.aperture.shape = Some((shape, obscures));
        } else if !(obscures && b <= a) {
            lens.leave_out(
                line,
                true,
                format!("{keyword} {} {}: no opening", number::shortest(a), number::shortest(b)),
            );
        }
    }

    /// Reads `SCBD side order pickup x y tilt-x tilt-y tilt-z`, where side 1 is before and 2 behind the surface.
    fn own_tilt(&mut self, record: &Record<'_>, lens: &mut Prescription) {
        // A word among the numbers makes the whole tilt unreadable.
        let value = |at| record.word(at).map_or(0.0, |word| number::parse(word).unwrap_or(f64::NAN));
        let by = Displacement {
            decenter_mm: [value(3) * self.unit_mm, value(4) * self.unit_mm],
            tilt_deg: [value(5), value(6), value(7)],
        };
        let finite = by.decenter_mm.iter().chain(&by.tilt_deg).all(|v| v.is_finite());
        if by.is_none() && finite {
            return;
        }
        let tilt = CoordinateBreak { by, tilt_first: value(1) != 0.0, thickness_mm: 0.0 };
        match (value(0), value(2)) {
            (1.0, 0.0) if finite => self.before.push(tilt),
            (2.0, 0.0) if finite => self.after.push(tilt),
            _ => lens.leave_out(record.line, true, shortened(&format!("SCBD {}: a tilt of the surface", record.rest))),
        }
    }

    /// Whether this is a coordinate break instead of a surface.
    pub(super) fn is_break(&self) -> bool {
        self.kind == "COORDBRK"
    }

    /// Returns the coordinate break.
    pub(super) fn coordinate_break(&self) -> CoordinateBreak {
        let value = |at: u32| self.parameters.get(at);
        CoordinateBreak {
            by: Displacement {
                decenter_mm: [value(1) * self.unit_mm, value(2) * self.unit_mm],
                tilt_deg: [value(3), value(4), value(5)],
            },
            tilt_first: value(6) != 0.0,
            thickness_mm: 0.0,
        }
    }
}
