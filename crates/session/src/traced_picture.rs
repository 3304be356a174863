//! Tracing of one picture, and the check of its output files before that.

use crate::job::Job;
use crate::{Event, Host, Session, SessionError};
use spectra_core::params::{Fault, Warning};

/// Checks that files of these names can be written, and that none would overwrite a file that the scene is read from.
pub(crate) fn prepare(job: &Job<'_>, host: &dyn Host, names: &[String]) -> Result<(), SessionError> {
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let folder = host.folder();
    let read = job.series.files_on_disk();
    if let Some(file) = names.iter().find(|name| read.iter().any(|path| folder.is(name, path))) {
        let text = format!("`{}` is a file that the scene is read from and would be overwritten", folder.shown(file));
        return Err(Fault::new(text).hint("choose another folder or name with `--output`").into());
    }
    folder.prepare(job.series.name(), &names).map_err(SessionError::Failed)
}

/// Treatment of a picture that is stopped before it is complete.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum IncompletePolicy {
    /// The picture is written; if files of its name exist, it is written beside them.
    IsKept,
    /// The picture is not written at all, because every file of a series must be complete.
    IsLeftOut,
}

/// Traced light of one picture.
pub(crate) struct TracedPicture {
    pub rendering: spectra_render::Rendering,
    pub seconds: f64,
    /// Cause of an incomplete picture, unless it was stopped on purpose.
    pub failure: Option<String>,
}

impl TracedPicture {
    /// Traces all samples that the scene states. A picture that was stopped and will be left out gets no remarks.
    pub(crate) fn of(
        session: &mut Session,
        host: &dyn Host,
        control: &spectra_render::Control,
        unfinished: IncompletePolicy,
    ) -> Result<Self, SessionError> {
        host.hear(Event::Start(session.scene()));
        let begun = host.now_s();
        let traced = session.advance(u64::from(session.scene().render.samples), host.workers(), control);
        let seconds = host.now_s() - begun;
        host.hear(Event::Traced);
        // Light traced before the failure is worth keeping: it may have taken hours.
        let failure = match traced {
            Err(SessionError::Failed(text)) if session.has_light() => {
                Some(format!("{text}; the files hold the light traced so far, without that ray"))
            }
            traced => traced.map(|()| None)?,
        };
        let mut rendering = session.rendering()?;
        rendering.partial |= failure.is_some();
        if !rendering.partial || unfinished == IncompletePolicy::IsKept {
            rendering.warnings = session.rendering_warnings(&rendering);
        }
        for warning in &rendering.warnings {
            host.hear(Event::Warning(&Warning::from(warning.clone())));
        }
        // Frees the light, because development needs memory of its own.
        session.forget_light();
        Ok(Self { rendering, seconds, failure })
    }
}
