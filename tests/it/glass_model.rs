//! Tests lenses whose glasses are known only by nd and Vd, and the absorption of glass.

use spectra_glass::lines;
use spectra_lens::{Coating, Lens};
use spectra_optics::Optics;
use spectra_plugins as _;
use spectra_scene::FileResources;
use spectra_tracer::Indices;
use std::path::Path;

fn text(lens: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("lenses/{lens}.yaml"));
    std::fs::read_to_string(path).expect("a bundled lens")
}

fn parse(text: &str) -> Lens {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("lens.yaml");
    std::fs::write(&path, text).expect("written");
    spectra_lens::load(&path.to_string_lossy(), &FileResources::beside(Path::new(".")))
        .unwrap_or_else(|e| panic!("{e}"))
}

/// Returns the paraxial focus at h minus that at d, um. The table states the value with real glasses.
fn violet_focus_um(lens: &Lens) -> f64 {
    let bfl = |line: lines::Line| lens.first_order(line.wavelength_nm).bfl_mm;
    (bfl(lines::H) - bfl(lines::D)) * 1e3
}

/// Returns the lens file with the glass names removed, so that nd and Vd remain.
fn without_names(text: &str) -> String {
    let strike = |line: &str| match (line.split_once("glass: "), line.contains("nd:")) {
        (Some((before, after)), true) => {
            let (_, rest) = after.split_once(", ").expect("more keys");
            format!("{before}{rest}")
        }
        _ => line.to_owned(),
    };
    text.lines().map(strike).collect::<Vec<_>>().join("\n")
}

#[test]
fn the_secondary_spectrum_is_that_of_real_glass() {
    for (name, real, within) in [
        ("double-gauss-100-f5", 173.0, 40.0),
        ("zeiss-biotar-50-f1.4", -76.0, 30.0),
        ("canon-35-f1.8", -12.0, 50.0),
        ("asahi-takumar-100-f1.2", 80.0, 220.0),
    ] {
        let text = text(name);
        let named = violet_focus_um(&parse(&text));
        assert!((named - real).abs() < 1.0, "{name}: {named} with its glasses");
        let lens = parse(&without_names(&text));
        assert!(lens.media.iter().skip(1).all(|m| m.label.starts_with("nd = ")), "{name}");
        let by_figures = violet_focus_um(&lens);
        println!("{name}: {named:+.1} um, by nd and Vd {by_figures:+.1} um");
        assert!((by_figures - real).abs() < within, "{name}: {by_figures}");
    }
}

/// A patent may state all values at the e line, or more lines in addition to d.
#[test]
fn more_lines_of_a_patent() {
    let plate = |head: &str, glass: &str| {
        parse(&format!(
            "name: p\n{head}surfaces:\n  - {{kind: plane, thickness: 5, {glass}}}\n  - {{kind: plane, thickness: 1}}\n"
        ))
    };
    let index = |lens: &Lens, line: lines::Line| lens.index(1, line.wavelength_nm);
    // N-BK7 from ne and Ve, in both notations.
    for lens in [plate("reference-line: e\n", "nd: 1.518722, vd: 63.96"), plate("", "glass: {ne: 1.518722, ve: 63.96}")]
    {
        assert!((index(&lens, lines::D) - 1.5168).abs() < 2e-6 && (index(&lens, lines::E) - 1.518_722).abs() < 1e-12);
        assert!((index(&lens, lines::G) - 1.526_685).abs() < 5e-5);
    }
    // SF6: with only nd and Vd the index at h is wrong by 8e-4; with ng it is right.
    let plain = plate("", "glass: {nd: 1.80518, vd: 25.43}");
    let more = plate("", "glass: {nd: 1.80518, vd: 25.43, ng: 1.847073}");
    let lines_alone = plate("", "glass: {nd: 1.80518, nF: 1.827752, nC: 1.796092, ng: 1.847073}");
    assert!((index(&plain, lines::H) - 1.864_365).abs() > 5e-4);
    for lens in [&more, &lines_alone] {
        assert!((index(lens, lines::H) - 1.864_365).abs() < 1e-4, "{}", index(lens, lines::H));
    }
    assert_eq!(more.media[1].label, "nd = 1.80518, ng = 1.847073, vd = 25.43");
}

/// Returns the index of N-BK7 by Schott's formula (data sheet, 2014), independently of the program.
fn n_bk7(nm: f64) -> f64 {
    let square = nm * nm * 1e-6;
    let term = |b: f64, c: f64| b * square / (square - c);
    let sum = term(1.039_612_12, 0.006_000_698_67) + term(0.231_792_344, 0.020_017_914_4);
    (1.0 + sum + term(1.010_469_45, 103.560_653)).sqrt()
}

/// Index and Abbe number can be stated for any three lines, by name or wavelength: in a lens file by `reference-line` or at a
/// surface, in a glass by `abbe`. Each notation reproduces the glass with the stated figures.
#[test]
fn any_three_lines() {
    let plate = |head: &str, glass: &str| {
        parse(&format!(
            "name: p\n{head}surfaces:\n  - {{kind: plane, thickness: 5, {glass}}}\n  - {{kind: plane, thickness: 1}}\n"
        ))
    };
    for (lines, [short, mid, long]) in [
        ("[450 nm, 580, 0.68 um]", [450.0, 580.0, 680.0]),
        ("[F', e, C']", [479.9914, 546.074, 643.8469]),
        ("[F, e, C]", [486.1327, 546.074, 656.2725]),
    ] {
        let (n, v) = (n_bk7(mid), (n_bk7(mid) - 1.0) / (n_bk7(short) - n_bk7(long)));
        let by_lines = plate(&format!("reference-line: {lines}\n"), &format!("nd: {n:.6}, vd: {v:.3}"));
        let by_glass = plate("", &format!("glass: {{abbe: {{lines: {lines}, n: {n:.6}, v: {v:.3}}}}}"));
        // The index at d, with only the Abbe number for these lines.
        let mixed = plate("", &format!("glass: {{nd: {:.6}, abbe: {{lines: {lines}, v: {v:.3}}}}}", n_bk7(587.5618)));
        for lens in [&by_lines, &by_glass, &mixed] {
            for nm in [435.8343, 486.1327, 587.5618, 656.2725, 706.5188] {
                let off = lens.index(1, nm) - n_bk7(nm);
                assert!(off.abs() < 5e-5, "{lines} at {nm}: {off}");
            }
            let got = lens.media[1].medium.abbe_number(lens_lines(short, mid, long));
            assert!((got - v).abs() < 0.01, "{lines}: {got}, not {v}");
        }
        assert_eq!(by_lines.abbe_lines, lens_lines(short, mid, long));
        assert_eq!((by_lines.reference_nm, by_lines.media[1].stated_nd), (mid, Some((n * 1e6).round() / 1e6)));
        // A named glass is compared with the index at that line.
        let named = |n: f64| plate(&format!("reference-line: {lines}\n"), &format!("glass: SCHOTT/N-BK7, nd: {n:.5}"));
        assert!(named(n).warnings.is_empty(), "{:?}", named(n).warnings);
        assert!(named(n + 0.01).warnings[0].contains("the prescription states"), "{lines}");
    }
    // `ne` and `ve` of a surface work with any reference line.
    let (ne, ve) = (n_bk7(546.074), 63.96);
    for head in ["", "reference-line: e\n", "reference-line: D\n"] {
        let lens = plate(head, &format!("ne: {ne:.6}, ve: {ve}"));
        assert!((lens.index(1, 587.5618) - 1.5168).abs() < 2e-6, "{head}");
        assert!((lens.media[1].stated_nd.expect("known") - n_bk7(lens.reference_nm)).abs() < 2e-6, "{head}");
    }
}

fn lens_lines(short: f64, mid: f64, long: f64) -> spectra_glass::LineTriple {
    let [short, mid, long] = [short, mid, long].map(|nm| lines::Line::at(nm).expect("a line"));
    spectra_glass::LineTriple::rising(short, mid, long).expect("rising")
}

/// Glass names follow one rule (D6): an exact name comes first; if several glasses have it, the maker or the year of the lens
/// decides, otherwise the default maker, with a note.
#[test]
fn one_rule_for_names() {
    let plate = |head: &str, glass: &str| {
        let lens = parse(&format!(
            "name: p\n{head}surfaces:\n  - {{kind: plane, thickness: 5, glass: {glass}}}\n  - {{kind: plane, thickness: 1}}\n"
        ));
        (lens.media[1].medium.name(), lens.warnings)
    };
    let (name, notes) = plate("", "BK7");
    assert_eq!(name, "SCHOTT/BK7");
    assert!(notes.len() == 1 && notes[0].contains("surface 1: `BK7` is the name of 2 glasses"), "{notes:?}");
    assert_eq!(plate("maker: Nikon\n", "F2"), ("HIKARI/F2".to_owned(), Vec::new()));
    assert_eq!(plate("maker: Hoya\n", "F2"), ("HOYA/F2".to_owned(), Vec::new()));
    assert_eq!(plate("", "N-BK7"), ("SCHOTT/N-BK7".to_owned(), Vec::new()));
    let (name, notes) = plate("", "F2");
    assert!(name == "SCHOTT/F2" && notes[0].contains("HOYA/F2"), "{name} {notes:?}");
}

/// Glasses without published transmittance absorb like the nearest glasses, and the lens reports which ones.
#[test]
fn absorption_counts_in_every_lens() {
    for name in [
        "minolta-fisheye-16-f2.7",
        "canon-ef-70-200-f2.8-at-72",
        "nikkor-100-f1.4",
        "canon-35-f1.8",
        "schneider-anamorphic-60",
    ] {
        let mut lens = parse(&text(name)).with_coating(Coating::Ideal);
        let marginal = Optics::new(lens.clone()).marginal_ray().ok();
        let passed = |lens: &Lens, nm: f64| {
            Optics::new(lens.clone()).axial_transmittance(Indices::At(nm), marginal).expect("light")
        };
        // Compared with the same lens without absorption, because the rims cut the beam in both cases.
        let mut share = |nm: f64| {
            lens.absorption = false;
            let clear = passed(&lens, nm);
            lens.absorption = true;
            passed(&lens, nm) / clear
        };
        let (violet, green) = (share(420.0), share(550.0));
        println!("{name}: 420 nm {violet:.4}, 550 nm {green:.4}");
        assert!(violet < 0.99 && violet < green && green < 1.0, "{name}");
        let borrowed = lens.substituted_absorption();
        assert!(!borrowed.is_empty());
        for (label, lender) in borrowed {
            assert!(lender.full_name.contains('/') && lender.distance < 10.0, "{name}: {label} from {lender}");
        }
    }
}
