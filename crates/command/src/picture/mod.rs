//! `spectra picture`: measures rendered pictures.

mod arguments;
mod compare;
mod cut;
mod info;
mod plot;
mod spectrum;

pub(crate) use arguments::PictureArguments;

use crate::console;
use crate::outcome::{Failure, Outcome};
use arguments::PictureCommand;
use spectra_analysis::picture::{Measured, NotMeasured, Quantity, QuantityMap};
use spectra_core::names::nearest;
use spectra_core::params::{Fault, Warning};
use spectra_core::resources::FoundFile;
use spectra_pictures::read::{FileProblem, ReadOptions, planes};
use std::path::{Path, PathBuf};

/// Largest number of channels that text shows one by one.
const MOST_CHANNELS: usize = 12;

/// Runs one of the commands of `spectra picture`.
pub(crate) fn picture(command: &PictureCommand) -> Outcome {
    match command {
        PictureCommand::Info(arguments) => info::info(arguments),
        PictureCommand::Plot(arguments) => plot::plot(arguments),
        PictureCommand::Cut(arguments) => cut::cut(arguments),
        PictureCommand::Spectrum(arguments) => spectrum::spectrum(arguments),
        PictureCommand::Compare(arguments) => compare::compare(arguments),
    }
}

/// Reads a picture and identifies its colors and unit. Warns about doubtful content.
fn load(path: &Path) -> Result<Measured, Failure> {
    let shown = path.display().to_string();
    if !path.is_file() {
        let what = if path.is_dir() { "is a folder" } else { "no such file" };
        let hint = "name a picture file: `spectra run SCENE` writes SCENE.exr into the folder `out`";
        return Err(Fault::new(format!("{shown}: {what}")).hint(hint).into());
    }
    let found = FoundFile::on_disk(shown.clone(), path.to_owned());
    let choice = ReadOptions { name: &shown, ..ReadOptions::default() };
    let refused = |trouble: FileProblem| -> Failure {
        Fault::new(format!("{shown}: {}", trouble.text)).hint(trouble.advice()).into()
    };
    let picture = planes(&found, choice).and_then(Measured::of).map_err(refused)?;
    for doubt in &picture.planes.warnings {
        let fault = Fault::new(format!("{shown}: {}", doubt.text)).hint(doubt.advice());
        console::scene_warning(&Warning::from(fault), None);
    }
    Ok(picture)
}

/// Converts an error of a measurement, with the name of the picture.
fn refuse(path: &Path, error: NotMeasured) -> Failure {
    Fault::new(format!("{}: {}", path.display(), error.text)).hint(error.hint).into()
}

/// Returns the quantity that `--quantity` names. `also` lists further words that the caller accepts, for the hint.
fn quantity(name: &str, picture: &Measured, also: &[&str]) -> Result<Quantity, Failure> {
    let name = name.trim();
    Quantity::named(name, picture).ok_or_else(|| {
        let words = Quantity::NAMED.iter().map(|(word, _)| *word).chain(also.iter().copied());
        let channels = picture.planes.channels.iter().map(|c| c.name.as_str());
        let known: Vec<&str> = words.chain(channels).collect();
        let hint = match nearest(name, known.iter().copied()) {
            Some(near) => format!("did you mean `{near}`?"),
            None => known.iter().take(24).map(|word| format!("`{word}`")).collect::<Vec<_>>().join(", "),
        };
        Fault::new(format!("--quantity: `{name}` is neither a quantity nor a channel of the picture")).hint(hint).into()
    })
}

/// Computes a quantity at each pixel of a picture.
fn field(path: &Path, picture: &Measured, quantity: &Quantity, white: Option<f64>) -> Result<QuantityMap, Failure> {
    QuantityMap::of(picture, quantity, white).map_err(|error| refuse(path, error))
}

/// Returns the name of a file without its extension.
fn stem(path: &Path) -> String {
    path.file_stem().map_or_else(|| "picture".to_owned(), |stem| stem.to_string_lossy().into_owned())
}

/// Returns the output file: the given one, or `NAME-REST` in the working folder, after the name of the picture.
fn output(given: Option<&PathBuf>, path: &Path, rest: &str) -> PathBuf {
    let plain = |c: char| if c.is_alphanumeric() || matches!(c, '-' | '_' | '.') { c } else { '-' };
    given.cloned().unwrap_or_else(|| format!("{}-{rest}", stem(path)).chars().map(plain).collect::<String>().into())
}

/// Formats a fraction as a percentage; a value that is not quite 0 is not shown as 0.
fn percent(share: f64) -> String {
    match 100.0 * share {
        p if p > 0.0 && p < 0.01 => "< 0.01 %".to_owned(),
        p => format!("{p:.2} %"),
    }
}
