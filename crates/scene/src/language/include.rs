//! The `include` key: a scene on top of others.

use super::merge::merge;
use crate::resources::{of_user, read_yaml};
use crate::yaml;
use schemars::JsonSchema;
use spectra_core::names::nearest;
use spectra_core::params::{Fault, Faults, Node, Params, Value};
use std::collections::BTreeSet;
use std::path::{Component, Path, PathBuf};

/// Longest chain of files that include each other.
const MAX_DEPTH: usize = 16;
/// Largest number of files in one scene; a file that is included twice counts twice.
const MAX_FILES: usize = 256;
/// The key `include` of a scene.
pub(super) const INCLUDE: &str = "include";

/// The value of `include` as written, for the schema.
#[derive(JsonSchema)]
#[serde(untagged)]
#[expect(dead_code, reason = "its form is all that is wanted of it")]
pub(crate) enum Form {
    /// The name of one file.
    One(String),
    /// A list of files; later ones go on top.
    Several(Vec<String>),
}

/// A scene merged with its includes, and the files that it is made of.
pub(super) struct Included {
    /// The merged tree; each value keeps the place where it was written.
    pub root: Node,
    /// Names of the included files in order, without the scene itself.
    pub files: Vec<String>,
    /// Folders of the included files on disk, in order, without duplicates.
    pub folders: Vec<PathBuf>,
    /// Names of the variables that any of the files refers to.
    pub references: BTreeSet<String>,
}

/// Merges a scene with the files that it includes, and with their includes.
///
/// # Errors
/// A file that is not found or cannot be read; every fault in it; an include chain that closes on itself.
pub(super) fn resolve(root: Node) -> Result<Included, Faults> {
    let mut reader = Reader {
        chain: vec![identity(&root.file.name)],
        read: 0,
        files: Vec::new(),
        folders: Vec::new(),
        references: BTreeSet::new(),
    };
    let root = reader.expand(root)?;
    Ok(Included { root, files: reader.files, folders: reader.folders, references: reader.references })
}

struct Reader {
    /// Files from the scene down to the one that is being read.
    chain: Vec<String>,
    /// Number of files read so far.
    read: usize,
    files: Vec<String>,
    folders: Vec<PathBuf>,
    references: BTreeSet<String>,
}

impl Reader {
    fn expand(&mut self, mut root: Node) -> Result<Node, Faults> {
        super::variables::references(&root, &mut self.references);
        let Value::Map(entries) = &mut root.value else { return Ok(root) };
        let Some(at) = entries.iter().position(|(key, _)| key.text == INCLUDE) else { return Ok(root) };
        let (_, list) = entries.remove(at);
        let items = match list.value {
            Value::Null => Vec::new(),
            Value::Seq(items) => items,
            _ => vec![list],
        };
        let mut faults = Faults::new();
        let mut below: Option<Node> = None;
        for item in &items {
            let Some(tree) = faults.take(self.file(item)) else { continue };
            below = Some(match below {
                Some(base) => merge(base, tree),
                None => tree,
            });
        }
        faults.into_result(())?;
        let merged = below.map_or_else(|| root.clone(), |base| merge(base, root.clone()));
        if super::count(&merged) > yaml::MAX_NODES {
            let fault =
                root.fault(format!("with what it includes, the scene has more than {} values", yaml::MAX_NODES));
            return Err(fault.path(INCLUDE).into());
        }
        Ok(merged)
    }

    /// Reads one file and merges it with its includes.
    fn file(&mut self, item: &Node) -> Result<Node, Faults> {
        let Some(name) = item.as_str() else {
            let fault = item.fault("`include` must name a file").path(INCLUDE);
            return Err(fault
                .hint("such as `include: base.yaml`, or a list: `include: [camera.yaml, light.yaml]`")
                .into());
        };
        self.read += 1;
        if self.read > MAX_FILES {
            return Err(item.fault(format!("more than {MAX_FILES} files are included")).path(INCLUDE).into());
        }
        let found = find(name, item)?;
        let identity = identity(&found.name());
        let chain = || {
            let short =
                |name: &String| Path::new(name).file_name().map_or(name.clone(), |n| n.to_string_lossy().into_owned());
            self.chain.iter().chain([&identity]).map(short).collect::<Vec<_>>().join(" -> ")
        };
        if self.chain.contains(&identity) {
            let fault = item.fault(format!("`{name}` includes itself")).path(INCLUDE);
            return Err(fault.hint(format!("the chain is {}", chain())).into());
        }
        if self.chain.len() >= MAX_DEPTH {
            let fault = item.fault(format!("files include each other more than {MAX_DEPTH} deep")).path(INCLUDE);
            return Err(fault.hint(format!("the chain is {}", chain())).into());
        }
        let tree = found.read().map_err(|faults| placed(faults, item))?;
        // A scene is a map; anything else is reported at its own place.
        Params::section(tree.clone(), "")?;
        if !self.files.contains(&found.name()) {
            self.files.push(found.name());
        }
        if let FoundInclude::Disk(path) = &found {
            let folder = path.parent().map(Path::to_owned).unwrap_or_default();
            if !self.folders.contains(&folder) {
                self.folders.push(folder);
            }
        }
        self.chain.push(identity);
        let expanded = self.expand(tree);
        self.chain.pop();
        expanded
    }
}

/// A file that was found.
enum FoundInclude {
    Disk(PathBuf),
    /// Name of a bundled file.
    Bundled(String),
}

impl FoundInclude {
    fn name(&self) -> String {
        match self {
            Self::Disk(path) => path.display().to_string(),
            Self::Bundled(name) => format!("bundled:{name}"),
        }
    }

    fn read(&self) -> Result<Node, Faults> {
        match self {
            Self::Disk(path) => read_yaml(path),
            Self::Bundled(name) => yaml::parse_bytes(&self.name(), spectra_data::get(name).unwrap_or_default()),
        }
    }
}

/// Finds the file that `item` names: beside the file that contains `item`, otherwise a bundled scene.
fn find(name: &str, item: &Node) -> Result<FoundInclude, Fault> {
    const ENDINGS: [&str; 3] = ["", ".yaml", ".yml"];
    if let Some(folder) = item.file.folder() {
        let found =
            ENDINGS.iter().map(|ending| plain(&folder.join(of_user(format!("{name}{ending}"))))).find(|p| p.is_file());
        if let Some(path) = found {
            return Ok(FoundInclude::Disk(path));
        }
    }
    let beside =
        item.file.name.strip_prefix("bundled:").and_then(|name| name.rsplit_once('/')).map(|(folder, _)| folder);
    let folders = beside.into_iter().chain(["scenes"]);
    let bundled = folders.flat_map(|folder| ENDINGS.map(|ending| format!("{folder}/{name}{ending}")));
    if let Some(name) = bundled.into_iter().find(|name| spectra_data::get(name).is_some()) {
        return Ok(FoundInclude::Bundled(name));
    }
    if let Ok(name) = crate::bundled::scene_file(name) {
        return Ok(FoundInclude::Bundled(name));
    }
    let missing = if crate::hints::is_file_name(name) { "no such file" } else { "no scene or file of this name" };
    let fault = item.fault(format!("`{name}`: {missing}")).path(INCLUDE);
    Err(fault.hint(match near(name, item) {
        Some(near) => format!("did you mean `{near}`?"),
        None => "a scene file, relative to the file that includes it, or the name of a bundled scene".to_owned(),
    }))
}

/// Returns the most similar name, on disk or bundled.
fn near(name: &str, item: &Node) -> Option<String> {
    let bundled = spectra_data::list("scenes/").filter_map(|n| n.strip_prefix("scenes/")?.strip_suffix(".yaml"));
    let mut names: Vec<String> = bundled.map(str::to_owned).collect();
    if let Some(folder) = item.file.folder() {
        let wanted = folder.join(name);
        let folder = wanted.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let beside = std::fs::read_dir(folder).into_iter().flatten().take(10_000).flatten();
        let scenes = beside
            .filter_map(|e| e.file_name().into_string().ok())
            .filter(|n| n.ends_with(".yaml") || n.ends_with(".yml"));
        names.extend(scenes);
    }
    nearest(name, names.iter().map(String::as_str)).map(str::to_owned)
}

/// Returns a text that is equal for two names of the same file.
fn identity(name: &str) -> String {
    std::fs::canonicalize(name).map_or_else(|_| name.to_owned(), |path| path.display().to_string())
}

/// Places faults that have no place, such as of a file that cannot be read, at the name of the file.
fn placed(faults: Faults, item: &Node) -> Faults {
    let at = |fault: Fault| {
        if fault.place.is_some() { fault } else { Fault { place: Some(item.place()), ..fault }.path(INCLUDE) }
    };
    faults.into_iter().map(at).collect::<Vec<_>>().into()
}

/// Returns the path without `.` components, as users write it.
fn plain(path: &Path) -> PathBuf {
    path.components().filter(|c| *c != Component::CurDir).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::language::yaml_writer::one_line;

    /// Writes files and resolves the first one.
    fn resolved(files: &[(&str, &str)]) -> Result<(tempfile::TempDir, Included), String> {
        let folder = tempfile::tempdir().expect("a folder");
        for (name, text) in files {
            let path = folder.path().join(name);
            std::fs::create_dir_all(path.parent().expect("a parent")).expect("a folder");
            std::fs::write(path, text).expect("written");
        }
        let root = read_yaml(&folder.path().join(files[0].0)).map_err(|faults| faults.to_string())?;
        let strip = |faults: Faults| faults.to_string().replace(&folder.path().display().to_string(), "");
        resolve(root).map_err(strip).map(|included| (folder, included))
    }

    #[test]
    fn later_files_and_the_scene_itself_win() {
        let (folder, included) = resolved(&[
            ("scene.yaml", "include: [sub/a.yaml, b]\nx: {own: 1}\n"),
            ("sub/a.yaml", "include: deep.yaml\nx: {own: a, a: a, both: a}\n"),
            ("sub/deep.yaml", "x: {deep: d, a: d}\ny: [1]\n"),
            ("b.yaml", "x: {both: b}\n"),
        ])
        .unwrap_or_else(|text| panic!("{text}"));
        assert_eq!(one_line(&included.root), "{x: {deep: d, a: a, own: 1, both: b}, y: [1]}");
        let names: Vec<&str> = included.files.iter().filter_map(|f| f.rsplit('/').next()).collect();
        assert_eq!(names, ["a.yaml", "deep.yaml", "b.yaml"]);
        assert_eq!(included.folders, [folder.path().join("sub"), folder.path().to_owned()]);
        let place = included.root.at_path("x.deep").expect("there").fault("x").place_text();
        assert!(place.is_some_and(|p| p.ends_with("sub/deep.yaml:1:11")));
    }

    #[test]
    fn bundled_scenes_are_included_by_name() {
        let (_folder, included) = resolved(&[("scene.yaml", "include: biotar-ortho\nrender: {samples: 1}\n")])
            .unwrap_or_else(|text| panic!("{text}"));
        assert_eq!(included.files, ["bundled:scenes/biotar-ortho.yaml"]);
        assert_eq!(included.root.at_path("render.samples").and_then(Node::as_str), Some("1"));
        assert_eq!(included.root.at_path("render.seed").and_then(Node::as_str), Some("1"));
    }

    #[test]
    fn what_cannot_be_included_is_told_at_its_place() {
        let long: Vec<(String, String)> =
            (0..20).map(|i| (format!("f{i}.yaml"), format!("include: f{}.yaml\n", i + 1))).collect();
        let long: Vec<(&str, &str)> = long.iter().map(|(n, t)| (n.as_str(), t.as_str())).collect();
        let bomb: Vec<(String, String)> =
            (0..12).map(|i| (format!("f{i}.yaml"), format!("include: [f{0}, f{0}]\n", i + 1))).collect();
        let mut bomb: Vec<(&str, &str)> = bomb.iter().map(|(n, t)| (n.as_str(), t.as_str())).collect();
        bomb.push(("f12.yaml", "x: 1\n"));
        for (files, said) in [
            (
                vec![("s.yaml", "a: 1\ninclude: [b, 3]\n"), ("basis.yaml", "x: 1")],
                "/s.yaml:2:11: `b`: no scene or file of this name",
            ),
            (vec![("s.yaml", "include: basi.yaml"), ("basis.yaml", "x: 1")], "did you mean `basis.yaml`?"),
            (vec![("s.yaml", "include: {a: 1}")], "/s.yaml:1:10: `include` must name a file"),
            (vec![("s.yaml", "include: s.yaml")], "`s.yaml` includes itself (the chain is s.yaml -> s.yaml)"),
            (
                vec![("s.yaml", "include: t.yaml"), ("t.yaml", "x: 1\ninclude: ./s.yaml")],
                "/t.yaml:2:10: `./s.yaml` includes itself (the chain is s.yaml -> t.yaml -> s.yaml)",
            ),
            (vec![("s.yaml", "include: t.yaml"), ("t.yaml", "- 1")], "/t.yaml:1:1: found a list"),
            (vec![("s.yaml", "include: t.yaml"), ("t.yaml", "a: [1")], "/t.yaml:1:4: `[` is never closed"),
            (long, "files include each other more than 16 deep (the chain is f0.yaml -> f1.yaml"),
            (bomb, "more than 256 files are included"),
        ] {
            let text = resolved(&files).map(|_| ()).expect_err(said);
            assert!(text.contains(said), "{text}");
        }
    }
}
