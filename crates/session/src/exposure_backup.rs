//! A fallback for light that could not be written to its own file.

use crate::Folder;
use spectra_pictures::write::{exr, half_exr};
use spectra_scene::Shot;

/// Saves the exposure after `failed`, its file or another one of the picture, could not be written. Tries the folder `elsewhere`
/// with full precision, then its own folder in half floats, which take half the space. Returns a message that says where it is.
pub(crate) fn save_exposure(shot: &Shot<'_>, failed: &str, folder: &dyn Folder, elsewhere: &dyn Folder) -> String {
    let name = failed.rsplit_once('.').map_or(failed, |(stem, _)| stem);
    let (frame, gains, squeeze) = (shot.exposure, shot.gains(), shot.scene.lens.squeeze);
    let there = format!("{name}.exr");
    if elsewhere.file(&there, &mut |out| exr(out, frame, &gains, squeeze, shot.attributes)).is_ok() {
        return format!("the light was saved in {}", elsewhere.shown(&there));
    }
    if folder.file(&there, &mut |out| half_exr(out, frame, &gains, squeeze, shot.attributes)).is_ok() {
        return format!("the light was saved in {}, in half floats (three digits)", folder.shown(&there));
    }
    format!("the light could not be saved in {} either", elsewhere.shown(&there))
}
