//! Measures the processor time of scenes until the first ray is traced, and of the first sample of each pixel, on one thread:
//! prepared SCENE...
//!
//! Of a series, the first picture is measured. Times are processor times if the system reports them, otherwise wall-clock times.

use spectra_plugins as _;
use spectra_session::{Control, Session, SessionOptions, SingleThread};
use std::path::Path;
use std::time::Instant;

/// Returns the time that this thread has run, s.
fn cpu_s(start: Instant) -> f64 {
    let said = std::fs::read_to_string("/proc/thread-self/schedstat").ok();
    let own = said.as_deref().and_then(|text| text.split(' ').next()?.parse::<f64>().ok());
    own.map_or_else(|| start.elapsed().as_secs_f64(), |nanoseconds| 1e-9 * nanoseconds)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut all = Vec::new();
    for scene in std::env::args().skip(1) {
        let begun = Instant::now();
        let start = cpu_s(begun);
        let set = ["render.noise=null".to_owned()];
        let mut session = Session::open(Path::new(&scene), &set, SessionOptions::default())?;
        let opened = cpu_s(begun);
        session.prepare(&SingleThread)?;
        let ready = cpu_s(begun);
        session.step(1, &SingleThread, &Control::new())?;
        let traced = cpu_s(begun);
        println!(
            "{scene}: {:.2} s to read, {:.2} s to prepare, {:.2} s for a sample",
            opened - start,
            ready - opened,
            traced - ready
        );
        all.push(ready - start);
    }
    all.sort_by(f64::total_cmp);
    if let (Some(median), Some(worst)) = (all.get(all.len() / 2), all.last()) {
        println!("to the first ray: median {median:.2} s, worst {worst:.2} s");
    }
    Ok(())
}
