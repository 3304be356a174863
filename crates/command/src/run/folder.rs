//! The folder that results go to.

use super::picture::{attributes, pictures};
use super::rays;
use super::report::Report;
use crate::outcome::Failure;
use spectra_film::write::{write_atomically, write_dng, write_exr, write_png8, write_tiff16, write_tiled_exr};
use spectra_plot::PlotError;
use spectra_scene::{Output, RaysFigure, Scene};
use std::fmt::Display;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// The folder, known to take files, and what goes into it.
pub(crate) struct Folder {
    files: Vec<(Output, PathBuf)>,
    report: PathBuf,
}

impl Folder {
    /// Makes the folder where it does not exist, and sees to it that files can be written there.
    pub(crate) fn prepare(folder: &Path, scene: &Scene) -> Result<Self, Failure> {
        std::fs::create_dir_all(folder).map_err(|error| refuse(folder, &error))?;
        let mut files: Vec<(Output, PathBuf)> = Vec::new();
        for output in &scene.output {
            let of_each_film = matches!(output, Output::Png | Output::Tiff) && !scene.films.is_empty();
            let films = if of_each_film { scene.films.iter().map(|f| f.name.as_deref()).collect() } else { vec![None] };
            for film in films {
                let film = film.map_or(String::new(), |name| format!("-{name}"));
                files.push((*output, folder.join(format!("{}{film}{}", scene.name, ending(*output)))));
            }
        }
        let report = folder.join("render.json");
        for path in files.iter().map(|(_, path)| path).chain([&report]) {
            if path.is_dir() {
                return Err(refuse(path, &"a folder of that name is in the way"));
            }
        }
        // Rights, read-only disks, quotas: only the attempt tells.
        let attempt = folder.join(format!(".spectra-{}.tmp", std::process::id()));
        std::fs::write(&attempt, b"spectra").map_err(|error| refuse(folder, &error))?;
        std::fs::remove_file(&attempt).map_err(|error| refuse(folder, &error))?;
        Ok(Self { files, report })
    }

    /// Writes all that the scene asks for; gives the paths.
    pub(crate) fn write(&self, report: &Report<'_>) -> Result<Vec<PathBuf>, Failure> {
        std::thread::scope(|scope| {
            // The picture is developed and packed while the light behind it is.
            let exposure = scope.spawn(|| self.write_exposure(report));
            let pictures = self.write_pictures(report);
            exposure.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)).and(pictures)
        })?;
        let paths: Vec<PathBuf> = self.files.iter().map(|(_, path)| path).chain([&self.report]).cloned().collect();
        let text = format!("{:#}\n", report.to_json(&paths));
        write_atomically(&self.report, |file| Ok(file.write_all(text.as_bytes())?))?;
        Ok(paths)
    }

    fn write_exposure(&self, report: &Report<'_>) -> Result<(), Failure> {
        for (output, path) in self.files.iter().filter(|(o, _)| matches!(o, Output::Exr | Output::TiledExr)) {
            let begun = Instant::now();
            let write = if *output == Output::Exr { write_exr } else { write_tiled_exr };
            write(path, &report.rendering.exposure, &attributes(report))?;
            tracing::debug!(seconds = begun.elapsed().as_secs_f64(), "exposure written");
        }
        Ok(())
    }

    fn write_pictures(&self, report: &Report<'_>) -> Result<(), Failure> {
        for (output, path) in &self.files {
            if let Output::Rays(figure) = output {
                rays::draw(report.scene, figure, report.isa)?.write_at(path, 1.0).map_err(|e| match e {
                    PlotError::Write(error) => error.into(),
                    PlotError::Ending { .. } => Failure::Failed(e.to_string()),
                })?;
            }
        }
        for (output, path) in &self.files {
            if *output == Output::Dng {
                let raw = report.scene.imager.raw(&report.rendering.exposure);
                let raw = raw.ok_or_else(|| Failure::Failed("this imager has no converter".to_owned()))?;
                write_dng(path, &raw)?;
            }
        }
        if !self.files.iter().any(|(output, _)| matches!(output, Output::Png | Output::Tiff)) {
            return Ok(());
        }
        let begun = Instant::now();
        let pictures = pictures(report).map_err(Failure::Failed)?;
        tracing::debug!(seconds = begun.elapsed().as_secs_f64(), "pictures developed");
        // Files and pictures come in the same order: for each kind of file, film after film.
        for kind in [Output::Png, Output::Tiff] {
            let paths = self.files.iter().filter(|(output, _)| *output == kind).map(|(_, path)| path);
            for (path, (_, picture)) in paths.zip(&pictures) {
                match kind {
                    Output::Tiff => write_tiff16(path, picture)?,
                    _ => write_png8(path, picture)?,
                }
            }
        }
        tracing::debug!(seconds = begun.elapsed().as_secs_f64(), "pictures written");
        Ok(())
    }
}

fn ending(output: Output) -> &'static str {
    match output {
        Output::Exr | Output::TiledExr => ".exr",
        Output::Png => ".png",
        Output::Tiff => ".tiff",
        Output::Dng => ".dng",
        Output::Rays(RaysFigure { svg: false, .. }) => "-rays.png",
        Output::Rays(RaysFigure { svg: true, .. }) => "-rays.svg",
    }
}

fn refuse(path: &Path, reason: &dyn Display) -> Failure {
    Failure::Failed(format!(
        "cannot write to `{}`: {reason} (nothing was rendered; choose another folder with --output)",
        path.display()
    ))
}
