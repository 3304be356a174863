//! Tables of measured indices, as text.

use super::Sample;
use spectra_core::params::Span;

/// The samples of one material of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedSamples {
    /// Name of the material, if the file has a column for it.
    pub name: Option<String>,
    /// Rows of the material, in the order of the file.
    pub samples: Vec<Sample>,
}

/// A line of a table that cannot be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("line {line}: {message}")]
pub struct SamplesError {
    /// Line, from 1.
    pub line: usize,
    /// Message that says what is wrong.
    pub message: String,
}

/// Names of the wavelength column, and its unit in nm.
const WAVELENGTH: [(&str, f64); 8] = [
    ("wavelength_nm", 1.0),
    ("wavelength", 1.0),
    ("lambda_nm", 1.0),
    ("nm", 1.0),
    ("wavelength_um", 1000.0),
    ("lambda_um", 1000.0),
    ("um", 1000.0),
    ("wl", 1000.0), // refractiveindex.info's exports
];
const INDEX: [&str; 4] = ["n", "index", "refractive_index", "nd"];
const MATERIAL: [&str; 4] = ["material", "name", "glass", "medium"];

/// Wavelengths from 10 nm to 1 mm; a value outside has the wrong unit.
const SENSIBLE_NM: std::ops::RangeInclusive<f64> = 10.0..=1e6;

struct Columns {
    wavelength: usize,
    unit_nm: f64,
    index: usize,
    extinction: Option<usize>,
    material: Option<usize>,
}

/// A row of a table of indices.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct IndexRow<'a> {
    pub(crate) wavelength_nm: f64,
    pub(crate) n: f64,
    pub(crate) k: Option<f64>,
    /// The wavelength as written, a slice of the text.
    pub(crate) cell: &'a str,
}

/// An error in a table, with its place.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct RowError {
    pub(crate) place: Span,
    pub(crate) message: String,
    pub(crate) hint: Option<&'static str>,
}

/// The rows of one material: its name if the file has a column for it, and the rows in the order of the file.
pub(crate) type Material<'a> = (Option<String>, Vec<IndexRow<'a>>);

/// The contents of a header, for messages.
const HEAD: &str = "columns `wavelength_nm` (or `wavelength_um`), `n` and, where they are known, `k` and `material`";

/// Reads a table of indices; all readers use this function. See [`read_csv`] for the format.
pub(crate) fn read_rows(text: &str) -> Result<Vec<Material<'_>>, RowError> {
    let mut columns: Option<Columns> = None;
    let mut found: Vec<Material<'_>> = Vec::new();
    for line in text.strip_prefix('\u{feff}').unwrap_or(text).lines().map(str::trim_end) {
        if line.is_empty() || line.trim_start().starts_with('#') {
            continue;
        }
        let values = split(line);
        let cell = |at: usize| values.get(at).copied().unwrap_or(&line[line.len()..]);
        let number = |at: usize| values.get(at).and_then(|v| v.parse::<f64>().ok());
        let fail = |(at, message, hint): Wrong| RowError { place: Span::of(cell(at), text), message, hint };
        if columns.is_none() {
            if number(0).is_some() && number(1).is_some() {
                columns = Some(Columns { wavelength: 0, unit_nm: 1.0, index: 1, extinction: None, material: None });
            } else {
                columns = Some(head(&values).map_err(|message| fail((0, message, Some(HEAD))))?);
                continue;
            }
        }
        let Some(columns) = &columns else { continue };
        let (wavelength_nm, n, k) = row(columns, &values).map_err(fail)?;
        let row = IndexRow { wavelength_nm, n, k, cell: cell(columns.wavelength) };
        let name = columns.material.map(|at| values.get(at).copied().unwrap_or_default().to_owned());
        match found.iter_mut().find(|(other, _)| *other == name) {
            Some((_, rows)) => rows.push(row),
            None => found.push((name, vec![row])),
        }
    }
    if found.is_empty() {
        let message = "no samples: a table has columns `wavelength_nm` and `n`".to_owned();
        let place = Span { line: text.lines().count().max(1), offset: text.len(), column: 1, len: 0 };
        return Err(RowError { place, message, hint: Some(HEAD) });
    }
    Ok(found)
}

/// Reads a table of wavelengths and indices. Columns are found by name: `wavelength_nm` (or `wavelength_um`), `n`, and
/// `material` if a file holds several. A file without a header has wavelengths in nm and indices. Lines that begin with `#` are
/// comments; values are separated by commas, semicolons, tabs or blanks.
///
/// # Errors
/// The first line that cannot be read; a file without samples.
pub fn read_csv(text: &str) -> Result<Vec<NamedSamples>, SamplesError> {
    let found = read_rows(text).map_err(|e| SamplesError { line: e.place.line, message: e.message })?;
    let sample = |row: IndexRow<'_>| Sample { wavelength_nm: row.wavelength_nm, n: row.n };
    let material = |(name, rows): Material<'_>| NamedSamples { name, samples: rows.into_iter().map(sample).collect() };
    Ok(found.into_iter().map(material).collect())
}

fn split(line: &str) -> Vec<&str> {
    let by = |c: char| line.split(c).map(|v| v.trim().trim_matches('"')).collect();
    match [',', ';', '\t'].into_iter().find(|c| line.contains(*c)) {
        Some(separator) => by(separator),
        None => line.split_ascii_whitespace().collect(),
    }
}

fn head(names: &[&str]) -> Result<Columns, String> {
    let lower: Vec<String> = names.iter().map(|n| n.to_lowercase().replace([' ', '-'], "_")).collect();
    let place = |known: &[&str]| lower.iter().position(|n| known.contains(&n.as_str()));
    let wavelength = WAVELENGTH.iter().find_map(|(name, unit)| Some((place(&[name])?, *unit)));
    let (Some((wavelength, unit_nm)), Some(index)) = (wavelength, place(&INDEX)) else {
        let found = names.join(", ").chars().take(60).collect::<String>();
        return Err(format!("columns `wavelength_nm` (or `wavelength_um`) and `n` are needed; found: {found}"));
    };
    Ok(Columns { wavelength, unit_nm, index, extinction: place(&["k"]), material: place(&MATERIAL) })
}

/// An error: its column, its message and its hint.
type Wrong = (usize, String, Option<&'static str>);

fn row(columns: &Columns, values: &[&str]) -> Result<(f64, f64, Option<f64>), Wrong> {
    let number = |at: usize, what: &str| {
        let text = values.get(at).copied().unwrap_or_default();
        let value = text.parse::<f64>().ok().filter(|v| v.is_finite());
        value.ok_or_else(|| (at, format!("`{text}` is not a valid {what}"), None))
    };
    let wavelength_nm = number(columns.wavelength, "wavelength")? * columns.unit_nm;
    if !SENSIBLE_NM.contains(&wavelength_nm) {
        let hint = "name the column `wavelength_um` if it is in micrometers";
        let message = format!("a wavelength of {wavelength_nm} nm; {hint}");
        return Err((columns.wavelength, message, None));
    }
    let n = number(columns.index, "index")?;
    if !(1.0..=10.0).contains(&n) {
        return Err((columns.index, format!("an index of {n} is out of range: it must lie between 1 and 10"), None));
    }
    let k = columns.extinction.map(|at| number(at, "extinction coefficient")).transpose()?;
    if let (Some(at), Some(k)) = (columns.extinction, k.filter(|k| *k < 0.0)) {
        return Err((at, format!("k is {k}"), Some("k must be 0 or more")));
    }
    Ok((wavelength_nm, n, k))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_found_by_name_or_place() {
        let plain = read_csv("486.1 1.523\n589.3 1.517\n").expect("good");
        assert_eq!(plain[0].samples[1], Sample { wavelength_nm: 589.3, n: 1.517 });
        for text in [
            "# remark\nwavelength_nm,n\n486.1,1.523\n589.3,1.517\n",
            "n;wavelength_nm\r\n1.523;486.1\r\n1.517;589.3\r\n",
            "\u{feff}Wavelength_um\tn\n0.4861\t1.523\n0.5893\t1.517",
            "486.1, 1.523\n\n589.3, 1.517",
        ] {
            let read = read_csv(text).expect(text);
            assert_eq!(read.len(), 1);
            for (got, made) in read[0].samples.iter().zip(&plain[0].samples) {
                assert!((got.wavelength_nm - made.wavelength_nm).abs() < 1e-9 && got.n == made.n, "{text}");
            }
        }
        let two = read_csv("material,wavelength_nm,n\nA,486,1.5\nB,486,1.6\nA,589,1.49\n").expect("good");
        let names: Vec<_> = two.iter().map(|g| (g.name.as_deref(), g.samples.len())).collect();
        assert_eq!(names, [(Some("A"), 2), (Some("B"), 1)]);
    }

    #[test]
    fn what_is_wrong_has_its_line() {
        for (text, line, word) in [
            ("", 1, "no samples"),
            ("wavelength_nm,k\n", 1, "found: wavelength_nm, k"),
            ("wavelength_nm,n\n486,x\n", 2, "`x` is not a valid index"),
            ("wavelength_nm,n\n\n486\n", 3, "`` is not a valid index"),
            ("wavelength_nm,n\n486,0.9\n", 2, "between 1 and 10"),
            ("0.486 1.52\n", 1, "wavelength_um"),
            ("wavelength_nm,n\n486,nan\n", 2, "`nan`"),
        ] {
            let error = read_csv(text).expect_err(text);
            assert!(error.line == line && error.message.contains(word), "{text}: {error}");
        }
    }
}
