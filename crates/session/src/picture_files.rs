//! The files of one picture: what is written when it is finished, stopped or looked at on the way.

use crate::files::{Files, write_report};
use crate::job::Job;
use crate::traced_picture::prepare;
use crate::{Event, Folder, Host, Names, Rendering, Report, Session, SessionError, header};
use spectra_core::params::Warning;
use spectra_core::sink::{Memory, Sink};
use spectra_scene::{FilmTime, Member, Scene, Shot};

/// Files of one picture, and the file of its report.
pub(crate) struct PictureFiles {
    pub files: Files,
    report: Option<String>,
}

impl PictureFiles {
    /// Lists the files of a picture.
    ///
    /// # Errors
    /// The scene cannot be written to the file that is asked for.
    pub fn of(names: &Names, scene: &Scene, member: &Member) -> Result<Self, SessionError> {
        Ok(Self { files: Files::of(names, scene, member)?, report: names.report(&member.stem("")) })
    }

    /// Names of all files, that of the report last.
    pub fn names(&self) -> Vec<String> {
        self.files.names().into_iter().chain(self.report.clone()).collect()
    }

    /// Returns whether a file of these names exists that may belong to a finished picture, and its name. If `replaces_partial`, a picture
    /// whose report calls it partial does not count, unless one of the files is newer than the report.
    pub fn finished(&self, folder: &dyn Folder, replaces_partial: bool) -> Option<String> {
        /// Largest report that is read, bytes; a larger file is not one of ours.
        const LARGEST: u64 = 64 << 20;
        let there = self.names().into_iter().find(|name| folder.has(name))?;
        // A picture's report is its last file.
        let is_last = |report: &&String| !self.names().iter().any(|name| folder.is_newer(name, report));
        let report = self.report.as_ref().filter(|_| replaces_partial).filter(is_last);
        let report = report.and_then(|name| folder.read(name, LARGEST));
        let report: serde_json::Value =
            report.and_then(|bytes| serde_json::from_slice(&bytes).ok()).unwrap_or_default();
        (report["partial"] != true).then_some(there)
    }

    /// Develops a rendering that took `seconds` to trace, and writes all files to `sink`. Returns how each film was exposed. If the system
    /// refuses a file and no file holds the light, the light is saved in one of the `backups`.
    pub fn write(
        &self,
        (job, host, scene): (&Job<'_>, &dyn Host, &Scene),
        (rendering, seconds): (&Rendering, f64),
        sink: &dyn Sink,
        backups: Option<[&dyn Folder; 2]>,
    ) -> Result<Vec<FilmTime>, SessionError> {
        let exposure = &rendering.exposure;
        let times = scene.film_times(exposure);
        let attributes = header::attributes(scene, exposure, &times, rendering.partial, job.version);
        let report = Report { job, scene, rendering, times: &times, seconds, threads: host.threads() };
        let shown = self.shown(host);
        let to_json = || report.to_json(&shown[..self.files.names().len()]);
        let shot = Shot::new(scene, exposure, &times, &attributes, job.isa);
        let shot = shot.with_report(&to_json).with_layers(&rendering.layers);
        self.files.write(&shot, sink, backups)?;
        if let Some(file) = &self.report {
            write_report(sink, (file, &host.folder().shown(file)), shot.report())?;
        }
        Ok(times)
    }

    /// Names of all files as shown to the user.
    pub fn shown(&self, host: &dyn Host) -> Vec<String> {
        self.names().iter().map(|name| host.folder().shown(name)).collect()
    }
}

/// A picture whose files are in memory.
pub(crate) struct DevelopedOnce {
    files: PictureFiles,
    contents: Vec<(String, Vec<u8>)>,
    times: Vec<FilmTime>,
}

impl DevelopedOnce {
    /// Develops a rendering of a session's picture that took `seconds` to trace.
    pub fn new(
        job: &Job<'_>,
        session: &Session,
        traced: (&Rendering, f64),
        host: &dyn Host,
    ) -> Result<Self, SessionError> {
        let whole = PictureFiles::of(&job.names, session.scene(), &session.member())?;
        let is_beside = traced.0.partial && whole.finished(host.folder(), true).is_some();
        let files = match is_beside {
            true => PictureFiles::of(&job.names.of_partial(), session.scene(), &session.member())?,
            false => whole,
        };
        let memory = Memory::default();
        let times = files.write((job, host, session.scene()), traced, &memory, None)?;
        Ok(Self { files, contents: memory.into_files(), times })
    }

    /// Writes the files under the names of `files`. Returns how each film was exposed.
    pub fn store(self, files: &PictureFiles, host: &dyn Host) -> Result<Vec<FilmTime>, SessionError> {
        for (own, name) in self.files.names().iter().zip(files.names()) {
            let Some((_, bytes)) = self.contents.iter().find(|(file, _)| file == own) else { continue };
            let written = host.folder().file(&name, &mut |out| Ok(out.write_all(bytes)?));
            written.map_err(|fault| {
                let file = host.folder().shown(&name);
                SessionError::Unwritten { file, fault, kept: String::new() }
            })?;
        }
        Ok(self.times)
    }
}

/// Snapshots of a picture while it is traced, in files that are marked as partial.
pub(crate) struct Snapshots<'a> {
    job: &'a Job<'a>,
    host: &'a dyn Host,
    files: Option<PictureFiles>,
    has_failed: bool,
}

impl<'a> Snapshots<'a> {
    /// Begins without a snapshot.
    pub fn new(job: &'a Job<'a>, host: &'a dyn Host) -> Self {
        Self { job, host, files: None, has_failed: false }
    }

    /// Writes the picture so far. A failure is told once, and no further snapshot is tried.
    pub fn take(&mut self, session: &mut Session, seconds: f64) {
        if self.has_failed {
            return;
        }
        if let Err(error) = self.write(session, seconds) {
            self.has_failed = true;
            let text = format!("the picture so far could not be written, so no more snapshots are taken: {error}");
            self.host.hear(Event::Warning(&Warning::from(text)));
        }
    }

    fn write(&mut self, session: &mut Session, seconds: f64) -> Result<(), SessionError> {
        let mut rendering = session.rendering()?;
        rendering.partial = true;
        let scene = session.scene();
        let files = match self.files.take() {
            Some(files) => files,
            None => {
                let files = PictureFiles::of(&self.job.names.of_partial(), scene, &session.member())?;
                prepare(self.job, self.host, &files.names())?;
                files
            }
        };
        let files = self.files.insert(files);
        files.write((self.job, self.host, scene), (&rendering, seconds), self.host.folder(), None)?;
        self.host.hear(Event::Snapshot(&files.shown(self.host)));
        Ok(())
    }

    /// Removes the files of the last snapshot, except those of these names.
    pub fn remove(self, except: &[String]) {
        let names = self.files.map(|files| files.names()).unwrap_or_default();
        names.iter().filter(|name| !except.contains(name)).for_each(|name| self.host.folder().remove(name));
    }
}
