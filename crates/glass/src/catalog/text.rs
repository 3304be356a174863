//! The catalogue's text format; see `spectra/glass/README.md`.

use std::sync::Arc;

use super::CatalogError;
use crate::formula::BUCHDAHL;
use crate::formula::{Formula, ModelGlass, NumberedFormula, Table};
use crate::glass::{Category, Extinction, Glass, Status, Thermal};
use crate::lines::LineTriple;

/// The catalogue's text with the places of its records.
#[derive(Debug, Default)]
pub(super) struct Bundle {
    records: Vec<Record>,
    blocks: Vec<Block>,
    grids: Vec<&'static str>,
    aliases: Vec<(&'static str, &'static str)>,
}

#[derive(Debug)]
struct Record {
    name: &'static str,
    rest: &'static str,
    block: u32,
    line: u32,
}

#[derive(Debug)]
struct Block {
    maker: Arc<str>,
    category: Category,
    source: Arc<str>,
}

impl Bundle {
    /// Finds the records, and reads only their names.
    pub(super) fn new(text: &'static str) -> Result<Bundle, CatalogError> {
        let mut bundle = Bundle::default();
        let mut sources: Vec<(&str, Arc<str>)> = Vec::new();
        for (i, line) in text.lines().enumerate() {
            let fail = |message: &str| CatalogError { line: i + 1, message: message.to_owned() };
            match line.as_bytes().first() {
                None | Some(b'#') => {}
                Some(b'!') => {
                    let (key, value) = line[1..].split_once(' ').ok_or_else(|| fail("a directive without a value"))?;
                    match key {
                        "grid" => bundle.grids.push(value),
                        "source" => {
                            let (mark, text) = value.split_once(' ').ok_or_else(|| fail("a source without a text"))?;
                            sources.push((mark, text.into()));
                        }
                        "alias" => {
                            bundle.aliases.push(value.split_once(" = ").ok_or_else(|| fail("an alias without ` = `"))?);
                        }
                        _ => return Err(fail("unknown directive")),
                    }
                }
                Some(b'@') => {
                    let mut parts = line[1..].split('|');
                    let (maker, category, mark) = (parts.next(), parts.next(), parts.next());
                    let category = category.and_then(Category::by_name).ok_or_else(|| fail("unknown category"))?;
                    let source =
                        sources.iter().find(|(m, _)| Some(*m) == mark).ok_or_else(|| fail("unknown source"))?;
                    bundle.blocks.push(Block {
                        maker: maker.unwrap_or_default().into(),
                        category,
                        source: source.1.clone(),
                    });
                }
                Some(_) => {
                    let (name, rest) = line.split_once('|').ok_or_else(|| fail("a record without fields"))?;
                    let block =
                        bundle.blocks.len().checked_sub(1).ok_or_else(|| fail("a record before its maker"))? as u32;
                    bundle.records.push(Record { name, rest, block, line: i as u32 + 1 });
                }
            }
        }
        Ok(bundle)
    }

    pub(super) fn len(&self) -> usize {
        self.records.len()
    }

    pub(super) fn name(&self, i: usize) -> &'static str {
        self.records[i].name
    }

    pub(super) fn maker(&self, i: usize) -> &str {
        &self.blocks[self.records[i].block as usize].maker
    }

    /// Returns whether record `i` has a column of extinction.
    pub(super) fn has_extinction(&self, i: usize) -> bool {
        self.records[i].rest.split('|').nth(6).is_some_and(|column| !column.is_empty())
    }

    pub(super) fn category(&self, i: usize) -> Category {
        self.blocks[self.records[i].block as usize].category
    }

    /// Iterates over everyday names and the media that they stand for.
    pub(super) fn aliases(&self) -> impl Iterator<Item = (&'static str, &'static str)> + '_ {
        self.aliases.iter().copied()
    }

    /// Returns the medium that an everyday name stands for.
    pub(super) fn alias(&self, name: &str) -> Option<&'static str> {
        self.aliases.iter().find(|(alias, _)| alias.eq_ignore_ascii_case(name)).map(|(_, target)| *target)
    }

    /// Returns the glass of record `i`.
    pub(super) fn glass(&self, i: usize) -> Result<Glass, CatalogError> {
        let record = &self.records[i];
        let block = &self.blocks[record.block as usize];
        self.read(record, block)
            .map_err(|message| CatalogError { line: record.line as usize, message: message.to_owned() })
    }

    fn read(&self, record: &Record, block: &Block) -> Result<Glass, &'static str> {
        let mut fields = record.rest.split('|');
        let mut field = || fields.next().unwrap_or_default();
        let (kind, range, listed, status, data, thermal, extinction) =
            (field(), field(), field(), field(), field(), field(), field());
        let [min, max] = numbers(range)?[..] else {
            return Err("a range is two wavelengths");
        };
        let mut glass = Glass {
            maker: block.maker.clone(),
            source: block.source.clone(),
            formula: formula(kind, data)?,
            ..Glass::new("", record.name, block.category, Formula::Constant(1.0), (min, max))
        };
        match numbers(listed)?[..] {
            [] => {}
            [nd, vd] => (glass.listed_nd, glass.listed_vd) = (Some(nd), Some(vd)),
            _ => return Err("listed values are nd and Vd"),
        }
        (glass.status, glass.years) = status_and_years(status)?;
        match numbers(thermal)?[..] {
            [] => {}
            [t] => glass.temperature_c = Some(t),
            [t, d0, d1, d2, e0, e1, lambda_tk_um] => {
                glass.temperature_c = Some(t);
                glass.thermal = Some(Thermal { d: [d0, d1, d2], e: [e0, e1], lambda_tk_um });
            }
            _ => return Err("thermal data are a temperature and six coefficients"),
        }
        if !extinction.is_empty() {
            glass.extinction = Some(self.extinction(extinction)?);
        }
        Ok(glass)
    }

    fn extinction(&self, text: &str) -> Result<Extinction, &'static str> {
        let (grid, values) = text.split_once(' ').ok_or("extinction without values")?;
        let grid = grid.parse().ok().and_then(|i: usize| self.grids.get(i)).ok_or("unknown wavelength grid")?;
        let k = values.split(' ').map(short).collect::<Result<_, _>>()?;
        Extinction::new(numbers(grid)?.into(), k).ok_or("extinction does not fit its grid")
    }
}

fn formula(kind: &str, data: &str) -> Result<Formula, &'static str> {
    let c = numbers(data)?;
    match kind {
        "B" if c.len() == 4 => Ok(BUCHDAHL.with(&c)),
        "B" => Err("Buchdahl's model has four coefficients"),
        "M" => match c[..] {
            [nd, vd] => {
                ModelGlass::new(nd, vd, LineTriple::FDC).map(Formula::Model).ok_or("no glass has such nd and Vd")
            }
            _ => Err("a model glass is nd and Vd"),
        },
        "T" => {
            if c.len() % 2 != 0 {
                return Err("a table consists of pairs");
            }
            let points: Vec<_> = c.chunks_exact(2).map(|p| (p[0], p[1])).collect();
            Table::new(&points).map(|t| Formula::Table(t.into())).map_err(|_| "wavelengths of a table must increase")
        }
        _ => {
            let number = kind.parse().map_err(|_| "unknown type")?;
            NumberedFormula::new(number, &c).map(Formula::Numbered).ok_or("coefficients do not fit the formula")
        }
    }
}

/// First and last year, if known.
type Years = Option<(u16, u16)>;

fn status_and_years(text: &str) -> Result<(Status, Years), &'static str> {
    let digits = text.trim_start_matches(|c: char| !c.is_ascii_digit());
    let status = match &text[..text.len() - digits.len()] {
        "" => Status::Unknown,
        "p" => Status::Preferred,
        "s" => Status::Standard,
        "x" => Status::Special,
        "o" => Status::Obsolete,
        "m" => Status::Melt,
        _ => return Err("unknown status"),
    };
    if digits.is_empty() {
        return Ok((status, None));
    }
    let (first, last) = digits.split_once('-').unwrap_or((digits, digits));
    match (first.parse(), last.parse()) {
        (Ok(first), Ok(last)) => Ok((status, Some((first, last)))),
        _ => Err("years are FIRST-LAST"),
    }
}

fn numbers(text: &str) -> Result<Vec<f64>, &'static str> {
    text.split(' ').filter(|t| !t.is_empty()).map(|t| t.parse().map_err(|_| "not a number")).collect()
}

/// Reads a number in short form: `286-8` is 286e-8; a plain number is itself.
fn short(text: &str) -> Result<f64, &'static str> {
    let fail = "not an extinction coefficient";
    match text.split_once('-') {
        Some((mantissa, exponent)) if !mantissa.contains('e') => {
            // Read as one decimal number, so that it is rounded once.
            format!("{mantissa}e-{exponent}").parse().map_err(|_| fail)
        }
        _ => text.parse().map_err(|_| fail),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "# remark\n!source a Somebody\n!alias best = MAKER/G1\n!grid 400 500\n@MAKER|optical glass|a\n\
                        G1|5|400 700|1.5 60|p1983-2017|1.5 0.004 -2|20 1e-6 0 0 1e-7 0 0.2|0 286-8 1e-5\nG2|T|400 700||o|400 1.6 700 1.5\n";

    #[test]
    fn a_record_with_all_fields() {
        let bundle = Bundle::new(TEXT).expect("well-formed");
        let glass = bundle.glass(0).expect("well-formed");
        assert_eq!(
            (glass.full_name().as_str(), glass.status, glass.years),
            ("MAKER/G1", Status::Preferred, Some((1983, 2017)))
        );
        assert_eq!((glass.listed_nd, glass.listed_vd, glass.temperature_c), (Some(1.5), Some(60.0), Some(20.0)));
        assert!((glass.index(500.0) - 1.516).abs() < 1e-15);
        assert_eq!(glass.extinction.as_ref().and_then(|e| e.at(400.0)), Some(2.86e-6));
        assert_eq!(&*glass.source, "Somebody");
        assert_eq!(bundle.alias("Best"), Some("MAKER/G1"));
        let plain = bundle.glass(1).expect("well-formed");
        assert_eq!(
            (plain.status, plain.years, plain.listed_nd, plain.extinction),
            (Status::Obsolete, None, None, None)
        );
    }

    #[test]
    fn faults_name_their_line() {
        for (text, line) in [
            ("A|5|1 2\n", 1),
            ("!source a b\n@M|optical glass|a\nG\n", 3),
            ("!source a b\n@M|stone|a\n", 2),
            ("@M|optical glass|a\n", 1),
            ("!what is\n", 1),
        ] {
            assert_eq!(Bundle::new(text).map_err(|e| e.line).err(), Some(line), "{text}");
        }
        for record in [
            "G|5|400|",
            "G|0|4 7|||1",
            "G|5|4 7|1||1",
            "G|5|4 7||q|1",
            "G|5|4 7||||1 2",
            "G|5|4 7|||1||0 1",
            "G|T|4 7|||1 1 1 1",
            "G|5|4 x|||1",
        ] {
            let text: &'static str =
                Box::leak(format!("!source a b\n!grid 400 500\n@M|optical glass|a\n{record}\n").into_boxed_str());
            assert_eq!(
                Bundle::new(text).expect("heads are fine").glass(0).map_err(|e| e.line).err(),
                Some(4),
                "{record}"
            );
        }
    }
}
