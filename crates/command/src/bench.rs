//! `spectra bench`: compares wavelength strategies, and measures the noise of scenes and ghosts.

use crate::arguments::{Bench, BenchGhosts, BenchNoise, OtherBench};
use crate::console;
use crate::outcome::{DONE, Failure, Outcome};
use crate::version;
use spectra_bench::{BenchError, GhostSettings, NoiseSettings, Settings, parse_list};
use spectra_core::Isa;
use spectra_core::spectral::Channel;
use spectra_files::write_atomically;
use spectra_scene::FileResources;
use spectra_spectrum::{SpectrumError, find_sensitivity_in};
use std::io::Write as _;
use std::path::Path;

/// Default number of seeds per render.
const SEEDS: usize = 20;
/// Number of seeds for the integral per seed of the render. The integral costs almost nothing.
const INTEGRAL_SEEDS: usize = 50;

/// Measures wavelength strategies, writes the files, and prints the table or JSON. With a subcommand, measures noise or ghosts.
pub(crate) fn bench(arguments: &Bench, isa: Isa) -> Outcome {
    match &arguments.other {
        Some(OtherBench::Noise(arguments)) => return noise(arguments, isa),
        Some(OtherBench::Ghosts(arguments)) => return ghosts(arguments, isa),
        None => {}
    }
    let Some(scene) = &arguments.scene else {
        return Err(Failure::Input("name a scene, such as `spectra bench bench/sampling-d65-xyz`".to_owned()));
    };
    let strategies = match &arguments.strategies {
        Some(list) => parse_list(list)?,
        None => Vec::new(),
    };
    let asked = arguments.seeds.map(usize::from);
    let seeds = asked.unwrap_or(SEEDS);
    // If only the integral is measured, the requested number of seeds applies to it.
    let integral_only = arguments.integral_only || !arguments.response.is_empty();
    let integral_seeds = asked.filter(|_| integral_only).unwrap_or(seeds * INTEGRAL_SEEDS);
    let threads = arguments.threads.map(usize::from);
    let settings = Settings {
        seeds,
        integral_seeds,
        seed: arguments.seed,
        samples: arguments.samples.clone(),
        strategies,
        render: !arguments.integral_only,
        response: response(&arguments.response, scene, &arguments.set.overrides)?,
        threads: threads.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, usize::from)),
        isa,
    };
    // The folder is created before measuring, so that an hour of work cannot end without a place to write the results.
    let folder = &arguments.output;
    std::fs::create_dir_all(folder).map_err(|e| Failure::Input(format!("{}: {e}", folder.display())))?;
    let mut tell = |line: &str| console::note(line);
    let report = spectra_bench::bench(scene, &arguments.set.overrides, &settings, &mut tell)?;
    let picture = spectra_bench::picture(&report);
    let file = |ending: &str| folder.join(format!("{}-sampling.{ending}", report.scene));
    write(&file("csv"), &spectra_bench::csv(&report))?;
    write(&folder.join(format!("{}-sampling-seeds.csv", report.scene)), &spectra_bench::seeds_csv(&report))?;
    for path in [file("svg"), file("png")] {
        picture.write(&path).map_err(|e| Failure::Failed(e.to_string()))?;
        console::note(&format!("wrote {}", path.display()));
    }
    if arguments.json {
        console::pretty_json(&report)?;
    } else {
        console::out(&spectra_bench::table(&report))?;
    }
    Ok(DONE)
}

/// Measures how long scenes take to become clean.
fn noise(arguments: &BenchNoise, isa: Isa) -> Outcome {
    let threads = arguments.threads.map(usize::from);
    let settings = NoiseSettings {
        seeds: arguments.renders.seeds.into(),
        seconds: arguments.seconds.into(),
        directions: arguments.directions.clone(),
        threads: threads.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, usize::from)),
        isa,
    };
    let mut rows = Vec::new();
    for scene in &arguments.renders.scenes {
        let mut tell = |line: &str| console::note(line);
        rows.extend(spectra_bench::noise(scene, &arguments.renders.set.overrides, &settings, &mut tell)?);
    }
    if arguments.json {
        console::pretty_json(&rows)?;
        return Ok(DONE);
    }
    let machine =
        format!("{}, {}, {} threads, commit {}", processor(), isa.name(), settings.threads, version::commit());
    console::out(&spectra_bench::noise_table(&rows, &settings, &machine))?;
    Ok(DONE)
}

/// Measures the noise of ghosts.
fn ghosts(arguments: &BenchGhosts, isa: Isa) -> Outcome {
    let threads = arguments.threads.map(usize::from);
    let settings = GhostSettings {
        seeds: arguments.renders.seeds.into(),
        threads: threads.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, usize::from)),
        isa,
        processor_s,
    };
    let mut rows = Vec::new();
    for scene in &arguments.renders.scenes {
        let mut tell = |line: &str| console::note(line);
        rows.push(spectra_bench::ghosts(scene, &arguments.renders.set.overrides, &settings, &mut tell)?);
    }
    if arguments.json {
        console::pretty_json(&rows)?;
        return Ok(DONE);
    }
    let machine =
        format!("{}, {}, {} threads, commit {}", processor(), isa.name(), settings.threads, version::commit());
    console::out(&spectra_bench::ghost_table(&rows, &settings, &machine))?;
    Ok(DONE)
}

/// Returns the processor time of this program in seconds, if the system reports it (proc(5): `utime` and `stime`, in hundredths of
/// a second on Linux).
fn processor_s() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/self/stat").ok()?;
    // The process name, in parentheses, may contain any character.
    let mut fields = text.rsplit_once(')')?.1.split_whitespace().skip(11);
    let mut ticks = || fields.next()?.parse::<f64>().ok();
    Some((ticks()? + ticks()?) / 100.0)
}

/// Returns the name of the processor, or its architecture if the system does not report a name.
fn processor() -> String {
    let known = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let named = known.lines().find_map(|line| line.strip_prefix("model name")?.split_once(':'));
    named.map_or_else(|| std::env::consts::ARCH.to_owned(), |(_, name)| name.trim().to_owned())
}

/// Loads the channels of `--response` by name, on the wavelength grid of the scene; `None` if no names are given.
fn response(names: &[String], scene: &Path, overrides: &[String]) -> Result<Option<Vec<Channel>>, Failure> {
    if names.is_empty() {
        return Ok(None);
    }
    let grid = spectra_scene::load(scene, overrides)?.grid;
    let files = FileResources::beside(Path::new(""));
    let mut channels = Vec::new();
    for name in names {
        // A file of several spectra gives one channel per column.
        let columns = match find_sensitivity_in(name, &files) {
            Err(SpectrumError::Ambiguous { columns, .. }) => columns.iter().map(|c| format!("{name}#{c}")).collect(),
            _ => vec![name.clone()],
        };
        for column in columns {
            let found = find_sensitivity_in(&column, &files).map_err(|e| Failure::Input(format!("--response: {e}")))?;
            let name = column.rsplit_once('#').map_or(column.as_str(), |(_, column)| column).trim().to_owned();
            channels.push(Channel { name, unit: "1".to_owned(), response: found.on_grid(&grid) });
        }
    }
    Ok(Some(channels))
}

fn write(path: &Path, text: &str) -> Result<(), Failure> {
    write_atomically(path, |file| Ok(file.write_all(text.as_bytes())?))?;
    console::note(&format!("wrote {}", path.display()));
    Ok(())
}

impl From<BenchError> for Failure {
    fn from(error: BenchError) -> Self {
        match error {
            BenchError::Faults(faults) => Self::Faults(faults),
            BenchError::Render { .. } => Self::Failed(error.to_string()),
            _ => Self::Input(error.to_string()),
        }
    }
}
