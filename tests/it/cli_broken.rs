//! Tests what the program says about a corpus of broken input, word for word.
//!
//! `tests/broken/NAME.yaml` is a scene with a mistake. If the mistake is in another file or on the command line,
//! `tests/broken/NAME/` holds the files, and `args` holds the arguments, one per line (`check scene.yaml` if absent).
//! `tests/broken/NAME.txt` is the output of `spectra`. `SPECTRA_BLESS=1 cargo test --test it cli_broken` writes the texts anew.
//!
//! A text could be wrong, so each case also states in comments what is broken. These comments are compared with the
//! places that the program reports:
//!
//! - `# broken: TEXT` in a file: one fault in that file starts at this text (`\t` is a tab).
//! - `# at: FILE:LINE:COLUMN` anywhere: one fault is at this place, in a file that cannot hold a comment.
//! - `# broken: TEXT` in `args`: one fault names this text and has no place in a file.
//!
//! The number of faults equals the number of such comments, and each fault has a hint. The exit code is 2, and no file is written.

use crate::common::{answer_in, repository, text, together};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// Smallest number of cases; fewer mean that some were lost.
const LEAST: usize = 40;

/// A case: its folder, its arguments and the files that it may name.
struct Case {
    name: String,
    folder: PathBuf,
    arguments: Vec<String>,
    /// Whether the case is a scene that `run` must reject like `check`.
    is_scene: bool,
    files: Vec<PathBuf>,
}

/// Places of faults that the comments of a case state.
#[derive(Default)]
struct Marks {
    /// Texts at which a fault starts, each with its file.
    tokens: Vec<(String, String)>,
    /// Places of faults, as `file:line:column`.
    places: Vec<String>,
    /// Texts on the command line that a fault names.
    words: Vec<String>,
}

#[test]
fn each_slip_is_told_where_it_is_and_what_to_do() {
    let root = repository("tests/broken");
    let bless = std::env::var_os("SPECTRA_BLESS").is_some();
    let cases = cases(&root);
    assert!(cases.len() >= LEAST, "{} cases", cases.len());
    let of = |case: &Case| -> Vec<String> {
        judge(case, &root, bless).into_iter().map(|fault| format!("{}: {fault}", case.name)).collect()
    };
    let wrong = together(&cases, of).concat();
    assert!(wrong.is_empty(), "{} complaints about {} cases\n\n{}", wrong.len(), cases.len(), wrong.join("\n\n"));
}

/// Checks that every text belongs to a case.
#[test]
fn every_text_belongs_to_a_case() {
    let root = repository("tests/broken");
    let names: Vec<String> = cases(&root).into_iter().map(|case| case.name).collect();
    for file in entries(&root).iter().filter(|path| path.extension().is_some_and(|e| e == "txt")) {
        let stem = file.file_stem().and_then(|stem| stem.to_str()).expect("plain names");
        assert!(names.iter().any(|name| name == stem), "{stem}.txt has no case");
    }
}

/// Returns what is wrong with the program's answer to a case.
fn judge(case: &Case, root: &Path, bless: bool) -> Vec<String> {
    let before = snapshot(&case.folder);
    let said = answer(case, &case.arguments);
    let mut wrong = said.1;
    let said = said.0;
    if case.is_scene {
        let mut run = case.arguments.clone();
        run[0] = "run".to_owned();
        let (again, more) = answer(case, &run);
        wrong.extend(more);
        if again != said {
            wrong.push(format!("`run` and `check` say different things:\n{again}"));
        }
    }
    if snapshot(&case.folder) != before {
        wrong.push("a file was written or changed".to_owned());
    }
    let expected = root.join(format!("{}.txt", case.name));
    if bless {
        fs::write(&expected, &said).expect("written");
    } else if fs::read_to_string(&expected).unwrap_or_default() != said {
        wrong.push(format!("the text differs from the expected one (SPECTRA_BLESS=1 writes it anew):\n{said}"));
    }
    wrong.extend(places_are_right(case, &said));
    wrong
}

/// Returns the program's output, and what is wrong with the way it was given.
fn answer(case: &Case, arguments: &[String]) -> (String, Vec<String>) {
    let output = answer_in(&case.folder, &arguments.iter().map(String::as_str).collect::<Vec<_>>());
    let (said, out) = (text(&output.stderr), text(&output.stdout));
    let mut wrong = Vec::new();
    if output.status.code() != Some(2) {
        wrong.push(format!("ends with {:?}, not 2:\n{out}{said}", output.status.code()));
    }
    if !out.is_empty() {
        wrong.push(format!("writes to standard output:\n{out}"));
    }
    if said.contains("panicked") || said.contains('\u{1b}') {
        wrong.push(format!("panics, or writes colors to a pipe:\n{said}"));
    }
    (said, wrong)
}

/// Compares the places that the program reports with the comments of the case.
fn places_are_right(case: &Case, said: &str) -> Vec<String> {
    let mut wrong = Vec::new();
    let marks = marks(case);
    let faults: Vec<&str> = said.split("\n\n").map(|fault| fault.split("\nerror: ").next().unwrap_or("")).collect();
    let wanted = marks.tokens.len() + marks.places.len() + marks.words.len();
    if faults.len() != wanted {
        wrong.push(format!("{} faults, but the comments state {wanted}:\n{said}", faults.len()));
    }
    let (mut tokens, mut places, mut words) = (marks.tokens, marks.places, marks.words);
    for fault in faults {
        if !fault.lines().any(|line| line.trim_start().starts_with("help: ")) {
            wrong.push(format!("no hint:\n{fault}"));
        }
        let header = fault.lines().find_map(|line| line.trim_start().strip_prefix("\u{256d}\u{2500}["));
        let place = header.and_then(|place| place.strip_suffix(']')).filter(|place| !place.starts_with("--"));
        let Some(place) = place else {
            match words.iter().position(|word| fault.contains(word.as_str())) {
                Some(at) => drop(words.remove(at)),
                None => wrong.push(format!("no place in a file:\n{fault}")),
            }
            continue;
        };
        if let Some(at) = places.iter().position(|known| known == place) {
            places.remove(at);
            continue;
        }
        match rest_of_line(case, place) {
            Err(reason) => wrong.push(format!("{place}: {reason}")),
            Ok((file, rest)) => {
                match tokens.iter().position(|(of, token)| *of == file && rest.starts_with(token.as_str())) {
                    Some(at) => drop(tokens.remove(at)),
                    None => wrong.push(format!("{place} is at `{rest}`, which is not marked as broken:\n{fault}")),
                }
            }
        }
    }
    for left in tokens.iter().map(|(_, token)| token).chain(&places).chain(&words) {
        wrong.push(format!("no fault mentions `{left}`"));
    }
    wrong
}

/// Returns the file of a place and the rest of its line from that place on.
fn rest_of_line(case: &Case, place: &str) -> Result<(String, String), String> {
    let mut parts = place.rsplitn(3, ':');
    let (column, line, file) = (parts.next(), parts.next(), parts.next());
    let number = |part: Option<&str>| part.and_then(|n| n.parse::<usize>().ok()).and_then(|n| n.checked_sub(1));
    let (Some(column), Some(line), Some(file)) = (number(column), number(line), file) else {
        return Err("no `file:line:column`".to_owned());
    };
    let bytes = fs::read(case.folder.join(file)).map_err(|error| error.to_string())?;
    let content = String::from_utf8_lossy(&bytes).into_owned();
    let line = content.lines().nth(line).ok_or("there is no such line")?;
    if column > line.chars().count() {
        return Err(format!("the line has {} columns", line.chars().count()));
    }
    Ok((file.to_owned(), line.chars().skip(column).collect()))
}

/// Collects the comments of all files of a case.
fn marks(case: &Case) -> Marks {
    let mut marks = Marks::default();
    for path in &case.files {
        let name = shown(path, &case.folder);
        let bytes = fs::read(path).expect("readable");
        for line in String::from_utf8_lossy(&bytes).lines().take_while(|line| line.starts_with("# ")) {
            if let Some(token) = line.strip_prefix("# broken: ") {
                match name.as_str() {
                    "args" => marks.words.push(token.to_owned()),
                    _ => marks.tokens.push((name.clone(), token.replace("\\t", "\t"))),
                }
            }
            marks.places.extend(line.strip_prefix("# at: ").map(str::to_owned));
        }
    }
    marks
}

fn cases(root: &Path) -> Vec<Case> {
    let mut cases = Vec::new();
    for path in entries(root) {
        let name = |path: &Path| path.file_stem().and_then(|stem| stem.to_str()).expect("plain names").to_owned();
        if path.is_dir() {
            let name = shown(&path, root);
            let args = fs::read_to_string(path.join("args")).ok();
            let is_scene = args.is_none();
            let args = args.unwrap_or_else(|| "check\nscene.yaml".to_owned());
            let arguments = args.lines().filter(|line| !line.starts_with('#')).map(str::to_owned).collect();
            cases.push(Case { name, arguments, is_scene, files: all_files(&path), folder: path });
        } else if path.extension().is_some_and(|ending| ending == "yaml") {
            let arguments = vec!["check".to_owned(), shown(&path, root)];
            cases.push(Case {
                name: name(&path),
                folder: root.to_owned(),
                arguments,
                is_scene: true,
                files: vec![path],
            });
        }
    }
    cases
}

/// Returns a path as the program names it from the folder.
fn shown(path: &Path, folder: &Path) -> String {
    path.strip_prefix(folder).expect("within").to_str().expect("plain names").to_owned()
}

fn entries(folder: &Path) -> Vec<PathBuf> {
    let mut entries: Vec<PathBuf> =
        fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("readable").path()).collect();
    entries.sort_unstable();
    entries
}

fn all_files(folder: &Path) -> Vec<PathBuf> {
    let inside = |path: PathBuf| if path.is_dir() { all_files(&path) } else { vec![path] };
    entries(folder).into_iter().flat_map(inside).collect()
}

/// Returns size and time of every file below a folder, except the texts, which may be written anew beside the cases.
fn snapshot(folder: &Path) -> BTreeMap<PathBuf, (u64, std::time::SystemTime)> {
    let files = all_files(folder).into_iter().filter(|path| path.extension().is_none_or(|ending| ending != "txt"));
    let of = |path: PathBuf| {
        let data = fs::metadata(&path).expect("readable");
        (path, (data.len(), data.modified().expect("a time")))
    };
    files.map(of).collect()
}
