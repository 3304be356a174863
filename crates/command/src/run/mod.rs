//! `spectra run`: renders a scene file to pictures.

mod progress;

use crate::arguments::{Quality, Run};
use crate::folder::{Target, Temporary};
use crate::interrupt::{self, Interrupt};
use crate::outcome::{DONE, Outcome, with_json_error};
use crate::time_limit::{Watch, deadline};
use crate::{frames, limits, memory, version};
use progress::Progress;
use spectra_core::Isa;
use spectra_session::{Control, Event, Folder, Host, Job, JobEnd, LightFrom, Threads, Workers};
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::time::{Duration, Instant};

/// Time that a time limit leaves beside that for development, s: the last units of work, and writing files.
const LEEWAY_S: f64 = 0.1;

/// Interval between updates of the progress and checks for Ctrl-C.
const TICK: Duration = Duration::from_millis(50);

/// Renders a scene. With `--json`, a failure is also written as an event.
pub(crate) fn run(arguments: &Run, isa: Isa, started: Instant) -> Outcome {
    with_json_error(render_scene(arguments, isa, started), arguments.json)
}

fn render_scene(arguments: &Run, isa: Isa, started: Instant) -> Outcome {
    let limit_s = arguments.time_limit.map(f64::from);
    let watch = Watch::new(started, limit_s, arguments.json);
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
    let snapshot_every = arguments.snapshot.and_then(|time| Duration::try_from_secs_f64(f64::from(time)).ok());
    let host = CliHost::new(target, arguments.threads, isa, started, speaks, deadline(started, limit_s));
    if job.light == LightFrom::Pixels {
        // Without a lens there is nothing that a limit could shorten.
        watch.done();
    }
    let face = CliHost { limit_s, watch, snapshot_every, ..host };
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
    limit_s: Option<f64>,
    /// End of tracing, so that the time limit leaves time for development.
    deadline: Mutex<Option<Instant>>,
    watch: Watch,
    snapshot_every: Option<Duration>,
    /// When tracing began or the last snapshot was written.
    snapshot: Mutex<Instant>,
    /// Time that development takes, once it is known.
    development: Mutex<Duration>,
    /// Whether several pictures are made.
    is_series: AtomicBool,
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
            limit_s: None,
            deadline: Mutex::new(deadline),
            watch: Watch::new(started, None, speaks.json),
            snapshot_every: None,
            snapshot: Mutex::new(started),
            development: Mutex::default(),
            is_series: AtomicBool::new(false),
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
        let deadline = self.deadline.lock().unwrap_or_else(PoisonError::into_inner);
        deadline.is_some_and(|deadline| Instant::now() >= deadline)
    }

    /// Moves the end of tracing forward by the time that development takes, and a quarter for safety.
    fn leave_time_for(&self, development_s: f64) {
        let before = Duration::try_from_secs_f64(1.25 * development_s + LEEWAY_S).unwrap_or_default();
        *self.development.lock().unwrap_or_else(PoisonError::into_inner) = before;
        let mut deadline = self.deadline.lock().unwrap_or_else(PoisonError::into_inner);
        *deadline = deadline.map(|deadline| deadline.checked_sub(before).unwrap_or(self.started));
    }

    /// Restarts the time until the next snapshot.
    fn begin_snapshot(&self) {
        *self.snapshot.lock().unwrap_or_else(PoisonError::into_inner) = Instant::now();
    }

    /// Whether a snapshot is due and there is time to develop it before tracing ends.
    fn is_snapshot_due(&self) -> bool {
        let begun = *self.snapshot.lock().unwrap_or_else(PoisonError::into_inner);
        let development = *self.development.lock().unwrap_or_else(PoisonError::into_inner);
        let deadline = *self.deadline.lock().unwrap_or_else(PoisonError::into_inner);
        let has_time = deadline.is_none_or(|deadline| Instant::now() + development < deadline);
        has_time && self.snapshot_every.is_some_and(|every| begun.elapsed() >= every)
    }

    fn tick(&self) {
        let control = Arc::clone(&self.control.lock().unwrap_or_else(PoisonError::into_inner));
        if self.is_late() {
            control.stop();
        }
        if self.is_tracing.load(Relaxed) {
            if self.is_snapshot_due() {
                // Until the first pass is complete there is no snapshot; then the next one is due after a whole interval.
                self.begin_snapshot();
                control.pause();
            }
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

    fn should_stop(&self) -> bool {
        self.is_stopped()
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

    fn time_limit_s(&self) -> Option<f64> {
        self.limit_s
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
            Event::Start(_) => {
                self.watch.prepared();
                // A series says itself that no picture was finished, and snapshots may be written from now on.
                if self.is_series.load(Relaxed) {
                    self.watch.done();
                }
                self.begin_snapshot();
                self.is_tracing.store(true, Relaxed);
            }
            Event::FirstPass => self.watch.passed(),
            Event::DevelopedOnce { seconds } => {
                self.watch.done();
                self.leave_time_for(seconds);
            }
            Event::Snapshot(_) => self.begin_snapshot(),
            Event::Picture(Some(place)) => {
                self.is_series.store(true, Relaxed);
                if place.index > 0 {
                    self.watch.done();
                }
            }
            Event::Traced => {
                self.watch.done();
                self.is_tracing.store(false, Relaxed);
            }
            _ => {}
        }
        self.progress.lock().unwrap_or_else(PoisonError::into_inner).hear(event, self.threads, self.isa);
    }
}
