//! Tests with arbitrary bytes: reading gives a lens or faults but never panics, and what was read can be written and read again.

use proptest::prelude::*;
use spectra_exchange::{Format, MAX_BYTES, read, yaml, zmx};
use std::path::Path;

fn sample(file: &str) -> Vec<u8> {
    std::fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(file)).expect("test data")
}

fn survive(format: Format, bytes: &[u8]) {
    if let Ok(lens) = read(format, "x", bytes) {
        let _ = yaml::write(&lens, Some("x"));
        let written = zmx::write(&lens);
        if let Err(faults) = read(Format::Zmx, "again", &zmx::encode(&written.text)) {
            panic!("what was written cannot be read: {faults}\n{}", written.text);
        }
    }
}

const WORDS: [&str; 24] = [
    "inf",
    "-inf",
    "nan",
    "1e308",
    "-1e308",
    "1e-320",
    "0",
    "-0",
    "99999999999",
    "INFINITY",
    "MIRROR",
    "___BLANK",
    "SURF",
    "PARM 4000000000 1",
    "XDAT 1 240",
    "CURV",
    "\"",
    "'",
    "&",
    ";",
    "COORDBRK",
    "S",
    "SI",
    "\u{fe0f}",
];

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn any_bytes(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
        for format in [Format::Zmx, Format::Seq, Format::Csv] {
            survive(format, &bytes);
        }
    }

    #[test]
    fn files_with_wounds(
        file in 0_usize..5,
        cuts in proptest::collection::vec((any::<prop::sample::Index>(), 0_usize..40, 0_usize..WORDS.len()), 1..6),
    ) {
        let (format, name) = [
            (Format::Zmx, "rayoptics/HoO-V2C18Ex27.zmx"),
            (Format::Zmx, "optiland/curved_reflective_grating.zmx"),
            (Format::Zmx, "rayoptics/HoO-V2C18Ex46.zmx"),
            (Format::Seq, "rayoptics/dec_test.seq"),
            (Format::Seq, "rayoptics/folded_lenses.seq"),
        ][file];
        let mut text = spectra_exchange::text(&sample(name));
        for (at, length, word) in cuts {
            let at = at.index(text.len().max(1));
            let start = (0..=at).rev().find(|i| text.is_char_boundary(*i)).unwrap_or(0);
            let end = (at + length..=text.len()).find(|i| text.is_char_boundary(*i)).unwrap_or(text.len());
            text.replace_range(start..end.max(start), WORDS[word]);
        }
        survive(format, text.as_bytes());
        let utf16: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
        survive(format, &utf16);
    }

    #[test]
    fn tables_with_any_cells(cells in proptest::collection::vec(proptest::collection::vec("[-0-9a-zA-Z.;\" ]{0,8}", 8), 0..6)) {
        let mut text = "surface,type,radius,thickness,nd,vd,glass,semi-diameter\n".to_owned();
        for row in cells {
            text.push_str(&row.join(","));
            text.push('\n');
        }
        survive(Format::Csv, text.as_bytes());
    }
}

#[test]
fn too_much_is_refused_before_it_is_read() {
    let big = vec![b' '; MAX_BYTES as usize + 1];
    assert!(read(Format::Zmx, "big.zmx", &big).unwrap_err().to_string().contains("bytes"));
    let many = "SURF 0\n  CURV 0\n".repeat(3000);
    assert!(read(Format::Zmx, "many.zmx", many.as_bytes()).unwrap_err().to_string().contains("at most 2000"));
    let many = "S 0 1\n".repeat(3000);
    assert!(read(Format::Seq, "many.seq", many.as_bytes()).unwrap_err().to_string().contains("2000"));
    let many = format!("radius,thickness\n{}", "1,1\n".repeat(3000));
    assert!(read(Format::Csv, "many.csv", many.as_bytes()).unwrap_err().to_string().contains("2000"));
}
