//! Faulty tables end in an error that names file, row and column.

use spectra_spectrum::table::{MAX_ROWS, Table};
use spectra_spectrum::{Kind, Scale, find, find_emission, find_reflectance, find_sensitivity, find_transmittance};

const HEAD: &str = "# spectra: 1\n# kind: sensitivity\n";

fn message(text: &str, kind: Option<Kind>) -> String {
    Table::parse("bad.csv", text, kind).expect_err(text).to_string()
}

#[test]
fn each_fault_has_its_place() {
    let emission = Some(Kind::Emission);
    for (text, want) in [
        ("", "bad.csv: holds no data"),
        ("wavelength_nm,p\n", "bad.csv: holds no data"),
        ("# spectra: 1\n# kind: emission\nwavelength_nm,p\n\n", "bad.csv: holds no data"),
        (
            "wavelength_nm,p\n400,1\n390,1\n410,1\n",
            "bad.csv: row 3, column 1 (wavelength_nm): 390 nm does not come after 400 nm: wavelengths must increase",
        ),
        (
            "wavelength_nm,p\n400,1\n400,1\n",
            "bad.csv: row 3, column 1 (wavelength_nm): 400 nm does not come after 400 nm: wavelengths must increase",
        ),
        (
            "wavelength_nm,p\n-400,1\n",
            "bad.csv: row 2, column 1 (wavelength_nm): a wavelength is a positive number of nanometers, not -400",
        ),
        ("wavelength_nm,p,q\n400,1,2\n410,1,-2\n", "bad.csv: row 3, column 3 (q): emission cannot be negative: -2"),
        ("wavelength_nm,p\n400,NaN\n", "bad.csv: row 2, column 2 (p): `NaN` is not a finite number"),
        ("wavelength_nm,p\n400,inf\n", "bad.csv: row 2, column 2 (p): `inf` is not a finite number"),
        ("wavelength_nm,p\n400,1e999\n", "bad.csv: row 2, column 2 (p): `1e999` is not a finite number"),
        ("wavelength_nm,p\n400,\n", "bad.csv: row 2, column 2 (p): `` is not a number"),
        ("wavelength_nm,p\n400,0x10\n", "bad.csv: row 2, column 2 (p): `0x10` is not a number"),
        (
            "wavelength_nm,p\n400\n",
            "bad.csv: row 2, column 1 (wavelength_nm): fields in this row: 1; fields in the header: 2",
        ),
        ("wavelength_nm,p\n400,1,2\n", "bad.csv: row 2, column 2 (p): fields in this row: 3; fields in the header: 2"),
        (
            "time,p\n400,1\n",
            "bad.csv: row 1, column 1: a header such as `wavelength_nm,power` is expected here, not `time,p`",
        ),
        ("400\n410\n", "bad.csv: row 1: fields in this row: 1; fields in the header: 2"),
        ("wavelength_nm;p\n400;1,5,2\n", "bad.csv: row 2, column 2 (p): `1.5,2` is not a number"),
        ("wavelength_nm,p,p\n", "bad.csv: row 1, column 3: column name `p` is empty or appears twice"),
    ] {
        assert_eq!(message(text, emission), want);
    }
}

#[test]
fn percentages_are_noticed() {
    for (kind, bound) in [(Kind::Sensitivity, "2"), (Kind::Transmittance, "1.02"), (Kind::Reflectance, "1.5")] {
        let got = message("wavelength_nm,red\n400,0.5\n410,80\n", Some(kind));
        assert_eq!(
            got,
            format!("bad.csv: row 3, column 2 (red): 80 is more than {bound}: given as percent? divide by 100")
        );
    }
    let got = message(&format!("{HEAD}# unit: %\nwavelength_nm,red\n400,50\n"), None);
    assert_eq!(got, "bad.csv: row 3: `unit` should be 1 or log10; divide percentages by 100, not `%`");
}

#[test]
fn front_matter_is_checked() {
    for (line, want) in [
        ("# outside: nothing", "bad.csv: row 3: `outside` should be zero, constant or geometric, not `nothing`"),
        (
            "# kind: light",
            "bad.csv: row 3: `kind` should be emission, lines, transmittance, reflectance, sensitivity, color-matching or components, not `light`",
        ),
        (
            "# range: 700-400 nm",
            "bad.csv: row 3: `range` should be two wavelengths, such as 380-780 nm, not `700-400 nm`",
        ),
        ("# a remark", "bad.csv: row 3: front matter is written as `# key: value`"),
    ] {
        assert_eq!(message(&format!("{HEAD}{line}\nwavelength_nm,p\n400,1\n"), None), want);
    }
    let sprague = format!("{HEAD}# interpolation: sprague\nwavelength_nm,p\n400,1\n");
    assert_eq!(
        message(&sprague, None),
        "bad.csv: `interpolation: sprague` needs at least six equally spaced wavelengths"
    );
    assert!(
        message(&format!("{HEAD}# sauce: x\nwavelength_nm,p\n400,1\n"), None).contains("row 3: unknown key `sauce`")
    );
    assert!(message("# spectra: 2\nwavelength_nm,p\n400,1\n", None).contains("row 1: `spectra` should be 1"));
    assert!(message("wavelength_nm,p\n400,1\n", None).contains("the kind is not stated"));
}

#[test]
fn size_is_bounded() {
    let mut text = String::from("wavelength_nm,p\n");
    for i in 0..=MAX_ROWS {
        text.push_str(&format!("{},1\n", i + 1));
    }
    assert_eq!(message(&text, Some(Kind::Emission)), format!("bad.csv: row {}: more than 100000 rows", MAX_ROWS + 2));
    let wide = vec!["p"; 300].iter().enumerate().map(|(i, p)| format!(",{p}{i}")).collect::<String>();
    assert!(message(&format!("wavelength_nm{wide}\n"), Some(Kind::Emission)).contains("more than 256 columns"));
    assert!(Table::parse_bytes("bad.csv", &[0xff, 0xfe], None).expect_err("binary").to_string().contains("not UTF-8"));
}

#[test]
fn windows_files_and_free_comments_are_read() {
    let text = "\u{feff}# measured on a Tuesday\r\nwavelength_nm, p\r\n400 , 1\r\n\r\n# more\r\n410,2\r\n";
    let table = Table::parse("mine.csv", text, Some(Kind::Emission)).expect("sound");
    assert_eq!((&*table.wavelengths_nm, &*table.values[0]), (&[400.0, 410.0][..], &[1.0, 2.0][..]));
    let log = Table::parse("s.csv", &format!("{HEAD}# unit: log10\nwavelength_nm,s\n400,-1\n410,1.5\n"), None)
        .expect("sound");
    assert_eq!(log.meta.scale(), Scale::Log10);
    assert!((log.column_at(0).at(400.0) - 0.1).abs() < 1e-16);
}

/// Each of these texts is the same table: 400 nm 0.5, 410 nm 1, 420 nm 0.25.
#[test]
fn tables_are_read_as_people_have_them() {
    for (text, column, notes) in [
        ("400,0.5\n410,1\n420,0.25\n", "value", &["no column names"][..]),
        ("wavelength,value\n400,0.5\n410,1\n420,0.25\n", "value", &[]),
        ("\"Wavelength (nm)\",\"Power\"\n400,0.5\n410,1\n420,0.25\n", "Power", &[]),
        ("nm;power\n400;0,5\n410;1\n420;0,25\n", "power", &[]),
        ("400,0;0,5\n410,0;1,0\n420,0;0,25\n", "value", &["no column names"]),
        ("nm\tpower\n400\t0.5\n410\t1\n420\t0,25\n", "power", &[]),
        ("# lamp\n  400   0.5\n  410   1\n  420   2.5e-1\n", "value", &["no column names"]),
        ("400 0,5\n410 1\n420 0,25\n", "value", &["no column names"]),
        ("Wavelength [nm]  Power [W]\n400 0.5\n410 1\n420 0.25\n", "value", &["no column names"]),
        ("420, 0.25\n410, 1\n400, 0.5\n", "value", &["no column names", "falling wavelengths"]),
        ("um,p\n0.4,0.5\n0.41,1\n0.42,0.25\n", "p", &["wavelengths in micrometers"]),
        (
            "0.42 0.25\r\n0.41 1\r\n0.4 0.5\r\n",
            "value",
            &["no column names", "falling wavelengths", "wavelengths in micrometers"],
        ),
    ] {
        let table = Table::parse("mine.txt", text, Some(Kind::Emission)).unwrap_or_else(|e| panic!("{text}{e}"));
        assert_eq!(
            (&*table.wavelengths_nm, &*table.values[0]),
            (&[400.0, 410.0, 420.0][..], &[0.5, 1.0, 0.25][..]),
            "{text}"
        );
        assert_eq!((table.columns, &table.notes[..]), (vec![column.to_owned()], notes), "{text}");
    }
    // A table that declares our format must keep to it.
    for text in
        ["400,1\n410,1\n", "wavelength_nm;p\n400;1\n", "wavelength_nm,p\n410,1\n400,1\n", "wavelength_nm,p\n0.4,1\n"]
    {
        let strict = format!("# spectra: 1\n# kind: emission\n{text}");
        assert!(Table::parse("ours.csv", &strict, None).is_err(), "{text}");
    }
}

#[test]
fn what_is_not_there_is_said_with_near_names() {
    for (name, want) in [
        ("D66", "no spectrum is called `D66`; near: D60, D65"),
        ("mercuri", "no spectrum is called `mercuri`; near: mercury"),
        ("blackbdy:5800", "no spectrum is called `blackbdy:5800`; near: blackbody:5800"),
        ("no-such.csv", "no spectrum is called `no-such.csv`"),
        (
            "gaussian:550",
            "`gaussian:550` is not understood: write center and standard deviation in nm, such as gaussian:550,20",
        ),
        ("gaussian:550,0", "standard deviation, nm must be positive, not 0"),
        ("line:Q", "`line:Q` is not understood: write a letter or a wavelength in nm, such as line:C' or line:632.8"),
        ("blackbody:nan", "`blackbody:nan` is not understood: write a temperature in kelvin, such as blackbody:5800"),
        ("colorchecker", "`colorchecker` holds dark-skin,"),
        ("colorchecker#rot", "`spectra/reflectances/colorchecker.csv` has no column `rot`"),
        ("cie-rgb-1931#r", "`cie-rgb-1931#r` is of kind color-matching"),
    ] {
        let got = find(name).expect_err(name).to_string();
        assert!(got.starts_with(want), "{got}");
    }
    assert_eq!(
        find_transmittance("D65").expect_err("a light").to_string(),
        "`D65` is of kind emission, but transmittance is expected here"
    );
}

#[test]
fn inline_spectra_are_what_is_wanted() {
    assert_eq!(find_emission("line:C'").expect("a line").lines()[0].wavelength_nm, 643.85);
    assert_eq!(find_emission("line: 632.8").expect("a line").lines()[0].wavelength_nm, 632.8);
    assert_eq!(find_transmittance("rectangle:500,600").expect("a filter").at(550.0), 1.0);
    assert_eq!(find_sensitivity("gaussian:550,20").expect("a detector").at(550.0), 1.0);
    assert_eq!(find_reflectance("constant:0.18").expect("a surface").at(550.0), 0.18);
    assert!(find_reflectance("constant:18").is_err());
    assert_eq!(find_sensitivity("cie-1931-2deg#y").expect("a detector").at(555.0), 1.0);
    assert!((find_emission("blackbody:5800").expect("light").at(500.0) * 1e9 / 2.69e13 - 1.0).abs() < 1e-2);
}
