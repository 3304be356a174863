//! Where results go: a folder, or one picture.

use crate::outcome::Failure;
use spectra_scene::{Member, Output, Scene};
use std::path::{Path, PathBuf};

/// What `--output` names.
#[derive(Clone, Debug)]
pub(crate) struct Target {
    /// The folder of everything.
    pub folder: PathBuf,
    /// The one file that is asked for.
    only: Option<Only>,
}

/// A picture's file by its name.
#[derive(Clone, Debug)]
struct Only {
    stem: String,
    ending: String,
    kind: Output,
}

impl Target {
    /// A name that ends as a picture does is that picture, any other one a folder.
    ///
    /// # Errors
    /// A file stands there that is no picture.
    pub(crate) fn of(output: &Path) -> Result<Self, Failure> {
        let whole = Self { folder: output.to_owned(), only: None };
        if output.is_dir() {
            return Ok(whole);
        }
        let part = |part: Option<&std::ffi::OsStr>| part.map(|p| p.to_string_lossy().into_owned());
        let kind = part(output.extension()).as_deref().and_then(kind);
        if let (Some(kind), Some(stem), Some(ending)) = (kind, part(output.file_stem()), part(output.extension())) {
            let folder = output.parent().filter(|f| !f.as_os_str().is_empty()).unwrap_or(Path::new("."));
            return Ok(Self { folder: folder.to_owned(), only: Some(Only { stem, ending, kind }) });
        }
        if output.is_file() {
            return Err(Failure::Failed(format!(
                "cannot write to `{}`: that is a file; name a folder, or a picture with its ending: .png, .tiff, .exr or .dng",
                output.display()
            )));
        }
        Ok(whole)
    }

    /// Makes the scene write what is asked for.
    ///
    /// # Errors
    /// The scene cannot have it.
    pub(crate) fn narrow(&self, scene: &mut Scene) -> Result<(), Failure> {
        let Some(only) = &self.only else { return Ok(()) };
        if only.kind == Output::Dng && !scene.imager.has_converter() {
            let text =
                format!("{}.{}: this imager has no A/D converter, so there is no raw data", only.stem, only.ending);
            return Err(Failure::Input(format!("{text} (`imager: {{kind: sensor, ...}}` has one)")));
        }
        // Tiles are asked for in the scene.
        let is_tiled = only.kind == Output::Exr && scene.output.contains(&Output::TiledExr);
        scene.output = vec![if is_tiled { Output::TiledExr } else { only.kind }];
        Ok(())
    }

    /// The path of a file of a picture; `part` is what tells it from the picture's others.
    pub(crate) fn path(&self, member: &Member, part: &str, ending: &str) -> PathBuf {
        self.folder.join(match &self.only {
            Some(only) => format!("{}{part}.{}", only.stem, only.ending),
            None => format!("{}{ending}", member.stem(part)),
        })
    }

    /// The path of the report; none where one file is asked for.
    pub(crate) fn report(&self, name: &str) -> Option<PathBuf> {
        self.only.is_none().then(|| self.folder.join(format!("{name}.json")))
    }
}

/// What a file of this ending holds.
fn kind(ending: &str) -> Option<Output> {
    match ending.to_ascii_lowercase().as_str() {
        "png" => Some(Output::Png),
        "tif" | "tiff" => Some(Output::Tiff),
        "exr" => Some(Output::Exr),
        "dng" => Some(Output::Dng),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_pictures_are_files_and_others_folders() {
        let folder = tempfile::tempdir().expect("a folder");
        let at = |name: &str| folder.path().join(name);
        std::fs::write(at("notes.txt"), "").expect("written");
        std::fs::write(at("old.png"), "").expect("written");
        std::fs::create_dir(at("folder.png")).expect("made");
        for (name, is_file) in
            [("new.png", true), ("old.png", true), ("a/b.TIF", true), ("folder.png", false), ("out", false)]
        {
            assert_eq!(Target::of(&at(name)).expect(name).only.is_some(), is_file, "{name}");
        }
        assert!(Target::of(&at("notes.txt")).is_err());
    }
}
