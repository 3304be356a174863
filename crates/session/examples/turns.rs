//! Measures the processor time that a turn of a control costs in the engine alone: turns SCENE [EVENTS [ONLY]]
//!
//! Each event is handled as the viewer does it, on one thread: a small draft is changed, prepared, traced and developed; then the
//! whole picture is changed. ONLY is a part of the names of the changes to make. Times are processor times if the system reports
//! them, otherwise wall-clock times.

use spectra_plugins as _;
use spectra_session::{Control, Effort, Session, SessionOptions, SingleThread};
use std::time::Instant;

/// Returns the time that this thread has run, in nanoseconds.
fn cpu_ns(start: Instant) -> u128 {
    let said = std::fs::read_to_string("/proc/self/schedstat").ok();
    let own = said.as_deref().and_then(|text| text.split(' ').next()?.parse().ok());
    own.unwrap_or_else(|| start.elapsed().as_nanos())
}

/// Pseudo-random numbers in [0, 1), the same in every run.
struct Random(u64);

impl Random {
    fn between(&mut self, least: f64, most: f64) -> f64 {
        self.0 = self.0 * 48_271 % 2_147_483_647;
        let part = self.0 as f64 / 2_147_483_647.0;
        ((least + (most - least) * part) * 1000.0).round() / 1000.0
    }
}

type Next = fn(usize, &mut Random) -> String;

const TURNS: [(&str, Next); 9] = [
    ("f-number", |_, r| format!("lens.f-number={}", r.between(2.0, 16.0))),
    ("focus", |_, r| format!("lens.focus={} m", r.between(1.2, 5.0))),
    ("tilt", |_, r| format!("imager.tilt=[{} deg, {} deg]", r.between(-5.0, 5.0), r.between(-5.0, 5.0))),
    ("untilted", |_, _| "imager.tilt=[0 deg, 0 deg]".to_owned()),
    ("blades", |i, _| format!("lens.aperture={{shape: iris, blades: {}}}", 5 + i % 7)),
    ("stock", |i, _| format!("film.stock={}", ["kodak-tri-x-400", "ilford-ortho-plus"][i % 2])),
    ("push", |i, _| format!("film.push={}", 1 - i % 2)),
    ("grade", |i, _| format!("film.paper.grade={}", 1 + i % 4)),
    ("lens", |i, _| format!("lens.file={}", ["cooke-triplet-50-f5", "zeiss-biotar-50-f1.4"][i % 2])),
];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut given = std::env::args().skip(1);
    let scene = given.next().ok_or("turns SCENE [EVENTS [ONLY]]")?;
    let events: usize = given.next().map_or(Ok(100), |text| text.parse())?;
    let only = given.next().unwrap_or_default();
    let mut whole =
        Session::open(scene.as_ref(), &["imager.resolution=[480, 320]".to_owned()], SessionOptions::default())?;
    whole.step(1, &SingleThread, &Control::new())?;
    let small =
        ["imager.resolution=[120, 80]", "render.samples=4", "render.reflections.order=0", "render.diffraction=false"];
    let mut draft =
        whole.branch(&small.map(str::to_owned), SessionOptions { effort: Effort::Draft, ..whole.options() })?;
    draft.step(4, &SingleThread, &Control::new())?;
    let (mut random, begun) = (Random(1), Instant::now());
    println!(
        "{:<10}{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}",
        "CPU ms", "median", "95 %", "change", "ready", "trace", "picture", "whole"
    );
    for (name, next) in TURNS {
        if !name.contains(&only) && name != "untilted" {
            continue;
        }
        let mut rows: Vec<[f64; 5]> = Vec::new();
        let count = match name {
            "untilted" => 1,
            "stock" | "lens" => events.div_ceil(4),
            _ => events,
        };
        for i in 0..count {
            let text = next(i, &mut random);
            let mut marks = vec![cpu_ns(begun)];
            let mut mark = || marks.push(cpu_ns(begun));
            if draft.change_unprepared(&[&text], 0, None, &SingleThread).is_err() {
                // This lens or paper has no such setting.
                continue;
            }
            mark();
            draft.prepare(&SingleThread)?;
            mark();
            draft.advance(4, &SingleThread, &Control::new())?;
            mark();
            draft.develop()?;
            mark();
            whole.change_unprepared(&[&text], 0, Some(&draft), &SingleThread)?;
            mark();
            rows.push(std::array::from_fn(|k| (marks[k + 1] - marks[k]) as f64 / 1e6));
        }
        let mut first: Vec<f64> = rows.iter().map(|row| row[..4].iter().sum()).collect();
        first.sort_by(f64::total_cmp);
        if first.is_empty() || name == "untilted" {
            continue;
        }
        let at = |part: f64| first[((first.len() - 1) as f64 * part).round() as usize];
        let mean = |k: usize| rows.iter().map(|row| row[k]).sum::<f64>() / rows.len() as f64;
        print!("{name:<10}{:>8.1}{:>8.1}", at(0.5), at(0.95));
        println!("{:>8.1}{:>8.1}{:>8.1}{:>8.1}{:>8.1}", mean(0), mean(1), mean(2), mean(3), mean(4));
    }
    Ok(())
}
