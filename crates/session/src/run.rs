//! Every picture of a scene, from its file to files.

use crate::files::{Files, write_report};
use crate::{Event, Host, Names, Report, Session, SessionError, header, series};
use serde_json::Value;
use spectra_core::Isa;
use spectra_core::params::Warning;
use spectra_scene::{FilmTime, Series, SeriesKind, Shot};

/// What is to be rendered and written.
pub struct Job<'a> {
    /// The scene with all its pictures.
    pub series: &'a Series,
    /// Where the light comes from.
    pub light: LightFrom,
    /// Of several pictures, the places in the series of those that are wanted.
    pub chosen: Vec<usize>,
    /// Whether pictures whose files are all there are left as they are.
    pub skip_existing: bool,
    /// What files are called.
    pub names: Names,
    /// Instruction set.
    pub isa: Isa,
    /// For the record: how the scene's file was named.
    pub scene_file: String,
    /// For the record: what was set on top of it.
    pub overrides: Vec<String>,
    /// For the record: the version of the program.
    pub version: &'a str,
    /// For the record: the versions that a result depends on.
    pub versions: Value,
    /// The unit that a bare number at a path of a scene is read in.
    pub unit_of: &'a (dyn Fn(&str) -> Option<String> + Sync),
}

/// Where the light of a picture comes from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LightFrom {
    /// Rays through the lens.
    #[default]
    Rays,
    /// The pixels of the scene's flat picture, as an ideal lens would image them: no ray is traced.
    Pixels,
}

/// How a job ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ended {
    /// All is done.
    Whole,
    /// Somebody stopped it; what was done is written.
    Stopped,
}

/// Renders and writes all that a job wants.
///
/// # Errors
/// [`SessionError`]; of several pictures, those that are done are written.
pub fn run(job: &Job<'_>, host: &dyn Host) -> Result<Ended, SessionError> {
    if job.series.kind() == SeriesKind::Single {
        picture(job, host).map(|(ended, _)| ended)
    } else {
        series::run(job, host)
    }
}

/// A scene that is one picture; and how long its films were exposed.
pub(crate) fn picture(job: &Job<'_>, host: &dyn Host) -> Result<(Ended, Vec<FilmTime>), SessionError> {
    let mut session = Session::of_series(job.series.clone(), 0, job.isa)?;
    let member = session.member();
    let files = Files::of(&job.names, session.scene(), &member)?;
    // What cannot be rendered leaves no folder behind.
    fits(&session, host)?;
    host.hear(Event::Preparing);
    let exposed = match job.light {
        LightFrom::Rays => session.prepare(host.workers()).map(|()| None)?,
        LightFrom::Pixels => Some(session.expose()?),
    };
    host.hear(Event::Ready);
    // Before any light is traced: an hour's picture must not end without a place to go.
    let report_file = job.names.report(&member.stem(""));
    let mut names = files.names();
    names.extend(report_file.clone());
    prepare(job, host, &names)?;
    let control = host.control();
    session.warnings().for_each(|warning| host.hear(Event::Warning(warning)));
    session.scene().all_notes().for_each(|note| host.hear(Event::Note(note)));
    let mut taken = match exposed {
        Some(rendering) => Taken { rendering, seconds: 0.0, failure: None },
        None => Taken::of(&mut session, host, &control)?,
    };
    let failure = taken.failure.take();
    let exposure = &taken.rendering.exposure;
    let scene = session.scene();
    let times = scene.film_times(exposure);
    let attributes = header::attributes(scene, exposure, &times, taken.rendering.partial, job.version);
    let Taken { rendering, seconds, .. } = &taken;
    let report = Report { job, scene, rendering, times: &times, seconds: *seconds, threads: host.threads() };
    let shown: Vec<String> = names.iter().map(|name| host.folder().shown(name)).collect();
    let told = || report.to_json(&shown[..files.names().len()]);
    let shot = Shot::new(scene, exposure, &times, &attributes, job.isa).told(&told).with_layers(&rendering.layers);
    files.write(&shot, host.folder(), Some([host.folder(), host.elsewhere()]))?;
    if let Some(file) = &report_file {
        write_report(host.folder(), file, shot.report())?;
    }
    host.hear(Event::Written(&shown));
    let stopped = rendering.partial && host.is_interrupted();
    host.hear(Event::Done { report: &report, stopped });
    match failure {
        Some(text) => Err(SessionError::Failed(text)),
        None if stopped => Ok((Ended::Stopped, times)),
        None => Ok((Ended::Whole, times)),
    }
}

/// Whether there is memory for the picture.
pub(crate) fn fits(session: &Session, host: &dyn Host) -> Result<(), SessionError> {
    let fits = host.memory_bytes().map_or(Ok(()), |bytes| spectra_render::fits(session.scene(), bytes));
    fits.map_err(SessionError::Faults)
}

pub(crate) fn prepare(job: &Job<'_>, host: &dyn Host, names: &[String]) -> Result<(), SessionError> {
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    host.folder().prepare(job.series.name(), &names).map_err(SessionError::Failed)
}

/// The light of a picture.
pub(crate) struct Taken {
    pub rendering: spectra_render::Rendering,
    pub seconds: f64,
    /// Why it is not whole, where that is nobody's wish.
    pub failure: Option<String>,
}

impl Taken {
    /// Traces all samples that the scene states.
    pub(crate) fn of(
        session: &mut Session,
        host: &dyn Host,
        control: &spectra_render::Control,
    ) -> Result<Self, SessionError> {
        host.hear(Event::Start(session.scene()));
        let begun = host.now_s();
        let traced = session.advance(u64::from(session.scene().render.samples), host.workers(), control);
        let seconds = host.now_s() - begun;
        host.hear(Event::Traced);
        // What was computed before is worth keeping: it may be hours.
        let failure = match traced {
            Err(SessionError::Failed(text)) if session.has_light() => {
                Some(format!("{text}; the files hold the light traced before it, without that ray"))
            }
            traced => traced.map(|()| None)?,
        };
        let mut rendering = session.look()?;
        rendering.partial |= failure.is_some();
        rendering.warnings = session.remarks(&rendering);
        for warning in &rendering.warnings {
            host.hear(Event::Warning(&Warning::from(warning.clone())));
        }
        // Developing takes memory of its own.
        session.forget_light();
        Ok(Self { rendering, seconds, failure })
    }
}
