//! Progress messages while a scene renders.

use crate::{console, formatting};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde_json::{Value, json};
use spectra_core::Isa;
use spectra_core::params::Warning;
use spectra_scene::{Scene, diagnostics};
use spectra_session::{Control, Event, Pace, Report, SeriesPosition, films};
use std::time::{Duration, Instant};

/// Form of the messages, by their reader.
enum Listener {
    /// A person at a terminal: a moving bar and messages.
    Bar(ProgressBar),
    /// A file or a pipe: a few whole lines.
    Lines,
    /// A program: JSON events on standard output.
    Json,
    /// No reader: nothing is written.
    Quiet,
}

/// Reports the progress of a render in the form that the reader needs.
pub(crate) struct Progress {
    listener: Listener,
    deadline: Option<Instant>,
    begun: Instant,
    said: Instant,
    stopping: bool,
    /// Number of the current picture in a series; `None` for a single picture.
    place: Option<SeriesPosition>,
}

/// Time between JSON progress events.
const JSON_EVERY: Duration = Duration::from_millis(200);
/// Time between plain progress lines.
const LINE_EVERY: Duration = Duration::from_secs(10);

/// Number of steps of the bar, more than any terminal can show.
const BAR_STEPS: u32 = 1000;

impl Progress {
    /// Creates the progress report without writing anything yet.
    pub(super) fn new(is_json: bool, is_quiet: bool, deadline: Option<Instant>) -> Self {
        let listener = if is_quiet {
            Listener::Quiet
        } else if is_json {
            Listener::Json
        } else if console::stderr_moves() {
            Listener::Bar(bar())
        } else {
            Listener::Lines
        };
        Self { listener, deadline, begun: Instant::now(), said: Instant::now(), stopping: false, place: None }
    }

    /// Reports an event of the session.
    pub(super) fn hear(&mut self, event: Event<'_>, threads: usize, isa: Isa) {
        match event {
            Event::Checked { done, of } => self.checking(done, of),
            Event::Preparing => self.preparing(),
            Event::Ready | Event::FirstPass | Event::DevelopedOnce { .. } => {}
            Event::Snapshot(files) => self.snapshot(files),
            Event::Warning(warning) => self.warning(warning),
            Event::Note(text) => self.note(text),
            Event::Series(text, event) => self.series(text, event.clone()),
            Event::Picture(place) => self.place = place,
            Event::Start(scene) => self.start(scene, threads, isa),
            Event::Traced => self.finish(),
            Event::Written(files) => self.written(files),
            Event::Done { report, stopped } => self.done(report, stopped),
        }
    }

    /// Returns the prefix `3 of 6: `, or an empty text for a single picture.
    fn place(&self) -> String {
        self.place.map_or(String::new(), |place| format!("{} of {}: ", place.index + 1, place.of))
    }

    /// Writes a JSON event. If the reader has gone away, the event is lost but the picture is still finished.
    fn event(&self, mut value: Value) {
        if let (Some(place), Value::Object(map)) = (self.place, &mut value) {
            map.insert("number".to_owned(), place.number.into());
            map.insert("picture".to_owned(), (place.index + 1).into());
            map.insert("pictures".to_owned(), place.of.into());
        }
        let _ = console::json(&value);
    }

    /// Writes a remark on the series, as text or as a JSON event.
    fn series(&self, text: &str, event: Value) {
        match &self.listener {
            Listener::Json => self.event(event),
            Listener::Quiet => {}
            // The text goes above the bar, which is drawn again below it.
            Listener::Bar(bar) => bar.suspend(|| console::note(text)),
            Listener::Lines => console::note(text),
        }
    }

    /// Writes a warning about something that may make the picture wrong.
    fn warning(&self, warning: &Warning) {
        match &self.listener {
            Listener::Json => {
                let mut event = diagnostics::warning_to_json(warning);
                event["event"] = "warning".into();
                self.event(event);
            }
            Listener::Quiet => {}
            Listener::Bar(_) | Listener::Lines => console::scene_warning(warning, None),
        }
    }

    /// Tells a program that files hold the picture so far.
    fn snapshot(&self, files: &[String]) {
        if let Listener::Json = &self.listener {
            self.event(json!({ "event": "snapshot", "files": files }));
        }
    }

    /// Shows the progress of the check of all pictures, before any is rendered.
    fn checking(&mut self, done: usize, of: usize) {
        if of < 2 {
            return;
        }
        let elapsed = self.said.elapsed();
        match &self.listener {
            Listener::Bar(bar) => {
                bar.set_position((done as u64 * u64::from(BAR_STEPS)) / of.max(1) as u64);
                bar.set_message(format!("{} of {} pictures checked", done, of));
            }
            Listener::Json if elapsed >= JSON_EVERY => {
                self.said = Instant::now();
                self.event(json!({ "event": "check", "done": done, "of": of }));
            }
            Listener::Lines if elapsed >= LINE_EVERY => {
                self.said = Instant::now();
                console::note(&format!("{} of {} pictures checked", done, of));
            }
            Listener::Json | Listener::Lines | Listener::Quiet => {}
        }
    }

    /// Shows that the lens is searched for where light passes, before the first ray.
    fn preparing(&self) {
        if let Listener::Bar(bar) = &self.listener {
            bar.set_message("finding where light passes the lens");
            bar.tick();
        }
    }

    /// Writes a note on how the scene is interpreted.
    fn note(&self, text: &str) {
        match &self.listener {
            Listener::Json => self.event(json!({ "event": "note", "message": text })),
            Listener::Quiet => {}
            Listener::Bar(_) | Listener::Lines => console::note(&format!("note: {text}")),
        }
    }

    /// Announces the start of tracing: scene, size, lens, film, direction and threads.
    fn start(&mut self, scene: &Scene, threads: usize, isa: Isa) {
        self.begun = Instant::now();
        self.said = self.begun;
        let size = scene.imager.size();
        match &self.listener {
            Listener::Json => self.event(json!({
                "event": "start",
                "scene": scene.name,
                "lens": scene.lens.name,
                "direction": scene.render.direction.name(),
                "width_px": size.width_px,
                "height_px": size.height_px,
                "seed": scene.render.seed,
                "threads": threads,
                "isa": isa.name(),
            })),
            Listener::Quiet => {}
            Listener::Bar(_) | Listener::Lines => {
                let film = films(scene).map_or(String::new(), |films| format!(", {films}"));
                let plural = if threads == 1 { "" } else { "s" };
                console::note(&format!(
                    "{}{}: {} x {} pixels through {}{film}; {} on {threads} thread{plural}",
                    self.place(),
                    scene.name,
                    size.width_px,
                    size.height_px,
                    scene.lens.name,
                    scene.render.direction.name()
                ));
            }
        }
        // The bar of the previous picture is gone; a new one starts below the line about this picture.
        if let (Listener::Bar(bar), Some(_)) = (&self.listener, self.place) {
            bar.set_message(self.place());
            bar.reset();
        }
    }

    /// Updates the progress; called many times a second.
    pub(super) fn tick(&mut self, control: &Control, interrupted: bool) {
        if interrupted && !self.stopping {
            self.stopping = true;
            self.say(match self.place {
                None => "stopping: the picture so far will be written; Ctrl-C again discards it",
                Some(_) => "stopping: finished pictures are kept",
            });
        }
        let pace = self.pace(control);
        let elapsed = self.said.elapsed();
        match &self.listener {
            Listener::Bar(bar) => {
                bar.set_position((pace.fraction().max(self.time_used()) * f64::from(BAR_STEPS)) as u64);
                let left = pace.seconds_left.map_or(String::new(), |s| format!(", {} left", formatting::duration(s)));
                bar.set_message(format!("{}{}{left}", self.place(), formatting::rate(pace.rays_per_second)));
            }
            Listener::Json if elapsed >= JSON_EVERY => {
                self.said = Instant::now();
                self.event(json!({
                    "event": "progress",
                    "rays": pace.rays,
                    "total_rays": pace.total_rays,
                    "fraction": pace.fraction(),
                    "rays_per_second": pace.rays_per_second,
                    "seconds": self.begun.elapsed().as_secs_f64(),
                    "seconds_left": pace.seconds_left,
                }));
            }
            Listener::Lines if elapsed >= LINE_EVERY => {
                self.said = Instant::now();
                let left = pace.seconds_left.map_or(String::new(), |s| format!(", {} left", formatting::duration(s)));
                console::note(&format!(
                    "{}{:.0} %, {}{left}",
                    self.place(),
                    100.0 * pace.fraction(),
                    formatting::rate(pace.rays_per_second)
                ));
            }
            Listener::Json | Listener::Lines | Listener::Quiet => {}
        }
    }

    fn pace(&self, control: &Control) -> Pace {
        let until = |deadline: Instant| deadline.saturating_duration_since(Instant::now()).as_secs_f64();
        Pace::of(control, self.begun.elapsed().as_secs_f64(), self.deadline.map(until))
    }

    /// Returns the fraction of the time limit that has passed, from 0 to 1; 0 without a limit.
    fn time_used(&self) -> f64 {
        let Some(limit) = self.deadline.map(|deadline| deadline.saturating_duration_since(self.begun)) else {
            return 0.0;
        };
        if limit.is_zero() { 1.0 } else { (self.begun.elapsed().as_secs_f64() / limit.as_secs_f64()).min(1.0) }
    }

    /// Writes a remark about stopping without disturbing the progress bar.
    fn say(&self, text: &str) {
        match &self.listener {
            // The text goes above the bar, which is drawn again below it.
            Listener::Bar(bar) => bar.suspend(|| console::note(text)),
            Listener::Lines => console::note(text),
            Listener::Json => self.event(json!({ "event": "stopping", "message": text })),
            Listener::Quiet => {}
        }
    }

    /// Removes the bar, because no more light is traced.
    fn finish(&self) {
        if let Listener::Bar(bar) = &self.listener {
            bar.finish_and_clear();
        }
    }

    /// Reports files that are complete.
    fn written(&self, paths: &[String]) {
        match &self.listener {
            Listener::Json => {
                for path in paths {
                    self.event(json!({ "event": "written", "path": path }));
                }
            }
            Listener::Quiet => {}
            // If the reader has gone away, only the names are lost, not the files.
            Listener::Bar(_) | Listener::Lines if !paths.is_empty() => {
                drop(console::out(&format!("wrote {}\n", formatting::files(paths))));
            }
            Listener::Bar(_) | Listener::Lines => {}
        }
    }

    /// Reports that a picture is done, with its time and number of rays.
    fn done(&self, report: &Report<'_>, interrupted: bool) {
        let rendering = report.rendering;
        match &self.listener {
            Listener::Json => self.event(json!({
                "event": "done",
                "seconds": report.seconds,
                "rays": rendering.rays,
                "rays_per_second": report.rays_per_second(),
                "lost": rendering.losses.total(),
                "partial": rendering.partial,
                "interrupted": interrupted,
            })),
            Listener::Quiet => {}
            Listener::Bar(_) | Listener::Lines => console::note(&report.summary()),
        }
    }
}

fn bar() -> ProgressBar {
    let bar = ProgressBar::with_draw_target(Some(u64::from(BAR_STEPS)), ProgressDrawTarget::stderr_with_hz(10));
    let style = ProgressStyle::with_template("[{bar:32}] {percent:>3} %  {msg}").expect("the template is a constant");
    bar.set_style(style.progress_chars("=> "));
    bar
}
