//! Tests `include`, `variables`, `sweep` and `animation`: several pictures of one scene, and one scene from several files.

use crate::common::{good, repository, run, shown, spectra, text};
use exr::prelude::{ReadChannels, ReadLayers};
use serde_json::Value;
use spectra_core::numbers::seed_of_frame;
use spectra_core::params::Length;
use spectra_plugins as _;
use spectra_scene::load_series;
use std::collections::BTreeMap;
use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::Stdio;

/// A small variant of the main scene: 48 x 32 pixels, 4 samples each.
const SMALL: &str = "include: biotar-ortho\nimager: {resolution: [48, 32]}\nrender: {samples: 4}\n";

/// Writes files into a new temporary folder.
fn files(all: &[(&str, &str)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, text) in all {
        let path = folder.path().join(name);
        std::fs::create_dir_all(path.parent().expect("a parent")).expect("a folder");
        std::fs::write(path, text).expect("written");
    }
    folder
}

/// Renders `scene.yaml` of a folder into another folder inside it.
fn rendered(folder: &Path, out: &str, more: &[&str]) -> PathBuf {
    let out = folder.join(out);
    let scene = folder.join("scene.yaml");
    let arguments = ["run", shown(&scene), "--quiet", "--output", shown(&out)];
    good(&[&arguments, more].concat());
    out
}

fn json(path: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(path).expect("a file")).expect("JSON")
}

fn bytes(path: &Path) -> Vec<u8> {
    std::fs::read(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// In a sweep over lenses, a lens that does not reach the f-number is used wide open, with a warning; outside of a sweep it is
/// refused.
#[test]
fn a_sweep_over_lenses_goes_on_wide_open() {
    let sweep =
        format!("{SMALL}lens: {{f-number: f/1.5}}\nsweep:\n  lens.file: [zeiss-biotar-50-f1.4, helios-44-58-f2]\n");
    let folder = files(&[("scene.yaml", &sweep)]);
    let series = load_series(&folder.path().join("scene.yaml"), &[]).unwrap_or_else(|faults| panic!("{faults}"));
    let scenes = [0, 1].map(|i| series.scene(i).unwrap_or_else(|faults| panic!("{faults}")));
    let f_number = |i: usize| scenes[i].lens.marginal_ray().expect("open").f_number();
    assert!((f_number(0) - 1.5).abs() < 1e-6 && (f_number(1) - 2.046).abs() < 1e-3, "{} {}", f_number(0), f_number(1));
    let told = |i: usize| scenes[i].warnings.iter().filter(|w| w.0.message.contains("wide open")).count();
    assert_eq!((told(0), told(1)), (0, 1), "{:?}", scenes[1].warnings);
    let alone =
        load_series(&folder.path().join("scene.yaml"), &["sweep=null".into(), "lens.file=helios-44-58-f2".into()]);
    let alone = alone.unwrap_or_else(|faults| panic!("{faults}"));
    assert!(alone.scene(0).is_err_and(|faults| faults.to_string().contains("is faster than the lens")));
}

/// Returns the bits of all channels of an EXR file, and its text attributes.
fn exr(path: &Path) -> (BTreeMap<String, Vec<u32>>, BTreeMap<String, String>) {
    let reader = exr::prelude::read().no_deep_data().largest_resolution_level().all_channels().first_valid_layer();
    let image = reader.all_attributes().from_file(path).expect("an EXR");
    let channels = image.layer_data.channel_data.list.iter();
    let bits = channels.map(|c| (c.name.to_string(), c.sample_data.values_as_f32().map(f32::to_bits).collect()));
    let all = image.layer_data.attributes.other.iter().filter_map(|(name, value)| match value {
        exr::meta::attribute::AttributeValue::Text(text) => Some((name.to_string(), text.to_string())),
        _ => None,
    });
    (bits.collect(), all.collect())
}

fn rgb(path: &Path) -> image::RgbImage {
    image::open(path).expect("a picture").into_rgb8()
}

/// Returns where one picture lies inside another with identical pixels.
fn found_in(sheet: &image::RgbImage, picture: &image::RgbImage) -> Option<(u32, u32)> {
    let (width, height) = picture.dimensions();
    let row = |of: &image::RgbImage, x: u32, y: u32| (0..width).map(|i| of.get_pixel(x + i, y).0).collect::<Vec<_>>();
    let first = row(picture, 0, 0);
    let places = (0..=sheet.height() - height).flat_map(|y| (0..=sheet.width() - width).map(move |x| (x, y)));
    places
        .filter(|&(x, y)| sheet.get_pixel(x, y).0 == first[0] && row(sheet, x, y) == first)
        .find(|&(x, y)| (1..height).all(|j| row(sheet, x, y + j) == row(picture, 0, j)))
}

#[test]
fn a_picture_of_a_sweep_is_that_of_the_scene_with_its_values_set() {
    let folder = files(&[
        (
            "scene.yaml",
            &format!(
                "{SMALL}sweep:\n  film.stock: [ilford-ortho-plus, kodak-tri-x-400]\n  lens.f-number: [f/2, f/5.6]\n"
            ),
        ),
        ("plain.yaml", SMALL),
    ]);
    let out = rendered(folder.path(), "out", &[]);
    let report = json(&out.join("scene-series.json"));
    assert_eq!((&report["kind"], &report["count"], &report["complete"]), (&"sweep".into(), &4.into(), &true.into()));
    let pictures = report["pictures"].as_array().expect("a list");
    let sheet = rgb(&out.join("scene-contact.png"));
    let mut places = Vec::new();
    for (at, picture) in pictures.iter().enumerate() {
        let [stock, f_number] = [["ilford-ortho-plus", "kodak-tri-x-400"][at / 2], ["f/2", "f/5.6"][at % 2]];
        assert_eq!(picture["values"], serde_json::json!({ "film.stock": stock, "lens.f-number": f_number }));
        assert_eq!((&picture["number"], &picture["rays"]), (&(at + 1).into(), &(48 * 32 * 4).into()));
        let name = format!("scene-{:03}", at + 1);
        let plain = folder.path().join("plain.yaml");
        let alone = folder.path().join(&name);
        let [stock, f_number] = [format!("film.stock={stock}"), format!("lens.f-number={f_number}")];
        good(&["run", shown(&plain), "-q", "-o", shown(&alone), "--set", &stock, "--set", &f_number]);
        let member = exr(&out.join(format!("{name}.exr")));
        assert!(member.0 == exr(&alone.join("plain.exr")).0, "{name}");
        let png = out.join(format!("{name}.png"));
        assert!(bytes(&png) == bytes(&alone.join("plain.png")), "{name}");
        assert_eq!(member.1["spectra:picture"], format!("{} of 4", at + 1));
        assert!(
            picture["files"]
                .as_array()
                .expect("a list")
                .iter()
                .all(|f| Path::new(f.as_str().expect("a path")).is_file())
        );
        // A picture this small appears unchanged in its cell.
        places.push(found_in(&sheet, &rgb(&png)).unwrap_or_else(|| panic!("{name} is not on the sheet")));
    }
    let [a, b, c, d] = places[..] else { panic!("four") };
    assert!(a.1 == b.1 && c.1 == d.1 && a.0 == c.0 && b.0 == d.0 && a.0 < b.0 && a.1 < c.1, "{places:?}");
}

/// The focus moves evenly in reciprocal distance from 1 m to 3 m: half way it is 2 / (1/1 + 1/3) = 1.5 m.
#[test]
fn a_focus_pull_records_each_frames_focus_and_a_frame_alone_is_the_same() {
    let animation = "animation:\n  frames: 3\n  rate: 23.976\n  animate:\n    lens.focus: {1: 1 m, 3: 3 m, interpolation: reciprocal}\n";
    let folder = files(&[("scene.yaml", &format!("{SMALL}{animation}"))]);
    let out = rendered(folder.path(), "out", &[]);
    let report = json(&out.join("scene-series.json"));
    assert_eq!((&report["kind"], &report["frames_per_second"]), (&"animation".into(), &23.976.into()));
    for (at, wanted_mm) in [1000.0, 1500.0, 3000.0].into_iter().enumerate() {
        let recorded = &report["pictures"][at];
        let focus = recorded["values"]["lens.focus"].as_str().expect("a value").to_owned();
        let read = |text: &str| <Length as spectra_core::params::Quantity>::from_text(text).expect("a length").mm();
        assert!((read(&focus) - wanted_mm).abs() < 1e-9 * wanted_mm, "{focus}");
        let path = out.join(format!("scene.{:04}.exr", at + 1));
        let attributes = exr(&path).1;
        assert!(attributes["spectra:scene"].contains(&format!("focus: {focus}")), "{}", attributes["spectra:scene"]);
        assert_eq!(attributes["spectra:values"], format!("lens.focus = {focus}"));
        let meta = exr::meta::MetaData::read_from_file(&path, true).expect("readable");
        assert_eq!(meta.headers[0].own_attributes.frames_per_second, Some((24000, 1001)));
    }
    let alone = rendered(folder.path(), "alone", &["--frames", "2"]);
    let names: Vec<String> = std::fs::read_dir(&alone)
        .expect("a folder")
        .map(|e| e.expect("an entry").file_name().into_string().expect("plain"))
        .collect();
    assert_eq!(names.len(), 3, "{names:?}");
    for name in ["scene.0002.exr", "scene.0002.png"] {
        assert!(bytes(&out.join(name)) == bytes(&alone.join(name)), "{name}");
    }
}

/// In a shot whose light grows fourfold, the camera meters the first frame for all frames, whichever frames are requested.
#[test]
fn an_animation_is_metered_on_its_first_frame() {
    let film = "film: {exposure: null, metering: average}\n";
    let animation = "animation: {frames: 3, animate: {source.luminance: {1: 100 cd/m2, 3: 400 cd/m2}}}\n";
    let folder = files(&[("scene.yaml", &format!("{SMALL}{film}{animation}"))]);
    let times = |out: &Path, film: &str| -> Vec<f64> {
        let report = json(&out.join("scene-series.json"));
        let pictures = report["pictures"].as_array().expect("pictures").clone();
        pictures.iter().map(|p| p[film].as_f64().unwrap_or_else(|| panic!("{p}"))).collect()
    };
    let locked = rendered(folder.path(), "locked", &[]);
    let first = times(&locked, "exposure_time_s");
    assert!(first.len() == 3 && first.iter().all(|t| *t == first[0]), "{first:?}");
    let each = rendered(folder.path(), "each", &["--set", "film.meter=each"]);
    let own = times(&each, "exposure_time_s");
    assert!((own[0] / own[2] - 4.0).abs() < 0.1, "{own:?}");
    assert!((own[0] / first[0] - 1.0).abs() < 0.01, "{own:?} {first:?}");
    // A single frame is exposed as in the shot.
    let alone = rendered(folder.path(), "alone", &["--frames", "3"]);
    let name = "scene.0003.png";
    assert_eq!(bytes(&alone.join(name)), bytes(&locked.join(name)));
    // A film set by a variable is locked to the first frame as well.
    let shared =
        format!("{SMALL}variables: {{own: {{stock: ilford-ortho-plus, metering: average}}}}\nfilm: $own\n{animation}");
    let folder = files(&[("scene.yaml", &shared)]);
    let shared = times(&rendered(folder.path(), "out", &[]), "exposure_time_s");
    assert!(shared.iter().all(|t| *t == first[0]), "{shared:?} {first:?}");
    // If the meter itself is animated, each frame is metered.
    let pulled = format!("{SMALL}{film}animation: {{frames: 2, animate: {{film.compensation: {{1: 0, 2: 1}}}}}}\n");
    let folder = files(&[("scene.yaml", &pulled)]);
    let two = times(&rendered(folder.path(), "out", &[]), "exposure_time_s");
    assert!((two[1] / two[0] - 2.0).abs() < 0.05, "{two:?}");
}

/// A frame is the same whether or not its picture with depth was read before. The lens was once focused in the mean light of the
/// picture if it had been read, and in white light otherwise.
#[test]
fn a_frame_of_a_picture_with_depth_alone_is_the_same() {
    let small = "include: focus-pull\nimager: {resolution: [36, 24]}\nrender: {samples: 4, reflections: {order: 0}}\n";
    let folder = files(&[("scene.yaml", small)]);
    let [both, alone] = ["1-2", "2"].map(|frames| rendered(folder.path(), frames, &["--frames", frames]));
    for name in ["scene.0002.exr", "scene.0002.png"] {
        assert!(bytes(&both.join(name)) == bytes(&alone.join(name)), "{name}");
    }
}

/// The scene recorded in an EXR file is a valid scene and makes the same picture.
#[test]
fn the_record_of_a_frame_makes_it_again() {
    let folder = files(&[(
        "scene.yaml",
        &format!(
            "{SMALL}variables: {{far: 3 m, all: {{stock: kodak-tri-x-400, exposure: '1/${{n}} s'}}, n: 250}}\nfilm: $all\n\
             animation: {{frames: 9, animate: {{lens.focus: {{1: 1 m, 9: $far}}}}}}\n"
        ),
    )]);
    let out = rendered(folder.path(), "out", &["--frames", "4"]);
    let (bits, attributes) = exr(&out.join("scene.0004.exr"));
    let record = &attributes["spectra:scene"];
    assert!(record.contains("1/250 s") && record.contains("frame: 4") && !record.contains('$'), "{record}");
    std::fs::write(folder.path().join("again.yaml"), record).expect("written");
    let again = folder.path().join("again");
    good(&["run", shown(&folder.path().join("again.yaml")), "-q", "-o", shown(&again)]);
    assert!(exr(&again.join("again.exr")).0 == bits);
    assert!(bytes(&again.join("again.png")) == bytes(&out.join("scene.0004.png")));
}

/// Each frame has its own noise and grain, or the same for all frames if the seed is fixed; this includes the noise of a sensor.
#[test]
fn frames_have_noise_and_grain_of_their_own() {
    // Pixels of 0.75 mm collect much light, so the light is dim enough to fill no well.
    let sensor = "include: biotar-ortho\nsource: {luminance: 0.02 cd/m2}\nfilm: null\nimager: {kind: sensor, format: 135, resolution: [48, 32], exposure: 1/60 s}\nrender: {samples: 4}\n";
    for (scene, name) in [(SMALL, "film"), (sensor, "sensor")] {
        let folder = files(&[("scene.yaml", &format!("{scene}animation: {{frames: 2}}\n"))]);
        let each = rendered(folder.path(), "each", &[]);
        let fixed = rendered(folder.path(), "fixed", &["--set", "animation.seed=fixed"]);
        let bits = |out: &Path, frame: u32| exr(&out.join(format!("scene.{frame:04}.exr"))).0;
        let png = |out: &Path, frame: u32| bytes(&out.join(format!("scene.{frame:04}.png")));
        assert!(bits(&each, 1) != bits(&each, 2) && png(&each, 1) != png(&each, 2), "{name}");
        assert!(bits(&fixed, 1) == bits(&fixed, 2) && png(&fixed, 1) == png(&fixed, 2), "{name}");
    }
    // Only the grain, for constant light.
    let light = |set: &[String]| {
        let path = repository("scenes/biotar-trix.yaml");
        let set = [&["imager.resolution=[48, 32]".to_owned()], set].concat();
        load_series(&path, &set).and_then(|series| series.scene(0)).unwrap_or_else(|faults| panic!("{faults}"))
    };
    let frames: Vec<_> = [None, Some(1), Some(2)]
        .map(|f| f.map(|f| format!("render.frame={f}")))
        .into_iter()
        .map(|f| light(f.as_slice()))
        .collect();
    let size = frames[0].imager.size();
    let plane = |c: &spectra_core::spectral::Channel| spectra_core::frame::ExposureChannel {
        name: c.name.clone(),
        unit: c.unit.clone(),
        values: vec![0.02; size.pixels()],
    };
    let exposure =
        spectra_core::frame::ExposureFrame { size, channels: frames[0].channels.iter().map(plane).collect() };
    let shown: Vec<_> =
        frames.iter().map(|scene| scene.films[0].film.develop(&exposure).expect("a picture").rgb).collect();
    assert!(shown[0] != shown[1] && shown[1] != shown[2] && shown[0] != shown[2]);
}

/// Seeds derived from neighboring frames and seeds are independent: all differ, and on average by half of their bits.
#[test]
fn seeds_of_frames_are_far_from_each_other() {
    let all: Vec<u64> = (0..40).flat_map(|seed| (0..250).map(move |frame| seed_of_frame(seed, frame))).collect();
    let mut sorted = all.clone();
    sorted.sort_unstable();
    sorted.dedup();
    assert_eq!(sorted.len(), all.len());
    let differing: u32 = all.windows(2).map(|w| (w[0] ^ w[1]).count_ones()).sum();
    let pairs = (all.len() - 1) as f64;
    // Of 64 fair bits, 32 differ on average with a standard deviation of 4. The bound is 4 standard errors.
    assert!((f64::from(differing) / pairs - 32.0).abs() < 4.0 * 4.0 / pairs.sqrt(), "{differing}");
    assert_ne!(seed_of_frame(1, 2), seed_of_frame(2, 1));
}

/// Returns all faults of `scene.yaml`: place, message and hint.
fn faults(all: &[(&str, &str)], more: &[&str]) -> Vec<String> {
    let folder = files(all);
    let scene = folder.path().join("scene.yaml");
    let output = run(&[&["check", "--json", shown(&scene)], more].concat());
    let said: Value = serde_json::from_slice(&output.stdout).unwrap_or_else(|_| panic!("{}", text(&output.stderr)));
    let found = said["scenes"][0]["faults"].as_array().expect("a list").clone();
    assert_eq!(output.status.code(), Some(if found.is_empty() { 0 } else { 2 }));
    let at = |f: &Value| {
        let name = f["file"].as_str().map_or("-", |name| name.rsplit('/').next().unwrap_or(name));
        let hint = f["hint"].as_str().map_or(String::new(), |hint| format!(" ({hint})"));
        format!("{name}:{}: {}{hint}", f["line"], f["message"].as_str().expect("a text"))
    };
    found.iter().map(at).collect::<Vec<_>>().into_iter().map(|f| f.replace(shown(folder.path()), "")).collect()
}

#[test]
fn faults_are_told_where_the_value_was_written() {
    let base = "spectra: 1\ninclude: biotar-ortho\nrender:\n  samples: 2 kg\nvariables: {stop: 2 s}\n";
    let found = faults(
        &[
            ("scene.yaml", "include: sub/base.yaml\nlens: {f-number: $stop}\nsource: {distanc: 2 m}\n"),
            ("sub/base.yaml", base),
        ],
        &[],
    );
    let wanted = ["scene.yaml:3: unknown key `distanc`", "base.yaml:4: ", "base.yaml:5: found a time"];
    for wanted in wanted {
        assert!(found.iter().any(|f| f.starts_with(wanted)), "{wanted}: {found:?}");
    }
    assert!(found.iter().any(|f| f.contains("the value of `$stop`, used at /scene.yaml:2:18")), "{found:?}");
    // Overriding the included variable removes that fault and no other.
    let healed = faults(
        &[("scene.yaml", "include: base.yaml\nlens: {f-number: $stop}\nvariables: {stop: f/4}\n"), ("base.yaml", base)],
        &["--set", "render.samples=4"],
    );
    assert_eq!(healed, Vec::<String>::new());
    let set = faults(
        &[("scene.yaml", "include: base.yaml\nlens: {f-number: $stop}\n"), ("base.yaml", base)],
        &["--set", "render.samples=4", "--set", "variables.stop=-4"],
    );
    assert!(set.len() == 1 && set[0].contains("--set variables.stop=-4:"), "{set:?}");
}

#[test]
fn every_member_is_checked_before_any_light_is_traced() {
    let scene =
        format!("{SMALL}sweep: {{lens.f-number: [f/2, 3 s, f/0.1], film.stock: [ilford-ortho-plus, nothing]}}\n");
    let found = faults(&[("scene.yaml", &scene)], &[]);
    assert!(
        found.iter().any(|f| f.starts_with("scene.yaml:4: found a time")
            && f.contains("picture 3 (lens.f-number = 3 s, film.stock = ilford-ortho-plus) and 1 more")),
        "{found:?}"
    );
    assert!(found.iter().any(|f| f.contains("f/0.1") && f.contains("picture 5")), "{found:?}");
    assert!(found.iter().any(|f| f.contains("`nothing`") && f.contains("picture 2")), "{found:?}");
    assert_eq!(found.len(), 3, "{found:?}");
    // A fault shared by all members is reported once, and `run` reports the same and renders nothing.
    let folder =
        files(&[("scene.yaml", &format!("{SMALL}film: {{exposure: 2 m}}\nsweep: {{lens.f-number: [f/2, f/4]}}\n"))]);
    let out = folder.path().join("out");
    let output = run(&["run", shown(&folder.path().join("scene.yaml")), "--json", "-o", shown(&out)]);
    assert_eq!((output.status.code(), out.exists()), (Some(2), false));
    let events = text(&output.stdout);
    // On a busy machine the check takes long enough to report its progress.
    let faulty: Vec<&str> = events.lines().filter(|line| !line.contains("\"event\":\"check\"")).collect();
    assert_eq!(faulty.len(), 1, "{events}");
    let event: Value = serde_json::from_str(faulty[0]).expect("JSON");
    assert_eq!(event["faults"].as_array().map(Vec::len), Some(1), "{events}");
}

#[test]
fn limits_and_what_does_not_go_together_are_told() {
    let sweep = "sweep: {render.seed: {from: 0, to: 50, steps: 51}, lens.f-number: {from: 2, to: 4, steps: 20}}\n";
    for (more, arguments, said) in [
        (sweep, &[][..], "the sweep has 1020 pictures, but at most 1000 can be made"),
        ("sweep: {a: [1]}\nanimation: {frames: 2}\n", &[], "a scene can have a sweep or an animation, not both"),
        ("animation: {frames: 100000}\n", &[], "found 100000, which is out of range"),
        ("animation: {frames: 3}\n", &["--frames", "2-9"], "there is no frame 9; the animation has the frames 1 to 3"),
        ("sweep: {render.seed: [1]}\n", &["--frames", "1"], "this scene has a `sweep`, not an `animation`"),
        ("", &["--frames", "1"], "--frames: this scene is one picture"),
        ("", &["--skip-existing"], "--skip-existing: this scene is one picture"),
        ("variables: {seed: $sed}\nrender: {seed: $seed}\n", &[], "no variable is called `sed`"),
        ("include: [biotar-ortho, scene.yaml]\n", &[], "`scene.yaml` includes itself"),
        ("swep: {a: [1]}\n", &[], "did you mean `sweep`?"),
    ] {
        let body =
            if more.starts_with("include") || more.contains("render:") { "include: biotar-ortho\n" } else { SMALL };
        let body = if more.starts_with("include") { "" } else { body };
        let folder = files(&[("scene.yaml", &format!("{body}{more}"))]);
        let out = folder.path().join("out");
        let output = run(&[&["run", shown(&folder.path().join("scene.yaml")), "-o", shown(&out)], arguments].concat());
        let stderr = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{more}: {stderr}");
        let words = stderr.split_whitespace().filter(|w| *w != "\u{2502}").collect::<Vec<_>>().join(" ");
        assert!(words.contains(said), "{said}: {stderr}");
        assert!(!out.exists());
    }
}

#[test]
fn warnings_name_what_has_no_effect() {
    let folder = files(&[(
        "scene.yaml",
        &format!(
            "{SMALL}variables: {{apertur: f/2, stop: f/4}}\nlens: {{f-number: $stop}}\nanimation: {{frames: 2, animate: {{lens.focus: {{1: 1 m, 9: 2 m}}}}}}\n"
        ),
    )]);
    let scene = folder.path().join("scene.yaml");
    let output = run(&["check", shown(&scene), "--set", "lens.focus=3 m"]);
    let (stdout, stderr) = (text(&output.stdout), text(&output.stderr));
    assert!(stdout.ends_with("scene.yaml: good, 2 pictures\n"), "{stdout}{stderr}");
    for said in [
        "the variable `apertur` is not used",
        "`--set lens.focus` has no effect: the animation sets it for each picture",
        "keyframe 9 of `lens.focus` is outside the frames 1 to 2",
    ] {
        assert!(stderr.contains(said), "{said}: {stderr}");
    }
    assert!(!stderr.contains("`stop`"), "{stderr}");
}

/// When a scene includes another, a stage of one kind takes nothing over from another kind, even if one kind is the unnamed default.
#[test]
fn included_stages_merge_by_kind() {
    let base = "include: biotar-ortho\nimager: {resolution: [48, 32]}\n";
    for (over, is_good) in [
        // `stock` is the default kind.
        ("film: {kind: stock, exposure: 1/30 s}\n", true),
        ("film: {exposure: 1/30 s}\n", true),
        ("film: {kind: three-strip, exposure: 1/4 s}\n", true),
        ("film: null\nimager: {kind: xyz, format: 135, resolution: [48, 32]}\n", true),
        // Nothing remains of the included imager, not even its format.
        ("film: null\nimager: {kind: xyz}\n", false),
        ("imager: {kind: film}\n", true),
    ] {
        let found = faults(&[("scene.yaml", &format!("include: base.yaml\n{over}")), ("base.yaml", base)], &[]);
        assert_eq!(found.is_empty(), is_good, "{over}: {found:?}");
    }
}

/// Files are searched next to the scene, then next to the files that it includes, in order.
#[test]
fn files_lie_beside_the_scene_or_beside_what_it_includes() {
    let copy = |folder: &Path| {
        std::fs::create_dir_all(folder).expect("a folder");
        std::fs::copy(repository("scenes/depth-still-life.exr"), folder.join("own.exr")).expect("copied");
    };
    let still = std::fs::read_to_string(repository("scenes/depth-still-life.yaml")).expect("there");
    let still = still.replace("depth-still-life.exr", "own.exr");
    let folder = files(&[
        ("scene.yaml", "include: [sub/a.yaml, sub/deep/still.yaml]\n"),
        ("sub/a.yaml", "render: {samples: 1}\n"),
        ("sub/deep/still.yaml", &still),
    ]);
    let load = || {
        load_series(&folder.path().join("scene.yaml"), &[])
            .and_then(|s| s.scene(0))
            .map(|s| s.source.describe())
            .map_err(|f| f.to_string())
    };
    let missing = load().expect_err("there is no such file");
    assert!(missing.contains("still.yaml") && missing.contains("`own.exr`"), "{missing}");
    copy(&folder.path().join("sub/deep"));
    load().unwrap_or_else(|faults| panic!("{faults}"));
    // A file next to the scene comes first, even if it is broken.
    std::fs::write(folder.path().join("own.exr"), "no picture").expect("written");
    assert!(load().is_err());
    let stock = load_series(
        &folder.path().join("scene.yaml"),
        &["film={stock: nowhere.yaml, exposure: 1 s}".to_owned(), "imager={kind: film, format: 135}".to_owned()],
    );
    let said = stock.and_then(|s| s.scene(0)).map(|_| ()).expect_err("no such stock").to_string();
    assert!(said.contains("(looked in ") && said.contains("sub/deep"), "{said}");
}

#[test]
fn a_scene_for_one_picture_is_wanted_where_only_one_is_taken() {
    let folder = files(&[("scene.yaml", &format!("{SMALL}sweep: {{render.seed: [1, 2]}}\n"))]);
    let path = folder.path().join("scene.yaml");
    let said = spectra_scene::load(&path, &[]).map(|_| ()).expect_err("two pictures").to_string();
    assert!(said.contains("makes 2 pictures") && said.contains("--set sweep=null"), "{said}");
    assert!(spectra_scene::load(&path, &["sweep=null".to_owned()]).is_ok());
}

#[test]
fn finished_frames_are_left_out_only_when_asked() {
    let folder = files(&[("scene.yaml", &format!("{SMALL}animation: {{frames: 3}}\n"))]);
    let out = rendered(folder.path(), "out", &[]);
    let wanted: Vec<Vec<u8>> = (1..=3).map(|f| bytes(&out.join(format!("scene.{f:04}.exr")))).collect();
    std::fs::remove_file(out.join("scene.0002.png")).expect("removed");
    std::fs::write(out.join("scene.0003.exr"), "kept as it is").expect("written");
    let scene = folder.path().join("scene.yaml");
    let events = good(&["run", shown(&scene), "-o", shown(&out), "--json", "--skip-existing"]);
    let events: Vec<Value> = events.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
    let numbers = |name: &str| {
        events.iter().filter(|e| e["event"] == name).filter_map(|e| e["number"].as_u64()).collect::<Vec<_>>()
    };
    assert_eq!((numbers("kept"), numbers("start")), (vec![1, 3], vec![2]));
    assert_eq!(bytes(&out.join("scene.0003.exr")), b"kept as it is");
    let report = json(&out.join("scene-series.json"));
    assert_eq!(report["pictures"].as_array().map(Vec::len), Some(3));
    assert!(report["pictures"][0]["kept"] == true && report["pictures"][0]["rays"] == 48 * 32 * 4, "{report}");
    rendered(folder.path(), "out", &[]);
    assert!(wanted[2] == bytes(&out.join("scene.0003.exr")) && wanted[1] == bytes(&out.join("scene.0002.exr")));
}

/// Stages that many frames share are built once, but every frame is checked.
#[test]
fn a_fault_in_one_frame_of_a_hundred_is_found() {
    let film = format!("{SMALL}film: {{stock: kodak-tri-x-400, exposure: null, metering: average}}\n");
    let animation = "animation:\n  frames: 100\n  animate:\n    lens.focus: {1: 1 m, 100: 3 m}\n    \
                     lens.f-number: {1: f/2, 76: f/4, 77: f/1, 78: f/4, 100: f/8}\n";
    let folder = files(&[("scene.yaml", &format!("{film}{animation}"))]);
    let output = run(&["check", shown(&folder.path().join("scene.yaml"))]);
    assert_eq!(output.status.code(), Some(2));
    let said = text(&output.stderr);
    assert!(said.contains("faster than the lens") && said.contains("frame 77"), "{said}");
    assert!(!said.contains("more"), "{said}");
}

#[cfg(unix)]
#[test]
fn ctrl_c_keeps_the_pictures_that_are_finished() {
    let folder = files(&[("scene.yaml", &format!("{SMALL}sweep: {{render.samples: [4, 4000000, 8]}}\n"))]);
    let out = folder.path().join("out");
    let mut child = spectra()
        .args(["run", shown(&folder.path().join("scene.yaml")), "--output", shown(&out), "--json"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    let mut events = BufReader::new(child.stdout.take().expect("piped"));
    let mut line = String::new();
    while !(line.contains("\"progress\"") && line.contains("\"number\":2")) {
        line.clear();
        assert!(events.read_line(&mut line).expect("UTF-8") > 0, "ended before the second picture");
    }
    assert!(line.contains("\"pictures\":3"), "{line}");
    let killed = std::process::Command::new("sh").args(["-c", &format!("kill -INT {}", child.id())]).status();
    assert!(killed.expect("a shell").success());
    let mut rest = String::new();
    events.read_to_string(&mut rest).expect("UTF-8");
    assert_eq!(child.wait().expect("it ends").code(), Some(130));
    assert!(rest.contains("\"interrupted\":true"), "{rest}");
    let mut names: Vec<String> = std::fs::read_dir(&out)
        .expect("a folder")
        .map(|e| e.expect("an entry").file_name().into_string().expect("plain"))
        .collect();
    names.sort();
    assert_eq!(names, ["scene-001.exr", "scene-001.png", "scene-contact.png", "scene-series.json"]);
    let report = json(&out.join("scene-series.json"));
    assert_eq!((&report["complete"], report["pictures"].as_array().map(Vec::len)), (&false.into(), Some(1)));
}
