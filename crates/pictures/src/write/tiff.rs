//! Directories of a little-endian TIFF file (TIFF 6.0, Adobe, 1992).

/// A field of a directory: tag, type, count and value. Values of more than four bytes are stored after the directory.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Field {
    pub tag: u16,
    kind: u16,
    count: u32,
    bytes: Vec<u8>,
}

// Field types of TIFF.
const BYTE: u16 = 1;
const ASCII: u16 = 2;
const SHORT: u16 = 3;
const LONG: u16 = 4;
const RATIONAL: u16 = 5;
const UNDEFINED: u16 = 7;
const SRATIONAL: u16 = 10;
const DOUBLE: u16 = 12;

fn field(tag: u16, kind: u16, count: usize, bytes: Vec<u8>) -> Field {
    Field { tag, kind, count: count as u32, bytes }
}

pub(super) fn bytes(tag: u16, values: &[u8]) -> Field {
    field(tag, BYTE, values.len(), values.to_vec())
}

pub(super) fn undefined(tag: u16, values: &[u8]) -> Field {
    field(tag, UNDEFINED, values.len(), values.to_vec())
}

pub(super) fn text(tag: u16, value: &str) -> Field {
    let mut bytes: Vec<u8> = value.bytes().filter(|b| *b != 0).collect();
    bytes.push(0);
    field(tag, ASCII, bytes.len(), bytes)
}

pub(super) fn shorts(tag: u16, values: &[u16]) -> Field {
    field(tag, SHORT, values.len(), values.iter().flat_map(|v| v.to_le_bytes()).collect())
}

pub(super) fn longs(tag: u16, values: &[u32]) -> Field {
    field(tag, LONG, values.len(), values.iter().flat_map(|v| v.to_le_bytes()).collect())
}

pub(super) fn doubles(tag: u16, values: &[f64]) -> Field {
    field(tag, DOUBLE, values.len(), values.iter().flat_map(|v| v.to_le_bytes()).collect())
}

/// Builds a field of non-negative numbers: accurate to a millionth below 4000, and to nine digits above. Infinity is 1/0.
pub(super) fn rationals(tag: u16, values: &[f64]) -> Field {
    let one = |v: &f64| {
        if v.is_infinite() {
            return [1_u32, 0].map(u32::to_le_bytes).concat();
        }
        let mut denominator = 1_000_000_u32;
        while denominator > 1 && v * f64::from(denominator) > f64::from(u32::MAX) {
            denominator /= 10;
        }
        [(v * f64::from(denominator)).round() as u32, denominator].map(u32::to_le_bytes).concat()
    };
    field(tag, RATIONAL, values.len(), values.iter().flat_map(one).collect())
}

/// Builds a field of numbers from -2000 to 2000, accurate to a millionth.
pub(super) fn signed_rationals(tag: u16, values: &[f64]) -> Field {
    let one = |v: &f64| [(v * 1e6).round() as i32, 1_000_000].map(i32::to_le_bytes).concat();
    field(tag, SRATIONAL, values.len(), values.iter().flat_map(one).collect())
}

/// Builds a field with an exposure time as photographers write it: 1/n if n is a whole number or large.
pub(super) fn exposure(tag: u16, time_s: f64) -> Field {
    let inverse = 1.0 / time_s;
    let whole = (inverse.round() - inverse).abs() < 1e-6 * inverse || inverse > 1000.0;
    if whole && (1.0..4e9).contains(&inverse) {
        return field(tag, RATIONAL, 1, [1, inverse.round() as u32].map(u32::to_le_bytes).concat());
    }
    rationals(tag, &[time_s])
}

/// Returns the number of bytes of a directory with these fields, including the values after it.
pub(super) fn length(fields: &[Field]) -> usize {
    let beside = |f: &Field| if f.bytes.len() > 4 { f.bytes.len().next_multiple_of(2) } else { 0 };
    2 + fields.len() * 12 + 4 + fields.iter().map(beside).sum::<usize>()
}

/// Returns the bytes of the directory at byte `at` of the file. It is the only directory or the last of its chain.
pub(super) fn directory(fields: &[Field], at: usize) -> Vec<u8> {
    let mut fields: Vec<&Field> = fields.iter().collect();
    fields.sort_by_key(|f| f.tag);
    let values_at = at + 2 + fields.len() * 12 + 4;
    let mut out = (fields.len() as u16).to_le_bytes().to_vec();
    let mut values = Vec::new();
    for field in fields {
        out.extend(field.tag.to_le_bytes());
        out.extend(field.kind.to_le_bytes());
        out.extend(field.count.to_le_bytes());
        if field.bytes.len() <= 4 {
            let mut value = field.bytes.clone();
            value.resize(4, 0);
            out.extend(value);
        } else {
            out.extend(((values_at + values.len()) as u32).to_le_bytes());
            values.extend(&field.bytes);
            values.resize(values.len().next_multiple_of(2), 0);
        }
    }
    out.extend([0; 4]);
    out.extend(values);
    out
}
