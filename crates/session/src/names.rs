//! Names of output files.

use crate::SessionError;
use spectra_core::params::Fault;
use spectra_scene::{FileContent, Member, Output, Scene};
use std::path::Path;
use std::sync::Arc;

/// How the files of a scene are named: after the scene, or one picture by a given file name.
#[derive(Clone, Debug, Default)]
pub struct Names {
    only: Option<[String; 2]>,
    /// Text before the extension: `.partial` for an incomplete picture.
    mark: &'static str,
}

/// Extensions that mark a name as a file instead of a folder. Scenes cannot be written with those of the last two rows.
const ENDINGS: [&str; 29] = [
    "png", "jpg", "jpeg", "tif", "tiff", "exr", "dng", "html", //
    "webp", "gif", "bmp", "jp2", "hdr", "tga", "avif", "heic", "psd", "dpx", "cin", "pfm", //
    "mp4", "mov", "pdf", "txt", "json", "yaml", "yml", "csv", "cube",
];

impl Names {
    /// Creates the naming for a whole scene: every output listed under its `output` is written, and its file is named after the
    /// scene.
    #[must_use]
    pub fn of_scene() -> Self {
        Self::default()
    }

    /// Creates the naming for one picture alone, which is written to a file with the name of `file`. `None` if `file` has no
    /// known extension.
    #[must_use]
    pub fn of_picture(file: &Path) -> Option<Self> {
        let [stem, ending] = [file.file_stem()?, file.extension()?].map(|part| part.to_string_lossy().into_owned());
        ENDINGS.contains(&&*ending.to_ascii_lowercase()).then_some(Self { only: Some([stem, ending]), mark: "" })
    }

    /// Returns the names for an incomplete picture, so that it does not replace a complete one.
    pub(crate) fn of_partial(&self) -> Self {
        Self { only: self.only.clone(), mark: ".partial" }
    }

    /// Returns the outputs to write for a scene.
    ///
    /// # Errors
    /// The scene cannot be written with the extension that is asked for.
    pub(crate) fn outputs(&self, scene: &Scene) -> Result<Vec<Arc<dyn Output>>, SessionError> {
        let Some([stem, ending]) = &self.only else { return Ok(scene.output.clone()) };
        let ending = ending.to_ascii_lowercase();
        let ending = match &*ending {
            "tif" => "tiff",
            "jpeg" => "jpg",
            other => other,
        };
        let none = || {
            let fault = Fault::new(format!("{stem}.{ending}: a picture cannot be written as `.{ending}`"));
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

    /// Returns whether one file is asked for by its name, and it holds the light.
    pub(crate) fn ask_for_light(&self, scene: &Scene) -> bool {
        let holds_light = |output: &Arc<dyn Output>| output.content() == FileContent::Light;
        self.is_one() && self.outputs(scene).is_ok_and(|outputs| outputs.iter().any(holds_light))
    }

    /// Returns whether one file is asked for by its name.
    pub(crate) fn is_one(&self) -> bool {
        self.only.is_some()
    }

    /// Returns the name of a file of a picture. `part` distinguishes it from the picture's other files.
    pub(crate) fn file(&self, member: &Member, part: &str, ending: &str) -> String {
        let mark = self.mark;
        match &self.only {
            Some([stem, own]) => format!("{stem}{part}{mark}.{own}"),
            None => format!("{}{mark}{ending}", member.stem(part)),
        }
    }

    /// Returns the name of a report; `None` if only one file is asked for.
    pub(crate) fn report(&self, name: &str) -> Option<String> {
        self.only.is_none().then(|| format!("{name}{}.json", self.mark))
    }
}
