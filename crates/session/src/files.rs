//! The files of one picture.

use crate::{Folder, Names, SessionError, exposure_backup};
use spectra_core::sink::{Sink, WriteFault};
use spectra_scene::{FileContent, Member, Output, Scene, Shot};
use std::sync::Arc;

/// Files to write for one picture.
#[derive(Clone)]
pub(crate) struct Files(Vec<File>);

#[derive(Clone)]
struct File {
    output: Arc<dyn Output>,
    /// Index of the film whose picture the file holds, among films side by side.
    film: usize,
    name: String,
}

/// A file that was not written, and the reason.
type Unwritten = (String, WriteFault);

impl Files {
    /// Lists the files of a picture.
    ///
    /// # Errors
    /// The scene cannot be written to the file that is asked for.
    pub(crate) fn of(names: &Names, scene: &Scene, member: &Member) -> Result<Self, SessionError> {
        let mut files = Vec::new();
        for output in names.outputs(scene)? {
            let films: Vec<Option<&str>> = match output.content() {
                FileContent::Picture if !scene.films.is_empty() => {
                    scene.films.iter().map(|f| f.name.as_deref()).collect()
                }
                _ => vec![None],
            };
            for (film, named) in films.into_iter().enumerate() {
                let named = named.map_or(String::new(), |name| format!("-{name}"));
                let [part, ending] = output.ending();
                let part = if names.is_one() { "" } else { part };
                let name = names.file(member, &format!("{named}{part}"), ending);
                files.push(File { output: Arc::clone(&output), film, name });
            }
        }
        Ok(Self(files))
    }

    /// Names of the files.
    pub(crate) fn names(&self) -> Vec<String> {
        self.0.iter().map(|file| file.name.clone()).collect()
    }

    /// Names of the files that hold the picture to look at, one for each film.
    pub(crate) fn shown(&self) -> Vec<String> {
        let first =
            self.0.iter().find(|file| file.output.content() == FileContent::Picture).map(|file| file.output.ending());
        let own = self.0.iter().filter(|file| Some(file.output.ending()) == first);
        own.map(|file| file.name.clone()).collect()
    }

    /// Writes all files. If the system refuses one and no file holds the light, the light is saved in one of the `folders`, and
    /// the error says where.
    pub(crate) fn write(
        &self,
        shot: &Shot<'_>,
        sink: &dyn Sink,
        folders: Option<[&dyn Folder; 2]>,
    ) -> Result<(), SessionError> {
        let is_light = |file: &&File| file.output.content() == FileContent::Light;
        // Pictures are developed and compressed in parallel with the light that they are made from.
        let (light, others) = rayon::join(
            || self.0.iter().filter(is_light).try_for_each(|file| file.write(shot, sink)),
            || self.0.iter().filter(|file| !is_light(file)).try_for_each(|file| file.write(shot, sink)),
        );
        let is_safe = light.is_ok() && self.0.iter().any(|file| is_light(&file));
        light.and(others).map_err(|(file, fault)| {
            let kept = match (&fault, folders) {
                (WriteFault::Io(_), Some([folder, elsewhere])) if !is_safe => {
                    format!("; {}", exposure_backup::save_exposure(shot, &file, folder, elsewhere))
                }
                _ => String::new(),
            };
            let file = folders.map_or(file.clone(), |[folder, _]| folder.shown(&file));
            SessionError::Unwritten { file, fault, kept }
        })
    }
}

impl File {
    fn write(&self, shot: &Shot<'_>, sink: &dyn Sink) -> Result<(), Unwritten> {
        let written = sink.file(&self.name, &mut |out| self.output.write(shot, self.film, out));
        written.map_err(|fault| (self.name.clone(), fault))
    }
}

/// Writes a report on a render as JSON to a file that is shown to the user under another name.
pub(crate) fn write_report(
    sink: &dyn Sink,
    (file, shown): (&str, &str),
    report: &serde_json::Value,
) -> Result<(), SessionError> {
    let text = format!("{report:#}\n");
    let written = sink.file(file, &mut |out| Ok(out.write_all(text.as_bytes())?));
    written.map_err(|fault| SessionError::Unwritten { file: shown.to_owned(), fault, kept: String::new() })
}
