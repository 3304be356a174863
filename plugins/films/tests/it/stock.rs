//! Tests of the film process `stock`, as a scene uses it.

use spectra_core::frame::{ExposureChannel, ExposureFrame, FrameSize};
use spectra_core::params::{Faults, Params};
use spectra_core::registry::{Context, Entry, Stage};
use spectra_core::resources::Resources;
use spectra_core::spectral::BAND;
use spectra_core::stage::Film;
use spectra_plugin_films::StockFilm;
use spectra_scene::FileResources;

fn with_params<T>(yaml: &str, use_them: impl FnOnce(&Params, &Context<'_>) -> T) -> T {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("film.yaml"), yaml).expect("written");
    let bare = "spectra: 1\nlike: kodak-tri-x-400\nname: Film of no known base\nbases: []\n";
    std::fs::write(folder.path().join("bare.yaml"), bare).expect("written");
    let grainless = "spectra: 1\nlike: ilford-ortho-plus\nname: Film of no known grain\ngranularity: null\n";
    std::fs::write(folder.path().join("grainless.yaml"), grainless).expect("written");
    let resources = FileResources::beside(folder.path());
    let params = resources.document("film.yaml", &[], &[]).expect("YAML");
    use_them(&params, &Context::new(&resources, BAND))
}

fn build(yaml: &str) -> Result<StockFilm, Faults> {
    with_params(yaml, StockFilm::build)
}

fn frame(values: &[f32]) -> ExposureFrame {
    let size = FrameSize { width_px: values.len() as u32, height_px: 1, width_mm: 1.0, height_mm: 1.0 };
    let channel = ExposureChannel { name: "ortho".into(), unit: "lx s".into(), values: values.to_vec() };
    ExposureFrame { size, channels: vec![channel] }
}

#[test]
fn is_registered_as_the_default() {
    let entries = <dyn Film as Stage>::entries();
    let entry: &&Entry<dyn Film> = entries.iter().find(|e| e.name == "stock").expect("registered");
    assert!(entry.default);
    let film = with_params("stock: ilford-ortho-plus\nexposure: 1/60 s\n", entry.build).map_err(|e| e.to_string());
    let film = film.expect("sound");
    assert!((film.exposure_time_s() - 1.0 / 60.0).abs() < 1e-15);
    assert_eq!(film.channels().len(), 1);
    assert_eq!(film.channels()[0].response.len(), BAND.count);
    assert!(film.describe().contains("Ilford Ortho Plus, ISO 80"));
}

/// A mid gray subject at the meter's exposure, 10/S lx s, is 18 % of the screen's white. A red patch does not expose this film, so it is as
/// black as the paper (density 2.1) with half a percent of flare. The picture is neutral.
#[test]
fn gray_is_gray_and_red_is_black() {
    let film = build("stock: ilford-ortho-plus\nexposure: 1/60 s\nscatter: false\nhalation: off\ngrain: false\n")
        .expect("sound");
    let picture = film.develop(&frame(&[0.125, 0.0, 0.125 * 5.0, 100.0])).expect("complete");
    assert!(picture.rgb.iter().all(|p| p[0] == p[1] && p[1] == p[2]));
    let [gray, black, white, burnt] = [0, 1, 2, 3].map(|i| picture.rgb[i][0]);
    assert!((gray - 0.18).abs() < 1e-5, "{gray}");
    let paper = (10_f32.powf(-2.1) + 0.005) / 1.005;
    assert!((black / paper - 1.0).abs() < 0.02, "{black} {paper}");
    assert!(white > 0.7 && white < burnt && burnt <= 1.0, "{white} {burnt}");
    // The film is not sensitive at the line of a red patch (C', 643.85 nm).
    let response = &film.channels()[0].response;
    assert_eq!(BAND.interpolate(response, 643.85), 0.0);
    assert!(BAND.interpolate(response, 546.07) > 0.0 && BAND.interpolate(response, 435.84) > 0.0);
}

#[test]
fn an_unknown_stock_is_told_with_near_names() {
    let text = build("stock: ilford-orto-plus\nexposure: 1/60 s\n").unwrap_err().to_string();
    assert!(text.contains("film.yaml:1:8:") && text.contains("did you mean `ilford-ortho-plus`?"), "{text}");
    let text = build("stock: zzz\nexposure: 1/60 s\n").unwrap_err().to_string();
    assert!(text.contains("film.yaml:1:8:") && text.contains("known: blue-sensitive-plate"), "{text}");
}

#[test]
fn parameters_are_checked() {
    for (yaml, word) in [
        ("stock: ilford-ortho-plus\n", "exposure"),
        ("stock: ilford-ortho-plus\nexposure: 0 s\n", "positive"),
        ("stock: ilford-ortho-plus\nexposure: 3 mm\n", "time"),
        ("stock: ilford-ortho-plus\nexposure: 1 s\niso: 0\n", "positive"),
        ("stock: ilford-ortho-plus\nexposure: 1 s\nasa: 3\n", "asa"),
        ("stock: ilford-ortho-plus\nexposure: 1 s\ncompensation: 1\n", "meter"),
        ("stock: ilford-ortho-plus\nexposure: 1 s\nspot: {diameter: 0.2}\n", "metering: spot"),
        ("stock: ilford-ortho-plus\nmetering: spot\nspot: {diameter: 0}\n", "up to 4"),
        ("stock: ilford-ortho-plus\nmetering: average\nview: projection\n", "negative"),
        ("stock: ilford-ortho-plus\nmetering: average\nview: scan\nprint: kodak-2302\n", "view: print"),
        ("stock: ilford-ortho-plus\nmetering: average\nprint: kodak-tri-x-400\n", "is not a print stock"),
        ("stock: ilford-ortho-plus\nmetering: average\nprint: kodak-2302\npaper: {range: 1}\n", "paper"),
        ("stock: ilford-ortho-plus\nmetering: average\npush: 3\n", "from -2 to +2 stops"),
        ("stock: kodak-tri-x-400\nmetering: average\npush: 5\n", "stops"),
        ("stock: kodak-vision-2383\nmetering: average\n", "is not a camera film"),
        ("stock: ilford-ortho-plus\nmetering: average\npaper: {grade: 6}\n", "no paper of grade 6"),
        ("stock: ilford-ortho-plus\nmetering: average\npaper: {grade: 3, range: 1.2}\n", "its own range"),
        ("stock: ilford-ortho-plus\nmetering: average\nwhite: lamp\n", "is the paper"),
        ("stock: ilford-ortho-plus\nmetering: average\nscan: log\n", "view: scan"),
        ("stock: kodak-ektachrome-100d\nmetering: average\nview: print\n", "already a positive"),
        ("stock: kodak-vision3-250d-5207\nmetering: average\nprint: kodak-2383\n", "did you mean"),
        ("stock: ilford-ortho-plus\nmetering: average\nlight: D5500\n", "did you mean `D55`?"),
        ("stock: grainless.yaml\nmetering: average\ngrain: true\n", "granularity"),
        ("stock: ilford-ortho-plus\nmetering: average\nassumed: off\nscatter: true\n", "modulation"),
        ("stock: kodak-ektachrome-100d\nmetering: average\nadjacency: true\n", "above 1"),
        ("stock: bare.yaml\nmetering: average\n", "thickness"),
        ("stock: bare.yaml\nmetering: average\nhalation: {entering: 0.2, transmittance: 0.5}\n", "thickness"),
        ("stock: kodak-tri-x-400\nmetering: average\nhalation: none\n", "known: off"),
        ("stock: kodak-tri-x-400\nmetering: average\nassumed: false\n", "off"),
        (
            "stock: ilford-ortho-plus\nmetering: average\nhalation: {entering: 20, transmittance: 0.5, index: 1.48}\n",
            "from 0 to 10",
        ),
        ("stock: ilford-ortho-plus\nexposure: 1 s\ndevelopment: lith\n", "pictorial"),
    ] {
        let text = build(yaml).unwrap_err().to_string();
        assert!(text.contains(word), "{yaml}: {text}");
    }
}

#[test]
fn a_frame_without_its_channel_is_refused() {
    let film = build("stock: ilford-ortho-plus\nexposure: 1/60 s\nhalation: off\ngrain: false\n").expect("sound");
    let mut other = frame(&[1.0]);
    other.channels[0].name = "Y".into();
    assert!(film.develop(&other).unwrap_err().message.contains("ortho"));
}

fn frame_of(names: &[&str], planes: &[Vec<f32>]) -> ExposureFrame {
    let pixels = planes[0].len() as u32;
    let size = FrameSize { width_px: pixels, height_px: 1, width_mm: f64::from(pixels), height_mm: 1.0 };
    let channel = |(name, values): (&&str, &Vec<f32>)| ExposureChannel {
        name: (*name).into(),
        unit: "lx s".into(),
        values: values.clone(),
    };
    ExposureFrame { size, channels: names.iter().zip(planes).map(channel).collect() }
}

/// A metered gray card on a plate prints as 18 % in any light, because the plate's meter has the plate's sensitivity. A photopic meter
/// would give the unsensitized plate half a stop too much in D55 and 1.3 stops too little in A. For panchromatic film it is about right;
/// the paper is soft.
#[test]
fn a_metered_gray_is_gray_on_a_plate_in_any_light() {
    for (stock, tolerance) in [("blue-sensitive-plate", 1e-4), ("panchromatic-plate", 1e-4), ("kodak-tri-x-400", 0.06)]
    {
        let settings =
            format!("stock: {stock}\nmetering: average\nhalation: off\ngrain: false\npaper: {{range: 1.6}}\n");
        let film = build(&settings).expect("sound");
        for light in ["D55", "D65", "A", "iso-7589-sensitometric-daylight"] {
            let power = spectra_spectrum::find_emission(light).expect("bundled").to_power(&BAND);
            let channels = film.channels();
            let names: Vec<&str> = channels.iter().map(|c| c.name.as_str()).collect();
            let planes: Vec<Vec<f32>> = channels.iter().map(|c| vec![power.seen_by(&c.response) as f32; 4]).collect();
            let shown = film.develop(&frame_of(&names, &planes)).expect("complete").rgb[0][0];
            println!("{stock} in {light}: {shown:.4}");
            assert!((shown - 0.18).abs() < tolerance, "{stock} in {light}: {shown}");
        }
    }
}

/// The meter gives the mean of the metered area the exposure of a mid gray, 10/S lx s. Compensation is in stops.
#[test]
fn a_metered_frame_gets_the_meters_exposure() {
    for (yaml, factor) in [
        ("stock: kodak-tri-x-400\nmetering: average\n", 0.025 / 3.0),
        ("stock: kodak-tri-x-400\nmetering: average\ncompensation: 1\n", 0.05 / 3.0),
        ("stock: kodak-tri-x-400\nmetering: average\niso: 800\n", 0.0125 / 3.0),
        // A pushed film is rated at a higher speed.
        ("stock: kodak-tri-x-400\nmetering: average\npush: 1\n", 0.0125 / 3.0),
        // The spot covers the middle one of five pixels in a row.
        ("stock: kodak-tri-x-400\nmetering: spot\nspot: {diameter: 1}\n", 0.025 / 5.0),
        ("stock: kodak-tri-x-400\nmetering: spot\nspot: {center: [0.1, 0.5], diameter: 1}\n", 0.025),
        ("stock: kodak-tri-x-400\nexposure: 1/8 s\n", 1.0),
    ] {
        let film = build(yaml).unwrap_or_else(|faults| panic!("{yaml}: {faults}"));
        let metered = yaml.contains("metering");
        let names: Vec<String> = film.channels().iter().map(|c| c.name.clone()).collect();
        assert_eq!(names.iter().any(|n| n == "meter"), metered, "{yaml}");
        let meter = vec![1.0, 2.0, 5.0, 3.0, 4.0];
        let frame = frame_of(&["panchromatic", "meter"], &[meter.clone(), meter]);
        let time_s = film.metered_time_s(&frame);
        assert!((time_s / (film.exposure_time_s() * factor) - 1.0).abs() < 1e-9, "{yaml}: {time_s}");
        let dark = frame_of(&["panchromatic", "meter"], &[vec![0.0; 5], vec![0.0; 5]]);
        assert_eq!(film.metered_time_s(&dark), film.exposure_time_s());
    }
}

/// A step wedge of exposures, developed by the film stage, lies on the stock's own curve to 1e-4 in density.
#[test]
fn a_step_wedge_through_the_stage_recovers_the_curve() {
    for name in ["kodak-tri-x-400", "kodak-double-x-5222", "ilford-ortho-plus"] {
        let plain = "scatter: false\nadjacency: false\nhalation: off\ngrain: false\n";
        let film = build(&format!("stock: {name}\nexposure: 1/60 s\n{plain}")).expect("sound");
        let layer = &film.stock().layers[0];
        let steps: Vec<f32> = (0..40).map(|i| 1e-4 * 1.3_f32.powi(i)).collect();
        let developed = film.developed(&frame_of(&[&layer.name], std::slice::from_ref(&steps))).expect("complete");
        for (h, density) in steps.iter().zip(&developed[0]) {
            let want = layer.developments[0].curve.density(f64::from(*h).log10());
            assert!((f64::from(*density) - want).abs() < 1e-4, "{name} {h}: {density} {want}");
        }
    }
}

/// Long exposures lose speed: Tri-X metered at 10 s needs 50 s (Kodak F-4017), so 50 s have the effect of 10 s.
#[test]
fn long_exposures_count_as_the_sheet_says() {
    let developed = |yaml: &str, lx_s: f32| {
        let film = build(&format!("{yaml}grain: false\n")).expect("sound");
        film.developed(&frame_of(&["panchromatic"], &[vec![lx_s]])).expect("complete")[0][0]
    };
    let long = developed("stock: kodak-tri-x-400\nexposure: 50 s\n", 0.125);
    let short = developed("stock: kodak-tri-x-400\nexposure: 1/60 s\n", 0.025);
    assert!((long - short).abs() < 1e-5, "{long} {short}");
}

/// On color film, a neutral subject at the meter's exposure becomes a neutral mid gray, on print and scan. More light on the red layer
/// alone makes it red.
#[test]
fn color_negative_prints_in_color() {
    for view in ["print", "scan"] {
        let film = build(&format!("stock: kodak-vision3-250d-5207\nexposure: 1/60 s\nview: {view}\n")).expect("sound");
        let names: Vec<String> = film.channels().iter().map(|c| c.name.clone()).collect();
        assert_eq!(names, ["blue", "green", "red"]);
        let planes = [vec![0.04, 0.02, 0.0], vec![0.04, 0.02, 0.0], vec![0.04, 0.08, 0.0]];
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let rgb = film.develop(&frame_of(&names, &planes)).expect("complete").rgb;
        assert!(rgb[0].iter().all(|v| (v - 0.18).abs() < 2e-3), "{view}: {:?}", rgb[0]);
        assert!(rgb[1][0] > 2.0 * rgb[1][1] && rgb[1][0] > 2.0 * rgb[1][2], "{view}: {:?}", rgb[1]);
        assert!(rgb[2].iter().all(|v| *v < 0.01), "{view}: {:?}", rgb[2]);
    }
}

/// A print with `grade: auto` reaches from near the paper's black to its white; a flat frame is printed as metered.
#[test]
fn an_automatic_print_is_made_for_the_frame() {
    let automatic =
        build("stock: kodak-tri-x-400\nexposure: 1/60 s\ngrain: false\nscatter: false\npaper: {grade: auto}\n");
    let metered = build("stock: kodak-tri-x-400\nexposure: 1/60 s\ngrain: false\nscatter: false\n");
    let (automatic, metered) = (automatic.expect("sound"), metered.expect("sound"));
    let shown = |film: &StockFilm, values: &[f32]| -> Vec<f32> {
        let frame = frame_of(&["panchromatic"], &[values.to_vec()]);
        film.develop(&frame).expect("complete").rgb.iter().map(|p| p[1]).collect()
    };
    let lightness = |y: f32| spectra_color::lab([f64::from(y); 3], [1.0; 3])[0];
    // An unlit border and a ramp from black to white.
    let chart: Vec<f32> = (0..1000).map(|i| if i < 100 { 0.0 } else { 0.025 * 5.0 * i as f32 / 1000.0 }).collect();
    let mut print = shown(&automatic, &chart);
    print.sort_by(f32::total_cmp);
    let (black, white) = (lightness(print[2]), lightness(print[997]));
    // By ISO 6846, a paper's exposure range ends where its density over white is nine tenths of the largest. Flare is 0.5 %.
    let range_end = lightness((10_f32.powf(-0.9 * 2.1) + 0.005) / 1.005);
    assert!((black - range_end).abs() < 0.5 && white >= 96.0, "{black} {range_end} {white}");
    let flat: Vec<f32> = (0..1000).map(|i| 0.025 * (0.9 + 0.2 * i as f32 / 1000.0)).collect();
    assert_eq!(shown(&automatic, &flat), shown(&metered, &flat));
    assert!(automatic.describe().contains("grade of paper that suits it"), "{}", automatic.describe());
    assert!(metered.describe().contains("paper of grade 2"), "{}", metered.describe());
}

fn square(side: u32, side_mm: f64, value: impl Fn(usize, usize) -> f32) -> ExposureFrame {
    let size = FrameSize { width_px: side, height_px: side, width_mm: side_mm, height_mm: side_mm };
    let n = side as usize;
    let values = (0..n * n).map(|i| value(i % n, i / n)).collect();
    ExposureFrame { size, channels: vec![ExposureChannel { name: "panchromatic".into(), unit: "lx s".into(), values }] }
}

/// A plain gray has the granularity of the data sheet within 7 %. It is read through squares of 8 x 8 pixels with the area of the 48 um
/// aperture (Selwyn: the deviation times the root of the area is constant). With 1681 squares the standard error is 1.7 %, so 7 % is four
/// standard errors.
#[test]
fn a_plain_gray_is_as_grainy_as_the_sheet_says() {
    const FINE: usize = 8;
    const SQUARES: usize = 45;
    let film = build("stock: kodak-tri-x-400\nexposure: 1/60 s\n").expect("sound");
    let clear = film.stock().layers[0].developments[0].curve.unexposed_density();
    let x = film.stock().layers[0].developments[0].curve.log10_exposure_at(clear + 1.0).expect("on the curve");
    let side_mm = 0.024 * std::f64::consts::PI.sqrt() * SQUARES as f64;
    let side = SQUARES * FINE;
    let frame = square(side as u32, side_mm, |_, _| 10_f64.powf(x) as f32);
    let plane = &film.developed(&frame).expect("complete")[0];
    let read = |row: usize, column: usize| {
        let pixels = (0..FINE * FINE).map(|i| (row * FINE + i / FINE) * side + column * FINE + i % FINE);
        pixels.map(|i| f64::from(plane[i])).sum::<f64>() / (FINE * FINE) as f64
    };
    // Squares away from the border, because the film outside the frame is unexposed.
    let inner: Vec<f64> = (2..SQUARES - 2)
        .flat_map(|row| (2..SQUARES - 2).map(move |column| (row, column)))
        .map(|(r, c)| read(r, c))
        .collect();
    let mean = inner.iter().sum::<f64>() / inner.len() as f64;
    let deviation = (inner.iter().map(|d| (d - mean) * (d - mean)).sum::<f64>() / inner.len() as f64).sqrt();
    println!("mean over fog {}, RMS {}", mean - clear, 1000.0 * deviation);
    assert!((mean - clear - 1.0).abs() < 0.005, "{mean}");
    assert!((1000.0 * deviation / 17.0 - 1.0).abs() < 0.07, "{deviation}");
    // The same piece of film has the same grain; another piece has not.
    assert_eq!(plane, &film.developed(&frame).expect("complete")[0]);
    let other = build("stock: kodak-tri-x-400\nexposure: 1/60 s\ngrain-seed: 7\n").expect("sound");
    assert_ne!(plane, &other.developed(&frame).expect("complete")[0]);
}

/// A point of light on film without backing has a ring of the radius 2 t tan(asin(1/n)) = 0.2291 mm, for 0.125 mm of index 1.48.
#[test]
fn a_point_has_its_ring() {
    let yaml = "stock: kodak-tri-x-400\nexposure: 1/60 s\ngrain: false\nscatter: false\n\
                halation: {entering: 0.5, transmittance: 1, thickness: 0.125 mm, index: 1.48}\n";
    let film = build(yaml).expect("sound");
    let frame = square(101, 1.01, |c, r| if (c, r) == (50, 50) { 1000.0 } else { 0.0 });
    let plane = &film.developed(&frame).expect("complete")[0];
    let at = |r: usize| plane[50 * 101 + 50 + r];
    // Finds the steepest rise outward; pixels are 10 um wide.
    let edge = (5..45).max_by(|a, b| (at(*a + 1) - at(*a)).total_cmp(&(at(*b + 1) - at(*b)))).expect("some");
    let radius = (edge as f64 + 0.5) * 0.01;
    println!("ring at {radius} mm");
    assert!((radius - 0.2291).abs() <= 0.01, "{radius}");
}

/// `metering: camera` is center-weighted and clips lights to eight times the median, compared with a calculation by hand. A gray frame gets
/// the same exposure as with `average`.
#[test]
fn a_camera_holds_lights_back() {
    let of = |metering: &str| build(&format!("stock: kodak-tri-x-400\nmetering: {metering}\n")).expect("sound");
    let time = |film: &StockFilm, plane: Vec<f32>| {
        film.metered_time_s(&frame_of(&["panchromatic", "meter"], &[plane.clone(), plane]))
    };
    let gray = vec![0.05; 1000];
    let [camera, average] = ["camera", "average"].map(|metering| time(&of(metering), gray.clone()));
    assert!((camera / average - 1.0).abs() < 1e-12, "{camera} {average}");
    // In a row of 1000 pixels the weights are 1/(1 + 2 x^2) for x from -1 to 1; y is 0 for the only row.
    let mut lights = vec![0.05_f32; 1000];
    lights[..20].fill(50.0);
    let weight = |i: usize| {
        let x = 2.0 * (i as f64 + 0.5) / 1000.0 - 1.0;
        1.0 / (1.0 + 2.0 * x * x)
    };
    let all: f64 = (0..1000).map(weight).sum();
    let mean = (0..1000).map(|i| weight(i) * if i < 20 { 0.4 } else { 0.05 }).sum::<f64>() / all;
    let found = time(&of("camera"), lights);
    assert!((found * mean / (10.0 / 400.0) - 1.0).abs() < 1e-6, "{found}");
}

/// `exposure: metered` switches the camera's meter on. It may be combined with any metering mode except `manual`.
#[test]
fn metered_is_a_word_for_the_exposure() {
    let of = |text: &str| build(&format!("stock: kodak-tri-x-400\n{text}"));
    let word = of("exposure: metered\n").expect("sound");
    assert!(word.keeps_exposure() && word.meter() == Some("camera") && word.is_metered());
    let spot = of("exposure: metered\nmetering: spot\n").expect("sound");
    assert!(!spot.keeps_exposure() && spot.meter() == Some("spot") && spot.warnings().is_empty());
    let stated = of("exposure: 1/60 s\n").expect("sound");
    assert!(!stated.keeps_exposure() && stated.meter().is_none());
    let both = of("exposure: metered\nmetering: manual\n").expect_err("both").to_string();
    assert!(both.contains("by hand"), "{both}");
}

/// The black of paper is kept or stretched. Film in a dark surround looks lighter and softer than its density. Scans have neither setting.
#[test]
fn blacks_and_surrounds_are_chosen() {
    let shown = |text: &str, lx_s: f32| {
        let film =
            build(&format!("exposure: 1/60 s\ngrain: false\nscatter: false\nhalation: off\n{text}")).expect("sound");
        let names: Vec<String> = film.channels().iter().map(|c| c.name.clone()).collect();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        film.develop(&frame_of(&names, &vec![vec![lx_s; 9]; names.len()])).expect("complete").rgb[4][1]
    };
    for (paper, lx_s) in [("stock: kodak-tri-x-400\n", 0.0), ("stock: kodak-portra-400\n", 0.0)] {
        assert!(shown(paper, lx_s) > 0.008, "{paper}");
        assert!(shown(&format!("{paper}black: stretched\n"), lx_s) < 1e-4, "{paper}");
    }
    let slide = |surround: &str| shown(&format!("stock: kodak-ektachrome-100d\nsurround: {surround}\n"), 0.03);
    let [dark, dim, average] = ["dark", "dim", "average"].map(slide);
    let exponent = |shown: f32| f64::from(shown).ln() / f64::from(average).ln();
    assert!(
        (exponent(dark) - 0.525 / 0.69).abs() < 0.02 && (exponent(dim) - 0.59 / 0.69).abs() < 0.02,
        "{dark} {dim} {average}"
    );
    for (text, word) in [
        ("stock: kodak-tri-x-400\nsurround: dark\n", "lit room"),
        ("stock: kodak-portra-400\nsurround: dim\n", "lit room"),
        ("stock: kodak-tri-x-400\nview: scan\nblack: stretched\n", "prints and projections"),
    ] {
        let text = build(&format!("exposure: 1/60 s\n{text}")).expect_err(text).to_string();
        assert!(text.contains(word), "{text}");
    }
}
