//! Light that could not be written where it was meant to be.

use super::picture::attributes;
use super::report::Report;
use spectra_pictures::write::{write_exr_times, write_half_exr};
use std::path::{Path, PathBuf};

/// Keeps the exposure somewhere, where `failed` is the file that should have held it, or would have been beside it: as it is
/// in the folder for temporary files, or in half floats, which take half the space, at its own place. In words, where.
pub(crate) fn keep(report: &Report<'_>, failed: &Path) -> String {
    let name = failed.file_stem().map_or_else(|| "exposure".into(), |stem| stem.to_string_lossy().into_owned());
    let frame = &report.rendering.exposure;
    let (gains, attributes) = (report.gains(), attributes(report));
    let elsewhere: PathBuf = std::env::temp_dir().join(format!("{name}-{}.exr", std::process::id()));
    if write_exr_times(&elsewhere, frame, &gains, &attributes).is_ok() {
        return format!("the light is kept in {}", elsewhere.display());
    }
    let halved = failed.with_file_name(format!("{name}.exr"));
    if write_half_exr(&halved, frame, &gains, &attributes).is_ok() {
        return format!("the light is kept in {}, in half floats (three digits)", halved.display());
    }
    format!("neither could the light be kept in {}", elsewhere.display())
}
