//! `spectra run`: renders a scene file to pictures.

mod progress;

use crate::arguments::{Quality, Run};
use crate::folder::{Target, Temporary};
use crate::interrupt::{self, Interrupt};
use crate::outcome::{DONE, Failure, Outcome};
use crate::time_limit::SetUp;
use crate::{console, frames, limits, memory, version};
use progress::Progress;
use serde_json::json;
use spectra_core::Isa;
use spectra_scene::diagnostics;
use spectra_session::{Control, Event, Folder, Host, Job, JobEnd, LightFrom, Threads, Workers};
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::time::{Duration, Instant};

/// Interval between updates of the progress and checks for Ctrl-C.
const TICK: Duration = Duration::from_millis(50);

/// Renders a scene. With `--json`, a failure is also written as an event.
pub(crate) fn run(arguments: &Run, isa: Isa, started: Instant) -> Outcome {
    with_json_error(render_scene(arguments, isa, started), arguments.json)
}

/// Writes a failure as a JSON event if `is_json`; returns the outcome unchanged.
pub(crate) fn with_json_error(outcome: Outcome, is_json: bool) -> Outcome {
    if let (true, Err(failure)) = (is_json, &outcome) {
        let event = match failure {
            Failure::Faults(faults) => {
                json!({ "event": "error", "message": faults.to_string(), "faults": diagnostics::to_json(faults) })
            }
            Failure::Input(text) | Failure::Failed(text) => json!({ "event": "error", "message": text, "faults": [] }),
            Failure::ReaderGone => return outcome,
        };
        // If the reader has gone away, only the event is lost.
        let _ = console::json(&event);
    }
    outcome
}

fn render_scene(arguments: &Run, isa: Isa, started: Instant) -> Outcome {
    let limit_s = arguments.time_limit.map(f64::from);
    let deadline = limit_s.and_then(|s| started.checked_add(Duration::try_from_secs_f64(s).ok()?));
    let set_up = SetUp::watched(deadline, limit_s.unwrap_or_default(), arguments.json, arguments.quiet);
    let target = Target::of(&arguments.output)?;
    let overrides = overrides(arguments);
    let series = spectra_scene::load_series(&arguments.scene, &overrides)?;
    let job = Job {
        chosen: frames::chosen(&series, arguments.frames.as_ref(), arguments.skip_existing)?,
        series: &series,
        light: if series.is_without_lens() { LightFrom::Pixels } else { LightFrom::Rays },
        skip_existing: arguments.skip_existing,
        names: target.names.clone(),
        isa,
        scene_file: arguments.scene.display().to_string(),
        overrides,
        version: version::VERSION,
        versions: version::to_json(),
    };
    let speaks = OutputMode { json: arguments.json, quiet: arguments.quiet };
    let face = CliHost { deadline, set_up, ..CliHost::new(target, arguments.threads, isa, started, speaks, deadline) };
    let ended = spectra_session::run(&job, &face)?;
    Ok(face.code(ended))
}

/// Returns all values set on the command line, as texts `path=value`. Options come last, so they take precedence over `--set`.
fn overrides(arguments: &Run) -> Vec<String> {
    let mut all = arguments.set.overrides.clone();
    all.extend(arguments.seed.map(|seed| format!("render.seed={seed}")));
    let preset = arguments.quality.map(Quality::figures);
    let noise = arguments.noise.as_deref().or(preset.map(|(noise, _)| noise));
    all.extend(noise.map(|noise| format!("render.noise={noise}")));
    let samples = arguments.samples.or(preset.map(|(_, samples)| samples));
    all.extend(samples.map(|samples| format!("render.samples={samples}")));
    all
}

/// How a command reports its progress: as JSON events, not at all, or else as text.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OutputMode {
    pub json: bool,
    pub quiet: bool,
}

/// Host of a session for the command line: its threads, folders, signals and progress.
pub(crate) struct CliHost {
    target: Target,
    threads: usize,
    isa: Isa,
    started: Instant,
    deadline: Option<Instant>,
    set_up: SetUp,
    progress: Mutex<Progress>,
    /// Control of the current picture.
    control: Mutex<Arc<Control>>,
    /// Whether light is being traced at this moment.
    is_tracing: AtomicBool,
    interrupt: OnceLock<Interrupt>,
}

impl CliHost {
    /// Creates a host that writes files to `target`. Uses all processors if `threads` is not given.
    pub(crate) fn new(
        target: Target,
        threads: Option<u16>,
        isa: Isa,
        started: Instant,
        speaks: OutputMode,
        deadline: Option<Instant>,
    ) -> Self {
        Self {
            target,
            threads: threads.map_or_else(limits::processors, usize::from),
            isa,
            started,
            deadline: None,
            set_up: SetUp::watched(None, 0.0, speaks.json, speaks.quiet),
            progress: Mutex::new(Progress::new(speaks.json, speaks.quiet, deadline)),
            control: Mutex::default(),
            is_tracing: AtomicBool::new(false),
            interrupt: OnceLock::new(),
        }
    }

    /// Exit code of a job that ended in this way.
    pub(crate) fn code(&self, ended: JobEnd) -> u8 {
        self.interrupt.get().filter(|_| ended == JobEnd::Stopped).map_or(DONE, Interrupt::code)
    }

    fn is_late(&self) -> bool {
        self.deadline.is_some_and(|deadline| Instant::now() >= deadline)
    }

    fn tick(&self) {
        let control = Arc::clone(&self.control.lock().unwrap_or_else(PoisonError::into_inner));
        if self.is_late() {
            control.stop();
        }
        if self.is_tracing.load(Relaxed) {
            self.progress.lock().unwrap_or_else(PoisonError::into_inner).tick(&control, self.is_interrupted());
        }
    }
}

/// Runs work on the render threads. Meanwhile the calling thread updates the progress.
impl Workers for CliHost {
    fn run_on_all(&self, work: &(dyn Fn() + Sync)) {
        std::thread::scope(|scope| {
            let (end, ended) = mpsc::channel::<()>();
            let worker = std::thread::Builder::new().name("render 0".to_owned()).spawn_scoped(scope, move || {
                // Dropped at the end, even after a panic; this ends the wait below.
                let _end = end;
                Threads(self.threads).run_on_all(work);
            });
            let Ok(worker) = worker else {
                // If no thread can be started, this thread does the work, and the progress is not updated.
                work();
                return;
            };
            while ended.recv_timeout(TICK) == Err(RecvTimeoutError::Timeout) {
                self.tick();
            }
            worker.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
        });
    }
}

impl Host for CliHost {
    fn workers(&self) -> &dyn Workers {
        self
    }

    fn threads(&self) -> usize {
        self.threads
    }

    fn control(&self) -> Arc<Control> {
        let control = Arc::new(Control::new());
        *self.control.lock().unwrap_or_else(PoisonError::into_inner) = Arc::clone(&control);
        self.interrupt.get_or_init(|| interrupt::listen(&control, &self.target.folder)).stops(&control);
        if self.is_late() {
            control.stop();
        }
        control
    }

    fn is_interrupted(&self) -> bool {
        self.interrupt.get().is_some_and(Interrupt::is_requested)
    }

    fn is_stopped(&self) -> bool {
        self.is_interrupted() || self.is_late()
    }

    fn now_s(&self) -> f64 {
        self.started.elapsed().as_secs_f64()
    }

    fn memory_bytes(&self) -> Option<u64> {
        memory::available()
    }

    fn folder(&self) -> &dyn Folder {
        &self.target
    }

    fn elsewhere(&self) -> &dyn Folder {
        &Temporary
    }

    fn hear(&self, event: Event<'_>) {
        match event {
            Event::Ready => self.set_up.done(),
            Event::Start(_) => self.is_tracing.store(true, Relaxed),
            Event::Traced => self.is_tracing.store(false, Relaxed),
            _ => {}
        }
        self.progress.lock().unwrap_or_else(PoisonError::into_inner).hear(event, self.threads, self.isa);
    }
}
