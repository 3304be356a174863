//! What files are called.

use crate::SessionError;
use spectra_core::params::Fault;
use spectra_scene::{Member, Output, Scene};
use std::path::Path;
use std::sync::Arc;

/// How the files of a scene are named: by the scene, or as the one that is asked for.
#[derive(Clone, Debug, Default)]
pub struct Names {
    only: Option<[String; 2]>,
    /// What stands before the ending: `.partial` of a picture that is not whole.
    mark: &'static str,
}

/// Endings by which a name is known to be that of a file and not of a folder; no scene is written as one of the last two rows.
const ENDINGS: [&str; 29] = [
    "png", "jpg", "jpeg", "tif", "tiff", "exr", "dng", "html", //
    "webp", "gif", "bmp", "jp2", "hdr", "tga", "avif", "heic", "psd", "dpx", "cin", "pfm", //
    "mp4", "mov", "pdf", "txt", "json", "yaml", "yml", "csv", "cube",
];

impl Names {
    /// All files that the scene asks for, by its name.
    #[must_use]
    pub fn of_scene() -> Self {
        Self::default()
    }

    /// One picture alone, where `file` ends as pictures do: that file.
    #[must_use]
    pub fn of_picture(file: &Path) -> Option<Self> {
        let [stem, ending] = [file.file_stem()?, file.extension()?].map(|part| part.to_string_lossy().into_owned());
        ENDINGS.contains(&&*ending.to_ascii_lowercase()).then_some(Self { only: Some([stem, ending]), mark: "" })
    }

    /// The same for a picture that is not whole, beside one that may be.
    pub(crate) fn of_partial(&self) -> Self {
        Self { only: self.only.clone(), mark: ".partial" }
    }

    /// What is written of a scene.
    ///
    /// # Errors
    /// There is no such picture of it.
    pub(crate) fn outputs(&self, scene: &Scene) -> Result<Vec<Arc<dyn Output>>, SessionError> {
        let Some([stem, ending]) = &self.only else { return Ok(scene.output.clone()) };
        let ending = ending.to_ascii_lowercase();
        let ending = match &*ending {
            "tif" => "tiff",
            "jpeg" => "jpg",
            other => other,
        };
        let none = || {
            let fault = Fault::new(format!("{stem}.{ending}: no picture is written as `.{ending}`"));
            SessionError::Request(fault.hint(format!("name it {stem}.png, .jpg, .tiff or .exr")).to_string())
        };
        let output = scene.output_of(&format!(".{ending}")).ok_or_else(none)?;
        match output.check(&*scene.imager) {
            Ok(()) => Ok(vec![output]),
            Err([text, hint]) => {
                Err(SessionError::Request(Fault::new(format!("{stem}.{ending}: {text}")).hint(hint).to_string()))
            }
        }
    }

    /// Whether one picture is asked for by its name.
    pub(crate) fn is_one(&self) -> bool {
        self.only.is_some()
    }

    /// The name of a file of a picture; `part` is what tells it from the picture's others.
    pub(crate) fn file(&self, member: &Member, part: &str, ending: &str) -> String {
        let mark = self.mark;
        match &self.only {
            Some([stem, own]) => format!("{stem}{part}{mark}.{own}"),
            None => format!("{}{mark}{ending}", member.stem(part)),
        }
    }

    /// The name of a report; none where one file is asked for.
    pub(crate) fn report(&self, name: &str) -> Option<String> {
        self.only.is_none().then(|| format!("{name}{}.json", self.mark))
    }
}
