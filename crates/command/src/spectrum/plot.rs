//! `spectra spectrum plot`: plots spectra or their chromaticities.

use super::arguments::{DiagramName, SpectrumPlot};
use super::info::{observer, on_grid, xyz_of};
use super::{files, load_as, load_illuminant, tell_reading};
use crate::console;
use crate::formatting::figure_of;
use crate::outcome::{DONE, Failure, Outcome};
use spectra_analysis::figure;
use spectra_color::chromaticity;
use spectra_plot::{Format, PlotError};
use spectra_spectrum::{AnySpectrum, BAND, Emission, Observer, SpectrumError, find_in, function_in};

/// Plots spectra or their chromaticities, and writes the figure to a file.
pub(crate) fn plot(arguments: &SpectrumPlot) -> Outcome {
    let name = arguments.names.first().map_or("", String::as_str);
    let output = &arguments.output.clone().unwrap_or_else(|| figure_of(name));
    // A wrong extension is reported before anything is computed.
    Format::of(output).map_err(failure)?;
    let (mut spectra, mut functions, mut own) = (Vec::new(), Vec::new(), Vec::new());
    for name in &columns(&arguments.names, arguments.chromaticity)? {
        let shown = name.trim().to_owned();
        if let Some(point) = arguments.chromaticity.then(|| own_point(&shown)).flatten() {
            own.push((shown.clone(), point.map_err(Failure::Input)?));
            continue;
        }
        match function_in(name, &files()).filter(|_| !arguments.chromaticity && find_in(name, &files()).is_err()) {
            Some((_, function)) => functions.push((shown, function)),
            None => spectra.push((shown, load_as(name, arguments.kind)?)),
        }
        tell_reading(name);
    }
    let canvas = if arguments.chromaticity {
        let illuminant = load_illuminant(&arguments.illuminant)?;
        let observer = observer(arguments.observer);
        let point = |(name, found): &(String, AnySpectrum)| Ok((name.clone(), xy(name, found, &illuminant, observer)?));
        let mut points = spectra.iter().map(point).collect::<Result<Vec<_>, Failure>>()?;
        points.extend(own);
        let diagram = match arguments.diagram {
            DiagramName::Cie1931 => figure::Diagram::Xy,
            DiagramName::Cie1976 => figure::Diagram::Uv,
        };
        figure::chromaticity_diagram(&points, diagram, observer)
    } else {
        spectra.iter().filter(|(_, found)| is_dark(found)).for_each(|(name, _)| {
            console::warning(&format!("`{name}` is 0 from {} to {} nm", BAND.start_nm, BAND.end_nm()));
        });
        figure::spectrum_and_functions(&spectra, &functions)
    };
    let canvas = match arguments.seen_by {
        None => canvas,
        Some(eye) => eye.simulate(canvas),
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

/// Parses a chromaticity, `xy:0.31,0.33` or `uv:0.198,0.468` (CIE 1976), and returns it as x, y. `None` if the text has another form.
fn own_point(text: &str) -> Option<Result<[f64; 2], String>> {
    let (head, values) = text.split_once(':')?;
    let is_uv = match head.trim() {
        "xy" => false,
        "uv" => true,
        _ => return None,
    };
    let values: Vec<f64> = values.split(',').filter_map(|v| v.trim().parse().ok()).collect();
    let wrong = || format!("`{text}` is not a chromaticity: write xy:0.3127,0.3290, or uv:0.1978,0.4683 for CIE 1976");
    let xy = match values[..] {
        [u, v] if is_uv => {
            let divisor = 6.0 * u - 16.0 * v + 12.0;
            [9.0 * u / divisor, 4.0 * v / divisor]
        }
        [x, y] => [x, y],
        _ => return Some(Err(wrong())),
    };
    let is_good = xy.iter().all(|v| (0.0..=1.0).contains(v)) && xy[0] + xy[1] <= 1.0;
    Some(if is_good { Ok(xy) } else { Err(wrong()) })
}

/// Replaces names of tables by the names of all their columns, unless chromaticities are plotted. Fails if there are too many curves.
fn columns(names: &[String], chromaticity: bool) -> Result<Vec<String>, Failure> {
    /// Largest number of columns of a table that is expanded, more than any observer or camera has.
    const MOST: usize = 8;
    let mut all = Vec::new();
    for name in names {
        match find_in(name, &files()) {
            Err(SpectrumError::Ambiguous { columns, .. }) if !chromaticity && columns.len() <= MOST => {
                all.extend(columns.iter().map(|column| format!("{}#{column}", name.trim())));
            }
            _ => all.push(name.clone()),
        }
    }
    if all.len() > MOST_CURVES {
        return Err(Failure::Input(format!("{} curves are too many for one figure: at most {MOST_CURVES}", all.len())));
    }
    Ok(all)
}

/// Largest number of curves that differ in color or dashes.
const MOST_CURVES: usize = 28;

fn xy(name: &str, found: &AnySpectrum, illuminant: &Emission, observer: &Observer) -> Result<[f64; 2], Failure> {
    if let AnySpectrum::Sensitivity(_) = found {
        return Err(Failure::Input(format!("`{name}` is a sensitivity and has no chromaticity")));
    }
    let xy = xyz_of(found, illuminant, observer).and_then(chromaticity);
    xy.ok_or_else(|| Failure::Input(format!("`{name}` has no chromaticity, because it has no visible light")))
}

fn is_dark(found: &AnySpectrum) -> bool {
    match found {
        AnySpectrum::Emission(light) => light.to_power(&BAND).is_dark(),
        matter => on_grid(matter, &BAND).iter().all(|v| *v <= 0.0),
    }
}
