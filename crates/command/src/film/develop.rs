//! `spectra film develop`: develops a picture on a film without a scene file.

use super::arguments::{FilmDevelop, MeterWhich, Switch};
use super::keys::{self, set};
use super::{called, pictures};
use crate::outcome::with_json_error;
use crate::outcome::{Failure, Outcome};
use crate::run::{CliHost, OutputMode};
use crate::version;
use spectra_core::Isa;
use spectra_darkroom::{DevelopSettings, Setting};
use spectra_session::{Develop, picture_ending};
use std::time::Instant;

/// Develops pictures. With `--json`, a failure is also written as an event.
pub(super) fn develop(arguments: &FilmDevelop, isa: Isa, started: Instant) -> Outcome {
    with_json_error(developed(arguments, isa, started), arguments.json)
}

fn developed(arguments: &FilmDevelop, isa: Isa, started: Instant) -> Outcome {
    let stock = called(&arguments.stock)?;
    let ending = || Ok(picture_ending(&arguments.set.overrides)?.unwrap_or_else(|| "png".to_owned()));
    let pictures::DevelopFiles { target, plates, is_series, missing } =
        pictures::of(&arguments.pictures, arguments.output.as_deref(), &keys::stem(&stock), &ending)?;
    let job = Develop {
        plates,
        is_series,
        notes: missing.into_iter().collect(),
        settings: DevelopSettings {
            settings: settings(arguments, &stock)?,
            overrides: arguments.set.overrides.clone(),
            format: arguments.format.as_ref().map(|format| set("imager.format", "--format", format)),
            side_px: arguments.side,
            meter_each: arguments.meter == MeterWhich::Each,
        },
        skip_existing: arguments.skip_existing,
        isa,
        version: version::VERSION,
        versions: version::to_json(),
    };
    let speaks = OutputMode { json: arguments.json, quiet: arguments.quiet };
    let face = CliHost::new(target, arguments.threads, isa, started, speaks, None);
    let ended = spectra_session::develop(&job, &face)?;
    Ok(face.code(ended))
}

/// Returns the settings of all options, by the keys of a scene.
fn settings(arguments: &FilmDevelop, stock: &str) -> Result<Vec<Setting>, Failure> {
    keys::stops(&arguments.keys)?;
    let mut all = keys::settings(&arguments.keys, &arguments.stock, stock);
    all.push(keys::illuminant(&arguments.keys, &arguments.stock, stock)?);
    for (path, option, value) in [
        ("lens.file", "--lens", &arguments.lens),
        ("lens.f-number", "--f-number", &arguments.f_number),
        ("render.noise", "--noise", &arguments.noise),
    ] {
        all.extend(value.as_ref().map(|value| set(path, option, value)));
    }
    match arguments.grain {
        Some(Switch::On) => all.push(set("film.grain", "--grain", "true")),
        Some(Switch::Off) => all.push(set("film.grain", "--grain", "false")),
        None => {}
    }
    if arguments.halation == Some(Switch::Off) {
        all.push(set("film.halation", "--halation", "off"));
    }
    if let Some(seed) = arguments.seed {
        let seed = seed.to_string();
        all.extend([set("film.grain-seed", "--seed", &seed), set("render.seed", "--seed", &seed)]);
    }
    Ok(all)
}
