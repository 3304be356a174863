//! The rooms of the house, as `ARCHITECTURE.md` has them: what stands on what, and who touches disk, clock and terminal.
//!
//! Two tables of that page are read and held against the manifests and the sources: an arrow that is not in the table fails,
//! and so does one in it that nothing uses. Tests are no arrows: neither `[dev-dependencies]` nor what is compiled for tests.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

type Rooms = BTreeMap<String, BTreeSet<String>>;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Cells of the table of `ARCHITECTURE.md` whose head has these words.
fn table(head: &[&str]) -> Vec<Vec<String>> {
    let text = fs::read_to_string(root().join("ARCHITECTURE.md")).expect("the page is there");
    let cells =
        |line: &str| -> Vec<String> { line.trim_matches('|').split('|').map(|c| c.trim().to_owned()).collect() };
    let mut lines = text.lines().skip_while(|line| cells(line) != head);
    assert!(lines.next().is_some(), "no table {head:?} in ARCHITECTURE.md");
    lines.skip(1).take_while(|line| line.starts_with('|')).map(cells).collect()
}

/// `a`, `b` as names; `-` is none.
fn names(cell: &str) -> BTreeSet<String> {
    cell.split(',').map(|name| name.trim().trim_matches('`').to_owned()).filter(|name| name != "-").collect()
}

/// Folder of each room: of the program itself, and of the members of the workspace.
fn folders() -> BTreeMap<String, PathBuf> {
    let mut all = BTreeMap::from([("src".to_owned(), root().to_owned())]);
    for (parent, prefix) in [("crates", ""), ("plugins", "plugins/")] {
        for entry in fs::read_dir(root().join(parent)).expect("a folder").map(|entry| entry.expect("an entry")) {
            if entry.path().join("Cargo.toml").is_file() {
                all.insert(format!("{prefix}{}", entry.file_name().to_string_lossy()), entry.path());
            }
        }
    }
    all
}

/// The room that a package or crate of ours is: `spectra-plugin-sources` and `spectra_plugin_sources` are `plugins/sources`.
fn room(name: &str) -> Option<String> {
    let own = name.strip_prefix("spectra-").or_else(|| name.strip_prefix("spectra_"))?;
    Some(match own.strip_prefix("plugin").and_then(|rest| rest.strip_prefix(['-', '_'])) {
        _ if own == "plugins" => "plugins/all".to_owned(),
        Some(family) => format!("plugins/{family}"),
        None => own.to_owned(),
    })
}

/// What a manifest names outside of `[dev-dependencies]`.
fn manifest(folder: &Path) -> BTreeSet<String> {
    let text = fs::read_to_string(folder.join("Cargo.toml")).expect("a manifest");
    let mut counts = false;
    let mut found = BTreeSet::new();
    for line in text.lines() {
        if let Some(section) = line.strip_prefix('[') {
            let section = section.trim_end_matches(']');
            counts = section.ends_with("dependencies")
                && !section.ends_with("dev-dependencies")
                && !section.starts_with("workspace");
        } else if counts {
            let key = line.split(['.', '=', ' ']).next().unwrap_or_default();
            found.extend(room(key));
        }
    }
    found
}

fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).into_iter().flatten().map(|entry| entry.expect("an entry")) {
        let path = entry.path();
        if path.is_dir() {
            found.extend(rust_files(&path));
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            found.push(path);
        }
    }
    found.sort();
    found
}

/// Rust without comments and without what stands in strings and characters.
fn bare(text: &str) -> String {
    let chars: Vec<char> = text.chars().collect();
    let mut out = String::new();
    let mut i = 0;
    let starts = |i: usize, what: &str| what.chars().enumerate().all(|(k, c)| chars.get(i + k) == Some(&c));
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    while i < chars.len() {
        if starts(i, "//") {
            while i < chars.len() && chars[i] != '\n' {
                i += 1;
            }
        } else if starts(i, "/*") {
            let mut depth = 0;
            while i < chars.len() {
                let step = if starts(i, "/*") {
                    depth += 1;
                    2
                } else if starts(i, "*/") {
                    depth -= 1;
                    2
                } else {
                    1
                };
                i += step;
                if depth == 0 {
                    break;
                }
            }
        } else if (chars[i] == 'r' || starts(i, "br")) && !out.chars().next_back().is_some_and(is_word) {
            let open = i + if chars[i] == 'b' { 2 } else { 1 };
            let hashes = chars[open.min(chars.len())..].iter().take_while(|c| **c == '#').count();
            if chars.get(open + hashes) == Some(&'"') {
                let close: String = std::iter::once('"').chain(std::iter::repeat_n('#', hashes)).collect();
                i = open + hashes + 1;
                while i < chars.len() && !starts(i, &close) {
                    i += 1;
                }
                i += close.len();
                out.push_str("\"\"");
            } else {
                out.push(chars[i]);
                i += 1;
            }
        } else if chars[i] == '"' {
            i += 1;
            while i < chars.len() && chars[i] != '"' {
                i += if chars[i] == '\\' { 2 } else { 1 };
            }
            i += 1;
            out.push_str("\"\"");
        } else if chars[i] == '\'' && (chars.get(i + 1) == Some(&'\\') || chars.get(i + 2) == Some(&'\'')) {
            // A character, and no lifetime.
            i += if chars[i + 1] == '\\' { 3 } else { 2 };
            while i < chars.len() && chars[i] != '\'' {
                i += 1;
            }
            i += 1;
            out.push_str("' '");
        } else {
            out.push(chars[i]);
            i += 1;
        }
    }
    out
}

/// Whether an attribute keeps what follows it for tests: `#[cfg(test)]`, `#[cfg(all(test, ...))]`, `#[test]`.
fn is_for_tests(attribute: &str) -> bool {
    let words: Vec<&str> =
        attribute.split(|c: char| !c.is_alphanumeric() && c != '_').filter(|w| !w.is_empty()).collect();
    match words[..] {
        ["test"] => true,
        ["cfg", ref rest @ ..] => rest.contains(&"test") && !rest.contains(&"not") && !rest.contains(&"any"),
        _ => false,
    }
}

/// [`bare`] Rust without items for tests, and the names of modules in files of their own that are for tests.
fn without_tests(bare: &str) -> (String, Vec<String>) {
    let (mut out, mut modules) = (String::new(), Vec::new());
    let mut rest = bare;
    while let Some(at) = rest.find("#[") {
        let close = |text: &str| {
            let mut depth = 0;
            text.char_indices().find_map(|(i, c)| {
                depth += i32::from(c == '[') - i32::from(c == ']');
                (c == ']' && depth == 0).then_some(i + 1)
            })
        };
        let Some(length) = close(&rest[at + 1..]) else { break };
        let (attribute, after) = rest[at..].split_at(length + 1);
        out.push_str(&rest[..at]);
        if !is_for_tests(attribute) {
            out.push_str(attribute);
            rest = after;
            continue;
        }
        // The item ends with its first block, or with a semicolon outside of all brackets.
        let mut depth = 0;
        let end = after.char_indices().find_map(|(i, c)| {
            depth += i32::from("{([".contains(c)) - i32::from("})]".contains(c));
            (depth == 0 && (c == '}' || c == ';')).then_some(i + 1)
        });
        let (item, after) = after.split_at(end.unwrap_or(after.len()));
        if let Some(name) = item.strip_suffix(';').and_then(|item| item.split_whitespace().next_back()) {
            modules.push(name.to_owned());
        }
        rest = after;
    }
    out.push_str(rest);
    (out, modules)
}

/// What of a room's sources is compiled into the program: path and code.
fn sources(folder: &Path) -> Vec<(PathBuf, String)> {
    let mut skipped: Vec<PathBuf> = Vec::new();
    let mut found = Vec::new();
    for path in rust_files(&folder.join("src")) {
        let (code, modules) = without_tests(&bare(&fs::read_to_string(&path).expect("a source")));
        let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let own = path.parent().unwrap_or(folder);
        let inside = if ["lib", "main", "mod"].contains(&stem.as_str()) { own.to_owned() } else { own.join(stem) };
        for module in modules {
            skipped.push(inside.join(format!("{module}.rs")));
            skipped.push(inside.join(module));
        }
        found.push((path, code));
    }
    found.retain(|(path, _)| !skipped.iter().any(|skipped| path.starts_with(skipped)));
    found
}

/// Names of our crates in code.
fn crates_named(code: &str) -> BTreeSet<String> {
    let words = code.split(|c: char| !c.is_alphanumeric() && c != '_');
    words.filter(|word| word.starts_with("spectra_")).filter_map(room).collect()
}

fn stands_on() -> (Vec<String>, Rooms) {
    let rows = table(&["room", "its one job", "stands on"]);
    let order: Vec<String> = rows.iter().map(|row| row[0].trim_matches('`').to_owned()).collect();
    let rooms = order.iter().cloned().zip(rows.iter().map(|row| names(&row[2]))).collect();
    (order, rooms)
}

#[test]
fn rooms_stand_on_what_the_table_says() {
    let (order, rooms) = stands_on();
    let folders = folders();
    let mut faults = Vec::new();
    for name in folders.keys().filter(|name| !rooms.contains_key(*name)) {
        faults.push(format!("`{name}` is not in the table"));
    }
    for (i, name) in order.iter().enumerate() {
        let Some(folder) = folders.get(name) else {
            faults.push(format!("`{name}` is in the table and not in the house"));
            continue;
        };
        let stated = &rooms[name];
        let declared = manifest(folder);
        let used: BTreeSet<String> = sources(folder).iter().flat_map(|(_, code)| crates_named(code)).collect();
        for other in stated {
            if !order[..i].contains(other) {
                faults.push(format!("`{name}` stands on `{other}`, which does not stand above it in the table"));
            }
            if !declared.contains(other) {
                faults.push(format!("`{name}` stands on `{other}` by the table, and not by its manifest"));
            }
            if !used.contains(other) {
                faults.push(format!("`{name}` stands on `{other}` by the table, and no source of it names that"));
            }
        }
        for other in declared.difference(stated) {
            faults.push(format!("`{name}` stands on `{other}` by its manifest, and not by the table"));
        }
        for other in
            used.iter().filter(|other| folders.contains_key(*other) && *other != name && !stated.contains(*other))
        {
            faults.push(format!("a source of `{name}` names `{other}`, which the table does not let it stand on"));
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// What only some rooms touch, and how it is told in code.
const TOUCHED: [(&str, &[&str]); 5] = [
    ("disk", &["std::fs", "fs::"]),
    ("environment", &["std::env", "env::"]),
    ("terminal", &["println!", "print!", "eprintln!", "eprint!", "stdout()", "stderr()", "stdin()"]),
    ("clock", &["Instant::now", "SystemTime::now"]),
    ("threads", &["ThreadPoolBuilder"]),
];

/// Whether the code has it, and not as the end of a longer name.
fn has(code: &str, what: &str) -> bool {
    code.match_indices(what).any(|(at, _)| {
        let before = code[..at].chars().next_back();
        !before.is_some_and(|c| c.is_alphanumeric() || c == '_')
    })
}

#[test]
fn disk_clock_and_terminal_are_touched_where_the_table_says() {
    let rows = table(&["room", "touches", "why"]);
    let stated: Rooms = rows.iter().map(|row| (row[0].trim_matches('`').to_owned(), names(&row[1]))).collect();
    let mut faults = Vec::new();
    for row in &rows {
        if row[2].is_empty() {
            faults.push(format!("no reason for `{}`", row[0]));
        }
    }
    for (name, folder) in folders() {
        let stated = stated.get(&name).cloned().unwrap_or_default();
        let mut found = BTreeSet::new();
        for (path, code) in sources(&folder) {
            for (touched, words) in TOUCHED {
                if words.iter().any(|word| has(&code, word)) {
                    found.insert(touched.to_owned());
                    if !stated.contains(touched) {
                        let path = path.strip_prefix(root()).unwrap_or(&path).display();
                        faults.push(format!("{path}: `{name}` must not touch the {touched}"));
                    }
                }
            }
        }
        for touched in stated.difference(&found) {
            faults.push(format!("`{name}` touches no {touched}: strike it from the table"));
        }
    }
    for name in stated.keys().filter(|name| !folders().contains_key(*name)) {
        faults.push(format!("there is no room `{name}`"));
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn what_is_for_tests_is_told_from_what_is_not() {
    let text = r##"
        use a::B; // use std::fs
        const C: &str = "std::env"; const D: char = '"'; const E: &str = r#"spectra_film "quoted""#;
        fn f<'a>(x: &'a str) { g('\'', "{") }
        #[cfg(test)]
        mod far;
        #[cfg(all(test, feature = "x"))] #[path = "y.rs"] mod farther;
        #[cfg(not(test))]
        fn kept() {}
        #[cfg(test)]
        mod tests { fn h() { println!("}") } }
        #[test]
        fn t(x: [u8; 2]) { std::fs::read("x"); }
        fn last() { /* a /* b */ c */ spectra_core::math::exp(1.0) }
    "##;
    let (code, modules) = without_tests(&bare(text));
    assert_eq!(modules, ["far", "farther"]);
    for gone in ["std::fs", "std::env", "spectra_film", "println", "fn h", "fn t"] {
        assert!(!code.contains(gone), "{gone} in {code}");
    }
    for kept in ["use a::B", "fn f<'a>", "fn kept", "fn last"] {
        assert!(code.contains(kept), "{kept} in {code}");
    }
    assert_eq!(crates_named(&code).into_iter().collect::<Vec<_>>(), ["core"]);
    assert_eq!(room("spectra-plugin-oiio").as_deref(), Some("plugins/oiio"));
    assert!(has("use std::fs;", "std::fs") && has(" eprintln!()", "eprintln!") && !has("eprintln!()", "println!"));
}
