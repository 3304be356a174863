//! What is written of a frame beside its light: the picture, and what stands in the header of the EXR.

use super::report::Report;
use spectra_core::frame::DisplayPicture;
use spectra_scene::{FilmTime, Scene, SceneFilm};

/// A picture, with the name of its film where there are several.
pub(crate) type Developed = (Option<String>, DisplayPicture);

/// The pictures of the frame: by each film, with its name where there are several, or else by the imager.
pub(crate) fn pictures(report: &Report<'_>) -> Result<Vec<Developed>, String> {
    let (scene, exposure) = (report.scene, &report.rendering.exposure);
    let developed = |film: &SceneFilm| match &film.name {
        // A film alone has the frame for itself.
        None => Ok((None, film.film.develop(exposure)?)),
        Some(name) => Ok((Some(name.clone()), film.film.develop(&film.exposure(exposure))?)),
    };
    if scene.films.is_empty() {
        let shown = scene.imager.display(exposure);
        let picture = shown.ok_or_else(|| "this imager shows no picture without a film on it".to_owned())?;
        return Ok(vec![(None, picture)]);
    }
    scene.films.iter().map(developed).collect()
}

/// What is on the imager, in words.
pub(crate) fn films(scene: &Scene) -> Option<String> {
    let one =
        |f: &SceneFilm| f.name.as_ref().map_or_else(|| f.film.describe(), |n| format!("{n}: {}", f.film.describe()));
    let all: Vec<String> = scene.films.iter().map(one).collect();
    (!all.is_empty()).then(|| all.join("; "))
}

/// How long light fell on the film, s with all digits; of several films one each, by their names.
fn exposure_times(report: &Report<'_>) -> String {
    if report.times.is_empty() {
        return format!("{} s", report.scene.exposure_time_s());
    }
    let one = |time: &FilmTime| match &time.name {
        None => format!("{} s", time.time_s),
        Some(name) => format!("{name}: {} s", time.time_s),
    };
    report.times.iter().map(one).collect::<Vec<_>>().join(", ")
}

/// Where a pixel lies on the film, for whoever measures in the EXR.
const COORDINATES: &str = "upright picture; +x of the film is to the left, +y is down: column = (0.5 - x / width) * columns, \
                           row = (0.5 + y / height) * rows";

/// Scene and lens, for the header of the EXR. Nothing here changes from run to run, nor with the number of threads.
pub(crate) fn attributes(report: &Report<'_>) -> Vec<(String, String)> {
    let scene = report.scene;
    let lens = &scene.lens;
    let size = report.rendering.exposure.size;
    let mut all = vec![
        ("spectra:version", crate::version::VERSION.to_owned()),
        ("spectra:name", scene.name.clone()),
        ("spectra:scene", scene.text.clone()),
        ("spectra:source", scene.source.describe()),
        ("spectra:lens", lens.name.clone()),
        ("spectra:lens losses", lens.losses()),
        ("spectra:focus", scene.focus.to_string()),
        ("spectra:film size", format!("{} x {} mm", size.width_mm, size.height_mm)),
        ("spectra:film coordinates", COORDINATES.to_owned()),
        ("spectra:exposure time", exposure_times(report)),
    ];
    let patent = lens.patent.clone().map(|patent| ("spectra:lens patent", patent));
    let source = lens.source.clone().map(|source| ("spectra:lens source", source));
    let film = films(scene).map(|films| ("spectra:film", films));
    let notes = (!scene.notes.is_empty()).then(|| ("spectra:notes", scene.notes.join("; ")));
    let partial =
        report.rendering.partial.then(|| ("spectra:partial", "true: stopped before all samples were taken".to_owned()));
    all.extend([patent, source, film, notes, partial].into_iter().flatten());
    let all = all.into_iter().map(|(name, value)| (name.to_owned(), value));
    all.chain(report.attributes.iter().cloned()).collect()
}
