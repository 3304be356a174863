//! Tests `spectra glass`: data of a glass, plots, nearest glasses, fits.

use crate::common::{good, lens, repository, run, shown, text};
use serde_json::Value;
use std::time::{Duration, Instant};

fn json(arguments: &[&str]) -> Value {
    let output = good(&[&["glass"][..], arguments, &["--json"]].concat());
    serde_json::from_str(&output).expect("JSON")
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("no number: {value}"))
}

/// Returns the message of a run that must be refused as bad input.
fn refused(arguments: &[&str]) -> String {
    let output = run(&[&["glass"][..], arguments].concat());
    assert_eq!(output.status.code(), Some(2), "{arguments:?}");
    text(&output.stderr)
}

/// The values of Schott's data sheets are shown: nd, nF, nC, ng, ne, Vd, Ve.
#[test]
fn makers_values_are_shown() {
    let info = json(&["info", "N-BK7", "--wavelength-nm", "632.8"]);
    for (found, wanted, tolerance) in [
        (&info["nd"], 1.516800, 1e-6),
        (&info["vd"], 64.17, 0.005),
        (&info["ne"], 1.518722, 1e-6),
        (&info["ve"], 63.96, 0.005),
        (&info["n"]["F"], 1.522376, 1e-6),
        (&info["n"]["C"], 1.514322, 1e-6),
        (&info["n"]["g"], 1.526685, 1e-6),
        // n at 632.8 nm from the data sheet, and an internal transmittance of 10 mm of 0.997 at 400 nm and above.
        (&info["n_at"], 1.515089, 1e-5),
        (&info["internal_transmittance_10mm"]["h"], 0.997, 1e-3),
        (&info["reflectance"], 0.0421646, 1e-7),
    ] {
        assert!((number(found) - wanted).abs() <= tolerance, "{found} is not {wanted}");
    }
    assert_eq!([&info["maker"], &info["name"], &info["relative_to"]], ["SCHOTT", "SCHOTT/N-BK7", "air"]);
    assert_eq!(info["range_nm"], serde_json::json!([300.0, 2500.0]));
    assert!(info["formula"].is_string() && info["coefficients"].is_array());
    let table = good(&["glass", "info", "schott/f2"]);
    for wanted in ["SCHOTT/F2", "1.620040", "36.37", "internal transmittance", "dn/dT"] {
        assert!(table.contains(wanted), "{wanted}: {table}");
    }
    assert!(!table.contains("null") && !table.contains("NaN"));
}

#[test]
fn temperature_and_vacuum() {
    // Schott's data sheet of SF6 states 1e6 dn/dT at e from 20 to 40 C: 11.1 relative, 9.5 absolute.
    let at = |more: &[&str]| number(&json(&[&["info", "SCHOTT/SF6"], more].concat())["ne"]);
    let slope = |more: &[&str]| {
        let hot = at(&[more, &["--temperature-c", "40"]].concat());
        (hot - at(&[more, &["--temperature-c", "20"]].concat())) / 20.0 * 1e6
    };
    assert!((slope(&[]) - 11.1).abs() < 0.1 && (slope(&["--absolute"]) - 9.5).abs() < 0.1);
    // Air at 20 C: n - 1 of standard air (15 C: 277.8e-6 at 550 nm, Ciddor), thinned by 288.15 / 293.15.
    let air = json(&["info", "air", "--absolute", "--wavelength-nm", "550"]);
    assert!((number(&air["n_at"]) - 1.0 - 277.8e-6 * 288.15 / 293.15).abs() < 1e-7, "{air}");
    assert_eq!(number(&json(&["info", "air"])["nd"]), 1.0);
    assert!(refused(&["info", "N-BK7", "--temperature-c", "1e9"]).contains("degrees Celsius"));
}

#[test]
fn melts_and_glasses_of_figures_alone() {
    let melt = json(&["info", "N-BK7", "--nd", "1.51712", "--vd", "64.01"]);
    assert!((number(&melt["nd"]) - 1.51712).abs() < 1e-12 && (number(&melt["vd"]) - 64.01).abs() < 1e-9);
    assert_eq!(melt["status"], "melt");
    let model = json(&["info", "--nd", "1.5168", "--vd", "64.17"]);
    assert!((number(&model["vd"]) - 64.17).abs() < 1e-9 && model["maker"].is_null());
    // With only nd and Vd, the partial dispersion is that of a normal glass: 0.6438 - 0.001682 Vd.
    for vd in [25.4, 36.4, 60.2] {
        let model = json(&["info", "--nd", "1.62", "--vd", &vd.to_string()]);
        let n = |line: &str| number(&model["n"][line]);
        let partial = (n("g") - n("F")) / (n("F") - n("C"));
        assert!((partial - (0.6438 - 0.001_682 * vd)).abs() < 2e-4, "{vd}: {partial}");
    }
    // N-BK7 from ne and Ve.
    let e = json(&["info", "--nd", "1.518722", "--vd", "63.96", "--line", "e"]);
    assert!((number(&e["nd"]) - 1.5168).abs() < 2e-6 && (number(&e["vd"]) - 64.17).abs() < 0.03, "{e}");
    assert!(refused(&["info", "--nd", "9", "--vd", "64"]).contains("no glass has nd 9"));
    assert!(refused(&["info", "--nd", "1.5"]).contains("--vd"));
}

/// If stated figures select one of several data sets, a message says so.
#[test]
fn a_melt_of_a_substance_says_which_data_it_is_of() {
    let of = |nd: &str| text(&run(&["glass", "info", "CaF2", "--nd", nd, "--vd", "96.4"]).stderr);
    assert!(of("1.43391").contains("CRYSTRAN/CaF2 is used, the nearest to the stated nd 1.43391"), "{}", of("1.43391"));
    assert_eq!(of("1.43385"), "");
}

#[test]
fn ambiguous_and_unknown_names_are_refused_with_candidates() {
    // Of several glasses with one name the default maker's is used, and the others are named. Among measurements the program does not
    // guess.
    let output = run(&["glass", "info", "F2"]);
    assert!(output.status.success() && text(&output.stdout).starts_with("SCHOTT/F2"));
    for candidate in ["SCHOTT/F2", "HOYA/F2", "CDGM/F2"] {
        assert!(text(&output.stderr).contains(candidate), "{}", text(&output.stderr));
    }
    assert!(text(&run(&["glass", "info", "BK7"]).stdout).starts_with("SCHOTT/BK7"));
    assert!(refused(&["info", "H2O"]).contains("H2O/Daimon-20.0C"));
    let plastic = refused(&["info", "PTFE"]);
    assert!(
        plastic.contains("no data of this plastic") && plastic.contains("PMMA") && !plastic.contains("HOYA"),
        "{plastic}"
    );
    assert!(refused(&["info", "N-BK8"]).contains("SCHOTT/N-BK7"));
    assert!(refused(&["plot", "N-BK8"]).contains("SCHOTT/N-BK7"));
    assert!(refused(&["match", "--nd", "1.5", "--maker", "SHOTT"]).contains("did you mean SCHOTT"));
    assert!(refused(&["match", "--nd", "15"]).contains("between 1 and 4"));
    assert!(refused(&["match", "--nd", "1.5", "--era", "old"]).contains("historical, modern, or a year"));
}

#[test]
fn a_catalogue_of_ones_own() {
    let forms = repository("crates/glass/tests/data/forms.agf");
    let info = json(&["info", "FORMS/ZNO-O", "--catalogue", shown(&forms)]);
    assert!((number(&info["nd"]) - 2.003385).abs() < 1e-6);
    assert_eq!(info["category"], "user");
    let own = json(&["match", "--nd", "1.61266", "--vd", "44.46", "--catalogue", shown(&forms), "--limit", "2"]);
    let names: Vec<&str> =
        own["matches"].as_array().expect("a list").iter().filter_map(|m| m["name"].as_str()).collect();
    assert!(names.contains(&"forms/E-KZFH1"), "{names:?}");
    let folder = tempfile::tempdir().expect("a folder");
    let broken = folder.path().join("broken.agf");
    std::fs::write(&broken, "NM GOOD 1 0 1.5 60\nCD 2.25\nLD 0.4 0.7\nNM BAD 99 0 1.5 60\n").expect("written");
    let output = run(&["glass", "info", "GOOD", "--catalogue", shown(&broken)]);
    assert!(output.status.success() && text(&output.stderr).contains(":4: glass BAD: unknown formula"));
    std::fs::write(&broken, "no glass").expect("written");
    assert!(refused(&["info", "GOOD", "--catalogue", shown(&broken)]).contains("no glass in it"));
    assert!(refused(&["info", "GOOD", "--catalogue", "no-such.agf"]).contains("no-such.agf"));
}

/// Finds the dense barium crown of the Biotar of 1927, from the patent's nd and Vd.
#[test]
fn nearest_glasses() {
    let found = json(&["match", "--nd", "1.64329", "--vd", "48", "--era", "1927", "--limit", "4"]);
    let matches = found["matches"].as_array().expect("a list");
    assert_eq!(matches.len(), 4);
    assert_eq!(matches[0]["name"], "SCHOTT/BAF9");
    assert!(matches.windows(2).all(|m| number(&m[0]["distance"]) <= number(&m[1]["distance"])));
    assert!(matches.iter().all(|m| !m["name"].as_str().expect("a name").contains("/LA")));
    // The same glass from its values at the e line.
    let e =
        json(&["match", "--nd", "1.518722", "--vd", "63.96", "--line", "e", "--maker", "SCHOTT", "--era", "modern"]);
    assert_eq!([&e["matches"][0]["name"], &e["line"]], ["SCHOTT/N-BK7", "e"]);
    // Every medium of a lens, in the order in which light meets them.
    let of_lens = json(&["match", "--lens", &lens("helios-44-58-f2")]);
    let media = of_lens.as_array().expect("a list");
    assert_eq!(media.len(), 3);
    assert_eq!(media[0]["surfaces"], serde_json::json!([1, 3, 8]));
    let best: Vec<&str> = media.iter().filter_map(|m| m["matches"][0]["name"].as_str()).collect();
    assert_eq!(best.len(), 3);
    // The lens is made of LZOS glass: other transcriptions name LF7 and TK14.
    assert!(media.iter().all(|m| number(&m["matches"][0]["distance"]) < 1.0), "{best:?}");
    assert!(good(&["glass", "match", "--lens", "zeiss-biotar-50-f1.4"]).contains("behind surface 1, 8, 10"));
}

#[test]
fn pictures_of_both_kinds() {
    let folder = tempfile::tempdir().expect("a folder");
    let names = ["SCHOTT/N-BK7", "water"];
    for more in [&[][..], &["--abbe", "--makers", "SCHOTT,LZOS"]] {
        let [svg, png] = ["a.svg", "a.png"].map(|name| folder.path().join(name));
        for path in [&svg, &png] {
            good(&[&["glass", "plot", "-o", shown(path)][..], more, &names].concat());
        }
        let svg = std::fs::read_to_string(svg).expect("written");
        assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>") && !svg.contains("NaN"));
        for name in names {
            assert!(svg.contains(&format!("aria-label=\"{name}\"")), "{name}");
        }
        assert!(std::fs::read(png).expect("written").starts_with(b"\x89PNG\r\n\x1a\n"));
    }
    assert!(refused(&["plot", "N-BK7", "-o", "x.jpg"]).contains(".svg or .png"));
    assert!(refused(&["plot", "N-BK7", "--range-nm", "800,400"]).contains("two wavelengths"));
    assert!(refused(&["plot", "--abbe", "--makers", "SHOTT"]).contains("SCHOTT"));
    assert!(refused(&["plot", "air", "--abbe", "-o", "x.svg"]).contains("no Abbe number"));
}

/// Cauchy's A and B (in nm^2) of tables of the CRC Handbook (1990), from adjacent rows and averaged.
#[test]
fn fits_of_seven_materials() {
    let tables = repository("crates/glass/tests/data/cauchy-tables.csv");
    let reports = json(&["fit", shown(&tables)]);
    let wanted = [
        ("water-20c", 1.3238, 1e-4, 3126.8, 0.1),
        ("zinc-crown", 1.5020, 1e-4, 4964.6, 0.1),
        ("higher-dispersion-crown", 1.5037, 1e-4, 5569.1, 0.1),
        ("light-flint", 1.5536, 1e-4, 7661.0, 0.1),
        ("heavy-flint", 1.6199, 1e-4, 10655.7, 0.1),
        ("heaviest-flint", 1.8321, 1e-4, 20737.8, 0.1),
        ("fused-quartz", 1.44751, 1e-5, 3689.68, 0.01),
    ];
    for (report, (material, a, a_unit, b, b_unit)) in reports.as_array().expect("a list").iter().zip(wanted) {
        assert_eq!(report["material"], material);
        let [rows, squares] = [&report["fits"][0], &report["fits"][1]];
        assert_eq!([&rows["model"], &squares["model"]], ["cauchy", "cauchy-ls"]);
        assert!((number(&rows["coefficients"]["a"]) - a).abs() <= a_unit, "{material}");
        assert!((number(&rows["coefficients"]["b_nm2"]) - b).abs() <= b_unit, "{material}");
        // No curve of this form fits better than least squares.
        assert!(number(&squares["rms_deviation"]) <= number(&rows["rms_deviation"]), "{material}");
    }
    let table = good(&["glass", "fit", shown(&tables), "--model", "cauchy,conrady"]);
    assert!(table.contains("3689.68") && table.contains("conrady") && table.contains("deviation:  mean"));
    // Three rows do not determine a Sellmeier formula: the other fits are shown, and the exit code reports the failure.
    let output = run(&["glass", "fit", shown(&tables), "--model", "sellmeier"]);
    assert!(output.status.code() == Some(2) && text(&output.stderr).contains("water-20c"));
    assert!(text(&output.stdout).contains("fused-quartz"));
    let folder = tempfile::tempdir().expect("a folder");
    let bad = folder.path().join("bad.csv");
    std::fs::write(&bad, "wavelength_nm,n\n486,1.52\n589,x\n").expect("written");
    assert!(refused(&["fit", shown(&bad)]).contains("bad.csv:3: `x` is not a valid index"));
}

/// `info` and `plot` read the same tables as `fit`, including one material of a file with several.
#[test]
fn one_reader_of_tables() {
    let tables = repository("crates/glass/tests/data/cauchy-tables.csv");
    let named = |material: &str| format!("{}#{material}", shown(&tables));
    let info = json(&["info", &named("zinc-crown"), "--wavelength-nm", "589"]);
    assert_eq!(number(&info["n_at"]), 1.517);
    // The catalog contains the same table, with its source.
    let bundled = json(&["info", "dispersion-study/zinc-crown", "--wavelength-nm", "589"]);
    assert!(
        number(&bundled["n_at"]) == 1.517 && bundled["source"].as_str().is_some_and(|s| s.contains("CRC Handbook"))
    );
    let folder = tempfile::tempdir().expect("a folder");
    let svg = folder.path().join("n.svg");
    good(&["glass", "plot", &named("heavy-flint"), &named("zinc-crown"), "-o", shown(&svg)]);
    assert!(std::fs::read_to_string(&svg).expect("written").contains("heavy-flint"));
    assert!(refused(&["info", shown(&tables)]).contains("7 materials"));
    assert!(refused(&["plot", &named("zink-crown")]).contains("zinc-crown"));
    // Conversely, `fit` reads what `plot` reads, including a column of k.
    let own = folder.path().join("own.csv");
    std::fs::write(&own, "wavelength_um;n;k\n0.486;1.522;1e-8\n0.588;1.517;1e-8\n0.656;1.514;1e-8\n").expect("written");
    assert!(json(&["fit", shown(&own)])[0]["samples"] == 3 && number(&json(&["info", shown(&own)])["nd"]) > 1.516);
}

#[test]
fn lists_by_fragment_and_category() {
    let names = |arguments: &[&str]| -> Vec<String> {
        let list = json(&[&["list"], arguments].concat());
        list.as_array().expect("a list").iter().map(|row| row["name"].as_str().expect("a name").to_owned()).collect()
    };
    let bk7 = names(&["bk7"]);
    assert!(["SCHOTT/BK7", "SCHOTT/N-BK7"].iter().all(|name| bk7.iter().any(|n| n == name)), "{bk7:?}");
    let plastics = names(&["--category", "plastic"]);
    assert!(plastics.len() > 20 && plastics.iter().any(|n| n == "polystyrene/Sultanova"), "{plastics:?}");
    assert!(names(&["sf", "--maker", "LZOS"]).iter().all(|n| n.starts_with("LZOS/")));
    assert!(good(&["glass", "list", "--category", "plastic"]).contains("polycarbonate/Sultanova"));
    assert!(refused(&["list", "--category", "stone"]).contains("plastic"));
    let none = run(&["glass", "list", "no such glass"]);
    assert!(none.status.success() && text(&none.stderr).contains("glass match"));
}

/// At least 99 % of the makers' listed values follow from their coefficients; the rest are named.
#[test]
fn the_catalogue_is_checked() {
    let check = json(&["check"]);
    let (listed, deviating) = (number(&check["listed"]), check["deviating"].as_array().expect("a list"));
    assert!(listed > 1800.0 && (deviating.len() as f64) < 0.01 * listed, "{listed} {}", deviating.len());
    assert!(good(&["glass", "check"]).contains("SCHOTT/BOROFLOAT33"));
}

/// A catalog of more than 3000 glasses adds less than 5 ms to the start. The test compares the fastest of several cold starts, taken
/// in turns, with more starts on a busy machine.
#[test]
fn a_look_up_starts_fast() {
    let time = |arguments: &[&str]| {
        let start = Instant::now();
        good(arguments);
        start.elapsed()
    };
    // An unoptimized build is slower by a factor of ten.
    let limit = Duration::from_millis(if cfg!(debug_assertions) { 100 } else { 5 });
    let (mut idle, mut look_up) = (Duration::MAX, Duration::MAX);
    for round in 0..100 {
        idle = idle.min(time(&["--version"]));
        look_up = look_up.min(time(&["glass", "info", "N-BK7"]));
        if round >= 10 && look_up.saturating_sub(idle) < limit {
            break;
        }
    }
    println!("--version {idle:?}, glass info {look_up:?}");
    assert!(look_up.saturating_sub(idle) < limit, "{idle:?} {look_up:?}");
}

/// Fits a table that follows Cauchy's formula, writes the glass file, the rows and the figure, and reads the glass back by its name.
#[test]
fn a_fit_is_written_shown_and_read_back() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name);
    let (a, b) = (1.5046, 4200.0);
    let lines = [404.66, 435.83, 486.13, 546.07, 587.56, 656.27];
    let rows: Vec<String> = lines.iter().map(|nm| format!("crown,{nm},{}", a + b / (nm * nm))).collect();
    let other = ["flint,435.8,1.66", "flint,546.1,1.63", "flint,656.3,1.61"].join("\n");
    std::fs::write(at("melts.csv"), format!("material,wavelength_nm,n\n{}\n{other}\n", rows.join("\n")))
        .expect("written");
    let one = format!("{}#crown", shown(&at("melts.csv")));
    let (yaml, figure) = (at("crown.yaml"), at("crown.svg"));
    let said = good(&["glass", "fit", &one, "--rows", "-o", shown(&yaml), "--plot", shown(&figure)]);
    assert!(said.contains("B / nm^2") && said.contains("4200.000") && said.contains("mean"), "{said}");
    assert_eq!(said.lines().filter(|line| line.trim_start().starts_with("404.66")).count(), 1);
    let text = std::fs::read_to_string(&yaml).expect("written");
    assert!(
        text.contains("unit: nm") && text.contains("formula: cauchy") && text.contains("range: [404.66 nm, 656.27 nm]"),
        "{text}"
    );
    let figure = std::fs::read_to_string(&figure).expect("written");
    assert!(figure.contains("crown: fitted dispersion") && figure.contains("formula minus row"));
    let info = json(&["info", shown(&yaml), "--wavelength-nm", "589.3"]);
    assert!((number(&info["n_at"]) - (a + b / (589.3 * 589.3))).abs() < 1e-9, "{info}");
    // Every other model can be read back too: at a row, the glass has the index of the formula, which is the row's index plus its
    // deviation.
    for model in ["cauchy-ls", "sellmeier", "conrady", "schott", "herzberger"] {
        let fits = json(&["fit", &one, "--model", model, "-o", shown(&yaml)]);
        let wanted = a + b / (546.07 * 546.07) + number(&fits[0]["fits"][0]["deviations"][3]);
        let info = json(&["info", shown(&yaml), "--wavelength-nm", "546.07"]);
        assert!((number(&info["n_at"]) - wanted).abs() < 1e-9, "{model}: {info}");
    }
    let fits = json(&["fit", &one, "--model", "sellmeier", "--terms", "2", "-o", shown(&yaml)]);
    let wanted = a + b / (546.07 * 546.07) + number(&fits[0]["fits"][0]["deviations"][3]);
    let info = json(&["info", shown(&yaml), "--wavelength-nm", "546.07"]);
    assert!((number(&info["n_at"]) - wanted).abs() < 1e-9, "{info}");
    // Several materials, an unknown material and a wrong file extension each have their own message.
    let all = shown(&at("melts.csv")).to_owned();
    for (options, words) in [
        (&["fit", &all, "-o", "x.yaml"][..], "#crown"),
        (&["fit", &format!("{all}#lead")], "crown, flint"),
        (&["fit", &one, "-o", "x.csv"], "x.csv"),
        (&["fit", &one, "--plot", "x.pdf"], "x.pdf"),
    ] {
        assert!(refused(options).contains(words), "{options:?}");
    }
}

/// B may be stated in nm^2, as in dispersion tables, instead of um^2. Other formulas reject the unit.
#[test]
fn coefficients_may_be_in_nanometers() {
    let folder = tempfile::tempdir().expect("a folder");
    let index = |text: &str| {
        let path = folder.path().join("glass.yaml");
        std::fs::write(&path, text).expect("written");
        number(&json(&["info", shown(&path), "--wavelength-nm", "550"])["n_at"])
    };
    let um = index("formula: cauchy\ncoefficients: [1.5046, 0.0042]\n");
    let nm = index("formula: cauchy\ncoefficients: [1.5046, 4200]\nunit: nm\n");
    assert!((um - nm).abs() < 1e-12, "{um} {nm}");
    let path = folder.path().join("glass.yaml");
    std::fs::write(&path, "formula: herzberger\ncoefficients: [1.5, 0.004]\nunit: nm\n").expect("written");
    assert!(refused(&["info", shown(&path)]).contains("in micrometers only"));
    std::fs::write(&path, "nd: 1.5168\nvd: 64.17\nunit: nm\n").expect("written");
    assert!(refused(&["info", shown(&path)]).contains("the unit of which formula?"));
}

/// Computes Abbe numbers of any three lines, given by name or wavelength: V = (n_middle - 1) / (n_blue - n_red).
#[test]
fn abbe_numbers_of_any_three_lines() {
    let at = |nm: &str| number(&json(&["info", "N-BK7", "--wavelength-nm", nm])["n_at"]);
    let wanted = (at("580") - 1.0) / (at("450") - at("680"));
    let info = json(&["info", "N-BK7", "--lines", "450,580,680"]);
    assert!((number(&info["v_lines"]) - wanted).abs() < 1e-9, "{info}");
    assert_eq!(info["lines_nm"], serde_json::json!([450.0, 580.0, 680.0]));
    // The usual lines give the usual Abbe number.
    let info = json(&["info", "N-BK7", "--lines", "F',e,C'"]);
    assert!((number(&info["v_lines"]) - number(&info["ve"])).abs() < 1e-12, "{info}");
    assert!(good(&["glass", "info", "N-BK7", "--lines", "450,580,680"]).contains("V 450 580 680 nm"));
    for wrong in ["680,580,450", "450,580", "F,x,C"] {
        assert!(refused(&["info", "N-BK7", "--lines", wrong]).contains("from blue to red"), "{wrong}");
    }
    // Plastics by category.
    let plastics = json(&["list", "--category", "plastic"]);
    let plastics = plastics.as_array().expect("a list");
    assert!(plastics.len() > 10 && plastics.iter().all(|glass| glass["category"] == "plastic"));
}

/// Indices and Abbe numbers at e are accepted in glass files and lens files.
#[test]
fn figures_at_e_are_taken_as_stated() {
    let folder = tempfile::tempdir().expect("a folder");
    let (glass, lens) = (folder.path().join("glass.yaml"), folder.path().join("lens.yaml"));
    std::fs::write(&glass, "ne: 1.6242\nve: 53.1\n").expect("written");
    let info = json(&["info", shown(&glass)]);
    assert!((number(&info["ne"]) - 1.6242).abs() < 1e-6 && (number(&info["ve"]) - 53.1).abs() < 0.01, "{info}");
    let text = "name: Singlet\nreference-line: e\nsurfaces:\n  - {kind: sphere, radius: 50, thickness: 5, glass: {ne: 1.6242, ve: 53.1}}\n  \
                - {kind: sphere, radius: -50, thickness: 40}\n";
    std::fs::write(&lens, text).expect("written");
    let info: serde_json::Value = serde_json::from_str(&good(&["lens", "info", shown(&lens), "--json"])).expect("JSON");
    assert!(info.to_string().contains("1.6242"), "{info}");
}

/// Nearest glasses and the Abbe diagram accept any three lines.
#[test]
fn glasses_by_any_three_lines() {
    let info = json(&["info", "SCHOTT/F2", "--lines", "450,580,680", "--wavelength-nm", "580"]);
    let (n, v) = (number(&info["n_at"]).to_string(), number(&info["v_lines"]).to_string());
    let found = json(&["match", "--nd", &n, "--vd", &v, "--line", "450,580,680", "--maker", "SCHOTT", "--limit", "1"]);
    assert_eq!((&found["matches"][0]["name"], &found["line"]), (&"SCHOTT/F2".into(), &"580 nm".into()), "{found}");
    assert_eq!(found["lines_nm"], serde_json::json!([450.0, 580.0, 680.0]));
    assert!(number(&found["matches"][0]["distance"]) < 1e-6, "{found}");
    // Read as nd and Vd, the same figures belong to another glass.
    let other = json(&["match", "--nd", &n, "--vd", &v, "--maker", "SCHOTT", "--limit", "1"]);
    assert!(number(&other["matches"][0]["distance"]) > 1.0, "{other}");
    let table = good(&["glass", "match", "--nd", &n, "--vd", &v, "--line", "450,580,680", "--limit", "2"]);
    assert!(table.contains("V(450 nm, 580 nm, 680 nm)"), "{table}");
    let unknown = json(&["info", "--nd", &n, "--vd", &v, "--line", "450,580,680", "--wavelength-nm", "580"]);
    assert!((number(&unknown["n_at"]) - number(&info["n_at"])).abs() < 1e-12, "{unknown}");
    let folder = tempfile::tempdir().expect("a folder");
    let figure = folder.path().join("abbe.svg");
    good(&["glass", "plot", "SCHOTT/F2", "--abbe", "--lines", "F',e,C'", "--makers", "SCHOTT", "-o", shown(&figure)]);
    let svg = std::fs::read_to_string(&figure).expect("written");
    assert!(svg.contains("V_{e}") || svg.contains("Abbe number"), "an axis has no name");
    for wrong in ["C,d,F", "q", "F,d"] {
        assert!(
            refused(&["match", "--nd", "1.6", "--vd", "40", "--line", wrong]).contains("from blue to red"),
            "{wrong}"
        );
    }
}
