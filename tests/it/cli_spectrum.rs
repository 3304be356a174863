//! Tests `spectra spectrum`: color in figures and plots.

use crate::common::{good, run, shown, text};
use serde_json::Value;

fn info(arguments: &[&str]) -> Value {
    let output = good(&[&["spectrum", "info", "--json"][..], arguments].concat());
    serde_json::from_str(&output).expect("JSON")
}

fn numbers(value: &Value) -> Vec<f64> {
    let array = value.as_array().expect("an array");
    array.iter().map(|v| v.as_f64().expect("a number")).collect()
}

fn close(found: &Value, wanted: &[f64], tolerance: f64) {
    let found = if found.is_array() { numbers(found) } else { vec![found.as_f64().expect("a number")] };
    let near = |(a, b): (&f64, &f64)| (a - b).abs() <= tolerance;
    assert!(found.len() == wanted.len() && found.iter().zip(wanted).all(near), "{found:?} is not {wanted:?}");
}

/// Returns the message of a run that must be refused as bad input.
fn refused(arguments: &[&str]) -> String {
    let output = run(&[&["spectrum"][..], arguments].concat());
    assert_eq!(output.status.code(), Some(2), "{arguments:?}");
    text(&output.stderr)
}

/// CIE 15:2004 states x 0.31272, y 0.32903 and XYZ 95.04 100 108.88. The color temperature, 6503.6 K, is 6500 K times 1.438777 /
/// 1.438, the constant of Planck's law when D65 was defined.
#[test]
fn d65() {
    let d65 = info(&["D65"]);
    close(&d65["xy"], &[0.31272, 0.32903], 2e-5);
    close(&d65["xyz"], &[95.04, 100.0, 108.88], 0.01);
    close(&d65["lab"], &[100.0, 0.0, 0.0], 1e-9);
    close(&d65["cct_k"], &[6503.5], 1.5);
    assert!(d65["dominant_wavelength_nm"].is_null() && d65["purity"].is_null());
    // The white of sRGB is D65 to four decimals of x and y.
    close(&d65["srgb_linear"], &[1.0, 1.0, 1.0], 2e-3);
    close(&d65["srgb"], &[255.0, 255.0, 255.0], 0.0);
    close(&d65["range_nm"], &[300.0, 780.0], 0.0);
    assert_eq!([&d65["name"], &d65["kind"]], ["D65", "emission"]);
    assert!(d65["source"].is_string() && d65["license"].is_string() && d65["luminance"].as_f64() > Some(0.0));
    // CIE 15:2004 for 10 degrees: x 0.31382, y 0.33100.
    close(&info(&["d65", "--observer", "1964"])["xy"], &[0.31382, 0.33100], 3e-5);
    for observer in ["2015-2", "2015-10"] {
        let seen = info(&["D65", "--observer", observer]);
        assert!(seen["observer"] != d65["observer"] && seen["xy"] != d65["xy"]);
        assert_eq!(seen["cct_k"], d65["cct_k"]);
    }
}

/// CIE 15:2004 states x 0.44758, y 0.40745 for illuminant A. Its formula, summed in steps of 1 nm, has XYZ 109.850 100 35.585. Linear
/// interpolation of the 5 nm table, which the CIE prescribes, raises Z by 0.006.
#[test]
fn illuminant_a() {
    let a = info(&["A"]);
    close(&a["xy"], &[0.44758, 0.40745], 2e-5);
    close(&a["xyz"], &[109.850, 100.0, 35.585], 0.01);
    close(&a["cct_k"], &[2855.5], 1.5);
    let body = info(&["blackbody:2856"]);
    close(&body["xy"], &numbers(&a["xy"]), 1e-4);
    close(&body["cct_k"], &[2856.0], 0.5);
    assert!(body["source"].is_null() && body["range_nm"].is_null() && body["title"].is_null());
}

/// The dominant wavelength of a line is its own wavelength.
#[test]
fn a_line() {
    let line = info(&["line:C'"]);
    close(&line["dominant_wavelength_nm"], &[643.85], 0.05);
    close(&line["purity"], &[1.0], 2e-3);
    assert!(line["cct_k"].is_null() && line["complementary_wavelength_nm"].is_null());
    let green = info(&["line:555"]);
    // 1 at 555 nm, where V is 1, has 683 lm/W.
    close(&green["luminance"], &[683.0], 0.01);
    close(&green["peak_nm"], &[555.0], 0.0);
    let dark = info(&["line:t"]);
    for key in ["xyz", "xy", "lab", "cct_k", "dominant_wavelength_nm", "purity", "srgb", "srgb_linear"] {
        assert!(dark.get(key).is_some_and(Value::is_null), "{key}");
    }
    close(&dark["luminance"], &[0.0], 0.0);
}

#[test]
fn matter_is_seen_in_a_light() {
    let grey = info(&["colorchecker#neutral-5"]);
    let xyz = numbers(&grey["xyz"]);
    assert_eq!(grey["kind"], "reflectance");
    assert!((15.0..25.0).contains(&xyz[1]) && grey["luminance"].is_null() && grey["cct_k"].is_null());
    let lab = numbers(&grey["lab"]);
    assert!(lab[1].abs() < 2.0 && lab[2].abs() < 2.0, "{lab:?}");
    let srgb = numbers(&grey["srgb"]);
    assert!(srgb.iter().all(|v| (v - srgb[1]).abs() <= 6.0), "{srgb:?}");
    // A gray stays gray in another light, and takes on its color.
    let in_a = info(&["colorchecker#neutral-5", "--illuminant", "A"]);
    close(&in_a["xy"], &[0.448, 0.407], 0.005);
    let srgb = numbers(&in_a["srgb"]);
    assert!(srgb.iter().all(|v| (v - srgb[1]).abs() <= 6.0), "{srgb:?}");
    let magenta = info(&["colorchecker#magenta"]);
    assert!(magenta["dominant_wavelength_nm"].is_null());
    assert!((490.0..570.0).contains(&magenta["complementary_wavelength_nm"].as_f64().expect("a purple")));
    // A detector has no color.
    let eye = info(&["v-lambda-1924"]);
    assert!(eye["xyz"].is_null() && eye["luminance"].is_null());
    close(&eye["peak_nm"], &[555.0], 0.0);
}

#[test]
fn files_of_ones_own() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("half.csv");
    let filter = "# spectra: 1\n# kind: transmittance\n# name: half\nwavelength_nm,T\n350,0.5\n830,0.5\n";
    std::fs::write(&path, filter).expect("written");
    let half = info(&[shown(&path), "--illuminant", "A"]);
    assert_eq!([&half["kind"], &half["title"]], ["transmittance", "half"]);
    close(&half["xyz"], &[109.85 / 2.0, 50.0, 35.58 / 2.0], 0.01);
    close(&half["cct_k"], &[2855.5], 1.5);
    std::fs::write(&path, filter.replace("830,0.5", "830,50")).expect("written");
    let message = refused(&["info", shown(&path)]);
    assert!(message.contains("half.csv") && message.contains('6'), "{message}");
}

#[test]
fn people_read_a_table() {
    let shown = good(&["spectrum", "info", "FL11"]);
    for wanted in ["emission", "source", "color temperature", " K", "dominant wavelength", "sRGB", "XYZ"] {
        assert!(shown.contains(wanted), "{wanted}: {shown}");
    }
    assert!(!shown.contains("null") && !shown.contains("NaN"));
    let list = good(&["spectrum", "list"]);
    assert!(list.contains("D65") && list.contains("mercury") && list.contains("#dark-skin"));
    let list: Value = serde_json::from_str(&good(&["spectrum", "list", "--json"])).expect("JSON");
    for item in list.as_array().expect("a list") {
        assert!(item["name"].is_string() && item["license"].is_string() && item["source"].is_string(), "{item}");
    }
}

#[test]
fn unknown_names_are_refused_with_near_ones() {
    assert!(refused(&["info", "D66"]).contains("D65"));
    assert!(refused(&["info", "mercurry"]).contains("mercury"));
    assert!(refused(&["info", "qqqqqqqqqq"]).contains("spectra list spectrum"));
    assert!(refused(&["info", "gaussian:550"]).contains("gaussian:550,20"));
    assert!(refused(&["info", "colorchecker"]).contains("colorchecker#"));
    assert!(refused(&["info", "D65", "--illuminant", "D66"]).contains("--illuminant"));
    assert!(refused(&["info", "D65", "--illuminant", "line:t"]).contains("--illuminant"));
    assert!(refused(&["info", "D65", "--observer", "1932"]).contains("1931"));
    assert!(refused(&["plot", "D66", "-o", "x.svg"]).contains("D65"));
    assert!(refused(&["plot", "D65", "-o", "x.jpg"]).contains(".svg or .png"));
    assert!(refused(&["plot", "line:t", "--chromaticity", "-o", "x.svg"]).contains("chromaticity"));
    assert!(refused(&["plot", "v-lambda-1924", "--chromaticity", "-o", "x.svg"]).contains("sensitivity"));
}

#[test]
fn pictures_of_both_kinds() {
    let folder = tempfile::tempdir().expect("a folder");
    let names = ["D65", "line:C'", "colorchecker#red"];
    for more in [&[][..], &["--chromaticity"]] {
        let [svg, png] = ["a.svg", "a.png"].map(|name| folder.path().join(name));
        for path in [&svg, &png] {
            good(&[&["spectrum", "plot", "-o", shown(path)][..], more, &names].concat());
        }
        let svg = std::fs::read_to_string(svg).expect("written");
        assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"));
        for name in names {
            let wanted = format!("aria-label=\"{name}\"");
            assert!(svg.contains(&wanted), "{wanted}");
        }
        assert!(!svg.contains("NaN") && !svg.contains("inf "));
        let size = |name: &str| {
            let start = svg.find(&format!("{name}=\"")).expect("a size") + name.len() + 2;
            svg[start..].split('"').next().and_then(|n| n.parse::<f64>().ok()).expect("a number")
        };
        // The PNG signature, then the size in the first chunk: two pixels per unit.
        let png = std::fs::read(png).expect("written");
        assert_eq!(&png[..8], b"\x89PNG\r\n\x1a\n");
        let word = |at: usize| u32::from_be_bytes(png[at..at + 4].try_into().expect("four bytes"));
        assert_eq!([word(16), word(20)].map(f64::from), ["width", "height"].map(|n| (2.0 * size(n)).round_ties_even()));
        assert!(png.len() > 20_000 && png.ends_with(b"IEND\xaeB`\x82"));
    }
    assert_eq!(std::fs::read_dir(folder.path()).expect("a folder").count(), 2);
    let missing = folder.path().join("no/a.svg");
    let output = run(&["spectrum", "plot", "D65", "-o", shown(&missing)]);
    assert_eq!(output.status.code(), Some(1));
}

/// A fit is written and read back, and represents the spectrum as closely as reported.
#[test]
fn fitted_terms_are_a_spectrum_like_any_other() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("ortho.yaml");
    let arguments = ["spectrum", "fit", "ilford-ortho-plus", "--terms", "4", "--band", "380,780", "--json", "-o"];
    let fit: Value = serde_json::from_str(&good(&[&arguments[..], &[shown(&path)]].concat())).expect("JSON");
    assert_eq!(fit["terms"].as_array().expect("a list").len(), 4);
    // Four terms reach a relative L2 of 0.0227, according to 60 random starts of another program.
    let l2 = fit["relative_l2"].as_f64().expect("a number");
    assert!(l2 > 0.0 && l2 <= 1.1 * 0.0227, "{l2}");
    assert!(fit["kappa"].as_f64() >= Some(1.0) && fit["integral"].as_f64().map(f64::abs) < Some(0.02));
    assert!(fit["maximum"].is_f64() && fit["smallest"].is_f64());
    let again = info(&[shown(&path)]);
    assert_eq!(again["kind"], "sensitivity");
    assert_eq!(again["title"], "ilford-ortho-plus, 4 Gaussian terms");
    close(&again["peak_nm"], &[info(&["ilford-ortho-plus"])["peak_nm"].as_f64().expect("a number")], 12.0);
    // The terms in the file equal those in the JSON up to the last digit, which reading may change.
    let text = std::fs::read_to_string(&path).expect("written");
    let of_file: Vec<f64> = text
        .split("center: ")
        .skip(1)
        .map(|rest| rest.split(',').next().and_then(|n| n.parse().ok()).expect("a number"))
        .collect();
    let terms = fit["terms"].as_array().expect("a list");
    let of_json: Vec<f64> = terms.iter().map(|t| t["center_nm"].as_f64().expect("a number")).collect();
    assert!(of_file.len() == 4 && of_file.iter().zip(&of_json).all(|(a, b)| (a / b - 1.0).abs() < 1e-14), "{text}");
    // Spectral lines stay lines.
    let path = folder.path().join("lamp.yaml");
    good(&["spectrum", "fit", "0.01 * D65 + line:e", "--terms", "2", "-o", shown(&path)]);
    let text = std::fs::read_to_string(&path).expect("written");
    assert!(text.contains("kind: sum") && text.contains("{wavelength: 546.07, power: 1}"), "{text}");
    assert_eq!(info(&[shown(&path)])["kind"], "emission");
    for (arguments, word) in [
        (&["fit", "mercury"][..], "only spectral lines"),
        (&["fit", "D65", "--terms", "0"], "0"),
        (&["fit", "D65", "--terms", "33"], "33"),
        (&["fit", "D65", "-o", "x.csv"], ".yaml"),
        (&["fit", "D65", "--band", "780,380"], "--band"),
        (&["fit", "D65", "--band", "380"], "--band"),
        (&["fit", "D65", "--step", "1e-9"], "at most"),
        (&["fit", "D65", "--band", "380,390", "--terms", "8"], "a third of the points"),
    ] {
        assert!(refused(arguments).contains(word), "{arguments:?}: {}", refused(arguments));
    }
}

/// A bad file causes an error that names file, line and column.
#[test]
fn bad_files_are_refused_with_their_place() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("bad.csv");
    let head = |kind: &str| format!("# spectra: 1\n# kind: {kind}\nwavelength_nm,p\n");
    for (text, place, word) in [
        (format!("{}400,1\n390,1\n", head("emission")), "bad.csv:5:1", "wavelengths must increase"),
        (format!("{}400,1\n410,-1\n", head("emission")), "bad.csv:5:5", "cannot be negative"),
        (format!("{}400,NaN\n", head("emission")), "bad.csv:4:5", "not a finite number"),
        (format!("{}400,87\n", head("sensitivity")), "bad.csv:4:5", "percent"),
        (format!("{}400;87\n", head("sensitivity")), "bad.csv:4:1", "fields"),
        (String::new(), "bad.csv:1:1", "holds no data"),
        (head("emission"), "bad.csv:1:1", "holds no data"),
    ] {
        std::fs::write(&path, &text).expect("written");
        let message = refused(&["info", shown(&path)]);
        assert!(message.contains("bad.csv") && message.contains(place) && message.contains(word), "{text}: {message}");
    }
    let path = folder.path().join("bad.yaml");
    for (text, place, word) in [
        ("kind: table\nwavelengths: [400, 390]\nvalues: [1, 1]\n", "bad.yaml:2:20", "must increase"),
        ("kind: histogram\nedges: [400, 410]\ncounts: [-3]\n", "bad.yaml:3:10", "negative"),
        ("kind: gaussian\ncenter: 550\n", "bad.yaml:1:1", "sigma"),
    ] {
        std::fs::write(&path, text).expect("written");
        let message = refused(&["info", shown(&path)]);
        assert!(message.contains(place) && message.contains(word), "{text}: {message}");
    }
    std::fs::write(&path, "").expect("written");
    assert!(refused(&["info", shown(&path)]).contains("bad.yaml"));
}

/// Spectral colors are correct in linear and encoded values, which are labeled: the table of the dispersion study.
#[test]
fn spectral_colors_linear_and_encoded() {
    for (nm, linear, encoded) in [
        (436, [33.0, 0.0, 255.0], [101.0, 0.0, 255.0]),
        (547, [0.0, 255.0, 0.0], [0.0, 255.0, 0.0]),
        (577, [255.0, 148.0, 0.0], [255.0, 200.0, 0.0]),
        (579, [255.0, 126.0, 0.0], [255.0, 187.0, 0.0]),
        (620, [255.0, 0.0, 0.0], [255.0, 0.0, 0.0]),
    ] {
        let line = info(&[&format!("line:{nm}")]);
        let of_255: Vec<f64> = numbers(&line["srgb_linear"]).iter().map(|v| 255.0 * v).collect();
        assert!(of_255.iter().zip(linear).all(|(a, b)| (a - b).abs() <= 1.0), "{nm}: {of_255:?}");
        close(&line["srgb"], &encoded, 1.0);
    }
    let text = good(&["spectrum", "info", "line:C'"]);
    assert!(text.contains("sRGB") && text.contains("linear 1.0000"), "{text}");
}

/// The models that may be the default reproduce every color; the others do not, and the report says how large the error is.
#[test]
fn colors_through_each_model() {
    let report: Value = serde_json::from_str(&good(&[
        "spectrum",
        "models",
        "--json",
        "--step",
        "51",
        "--model",
        "all",
        "--model",
        "fraunhofer{secondary: [F, D]}",
    ]))
    .expect("JSON");
    let models = report["models"].as_array().expect("a list");
    let number = |name: &str, key: &str| {
        let model = models.iter().find(|m| m["model"] == name).unwrap_or_else(|| panic!("no {name}"));
        model[key].as_f64().expect("a number")
    };
    assert_eq!((models.len(), &models[0]["default"]), (5, &Value::Bool(true)));
    for (name, most, green) in [("primaries", 0.5, 0.5), ("smooth", 0.5, 0.5)] {
        assert!(number(name, "largest") <= most && number(name, "phantom_green") <= green, "{name}");
    }
    assert!(number("gaussians", "largest") > 20.0 && number("fraunhofer", "largest") > 20.0);
    // A yellow line next to the red one adds green that the color does not contain.
    assert!(number("fraunhofer{secondary: [F, D]}", "phantom_green") > 30.0);

    let color: Value = serde_json::from_str(&good(&["spectrum", "color", "255", "128", "64", "--json"])).expect("JSON");
    let hex: Value = serde_json::from_str(&good(&["spectrum", "color", "#ff8040", "--json"])).expect("JSON");
    assert_eq!(color, hex);
    for model in color["models"].as_array().expect("a list") {
        if ["smooth", "primaries"].contains(&model["model"].as_str().expect("a name")) {
            close(&model["back"], &[255.0, 128.0, 64.0], 0.5);
            close(&model["srgb"], &[255.0, 128.0, 64.0], 0.0);
        }
    }
    assert!(good(&["spectrum", "color", "ff8040"]).contains("comes back as"));
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("colors.png");
    good(&["spectrum", "models", "--step", "255", "-o", shown(&path)]);
    assert!(std::fs::read(&path).expect("written").starts_with(b"\x89PNG"));
    for (arguments, word) in [
        (&["color", "256", "0", "0"][..], "not a color"),
        (&["color", "#ff80"], "not a color"),
        (&["color", "1", "2"], "not a color"),
        (&["models", "--model", "smoth"], "did you mean `smooth`"),
        (&["models", "--model", "fraunhofer{secondary: [Q]}"], "or a positive wavelength such as 550 nm"),
        (&["models", "--model", "fraunhofer{"], "--model"),
        (&["models", "-o", "x.jpg"], ".svg or .png"),
        (&["models", "--illuminant", "nowhere"], "--illuminant"),
    ] {
        assert!(refused(arguments).contains(word), "{arguments:?}: {}", refused(arguments));
    }
}

/// Figures other than color: closed forms of a Gaussian, the CIE and TM-30 indices of FL2, and values at wavelengths.
#[test]
fn figures_of_a_lamp() {
    let bell = info(&["gaussian:550,20", "--wavelength-nm", "550,e,570"]);
    close(&bell["centroid_nm"], &[550.0], 1e-6);
    close(&bell["width_nm"], &[47.0964], 1e-3);
    close(&bell["power"], &[20.0 * (2.0 * std::f64::consts::PI).sqrt()], 1e-6);
    let values: Vec<f64> =
        bell["values"].as_array().expect("a list").iter().map(|v| v["value"].as_f64().expect("a number")).collect();
    let wanted = [1.0, (-0.5_f64 * (3.93_f64 / 20.0).powi(2)).exp(), (-0.5_f64).exp()];
    assert!(values.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-12), "{values:?}");
    // 1 W at 555 nm, where V is 1.
    close(&info(&["line:555"])["luminous_efficacy_lm_per_w"], &[683.0], 1e-6);
    let lamp = info(&["FL2"]);
    close(&lamp["cie_ra"], &[64.2], 0.1);
    close(&lamp["tm30_rf"], &[70.1], 0.1);
    close(&info(&["D65"])["uv_1976"], &[0.1978, 0.4683], 1e-4);
    assert!(info(&["line:555"])["cie_ra"].is_null() && info(&["wratten-12"])["power"].is_null());
    assert!(refused(&["info", "D65", "--wavelength-nm", "Q"]).contains("--wavelength-nm"));
    let shown = good(&["spectrum", "info", "FL2", "--wavelength-nm", "550"]);
    for wanted in ["centroid", "luminous efficacy", "CIE Ra", "TM-30 Rf", "at 550 nm", "u'v'"] {
        assert!(shown.contains(wanted), "{wanted}: {shown}");
    }
}

/// The product of light, surface, filter and film has as many terms as there are combinations, and is exact in all output formats.
#[test]
fn a_product_of_terms() {
    let folder = tempfile::tempdir().expect("a folder");
    let [svg, csv] = ["terms.svg", "terms.csv"].map(|name| folder.path().join(name));
    let chain = ["spectrum", "product", "D65", "colorchecker#red", "wratten-12", "ilford-ortho-plus", "--terms"];
    let out = good(&[&chain[..], &["4", "--json", "-o", shown(&svg), "-o", shown(&csv)]].concat());
    let product: Value = serde_json::from_str(&out).expect("JSON");
    assert_eq!(product["terms"], 256);
    assert!(product["difference"].as_f64().expect("a number") < 1e-12);
    assert!(product["kappa"].as_f64().expect("a number") >= 1.0);
    let table = std::fs::read_to_string(csv).expect("written");
    assert_eq!(table.lines().count(), 7);
    let svg = std::fs::read_to_string(svg).expect("written");
    assert!(svg.contains("256 terms") && !svg.contains("NaN"));
    let told = good(&[&chain[..], &["3"]].concat());
    for wanted in ["terms of the product    81", "kappa", "by quadrature", "one term"] {
        assert!(told.contains(wanted), "{wanted}: {told}");
    }
    assert!(refused(&["product", "D65", "A"]).contains("both of kind emission"));
    assert!(refused(&["product", "mercury", "wratten-12"]).contains("spectral lines"));
    assert!(refused(&["product", "D65", "-o", "x.jpg"]).contains(".csv"));
}

/// The osculating Gaussian of a spectrum: for a Gaussian it is the Gaussian itself, and it does not exist where the logarithm is
/// convex.
#[test]
fn a_local_gaussian_or_none() {
    let at = |name: &str, nm: &str| -> Value {
        serde_json::from_str(&good(&["spectrum", "fit", name, "--at", nm, "--json", "--step", "0.1"])).expect("JSON")
    };
    let bell = at("gaussian:540,30", "560");
    close(&bell["center_nm"], &[540.0], 1e-3);
    close(&bell["sigma_nm"], &[30.0], 1e-3);
    close(&bell["amplitude"], &[1.0], 1e-5);
    let none = at("function:exp((w-600)^2/5000)", "550");
    assert!(
        none["center_nm"].is_null() && none["none_because"].as_str().expect("a reason").contains("does not bend down")
    );
    // A table has curvature only between its points, which for D65 are 5 nm apart.
    let day: Value = serde_json::from_str(&good(&["spectrum", "fit", "D65", "--at", "550", "--json"])).expect("JSON");
    close(&day["step_nm"], &[5.0], 0.0);
    assert!(refused(&["fit", "mercury", "--at", "550"]).contains("only spectral lines"));
    assert!(refused(&["fit", "D65", "--at", "-5"]).contains("--at"));
}

/// Draws diagrams of both years and fields, the user's own points, matching functions with their negative lobes, and sixteen distinct
/// curves.
#[test]
fn figures_of_spectra() {
    let folder = tempfile::tempdir().expect("a folder");
    let draw = |name: &str, arguments: &[&str]| {
        let path = folder.path().join(name);
        good(&[&["spectrum", "plot", "-o", shown(&path)][..], arguments].concat());
        std::fs::read_to_string(path).expect("written")
    };
    for (diagram, observer) in [("1931", "1931"), ("1931", "1964"), ("1976", "1931"), ("1976", "1964")] {
        let more = ["--chromaticity", "--diagram", diagram, "--observer", observer, "D65", "xy:0.3,0.4", "uv:0.2,0.5"];
        let svg = draw("diagram.svg", &more);
        assert!(svg.contains("aria-label=\"xy:0.3,0.4\"") && !svg.contains("NaN"), "{diagram} {observer}");
    }
    let cones = draw("cones.svg", &["cone-fundamentals-2deg"]);
    assert!(cones.contains("cone-fundamentals-2deg#s"));
    let matching = draw("matching.svg", &["srgb-1931-2deg"]);
    assert!(matching.contains("srgb-1931-2deg#g") && !matching.contains("NaN"));
    // Blue-green lights need added red: the negative lobe reaches -0.93 at 520 nm.
    close(&info(&["srgb-1931-2deg#r"])["lowest"], &[-0.9255], 1e-3);
    let many: Vec<String> = (0..16).map(|i| format!("gaussian:{},15", 400 + 25 * i)).collect();
    let names: Vec<&str> = many.iter().map(String::as_str).collect();
    let svg = draw("many.svg", &names);
    assert!(svg.matches("stroke-dasharray").count() >= 2 * 9, "the second seven curves are not dashed");
    assert_ne!(draw("deutan.svg", &[&names[..], &["--seen-by", "deutan"]].concat()), svg);
    let much = vec!["A"; 29];
    assert!(refused(&[&["plot"][..], &much].concat()).contains("at most 28"));
    assert!(refused(&["plot", "xy:0.9,0.9", "--chromaticity", "-o", "x.svg"]).contains("is not a chromaticity"));
}

/// A file with many columns takes one line, unless all columns are requested.
#[test]
fn the_list_folds_files_of_many_columns() {
    let short = good(&["spectrum", "list"]);
    assert!(short.contains("(99 columns: #ces01 ... #ces99)") && !short.contains("#ces50"), "{short}");
    assert!(short.contains("#neutral-5") && short.contains("--all"), "{short}");
    let longest = short.lines().map(|line| line.chars().count()).max().unwrap_or(0);
    assert!(longest < 600, "{longest}");
    let all = good(&["spectrum", "list", "--all"]);
    assert!(all.contains("#ces01, #ces02") && all.contains("#ces50"), "{all}");
}

/// Three lines with the hues of sRGB's primaries add up to white.
#[test]
fn lines_that_make_white() {
    let light = info(&["rgb-lines"]);
    close(&light["xy"], &[0.3127, 0.3290], 1e-4);
    let picture = good(&["spectrum", "info", "rgb-lines"]);
    assert!(picture.contains("rgb-lines"), "{picture}");
    assert!(refused(&["info", "rgb-lines:1"]).contains("rgb-lines"));
}
