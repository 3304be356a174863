//! `spectra check`: every fault of scenes, nothing rendered.

use crate::arguments::Check;
use crate::console;
use crate::memory;
use crate::outcome::{BAD_INPUT, DONE, Failure, Outcome};
use crate::run::{self, Checking};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde_json::json;
use spectra_core::Isa;
use spectra_core::params::{Fault, Faults, Warning};
use spectra_scene::{Scene, SeriesKind, diagnostics};
use std::path::Path;
use std::time::{Duration, Instant};

/// Checks all scenes; a faulty one does not keep the others from being looked at.
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
                    console::said(warning, Some(path));
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

/// A scene in which nothing is wrong.
struct Good {
    warnings: Vec<Warning>,
    notes: Vec<String>,
    /// How many pictures a sweep or an animation has.
    pictures: Option<usize>,
    /// What the largest picture takes beyond the scene itself.
    memory_bytes: u64,
}

/// The warnings of a good scene, or all faults.
fn check_one(path: &Path, overrides: &[String], isa: Isa, is_shown: bool) -> Result<Good, Faults> {
    let series = spectra_scene::load_series(path, overrides)?;
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let all: Vec<usize> = (0..series.count()).collect();
    let mut shown = Shown::new(is_shown);
    let of_each = run::checked(
        &series,
        &all,
        isa,
        threads,
        &|_, scene: &Scene| {
            let notes: Vec<String> = scene.all_notes().cloned().collect();
            Ok((spectra_render::memory_needed(scene), scene.warnings.clone(), notes))
        },
        &mut |checking| {
            shown.tick(checking);
        },
    );
    shown.end();
    let of_each = of_each.map_err(|failure| match failure {
        Failure::Faults(faults) => faults,
        // What shows only once the stages are put together, such as a lens without any aperture.
        Failure::Input(text) | Failure::Failed(text) => Fault::new(format!("{}: {text}", path.display())).into(),
        Failure::ReaderGone => Faults::new(),
    })?;
    let warnings = run::each_once(series.warnings().iter().chain(of_each.iter().flat_map(|(_, warnings, _)| warnings)));
    let warnings = warnings.into_iter().cloned().collect();
    let notes = run::each_once(of_each.iter().flat_map(|(_, _, notes)| notes)).into_iter().cloned().collect();
    let pictures = (series.kind() != SeriesKind::Single).then_some(all.len());
    Ok(Good { warnings, notes, pictures, memory_bytes: of_each.iter().map(|(bytes, _, _)| *bytes).max().unwrap_or(0) })
}

/// How far the check of a long series is, on standard error: a line that moves at a terminal, else one now and then.
struct Shown {
    bar: Option<ProgressBar>,
    is_shown: bool,
    said: Instant,
}

/// What takes less than this needs no words.
const SHOWN_AFTER: Duration = Duration::from_secs(1);
/// One plain line in this time.
const LINE_EVERY: Duration = Duration::from_secs(10);

impl Shown {
    fn new(is_shown: bool) -> Self {
        Self { bar: None, is_shown, said: Instant::now() }
    }

    fn tick(&mut self, checking: Checking) {
        if !self.is_shown || checking.of < 2 {
            return;
        }
        let elapsed = self.said.elapsed();
        match &self.bar {
            Some(bar) => bar.set_position(checking.done as u64),
            None if console::stderr_moves() && elapsed >= SHOWN_AFTER => {
                let bar =
                    ProgressBar::with_draw_target(Some(checking.of as u64), ProgressDrawTarget::stderr_with_hz(10));
                let style = ProgressStyle::with_template("[{bar:32}] {pos} of {len} pictures checked");
                bar.set_style(style.expect("the template is a constant").progress_chars("=> "));
                self.bar = Some(bar);
            }
            None if !console::stderr_moves() && elapsed >= LINE_EVERY => {
                self.said = Instant::now();
                console::note(&format!("{} of {} pictures checked", checking.done, checking.of));
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
