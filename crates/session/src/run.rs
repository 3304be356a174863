//! Rendering of every picture of a scene, from its file to output files.

use crate::exposure_warnings::exposure_warnings;
use crate::job::{Job, JobEnd};
use crate::picture_files::{DevelopedOnce, PictureFiles, Snapshots};
use crate::traced_picture::{IncompletePolicy, TracedPicture, Tracing, prepare};
use crate::{Event, Host, Report, Session, SessionError, SessionOptions, TimeSpent, formatting, series};
use spectra_darkroom::{LightFrom, is_generated, without_generated_place};
use spectra_scene::{FilmTime, Member, Scene, SeriesKind};

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
    let whole = PictureFiles::of(&job.names, session.scene(), &member)?;
    session.keep_light(job.names.ask_for_light(session.scene()));
    // Checked before any folder is made, so that a scene that does not fit into memory leaves none behind.
    fits(&session, host)?;
    host.hear(Event::Preparing);
    let exposed = match job.light {
        LightFrom::Rays => session.prepare(host.workers()).map(|()| None)?,
        LightFrom::Pixels => Some(session.expose()?),
    };
    host.hear(Event::Ready);
    // Checked before any light is traced: a picture that took an hour must have a place to go.
    prepare(job, host, &whole.names())?;
    session.warnings().for_each(|warning| host.hear(Event::Warning(&without_generated_place(warning))));
    session.scene().all_notes().for_each(|note| host.hear(Event::Note(note)));
    let mut snapshots = Snapshots::new(job, host);
    let traced = match exposed {
        Some(rendering) => Some((TracedPicture { rendering, seconds: 0.0, failure: None }, None)),
        None => traced(job, &mut session, unfinished, &mut snapshots, host)?,
    };
    let Some((TracedPicture { rendering, seconds, failure }, developed)) = traced else {
        if unfinished == IncompletePolicy::IsKept {
            host.hear(Event::Note("stopped before the first pass over the frame was complete: nothing was written"));
        }
        return Ok((JobEnd::Stopped, Vec::new()));
    };
    let stopped = rendering.partial && host.is_interrupted();
    let scene = session.scene();
    let files = match rendering.partial {
        true => partial_files(job, scene, &member, whole, host)?,
        false => whole,
    };
    if !rendering.partial {
        // Values that the program wrote are not warned about: a sequence exposed like its first frame may fade to black.
        let stated = exposure_warnings(scene, &rendering.exposure).into_iter().filter(|warning| !is_generated(warning));
        stated.for_each(|warning| host.hear(Event::Warning(&warning)));
    }
    let times = match developed {
        Some(developed) => developed.store(&files, host)?,
        None => {
            let backups = [host.folder(), host.elsewhere()];
            files.write((job, host, scene), (&rendering, seconds), host.folder(), Some(backups))?
        }
    };
    snapshots.remove(&files.names());
    host.hear(Event::Written(&files.shown(host)));
    let report = Report { job, scene, rendering: &rendering, times: &times, seconds, threads: host.threads() };
    host.hear(Event::Done { report: &report, stopped });
    match failure {
        Some(text) => {
            let text = format!("{text}; the files hold the light traced so far, without that ray");
            Err(SessionError::Failed(text))
        }
        None if stopped => Ok((JobEnd::Stopped, times)),
        None => Ok((JobEnd::Whole, times)),
    }
}

/// Traces a picture, as far as a time limit or the user allows. Returns it, and its files in memory if they are all that there is time for;
/// `None` if it was stopped before the first pass over the frame was complete.
fn traced(
    job: &Job<'_>,
    session: &mut Session,
    unfinished: IncompletePolicy,
    snapshots: &mut Snapshots<'_>,
    host: &dyn Host,
) -> Result<Option<(TracedPicture, Option<DevelopedOnce>)>, SessionError> {
    let prepared_s = host.now_s();
    let mut tracing = Tracing::new(session, host);
    if let Some(limit_s) = host.time_limit_s().filter(|_| unfinished == IncompletePolicy::IsKept) {
        if !tracing.first_pass()? {
            if host.is_interrupted() {
                return tracing.end(unfinished).map(|traced| traced.map(|traced| (traced, None)));
            }
            let spent = TimeSpent { limit_s, prepared_s: Some(prepared_s), pass_s: None };
            return Err(SessionError::Failed(spent.too_short(host.now_s())));
        }
        host.hear(Event::FirstPass);
        // The first pass is developed at once: to know how long that takes, and to have a picture if there is no time for more.
        let begun = host.now_s();
        let mut rendering = tracing.so_far()?;
        rendering.warnings = tracing.session().rendering_warnings(&rendering);
        let developed = DevelopedOnce::new(job, tracing.session(), (&rendering, tracing.seconds()), host)?;
        host.hear(Event::DevelopedOnce { seconds: host.now_s() - begun });
        if host.is_stopped() {
            return Ok(Some((tracing.end_with(rendering), Some(developed))));
        }
    }
    tracing.all(|session, seconds| snapshots.take(session, seconds))?;
    Ok(tracing.end(unfinished)?.map(|traced| (traced, None)))
}

/// Returns the files for a partial picture. It never takes the place of a finished one. Nor does a picture that the user stopped take the
/// place of a partial one: that may have more light.
fn partial_files(
    job: &Job<'_>,
    scene: &Scene,
    member: &Member,
    whole: PictureFiles,
    host: &dyn Host,
) -> Result<PictureFiles, SessionError> {
    let is_limit = host.time_limit_s().is_some() && !host.is_interrupted();
    let Some(there) = whole.finished(host.folder(), is_limit) else { return Ok(whole) };
    let there = formatting::files(&[host.folder().shown(&there)]);
    host.hear(Event::Note(&format!(
        "`{there}` was not overwritten. The picture is incomplete and was saved under another name"
    )));
    let partial = PictureFiles::of(&job.names.of_partial(), scene, member)?;
    // These names must not overwrite a file that the scene is read from, either.
    prepare(job, host, &partial.names())?;
    Ok(partial)
}

/// Checks that the picture fits into memory.
pub(crate) fn fits(session: &Session, host: &dyn Host) -> Result<(), SessionError> {
    let fits = host.memory_bytes().map_or(Ok(()), |bytes| spectra_render::fits(session.scene(), bytes));
    fits.map_err(SessionError::Faults)
}
