//! `spectra glass`: inspects, compares and fits the refractive index of glasses and other media.

mod arguments;
mod check;
mod fit;
mod info;
mod list;
mod nearest;
mod plot;

pub(crate) use arguments::{GlassArguments, OwnCatalogues};

use crate::console;
use crate::outcome::{Failure, Outcome};
use arguments::GlassCommand;
use spectra_core::names::nearest as near_words;
use spectra_core::params::Fault;
use spectra_glass::{Catalog, FindError, Glass, GlassFacts, Medium, agf, file};
use spectra_scene::FileResources;
use std::borrow::Cow;
use std::io::Read;
use std::path::Path;

/// Runs one of the commands of `spectra glass`.
pub(crate) fn glass(command: &GlassCommand) -> Outcome {
    match command {
        GlassCommand::Info(arguments) => info::info(arguments),
        GlassCommand::List(arguments) => list::list(arguments),
        GlassCommand::Plot(arguments) => plot::plot(arguments),
        GlassCommand::Match(arguments) => nearest::nearest(arguments),
        GlassCommand::Fit(arguments) => fit::fit(arguments),
        GlassCommand::Check(arguments) => check::check(arguments),
    }
}

/// Largest file that is read, bytes. Makers' catalogues have some hundred thousand.
const MAX_BYTES: u64 = 16 << 20;

/// Returns the bundled catalogue together with the user's own glasses. Warns about lines in those files that are not understood.
fn catalogue(own: &OwnCatalogues) -> Result<Cow<'static, Catalog>, Failure> {
    let mut catalogue = Cow::Borrowed(Catalog::bundled());
    for path in &own.files {
        catalogue.to_mut().add(own_glasses(path)?);
    }
    Ok(catalogue)
}

/// Reads the glasses of a catalogue file (AGF). Warns about lines that are not understood. Fails if there is no glass.
pub(crate) fn own_glasses(path: &Path) -> Result<Vec<Glass>, Failure> {
    let bytes = read(path)?;
    let maker = path.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
    let read = agf::read(&bytes, &maker);
    for problem in &read.problems {
        console::warning(&format!("{}:{}: {}", path.display(), problem.line, problem.message));
    }
    if read.glasses.is_empty() {
        let hint = "a glass catalogue (AGF) has lines `NM ...` and `CD ...`";
        return Err(Failure::Input(format!("{}: no glass in it; {hint}", path.display())));
    }
    Ok(read.glasses)
}

/// Returns the medium of a name: a file in the working folder, or a medium of the catalogue.
fn named(name: &str, catalogue: &Catalog) -> Result<Medium, Failure> {
    match own_file(name)? {
        Some(glass) => Ok(glass.into()),
        None if ["air", "vacuum"].iter().any(|medium| name.trim().eq_ignore_ascii_case(medium)) => {
            catalogue.medium(name).map_err(unknown)
        }
        None => Ok(chosen(name, GlassFacts::default(), catalogue)?.into()),
    }
}

/// Returns the glass that a name and known facts select. A note says so if several glasses have the name.
fn chosen(name: &str, facts: GlassFacts<'_>, catalogue: &Catalog) -> Result<Glass, Failure> {
    let chosen = catalogue.choose(name, facts).map_err(unknown)?;
    if let Some(note) = &chosen.note {
        console::note(note);
    }
    Ok(chosen.glass)
}

/// Converts the error for an unknown or ambiguous name.
fn unknown(error: FindError) -> Failure {
    Failure::Faults(Fault::new(error.message()).hint(error.hint()).into())
}

/// Loads the glass of a file in the working folder; `None` if `name` is a name of the catalogue.
fn own_file(name: &str) -> Result<Option<Glass>, Failure> {
    if !file::is_file(name) {
        return Ok(None);
    }
    Ok(Some(file::load(name, &FileResources::beside(Path::new("")))?))
}

/// Reads a whole file, or standard input for `-`. Fails above [`MAX_BYTES`].
fn read(path: &Path) -> Result<Vec<u8>, Failure> {
    let refuse = |text: String| Failure::Input(format!("{}: {text}", path.display()));
    let mut bytes = Vec::new();
    if path == Path::new("-") {
        let input = std::io::stdin().lock();
        input.take(MAX_BYTES + 1).read_to_end(&mut bytes).map_err(|e| refuse(format!("cannot be read: {e}")))?;
    } else {
        let file = std::fs::File::open(path).map_err(|e| refuse(format!("cannot be read: {e}")))?;
        file.take(MAX_BYTES + 1).read_to_end(&mut bytes).map_err(|e| refuse(format!("cannot be read: {e}")))?;
    }
    if bytes.len() as u64 > MAX_BYTES {
        return Err(refuse(format!("larger than {} MB", MAX_BYTES >> 20)));
    }
    Ok(bytes)
}

/// Returns the makers' names as written in the catalogue. Fails if one is unknown.
fn makers(asked: &[String], catalogue: &Catalog) -> Result<Vec<String>, Failure> {
    let known = catalogue.makers();
    let find = |name: &String| {
        let name = name.trim();
        known.iter().find(|k| k.eq_ignore_ascii_case(name)).cloned().ok_or_else(|| {
            let near = near_words(name, known.iter().map(String::as_str));
            let hint = near.map_or(String::new(), |near| format!("; did you mean {near}?"));
            Failure::Input(format!("unknown maker `{name}`{hint}"))
        })
    };
    asked.iter().map(find).collect()
}

/// Formats the years of the first and the last catalogue that list a glass: `1923-1967`, or one year.
fn period((first, last): (u16, u16)) -> String {
    if first == last { first.to_string() } else { format!("{first}-{last}") }
}
