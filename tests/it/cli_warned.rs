//! Tests what the program says about a corpus of mistakes that still make a picture, but not the intended one, word for word.
//!
//! `tests/warned/NAME.yaml` is a scene that can be rendered but should not be trusted. `tests/warned/NAME.txt` is what
//! `spectra check` says. `SPECTRA_BLESS=1 cargo test --test it cli_warned` writes the texts anew. As in `tests/broken`, each case
//! states in a comment what is doubtful, `# doubtful: TEXT`. Exactly one warning with a hint starts at this text, and there are no
//! other warnings.
//!
//! The bundled scenes are the counterexamples: no warning appears for any of them, see `bundled`.

use crate::common::{answer_in, repository, run, text};
use std::fs;
use std::path::{Path, PathBuf};

/// Smallest number of cases; fewer mean that some were lost.
const LEAST: usize = 12;

fn yaml(folder: &Path) -> Vec<PathBuf> {
    let mut files: Vec<PathBuf> = fs::read_dir(folder)
        .expect("a folder")
        .map(|entry| entry.expect("readable").path())
        .filter(|path| path.extension().is_some_and(|e| e == "yaml"))
        .collect();
    files.sort();
    files
}

#[test]
fn each_doubt_is_told_where_it_is_and_what_to_do() {
    let folder = repository("tests/warned");
    let bless = std::env::var_os("SPECTRA_BLESS").is_some();
    let cases = yaml(&folder);
    assert!(cases.len() >= LEAST, "{} cases", cases.len());
    let mut wrong = Vec::new();
    for case in &cases {
        let name = case.file_name().and_then(|name| name.to_str()).expect("plain names");
        let scene = fs::read_to_string(case).expect("a scene");
        let output = answer_in(&folder, &["check", name]);
        let said = text(&output.stderr);
        if output.status.code() != Some(0) {
            wrong.push(format!("{name}: ends with {:?}:\n{said}", output.status.code()));
        }
        let expected = case.with_extension("txt");
        if bless {
            fs::write(&expected, &said).expect("written");
        } else if fs::read_to_string(&expected).unwrap_or_default() != said {
            wrong.push(format!(
                "{name}: the text differs from the expected one (SPECTRA_BLESS=1 writes it anew):\n{said}"
            ));
        }
        let mut wanted: Vec<&str> =
            scene.lines().filter_map(|line| line.split_once("# doubtful: ")).map(|l| l.1).collect();
        for warning in said.split("warning: ").skip(1) {
            if !warning.contains("\n  help: ") {
                wrong.push(format!("{name}: no hint:\n{warning}"));
            }
            let mut place = warning.strip_prefix(name).unwrap_or("").split(':').skip(1);
            let mut number = || place.next().and_then(|text| text.parse::<usize>().ok());
            let (Some(line), Some(column)) = (number(), number()) else {
                wrong.push(format!("{name}: no place:\n{warning}"));
                continue;
            };
            let rest: String = scene.lines().nth(line - 1).unwrap_or("").chars().skip(column - 1).collect();
            match wanted.iter().position(|token| rest.starts_with(token)) {
                Some(at) => drop(wanted.remove(at)),
                None => wrong.push(format!(
                    "{name}: {line}:{column} is at `{rest}`, which is not marked as doubtful:\n{warning}"
                )),
            }
        }
        wrong.extend(wanted.iter().map(|token| format!("{name}: no warning about `{token}`:\n{said}")));
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
}

/// A bundled lens whose odd glass is explained in its own file causes no warning, whatever part of its name is given.
#[test]
fn a_bundled_lens_is_itself_by_a_part_of_its_name() {
    for name in ["canon-fd-50-f1.8", "canon-fd-50", "Canon FD 50 f1.8"] {
        let output = run(&["check", "biotar-trix", "--set", &format!("lens.file={name}")]);
        assert_eq!((output.status.code(), text(&output.stderr)), (Some(0), String::new()), "{name}");
    }
}
