//! Reads the commands of a file one by one.

use super::glass::Private;
use super::lens::{Aperture, Decenter, DecenterKind, Raw, Role, SurfaceType, build};
use super::statement::{Statement, split};
use crate::glass::UserCatalog;
use crate::prescription::{ApertureShape, FieldKind, Fields, Prescription, SystemAperture, Wavelength};
use crate::source::{Source, shortened};
use crate::{MAX_ITEMS, number};
use spectra_core::params::Faults;
use std::collections::BTreeMap;

/// Commands that only select rays, draw, vary or print.
const HARMLESS: [&str; 52] = [
    "LEN", "GO", "INI", "WTF", "WTW", "VUX", "VLX", "VUY", "VLY", "PIM", "CCY", "CCX", "THC", "GLC", "GC1", "GC2",
    "GC3", "CUM", "THM", "DER", "CLS", "POL", "CA", "AC", "BC", "CC", "DC", "EC", "FC", "GC", "HC", "JC", "KC", "ADC",
    "BDC", "CDC", "XDC", "YDC", "ZDC", "COM", "HOR", "HWL", "HCT", "HCO", "HCC", "CON", "SPH", "OUT", "END", "RSI",
    "FCY", "XAC",
];

/// Reads the text of a `.seq` file. `name` is the name of the file in error messages; glasses are searched for in the catalogs
/// `own` first.
///
/// # Errors
/// The file has no surfaces or more than [`MAX_ITEMS`], or a value that the lens needs is not a number.
pub fn read(name: &str, text: &str, own: &[UserCatalog]) -> Result<Prescription, Faults> {
    let source = Source::new(name, text);
    let mut reader = Reader { source: &source, ..Reader::new(&source) };
    for statement in &split(source.text()) {
        reader.statement(statement);
        if reader.surfaces.len() > MAX_ITEMS {
            return Err(source.fault_here(format!("more than {MAX_ITEMS} surfaces")).into());
        }
    }
    reader.finish(own)
}

/// State of reading: everything that the commands have defined so far.
struct Reader<'a> {
    source: &'a Source,
    lens: Prescription,
    faults: Faults,
    /// Whether curvatures are given as radii; `None` if the file does not say.
    radius_mode: Option<bool>,
    unit_mm: f64,
    surfaces: Vec<Raw>,
    /// Wavelengths (nm) of the index tables of the file's own glasses.
    private_nm: Vec<f64>,
    private: Vec<Private>,
    in_private: bool,
    /// Line of the current command.
    line: usize,
    /// Line of the command that sets the size of the beam.
    aperture_line: usize,
    fields: BTreeMap<&'static str, Vec<f64>>,
    unknown: BTreeMap<String, (usize, usize)>,
}

impl<'a> Reader<'a> {
    fn new(source: &'a Source) -> Self {
        Self {
            source,
            lens: Prescription::default(),
            faults: Faults::new(),
            radius_mode: None,
            unit_mm: 1.0,
            surfaces: Vec::new(),
            private_nm: Vec::new(),
            private: Vec::new(),
            in_private: false,
            line: 0,
            aperture_line: 0,
            fields: BTreeMap::new(),
            unknown: BTreeMap::new(),
        }
    }

    /// Parses a value without which there is no lens; anything else is a fault.
    fn needed(&mut self, word: &str) -> Option<f64> {
        let value = number::parse(word);
        if value.is_none() {
            self.faults.push(self.source.fault(word, format!("`{}` is not a number", shortened(word))));
        }
        value
    }

    /// Parses any other value; anything else is noted.
    fn number(&mut self, word: &str) -> Option<f64> {
        let value = number::parse(word);
        if value.is_none() {
            self.lens.leave_out(self.line, true, format!("`{}` is not a number", shortened(word)));
        }
        value
    }

    fn numbers(&mut self, words: &[&str]) -> Vec<f64> {
        words.iter().take(128).filter_map(|word| self.number(word)).collect()
    }

    /// Returns the value after a command, and the index of its surface: the named one as in `THI S3 5.0`, or the latest.
    fn value(&mut self, command: &str, words: &[&str], is_needed: bool) -> Option<(usize, f64)> {
        let (at, words) = self.target(words)?;
        let Some((word, more)) = words.split_first() else {
            self.lens.leave_out(self.line, true, format!("{command} without a value"));
            return None;
        };
        // A solve, with which the program recomputes the value: `THI HMY 0.0` after `S 50 5`.
        if is_needed && self.surfaces[at].states(command) && word.starts_with(|c: char| c.is_ascii_alphabetic()) {
            let is_solve = word.bytes().all(|b| b.is_ascii_alphabetic());
            let text = format!("{command} {}: the value on the surface's own line is carried", words.join(" "));
            self.lens.leave_out(self.line, !is_solve, shortened(&text));
            return None;
        }
        let value = if is_needed { self.needed(word) } else { self.number(word) }?;
        self.note_more(command, more);
        Some((at, value))
    }

    /// Notes words after the values that a command has.
    fn note_more(&mut self, command: &str, more: &[&str]) {
        if !more.is_empty() {
            self.lens.leave_out(self.line, true, shortened(&format!("unexpected {} after {command}", more.join(" "))));
        }
    }

    /// Returns the index of the surface that a command is for (`S3`, `SO`, `SI`, or the latest), and the remaining words. `None` if it does
    /// not exist, which is noted.
    fn target<'w>(&mut self, words: &'w [&'w str]) -> Option<(usize, &'w [&'w str])> {
        let last = self.surfaces.len().checked_sub(1)?;
        let Some(first) = words.first() else { return Some((last, words)) };
        let named = match first.to_ascii_uppercase().as_str() {
            "SO" => Some(0),
            "SI" => Some(last),
            name => name.strip_prefix('S').and_then(|digits| digits.parse::<usize>().ok()),
        };
        match named {
            Some(at) if at <= last => Some((at, &words[1..])),
            Some(_) => {
                self.lens.leave_out(self.line, true, format!("there is no surface {} yet", shortened(first)));
                None
            }
            None => Some((last, words)),
        }
    }

    fn statement(&mut self, statement: &Statement<'_>) {
        let Some((first, words)) = statement.words.split_first() else { return };
        let upper = first.to_ascii_uppercase();
        self.line = statement.line;
        if self.in_private {
            match upper.as_str() {
                "PWL" => self.private_nm = self.numbers(words),
                "END" => self.in_private = false,
                _ => {
                    let name = first.trim_matches(['\'', '"']).to_owned();
                    let formula = words.first().filter(|word| number::parse(word).is_none());
                    let indices = if let Some(formula) = formula {
                        let text = format!(
                            "the file's own glass {} has a formula, {}, which is not read",
                            shortened(&name),
                            shortened(formula)
                        );
                        self.lens.leave_out(statement.line, false, text);
                        Vec::new()
                    } else {
                        self.numbers(words)
                    };
                    let points = self.private_nm.iter().copied().zip(indices).collect();
                    if self.private.len() < 200 {
                        self.private.push(Private { name, points });
                    }
                }
            }
            return;
        }
        // Shorten long command names to three letters.
        let known =
            if upper.len() > 3 && upper.bytes().all(|b| b.is_ascii_alphabetic()) { &upper[..3] } else { &upper };
        match known {
            "RDM" => self.radius_mode = Some(!words.first().is_some_and(|w| w.to_ascii_uppercase().starts_with('N'))),
            "TIT" => self.lens.name = shortened(words.join(" ").trim_matches(['\'', '"'])),
            "DIM" => self.dimension(words),
            "PRV" => self.in_private = true,
            "WL" => {
                let nm = self.numbers(words);
                self.lens.wavelengths = nm
                    .into_iter()
                    .filter(|nm| *nm > 0.0 && nm.is_finite())
                    .map(|nm| Wavelength { nm, weight: 1.0 })
                    .collect();
            }
            "REF" => {
                let at = words.first().and_then(|word| self.number(word));
                self.lens.primary = at.filter(|at| (1.0..=128.0).contains(at)).map(|at| at as usize - 1);
            }
            "EPD" | "FNO" | "NA" | "NAO" => {
                let value = words.first().and_then(|word| self.number(word)).filter(|value| *value > 0.0);
                self.aperture_line = statement.line;
                self.lens.system_aperture = value.map(|value| match known {
                    "EPD" => SystemAperture::EntrancePupilDiameter(value),
                    "FNO" => SystemAperture::FNumber(value),
                    "NA" => SystemAperture::ImageNumericalAperture(value),
                    _ => SystemAperture::ObjectNumericalAperture(value),
                });
            }
            "XAN" | "YAN" | "XOB" | "YOB" | "XIM" | "YIM" | "XRI" | "YRI" => {
                let key =
                    ["XAN", "YAN", "XOB", "YOB", "XIM", "YIM", "XRI", "YRI"].into_iter().find(|key| *key == known);
                let values = self.numbers(words);
                self.fields.insert(key.unwrap_or("YAN"), values);
            }
            "TEM" | "PRE" => {
                let value = words.first().and_then(|word| self.number(word));
                let usual = if known == "TEM" { 20.0 } else { 760.0 };
                if value.is_some_and(|value| value != usual && !(known == "PRE" && value == 1.0)) {
                    self.lens.leave_out(statement.line, true, shortened(&statement.words.join(" ")));
                }
            }
            "SO" => self.begin(Role::Object, statement.line, words),
            "SI" => self.begin(Role::Image, statement.line, words),
            "S" => self.begin(Role::Surface, statement.line, words),
            _ if self.surface_command(known, words, statement.line) => {}
            _ if HARMLESS.contains(&known) => {}
            "PIK" | "ZOO" | "SOL" => {
                let text = format!("{}: values are carried as saved", shortened(&statement.words.join(" ")));
                self.lens.leave_out(statement.line, false, text);
            }
            _ => {
                let entry = self.unknown.entry(shortened(&statement.words.join(" "))).or_insert((statement.line, 0));
                entry.1 += 1;
            }
        }
    }

    fn dimension(&mut self, words: &[&str]) {
        let Some(word) = words.first() else { return };
        match word.to_ascii_uppercase().as_str() {
            "M" | "MM" => self.unit_mm = 1.0,
            "C" | "CM" => self.unit_mm = 10.0,
            "I" | "IN" => self.unit_mm = 25.4,
            _ => self.faults.push(self.source.fault(word, "unknown unit").hint("write M (mm), C (cm) or I (inch)")),
        }
    }

    /// Reads `S radius thickness glass`.
    fn begin(&mut self, role: Role, line: usize, words: &[&str]) {
        let mut raw = Raw::new(role, line);
        let mut words = words;
        let mut stated = [false; 2];
        // A word that begins like a number is not a glass, unless a number precedes it.
        let is_figure = |word: &str| word.starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c));
        for (at, into) in [&mut raw.bend, &mut raw.thickness].into_iter().enumerate() {
            let Some(word) = words.first() else { break };
            let value =
                number::parse(word).or_else(|| if at == 0 && is_figure(word) { self.needed(word) } else { None });
            if value.is_none() && !(at == 0 && is_figure(word)) {
                continue;
            }
            *into = value.unwrap_or(0.0);
            stated[at] = true;
            words = &words[1..];
        }
        raw.stated = stated;
        if let Some(word) = words.first() {
            if raw.role == Role::Surface || !word.starts_with(|c: char| c.is_ascii_digit()) {
                raw.set_glass(word);
            }
            if let Some(more) = words.get(1) {
                self.lens.leave_out(line, true, format!("unexpected {} after the glass of a surface", shortened(more)));
            }
        }
        self.surfaces.push(raw);
    }

    /// Reads a command that belongs to a surface; returns false if it is another command.
    fn surface_command(&mut self, command: &str, words: &[&str], line: usize) -> bool {
        /// Powers of the coefficients A, B, ...; there is no I.
        const POWERS: [(&str, u32); 9] =
            [("A", 4), ("B", 6), ("C", 8), ("D", 10), ("E", 12), ("F", 14), ("G", 16), ("H", 18), ("J", 20)];
        if self.surfaces.is_empty() {
            return false;
        }
        if let Some((_, power)) = POWERS.iter().find(|(name, _)| *name == command) {
            if let Some((at, value)) = self.value(command, words, false) {
                self.surfaces[at].coefficients.insert(*power, value);
            }
            return true;
        }
        match command {
            "STO" => {
                if let Some((at, _)) = self.target(words) {
                    self.surfaces[at].stop = true;
                }
            }
            "ASP" | "CYL" | "YTO" | "XTO" | "AAS" => {
                let form = match command {
                    "ASP" => SurfaceType::Asphere,
                    "CYL" => SurfaceType::Cylinder,
                    "YTO" => SurfaceType::ToroidY,
                    "XTO" => SurfaceType::ToroidX,
                    _ => SurfaceType::Anamorphic,
                };
                if let Some((at, _)) = self.target(words) {
                    self.surfaces[at].form = form;
                }
            }
            "GLA" => {
                if let Some((at, words)) = self.target(words)
                    && let Some(name) = words.first()
                {
                    self.surfaces[at].set_glass(name);
                    self.note_more("GLA", &words[1..]);
                }
            }
            "RMD" => {
                if let Some((at, words)) = self.target(words)
                    && let Some(mode) = words.first()
                {
                    let mode = mode.to_ascii_uppercase();
                    self.surfaces[at].mirror = mode.starts_with("REFL");
                    if !mode.starts_with("REFL") && !mode.starts_with("REFR") {
                        self.lens.leave_out(line, true, shortened(&format!("RMD {mode}: light is refracted here")));
                    }
                }
            }
            "SLB" => {
                if let Some((at, words)) = self.target(words) {
                    self.surfaces[at].comment = shortened(words.join(" ").trim_matches(['\'', '"']));
                }
            }
            "CUF" => {
                if words.iter().any(|word| number::parse(word).is_none_or(|value| value != 0.0)) {
                    self.lens.leave_out(line, true, "CUF: the curvature of a Fresnel surface");
                }
            }
            "DAR" | "REV" | "BEN" => {
                if let Some((at, _)) = self.target(words) {
                    self.surfaces[at].decenter.kind = match command {
                        "DAR" => DecenterKind::AndReturn,
                        "REV" => DecenterKind::Reverse,
                        _ => DecenterKind::Bend,
                    };
                }
            }
            "RDY" | "CUY" | "RDX" | "CUX" | "THI" | "K" | "KY" | "KX" | "XDE" | "YDE" | "ZDE" | "ADE" | "BDE"
            | "CDE" => {
                let is_needed = ["RDY", "CUY", "RDX", "CUX", "THI"].contains(&command);
                if let Some((at, value)) = self.value(command, words, is_needed) {
                    self.surfaces[at].set(command, value);
                }
            }
            "CIR" | "REX" | "REY" | "ELX" | "ELY" | "ADX" | "ADY" | "ARO" => self.aperture(command, words, line),
            "DIF" | "HOE" => {
                let text =
                    format!("{command} {}: a diffractive surface, carried without its diffraction", words.join(" "));
                self.lens.leave_out(line, true, shortened(&text));
            }
            _ => return false,
        }
        true
    }

    /// Reads an aperture: `CIR 12`, `CIR EDG 12`, `CIR OBS L'A' 0.4`, `REX 5`.
    fn aperture(&mut self, command: &str, words: &[&str], line: usize) {
        let Some((at, words)) = self.target(words) else { return };
        let mut use_of = Aperture::CLEAR;
        let mut label = "";
        let mut value = None;
        for word in words {
            match word.to_ascii_uppercase().as_str() {
                "EDG" => use_of = Aperture::EDGE,
                "OBS" => use_of = Aperture::OBSCURES,
                "HOL" => use_of = Aperture::HOLE,
                "CLR" => use_of = Aperture::CLEAR,
                _ if word.contains(['\'', '"']) => label = word,
                _ if value.is_some() => self.note_more(command, &[word]),
                _ => value = self.number(word),
            }
        }
        let Some(value) = value else { return };
        if !value.is_finite() {
            return;
        }
        let label = shortened(label);
        if command == "ARO" && value != 0.0 {
            self.lens.leave_out(line, true, format!("ARO {value}: the rotation of an aperture"));
            return;
        }
        let entry = self.surfaces[at].aperture(use_of, &label);
        match command {
            "CIR" => entry.shape = Some(ApertureShape::Ring { inner: 0.0, outer: value }),
            "ADX" => entry.center[0] = value,
            "ADY" => entry.center[1] = value,
            "REX" | "REY" => {
                let (mut width, mut height) = match entry.shape {
                    Some(ApertureShape::Rectangle { half_width, half_height }) => (half_width, half_height),
                    _ => (0.0, 0.0),
                };
                *(if command == "REX" { &mut width } else { &mut height }) = value;
                entry.shape = Some(ApertureShape::Rectangle { half_width: width, half_height: height });
            }
            "ELX" | "ELY" => {
                let (mut width, mut height) = match entry.shape {
                    Some(ApertureShape::Ellipse { half_width, half_height }) => (half_width, half_height),
                    _ => (0.0, 0.0),
                };
                *(if command == "ELX" { &mut width } else { &mut height }) = value;
                entry.shape = Some(ApertureShape::Ellipse { half_width: width, half_height: height });
            }
            _ => {}
        }
    }

    fn finish(mut self, own: &[UserCatalog]) -> Result<Prescription, Faults> {
        if !self.surfaces.iter().any(|raw| raw.role == Role::Surface) {
            self.faults.push(
                self.source.fault_here("no surfaces: no line begins with S").hint("is this a CODE V sequence file?"),
            );
        }
        if !self.faults.is_empty() {
            return Err(self.faults);
        }
        let units = self.unit_mm;
        if let Some(SystemAperture::EntrancePupilDiameter(d)) = &mut self.lens.system_aperture {
            *d *= units;
        }
        self.lens.primary = self.lens.primary.filter(|at| *at < self.lens.wavelengths.len());
        self.lens.fields = fields(&self.fields, units);
        for (text, (line, count)) in std::mem::take(&mut self.unknown) {
            let times = if count > 1 { format!(" ({count} times)") } else { String::new() };
            self.lens.leave_out(line, true, format!("unknown command {text}{times}"));
        }
        build(&mut self.lens, &self.surfaces, self.radius_mode, units, (&self.private, own));
        // For an object at a finite distance the f-number of CODE V is that of the cone at the image.
        if let (Some(SystemAperture::FNumber(n)), Some(_)) = (self.lens.system_aperture, self.lens.object_distance_mm) {
            self.lens.system_aperture = Some(SystemAperture::ImageNumericalAperture(0.5 / n));
        }
        crate::stop::size(&mut self.lens, self.aperture_line, "STO");
        crate::reference::set(&mut self.lens);
        self.lens.left_out.sort_by_key(|note| note.line);
        Ok(self.lens)
    }
}

fn fields(given: &BTreeMap<&'static str, Vec<f64>>, unit_mm: f64) -> Option<Fields> {
    let kinds = [
        ("XAN", "YAN", FieldKind::Angle, 1.0),
        ("XOB", "YOB", FieldKind::ObjectHeight, unit_mm),
        ("XIM", "YIM", FieldKind::ParaxialImageHeight, unit_mm),
        ("XRI", "YRI", FieldKind::RealImageHeight, unit_mm),
    ];
    kinds.into_iter().find_map(|(x, y, kind, unit)| {
        let list = |key| given.get(key).map_or(&[][..], Vec::as_slice);
        let (x, y) = (list(x), list(y));
        let at = |values: &[f64], i: usize| values.get(i).copied().unwrap_or(0.0) * unit;
        let points: Vec<[f64; 2]> = (0..x.len().max(y.len())).map(|i| [at(x, i), at(y, i)]).collect();
        (!points.is_empty()).then_some(Fields { kind, points })
    })
}

impl Raw {
    fn set(&mut self, command: &str, value: f64) {
        let Decenter { shift, turn, .. } = &mut self.decenter;
        match command {
            "RDY" => (self.bend, self.bend_is_radius) = (value, Some(true)),
            "CUY" => (self.bend, self.bend_is_radius) = (value, Some(false)),
            "RDX" => self.bend_x = Some((value, true)),
            "CUX" => self.bend_x = Some((value, false)),
            "THI" => self.thickness = value,
            "K" | "KY" => self.conic = value,
            "KX" => self.conic_x = value,
            "XDE" => shift[0] = value,
            "YDE" => shift[1] = value,
            "ZDE" => shift[2] = value,
            "ADE" => turn[0] = value,
            "BDE" => turn[1] = value,
            _ => turn[2] = value,
        }
    }
}
