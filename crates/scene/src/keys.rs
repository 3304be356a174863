//! Keys of scenes and data files: the pages that document them, keys by name or path, and the units of bare numbers.

use crate::schema::{FileKind, file_documentation, shared_documentation};
use spectra_core::names::{self, Match};
use spectra_core::registry::{self, Documentation, Parameter};

/// A documentation page: a kind of file, a kind of stage, or a stage, with its parameters.
#[derive(Clone, Debug)]
pub struct KeyPage {
    /// Name of the page for `spectra doc`.
    pub page: String,
    /// Prefix of the parameters' paths in a scene, such as `film.`.
    at: &'static str,
    /// What the page is about, in a sentence.
    pub summary: String,
    /// Parameters, by their keys on the page.
    pub parameters: Vec<Parameter>,
}

/// The keys that were found for a name or path, page by page.
#[derive(Clone, Debug)]
pub struct FoundKeys {
    /// Name or path that was looked up, in lower case and without the marks of kinds and lists.
    pub key: String,
    /// Name of each page that has the key, with the key and the keys below it.
    pub pages: Vec<(String, Vec<Parameter>)>,
}

/// Returns all pages with their keys: files first, then stages. The shared keys of each kind of stage come before its members.
#[must_use]
pub fn key_pages() -> Vec<KeyPage> {
    let mut all = Vec::new();
    for kind in FileKind::ALL {
        let documentation = file_documentation(kind);
        let (summary, parameters) = (documentation.summary, documentation.parameters);
        all.push(KeyPage { page: kind.name().to_owned(), at: "", summary, parameters });
    }
    let mut before = "";
    for stage in registry::list() {
        let at = match stage.stage {
            "source" => "source.",
            "color" => "source.color.",
            "wavelengths" => "wavelengths.",
            "surface" => "surfaces[].",
            "imager" => "imager.",
            "response" => "imager.response.",
            "film" => "film.",
            "coating" => "lens.coating.",
            "aperture" => "lens.aperture.",
            _ => "",
        };
        if stage.stage != before {
            before = stage.stage;
            if let Some(shared) = shared_documentation(stage.stage) {
                let (summary, parameters) = (shared.summary, shared.parameters);
                all.push(KeyPage { page: stage.stage.to_owned(), at, summary, parameters });
            }
        }
        let Documentation { summary, mut parameters, .. } = stage.documentation();
        // The page of the file lists these parameters already.
        if FileKind::ALL.iter().any(|kind| kind.name() == stage.stage) {
            parameters.clear();
        }
        all.push(KeyPage { page: format!("{}/{}", stage.stage, stage.name), at, summary, parameters });
    }
    all
}

/// Returns a path in lower case without the marks of kinds and lists: `output(rays)[].size` becomes `output.size`.
fn plain_path(path: &str) -> String {
    let mut out = String::new();
    let mut inside = false;
    for c in path.trim().to_lowercase().chars() {
        match c {
            '(' => inside = true,
            ')' => inside = false,
            '[' | ']' => {}
            '_' | ' ' => out.push('-'),
            c if !inside => out.push(c),
            _ => {}
        }
    }
    out
}

/// Finds the keys that `name` means, on all pages. Tries it as a whole path, then as a key's name or the end of a path, then as a
/// part of a key's name.
///
/// `is_named_elsewhere` tells that `name` is also a bundled file or a word of the glossary. It then does not count as a part of a
/// key's name.
///
/// # Errors
/// The keys that come nearest, if any.
pub fn find_keys(name: &str, is_named_elsewhere: bool) -> Result<FoundKeys, Vec<String>> {
    let pages = key_pages();
    let wanted = plain_path(name);
    if wanted.is_empty() {
        return Err(Vec::new());
    }
    let end = format!(".{wanted}");
    let collect = |fits: &dyn Fn(&str) -> bool| -> Vec<(String, Vec<Parameter>)> {
        let mut found: Vec<(String, Vec<Parameter>)> = Vec::new();
        for page in &pages {
            let full = |p: &Parameter| plain_path(&format!("{}{}", page.at, p.key));
            let heads: Vec<String> = page.parameters.iter().map(full).filter(|path| fits(path)).collect();
            let below = |path: &str| {
                heads
                    .iter()
                    .any(|head| path.strip_prefix(head.as_str()).is_some_and(|r| r.is_empty() || r.starts_with('.')))
            };
            let of_page: Vec<Parameter> = page.parameters.iter().filter(|p| below(&full(p))).cloned().collect();
            if !of_page.is_empty() {
                found.push((page.page.clone(), of_page));
            }
        }
        found
    };
    // A path with a dot is first matched as a whole; a bare name matches at the end of any path.
    let found = if wanted.contains('.') { collect(&|path| path == wanted) } else { Vec::new() };
    let found = if found.is_empty() { collect(&|path| path == wanted || path.ends_with(&end)) } else { found };
    if !found.is_empty() {
        return Ok(FoundKeys { key: wanted, pages: found });
    }
    let mut last: Vec<String> = Vec::new();
    for parameter in pages.iter().flat_map(|page| &page.parameters) {
        let path = plain_path(&parameter.key);
        let key = path.rsplit('.').next().unwrap_or(&path).to_owned();
        if !last.contains(&key) {
            last.push(key);
        }
    }
    match names::find(&wanted, last.iter().map(String::as_str)) {
        // Another meaning takes precedence over a part of a key: `tri-x` does not mean `matrix`.
        Match::One(key) if names::normalized(key) == names::normalized(&wanted) || !is_named_elsewhere => {
            find_keys(key, is_named_elsewhere)
        }
        Match::One(key) => Err(vec![key.to_owned()]),
        Match::Several(several) => Err(several.into_iter().map(str::to_owned).collect()),
        Match::Nothing => {
            Err(names::nearest(&wanted, last.iter().map(String::as_str)).map(str::to_owned).into_iter().collect())
        }
    }
}

/// Returns the unit that a number without a unit has at a path of a scene; `None` unless all pages agree on it.
#[must_use]
pub fn unit_of(path: &str) -> Option<String> {
    let wanted = plain_path(path);
    let mut units: Vec<String> = Vec::new();
    for page in key_pages().into_iter().filter(|page| !["lens", "stock", "spectrum"].contains(&page.page.as_str())) {
        let at = |p: &Parameter| plain_path(&format!("{}{}", page.at, p.key)) == wanted;
        units.extend(page.parameters.iter().filter(|p| at(p)).map(|p| p.unit.clone()));
    }
    units.dedup();
    match &units[..] {
        [unit] if !unit.is_empty() => Some(unit.clone()),
        _ => None,
    }
}
