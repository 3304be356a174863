//! The light of a picture, and the place for its files before any is traced.

use crate::job::Job;
use crate::{Event, Host, Session, SessionError};
use spectra_core::params::{Fault, Warning};

/// Sees to it that such files can be written, and none of them over one that the scene is made of.
pub(crate) fn prepare(job: &Job<'_>, host: &dyn Host, names: &[String]) -> Result<(), SessionError> {
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let folder = host.folder();
    let read = job.series.files_on_disk();
    if let Some(file) = names.iter().find(|name| read.iter().any(|path| folder.is(name, path))) {
        let text = format!("`{}` would be written over a file that the scene is made of", folder.shown(file));
        return Err(Fault::new(text).hint("another folder or name at `--output`").into());
    }
    folder.prepare(job.series.name(), &names).map_err(SessionError::Failed)
}

/// What becomes of a picture that is stopped before it is whole.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Unfinished {
    /// It is written: where files of its name are there, beside them.
    IsKept,
    /// Nothing is written of it: a file of a series is whole.
    IsLeftOut,
}

/// The light of a picture.
pub(crate) struct Taken {
    pub rendering: spectra_render::Rendering,
    pub seconds: f64,
    /// Why it is not whole, where that is nobody's wish.
    pub failure: Option<String>,
}

impl Taken {
    /// Traces all samples that the scene states. Of a picture that is left out where it is stopped, nothing is looked for, nor said,
    /// then.
    pub(crate) fn of(
        session: &mut Session,
        host: &dyn Host,
        control: &spectra_render::Control,
        unfinished: Unfinished,
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
        if !rendering.partial || unfinished == Unfinished::IsKept {
            rendering.warnings = session.remarks(&rendering);
        }
        for warning in &rendering.warnings {
            host.hear(Event::Warning(&Warning::from(warning.clone())));
        }
        // Developing takes memory of its own.
        session.forget_light();
        Ok(Self { rendering, seconds, failure })
    }
}
