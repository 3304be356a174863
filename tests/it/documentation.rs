//! Tests the documentation of stages and files: it exists, agrees with the schema, and every example works as written.

use crate::common::{good, repository};
use spectra_core::params::Params;
use spectra_core::registry::{Documentation, Listed, list};
use spectra_core::resources::Resources;
use spectra_plugins as _;
use spectra_scene::{FileKind, FileResources, file_documentation, shared_documentation};
use std::path::Path;

/// Names of quantities in documentation, except those without a unit.
const WITH_UNIT: [&str; 12] = [
    "length",
    "wavelength",
    "time",
    "temperature",
    "luminance",
    "illuminance",
    "exposure",
    "power",
    "radiant intensity",
    "spatial frequency",
    "f-number",
    "angle",
];

/// Width of the terminal, in columns, that pages are made for.
const COLUMNS: usize = 100;

fn name(stage: &Listed) -> String {
    format!("{}/{}", stage.stage, stage.name)
}

/// Checks that the documentation of an item is complete.
fn complete(name: &str, doc: &Documentation, faults: &mut Vec<String>) {
    let mut must = |good: bool, what: &str| {
        if !good {
            faults.push(format!("{name}: {what}"));
        }
    };
    let summary = &doc.summary;
    must(summary.ends_with('.') && !summary.contains(". "), "the summary is one sentence with a period");
    must(summary.chars().count() <= 110, "the summary has 110 characters at most");
    must(doc.text.len() >= 60, "a text says what it does and when to use it");
    must(!doc.examples.is_empty(), "there is an example");
    for p in &doc.parameters {
        must(p.description.len() >= 4, &format!("`{}` is described", p.key));
        let form = p.form.to_string();
        must(form != "anything" && !form.is_empty(), &format!("`{}` has a type", p.key));
        let quantity = WITH_UNIT.iter().any(|q| form.split([' ', ',']).any(|word| word == *q) && form != "text");
        must(!quantity || !p.unit.is_empty(), &format!("`{}`, a {form}, has a unit", p.key));
    }
}

#[test]
fn every_stage_and_file_is_documented() {
    let mut faults = Vec::new();
    for stage in list() {
        complete(&name(&stage), &stage.documentation(), &mut faults);
        if let Some(shared) = shared_documentation(stage.stage) {
            let silent = shared.parameters.iter().filter(|p| p.description.len() < 4);
            faults.extend(silent.map(|p| format!("{}: `{}` is not described", stage.stage, p.key)));
        }
    }
    for kind in FileKind::ALL {
        complete(kind.name(), &file_documentation(kind), &mut faults);
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// Returns whether code cites a paper: by a year in parentheses, or a year before a closing parenthesis.
fn cites(code: &str) -> bool {
    let comments = code.lines().map(str::trim_start).filter(|line| line.starts_with("//"));
    let mut years = comments.flat_map(|line| {
        let digits = line.as_bytes().windows(5);
        digits.filter(|w| w[4] == b')' && w[..4].iter().all(u8::is_ascii_digit)).map(|w| w[..4].to_vec())
    });
    years.any(|year| (1600..2100).contains(&String::from_utf8_lossy(&year).parse::<u32>().unwrap_or(0)))
}

/// If the code of a stage cites a paper, its page names the reference too.
#[test]
fn what_the_code_cites_the_page_cites() {
    let mut looked_at = 0;
    for family in std::fs::read_dir(repository("plugins")).expect("plugins") {
        let mut folders = vec![family.expect("an entry").path().join("src")];
        while let Some(folder) = folders.pop() {
            let Ok(entries) = std::fs::read_dir(&folder) else { continue };
            for path in entries.map(|entry| entry.expect("an entry").path()) {
                if path.is_dir() {
                    folders.push(path);
                    continue;
                }
                let code = std::fs::read_to_string(&path).expect("text");
                for line in code.lines().filter_map(|line| line.strip_prefix("spectra_core::register!(")) {
                    let (stage, rest) = line.split_once(' ').expect("register!(stage \"name\"");
                    // A kind of stage that another crate declares is named by its entry type.
                    let entry = stage.rsplit("::").next().and_then(|entry| entry.strip_suffix("Entry,"));
                    let stage = entry.map_or_else(|| stage.to_owned(), str::to_lowercase);
                    let name = rest.split('"').nth(1).expect("a name");
                    let listed = list().into_iter().find(|l| l.stage == stage && l.name == name);
                    let Some(listed) = listed else { panic!("{stage}/{name} is registered but not linked") };
                    let references = listed.documentation().references;
                    assert!(
                        !cites(&code) || !references.is_empty(),
                        "{stage}/{name}: {} cites a paper",
                        path.display()
                    );
                    looked_at += 1;
                }
            }
        }
    }
    let of_plugins = list().iter().filter(|listed| listed.package.starts_with("spectra-plugin-")).count();
    assert_eq!(looked_at, of_plugins, "the folder `plugins` and the registry have different stages");
}

/// Creates a folder with the files that examples name.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let put = |name: &str, bytes: &[u8]| std::fs::write(folder.path().join(name), bytes).expect("written");
    let deep = std::fs::read(repository("scenes/depth-still-life.exr")).expect("a picture");
    put("still-life.exr", &deep);
    for name in ["holiday.png", "leaves.png", "portrait.png"] {
        put(name, PNG);
    }
    let rows: Vec<String> = (-3..=3)
        .map(|j| (-3..=3).map(|i| format!("{}", f64::from(i * i + j * j) * 0.01)).collect::<Vec<_>>().join(", "))
        .collect();
    put("measured.csv", format!("# sags, mm\n{}\n", rows.join("\n")).as_bytes());
    put("lens.yaml", b"name: ideal\nsurfaces:\n  - {kind: thin-lens, focal-length: 50, thickness: 51.3, semi-diameter: 12, stop: true}\n");
    folder
}

/// A PNG file of one gray pixel.
const PNG: &[u8] = &[
    0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48, 0x44, 0x52, 0x00, 0x00, 0x00,
    0x01, 0x00, 0x00, 0x00, 0x01, 0x08, 0x00, 0x00, 0x00, 0x00, 0x3a, 0x7e, 0x9b, 0x55, 0x00, 0x00, 0x00, 0x0a, 0x49,
    0x44, 0x41, 0x54, 0x78, 0x9c, 0x63, 0x68, 0x00, 0x00, 0x00, 0x82, 0x00, 0x81, 0x77, 0xcd, 0x72, 0xb6, 0x00, 0x00,
    0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82,
];

/// Returns the text as the value of a key.
fn section(key: &str, value: &str) -> String {
    let lines: Vec<String> = value.lines().map(|line| format!("  {line}\n")).collect();
    format!("{key}:\n{}", lines.concat())
}

fn parsed(folder: &Path, file: &str, text: &str) -> Result<Params, String> {
    std::fs::write(folder.join(file), text).expect("written");
    FileResources::beside(folder).document(file, &[], &[]).map_err(|faults| faults.to_string())
}

fn lens(folder: &Path, text: &str) -> Result<(), String> {
    let params = parsed(folder, "example.yaml", text)?;
    let lens = spectra_lens::parse(&params, &FileResources::beside(folder)).map_err(|faults| faults.to_string())?;
    if lens.warnings.is_empty() { Ok(()) } else { Err(lens.warnings.join("\n")) }
}

fn scene(folder: &Path, text: &str) -> Result<(), String> {
    let path = folder.join("scene.yaml");
    std::fs::write(&path, text).expect("written");
    spectra_scene::load(&path, &[]).map(|_| ()).map_err(|faults| format!("{faults}\n{text}"))
}

/// Loads a small scene in which the given sections replace the usual ones.
fn scene_with(folder: &Path, given: &[(&str, &str)]) -> Result<(), String> {
    let usual = [
        ("source", "{kind: chart, chart: white, distance: 2 m, width: 1.5 m}"),
        ("lens", "{file: lens.yaml}"),
        ("imager", "{kind: xyz, format: 135, resolution: [12, 8]}"),
    ];
    let kept = usual.iter().filter(|(key, _)| given.iter().all(|(other, _)| other != key));
    let text: String = kept.chain(given).map(|(key, value)| section(key, value)).collect();
    scene(folder, &format!("spectra: 1\n{text}"))
}

/// A surface with a size, to which keys can be added.
const SURFACE: &str = "surfaces:\n  - kind: sphere\n    radius: 50\n    glass: SCHOTT/N-BK7\n    semi-diameter: 10\n";

/// Builds an example in the place where a stage of its kind belongs.
fn build(stage: &str, example: &str, folder: &Path) -> Result<(), String> {
    match stage {
        "surface" => {
            let item = example.lines().filter(|line| !line.starts_with('#'));
            let item: Vec<String> =
                item.enumerate().map(|(i, l)| format!("  {} {l}\n", if i == 0 { '-' } else { ' ' })).collect();
            lens(folder, &format!("name: example\nsurfaces:\n{}", item.concat()))
        }
        "color" => {
            let source =
                format!("kind: chart\nchart: white\ndistance: 2 m\nwidth: 1.5 m\n{}", section("color", example));
            scene_with(folder, &[("source", &source)])
        }
        "source" | "wavelengths" => scene_with(folder, &[(stage, example)]),
        "output" => {
            let imager = "{kind: sensor, format: 135, resolution: [12, 8], exposure: 1/60 s}";
            scene_with(folder, &[("imager", imager), ("output", &format!("[{example}]"))])
        }
        "imager" if example.contains("kind: film") => {
            scene_with(folder, &[("imager", example), ("film", "{stock: ilford-ortho-plus, exposure: 1/60 s}")])
        }
        "imager" => scene_with(folder, &[("imager", example)]),
        "film" => {
            scene_with(folder, &[("imager", "{kind: film, format: 135, resolution: [12, 8]}"), ("film", example)])
        }
        "response" => {
            let imager = format!("kind: detector\nformat: 135\nresolution: [12, 8]\n{}", section("response", example));
            scene_with(folder, &[("imager", &imager)])
        }
        "spectrum" => {
            parsed(folder, "example.yaml", example)?;
            let resources = FileResources::beside(folder);
            let found = spectra_spectrum::find_emission_in("example.yaml", &resources);
            found.map(|_| ()).map_err(|error| error.to_string())
        }
        "coating" => lens(folder, &format!("name: example\n{}{SURFACE}", section("coating", example))),
        "aperture" => {
            let lines: Vec<String> = example.lines().map(|line| format!("      {line}\n")).collect();
            lens(folder, &format!("name: example\n{SURFACE}    aperture:\n{}", lines.concat()))
        }
        "formula" => {
            parsed(folder, "example.yaml", example)?;
            let glass = spectra_glass::file::load("example.yaml", &FileResources::beside(folder));
            glass.map(|_| ()).map_err(|faults| faults.to_string())
        }
        // A nested stage: its YAML is read, and its own tests build it.
        _ => parsed(folder, "example.yaml", example).map(|_| ()),
    }
}

#[test]
fn every_example_of_a_stage_builds() {
    let folder = folder();
    let mut faults = Vec::new();
    for stage in list() {
        for example in &stage.documentation().examples {
            let other = match parsed(folder.path(), "example.yaml", example) {
                // An example that names no kind is of the default kind.
                Ok(params) => params.get(stage.key).map_or(!stage.default, |k| k.as_str() != Some(stage.name)),
                Err(fault) => {
                    faults.push(format!("{}: {fault}", name(&stage)));
                    continue;
                }
            };
            if other {
                faults.push(format!("{}: this example is of another kind:\n{example}", name(&stage)));
            }
            faults.extend(build(stage.stage, example, folder.path()).err().map(|f| format!("{}: {f}", name(&stage))));
            // Building proves something only if the builder reads the example's own keys, so an unknown key must fail.
            let wrong = match example
                .strip_suffix('}')
                .filter(|_| example.lines().any(|line| line.starts_with('{')) || !example.contains('\n'))
            {
                Some(flow) => format!("{flow}, no-such-key: 1}}"),
                None => format!("{example}\nno-such-key: 1"),
            };
            if let Ok(()) = build(stage.stage, &wrong, folder.path()) {
                faults.push(format!("{}: an unknown key is accepted:\n{wrong}", name(&stage)));
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn every_example_of_a_file_is_one() {
    let folder = folder();
    let resources = FileResources::beside(folder.path());
    for kind in FileKind::ALL {
        for example in &file_documentation(kind).examples {
            let read = match kind {
                FileKind::Scene => scene(folder.path(), example),
                FileKind::Lens => lens(folder.path(), example),
                FileKind::Stock => {
                    parsed(folder.path(), "example.yaml", example).expect("YAML");
                    let stock = spectra_film::stock::Stock::load("example.yaml", &resources);
                    stock.map(|_| ()).map_err(|faults| faults.to_string())
                }
                FileKind::Spectrum => {
                    parsed(folder.path(), "example.yaml", example).expect("YAML");
                    let found = spectra_spectrum::find_emission_in("example.yaml", &resources);
                    found.map(|_| ()).map_err(|error| error.to_string())
                }
            };
            read.unwrap_or_else(|faults| panic!("{}: {faults}", kind.name()));
        }
    }
}

/// Pages of the command fit a terminal of 100 columns, except blocks of code, which are not wrapped.
#[test]
fn pages_fit_a_terminal() {
    let stages = list();
    let mut names: Vec<String> = stages.iter().map(name).collect();
    names.extend(FileKind::ALL.map(|kind| kind.name().to_owned()));
    names.extend(stages.iter().map(|s| s.stage.to_owned()).filter(|s| s != "lens"));
    names.dedup();
    for name in names {
        let page = good(&["doc", &name]);
        let mut in_example = false;
        for line in page.lines() {
            in_example = line == "Example" || (in_example && (line.is_empty() || line.starts_with("  ")));
            assert!(in_example || line.chars().count() <= COLUMNS, "{name}: {line}");
        }
        assert!(!page.contains("```"), "{name}: a fence is left");
    }
}
