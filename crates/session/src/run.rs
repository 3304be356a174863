//! Rendering of every picture of a scene, from its file to output files.

use crate::exposure_warnings::exposure_warnings;
use crate::files::{Files, write_report};
use crate::job::{Job, JobEnd};
use crate::traced_picture::{IncompletePolicy, TracedPicture, prepare};
use crate::{Event, Host, Report, Session, SessionError, SessionOptions, formatting, header, series};
use spectra_darkroom::{LightFrom, is_generated, without_generated_place};
use spectra_scene::{FilmTime, SeriesKind, Shot};

/// Renders and writes all pictures of a job.
///
/// # Errors
/// [`SessionError`]; if there are several pictures, the finished ones are written.
pub fn run(job: &Job<'_>, host: &dyn Host) -> Result<JobEnd, SessionError> {
    if job.series.kind() == SeriesKind::Single {
        picture(job, IncompletePolicy::IsKept, host).map(|(ended, _)| ended)
    } else {
        series::run(job, host)
    }
}

/// Renders and writes a scene that is one picture, and returns the exposure times of its films.
pub(crate) fn picture(
    job: &Job<'_>,
    unfinished: IncompletePolicy,
    host: &dyn Host,
) -> Result<(JobEnd, Vec<FilmTime>), SessionError> {
    let mut session = Session::new(job.series.clone(), SessionOptions { isa: job.isa, ..SessionOptions::default() })?;
    let member = session.member();
    let files = Files::of(&job.names, session.scene(), &member)?;
    // Checked before any folder is made, so that a scene that does not fit into memory leaves none behind.
    fits(&session, host)?;
    host.hear(Event::Preparing);
    let exposed = match job.light {
        LightFrom::Rays => session.prepare(host.workers()).map(|()| None)?,
        LightFrom::Pixels => Some(session.expose()?),
    };
    host.hear(Event::Ready);
    // Checked before any light is traced: a picture that took an hour must have a place to go.
    let report_file = job.names.report(&member.stem(""));
    let mut names = files.names();
    names.extend(report_file.clone());
    prepare(job, host, &names)?;
    let control = host.control();
    session.warnings().for_each(|warning| host.hear(Event::Warning(&without_generated_place(warning))));
    session.scene().all_notes().for_each(|note| host.hear(Event::Note(note)));
    let mut taken = match exposed {
        Some(rendering) => TracedPicture { rendering, seconds: 0.0, failure: None },
        None => TracedPicture::of(&mut session, host, &control, unfinished)?,
    };
    let failure = taken.failure.take();
    let stopped = taken.rendering.partial && host.is_interrupted();
    let (mut files, mut report_file) = (files, report_file);
    if taken.rendering.partial {
        if unfinished == IncompletePolicy::IsLeftOut {
            return failure.map_or(Ok((JobEnd::Stopped, Vec::new())), |text| Err(SessionError::Failed(text)));
        }
        let there = names.iter().find(|name| host.folder().has(name));
        // A picture ended by a time limit is what the user asked for, so it keeps its names.
        if let (Some(there), true) = (there, stopped || failure.is_some()) {
            let there = formatting::files(&[host.folder().shown(there)]);
            host.hear(Event::Note(&format!(
                "`{there}` was not overwritten. The picture is incomplete and was saved under another name"
            )));
            let partial = job.names.of_partial();
            files = Files::of(&partial, session.scene(), &member)?;
            report_file = partial.report(&member.stem(""));
            names = files.names();
            names.extend(report_file.clone());
            // These names must not overwrite a file that the scene is read from, either.
            prepare(job, host, &names)?;
        }
    }
    let exposure = &taken.rendering.exposure;
    let scene = session.scene();
    let times = scene.film_times(exposure);
    if !taken.rendering.partial {
        // Values that the program wrote are not warned about: a sequence exposed like its first frame may fade to black.
        let stated = exposure_warnings(scene, exposure).into_iter().filter(|warning| !is_generated(warning));
        stated.for_each(|warning| host.hear(Event::Warning(&warning)));
    }
    let attributes = header::attributes(scene, exposure, &times, taken.rendering.partial, job.version);
    let TracedPicture { rendering, seconds, .. } = &taken;
    let report = Report { job, scene, rendering, times: &times, seconds: *seconds, threads: host.threads() };
    let shown: Vec<String> = names.iter().map(|name| host.folder().shown(name)).collect();
    let told = || report.to_json(&shown[..files.names().len()]);
    let shot =
        Shot::new(scene, exposure, &times, &attributes, job.isa).with_report(&told).with_layers(&rendering.layers);
    files.write(&shot, host.folder(), Some([host.folder(), host.elsewhere()]))?;
    if let Some(file) = &report_file {
        write_report(host.folder(), file, shot.report())?;
    }
    host.hear(Event::Written(&shown));
    host.hear(Event::Done { report: &report, stopped });
    match failure {
        Some(text) => Err(SessionError::Failed(text)),
        None if stopped => Ok((JobEnd::Stopped, times)),
        None => Ok((JobEnd::Whole, times)),
    }
}

/// Checks that the picture fits into memory.
pub(crate) fn fits(session: &Session, host: &dyn Host) -> Result<(), SessionError> {
    let fits = host.memory_bytes().map_or(Ok(()), |bytes| spectra_render::fits(session.scene(), bytes));
    fits.map_err(SessionError::Faults)
}
