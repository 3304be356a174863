//! Checks of every picture of a series before any is rendered.

use crate::{SessionError, Workers};
use spectra_core::Isa;
use spectra_core::params::{Fault, Faults, Warning};
use spectra_render::Renderer;
use spectra_scene::{Scene, Series, SeriesKind};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::sync::{Arc, Mutex, PoisonError};

/// Largest number of scenes that are assembled at the same time.
const AT_ONCE: usize = 8;

/// Settings for a check of the pictures of a series.
#[derive(Clone, Copy)]
pub struct CheckSettings<'a> {
    /// Instruction set that the pictures will be traced with.
    pub isa: Isa,
    /// Threads that do the checks.
    pub workers: &'a dyn Workers,
    /// Bytes of memory that are still available, if known.
    pub memory_bytes: Option<u64>,
    /// Progress callback: receives how many pictures have been checked, and how many there are.
    pub on_progress: &'a (dyn Fn(usize, usize) + Sync),
}

/// Result of checking a series that has no faults.
#[derive(Clone, Debug, Default)]
pub struct Checked {
    /// Warnings about the pictures, without duplicates.
    pub warnings: Vec<Warning>,
    /// Notes on how the pictures are taken, without duplicates.
    pub notes: Vec<String>,
    /// Bytes of memory that the largest picture needs beyond the scene itself.
    pub memory_bytes: u64,
}

/// Checks every picture of a series.
///
/// # Errors
/// Every fault of any picture. A fault that several pictures share is reported once.
pub fn check(series: &Series, look: CheckSettings<'_>) -> Result<Checked, SessionError> {
    let all: Vec<usize> = (0..series.count()).collect();
    let keep = |_, scene: &Scene| {
        // Pixels of large files are checked only for a single picture, not for each of a thousand.
        if series.count() == 1 {
            scene.source.prepare()?;
        }
        let notes: Vec<String> = scene.all_notes().cloned().collect();
        let warnings = scene.warnings.iter().chain(scene.source.warnings()).cloned().collect::<Vec<_>>();
        Ok((spectra_render::memory_needed(scene), warnings, notes))
    };
    let of_each = checked(series, &all, look, &keep)?;
    let warnings = each_once(series.warnings().iter().chain(of_each.iter().flat_map(|(_, warnings, _)| warnings)));
    Ok(Checked {
        warnings: warnings.into_iter().cloned().collect(),
        notes: each_once(of_each.iter().flat_map(|(_, _, notes)| notes)).into_iter().cloned().collect(),
        memory_bytes: of_each.iter().map(|(bytes, _, _)| *bytes).max().unwrap_or(0),
    })
}

/// Returns the items without duplicates, in their order.
pub(crate) fn each_once<'a, T: PartialEq>(all: impl Iterator<Item = &'a T>) -> Vec<&'a T> {
    let mut once: Vec<&T> = Vec::new();
    for one in all {
        if !once.contains(&one) {
            once.push(one);
        }
    }
    once
}

/// Assembles and checks these pictures of a series, and returns what `keep` makes of each.
pub(crate) fn checked<T: Send>(
    series: &Series,
    indices: &[usize],
    look: CheckSettings<'_>,
    keep: &(impl Fn(usize, &Scene) -> Result<T, SessionError> + Sync),
) -> Result<Vec<T>, SessionError> {
    let results: Vec<Mutex<Option<Result<T, SessionError>>>> = indices.iter().map(|_| Mutex::new(None)).collect();
    let (next, done, working) = (AtomicUsize::new(0), AtomicUsize::new(0), AtomicUsize::new(0));
    // Pictures of a series mostly differ in little: each thread makes the stages that they share once.
    let check = |index: usize, other: &mut Option<Arc<Scene>>| -> Result<T, SessionError> {
        let scene = Arc::new(series.looked_at(index, other.take())?);
        // Finds the faults that show only once the stages are put together.
        Renderer::check(&scene).map_err(|error| SessionError::of(&error, &scene))?;
        look.memory_bytes.map_or(Ok(()), |bytes| spectra_render::fits(&scene, bytes))?;
        let kept = keep(index, &scene);
        *other = Some(scene);
        kept
    };
    look.workers.run_on_all(&|| {
        if working.fetch_add(1, Relaxed) >= AT_ONCE {
            return;
        }
        let mut other = None;
        while let Some((index, result)) = {
            let at = next.fetch_add(1, Relaxed);
            indices.get(at).zip(results.get(at))
        } {
            *result.lock().unwrap_or_else(PoisonError::into_inner) = Some(check(*index, &mut other));
            (look.on_progress)(done.fetch_add(1, Relaxed) + 1, indices.len());
        }
    });
    let mut kept = Vec::with_capacity(indices.len());
    let mut faults: Vec<(Fault, Vec<usize>)> = Vec::new();
    for (index, result) in indices.iter().zip(results) {
        match result.into_inner().unwrap_or_else(PoisonError::into_inner) {
            Some(Ok(value)) => kept.push(value),
            Some(Err(SessionError::Faults(found))) => {
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
    let told =
        faults.into_iter().map(|(fault, members)| with_affected_pictures(series, fault, &members, indices.len()));
    Err(SessionError::Faults(Faults(told.collect())))
}

/// Returns the fault with a hint that names the first of `members`, the pictures that have it, and counts the others. The fault
/// is unchanged if all `all` pictures have it.
fn with_affected_pictures(series: &Series, fault: Fault, members: &[usize], all: usize) -> Fault {
    let Some(first) = members.first().filter(|_| members.len() < all) else { return fault };
    let member = series.member(*first);
    let what = if matches!(series.kind(), SeriesKind::Animation { .. }) { "frame" } else { "picture" };
    let more = if members.len() > 1 { format!(" and {} more", members.len() - 1) } else { String::new() };
    let values = if member.values.is_empty() { String::new() } else { format!(" ({})", member.words()) };
    let note = format!("{what} {}{values}{more}", member.number);
    let hint = fault.hint.as_ref().map_or_else(
        || note.clone(),
        |hint| if hint.ends_with('?') { format!("{hint} In {note}") } else { format!("{hint}; {note}") },
    );
    fault.hint(hint)
}
