//! The list of what a page can open: bundled scenes, and scenes and photographs beside the one with which the viewer was started. A page
//! sends a name from this list and never a path.

use super::render_job::RenderJob;
use serde_json::{Value, json};
use spectra_darkroom::is_picture;
use spectra_scene::bundled::Bundled;
use spectra_session::SessionError;
use std::io::Read;
use std::path::{Path, PathBuf};

/// Largest number of files that are listed.
const MANY: usize = 500;
/// Number of bytes at the start of a file in which the key `spectra:` marks it as a scene.
const HEAD_BYTES: u64 = 4096;

/// Returns the folder of the viewer's scene, or the one in which the viewer was started.
fn folder(order: &RenderJob) -> PathBuf {
    let parent = order.scene.parent().filter(|p| !p.as_os_str().is_empty() && order.scene.exists());
    parent.unwrap_or(Path::new(".")).to_owned()
}

/// Returns the names of the scenes and photographs in a folder, sorted.
fn files(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut names: Vec<String> = entries
        .filter(|entry| entry.file_type().is_ok_and(|kind| kind.is_file()))
        .filter_map(|entry| entry.file_name().into_string().ok())
        .filter(|name| !name.starts_with('.') && (is_picture(Path::new(name)) || is_scene(&folder.join(name))))
        .take(MANY)
        .collect();
    names.sort();
    names
}

/// Returns whether a file is a scene: YAML that begins like one.
fn is_scene(path: &Path) -> bool {
    let is_yaml = path.extension().is_some_and(|ending| ending == "yaml" || ending == "yml");
    let head = || {
        let mut head = Vec::new();
        std::fs::File::open(path).ok()?.take(HEAD_BYTES).read_to_end(&mut head).ok()?;
        Some(String::from_utf8_lossy(&head).lines().any(|line| line.starts_with("spectra:")))
    };
    is_yaml && head().unwrap_or(false)
}

/// Returns the list of files and bundled scenes as JSON for the page.
pub(super) fn listed(order: &RenderJob) -> Value {
    let bundled: Vec<String> = Bundled::Scene.names().into_iter().filter(|name| !name.contains('/')).collect();
    json!({"files": files(&folder(order)), "bundled": bundled})
}

/// Returns the order for a name from the list; `is_bundled` says whether it is the name of a bundled scene.
///
/// # Errors
/// The reason why it cannot be opened.
pub(super) fn opened(order: &RenderJob, name: &str, is_bundled: bool) -> Result<RenderJob, String> {
    let own = listed(order);
    let is_known = own[if is_bundled { "bundled" } else { "files" }]
        .as_array()
        .is_some_and(|all| all.iter().any(|own| own == name));
    if !is_known {
        return Err(format!("`{name}` is not among the scenes and photographs that can be opened"));
    }
    let scene = if is_bundled { PathBuf::from(name) } else { folder(order).join(name) };
    let made = RenderJob::of(scene, None, Vec::new(), order.isa, order.threads);
    // Faults are reported before the page leaves its current scene.
    made.and_then(|made| made.session().map(|_| made)).map_err(|error: SessionError| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;
    use spectra_core::Isa;
    use spectra_plugins as _;

    #[test]
    fn scenes_and_photographs_are_opened_by_name_and_nothing_else_is() {
        let folder = tempfile::tempdir().expect("a folder");
        let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).expect("written");
        write("a.yaml", "# own\nspectra: 1\n");
        write("lens.yaml", "surfaces: []\n");
        write("b.JPG", "no picture");
        write("secret.txt", "spectra: 1\n");
        let order = RenderJob {
            scene: folder.path().join("a.yaml"),
            photograph: None,
            overrides: Vec::new(),
            isa: Isa::detect(),
            threads: 1,
        };
        assert_eq!(listed(&order)["files"], json!(["a.yaml", "b.JPG"]));
        for (name, is_bundled) in
            [("secret.txt", false), ("../a.yaml", false), ("biotar-ortho", false), ("a.yaml", true), ("", true)]
        {
            assert!(opened(&order, name, is_bundled).is_err_and(|why| why.contains("not among")), "{name}");
        }
        assert!(opened(&order, "biotar-ortho", true).is_ok());
        // A broken picture is reported, and nothing is opened.
        assert!(opened(&order, "b.JPG", false).is_err_and(|why| why.contains("b.JPG")));
    }
}
