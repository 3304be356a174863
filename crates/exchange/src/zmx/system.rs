//! Reads the data of the whole system: unit, glass catalogs, beam, fields, wavelengths.

use super::record::Record;
use super::{OPEN_STOP, keywords};
use crate::glass::maker_of_catalogue;
use crate::number;
use crate::prescription::{FieldKind, Fields, Prescription, SystemAperture, Wavelength};
use crate::source::{Source, shortened};
use spectra_core::params::Faults;

/// System data that reading the surfaces needs.
pub(super) struct System {
    /// Length of a lens unit, mm.
    pub(super) unit_mm: f64,
    /// Makers of the glass catalogs, in the order of the file.
    pub(super) makers: Vec<&'static str>,
    /// Line of the record that sets the size of the beam.
    pub(super) aperture_line: usize,
    /// Whether an f-number is that of the cone at the image, whatever the object distance.
    pub(super) working: bool,
    /// Whether the file says that its stop does not limit the light.
    pub(super) open_stop: bool,
}

/// Largest number of wavelengths and of fields that are kept.
const MOST: usize = 64;

pub(super) fn read(records: &[Record<'_>], source: &Source, lens: &mut Prescription, faults: &mut Faults) -> System {
    let mut system = System { unit_mm: 1.0, makers: Vec::new(), aperture_line: 0, working: false, open_stop: false };
    let find = |keyword: &str| records.iter().find(|record| record.keyword.eq_ignore_ascii_case(keyword));
    if let Some(record) = find("UNIT")
        && let Some(word) = record.word(0)
    {
        match word.to_ascii_uppercase().as_str() {
            "MM" => {}
            "CM" => system.unit_mm = 10.0,
            "IN" | "INCH" | "INCHES" => system.unit_mm = 25.4,
            "M" | "METER" | "METERS" => system.unit_mm = 1000.0,
            _ => faults.push(source.fault(word, "unknown unit").hint("write MM, CM, IN or METER")),
        }
    }
    if let Some(record) = find("MODE")
        && let Some(word) = record.word(0)
        && !word.eq_ignore_ascii_case("SEQ")
    {
        let fault = source.fault(word, format!("the mode {} is not sequential", shortened(word)));
        faults.push(fault.hint("only sequential lenses can be read: surfaces in the order of the light"));
    }
    let counts = find("FTYP");
    let count = |at: usize| counts.and_then(|record| record.number(at)).map(|n| n.clamp(0.0, MOST as f64) as usize);
    wavelengths(records, count(3), lens);
    fields(records, counts, count(2), system.unit_mm, lens);
    let mut notes = Vec::new();
    let mut vignetting = None;
    for record in records {
        let keyword = record.keyword.to_ascii_uppercase();
        let positive = record.number(0).filter(|n| *n > 0.0);
        let second = record.number(1) == Some(1.0);
        if ["ENPD", "FNUM", "OBNA", "FLOA"].contains(&&*keyword) {
            system.aperture_line = record.line;
        }
        match keyword.as_str() {
            "NAME" => lens.name = shortened(record.rest),
            "GCAT" => system.makers.extend(record.words().filter_map(maker_of_catalogue)),
            "ENPD" => {
                lens.system_aperture = positive.map(|d| SystemAperture::EntrancePupilDiameter(d * system.unit_mm));
            }
            "FNUM" => {
                lens.system_aperture = positive.map(SystemAperture::FNumber);
                system.working = second;
            }
            "OBNA" => {
                // A 1 after the value makes it half the angle of the cone, in degrees.
                let na = positive.map(|n| if second { libm::sin(n.to_radians()) } else { n });
                lens.system_aperture = na.map(SystemAperture::ObjectNumericalAperture);
            }
            "FLOA" => lens.system_aperture = Some(SystemAperture::StopSize),
            "NOTE" => notes.extend(record.rest.split_once(' ').map(|(_, text)| text.trim().to_owned())),
            "ENVD" | "TEMP" | "PRES" => environment(record, &keyword, lens),
            _ if keywords::is_vignetting(&keyword) => {
                if record.words().filter_map(number::parse).any(|factor| factor != 0.0) {
                    vignetting.get_or_insert(record.line);
                }
            }
            _ if keywords::is_harmless_in_system(&keyword) => {}
            _ => lens.leave_out(record.line, false, shortened(&format!("{keyword} {}", record.rest))),
        }
    }
    if let Some(line) = vignetting {
        lens.leave_out(line, false, "vignetting factors: they only select rays");
    }
    system.open_stop = notes.iter().any(|text: &String| text == OPEN_STOP);
    notes.retain(|text| !text.is_empty() && text != OPEN_STOP);
    if !notes.is_empty() {
        let text: String = notes.join(" ").chars().take(400).collect();
        lens.remarks.push(format!("Notes of the file: {}", text.replace(char::is_control, " ")));
    }
    system
}

fn environment(record: &Record<'_>, keyword: &str, lens: &mut Prescription) {
    let number = |at| record.number(at);
    let (temperature, pressure, adjusts) = match keyword {
        "ENVD" => (number(0), number(1), number(2).is_some_and(|flag| flag != 0.0)),
        "TEMP" => (number(0), None, true),
        _ => (None, number(0), true),
    };
    let (t, p) = (temperature.unwrap_or(20.0), pressure.unwrap_or(1.0));
    if t != 20.0 || p != 1.0 {
        let text = format!(
            "indices at {t} degrees Celsius and {p} atmospheres: those at 20 degrees and 1 atmosphere are used"
        );
        lens.leave_out(record.line, adjusts, text);
    }
}

fn wavelengths(records: &[Record<'_>], active: Option<usize>, lens: &mut Prescription) {
    let usable = |um: &f64| um.is_finite() && *um > 0.0;
    let mut listed: Vec<(usize, Wavelength)> = Vec::new();
    let mut old: Vec<f64> = Vec::new();
    for record in records {
        if record.keyword.eq_ignore_ascii_case("WAVM") {
            let at = record.number(0).unwrap_or(0.0);
            if let Some(um) = record.number(1).filter(usable)
                && (1.0..=MOST as f64).contains(&at)
            {
                listed.push((at as usize, Wavelength { nm: nanometers(um), weight: record.number(2).unwrap_or(1.0) }));
            }
        } else if record.keyword.eq_ignore_ascii_case("WAVL") || record.keyword.eq_ignore_ascii_case("WAVN") {
            old.extend(record.words().filter_map(number::parse).filter(usable).take(MOST));
        } else if record.keyword.eq_ignore_ascii_case("PWAV") {
            lens.primary = record.number(0).filter(|n| (1.0..=MOST as f64).contains(n)).map(|n| n as usize - 1);
        }
    }
    listed.sort_by_key(|(at, _)| *at);
    listed.dedup_by_key(|(at, _)| *at);
    lens.wavelengths = if listed.is_empty() {
        old.into_iter().map(|um| Wavelength { nm: nanometers(um), weight: 1.0 }).collect()
    } else {
        listed.into_iter().map(|(_, wavelength)| wavelength).collect()
    };
    if let Some(active) = active.filter(|active| *active > 0) {
        lens.wavelengths.truncate(active);
    }
    lens.wavelengths.truncate(MOST);
    lens.primary = lens.primary.filter(|at| *at < lens.wavelengths.len());
}

/// Converts micrometers to nanometers, rounding away digits that only the conversion adds.
fn nanometers(um: f64) -> f64 {
    let nm = um * 1000.0;
    format!("{nm:.9}").parse().unwrap_or(nm)
}

fn fields(
    records: &[Record<'_>],
    kind: Option<&Record<'_>>,
    count: Option<usize>,
    unit_mm: f64,
    lens: &mut Prescription,
) {
    let kind = match kind.and_then(|record| record.number(0)).unwrap_or(0.0) {
        1.0 => FieldKind::ObjectHeight,
        2.0 => FieldKind::ParaxialImageHeight,
        3.0 => FieldKind::RealImageHeight,
        _ => FieldKind::Angle,
    };
    let unit = if kind == FieldKind::Angle { 1.0 } else { unit_mm };
    let list = |keyword: &str| -> Vec<f64> {
        let record = records.iter().find(|record| record.keyword.eq_ignore_ascii_case(keyword));
        record.map_or_else(Vec::new, |r| r.words().filter_map(number::parse).map(|v| v * unit).take(MOST).collect())
    };
    let (x, y) = (list("XFLN"), list("YFLN"));
    let count = count.filter(|count| *count > 0).unwrap_or(x.len().max(y.len())).min(x.len().max(y.len()));
    let points: Vec<[f64; 2]> =
        (0..count).map(|i| [x.get(i).copied().unwrap_or(0.0), y.get(i).copied().unwrap_or(0.0)]).collect();
    if !points.is_empty() {
        lens.fields = Some(Fields { kind, points });
    }
}
