//! Tests names, lists and hints: what the program tells a person to write works when it is written.
//!
//! Examples of `--help` and hints are run in an empty folder, like that of a person with an installed program.

use crate::common::{answer_in, good, repository, run, run_in, shown, spectra, text, together};
use serde_json::Value;
use spectra_core::frame::{ExposureChannel, ExposureFrame, FrameSize};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Returns the standard error of a run that must fail.
fn refused(arguments: &[&str]) -> String {
    let folder = tempfile::tempdir().expect("a folder");
    let output = answer_in(folder.path(), arguments);
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {}{}", text(&output.stdout), text(&output.stderr));
    text(&output.stderr)
}

#[test]
fn bundled_scenes_run_from_anywhere_under_every_name() {
    let folder = tempfile::tempdir().expect("a folder");
    for name in ["gray-card", "scenes/gray-card.yaml", "./scenes/gray-card", "Gray_Card", "gray-c"] {
        let small = ["--samples", "1", "--set", "imager.resolution=[48, 32]", "-o", "pictures"];
        let output = run_in(folder.path(), &[&["run", name][..], &small].concat());
        assert!(output.status.success(), "{name}: {}", text(&output.stderr));
        let file = folder.path().join("pictures/gray-card.png");
        assert!(file.is_file(), "{name}");
        fs::remove_dir_all(folder.path().join("pictures")).expect("removed");
    }
    assert!(refused(&["check", "biotar"]).contains("which one? `biotar-"));
    assert!(refused(&["check", "kodak-tri-x-400"]).contains("is a film stock"));
}

/// A hint never repeats what the user typed.
#[test]
fn no_hint_suggests_what_was_typed() {
    for typed in
        ["scenes/biotar-orto", "scenes/biotar-orto.yaml", "biotar-orto", "gray-crad.yaml", "scenes/nothing-like-it"]
    {
        let said = refused(&["run", typed]);
        assert!(said.contains("help: ") && !said.contains(&format!("did you mean `{typed}`")), "{said}");
        let Some((_, rest)) = said.split_once("did you mean `") else { continue };
        let meant = rest.split('`').next().expect("a name");
        let folder = tempfile::tempdir().expect("a folder");
        let output = answer_in(folder.path(), &["check", meant]);
        assert!(output.status.success(), "{typed} -> {meant}: {}", text(&output.stderr));
    }
}

#[test]
fn parts_of_names_are_enough() {
    for arguments in [
        &["lens", "info", "helios"][..],
        &["lens", "info", "Biotar 50"],
        &["film", "info", "Tri-X"],
        &["film", "info", "5207"],
        &["spectrum", "info", "d 65"],
        &["spectrum", "info", "5600 K"],
        &["spectrum", "info", "blackbody:2000K"],
        &["spectrum", "info", "line:632.8 nm"],
        &["check", "gray-card", "--set", "lens.file=helios", "--set", "lens.focus=2 m"],
        &["check", "biotar-ortho", "--set", "film.stock=tri-x"],
        &["check", "biotar-ortho", "--set", "source.illuminant=5600K"],
    ] {
        let output = run(arguments);
        assert!(output.status.success(), "{arguments:?}: {}", text(&output.stderr));
    }
    for (arguments, word) in [
        (&["lens", "info", "canon"][..], "canon-35-f1.8"),
        (&["lens", "info", "tri-x"], "`kodak-tri-x-400` is a film stock"),
        (&["film", "info", "helios"], "`helios-44-58-f2` is a lens"),
        (&["film", "info", "kodak"], "which one? "),
        (&["spectrum", "info", "helios"], "`helios-44-58-f2` is a lens"),
        (&["film", "info", "delta-3200"], "known: "),
        (&["run", "helios"], "is a lens"),
    ] {
        let said = refused(arguments);
        assert!(said.contains(word), "{arguments:?}: {said}");
    }
}

/// A color temperature means a black body below 5000 K and daylight from 5000 K on: CIE 13.3.
#[test]
fn color_temperatures_are_lights() {
    let of = |name: &str| {
        let report: Value = serde_json::from_str(&good(&["spectrum", "info", name, "--json"])).expect("JSON");
        report["xy"].to_string()
    };
    assert_eq!([of("3200K"), of("5600 K")], [of("blackbody:3200"), of("daylight:5600")]);
}

#[test]
fn lists_have_the_words_that_one_chooses_by() {
    for (arguments, words) in [
        (&["list", "lens"][..], &["helios-44-58-f2", "58 mm", "f/2.0", "1958", "deg", "Helios-44 58 mm f/2"][..]),
        (&["list", "lenses", "100"], &["zeiss-biotar-100-f1.4"]),
        (&["list", "stock"], &["kodak-tri-x-400", "ISO 400", "black-and-white negative", "1954", "print stock\n"]),
        (&["list", "scene"], &["biotar-ortho", "A resolution chart", "surfaces/zernike"]),
        (&["list", "spectrum", "wratten"], &["wratten-12", "transmittance"]),
        (&["list", "glass", "BK7"], &["SCHOTT/N-BK7", "nd 1.5168", "Vd 64.1"]),
        (&["list", "coating"], &["bare", "ideal", "stack"]),
        (&["list", "sensor"], &["nikon-d5100", "#red"]),
        (&["list", "format"], &["135", "36 x 24 mm", "super-35"]),
    ] {
        let said = good(arguments);
        for word in words {
            assert!(said.contains(word), "{arguments:?} lacks `{word}`:\n{said}");
        }
    }
    let lenses = good(&["list", "lens", "50"]);
    assert!(!lenses.contains("helios"), "{lenses}");
    let stocks = good(&["list", "stock"]);
    let (camera, print) = stocks.split_once("print stock\n").expect("print stocks form a group of their own");
    assert!(print.contains("kodak-vision-2383") && !camera.contains("kodak-vision-2383"), "{stocks}");
    let stocks: Value = serde_json::from_str(&good(&["list", "stock", "--json"])).expect("JSON");
    let tri_x = stocks.as_array().expect("a list").iter().find(|s| s["name"] == "kodak-tri-x-400").expect("there");
    assert_eq!((tri_x["iso"].as_f64(), tri_x["year"].as_u64()), (Some(400.0), Some(1954)));
    let lenses: Value = serde_json::from_str(&good(&["list", "lens", "--json"])).expect("JSON");
    for lens in lenses.as_array().expect("a list") {
        let keys = ["focal_length_mm", "f_number", "field_deg", "year"];
        assert!(keys.iter().all(|key| lens.get(key).is_some()), "{lens}");
    }
}

#[test]
fn any_key_has_its_page() {
    for (name, words) in [
        ("render", &["render.samples", "render.seed"][..]),
        ("output", &["rays", "exr"]),
        ("focus", &["lens.focus", "lens.focus.by"]),
        ("f-number", &["lens.f-number"]),
        ("film.exposure", &["film/stock", "exposure"]),
        ("halation", &["halation"]),
        ("lens.coating.layer", &["Refractive index of the layer", "1 to 5"]),
        ("film/stock", &["push"]),
    ] {
        let said = good(&["doc", name]);
        for word in words {
            assert!(said.contains(word), "{name} lacks `{word}`:\n{said}");
        }
    }
    let halo = good(&["doc", "--search", "halo"]);
    assert!(halo.contains("film/stock") || halo.contains("stock  halation"), "{halo}");
    assert!(refused(&["doc", "rendr"]).contains("did you mean `render`?"));
    let json: Value = serde_json::from_str(&good(&["doc", "film.exposure", "--json"])).expect("JSON");
    assert!(json["found"].as_array().is_some_and(|found| !found.is_empty()), "{json}");
}

/// A page describes each key only once.
#[test]
fn pages_do_not_repeat_themselves() {
    for page in ["scene", "lens", "surface", "stock", "film/stock"] {
        let said = good(&["doc", page]);
        // Examples contain keys again.
        let said = said.split("\nExample\n").next().unwrap_or_default();
        let keys =
            said.lines().filter(|l| l.starts_with("  ") && !l.starts_with("   ")).filter_map(|l| l.split_once(": "));
        let mut seen: BTreeMap<&str, usize> = BTreeMap::new();
        for (key, _) in keys {
            *seen.entry(key.trim()).or_default() += 1;
        }
        let twice: Vec<_> =
            seen.iter().filter(|(key, n)| **n > 1 && !key.contains(' ') && **key != "spectra").collect();
        assert!(twice.is_empty(), "{page}: {twice:?}");
        assert!(said.matches("The layers, the one next to the air first.").count() <= 1, "{page}");
    }
}

/// Every column of every bundled spectrum can be listed and plotted.
#[test]
fn every_bundled_spectrum_can_be_shown() {
    let list: Value = serde_json::from_str(&good(&["list", "spectrum", "--json"])).expect("JSON");
    let mut names: Vec<String> = Vec::new();
    // The list also has the kinds of spectra, which have documentation.
    for item in list.as_array().expect("a list").iter().filter(|item| item["documentation"].is_null()) {
        let name = item["name"].as_str().expect("a name");
        match item["columns"].as_array().expect("a list").as_slice() {
            [] => names.push(name.to_owned()),
            columns => names.extend(columns.iter().map(|c| format!("{name}#{}", c.as_str().expect("a name")))),
        }
    }
    assert!(names.len() > 130 && names.contains(&"cie-rgb-1931#r".to_owned()), "{} spectra", names.len());
    let folder = tempfile::tempdir().expect("a folder");
    for name in &names {
        let output = answer_in(folder.path(), &["spectrum", "info", name]);
        assert!(output.status.success(), "{name}: {}", text(&output.stderr));
    }
    for some in names.chunks(24) {
        let mut arguments = vec!["spectrum", "plot", "-o", "all.svg"];
        arguments.extend(some.iter().map(String::as_str));
        let output = answer_in(folder.path(), &arguments);
        assert!(output.status.success(), "{some:?}: {}", text(&output.stderr));
    }
    println!("{} bundled spectra are shown", names.len());
}

#[test]
fn tables_are_read_as_people_have_them() {
    let folder = tempfile::tempdir().expect("a folder");
    let same = [
        ("plain.csv", "wavelength_nm,power\n400,0.5\n500,1\n600,0.25\n"),
        ("no-header.csv", "400,0.5\n500,1\n600,0.25\n"),
        ("other-header.csv", "wavelength,value\n400,0.5\n500,1\n600,0.25\n"),
        ("semicolons.csv", "nm;power\n400;0,5\n500;1\n600;0,25\n"),
        ("blanks.txt", "400 0.5\n500 1\n600 0.25\n"),
        ("tabs.dat", "nm\tpower\n400\t0,5\n500\t1\n600\t0,25\n"),
        ("micrometers.csv", "um,power\n0.4,0.5\n0.5,1\n0.6,0.25\n"),
        ("falling.txt", "600 0.25\n500 1\n400 0.5\n"),
    ];
    let mut first: Option<Value> = None;
    for (name, content) in same {
        fs::write(folder.path().join(name), content).expect("written");
        let output = answer_in(folder.path(), &["spectrum", "info", name, "--json"]);
        assert!(output.status.success(), "{name}: {}", text(&output.stderr));
        let report: Value = serde_json::from_str(&text(&output.stdout)).expect("JSON");
        let xyz = report["xyz"].clone();
        assert_eq!(*first.get_or_insert(xyz.clone()), xyz, "{name}");
        let told = text(&output.stderr);
        match name {
            "falling.txt" => assert!(told.contains("falling wavelengths"), "{told}"),
            "micrometers.csv" => assert!(told.contains("wavelengths in micrometers"), "{told}"),
            "plain.csv" | "tabs.dat" => assert!(told.is_empty(), "{told}"),
            _ => {}
        }
    }
    fs::write(folder.path().join("paint.csv"), "nm,paint,other\n400,0.2,0.1\n700,0.6,0.1\n").expect("written");
    let output = answer_in(folder.path(), &["spectrum", "info", "paint.csv#paint", "--as", "reflectance"]);
    assert!(output.status.success() && text(&output.stdout).contains(": reflectance"), "{}", text(&output.stdout));
    assert!(!text(&output.stdout).contains("cd/m2"), "{}", text(&output.stdout));
    assert!(text(&output.stdout).contains("rises to 700 nm and stays there"), "{}", text(&output.stdout));
    assert!(good(&["spectrum", "info", "blackbody:20"]).contains("too little"));
}

#[test]
fn words_that_are_no_commands_have_one_behind_them() {
    for (typed, hint) in [
        ("scene.yaml", "did you mean `spectra run scene.yaml`?"),
        ("render", "did you mean `spectra run SCENE`?"),
        ("licenses", "did you mean `spectra --licenses`?"),
        ("helios", "did you mean `spectra lens info helios-44-58-f2`?"),
    ] {
        let said = refused(&[typed]);
        assert!(said.contains(hint), "{said}");
    }
    for (arguments, word) in [
        (&["run", "a.yaml", "--samples", "0"][..], "expected a whole number from 1 to 4194304"),
        (&["run", "a.yaml", "--samples", "abc"], "expected a whole number from 1 to 4194304"),
    ] {
        let said = refused(arguments);
        assert!(said.contains(word), "{said}");
    }
}

/// A word that has no page leads to a command that explains it.
#[test]
fn words_of_photographers_lead_somewhere() {
    let words = "tri-x helios D55 gray-card bokeh dof fov sequence overscan alpha z-depth ghosts starburst vignetting \
                 distortion asa shutter-speed darkroom lut aces raw anamorphic tilt-shift denoise cryptomatte gel";
    for word in words.split(' ') {
        let said = refused(&["doc", word]).replace("\n        ", " ");
        let command = said.split("see `spectra ").nth(1).and_then(|rest| rest.split('`').next());
        let command: Vec<&str> = command.unwrap_or_else(|| panic!("{word}: {said}")).split(' ').collect();
        assert!(!good(&command).is_empty(), "{word}: {command:?}");
    }
    assert!(refused(&["doc", "BK7"]).contains("`spectra list glass BK7`"));
}

/// The list begins with the kinds of entries and their numbers.
#[test]
fn the_list_begins_with_kinds_and_counts() {
    let list = good(&["list"]);
    let head: Vec<Vec<&str>> = list.lines().skip(1).take(7).map(|line| line.split_whitespace().collect()).collect();
    for (line, kind) in head.iter().zip(["scene", "lens", "stock", "spectrum", "glass", "sensor", "format"]) {
        assert!(
            line[0] == kind && line[1].parse::<u32>().is_ok_and(|n| n > 0) && line[2..] == ["spectra", "list", kind],
            "{list}"
        );
    }
    assert!(!good(&["list", "lens"]).contains("spectra list"));
}

/// A request that belongs to another command, or is written wrongly, is answered with what to write.
#[test]
fn slips_of_the_command_line_are_told_with_what_to_write() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("foma.csv"), "nm,S\n400,1\n500,2\n").expect("written");
    for (arguments, words) in [
        (&["check", "--set", "film.stock", "tri-x", "gray-card"][..], "write `--set film.stock=tri-x`"),
        (&["run", "gray-card", "--set", "film.stock", "tri-x"], "write `--set film.stock=tri-x`"),
        (&["check", "gray-card", "--set", "film.stock"], "`--set film.stock=VALUE`"),
        (&["film", "info", "foma.csv"], "`spectra new film foma`"),
        (&["film", "info", "cinestill-50d"], "did you mean `cinestill-800t`?"),
        (&["film", "info", "delta-3200"], "`spectra new film NAME`"),
        (&["film", "info", "fomapan-100"], "the nearest are"),
        (&["film", "develop", "a.png", "--stock", "tri-x", "--frames", "1..3"], "'plate.####.exr'"),
        (&["film", "develop", "a.png", "--stock", "tri-x", "--filter", "yellow"], "lens.filters=[wratten-12]"),
        (&["bench", "gray-card", "--samples", "1..64"], "such as 1,4,16,64"),
        (&["info", "tri-x"], "`spectra film info kodak-tri-x-400`"),
        (&["develop", "a.png"], "`spectra film develop a.png --stock tri-x`"),
    ] {
        let output = run_in(folder.path(), arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        let said = text(&output.stderr).replace("\n        ", " ");
        assert!(said.contains(words), "{arguments:?}: {said}");
    }
    let said = text(&run_in(folder.path(), &["film", "info", "fomapan"]).stderr);
    assert!(said.contains("fuji-c200") && !said.contains("kodak-2302") && !said.contains("paper"), "{said}");
}

#[test]
fn completions_and_man_page_know_every_command() {
    let bash = good(&["completions", "bash"]);
    let man = good(&["man"]);
    for command in ["run", "check", "view", "list", "doc", "lens", "film", "bench", "spectrum", "glass", "new", "build"]
    {
        assert!(bash.contains(command), "{command}");
        assert!(man.contains(&format!("SPECTRA {}", command.to_uppercase())), "{command}");
    }
}

/// A figure is written to NAME.svg if no file is given.
#[test]
fn figures_have_a_name_of_their_own() {
    let folder = tempfile::tempdir().expect("a folder");
    for (arguments, file) in [
        (&["lens", "draw", "helios-44-58-f2", "--rays", "1"][..], "helios-44-58-f2.svg"),
        (&["film", "plot", "kodak-tri-x-400"], "kodak-tri-x-400.svg"),
        (&["spectrum", "plot", "cie-rgb-1931#r"], "cie-rgb-1931-r.svg"),
    ] {
        let output = run_in(folder.path(), arguments);
        assert!(output.status.success(), "{arguments:?}: {}", text(&output.stderr));
        assert!(folder.path().join(file).is_file(), "{file}");
    }
}

/// Collects all commands, each as the words after `spectra`.
fn commands(of: &[String], found: &mut Vec<Vec<String>>) {
    let arguments: Vec<&str> = of.iter().map(String::as_str).chain(["--help"]).collect();
    let help = good(&arguments);
    found.push(of.to_vec());
    let Some((_, list)) = help.split_once("\nCommands:\n") else { return };
    for line in list.lines().take_while(|line| line.starts_with("  ")) {
        let Some(name) = line.split_whitespace().next().filter(|name| *name != "help") else { continue };
        if line.starts_with("   ") {
            continue;
        }
        commands(&[of, &[name.to_owned()]].concat(), found);
    }
}

/// Examples that this test leaves out, and why.
const LEFT_OUT: [(&str, &str); 2] = [
    ("spectra build ", "compiles for minutes; the test of the guide covers it"),
    ("./spectra-mine ", "the program that `spectra build` makes"),
];

/// Writes an EXR like one of a user: channels with units, brighter to the right and from channel to channel.
fn own_picture(path: &Path, [width_px, height_px]: [u32; 2], channels: Vec<(String, &str)>) {
    let size = FrameSize { width_px, height_px, width_mm: 36.0, height_mm: 24.0 };
    let values = |at: usize| (0..size.pixels()).map(|i| (at + 1) as f32 + (i as u32 % width_px) as f32).collect();
    let channel = |(at, (name, unit)): (usize, (String, &str))| ExposureChannel {
        name,
        unit: unit.to_owned(),
        values: values(at),
    };
    let channels = channels.into_iter().enumerate().map(channel).collect();
    spectra_pictures::write::write_exr(path, &ExposureFrame { size, channels }, &[]).expect("written");
}

/// Runs the examples of every `--help`, in two parts.
#[test]
#[cfg(unix)]
fn every_example_of_the_help_of_films_and_spectra_works() {
    let done = examples_work(is_of_films_and_spectra);
    assert!(done >= 15, "{done} examples");
}

#[test]
#[cfg(unix)]
fn every_other_example_of_the_help_works() {
    let done = examples_work(|example| !is_of_films_and_spectra(example));
    assert!(done >= 15, "{done} examples");
}

fn is_of_films_and_spectra(example: &str) -> bool {
    ["spectra film ", "spectra spectrum "].iter().any(|start| example.starts_with(start))
}

/// Runs examples of the help with a shell in one empty folder that contains the files that the examples name. Returns how many were
/// run.
#[cfg(unix)]
fn examples_work(is_asked: impl Fn(&str) -> bool) -> usize {
    let folder = tempfile::tempdir().expect("a folder");
    let mut all = Vec::new();
    commands(&[], &mut all);
    let mut examples: Vec<String> = Vec::new();
    for command in &all {
        for flag in ["-h", "--help"] {
            let arguments: Vec<&str> = command.iter().map(String::as_str).chain([flag]).collect();
            let help = good(&arguments);
            let lines = help.lines().map(str::trim);
            let started =
                lines.clone().filter_map(|l| l.strip_prefix("Start with: ")).map(|l| l.split(" (").next().unwrap_or(l));
            for line in lines.filter(|l| l.starts_with("spectra ") || l.starts_with("./spectra")).chain(started) {
                // Skip usage lines.
                if !line.contains("...") && !line.contains("<COMMAND>") && !examples.iter().any(|known| known == line) {
                    examples.push(line.to_owned());
                }
            }
        }
    }
    let own = |name: &str, content: &str| fs::write(folder.path().join(name), content).expect("written");
    own("rays.csv", "x_mm,y_mm,z_mm,l,m,n\n0,1,-10,0,0,1\n");
    own(
        "melt.csv",
        "wavelength_nm,n\n404.66,1.53024\n435.83,1.52668\n486.13,1.52238\n546.07,1.51872\n587.56,1.51680\n656.27,1.51432\n706.52,1.51289\n",
    );
    fs::copy(repository("crates/glass/tests/data/forms.agf"), folder.path().join("old-glasses.agf")).expect("copied");
    let photo = image::RgbImage::from_fn(48, 32, |x, y| image::Rgb([(5 * x) as u8, (7 * y) as u8, 90]));
    photo.save(folder.path().join("photo.jpg")).expect("written");
    fs::create_dir(folder.path().join("plates")).expect("made");
    photo.save(folder.path().join("plates/plate.0001.png")).expect("written");
    own_picture(&folder.path().join("a.exr"), [240, 160], ["X", "Y", "Z"].map(|name| (name.to_owned(), "lx")).to_vec());
    fs::copy(folder.path().join("a.exr"), folder.path().join("b.exr")).expect("written");
    let bands = (0..8).map(|i| (format!("S0.{},0nm", 425 + 50 * i), "W.m^-2.nm^-1"));
    own_picture(&folder.path().join("spectral.exr"), [60, 40], bands.collect());
    let exported = run_in(folder.path(), &["lens", "export", "tessar-50-f4.5", "-o", "tessar.zmx"]);
    assert!(exported.status.success(), "{}", text(&exported.stderr));
    let program = Path::new(env!("CARGO_BIN_EXE_spectra")).parent().expect("a folder").to_owned();
    let path = std::env::join_paths(
        std::iter::once(program).chain(std::env::split_paths(&std::env::var_os("PATH").unwrap_or_default())),
    );
    let path = path.expect("a path");
    let mut done = 0;
    for example in &examples {
        if !is_asked(example) || LEFT_OUT.iter().any(|(start, _)| example.starts_with(start)) {
            continue;
        }
        if let Some(rest) = example.strip_prefix("spectra view ") {
            viewed(folder.path(), rest);
            done += 1;
            continue;
        }
        let short = match example {
            // A full picture takes a minute, a small one seconds.
            run if run.starts_with("spectra run ") => format!("{run} --set imager.resolution=[48,32]"),
            // Only one of the named scenes, and small.
            noise if noise.starts_with("spectra bench noise ") => {
                let scenes = |word: &str| word.starts_with("bench/noise-") && word != "bench/noise-flat";
                let words: Vec<&str> = noise.split(' ').filter(|word| !scenes(word)).collect();
                format!("{} --seeds 2 --seconds 1 --set imager.resolution=[96,54]", words.join(" "))
            }
            // Fits of many terms take seconds.
            terms if terms.starts_with("spectra spectrum ") => {
                terms.replace("--terms 6", "--terms 3").replace("--terms 8", "--terms 3")
            }
            // Few pixels need few rays.
            ghosts if ghosts.starts_with("spectra bench ghosts ") => {
                format!("{ghosts} --set imager.resolution=[96,64]")
            }
            other => other.clone(),
        };
        let mut shell = Command::new("sh");
        shell.args(["-c", &short]).current_dir(folder.path()).env("PATH", &path);
        let begun = std::time::Instant::now();
        let output = shell.env_remove("SPECTRA_ISA").stdin(Stdio::null()).output().expect("a shell");
        assert!(output.status.success(), "{example}: {}", text(&output.stderr));
        println!("{:5.1} s  {short}", begun.elapsed().as_secs_f64());
        done += 1;
    }
    println!("{done} examples of --help work; left out: {LEFT_OUT:?}");
    done
}

/// Starts the viewer with these arguments, and stops it once it has printed its address.
#[cfg(unix)]
fn viewed(folder: &Path, arguments: &str) {
    let all = ["view"].into_iter().chain(arguments.split(' ').filter(|word| *word != "--no-open")).chain(["--no-open"]);
    let mut command = spectra();
    command.args(all).current_dir(folder).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().expect("the program starts");
    let mut line = String::new();
    let read =
        std::io::BufRead::read_line(&mut std::io::BufReader::new(child.stdout.take().expect("piped")), &mut line);
    child.kill().expect("it runs until it is ended");
    let ended = child.wait_with_output().expect("it ended");
    read.expect("a line");
    assert!(line.starts_with("http://127.0.0.1:") && line.contains("/?token="), "{arguments}: {}", text(&ended.stderr));
}

/// A fault or a warning: its message, its place, the number of underlined letters, and its hint.
#[derive(Clone)]
struct Told {
    message: String,
    place: (String, usize, usize),
    letters: usize,
    hint: String,
}

impl Told {
    /// Returns the quoted text after "did you mean".
    fn meant(&self) -> Option<&str> {
        self.hint.split_once("did you mean `")?.1.split('`').next()
    }
}

fn place(text: &str) -> Option<(String, usize, usize)> {
    let mut parts = text.rsplitn(3, ':');
    let number = |part: Option<&str>| part.and_then(|n| n.parse::<usize>().ok());
    let (column, line) = (number(parts.next())?, number(parts.next())?);
    Some((parts.next()?.to_owned(), line, column))
}

/// Parses a fault as `tests/broken` records it.
fn told(said: &str) -> Option<Told> {
    let message = said.lines().find_map(|l| l.trim_start().strip_prefix("\u{d7} "))?.to_owned();
    let place = place(said.lines().find_map(|l| l.trim_start().strip_prefix("\u{256d}\u{2500}["))?.strip_suffix(']')?)?;
    let underline =
        said.lines().find(|l| l.trim_start().starts_with('\u{b7}') && l.contains(['\u{252c}', '\u{25b2}']))?;
    let letters = underline.chars().filter(|c| matches!(c, '\u{2500}' | '\u{252c}' | '\u{25b2}')).count();
    let (_, hint) = said.split_once("  help: ")?;
    let hint: Vec<&str> = hint.split("\nerror: ").next()?.split_whitespace().collect();
    Some(Told { message, place, letters, hint: hint.join(" ") })
}

/// Parses the warnings that `tests/warned` records.
fn warned(said: &str) -> Vec<Told> {
    let of = |text: &str| {
        let (line, hint) = text.split_once("\n  help: ")?;
        let (at, message) = line.split_once(": ")?;
        Some(Told { message: message.to_owned(), place: place(at)?, letters: 0, hint: hint.trim().to_owned() })
    };
    said.split("warning: ").filter_map(of).collect()
}

/// Returns the recorded texts of a folder with their names.
fn recorded(root: &Path) -> Vec<(String, String)> {
    let mut texts: Vec<PathBuf> = fs::read_dir(root).expect("a folder").map(|e| e.expect("readable").path()).collect();
    texts.retain(|path| path.extension().is_some_and(|ending| ending == "txt"));
    texts.sort();
    let named = |path: PathBuf| {
        let name = path.file_stem().and_then(|s| s.to_str()).expect("plain names").to_owned();
        (name, fs::read_to_string(&path).expect("text"))
    };
    texts.into_iter().map(named).collect()
}

/// Copies a case to a temporary folder; returns the folder and the arguments of the case.
fn copied(root: &Path, name: &str) -> (tempfile::TempDir, Vec<String>) {
    let folder = tempfile::tempdir().expect("a folder");
    let case = root.join(name);
    let own = if case.is_dir() { case.clone() } else { root.to_owned() };
    for entry in fs::read_dir(&own).expect("a folder") {
        let from = entry.expect("readable").path();
        let is_of_case = case.is_dir() || from.file_stem().is_some_and(|stem| stem == name) || !is_case(&from);
        if from.is_file() && is_of_case {
            fs::copy(&from, folder.path().join(from.file_name().expect("a name"))).expect("copied");
        }
    }
    let arguments = fs::read_to_string(case.join("args"));
    let whole = if case.is_dir() { "check\nscene.yaml".to_owned() } else { format!("check\n{name}.yaml") };
    let arguments = arguments.unwrap_or(whole);
    (folder, arguments.lines().filter(|l| !l.starts_with('#')).map(str::to_owned).collect())
}

fn is_case(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending == "yaml" || ending == "txt")
}

fn said_in(folder: &Path, arguments: &[String]) -> String {
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    text(&answer_in(folder, &words).stderr)
}

/// Returns a file with one line changed.
fn with_line(content: &str, number: usize, change: impl Fn(&str) -> String) -> String {
    let line = |(i, text): (usize, &str)| if i + 1 == number { change(text) } else { text.to_owned() };
    content.lines().enumerate().map(line).collect::<Vec<_>>().join("\n") + "\n"
}

/// Returns a line with `letters` characters from a column on replaced.
fn replaced(line: &str, column: usize, letters: usize, by: &str) -> String {
    let head: String = line.chars().take(column - 1).collect();
    let tail: String = line.chars().skip(column - 1 + letters).collect();
    format!("{head}{by}{tail}")
}

/// Every recorded "did you mean" works: written in place of the underlined text, it removes the fault.
#[test]
fn every_recorded_did_you_mean_works() {
    let root = repository("tests/broken");
    let mut done = 0;
    for (name, said) in recorded(&root) {
        // Of several faults only the first with such a hint is tried, which shows that the word can be written.
        let mut all = said.split("\n\n").filter_map(told);
        let Some(told) = all.find(|told| told.meant().is_some()).filter(|told| !told.place.0.starts_with("--")) else {
            continue;
        };
        let (folder, arguments) = copied(&root, &name);
        let (file, line, column) = &told.place;
        let file = folder.path().join(file);
        let Ok(content) = fs::read_to_string(&file) else { continue };
        let meant = told.meant().expect("filtered");
        fs::write(&file, with_line(&content, *line, |text| replaced(text, *column, told.letters, meant)))
            .expect("written");
        let now = said_in(folder.path(), &arguments);
        assert!(!now.contains(&told.message), "{name}: `{meant}` does not help:\n{now}");
        done += 1;
    }
    assert!(done >= 15, "{done} hints");
    println!("{done} recorded hints `did you mean` work");
}

/// A change that a hint proposes for the text between its backquotes.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Change {
    /// Add this key, or this bracket.
    Add,
    /// Leave this key out.
    Remove,
    /// Write this value, or this key with its value.
    Write,
    /// Run this command.
    Run,
}

/// Returns the first change of a file that a hint proposes, and all commands in the hint.
fn proposed(hint: &str) -> Vec<(Change, &str)> {
    let mut found: Vec<(Change, &str)> = Vec::new();
    let parts: Vec<&str> = hint.split('`').collect();
    for at in (1..parts.len()).step_by(2) {
        let (before, quoted, after) = (parts[at - 1], parts[at], parts.get(at + 1).unwrap_or(&""));
        let is_open = quoted.contains("...")
            || quoted == "key: value"
            || quoted.split([' ', '/']).any(|w| w.len() > 2 && w.chars().all(|c| c.is_ascii_uppercase()));
        let is_pair = quoted.split_once(": ").is_some_and(|(key, _)| is_key(key));
        let change = match () {
            () if quoted.starts_with("spectra ") => Change::Run,
            () if before.ends_with("add ") => Change::Add,
            () if before.ends_with("leave out ") || (before.ends_with("leave ") && after.starts_with(" out")) => {
                Change::Remove
            }
            () if is_pair && !before.ends_with("scene: ") && !before.ends_with("under ") => Change::Write,
            () if ["write ", "as in ", "brackets: ", "mean "].iter().any(|word| before.ends_with(word)) => {
                Change::Write
            }
            () => continue,
        };
        if !is_open && (change == Change::Run || found.iter().all(|(other, _)| *other == Change::Run)) {
            found.push((change, quoted));
        }
    }
    found
}

fn is_key(word: &str) -> bool {
    !word.is_empty() && word.chars().all(|c| c.is_ascii_lowercase() || c == '-' || c.is_ascii_digit())
}

/// Returns where the value that starts at a character of a line ends: at its closing bracket, or before the end of a plain value.
fn value_end(line: &[char], start: usize) -> usize {
    let mut depth = 0_usize;
    for (at, c) in line.iter().enumerate().skip(start) {
        match c {
            '{' | '[' => depth += 1,
            '}' | ']' if depth == 0 => return at,
            '}' | ']' => depth -= 1,
            ',' if depth == 0 => return at,
            '#' if depth == 0 && at > 0 && line[at - 1] == ' ' => return at - 1,
            _ => {}
        }
    }
    line.len()
}

/// Returns the start of a key in a line, and the start and end of its value, in characters.
fn entry(line: &[char], key: &str) -> Option<(usize, usize, usize)> {
    let wanted: Vec<char> = format!("{key}:").chars().collect();
    let is_start = |at: usize| at == 0 || matches!(line[at - 1], ' ' | '{' | ',');
    let at = (0..line.len()).find(|&at| is_start(at) && line[at..].starts_with(&wanted))?;
    let mut start = at + wanted.len();
    while line.get(start) == Some(&' ') {
        start += 1;
    }
    Some((at, start, value_end(line, start)))
}

/// Returns the file with the proposed change, or `None` if the change has no place in it.
fn changed(content: &str, told: &Told, change: Change, text: &str) -> Option<String> {
    let (_, number, column) = &told.place;
    let line: Vec<char> = content.lines().nth(number - 1)?.chars().collect();
    let joined = |parts: &[&[char]]| parts.concat().into_iter().collect::<String>();
    let put = |new: String| Some(with_line(content, *number, |_| new.clone()));
    let key = text.split_once(": ").map(|(key, _)| key).filter(|key| is_key(key));
    let letters: Vec<char> = text.chars().collect();
    if change == Change::Remove {
        let (at, _, mut end) = entry(&line, text)?;
        while line.get(end).is_some_and(|c| matches!(c, ',' | ' ')) {
            end += 1;
        }
        return put(joined(&[&line[..at], &line[end..]]).replace(", }", "}"));
    }
    let Some(key) = key else {
        let at = (column - 1).min(line.len());
        if change == Change::Add {
            return put(joined(&[&line, &letters]));
        }
        let end = if told.letters > 0 { at + told.letters } else { value_end(&line, at) };
        return put(joined(&[&line[..at], &letters, &line[end.min(line.len())..]]));
    };
    // A section of the scene replaces the existing one, or becomes a new line.
    if ["spectra", "source", "lens", "imager", "film", "output"].contains(&key) && !line.starts_with(&[' ']) {
        let head = format!("{key}:");
        if content.lines().any(|line| line.starts_with(&head)) {
            let lines = content.lines().map(|line| if line.starts_with(&head) { text } else { line });
            return Some(lines.collect::<Vec<_>>().join("\n") + "\n");
        }
        return Some(if key == "spectra" { format!("{text}\n{content}") } else { format!("{content}\n{text}\n") });
    }
    if let Some((at, _, end)) = entry(&line, key) {
        return put(joined(&[&line[..at], &letters, &line[end..]]));
    }
    let at = (column - 1).min(line.len());
    if told.letters > 0 && told.message.contains("unknown key") {
        return put(joined(&[&line[..at], &letters, &line[(at + told.letters).min(line.len())..]]));
    }
    // Into the map on this line, or else before the line.
    match line[..(at + 1).min(line.len())].iter().rposition(|c| *c == '{') {
        Some(brace) => put(joined(&[&line[..=brace], &letters, &[',', ' '], &line[brace + 1..]]).replace(", }", "}")),
        None => {
            let indent = line.iter().take_while(|c| **c == ' ').count();
            put(format!("{}{text}\n{}", " ".repeat(indent), joined(&[&line])))
        }
    }
}

/// Recorded hints that this test cannot apply, and why.
const BY_HAND: [(&str, &str); 5] = [
    ("dng-from-film", "`dng` is removed from a list, not from a map"),
    ("empty-file", "an empty file does not become a scene with its first line only"),
    ("lens-index-as-glass", "`nd` replaces another key, `glass`"),
    ("picture-sequence", "the pictures of the sequence do not exist"),
    ("width-without-a-unit", "the intended width leaves a narrow border, which causes a warning"),
];

/// Every other recorded proposal works: applied to the file, it removes the fault or warning, and commands in it run.
#[test]
fn every_recorded_proposal_works() {
    let (mut changes, mut commands): (Vec<Proposal>, Vec<(String, String)>) = (Vec::new(), Vec::new());
    let mut left: Vec<&str> = BY_HAND.iter().map(|(name, _)| *name).collect();
    for folder in ["broken", "warned"] {
        for (name, said) in recorded(&repository("tests").join(folder)) {
            let all: Vec<Told> =
                if folder == "broken" { said.split("\n\n").filter_map(told).collect() } else { warned(&said) };
            for told in all.iter().filter(|told| folder == "warned" || told.meant().is_none()) {
                for (change, text) in proposed(&told.hint) {
                    let text = text.to_owned();
                    if change == Change::Run {
                        if !commands.iter().any(|(_, known)| *known == text) && !text.contains(".yaml") {
                            commands.push((name.clone(), text));
                        }
                        continue;
                    }
                    if let Some(at) = left.iter().position(|known| *known == name) {
                        left.remove(at);
                        continue;
                    }
                    if BY_HAND.iter().any(|(known, _)| *known == name) {
                        continue;
                    }
                    let (name, said, told) = (name.clone(), said.clone(), told.clone());
                    changes.push(Proposal { folder, name, said, told, change, text });
                }
            }
        }
    }
    let elsewhere = tempfile::tempdir().expect("a folder");
    let fails = |(name, text): &(String, String)| {
        let words: Vec<&str> = text.split_whitespace().skip(1).collect();
        let output = run_in(elsewhere.path(), &words);
        (!output.status.success()).then(|| format!("{name}: `{text}`: {}", self::text(&output.stderr)))
    };
    let wrong = [together(&commands, fails), together(&changes, Proposal::fails)].concat();
    let wrong: Vec<String> = wrong.into_iter().flatten().collect();
    let (files, commands) = (changes.len(), commands.len());
    println!("{files} recorded proposals work, and {commands} commands; by hand: {BY_HAND:?}");
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
    assert!(left.is_empty(), "no proposal in {left:?}");
    assert!(files >= 40, "{files} proposals");
}

/// A change of a case's file that its recorded text proposes.
struct Proposal {
    folder: &'static str,
    name: String,
    said: String,
    told: Told,
    change: Change,
    text: String,
}

impl Proposal {
    /// Returns why the proposal does not help, or `None` if it helps.
    fn fails(&self) -> Option<String> {
        let Self { folder, name, said, told, change, text } = self;
        let (copy, arguments) = copied(&repository("tests").join(folder), name);
        let file = copy.path().join(&told.place.0);
        let content = fs::read(&file).unwrap_or_default();
        let content = String::from_utf8_lossy(&content).into_owned();
        let Some(new) = changed(&content, told, *change, text) else {
            return Some(format!("{name}: `{text}` has no place ({change:?}): {}", told.hint));
        };
        fs::write(&file, &new).expect("written");
        let now = said_in(copy.path(), &arguments);
        let gone = match *folder {
            "broken" => !now.contains(&told.message),
            _ => now.matches("warning: ").count() < said.matches("warning: ").count(),
        };
        if gone && !now.contains("panicked") {
            return None;
        }
        let diff: Vec<&str> = new.lines().filter(|l| !content.lines().any(|old| old == *l)).collect();
        Some(format!("{name}: `{text}` ({change:?}) does not help: {diff:?}\n{now}"))
    }
}

/// The viewer refuses a file that is neither a scene nor a photograph with a short message, without printing the file's contents.
#[test]
fn the_viewer_says_what_it_cannot_open() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("photo.heic"), b"\0\0\0\x18ftypheic\0\xff\xfe").expect("written");
    for (arguments, wanted) in [
        (&["photo.heic"][..], "neither a scene nor a picture"),
        (&["gone.jpg"], "`gone.jpg`: no such file"),
        (&["gray-card", "--stock", "tri-x"], "--set film.stock=tri-x"),
        (&["gone.jpg", "--stock", "portra"], "which one? kodak-portra-160"),
    ] {
        let said = answer_in(folder.path(), &[&["view", "--no-open"], arguments].concat());
        let said = text(&said.stderr);
        assert!(said.contains(wanted) && said.len() < 600, "{arguments:?}: {said}");
    }
}

/// The scene paths in the README name existing scenes.
#[test]
fn scenes_of_the_readme_are_there() {
    let readme = fs::read_to_string(repository("README.md")).expect("there");
    let named: Vec<&str> =
        readme.split('`').filter(|word| word.starts_with("scenes/") && word.ends_with(".yaml")).collect();
    assert!(named.len() > 5);
    for scene in named {
        assert!(Path::new(shown(&repository(scene))).is_file(), "{scene}");
    }
}
