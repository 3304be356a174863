//! Metering of an animation on its first frame, for all of its frames.
//!
//! A camera that meters each frame by itself makes a shot flicker with whatever moves through it. The first frame is therefore
//! traced with few rays before any picture is made, and all frames, including the first, are exposed as metered there. It does
//! not matter which frames are asked for: frame 17 alone has the same exposure as in the whole shot.

use crate::{Event, Host, Job, Session, SessionError, SessionOptions};
use spectra_core::params::Warning;
use spectra_core::shutter;
use spectra_scene::SeriesKind;

/// Samples over the whole frame. They give the mean of an even frame to about 0.1 %, and of a spot of a hundredth of it to about
/// 1 %.
const SAMPLES: u64 = 1 << 21;
/// Longest plausible exposure of the first frame, s. A longer one means a dark frame: nobody opens a shutter for an hour in each
/// frame.
const LONGEST_S: f64 = 3600.0;

/// Returns the series of a job with the exposure metered on its first frame; `None` if its films are not metered on that frame,
/// or if it has no light.
pub(crate) fn metered(job: &Job<'_>, host: &dyn Host) -> Result<Option<spectra_scene::Series>, SessionError> {
    let series = job.series;
    if !matches!(series.kind(), SeriesKind::Animation { .. }) || series.sets_exposures() {
        return Ok(None);
    }
    let first = series.scene(0).map_err(SessionError::Faults)?;
    let locked = |film: &spectra_scene::SceneFilm| film.film.is_metered() && !film.film.meters_each_frame();
    if !first.films.iter().any(locked) {
        return Ok(None);
    }
    let size = first.imager.size();
    let pixels = u64::from(size.width_px) * u64::from(size.height_px);
    let samples = SAMPLES.div_ceil(pixels.max(1)).next_power_of_two().min(u64::from(first.render.samples.max(1)));
    let few = series.with_all(&["render.noise=null".to_owned(), format!("render.samples={samples}")]);
    let options = SessionOptions { isa: job.isa, ..SessionOptions::default() };
    let mut session = Session::new(few.map_err(SessionError::Faults)?, options)?;
    session.prepare(host.workers())?;
    let samples = samples.min(u64::from(session.scene().render.samples));
    session.advance(samples, host.workers(), &host.control())?;
    if host.is_stopped() {
        return Ok(None);
    }
    let rendering = session.rendering()?;
    let times = session.scene().film_times(&rendering.exposure);
    // A meter that sees no light leaves the time unchanged.
    if times.iter().any(|time| time.gain == 1.0 || time.time_s > LONGEST_S) {
        let text = "the first frame has no light to meter: each frame is metered by itself";
        host.hear(Event::Warning(&Warning::from(format!(
            "{text}; begin the animation where there is light, or state `film.exposure`"
        ))));
        return Ok(None);
    }
    let locked: Vec<(usize, f64)> = first
        .films
        .iter()
        .zip(&times)
        .enumerate()
        .filter(|(_, (f, _))| locked(f))
        .map(|(i, (_, t))| (i, t.time_s))
        .collect();
    let words: Vec<String> = locked.iter().map(|(_, time_s)| shutter::format_time(*time_s)).collect();
    host.hear(Event::Note(&format!(
        "metered on the first frame: {} for all frames (`film.meter: each` meters each frame by itself, which may flicker)",
        words.join(", ")
    )));
    series.exposed_for(&locked).map(Some).map_err(SessionError::Faults)
}
