//! Detection of changes to the files that a scene names.

use spectra_session::Session;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// State of a file: time of its last modification, and size in bytes.
type Stamp = (Option<SystemTime>, u64);

/// States of the files that a scene names, such as a lens, a stock, a picture or an included file, at one time.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Stamps(BTreeMap<PathBuf, Stamp>);

impl Stamps {
    /// Returns the states of the files that the session's scene names now. A file that is missing for a moment, because it is being
    /// replaced, keeps its state. The scene's own file is left out.
    pub(super) fn now(&self, session: &Session, scene: &Path) -> Self {
        let stamp = |path: &Path| {
            let data = std::fs::metadata(path).ok()?;
            Some((data.modified().ok(), data.len()))
        };
        // The scene's own file is compared by its text, so it is left out here, by whatever path it was found.
        let scene = std::fs::canonicalize(scene).ok();
        let is_other = |path: &PathBuf| scene.is_none() || std::fs::canonicalize(path).ok() != scene;
        let others = session.files().into_iter().filter(is_other);
        Self(
            others
                .filter_map(|path| {
                    let stamp = stamp(&path).or_else(|| self.0.get(&path).copied())?;
                    Some((path, stamp))
                })
                .collect(),
        )
    }

    /// Returns whether a file that both know has different states in them.
    pub(super) fn differ(&self, other: &Self) -> bool {
        self.0.iter().any(|(path, stamp)| other.0.get(path).is_some_and(|before| before != stamp))
    }

    /// Adds the files of `other` that are not known yet.
    pub(super) fn learn(&mut self, other: &Self) {
        for (path, stamp) in &other.0 {
            self.0.entry(path.clone()).or_insert(*stamp);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use spectra_plugins as _;
    use spectra_session::SessionOptions;

    #[test]
    fn what_a_scene_includes_and_names_is_watched() {
        let folder = tempfile::tempdir().expect("a folder");
        let at = |name: &str| folder.path().join(name);
        let write = |name: &str, text: &str| std::fs::write(at(name), text).expect("written");
        write("base.yaml", "spectra: 1\nimager: {kind: film, format: 135, resolution: [24, 16]}\n");
        write("own.yaml", include_str!("../../../../../lenses/cooke-triplet-50-f5.yaml"));
        write(
            "scene.yaml",
            "spectra: 1\ninclude: base.yaml\nlens: {file: own.yaml}\nfilm: {stock: kodak-tri-x-400, exposure: 1/80 s}\n\
             source: {kind: chart, chart: resolution, distance: 2 m, luminance: 300 cd/m2, width: fill}\n",
        );
        let session =
            Session::open(&at("scene.yaml"), &[], SessionOptions::default()).unwrap_or_else(|error| panic!("{error}"));
        let before = Stamps::default().now(&session, &at("scene.yaml"));
        assert_eq!(before.0.keys().collect::<Vec<_>>(), [&at("base.yaml"), &at("own.yaml")]);
        assert!(!before.now(&session, &at("scene.yaml")).differ(&before));
        write("own.yaml", "surfaces: []\n");
        assert!(before.now(&session, &at("scene.yaml")).differ(&before));
        std::fs::remove_file(at("own.yaml")).expect("removed");
        assert!(!before.now(&session, &at("scene.yaml")).differ(&before));
    }
}
