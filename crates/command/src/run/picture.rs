//! What is written of a frame beside its light: the picture, and what stands in the header of the EXR.

use super::report::Report;
use spectra_core::frame::DisplayPicture;

/// The picture of the frame: by the film, or else by the imager.
pub(crate) fn picture(report: &Report<'_>) -> Result<DisplayPicture, String> {
    let (scene, exposure) = (report.scene, &report.rendering.exposure);
    match &scene.film {
        Some(film) => film.develop(exposure),
        None => {
            scene.imager.display(exposure).ok_or_else(|| "this imager shows no picture without a film on it".to_owned())
        }
    }
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
        ("spectra:film size", format!("{} x {} mm", size.width_mm, size.height_mm)),
        ("spectra:film coordinates", COORDINATES.to_owned()),
        ("spectra:exposure time", format!("{} s", scene.exposure_time_s())),
    ];
    let patent = lens.patent.clone().map(|patent| ("spectra:lens patent", patent));
    let source = lens.source.clone().map(|source| ("spectra:lens source", source));
    let film = scene.film.as_ref().map(|film| ("spectra:film", film.describe()));
    let partial =
        report.rendering.partial.then(|| ("spectra:partial", "true: stopped before all samples were taken".to_owned()));
    all.extend([patent, source, film, partial].into_iter().flatten());
    all.into_iter().map(|(name, value)| (name.to_owned(), value)).collect()
}
