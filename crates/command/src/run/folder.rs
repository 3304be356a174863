//! The folder that results go to.

use super::picture::{Developed, attributes, pictures};
use super::rays;
use super::report::Report;
use super::rescue;
use super::target::Target;
use crate::outcome::Failure;
use spectra_files::{WriteError, write_atomically};
use spectra_pictures::write::{
    RawLens, write_dng, write_exr_times, write_png8_of_pixels, write_tiff16, write_tiled_exr_times,
};
use spectra_plot::PlotError;
use spectra_scene::{Member, Output, RaysFigure, Scene};
use std::fmt::Display;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

/// What goes into the folder of one picture, which is known to take files.
#[derive(Clone, Debug)]
pub(crate) struct Folder {
    folder: PathBuf,
    files: Vec<(Output, PathBuf)>,
}

/// Why a file was not written.
enum Trouble {
    /// The system refused: the light is worth keeping elsewhere.
    System(WriteError),
    Other(Failure),
}

impl From<WriteError> for Trouble {
    fn from(error: WriteError) -> Self {
        match error {
            WriteError::Io { .. } => Self::System(error),
            WriteError::Format { .. } => Self::Other(error.into()),
        }
    }
}

impl From<Failure> for Trouble {
    fn from(failure: Failure) -> Self {
        Self::Other(failure)
    }
}

/// What was made of one picture.
pub(crate) struct Written {
    /// The files.
    pub paths: Vec<PathBuf>,
    /// The pictures of it, where they were developed.
    pub pictures: Option<Vec<Developed>>,
}

impl Folder {
    /// Makes the folder where it does not exist, and sees to it that the files of the picture, and `report`, can be
    /// written there.
    pub(crate) fn prepare(
        target: &Target,
        scene: &Scene,
        member: &Member,
        report: Option<&Path>,
    ) -> Result<Self, Failure> {
        let folder = target.folder.as_path();
        std::fs::create_dir_all(folder).map_err(|error| refuse(folder, &error))?;
        let mut files: Vec<(Output, PathBuf)> = Vec::new();
        for output in &scene.output {
            let of_each_film = matches!(output, Output::Png | Output::Tiff) && !scene.films.is_empty();
            let films = if of_each_film { scene.films.iter().map(|f| f.name.as_deref()).collect() } else { vec![None] };
            for film in films {
                let film = film.map_or(String::new(), |name| format!("-{name}"));
                let (part, ending) = ending(*output);
                files.push((*output, target.path(member, &format!("{film}{part}"), ending)));
            }
        }
        for path in files.iter().map(|(_, path)| path.as_path()).chain(report) {
            if path.is_dir() {
                return Err(refuse(path, &"a folder of that name is in the way"));
            }
        }
        // Rights, read-only disks, quotas: only the attempt tells.
        // Several pictures of a series try at the same time.
        static ATTEMPTS: AtomicU64 = AtomicU64::new(0);
        let number = ATTEMPTS.fetch_add(1, Ordering::Relaxed);
        let attempt = folder.join(format!(".spectra-{}-{number}.tmp", std::process::id()));
        std::fs::write(&attempt, b"spectra").map_err(|error| refuse(folder, &error))?;
        std::fs::remove_file(&attempt).map_err(|error| refuse(folder, &error))?;
        Ok(Self { folder: folder.to_owned(), files })
    }

    /// The files of the picture.
    pub(crate) fn paths(&self) -> Vec<PathBuf> {
        self.files.iter().map(|(_, path)| path.clone()).collect()
    }

    /// The files that hold what a person looks at, one for each film.
    pub(crate) fn shown(&self) -> Vec<PathBuf> {
        let of =
            |kind: Output| self.files.iter().filter(move |(output, _)| *output == kind).map(|(_, path)| path.clone());
        let png: Vec<PathBuf> = of(Output::Png).collect();
        if png.is_empty() { of(Output::Tiff).collect() } else { png }
    }

    /// Writes all that the scene asks for. The picture is developed where it asks for one, or where `develop` does. Where
    /// the system refuses, the light is kept elsewhere, and the failure says where.
    pub(crate) fn write(&self, report: &Report<'_>, develop: bool) -> Result<Written, Failure> {
        make_again(&self.folder);
        let (exposure, pictures) = std::thread::scope(|scope| {
            // The picture is developed and packed while the light behind it is.
            let exposure = scope.spawn(|| self.write_exposure(report));
            let pictures = self.write_pictures(report, develop);
            (exposure.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)), pictures)
        });
        let has_light = matches!(exposure, Ok(true));
        match exposure.and(pictures) {
            Ok(pictures) => Ok(Written { paths: self.paths(), pictures }),
            Err(Trouble::Other(failure)) => Err(failure),
            Err(Trouble::System(error)) if has_light => Err(error.into()),
            Err(Trouble::System(error)) => {
                let path = match &error {
                    WriteError::Io { path, .. } | WriteError::Format { path, .. } => path.clone(),
                };
                Err(Failure::Failed(format!("{error}; {}", rescue::keep(report, &path))))
            }
        }
    }

    /// Writes the exposure; false where the scene does not ask for it.
    fn write_exposure(&self, report: &Report<'_>) -> Result<bool, Trouble> {
        let mut is_written = false;
        for (output, path) in self.files.iter().filter(|(o, _)| matches!(o, Output::Exr | Output::TiledExr)) {
            let begun = Instant::now();
            let write = if *output == Output::Exr { write_exr_times } else { write_tiled_exr_times };
            write(path, &report.rendering.exposure, &report.gains(), &attributes(report))?;
            is_written = true;
            tracing::debug!(seconds = begun.elapsed().as_secs_f64(), "exposure written");
        }
        Ok(is_written)
    }

    fn write_pictures(&self, report: &Report<'_>, develop: bool) -> Result<Option<Vec<Developed>>, Trouble> {
        for (output, path) in &self.files {
            if let Output::Rays(figure) = output {
                rays::draw(report.scene, figure, report.isa)?.write_at(path, 1.0).map_err(|e| match e {
                    PlotError::Write(error) => Trouble::from(error),
                    PlotError::Ending { .. } => Failure::Failed(e.to_string()).into(),
                })?;
            }
        }
        for (output, path) in &self.files {
            if *output == Output::Dng {
                let raw = report.scene.imager.raw(&report.rendering.exposure);
                let raw = raw.ok_or_else(|| Failure::Failed("this imager has no converter".to_owned()))?;
                write_dng(path, &raw, &raw_lens(report.scene))?;
            }
        }
        let is_wanted = self.files.iter().any(|(output, _)| matches!(output, Output::Png | Output::Tiff));
        if !is_wanted && !develop {
            return Ok(None);
        }
        let begun = Instant::now();
        let pictures = match pictures(report) {
            Ok(pictures) => pictures,
            // Not every imager has something to show, and nobody has asked for it.
            Err(_) if !is_wanted => return Ok(None),
            Err(text) => return Err(Failure::Failed(text).into()),
        };
        tracing::debug!(seconds = begun.elapsed().as_secs_f64(), "pictures developed");
        // Files and pictures come in the same order: for each kind of file, film after film.
        for kind in [Output::Png, Output::Tiff] {
            let paths = self.files.iter().filter(|(output, _)| *output == kind).map(|(_, path)| path);
            for (path, (_, picture)) in paths.zip(&pictures) {
                match kind {
                    Output::Tiff => write_tiff16(path, picture)?,
                    _ => write_png8_of_pixels(path, picture, pixel_aspect(report))?,
                }
            }
        }
        tracing::debug!(seconds = begun.elapsed().as_secs_f64(), "pictures written");
        Ok(Some(pictures))
    }
}

/// The lens as a raw file names it, focal length and f-number as they are set.
fn raw_lens(scene: &Scene) -> RawLens {
    let lens = &scene.lens;
    RawLens {
        model: Some(lens.name.clone()),
        maker: lens.maker.clone(),
        focal_length_mm: Some(lens.first_order(lens.reference_nm).efl_mm.abs()),
        f_number: lens.marginal_ray().ok().map(|ray| ray.f_number()),
    }
}

/// Writes a report of what was rendered.
pub(crate) fn write_report(path: &Path, report: &serde_json::Value) -> Result<(), Failure> {
    if let Some(folder) = path.parent() {
        make_again(folder);
    }
    let text = format!("{report:#}\n");
    Ok(write_atomically(path, |file| Ok(file.write_all(text.as_bytes())?))?)
}

/// Makes a folder that was there when the render began, and has gone since. Where it cannot be made, the file that does not
/// find it says so.
fn make_again(folder: &Path) {
    let _ = std::fs::create_dir_all(folder);
}

/// What tells a file from the others of its picture, and its ending.
fn ending(output: Output) -> (&'static str, &'static str) {
    match output {
        Output::Exr | Output::TiledExr => ("", ".exr"),
        Output::Png => ("", ".png"),
        Output::Tiff => ("", ".tiff"),
        Output::Dng => ("", ".dng"),
        Output::Rays(RaysFigure { svg: false, .. }) => ("-rays", ".png"),
        Output::Rays(RaysFigure { svg: true, .. }) => ("-rays", ".svg"),
    }
}

fn refuse(path: &Path, reason: &dyn Display) -> Failure {
    Failure::Failed(format!(
        "cannot write to `{}`: {reason} (nothing was rendered; choose another folder with --output)",
        path.display()
    ))
}

/// Width over height of a pixel of the frame.
fn pixel_aspect(report: &Report<'_>) -> f64 {
    let size = report.scene.imager.size();
    let aspect = size.width_mm / f64::from(size.width_px) / (size.height_mm / f64::from(size.height_px));
    // As near to square as whole numbers of pixels come.
    if (aspect - 1.0).abs() < 0.005 { 1.0 } else { aspect }
}
