//! Collects the licenses, with their texts, of the crates that plugins add to a program.

use super::metadata::{Metadata, Package};
use super::program::Program;
use crate::licenses;
use crate::sources::{Sources, plain};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// Longest license text that is read, bytes; the longest usual license has 35 kB.
const LONGEST: u64 = 256 << 10;
/// Beginnings of the names of license files, in capitals.
const FILES: [&str; 5] = ["LICENSE", "LICENCE", "COPYING", "UNLICENSE", "NOTICE"];

/// License notices of crates that `spectra` itself does not contain.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Notices {
    /// Text of the notices: each crate with its license, then each license text once.
    pub text: String,
    /// Crates that state neither a license nor a file with one, as `name version`.
    pub unlicensed: Vec<String>,
}

/// Returns the notices of all crates linked into the program, except those of `spectra` and the crates that it contains anyway.
pub(super) fn of(graph: &Metadata, program: &Program, sources: &Sources) -> Notices {
    let ours = plain(sources.folder());
    let linked = linked(graph, &program.name);
    let is_new = |package: &&Package| {
        let own = package.name == program.name || plain(&package.manifest_path).starts_with(&ours);
        linked.contains(package.id.as_str()) && !own && !licenses::has(&package.name, &package.version)
    };
    let mut packages: Vec<&Package> = graph.packages.iter().filter(is_new).collect();
    packages.sort_by(|a, b| (&a.name, &a.version).cmp(&(&b.name, &b.version)));
    written(&packages)
}

/// Returns the packages whose code is in the program: all direct and indirect dependencies, without those of build scripts and tests,
/// and without procedural macros.
fn linked<'a>(graph: &'a Metadata, program: &str) -> BTreeSet<&'a str> {
    let packages: BTreeMap<&str, &Package> = graph.packages.iter().map(|p| (p.id.as_str(), p)).collect();
    let nodes = graph.resolve.iter().flat_map(|resolve| &resolve.nodes);
    let nodes: BTreeMap<&str, _> = nodes.map(|node| (node.id.as_str(), node)).collect();
    let mut todo: Vec<&str> = graph.packages.iter().filter(|p| p.name == program).map(|p| p.id.as_str()).collect();
    let mut found: BTreeSet<&str> = todo.iter().copied().collect();
    while let Some(id) = todo.pop() {
        for link in nodes.get(id).into_iter().flat_map(|node| &node.deps) {
            let is_linked = link.dep_kinds.iter().any(|kind| kind.kind.is_none())
                && packages.get(link.pkg.as_str()).is_some_and(|package| !package.is_macro());
            if is_linked && found.insert(&link.pkg) {
                todo.push(&link.pkg);
            }
        }
    }
    found
}

fn written(packages: &[&Package]) -> Notices {
    let mut notices = Notices::default();
    let mut texts: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for package in packages {
        let title = format!("{} {}", package.name, package.version);
        let files = files(package);
        let license = package.license.as_deref().filter(|license| !license.trim().is_empty());
        let stated = match license {
            Some(license) => license,
            None if package.license_file.is_some() => "see its text below",
            None => {
                notices.unlicensed.push(title.clone());
                "states no license"
            }
        };
        // Writing to a String cannot fail.
        let _ = writeln!(notices.text, "{title}: {stated}");
        for text in files.iter().filter_map(|file| read(file)) {
            texts.entry(text).or_default().push(title.clone());
        }
    }
    for (text, titles) in texts {
        let _ = write!(notices.text, "\n{}\n{}\n\n{text}\n", "-".repeat(100), titles.join(", "));
    }
    notices
}

/// Returns the license files in a package's folder, sorted by name.
fn files(package: &Package) -> Vec<PathBuf> {
    let folder = package.manifest_path.parent().unwrap_or(Path::new("."));
    let is_terms = |path: &PathBuf| {
        let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default().to_ascii_uppercase();
        path.is_file() && FILES.iter().any(|start| name.starts_with(start))
    };
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    let stated = package.license_file.iter().map(|file| folder.join(file));
    let found: BTreeSet<PathBuf> = entries.filter(is_terms).chain(stated).collect();
    found.into_iter().collect()
}

/// Reads a text without trailing spaces; `None` if it cannot be read, is too long or empty.
fn read(path: &Path) -> Option<String> {
    if std::fs::metadata(path).ok()?.len() > LONGEST {
        return None;
    }
    let text = String::from_utf8_lossy(&std::fs::read(path).ok()?).into_owned();
    let lines: Vec<&str> = text.trim().lines().map(str::trim_end).collect();
    Some(lines.join("\n")).filter(|text| !text.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn package(folder: &Path, name: &str, license: Option<&str>) -> serde_json::Value {
        let folder = folder.join(name);
        std::fs::create_dir_all(&folder).unwrap();
        let kind = if name == "macro" { "proc-macro" } else { "lib" };
        serde_json::json!({
            "id": name, "name": name, "version": "1.2.3", "manifest_path": folder.join("Cargo.toml"), "license": license,
            "license_file": null, "dependencies": [],
            "targets": [{"name": name, "crate_types": ["lib"], "kind": [kind]}],
        })
    }

    /// A plugin that adds two crates under the same terms. A macro, a crate for tests and one that every program has are left out.
    #[test]
    fn plugins_and_what_they_bring_are_listed() {
        let folder = tempfile::tempdir().unwrap();
        let at = folder.path();
        let has = |name: &str| licenses::has(name, "1.2.3");
        let (known, version) = a_known_crate();
        assert!(licenses::has(known, version) && !licenses::has(known, "") && !has("plugin"));
        let mut known_package = package(at, known, Some("MIT"));
        known_package["version"] = version.into();
        let link = |to: &str, kind: Option<&str>| serde_json::json!({"pkg": to, "dep_kinds": [{"kind": kind}]});
        let graph: Metadata = serde_json::from_value(serde_json::json!({
            "packages": [
                package(at, "program", None), package(at, "plugin", None), package(at, "one", Some("MIT")),
                package(at, "two", Some("MIT OR Apache-2.0")), package(at, "macro", Some("MIT")),
                package(at, "tester", Some("MIT")), known_package,
            ],
            "resolve": {"nodes": [
                {"id": "program", "deps": [link("plugin", None)]},
                {"id": "plugin", "deps": [
                    link("one", None), link("macro", None), link("tester", Some("dev")), link(known, None),
                ]},
                {"id": "one", "deps": [link("two", None)]},
            ]},
        }))
        .unwrap();
        std::fs::write(at.join("one/LICENSE-MIT"), "The same \r\nterms\r\n").unwrap();
        std::fs::write(at.join("two/licence.txt"), "\nThe same\nterms").unwrap();
        std::fs::write(at.join("two/lib.rs"), "no terms").unwrap();
        let program = Program { name: "program".into(), manifest: at.join("Cargo.toml"), target: at.to_owned() };
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        let sources = Sources::find(Some(&root), |_, _| Err(std::io::Error::other("not asked for"))).unwrap();
        let notices = of(&graph, &program, &sources);
        assert_eq!(notices.unlicensed, ["plugin 1.2.3"]);
        let line = "-".repeat(100);
        let wanted = format!(
            "one 1.2.3: MIT\nplugin 1.2.3: states no license\ntwo 1.2.3: MIT OR Apache-2.0\n\n{line}\none 1.2.3, two 1.2.3\n\n\
             The same\nterms\n"
        );
        assert_eq!(notices.text, wanted);
    }

    /// Returns a crate that every program contains, with its version.
    fn a_known_crate() -> (&'static str, &'static str) {
        let mut lines = include_str!("../notices.txt").lines();
        lines.find_map(|line| line.split_once(": ")?.0.split_once(' ')).expect("notices")
    }
}
