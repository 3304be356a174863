//! Reads color profiles of three primaries and one curve, or of gray (ICC.1:2022).

use super::encoding::Encoding;
use spectra_color::matrix::{Matrix, apply, product};
use spectra_color::{Adaptation, RgbSpace, Transfer};

/// XYZ of D50, the white of the profile connection space (7.2.16).
pub(super) const D50: [f64; 3] = [0.9642, 1.0, 0.8249];
/// Bytes of a profile header, and of an entry of the tag table.
const HEADER: usize = 128;
const ENTRY: usize = 12;
/// Largest number of tags that are searched.
const MOST_TAGS: usize = 256;
/// Number of points at which curves are sampled and compared.
const POINTS: usize = 4096;
/// Largest difference in light at which two curves count as the same: sRGB profiles of many makers have tables of the curve.
const NEAR_CURVE: f64 = 1e-3;
/// Largest difference at which two colorants count as the same.
const NEAR_COLORANT: f64 = 2e-3;

/// A stated color encoding: the curve, and the matrix to the primaries of sRGB (`None` if they are the same).
pub(super) type Stated = (Encoding, Option<Matrix>);

/// Scales the rows of an RGB matrix to a sum of 1, so that gray stays gray to the last digit.
pub(super) fn keeping_white(matrix: Matrix) -> Matrix {
    matrix.map(|row| {
        let sum: f64 = row.iter().sum();
        row.map(|v| v / sum)
    })
}

/// Reads curve and primaries of a profile; `None` if it is of another kind or broken.
pub(super) fn read(bytes: &[u8]) -> Option<Stated> {
    if bytes.get(36..40)? != b"acsp" {
        return None;
    }
    match bytes.get(16..20)? {
        b"GRAY" => Some((encoding(&[tag(bytes, b"kTRC")?])?, None)),
        b"RGB " if bytes.get(20..24)? == b"XYZ " => {
            let curves = [tag(bytes, b"rTRC")?, tag(bytes, b"gTRC")?, tag(bytes, b"bTRC")?];
            let columns = [xyz(tag(bytes, b"rXYZ")?)?, xyz(tag(bytes, b"gXYZ")?)?, xyz(tag(bytes, b"bXYZ")?)?];
            Some((encoding(&curves)?, to_srgb(columns)?))
        }
        _ => None,
    }
}

/// Returns the data of a tag.
pub(super) fn tag<'a>(bytes: &'a [u8], name: &[u8; 4]) -> Option<&'a [u8]> {
    let count = (long(bytes, HEADER)? as usize).min(MOST_TAGS);
    let entry =
        (0..count).map(|i| HEADER + 4 + i * ENTRY).find(|at| bytes.get(*at..*at + 4).is_some_and(|own| own == name))?;
    let (at, length) = (long(bytes, entry + 4)? as usize, long(bytes, entry + 8)? as usize);
    bytes.get(at..at.checked_add(length)?)
}

pub(super) fn long(bytes: &[u8], at: usize) -> Option<u32> {
    let four = bytes.get(at..at.checked_add(4)?)?;
    Some(u32::from_be_bytes([four[0], four[1], four[2], four[3]]))
}

/// Reads a fixed-point number of 16.16 bits.
pub(super) fn fixed(bytes: &[u8], at: usize) -> Option<f64> {
    Some(f64::from(long(bytes, at)? as i32) / 65_536.0)
}

fn xyz(tag: &[u8]) -> Option<[f64; 3]> {
    if tag.get(..4)? != b"XYZ " {
        return None;
    }
    Some([fixed(tag, 8)?, fixed(tag, 12)?, fixed(tag, 16)?])
}

/// Matrix from primaries with these XYZ under D50 to those of sRGB; the inner `None` means that they are the same.
fn to_srgb(columns: [[f64; 3]; 3]) -> Option<Option<Matrix>> {
    let srgb = RgbSpace::srgb();
    let to_d50 = Adaptation::Bradford.matrix(srgb.white_xyz(), D50);
    let own = product(&to_d50, &srgb.xyz_from_rgb);
    let of_file: Matrix = [0, 1, 2].map(|i| [0, 1, 2].map(|j| columns[j][i]));
    if own.as_flattened().iter().zip(of_file.as_flattened()).all(|(a, b)| (a - b).abs() < NEAR_COLORANT) {
        return Some(None);
    }
    // Colorants whose sum is not near white are not a set of primaries.
    let white = apply(&of_file, [1.0; 3]);
    if white.iter().zip(D50).any(|(a, b)| (a - b).abs() > 0.05) {
        return None;
    }
    let to_d65 = Adaptation::Bradford.matrix(D50, srgb.white_xyz());
    Some(Some(keeping_white(product(&srgb.rgb_from_xyz, &product(&to_d65, &of_file)))))
}

/// Returns the curve that all tags share; `None` if they differ.
fn encoding(tags: &[&[u8]]) -> Option<Encoding> {
    let code = |i: usize| i as f64 / (POINTS - 1) as f64;
    let sampled = |tag: &[u8]| -> Option<Vec<f64>> {
        (0..POINTS).map(|i| light(tag, code(i)).filter(|v| v.is_finite())).collect()
    };
    let all: Vec<Vec<f64>> = tags.iter().map(|tag| sampled(tag)).collect::<Option<_>>()?;
    let first = all.first()?;
    let near = |a: f64, b: f64| (a - b).abs() < NEAR_CURVE;
    if all.iter().any(|other| other.iter().zip(first).any(|(a, b)| !near(*a, *b))) {
        return None;
    }
    let known = [Transfer::Linear, Transfer::Srgb, Transfer::Rec2020];
    let is = |transfer: &Transfer| first.iter().enumerate().all(|(i, v)| near(transfer.decode(code(i)), *v));
    if let Some(transfer) = known.into_iter().find(is) {
        return Some(Encoding::Curve(transfer));
    }
    Some(Encoding::Sampled(first.iter().map(|v| v.clamp(0.0, 1.0) as f32).collect()))
}

/// Light of a code value, 0 to 1, by a curve (10.6 and 10.18).
pub(super) fn light(tag: &[u8], code: f64) -> Option<f64> {
    match tag.get(..4)? {
        b"curv" => {
            let count = long(tag, 8)? as usize;
            let short = |i: usize| {
                let two = tag.get(12 + 2 * i..14 + 2 * i)?;
                Some(f64::from(u16::from_be_bytes([two[0], two[1]])))
            };
            match count {
                0 => Some(code),
                1 => Some(libm::pow(code, short(0)? / 256.0)),
                // A table has no more entries than code values.
                2..=65_536 => {
                    let place = code * (count - 1) as f64;
                    let at = (place as usize).min(count - 2);
                    let (a, b) = (short(at)?, short(at + 1)?);
                    Some((a + (b - a) * (place - at as f64)) / 65_535.0)
                }
                _ => None,
            }
        }
        b"para" => {
            let kind = u16::from_be_bytes([*tag.get(8)?, *tag.get(9)?]);
            let p = |i: usize| fixed(tag, 12 + 4 * i);
            let power = |a: f64, b: f64, g: f64| libm::pow((a * code + b).max(0.0), g);
            let g = p(0)?;
            Some(match kind {
                0 => libm::pow(code, g),
                1 if code >= -p(2)? / p(1)? => power(p(1)?, p(2)?, g),
                1 => 0.0,
                2 if code >= -p(2)? / p(1)? => power(p(1)?, p(2)?, g) + p(3)?,
                2 => p(3)?,
                3 if code >= p(4)? => power(p(1)?, p(2)?, g),
                3 => p(3)? * code,
                4 if code >= p(4)? => power(p(1)?, p(2)?, g) + p(5)?,
                4 => p(3)? * code + p(6)?,
                _ => return None,
            })
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::write::display_profile;

    #[test]
    fn own_profiles_are_known() {
        let read = |space: &RgbSpace, transfer| read(&display_profile(space, "a space", transfer)).expect("known");
        assert_eq!(read(RgbSpace::srgb(), Transfer::Srgb), (Encoding::Curve(Transfer::Srgb), None));
        let (encoding, matrix) = read(RgbSpace::display_p3(), Transfer::Srgb);
        assert_eq!(encoding, Encoding::Curve(Transfer::Srgb));
        // CSS Color Module Level 4: linear Display P3 to linear sRGB.
        let want = [[1.224_94, -0.224_94, 0.0], [-0.042_06, 1.042_06, 0.0], [-0.019_64, -0.078_64, 1.098_27]];
        for (got, want) in matrix.expect("another").as_flattened().iter().zip(want.as_flattened()) {
            assert!((got - want).abs() < 5e-4, "{got} {want}");
        }
        assert_eq!(read(RgbSpace::rec2020(), Transfer::Rec2020).0, Encoding::Curve(Transfer::Rec2020));
    }

    /// A power and a table of the same power are one curve: the light of code 0.5 is 0.5 to this power.
    #[test]
    fn powers_and_tables_are_one_curve() {
        let power = [b"curv\0\0\0\0\0\0\0\x01".to_vec(), 0x0233_u16.to_be_bytes().to_vec()].concat();
        let g = f64::from(0x0233_u16) / 256.0;
        let entries = (0..1024_u32).map(|i| (libm::pow(f64::from(i) / 1023.0, g) * 65_535.0).round() as u16);
        let table = [b"curv\0\0\0\0\0\0\x04\0".to_vec(), entries.flat_map(u16::to_be_bytes).collect()].concat();
        for curve in [&power, &table] {
            let encoding = encoding(&[curve.as_slice()]).expect("a curve");
            for code in [0.0, 0.1, 0.5, 1.0] {
                let got = encoding.decode(code);
                assert!((got - libm::pow(code, g)).abs() < 2e-5, "{code}: {got}");
            }
        }
    }

    #[test]
    fn broken_profiles_say_nothing() {
        let good = display_profile(RgbSpace::display_p3(), "a space", Transfer::Srgb);
        for cut in 0..good.len() - 44 {
            let _ = read(&good[..cut]);
        }
        for at in 0..good.len() {
            for byte in [0, 0xff] {
                let mut bad = good.clone();
                bad[at] = byte;
                let _ = read(&bad);
            }
        }
        assert_eq!(read(&good[..200]), None);
    }
}
