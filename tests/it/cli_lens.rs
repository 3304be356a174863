//! Tests `spectra lens info` with first-order values computed by others.

use crate::common::{good, lens, repository, rows, run, shown, text};
use serde_json::Value;
use std::collections::BTreeMap;
use std::sync::Mutex;

/// Returns the program's report on a lens. The report on a bundled lens is computed once, because several tests need it.
fn info(lens: &str, options: &[&str]) -> Value {
    static KNOWN: Mutex<BTreeMap<String, Value>> = Mutex::new(BTreeMap::new());
    let arguments: Vec<&str> = ["lens", "info", lens, "--json"].into_iter().chain(options.iter().copied()).collect();
    let ask = || serde_json::from_str(&good(&arguments)).expect("JSON");
    // A lens name can contain a point, so the extension is appended, not replaced.
    if !repository("lenses").join(format!("{lens}.yaml")).is_file() {
        return ask();
    }
    let key = arguments.join(" ");
    if let Some(known) = KNOWN.lock().expect("no panic").get(&key) {
        return known.clone();
    }
    let said: Value = ask();
    KNOWN.lock().expect("no panic").insert(key, said.clone());
    said
}

fn figure(info: &Value, key: &str) -> f64 {
    info[key].as_f64().unwrap_or_else(|| panic!("`{key}` is no number: {}", info[key]))
}

/// Every medium with an extrapolated index is reported once.
#[test]
fn extrapolated_indices_are_told() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("two.yaml");
    let text = "name: two\nsurfaces:\n  - {radius: 50, thickness: 5, glass: SCHOTT/BK7, stop: true, semi-diameter: 5}\n  - {radius: -50, thickness: 1}\n  \
                - {radius: 50, thickness: 5, glass: SCHOTT/BK7}\n  - {radius: -50, thickness: 1}\n  \
                - {radius: 50, thickness: 5, glass: {nd: 1.6, vd: 50}}\n  - {radius: -50, thickness: 9}\n";
    std::fs::write(&file, text).expect("written");
    let told = |nm: &str| {
        let notes = info(shown(&file), &["--wavelength-nm", nm])["notes"].clone();
        let notes = notes.as_array().expect("a list").iter().filter_map(Value::as_str);
        notes.filter(|note| note.contains("is extrapolated")).map(str::to_owned).collect::<Vec<_>>()
    };
    assert_eq!(told("550"), [""; 0]);
    let far = told("1550");
    assert!(far.len() == 2 && far[0].starts_with("SCHOTT/BK7 was measured from 400 to 700 nm"), "{far:?}");
    assert!(far[1].contains("only by an index and an Abbe number"), "{far:?}");
}

/// A note reports an assumed absorption that costs a stop, and names the glass that it is borrowed from.
#[test]
fn a_stop_of_assumed_absorption_is_told() {
    let rod = repository("tests/warned/own/rod.yaml");
    let said = |more: &[&str]| info(shown(&rod), more)["notes"].to_string();
    let notes = said(&[]);
    assert!(
        notes.contains("absorption of SCHOTT/SF53 is not known; that of SCHOTT/SF")
            && notes.contains("stops at 405 nm"),
        "{notes}"
    );
    assert!(!said(&["--absorption", "false"]).contains("darkens"));
}

/// Focal lengths were computed twice, independently, and are printed with seven decimals.
#[test]
fn focal_lengths_of_thirteen_lenses() {
    let wanted = rows("first-order.csv");
    assert_eq!(wanted.len(), 13);
    for row in wanted {
        let info = info(&lens(&row[0]), &["--nd"]);
        for (key, wanted) in [("efl_mm", &row[1]), ("bfl_mm", &row[2])] {
            let wanted: f64 = wanted.parse().expect("a number");
            assert!((figure(&info, key) - wanted).abs() < 1e-7, "{} {key}: {}", row[0], info[key]);
        }
    }
}

/// The paraxial pupil magnification, exit over entrance pupil diameter, agrees within 0.01.
#[test]
fn pupil_magnification_of_nine_lenses() {
    for (name, wanted) in [
        ("angenieux-100-f1.1", 2.38),
        ("nikon-retrofocus-100-f2.8", 1.73),
        ("asahi-takumar-100-f1.2", 1.63),
        ("zeiss-biotar-50-f1.4", 1.32),
        ("nikkor-100-f1.4", 1.32),
        ("canon-fd-50-f1.8", 1.14),
        ("leica-summilux-35-f1.4", 1.09),
        ("helios-44-58-f2", 0.98),
        ("zeiss-hologon-15-f8", 0.98),
    ] {
        let found = figure(&info(&lens(name), &["--nd"]), "pupil_magnification");
        assert!((found - wanted).abs() <= 0.01, "{name}: {found}");
    }
}

/// A thick lens follows its closed form; the index of N-BK7 at d is the maker's.
#[test]
fn equiconvex_lens_has_its_closed_form() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("equiconvex.yaml");
    let text = "name: Equiconvex\nsurfaces:\n  - {kind: sphere, radius: 50, thickness: 5, glass: SCHOTT/N-BK7}\n  \
                - {kind: sphere, radius: -50, thickness: 47, semi-diameter: 10}\n";
    std::fs::write(&file, text).expect("written");
    let info = info(shown(&file), &["--line", "d"]);
    assert!((figure(&info, "efl_mm") - 49.21300).abs() < 5e-6, "{info}");
    assert!((figure(&info, "bfl_mm") - 47.53622).abs() < 5e-6, "{info}");
    // The lens is symmetric, so its front mirrors its rear.
    assert!((figure(&info, "ffl_mm") + figure(&info, "bfl_mm")).abs() < 1e-9);
    let (front, rear) = (figure(&info, "front_principal_z_mm"), figure(&info, "rear_principal_z_mm"));
    assert!((front + rear - 5.0).abs() < 1e-9 && front < rear);
    assert_eq!(figure(&info, "total_track_mm"), 52.0);
    assert_eq!(figure(&info, "image_distance_mm"), 47.0);
    assert_eq!(info["entrance_pupil_z_mm"], Value::Null, "a lens without a stop has no pupil");
    assert_eq!(info["surfaces"].as_array().map(Vec::len), Some(2));
    assert_eq!(info["line"], "d");
}

#[test]
fn f_number_and_focus_are_set() {
    let name = "zeiss-biotar-50-f1.4";
    let wide = info(name, &[]);
    let set = info(name, &["--f-number", "f/4", "--focus", "2 m"]);
    assert!((figure(&set, "f_number") - 4.0).abs() < 1e-9);
    // In air, the sine condition of a well corrected lens holds to a few per cent: D = f / N.
    assert!((figure(&set, "entrance_pupil_diameter_mm") * 4.0 / figure(&set, "efl_mm") - 1.0).abs() < 0.02);
    assert!(figure(&set, "image_distance_mm") > figure(&wide, "image_distance_mm") + 1.0);
    assert_eq!(figure(&set, "efl_mm"), figure(&wide, "efl_mm"));
    // Blue light bends more in every glass, but the lens is corrected: less than one per cent of difference is left.
    let (blue, red) =
        (figure(&info(name, &["--line", "F"]), "efl_mm"), figure(&info(name, &["--line", "C"]), "efl_mm"));
    assert!(blue != red && (blue / red - 1.0).abs() < 0.01, "{blue} {red}");
}

/// The report contains coatings, focus shifts, field, chief rays and mounts, and they are consistent.
#[test]
fn the_report_is_whole() {
    let biotar = info("zeiss-biotar-50-f1.4", &[]);
    for key in [
        "efl_mm",
        "bfl_mm",
        "ffl_mm",
        "f_number",
        "t_number",
        "entrance_pupil_z_mm",
        "entrance_pupil_diameter_mm",
        "exit_pupil_z_mm",
        "exit_pupil_diameter_mm",
        "front_principal_z_mm",
        "rear_principal_z_mm",
        "front_nodal_z_mm",
        "rear_nodal_z_mm",
        "total_track_mm",
        "image_distance_mm",
        "max_field_deg",
        "magnification",
        "paraxial_focus_shift_mm",
        "rms_focus_shift_mm",
        "contrast_focus_shift_mm",
    ] {
        figure(&biotar, key);
    }
    // In air the nodal points are the principal points, and this lens is not anamorphic.
    assert!((figure(&biotar, "front_nodal_z_mm") - figure(&biotar, "front_principal_z_mm")).abs() < 1e-9);
    assert!((figure(&biotar, "rear_nodal_z_mm") - figure(&biotar, "rear_principal_z_mm")).abs() < 1e-9);
    assert!(biotar.get("efl_x_mm").is_none());
    assert_eq!(biotar["focus_distance_mm"], Value::Null);
    let rays = biotar["chief_ray_exit_angle_deg"].as_array().expect("a list");
    assert_eq!(rays.len(), 11);
    assert_eq!((figure(&rays[0], "field_deg"), figure(&rays[0], "angle_deg")), (0.0, 0.0));
    // f tan(field), except for a few per cent of distortion.
    let (field, height) = (figure(&rays[5], "field_deg"), figure(&rays[5], "image_height_mm"));
    assert!((height / (figure(&biotar, "efl_mm") * field.to_radians().tan()) - 1.0).abs() < 0.03, "{field} {height}");
    // There are 32.4 mm behind the glass: enough for Leica's 27.80, too little for a mirror.
    let mounts = biotar["mounts"].as_array().expect("a list");
    let clearance = |name: &str| mounts.iter().find(|m| m["name"] == name).map(|m| figure(m, "clearance_mm"));
    assert!((clearance("Leica M").expect("it fits") - (figure(&biotar, "image_distance_mm") - 27.8)).abs() < 1e-9);
    assert!(clearance("Nikon F").is_none() && clearance("M42").is_none());
    let retrofocus = info(&lens("nikon-retrofocus-100-f2.8"), &[]);
    assert!(retrofocus["mounts"].as_array().is_some_and(|m| m.iter().any(|m| m["name"] == "Nikon F")));
}

/// The focus distance can be given with or without a unit; the magnification is m = f / (distance - front focus).
#[test]
fn focus_is_given_in_either_form() {
    let unit = info("zeiss-biotar-50-f1.4", &["--focus", "2 m"]);
    let bare = info("zeiss-biotar-50-f1.4", &["--focus-mm", "2000"]);
    assert_eq!(unit, bare);
    assert_eq!(figure(&bare, "focus_distance_mm"), 2000.0);
    let want = -figure(&bare, "efl_mm") / (2000.0 + figure(&bare, "ffl_mm"));
    assert!((figure(&bare, "magnification") - want).abs() < 1e-12, "{want}");
    let both = run(&["lens", "info", "zeiss-biotar-50-f1.4", "--focus", "2 m", "--focus-mm", "2000"]);
    assert_eq!(both.status.code(), Some(2));
}

/// The Biotar of 1927 at line d has f/1.438 and T/1.836, by an independent ray tracer (`xtask/t_number.py`; its figures are kept in a
/// table).
#[test]
fn t_number_of_the_biotar_is_that_of_an_independent_script() {
    for row in rows("t-numbers.csv") {
        let number = |at: usize| row[at].parse::<f64>().expect("a number");
        let found = info(&row[0], &["--coating", "bare", "--absorption", "false", "--line", "d"]);
        for (key, want) in [("f_number", number(1)), ("transmittance", number(2)), ("t_number", number(3))] {
            assert!((figure(&found, key) / want - 1.0).abs() < 0.003, "{} {key}: {} {want}", row[0], found[key]);
        }
        // Includes the transmittance of the glass, its own or borrowed. The script has no value for glasses that are known by figures
        // only.
        if let Ok(want) = row[4].parse::<f64>() {
            let found = info(&row[0], &["--coating", "bare", "--line", "d"]);
            assert!(
                (figure(&found, "t_number") / want - 1.0).abs() < 0.003,
                "{}: {} {want}",
                row[0],
                found["t_number"]
            );
        }
    }
    let biotar = info("zeiss-biotar-50-f1.4", &[]);
    assert!(figure(&biotar, "t_number") > 1.83, "{}", biotar["t_number"]);
    assert!(
        biotar["losses"].as_str().is_some_and(|l| l.starts_with("bare (assumed for 1927), glass absorbs")),
        "{biotar}"
    );
    let ideal = info("zeiss-biotar-50-f1.4", &["--coating", "ideal", "--absorption", "false"]);
    assert_eq!(ideal["t_number"], ideal["f_number"]);
    assert_eq!(ideal["losses"], "no reflections, no absorption");
}

/// Assumed coatings are bare before 1940 and without a year, one layer before 1970, then three layers, and the T-number's remark says
/// so.
#[test]
fn coatings_are_those_of_the_time() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("lens.yaml");
    let losses = |more: &str| {
        let text = format!(
            "name: Singlet\n{more}absorption: false\nsurfaces:\n  - {{kind: plane, thickness: 5, glass: SCHOTT/N-BK7, \
             semi-diameter: 5}}\n  - {{kind: sphere, radius: -50, thickness: 96, semi-diameter: 5}}\n"
        );
        std::fs::write(&file, text).expect("written");
        let info = info(shown(&file), &[]);
        (info["losses"].as_str().expect("words").to_owned(), 1.0 - figure(&info, "transmittance"))
    };
    for (more, words, least, most) in [
        ("", "bare (assumed: no year is stated), no absorption", 0.08, 0.09),
        ("year: 1938\n", "bare (assumed for 1938), no absorption", 0.08, 0.09),
        ("year: 1955\n", "a single layer of MgF2 (assumed for 1955), no absorption", 0.02, 0.03),
        ("year: 1985\n", "three layers (assumed for 1985), no absorption", 0.0, 0.01),
        ("year: 1985\ncoating: bare\n", "bare, no absorption", 0.08, 0.09),
        (
            "coating: {kind: single-layer, assumed: true}\n",
            "a single layer of MgF2 (assumed: no year is stated), no absorption",
            0.02,
            0.03,
        ),
    ] {
        let (found, lost) = losses(more);
        assert_eq!(found, words);
        assert!(lost > least && lost < most, "{more}: {lost}");
    }
}

/// A lens fits its own mount, whose mirror box its rear glass may enter. Mounts that it does not fit are not listed.
#[test]
fn lenses_fit_their_own_mounts() {
    let mounts = |name: &str| -> Vec<String> {
        let info = info(name, &[]);
        let all = info["mounts"].as_array().expect("a list").iter();
        all.map(|m| m["name"].as_str().expect("a name").to_owned()).collect()
    };
    for (lens, own, other) in [
        // The back focus is 32.7 mm: behind the flange of FD, and too close to the film for a deeper mirror.
        ("canon-fd-50-f1.8", "Canon FD", "Canon EF"),
        ("helios-44-58-f2", "M42", "Leica R"),
        ("minolta-fisheye-16-f2.7", "Minolta SR", "M42"),
        ("canon-ef-70-200-f2.8-at-72", "Canon EF", "T2"),
        // Lenses for rangefinders: no mirror swings behind them.
        ("canon-35-f1.8", "C-mount", "Canon FD"),
        ("zeiss-biotar-50-f1.4", "Leica M", "M42"),
        ("zeiss-biotar-50-f1.4", "Leica M", "Minolta SR"),
    ] {
        let found = mounts(lens);
        assert!(found.iter().any(|m| m == own), "{lens}: {found:?}");
        assert!(!found.iter().any(|m| m == other), "{lens}: {found:?}");
    }
    // The table shows the common mounts, and the others on request.
    let told = |arguments: &[&str]| {
        let table = good(&[&["lens", "info", "canon-fd-50-f1.8"][..], arguments].concat());
        table.lines().find(|line| line.starts_with("fits these mounts")).expect("a line").to_owned()
    };
    let (common, every) = (told(&[]), told(&["--mounts"]));
    assert!(common.contains("Canon FD 42 (9.3 behind the flange)") && every.contains("Canon FD 42"), "{common}");
    assert!(!common.contains("Samsung NX") && every.contains("Samsung NX 25.5"), "{common}");
    assert!(common.ends_with("less common ones (`--mounts` lists them)") && !every.contains("--mounts"), "{common}");
    assert_eq!(every.matches(", ").count() + 1, mounts("canon-fd-50-f1.8").len());
}

/// The number in a lens's name means its full aperture, for every bundled lens that has one. A note says if the name is rounded.
#[test]
fn nominal_f_numbers_mean_wide_open() {
    let mut noted = 0;
    for entry in std::fs::read_dir(repository("lenses")).expect("a folder") {
        let path = entry.expect("an entry").path();
        let name = path.file_stem().expect("a name").to_string_lossy().into_owned();
        let plain = path.is_file().then(|| info(&name, &[]));
        let Some(plain) = plain.filter(|info| info["nominal_f_number"].is_number()) else { continue };
        let nominal = figure(&plain, "nominal_f_number");
        let set = info(&name, &["--f-number", &format!("f/{nominal}")]);
        let (set_number, real) = (figure(&set, "f_number"), figure(&plain, "f_number"));
        assert!((set_number - nominal.max(real)).abs() < 0.03 * nominal, "{name}: {set_number} {real} {nominal}");
        noted += usize::from(!set["notes"].as_array().expect("a list").is_empty());
    }
    assert_eq!(noted, 4, "Biotar 50, Takumar, Canon 35, the zoom");
    let output = run(&["lens", "info", "zeiss-biotar-50-f1.4", "--f-number", "f/1.37"]);
    let told = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2));
    assert!(told.contains("the rim of surface") && told.contains("would need r ="), "{told}");
}

/// A mistyped digit or sign is noticed in the shape, and the warning names the surfaces. No bundled lens causes such a warning.
#[test]
fn slips_of_typing_are_seen_in_the_shape() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("lens.yaml");
    let biotar = std::fs::read_to_string(repository("lenses/zeiss-biotar-50-f1.4.yaml")).expect("the lens");
    let doubts = |from: &str, to: &str| {
        assert!(biotar.contains(from), "{from}");
        std::fs::write(&file, biotar.replacen(from, to, 1)).expect("written");
        info(shown(&file), &[])["warnings"].to_string()
    };
    assert_eq!(doubts("name: Zeiss", "name: Z"), "[]");
    // The stop is 4 mm in front of a surface with a radius of 19.25 mm; a wrong thickness makes the surfaces meet.
    let meet = doubts("{kind: stop, thickness: 4}", "{kind: stop, thickness: -1}");
    assert!(meet.contains("surfaces 5 and 7 meet"), "{meet}");
    let thin = doubts("radius: -26.6, thickness: 0.485", "radius: 26.6, thickness: 0.485");
    assert!(thin.contains("meet") || thin.contains("wrong sign"), "{thin}");
    let sign = doubts("radius: 14.15", "radius: -14.15");
    assert!(sign.contains("wrong sign"), "{sign}");
    for folder in ["", "surfaces/"] {
        for entry in std::fs::read_dir(repository("lenses").join(folder)).expect("a folder") {
            let path = entry.expect("an entry").path();
            if path.is_file() {
                let name = format!("{folder}{}", path.file_stem().and_then(|stem| stem.to_str()).expect("a name"));
                let warnings = info(&name, &[])["warnings"].to_string();
                assert!(!warnings.contains("meet") && !warnings.contains("in front of the last"), "{name}: {warnings}");
            }
        }
    }
}

/// Lenses are compared side by side; a setting that one lens cannot reach does not stop the other.
#[test]
fn lenses_are_compared() {
    let table = good(&["lens", "compare", "zeiss-biotar-50-f1.4", "helios-44-58-f2", "--f-number", "f/1.4"]);
    for word in [
        "Zeiss Biotar 50 mm f/1.4",
        "Helios-44 58 mm f/2",
        "f/1.438",
        "f/2.046",
        "T/",
        "contrast",
        "distortion",
        "wide open",
    ] {
        assert!(table.contains(word), "{word}: {table}");
    }
    let json: Value =
        serde_json::from_str(&good(&["lens", "compare", "cooke-triplet-50-f5", "tessar-50-f4.5", "--json"]))
            .expect("JSON");
    let lenses = json["lenses"].as_array().expect("a list");
    for compared in lenses {
        assert!((0.1..=1.0).contains(&figure(compared, "axial_contrast")), "{compared}");
        assert!(figure(compared, "distortion").abs() < 0.05 && figure(compared, "image_circle_mm") > 20.0);
    }
    assert_eq!(run(&["lens", "compare", "cooke-triplet-50-f5"]).status.code(), Some(2));
}

/// The T-number of an uncoated singlet at a small aperture is N / T^(1/2) with T = (1 - R)^2 and R = ((n - 1) / (n + 1))^2.
#[test]
fn t_number_counts_reflections() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("bare.yaml");
    let write = |coating: &str| {
        let text = format!(
            "name: Bare\nsurfaces:\n  - {{kind: sphere, radius: 500, thickness: 5, glass: {{nd: 1.5168}}, semi-diameter: 5}}\n  \
             - {{kind: sphere, radius: -500, thickness: 480, semi-diameter: 6}}\n{coating}"
        );
        std::fs::write(&file, text).expect("written");
        info(shown(&file), &["--nd"])
    };
    let (ideal, bare) = (write("coating: ideal\n"), write("coating: bare\n"));
    let coated = write("coating: {layer: 1.38, quarter-wave-at: 587.5618 nm}\n");
    assert_eq!(ideal["t_number"], ideal["f_number"]);
    for (info, reflectance) in [(bare, 0.042_164_6), (coated, 0.012_835_4)] {
        assert_eq!(info["f_number"], ideal["f_number"]);
        let ratio = figure(&info, "f_number") / figure(&info, "t_number");
        assert!((ratio - (1.0 - reflectance)).abs() < 1e-6, "{ratio} {reflectance}");
        assert!((figure(&info, "transmittance") - ratio * ratio).abs() < 1e-12);
    }
}

/// If the axis is folded or bends behind the last surface, lengths are measured along it.
#[test]
fn a_folded_lens_is_as_long_as_its_axis() {
    for (name, length_mm, image_mm) in [
        ("surfaces/newton-200-f2.5", -150.0, 50.0),
        ("prism-60-sf11", 0.0, 150.0),
        ("surfaces/schmidt-200-f2", 400.0, -200.0),
    ] {
        let info = info(name, &[]);
        assert!((figure(&info, "vertex_length_mm") - length_mm).abs() < 1e-9, "{name}: {info}");
        assert!((figure(&info, "image_distance_mm") - image_mm).abs() < 1e-9, "{name}: {info}");
        assert!((figure(&info, "total_track_mm") - length_mm - image_mm).abs() < 1e-9, "{name}: {info}");
    }
}

#[test]
fn people_get_a_table() {
    let table = good(&["lens", "info", "zeiss-biotar-50-f1.4"]);
    for word in [
        "Biotar",
        "1927",
        "US 1786916",
        "focal length",
        "SCHOTT/BAF9",
        "stop",
        "f/1.4",
        "T/1.8",
        "bare (assumed for 1927)",
        "open",
        "Leica M",
        "largest field",
        "smallest spot",
    ] {
        assert!(table.contains(word), "{word}: {table}");
    }
    assert!(!table.contains('\u{1b}'));
}

#[test]
fn wrong_settings_are_told() {
    for (arguments, word) in [
        (&["zeiss-biotar-50-f1.5"][..], "zeiss-biotar-50-f1.4"),
        (&["zeiss-biotar-50-f1.4", "--f-number", "f/0.9"], "faster than the lens"),
        (&["zeiss-biotar-50-f1.4", "--focus", "1 mm"], "has no real image"),
        (&["zeiss-biotar-50-f1.4", "--focus", "2 s"], "expected a positive length"),
        (&["zeiss-biotar-50-f1.4", "--line", "q"], "no such spectral line"),
        (&["zeiss-biotar-50-f1.4", "--nd", "--line", "d"], "cannot be used with"),
    ] {
        let output = run(&["lens", "info"].into_iter().chain(arguments.iter().copied()).collect::<Vec<_>>());
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(message.contains(word), "{arguments:?}: {message}");
    }
}

/// Veiling glare is reported on request, with its error, in the table and in JSON; if it cannot be computed, a reason is given.
#[test]
fn veiling_glare_is_said_where_asked() {
    let name = "zeiss-biotar-50-f1.4";
    assert!(info(name, &[]).get("glare").is_none());
    let bare = info(name, &["--glare", "--f-number", "2", "--coating", "bare"])["glare"].clone();
    let index = figure(&bare, "index");
    assert!(index > 0.01 && index < 0.1 && figure(&bare, "standard_error") < 0.03 * index, "{bare}");
    assert_eq!((figure(&bare, "paint"), figure(&bare, "imager")), (0.04, 0.0));
    let options = ["--glare", "--f-number", "2", "--coating", "bare", "--paint", "50%", "--film-reflectance", "0.3"];
    let bright = info(name, &options)["glare"].clone();
    assert!(figure(&bright, "index") > 1.2 * index && figure(&bright, "scattered") > figure(&bare, "scattered"));
    let table = good(&["lens", "info", name, "--glare"]);
    assert!(table.contains("veiling glare") && table.contains("by glass alone"), "{table}");
    for (arguments, word) in [
        (vec!["prism-60-sf11", "--glare"], "surface 1 is tilted"),
        (vec![name, "--paint", "4 %"], "--glare"),
        (vec![name, "--glare", "--paint", "120 %"], "from 0 to 100 %"),
    ] {
        let output = run(&[&["lens", "info"][..], &arguments].concat());
        assert!(!output.status.success() && text(&output.stderr).contains(word), "{}", text(&output.stderr));
    }
}

/// The field is reported point by point, at the requested image heights: curvature, astigmatism, distortion and relative illuminance.
#[test]
fn the_field_is_told_point_by_point() {
    let name = "zeiss-biotar-50-f1.4";
    let stopped = info(name, &["--f-number", "f/4", "--image-height", "21.6mm"]);
    let points = stopped["chief_ray_exit_angle_deg"].as_array().expect("a list");
    assert_eq!(points.len(), 4);
    for (point, part) in points.iter().zip([0.0, 0.5, 0.7, 1.0]) {
        assert!((figure(point, "image_height_mm") - part * 21.6).abs() < 1e-6, "{point}");
        // At f/4 only the corner is vignetted: light falls roughly with the fourth power of the cosine, and less where the pupil
        // grows.
        let angle = figure(point, "angle_deg").to_radians();
        let light = figure(point, "relative_illuminance");
        assert!(light < 1.0 + 1e-9 && light > 0.5 * angle.cos().powi(4), "{point}");
    }
    assert_eq!((figure(&points[0], "relative_illuminance"), &points[0]["distortion"]), (1.0, &Value::Null));
    let (sagittal, tangential) = (figure(&points[0], "sagittal_focus_mm"), figure(&points[0], "tangential_focus_mm"));
    assert!(
        (sagittal - tangential).abs() < 1e-6 && (sagittal - figure(&stopped, "paraxial_focus_shift_mm")).abs() < 1e-5
    );
    // Wide open, the rims cut off more light.
    let open = info(name, &["--image-height", "21.6mm"]);
    let corner = |info: &Value| figure(&info["chief_ray_exit_angle_deg"][3], "relative_illuminance");
    assert!(corner(&open) < 0.7 * corner(&stopped), "{} {}", corner(&open), corner(&stopped));
    // Without an image height, the field continues to the point where no light arrives.
    let all = info(name, &[]);
    let last = &all["chief_ray_exit_angle_deg"][10];
    assert!(figure(last, "relative_illuminance") < 0.02 && figure(last, "distortion").abs() < 0.2, "{last}");
    let table = good(&["lens", "info", name, "--image-height", "21.6mm"]);
    assert!(
        ["distortion", "sagittal", "tangential", "100.0 %", "21.6000"].iter().all(|w| table.contains(w)),
        "{table}"
    );
    let too_far = run(&["lens", "info", name, "--image-height", "100mm"]);
    assert!(
        text(&too_far.stderr).contains("--image-height: the field of the lens ends at"),
        "{}",
        text(&too_far.stderr)
    );
}

/// A single element accepts up to 90 degrees, but nobody uses such a field, so it is listed and drawn to the corner of 135 film. A
/// fisheye is shown whole.
#[test]
fn a_field_that_no_rim_limits_ends_at_the_corner() {
    let last = |name: &str| {
        let found = info(name, &[]);
        let points = found["chief_ray_exit_angle_deg"].as_array().expect("a list").clone();
        let [field, height] =
            ["field_deg", "image_height_mm"].map(|key| figure(points.last().expect("points"), key).abs());
        (figure(&found, "max_field_deg"), field, height)
    };
    let (largest, field, height) = last("surfaces/conic-singlet");
    assert!(largest > 80.0 && field < 30.0 && (height - 21.633).abs() < 0.01, "{largest} {field} {height}");
    assert!(good(&["lens", "info", "surfaces/conic-singlet"]).contains("to the corner of 135 film"));
    let (largest, field, _) = last("minolta-fisheye-16-f2.7");
    assert!(largest > 100.0 && field > 90.0, "{largest} {field}");
    // The drawing stops at the same field. Otherwise oblique beams would fill it: the figure must be lower than 1.5 times its width.
    let folder = tempfile::tempdir().expect("a folder");
    for name in ["surfaces/conic-singlet", "surfaces/axicon"] {
        let drawn = folder.path().join("drawn.svg");
        good(&["lens", "draw", name, "-o", shown(&drawn)]);
        let svg = std::fs::read_to_string(&drawn).expect("a figure");
        let side = |key: &str| -> f64 {
            let rest = svg.split(&format!(" {key}=\"")).nth(1).expect(key);
            rest.split('"').next().and_then(|n| n.parse().ok()).expect("a number")
        };
        assert!(side("height") < 1.5 * side("width"), "{name}: {} x {}", side("width"), side("height"));
    }
}

/// Both commands report the same distortion, and none for a pinhole.
#[test]
fn distortion_is_told_alike() {
    let (biotar, triplet) = ("zeiss-biotar-50-f1.4", "cooke-triplet-50-f5");
    let both: Value = serde_json::from_str(&good(&["lens", "compare", biotar, triplet, "--json"])).expect("JSON");
    let (field, distortion) = (figure(&both, "field_deg"), figure(&both["lenses"][0], "distortion"));
    let points = info(biotar, &[])["chief_ray_exit_angle_deg"].clone();
    // The distortion lies between the values of the points on both sides, because it is monotone there.
    let beside: Vec<(f64, f64)> = points.as_array().expect("a list")[1..]
        .iter()
        .map(|point| (figure(point, "field_deg"), figure(point, "distortion")))
        .collect();
    let pair = beside.windows(2).find(|pair| pair[0].0 <= field && field <= pair[1].0).expect("a field within");
    let (low, high) = (pair[0].1.min(pair[1].1), pair[0].1.max(pair[1].1));
    assert!((low..=high).contains(&distortion), "{field}: {distortion} {pair:?}");
    let pinhole = info("surfaces/pinhole-50", &["--image-height", "21.6mm"]);
    for point in &pinhole["chief_ray_exit_angle_deg"].as_array().expect("a list")[1..] {
        assert!(figure(point, "distortion").abs() < 1e-9, "{point}");
    }
}

/// Light of a uniform field through a round hole without glass: a disk of radius r, D in front of the film, gives at height h off the
/// axis E = pi L / 2 (1 - (D^2 + h^2 - r^2) / ((D^2 + h^2 + r^2)^2 - 4 r^2 h^2)^(1/2)) (e.g. P. Foote, Bull. Bur. Stand. 12 (1915),
/// 583).
#[test]
fn light_over_the_field_is_that_of_a_hole() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("hole.yaml");
    for (r, d) in [(1.0_f64, 50.0_f64), (20.0, 40.0)] {
        let text = format!("name: Hole\nsurfaces:\n  - {{kind: stop, thickness: {d}, semi-diameter: {r}}}\n");
        std::fs::write(&file, text).expect("written");
        let light = |h: f64| {
            let all = d * d + h * h + r * r;
            1.0 - (all - 2.0 * r * r) / (all * all - 4.0 * r * r * h * h).sqrt()
        };
        let found = info(shown(&file), &["--image-height", "30mm"]);
        for point in found["chief_ray_exit_angle_deg"].as_array().expect("a list") {
            let wanted = light(figure(point, "image_height_mm")) / light(0.0);
            let found = figure(point, "relative_illuminance");
            assert!((found / wanted - 1.0).abs() < 3e-3, "{r} {d}: {found} {wanted}");
        }
    }
}

/// A note about a lens without a stop says which rim sets the f-number and what to write, in the terms of the file format. Writing it
/// solves the problem.
#[test]
fn a_lens_without_a_stop_says_what_is_assumed() {
    let folder = tempfile::tempdir().expect("a folder");
    let yaml = "name: Singlet\nsurfaces:\n  - {radius: 50, thickness: 5, nd: 1.5168, vd: 64.2, semi-diameter: 8}\n  \
                - {radius: -50, thickness: 47, semi-diameter: 10}\n";
    let seq = "RDM\nS0 0 1e13\nS 50 5 516800.641700\n CIR 8\nS -50 47\n CIR 10\nSI 0 0\n";
    let marked_yaml = yaml.replace("semi-diameter: 8", "semi-diameter: 8, stop: true");
    let marked_seq = seq.replace(" CIR 8", " CIR 8\n STO");
    for (name, plain, marked, words) in
        [("singlet.yaml", yaml, marked_yaml, "`stop: true`"), ("singlet.seq", seq, marked_seq, "write `STO`")]
    {
        let file = folder.path().join(name);
        std::fs::write(&file, plain).expect("written");
        let notes = info(shown(&file), &[])["notes"].to_string();
        assert!(notes.contains("that of the rim of surface 1 (r = 8.00 mm)") && notes.contains(words), "{notes}");
        let refused = run(&["lens", "info", shown(&file), "--f-number", "8"]);
        assert!(text(&refused.stderr).contains(words), "{}", text(&refused.stderr));
        std::fs::write(&file, marked).expect("written");
        let helped = info(shown(&file), &["--f-number", "8"]);
        assert!(!helped["notes"].to_string().contains("stop"), "{helped}");
        assert!((figure(&helped, "f_number") - 8.0).abs() < 1e-6);
    }
    // A prism, which has no power, needs no stop.
    assert_eq!(info("prism-60-sf11", &[])["notes"], serde_json::json!([]));
}
