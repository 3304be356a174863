//! `spectra bench`: wavelength strategies against each other.

use crate::arguments::Bench;
use crate::console;
use crate::outcome::{DONE, Failure, Outcome};
use spectra_bench::{BenchError, Settings, parse_list};
use spectra_core::Isa;
use spectra_core::spectral::Channel;
use spectra_files::write_atomically;
use spectra_scene::FileResources;
use spectra_spectrum::{SpectrumError, find_sensitivity_in};
use std::io::Write as _;
use std::path::Path;

/// Seeds of each render, where none are asked for.
const SEEDS: usize = 20;
/// Seeds of the integral a seed of the render: it costs next to nothing.
const INTEGRAL_SEEDS: usize = 50;

/// Measures, writes the files, and shows the table, or JSON in its place.
pub(crate) fn bench(arguments: &Bench, isa: Isa) -> Outcome {
    let strategies = match &arguments.strategies {
        Some(list) => parse_list(list)?,
        None => Vec::new(),
    };
    let asked = arguments.seeds.map(usize::from);
    let seeds = asked.unwrap_or(SEEDS);
    // Where nothing else is measured, the seeds that are asked for are those of the integral.
    let integral_only = arguments.integral_only || !arguments.response.is_empty();
    let integral_seeds = asked.filter(|_| integral_only).unwrap_or(seeds * INTEGRAL_SEEDS);
    let threads = arguments.threads.map(usize::from);
    let settings = Settings {
        seeds,
        integral_seeds,
        samples: arguments.samples.clone(),
        strategies,
        render: !arguments.integral_only,
        response: response(&arguments.response, &arguments.scene, &arguments.set.overrides)?,
        threads: threads.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, usize::from)),
        isa,
    };
    // Before anything is measured: an hour's figures must not end without a place to go.
    let folder = &arguments.output;
    std::fs::create_dir_all(folder).map_err(|e| Failure::Input(format!("{}: {e}", folder.display())))?;
    let mut tell = |line: &str| console::note(line);
    let report = spectra_bench::bench(&arguments.scene, &arguments.set.overrides, &settings, &mut tell)?;
    let picture = spectra_bench::picture(&report);
    let file = |ending: &str| folder.join(format!("{}-sampling.{ending}", report.scene));
    write(&file("csv"), &spectra_bench::csv(&report))?;
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

/// Channels by name; `None` where none is asked for.
fn response(names: &[String], scene: &Path, overrides: &[String]) -> Result<Option<Vec<Channel>>, Failure> {
    if names.is_empty() {
        return Ok(None);
    }
    let grid = spectra_scene::load(scene, overrides)?.grid;
    let files = FileResources::beside(Path::new(""));
    let mut channels = Vec::new();
    for name in names {
        // A file of several spectra is asked for its columns.
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
