//! Files for stages: beside the scene first, then bundled.

use crate::bundled::{Bundled, camera_films, other_kind};
use crate::hints::{FileIs, other_file};
use crate::mistake_hints::other_films;
use crate::yaml;
use spectra_core::names::nearest;
use spectra_core::params::{Fault, Faults, Node, Params, SourceFile};
use spectra_core::resources::{FoundFile, Resource, ResourceError, Resources};
use spectra_exchange::Format;
use std::borrow::Cow;
use std::io::Read;
use std::path::{Path, PathBuf};

/// Largest number of similar names that are suggested; a folder may hold thousands of numbered pictures.
const MOST_NEAR: usize = 5;

/// Size limit of a YAML document, bytes.
const MAX_DOCUMENT: u64 = 4 << 20;

/// Name of the ideal lens that stands for no lens. `spectra film develop` records it for a picture whose own pixels expose the
/// film.
pub const NO_LENS: &str = "no-lens";
/// F-number of the ideal lens named [`NO_LENS`]. Its focal length does not matter, because the picture fills the frame.
pub const NO_LENS_F_NUMBER: f64 = 2.8;

/// Finds files beside the scene, then in other folders, then among the bundled data.
#[derive(Clone, Debug)]
pub struct FileResources {
    folder: PathBuf,
    /// Folders that are searched after `folder`.
    others: Vec<PathBuf>,
}

impl FileResources {
    /// Returns a finder for files in and under `folder`; absolute paths are used as they are.
    #[must_use]
    pub fn beside(folder: &Path) -> Self {
        Self { folder: folder.to_owned(), others: Vec::new() }
    }

    /// Adds `folders` to search, in this order, for files that are not in the first folder. They are the folders of the files
    /// that a scene includes.
    #[must_use]
    pub fn and_beside(mut self, folders: &[PathBuf]) -> Self {
        for folder in folders {
            if *folder != self.folder && !self.others.contains(folder) {
                self.others.push(folder.clone());
            }
        }
        self
    }

    /// Returns all folders on disk in search order.
    fn folders(&self) -> impl Iterator<Item = &PathBuf> {
        std::iter::once(&self.folder).chain(&self.others)
    }

    /// Returns the part of a message that names the searched folders; empty if there is only one folder.
    fn looked(&self) -> String {
        if self.others.is_empty() {
            return String::new();
        }
        let shown = |folder: &PathBuf| {
            if folder.as_os_str().is_empty() { ".".to_owned() } else { folder.display().to_string() }
        };
        let folders: Vec<String> = self.folders().map(shown).collect();
        format!(" (looked in {}, and among the bundled data)", folders.join(", "))
    }
}

/// Expands `~/photo.jpg` to the user's home folder, as shells do.
pub(crate) fn of_user(path: String) -> PathBuf {
    match (path.strip_prefix("~/"), std::env::home_dir()) {
        (Some(rest), Some(home)) if !home.as_os_str().is_empty() => home.join(rest),
        _ => path.into(),
    }
}

fn no_lens() -> Result<Params, Faults> {
    const FOCAL_MM: f64 = 100.0;
    let radius_mm = FOCAL_MM / (2.0 * NO_LENS_F_NUMBER);
    let surface = format!(
        "{{kind: thin-lens, focal-length: {FOCAL_MM}, thickness: {FOCAL_MM}, semi-diameter: {radius_mm}, stop: true}}"
    );
    let name = format!("no lens (the picture itself, as an ideal lens at f/{NO_LENS_F_NUMBER} images it)");
    let text = format!("name: {name}\nsurfaces: [{surface}]\n");
    Params::section(yaml::parse(SourceFile::new(NO_LENS, text))?, "")
}

impl Resources for FileResources {
    fn read(
        &self,
        path: &str,
        folders: &[&str],
        endings: &[&str],
        limit_bytes: u64,
    ) -> Result<Resource, ResourceError> {
        let endings = || std::iter::once("").chain(endings.iter().copied());
        for folder in self.folders() {
            for ending in endings() {
                let on_disk = plain(&folder.join(of_user(format!("{path}{ending}"))));
                if on_disk.is_file() {
                    let bytes = read_file(&on_disk, limit_bytes)?;
                    let folder = on_disk.parent().map(Path::to_owned);
                    let name = from_here(&on_disk).display().to_string();
                    return Ok(Resource { name, folder, bytes: Cow::Owned(bytes) });
                }
            }
        }
        if let Some(found) = bundled(path, folders, &endings().collect::<Vec<_>>()) {
            return Ok(found);
        }
        // `path` may be a part of a name, or a name in another spelling.
        match named(path, folders, &endings().collect::<Vec<_>>()).map(|kind| kind.find(path)) {
            Some(Ok(name)) => {
                if let Some(found) = bundled(&name, folders, &endings().collect::<Vec<_>>()) {
                    return Ok(found);
                }
            }
            Some(Err(several)) if !several.is_empty() => return Err(ResourceError::NotFound(several)),
            Some(Err(_)) | None => {}
        }
        if plain(&self.folder.join(of_user(path.to_owned()))).is_dir() {
            return Err(ResourceError::Io("this is a folder; a file is expected".to_owned()));
        }
        Err(ResourceError::NotFound(self.near(path, folders)))
    }

    fn find(
        &self,
        path: &str,
        folders: &[&str],
        endings: &[&str],
        limit_bytes: u64,
    ) -> Result<FoundFile, ResourceError> {
        for folder in self.folders() {
            for ending in std::iter::once("").chain(endings.iter().copied()) {
                let on_disk = plain(&folder.join(of_user(format!("{path}{ending}"))));
                if on_disk.is_file() {
                    let found = FoundFile::on_disk(from_here(&on_disk).display().to_string(), on_disk);
                    let size = found.size_bytes()?;
                    if size > limit_bytes {
                        return Err(ResourceError::TooLarge(size, limit_bytes));
                    }
                    found.open()?;
                    return Ok(found);
                }
            }
        }
        self.read(path, folders, endings, limit_bytes).map(|read| FoundFile::bytes(read.name, read.bytes))
    }

    fn document(&self, path: &str, folders: &[&str], endings: &[&str]) -> Result<Params, Faults> {
        if path == NO_LENS && folders == ["lenses"] {
            return no_lens();
        }
        // A lens file of another program is read as the lens file that an import would write.
        let foreign = Format::of_name(path).filter(|_| folders.contains(&"lenses"));
        let missing = match folders {
            _ if crate::hints::is_file_name(path) => "no such file",
            ["lenses"] => "no lens or file of this name",
            ["spectra/film"] => "no film stock or file of this name",
            _ => "no such file",
        };
        let limit = if foreign.is_some() { spectra_exchange::MAX_BYTES } else { MAX_DOCUMENT };
        let resource = self.read(path, folders, endings, limit).map_err(|e| match &e {
            ResourceError::NotFound(near) if near.is_empty() => {
                let hint = named(path, folders, endings).and_then(|kind| other_kind(path, kind)).unwrap_or_else(|| {
                    match folders {
                        ["lenses"] => {
                            format!(
                                "name a file beside the scene, or a bundled lens: {}",
                                Bundled::Lens.names().join(", ")
                            )
                        }
                        ["spectra/film"] if !crate::hints::is_file_name(path) => other_films(path, &camera_films()),
                        _ => "a file is looked for beside the scene, then among the bundled ones".to_owned(),
                    }
                });
                Fault::new(format!("`{path}`: {missing}{}", self.looked())).hint(hint)
            }
            ResourceError::NotFound(near) => Fault::new(format!("`{path}`: {missing}{}", self.looked()))
                .hint(format!("did you mean {}?", list(near))),
            ResourceError::TooLarge(..) => Fault::new(format!("`{path}`: {e}")).hint("is this the right file?"),
            ResourceError::Io(_) => Fault::new(format!("`{path}`: {e}")).hint("name a file that can be read"),
        })?;
        let node = match foreign {
            None => yaml::parse_bytes(&resource.name, &resource.bytes)?,
            Some(format) => {
                let lens = spectra_exchange::read(format, &resource.name, &resource.bytes)?;
                let text =
                    spectra_exchange::yaml::write(&lens, Path::new(path).file_name().and_then(|name| name.to_str()));
                yaml::parse(SourceFile::new(resource.name, text))?
            }
        };
        let wanted = match folders {
            ["lenses"] => Some(FileIs::Lens),
            ["spectra/film"] => Some(FileIs::Stock),
            _ => None,
        };
        match wanted.and_then(|wanted| other_file(&node, wanted)) {
            Some(fault) => Err(fault.into()),
            None => Params::section(node, ""),
        }
    }
}

impl FileResources {
    /// Returns the most similar names, bundled or on disk.
    fn near(&self, path: &str, folders: &[&str]) -> Vec<String> {
        let mut names: Vec<String> = folders
            .iter()
            .flat_map(|folder| {
                let prefix = format!("{folder}/");
                spectra_data::list(&prefix)
                    .filter_map(|name| name.strip_prefix(&prefix).map(str::to_owned))
                    .filter_map(|name| name.rsplit_once('.').map(|(stem, _)| stem.to_owned()))
                    .collect::<Vec<_>>()
            })
            .collect();
        let here = |folder: &Path| if folder.as_os_str().is_empty() { PathBuf::from(".") } else { folder.to_owned() };
        for folder in self.folders() {
            let wanted = folder.join(path);
            if let Some(entries) = wanted.parent().and_then(|folder| std::fs::read_dir(here(folder)).ok()) {
                names.extend(entries.take(10_000).flatten().filter_map(|e| e.file_name().into_string().ok()));
            }
        }
        if let Some(near) = nearest(path, names.iter().map(String::as_str)) {
            return vec![near.to_owned()];
        }
        // A misspelled beginning: `heliso-44` for `helios-44-58-f2`.
        let words = path.split('-').count();
        let beginning = |name: &String| name.split('-').take(words).collect::<Vec<_>>().join("-");
        let beginnings: Vec<String> = names.iter().map(beginning).collect();
        if let Some(near) = nearest(path, beginnings.iter().map(String::as_str)) {
            let alike = names.iter().zip(&beginnings).filter(|(_, own)| *own == near);
            return alike.map(|(name, _)| name.clone()).take(MOST_NEAR).collect();
        }
        // `a\b.png` means a file in a folder on one system only; `biotar-50` is a part of a name.
        let slashed = path.replace('\\', "/");
        if slashed != path && self.folder.join(&slashed).is_file() {
            return vec![slashed];
        }
        let part = path.to_lowercase();
        let mut holding: Vec<String> =
            names.into_iter().filter(|n| part.len() >= 4 && n.to_lowercase().contains(&part)).collect();
        holding.sort_unstable();
        holding.dedup();
        holding.truncate(4);
        holding
    }
}

fn list(names: &[String]) -> String {
    const MOST: usize = 6;
    let shown: Vec<String> = names.iter().take(MOST).map(|n| format!("`{n}`")).collect();
    shown.join(" or ") + if names.len() > MOST { " or one of the others" } else { "" }
}

/// Returns the kind of bundled data that `path` can name; `None` if it looks like a file name.
fn named(path: &str, folders: &[&str], endings: &[&str]) -> Option<Bundled> {
    if !endings.contains(&".yaml") {
        return None;
    }
    // `f1.4` ends a name of a lens, `.yaml` one of a file.
    let ending = Path::new(path).extension().and_then(|ending| ending.to_str()).unwrap_or_default();
    if path.contains(['/', '\\']) || ending.starts_with(|c: char| c.is_ascii_alphabetic()) {
        return None;
    }
    folders.iter().find_map(|folder| Bundled::in_folder(folder))
}

/// Returns the bundled file of exactly this name.
fn bundled(path: &str, folders: &[&str], endings: &[&str]) -> Option<Resource> {
    for folder in folders {
        for ending in endings {
            let name = format!("{folder}/{path}{ending}");
            if let Some(bytes) = spectra_data::get(&name) {
                return Some(Resource { name: format!("bundled:{name}"), folder: None, bytes: Cow::Borrowed(bytes) });
            }
        }
    }
    None
}

/// Reads and parses a YAML file.
pub(crate) fn read_yaml(path: &Path) -> Result<Node, Faults> {
    let name = path.display().to_string();
    match read_file(path, yaml::MAX_BYTES as u64) {
        Ok(bytes) => yaml::parse_bytes(&name, &bytes),
        Err(ResourceError::TooLarge(bytes, _)) => Err(yaml::too_large(&name, bytes).into()),
        Err(error) => Err(Fault::new(format!("cannot read {name}: {error}")).into()),
    }
}

/// Reads a file, and checks its size before and during reading.
fn read_file(path: &Path, limit_bytes: u64) -> Result<Vec<u8>, ResourceError> {
    let io = |e: std::io::Error| ResourceError::Io(e.to_string());
    let file = std::fs::File::open(path).map_err(io)?;
    let size = file.metadata().map_err(io)?.len();
    if size > limit_bytes {
        return Err(ResourceError::TooLarge(size, limit_bytes));
    }
    let mut bytes = Vec::with_capacity(size as usize);
    file.take(limit_bytes + 1).read_to_end(&mut bytes).map_err(io)?;
    if bytes.len() as u64 > limit_bytes {
        return Err(ResourceError::TooLarge(bytes.len() as u64, limit_bytes));
    }
    Ok(bytes)
}

/// Returns the path relative to the working folder if it is inside.
fn from_here(path: &Path) -> &Path {
    std::env::current_dir().ok().and_then(|here| path.strip_prefix(here).ok()).unwrap_or(path)
}

/// Returns the path without `.` components, relative to the working folder if it is inside, as users write it.
fn plain(path: &Path) -> PathBuf {
    let here = std::env::current_dir().ok();
    let path = here.and_then(|here| path.strip_prefix(here).ok()).unwrap_or(path);
    path.components().filter(|c| *c != std::path::Component::CurDir).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_that_cannot_be_scenes_are_not_read() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("large.yaml");
        // A sparse file has the length without using the space.
        std::fs::File::create(&path).and_then(|file| file.set_len(100_000_000)).expect("written");
        let said = read_yaml(&path).expect_err("refused").to_string();
        assert!(said.contains("100000000 bytes, at most 4194304 are read"), "{said}");
        let said = read_yaml(Path::new("/nowhere/scene.yaml")).expect_err("refused").to_string();
        assert!(said.starts_with("cannot read /nowhere/scene.yaml: "), "{said}");
    }
}
