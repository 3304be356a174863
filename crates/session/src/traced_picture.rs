//! Tracing of one picture, and the check of its output files before that.

use crate::job::Job;
use crate::{Control, Event, Host, Rendering, Session, SessionError};
use spectra_core::params::{Fault, Warning};
use std::sync::Arc;

/// Checks that files of these names can be written, and that none would overwrite a file that the scene is read from.
pub(crate) fn prepare(job: &Job<'_>, host: &dyn Host, names: &[String]) -> Result<(), SessionError> {
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let folder = host.folder();
    let read = job.series.files_on_disk();
    if let Some(file) = names.iter().find(|name| read.iter().any(|path| folder.is(name, path))) {
        let text = format!("`{}` is a file that the scene is read from and would be overwritten", folder.shown(file));
        return Err(Fault::new(text).hint("choose another folder or name with `--output`").into());
    }
    folder.prepare(job.series.name(), &names).map_err(|fault| SessionError::Failed(fault.to_string()))
}

/// Treatment of a picture that is stopped before it is complete.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum IncompletePolicy {
    /// The picture is written; if finished files of its name exist, it is written beside them.
    IsKept,
    /// The picture is not written at all, because every file of a series must be complete.
    IsLeftOut,
}

/// Traced light of one picture.
pub(crate) struct TracedPicture {
    pub rendering: Rendering,
    /// Time spent on tracing, s.
    pub seconds: f64,
    /// Cause of an incomplete picture, unless it was stopped on purpose.
    pub failure: Option<String>,
}

impl TracedPicture {
    /// Traces all samples that the scene states, or until the host asks to stop. `None` if there is no picture to write then.
    pub(crate) fn of(
        session: &mut Session,
        host: &dyn Host,
        unfinished: IncompletePolicy,
    ) -> Result<Option<Self>, SessionError> {
        let mut tracing = Tracing::new(session, host);
        tracing.all(|_, _| ())?;
        tracing.end(unfinished)
    }
}

/// The tracing of one picture.
pub(crate) struct Tracing<'a> {
    session: &'a mut Session,
    host: &'a dyn Host,
    control: Arc<Control>,
    seconds: f64,
    failure: Option<String>,
}

impl<'a> Tracing<'a> {
    /// Begins to trace the picture of a session that is prepared.
    pub fn new(session: &'a mut Session, host: &'a dyn Host) -> Self {
        let control = host.control();
        host.hear(Event::Start(session.scene()));
        Self { session, host, control, seconds: 0.0, failure: None }
    }

    /// Traces the first pass over the frame. Returns whether it is complete.
    pub fn first_pass(&mut self) -> Result<bool, SessionError> {
        loop {
            self.timed(|session, host, control| session.first_pass(host.workers(), control))?;
            // There is nothing to show in a pause yet.
            if self.session.covers_frame() || !self.control.resume() || self.control.is_stopped() {
                return Ok(self.session.covers_frame());
            }
        }
    }

    /// Traces all samples that the scene states, or until the control asks to stop. At each pause, `snapshot` takes the light so far.
    pub fn all(&mut self, mut snapshot: impl FnMut(&mut Session, f64)) -> Result<(), SessionError> {
        let samples = u64::from(self.session.scene().render.samples);
        while self.failure.is_none() || !self.session.covers_frame() {
            self.timed(|session, host, control| session.advance(samples, host.workers(), control))?;
            if !self.control.resume() || self.control.is_stopped() {
                break;
            }
            if self.session.covers_frame() {
                snapshot(self.session, self.seconds);
            }
        }
        Ok(())
    }

    /// Traces, counts the time and keeps the cause of a failure. Light traced before a failure is worth keeping: it may have taken hours.
    fn timed(
        &mut self,
        trace: impl FnOnce(&mut Session, &dyn Host, &Control) -> Result<(), SessionError>,
    ) -> Result<(), SessionError> {
        let begun = self.host.now_s();
        let traced = trace(self.session, self.host, &self.control);
        self.seconds += self.host.now_s() - begun;
        match traced {
            Err(SessionError::Failed(text)) if self.session.has_light() => {
                self.failure.get_or_insert(text);
                Ok(())
            }
            traced => traced,
        }
    }

    /// Returns the picture so far, without remarks.
    pub fn so_far(&mut self) -> Result<Rendering, SessionError> {
        let mut rendering = self.session.rendering()?;
        rendering.partial |= self.failure.is_some();
        Ok(rendering)
    }

    /// Time spent on tracing, s.
    pub fn seconds(&self) -> f64 {
        self.seconds
    }

    /// Ends tracing with a picture that was computed from all of its light, and says its remarks.
    pub fn end_with(self, mut rendering: Rendering) -> TracedPicture {
        self.host.hear(Event::Traced);
        rendering.warnings = self.session.rendering_warnings(&rendering);
        for warning in &rendering.warnings {
            self.host.hear(Event::Warning(&Warning::from(warning.clone())));
        }
        // Frees the light, because development needs memory of its own.
        self.session.forget_light();
        TracedPicture { rendering, seconds: self.seconds, failure: self.failure }
    }

    /// The session whose picture is traced.
    pub fn session(&self) -> &Session {
        self.session
    }

    /// Ends tracing and returns the picture. `None` if it was stopped before the first pass over the frame was complete, or if it is
    /// incomplete and will be left out.
    pub fn end(mut self, unfinished: IncompletePolicy) -> Result<Option<TracedPicture>, SessionError> {
        let is_partial = self.failure.is_some() || !self.session.is_complete();
        if !self.session.covers_frame() || is_partial && unfinished == IncompletePolicy::IsLeftOut {
            self.host.hear(Event::Traced);
            return self.failure.map_or(Ok(None), |text| Err(SessionError::Failed(text)));
        }
        let rendering = self.so_far()?;
        Ok(Some(self.end_with(rendering)))
    }
}
