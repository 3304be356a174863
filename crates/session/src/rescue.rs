//! Light that could not be written where it was meant to be.

use crate::Folder;
use spectra_pictures::write::{exr, half_exr};
use spectra_scene::Shot;

/// Keeps the exposure somewhere, where `failed` is the file that should have held it, or would have been beside it: as it is
/// elsewhere, or in half floats, which take half the space, at its own place. In words, where.
pub(crate) fn keep(shot: &Shot<'_>, failed: &str, folder: &dyn Folder, elsewhere: &dyn Folder) -> String {
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
