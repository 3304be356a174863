//! `spectra lens trace`: traces a table of rays through a lens.

use super::arguments::LensTrace;
use super::{load, one_light};
use crate::folder::apart;
use crate::outcome::{DONE, Failure, Outcome};
use crate::{console, formatting};
use spectra_analysis::trace::{Format, TraceError, TraceSummary, Tracing, trace as trace_rays};
use spectra_core::Loss;
use spectra_core::surface::Action;
use spectra_files::{WriteFault, write_atomically};
use spectra_lens::Lens;
use spectra_tracer::{Path as LightPath, Travel};
use std::fs::File;
use std::io::{self, BufReader, BufWriter, Read, Write};
use std::path::Path;

/// Traces a table of rays and writes the result as CSV or JSON lines.
pub(crate) fn trace(arguments: &LensTrace) -> Outcome {
    let lens = load(&arguments.setting)?;
    let light = one_light(&arguments.light);
    let format = if arguments.json { Format::JsonLines } else { Format::Csv };
    let output = arguments.output.as_deref().filter(|path| *path != Path::new("-"));
    output.map_or(Ok(()), |output| apart(output, &[&arguments.rays]))?;
    let (input, name) = open(&arguments.rays)?;
    let path = path_of(&arguments.path, &lens)?;
    let run = |output: &mut dyn Write| {
        let rays = BufReader::new(input);
        let tracing = Tracing { light, path: path.as_ref(), format, every_surface: arguments.every_surface };
        trace_rays(&lens, tracing, rays, &name, &mut BufWriter::new(output))
    };
    let summary = match output {
        None => run(&mut console::Out).map_err(|error| failure(error, None))?,
        Some(path) => to_file(path, run)?,
    };
    for note in &lens.notes {
        console::note(&format!("note: {note}"));
    }
    for warning in lens.warnings.iter().chain(&summary.warnings) {
        console::warning(warning);
    }
    if let Some(path) = output {
        console::note(&format!("wrote {}: {}", path.display(), describe(&summary)));
    }
    Ok(DONE)
}

/// Returns the light path that reflects at the given surfaces (counted from 1); `None` if there are none. Fails if no such path exists.
pub(super) fn path_of(surfaces: &[usize], lens: &Lens) -> Result<Option<LightPath>, Failure> {
    if surfaces.is_empty() {
        return Ok(None);
    }
    let refuse = |text: String| Failure::Input(format!("--path: {text}"));
    if surfaces.len() % 2 == 1 {
        return Err(refuse(
            "an odd number of reflections leads back out of the front; name two surfaces, as in 7,3".to_owned(),
        ));
    }
    let count = lens.elements.len();
    let Some(at) = surfaces.iter().map(|at| at.checked_sub(1)).collect::<Option<Vec<_>>>() else {
        return Err(refuse("surfaces are counted from 1".to_owned()));
    };
    if let Some(other) = at.iter().find(|at| lens.elements.get(**at).is_some_and(|e| e.action != Action::Refract)) {
        return Err(refuse(format!("surface {} does not refract, so it makes no ghost reflection", other + 1)));
    }
    LightPath::reflected(count, Travel::Forward, &at).map(Some).map_err(|error| refuse(error.to_string()))
}

fn open(path: &Path) -> Result<(Box<dyn Read>, String), Failure> {
    if path == Path::new("-") {
        return Ok((Box::new(io::stdin().lock()), "standard input".to_owned()));
    }
    let name = path.display().to_string();
    if path.is_dir() {
        return Err(Failure::Input(format!("{name}: is a folder; --rays takes a CSV file, or - for standard input")));
    }
    let file = File::open(path).map_err(|error| Failure::Input(format!("{name}: cannot be read: {error}")))?;
    Ok((Box::new(file), name))
}

/// Traces to a file, which appears under its name only when all rays are traced. A device is written as the trace goes on.
fn to_file(
    path: &Path,
    run: impl FnOnce(&mut dyn Write) -> Result<TraceSummary, TraceError>,
) -> Result<TraceSummary, Failure> {
    if std::fs::metadata(path).is_ok_and(|data| !data.is_file()) {
        let mut device = File::options().write(true).open(path).map_err(|error| cannot_write(path, &error))?;
        return run(&mut device).map_err(|error| failure(error, Some(path)));
    }
    let mut result = None;
    let written = write_atomically(path, |file| {
        let outcome = run(file);
        let good = outcome.is_ok();
        result = Some(outcome);
        // This error only discards the file; the real one is in `result` and returned below.
        if good { Ok(()) } else { Err(WriteFault::Format(String::new())) }
    });
    match (result, written) {
        (Some(Err(error)), _) => Err(failure(error, Some(path))),
        (_, Err(error)) => Err(Failure::Failed(error.to_string())),
        (Some(Ok(summary)), Ok(())) => Ok(summary),
        (None, Ok(())) => unreachable!("a file is written by running"),
    }
}

fn cannot_write(path: &Path, error: &io::Error) -> Failure {
    Failure::Failed(format!("{}: cannot be written: {error}", path.display()))
}

fn failure(error: TraceError, output: Option<&Path>) -> Failure {
    match (error, output) {
        (TraceError::Write(cause), None) => cause.into(),
        (TraceError::Write(cause), Some(path)) => cannot_write(path, &cause),
        (error @ TraceError::Read { .. }, _) => Failure::Failed(error.to_string()),
        (error @ (TraceError::Input { .. } | TraceError::Lens(_)), _) => Failure::Input(error.to_string()),
    }
}

/// Returns a summary such as `1 540 rays, 912 hit, 520 vignetted`.
fn describe(summary: &TraceSummary) -> String {
    let mut text = format!("{}, {} hit", formatting::counted(summary.rays, "ray"), formatting::count(summary.hits));
    for cause in Loss::ALL {
        let many = summary.losses.of_cause(cause);
        if many > 0 {
            text.push_str(&format!(", {} {}", formatting::count(many), cause.name()));
        }
    }
    text
}
