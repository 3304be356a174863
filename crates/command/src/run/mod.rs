//! `spectra run`: from a scene file to pictures.

mod contact;
mod folder;
mod frames;
mod interrupt;
mod leftover;
mod limit;
mod picture;
mod progress;
mod rays;
mod report;
mod rescue;
mod series;
mod summary;
mod target;

use crate::arguments::Run;
use crate::console;
use crate::memory;
use crate::outcome::{DONE, Failure, Outcome};
use folder::{Folder, write_report};
pub(crate) use frames::Frames;
use limit::SetUp;
use progress::Progress;
use report::Report;
use serde_json::json;
pub(crate) use series::{Checking, checked};
use spectra_core::Isa;
use spectra_core::params::Warning;
use spectra_render::{Control, RenderError, Renderer, Rendering};
use spectra_scene::{Scene, SeriesKind, diagnostics};
use std::sync::Arc;
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::{Duration, Instant};
use target::Target;

/// How often the progress is looked at, and Ctrl-C with it.
const TICK: Duration = Duration::from_millis(50);

/// Renders a scene; with `--json` a failure is an event as well.
pub(crate) fn run(arguments: &Run, isa: Isa, started: Instant) -> Outcome {
    let outcome = render_scene(arguments, isa, started);
    if let (true, Err(failure)) = (arguments.json, &outcome) {
        let event = match failure {
            Failure::Faults(faults) => {
                json!({ "event": "error", "message": faults.to_string(), "faults": diagnostics::to_json(faults) })
            }
            Failure::Input(text) | Failure::Failed(text) => json!({ "event": "error", "message": text, "faults": [] }),
            Failure::ReaderGone => return outcome,
        };
        // A reader that has gone away misses the event, not the picture.
        let _ = console::json(&event);
    }
    outcome
}

fn render_scene(arguments: &Run, isa: Isa, started: Instant) -> Outcome {
    let limit_s = arguments.time_limit.map(f64::from);
    let deadline = limit_s.and_then(|s| started.checked_add(Duration::try_from_secs_f64(s).ok()?));
    let set_up = SetUp::watched(deadline, limit_s.unwrap_or_default(), arguments.json, arguments.quiet);
    let target = Target::of(&arguments.output)?;
    let series = spectra_scene::load_series(&arguments.scene, &overrides(arguments))?;
    let threads = arguments.threads.map_or_else(processors, usize::from);
    if series.kind() != SeriesKind::Single {
        return series::render(&series, arguments, &target, threads, isa, deadline, set_up);
    }
    frames::refuse_without_series(arguments)?;
    let mut scene = series.scene(0)?;
    scene.warnings.splice(0..0, series.warnings().iter().cloned());
    target.narrow(&mut scene)?;
    tracing::debug!(seconds = started.elapsed().as_secs_f64(), "scene loaded");
    // What cannot be rendered leaves no folder behind.
    let renderer = Renderer::new(&scene, isa).map_err(|error| refused(error, &scene))?;
    tracing::debug!(seconds = started.elapsed().as_secs_f64(), "ready to render");
    memory::suffices_for(&scene)?;
    // Before any light is traced: an hour's picture must not end without a place to go.
    set_up.done();
    let report_path = target.report(&series.member(0).stem(""));
    let folder = Folder::prepare(&target, &scene, &series.member(0), report_path.as_deref())?;
    leftover::sweep(&target.folder, series.name());
    let control = Arc::new(deadline.map_or_else(Control::new, Control::until));
    let interrupt = interrupt::listen(&control, &target.folder);
    let mut progress = Progress::new(arguments, deadline);
    for note in &scene.lens.notes {
        progress.note(note);
    }
    for warning in &scene.warnings {
        progress.warning(warning);
    }
    for note in &scene.notes {
        progress.note(note);
    }
    progress.start(&scene, threads, isa);
    let begun = Instant::now();
    let rendered = watch(&renderer, threads, &control, || progress.tick(&control, interrupt.happened()));
    let seconds = begun.elapsed().as_secs_f64();
    progress.finish();
    let (rendering, failure) = match rendered {
        Ok(rendering) => (rendering, None),
        // What was computed before is worth keeping: it may be hours.
        Err(RenderError::Overflow { times, so_far: Some(so_far) }) => {
            let error = RenderError::Overflow { times, so_far: None };
            (*so_far, Some(format!("{error}; the files hold the light traced before it, without that ray")))
        }
        Err(error) => return Err(refused(error, &scene)),
    };
    for warning in &rendering.warnings {
        progress.warning(&Warning::from(warning.clone()));
    }
    let times = scene.film_times(&rendering.exposure);
    let report = Report {
        scene: &scene,
        arguments,
        rendering: &rendering,
        times: &times,
        seconds,
        threads,
        isa,
        attributes: &[],
    };
    let mut paths = folder.write(&report, false)?.paths;
    if let Some(report_path) = report_path {
        paths.push(report_path.clone());
        write_report(&report_path, &report.to_json(&paths))?;
    }
    progress.written(&paths);
    let interrupted = rendering.partial && interrupt.happened();
    progress.done(&report, interrupted);
    if let Some(text) = failure {
        return Err(Failure::Failed(text));
    }
    Ok(if interrupted { interrupt.code() } else { DONE })
}

/// All that is set on the command line, as texts `path=value`; the options come after what `--set` says.
fn overrides(arguments: &Run) -> Vec<String> {
    let mut all = arguments.set.overrides.clone();
    all.extend(arguments.seed.map(|seed| format!("render.seed={seed}")));
    all.extend(arguments.samples.map(|samples| format!("render.samples={samples}")));
    all
}

/// Processors that this process may use.
fn processors() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// What the scene cannot have is a fault of the scene.
fn refused(error: RenderError, scene: &Scene) -> Failure {
    error.faults(scene).map_or_else(|| failed(error), Failure::Faults)
}

fn failed(error: RenderError) -> Failure {
    Failure::Failed(error.to_string())
}

/// Renders on other threads and calls `tick` meanwhile.
fn watch(
    renderer: &Renderer<'_>,
    threads: usize,
    control: &Control,
    mut tick: impl FnMut(),
) -> Result<Rendering, RenderError> {
    std::thread::scope(|scope| {
        let (end, ended) = mpsc::channel::<()>();
        let worker = scope.spawn(move || {
            // Dropped at the end, also by a panic: that is what ends the wait below.
            let _end = end;
            renderer.run(threads, control)
        });
        while ended.recv_timeout(TICK) == Err(RecvTimeoutError::Timeout) {
            tick();
        }
        worker.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    })
}

/// What a person wants to know of the way light is computed.
fn direction(scene: &Scene) -> &'static str {
    match scene.render.direction {
        spectra_scene::Direction::Forward => "forward",
        spectra_scene::Direction::Backward => "backward",
    }
}
