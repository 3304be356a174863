//! `spectra check`: finds every fault of scenes without rendering them.

use crate::arguments::Check;
use crate::console;
use crate::limits;
use crate::memory;
use crate::outcome::{BAD_INPUT, DONE, Outcome};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde_json::json;
use spectra_core::Isa;
use spectra_core::params::{Fault, Faults, Warning};
use spectra_scene::{SeriesKind, diagnostics};
use spectra_session::{CheckSettings, Checked, SessionError, Threads};
use std::path::Path;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Checks all scenes. A faulty scene does not stop the check of the others.
pub(crate) fn check(arguments: &Check, isa: Isa) -> Outcome {
    let mut results = Vec::new();
    let mut faulty = 0_usize;
    for path in &arguments.scenes {
        let result = check_one(path, &arguments.set.overrides, isa, !arguments.json);
        faulty += usize::from(result.is_err());
        if arguments.json {
            let scene = path.display().to_string();
            let mut said = match &result {
                Ok(good) => json!({
                    "scene": scene, "ok": true, "faults": [], "warnings": diagnostics::warnings_to_json(&good.warnings), "notes": good.notes, "memory_bytes": good.memory_bytes
                }),
                Err(faults) => {
                    json!({ "scene": scene, "ok": false, "faults": diagnostics::to_json(faults), "warnings": [] })
                }
            };
            if let Some(pictures) = result.as_ref().ok().and_then(|good| good.pictures) {
                said["pictures"] = pictures.into();
            }
            results.push(said);
            continue;
        }
        match &result {
            Ok(good) => {
                for warning in &good.warnings {
                    console::scene_warning(warning, Some(path));
                }
                for note in &good.notes {
                    console::note(&format!("note: {}: {note}", path.display()));
                }
                let pictures =
                    good.pictures.map_or(String::new(), |n| format!(", {n} picture{}", if n == 1 { "" } else { "s" }));
                let memory = memory::worth_saying(good.memory_bytes).map_or(String::new(), |text| format!(", {text}"));
                console::out(&format!("{}: good{pictures}{memory}\n", path.display()))?;
            }
            Err(faults) => console::faults(faults),
        }
    }
    if arguments.json {
        console::pretty_json(&json!({ "scenes": results }))?;
    } else if faulty > 0 && arguments.scenes.len() > 1 {
        console::error(&format!("{faulty} of {} scenes cannot be rendered", arguments.scenes.len()));
    }
    Ok(if faulty > 0 { BAD_INPUT } else { DONE })
}

/// Result of checking a scene without faults.
struct Good {
    warnings: Vec<Warning>,
    notes: Vec<String>,
    /// Number of pictures of a sweep or an animation; `None` for a single picture.
    pictures: Option<usize>,
    /// Memory that the largest picture takes in addition to the scene itself, bytes.
    memory_bytes: u64,
}

/// Checks one scene. Returns its warnings and notes if it is good, or else all its faults.
fn check_one(path: &Path, overrides: &[String], isa: Isa, is_shown: bool) -> Result<Good, Faults> {
    let series = spectra_scene::load_series(path, overrides)?;
    let shown = Mutex::new(Shown::new(is_shown));
    let seen = |done: usize, of: usize| shown.lock().unwrap_or_else(PoisonError::into_inner).tick(done, of);
    let (workers, memory_bytes) = (&Threads(limits::processors()), memory::available());
    let found = spectra_session::check(&series, CheckSettings { isa, workers, memory_bytes, on_progress: &seen });
    shown.lock().unwrap_or_else(PoisonError::into_inner).end();
    let Checked { warnings, notes, memory_bytes } = found.map_err(|error| match error {
        SessionError::Faults(faults) => faults,
        // Errors that appear only once the stages are assembled, such as a lens without any aperture.
        other => Fault::new(format!("{}: {other}", path.display())).into(),
    })?;
    let pictures = (series.kind() != SeriesKind::Single).then(|| series.count());
    Ok(Good { warnings, notes, pictures, memory_bytes })
}

/// Progress of the check of a long series, on standard error: a moving bar at a terminal, otherwise a line now and then.
struct Shown {
    bar: Option<ProgressBar>,
    is_shown: bool,
    said: Instant,
}

/// Time before the progress bar appears.
const SHOWN_AFTER: Duration = Duration::from_secs(1);
/// Time between plain progress lines.
const LINE_EVERY: Duration = Duration::from_secs(10);

impl Shown {
    fn new(is_shown: bool) -> Self {
        Self { bar: None, is_shown, said: Instant::now() }
    }

    fn tick(&mut self, done: usize, of: usize) {
        if !self.is_shown || of < 2 {
            return;
        }
        let elapsed = self.said.elapsed();
        match &self.bar {
            Some(bar) => bar.set_position(done as u64),
            None if console::stderr_moves() && elapsed >= SHOWN_AFTER => {
                let bar = ProgressBar::with_draw_target(Some(of as u64), ProgressDrawTarget::stderr_with_hz(10));
                let style = ProgressStyle::with_template("[{bar:32}] {pos} of {len} pictures checked");
                bar.set_style(style.expect("the template is a constant").progress_chars("=> "));
                self.bar = Some(bar);
            }
            None if !console::stderr_moves() && elapsed >= LINE_EVERY => {
                self.said = Instant::now();
                console::note(&format!("{} of {} pictures checked", done, of));
            }
            None => {}
        }
    }

    fn end(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
