//! Rendering of several pictures of one scene: the members of a sweep, or the frames of an animation.

use crate::check::{CheckSettings, checked, each_once};
use crate::contact::Contact;
use crate::exposure_warnings::exposure_warnings;
use crate::files::Files;
use crate::picture_files::Snapshots;
use crate::traced_picture::{IncompletePolicy, TracedPicture, Tracing, prepare};
use crate::{
    Event, Host, Job, JobEnd, Report, SeriesPosition, Session, SessionError, SessionOptions, first_frame, formatting,
    header,
};
use serde_json::{Map, Value, json};
use spectra_core::params::{Reading, Warning};
use spectra_core::sink::WriteFault;
use spectra_render::Renderer;
use spectra_scene::{Member, Scene, Series, SeriesKind, SeriesSummary, Shot, unit_of};
use std::collections::HashMap;
use std::io::Cursor;
use std::sync::Arc;

/// Interval between updates of `SCENE-series.json`, s, so that little of it is lost if the machine fails.
const REPORT_EVERY_S: f64 = 10.0;

/// A picture to be made.
struct Planned {
    /// Index of the picture in the series.
    index: usize,
    member: Member,
    files: Files,
    size_px: [u32; 2],
    films: Vec<Option<String>>,
    warnings: Vec<Warning>,
    notes: Vec<String>,
}

/// Renders the pictures of a series that the job asks for.
pub(crate) fn run(job: &Job<'_>, host: &dyn Host) -> Result<JobEnd, SessionError> {
    let series = job.series;
    let Some(report_file) = job.names.report(&format!("{}-series", series.name())) else {
        let text = format!("--output: this names one picture, but the scene makes {}: name a folder", series.count());
        return Err(SessionError::Request(text));
    };
    let plan = |index: usize, scene: &Scene| -> Result<Planned, SessionError> {
        let member = series.member(index);
        let files = Files::of(&job.names, scene, &member)?;
        let mut names = files.names();
        names.push(report_file.clone());
        prepare(job, host, &names)?;
        let size = scene.imager.size();
        let films: Vec<Option<String>> = scene.films.iter().map(|film| film.name.clone()).collect();
        let films = if films.is_empty() { vec![None] } else { films };
        let (warnings, notes) = (scene.warnings.clone(), scene.all_notes().cloned().collect());
        Ok(Planned { index, member, files, size_px: [size.width_px, size.height_px], films, warnings, notes })
    };
    let seen = |done: usize, of: usize| host.hear(Event::Checked { done, of });
    let look =
        CheckSettings { isa: job.isa, workers: host.workers(), memory_bytes: host.memory_bytes(), on_progress: &seen };
    let planned = checked(series, &job.chosen, look, &plan)?;
    host.hear(Event::Ready);
    for warning in each_once(series.warnings().iter().chain(planned.iter().flat_map(|p| &p.warnings))) {
        host.hear(Event::Warning(warning));
    }
    for note in each_once(planned.iter().flat_map(|p| &p.notes)) {
        host.hear(Event::Note(note));
    }
    host.hear(Event::Series(
        &format!("{}: {}", series.name(), what(series, planned.len())),
        &json!({ "event": "series", "scene": series.name(), "count": series.count(), "pictures": planned.len() }),
    ));
    let metered = first_frame::metered(job, host)?;
    let mut work = SeriesRun {
        job,
        series: metered.as_ref().unwrap_or(series),
        host,
        earlier: if job.skip_existing { previous_entries(host, &report_file) } else { Map::new() },
        contact: contact(job, &planned),
        done: Vec::new(),
        other: (None, None),
        doubts: Vec::new(),
        report_file,
        reported_s: host.now_s(),
        begun_s: host.now_s(),
    };
    let mut result = Ok(true);
    for (at, picture) in planned.iter().enumerate() {
        let place = SeriesPosition { number: picture.member.number, index: at, of: planned.len() };
        result = work.picture(picture, place);
        if !matches!(result, Ok(true)) {
            break;
        }
    }
    host.hear(Event::Picture(None));
    if let (false, false, Some(limit_s)) = (!matches!(result, Ok(false)), host.is_interrupted(), host.time_limit_s())
        && work.done.is_empty()
    {
        let limit = formatting::duration(limit_s);
        let text =
            format!("the time limit of {limit} ended before the first of {} pictures was finished", planned.len());
        return Err(SessionError::Failed(text));
    }
    // Finished pictures are kept and reported even if the next one failed.
    let files = work.finish(result.as_ref().is_ok_and(|whole| *whole));
    let whole = result?;
    host.hear(Event::Written(&files?));
    let stopped = !whole && host.is_interrupted();
    let (done, of) = (work.done.len(), planned.len());
    host.hear(Event::Series(
        &format!(
            "{done} of {} in {}",
            formatting::counted(of as u64, "picture"),
            formatting::duration(host.now_s() - work.begun_s)
        ),
        &json!({ "event": "end", "done": done, "of": of, "interrupted": stopped }),
    ));
    Ok(if stopped { JobEnd::Stopped } else { JobEnd::Whole })
}

/// Describes the series, for the message before it begins.
fn what(series: &Series, pictures: usize) -> String {
    let counted = formatting::counted(pictures as u64, "picture");
    match series.kind() {
        SeriesKind::Sweep { axes } if !axes.is_empty() => {
            let axis = axes.iter().map(|axis| format!("{} of {}", axis.values.len(), axis.path));
            format!("a sweep of {counted}: {}", axis.collect::<Vec<_>>().join(" x "))
        }
        SeriesKind::Sweep { .. } => format!("a sweep of {counted}"),
        SeriesKind::Animation { .. } => {
            format!("{pictures} of {}", formatting::counted(series.count() as u64, "frame"))
        }
        SeriesKind::Single => "a picture".to_owned(),
    }
}

/// Returns the unit of a bare number at a path of the scene. The unit of a variable follows from the places that use it.
fn unit_in(series: &Series, path: &str) -> Option<String> {
    let Some(name) = path.strip_prefix("variables.") else { return unit_of(path) };
    series.uses_of_variable(name).into_iter().find_map(|(path, text)| {
        let is_temperature =
            ["blackbody:", "daylight:"].iter().any(|head| text.contains(&format!("{head}${{{name}}}")));
        let is_whole = text == format!("${name}") || text == format!("${{{name}}}");
        match () {
            () if is_temperature => Some("K".to_owned()),
            () if is_whole => unit_of(&path),
            () => None,
        }
    })
}

/// Returns the contact sheet of a sweep, with empty cells; `None` for other series.
fn contact(job: &Job<'_>, planned: &[Planned]) -> Option<Contact> {
    let SeriesKind::Sweep { mut axes } = job.series.kind() else { return None };
    let mut members: Vec<Member> = planned.iter().map(|p| p.member.clone()).collect();
    // The sheet shows a bare number with the unit in which it is read.
    let mut units: HashMap<String, Option<String>> = HashMap::new();
    let mut complete = |path: &str, value: &mut String| {
        if let Reading::Bare(_) = Reading::of(value.trim_matches('"'))
            && let Some(unit) = units.entry(path.to_owned()).or_insert_with(|| unit_in(job.series, path))
        {
            *value = if unit == "f/" { format!("f/{value}") } else { format!("{value} {unit}") };
        }
    };
    for axis in &mut axes {
        axis.values.iter_mut().for_each(|value| complete(&axis.path, value));
    }
    for (path, value) in members.iter_mut().flat_map(|member| &mut member.values) {
        complete(path, value);
    }
    Some(Contact::new(&axes, &members, planned.first()?.size_px))
}

/// Returns the entries of an earlier run's report, by picture number.
fn previous_entries(host: &dyn Host, report_file: &str) -> Map<String, Value> {
    /// Largest report that is read, bytes; a larger file is not one of ours.
    const LARGEST: u64 = 256 << 20;
    let read = host.folder().read(report_file, LARGEST);
    let report: Value = read.and_then(|bytes| serde_json::from_slice(&bytes).ok()).unwrap_or_default();
    let pictures = report["pictures"].as_array().cloned().unwrap_or_default();
    pictures.into_iter().filter_map(|p| Some((p["number"].as_u64()?.to_string(), p))).collect()
}

/// The work on a series, and the results so far.
struct SeriesRun<'a> {
    job: &'a Job<'a>,
    /// The series to render: that of the job, with the exposure metered on the first frame where all frames share it.
    series: &'a Series,
    host: &'a dyn Host,
    earlier: Map<String, Value>,
    contact: Option<Contact>,
    /// Scene and renderer of the previous picture; the next one reuses the stages and the search that they share.
    other: (Option<Arc<Scene>>, Option<Renderer>),
    /// Entry of each picture in `SCENE-series.json`, as text: a JSON tree takes five times the memory, and there may be thousands
    /// of pictures.
    done: Vec<Box<str>>,
    /// Warnings already given about the files of sources and about exposures that films cannot record.
    doubts: Vec<Warning>,
    report_file: String,
    reported_s: f64,
    begun_s: f64,
}

impl SeriesRun<'_> {
    /// Renders a picture and writes its files. Returns false if it was stopped before it was complete.
    fn picture(&mut self, picture: &Planned, place: SeriesPosition) -> Result<bool, SessionError> {
        let Self { job, host, .. } = *self;
        if host.is_stopped() {
            return Ok(false);
        }
        host.hear(Event::Picture(Some(place)));
        let names = picture.files.names();
        let shown: Vec<String> = names.iter().map(|name| host.folder().shown(name)).collect();
        if job.skip_existing && !names.is_empty() && names.iter().all(|name| host.folder().has(name)) {
            self.keep(picture, &shown);
            host.hear(Event::Series(
                &format!("{} of {}: {} already exists", place.index + 1, place.of, picture.member.stem("")),
                &json!({ "event": "kept", "files": shown }),
            ));
            return Ok(true);
        }
        // The scenes of the check are not kept: a thousand of them would not fit into memory.
        let options = SessionOptions { isa: job.isa, picture: picture.index, ..SessionOptions::default() };
        let mut session = Session::sharing(self.series.clone(), std::mem::take(&mut self.other), options)?;
        session.prepare(host.workers())?;
        for doubt in session.scene().source.warnings() {
            if !self.doubts.contains(doubt) {
                host.hear(Event::Warning(doubt));
                self.doubts.push(doubt.clone());
            }
        }
        let mut snapshots = Snapshots::new(job, host);
        let mut tracing = Tracing::new(&mut session, host);
        tracing.all(|session, seconds| snapshots.take(session, seconds))?;
        let traced = tracing.end(IncompletePolicy::IsLeftOut)?;
        snapshots.remove(&[]);
        let Some(TracedPicture { rendering, seconds, .. }) = traced else { return Ok(false) };
        let (scene, renderer) = session.into_scene();
        for warning in exposure_warnings(&scene, &rendering.exposure) {
            // One warning for each place in the scene file, not one in each of a thousand frames.
            if !self.doubts.iter().any(|said| said.0.place == warning.0.place) {
                host.hear(Event::Warning(&warning));
                self.doubts.push(warning);
            }
        }
        let times = scene.film_times(&rendering.exposure);
        let mut attributes = header::attributes(&scene, &rendering.exposure, &times, false, job.version);
        attributes.extend(attributes_of(job.series, &picture.member));
        let report =
            Report { job, scene: &scene, rendering: &rendering, times: &times, seconds, threads: host.threads() };
        let told = || report.to_json(&shown);
        let shot = Shot::new(&scene, &rendering.exposure, &times, &attributes, job.isa).with_report(&told);
        let shot = shot.with_layers(&rendering.layers);
        picture.files.write(&shot, host.folder(), Some([host.folder(), host.elsewhere()]))?;
        let mut said = entry(&picture.member);
        if let Value::Object(figures) = shot.report().clone() {
            let common = ["scene", "scene_file", "overrides", "versions", "threads", "isa"];
            said.extend(figures.into_iter().filter(|(key, _)| !common.contains(&key.as_str())));
        }
        self.done.push(format!("{:#}", Value::Object(said)).into());
        // Not every imager gives a picture.
        if let (Some(contact), Ok(pictures)) = (&mut self.contact, shot.pictures()) {
            contact.put(place.index, pictures);
        }
        host.hear(Event::Written(&shown));
        host.hear(Event::Done { report: &report, stopped: false });
        self.other = (Some(scene), renderer);
        if host.now_s() - self.reported_s >= REPORT_EVERY_S {
            self.reported_s = host.now_s();
            self.write_report(&self.report(&[], false))?;
        }
        Ok(true)
    }

    /// Adds a picture that already exists on disk to the report and the contact sheet.
    fn keep(&mut self, picture: &Planned, shown: &[String]) {
        let mut said = entry(&picture.member);
        if let Some(Value::Object(earlier)) = self.earlier.get(&picture.member.number.to_string()) {
            // The earlier entry may belong to other values, but nothing else is known about these files.
            said.extend(earlier.clone().into_iter().filter(|(key, _)| key != "values"));
        }
        said.insert("files".to_owned(), shown.into());
        said.insert("kept".to_owned(), true.into());
        self.done.push(format!("{:#}", Value::Object(said)).into());
        if let Some(contact) = &mut self.contact {
            let files = picture.films.iter().zip(picture.files.shown());
            let read = |name: &str| self.host.folder().read(name, Contact::LARGEST_BYTES);
            files.filter_map(|(film, name)| Some((film, read(&name)?))).for_each(|(film, bytes)| {
                contact.put_file(picture.index, film.as_deref(), &bytes);
            });
        }
    }

    /// Returns the content of `SCENE-series.json` without the entries of the pictures.
    fn report(&self, contact: &[String], whole: bool) -> Value {
        let Self { job, host, .. } = self;
        let mut report = json!({
            "scene": job.series.name(),
            "scene_file": job.scene_file,
            "made_of": job.series.files(),
            "overrides": job.overrides,
            "count": job.series.count(),
            "complete": whole,
            "seconds": host.now_s() - self.begun_s,
            "threads": host.threads(),
            "isa": job.isa.name(),
            "versions": job.versions,
            "pictures": [],
        });
        if let Value::Object(map) = &mut report {
            match job.series.kind() {
                SeriesKind::Sweep { axes } => {
                    let axes: Vec<Value> = axes.iter().map(|a| json!({ "path": a.path, "values": a.values })).collect();
                    map.insert("kind".to_owned(), "sweep".into());
                    map.insert("axes".to_owned(), axes.into());
                    map.insert("contact_sheets".to_owned(), contact.into());
                }
                SeriesKind::Animation { first, rate } => {
                    map.insert("kind".to_owned(), "animation".into());
                    map.insert("first_frame".to_owned(), first.into());
                    map.insert("frames_per_second".to_owned(), rate.into());
                }
                SeriesKind::Single => {}
            }
        }
        report
    }

    /// Writes the contact sheets and the report, and returns the names of these files.
    fn finish(&self, whole: bool) -> Result<Vec<String>, SessionError> {
        let (name, folder) = (self.job.series.name(), self.host.folder());
        let mut shown = Vec::new();
        let mut sheets: Vec<(String, Vec<u8>)> = Vec::new();
        if let Some(contact) = &self.contact {
            for film in contact.films() {
                let part = film.as_ref().map_or(String::new(), |film| format!("-{film}"));
                let file = format!("{name}-contact{part}.png");
                let title = format!("{name}: contact sheet");
                let mut bytes = Cursor::new(Vec::new());
                let written = contact.write(film.as_deref(), &title, &mut bytes);
                let bytes = bytes.into_inner();
                let written = written.and_then(|()| folder.file(&file, &mut |out| Ok(out.write_all(&bytes)?)));
                written.map_err(|fault| self.unwritten(&file, fault))?;
                shown.push(folder.shown(&file));
                sheets.push((file, bytes));
            }
        }
        let mut report = self.report(&shown, whole);
        self.write_report(&report)?;
        shown.push(folder.shown(&self.report_file));
        // All pictures have the same outputs of the series; those of the last scene are used.
        if let Some(scene) =
            self.other.0.as_ref().filter(|scene| scene.output.iter().any(|output| output.is_of_series()))
        {
            report["pictures"] = self.done.iter().map(|said| said_of(said)).collect();
            let text = self.job.series.text();
            let told = SeriesSummary { name, text: &text, report: &report, contact_sheets: &sheets };
            for output in scene.output.iter().filter(|output| output.is_of_series()) {
                let file = format!("{name}-series{}", output.ending()[1]);
                let written = folder.file(&file, &mut |out| output.write_series(&told, out));
                written.map_err(|fault| self.unwritten(&file, fault))?;
                shown.push(folder.shown(&file));
            }
        }
        Ok(shown)
    }

    /// Writes the report, with the entries of the pictures in its list.
    fn write_report(&self, report: &Value) -> Result<(), SessionError> {
        const LIST: &str = "\n  \"pictures\": [";
        let text = format!("{report:#}\n");
        // JSON texts hold no line breaks, so this finds the key.
        let (before, behind) = text.split_once(&format!("{LIST}]")).unwrap_or((&text, ""));
        let written = self.host.folder().file(&self.report_file, &mut |out| {
            write!(out, "{before}")?;
            for (i, said) in self.done.iter().enumerate() {
                let begin = if i == 0 { LIST } else { "," };
                write!(out, "{begin}\n    {}", said.replace('\n', "\n    "))?;
            }
            let end = if self.done.is_empty() { format!("{LIST}]") } else { "\n  ]".to_owned() };
            Ok(write!(out, "{end}{behind}")?)
        });
        written.map_err(|fault| self.unwritten(&self.report_file, fault))
    }

    fn unwritten(&self, file: &str, fault: WriteFault) -> SessionError {
        SessionError::Unwritten { file: self.host.folder().shown(file), fault, kept: String::new() }
    }
}

/// Parses the entry of a picture from its text.
fn said_of(text: &str) -> Value {
    serde_json::from_str(text).unwrap_or_default()
}

/// Returns the first values of a picture's entry: number, name and swept values.
fn entry(member: &Member) -> Map<String, Value> {
    let values: Map<String, Value> =
        member.values.iter().map(|(path, value)| (path.clone(), value.as_str().into())).collect();
    let mut said = Map::new();
    said.insert("number".to_owned(), member.number.into());
    said.insert("name".to_owned(), member.stem("").into());
    said.insert("values".to_owned(), values.into());
    said
}

/// Describes the picture's place in the series for the header of an EXR. The result does not depend on which frames are asked
/// for.
fn attributes_of(series: &Series, member: &Member) -> Vec<(String, String)> {
    let mut all = Vec::new();
    match series.kind() {
        SeriesKind::Sweep { .. } => {
            all.push(("spectra:picture".to_owned(), format!("{} of {}", member.number, series.count())));
        }
        SeriesKind::Animation { rate, .. } => {
            all.push(("spectra:frame".to_owned(), member.number.to_string()));
            all.push(("spectra:frames per second".to_owned(), rate.to_string()));
            all.push(("framesPerSecond".to_owned(), rational(rate)));
        }
        SeriesKind::Single => {}
    }
    all.push(("spectra:values".to_owned(), member.words()));
    all
}

/// Returns a frame rate as the fraction that it stands for: `24/1`, and `24000/1001` for 23.976.
fn rational(rate: f64) -> String {
    let whole = rate.round();
    if rate == whole {
        return format!("{whole}/1");
    }
    let thousands = (rate * 1001.0 / 1000.0).round();
    if (thousands * 1000.0 / 1001.0 - rate).abs() < 0.001 {
        return format!("{}/1001", thousands * 1000.0);
    }
    format!("{}/1000", (rate * 1000.0).round())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_are_the_fractions_that_they_stand_for() {
        for (rate, wanted) in [
            (24.0, "24/1"),
            (23.976, "24000/1001"),
            (29.97, "30000/1001"),
            (59.94, "60000/1001"),
            (12.5, "12500/1000"),
            (0.5, "500/1000"),
        ] {
            assert_eq!(rational(rate), wanted);
        }
    }
}
