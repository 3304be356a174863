//! Several pictures of one scene: the members of a sweep, the frames of an animation.

use super::contact::Contact;
use super::folder::{Folder, write_report};
use super::interrupt::{self, Interrupt};
use super::leftover;
use super::limit::SetUp;
use super::progress::{Place, Progress};
use super::report::Report;
use super::target::Target;
use super::{refused, watch};
use crate::arguments::Run;
use crate::outcome::{DONE, Failure, Outcome};
use crate::{doc, memory, version, words};
use serde_json::{Map, Value, json};
use spectra_core::Isa;
use spectra_core::params::{Fault, Faults, Reading, Warning};
use spectra_render::{Control, Renderer};
use spectra_scene::{Member, Scene, Series, SeriesKind};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::ScopedJoinHandle;
use std::time::{Duration, Instant};

/// `SCENE-series.json` is brought up to date in this time, so that little of it is lost with the machine.
const REPORT_EVERY: Duration = Duration::from_secs(10);
/// How often it is said how far the check of a series is.
const LOOK_EVERY: Duration = Duration::from_millis(5);
/// Most scenes that are assembled at one time.
const AT_ONCE: usize = 8;

/// A picture that is going to be made.
struct Planned {
    /// Its place in the series.
    index: usize,
    member: Member,
    folder: Folder,
    size_px: [u32; 2],
    films: Vec<Option<String>>,
    warnings: Vec<Warning>,
}

/// Renders all pictures of a series that are asked for.
pub(super) fn render(
    series: &Series,
    arguments: &Run,
    target: &Target,
    threads: usize,
    isa: Isa,
    deadline: Option<Instant>,
    set_up: SetUp,
) -> Outcome {
    let chosen = chosen(series, arguments)?;
    let Some(report_path) = target.report(&format!("{}-series", series.name())) else {
        let text = format!("--output {}: that is one picture", arguments.output.display());
        return Err(Failure::Input(format!("{text}, but this scene makes {}: name a folder", series.count())));
    };
    let mut progress = Progress::new(arguments, deadline);
    let plan = |index: usize, scene: &Scene| -> Result<Planned, Failure> {
        let member = series.member(index);
        let folder = Folder::prepare(target, scene, &member, Some(&report_path))?;
        let size = scene.imager.size();
        let films: Vec<Option<String>> = scene.films.iter().map(|film| film.name.clone()).collect();
        let films = if films.is_empty() { vec![None] } else { films };
        let warnings = scene.warnings.clone();
        Ok(Planned { index, member, folder, size_px: [size.width_px, size.height_px], films, warnings })
    };
    let planned = checked(series, &chosen, isa, threads, &plan, &mut |checking| progress.checking(checking))?;
    set_up.done();
    leftover::sweep(&target.folder, series.name());
    let mut said: Vec<&Warning> = Vec::new();
    for warning in series.warnings().iter().chain(planned.iter().flat_map(|p| &p.warnings)) {
        if !said.contains(&warning) {
            said.push(warning);
            progress.warning(warning);
        }
    }
    let control = Arc::new(deadline.map_or_else(Control::new, Control::until));
    let interrupt = interrupt::listen(&control, &target.folder);
    progress.series(
        &format!("{}: {}", series.name(), what(series, planned.len())),
        json!({ "event": "series", "scene": series.name(), "count": series.count(), "pictures": planned.len() }),
    );
    let mut work = Work {
        series,
        arguments,
        threads,
        isa,
        deadline,
        interrupt: &interrupt,
        earlier: if arguments.skip_existing { earlier(&report_path) } else { Map::new() },
        contact: contact(series, &planned),
        done: Vec::new(),
        folder: target.folder.clone(),
        other: None,
        report_path,
        reported: Instant::now(),
        begun: Instant::now(),
    };
    let mut result = Ok(true);
    for (at, picture) in planned.iter().enumerate() {
        let place = Place { number: picture.member.number, index: at, of: planned.len() };
        result = work.picture(picture, place, &mut progress);
        if !matches!(result, Ok(true)) {
            break;
        }
    }
    progress.no_picture();
    // What is done is kept and told of, also where the next one failed.
    let paths = work.finish(result.as_ref().is_ok_and(|whole| *whole));
    let whole = result?;
    progress.written(&paths?);
    let stopped = !whole && interrupt.happened();
    let (done, of) = (work.done.len(), planned.len());
    progress.series(
        &format!("{done} of {of} pictures in {}", words::duration(work.begun.elapsed().as_secs_f64())),
        json!({ "event": "end", "done": done, "of": of, "interrupted": stopped }),
    );
    Ok(if stopped { interrupt.code() } else { DONE })
}

/// Places in the series of the pictures that are asked for.
fn chosen(series: &Series, arguments: &Run) -> Result<Vec<usize>, Failure> {
    let all = 0..series.count();
    let Some(frames) = &arguments.frames else { return Ok(all.collect()) };
    let SeriesKind::Animation { first, .. } = series.kind() else {
        return Err(Failure::Input("--frames: this scene has a `sweep`, not an `animation`".to_owned()));
    };
    let last = first + series.count() as u32 - 1;
    frames.check(&(first..=last))?;
    Ok(all.filter(|index| frames.contains(first + *index as u32)).collect())
}

/// What a person wants to know before it begins.
fn what(series: &Series, pictures: usize) -> String {
    match series.kind() {
        SeriesKind::Sweep { axes } if !axes.is_empty() => {
            let axis = axes.iter().map(|axis| format!("{} of {}", axis.values.len(), axis.path));
            format!("a sweep of {pictures} pictures: {}", axis.collect::<Vec<_>>().join(" x "))
        }
        SeriesKind::Sweep { .. } => format!("a sweep of {pictures} pictures"),
        SeriesKind::Animation { .. } => format!("{pictures} of {} frames", series.count()),
        SeriesKind::Single => "a picture".to_owned(),
    }
}

/// How far the check of a series is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Checking {
    /// Pictures that were looked at.
    pub done: usize,
    /// How many there are.
    pub of: usize,
}

/// Assembles and checks every picture, on several threads, and gives what `keep` makes of each. `tick` is called now and
/// then meanwhile.
///
/// # Errors
/// Everything that is wrong with any of them; a fault that several have is told once.
pub(crate) fn checked<T: Send>(
    series: &Series,
    indices: &[usize],
    isa: Isa,
    threads: usize,
    keep: &(impl Fn(usize, &Scene) -> Result<T, Failure> + Sync),
    tick: &mut dyn FnMut(Checking),
) -> Result<Vec<T>, Failure> {
    let results: Vec<Mutex<Option<Result<T, Failure>>>> = indices.iter().map(|_| Mutex::new(None)).collect();
    let (next, done) = (AtomicUsize::new(0), AtomicUsize::new(0));
    // Pictures of a series mostly differ in little: what they share is made once a thread.
    let check = |index: usize, other: &mut Option<Scene>| -> Result<T, Failure> {
        let scene = series.looked_at(index, other.take())?;
        // What shows only once the stages are put together.
        Renderer::check(&scene, isa).map_err(|error| refused(error, &scene))?;
        memory::suffices_for(&scene)?;
        let kept = keep(index, &scene);
        *other = Some(scene);
        kept
    };
    std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads.clamp(1, AT_ONCE.min(indices.len().max(1))))
            .map(|_| {
                scope.spawn(|| {
                    let mut other = None;
                    while let Some((index, result)) = {
                        let at = next.fetch_add(1, Relaxed);
                        indices.get(at).zip(results.get(at))
                    } {
                        *result.lock().unwrap_or_else(PoisonError::into_inner) = Some(check(*index, &mut other));
                        done.fetch_add(1, Relaxed);
                    }
                })
            })
            .collect();
        while !workers.iter().all(ScopedJoinHandle::is_finished) {
            std::thread::sleep(LOOK_EVERY);
            tick(Checking { done: done.load(Relaxed), of: indices.len() });
        }
    });
    let mut kept = Vec::with_capacity(indices.len());
    let mut faults: Vec<(Fault, Vec<usize>)> = Vec::new();
    for (index, result) in indices.iter().zip(results) {
        match result.into_inner().unwrap_or_else(PoisonError::into_inner) {
            Some(Ok(value)) => kept.push(value),
            Some(Err(Failure::Faults(found))) => {
                for fault in found {
                    match faults.iter_mut().find(|(known, _)| *known == fault) {
                        Some((_, members)) => members.push(*index),
                        None => faults.push((fault, vec![*index])),
                    }
                }
            }
            Some(Err(other)) => return Err(other),
            None => {}
        }
    }
    if faults.is_empty() {
        return Ok(kept);
    }
    let told = faults.into_iter().map(|(fault, members)| told(series, fault, &members, indices.len()));
    Err(Failure::Faults(Faults(told.collect())))
}

/// A fault with the pictures that have it, where not all do.
fn told(series: &Series, fault: Fault, members: &[usize], all: usize) -> Fault {
    let Some(first) = members.first().filter(|_| members.len() < all) else { return fault };
    let member = series.member(*first);
    let what = if matches!(series.kind(), SeriesKind::Animation { .. }) { "frame" } else { "picture" };
    let more = if members.len() > 1 { format!(" and {} more", members.len() - 1) } else { String::new() };
    let values = if member.values.is_empty() { String::new() } else { format!(" ({})", member.words()) };
    let note = format!("{what} {}{values}{more}", member.number);
    let hint = fault.hint.as_ref().map_or_else(|| note.clone(), |hint| format!("{hint}; {note}"));
    fault.hint(hint)
}

/// The unit of a bare number at a path of the scene; that of a variable is known by where it is used.
fn unit_of(series: &Series, path: &str) -> Option<String> {
    let Some(name) = path.strip_prefix("variables.") else { return doc::unit_of(path) };
    series.uses_of_variable(name).into_iter().find_map(|(path, text)| {
        let is_temperature =
            ["blackbody:", "daylight:"].iter().any(|head| text.contains(&format!("{head}${{{name}}}")));
        let is_whole = text == format!("${name}") || text == format!("${{{name}}}");
        match () {
            () if is_temperature => Some("K".to_owned()),
            () if is_whole => doc::unit_of(&path),
            () => None,
        }
    })
}

/// The contact sheet of a sweep, its cells empty.
fn contact(series: &Series, planned: &[Planned]) -> Option<Contact> {
    let SeriesKind::Sweep { mut axes } = series.kind() else { return None };
    let mut members: Vec<Member> = planned.iter().map(|p| p.member.clone()).collect();
    // On the sheet a bare number has the unit that it is read in.
    let mut units: HashMap<String, Option<String>> = HashMap::new();
    let mut complete = |path: &str, value: &mut String| {
        if let Reading::Bare(_) = Reading::of(value.trim_matches('"'))
            && let Some(unit) = units.entry(path.to_owned()).or_insert_with(|| unit_of(series, path))
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

/// What an earlier run said of its pictures, by their numbers.
fn earlier(path: &Path) -> Map<String, Value> {
    /// A larger file is not one of ours.
    const LARGEST: u64 = 256 << 20;
    let fits = std::fs::metadata(path).is_ok_and(|data| data.len() <= LARGEST);
    let read = fits.then(|| std::fs::read(path).ok()).flatten();
    let report: Value = read.and_then(|bytes| serde_json::from_slice(&bytes).ok()).unwrap_or_default();
    let pictures = report["pictures"].as_array().cloned().unwrap_or_default();
    pictures.into_iter().filter_map(|p| Some((p["number"].as_u64()?.to_string(), p))).collect()
}

/// The work on a series, and what is done of it.
struct Work<'a> {
    series: &'a Series,
    arguments: &'a Run,
    threads: usize,
    isa: Isa,
    deadline: Option<Instant>,
    interrupt: &'a Interrupt,
    earlier: Map<String, Value>,
    contact: Option<Contact>,
    folder: PathBuf,
    /// The picture before: what the next one shares with it is not made again.
    other: Option<Scene>,
    /// What is said of each picture in `SCENE-series.json`.
    done: Vec<Value>,
    report_path: PathBuf,
    reported: Instant,
    begun: Instant,
}

impl Work<'_> {
    /// Renders a picture and writes its files; false where it was stopped before it was whole.
    fn picture(&mut self, picture: &Planned, place: Place, progress: &mut Progress) -> Result<bool, Failure> {
        if self.interrupt.happened() || self.deadline.is_some_and(|deadline| Instant::now() >= deadline) {
            return Ok(false);
        }
        progress.picture(place);
        let paths = picture.folder.paths();
        if self.arguments.skip_existing && !paths.is_empty() && paths.iter().all(|path| path.is_file()) {
            self.keep(picture, &paths);
            progress.series(
                &format!("{} of {}: {} is there", place.index + 1, place.of, picture.member.stem("")),
                json!({ "event": "kept", "files": paths.iter().map(|p| p.display().to_string()).collect::<Vec<_>>() }),
            );
            return Ok(true);
        }
        // Not kept from the check: a thousand scenes would not fit into memory.
        let scene = self.series.scene_after(picture.index, self.other.take())?;
        let control = Arc::new(self.deadline.map_or_else(Control::new, Control::until));
        self.interrupt.stops(&control);
        let renderer = Renderer::new(&scene, self.isa).map_err(|error| refused(error, &scene))?;
        progress.start(&scene, self.threads, self.isa);
        let begun = Instant::now();
        let rendering = watch(&renderer, self.threads, &control, || progress.tick(&control, self.interrupt.happened()))
            .map_err(|error| refused(error, &scene))?;
        let seconds = begun.elapsed().as_secs_f64();
        progress.finish();
        if rendering.partial {
            return Ok(false);
        }
        for warning in &rendering.warnings {
            progress.warning(&Warning::from(warning.clone()));
        }
        let attributes = attributes(self.series, &picture.member);
        let times = scene.film_times(&rendering.exposure);
        let report = Report {
            scene: &scene,
            arguments: self.arguments,
            rendering: &rendering,
            times: &times,
            seconds,
            threads: self.threads,
            isa: self.isa,
            attributes: &attributes,
        };
        let written = picture.folder.write(&report, self.contact.is_some())?;
        let mut said = entry(&picture.member);
        if let Value::Object(figures) = report.to_json(&written.paths) {
            let common = ["scene", "scene_file", "overrides", "versions", "threads", "isa"];
            said.extend(figures.into_iter().filter(|(key, _)| !common.contains(&key.as_str())));
        }
        self.done.push(said.into());
        if let (Some(contact), Some(pictures)) = (&mut self.contact, &written.pictures) {
            contact.put(place.index, pictures);
        }
        progress.written(&written.paths);
        progress.done(&report, false);
        drop(renderer);
        self.other = Some(scene);
        if self.reported.elapsed() >= REPORT_EVERY {
            self.reported = Instant::now();
            write_report(&self.report_path, &self.report(&[], false))?;
        }
        Ok(true)
    }

    /// Takes a picture as it is on disk.
    fn keep(&mut self, picture: &Planned, paths: &[PathBuf]) {
        let mut said = entry(&picture.member);
        if let Some(Value::Object(earlier)) = self.earlier.get(&picture.member.number.to_string()) {
            // Of other values it may be, but of these files it is all that is known.
            said.extend(earlier.clone().into_iter().filter(|(key, _)| key != "values"));
        }
        said.insert("files".to_owned(), paths.iter().map(|p| p.display().to_string()).collect::<Vec<_>>().into());
        said.insert("kept".to_owned(), true.into());
        self.done.push(said.into());
        if let Some(contact) = &mut self.contact {
            contact.put_files(picture.index, &picture.films, &picture.folder.shown());
        }
    }

    /// The content of `SCENE-series.json`.
    fn report(&self, contact: &[PathBuf], whole: bool) -> Value {
        let mut report = json!({
            "scene": self.series.name(),
            "scene_file": self.arguments.scene.display().to_string(),
            "made_of": self.series.files(),
            "overrides": super::overrides(self.arguments),
            "count": self.series.count(),
            "complete": whole,
            "seconds": self.begun.elapsed().as_secs_f64(),
            "threads": self.threads,
            "isa": self.isa.name(),
            "versions": version::to_json(),
            "pictures": self.done,
        });
        if let Value::Object(map) = &mut report {
            match self.series.kind() {
                SeriesKind::Sweep { axes } => {
                    let axes: Vec<Value> = axes.iter().map(|a| json!({ "path": a.path, "values": a.values })).collect();
                    let sheets: Vec<String> = contact.iter().map(|p| p.display().to_string()).collect();
                    map.insert("kind".to_owned(), "sweep".into());
                    map.insert("axes".to_owned(), axes.into());
                    map.insert("contact_sheets".to_owned(), sheets.into());
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

    /// Writes the contact sheets and the report; gives their paths.
    fn finish(&self, whole: bool) -> Result<Vec<PathBuf>, Failure> {
        let mut paths = Vec::new();
        if let Some(contact) = &self.contact {
            for film in contact.films() {
                let part = film.as_ref().map_or(String::new(), |film| format!("-{film}"));
                let path = self.folder.join(format!("{}-contact{part}.png", self.series.name()));
                contact.write(film.as_deref(), &path, &format!("{}: contact sheet", self.series.name()))?;
                paths.push(path);
            }
        }
        write_report(&self.report_path, &self.report(&paths, whole))?;
        paths.push(self.report_path.clone());
        Ok(paths)
    }
}

/// The head of what is said of a picture.
fn entry(member: &Member) -> Map<String, Value> {
    let values: Map<String, Value> =
        member.values.iter().map(|(path, value)| (path.clone(), value.as_str().into())).collect();
    let mut said = Map::new();
    said.insert("number".to_owned(), member.number.into());
    said.insert("name".to_owned(), member.stem("").into());
    said.insert("values".to_owned(), values.into());
    said
}

/// What the header of an EXR says of its place in the series. Nothing here changes with the frames that are asked for.
fn attributes(series: &Series, member: &Member) -> Vec<(String, String)> {
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

/// A rate as the fraction that it stands for: `24/1`, and `24000/1001` for 23.976.
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
