//! Glass catalogue files (AGF) of optical design programs: a user's own catalogues.
//!
//! A record begins with `NM name formula code nd vd ...`; `CD` has the coefficients, `TD` the thermal data, `LD` the range in
//! micrometers, `IT` internal transmittances (wavelength, transmittance, thickness in mm). Text is UTF-8, UTF-16 or Latin-1.
//! What cannot be read is listed, and the rest is used.

use std::borrow::Cow;

use crate::formula::Formula;
use crate::formula::{
    CONRADY, EXTENDED, EXTENDED_2, EXTENDED_3, HANDBOOK_1, HANDBOOK_2, HERZBERGER, SCHOTT, SELLMEIER_1, SELLMEIER_2,
    SELLMEIER_3, SELLMEIER_4, SELLMEIER_5,
};
use crate::glass::{Category, Extinction, Glass, Status, Thermal};

/// A line of an AGF file that was not understood.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AgfProblem {
    /// Line, from 1.
    pub line: usize,
    /// Message that says what is wrong, and how the line was treated.
    pub message: String,
}

/// The content of an AGF file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Agf {
    /// The glasses, in the order of the file.
    pub glasses: Vec<Glass>,
    /// Problems of lines that were not understood. A glass without coefficients is such a problem, and is left out.
    pub problems: Vec<AgfProblem>,
}

/// Reads the bytes of an AGF file; `maker` (usually the file's name) becomes the maker of its glasses.
#[must_use]
pub fn read(bytes: &[u8], maker: &str) -> Agf {
    let text = decode(bytes);
    let mut reader = Reader { maker, agf: Agf::default(), record: None, continues: false };
    for (i, line) in text.lines().enumerate() {
        reader.line(i + 1, line);
    }
    reader.finish();
    reader.agf
}

/// Decodes text from UTF-16 (with a byte-order mark, or recognized by its zero bytes), UTF-8 or Latin-1.
fn decode(bytes: &[u8]) -> Cow<'_, str> {
    let utf16 = |bytes: &[u8], unit: fn([u8; 2]) -> u16| {
        let units: Vec<u16> = bytes.chunks_exact(2).map(|pair| unit([pair[0], pair[1]])).collect();
        Cow::Owned(String::from_utf16_lossy(&units))
    };
    let start = &bytes[..bytes.len().min(64)];
    let zeros = |from: usize| start.len() >= 4 && start.iter().skip(from).step_by(2).all(|b| *b == 0);
    match bytes {
        [0xff, 0xfe, rest @ ..] => utf16(rest, u16::from_le_bytes),
        [0xfe, 0xff, rest @ ..] => utf16(rest, u16::from_be_bytes),
        _ if zeros(1) => utf16(bytes, u16::from_le_bytes),
        _ if zeros(0) => utf16(bytes, u16::from_be_bytes),
        [0xef, 0xbb, 0xbf, rest @ ..] => String::from_utf8_lossy(rest),
        _ => match std::str::from_utf8(bytes) {
            Ok(text) => Cow::Borrowed(text),
            Err(_) => Cow::Owned(bytes.iter().map(|b| char::from(*b)).collect()),
        },
    }
}

/// A glass whose record is being read.
struct Record {
    line: usize,
    name: String,
    formula: u8,
    nd: Option<f64>,
    vd: Option<f64>,
    status: Status,
    coefficients: Vec<f64>,
    thermal: Vec<f64>,
    range_nm: Option<(f64, f64)>,
    transmittance: Vec<[f64; 3]>,
}

struct Reader<'a> {
    maker: &'a str,
    agf: Agf,
    record: Option<Record>,
    /// Whether the line before was `CD`: some programs break that line.
    continues: bool,
}

impl Reader<'_> {
    fn problem(&mut self, line: usize, message: impl Into<String>) {
        self.agf.problems.push(AgfProblem { line, message: message.into() });
    }

    fn line(&mut self, number: usize, line: &str) {
        let mut words = line.split_ascii_whitespace();
        let Some(key) = words.next() else { return };
        if key == "NM" {
            self.finish();
            self.begin(number, line);
            return;
        }
        let continues = std::mem::replace(&mut self.continues, key == "CD");
        let Some(record) = &mut self.record else {
            return;
        };
        let values: Vec<f64> = words.map_while(value).collect();
        match key {
            "CD" => record.coefficients = values,
            "TD" => record.thermal = values,
            "LD" => match values[..] {
                [min, max, ..] if min > 0.0 && min < max => record.range_nm = Some((min * 1000.0, max * 1000.0)),
                _ => self.problem(number, "LD needs two wavelengths in micrometers; left out"),
            },
            "IT" => match values[..] {
                [um, tau, mm, ..] if um > 0.0 && (0.0..=1.0).contains(&tau) && mm > 0.0 => {
                    record.transmittance.push([um, tau, mm]);
                }
                // Some programs fill tables with empty rows; a negative transmittance was not measured.
                [] | [_] | [_, _] => {}
                [_, tau, ..] if tau < 0.0 => {}
                _ => self.problem(number, "IT needs a wavelength, a transmittance up to 1 and a thickness; left out"),
            },
            _ if continues && value(key).is_some() => {
                record.coefficients.extend(value(key));
                record.coefficients.extend(values);
                self.continues = true;
            }
            // CC, GC, ED, OD, MD, BD: remarks and data that this program has no use for.
            _ => {}
        }
    }

    fn begin(&mut self, line: usize, text: &str) {
        let words: Vec<&str> = text.split_ascii_whitespace().collect();
        let number = |i: usize| words.get(i).and_then(|w| value(w));
        let (Some(name), Some(formula)) = (words.get(1), number(2)) else {
            self.problem(line, "NM needs a name and the number of a formula; the glass is left out");
            return;
        };
        if !(1.0..=13.0).contains(&formula) || formula != libm::trunc(formula) {
            self.problem(line, format!("glass {name}: unknown formula {formula}; the glass is left out"));
            return;
        }
        // Programs write 1 and 0 if index and Abbe number are not known.
        let known = |v: Option<f64>, least: f64| v.filter(|v| *v > least);
        self.record = Some(Record {
            line,
            name: (*name).to_owned(),
            formula: formula as u8,
            nd: known(number(4), 1.0),
            vd: known(number(5), 0.0),
            status: match number(7).map(|v| v as i64) {
                Some(0) => Status::Standard,
                Some(1) => Status::Preferred,
                Some(2) => Status::Obsolete,
                Some(3) => Status::Special,
                Some(4) => Status::Melt,
                _ => Status::Unknown,
            },
            coefficients: Vec::new(),
            thermal: Vec::new(),
            range_nm: None,
            transmittance: Vec::new(),
        });
    }

    fn finish(&mut self) {
        self.continues = false;
        let Some(record) = self.record.take() else {
            return;
        };
        let Some(formula) = formula(record.formula, &record.coefficients) else {
            self.problem(
                record.line,
                format!("glass {}: coefficients are missing; the glass is left out", record.name),
            );
            return;
        };
        let range_nm = record.range_nm.unwrap_or((365.0, 1014.0));
        let mut glass = Glass::new(self.maker, &record.name, Category::User, formula, range_nm);
        if !glass.index(0.5 * (range_nm.0 + range_nm.1)).is_finite() {
            self.problem(
                record.line,
                format!("glass {}: its coefficients give no index; the glass is left out", record.name),
            );
            return;
        }
        if record.range_nm.is_none() {
            self.problem(
                record.line,
                format!("glass {}: no LD line; its range is assumed to be 365 to 1014 nm", record.name),
            );
        }
        // Columns that were swapped still give an index, of another glass.
        if record.nd.is_some_and(|nd| (nd - glass.nd()).abs() > 1e-3) {
            let message =
                format!("glass {}: its coefficients give nd {:.5}, not the one listed", record.name, glass.nd());
            self.problem(record.line, message);
        }
        glass.listed_nd = record.nd;
        glass.listed_vd = record.vd;
        glass.status = record.status;
        glass.extinction = extinction(record.transmittance);
        if let [d0, d1, d2, e0, e1, lambda_tk_um, rest @ ..] = &record.thermal[..] {
            glass.temperature_c = rest.first().copied();
            let known = [d0, d1, d2, e0, e1].iter().any(|v| **v != 0.0);
            glass.thermal = known.then_some(Thermal { d: [*d0, *d1, *d2], e: [*e0, *e1], lambda_tk_um: *lambda_tk_um });
        }
        self.agf.glasses.push(glass);
    }
}

/// Reads a number as programs of any age and country write it: `1.0E+000`, `1.0D-3`, `1,5`.
fn value(word: &str) -> Option<f64> {
    let plain = word.parse::<f64>().ok();
    plain.or_else(|| word.replace(['D', 'd'], "E").replace(',', ".").parse().ok()).filter(|v| v.is_finite())
}

/// Returns the formula by its number in AGF files. Missing coefficients at the end are 0; `None` if all are 0.
fn formula(number: u8, coefficients: &[f64]) -> Option<Formula> {
    let c = coefficients;
    if c.iter().all(|c| *c == 0.0) {
        return None;
    }
    Some(match number {
        1 => SCHOTT.with(c),
        2 => SELLMEIER_1.with(c),
        3 => HERZBERGER.with(c),
        4 => SELLMEIER_2.with(c),
        5 => CONRADY.with(c),
        6 => SELLMEIER_3.with(c),
        7 => HANDBOOK_1.with(c),
        8 => HANDBOOK_2.with(c),
        9 => SELLMEIER_4.with(c),
        10 => EXTENDED.with(c),
        11 => SELLMEIER_5.with(c),
        12 => EXTENDED_2.with(c),
        13 => EXTENDED_3.with(c),
        _ => return None,
    })
}

/// Computes k from internal transmittances: tau = exp(-4 pi k d / lambda). Opaque rows are dropped, since they do not say how
/// opaque the glass is.
fn extinction(mut rows: Vec<[f64; 3]>) -> Option<Extinction> {
    rows.retain(|[_, tau, _]| *tau > 0.0);
    rows.sort_by(|a, b| a[0].total_cmp(&b[0]));
    rows.dedup_by(|a, b| a[0] == b[0]);
    let wavelengths: Vec<f64> = rows.iter().map(|r| r[0] * 1000.0).collect();
    let k = rows
        .iter()
        .map(|[um, tau, mm]| -libm::log(*tau) * um * 1e-3 / (4.0 * std::f64::consts::PI * mm) + 0.0)
        .collect();
    Extinction::new(wavelengths.into(), k)
}

#[cfg(test)]
mod tests {
    use super::*;

    const N_BK7: &str = "CC A remark\nNM N-BK7 2 517642.251 1.5168 64.17 0 1 -\nGC step 0.5 available\nED 7.1 8.3 2.51 -0.0009 0\n\
        CD 1.039612120E+00 6.000698670E-03 2.317923440E-01 2.001791440E-02 1.010469450E+00 1.035606530E+02 0 0\n\
        TD 1.860000E-06 1.310000E-08 -1.370000E-11 4.340000E-07 6.270000E-10 1.700000E-01 2.000000E+01\n\
        LD 3.00000E-01 2.50000E+00\nIT 0.4 0.997 10.0\nIT 0.35 0.986 10.0\nIT 0.3 0.0 10.0\nIT 2.5\n";

    fn utf16(text: &str, big: bool, mark: bool) -> Vec<u8> {
        let units = mark.then_some(0xfeff).into_iter().chain(text.encode_utf16());
        units.flat_map(|u| if big { u.to_be_bytes() } else { u.to_le_bytes() }).collect()
    }

    #[test]
    fn all_fields_of_a_record() {
        let agf = read(N_BK7.as_bytes(), "MINE");
        assert_eq!(agf.problems, []);
        let [glass] = &agf.glasses[..] else { panic!("one glass") };
        assert_eq!(
            (glass.full_name().as_str(), glass.status, glass.range_nm),
            ("MINE/N-BK7", Status::Preferred, (300.0, 2500.0))
        );
        assert_eq!((glass.listed_nd, glass.listed_vd, glass.temperature_c), (Some(1.5168), Some(64.17), Some(20.0)));
        assert!((glass.nd() - 1.5168).abs() < 1e-6 && (glass.vd() - 64.17).abs() < 0.005);
        let tau = glass.internal_transmittance(400.0, 10.0).expect("within the data");
        assert!((tau - 0.997).abs() < 1e-12);
        assert_eq!(glass.internal_transmittance(300.0, 10.0), None);
    }

    #[test]
    fn all_encodings_give_the_same_glass() {
        let expected = read(N_BK7.as_bytes(), "MINE");
        for big in [false, true] {
            for mark in [false, true] {
                assert_eq!(read(&utf16(N_BK7, big, mark), "MINE"), expected, "UTF-16 {big} {mark}");
            }
        }
        assert_eq!(read(&[b"\xef\xbb\xbf", N_BK7.as_bytes()].concat(), "MINE"), expected);
        // Latin-1: the degree sign alone is no UTF-8.
        assert_eq!(read(&[b"CC 20 \xb0C\r\n", N_BK7.replace('\n', "\r\n").as_bytes()].concat(), "MINE"), expected);
    }

    #[test]
    fn broken_coefficient_lines_and_other_numbers() {
        let agf = read(b"NM A 1 0 1,5096 60 0 0\nCD 2.25D0 0\n 1E-2\n 0 0 0\nLD 0.4 0.7\n", "M");
        assert_eq!(agf.problems, []);
        assert_eq!(agf.glasses[0].formula, SCHOTT.with(&[2.25, 0.0, 0.01, 0.0, 0.0, 0.0]));
        assert_eq!(agf.glasses[0].listed_nd, Some(1.5096));
    }

    #[test]
    fn coefficients_that_contradict_the_listed_index_are_told() {
        let swapped = N_BK7.replace("1.5168 64.17", "1.6168 64.17");
        let agf = read(swapped.as_bytes(), "M");
        assert_eq!(agf.glasses.len(), 1);
        assert_eq!(agf.problems.iter().map(|p| p.line).collect::<Vec<_>>(), [2]);
        assert!(agf.problems[0].message.contains("1.51680"));
    }

    #[test]
    fn what_cannot_be_read_is_listed_by_line() {
        let text = "NM\nNM X 99 0 1.5 60\nCD 1\nNM Y 2 0 1.5 60\nNM Z 1 0 1.5 60\nCD 2.25\nLD 0.7 0.4\nIT 0.4 1.2 10\nNM W 1 0 1 0\nCD -4\nLD 0.4 0.7\n";
        let agf = read(text.as_bytes(), "M");
        let lines: Vec<usize> = agf.problems.iter().map(|p| p.line).collect();
        assert_eq!(lines, [1, 2, 4, 7, 8, 5, 9]);
        let names: Vec<&str> = agf.glasses.iter().map(|g| g.name.as_str()).collect();
        assert_eq!(names, ["Z"]);
    }

    #[test]
    fn rubbish_is_no_glass() {
        for bytes in [&b""[..], b"\xff\xfe", b"\xff\xfe\x00", b"\x00\x00\x00\x00", b"NM \xff\xff\xff", &[0x80; 300]] {
            assert!(read(bytes, "M").glasses.is_empty());
        }
    }
}
