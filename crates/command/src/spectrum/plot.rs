//! `spectra spectrum plot`.

use super::arguments::SpectrumPlot;
use super::{files, load_as, load_illuminant, tell_reading};
use crate::console;
use crate::outcome::{DONE, Failure, Outcome};
use crate::words::figure_of;
use spectra_analysis::figure;
use spectra_color::{chromaticity, xyz_of_light, xyz_of_reflectance, xyz_of_transmittance};
use spectra_plot::{Format, PlotError};
use spectra_spectrum::{BAND, Emission, Found, Observer, find_in, function_in};

/// Draws spectra, or their chromaticities.
pub(crate) fn plot(arguments: &SpectrumPlot) -> Outcome {
    let name = arguments.names.first().map_or("", String::as_str);
    let output = &arguments.output.clone().unwrap_or_else(|| figure_of(name));
    // Before anything is computed: a wrong ending is found out at once.
    Format::of(output).map_err(failure)?;
    let (mut spectra, mut functions) = (Vec::new(), Vec::new());
    for name in &arguments.names {
        let shown = name.trim().to_owned();
        match function_in(name, &files()).filter(|_| !arguments.chromaticity && find_in(name, &files()).is_err()) {
            Some((_, function)) => functions.push((shown, function)),
            None => spectra.push((shown, load_as(name, arguments.kind)?)),
        }
        tell_reading(name);
    }
    let canvas = if arguments.chromaticity {
        let illuminant = load_illuminant(&arguments.illuminant)?;
        let point = |(name, found): &(String, Found)| Ok((name.clone(), xy(name, found, &illuminant)?));
        let points = spectra.iter().map(point).collect::<Result<Vec<_>, Failure>>()?;
        figure::chromaticity(&points)
    } else {
        spectra.iter().filter(|(_, found)| is_dark(found)).for_each(|(name, _)| {
            console::warning(&format!("`{name}` is 0 from {} to {} nm", BAND.start_nm, BAND.end_nm()));
        });
        figure::spectrum_and_functions(&spectra, &functions)
    };
    canvas.write(output).map_err(failure)?;
    console::note(&format!("wrote {}", output.display()));
    Ok(DONE)
}

fn failure(error: PlotError) -> Failure {
    match error {
        PlotError::Ending { .. } => Failure::Input(error.to_string()),
        PlotError::Write(error) => error.into(),
    }
}

fn xy(name: &str, found: &Found, illuminant: &Emission) -> Result<[f64; 2], Failure> {
    let observer = Observer::cie_1931_2deg();
    let xyz = match found {
        Found::Emission(light) => xyz_of_light(light, observer),
        Found::Transmittance(filter) => xyz_of_transmittance(filter, illuminant, observer),
        Found::Reflectance(surface) => xyz_of_reflectance(surface, illuminant, observer),
        Found::Sensitivity(_) => {
            return Err(Failure::Input(format!("`{name}` is a sensitivity: it has no chromaticity")));
        }
    };
    let xy = xyz.and_then(chromaticity);
    xy.ok_or_else(|| Failure::Input(format!("`{name}` has no chromaticity: nothing of it is seen")))
}

fn is_dark(found: &Found) -> bool {
    let dark = |values: Vec<f64>| values.iter().all(|v| *v <= 0.0);
    match found {
        Found::Emission(light) => light.to_power(&BAND).is_dark(),
        Found::Transmittance(filter) => dark(filter.on_grid(&BAND)),
        Found::Reflectance(surface) => dark(surface.on_grid(&BAND)),
        Found::Sensitivity(detector) => dark(detector.on_grid(&BAND)),
    }
}
