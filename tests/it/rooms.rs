//! Tests the structure of the workspace that `ARCHITECTURE.md` states: which room (crate) depends on which, who touches disk, clock
//! and terminal, and that the files of a room do not import each other in circles.
//!
//! Two tables of that page are compared with the manifests and the sources. A dependency that is missing from the table fails, and so
//! does one in the table that nothing uses. Tests do not count: neither `[dev-dependencies]` nor code compiled for tests. Imports are
//! followed from file to file, through modules that only pass a name on.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

type Rooms = BTreeMap<String, BTreeSet<String>>;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Returns the cells of the table in `ARCHITECTURE.md` with these column heads.
fn table(head: &[&str]) -> Vec<Vec<String>> {
    let text = fs::read_to_string(root().join("ARCHITECTURE.md")).expect("the page is there");
    let cells =
        |line: &str| -> Vec<String> { line.trim_matches('|').split('|').map(|c| c.trim().to_owned()).collect() };
    let mut lines = text.lines().skip_while(|line| cells(line) != head);
    assert!(lines.next().is_some(), "no table {head:?} in ARCHITECTURE.md");
    lines.skip(1).take_while(|line| line.starts_with('|')).map(cells).collect()
}

/// Parses `a`, `b` as names; `-` means none.
fn names(cell: &str) -> BTreeSet<String> {
    cell.split(',').map(|name| name.trim().trim_matches('`').to_owned()).filter(|name| name != "-").collect()
}

/// Returns the folder of each room: of the program itself and of the members of the workspace.
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

/// Returns the room of one of our packages or crates: `spectra-plugin-sources` and `spectra_plugin_sources` are `plugins/sources`.
fn room(name: &str) -> Option<String> {
    let own = name.strip_prefix("spectra-").or_else(|| name.strip_prefix("spectra_"))?;
    Some(match own.strip_prefix("plugin").and_then(|rest| rest.strip_prefix(['-', '_'])) {
        _ if own == "plugins" => "plugins/all".to_owned(),
        Some(family) => format!("plugins/{family}"),
        None => own.to_owned(),
    })
}

/// Returns our crates that a manifest names outside of `[dev-dependencies]`.
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

/// Returns Rust code without comments and without the contents of strings and characters.
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
            // A character, not a lifetime.
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

/// Returns whether an attribute restricts the next item to tests: `#[cfg(test)]`, `#[cfg(all(test, ...))]`, `#[test]`.
fn is_for_tests(attribute: &str) -> bool {
    let words: Vec<&str> =
        attribute.split(|c: char| !c.is_alphanumeric() && c != '_').filter(|w| !w.is_empty()).collect();
    match words[..] {
        ["test"] => true,
        ["cfg", ref rest @ ..] => rest.contains(&"test") && !rest.contains(&"not") && !rest.contains(&"any"),
        _ => false,
    }
}

/// Returns [`bare`] Rust code without items for tests, and the names of modules for tests that have their own files.
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
        // The item ends with its first block, or with a semicolon outside all brackets.
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

/// Returns the sources of a room that are compiled into the program: path and code.
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

/// Returns the rooms of our crates that code names.
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
        faults.push(format!("`{name}` is missing from the table"));
    }
    for (i, name) in order.iter().enumerate() {
        let Some(folder) = folders.get(name) else {
            faults.push(format!("`{name}` is in the table, but there is no such folder"));
            continue;
        };
        let stated = &rooms[name];
        let declared = manifest(folder);
        let used: BTreeSet<String> = sources(folder).iter().flat_map(|(_, code)| crates_named(code)).collect();
        for other in stated {
            if !order[..i].contains(other) {
                faults.push(format!("`{name}` stands on `{other}`, which is not above it in the table"));
            }
            if !declared.contains(other) {
                faults.push(format!("`{name}` stands on `{other}` by the table, but not by its manifest"));
            }
            if !used.contains(other) {
                faults.push(format!("`{name}` stands on `{other}` by the table, but no source of it names that crate"));
            }
        }
        for other in declared.difference(stated) {
            faults.push(format!("`{name}` stands on `{other}` by its manifest, but not by the table"));
        }
        for other in
            used.iter().filter(|other| folders.contains_key(*other) && *other != name && !stated.contains(*other))
        {
            faults.push(format!("a source of `{name}` names `{other}`, which the table does not allow"));
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// Resources that only some rooms may touch, and the code that reveals it.
const TOUCHED: [(&str, &[&str]); 5] = [
    ("disk", &["std::fs", "fs::"]),
    ("environment", &["std::env", "env::"]),
    ("terminal", &["println!", "print!", "eprintln!", "eprint!", "stdout()", "stderr()", "stdin()"]),
    ("clock", &["Instant::now", "SystemTime::now"]),
    ("threads", &["ThreadPoolBuilder"]),
];

/// Returns whether the code contains a word, other than as the end of a longer name.
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
            faults.push(format!("`{name}` touches no {touched}: remove it from the table"));
        }
    }
    for name in stated.keys().filter(|name| !folders().contains_key(*name)) {
        faults.push(format!("there is no room `{name}`"));
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// A file of a room as a module: its path and its imports, each with its local name (`*`: all names).
struct Module {
    file: PathBuf,
    code: String,
    imports: Vec<(Vec<String>, String)>,
}

/// All modules of a room, by their paths.
type House = BTreeMap<Vec<String>, Module>;

fn is_of_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// Returns the texts of `use` items, from after the keyword to the semicolon.
fn use_items(code: &str) -> impl Iterator<Item = &str> {
    code.match_indices("use ").filter_map(|(at, word)| {
        let is_word = !code[..at].chars().next_back().is_some_and(is_of_word);
        is_word.then(|| code[at + word.len()..].split_once(';').map(|(tree, _)| tree)).flatten()
    })
}

/// Collects the leaves of a tree such as `a::{b, c::*, d as e}`.
fn leaves(tree: &str, before: &[String], found: &mut Vec<(Vec<String>, String)>) {
    let steps = |text: &str| -> Vec<String> {
        let own = text.split("::").map(str::trim).filter(|step| !step.is_empty());
        let own = own.filter(|step| before.is_empty() || *step != "self").map(str::to_owned);
        before.iter().cloned().chain(own).collect()
    };
    let Some((head, rest)) = tree.split_once('{') else {
        let (path, name) = tree.split_once(" as ").map_or((tree, None), |(path, name)| (path, Some(name.trim())));
        let path = steps(path);
        let name = name.map(str::to_owned).or(path.last().cloned()).unwrap_or_default();
        return found.push((path, name));
    };
    let (mut depth, mut from) = (0, 0);
    let (before, nested) = (steps(head), &rest[..rest.rfind('}').unwrap_or(rest.len())]);
    for (at, c) in nested.char_indices().chain([(nested.len(), ',')]) {
        depth += i32::from(c == '{') - i32::from(c == '}');
        if c == ',' && depth == 0 {
            if !nested[from..at].trim().is_empty() {
                leaves(&nested[from..at], &before, found);
            }
            from = at + 1;
        }
    }
}

fn house(files: Vec<(PathBuf, String)>, src: &Path) -> House {
    let module = |(file, code): (PathBuf, String)| {
        let own = file.strip_prefix(src).unwrap_or(&file).with_extension("");
        let mut path: Vec<String> = own.iter().map(|step| step.to_string_lossy().into_owned()).collect();
        path.pop_if(|last| ["lib", "main", "mod"].contains(&last.as_str()));
        let mut imports = Vec::new();
        use_items(&code).for_each(|tree| leaves(tree, &[], &mut imports));
        (path, Module { file, code, imports })
    };
    files.into_iter().map(module).collect()
}

/// Returns a path written in a module relative to the root of the room, or `None` if it leads out of the room.
fn from_root(house: &House, at: &[String], path: &[String]) -> Option<Vec<String>> {
    let (mut whole, mut rest) = (at.to_vec(), path);
    match path.first()?.as_str() {
        "crate" => (whole, rest) = (Vec::new(), &path[1..]),
        "self" => rest = &path[1..],
        "super" => {
            while rest.first().is_some_and(|step| step == "super") {
                (_, rest) = (whole.pop()?, &rest[1..]);
            }
        }
        first => {
            whole.push(first.to_owned());
            house.get(&whole)?;
            whole.pop();
        }
    }
    whole.extend_from_slice(rest);
    Some(whole)
}

fn has_item(code: &str, name: &str) -> bool {
    let words: Vec<&str> = code.split(|c| !is_of_word(c)).filter(|word| !word.is_empty()).collect();
    let items = ["fn", "struct", "enum", "trait", "type", "const", "static", "union", "macro_rules"];
    words.windows(2).any(|pair| items.contains(&pair[0]) && pair[1] == name)
}

/// Returns the module whose file defines what a path from the root of the room names, through modules that only pass it on. Returns
/// `None` if it belongs to another crate.
fn home(house: &House, path: &[String], steps_left: usize) -> Option<Vec<String>> {
    let known = (0..=path.len()).rev().find(|len| house.contains_key(&path[..*len]))?;
    let (at, rest) = path.split_at(known);
    let Some((name, more)) = rest.split_first().filter(|_| steps_left > 0) else { return Some(at.to_vec()) };
    for (import, _) in house[at].imports.iter().filter(|(_, own)| own == name) {
        let mut whole = from_root(house, at, import)?;
        whole.extend_from_slice(more);
        if whole != path {
            return home(house, &whole, steps_left - 1);
        }
    }
    let all = house[at].imports.iter().filter(|(_, own)| own == "*");
    let mut all = all.filter_map(|(import, _)| from_root(house, at, &import[..import.len() - 1]));
    let found = all.find_map(|whole| {
        let home = home(house, &whole, steps_left - 1)?;
        (home != at && has_item(&house[&home].code, name)).then_some(home)
    });
    found.or(Some(at.to_vec()))
}

/// Returns where a path in a file leads, if that counts. Paths within the file, and from a folder's own file into the folder, do not
/// count.
fn leads_to(house: &House, at: &[String], path: &[String]) -> Option<Vec<String>> {
    let path = path.strip_suffix(&["*".to_owned()]).unwrap_or(path);
    let found = home(house, &from_root(house, at, path)?, 16)?;
    (!found.starts_with(at)).then_some(found)
}

/// Returns what each module of a room imports or names by a path.
fn edges(house: &House) -> BTreeMap<Vec<String>, BTreeSet<Vec<String>>> {
    let of = |(at, module): (&Vec<String>, &Module)| {
        let code = module.code.replace("::<", "<");
        let words = code.split(|c| !is_of_word(c) && c != ':').filter(|word| !word.ends_with(':'));
        let paths = words.filter(|word| word.starts_with("crate::") || word.starts_with("super::"));
        let paths = paths.map(|word| word.split("::").map(str::to_owned).collect());
        let all = module.imports.iter().map(|(path, _)| path.clone()).chain(paths);
        (at.clone(), all.filter_map(|path: Vec<String>| leads_to(house, at, &path)).collect())
    };
    house.iter().map(of).collect()
}

/// Returns the modules of a circle, if there is one.
fn circle(edges: &BTreeMap<Vec<String>, BTreeSet<Vec<String>>>) -> Option<Vec<Vec<String>>> {
    let mut left: BTreeSet<&Vec<String>> = edges.keys().collect();
    loop {
        let ends: Vec<_> = left.iter().copied().filter(|at| !edges[*at].iter().any(|to| left.contains(to))).collect();
        if ends.is_empty() {
            break;
        }
        left.retain(|at| !ends.contains(at));
    }
    let mut way = vec![*left.first()?];
    loop {
        let next = edges[way[way.len() - 1]].iter().find(|to| left.contains(to))?;
        if let Some(from) = way.iter().position(|at| *at == next) {
            return Some(way[from..].iter().map(|at| (*at).clone()).collect());
        }
        way.push(next);
    }
}

/// Removes the edges that comments in a file justify, and returns what is wrong with these comments.
fn defended(
    house: &House,
    at: &[String],
    text: &str,
    edges: &mut BTreeMap<Vec<String>, BTreeSet<Vec<String>>>,
) -> Vec<String> {
    let mut faults = Vec::new();
    for (found, words) in text.match_indices("// A circle with `") {
        let (comment, below) = text[found + words.len()..].split_once('\n').unwrap_or_default();
        let Some((file, _)) = comment.split_once("`: ").filter(|(_, why)| !why.is_empty()) else {
            faults.push(format!("no reason: {comment}"));
            continue;
        };
        let below = bare(below.trim_start().trim_start_matches("pub "));
        let mut imports = Vec::new();
        if let Some((tree, _)) = below.strip_prefix("use ").and_then(|tree| tree.split_once(';')) {
            leaves(tree, &[], &mut imports);
        }
        let led = imports.iter().filter_map(|(path, _)| leads_to(house, at, path));
        let led: Vec<_> = led.filter(|to| house[to].file.ends_with(file)).collect();
        let own = edges.entry(at.to_vec()).or_default();
        let before = own.len();
        own.retain(|to| !led.contains(to));
        if own.len() == before {
            faults.push(format!("the `use` below does not lead to `{file}`"));
        }
    }
    faults
}

#[test]
fn files_import_each_other_in_no_circle_but_those_that_a_comment_defends() {
    let mut faults = Vec::new();
    for folder in folders().values() {
        let house = house(sources(folder), &folder.join("src"));
        let shown =
            |at: &Vec<String>| house[at].file.strip_prefix(root()).unwrap_or(&house[at].file).display().to_string();
        let mut edges = edges(&house);
        for (at, module) in &house {
            let text = fs::read_to_string(&module.file).expect("a source");
            let before = edges.clone();
            faults
                .extend(defended(&house, at, &text, &mut edges).iter().map(|fault| format!("{}: {fault}", shown(at))));
            for to in before[at].difference(&edges[at]) {
                // The import must be part of a circle; otherwise the comment is outdated.
                let (mut reached, mut open) = (BTreeSet::new(), vec![to]);
                while let Some(next) = open.pop() {
                    if reached.insert(next) {
                        open.extend(&before[next]);
                    }
                }
                if !reached.contains(at) {
                    faults.push(format!("{}: there is no circle with {}", shown(at), shown(to)));
                }
            }
        }
        while let Some(circle) = circle(&edges) {
            let files: Vec<String> = circle.iter().map(shown).collect();
            faults.push(format!("a circle: {} -> {}", files.join(" -> "), files[0]));
            edges.get_mut(&circle[0]).expect("one of them").remove(&circle[1]);
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// A manifest with `doctest = false` belongs to a crate without examples in its documentation.
#[test]
fn examples_of_the_documentation_are_run() {
    for (name, folder) in folders() {
        let manifest = fs::read_to_string(folder.join("Cargo.toml")).expect("a manifest");
        if !manifest.contains("doctest = false") {
            continue;
        }
        for file in rust_files(&folder.join("src")) {
            let text = fs::read_to_string(&file).expect("readable");
            let mut is_open = false;
            for line in text.lines().map(str::trim_start).filter(|line| line.starts_with("//")) {
                let Some(language) = line.trim_start_matches(['/', '!', ' ']).strip_prefix("```") else { continue };
                is_open = !is_open;
                let is_rust = ["", "rust", "no_run", "should_panic", "compile_fail"].contains(&language.trim());
                let is_template = file.components().any(|part| part.as_os_str() == "templates");
                assert!(!is_open || !is_rust || is_template, "{name}: an example in {} is not run", file.display());
            }
        }
    }
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

#[test]
fn circles_are_found_through_what_only_hands_on() {
    let file = |name: &str, code: &str| (PathBuf::from(name), code.to_owned());
    let names = |path: &[String]| path.join("/");
    let files = vec![
        file("lib.rs", "mod a; mod b; mod c; pub use b::{deep::B, other as another};"),
        file("a.rs", "use crate::{B, c::{self, C as D}}; use std::fmt; fn f() -> crate::another { }"),
        file("b/mod.rs", "mod deep; pub use deep::*; fn other() { deep::g() }"),
        file("b/deep.rs", "pub struct B; fn g(x: super::super::c::C) { super::other() }"),
        file("c.rs", "struct C;"),
    ];
    let mut house = house(files, Path::new(""));
    let all = edges(&house);
    let of = |at: &str| all[&vec![at.to_owned()]].iter().map(|to| names(to)).collect::<Vec<_>>();
    assert_eq!(of("a"), ["b", "b/deep", "c"]);
    assert!(of("b").is_empty() && of("c").is_empty() && circle(&all).is_none());
    let a = vec!["a".to_owned()];
    house
        .get_mut(&vec!["c".to_owned()])
        .expect("there")
        .imports
        .push((vec!["super".to_owned(), "a".to_owned()], "a".to_owned()));
    let mut all = edges(&house);
    assert!(circle(&all).is_some_and(|found| found.contains(&a)));
    let text = "// A circle with `deep.rs`: why.\nuse crate::B;\n// A circle with `c.rs`: why.\nuse crate::c;\n";
    assert_eq!(defended(&house, &a, text, &mut all).len(), 0);
    assert!(circle(&all).is_none());
    assert_eq!(defended(&house, &a, "// A circle with `c.rs`: why.\nuse std::fmt;", &mut all).len(), 1);
    assert_eq!(defended(&house, &a, "// A circle with `c.rs`: \nuse crate::c;", &mut all).len(), 1);
}
