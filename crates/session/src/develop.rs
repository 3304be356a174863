//! Development of a film from one or many picture files, without a scene file.

use crate::run::{fits, picture};
use crate::traced_picture::{IncompletePolicy, TracedPicture};
use crate::{
    Event, Host, Job, JobEnd, LightFrom, Names, SeriesPosition, Session, SessionError, SessionOptions, formatting,
};
use serde_json::{Value, json};
use spectra_core::Isa;
use spectra_core::params::{Fault, Params, Warning};
use spectra_core::registry::{self, Context};
use spectra_core::spectral::BAND;
use spectra_darkroom::{DevelopSettings, PictureJob, without_generated_places};
use spectra_scene::{FileResources, FilmTime, Output, yaml};
use std::path::Path;

/// Pictures to develop, and how to develop them.
pub struct Develop<'a> {
    /// Pictures to develop, in order.
    pub plates: Vec<PictureJob>,
    /// Settings of their scenes.
    pub settings: DevelopSettings,
    /// Whether the pictures are a series. Of a series only complete pictures are written, and one that fails does not stop the
    /// others.
    pub is_series: bool,
    /// Notes on a series, given before any of it is developed.
    pub notes: Vec<String>,
    /// Whether pictures whose files already exist are skipped.
    pub skip_existing: bool,
    /// Instruction set that rays are traced with.
    pub isa: Isa,
    /// Version of the program, for the record.
    pub version: &'a str,
    /// Versions that a result depends on, for the record.
    pub versions: Value,
}

/// Returns the extension of the picture file, such as `png`, if `output` is set among `overrides` (texts `path=value`).
///
/// # Errors
/// `output` names a file that is not a picture, or more than one file.
pub fn picture_ending(overrides: &[String]) -> Result<Option<String>, Fault> {
    // A value that cannot be read is reported when the scene is read.
    let set =
        overrides.iter().rev().filter_map(|text| yaml::parse_override(text).ok()).find(|set| set.path == "output");
    let Some(yaml::Override { node, .. }) = set else { return Ok(None) };
    let files = FileResources::beside(Path::new(""));
    let context = Context::new(&files, BAND);
    let mut endings = Vec::new();
    for item in (0..).map_while(|index| node.element(index)) {
        let output = Params::stage(item.clone(), "output").and_then(|p| registry::build::<dyn Output>(&p, &context));
        let Ok(output) = output else { return Ok(None) };
        endings.push(output.ending()[1]);
    }
    match &endings[..] {
        [ending] if Names::of_picture(Path::new(&format!("picture{ending}"))).is_some() => {
            Ok(Some(ending.trim_start_matches('.').to_owned()))
        }
        [] => Ok(None),
        [ending] => {
            let text = format!("`film develop` writes pictures, but {ending} is not a picture");
            Err(node.fault(text).hint("`--set output=[png]`, or tiff or exr"))
        }
        [first, ..] => {
            let text = format!("one file is written for each picture, but these are {}", endings.join(", "));
            let hint = format!(
                "keep one, or choose with `-o`: `-o out/picture{first}`, or `-o out/####{first}` for a sequence"
            );
            Err(node.fault(text).hint(hint))
        }
    }
}

/// Develops all pictures of a job.
///
/// # Errors
/// [`SessionError`]; if one of several pictures fails, the others are developed all the same.
pub fn develop(job: &Develop<'_>, host: &dyn Host) -> Result<JobEnd, SessionError> {
    match &job.plates[..] {
        [plate] if !job.is_series && !job.skip_existing => {
            one(job, plate, None, IncompletePolicy::IsKept, host).map(|(ended, _)| ended)
        }
        // A file that is skipped if it exists must be complete, so an incomplete picture is not written.
        [plate] if !job.is_series => {
            host.hear(Event::Picture(Some(place(plate, 0, 1))));
            if is_there(plate, 0, 1, host) {
                return Ok(JobEnd::Whole);
            }
            one(job, plate, None, IncompletePolicy::IsLeftOut, host).map(|(ended, _)| ended)
        }
        plates => all(job, plates, host),
    }
}

/// Returns the number and the position of a picture among all.
fn place(plate: &PictureJob, index: usize, of: usize) -> SeriesPosition {
    let number = plate.number.unwrap_or(index as u64 + 1);
    SeriesPosition { number: u32::try_from(number).unwrap_or(u32::MAX), index, of }
}

/// Returns whether a picture's file already exists, and reports it if so.
fn is_there(plate: &PictureJob, index: usize, of: usize, host: &dyn Host) -> bool {
    let is_there = host.folder().has(&plate.output);
    if is_there {
        let shown = host.folder().shown(&plate.output);
        host.hear(Event::Series(
            &format!("{} of {of}: {} already exists", index + 1, formatting::files(std::slice::from_ref(&shown))),
            &json!({ "event": "kept", "files": [shown] }),
        ));
    }
    is_there
}

/// Develops pictures one after another.
fn all(job: &Develop<'_>, plates: &[PictureJob], host: &dyn Host) -> Result<JobEnd, SessionError> {
    let begun_s = host.now_s();
    host.hear(Event::Series(
        &format!(
            "{}, {}",
            formatting::counted(plates.len() as u64, "picture"),
            if job.settings.meter_each { "each metered" } else { "exposed like the first" }
        ),
        &json!({ "event": "series", "pictures": plates.len(), "metered": if job.settings.meter_each { "each" } else { "first" } }),
    ));
    for note in &job.notes {
        host.hear(Event::Note(note));
    }
    let (mut metered, mut done, mut failed) = (None, 0, Vec::new());
    // A stated exposure is not metered.
    let mut meters = !job.settings.meter_each;
    let mut ended = JobEnd::Whole;
    for (index, plate) in plates.iter().enumerate() {
        if host.is_stopped() {
            ended = JobEnd::Stopped;
            break;
        }
        host.hear(Event::Picture(Some(place(plate, index, plates.len()))));
        if job.skip_existing && is_there(plate, index, plates.len(), host) {
            done += 1;
            continue;
        }
        if metered.is_none() && meters && index > 0 {
            let mut earlier =
                plates[..index].iter().filter(|earlier| failed.iter().all(|(file, _)| *file != earlier.file));
            metered = earlier.find_map(|earlier| meter(job, earlier, host));
            if host.is_stopped() {
                ended = JobEnd::Stopped;
                break;
            }
            if metered.is_none() {
                let text = format!(
                    "`{}` sets the exposure instead of the first picture; those after it are exposed like it",
                    plate.file
                );
                host.hear(Event::Warning(&Warning::from(text)));
            }
        }
        let exposure = metered.as_ref().filter(|_| !job.settings.meter_each);
        match one(job, plate, exposure, IncompletePolicy::IsLeftOut, host) {
            Ok((JobEnd::Stopped, _)) => {
                ended = JobEnd::Stopped;
                break;
            }
            Ok((JobEnd::Whole, times)) => {
                done += 1;
                metered = metered.or_else(|| times.into_iter().find(|time| time.is_metered));
                meters &= metered.is_some();
            }
            // A fault of the settings affects every picture.
            Err(SessionError::Faults(faults)) if faults.iter().any(|fault| fault.place.is_some()) => {
                return Err(faults.into());
            }
            Err(error @ SessionError::Request(_)) => return Err(error),
            Err(error) => {
                host.hear(Event::Warning(&Warning::from(format!("`{}` was not developed: {error}", plate.file))));
                failed.push((plate.file.clone(), error.to_string()));
            }
        }
    }
    host.hear(Event::Picture(None));
    let stopped = ended == JobEnd::Stopped && host.is_interrupted();
    host.hear(Event::Series(
        &format!(
            "{done} of {} in {}",
            formatting::counted(plates.len() as u64, "picture"),
            formatting::duration(host.now_s() - begun_s)
        ),
        &json!({ "event": "end", "done": done, "of": plates.len(), "interrupted": stopped }),
    ));
    match &failed[..] {
        [] => Ok(ended),
        [(file, why)] => Err(SessionError::Failed(format!("`{file}` was not developed: {why}"))),
        // Gives the cause of the first failure: all may have the same one, and warnings may be turned off.
        [(file, why), ..] => {
            Err(SessionError::Failed(format!("{} pictures were not developed: `{file}`: {why} ...", failed.len())))
        }
    }
}

/// Meters a picture whose file already exists. Returns `None` if it cannot be read, or if tracing stops. Through a lens it is
/// traced with all samples, because fewer would change the last digits of the metered time.
fn meter(job: &Develop<'_>, plate: &PictureJob, host: &dyn Host) -> Option<FilmTime> {
    let (series, light) = job.settings.scene(plate, None).ok()?;
    let mut session = Session::new(series, SessionOptions { isa: job.isa, ..SessionOptions::default() }).ok()?;
    let rendering = match light {
        LightFrom::Pixels => session.expose().ok()?,
        LightFrom::Rays if !session.scene().films.iter().any(|film| film.film.is_metered()) => return None,
        LightFrom::Rays => {
            fits(&session, host).ok()?;
            host.hear(Event::Note(&format!("`{}` is traced once more, to expose the others like it", plate.file)));
            session.prepare(host.workers()).ok()?;
            TracedPicture::of(&mut session, host, IncompletePolicy::IsLeftOut).ok()??.rendering
        }
    };
    session.scene().film_times(&rendering.exposure).into_iter().find(|time| time.is_metered)
}

/// Develops a picture, with the exposure metered on another one if `metered` is given.
fn one(
    job: &Develop<'_>,
    plate: &PictureJob,
    metered: Option<&FilmTime>,
    unfinished: IncompletePolicy,
    host: &dyn Host,
) -> Result<(JobEnd, Vec<FilmTime>), SessionError> {
    let (series, light) = job.settings.scene(plate, metered)?;
    let of_picture = Names::of_picture(Path::new(&plate.output));
    let none = || SessionError::Request(format!("{}: a picture cannot be written with this ending", plate.output));
    let job = Job {
        series: &series,
        light,
        chosen: vec![0],
        skip_existing: false,
        names: of_picture.ok_or_else(none)?,
        isa: job.isa,
        scene_file: plate.file.clone(),
        overrides: series.overrides().to_vec(),
        version: job.version,
        versions: job.versions.clone(),
    };
    picture(&job, unfinished, host).map_err(|error| match error {
        SessionError::Faults(faults) => SessionError::Faults(without_generated_places(faults)),
        other => other,
    })
}
