//! Tests `spectra picture` with closed forms and with another program: figures, plots, cuts, spectra and comparisons of rendered
//! pictures.

use crate::common::{good, rows, run, shown, text};
use serde_json::Value;
use spectra_core::frame::{ExposureChannel, ExposureFrame, FrameSize};
use spectra_pictures::write::write_exr;
use std::fs;
use std::path::{Path, PathBuf};

/// Luminance of the card, cd/m2.
const LUMINANCE: f64 = 300.0;
/// Focal length of the ideal lens, mm.
const FOCAL_MM: f64 = 50.0;
/// Radius of the ideal lens, mm.
const RADIUS_MM: f64 = 6.25;
/// Size of the frame, mm.
const FRAME_MM: [f64; 2] = [18.0, 12.0];
/// Size of the frame, pixels.
const FRAME_PX: [u32; 2] = [48, 32];

/// Writes a scene of a large and distant white card through an ideal lens, and returns its path.
fn scene(folder: &Path, name: &str, source: &str, imager: &str, samples: u32) -> PathBuf {
    let lens = folder.join("ideal.yaml");
    let text = format!(
        "name: ideal\nsource: geometry\nsurfaces:\n  - {{kind: thin-lens, focal-length: {FOCAL_MM}, thickness: {FOCAL_MM}, \
         semi-diameter: {RADIUS_MM}}}\n"
    );
    fs::write(&lens, text).expect("written");
    let path = folder.join(format!("{name}.yaml"));
    let ([w, h], [columns, rows]) = (FRAME_MM, FRAME_PX);
    let text = format!(
        "spectra: 1\nsource: {{kind: chart, chart: white, distance: 10 km, width: 16 km, {source}}}\n\
         lens: {{file: ideal.yaml, focus: infinity}}\n\
         imager: {{{imager}, width: {w} mm, height: {h} mm, resolution: [{columns}, {rows}]}}\n\
         render: {{samples: {samples}, seed: 1}}\noutput: [exr, png]\n"
    );
    fs::write(&path, text).expect("written");
    path
}

fn render(scene: &Path, folder: &Path) -> PathBuf {
    good(&["run", shown(scene), "-q", "-o", shown(folder)]);
    folder.join(scene.file_stem().expect("a name")).with_extension("exr")
}

fn json(arguments: &[&str]) -> Value {
    serde_json::from_str(&good(arguments)).expect("JSON")
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

/// A truncated file is refused with a hint, as it is when it is developed. Long names in the report are separated from their values.
#[test]
fn a_file_cut_short_and_a_long_name_are_told_whole() {
    let folder = tempfile::tempdir().expect("a folder");
    let whole = folder.path().join("whole.png");
    image::RgbImage::from_pixel(8, 4, image::Rgb([255; 3])).save(&whole).expect("written");
    assert!(good(&["picture", "info", shown(&whole)]).contains("at the end of the scale  100.00 %"));
    let bytes = fs::read(&whole).expect("there");
    let cut = folder.path().join("cut.png");
    fs::write(&cut, &bytes[..bytes.len() / 2]).expect("written");
    let refused = run(&["picture", "info", shown(&cut)]);
    assert!(!refused.status.success() && text(&refused.stderr).contains("is the file complete?"));
}

/// Returns the projected solid angle, sr, of a disk of radius a at distance d, seen `r` off its axis by an observer who looks along
/// the axis.
fn projected_solid_angle_sr(d: f64, a: f64, r: f64) -> f64 {
    let sum = d * d + r * r + a * a;
    0.5 * std::f64::consts::PI * (1.0 - (sum - 2.0 * a * a) / (sum * sum - 4.0 * r * r * a * a).sqrt())
}

/// Returns the etendue of the frame, m2 sr: the flux of unit radiance, from that formula at 8 x 8 points of each pixel.
fn etendue_m2_sr() -> f64 {
    let steps = FRAME_PX.map(|px| 8 * px);
    let place = |i: u32, k: usize| (f64::from(i) + 0.5) / f64::from(steps[k]) * FRAME_MM[k] - 0.5 * FRAME_MM[k];
    let mut sum = 0.0;
    for i in 0..steps[0] {
        for j in 0..steps[1] {
            sum += projected_solid_angle_sr(FOCAL_MM, RADIUS_MM, place(i, 0).hypot(place(j, 1)));
        }
    }
    sum / f64::from(steps[0] * steps[1]) * FRAME_MM[0] * FRAME_MM[1] * 1e-6
}

/// Lumens and watts of a card of known luminance through an ideal lens agree with the camera equation within 0.1 %.
#[test]
fn lumens_and_watts_are_those_of_the_camera_equation() {
    let folder = tempfile::tempdir().expect("a folder");
    let wanted_lm = LUMINANCE * etendue_m2_sr();
    // On the axis this is pi L / (4 N^2 + 1).
    let axis = LUMINANCE * projected_solid_angle_sr(FOCAL_MM, RADIUS_MM, 0.0);
    let n = FOCAL_MM / (2.0 * RADIUS_MM);
    assert!((axis / (std::f64::consts::PI * LUMINANCE / (4.0 * n * n + 1.0)) - 1.0).abs() < 1e-12);

    let source = format!("illuminant: E, luminance: {LUMINANCE} cd/m2");
    let path = scene(folder.path(), "lux", &source, "kind: xyz", 1024);
    let info = json(&["picture", "info", shown(&render(&path, folder.path())), "--json"]);
    assert_eq!([&info["width_px"], &info["height_px"]], [48, 32]);
    let lux = &info["illuminance_lx"];
    let off = |found: &Value, wanted: f64| (number(found) / wanted - 1.0).abs();
    assert!(off(&info["luminous_flux_lm"], wanted_lm) < 1e-3, "{info}");
    assert!(off(&lux["mean"], wanted_lm / (FRAME_MM[0] * FRAME_MM[1] * 1e-6)) < 1e-3, "{info}");
    // The maximum is on the axis. The minimum is in a corner and follows the same formula at the center of the pixel.
    assert!(off(&lux["maximum"], axis) < 0.02 && number(&lux["minimum"]) < 0.97 * axis, "{info}");
    assert!(info["radiant_power_w"].is_null() && info["out_of_gamut"][0]["share"] == 0.0, "{info}");

    // With an exposure time the file is in lx s and states the time.
    let path = scene(folder.path(), "timed", &source, "kind: xyz, exposure: 1/60 s", 1024);
    let info = json(&["picture", "info", shown(&render(&path, folder.path())), "--json"]);
    assert_eq!(info["unit"], "lx s");
    assert!(off(&info["luminous_flux_lm"], wanted_lm) < 1e-3, "{info}");

    // Equal energy from 350 to 830 nm: 300 cd/m2 is 300 / (683 * 106.857) W m-2 sr-1 nm-1 (CIE 1931, sums over 1 nm).
    let spectral = "kind: spectral, bands: 240, range: [350 nm, 830 nm]";
    let path = scene(folder.path(), "watt", &source, spectral, 1024);
    let info = json(&["picture", "info", shown(&render(&path, folder.path())), "--json"]);
    let wanted_w = wanted_lm / (683.002 * 106.857) * 480.0;
    assert!(off(&info["radiant_power_w"], wanted_w) < 1e-3, "{} for {wanted_w}", info["radiant_power_w"]);
    assert!(off(&info["luminous_flux_lm"], wanted_lm) < 1e-3, "{}", info["luminous_flux_lm"]);
    assert_eq!(info["band_nm"], serde_json::json!([350.0, 830.0]));
}

/// The measured spectrum of an area can be used as a light, and makes the same picture within noise.
#[test]
fn a_measured_histogram_is_a_light() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name);
    let bands = "kind: spectral, bands: 240, range: [350 nm, 830 nm]";
    let light = |illuminant: &str| format!("illuminant: {illuminant}, luminance: {LUMINANCE} cd/m2");
    let spectral = render(&scene(folder.path(), "spectral", &light("D55"), bands, 2048), folder.path());
    let (yaml, diagram) = (at("measured.yaml"), at("xy.png"));
    let said = good(&[
        "picture",
        "spectrum",
        shown(&spectral),
        "--area",
        "0,0,48,32",
        "-o",
        shown(&yaml),
        "--diagram",
        shown(&diagram),
    ]);
    assert!(said.contains("color temperature") && said.contains("from 350.0 to 830.0 nm"), "{said}");
    assert!(diagram.metadata().expect("written").len() > 10_000);
    let info = json(&["spectrum", "info", shown(&yaml), "--json"]);
    let d55 = json(&["spectrum", "info", "D55", "--json"]);
    for i in 0..2 {
        assert!((number(&info["xy"][i]) - number(&d55["xy"][i])).abs() < 2e-4, "{info}");
    }
    let first = render(&scene(folder.path(), "first", &light("D55"), "kind: xyz", 256), folder.path());
    let second = scene(folder.path(), "second", &light("measured.yaml"), "kind: xyz", 256);
    good(&["run", shown(&second), "-q", "--seed", "2", "-o", shown(folder.path())]);
    // The difference must be as large as between two renders of the same light with other random numbers, and no larger.
    let again = scene(folder.path(), "again", &light("D55"), "kind: xyz", 256);
    good(&["run", shown(&again), "-q", "--seed", "2", "-o", shown(folder.path())]);
    let compared = |other: &str| json(&["picture", "compare", shown(&first), shown(&at(other)), "--json"]);
    let (by_histogram, by_noise) = (compared("second.exr"), compared("again.exr"));
    let delta_e = |of: &Value| number(&of["delta_e_2000"]["mean"]);
    println!("CIEDE2000 {} by the histogram, {} by noise", delta_e(&by_histogram), delta_e(&by_noise));
    assert!((delta_e(&by_histogram) / delta_e(&by_noise) - 1.0).abs() < 0.05, "{by_histogram} {by_noise}");
    for channel in by_histogram["channels"].as_array().expect("channels") {
        let [mean, error] = [number(&channel["relative_mean"]), number(&channel["relative_standard_error"])];
        // The second term is the noise that 2048 samples per pixel leave in the spectrum itself.
        assert!(mean.abs() < 4.0 * error + 5e-4, "{channel}");
        assert!(number(&channel["blocks_beyond_3"]) <= 1.0 / 6.0, "{channel}");
    }
    // A different light gives a clear difference.
    let other = render(&scene(folder.path(), "other", &light("A"), "kind: xyz", 256), folder.path());
    let apart = json(&["picture", "compare", shown(&first), shown(&other), "--json"]);
    assert!(number(&apart["delta_e_2000"]["mean"]) > 10.0, "{apart}");
}

/// Writes a picture with these XYZ values, 24 pixels wide.
fn picture(path: &Path, xyz: &[[f32; 3]], unit: &str) {
    let height_px = (xyz.len() / 24) as u32;
    let size = FrameSize { width_px: 24, height_px, width_mm: 24.0, height_mm: f64::from(height_px) };
    let channel = |(i, name): (usize, &str)| ExposureChannel {
        name: name.into(),
        unit: unit.into(),
        values: xyz.iter().map(|v| v[i]).collect(),
    };
    let channels = ["X", "Y", "Z"].into_iter().enumerate().map(channel).collect();
    let said = [("spectra:film size".to_owned(), format!("24 x {height_px} mm"))];
    write_exr(path, &ExposureFrame { size, channels }, &said).expect("written");
}

/// Differences of the pixels in `picture-differences.csv` agree with colour-science: mean and maximum within 1e-6.
#[test]
fn delta_e_is_that_of_colour_science() {
    let folder = tempfile::tempdir().expect("a folder");
    let table: Vec<Vec<f64>> = rows("picture-differences.csv")
        .iter()
        .map(|row| row.iter().map(|v| v.parse().expect("a number")).collect())
        .collect();
    assert_eq!(table.len(), 384);
    let xyz =
        |from: usize| -> Vec<[f32; 3]> { table.iter().map(|row| [0, 1, 2].map(|i| row[from + i] as f32)).collect() };
    let (a, b) = (folder.path().join("a.exr"), folder.path().join("b.exr"));
    picture(&a, &xyz(0), "lx");
    picture(&b, &xyz(3), "lx");
    let figure = folder.path().join("difference.svg");
    let found = json(&["picture", "compare", shown(&a), shown(&b), "--white", "1", "--json", "-o", shown(&figure)]);
    let e = &found["delta_e_2000"];
    let mean = table.iter().map(|row| row[6]).sum::<f64>() / 384.0;
    let largest = table.iter().map(|row| row[6]).fold(0.0, f64::max);
    println!("mean {} here, {mean} there", e["mean"]);
    assert!((number(&e["mean"]) - mean).abs() < 1e-6, "{e} {mean}");
    assert!((number(&e["maximum"]) - largest).abs() < 1e-6, "{e} {largest}");
    let at = table.iter().position(|row| row[6] == largest).expect("there");
    assert_eq!(e["maximum_at"], serde_json::json!([at % 24, at / 24]));
    assert!(fs::read_to_string(figure).expect("written").contains("CIEDE2000"));
    // Equal pictures have no difference.
    let same = json(&["picture", "compare", shown(&a), shown(&a), "--json"]);
    assert_eq!(number(&same["delta_e_2000"]["maximum"]), 0.0);
    assert_eq!(number(&same["channels"][0]["relative_rms"]), 0.0);
}

/// The noise of one picture is computed from the difference of two pictures with equal mean and noise.
#[test]
fn noise_is_told_from_differences() {
    let folder = tempfile::tempdir().expect("a folder");
    let (a, b) = (folder.path().join("a.exr"), folder.path().join("b.exr"));
    // The sum of 12 uniform numbers has variance 1. They come from one Lehmer generator, because an additive recurrence per term
    // would repeat.
    let mut state: u64 = 48_271;
    let mut uniform = || {
        state = state * 48_271 % 2_147_483_647;
        state as f64 / 2_147_483_647.0
    };
    let mut noisy = |share: f64| -> Vec<[f32; 3]> {
        let mut normal = || (0..12).map(|_| uniform()).sum::<f64>() - 6.0;
        (0..24 * 64).map(|_| [(10.0 * (1.0 + share * normal())) as f32; 3]).collect()
    };
    picture(&a, &noisy(0.03), "lx s");
    picture(&b, &noisy(0.03), "lx s");
    let found = json(&["picture", "compare", shown(&a), shown(&b), "--json"]);
    let y = &found["channels"][0];
    assert!((number(&y["relative_noise"]) / 0.03 - 1.0).abs() < 0.06, "{y}");
    let error = 0.03 * (2.0_f64 / (24.0 * 64.0)).sqrt();
    assert!((number(&y["relative_standard_error"]) / error - 1.0).abs() < 0.06, "{y}");
    assert!(number(&y["relative_mean"]).abs() < 4.0 * error, "{y}");
}

/// Rows, columns and lines through a ramp contain the values of its pixels, and positions in mm.
#[test]
fn cuts_hold_the_values_of_the_picture() {
    let folder = tempfile::tempdir().expect("a folder");
    let (file, table) = (folder.path().join("ramp.exr"), folder.path().join("cut.csv"));
    // A picture of 24 x 10 pixels of 1 mm in which Y is column + 100 * row.
    let xyz: Vec<[f32; 3]> = (0..240).map(|i| [0.5, (i % 24 + 100 * (i / 24)) as f32, 0.25]).collect();
    picture(&file, &xyz, "lx");
    let cut = |options: &[&str]| -> Vec<Vec<f64>> {
        let all = [&["picture", "cut", shown(&file), "-o", shown(&table)], options].concat();
        good(&all);
        let text = fs::read_to_string(&table).expect("written");
        let mut lines = text.lines();
        assert!(lines.next().expect("a head").starts_with("column,row,distance_px,distance_mm,illuminance / lx"));
        lines.map(|line| line.split(',').map(|v| v.parse().expect("a number")).collect()).collect()
    };
    let row = cut(&["--row", "3"]);
    assert_eq!(row.len(), 24);
    assert_eq!(row[5], [5.5, 3.5, 5.0, 5.0, 305.0]);
    let column = cut(&["--column", "7", "--quantity", "illuminance,X"]);
    assert_eq!((column.len(), &column[2][..]), (10, &[7.5, 2.5, 2.0, 2.0, 207.0, 0.5][..]));
    let line = cut(&["--line", "0.5,0.5,6.5,8.5"]);
    assert_eq!(line.len(), 11);
    for point in &line {
        // Interpolation between pixels is linear, so the whole line is.
        assert!((point[4] - (point[0] - 0.5 + 100.0 * (point[1] - 0.5))).abs() < 1e-9, "{point:?}");
    }
    assert!((line[10][2] - 10.0).abs() < 1e-12 && (line[10][3] - 10.0).abs() < 1e-12);
    let figure = folder.path().join("cut.svg");
    good(&["picture", "cut", shown(&file), "--row", "3", "--log", "-o", shown(&figure)]);
    assert!(fs::read_to_string(figure).expect("written").contains("distance on the film / mm"));
}

/// A picture in its own colors and as seen without one kind of cones. The published matrices (Machado, Oliveira and Fernandes 2009,
/// severity 1) act on linear sRGB; the values for red, green and a gray are computed here.
#[test]
fn a_picture_as_other_eyes_have_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("colors.exr");
    // Full red, full green and half gray in linear sRGB, as XYZ of IEC 61966-2-1.
    let colors = [[0.412_4, 0.212_6, 0.019_3], [0.357_6, 0.715_2, 0.119_2], [0.475_25, 0.5, 0.544_5]];
    let xyz: Vec<[f32; 3]> = (0..72).map(|i| colors[i % 24 / 8].map(|v| v as f32)).collect();
    picture(&file, &xyz, "lx");
    let encoded = |linear: f64| {
        let v = linear.clamp(0.0, 1.0);
        let code = if v <= 0.003_130_8 { 12.92 * v } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 };
        (255.0 * code).round() as i32
    };
    for (eye, red, green) in [
        (None, [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]),
        (Some("protan"), [0.152_286, 0.114_503, -0.003_882], [1.052_583, 0.786_281, -0.048_116]),
        (Some("deutan"), [0.367_322, 0.280_085, -0.011_820], [0.860_646, 0.672_501, 0.042_940]),
        (Some("tritan"), [1.255_528, -0.078_411, 0.004_733], [-0.076_749, 0.930_809, 0.691_367]),
    ] {
        let figure = folder.path().join("seen.png");
        let mut arguments = vec!["picture", "plot", shown(&file), "--white", "1", "-o", shown(&figure)];
        match eye {
            // Without `--quantity`, `--seen-by` shows the colors.
            Some(eye) => arguments.extend(["--seen-by", eye]),
            None => arguments.extend(["--quantity", "color"]),
        }
        good(&arguments);
        let image = image::open(&figure).expect("a picture").into_rgb8();
        for (name, wanted) in [("red", red), ("green", green), ("gray", [0.5; 3])] {
            let wanted = wanted.map(encoded);
            let near = |p: &image::Rgb<u8>| p.0.iter().zip(wanted).all(|(a, b)| (i32::from(*a) - b).abs() <= 1);
            let count = image.pixels().filter(|p| near(p)).count();
            let share = count as f64 / f64::from(image.width() * image.height());
            assert!(share > 0.05, "{eye:?} {name}: {wanted:?} is {share} of the sheet");
        }
    }
    // A false-color scale can be shown as seen by such an eye too.
    let [own, seen] = ["own.png", "seen.png"].map(|name| folder.path().join(name));
    good(&["picture", "plot", shown(&file), "--quantity", "hue", "-o", shown(&own)]);
    good(&["picture", "plot", shown(&file), "--quantity", "hue", "--seen-by", "deutan", "-o", shown(&seen)]);
    assert_ne!(fs::read(own).expect("written"), fs::read(seen).expect("written"));
}

/// Every quantity that a picture contains can be plotted; others are refused with a reason.
#[test]
fn views_show_what_a_picture_knows() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name);
    let source = format!("illuminant: FL11, luminance: {LUMINANCE} cd/m2");
    let xyz = render(&scene(folder.path(), "xyz", &source, "kind: xyz, exposure: 1/60 s", 4), folder.path());
    for quantity in ["illuminance", "exposure", "lightness", "L*", "chroma", "hue", "clipping", "color", "X"] {
        let figure = at("view.png");
        good(&["picture", "plot", shown(&xyz), "--quantity", quantity, "-o", shown(&figure)]);
        let size = fs::metadata(&figure).expect("written").len();
        assert!(size > 5_000, "{quantity}: {size} bytes");
        fs::remove_file(&figure).expect("there");
    }
    good(&["picture", "plot", shown(&xyz), "--log", "--range", "0.1,100", "-o", shown(&at("log.svg"))]);
    assert!(fs::read_to_string(at("log.svg")).expect("written").contains("illuminance"));
    let fails = |options: &[&str], words: &[&str]| {
        let output = run(&[&["picture"], options].concat());
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{options:?}: {said}");
        assert!(words.iter().all(|word| said.contains(word)), "{options:?}: {said}");
    };
    let file = shown(&xyz);
    fails(&["plot", file, "--quantity", "irradiance"], &["power by wavelength", "kind: spectral"]);
    fails(&["plot", file, "--quantity", "illuminence"], &["`illuminence`", "did you mean `illuminance`?"]);
    fails(&["plot", file, "-o", "view.jpg"], &["view.jpg"]);
    fails(&["plot", file, "--range", "3,1"], &["3,1", "two increasing numbers"]);
    fails(&["plot", "nothing.exr"], &["nothing.exr: no such file", "spectra run"]);
    fails(&["cut", file, "--row", "32"], &["row 32", "rows 0 to 31"]);
    fails(&["cut", file], &["--row"]);
    fails(&["cut", file, "--line", "0,0,100,3"], &["100, 3", "48 x 32"]);
    fails(&["cut", file, "--row", "1", "-o", "cut.txt"], &["cut.txt", ".csv"]);
    fails(&["spectrum", file, "--area", "40,0,20,20"], &["40,0,20,20", "48 x 32"]);
    fails(&["spectrum", file, "-o", "x.yaml"], &["no bands", "kind: spectral"]);
    fails(&["spectrum", file, "-o", "x.svg"], &["x.svg", ".yaml"]);
    let small = at("small.exr");
    picture(&small, &[[1.0; 3]; 48], "lx s");
    fails(&["compare", file, shown(&small)], &["48 x 32 and 24 x 2", "resolution"]);
    let lux = at("lux.exr");
    picture(&lux, &[[1.0; 3]; 48], "lx");
    fails(&["compare", shown(&lux), shown(&small)], &["the first picture is in lx", "same kind of imager"]);
    fs::write(at("torn.exr"), &fs::read(&xyz).expect("there")[..700]).expect("written");
    let torn = run(&["picture", "info", shown(&at("torn.exr"))]);
    assert_eq!(torn.status.code(), Some(2), "{}", text(&torn.stderr));
    let info = json(&["picture", "info", shown(&at("xyz.png")), "--json"]);
    assert_eq!((&info["format"], &info["colors"]), (&"PNG".into(), &"rgb".into()));
}
