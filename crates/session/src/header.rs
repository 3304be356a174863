//! Attributes in the header of a picture's EXR.

use spectra_core::frame::ExposureFrame;
use spectra_scene::{FilmTime, Scene, SceneFilm};

/// Describes the films on the imager, with their names if there are several; `None` if there is no film.
pub fn films(scene: &Scene) -> Option<String> {
    let one =
        |f: &SceneFilm| f.name.as_ref().map_or_else(|| f.film.describe(), |n| format!("{n}: {}", f.film.describe()));
    let all: Vec<String> = scene.films.iter().map(one).collect();
    (!all.is_empty()).then(|| all.join("; "))
}

/// Formats the exposure time of the film, s, with all digits; if there are several films, one time for each by name.
fn exposure_times(scene: &Scene, times: &[FilmTime]) -> String {
    if times.is_empty() {
        return format!("{} s", scene.exposure_time_s());
    }
    let one = |time: &FilmTime| match &time.name {
        None => format!("{} s", time.time_s),
        Some(name) => format!("{name}: {} s", time.time_s),
    };
    times.iter().map(one).collect::<Vec<_>>().join(", ")
}

/// Explains where a pixel lies on the film, for users who measure in the EXR.
const COORDINATES: &str = "upright picture; +x of the film is to the left, +y is down: column = (0.5 - x / width) * columns, \
                           row = (0.5 + y / height) * rows";

/// Describes scene and lens for the header of the EXR. The result is the same in every run and with any number of threads.
pub(crate) fn attributes(
    scene: &Scene,
    exposure: &ExposureFrame,
    times: &[FilmTime],
    is_partial: bool,
    version: &str,
) -> Vec<(String, String)> {
    let lens = &scene.lens;
    let size = exposure.size;
    let mut all = vec![
        ("spectra:version", version.to_owned()),
        ("spectra:name", scene.name.clone()),
        ("spectra:scene", scene.text.clone()),
        ("spectra:source", scene.source.describe()),
        ("spectra:lens", lens.name.clone()),
        ("spectra:lens losses", lens.losses()),
        ("spectra:focus", scene.focus.to_string()),
        ("spectra:film size", format!("{} x {} mm", size.width_mm, size.height_mm)),
        ("spectra:film coordinates", COORDINATES.to_owned()),
        ("spectra:exposure time", exposure_times(scene, times)),
    ];
    let patent = lens.patent.clone().map(|patent| ("spectra:lens patent", patent));
    let source = lens.source.clone().map(|source| ("spectra:lens source", source));
    let film = films(scene).map(|films| ("spectra:film", films));
    let notes = (!scene.notes.is_empty()).then(|| ("spectra:notes", scene.notes.join("; ")));
    let partial = is_partial.then(|| ("spectra:partial", "true: stopped before all samples were taken".to_owned()));
    all.extend([patent, source, film, notes, partial].into_iter().flatten());
    all.into_iter().map(|(name, value)| (name.to_owned(), value)).collect()
}
