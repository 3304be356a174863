//! Reads rows of numbers from CSV by the names of their columns.

use super::TraceError;
use std::io::{BufRead, Read};

/// Longest line that is read, bytes: a file without line ends must not fill the memory.
const LONGEST_LINE: u64 = 64 * 1024;

/// Reader of rows of numbers. It finds columns by the names in the first row, in any order, and skips other columns and empty lines.
pub(crate) struct NumberRows<R> {
    input: R,
    file: String,
    line: usize,
    text: Vec<u8>,
    /// Names of the columns to read.
    wanted: Vec<&'static str>,
    /// Index in `wanted` of the name of each column of the file; `None` for columns to skip.
    columns: Vec<Option<usize>>,
}

impl<R: BufRead> NumberRows<R> {
    /// Reads and checks the first row.
    pub(crate) fn new(input: R, file: &str, wanted: &[&'static str]) -> Result<Self, TraceError> {
        let mut rows = Self {
            input,
            file: file.to_owned(),
            line: 0,
            text: Vec::new(),
            wanted: wanted.to_vec(),
            columns: Vec::new(),
        };
        if !rows.next_line()? {
            let expected = wanted.join(",");
            return Err(rows.fault(1, format!("the file is empty, expected a first row such as `{expected}`")));
        }
        rows.columns = rows.header()?;
        Ok(rows)
    }

    fn header(&self) -> Result<Vec<Option<usize>>, TraceError> {
        let mut columns = Vec::new();
        let mut seen = vec![false; self.wanted.len()];
        let text = self.utf8()?;
        for (column, name) in fields(text) {
            let which = self.wanted.iter().position(|wanted| *wanted == name);
            if which.is_some_and(|which| std::mem::replace(&mut seen[which], true)) {
                return Err(self.fault(column, format!("the column `{name}` appears twice")));
            }
            columns.push(which);
        }
        let missing: Vec<&str> =
            self.wanted.iter().zip(&seen).filter(|(_, seen)| !**seen).map(|(name, _)| *name).collect();
        if missing.is_empty() {
            return Ok(columns);
        }
        let names = missing.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ");
        let hint = if columns.len() == 1 && (text.contains(';') || text.contains('\t')) {
            "; columns are separated by commas"
        } else if missing == ["wavelength_nm"] {
            "; or trace at one wavelength (--line) or at the stated indices (--nd)"
        } else {
            ""
        };
        let noun = if missing.len() == 1 { "the column" } else { "the columns" };
        Err(self.fault(
            1,
            format!("{noun} {names} {} missing in the first row{hint}", if missing.len() == 1 { "is" } else { "are" }),
        ))
    }

    /// Reads the next row into `values`, one value for each wanted column; returns false at the end of the file.
    pub(crate) fn next_row(&mut self, values: &mut [f64]) -> Result<bool, TraceError> {
        if !self.next_line()? {
            return Ok(false);
        }
        let text = self.utf8()?;
        let mut count = 0;
        for (at, (column, field)) in fields(text).enumerate() {
            count += 1;
            if let Some(which) = self.columns.get(at).copied().flatten() {
                values[which] = number(field)
                    .map_err(|found| self.fault(column, format!("column `{}`: {found}", self.wanted[which])))?;
            }
        }
        if count != self.columns.len() {
            let expected = self.columns.len();
            let hint = if count > expected { "; write numbers with a decimal point, not a comma" } else { "" };
            return Err(self.fault(1, format!("found {count} columns where the first row has {expected}{hint}")));
        }
        Ok(true)
    }

    /// Returns an error in the row that was read last, at the column with this name.
    pub(crate) fn fault_at(&self, name: &str, message: &str) -> TraceError {
        let which = self.wanted.iter().position(|wanted| *wanted == name);
        let at = self.columns.iter().position(|column| column.is_some() && *column == which);
        let text = self.utf8().unwrap_or("");
        let column = at.and_then(|at| fields(text).nth(at)).map_or(1, |(column, _)| column);
        self.fault(column, message.to_owned())
    }

    /// Reads the next line that is not empty; returns false at the end of the file.
    fn next_line(&mut self) -> Result<bool, TraceError> {
        loop {
            self.text.clear();
            let read = self.input.by_ref().take(LONGEST_LINE).read_until(b'\n', &mut self.text);
            let read = read.map_err(|cause| TraceError::Read { file: self.file.clone(), cause })?;
            self.line += 1;
            if read as u64 == LONGEST_LINE && self.text.last() != Some(&b'\n') {
                return Err(
                    self.fault(1, format!("a line of more than {LONGEST_LINE} bytes: this is not a table of rays"))
                );
            }
            if read == 0 {
                return Ok(false);
            }
            if self.line == 1 && self.text.starts_with(b"\xef\xbb\xbf") {
                self.text.drain(..3);
            }
            let kept = self.text.trim_ascii_end().len();
            self.text.truncate(kept);
            if kept > 0 {
                return Ok(true);
            }
        }
    }

    fn utf8(&self) -> Result<&str, TraceError> {
        std::str::from_utf8(&self.text).map_err(|error| {
            let column = String::from_utf8_lossy(&self.text[..error.valid_up_to()]).chars().count() + 1;
            self.fault(column, "found bytes that are not UTF-8 text".to_owned())
        })
    }

    fn fault(&self, column: usize, message: String) -> TraceError {
        TraceError::Input { file: self.file.clone(), line: self.line.max(1), column, message }
    }
}

/// Iterates over the fields of a row, each with the column (in characters, from 1) where it starts. A field may be quoted.
fn fields(row: &str) -> impl Iterator<Item = (usize, &str)> {
    let mut rest = Some(row);
    let mut column = 1;
    std::iter::from_fn(move || {
        let text = rest?;
        let lead = text.len() - text.trim_start().len();
        // A comma inside quotes does not separate fields.
        let from = match text[lead..].strip_prefix('"').and_then(|quoted| quoted.find('"')) {
            Some(end) => lead + end + 2,
            None => 0,
        };
        let end = text[from..].find(',').map(|at| at + from);
        let field = &text[..end.unwrap_or(text.len())];
        let trimmed = field.trim();
        let value = trimmed.strip_prefix('"').and_then(|t| t.strip_suffix('"')).unwrap_or(trimmed);
        let start = column + text[..lead.min(field.len())].chars().count();
        column += field.chars().count() + 1;
        rest = end.map(|at| &text[at + 1..]);
        Some((start, value))
    })
}

/// Parses a finite number, or says what was found instead.
fn number(field: &str) -> Result<f64, String> {
    match field.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        Ok(_) => Err(format!("found {}, expected a finite number", shortened(field))),
        Err(_) if field.is_empty() => Err("found nothing, expected a number".to_owned()),
        Err(_) => Err(format!("found `{}`, expected a number", shortened(field))),
    }
}

/// Makes a user's text fit on one short line.
fn shortened(text: &str) -> String {
    let safe: String = text.chars().map(|c| if c.is_control() { '\u{fffd}' } else { c }).take(41).collect();
    if safe.chars().count() > 40 { safe.chars().take(40).chain("...".chars()).collect() } else { safe }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Vec<[f64; 2]>, String> {
        let mut rows = NumberRows::new(text.as_bytes(), "rays.csv", &["x", "y"]).map_err(|e| e.to_string())?;
        let mut all = Vec::new();
        let mut values = [0.0; 2];
        while rows.next_row(&mut values).map_err(|e| e.to_string())? {
            all.push(values);
        }
        Ok(all)
    }

    #[test]
    fn columns_are_found_by_name() {
        for text in [
            "x,y\n1,2\n-3e-4,5",
            "y,x\n2,1\n5,-3e-4\n",
            "\u{feff}name, y ,x\r\n\"a, b\",2,1\r\n\r\nc,\"5\", -3e-4 \r\n",
        ] {
            assert_eq!(read(text), Ok(vec![[1.0, 2.0], [-3e-4, 5.0]]), "{text}");
        }
        assert_eq!(read("x,y\n"), Ok(Vec::new()));
    }

    #[test]
    fn faults_name_file_row_and_column() {
        for (text, want) in [
            ("x,y\n1,2\n1, two\n", "rays.csv:3:4: column `y`: found `two`, expected a number"),
            ("x,y\n1,\n", "rays.csv:2:3: column `y`: found nothing, expected a number"),
            ("x,y\n1,nan\n", "rays.csv:2:3: column `y`: found nan, expected a finite number"),
            ("x,y\n1\n", "rays.csv:2:1: found 1 columns where the first row has 2"),
            (
                "x,y\n1,5,2\n",
                "rays.csv:2:1: found 3 columns where the first row has 2; write numbers with a decimal point, not a comma",
            ),
            ("x,x,y\n", "rays.csv:1:3: the column `x` appears twice"),
            ("x\n", "rays.csv:1:1: the column `y` is missing in the first row"),
            (
                "x;y\n",
                "rays.csv:1:1: the columns `x`, `y` are missing in the first row; columns are separated by commas",
            ),
            ("", "rays.csv:1:1: the file is empty, expected a first row such as `x,y`"),
        ] {
            assert_eq!(read(text).unwrap_err(), want, "{text}");
        }
    }

    #[test]
    fn bytes_that_are_no_text_and_endless_lines_are_faults() {
        let mut rows = NumberRows::new(&b"x,y\n1,\xff\n"[..], "r", &["x", "y"]).expect("a header");
        assert_eq!(rows.next_row(&mut [0.0; 2]).unwrap_err().to_string(), "r:2:3: found bytes that are not UTF-8 text");
        let endless = std::io::BufReader::new(std::io::repeat(b'1'));
        let Err(error) = NumberRows::new(endless, "r", &["x", "y"]) else { panic!("endless") };
        assert!(error.to_string().starts_with("r:1:1: a line of more than"), "{error}");
    }
}
