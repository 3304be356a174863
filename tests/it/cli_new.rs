//! Tests stages written by others: `spectra new` and `spectra build`.

use crate::common::{repository, shown, spectra, text};
use std::path::Path;
use std::process::{Command, Output};

const STAGES: [(&str, &str); 6] = [
    ("surface", "surface"),
    ("film", "film"),
    ("source", "source"),
    ("sampler", "wavelengths"),
    ("imager", "imager"),
    ("response", "response"),
];

/// Runs `spectra` in a folder, with the sources of this checkout and a cache inside the folder.
fn in_folder(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = spectra();
    command.current_dir(folder).env("SPECTRA_CACHE", folder.join("cache")).args(arguments);
    command.output().expect("the program starts")
}

fn good(folder: &Path, arguments: &[&str]) -> String {
    let output = in_folder(folder, arguments);
    assert!(output.status.success(), "{arguments:?}: {}", text(&output.stderr));
    text(&output.stdout)
}

/// Returns the message about wrong arguments, which must have exit code 2.
fn refused(folder: &Path, arguments: &[&str]) -> String {
    let output = in_folder(folder, arguments);
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {said}");
    // Joins the lines, because messages are wrapped at the width of the terminal.
    said.split_whitespace().filter(|word| *word != "\u{2502}").collect::<Vec<_>>().join(" ")
}

fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).expect("a folder");
    let mut names: Vec<String> =
        entries.map(|e| e.expect("an entry").file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn checkout() -> String {
    shown(&repository("")).to_owned()
}

#[test]
fn plugins_of_every_stage_are_whole() {
    let folder = tempfile::tempdir().expect("a folder");
    for (stage, word) in STAGES {
        let name = format!("far-{stage}");
        let said = good(folder.path(), &["new", "plugin", &name, "--stage", stage, "--core", &checkout()]);
        for next in [&format!("cd {name}"), "cargo test --release", "spectra build --with . -o ./spectra-mine"] {
            assert!(said.contains(next), "{said}");
        }
        let plugin = folder.path().join(&name);
        let mut files =
            vec![".cargo", ".gitignore", "Cargo.lock", "Cargo.toml", "README.md", "rustfmt.toml", "scene.yaml", "src"];
        if stage == "surface" {
            files.push("lens.yaml");
            files.sort_unstable();
        }
        assert_eq!(names(&plugin), files);
        assert_eq!(names(&plugin.join("src")), ["lib.rs"]);
        let source = read(&plugin.join("src/lib.rs"));
        let registered = format!("spectra_core::register!({word} \"{name}\": Far");
        assert!(source.contains(&registered), "{source}");
        for file in ["src/lib.rs", "scene.yaml", "README.md", "Cargo.toml"] {
            let text = read(&plugin.join(file));
            assert!(!text.contains("my-stage") && !text.contains("MyStage") && !text.contains("{{"), "{text}");
        }
        assert_eq!(read(&plugin.join("Cargo.lock")), read(&repository("Cargo.lock")));
        // The tests of a plugin and `spectra build` compile with the same settings into the same folder.
        let manifest = read(&plugin.join("Cargo.toml"));
        let (_, profile) = manifest.split_once("[profile.release]\n").expect("a profile");
        let ours = read(&repository("Cargo.toml"));
        let (_, wanted) = ours.split_once("[profile.release]\n").expect("a profile");
        assert_eq!(profile.split("\n\n").next(), wanted.split("\n\n").next());
        let config = read(&plugin.join(".cargo/config.toml"));
        let target = folder.path().join("cache").join("target");
        assert!(config.contains(&format!("target-dir = {:?}", shown(&target))), "{config}");
        assert!(read(&plugin.join(".gitignore")).contains("/.cargo\n"));
    }
    assert_eq!(names(folder.path()).len(), STAGES.len(), "other files were left");
}

/// A film starts with the requested number of layers; other stages have no layers.
#[test]
fn films_start_with_as_many_layers_as_are_asked_for() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    let core = checkout();
    for count in ["1", "3", "16"] {
        let name = format!("stack-{count}");
        good(at, &["new", "plugin", &name, "--stage", "film", "--layers", count, "--core", &core]);
        let source = read(&at.join(&name).join("src/lib.rs"));
        assert!(source.contains(&format!("const LAYERS: usize = {count};")), "{source}");
        assert!(source.contains(&format!("register!(film \"{name}\": Stack")), "{source}");
        assert!(!source.contains("my-stage") && !source.contains("MyStage") && !source.contains("{{"), "{source}");
        assert!(read(&at.join(&name).join("scene.yaml")).contains(&format!("film: {{kind: {name}, ")));
    }
    let said = refused(at, &["new", "plugin", "x", "--stage", "source", "--layers", "3", "--core", &core]);
    assert!(said.contains("a source has no layers") && said.contains("only with --stage film"), "{said}");
    for count in ["0", "17", "many"] {
        refused(at, &["new", "plugin", "x", "--stage", "film", "--layers", count, "--core", &core]);
    }
    assert_eq!(names(at), ["stack-1", "stack-16", "stack-3"]);
}

/// The code that an author starts with is short, not counting its tests.
#[test]
fn sources_are_short() {
    for (stage, most) in [
        ("surface", 60),
        ("film", 40),
        ("film-layers", 110),
        ("source", 130),
        ("wavelengths", 105),
        ("imager", 120),
        ("response", 70),
    ] {
        let path = repository(&format!("crates/command/src/new/templates/{stage}/lib.rs"));
        let source = read(&path);
        let before = source.split("#[cfg(test)]").next().expect("a first part");
        assert!(before.lines().count() <= most, "{stage}: {} lines", before.lines().count());
    }
}

#[test]
fn scenes_and_lenses_work_as_they_are() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    assert!(good(at, &["new", "scene", "first-light"]).contains("spectra run first-light.yaml"));
    assert!(good(at, &["new", "lens", "triplet.yaml"]).contains("spectra lens info triplet.yaml"));
    assert_eq!(names(at), ["first-light.yaml", "triplet.yaml"]);
    good(at, &["check", "first-light.yaml", "--set", "lens.file=triplet", "--set", "lens.f-number=f/5"]);
    let info = good(at, &["lens", "info", "triplet.yaml"]);
    assert!(info.contains("Cooke triplet"), "{info}");
    good(at, &["run", "first-light.yaml", "--samples", "1", "--set", "imager.resolution=[48, 32]", "-q"]);
    assert!(at.join("out/first-light.png").is_file());
}

/// A film based on another one can be developed at once, whether of silver or of three dyes, and states its origin.
#[test]
fn films_start_from_another_one() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    for (name, like, stock) in [("my-pan", "tri-x", "kodak-tri-x-400"), ("my-slide", "velvia", "fuji-velvia-50")] {
        let said = good(at, &["new", "film", name, "--like", like]);
        assert!(said.contains(&format!("spectra film info {name}.yaml")), "{said}");
        assert!(read(&at.join(format!("{name}.yaml"))).contains(&format!("like: {stock}\n")));
        let info = good(at, &["film", "info", &format!("{name}.yaml"), "--json"]);
        let json: serde_json::Value = serde_json::from_str(&info).expect("JSON");
        assert!(json["warnings"].as_array().is_some_and(Vec::is_empty), "{info}");
        assert!(json["source"].as_str().is_some_and(|source| source.contains("changed: ")), "{info}");
    }
    // A data sheet with a relative axis: all curves are moved by 3 to the right, and the program slides them back to the speed.
    let text = read(&at.join("my-pan.yaml")).replace("# exposure: relative ", "exposure: relative ");
    let (head, points) = text.split_once("        points:\n").expect("a curve");
    let moved: String = points
        .lines()
        .map(|line| {
            let (x, density) = line.trim().trim_start_matches("- [").split_once(',').expect("a point");
            format!("          - [{:.2},{density}\n", x.parse::<f64>().expect("a number") + 3.0)
        })
        .collect();
    std::fs::write(at.join("sheet.yaml"), format!("{head}        points:\n{moved}")).expect("written");
    let info = good(at, &["film", "info", "sheet.yaml"]);
    assert!(info.contains("relative in the file; slid by -") && !info.contains("warning"), "{info}");
    let text = read(&at.join("sheet.yaml")).replace("exposure: relative ", "# exposure: relative ");
    std::fs::write(at.join("sheet.yaml"), text).expect("written");
    let info = good(at, &["film", "info", "sheet.yaml"]);
    assert!(info.contains("warning: its curves have the speed") && info.contains("stops slower"), "{info}");
    assert!(refused(at, &["new", "film", "x", "--like", "velvio"]).contains("no film stock is called"));
}

#[test]
fn names_that_cannot_be_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    let core = checkout();
    std::fs::create_dir(at.join("there")).expect("made");
    let said = |name: &str| refused(at, &["new", "plugin", name, "--stage", "surface", "--core", &core]);
    for (name, why) in [
        ("Ripple", "`R` is not allowed in it"),
        ("two words", "is not allowed in it"),
        ("../out", "is not allowed in it"),
        ("match", "Rust reserves it"),
        ("spectra-core", "reserved for the crates of spectra"),
        ("sphere", "spectra-plugin-surfaces"),
        ("there", "already exists"),
    ] {
        let said = said(name);
        assert!(said.contains(why) && said.contains("help:"), "{name}: {said}");
    }
    // A name must be unique only within its stage.
    good(at, &["new", "plugin", "sphere", "--stage", "source", "--core", &core]);
    let elsewhere = refused(at, &["new", "plugin", "x", "--stage", "film", "--core", &core, "--path", "no/such"]);
    assert!(elsewhere.contains("there is no such folder"), "{elsewhere}");
    let core = refused(at, &["new", "plugin", "x", "--stage", "film", "--core", "there"]);
    assert!(core.contains("no sources of spectra"), "{core}");
    assert!(refused(at, &["new", "scene", "a b"]).contains("is not allowed in it"));
    assert_eq!(names(at), ["sphere", "there"], "other files were left");
}

/// Writes a crate with one file, as `--with` expects it, and returns its path.
fn krate(folder: &Path, name: &str, manifest: &str, source: &str, file: &str) -> String {
    let path = folder.join(name);
    std::fs::create_dir_all(path.join("src")).expect("made");
    let manifest =
        format!("[package]\nname = \"{name}\"\nversion = \"0.3.0\"\nedition = \"2024\"\n[workspace]\n{manifest}");
    std::fs::write(path.join("Cargo.toml"), manifest).expect("written");
    std::fs::write(path.join("src").join(file), source).expect("written");
    shown(&path).to_owned()
}

#[test]
fn plugins_that_cannot_be_built_in_are_refused_at_once() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    let core = checkout();
    let said = |with: &str| refused(at, &["build", "--with", with, "--core", &core, "--offline"]);
    std::fs::create_dir(at.join("empty")).expect("made");
    std::fs::write(at.join("text"), "").expect("written");
    let program = krate(at, "program", "", "fn main() {}", "main.rs");
    let registry = "[dependencies]\nspectra-core = \"77\"\n";
    let later = krate(at, "later", registry, "", "lib.rs");
    let other = krate(at, "spectra-core", "", "", "lib.rs");
    let path = krate(at, "by-path", "[dependencies]\nspectra-core = { path = \"../spectra-core\" }\n", "", "lib.rs");
    let broken = krate(at, "broken", "[dependencies", "", "lib.rs");
    for (with, why, hint) in [
        ("none", "no such folder", "the folder of a plugin's crate"),
        ("empty", "there is no Cargo.toml", "the folder of a plugin's crate"),
        ("text", "not a crate", "the folder of a plugin's crate"),
        (&program, "has no library", "src/lib.rs"),
        (&later, "written for spectra-core ^77", "--core PATH"),
        (&other, "the name of a crate of spectra itself", "rename it"),
        (&path, "its spectra-core comes from", "--core"),
        (&broken, "cargo cannot read it", "spectra new plugin"),
    ] {
        let said = said(with);
        assert!(said.contains(why) && said.contains("help:") && said.contains(hint), "{with}: {said}");
    }
    // All faults are reported at once.
    let both = refused(at, &["build", "--with", "none", "--with", &later, "--core", &core, "--offline"]);
    assert!(both.contains("no such folder") && both.contains("^77") && both.contains("2 faults"), "{both}");
    let mut command = spectra();
    command.current_dir(at).env("CARGO", "no-such-cargo").args(["build", "--with", &program, "--core", &core]);
    let output = command.output().expect("the program starts");
    assert!(text(&output.stderr).contains("https://rustup.rs"), "{}", text(&output.stderr));
    let taken = refused(at, &["build", "--with", &program, "--core", &core, "-o", "empty"]);
    assert!(taken.contains("that is a folder"), "{taken}");
    // A file that is not one of our programs stays unchanged. The program under test is one of ours.
    let manifest = at.join("program/Cargo.toml");
    let before = read(&manifest);
    let taken = refused(at, &["build", "--with", &program, "--core", &core, "-o", shown(&manifest)]);
    assert!(taken.contains("was not made by") && taken.contains("--force"), "{taken}");
    assert_eq!(read(&manifest), before);
    let own = at.join(format!("own{}", std::env::consts::EXE_SUFFIX));
    std::fs::copy(env!("CARGO_BIN_EXE_spectra"), &own).expect("copied");
    let other = refused(at, &["build", "--with", &program, "--core", &core, "--offline", "-o", shown(&own)]);
    assert!(other.contains("has no library") && !other.contains("--force"), "{other}");
    assert!(!at.join("spectra-mine").exists());
}

/// Builds a program with a generated surface and a generated film, queries it and renders with it, then breaks each plugin in turn.
/// This compiles the whole engine again, which takes minutes: `cargo test --test it cli_new -- --ignored`.
#[test]
#[ignore = "compiles the whole engine once more: minutes"]
fn a_program_with_plugins_renders_their_scenes() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    let core = checkout();
    let target = Path::new(env!("CARGO_BIN_EXE_spectra")).ancestors().nth(2).expect("target/profile/spectra");
    let build = |arguments: &[&str]| {
        let mut command = spectra();
        command.current_dir(at).env("SPECTRA_CACHE", at.join("cache")).env("CARGO_TARGET_DIR", target);
        command.args(["build", "--core", &core, "--offline", "--profile", "dev", "-o", "mine"]).args(arguments);
        command.output().expect("the program starts")
    };
    good(at, &["new", "plugin", "far-surface", "--stage", "surface", "--core", &core]);
    good(at, &["new", "plugin", "far-film", "--stage", "film", "--layers", "3", "--core", &core]);
    // Crates that the plugin's tests compiled with the same features are not compiled again for the program.
    let mut tests = Command::new("cargo");
    tests
        .args(["test", "--offline", "--profile", "dev"])
        .current_dir(at.join("far-film"))
        .env("CARGO_TARGET_DIR", target);
    let output = tests.output().expect("cargo starts");
    assert!(output.status.success(), "{}{}", text(&output.stdout), text(&output.stderr));
    let manifest = read(&at.join("far-surface/Cargo.toml"));
    let unlicensed: Vec<&str> = manifest.lines().filter(|line| !line.starts_with("license")).collect();
    std::fs::write(at.join("far-surface/Cargo.toml"), unlicensed.join("\n")).expect("written");
    std::fs::write(at.join("far-film/LICENSE"), "The terms of a far film.").expect("written");
    let both = ["--with", "far-surface", "--with", "far-film/Cargo.toml"];
    let output = build(&both);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let compiled = text(&output.stderr);
    assert!(!compiled.contains("Compiling spectra-data "), "{compiled}");
    assert!(compiled.contains("warning: no license is stated by far-surface 0.1.0\n  help: "), "{compiled}");
    let said = text(&output.stdout);
    assert!(said.contains("far-surface 0.1.0: surface `far-surface`"), "{said}");
    assert!(said.contains("far-film 0.1.0: film `far-film`"), "{said}");

    let mine = at.join(format!("mine{}", std::env::consts::EXE_SUFFIX));
    let run = |arguments: &[&str]| {
        Command::new(&mine)
            .current_dir(at)
            .env("SPECTRA_CACHE", at.join("cache"))
            .args(arguments)
            .output()
            .expect("it starts")
    };
    for stage in ["surface", "film"] {
        let scene = format!("far-{stage}/scene.yaml");
        let output = run(&["run", &scene, "--samples", "2", "--set", "imager.resolution=[72, 48]", "-q", "-o", stage]);
        assert!(output.status.success(), "{scene}: {}", text(&output.stderr));
        assert!(at.join(stage).join("scene.png").is_file());
    }
    let licenses = text(&run(&["--licenses"]).stdout);
    for line in
        ["far-film 0.1.0: MIT OR Apache-2.0\n", "far-surface 0.1.0: states no license\n", "The terms of a far film."]
    {
        assert!(licenses.contains(line), "{line}");
    }
    // The program is complete: it creates and builds plugins itself, from its own sources.
    let output = run(&["new", "plugin", "third", "--stage", "source"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let output = run(&["new", "plugin", "far-film", "--stage", "film", "--path", "cache"]);
    assert!(text(&output.stderr).contains("in crate far-film"), "{}", text(&output.stderr));

    // A failed build leaves the program unchanged.
    let before = std::fs::read(&mine).expect("the program");
    let source = at.join("far-surface/src/lib.rs");
    let good_source = read(&source);
    let failing = |changed: String, why: &str| {
        std::fs::write(&source, changed).expect("written");
        let output = build(&both);
        let said = text(&output.stderr);
        assert!(!output.status.success() && said.contains(why), "{why}: {said}");
        assert!(std::fs::read(&mine).expect("the program") == before, "{why}: the program was changed");
    };
    failing(good_source.replace("\"far-surface\":", "\"sphere\":"), "`sphere` is registered twice");
    failing(good_source.replace("x * x * x", "x * x * z"), "`far-surface` does not compile");
    let line = good_source.lines().find(|line| line.starts_with("spectra_core::register!")).expect("one");
    let unregistered = good_source.replace(line, "").replace("fn build", "pub fn build");
    failing(format!("#![allow(dead_code)]\n{unregistered}"), "registers no stage");
}
